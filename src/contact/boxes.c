// Two boxes: which axis separates them, and where they touch along it.
#include <string.h>

#include "contact/manifold.h"

// Everything that the axis tests need, in a's frame.
typedef struct frame_pair {
	double c[3][3], q[3][3]; // b's axes in a's frame; their absolute values
	double t[3], u[3]; // centre and velocity of b seen from a, a's frame
	double tb[3], ub[3]; // the same along b's axes
	double ha[3], hb[3]; // half extents
} frame_pair;

// The best axis so far. face: 0..2 of a, 3..5 of b; edge: 3 i + j of the cross products.
typedef struct axis_search {
	double face_gap, edge_gap; // the largest separations
	int face, edge;
	double close_time; // of the separating axis that closes last; < 0 = none separates
	int close_axis; // 0..5 faces, 6.. edges
} axis_search;

// Separations this close count as equal: faces of a before faces of b, faces before edges.
static const double along_face = .99; // cosine: edges that close along a face's normal, or nearly
static const double prefer_first = 1e-4, prefer_face = 1e-3;

static void frame_pair_init(frame_pair *f, const ob_placed *a, const ob_placed *b)
{
	ob_vec3 t = ob_rotate_back(&a->r, ob_sub(b->p, a->p)), u = ob_rotate_back(&a->r, ob_sub(b->v, a->v));
	double ts[3] = { t.x, t.y, t.z }, us[3] = { u.x, u.y, u.z };
	memcpy(f->t, ts, sizeof ts);
	memcpy(f->u, us, sizeof us);
	memcpy(f->ha, (double[3]){ a->size.x, a->size.y, a->size.z }, sizeof ts);
	memcpy(f->hb, (double[3]){ b->size.x, b->size.y, b->size.z }, sizeof ts);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			f->c[i][j] =
				a->r.m[0][i] * b->r.m[0][j] + a->r.m[1][i] * b->r.m[1][j] + a->r.m[2][i] * b->r.m[2][j];
			f->q[i][j] = fabs(f->c[i][j]);
		}
	for (int j = 0; j < 3; j++) {
		f->tb[j] = t.x * f->c[0][j] + t.y * f->c[1][j] + t.z * f->c[2][j];
		f->ub[j] = u.x * f->c[0][j] + u.y * f->c[1][j] + u.z * f->c[2][j];
	}
}

// Of several axes that separate, the one that closes last is the one along which the boxes will meet.
static void note_closing(axis_search *s, double gap, double rate, int axis)
{
	if (gap <= 0)
		return;
	double time = rate < -1e-6 ? -gap / rate : 1e9;
	if (time > s->close_time) {
		s->close_time = time;
		s->close_axis = axis;
	}
}

static void search_faces(const frame_pair *f, axis_search *s)
{
	for (int i = 0; i < 3; i++) {
		double gap = fabs(f->t[i]) - f->ha[i] -
			     (f->q[i][0] * f->hb[0] + f->q[i][1] * f->hb[1] + f->q[i][2] * f->hb[2]);
		note_closing(s, gap, f->t[i] > 0 ? f->u[i] : -f->u[i], i);
		if (gap > s->face_gap)
			s->face_gap = gap, s->face = i;
	}
	for (int j = 0; j < 3; j++) {
		double gap = fabs(f->tb[j]) - f->hb[j] -
			     (f->q[0][j] * f->ha[0] + f->q[1][j] * f->ha[1] + f->q[2][j] * f->ha[2]);
		note_closing(s, gap, f->tb[j] > 0 ? f->ub[j] : -f->ub[j], 3 + j);
		if (gap > s->face_gap + prefer_first)
			s->face_gap = gap, s->face = 3 + j;
	}
}

static void search_edges(const frame_pair *f, axis_search *s)
{
	for (int i = 0; i < 3; i++) {
		int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
		for (int j = 0; j < 3; j++) {
			int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
			double l2 = 1 - f->c[i][j] * f->c[i][j];
			if (l2 < 1e-4)
				continue; // nearly parallel edges: a face axis says the same
			double inv = 1 / sqrt(l2), along = f->t[i2] * f->c[i1][j] - f->t[i1] * f->c[i2][j];
			double rate = (f->u[i2] * f->c[i1][j] - f->u[i1] * f->c[i2][j]) * inv;
			double gap = (fabs(along) - (f->ha[i1] * f->q[i2][j] + f->ha[i2] * f->q[i1][j] +
						     f->hb[j1] * f->q[i][j2] + f->hb[j2] * f->q[i][j1])) *
				     inv;
			note_closing(s, gap - prefer_face, along > 0 ? rate : -rate, 6 + 3 * i + j);
			if (gap > s->edge_gap)
				s->edge_gap = gap, s->edge = 3 * i + j;
		}
	}
}

// Two edges: the nearest points of the lines that carry them.
static void edge_manifold(const ob_placed *a, const ob_placed *b, int edge, ob_manifold *m)
{
	int i = edge / 3, j = edge % 3;
	ob_vec3 u = ob_column(&a->r, i), v = ob_column(&b->r, j), n = ob_cross(u, v), d = ob_sub(b->p, a->p);
	n = ob_scale(n, (ob_dot(n, d) > 0 ? -1 : 1) / ob_norm(n));
	double ha[3] = { a->size.x, a->size.y, a->size.z }, hb[3] = { b->size.x, b->size.y, b->size.z };
	ob_vec3 pa = a->p, pb = b->p;
	for (int k = 0; k < 3; k++) {
		ob_vec3 ax = ob_column(&a->r, k), bx = ob_column(&b->r, k);
		if (k != i)
			pa = ob_madd(pa, ob_dot(ax, n) > 0 ? -ha[k] : ha[k], ax);
		if (k != j)
			pb = ob_madd(pb, ob_dot(bx, n) > 0 ? hb[k] : -hb[k], bx);
	}
	ob_vec3 w = ob_sub(pa, pb);
	double uv = ob_dot(u, v), uw = ob_dot(u, w), vw = ob_dot(v, w), det = 1 - uv * uv;
	double s = (uv * vw - uw) / det, t = (vw - uv * uw) / det;
	s = s > ha[i] ? ha[i] : s < -ha[i] ? -ha[i] : s;
	t = t > hb[j] ? hb[j] : t < -hb[j] ? -hb[j] : t;
	ob_vec3 xa = ob_madd(pa, s, u), xb = ob_madd(pb, t, v);
	m->normal = n;
	m->points = 1;
	m->gap[0] = ob_dot(n, ob_sub(xa, xb));
	m->at[0] = ob_scale(ob_add(xa, xb), .5);
}

// A convex polygon in the reference face's plane: coordinates u, w in the face, z above it.
typedef struct polygon {
	double u[8], w[8], z[8];
	int n;
} polygon;

static void polygon_put(polygon *p, double u, double w, double z)
{
	if (p->n < 8) {
		p->u[p->n] = u, p->w[p->n] = w, p->z[p->n] = z;
		p->n++;
	}
}

// Cuts away what lies beyond limit on one side (sign) of one face axis (0 = u, 1 = w).
static void clip(polygon *p, int axis, double sign, double limit)
{
	polygon out = { .n = 0 };
	const double *x = axis ? p->w : p->u;
	for (int k = 0; k < p->n; k++) {
		int next = k + 1 < p->n ? k + 1 : 0;
		double f = sign * x[k] - limit, g = sign * x[next] - limit;
		if (f <= 0)
			polygon_put(&out, p->u[k], p->w[k], p->z[k]);
		if ((f < 0 && g > 0) || (f > 0 && g < 0)) {
			double s = f / (f - g);
			polygon_put(&out, p->u[k] + s * (p->u[next] - p->u[k]), p->w[k] + s * (p->w[next] - p->w[k]),
				    p->z[k] + s * (p->z[next] - p->z[k]));
		}
	}
	*p = out;
}

// The four points that matter most: the deepest, the farthest from it, and the widest to each side.
static void reduce_to_four(polygon *p)
{
	int k0 = 0, k1 = -1, k2 = -1, k3 = -1;
	for (int k = 1; k < p->n; k++)
		if (p->z[k] < p->z[k0] - 1e-5)
			k0 = k;
	double far = -1, left = 1e-12, right = -1e-12;
	for (int k = 0; k < p->n; k++) {
		double du = p->u[k] - p->u[k0], dw = p->w[k] - p->w[k0];
		if (du * du + dw * dw > far)
			far = du * du + dw * dw, k1 = k;
	}
	for (int k = 0; k < p->n; k++) {
		if (k == k0 || k == k1)
			continue;
		double area =
			(p->u[k1] - p->u[k0]) * (p->w[k] - p->w[k0]) - (p->w[k1] - p->w[k0]) * (p->u[k] - p->u[k0]);
		if (area > left)
			left = area, k2 = k;
		if (area < right)
			right = area, k3 = k;
	}
	int keep[4] = { k0, k1, k2, k3 };
	polygon out = { .n = 0 };
	for (int k = 0; k < 4; k++)
		if (keep[k] >= 0)
			polygon_put(&out, p->u[keep[k]], p->w[keep[k]], p->z[keep[k]]);
	*p = out;
}

// The face of box "in" that looks most against n, in the reference face's coordinates.
static void incident_face(const ob_placed *ref, const ob_placed *in, ob_vec3 n, ob_vec3 u, ob_vec3 w, double height,
			  polygon *p)
{
	double h[3] = { in->size.x, in->size.y, in->size.z }, best = -1, sign = 1;
	int k = 0;
	for (int i = 0; i < 3; i++) {
		double c = ob_dot(n, ob_column(&in->r, i));
		if (fabs(c) > best)
			best = fabs(c), k = i, sign = c > 0 ? -1 : 1;
	}
	int e1 = (k + 1) % 3, e2 = (k + 2) % 3;
	ob_vec3 centre = ob_madd(ob_sub(in->p, ref->p), sign * h[k], ob_column(&in->r, k));
	ob_vec3 f1 = ob_scale(ob_column(&in->r, e1), h[e1]), f2 = ob_scale(ob_column(&in->r, e2), h[e2]);
	static const int s1[4] = { 1, -1, -1, 1 }, s2[4] = { 1, 1, -1, -1 };
	p->n = 0;
	for (int i = 0; i < 4; i++) {
		ob_vec3 x = ob_madd(ob_madd(centre, s1[i], f1), s2[i], f2);
		polygon_put(p, ob_dot(x, u), ob_dot(x, w), ob_dot(x, n) - height);
	}
}

// The face whose normal is nearest to that of two edges, if it is near enough: -1 otherwise.
static int face_along(const ob_placed *a, const ob_placed *b, int edge)
{
	ob_vec3 n = ob_cross(ob_column(&a->r, edge / 3), ob_column(&b->r, edge % 3));
	double best = along_face * ob_norm(n);
	int face = -1;
	for (int k = 0; k < 6; k++) {
		double c = fabs(ob_dot(n, ob_column(k < 3 ? &a->r : &b->r, k % 3)));
		if (c > best)
			best = c, face = k;
	}
	return face;
}

static void face_manifold(const ob_placed *a, const ob_placed *b, int face, double margin, ob_manifold *m)
{
	bool of_b = face >= 3;
	const ob_placed *ref = of_b ? b : a, *in = of_b ? a : b;
	int r = face % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
	double h[3] = { ref->size.x, ref->size.y, ref->size.z };
	ob_vec3 n = ob_column(&ref->r, r), u = ob_column(&ref->r, r1), w = ob_column(&ref->r, r2);
	if (ob_dot(n, ob_sub(in->p, ref->p)) < 0)
		n = ob_scale(n, -1);
	polygon p;
	incident_face(ref, in, n, u, w, h[r], &p);
	clip(&p, 0, 1, h[r1]);
	clip(&p, 0, -1, h[r1]);
	clip(&p, 1, 1, h[r2]);
	clip(&p, 1, -1, h[r2]);
	int kept = 0;
	for (int k = 0; k < p.n; k++)
		if (p.z[k] <= margin) {
			p.u[kept] = p.u[k], p.w[kept] = p.w[k], p.z[kept] = p.z[k];
			kept++;
		}
	p.n = kept;
	if (p.n > 4)
		reduce_to_four(&p);
	m->normal = ob_scale(n, of_b ? 1 : -1);
	m->points = p.n;
	for (int k = 0; k < p.n; k++) {
		m->gap[k] = p.z[k];
		m->at[k] = ob_madd(ob_madd(ob_madd(ref->p, p.u[k], u), p.w[k], w), h[r] + .5 * p.z[k], n);
	}
}

void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	frame_pair f;
	axis_search s = { .face_gap = -1e30, .edge_gap = -1e30, .close_time = -1, .close_axis = -1 };
	frame_pair_init(&f, a, b);
	search_faces(&f, &s);
	out->points = 0;
	out->separation = s.face_gap;
	if (s.face_gap > margin + .02)
		return;
	search_edges(&f, &s);
	if (s.edge_gap > s.face_gap)
		out->separation = s.edge_gap;
	if (out->separation > margin)
		return;
	double tolerance = s.face_gap < 0 ? prefer_face - .02 * s.face_gap : prefer_face;
	bool edge = s.edge_gap > s.face_gap + tolerance;
	if (s.close_axis >= 0) {
		edge = s.close_axis >= 6;
		if (edge)
			s.edge = s.close_axis - 6;
		else
			s.face = s.close_axis;
	}
	// Edges that meet nearly along a face's normal: the face's points hold them apart, too, and with them what else
	// is about to meet there.
	int face = edge ? face_along(a, b, s.edge) : s.face;
	if (face >= 0)
		face_manifold(a, b, face, margin, out);
	if (edge && (face < 0 || !out->points))
		edge_manifold(a, b, s.edge, out);
}
