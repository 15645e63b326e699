#include "contact/facets.h"

#include "contact/support.h"
#include "shape/shape.h"

static const double steep_cap = .3, steep_side = .95; // cosines: a cap with less, or a side with more, has one point
static const double steepest_face = .05; // cosine: over a cap, a steeper face has nothing but its edges
static const double upright = 1e-6; // rad: a cap that leans by less is level
static const double pressing = 1e-6; // relative to an acceleration: a smaller part along a facet presses nowhere
static const double standing = 1 - 1e-6; // cosine: a cap that leans more, by 1.4 mrad, touches with its rim
static const double leaning = 1.4e-3; // sine: a side that leans more touches with its rim
static const double parallel = .99; // cosine: caps with rims that count as in one plane
static const double border = 1e-9; // relative to the facet's size: so far outside counts as inside
static const double as_low = 1e-4; // relative to ob_spots' same: spots that are lower by less are not lower

static ob_vec3 unit(ob_vec3 v)
{
	return ob_scale(v, 1 / ob_norm(v));
}

static ob_vec3 part_across(ob_vec3 v, ob_vec3 d)
{
	return ob_madd(v, -ob_dot(v, d), d);
}

void ob_rim_directions(const ob_placed *cylinder, const ob_placed *other, ob_vec3 towards, ob_vec3 direction[4])
{
	ob_vec3 d = ob_column(&cylinder->r, 2), pressed = ob_add(cylinder->a, other->a);
	ob_vec3 first = part_across(towards, d);
	if (ob_norm(first) <= upright) {
		first = part_across(pressed, d);
		if (!(ob_norm(first) > pressing * ob_norm(pressed))) {
			first = ob_column(&cylinder->r, 0);
			if (ob_shape_is(other->shape, OB_RIMMED)) {
				ob_vec3 x = ob_column(&other->r, 0);
				first = part_across(ob_madd(first, ob_dot(first, x) < 0 ? -1 : 1, x), d);
			}
		}
	}
	direction[0] = unit(first);
	direction[1] = ob_cross(d, direction[0]);
	direction[2] = ob_scale(direction[0], -1);
	direction[3] = ob_scale(direction[1], -1);
}

// ---- seams

static const double same_gap = 1e-3; // relative to the resting depth: gaps that differ by less are equal
static const double leaving_share = .1; // relative to the resting depth, see ob_leaving_path

static double rest_depth(const ob_placed *a, const ob_placed *b)
{
	return ob_min(a->rest_depth, b->rest_depth);
}

double ob_leaving_path(const ob_placed *a, const ob_placed *b)
{
	return leaving_share * rest_depth(a, b);
}

// Time (s) until a is deeper along n than at rest; at most the far future.
static double time_to_close(const ob_placed *a, const ob_placed *b, ob_vec3 n, double gap)
{
	ob_vec3 x = ob_support(a, ob_scale(n, -1)), va = ob_add(a->v, ob_cross(a->w, ob_sub(x, a->p)));
	double rate = ob_dot(n, ob_sub(va, ob_add(b->v, ob_cross(b->w, ob_sub(x, b->p)))));
	return ob_time_to_close(a, b, gap + rest_depth(a, b), rate);
}

bool ob_face_underfoot(const ob_placed *a, const ob_placed *box, ob_vec3 n, double gap, double reach, ob_placed *wider,
		       ob_vec3 *normal, bool *leaving)
{
	const double h[3] = { box->size.x, box->size.y, box->size.z }, rest = rest_depth(a, box);
	const double other = time_to_close(a, box, n, gap);
	double latest = other;
	int face = -1;
	for (int i = 0; i < 3; i++) {
		ob_vec3 f = ob_column(&box->r, i);
		if (ob_dot(f, ob_sub(a->p, box->p)) < 0)
			f = ob_scale(f, -1);
		double at = ob_dot(f, ob_sub(ob_support(a, ob_scale(f, -1)), box->p)) - h[i];
		if (!(fabs(at) <= rest))
			continue;
		double closes = time_to_close(a, box, f, at);
		if (closes >= latest)
			latest = closes, face = i, *normal = f;
	}
	*leaving = face >= 0 && latest == other;
	if (*leaving)
		reach = sqrt(2 * a->size.x * same_gap * rest);
	*wider = *box;
	wider->size =
		ob_v3(h[0] + (face == 0 ? 0 : reach), h[1] + (face == 1 ? 0 : reach), h[2] + (face == 2 ? 0 : reach));
	return face >= 0;
}

// ---- facets

typedef struct disc {
	ob_vec3 centre, normal; // outward
	double radius;
} disc;

// Returns the ob_manifold.disc_radius of a cap. whole: all four points of its rim are over the other facet; first: the lowest
// one is.
static double cap_radius(const ob_spots *s, const disc *cap, bool whole, bool first)
{
	if (!(fabs(ob_dot(cap->normal, s->normal)) > standing))
		return first ? -cap->radius : 0;
	return whole && s->n == 4 ? cap->radius : 0;
}

typedef struct polygon {
	int n;
	ob_vec3 normal; // outward
	ob_vec3 corner[OB_HULL_CORNERS_MAX]; // counterclockwise
} polygon;

static disc cap_of(const ob_placed *cylinder, ob_vec3 towards)
{
	ob_vec3 d = ob_column(&cylinder->r, 2);
	if (ob_dot(d, towards) < 0)
		d = ob_scale(d, -1);
	return (disc){ ob_madd(cylinder->p, cylinder->size.y, d), d, cylinder->size.x };
}

static polygon hull_face(const ob_placed *x, uint32_t f)
{
	const ob_hull *h = x->hull;
	polygon p;
	p.n = h->first[f + 1] - h->first[f];
	p.normal = ob_rotate(&x->r, h->normal[f]);
	for (int k = 0; k < p.n; k++)
		p.corner[k] = ob_add(x->p, ob_rotate(&x->r, h->corner[h->loop[h->first[f] + k]]));
	return p;
}

static uint32_t hull_face_towards(const ob_placed *x, ob_vec3 towards)
{
	const ob_vec3 l = ob_rotate_back(&x->r, towards);
	double best = -INFINITY;
	uint32_t face = 0;
	for (uint32_t f = 0; f < x->hull->faces; f++) {
		const double c = ob_dot(l, x->hull->normal[f]);
		if (c > best)
			best = c, face = f;
	}
	return face;
}

// Face of a box or a hull that looks most along "towards".
static polygon face_of(const ob_placed *box, ob_vec3 towards)
{
	if (box->hull)
		return hull_face(box, hull_face_towards(box, towards));
	static const int s1[4] = { 1, -1, -1, 1 }, s2[4] = { 1, 1, -1, -1 };
	double h[3] = { box->size.x, box->size.y, box->size.z }, best = -1;
	polygon p;
	int k = 0;
	p.n = 4;
	for (int i = 0; i < 3; i++) {
		double c = ob_dot(towards, ob_column(&box->r, i));
		if (fabs(c) > best)
			best = fabs(c), k = i, p.normal = ob_scale(ob_column(&box->r, i), c < 0 ? -1 : 1);
	}
	ob_vec3 centre = ob_madd(box->p, h[k], p.normal);
	ob_vec3 u = ob_scale(ob_column(&box->r, (k + 1) % 3), h[(k + 1) % 3]);
	ob_vec3 w = ob_cross(p.normal, ob_scale(u, h[(k + 2) % 3] / h[(k + 1) % 3])); // corners counterclockwise
	for (int i = 0; i < 4; i++)
		p.corner[i] = ob_madd(ob_madd(centre, s1[i], u), s2[i], w);
	return p;
}

// Line on the side of a cylinder or a capsule that reaches farthest along "towards".
static void line_of(const ob_placed *x, ob_vec3 towards, ob_vec3 end[2])
{
	ob_vec3 d = ob_column(&x->r, 2), out = ob_shape_is(x->shape, OB_RIMMED) ? part_across(towards, d) : towards;
	ob_vec3 middle = ob_madd(x->p, x->size.x / ob_norm(out), out);
	end[0] = ob_madd(middle, -x->size.y, d);
	end[1] = ob_madd(middle, x->size.y, d);
}

// Moves x along n into the plane through c across normal.
static ob_vec3 into_plane(ob_vec3 x, ob_vec3 n, ob_vec3 c, ob_vec3 normal)
{
	return ob_madd(x, ob_dot(normal, ob_sub(c, x)) / ob_dot(normal, n), n);
}

// ---- spots

void ob_spots_add(ob_spots *s, ob_vec3 at, double gap)
{
	if (gap > s->margin || s->n == OB_SPOTS_MAX)
		return;
	for (int k = 0; k < s->n; k++)
		if (ob_norm2(ob_sub(at, s->at[k])) < s->same * s->same)
			return;
	s->at[s->n] = at;
	s->gap[s->n++] = gap;
}

// Adds a spot. on: its point in the facet; over: the other shape's point, along the normal.
static void add(ob_spots *s, ob_vec3 on, ob_vec3 over)
{
	ob_spots_add(s, ob_scale(ob_add(on, over), .5), ob_dot(s->normal, ob_sub(over, on)));
}

// True if x, moved along n, is inside the polygon.
static bool inside_polygon(const polygon *p, ob_vec3 n, ob_vec3 x)
{
	double turn = ob_dot(p->normal, n) < 0 ? -1 : 1;
	for (int k = 0; k < p->n; k++) {
		ob_vec3 e = ob_sub(p->corner[k + 1 < p->n ? k + 1 : 0], p->corner[k]);
		if (turn * ob_dot(n, ob_cross(e, ob_sub(x, p->corner[k]))) < -border * ob_norm2(e))
			return false;
	}
	return true;
}

// Finds the part of the line from x to y within radius of c, in shares of the way. Returns false if there is none.
static bool within_circle(ob_vec3 x, ob_vec3 y, ob_vec3 c, double radius, double share[2])
{
	ob_vec3 e = ob_sub(y, x), f = ob_sub(x, c);
	double ee = ob_norm2(e), ef = ob_dot(e, f), ff = ob_norm2(f) - radius * radius, root = ef * ef - ee * ff;
	if (!(root >= 0) || !(ee > 0))
		return false;
	root = sqrt(root);
	share[0] = (-ef - root) / ee, share[1] = (-ef + root) / ee;
	return share[1] >= 0 && share[0] <= 1;
}

static ob_vec3 between(ob_vec3 x, ob_vec3 y, double share)
{
	return ob_madd(x, share, ob_sub(y, x));
}

// Adds the common points of a polygon and a disc; the spots' normal is that of one of them.
static void polygon_and_disc(ob_spots *s, const polygon *p, const disc *c, const ob_vec3 rim[4], bool polygon_is_on)
{
	ob_vec3 flat[OB_HULL_CORNERS_MAX]; // corners, moved into the disc's plane
	int whole = 0;
	bool first = false;
	for (int k = 0; k < 4; k++) {
		ob_vec3 x = ob_madd(c->centre, c->radius, rim[k]);
		ob_vec3 y = into_plane(x, s->normal, p->corner[0], p->normal);
		if (!inside_polygon(p, s->normal, x))
			continue;
		add(s, polygon_is_on ? y : x, polygon_is_on ? x : y);
		first |= k == 0;
		whole++;
	}
	for (int k = 0; k < p->n; k++) {
		flat[k] = into_plane(p->corner[k], s->normal, c->centre, c->normal);
		if (ob_norm2(ob_sub(flat[k], c->centre)) < c->radius * c->radius)
			add(s, polygon_is_on ? p->corner[k] : flat[k], polygon_is_on ? flat[k] : p->corner[k]);
	}
	for (int k = 0; k < p->n; k++) {
		double share[2];
		int next = k + 1 < p->n ? k + 1 : 0;
		if (!within_circle(flat[k], flat[next], c->centre, c->radius, share))
			continue;
		whole = 0;
		for (int i = 0; i < 2; i++) {
			if (!(share[i] > 0 && share[i] < 1))
				continue;
			ob_vec3 x = between(flat[k], flat[next], share[i]);
			ob_vec3 y = between(p->corner[k], p->corner[next], share[i]);
			add(s, polygon_is_on ? y : x, polygon_is_on ? x : y);
		}
	}
	s->disc_radius = cap_radius(s, c, whole == 4, first);
}

// Finds the crossing of two discs' rims near x, which is in the plane of the first, as seen along the normal n. Solves
// both quadratic equations by Newton's method. Returns false if they do not cross there.
static bool rims_cross(const disc *on, const disc *over, ob_vec3 n, ob_vec3 *x)
{
	enum { NEWTON = 12 };
	const double r2 = on->radius * on->radius, q2 = over->radius * over->radius;
	const double across = ob_dot(over->normal, n);
	for (int i = 0; i < NEWTON; i++) {
		const ob_vec3 f = ob_sub(*x, on->centre);
		const ob_vec3 g = ob_sub(into_plane(*x, n, over->centre, over->normal), over->centre);
		const ob_vec3 gn = ob_madd(g, -ob_dot(g, n) / across, over->normal); // g follows x along n
		const ob_vec3 u = ob_madd(f, -ob_dot(f, n), n), v = ob_madd(gn, -ob_dot(gn, n), n);
		const double ef = .5 * (r2 - ob_norm2(f)), eg = .5 * (q2 - ob_norm2(g)),
			     det = ob_dot(n, ob_cross(u, v));
		if (fabs(ef) <= border * r2 && fabs(eg) <= border * q2)
			return true;
		if (!(det * det > border * r2 * q2))
			return false;
		*x = ob_madd(*x, 1 / det, ob_cross(ob_sub(ob_scale(v, ef), ob_scale(u, eg)), n));
	}
	return false;
}

static void disc_and_disc(ob_spots *s, const disc *on, const disc *over, const ob_vec3 rim_on[4],
			  const ob_vec3 rim_over[4])
{
	const ob_vec3 n = s->normal;
	const bool level = -ob_dot(over->normal, n) > parallel;
	ob_vec3 centre = into_plane(over->centre, n, on->centre, n), way = ob_sub(centre, on->centre);
	const double l = ob_norm(way), r = on->radius, q = over->radius;
	int whole = 0;
	bool first = false;
	for (int k = 0; k < 4; k++) {
		ob_vec3 x = ob_madd(over->centre, q, rim_over[k]), y = into_plane(x, n, on->centre, n);
		if (ob_norm(ob_sub(y, on->centre)) <= r * (1 + border))
			add(s, y, x), whole++, first |= k == 0;
	}
	if (!level || l + q <= r * (1 + border)) {
		s->disc_radius = cap_radius(s, over, whole == 4, first);
	} else if (l + r <= q * (1 + border)) {
		s->n = 0;
		for (int k = 0; k < 4; k++) {
			ob_vec3 y = ob_madd(on->centre, r, rim_on[k]);
			add(s, y, into_plane(y, n, over->centre, over->normal));
		}
		s->disc_radius = s->n == 4 ? r : 0;
	} else if (l < r + q) { // a lens: its corners, and its points on the line of centres
		ob_vec3 u = ob_scale(way, 1 / l), v = ob_cross(n, u);
		const double x = .5 * (l + (r - q) * (r + q) / l), y = sqrt(ob_max(0, r * r - x * x));
		ob_vec3 corner[2] = { ob_madd(ob_madd(on->centre, x, u), y, v),
				      ob_madd(ob_madd(on->centre, x, u), -y, v) };
		for (int k = 0; k < 2; k++)
			if (rims_cross(on, over, n, &corner[k]))
				add(s, corner[k], into_plane(corner[k], n, over->centre, over->normal));
		const ob_vec3 far = ob_madd(on->centre, r, u),
			      far_over = into_plane(far, n, over->centre, over->normal);
		const ob_vec3 near_over = ob_madd(over->centre, -q, unit(part_across(u, over->normal))),
			      near = into_plane(near_over, n, on->centre, n);
		if (ob_norm(ob_sub(far_over, over->centre)) <= q * (1 + border))
			add(s, far, far_over);
		if (ob_norm(ob_sub(near, on->centre)) <= r * (1 + border))
			add(s, near, near_over);
	}
}

// Finds the part of a line inside the polygon, as seen along its normal, in shares of the way. Returns false if there
// is none.
static bool within_polygon(const polygon *p, ob_vec3 x, ob_vec3 y, double share[2])
{
	share[0] = 0, share[1] = 1;
	for (int k = 0; k < p->n; k++) {
		ob_vec3 inwards = ob_cross(p->normal, ob_sub(p->corner[k + 1 < p->n ? k + 1 : 0], p->corner[k]));
		double slack = border * ob_norm2(inwards);
		double f = ob_dot(inwards, ob_sub(x, p->corner[k])) + slack;
		double g = ob_dot(inwards, ob_sub(y, p->corner[k])) + slack;
		if (f < 0 && g < 0)
			return false;
		if (f < 0)
			share[0] = ob_max(share[0], f / (f - g));
		else if (g < 0)
			share[1] = ob_min(share[1], f / (f - g));
	}
	return share[0] <= share[1];
}

static void line_over(ob_spots *s, const ob_placed *on, const ob_placed *over)
{
	const ob_vec3 n = s->normal;
	double share[2] = { 0, 1 };
	ob_vec3 end[2], below[2], origin = on->p, towards = ob_scale(n, -1);
	line_of(over, towards, end);
	if (ob_shape_is(on->shape, OB_CORNERED))
		origin = face_of(on, n).corner[0];
	else if (ob_shape_is(on->shape, OB_RIMMED))
		origin = cap_of(on, n).centre;
	for (int k = 0; k < 2; k++)
		below[k] = into_plane(end[k], n, origin, n);
	if (ob_shape_is(on->shape, OB_CORNERED)) {
		polygon p = face_of(on, n);
		if (!within_polygon(&p, below[0], below[1], share))
			return;
	} else if (ob_shape_is(on->shape, OB_RIMMED) &&
		   !within_circle(below[0], below[1], origin, on->size.x * (1 + border), share)) {
		return;
	}
	const double lean = ob_dot(n, ob_sub(end[1], end[0])) / ob_norm(ob_sub(end[1], end[0]));
	const int first = lean < 0; // the lower end
	if (ob_shape_is(over->shape, OB_RIMMED) && fabs(lean) > leaning && s->n == 0 &&
	    (first ? share[1] >= 1 : share[0] <= 0))
		s->disc_radius = -over->size.x;
	for (int k = 0; k < 2; k++) {
		double at = ob_min(ob_max(share[k ^ first], 0), 1);
		add(s, between(below[0], below[1], at), between(end[0], end[1], at));
	}
}

static void cap_over(ob_spots *s, const ob_placed *on, const ob_placed *over)
{
	const ob_vec3 towards = ob_scale(s->normal, -1);
	const disc cap = cap_of(over, towards);
	ob_vec3 rim[4], rim_on[4];
	ob_rim_directions(over, on, towards, rim);
	if (ob_shape_is(on->shape, OB_UNBOUNDED)) {
		for (int k = 0; k < 4; k++) {
			ob_vec3 x = ob_madd(cap.centre, cap.radius, rim[k]);
			add(s, into_plane(x, s->normal, on->p, s->normal), x);
		}
		s->disc_radius = cap_radius(s, &cap, true, true);
	} else if (ob_shape_is(on->shape, OB_CORNERED)) {
		const polygon p = face_of(on, s->normal);
		polygon_and_disc(s, &p, &cap, rim, true);
	} else {
		const disc below = cap_of(on, s->normal);
		ob_rim_directions(on, over, ob_scale(cap.normal, -1), rim_on);
		disc_and_disc(s, &below, &cap, rim_on, rim);
	}
}

static double lowest(const ob_spots *s)
{
	double least = INFINITY;
	for (int k = 0; k < s->n; k++)
		least = ob_min(least, s->gap[k]);
	return least;
}

// Finds the spots of a box over a cap: those of the face that looks most at the cap, or of another face at the box's
// lowest corner if they are lower.
static void box_over(ob_spots *s, const ob_placed *on, const ob_placed *over)
{
	const ob_vec3 towards = ob_scale(s->normal, -1), first = face_of(over, towards).normal;
	const disc cap = cap_of(on, s->normal);
	for (int i = -1; i < 3; i++) {
		ob_vec3 e = i < 0 ? first : ob_column(&over->r, i);
		if (ob_dot(e, towards) < 0)
			e = ob_scale(e, -1);
		if ((i >= 0 && fabs(ob_dot(e, first)) > .5) || ob_dot(e, towards) < steepest_face)
			continue;
		ob_spots also = *s;
		const polygon p = face_of(over, e);
		ob_vec3 rim[4];
		ob_rim_directions(on, over, ob_scale(p.normal, -1), rim);
		also.n = 0;
		polygon_and_disc(&also, &p, &cap, rim, false);
		if (lowest(&also) < lowest(s) - as_low * s->same)
			*s = also;
	}
}

// Takes the spots of one face over the cap if they are lower than those found already.
static void face_over(ob_spots *s, const ob_placed *on, const ob_placed *over, const disc *cap, const polygon *p)
{
	ob_spots also = *s;
	ob_vec3 rim[4];
	ob_rim_directions(on, over, ob_scale(p->normal, -1), rim);
	also.n = 0;
	polygon_and_disc(&also, p, cap, rim, false);
	if (lowest(&also) < lowest(s) - as_low * s->same)
		*s = also;
}

// As box_over, for a hull: the face that looks most at the cap, then others at its lowest corner.
static void hull_over(ob_spots *s, const ob_placed *on, const ob_placed *over)
{
	const ob_vec3 towards = ob_scale(s->normal, -1), l = ob_rotate_back(&over->r, towards);
	const disc cap = cap_of(on, s->normal);
	const ob_hull *h = over->hull;
	const uint32_t best = hull_face_towards(over, towards);
	double most = -INFINITY;
	for (uint32_t k = 0; k < h->corners; k++)
		most = ob_max(most, ob_dot(l, h->corner[k]));
	polygon p = hull_face(over, best);
	face_over(s, on, over, &cap, &p);
	for (uint32_t f = 0; f < h->faces; f++) {
		bool at_lowest = false;
		for (uint32_t k = h->first[f]; k < h->first[f + 1]; k++)
			at_lowest |= ob_dot(l, h->corner[h->loop[k]]) >= most - border * h->radius;
		if (f == best || !at_lowest || ob_dot(l, h->normal[f]) < steepest_face)
			continue;
		p = hull_face(over, f);
		face_over(s, on, over, &cap, &p);
	}
}

void ob_spots_find(const ob_placed *on, const ob_placed *over, ob_vec3 n, double margin, ob_spots *out)
{
	out->normal = n;
	out->margin = margin;
	out->same = 1e-5 * (ob_shape_is(on->shape, OB_RIMMED) ? on : over)->size.x;
	out->n = 0;
	out->disc_radius = 0;
	if (ob_shape_is(over->shape, OB_CORNERED)) {
		(over->hull ? hull_over : box_over)(out, on, over);
		return;
	}
	const bool rimmed = ob_shape_is(over->shape, OB_RIMMED);
	double lean = fabs(ob_dot(n, ob_column(&over->r, 2)));
	if (rimmed && lean > steep_cap)
		cap_over(out, on, over);
	if (!rimmed || lean < steep_side)
		line_over(out, on, over);
}

void ob_spots_reduce(ob_spots *s)
{
	if (s->n <= 4)
		return;
	int keep[4] = { 0, 0, -1, -1 }; // the first two also where no distance is a number
	double far = -1, left = 0, right = 0;
	for (int k = 1; k < s->n; k++)
		if (s->gap[k] < s->gap[keep[0]] - as_low * s->same)
			keep[0] = k;
	const ob_vec3 first = s->at[keep[0]];
	for (int k = 0; k < s->n; k++)
		if (ob_norm2(ob_sub(s->at[k], first)) > far)
			far = ob_norm2(ob_sub(s->at[k], first)), keep[1] = k;
	const ob_vec3 across = ob_cross(s->normal, ob_sub(s->at[keep[1]], first));
	const double least = 1e-6 * far;
	for (int k = 0; k < s->n; k++) {
		double side = ob_dot(across, ob_sub(s->at[k], first));
		if (k == keep[0] || k == keep[1])
			continue;
		if (side > ob_max(left, least))
			left = side, keep[2] = k;
		if (side < ob_min(right, -least))
			right = side, keep[3] = k;
	}
	ob_spots out = *s;
	out.n = 0;
	for (int i = 0; i < 4; i++) {
		if (keep[i] < 0)
			continue;
		out.at[out.n] = s->at[keep[i]];
		out.gap[out.n++] = s->gap[keep[i]];
	}
	*s = out;
}

void ob_spots_put(const ob_spots *s, double sign, ob_manifold *out)
{
	out->normal = ob_scale(s->normal, sign);
	out->points = s->n < 4 ? s->n : 4;
	out->disc_radius = s->disc_radius;
	for (int k = 0; k < out->points; k++) {
		out->at[k] = s->at[k];
		out->gap[k] = s->gap[k];
	}
}
