// Contacts of hulls with planes, boxes and hulls. The decisions are those for boxes (boxes.h), for any polyhedron. Axes
// are the normals of faces, and those of two edges that are a face of the Minkowski difference (the arcs of their
// normals cross: Gregorius 2013). Among several separating axes the one that closes last decides. A face's points are
// the other's face, clipped. The separation is that of the best axis: a lower bound of the distance.
#include "contact/polytope.h"

#include <string.h>

#include "contact/pairs.h"
#include "elementary/elementary.h"
#include "shape/shape.h"

static const double crossing_faces = .5; // cosine: faces with a smaller one cross
static const double as_low = 2e-9; // relative to the radius: corners that count as equally low

// ---- boxes and hulls alike

// Topology of a box: corner k has the signs of the bits of k.
static const ob_hull box_topology = {
	.corners = 8,
	.faces = 6,
	.edges = 12,
	.normal = { { -1, 0, 0 }, { 1, 0, 0 }, { 0, -1, 0 }, { 0, 1, 0 }, { 0, 0, -1 }, { 0, 0, 1 } },
	.first = { 0, 4, 8, 12, 16, 20, 24 },
	.loop = { 0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6 },
	.edge = { { 0, 1, 2, 4 },
		  { 2, 3, 4, 3 },
		  { 4, 5, 5, 2 },
		  { 6, 7, 3, 5 },
		  { 0, 2, 4, 0 },
		  { 1, 3, 1, 4 },
		  { 4, 6, 0, 5 },
		  { 5, 7, 5, 1 },
		  { 0, 4, 0, 2 },
		  { 1, 5, 2, 1 },
		  { 2, 6, 3, 0 },
		  { 3, 7, 1, 3 } },
};

void ob_polytope_init(ob_polytope *x, const ob_placed *from, ob_vec3 origin)
{
	x->placed = from;
	x->centre = ob_sub(from->p, origin);
	x->radius = ob_polytope_radius(from);
	if (!from->hull) {
		const ob_vec3 h = from->size;
		x->shape = &box_topology;
		x->inner = ob_min(h.x, ob_min(h.y, h.z));
		x->thin = 2 * x->inner;
		x->corner = x->box_corner;
		x->offset = x->box_offset;
		for (uint32_t k = 0; k < 8; k++)
			x->box_corner[k] = ob_box_corner(h, k);
		for (int f = 0; f < 6; f++)
			x->box_offset[f] = f < 2 ? h.x : f < 4 ? h.y : h.z;
	} else {
		x->shape = from->hull;
		x->inner = from->hull->inner;
		x->thin = from->hull->thickness;
		x->corner = from->hull->corner;
		x->offset = from->hull->offset;
	}
}

static ob_vec3 to_world(const ob_polytope *x, ob_vec3 direction)
{
	return ob_rotate(&x->placed->r, direction);
}

static ob_vec3 to_local(const ob_polytope *x, ob_vec3 direction)
{
	return ob_rotate_back(&x->placed->r, direction);
}

static ob_vec3 corner_of(const ob_polytope *x, uint32_t k)
{
	return ob_add(x->centre, to_world(x, x->corner[k]));
}

static ob_vec3 normal_of(const ob_polytope *x, uint32_t face)
{
	return to_world(x, x->shape->normal[face]);
}

// Position along n of the lowest corner, from the centre (m). n: in the shape's frame. Keeps four minima side by side;
// a single one would wait for each comparison.
static double lowest_along(const ob_polytope *x, ob_vec3 n)
{
	const ob_vec3 *c = x->corner;
	const uint32_t corners = x->shape->corners; // four at least
	double low[4] = { INFINITY, INFINITY, INFINITY, INFINITY };
	for (uint32_t k = 0; k + 4 <= corners; k += 4)
		for (uint32_t i = 0; i < 4; i++) {
			const double at = ob_dot(n, c[k + i]);
			low[i] = at < low[i] ? at : low[i];
		}
	for (uint32_t i = 0; i < 4; i++) {
		const double at = ob_dot(n, c[corners - 4 + i]);
		low[i] = at < low[i] ? at : low[i];
	}
	return ob_min(ob_min(low[0], low[1]), ob_min(low[2], low[3]));
}

// Returns the corner that is lowest along n. low: result of lowest_along.
static uint32_t lowest_corner(const ob_polytope *x, ob_vec3 n, double low)
{
	uint32_t k = 0;
	while (k + 1 < x->shape->corners && ob_dot(n, x->corner[k]) > low)
		k++;
	return k;
}

static ob_vec3 velocity_at(const ob_polytope *x, ob_vec3 at)
{
	return ob_add(x->placed->v, ob_cross(x->placed->w, ob_sub(at, x->centre)));
}

// ---- axes

enum { OPEN_MAX = 32 };

// Axis along which the shapes are apart, or overlap least.
typedef struct axis {
	double gap; // m
	bool is_face;
	bool of_b; // the face is one of b's
	uint32_t face;
	uint32_t edge_a, edge_b;
	ob_vec3 normal; // unit, from b to a
} axis;

typedef struct axes {
	axis face, edge; // the best of each kind
	int open; // number of axes that separate, or along which the shapes touch no deeper than at rest
	axis list[OPEN_MAX];
} axes;

// Adds an axis; a full list keeps those with the largest gaps.
static void add_open(axes *s, const axis *x)
{
	if (s->open < OPEN_MAX) {
		s->list[s->open++] = *x;
		return;
	}
	int least = 0;
	for (int k = 1; k < OPEN_MAX; k++)
		if (s->list[k].gap < s->list[least].gap)
			least = k;
	if (x->gap > s->list[least].gap)
		s->list[least] = *x;
}

// Heights (m) of two points of one shape above the faces of the other. They bound the gap of an axis along a face's
// normal: it is at most the point's height, and at most the centre's height less the radius of the ball inside.
typedef struct heights {
	double of_centre[OB_HULL_FACES_MAX];
	double of_point[OB_HULL_FACES_MAX]; // lowest corner above the face that looks most at the centre
} heights;

// Returns the face above which the point is highest. point: in the frame of the faces.
static uint32_t find_heights(const ob_polytope *of, ob_vec3 point, double *height)
{
	const uint32_t faces = of->shape->faces;
	double highest = -INFINITY;
	uint32_t f = 0;
	for (uint32_t k = 0; k < faces; k++)
		height[k] = ob_dot(of->shape->normal[k], point) - of->offset[k];
	for (uint32_t k = 0; k < faces; k++)
		highest = height[k] > highest ? height[k] : highest;
	while (f + 1 < faces && height[f] < highest)
		f++;
	return f;
}

static void add_face(axes *s, const ob_polytope *of, bool of_b, double rest, uint32_t f, double gap)
{
	const ob_vec3 n = normal_of(of, f);
	const axis x = { .gap = gap, .is_face = true, .of_b = of_b, .face = f, .normal = of_b ? n : ob_scale(n, -1) };
	if (gap > s->face.gap)
		s->face = x;
	if (gap > -rest)
		add_open(s, &x);
}

// Tries the faces of one shape, beginning with the one that looks most at the other's centre.
static void try_faces(axes *s, const ob_polytope *of, const ob_polytope *other, bool of_b, double rest, heights *h)
{
	const ob_vec3 d = to_local(of, ob_sub(other->centre, of->centre));
	const uint32_t first = find_heights(of, d, h->of_centre);
	const ob_vec3 down = to_local(other, normal_of(of, first));
	const double low = lowest_along(other, down);
	const uint32_t corner = lowest_corner(other, down, low);
	find_heights(of, ob_add(d, to_local(of, to_world(other, other->corner[corner]))), h->of_point);
	add_face(s, of, of_b, rest, first, h->of_centre[first] + low);
	double least = ob_min(s->face.gap, -rest);
	for (uint32_t f = 0; f < of->shape->faces; f++) {
		if (f == first || h->of_point[f] < least || h->of_centre[f] - other->inner < least)
			continue;
		add_face(s, of, of_b, rest, f,
			 h->of_centre[f] + lowest_along(other, to_local(other, normal_of(of, f))));
		least = ob_min(s->face.gap, -rest);
	}
}

// Edge with an arc of normals that comes near enough to the other shape.
typedef struct near_edge {
	uint32_t edge;
	ob_vec3 from, way; // m: one end, and the vector to the other
	ob_vec3 left, right; // normals of its faces
} near_edge;

// True if a point is higher than "least" (m) above an edge, along some normal of its arc. left, right: heights above
// the edge's faces, at the ends of the arc. In between, the height runs as a cosine does. cosine: of the arc.
static bool is_above_edge(double left, double right, double cosine, double least)
{
	if (left >= least || right >= least)
		return true;
	return right > cosine * left && left > cosine * right &&
	       (least <= 0 ||
		left * left + right * right - 2 * cosine * left * right >= least * least * (1 - cosine * cosine));
}

// Collects edges that may be part of an axis with a gap of "needed" (m). A point is not above an edge if it is in front
// of neither of its faces.
static uint32_t collect_edges(const ob_polytope *x, const ob_polytope *other, double needed, const heights *h,
			      near_edge *out)
{
	enum { POINT = 1, CENTRE = 2 };
	const double slack = 1e-9 * (x->radius + other->radius), of_point = needed - slack,
		     of_centre = needed + other->inner - slack, point_from = ob_min(of_point, 0),
		     centre_from = ob_min(of_centre, 0);
	uint8_t in_front[OB_HULL_FACES_MAX], near[OB_HULL_EDGES_MAX];
	uint32_t n = 0, nears = 0;
	for (uint32_t f = 0; f < x->shape->faces; f++)
		in_front[f] = (uint8_t)((h->of_point[f] >= point_from ? POINT : 0) |
					(h->of_centre[f] >= centre_from ? CENTRE : 0));
	for (uint32_t k = 0; k < x->shape->edges; k++) {
		near[nears] = (uint8_t)k;
		nears += (in_front[x->shape->edge[k].left] | in_front[x->shape->edge[k].right]) == (POINT | CENTRE);
	}
	for (uint32_t i = 0; i < nears; i++) {
		const ob_hull_edge *e = &x->shape->edge[near[i]];
		const ob_vec3 left = x->shape->normal[e->left], right = x->shape->normal[e->right];
		const double cosine = ob_dot(left, right);
		if (!is_above_edge(h->of_point[e->left], h->of_point[e->right], cosine, of_point) ||
		    !is_above_edge(h->of_centre[e->left], h->of_centre[e->right], cosine, of_centre))
			continue;
		out[n++] = (near_edge){ near[i], corner_of(x, e->from),
					to_world(x, ob_sub(x->corner[e->to], x->corner[e->from])), to_world(x, left),
					to_world(x, right) };
	}
	return n;
}

static void try_edges(axes *s, const ob_polytope *a, const ob_polytope *b, double needed, double rest, double discount,
		      const heights *heights_a, const heights *heights_b)
{
	near_edge of_a[OB_HULL_EDGES_MAX], of_b[OB_HULL_EDGES_MAX];
	const uint32_t na = collect_edges(a, b, needed, heights_a, of_a);
	const uint32_t nb = na ? collect_edges(b, a, needed, heights_b, of_b) : 0;
	for (uint32_t i = 0; i < na; i++)
		for (uint32_t j = 0; j < nb; j++) {
			const near_edge *ea = &of_a[i], *eb = &of_b[j];
			const double bl = ob_dot(eb->left, ea->way), br = ob_dot(eb->right, ea->way);
			if (bl * br >= 0)
				continue;
			const double al = ob_dot(ea->left, eb->way), ar = ob_dot(ea->right, eb->way);
			if (al * ar >= 0 || bl * ar >= 0)
				continue;
			ob_vec3 n = ob_cross(ea->way, eb->way);
			const double l2 = ob_norm2(n);
			if (l2 < parallel_edges * ob_norm2(ea->way) * ob_norm2(eb->way))
				continue;
			n = ob_scale(n, (ob_dot(n, ob_add(ea->left, ea->right)) > 0 ? -1 : 1) / sqrt(l2));
			const axis x = { .gap = ob_dot(n, ob_sub(ea->from, eb->from)),
					 .edge_a = ea->edge,
					 .edge_b = eb->edge,
					 .normal = n };
			if (x.gap > s->edge.gap)
				s->edge = x;
			if (x.gap - discount > -rest)
				add_open(s, &x);
		}
}

// ---- choice of the axis

// Rate (m/s) at which the gap of a face opens: the least rate of the other shape's lowest corners.
static double face_rate(const ob_polytope *of, const ob_polytope *other, ob_vec3 n)
{
	const ob_vec3 l = to_local(other, n);
	const double low = lowest_along(other, l) + as_low * other->radius;
	double rate = INFINITY;
	for (uint32_t k = 0; k < other->shape->corners; k++) {
		if (ob_dot(l, other->corner[k]) > low)
			continue;
		const ob_vec3 x = corner_of(other, k);
		rate = ob_min(rate, ob_dot(n, ob_sub(velocity_at(other, x), velocity_at(of, x))));
	}
	return rate;
}

// Finds the nearest points of the lines that carry two edges or, if limited, of the edges themselves.
static void nearest_on_edges(const ob_polytope *a, const ob_polytope *b, const axis *x, bool limited, ob_vec3 *xa,
			     ob_vec3 *xb)
{
	const ob_hull_edge *ea = &a->shape->edge[x->edge_a], *eb = &b->shape->edge[x->edge_b];
	const ob_vec3 pa = corner_of(a, ea->from), pb = corner_of(b, eb->from), u = ob_sub(corner_of(a, ea->to), pa),
		      v = ob_sub(corner_of(b, eb->to), pb), w = ob_sub(pa, pb);
	const double uu = ob_norm2(u), vv = ob_norm2(v), uv = ob_dot(u, v), uw = ob_dot(u, w), vw = ob_dot(v, w);
	const double det = uu * vv - uv * uv;
	double s = (uv * vw - uw * vv) / det, t = (vw * uu - uv * uw) / det;
	if (limited) {
		s = ob_max(0, ob_min(1, s));
		t = ob_max(0, ob_min(1, t));
	}
	*xa = ob_madd(pa, s, u);
	*xb = ob_madd(pb, t, v);
}

static double opening_rate(const ob_polytope *a, const ob_polytope *b, const axis *x)
{
	ob_vec3 xa, xb;
	if (x->is_face)
		return x->of_b ? face_rate(b, a, normal_of(b, x->face)) : face_rate(a, b, normal_of(a, x->face));
	nearest_on_edges(a, b, x, false, &xa, &xb);
	return ob_dot(x->normal, ob_sub(velocity_at(a, xa), velocity_at(b, xb)));
}

// Chooses an axis as between boxes: the one that closes last, but first a touching face that does not close. Returns
// NULL if no axis separates. crossing: the shapes touch along two crossing faces that do not close. together: the sum of
// the normals of axes that close last at the same instant; otherwise 0.
static const axis *closing_last(const ob_polytope *a, const ob_polytope *b, const axes *s, double rest, double discount,
				bool *crossing, ob_vec3 *together)
{
	const axis *best = NULL, *touching = NULL;
	double latest = -1, largest = 0, steadiest = INFINITY, all[OPEN_MAX], fastest = 0;
	const double never = ob_time_to_close(a->placed, b->placed, 1, 0), thin = ob_min(a->thin, b->thin);
	*crossing = false, *together = ob_v3(0, 0, 0);
	if (s->open <= 1)
		return s->open ? &s->list[0] : NULL;
	for (int k = 0; k < s->open; k++) {
		const axis *x = &s->list[k];
		const double gap = x->gap - (x->is_face ? 0 : discount), rate = opening_rate(a, b, x);
		const double time = all[k] = ob_time_to_close(a->placed, b->placed, gap + rest, rate);
		if (time == never && x->is_face && fabs(gap) <= rest) {
			*crossing |= touching && fabs(ob_dot(touching->normal, x->normal)) < crossing_faces;
			if (fabs(rate) < steadiest || (fabs(rate) == steadiest && gap > touching->gap))
				steadiest = fabs(rate), touching = x;
		}
		fastest = ob_max(fastest, -rate);
		if (time > latest || (time == latest && gap > largest))
			latest = time, largest = gap, best = x;
	}
	for (int k = 0; latest < never && fastest > 0 && k < s->open; k++)
		if ((latest - all[k]) * fastest <= same_gap * thin)
			*together = ob_add(*together, s->list[k].normal);
	return touching ? touching : best;
}

// ---- points

static void polygon_put(ob_polygon *p, double u, double w, double z)
{
	if (p->n < OB_POLYGON_MAX) {
		p->u[p->n] = u, p->w[p->n] = w, p->z[p->n] = z;
		p->n++;
	}
}

static void polygon_drop(ob_polygon *p, int k)
{
	for (p->n--; k < p->n; k++)
		p->u[k] = p->u[k + 1], p->w[k] = p->w[k + 1], p->z[k] = p->z[k + 1];
}

// Twice the area of the triangle of a point and its neighbours.
static double corner_area(const ob_polygon *p, int k)
{
	const int i = k ? k - 1 : p->n - 1, j = k + 1 < p->n ? k + 1 : 0;
	return fabs((p->u[i] - p->u[k]) * (p->w[j] - p->w[k]) - (p->u[j] - p->u[k]) * (p->w[i] - p->w[k]));
}

// Reduces many points to eight: drops those that span least, but keeps one of the deepest.
static void reduce_to_eight(ob_polygon *p, double tie)
{
	enum { FEW = 8 };
	while (p->n > FEW) {
		double deepest = INFINITY, least = INFINITY;
		int deep = 0, drop = -1;
		for (int k = 0; k < p->n; k++)
			deepest = ob_min(deepest, p->z[k]);
		for (int k = 0; k < p->n; k++)
			deep += p->z[k] <= deepest + tie;
		for (int k = 0; k < p->n; k++) {
			const double area = corner_area(p, k);
			if (area < least && (deep > 1 || p->z[k] > deepest + tie))
				least = area, drop = k;
		}
		polygon_drop(p, drop < 0 ? 0 : drop);
	}
}

unsigned ob_widest_four(const double *u, const double *w, const double *z, int n, double tie)
{
	double deepest = INFINITY, largest = -1;
	unsigned deep = 0, keep = 0;
	for (int k = 0; k < n; k++)
		deepest = ob_min(deepest, z[k]);
	for (int k = 0; k < n; k++)
		deep |= (unsigned)(z[k] <= deepest + tie) << k;
	for (int i = 0; i < n; i++)
		for (int j = i + 1; j < n; j++)
			for (int k = j + 1; k < n; k++)
				for (int l = k + 1; l < n; l++) {
					const unsigned four = 1u << i | 1u << j | 1u << k | 1u << l;
					const double area =
						fabs((u[k] - u[i]) * (w[l] - w[j]) - (w[k] - w[i]) * (u[l] - u[j]));
					if ((four & deep) && area > largest)
						largest = area, keep = four;
				}
	return keep;
}

// Keeps the four points that span the largest area with one of the deepest among them.
static void reduce_to_four(ob_polygon *p, double tie)
{
	if (p->n <= 4)
		return;
	reduce_to_eight(p, tie);
	const unsigned keep = ob_widest_four(p->u, p->w, p->z, p->n, tie);
	for (int k = p->n - 1; k >= 0; k--)
		if (!(keep >> k & 1))
			polygon_drop(p, k);
}

// Orders scattered points by their angle about the middle: a polygon, as far as they make one.
static void order_round_middle(ob_polygon *p)
{
	double mu = 0, mw = 0, angle[OB_POLYGON_MAX];
	for (int k = 0; k < p->n; k++)
		mu += p->u[k] / p->n, mw += p->w[k] / p->n;
	for (int k = 0; k < p->n; k++) {
		const double u = p->u[k], w = p->w[k], z = p->z[k], turn = ob_atan2(w - mw, u - mu);
		int at = k;
		for (; at > 0 && angle[at - 1] > turn; at--) {
			angle[at] = angle[at - 1];
			p->u[at] = p->u[at - 1], p->w[at] = p->w[at - 1], p->z[at] = p->z[at - 1];
		}
		angle[at] = turn, p->u[at] = u, p->w[at] = w, p->z[at] = z;
	}
}

void ob_polygon_reduce(ob_polygon *p, double band)
{
	double low[4] = { INFINITY, INFINITY, INFINITY, INFINITY };
	if (p->n <= 4)
		return;
	for (int k = 0; k < p->n; k++) {
		double z = p->z[k];
		for (int i = 0; i < 4; i++)
			if (z < low[i]) {
				const double x = low[i];
				low[i] = z, z = x;
			}
	}
	const double highest = ob_max(low[3], low[0] + band);
	for (int k = p->n - 1; k >= 0; k--)
		if (p->z[k] > highest)
			polygon_drop(p, k);
	if (p->n > 4)
		order_round_middle(p);
	reduce_to_four(p, band);
}

// Clips p: keeps the part on the inner side of the line through (u, w) across the outward direction (nu, nw).
static void clip(ob_polygon *p, double u, double w, double nu, double nw)
{
	ob_polygon out;
	bool beyond = false;
	for (int k = 0; k < p->n; k++)
		beyond |= nu * (p->u[k] - u) + nw * (p->w[k] - w) > 0;
	if (!beyond)
		return;
	out.n = 0;
	for (int k = 0; k < p->n; k++) {
		const int next = k + 1 < p->n ? k + 1 : 0;
		const double f = nu * (p->u[k] - u) + nw * (p->w[k] - w),
			     g = nu * (p->u[next] - u) + nw * (p->w[next] - w);
		if (f <= 0)
			polygon_put(&out, p->u[k], p->w[k], p->z[k]);
		if ((f < 0 && g > 0) || (f > 0 && g < 0)) {
			const double s = f / (f - g);
			polygon_put(&out, p->u[k] + s * (p->u[next] - p->u[k]), p->w[k] + s * (p->w[next] - p->w[k]),
				    p->z[k] + s * (p->z[next] - p->z[k]));
		}
	}
	p->n = out.n;
	memcpy(p->u, out.u, (size_t)out.n * sizeof *p->u);
	memcpy(p->w, out.w, (size_t)out.n * sizeof *p->w);
	memcpy(p->z, out.z, (size_t)out.n * sizeof *p->z);
}

// Returns the incident face: among those at the lowest corners along n, the one that looks most against n.
static uint32_t incident_face(const ob_polytope *in, ob_vec3 n)
{
	const ob_vec3 l = to_local(in, n);
	const double low = lowest_along(in, l) + as_low * in->radius;
	uint64_t lowest = 0;
	uint32_t best = 0;
	double least = INFINITY;
	for (uint32_t k = 0; k < in->shape->corners; k++)
		lowest |= (uint64_t)(ob_dot(l, in->corner[k]) <= low) << k;
	for (uint32_t f = 0; f < in->shape->faces; f++) {
		const double c = ob_dot(l, in->shape->normal[f]);
		bool there = false;
		for (uint32_t k = in->shape->first[f]; c < least && k < in->shape->first[f + 1]; k++)
			there |= lowest >> in->shape->loop[k] & 1;
		if (there)
			least = c, best = f;
	}
	return best;
}

// Returns the face of an edge that looks most against n.
static uint32_t incident_face_of_edge(const ob_polytope *in, uint32_t edge, ob_vec3 n)
{
	const ob_hull_edge *e = &in->shape->edge[edge];
	return ob_dot(normal_of(in, e->right), n) < ob_dot(normal_of(in, e->left), n) ? e->right : e->left;
}

// Manifold over a face: the incident face, projected along the axis and clipped. The axis is the face's normal, or that
// of two edges, one of this face; their crossing is then a corner of the projection.
static void face_manifold(const ob_polytope *ref, const ob_polytope *in, const axis *x, uint32_t face, bool of_b,
			  ob_vec3 origin, double margin, ob_manifold *m)
{
	const ob_hull *top = ref->shape;
	const uint32_t first = top->first[face], end = top->first[face + 1];
	const ob_vec3 n = normal_of(ref, face), base = corner_of(ref, top->loop[first]);
	const ob_vec3 up = x->is_face ? n : ob_scale(x->normal, of_b ? 1 : -1);
	const uint32_t incident =
		x->is_face ? incident_face(in, n) : incident_face_of_edge(in, of_b ? x->edge_a : x->edge_b, n);
	ob_vec3 u = ob_sub(corner_of(ref, top->loop[first + 1]), base);
	u = ob_scale(u, 1 / ob_norm(u));
	const ob_vec3 w = ob_cross(n, u);
	const double along[3] = { x->is_face ? 0 : ob_dot(up, u), x->is_face ? 0 : ob_dot(up, w),
				  x->is_face ? 1 : ob_dot(up, n) };
	ob_polygon p;
	p.n = 0;
	for (uint32_t k = in->shape->first[incident]; k < in->shape->first[incident + 1]; k++) {
		const ob_vec3 at = ob_sub(corner_of(in, in->shape->loop[k]), base);
		const double z = ob_dot(at, n) / along[2];
		polygon_put(&p, ob_dot(at, u) - z * along[0], ob_dot(at, w) - z * along[1], z);
	}
	ob_vec3 from = { 0, 0, 0 };
	for (uint32_t k = first; k < end && p.n; k++) {
		const ob_vec3 to = ob_sub(corner_of(ref, top->loop[k + 1 < end ? k + 1 : first]), base);
		const ob_vec3 way = ob_sub(to, from);
		clip(&p, ob_dot(from, u), ob_dot(from, w), ob_dot(way, w), -ob_dot(way, u));
		from = to;
	}
	for (int k = p.n - 1; k >= 0; k--)
		if (!(p.z[k] <= margin))
			polygon_drop(&p, k);
	reduce_to_four(&p, same_depth * .5 * ref->thin);
	m->normal = ob_scale(up, of_b ? 1 : -1);
	m->points = p.n;
	for (int k = 0; k < p.n; k++) {
		const ob_vec3 on = ob_madd(ob_madd(base, p.u[k], u), p.w[k], w);
		m->gap[k] = p.z[k];
		m->at[k] = ob_add(origin, ob_madd(on, .5 * p.z[k], up));
	}
}

static void edge_manifold(const ob_polytope *a, const ob_polytope *b, const axis *x, ob_vec3 origin, ob_manifold *m)
{
	ob_vec3 xa, xb;
	nearest_on_edges(a, b, x, true, &xa, &xb);
	m->normal = x->normal;
	m->points = 1;
	m->gap[0] = ob_dot(x->normal, ob_sub(xa, xb));
	m->at[0] = ob_add(origin, ob_scale(ob_add(xa, xb), .5));
}

// Collects the one or two corners that are lowest along n. Returns their number; 0 for more.
static int collect_lowest(const ob_polytope *x, ob_vec3 n, ob_vec3 at[2])
{
	const ob_vec3 l = to_local(x, n);
	const double low = lowest_along(x, l) + as_low * x->radius;
	int found = 0;
	for (uint32_t k = 0; k < x->shape->corners; k++)
		if (ob_dot(l, x->corner[k]) <= low) {
			if (found == 2)
				return 0;
			at[found++] = corner_of(x, k);
		}
	return found;
}

// Manifold of a corner that meets a corner, or of two parallel edges, exactly head-on: the faces on all sides close at
// the same instant, and none of them decides. The mean of their normals does, so mirrored bodies stay mirrored.
// Returns false where other features meet.
static bool corners_manifold(const ob_polytope *a, const ob_polytope *b, ob_vec3 n, ob_vec3 origin, double margin,
			     ob_manifold *m)
{
	ob_vec3 xa[2], xb[2];
	const int in_a = collect_lowest(a, n, xa), in_b = collect_lowest(b, ob_scale(n, -1), xb);
	if (!in_a || in_a != in_b)
		return false;
	const double gap = ob_dot(n, ob_sub(xa[0], xb[0]));
	m->normal = n;
	m->points = gap > margin ? 0 : in_a;
	m->valid_path = ob_min(a->placed->rest_depth, b->placed->rest_depth);
	if (in_a == 1) {
		m->at[0] = ob_add(origin, ob_scale(ob_add(xa[0], xb[0]), .5)), m->gap[0] = gap;
		return true;
	}
	// ends of the stretch over which both edges run
	const ob_vec3 way = ob_sub(xa[1], xa[0]), along = ob_scale(way, 1 / ob_norm(way));
	const double to = ob_norm(way), b0 = ob_dot(along, ob_sub(xb[0], xa[0])),
		     b1 = ob_dot(along, ob_sub(xb[1], xa[0]));
	const double end[2] = { ob_max(0, ob_min(b0, b1)), ob_min(to, ob_max(b0, b1)) };
	if (fabs(fabs(b1 - b0) - ob_norm(ob_sub(xb[1], xb[0]))) > as_low * b->radius || !(end[0] < end[1]))
		return false;
	for (int k = 0; k < 2; k++) {
		m->at[k] = ob_add(origin, ob_madd(ob_madd(xa[0], end[k], along), -.5 * gap, n));
		m->gap[k] = gap;
	}
	return true;
}

// Finds the face whose normal is nearest to the axis of two edges, among the faces of these edges. Returns false if
// none is near enough.
static bool face_along(const ob_polytope *a, const ob_polytope *b, const axis *x, uint32_t *face, bool *of_b)
{
	double best = along_face;
	bool found = false;
	for (int k = 0; k < 4; k++) {
		const ob_hull_edge *e = k < 2 ? &a->shape->edge[x->edge_a] : &b->shape->edge[x->edge_b];
		const uint32_t f = k & 1 ? e->right : e->left;
		const double c = k < 2 ? -ob_dot(normal_of(a, f), x->normal) : ob_dot(normal_of(b, f), x->normal);
		if (c > best)
			best = c, *face = f, *of_b = k >= 2, found = true;
	}
	return found;
}

// Finds the points over the axis' face, or over a face that looks along an axis of edges; failing that, the edges'
// point.
static void manifold_along(const ob_polytope *a, const ob_polytope *b, const axis *x, ob_vec3 origin, double margin,
			   ob_manifold *out)
{
	uint32_t face = x->face;
	bool of_b = x->of_b;
	const bool has_face = x->is_face || face_along(a, b, x, &face, &of_b);
	if (has_face)
		face_manifold(of_b ? b : a, of_b ? a : b, x, face, of_b, origin, margin, out);
	if (!x->is_face && (!has_face || !out->points))
		edge_manifold(a, b, x, origin, out);
}

// True if a point has a gap of at most "gap" (m).
static bool is_proven(const ob_manifold *m, double gap)
{
	for (int k = 0; k < m->points; k++)
		if (m->gap[k] <= gap)
			return true;
	return false;
}

// ---- pairs

void ob_manifold_polytopes(const ob_placed *pa, const ob_placed *pb, double margin, ob_manifold *out)
{
	ob_polytope a, b;
	axes s = { .face = { .gap = -INFINITY }, .edge = { .gap = -INFINITY } };
	heights heights_a, heights_b;
	bool crossing;
	const ob_vec3 origin = pb->p;
	const double rest = ob_min(pa->rest_depth, pb->rest_depth);
	out->points = 0;
	out->separation = ob_norm(ob_sub(pa->p, pb->p)) - ob_polytope_radius(pa) - ob_polytope_radius(pb);
	if (out->separation > margin)
		return;
	ob_polytope_init(&a, pa, origin);
	ob_polytope_init(&b, pb, origin);
	const double thin = ob_min(a.thin, b.thin), discount = ob_min(prefer_face * thin, rest),
		     touch = rest + same_gap * thin;
	try_faces(&s, &a, &b, false, touch, &heights_a);
	try_faces(&s, &b, &a, true, touch, &heights_b);
	out->separation = s.face.gap;
	if (s.face.gap > margin + nearby * thin)
		return;
	try_edges(&s, &a, &b, ob_min(s.face.gap, discount - touch), touch, discount, &heights_a, &heights_b);
	out->separation = ob_max(s.face.gap, s.edge.gap);
	if (out->separation > margin)
		return;
	ob_vec3 together;
	const axis *x = closing_last(&a, &b, &s, rest, discount, &crossing, &together);
	out->valid_path = crossing ? rest : INFINITY;
	if (crossing)
		return;
	const double length = ob_norm(together);
	if (x && length > 0 && ob_dot(together, x->normal) < same_axis * length &&
	    corners_manifold(&a, &b, ob_scale(together, 1 / length), origin, margin, out))
		return;
	if (!x)
		x = s.edge.gap > s.face.gap + discount - prefer_face_when_deep * s.face.gap ? &s.edge : &s.face;
	manifold_along(&a, &b, x, origin, margin, out);
	if (is_proven(out, x->gap + rest + discount))
		return;
	// The features along this axis do not lie over each other, so it holds nothing: the best axis has the points.
	out->points = 0;
	const axis *best = s.edge.gap > s.face.gap ? &s.edge : &s.face;
	if (best->is_face)
		manifold_along(&a, &b, best, origin, margin, out);
	else
		edge_manifold(&a, &b, best, origin, out);
	if (!out->points) // only separate shapes have none: they are checked again before they can touch
		out->valid_path = ob_max(rest, out->separation);
}

void ob_manifold_hull_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const ob_vec3 n = ob_column(&b->r, 2), l = ob_rotate_back(&a->r, n), u = ob_column(&b->r, 0),
		      w = ob_column(&b->r, 1);
	const double height = ob_dot(n, ob_sub(a->p, b->p)), band = 2 * a->rest_depth;
	ob_polygon p;
	p.n = 0;
	out->separation = INFINITY;
	for (uint32_t k = 0; k < a->hull->corners; k++) {
		const double gap = height + ob_dot(l, a->hull->corner[k]);
		out->separation = ob_min(out->separation, gap);
		if (gap > margin)
			continue;
		const ob_vec3 x = ob_rotate(&a->r, a->hull->corner[k]);
		polygon_put(&p, ob_dot(x, u), ob_dot(x, w), gap);
	}
	ob_polygon_reduce(&p, band);
	out->normal = n;
	out->points = p.n;
	for (int k = 0; k < p.n; k++) {
		const ob_vec3 on = ob_madd(ob_madd(ob_scale(n, p.z[k] - height), p.u[k], u), p.w[k], w);
		out->gap[k] = p.z[k];
		out->at[k] = ob_madd(ob_add(a->p, on), -.5 * p.z[k], n);
	}
}
