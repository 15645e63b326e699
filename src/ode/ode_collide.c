#include "ode/ode_collide.h"

#include <stdbool.h>

#include "ode/ode_geom.h"

// ---- solids: where a point lies with regard to a shape

typedef struct solid {
	ob_shape shape;
	ob_vec3 size;
	ob_vec3 p; // m, centre
	ob_mat3 r; // body to world
} solid;

static double clamp_to(double x, double h)
{
	return fmin(fmax(x, -h), h);
}

static ob_vec3 into_body_frame(const solid *s, ob_vec3 x)
{
	return ob_rotate_back(&s->r, ob_sub(x, s->p));
}

static solid solid_make(ob_shape shape, ob_vec3 size, ob_pose pose)
{
	return (solid){ shape, size, pose.p, ob_quat_matrix(pose.q) };
}

// The same shape, thicker by m (m) on every side.
static ob_vec3 solid_inflate(ob_shape shape, ob_vec3 size, double m)
{
	switch (shape) {
	case OB_SHAPE_SPHERE:
	case OB_SHAPE_CAPSULE: // a capsule's core stays as long as it is
		return ob_v3(size.x + m, size.y, size.z);
	case OB_SHAPE_BOX:
		return ob_v3(size.x + m, size.y + m, size.z + m);
	case OB_SHAPE_CYLINDER:
		return ob_v3(size.x + m, size.y + m, size.z);
	case OB_SHAPE_PLANE:
	case OB_SHAPE_NONE:
		break;
	}
	return size;
}

// Of the sphere round its centre that holds it (m); not for planes.
static double solid_radius(const solid *s)
{
	if (s->shape == OB_SHAPE_BOX)
		return ob_norm(s->size);
	if (s->shape == OB_SHAPE_CYLINDER)
		return hypot(s->size.x, s->size.y);
	return s->shape == OB_SHAPE_CAPSULE ? s->size.x + s->size.y : s->size.x;
}

// How far the solid reaches beyond x along the unit direction n (m).
static double solid_height(const solid *s, ob_vec3 n, ob_vec3 x)
{
	ob_vec3 b = ob_rotate_back(&s->r, n), h = s->size;
	double extent = 0;
	switch (s->shape) {
	case OB_SHAPE_SPHERE:
		extent = h.x;
		break;
	case OB_SHAPE_BOX:
		extent = fabs(b.x) * h.x + fabs(b.y) * h.y + fabs(b.z) * h.z;
		break;
	case OB_SHAPE_CAPSULE:
		extent = h.x + fabs(b.z) * h.y;
		break;
	case OB_SHAPE_CYLINDER:
		extent = sqrt(b.x * b.x + b.y * b.y) * h.x + fabs(b.z) * h.y;
		break;
	case OB_SHAPE_PLANE: // along its own normal, the only direction that is asked for
	case OB_SHAPE_NONE:
		break;
	}
	return extent - ob_dot(n, ob_sub(x, s->p));
}

// The nearest point of a ball of radius r round c.
static ob_vec3 into_ball(ob_vec3 b, ob_vec3 c, double r)
{
	double distance = ob_norm(ob_sub(b, c));
	return distance > r ? ob_madd(c, r / distance, ob_sub(b, c)) : b;
}

// x itself, or the point of the solid nearest to it.
static ob_vec3 solid_nearest(const solid *s, ob_vec3 x)
{
	ob_vec3 b = into_body_frame(s, x), h = s->size;
	double across = sqrt(b.x * b.x + b.y * b.y);
	switch (s->shape) {
	case OB_SHAPE_SPHERE:
		b = into_ball(b, ob_v3(0, 0, 0), h.x);
		break;
	case OB_SHAPE_CAPSULE:
		b = into_ball(b, ob_v3(0, 0, clamp_to(b.z, h.y)), h.x);
		break;
	case OB_SHAPE_BOX:
		b = ob_v3(clamp_to(b.x, h.x), clamp_to(b.y, h.y), clamp_to(b.z, h.z));
		break;
	case OB_SHAPE_PLANE:
		b.z = fmin(b.z, 0);
		break;
	case OB_SHAPE_CYLINDER:
		if (across > h.x)
			b = ob_v3(b.x * h.x / across, b.y * h.x / across, b.z);
		b.z = clamp_to(b.z, h.y);
		break;
	case OB_SHAPE_NONE:
		break;
	}
	return ob_add(s->p, ob_rotate(&s->r, b));
}

// How much the extent along the unit direction n grows (m) when the shape is inflated by m (m).
static double solid_growth(const solid *s, ob_vec3 n, double m)
{
	ob_vec3 b = ob_rotate_back(&s->r, n);
	if (s->shape == OB_SHAPE_BOX)
		return m * (fabs(b.x) + fabs(b.y) + fabs(b.z));
	if (s->shape == OB_SHAPE_CYLINDER)
		return m * (sqrt(b.x * b.x + b.y * b.y) + fabs(b.z));
	return m;
}

static bool clip_slab(double x, double u, double h, double *from, double *to)
{
	if (fabs(u) < 1e-12)
		return fabs(x) <= h;
	double one = (-h - x) / u, other = (h - x) / u;
	*from = fmax(*from, fmin(one, other));
	*to = fmin(*to, fmax(one, other));
	return *from <= *to;
}

static bool clip_disc(ob_vec3 x, ob_vec3 u, double radius, double *from, double *to)
{
	double a = u.x * u.x + u.y * u.y, b = x.x * u.x + x.y * u.y, c = x.x * x.x + x.y * x.y - radius * radius;
	double root2 = b * b - a * c;
	if (a < 1e-12 || root2 < 0)
		return c <= 0;
	*from = fmax(*from, (-b - sqrt(root2)) / a);
	*to = fmin(*to, (-b + sqrt(root2)) / a);
	return *from <= *to;
}

// The part [*from, *to] of the line x + t u over the face that looks along n; false: none.
static bool solid_clip(const solid *s, ob_vec3 n, ob_vec3 x, ob_vec3 u, double *from, double *to)
{
	ob_vec3 m = ob_rotate_back(&s->r, n), h = s->size;
	x = into_body_frame(s, x);
	u = ob_rotate_back(&s->r, u);
	if (s->shape == OB_SHAPE_CYLINDER)
		return fabs(m.z) > .7 ? clip_disc(x, u, h.x, from, to) : clip_slab(x.z, u.z, h.y, from, to);
	if (s->shape == OB_SHAPE_CAPSULE)
		return clip_slab(x.z, u.z, h.y, from, to);
	if (s->shape != OB_SHAPE_BOX)
		return true;
	double mx = fabs(m.x), my = fabs(m.y), mz = fabs(m.z), largest = fmax(fmax(mx, my), mz);
	return (mx == largest || clip_slab(x.x, u.x, h.x, from, to)) &&
	       (my == largest || clip_slab(x.y, u.y, h.y, from, to)) &&
	       (mz == largest || clip_slab(x.z, u.z, h.z, from, to));
}

// ---- contacts that ODE does not find: the direction of least overlap

enum { AXES_MAX = 6, TURNS = 8, CLIMBS = 100, PROJECTIONS = 20 };

struct search {
	const solid *a, *b;
	ob_vec3 best; // unit, from b to a
	double gap; // m, along it; the widest so far
};

static ob_vec3 normalised(ob_vec3 n)
{
	return ob_scale(n, 1 / ob_norm(n));
}

static bool try_direction(struct search *s, ob_vec3 n)
{
	if (ob_norm2(n) < 1e-12)
		return false;
	n = normalised(n);
	if (ob_dot(n, ob_sub(s->a->p, s->b->p)) < 0)
		n = ob_scale(n, -1);
	double gap =
		-solid_height(s->b, n, s->b->p) - solid_height(s->a, n, s->a->p) + ob_dot(n, ob_sub(s->a->p, s->b->p));
	if (!(gap > s->gap))
		return false;
	s->gap = gap;
	s->best = n;
	return true;
}

static int axes_of(const solid *s, ob_vec3 axis[3])
{
	if (s->shape != OB_SHAPE_BOX) {
		axis[0] = ob_column(&s->r, 2);
		return 1;
	}
	for (int i = 0; i < 3; i++)
		axis[i] = ob_column(&s->r, i);
	return 3;
}

// The faces, the edges across each other, and what points from one to the other across an axis: where the gap has
// kinks.
static void try_kinks(struct search *s)
{
	ob_vec3 axis[AXES_MAX], d = ob_sub(s->a->p, s->b->p);
	int n = axes_of(s->a, axis);
	n += axes_of(s->b, axis + n);
	try_direction(s, d);
	for (int i = 0; i < n; i++) {
		try_direction(s, axis[i]);
		try_direction(s, ob_madd(d, -ob_dot(d, axis[i]), axis[i]));
		for (int j = 0; j < i; j++)
			try_direction(s, ob_cross(axis[i], axis[j]));
	}
}

// TURNS steps round the best direction, turned a little each time so that no way up is missed for good, and along the
// kinks through it: across each axis.
static void climb_to_widest(struct search *s)
{
	double phase = 0, step = .3;
	ob_vec3 axis[AXES_MAX];
	int n = axes_of(s->a, axis);
	n += axes_of(s->b, axis + n);
	// A gain in the last bits would keep the step long for ever: what counts is one of the step's own order.
	for (int round = 0; round < CLIMBS && step > 1e-5; round++) {
		double before = s->gap;
		ob_vec3 from = s->best;
		ob_vec3 u = normalised(ob_cross(from, fabs(from.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0)));
		ob_vec3 v = ob_cross(from, u);
		for (int i = 0; i < TURNS; i++) {
			double angle = phase + i * (2 * M_PI / TURNS);
			try_direction(s, ob_madd(from, step, ob_madd(ob_scale(u, cos(angle)), sin(angle), v)));
		}
		for (int i = 0; i < n; i++) {
			ob_vec3 along = ob_cross(axis[i], from);
			try_direction(s, ob_madd(from, step, along));
			try_direction(s, ob_madd(from, -step, along));
		}
		phase += 2.399963229728653; // the golden angle
		step *= s->gap > before + 1e-3 * step * step ? 1 : .5;
	}
}

// Alternating projections (von Neumann 1950) end in the overlap, or at the points nearest to each other.
static ob_vec3 point_between(const solid *a, const solid *b)
{
	ob_vec3 on_a = a->p, on_b = b->p;
	for (int i = 0; i < PROJECTIONS; i++) {
		on_b = solid_nearest(b, on_a);
		on_a = solid_nearest(a, on_b);
	}
	return ob_scale(ob_add(on_a, on_b), .5);
}

// One contact of two solids of which ODE knows too little (cylinders with boxes and cylinders, where their caps do not
// lie flat): the direction in which they overlap least, found from "hint" and from their axes by pattern search (Hooke
// and Jeeves 1961), and a point between them. Gap to about 1e-4 of their size, never too wide.
static ob_ode_point axis_contact(const solid *a, const solid *b, ob_vec3 hint)
{
	struct search s = { .a = a, .b = b, .best = { 0, 0, 1 }, .gap = -INFINITY };
	try_direction(&s, hint);
	try_kinks(&s);
	climb_to_widest(&s);
	return (ob_ode_point){ point_between(a, b), s.best, s.gap };
}

// ---- contacts that ODE finds

enum { RAW_MAX = 16, POINTS_MAX = 8 };

// A pair with both its true and its inflated shapes.
struct pair {
	solid a, b, fat_a, fat_b;
	double grow_a, grow_b; // m
};

static bool is_round(ob_shape s)
{
	return s == OB_SHAPE_SPHERE || s == OB_SHAPE_CAPSULE || s == OB_SHAPE_PLANE;
}

static solid fatten(const solid *s, double m)
{
	solid fat = *s;
	fat.size = solid_inflate(s->shape, s->size, m);
	if (s->shape == OB_SHAPE_PLANE)
		fat.p = ob_madd(s->p, m, ob_column(&s->r, 2));
	return fat;
}

// What is round grows alike on all sides, so it takes the whole margin where there is such a one. What has edges grows
// more at the edges.
static struct pair inflate_pair(const solid *a, const solid *b, double margin)
{
	double share_a = is_round(a->shape) ? 1 : is_round(b->shape) ? 0 : .5;
	struct pair p = { .a = *a, .b = *b, .grow_a = share_a * margin, .grow_b = (1 - share_a) * margin };
	p.fat_a = fatten(a, p.grow_a);
	p.fat_b = fatten(b, p.grow_b);
	return p;
}

// How far a's surface lies below x, as a share of the depth: 0 = x is on a's surface, 1 = on b's. ODE does not say.
// It may be told from the heights over a's lowest and under b's highest place along the normal: of several points, each
// is either a vertex, over the face of the other, or on that face.
static double share_of(const struct pair *p, ob_vec3 x, ob_vec3 n, double depth, bool alone)
{
	double over_a = solid_height(&p->fat_a, ob_scale(n, -1), x);
	double under_b = solid_height(&p->fat_b, n, x);
	double on_a = fmin(fabs(over_a), fabs(under_b - depth)), on_b = fmin(fabs(under_b), fabs(over_a - depth));
	double between = over_a + under_b > 0 ? fmin(fmax(over_a / (over_a + under_b), 0), 1) : .5;
	return alone ? between : on_a <= on_b ? 0 : 1;
}

// What of d (m) is across the unit vector n, squared.
static double across2(ob_vec3 d, ob_vec3 n)
{
	return ob_norm2(ob_madd(d, -ob_dot(d, n), n));
}

static void to_true_surfaces(const struct pair *p, const dContactGeom *c, bool alone, ob_ode_point *out)
{
	ob_vec3 x = ob_v3(c->pos[0], c->pos[1], c->pos[2]);
	ob_vec3 n = ob_v3(c->normal[0], c->normal[1], c->normal[2]);
	double share = share_of(p, x, n, c->depth, alone);
	// a's surface lies lower than b's by the depth, seen along the normal
	ob_vec3 fat_a = ob_madd(x, -share * c->depth, n), fat_b = ob_madd(x, (1 - share) * c->depth, n);
	ob_vec3 on_a = solid_nearest(&p->a, fat_a), on_b = solid_nearest(&p->b, fat_b);
	double point_gap = ob_dot(n, ob_sub(on_a, on_b));
	// A single point is where both extents along the normal are reached, and their growth is known exactly.
	// Of several, the others grew by less.
	double extent_gap = solid_growth(&p->a, n, p->grow_a) + solid_growth(&p->b, n, p->grow_b) - c->depth;
	out->gap = alone ? extent_gap : fmin(point_gap, extent_gap);
	out->normal = n;
	// Where a corner shrank sideways, the point lies at the true corner.
	bool corner_of_a = across2(ob_sub(on_a, fat_a), n) >= across2(ob_sub(on_b, fat_b), n);
	out->position = corner_of_a ? ob_madd(on_a, -.5 * point_gap, n) : ob_madd(on_b, .5 * point_gap, n);
}

static dGeomID make_geom(const solid *fat, ob_quat q)
{
	dGeomID g = ob_ode_geom_create(0, fat->shape, fat->size);
	if (g)
		ob_ode_geom_place(g, (ob_pose){ fat->p, q });
	return g;
}

static int collide_inflated(const solid *a, ob_quat qa, const solid *b, ob_quat qb, double margin, ob_ode_point *out)
{
	struct pair p = inflate_pair(a, b, margin);
	dGeomID ga = make_geom(&p.fat_a, qa), gb = make_geom(&p.fat_b, qb);
	dContactGeom raw[RAW_MAX];
	int n = ga && gb ? dCollide(ga, gb, RAW_MAX, raw, sizeof *raw) : 0, kept = 0;
	for (int i = 0; i < n; i++) {
		to_true_surfaces(&p, &raw[i], n == 1, &out[kept]);
		kept += out[kept].gap < margin;
	}
	if (ga)
		dGeomDestroy(ga);
	if (gb)
		dGeomDestroy(gb);
	return kept;
}

// ODE gives one point for a capsule that lies on something. The ends of what lies there are spheres: their points count
// too where their normal is that of the pair. sign = -1 where the capsule is the pair's b.
static int add_ends(const solid *capsule, const solid *other, ob_quat q, double sign, double margin, ob_ode_point *out,
		    int n)
{
	ob_vec3 normal = out[0].normal, axis = ob_column(&capsule->r, 2);
	double at[2] = { -capsule->size.y, capsule->size.y };
	if (!solid_clip(other, normal, capsule->p, axis, &at[0], &at[1]))
		return n;
	for (int i = 0; i < 2; i++) {
		ob_pose pose = { ob_madd(capsule->p, at[i], axis), ob_quat_identity() };
		solid end = solid_make(OB_SHAPE_SPHERE, ob_v3(capsule->size.x, 0, 0), pose);
		ob_ode_point point[RAW_MAX];
		if (collide_inflated(&end, pose.q, other, q, margin, point) != 1)
			continue;
		point[0].normal = ob_scale(point[0].normal, sign);
		bool known = ob_dot(point[0].normal, normal) < .9999;
		for (int k = 0; k < n; k++)
			known |= ob_norm(ob_sub(point[0].position, out[k].position)) < .02 * capsule->size.x;
		if (!known)
			out[n++] = point[0];
	}
	return n;
}

// Brings the deepest point to the front, then always the one farthest from those before it: a small number of points
// then still spans what the pair stands on.
static void sort_spread(ob_ode_point *point, int n)
{
	for (int i = 0; i < n; i++) {
		int best = i;
		double best_value = -INFINITY;
		for (int k = i; k < n; k++) {
			double value = i ? INFINITY : -point[k].gap;
			for (int m = 0; m < i; m++)
				value = fmin(value, ob_norm2(ob_sub(point[k].position, point[m].position)));
			if (value > best_value) {
				best_value = value;
				best = k;
			}
		}
		ob_ode_point chosen = point[best];
		point[best] = point[i];
		point[i] = chosen;
	}
}

// libccd's normals and depths for cylinders are rough, and ODE misses some of their edges. Points on a flat cap are
// good: they lie as deep as the least overlap.
static int mend_cylinder(const solid *a, const solid *b, double margin, ob_ode_point *out, int n)
{
	ob_ode_point p = axis_contact(a, b, n ? out[0].normal : ob_sub(a->p, b->p));
	double deepest = INFINITY;
	for (int i = 0; i < n; i++)
		deepest = fmin(deepest, out[i].gap);
	if (n >= 2 && deepest > p.gap - 1e-4 * (solid_radius(a) + solid_radius(b)))
		return n;
	out[0] = p;
	return p.gap < margin;
}

// The point of the capsule's core nearest to the cylinder, by golden section (Kiefer 1953): their distance is convex.
static ob_pose nearest_core(const solid *capsule, const solid *cylinder)
{
	const double golden = .6180339887498949;
	ob_vec3 axis = ob_column(&capsule->r, 2);
	double low = -capsule->size.y, high = capsule->size.y;
	for (int i = 0; i < 40; i++) {
		double left = high - golden * (high - low), right = low + golden * (high - low);
		ob_vec3 at_left = ob_madd(capsule->p, left, axis), at_right = ob_madd(capsule->p, right, axis);
		if (ob_norm2(ob_sub(at_left, solid_nearest(cylinder, at_left))) <
		    ob_norm2(ob_sub(at_right, solid_nearest(cylinder, at_right))))
			high = right;
		else
			low = left;
	}
	return (ob_pose){ ob_madd(capsule->p, .5 * (low + high), axis), ob_quat_identity() };
}

static bool has_ends(ob_shape one, ob_shape other)
{
	return one == OB_SHAPE_CAPSULE && other != OB_SHAPE_SPHERE && other != OB_SHAPE_PLANE;
}

// The points of a pair in the order in which they are found, before the ends of capsules.
static int find_points(const solid *a, ob_quat qa, const solid *b, ob_quat qb, double margin, ob_ode_point *out)
{
	bool edged_a = a->shape == OB_SHAPE_CYLINDER || a->shape == OB_SHAPE_BOX;
	bool edged_b = b->shape == OB_SHAPE_CYLINDER || b->shape == OB_SHAPE_BOX;
	if (a->shape == OB_SHAPE_CAPSULE && b->shape == OB_SHAPE_CYLINDER) {
		solid end = solid_make(OB_SHAPE_SPHERE, a->size, nearest_core(a, b));
		return collide_inflated(&end, ob_quat_identity(), b, qb, margin, out);
	}
	if (b->shape == OB_SHAPE_CAPSULE && a->shape == OB_SHAPE_CYLINDER) {
		solid end = solid_make(OB_SHAPE_SPHERE, b->size, nearest_core(b, a));
		return collide_inflated(a, qa, &end, ob_quat_identity(), margin, out);
	}
	int n = collide_inflated(a, qa, b, qb, margin, out);
	bool mended = edged_a && edged_b && (a->shape == OB_SHAPE_CYLINDER || b->shape == OB_SHAPE_CYLINDER) &&
		      ob_norm(ob_sub(a->p, b->p)) < solid_radius(a) + solid_radius(b) + margin;
	return mended ? mend_cylinder(a, b, margin, out, n) : n;
}

int ob_ode_collide(ob_shape sa, ob_vec3 size_a, ob_pose pa, ob_shape sb, ob_vec3 size_b, ob_pose pb, double margin,
		   ob_ode_point *out, int max)
{
	solid a = solid_make(sa, size_a, pa), b = solid_make(sb, size_b, pb);
	ob_ode_point point[RAW_MAX + 4];
	if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_PLANE)
		return 0;
	int n = find_points(&a, pa.q, &b, pb.q, margin, point);
	if (n == 1 && has_ends(sa, sb))
		n = add_ends(&a, &b, pb.q, 1, margin, point, n);
	if (n >= 1 && n <= 3 && has_ends(sb, sa))
		n = add_ends(&b, &a, pa.q, -1, margin, point, n);
	sort_spread(point, n);
	max = max < POINTS_MAX ? max : POINTS_MAX;
	n = n < max ? n : max;
	for (int i = 0; i < n; i++)
		out[i] = point[i];
	return n;
}
