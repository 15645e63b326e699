// Two boxes: which axis separates them, and where they touch along it.
#include <string.h>

#include "contact/manifold.h"
#include "contact/polytope.h"

// Everything that the axis tests need, in a's frame.
typedef struct frame_pair {
	double c[3][3], q[3][3]; // b's axes in a's frame; their absolute values
	double t[3], tb[3]; // centre of b seen from a, a's frame; along b's axes
	double ha[3], hb[3]; // half extents
	double thin; // the least thickness of both
	double rest; // m: so deep they may be in each other at rest
	double discount; // m: so much more must an edge's axis separate than a face's
} frame_pair;

// How it changes with time.
typedef struct frame_rates {
	double c[3][3], t[3], tb[3];
} frame_rates;

enum { FACES = 6, AXES = 15 }; // axis 0..2: faces of a; 3..5: of b; 6 + 3 i + j: edge i of a across edge j of b

// The separation along each axis (m), -infinity where edges are nearly parallel: there a face's axis says the same.
typedef struct axis_gaps {
	double gap[AXES];
	double largest_face, largest_edge;
	int face, edge; // whose they are
} axis_gaps;

static const double along_face = .99; // cosine: edges that close along a face's normal, or nearly
// An edge's axis must separate by so much more than a face's: of the thickness, and no more than two may be in each
// other at rest, for so deep do they get before the edge holds them.
static const double prefer_face = 1e-3;
static const double prefer_face_when_deep = .02; // of the depth, beside it
static const double nearby = .05; // of the thickness: boxes farther apart than that need no axes of edges
static const double parallel_edges = 1e-10; // sin^2 of their angle
static const double same_axis = .99; // cosine
static const double same_depth = 1e-4; // of the reference box's least half extent: points that count as equally deep

static void frame_pair_init(frame_pair *f, const ob_placed *a, const ob_placed *b)
{
	ob_vec3 t = ob_rotate_back(&a->r, ob_sub(b->p, a->p));
	memcpy(f->t, (double[3]){ t.x, t.y, t.z }, sizeof f->t);
	memcpy(f->ha, (double[3]){ a->size.x, a->size.y, a->size.z }, sizeof f->ha);
	memcpy(f->hb, (double[3]){ b->size.x, b->size.y, b->size.z }, sizeof f->hb);
	f->thin =
		2 * ob_min(ob_min(f->ha[0], ob_min(f->ha[1], f->ha[2])), ob_min(f->hb[0], ob_min(f->hb[1], f->hb[2])));
	f->rest = ob_min(a->rest_depth, b->rest_depth);
	f->discount = ob_min(prefer_face * f->thin, f->rest);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			f->c[i][j] =
				a->r.m[0][i] * b->r.m[0][j] + a->r.m[1][i] * b->r.m[1][j] + a->r.m[2][i] * b->r.m[2][j];
			f->q[i][j] = fabs(f->c[i][j]);
		}
	for (int j = 0; j < 3; j++)
		f->tb[j] = t.x * f->c[0][j] + t.y * f->c[1][j] + t.z * f->c[2][j];
}

// Both boxes move and turn: as a sees it, in its own frame.
static void frame_rates_init(frame_rates *d, const frame_pair *f, const ob_placed *a, const ob_placed *b)
{
	ob_vec3 apart = ob_sub(b->p, a->p), v = ob_sub(ob_sub(b->v, a->v), ob_cross(a->w, apart));
	ob_vec3 u = ob_rotate_back(&a->r, v), w = ob_rotate_back(&a->r, ob_sub(b->w, a->w));
	memcpy(d->t, (double[3]){ u.x, u.y, u.z }, sizeof d->t);
	for (int j = 0; j < 3; j++) {
		ob_vec3 turn = ob_cross(w, ob_v3(f->c[0][j], f->c[1][j], f->c[2][j]));
		d->c[0][j] = turn.x, d->c[1][j] = turn.y, d->c[2][j] = turn.z;
		d->tb[j] = 0;
		for (int i = 0; i < 3; i++)
			d->tb[j] += d->t[i] * f->c[i][j] + f->t[i] * d->c[i][j];
	}
}

static double face_gap(const frame_pair *f, int axis)
{
	int k = axis % 3;
	return axis < 3 ? fabs(f->t[k]) - f->ha[k] -
				  (f->q[k][0] * f->hb[0] + f->q[k][1] * f->hb[1] + f->q[k][2] * f->hb[2])
			: fabs(f->tb[k]) - f->hb[k] -
				  (f->q[0][k] * f->ha[0] + f->q[1][k] * f->ha[1] + f->q[2][k] * f->ha[2]);
}

static void find_face_gaps(const frame_pair *f, axis_gaps *s)
{
	s->largest_face = s->gap[s->face = 0] = face_gap(f, 0);
	for (int k = 1; k < FACES; k++) {
		s->gap[k] = face_gap(f, k);
		if (s->gap[k] > s->largest_face)
			s->largest_face = s->gap[k], s->face = k;
	}
}

static void find_edge_gaps(const frame_pair *f, axis_gaps *s)
{
	s->largest_edge = -INFINITY;
	s->edge = 0;
	for (int i = 0; i < 3; i++) {
		int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
		for (int j = 0; j < 3; j++) {
			int j1 = (j + 1) % 3, j2 = (j + 2) % 3, axis = FACES + 3 * i + j;
			double l2 = 1 - f->c[i][j] * f->c[i][j];
			s->gap[axis] = -INFINITY;
			if (l2 < parallel_edges)
				continue;
			double along = f->t[i2] * f->c[i1][j] - f->t[i1] * f->c[i2][j];
			double gap = (fabs(along) - (f->ha[i1] * f->q[i2][j] + f->ha[i2] * f->q[i1][j] +
						     f->hb[j1] * f->q[i][j2] + f->hb[j2] * f->q[i][j1])) /
				     sqrt(l2);
			s->gap[axis] = gap;
			if (gap > s->largest_edge)
				s->largest_edge = gap, s->edge = 3 * i + j;
		}
	}
}

// d|c|/dt of b's axis j along a's axis i, at the most where it passes 0.
static double growth(const frame_pair *f, const frame_rates *d, int i, int j)
{
	return f->q[i][j] < 1e-9 ? fabs(d->c[i][j]) : f->c[i][j] > 0 ? d->c[i][j] : -d->c[i][j];
}

// m/s at which the gap along an axis opens
static double opening_rate(const frame_pair *f, const frame_rates *d, int axis)
{
	double rate = 0;
	if (axis < FACES) {
		const int k = axis % 3;
		const double t = axis < 3 ? f->t[k] : f->tb[k], dt = axis < 3 ? d->t[k] : d->tb[k];
		for (int i = 0; i < 3; i++)
			rate -= axis < 3 ? f->hb[i] * growth(f, d, k, i) : f->ha[i] * growth(f, d, i, k);
		return rate + (t > 0 ? dt : -dt);
	}
	const int i = (axis - FACES) / 3, j = (axis - FACES) % 3;
	const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
	const double l2 = 1 - f->c[i][j] * f->c[i][j], inv = 1 / sqrt(l2);
	double along = f->t[i2] * f->c[i1][j] - f->t[i1] * f->c[i2][j];
	double sliding =
		d->t[i2] * f->c[i1][j] + f->t[i2] * d->c[i1][j] - d->t[i1] * f->c[i2][j] - f->t[i1] * d->c[i2][j];
	double radii =
		f->ha[i1] * f->q[i2][j] + f->ha[i2] * f->q[i1][j] + f->hb[j1] * f->q[i][j2] + f->hb[j2] * f->q[i][j1];
	double growing = f->ha[i1] * growth(f, d, i2, j) + f->ha[i2] * growth(f, d, i1, j) +
			 f->hb[j1] * growth(f, d, i, j2) + f->hb[j2] * growth(f, d, i, j1);
	rate = (along > 0 ? sliding : -sliding) - growing;
	return inv * (rate + (fabs(along) - radii) * f->c[i][j] * d->c[i][j] / l2);
}

// The cosine between the axes of two faces.
static double face_cosine(const frame_pair *f, int k, int l)
{
	if (k / 3 == l / 3)
		return k == l;
	return k < 3 ? f->q[k][l - 3] : f->q[l][k - 3];
}

// Of several axes that separate the boxes, or along which they touch no deeper than at rest, the one that closes last
// is the one along which they will meet: as long as one stays open, nothing is hit along the others. So what slides
// over a seam of two coplanar faces is not hit by the side of the next one. Of those that do not close at all, axes of
// faces that touch count first: something else holds the boxes there. -1: no axis separates; crossing is set where the
// boxes touch along two axes of faces that do not close: edge to edge, they may go on along either.
static int closing_last(const ob_placed *a, const ob_placed *b, const frame_pair *f, const axis_gaps *s, bool *crossing)
{
	frame_rates d;
	int open[AXES], n = 0, best = -1, touching = -1;
	double latest = -1, largest = 0, steadiest = INFINITY;
	const double never = ob_time_to_close(a, b, 1, 0), rest = f->rest;
	*crossing = false;
	for (int k = 0; k < AXES; k++)
		if (s->gap[k] - (k < FACES ? 0 : f->discount) > -rest)
			open[n++] = k;
	if (n == 0)
		return -1;
	if (n == 1)
		return open[0];
	frame_rates_init(&d, f, a, b);
	for (int k = 0; k < n; k++) {
		const int axis = open[k];
		double gap = s->gap[axis] - (axis < FACES ? 0 : f->discount);
		double rate = opening_rate(f, &d, axis);
		double time = ob_time_to_close(a, b, gap + rest, rate);
		if (time == never && axis < FACES && fabs(gap) <= rest) {
			*crossing |= touching >= 0 && face_cosine(f, touching, axis) < same_axis;
			if (fabs(rate) < steadiest || (fabs(rate) == steadiest && gap > s->gap[touching]))
				steadiest = fabs(rate), touching = axis;
		}
		if (time > latest || (time == latest && gap > largest))
			latest = time, largest = gap, best = axis;
	}
	return touching >= 0 ? touching : best;
}

// From b to a, across a face of one of them.
static ob_vec3 face_normal(const ob_placed *a, const ob_placed *b, int face)
{
	const ob_vec3 n = ob_column(face < 3 ? &a->r : &b->r, face % 3);
	return ob_dot(n, ob_sub(a->p, b->p)) < 0 ? ob_scale(n, -1) : n;
}

// From b to a, across an edge of each.
static ob_vec3 edge_normal(const ob_placed *a, const ob_placed *b, int edge)
{
	const ob_vec3 n = ob_cross(ob_column(&a->r, edge / 3), ob_column(&b->r, edge % 3)), d = ob_sub(b->p, a->p);
	return ob_scale(n, (ob_dot(n, d) > 0 ? -1 : 1) / ob_norm(n));
}

// Two edges: the nearest points of the lines that carry them.
static void edge_manifold(const ob_placed *a, const ob_placed *b, int edge, ob_manifold *m)
{
	int i = edge / 3, j = edge % 3;
	const ob_vec3 u = ob_column(&a->r, i), v = ob_column(&b->r, j), n = edge_normal(a, b, edge);
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
	polygon out;
	const double *x = axis ? p->w : p->u;
	bool beyond = false;
	for (int k = 0; k < p->n; k++)
		beyond |= sign * x[k] - limit > 0;
	if (!beyond)
		return;
	out.n = 0;
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

// Keeps the four points that span the largest area with one of the deepest among them.
static void reduce_to_four(polygon *p, double tie)
{
	const unsigned keep = ob_widest_four(p->u, p->w, p->z, p->n, tie);
	polygon out = { .n = 0 };
	for (int k = 0; k < p->n; k++)
		if (keep >> k & 1)
			polygon_put(&out, p->u[k], p->w[k], p->z[k]);
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

// What lies over a face, as seen along its normal or, unless edge is -1, along that of two edges: then the place where
// those cross is a corner of what is seen.
static void face_manifold(const ob_placed *a, const ob_placed *b, int face, int edge, double margin, ob_manifold *m)
{
	bool of_b = face >= 3;
	const ob_placed *ref = of_b ? b : a, *in = of_b ? a : b;
	int r = face % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3;
	double h[3] = { ref->size.x, ref->size.y, ref->size.z }, along[3] = { 0, 0, 1 };
	ob_vec3 n = ob_column(&ref->r, r), u = ob_column(&ref->r, r1), w = ob_column(&ref->r, r2);
	const double side = of_b ? 1 : -1;
	const ob_vec3 up = edge < 0 ? ob_sub(in->p, ref->p) : ob_scale(edge_normal(a, b, edge), side);
	if (ob_dot(n, up) < 0)
		n = ob_scale(n, -1);
	m->normal = ob_scale(edge < 0 ? n : up, side);
	if (edge >= 0)
		along[0] = ob_dot(up, u), along[1] = ob_dot(up, w), along[2] = ob_dot(up, n);
	polygon p;
	incident_face(ref, in, n, u, w, h[r], &p);
	for (int k = 0; k < p.n; k++) {
		p.z[k] /= along[2];
		p.u[k] -= p.z[k] * along[0];
		p.w[k] -= p.z[k] * along[1];
	}
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
		reduce_to_four(&p, same_depth * ob_min(ref->size.x, ob_min(ref->size.y, ref->size.z)));
	m->points = p.n;
	for (int k = 0; k < p.n; k++) {
		const double half = .5 * p.z[k];
		m->gap[k] = p.z[k];
		m->at[k] = ob_madd(ob_madd(ob_madd(ref->p, p.u[k] + half * along[0], u), p.w[k] + half * along[1], w),
				   h[r] + half * along[2], n);
	}
}

void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	frame_pair f;
	axis_gaps s;
	bool crossing;
	frame_pair_init(&f, a, b);
	find_face_gaps(&f, &s);
	out->points = 0;
	out->separation = s.largest_face;
	out->normal = face_normal(a, b, s.face);
	if (s.largest_face > margin + nearby * f.thin)
		return;
	find_edge_gaps(&f, &s);
	out->separation = ob_max(s.largest_face, s.largest_edge);
	if (s.largest_edge > s.largest_face)
		out->normal = edge_normal(a, b, s.edge);
	if (out->separation > margin)
		return;
	int axis = closing_last(a, b, &f, &s, &crossing);
	out->valid_path = crossing ? f.rest : INFINITY;
	if (crossing)
		return;
	if (axis < 0) {
		double more = f.discount - prefer_face_when_deep * s.largest_face;
		axis = s.largest_edge > s.largest_face + more ? FACES + s.edge : s.face;
	}
	bool edge = axis >= FACES;
	// Edges that meet nearly along a face's normal: with the place where they cross goes what else is about to meet
	// over the face, all of it along the edges' axis. Along the face's normal that place would run over the edges
	// as the boxes pass each other, and deeper in than its velocity says.
	int face = edge ? face_along(a, b, axis - FACES) : axis;
	if (face >= 0)
		face_manifold(a, b, face, edge ? axis - FACES : -1, margin, out);
	if (edge && (face < 0 || !out->points))
		edge_manifold(a, b, axis - FACES, out);
}
