#include "ode/ode_collide.h"

#include "ode/ode_geom.h"
#include "ode/ode_solid.h"

enum { RAW_MAX = 16, POINTS_MAX = 8 };

// A pair with both its true and its inflated shapes.
struct pair {
	ob_ode_solid a, b, fat_a, fat_b;
	double half; // m, half the margin
};

// ODE says neither on whose surface its point lies nor whether it lies between both: how deep it is in each tells.
static void straighten(const struct pair *p, const dContactGeom *c, bool alone, ob_ode_point *out)
{
	ob_vec3 x = ob_v3(c->pos[0], c->pos[1], c->pos[2]);
	ob_vec3 n = ob_v3(c->normal[0], c->normal[1], c->normal[2]);
	double in_a = ob_ode_solid_inside(&p->fat_a, x), in_b = ob_ode_solid_inside(&p->fat_b, x);
	double share = in_a + in_b > 0 ? in_a / (in_a + in_b) : .5;
	// a's surface lies lower than b's by the depth, seen along the normal
	ob_vec3 on_a = ob_madd(x, -share * c->depth, n), on_b = ob_madd(x, (1 - share) * c->depth, n);
	on_a = ob_ode_solid_nearest(&p->a, on_a);
	on_b = ob_ode_solid_nearest(&p->b, on_b);
	// A single point is where both extents along the normal are reached, and their growth is known exactly.
	// Of several, the others grew by less.
	double extent_gap = ob_ode_solid_growth(&p->a, n, p->half) + ob_ode_solid_growth(&p->b, n, p->half) - c->depth;
	double point_gap = ob_dot(n, ob_sub(on_a, on_b));
	out->gap = alone ? extent_gap : fmin(point_gap, extent_gap);
	out->normal = n;
	out->position = ob_scale(ob_add(on_a, on_b), .5);
}

static dGeomID make_geom(const ob_ode_solid *fat, ob_pose pose, double half)
{
	dGeomID g = ob_ode_geom_create(0, fat->shape, fat->size);
	if (fat->shape == OB_SHAPE_PLANE)
		pose.p = ob_madd(pose.p, half, ob_column(&fat->r, 2));
	if (g)
		ob_ode_geom_place(g, pose);
	return g;
}

static ob_ode_solid fatten(const ob_ode_solid *s, double half)
{
	ob_ode_solid fat = *s;
	fat.size = ob_ode_solid_inflate(s->shape, s->size, half);
	if (s->shape == OB_SHAPE_PLANE)
		fat.p = ob_madd(s->p, half, ob_column(&s->r, 2));
	return fat;
}

static int collide(const ob_ode_solid *a, ob_pose pa, const ob_ode_solid *b, ob_pose pb, double margin,
		   ob_ode_point *out)
{
	struct pair p = { *a, *b, fatten(a, .5 * margin), fatten(b, .5 * margin), .5 * margin };
	dGeomID ga = make_geom(&p.fat_a, pa, p.half), gb = make_geom(&p.fat_b, pb, p.half);
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
static int add_ends(const ob_ode_solid *capsule, const ob_ode_solid *other, ob_pose other_pose, double sign,
		    double margin, ob_ode_point *out, int n)
{
	ob_vec3 normal = out[0].normal, axis = ob_column(&capsule->r, 2);
	double at[2] = { -capsule->size.y, capsule->size.y };
	if (!ob_ode_solid_clip(other, normal, capsule->p, axis, &at[0], &at[1]))
		return n;
	for (int i = 0; i < 2; i++) {
		ob_pose pose = { ob_madd(capsule->p, at[i], axis), ob_quat_identity() };
		ob_ode_solid end = ob_ode_solid_make(OB_SHAPE_SPHERE, ob_v3(capsule->size.x, 0, 0), pose);
		ob_ode_point point[RAW_MAX];
		if (collide(&end, pose, other, other_pose, margin, point) != 1)
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

int ob_ode_collide(ob_shape sa, ob_vec3 size_a, ob_pose pa, ob_shape sb, ob_vec3 size_b, ob_pose pb, double margin,
		   ob_ode_point *out, int max)
{
	ob_ode_solid a = ob_ode_solid_make(sa, size_a, pa), b = ob_ode_solid_make(sb, size_b, pb);
	ob_ode_point point[RAW_MAX + 4];
	if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_PLANE)
		return 0;
	int n = collide(&a, pa, &b, pb, margin, point);
	if (n == 1 && sa == OB_SHAPE_CAPSULE && sb != OB_SHAPE_SPHERE && sb != OB_SHAPE_PLANE)
		n = add_ends(&a, &b, pb, 1, margin, point, n);
	if (n >= 1 && n <= 3 && sb == OB_SHAPE_CAPSULE && sa != OB_SHAPE_SPHERE && sa != OB_SHAPE_PLANE)
		n = add_ends(&b, &a, pa, -1, margin, point, n);
	spread(point, n);
	max = max < POINTS_MAX ? max : POINTS_MAX;
	n = n < max ? n : max;
	for (int i = 0; i < n; i++)
		out[i] = point[i];
	return n;
}
