// Two bodies that pass each other, held apart only by the contact points found between them. As long as none of these
// closes below zero, the bodies penetrate no deeper than they may at rest, in any motion. Boxes, hulls and both, in all
// attitudes and nearly flat on each other, slow and fast.
#include "check.h"
#include "hull/hull.h"
#include "placed.h"

static const double rest = 2e-5, far_future = 3; // m, s

typedef enum attitude { ANY, TILTED, FLAT, ATTITUDES } attitude;

static void make_hull_of_box(ob_placed *x, ob_hull *hull)
{
	ob_vec3 corner[8];
	ob_error e;
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? x->size.x : -x->size.x, k & 2 ? x->size.y : -x->size.y,
				  k & 4 ? x->size.z : -x->size.z);
	CHECK(ob_hull_build(corner, 8, hull, &e));
	x->shape = OB_SHAPE_HULL;
	x->size = ob_hull_size(hull);
	x->hull = hull;
}

static ob_placed moved(const ob_placed *x, double t)
{
	const ob_mat3 turn = ob_quat_matrix(ob_quat_turn(ob_quat_identity(), ob_scale(x->w, t)));
	ob_placed out = *x;
	out.p = ob_madd(x->p, t, x->v);
	for (int c = 0; c < 3; c++) {
		const ob_vec3 axis = ob_rotate(&turn, ob_column(&x->r, c));
		out.r.m[0][c] = axis.x, out.r.m[1][c] = axis.y, out.r.m[2][c] = axis.z;
	}
	return out;
}

static ob_manifold find(const ob_placed *a, const ob_placed *b, double margin)
{
	ob_manifold m = { .valid_path = INFINITY };
	CHECK(ob_manifold_find(a, b, margin, &m));
	return m;
}

// m/s at which a point of the manifold opens
static double opening(const ob_placed *a, const ob_placed *b, const ob_manifold *m, int k)
{
	const ob_vec3 va = ob_add(a->v, ob_cross(a->w, ob_sub(m->at[k], a->p))),
		      vb = ob_add(b->v, ob_cross(b->w, ob_sub(m->at[k], b->p)));
	return ob_dot(m->normal, ob_sub(va, vb));
}

// Pushes a off along the normal, so that no point closes below zero within h. true: a push was needed
static bool hold(ob_placed *a, const ob_placed *b, double h)
{
	const double speed = ob_norm(ob_sub(a->v, b->v)) + 2 * (ob_norm(a->w) + ob_norm(b->w));
	const ob_manifold m = find(a, b, 2 * speed * h);
	double push = 0;
	for (int k = 0; k < m.points; k++)
		push = fmax(push, -fmax(m.gap[k], 0) / h - opening(a, b, &m, k));
	a->v = ob_madd(a->v, push, m.normal);
	return push > 0;
}

// m: deepest penetration within t, with contacts applied every h (s)
static double deepest(ob_placed a, ob_placed b, double t, double h, int *held)
{
	double most = 0;
	bool any = false;
	for (double now = 0; now < t; now += h) {
		any |= hold(&a, &b, h);
		a = moved(&a, h);
		b = moved(&b, h);
		most = fmax(most, -find(&a, &b, 0).separation);
	}
	*held += any;
	return most;
}

// Moves a until the separation is a hair.
static void bring_near(ob_placed *a, const ob_placed *b)
{
	const double hair = 1e-4; // m
	for (int i = 0; i < 40; i++) {
		const ob_manifold m = find(a, b, 10);
		a->p = ob_madd(a->p, hair - m.separation, m.normal);
	}
}

static void draw_pair(uint64_t *seed, attitude kind, ob_placed *a, ob_placed *b)
{
	*b = random_placed(seed, OB_SHAPE_BOX, 0);
	*a = random_placed(seed, OB_SHAPE_BOX, 1);
	if (kind != ANY) {
		const ob_quat about = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, within(seed, -3, 3)));
		b->r = ob_quat_matrix(ob_quat_identity());
		a->r = ob_quat_matrix(ob_quat_turn(about, random_vector(seed, kind == TILTED ? .2 : 1e-3)));
		a->p.z = a->size.z + b->size.z;
	}
	a->rest_depth = b->rest_depth = rest;
	a->far_future = b->far_future = far_future;
}

static void set_moving(uint64_t *seed, double speed, ob_placed *x)
{
	x->v = random_vector(seed, speed);
	x->w = random_vector(seed, 2);
}

// The error between two instants is of second order in h; first order would be millimetres here.
static void test_passing(attitude kind, bool hull_a, bool hull_b)
{
	enum { PAIRS = 250 };
	const double h = 2.5e-5, deepest_allowed = 2 * rest + 3 * h; // s, m
	uint64_t seed = 1;
	double worst = 0;
	int held = 0;
	for (int i = 0; i < PAIRS; i++) {
		ob_hull of_a, of_b;
		ob_placed a, b;
		draw_pair(&seed, kind, &a, &b);
		if (hull_a)
			make_hull_of_box(&a, &of_a);
		if (hull_b)
			make_hull_of_box(&b, &of_b);
		bring_near(&a, &b);
		set_moving(&seed, i % 2 ? 7 : 1, &a);
		set_moving(&seed, i % 2 ? 7 : 1, &b);
		worst = fmax(worst, deepest(a, b, .02, h, &held));
	}
	printf("attitude %d, %s and %s: %.1f um deep at most, %d of %d were held\n", (int)kind, hull_a ? "hull" : "box",
	       hull_b ? "hull" : "box", 1e6 * worst, held, PAIRS);
	CHECK(worst < deepest_allowed);
	CHECK(held > PAIRS / 5);
}

int main(void)
{
	for (int kind = 0; kind < ATTITUDES; kind++)
		for (int hulls = 0; hulls < 4; hulls++)
			test_passing((attitude)kind, hulls & 1, hulls & 2);
	return check_end();
}
