#include "ode/ode_collide.h"

#include "ode/ode_axis.h"
#include "ode/ode_geom.h"
#include "ode/ode_solid.h"

enum { RAW_MAX = 16, POINTS_MAX = 8 };

// A pair with both its true and its inflated shapes.
struct pair {
	ob_ode_solid a, b, fat_a, fat_b;
	double grow_a, grow_b; // m
};

static bool is_round(ob_shape s)
{
	return s == OB_SHAPE_SPHERE || s == OB_SHAPE_CAPSULE || s == OB_SHAPE_PLANE;
}

static ob_ode_solid fatten(const ob_ode_solid *s, double m)
{
	ob_ode_solid fat = *s;
	fat.size = ob_ode_solid_inflate(s->shape, s->size, m);
	if (s->shape == OB_SHAPE_PLANE)
		fat.p = ob_madd(s->p, m, ob_column(&s->r, 2));
	return fat;
}

// What is round grows alike on all sides, so it takes the whole margin where there is such a one. What has edges grows
// more at the edges.
static struct pair make_pair(const ob_ode_solid *a, const ob_ode_solid *b, double margin)
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
	double over_a = ob_ode_solid_height(&p->fat_a, ob_scale(n, -1), x);
	double under_b = ob_ode_solid_height(&p->fat_b, n, x);
	double on_a = fmin(fabs(over_a), fabs(under_b - depth)), on_b = fmin(fabs(under_b), fabs(over_a - depth));
	double between = over_a + under_b > 0 ? fmin(fmax(over_a / (over_a + under_b), 0), 1) : .5;
	return alone ? between : on_a <= on_b ? 0 : 1;
}

// What of d (m) is across the unit vector n, squared.
static double across2(ob_vec3 d, ob_vec3 n)
{
	return ob_norm2(ob_madd(d, -ob_dot(d, n), n));
}

static void straighten(const struct pair *p, const dContactGeom *c, bool alone, ob_ode_point *out)
{
	ob_vec3 x = ob_v3(c->pos[0], c->pos[1], c->pos[2]);
	ob_vec3 n = ob_v3(c->normal[0], c->normal[1], c->normal[2]);
	double share = share_of(p, x, n, c->depth, alone);
	// a's surface lies lower than b's by the depth, seen along the normal
	ob_vec3 fat_a = ob_madd(x, -share * c->depth, n), fat_b = ob_madd(x, (1 - share) * c->depth, n);
	ob_vec3 on_a = ob_ode_solid_nearest(&p->a, fat_a), on_b = ob_ode_solid_nearest(&p->b, fat_b);
	double point_gap = ob_dot(n, ob_sub(on_a, on_b));
	// A single point is where both extents along the normal are reached, and their growth is known exactly.
	// Of several, the others grew by less.
	double extent_gap =
		ob_ode_solid_growth(&p->a, n, p->grow_a) + ob_ode_solid_growth(&p->b, n, p->grow_b) - c->depth;
	out->gap = alone ? extent_gap : fmin(point_gap, extent_gap);
	out->normal = n;
	// Where a corner shrank sideways, the point lies at the true corner.
	bool corner_of_a = across2(ob_sub(on_a, fat_a), n) >= across2(ob_sub(on_b, fat_b), n);
	out->position = corner_of_a ? ob_madd(on_a, -.5 * point_gap, n) : ob_madd(on_b, .5 * point_gap, n);
}

static dGeomID make_geom(const ob_ode_solid *fat, ob_quat q)
{
	dGeomID g = ob_ode_geom_create(0, fat->shape, fat->size);
	if (g)
		ob_ode_geom_place(g, (ob_pose){ fat->p, q });
	return g;
}

static int collide(const ob_ode_solid *a, ob_quat qa, const ob_ode_solid *b, ob_quat qb, double margin,
		   ob_ode_point *out)
{
	struct pair p = make_pair(a, b, margin);
	dGeomID ga = make_geom(&p.fat_a, qa), gb = make_geom(&p.fat_b, qb);
	dContactGeom raw[RAW_MAX];
	int n = ga && gb ? dCollide(ga, gb, RAW_MAX, raw, sizeof *raw) : 0, kept = 0;
	for (int i = 0; i < n; i++) {
		straighten(&p, &raw[i], n == 1, &out[kept]);
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
static int add_ends(const ob_ode_solid *capsule, const ob_ode_solid *other, ob_quat q, double sign, double margin,
		    ob_ode_point *out, int n)
{
	ob_vec3 normal = out[0].normal, axis = ob_column(&capsule->r, 2);
	double at[2] = { -capsule->size.y, capsule->size.y };
	if (!ob_ode_solid_clip(other, normal, capsule->p, axis, &at[0], &at[1]))
		return n;
	for (int i = 0; i < 2; i++) {
		ob_pose pose = { ob_madd(capsule->p, at[i], axis), ob_quat_identity() };
		ob_ode_solid end = ob_ode_solid_make(OB_SHAPE_SPHERE, ob_v3(capsule->size.x, 0, 0), pose);
		ob_ode_point point[RAW_MAX];
		if (collide(&end, pose.q, other, q, margin, point) != 1)
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
static void spread(ob_ode_point *point, int n)
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
static int mend(const ob_ode_solid *a, const ob_ode_solid *b, double margin, ob_ode_point *out, int n)
{
	ob_ode_point p = ob_ode_axis_contact(a, b, n ? out[0].normal : ob_sub(a->p, b->p));
	double deepest = INFINITY;
	for (int i = 0; i < n; i++)
		deepest = fmin(deepest, out[i].gap);
	if (n >= 2 && deepest > p.gap - 1e-4 * (ob_ode_solid_radius(a) + ob_ode_solid_radius(b)))
		return n;
	out[0] = p;
	return p.gap < margin;
}

// The point of the capsule's core nearest to the cylinder, by golden section (Kiefer 1953): their distance is convex.
static ob_pose nearest_core(const ob_ode_solid *capsule, const ob_ode_solid *cylinder)
{
	const double golden = .6180339887498949;
	ob_vec3 axis = ob_column(&capsule->r, 2);
	double low = -capsule->size.y, high = capsule->size.y;
	for (int i = 0; i < 40; i++) {
		double left = high - golden * (high - low), right = low + golden * (high - low);
		ob_vec3 at_left = ob_madd(capsule->p, left, axis), at_right = ob_madd(capsule->p, right, axis);
		if (ob_norm2(ob_sub(at_left, ob_ode_solid_nearest(cylinder, at_left))) <
		    ob_norm2(ob_sub(at_right, ob_ode_solid_nearest(cylinder, at_right))))
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
static int find(const ob_ode_solid *a, ob_quat qa, const ob_ode_solid *b, ob_quat qb, double margin, ob_ode_point *out)
{
	bool edged_a = a->shape == OB_SHAPE_CYLINDER || a->shape == OB_SHAPE_BOX;
	bool edged_b = b->shape == OB_SHAPE_CYLINDER || b->shape == OB_SHAPE_BOX;
	if (a->shape == OB_SHAPE_CAPSULE && b->shape == OB_SHAPE_CYLINDER) {
		ob_ode_solid end = ob_ode_solid_make(OB_SHAPE_SPHERE, a->size, nearest_core(a, b));
		return collide(&end, ob_quat_identity(), b, qb, margin, out);
	}
	if (b->shape == OB_SHAPE_CAPSULE && a->shape == OB_SHAPE_CYLINDER) {
		ob_ode_solid end = ob_ode_solid_make(OB_SHAPE_SPHERE, b->size, nearest_core(b, a));
		return collide(a, qa, &end, ob_quat_identity(), margin, out);
	}
	int n = collide(a, qa, b, qb, margin, out);
	bool mended = edged_a && edged_b && (a->shape == OB_SHAPE_CYLINDER || b->shape == OB_SHAPE_CYLINDER) &&
		      ob_norm(ob_sub(a->p, b->p)) < ob_ode_solid_radius(a) + ob_ode_solid_radius(b) + margin;
	return mended ? mend(a, b, margin, out, n) : n;
}

int ob_ode_collide(ob_shape sa, ob_vec3 size_a, ob_pose pa, ob_shape sb, ob_vec3 size_b, ob_pose pb, double margin,
		   ob_ode_point *out, int max)
{
	ob_ode_solid a = ob_ode_solid_make(sa, size_a, pa), b = ob_ode_solid_make(sb, size_b, pb);
	ob_ode_point point[RAW_MAX + 4];
	if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_PLANE)
		return 0;
	int n = find(&a, pa.q, &b, pb.q, margin, point);
	if (n == 1 && has_ends(sa, sb))
		n = add_ends(&a, &b, pb.q, 1, margin, point, n);
	if (n >= 1 && n <= 3 && has_ends(sb, sa))
		n = add_ends(&b, &a, pa.q, -1, margin, point, n);
	spread(point, n);
	max = max < POINTS_MAX ? max : POINTS_MAX;
	n = n < max ? n : max;
	for (int i = 0; i < n; i++)
		out[i] = point[i];
	return n;
}
