// Contact manifold of two boxes: the axis that separates them, and the contact points along it. Three axes or four
// corners are computed side by side; lanes mix only in the search for the largest. For contact/kernel.c.
#ifndef OB_CONTACT_BOXES_H
#define OB_CONTACT_BOXES_H

#include <string.h>

#include "contact/pairs.h"
#include "contact/polytope.h"
#include "elementary/lanes.h"

// Data of the axis tests, in a's frame. Lane 3 is unused.
typedef struct frame_pair {
	lanes a[3], b[3]; // world components of a's axes, one axis a lane; of b's
	lanes c[3], q[3]; // components of b's axes in a's frame; absolute values
	lanes qt[3]; // transpose of q: a's axes in b's frame
	lanes t, tb; // m: b's centre from a's, along a's axes; along b's
	lanes ha, hb; // half extents, m
	double thin; // m: least thickness of both
	double rest; // m: penetration permitted at rest
	double discount; // m: an axis of edges must separate by this much more than a face's
} frame_pair;

// Rates of c (1/s), t and tb (m/s) of a frame_pair.
typedef struct frame_rates {
	double c[3][3], t[3], tb[3];
} frame_rates;

enum { FACES = 6, AXES = 15 }; // axis 0..2: faces of a; 3..5: of b; 6 + 3 i + j: edge i of a across edge j of b

// Separation along each axis (m). -infinity for nearly parallel edges: a face's axis gives the same.
typedef struct axis_gaps {
	lanes gap[AXES / 3]; // three axes each; -infinity in the last lane
	double largest_face, largest_edge;
	int face, edge; // axes of the largest gaps: faces 0 .. 5, edges 0 .. 8
} axis_gaps;

static inline lanes lanes_of_three(double x, double y, double z)
{
	return (lanes){ x, y, z, z };
}

// Index of the first bit that is set; "last" if none is, as after a NaN.
static inline int first_axis(unsigned bits, int last)
{
	return __builtin_ctz(bits | 1u << last);
}

static void frame_pair_init(frame_pair *f, const ob_placed *a, const ob_placed *b)
{
	const ob_vec3 apart = ob_sub(b->p, a->p), ha = a->size, hb = b->size;
	lanes ct[4] = { { 0 } };
	f->ha = lanes_of_three(ha.x, ha.y, ha.z);
	f->hb = lanes_of_three(hb.x, hb.y, hb.z);
	f->thin = 2 * ob_min(ob_min(ha.x, ob_min(ha.y, ha.z)), ob_min(hb.x, ob_min(hb.y, hb.z)));
	f->rest = ob_min(a->rest_depth, b->rest_depth);
	f->discount = ob_min(prefer_face * f->thin, f->rest);
	for (int r = 0; r < 3; r++) {
		f->a[r] = lanes_of_three(a->r.m[r][0], a->r.m[r][1], a->r.m[r][2]);
		f->b[r] = lanes_of_three(b->r.m[r][0], b->r.m[r][1], b->r.m[r][2]);
	}
	f->t = f->a[0] * apart.x + f->a[1] * apart.y + f->a[2] * apart.z;
	for (int i = 0; i < 3; i++) {
		f->c[i] = a->r.m[0][i] * f->b[0] + a->r.m[1][i] * f->b[1] + a->r.m[2][i] * f->b[2];
		f->q[i] = lanes_abs(f->c[i]);
		ct[i] = f->c[i];
	}
	lanes_transpose(ct);
	for (int j = 0; j < 3; j++)
		f->qt[j] = lanes_abs(ct[j]);
	f->tb = f->t[0] * f->c[0] + f->t[1] * f->c[1] + f->t[2] * f->c[2];
}

// Motion of b as seen from a, in a's frame. Both boxes move and turn.
static void frame_rates_init(frame_rates *d, const frame_pair *f, const ob_placed *a, const ob_placed *b)
{
	ob_vec3 apart = ob_sub(b->p, a->p), v = ob_sub(ob_sub(b->v, a->v), ob_cross(a->w, apart));
	ob_vec3 u = ob_rotate_back(&a->r, v), w = ob_rotate_back(&a->r, ob_sub(b->w, a->w));
	d->t[0] = u.x, d->t[1] = u.y, d->t[2] = u.z;
	for (int j = 0; j < 3; j++) {
		ob_vec3 turn = ob_cross(w, ob_v3(f->c[0][j], f->c[1][j], f->c[2][j]));
		d->c[0][j] = turn.x, d->c[1][j] = turn.y, d->c[2][j] = turn.z;
		d->tb[j] = 0;
		for (int i = 0; i < 3; i++)
			d->tb[j] += d->t[i] * f->c[i][j] + f->t[i] * d->c[i][j];
	}
}

static inline lanes without_last(lanes gap, lane_mask leave_out)
{
	return lanes_select(leave_out | (lane_mask){ 0, 0, 0, -1 }, lanes_of(-INFINITY), gap);
}

static void find_face_gaps(const frame_pair *f, axis_gaps *s)
{
	const lanes *q = f->q, *qt = f->qt;
	const lanes of_a = lanes_abs(f->t) - f->ha - (qt[0] * f->hb[0] + qt[1] * f->hb[1] + qt[2] * f->hb[2]),
		    of_b = lanes_abs(f->tb) - f->hb - (q[0] * f->ha[0] + q[1] * f->ha[1] + q[2] * f->ha[2]);
	const lane_mask none = { 0 };
	s->gap[0] = without_last(of_a, none);
	s->gap[1] = without_last(of_b, none);
	s->largest_face = lanes_largest(lanes_max(s->gap[0], s->gap[1]));
	const lanes most = lanes_of(s->largest_face);
	s->face = first_axis(lanes_bits(s->gap[0] == most) | lanes_bits(s->gap[1] == most) << 3, FACES - 1);
}

static void find_edge_gaps(const frame_pair *f, axis_gaps *s)
{
	const lanes hb1 = __builtin_shufflevector(f->hb, f->hb, 1, 2, 0, 3),
		    hb2 = __builtin_shufflevector(f->hb, f->hb, 2, 0, 1, 3);
	lanes *gap = s->gap + 2;
	for (int i = 0; i < 3; i++) {
		const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
		const lanes q1 = __builtin_shufflevector(f->q[i], f->q[i], 1, 2, 0, 3),
			    q2 = __builtin_shufflevector(f->q[i], f->q[i], 2, 0, 1, 3);
		const lanes l2 = 1 - f->c[i] * f->c[i];
		const lanes along = f->t[i2] * f->c[i1] - f->t[i1] * f->c[i2];
		const lanes radii = f->ha[i1] * f->q[i2] + f->ha[i2] * f->q[i1] + hb1 * q2 + hb2 * q1;
		gap[i] = without_last((lanes_abs(along) - radii) / lanes_sqrt(l2), l2 < parallel_edges);
	}
	s->largest_edge = lanes_largest(lanes_max(lanes_max(gap[0], gap[1]), gap[2]));
	const lanes most = lanes_of(s->largest_edge);
	s->edge = first_axis(lanes_bits(gap[0] == most) | lanes_bits(gap[1] == most) << 3 |
				     lanes_bits(gap[2] == most) << 6,
			     AXES - FACES - 1);
}

// d|c|/dt of b's axis j along a's axis i; the larger of its two values if c passes 0.
static double growth(const frame_pair *f, const frame_rates *d, int i, int j)
{
	return f->q[i][j] < 1e-9 ? fabs(d->c[i][j]) : f->c[i][j] > 0 ? d->c[i][j] : -d->c[i][j];
}

// Rate (m/s) at which the gap along an axis opens.
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

static double gap_along(const axis_gaps *s, int axis)
{
	return s->gap[axis / 3][axis % 3];
}

// Cosine between the normals of two faces.
static double face_cosine(const frame_pair *f, int k, int l)
{
	if (k / 3 == l / 3)
		return k == l;
	return k < 3 ? f->q[k][l - 3] : f->q[l][k - 3];
}

// Normal of a face of either box, from b to a.
static ob_vec3 face_normal(const ob_placed *a, const ob_placed *b, int face)
{
	const ob_vec3 n = ob_column(face < 3 ? &a->r : &b->r, face % 3);
	return ob_dot(n, ob_sub(a->p, b->p)) < 0 ? ob_scale(n, -1) : n;
}

// Normal across an edge of each box, from b to a.
static ob_vec3 edge_normal(const ob_placed *a, const ob_placed *b, int edge)
{
	const ob_vec3 n = ob_cross(ob_column(&a->r, edge / 3), ob_column(&b->r, edge % 3)), d = ob_sub(b->p, a->p);
	return ob_scale(n, (ob_dot(n, d) > 0 ? -1 : 1) / ob_norm(n));
}

static ob_vec3 normal_along(const ob_placed *a, const ob_placed *b, int axis)
{
	return axis < FACES ? face_normal(a, b, axis) : edge_normal(a, b, axis - FACES);
}

// Chooses an axis, among those that separate the boxes or along which they touch no deeper than at rest. The one that
// closes last is the one along which they will meet: as long as one stays open, nothing is hit along the others. So a
// box that slides over a seam of two coplanar faces does not hit the side of the next one. Among axes that never close,
// those of touching faces come first: something else holds the boxes there. Returns -1 if no axis separates. crossing:
// the boxes touch along two axes of faces that do not close; edge to edge, they may go on along either. together: two
// axes close last at the same instant; the boxes meet corner to corner, or with parallel edges.
static int closing_last(const ob_placed *a, const ob_placed *b, const frame_pair *f, const axis_gaps *s, bool *crossing,
			bool *together)
{
	frame_rates d;
	int best = -1, touching = -1;
	unsigned open = 0;
	double latest = -1, largest = 0, steadiest = INFINITY, fastest = 0;
	const double never = ob_time_to_close(a, b, 1, 0), rest = f->rest, touch = rest + same_gap * f->thin;
	*crossing = *together = false;
	for (int k = 0; k < AXES / 3; k++)
		open |= (lanes_bits(s->gap[k] - (3 * k < FACES ? 0 : f->discount) > -touch) & 7u) << 3 * k;
	if (open == 0)
		return -1;
	if ((open & (open - 1)) == 0)
		return __builtin_ctz(open);
	frame_rates_init(&d, f, a, b);
	for (; open; open &= open - 1) {
		const int axis = __builtin_ctz(open);
		double gap = gap_along(s, axis) - (axis < FACES ? 0 : f->discount);
		double rate = opening_rate(f, &d, axis);
		double time = ob_time_to_close(a, b, gap + rest, rate);
		if (time == never && axis < FACES && fabs(gap) <= rest) {
			*crossing |= touching >= 0 && face_cosine(f, touching, axis) < same_axis;
			if (touching < 0 || fabs(rate) < steadiest ||
			    (fabs(rate) == steadiest && gap > gap_along(s, touching)))
				steadiest = fabs(rate), touching = axis;
		}
		fastest = ob_max(fastest, -rate);
		if (best >= 0 && latest < never && fabs(time - latest) * fastest <= same_gap * f->thin)
			*together |= ob_dot(normal_along(a, b, best), normal_along(a, b, axis)) < same_axis;
		else if (time > latest)
			*together = false;
		if (time > latest || (time == latest && gap > largest))
			latest = time, largest = gap, best = axis;
	}
	return touching >= 0 ? touching : best;
}

// Manifold of two edges: one point, midway between their nearest points.
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

// Convex polygon over the plane of the reference face. A corner: u and w in the plane, z above it (m).
enum { POLYGON_MAX = 8 };
typedef struct polygon {
	lanes corner[POLYGON_MAX + 1]; // with room for one that is dropped
	int n;
} polygon;

static inline void polygon_put(polygon *p, lanes corner, bool keep)
{
	p->corner[p->n] = corner;
	p->n += keep && p->n < POLYGON_MAX;
}

// Clips the polygon at the limit on one side (sign) of one face axis (0 = u, 1 = w).
static void clip(polygon *p, int axis, double sign, double limit)
{
	double f[POLYGON_MAX]; // distance beyond the limit
	unsigned above = 0, below = 0;
	for (int k = 0; k < p->n; k++) {
		f[k] = sign * p->corner[k][axis] - limit;
		above |= (unsigned)(f[k] > 0) << k;
		below |= (unsigned)(f[k] < 0) << k;
	}
	if (!above)
		return;
	const unsigned next_above = above >> 1 | (above & 1) << (p->n - 1),
		       next_below = below >> 1 | (below & 1) << (p->n - 1),
		       crosses = (above & next_below) | (below & next_above);
	polygon out;
	out.n = 0;
	for (int k = 0; k < p->n; k++) {
		polygon_put(&out, p->corner[k], !(above >> k & 1));
		if (crosses >> k & 1) {
			const int next = k + 1 < p->n ? k + 1 : 0;
			const double s = f[k] / (f[k] - f[next]);
			polygon_put(&out, p->corner[k] + s * (p->corner[next] - p->corner[k]), true);
		}
	}
	p->n = out.n;
	for (int k = 0; k < out.n; k++)
		p->corner[k] = out.corner[k];
}

// Keeps the four points that span the largest area with one of the deepest among them.
static void reduce_to_four(polygon *p, double tie)
{
	double u[POLYGON_MAX], w[POLYGON_MAX], z[POLYGON_MAX];
	for (int k = 0; k < p->n; k++)
		u[k] = p->corner[k][0], w[k] = p->corner[k][1], z[k] = p->corner[k][2];
	const unsigned keep = ob_widest_four(u, w, z, p->n, tie);
	const int n = p->n;
	p->n = 0;
	for (int k = 0; k < n; k++)
		polygon_put(p, p->corner[k], keep >> k & 1);
}

// Computes the corners of the incident face, the face of box "in" that looks most against n, from the centre of the
// reference box. of: components of the axes of "in".
static void incident_face(const ob_placed *ref, const ob_placed *in, const lanes *of, ob_vec3 n, lanes corner[3])
{
	const lanes c = n.x * of[0] + n.y * of[1] + n.z * of[2], far = lanes_abs(c);
	const double h[3] = { in->size.x, in->size.y, in->size.z };
	int k = far[1] > far[0] ? 1 : 0;
	k = far[2] > far[k] ? 2 : k;
	const int e1 = (k + 1) % 3, e2 = (k + 2) % 3;
	const ob_vec3 centre = ob_madd(ob_sub(in->p, ref->p), (c[k] > 0 ? -1 : 1) * h[k], ob_column(&in->r, k));
	const ob_vec3 f1 = ob_scale(ob_column(&in->r, e1), h[e1]), f2 = ob_scale(ob_column(&in->r, e2), h[e2]);
	const lanes s1 = { 1, -1, -1, 1 }, s2 = { 1, 1, -1, -1 };
	corner[0] = centre.x + s1 * f1.x + s2 * f2.x;
	corner[1] = centre.y + s1 * f1.y + s2 * f2.y;
	corner[2] = centre.z + s1 * f1.z + s2 * f2.z;
}

static lanes dot_along(const lanes *x, ob_vec3 along)
{
	return x[0] * along.x + x[1] * along.y + x[2] * along.z;
}

// Returns the face whose normal is nearest to the axis of two edges, if it is near enough; otherwise -1.
static int face_along(const frame_pair *f, const ob_placed *a, const ob_placed *b, int edge)
{
	const ob_vec3 n = ob_cross(ob_column(&a->r, edge / 3), ob_column(&b->r, edge % 3));
	const lanes of_a = lanes_abs(dot_along(f->a, n)), of_b = lanes_abs(dot_along(f->b, n));
	const double most = lanes_largest(lanes_max(of_a, of_b));
	if (!(most > along_face * ob_norm(n)))
		return -1;
	return first_axis(lanes_bits(of_a == most) | lanes_bits(of_b == most) << 3, FACES - 1);
}

// Manifold over a face: the incident face, projected and clipped. It is projected along the face's normal or, unless
// edge is -1, along the axis of two edges; their crossing is then a corner of the projection.
static void face_manifold(const frame_pair *f, const ob_placed *a, const ob_placed *b, int face, int edge,
			  double margin, ob_manifold *m)
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
	lanes corner[3];
	incident_face(ref, in, of_b ? f->a : f->b, n, corner);
	const lanes z = (dot_along(corner, n) - h[r]) / along[2];
	polygon p = { { dot_along(corner, u) - z * along[0], dot_along(corner, w) - z * along[1], z }, 4 };
	lanes_transpose(p.corner);
	clip(&p, 0, 1, h[r1]);
	clip(&p, 0, -1, h[r1]);
	clip(&p, 1, 1, h[r2]);
	clip(&p, 1, -1, h[r2]);
	const int clipped = p.n;
	p.n = 0;
	for (int k = 0; k < clipped; k++)
		polygon_put(&p, p.corner[k], p.corner[k][2] <= margin);
	if (p.n > 4)
		reduce_to_four(&p, same_depth * ob_min(ref->size.x, ob_min(ref->size.y, ref->size.z)));
	lanes_transpose(p.corner);
	const lanes gap = p.corner[2], half = .5 * gap, pu = p.corner[0] + half * along[0],
		    pw = p.corner[1] + half * along[1], pn = h[r] + half * along[2];
	lanes at[4] = { ref->p.x + pu * u.x + pw * w.x + pn * n.x, ref->p.y + pu * u.y + pw * w.y + pn * n.y,
			ref->p.z + pu * u.z + pw * w.z + pn * n.z };
	lanes_transpose(at);
	m->points = p.n;
	for (int k = 0; k < p.n; k++) {
		m->gap[k] = gap[k];
		m->at[k] = ob_v3(at[k][0], at[k][1], at[k][2]);
	}
}

static void boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	frame_pair f;
	axis_gaps s;
	bool crossing = false, together = false;
	int axis = -1;
	frame_pair_init(&f, a, b);
	find_face_gaps(&f, &s);
	s.largest_edge = -INFINITY;
	if (s.largest_face <= margin || s.largest_face <= margin + nearby * f.thin) // for any size
		find_edge_gaps(&f, &s);
	out->points = 0;
	out->separation = ob_max(s.largest_face, s.largest_edge);
	if (out->separation <= margin) {
		axis = closing_last(a, b, &f, &s, &crossing, &together);
		out->valid_path = crossing ? f.rest : INFINITY;
	}
	if (together && !crossing) {
		ob_manifold_polytopes(a, b, margin, out);
		return;
	}
	if (out->separation > margin || crossing) {
		out->normal = normal_along(a, b, s.largest_edge > s.largest_face ? FACES + s.edge : s.face);
		return;
	}
	if (axis < 0) {
		double more = f.discount - prefer_face_when_deep * s.largest_face;
		axis = s.largest_edge > s.largest_face + more ? FACES + s.edge : s.face;
	}
	bool edge = axis >= FACES;
	// An axis of edges near a face's normal: the crossing of the edges, and other points over the face that are
	// about to touch, are all found along the edges' axis. Along the face's normal the crossing would run over the
	// edges as the boxes pass each other, and penetrate deeper than its velocity says.
	int face = edge ? face_along(&f, a, b, axis - FACES) : axis;
	if (face >= 0)
		face_manifold(&f, a, b, face, edge ? axis - FACES : -1, margin, out);
	if (edge && (face < 0 || !out->points))
		edge_manifold(a, b, axis - FACES, out);
}

#endif
