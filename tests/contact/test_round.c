// Contacts of capsules and cylinders with all shapes, against slow methods without closed forms.
#include "check.h"
#include "convex.h"

static const double tiny = 1e-11; // m
static const ob_shape round_shapes[] = { OB_SHAPE_CYLINDER, OB_SHAPE_CAPSULE };
static const ob_shape other_shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_PLANE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE,
					 OB_SHAPE_CYLINDER };
enum { ROUND = sizeof round_shapes / sizeof *round_shapes, OTHER = sizeof other_shapes / sizeof *other_shapes };

static ob_manifold find(const ob_placed *a, const ob_placed *b, double margin)
{
	ob_manifold m;
	CHECK(ob_manifold_find(a, b, margin, &m));
	return m;
}

typedef struct two {
	ob_placed a, b;
} two;

// Number k of a sequence of random pairs; if "near", a is moved to about this distance from b (m).
static two random_two(uint64_t *seed, int k, bool near, double distance)
{
	two t;
	t.a = random_placed(seed, round_shapes[k % ROUND], 1.5);
	t.b = random_placed(seed, other_shapes[k / ROUND % OTHER], 1.5);
	for (int i = 0; near && i < 4; i++) {
		ob_manifold m = find(&t.a, &t.b, 9);
		t.a.p = ob_madd(t.a.p, distance - m.separation, m.normal);
	}
	return t;
}

// The separation is the distance while the shapes are apart; if they overlap, no direction has less overlap.
static void test_separation(void)
{
	uint64_t seed = 1;
	int apart = 0, slow = 0;
	for (int i = 0; i < 4000; i++) {
		two t = random_two(&seed, i, i & 1, within(&seed, -.05, .1));
		ob_manifold m = find(&t.a, &t.b, 9);
		CHECK(m.points > 0);
		CHECK_NEAR(ob_norm(m.normal), 1, tiny);
		CHECK_NEAR(apart_along(&t.a, &t.b, m.normal), m.separation, tiny);
		if (m.separation > 0) {
			double distance = distance_from_above(&t.a, &t.b, 3000);
			CHECK(m.separation <= distance + tiny);
			apart++;
			slow += distance - m.separation > 1e-5;
		} else if (t.b.shape != OB_SHAPE_PLANE) {
			CHECK(farthest_apart(&seed, &t.a, &t.b, 100) <= m.separation + 1e-5);
		}
	}
	CHECK(apart > 1000);
	CHECK(slow < apart / 50); // projections between nearly parallel surfaces take longer
}

static ob_vec3 point_of_rim(const ob_placed *cylinder, ob_vec3 n)
{
	const ob_vec3 axis = ob_column(&cylinder->r, 2), side = ob_madd(n, -ob_dot(n, axis), axis);
	return ob_madd(ob_madd(cylinder->p, copysign(cylinder->size.y, ob_dot(n, axis)), axis),
		       cylinder->size.x / ob_norm(side), side);
}

// Cylinders whose rims are nearest, at a known distance along a known direction. Cylinders that are almost parallel,
// slightly beside each other, overlap by as little along many directions: the ridge is long and almost flat.
static void test_rims(void)
{
	uint64_t seed = 8;
	for (int i = 0; i < 20000; i++) {
		const double lean = i & 1 ? .1 : 2, gap = i & 2 ? within(&seed, 0, 1e-4) : within(&seed, 0, .1);
		const ob_vec3 n = random_direction(&seed), leans = random_vector(&seed, lean);
		two t;
		t.b = random_placed(&seed, OB_SHAPE_CYLINDER, 1);
		t.a = t.b;
		if (i & 4)
			t.a.size = random_size(&seed);
		const ob_mat3 turn = ob_quat_matrix(ob_quat_turn(ob_quat_identity(), leans));
		for (int c = 0; c < 3; c++) {
			const ob_vec3 axis = ob_rotate(&turn, ob_column(&t.b.r, c));
			t.a.r.m[0][c] = axis.x, t.a.r.m[1][c] = axis.y, t.a.r.m[2][c] = axis.z;
		}
		t.a.p = ob_add(t.a.p,
			       ob_sub(ob_madd(point_of_rim(&t.b, n), gap, n), point_of_rim(&t.a, ob_scale(n, -1))));
		ob_manifold m = find(&t.a, &t.b, 9);
		CHECK_NEAR(m.separation, gap, 1e-9);
	}
}

// The first point's gap is the separation, no gap exceeds the margin, all points lie between the surfaces, and none is
// a duplicate.
static void test_points(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 8000; i++) {
		double gap = within(&seed, -.03, .03), margin = within(&seed, -.02, .1);
		two t = random_two(&seed, i, true, gap);
		ob_manifold m = find(&t.a, &t.b, margin);
		CHECK((m.points > 0) == (m.separation <= margin));
		double least = INFINITY;
		for (int k = 0; k < m.points; k++) {
			least = fmin(least, m.gap[k]);
			CHECK(m.gap[k] <= margin);
			ob_vec3 on_a = ob_madd(m.at[k], .5 * m.gap[k], m.normal);
			ob_vec3 on_b = ob_madd(m.at[k], -.5 * m.gap[k], m.normal);
			// a point beside the nearest may have a normal of its own, .14 rad away at most
			double loose = k ? .08 * fabs(m.gap[k]) + 1e-3 : 2e-9;
			CHECK(ob_norm(ob_sub(nearest_in(&t.a, on_a), on_a)) < loose);
			CHECK(ob_norm(ob_sub(nearest_in(&t.b, on_b), on_b)) < loose);
			for (int j = 0; j < k; j++)
				CHECK(ob_norm(ob_sub(m.at[j], m.at[k])) > 1e-6);
		}
		CHECK(m.points == 0 || fabs(least - m.separation) < 2e-9);
	}
}

// ties: rounding may decide about a point on the limit of the margin.
static void check_same(const ob_manifold *m, const ob_manifold *n, const rigid *g, double sign, int *ties)
{
	CHECK_NEAR(n->separation, m->separation, tiny);
	*ties += n->points != m->points;
	if (n->points != m->points || !m->points)
		return;
	CHECK_NEAR(ob_norm(ob_sub(rigid_turn(g, m->normal), ob_scale(n->normal, sign))), 0, 1e-8);
	for (int k = 0; k < m->points; k++) {
		double nearest = INFINITY;
		int same = 0;
		for (int j = 0; j < n->points; j++) {
			double from = ob_norm(ob_sub(n->at[j], rigid_point(g, m->at[k])));
			if (from < nearest)
				nearest = from, same = j;
		}
		CHECK_NEAR(nearest, 0, 1e-8);
		CHECK_NEAR(n->gap[same], m->gap[k], 1e-8);
	}
}

static ob_placed turned(const rigid *g, const ob_placed *x)
{
	ob_placed y = *x;
	ob_mat3 r = ob_quat_matrix(g->q);
	y.p = rigid_point(g, x->p);
	y.v = rigid_turn(g, x->v);
	for (int c = 0; c < 3; c++) {
		ob_vec3 axis = ob_rotate(&r, ob_column(&x->r, c));
		y.r.m[0][c] = axis.x, y.r.m[1][c] = axis.y, y.r.m[2][c] = axis.z;
	}
	return y;
}

// The same with the shapes swapped and in a rotated world.
static void test_invariance(void)
{
	const rigid still = { { 0, 0, 0 }, ob_quat_identity() };
	uint64_t seed = 3;
	int ties = 0;
	for (int i = 0; i < 6000; i++) {
		two t = random_two(&seed, i, true, within(&seed, -.02, .02));
		ob_manifold m = find(&t.a, &t.b, .05), n = find(&t.b, &t.a, .05);
		check_same(&m, &n, &still, -1, &ties);
		rigid g = random_rigid(&seed);
		ob_placed a = turned(&g, &t.a), b = turned(&g, &t.b);
		n = find(&a, &b, .05);
		check_same(&m, &n, &g, 1, &ties);
	}
	CHECK(ties < 6);
}

// On a path past each other the separation changes by no more than the path's length, and the normal changes smoothly
// while the shapes are apart.
static void test_continuity(void)
{
	uint64_t seed = 4;
	for (int i = 0; i < 200; i++) {
		two t = random_two(&seed, i, true, within(&seed, -.01, .05));
		ob_vec3 way = random_direction(&seed), turn = random_vector(&seed, 2);
		const double step = 1e-3;
		double last = NAN;
		for (int k = 0; k < 400; k++) {
			ob_manifold m = find(&t.a, &t.b, 9);
			if (k > 0)
				CHECK(fabs(m.separation - last) <= step * (1 + ob_norm(turn) * 2) + tiny);
			last = m.separation;
			t.a.p = ob_madd(t.a.p, step, way);
			rigid g = { { 0, 0, 0 }, ob_quat_turn(ob_quat_identity(), ob_scale(turn, step)) };
			ob_vec3 p = t.a.p;
			t.a = turned(&g, &t.a);
			t.a.p = p;
		}
	}
}

static void check_two_points(const ob_placed *a, const ob_placed *b, ob_vec3 n, ob_vec3 one, ob_vec3 other, double gap)
{
	for (int swapped = 0; swapped < 2; swapped++) {
		ob_manifold m = find(swapped ? b : a, swapped ? a : b, .1);
		CHECK(m.points == 2);
		CHECK_NEAR(ob_norm(ob_sub(m.normal, ob_scale(n, swapped ? -1 : 1))), 0, 1e-9);
		for (int k = 0; k < m.points; k++) {
			double from_one = ob_norm(ob_sub(m.at[k], one)), from_other = ob_norm(ob_sub(m.at[k], other));
			CHECK_NEAR(m.gap[k], gap, 1e-9);
			CHECK(fmin(from_one, from_other) < 1e-7);
		}
		if (m.points == 2)
			CHECK(ob_norm(ob_sub(m.at[0], m.at[1])) > .9 * ob_norm(ob_sub(one, other)));
	}
}

// A capsule along another shape has two contact points: at the ends of their overlap.
static void test_capsule_lies(void)
{
	uint64_t seed = 5;
	for (int i = 0; i < 500; i++) {
		rigid g = random_rigid(&seed);
		double r = within(&seed, .05, .3), l = within(&seed, .3, 1), gap = within(&seed, -.01, .02);
		double angle = within(&seed, -3, 3), x = within(&seed, -.3, .3);
		ob_quat flat = ob_quat_turn(ob_quat_identity(), ob_v3(0, M_PI / 2, 0)); // the axis along x
		ob_quat about = ob_quat_mul(ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, angle)), flat);
		ob_vec3 n = rigid_turn(&g, ob_v3(0, 0, 1)), u = ob_v3(cos(angle), sin(angle), 0);
		ob_placed capsule = rigid_place(&g, OB_SHAPE_CAPSULE, ob_v3(r, l, 0), ob_v3(x, 0, 1 + r + gap), about);
		ob_placed plane = rigid_place(&g, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 1), ob_quat_identity());
		ob_placed slab = rigid_place(&g, OB_SHAPE_BOX, ob_v3(2, 3, 1), ob_v3(0, 0, 0), ob_quat_identity());
		ob_vec3 middle = ob_v3(x, 0, 1 + .5 * gap);
		ob_vec3 one = rigid_point(&g, ob_madd(middle, l, u)), other = rigid_point(&g, ob_madd(middle, -l, u));
		check_two_points(&capsule, &plane, n, one, other, gap);
		check_two_points(&capsule, &slab, n, one, other, gap);
		// across a beam of half width .2, along x
		capsule = rigid_place(&g, OB_SHAPE_CAPSULE, ob_v3(r, l, 0), ob_v3(x, 0, 1 + r + gap), flat);
		ob_placed beam = rigid_place(&g, OB_SHAPE_BOX, ob_v3(.2, 3, 1), ob_v3(0, 0, 0), ob_quat_identity());
		double low = fmax(-.2, x - l), high = fmin(.2, x + l);
		if (high - low < .05)
			continue;
		one = rigid_point(&g, ob_v3(low, 0, 1 + .5 * gap));
		other = rigid_point(&g, ob_v3(high, 0, 1 + .5 * gap));
		check_two_points(&capsule, &beam, n, one, other, gap);
		// along another capsule, and along the edge of a box that stands on it
		ob_placed under = rigid_place(&g, OB_SHAPE_CAPSULE, ob_v3(.7, .2, 0), ob_v3(0, 0, .3), flat);
		check_two_points(&capsule, &under, n, one, other, gap);
		ob_quat on_edge = ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 4, 0, 0));
		ob_placed roof = rigid_place(&g, OB_SHAPE_BOX, ob_v3(.2, .5, .5), ob_v3(0, 0, 1 - sqrt(.5)), on_edge);
		check_two_points(&capsule, &roof, n, one, other, gap);
	}
}

static ob_placed ground(const rigid *g)
{
	return rigid_place(g, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0), ob_quat_identity());
}

// A cylinder stands on four points of its rim, tilts on the lowest point of its rim, and lies on the two ends of a
// line.
static void test_cylinder_on_plane(void)
{
	uint64_t seed = 7;
	for (int i = 0; i < 2000; i++) {
		rigid g = random_rigid(&seed);
		double r = within(&seed, .1, .5), h = within(&seed, .1, .5), gap = within(&seed, -.01, .01);
		double lean = i % 3 ? within(&seed, .01, 1.5) : 0, spin = within(&seed, -3, 3),
		       towards = within(&seed, -3, 3);
		ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, spin));
		q = ob_quat_turn(q, ob_scale(ob_v3(-sin(towards), cos(towards), 0), lean)); // leans towards this angle
		double reaches = r * sin(lean) + h * cos(lean);
		ob_placed plane = ground(&g),
			  c = rigid_place(&g, OB_SHAPE_CYLINDER, ob_v3(r, h, 0), ob_v3(0, 0, reaches + gap), q);
		ob_manifold m = find(&c, &plane, .02);
		CHECK_NEAR(m.separation, gap, tiny);
		CHECK_NEAR(m.gap[0], gap, tiny);
		double out = r * cos(lean) - h * sin(lean); // the lowest point, seen from the axis
		ob_vec3 lowest = ob_v3(out * cos(towards), out * sin(towards), .5 * gap);
		if (lean > 0)
			CHECK_NEAR(ob_norm(ob_sub(m.at[0], rigid_point(&g, lowest))), 0, 1e-9);
		CHECK(!m.points || m.disc_radius == (lean > 0 ? -r : r));
		for (int k = 0; lean == 0 && k < 4; k++) {
			CHECK_NEAR(m.gap[k], gap, tiny);
			CHECK_NEAR(ob_norm(ob_sub(m.at[k], rigid_point(&g, ob_v3(0, 0, .5 * gap)))), r, tiny);
			CHECK_NEAR(ob_norm(ob_sub(m.at[k], m.at[(k + 1) & 3])), sqrt(2) * r, tiny);
		}
	}
	rigid g = random_rigid(&seed);
	ob_quat flat = ob_quat_turn(ob_quat_identity(), ob_v3(0, M_PI / 2, 0));
	ob_placed plane = ground(&g), c = rigid_place(&g, OB_SHAPE_CYLINDER, ob_v3(.2, .4, 0), ob_v3(0, 0, .201), flat);
	check_two_points(&c, &plane, rigid_turn(&g, ob_v3(0, 0, 1)), rigid_point(&g, ob_v3(.4, 0, .0005)),
			 rigid_point(&g, ob_v3(-.4, 0, .0005)), .001);
}

// On a slope the first point of the rim is where the cylinder would tip over.
static void test_pressed_side(void)
{
	ob_quat slope = ob_quat_turn(ob_quat_identity(), ob_v3(.3, 0, 0));
	const rigid g = { { 1, 2, 3 }, slope };
	ob_placed plane = ground(&g),
		  slab = rigid_place(&g, OB_SHAPE_BOX, ob_v3(2, 2, 1), ob_v3(0, 0, -1), ob_quat_identity());
	ob_placed c = rigid_place(&g, OB_SHAPE_CYLINDER, ob_v3(.2, .4, 0), ob_v3(0, 0, .4), ob_quat_identity());
	c.a = ob_v3(0, 0, -9.81);
	for (int swapped = 0; swapped < 2; swapped++) {
		ob_manifold m = find(&c, &plane, .01), n = swapped ? find(&slab, &c, .01) : find(&c, &slab, .01);
		ob_vec3 down = rigid_point(&g, ob_v3(0, -.2, 0));
		CHECK_NEAR(ob_norm(ob_sub(m.at[0], down)), 0, 1e-9);
		CHECK_NEAR(ob_norm(ob_sub(n.at[0], down)), 0, 1e-9);
		CHECK(m.points == 4 && n.points == 4 && n.disc_radius == .2);
	}
}

// Two cylinders stand on each other: contacts on the smaller rim, or on the lens that their caps share.
static void test_caps(void)
{
	uint64_t seed = 8;
	for (int i = 0; i < 1000; i++) {
		rigid g = random_rigid(&seed);
		double r = within(&seed, .1, .5), q = within(&seed, .1, .5), x = within(&seed, 0, r + q - .02);
		double gap = within(&seed, -.01, .01);
		ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, within(&seed, -3, 3)));
		ob_placed b = rigid_place(&g, OB_SHAPE_CYLINDER, ob_v3(r, .3, 0), ob_v3(0, 0, -.3), ob_quat_identity());
		ob_placed a = rigid_place(&g, OB_SHAPE_CYLINDER, ob_v3(q, .2, 0), ob_v3(x, 0, .2 + gap), turn);
		ob_manifold m = find(&a, &b, .02);
		CHECK(m.points == 4);
		CHECK_NEAR(ob_norm(ob_sub(m.normal, rigid_turn(&g, ob_v3(0, 0, 1)))), 0, 1e-9);
		double inside = fmin(r, q);
		CHECK_NEAR(m.disc_radius, x + inside <= fmax(r, q) ? inside : 0, 1e-12);
		for (int k = 0; k < m.points; k++) {
			double from_b = ob_norm(ob_sub(m.at[k], rigid_point(&g, ob_v3(0, 0, .5 * gap))));
			double from_a = ob_norm(ob_sub(m.at[k], rigid_point(&g, ob_v3(x, 0, .5 * gap))));
			CHECK_NEAR(m.gap[k], gap, 1e-12);
			CHECK(from_b < r + 1e-8 && from_a < q + 1e-8);
			CHECK(fabs(from_b - r) < 1e-8 || fabs(from_a - q) < 1e-8);
		}
	}
}

// The edge of a box does not stop a cylinder that falls past it, slightly beside it, but one that lands on it.
static void test_passes_by(void)
{
	ob_placed box = place(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed c = place(OB_SHAPE_CYLINDER, ob_v3(.2, .3, 0), ob_v3(.702, 0, .803), ob_quat_identity());
	c.v = ob_v3(0, 0, -5);
	ob_manifold m = find(&c, &box, .02);
	CHECK(m.points == 0 || fabs(m.normal.z) < 1e-6);
	c.v = ob_v3(-5, 0, -1); // over the edge before it is down
	m = find(&c, &box, .02);
	CHECK(m.points == 0 || m.normal.z > 1 - 1e-6);
}

int main(void)
{
	test_cylinder_on_plane();
	test_pressed_side();
	test_caps();
	test_passes_by();
	test_separation();
	test_rims();
	test_points();
	test_invariance();
	test_continuity();
	test_capsule_lies();
	return check_end();
}
