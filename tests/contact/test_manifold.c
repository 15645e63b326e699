// Contacts of two shapes, against scenes with known solutions, in random places and attitudes.
#include "contact/pairs.h"

#include "check.h"
#include "placed.h"

static const double tiny = 1e-12; // m

static void check_vector(ob_vec3 a, ob_vec3 b, double tolerance)
{
	CHECK_NEAR(ob_norm(ob_sub(a, b)), 0, tolerance);
}

// Checks for a single known point; also with the shapes swapped.
static void check_point(const ob_placed *a, const ob_placed *b, ob_vec3 normal, ob_vec3 at, double gap)
{
	for (int swapped = 0; swapped < 2; swapped++) {
		ob_manifold m;
		CHECK(ob_manifold_find(swapped ? b : a, swapped ? a : b, gap + .001, &m));
		CHECK(m.points == 1);
		check_vector(m.normal, ob_scale(normal, swapped ? -1 : 1), tiny);
		check_vector(m.at[0], at, tiny);
		CHECK_NEAR(m.gap[0], gap, tiny);
		CHECK_NEAR(m.separation, gap, tiny);
		CHECK(ob_manifold_find(swapped ? b : a, swapped ? a : b, gap - .001, &m));
		CHECK(m.points == 0);
		CHECK_NEAR(m.separation, gap, tiny);
	}
}

static void test_sphere_with_sphere_and_plane(void)
{
	uint64_t seed = 1;
	for (int i = 0; i < 1000; i++) {
		ob_placed b = random_placed(&seed, OB_SHAPE_SPHERE, 3), a = random_placed(&seed, OB_SHAPE_SPHERE, 3);
		ob_vec3 n = random_direction(&seed);
		double gap = within(&seed, -.09, .3);
		a.p = ob_madd(b.p, a.size.x + b.size.x + gap, n);
		check_point(&a, &b, n, ob_madd(b.p, b.size.x + .5 * gap, n), gap);
		rigid g = random_rigid(&seed);
		double x = within(&seed, -9, 9), y = within(&seed, -9, 9), r = a.size.x;
		ob_placed plane = rigid_place(&g, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0), ob_quat_identity());
		a.p = rigid_point(&g, ob_v3(x, y, r + gap));
		check_point(&a, &plane, rigid_turn(&g, ob_v3(0, 0, 1)), rigid_point(&g, ob_v3(x, y, .5 * gap)), gap);
	}
}

// The sphere's centre is over a face, an edge or a corner: outside it, there is a cone of directions.
static void test_sphere_outside_box(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 3000; i++) {
		rigid g = random_rigid(&seed);
		ob_vec3 size = random_size(&seed);
		double h[3] = { size.x, size.y, size.z }, on[3], out[3];
		int fixed = 1 + i % 3, first = i / 3 % 3; // coordinates on the box's border: face, edge, corner
		for (int c = 0; c < 3; c++) {
			bool at_border = (c + 3 - first) % 3 < fixed;
			double side = uniform(&seed) < .5 ? -1 : 1;
			on[c] = at_border ? side * h[c] : within(&seed, -h[c], h[c]);
			out[c] = at_border ? side * within(&seed, .1, 1) : 0;
		}
		ob_vec3 surface = ob_v3(on[0], on[1], on[2]), n = ob_v3(out[0], out[1], out[2]);
		n = ob_scale(n, 1 / ob_norm(n));
		double r = within(&seed, .1, 1), gap = within(&seed, -.09, .3);
		ob_placed box = rigid_place(&g, OB_SHAPE_BOX, size, ob_v3(0, 0, 0), ob_quat_identity());
		ob_placed ball = rigid_place(&g, OB_SHAPE_SPHERE, ob_v3(r, 0, 0), ob_madd(surface, r + gap, n),
					     random_attitude(&seed));
		check_point(&ball, &box, rigid_turn(&g, n), rigid_point(&g, ob_madd(surface, .5 * gap, n)), gap);
	}
}

// The centre is inside: the normal is that of the nearest face.
static void test_sphere_inside_box(void)
{
	uint64_t seed = 3;
	for (int i = 0; i < 1000; i++) {
		rigid g = random_rigid(&seed);
		ob_vec3 size = ob_v3(1, 2, 3);
		double h[3] = { 1, 2, 3 }, p[3], n[3] = { 0 }, depth = within(&seed, .01, .4), r = within(&seed, .1, 1);
		int face = i % 3;
		for (int c = 0; c < 3; c++) // all other faces are farther than .4
			p[c] = within(&seed, -h[c] + .5, h[c] - .5);
		n[face] = i % 2 ? 1 : -1;
		p[face] = n[face] * (h[face] - depth);
		ob_vec3 normal = ob_v3(n[0], n[1], n[2]), at = ob_v3(p[0], p[1], p[2]);
		ob_placed box = rigid_place(&g, OB_SHAPE_BOX, size, ob_v3(0, 0, 0), ob_quat_identity());
		ob_placed ball = rigid_place(&g, OB_SHAPE_SPHERE, ob_v3(r, 0, 0), at, ob_quat_identity());
		double gap = -depth - r;
		ob_vec3 midway = ob_madd(at, depth + .5 * gap, normal);
		check_point(&ball, &box, rigid_turn(&g, normal), rigid_point(&g, midway), gap);
	}
}

// The corners within the margin, four at most, the lowest first.
static void test_box_on_plane(void)
{
	uint64_t seed = 4;
	for (int i = 0; i < 2000; i++) {
		rigid g = random_rigid(&seed);
		ob_vec3 size = random_size(&seed), local = random_vector(&seed, 3);
		ob_quat q = random_attitude(&seed);
		ob_mat3 r = ob_quat_matrix(q);
		double height[8], low = INFINITY, margin = within(&seed, 0, 1);
		for (int k = 0; k < 8; k++) {
			ob_vec3 corner =
				ob_v3(k & 1 ? size.x : -size.x, k & 2 ? size.y : -size.y, k & 4 ? size.z : -size.z);
			height[k] = ob_rotate(&r, corner).z;
			low = fmin(low, height[k]);
		}
		local.z = within(&seed, -.1, .1) - low;
		int expected = 0;
		for (int k = 0; k < 8; k++)
			expected += height[k] + local.z <= margin;
		ob_placed box = rigid_place(&g, OB_SHAPE_BOX, size, local, q);
		ob_placed plane = rigid_place(&g, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0), ob_quat_identity());
		ob_manifold m;
		CHECK(ob_manifold_find(&box, &plane, margin, &m));
		CHECK(m.points == (expected > 4 ? 4 : expected));
		CHECK_NEAR(m.separation, low + local.z, tiny);
		check_vector(m.normal, rigid_turn(&g, ob_v3(0, 0, 1)), tiny);
		for (int k = 0; k < m.points; k++) {
			CHECK(k == 0 || m.gap[k] >= m.gap[k - 1]);
			CHECK_NEAR(outside(&plane, m.at[k]), .5 * m.gap[k], tiny);
			CHECK_NEAR(outside(&box, ob_madd(m.at[k], .5 * m.gap[k], m.normal)), 0, tiny);
		}
	}
}

// Two boxes lie flat on each other: the corners of their common rectangle.
static void test_boxes_flat(void)
{
	uint64_t seed = 5;
	for (int i = 0; i < 1000; i++) {
		rigid g = random_rigid(&seed);
		ob_vec3 sa = random_size(&seed), sb = random_size(&seed);
		double gap = within(&seed, -.02, .02), x = within(&seed, -1, 1) * (sa.x + sb.x - .1);
		double y = within(&seed, -1, 1) * (sa.y + sb.y - .1);
		double left = fmax(x - sa.x, -sb.x), right = fmin(x + sa.x, sb.x);
		double front = fmax(y - sa.y, -sb.y), back = fmin(y + sa.y, sb.y);
		ob_placed b = rigid_place(&g, OB_SHAPE_BOX, sb, ob_v3(0, 0, 0), ob_quat_identity());
		ob_placed a = rigid_place(&g, OB_SHAPE_BOX, sa, ob_v3(x, y, sa.z + sb.z + gap), ob_quat_identity());
		ob_manifold m;
		CHECK(ob_manifold_find(&a, &b, .03, &m));
		CHECK(m.points == 4);
		check_vector(m.normal, rigid_turn(&g, ob_v3(0, 0, 1)), tiny);
		CHECK_NEAR(m.separation, gap, tiny);
		for (int corner = 0; corner < 4; corner++) {
			ob_vec3 c = ob_v3(corner & 1 ? left : right, corner & 2 ? front : back, sb.z + .5 * gap);
			double nearest = INFINITY;
			for (int k = 0; k < m.points; k++)
				nearest = fmin(nearest, ob_norm(ob_sub(m.at[k], rigid_point(&g, c))));
			CHECK_NEAR(nearest, 0, tiny);
		}
		for (int k = 0; k < m.points; k++)
			CHECK_NEAR(m.gap[k], gap, tiny);
	}
}

// A corner of a is over a face of b; two edges cross.
static void test_boxes_on_corner_and_edge(void)
{
	uint64_t seed = 6;
	for (int i = 0; i < 1000; i++) {
		rigid g = random_rigid(&seed);
		double gap = within(&seed, -.01, .02), turn = within(&seed, -3, 3);
		ob_placed b = rigid_place(&g, OB_SHAPE_BOX, ob_v3(2, 2, 1), ob_v3(0, 0, 0), ob_quat_identity());
		// rotated so that the body diagonal of a unit cube is vertical
		ob_quat upright = ob_quat_turn(ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 4, 0, 0)),
					       ob_v3(0, -atan(sqrt(.5)), 0));
		ob_quat q = ob_quat_turn(upright, ob_v3(0, 0, turn));
		ob_vec3 tip = random_vector(&seed, 1);
		tip.z = 1 + gap;
		ob_placed a =
			rigid_place(&g, OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_madd(tip, sqrt(.75), ob_v3(0, 0, 1)), q);
		check_point(&a, &b, rigid_turn(&g, ob_v3(0, 0, 1)), rigid_point(&g, ob_sub(tip, ob_v3(0, 0, .5 * gap))),
			    gap);
		// b's edge lies along x at the top, a's along (cos, sin) of an angle at the bottom
		double angle = within(&seed, .6, M_PI - .6), edge = sqrt(.5);
		ob_quat along_x = ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 4, 0, 0));
		b = rigid_place(&g, OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 0), along_x);
		a = rigid_place(&g, OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 2 * edge + gap),
				ob_quat_turn(along_x, ob_v3(0, 0, angle)));
		check_point(&a, &b, rigid_turn(&g, ob_v3(0, 0, 1)), rigid_point(&g, ob_v3(0, 0, edge + .5 * gap)), gap);
	}
}

// With two separating axes, the normal is the one that closes last.
static void test_boxes_meet_along(void)
{
	ob_placed b = place(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed a = place(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(1.05, 0, 1.01), ob_quat_identity());
	ob_manifold m;
	a.v = ob_v3(-10, 0, -1); // over b's edge before it is down
	CHECK(ob_manifold_find(&a, &b, .1, &m));
	CHECK_NEAR(m.normal.z, 1, tiny);
	a.v = ob_v3(-1, 0, -10); // past b's side, then against it
	CHECK(ob_manifold_find(&a, &b, .1, &m));
	CHECK_NEAR(m.normal.x, 1, tiny);
}

// Separation of the shapes along the unit direction n, from b to a (m)
static double gap_along(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	return ob_dot(n, ob_sub(a->p, b->p)) - half_width(a, n) - half_width(b, n);
}

// Checks any point: it lies on both shapes, and within the margin. Edges of two boxes that cross beyond their ends have
// no such point, but the gap along their normal.
static void check_each_point(const ob_placed *a, const ob_placed *b, double margin, const ob_manifold *m)
{
	bool boxes = a->shape == OB_SHAPE_BOX && b->shape == OB_SHAPE_BOX;
	bool past = boxes && m->points == 1 && m->gap[0] > 0;
	CHECK(m->points >= 0 && m->points <= 4);
	for (int k = 0; k < m->points; k++) {
		CHECK_NEAR(ob_norm(m->normal), 1, tiny);
		CHECK(m->gap[k] <= margin);
		if (boxes)
			CHECK(m->gap[k] >= gap_along(a, b, m->normal) - tiny);
		if (past)
			continue;
		CHECK(outside(a, ob_madd(m->at[k], .5 * m->gap[k], m->normal)) <= tiny);
		CHECK(outside(b, ob_madd(m->at[k], -.5 * m->gap[k], m->normal)) <= tiny);
	}
}

// Both orders give the same result, unless two axes separate equally far: then each order takes its own.
static void check_both_sides(const ob_placed *a, const ob_placed *b, double margin, int *ties)
{
	ob_manifold m, n;
	CHECK(ob_manifold_find(a, b, margin, &m));
	CHECK(ob_manifold_find(b, a, margin, &n));
	CHECK_NEAR(m.separation, n.separation, tiny);
	check_each_point(a, b, margin, &m);
	if (!m.points && !n.points)
		return;
	if (ob_dot(m.normal, n.normal) > -1 + tiny) {
		(*ties)++;
		return;
	}
	CHECK(n.points == m.points);
	for (int k = 0; k < m.points; k++) {
		CHECK_NEAR(n.gap[k], m.gap[k], tiny);
		check_vector(n.at[k], m.at[k], tiny);
	}
}

static void test_any(void)
{
	static const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_PLANE };
	uint64_t seed = 7;
	int ties = 0;
	for (int i = 0; i < 60000; i++) {
		ob_shape sa = shape[i % 3], sb = shape[i / 3 % 3];
		if (sa == OB_SHAPE_PLANE && sb == OB_SHAPE_PLANE)
			continue;
		ob_placed a = random_placed(&seed, sa, .9), b = random_placed(&seed, sb, .9);
		a.v = random_vector(&seed, 1);
		check_both_sides(&a, &b, within(&seed, 0, .2), &ties);
	}
	CHECK(ties < 60);
}

// Positive: never more than the distance. Negative: no direction has less overlap.
static void test_box_separation(void)
{
	uint64_t seed = 8;
	int apart = 0, deep = 0;
	for (int i = 0; i < 3000; i++) {
		ob_placed a = random_placed(&seed, OB_SHAPE_BOX, 1), b = random_placed(&seed, OB_SHAPE_BOX, 1);
		ob_manifold m;
		ob_manifold_boxes(&a, &b, 0, &m);
		if (m.separation > 0) {
			apart++;
			CHECK(m.separation <= box_distance(&a, &b) + tiny);
			CHECK(m.points == 0);
			continue;
		}
		deep++;
		double least = INFINITY;
		for (int k = 0; k < 1000; k++) {
			ob_vec3 n = random_direction(&seed);
			double overlap = half_width(&a, n) + half_width(&b, n) - fabs(ob_dot(n, ob_sub(a.p, b.p)));
			least = fmin(least, overlap);
		}
		CHECK(-m.separation <= least + tiny);
		CHECK(least + m.separation < .15); // a thousand directions come near it
		CHECK(m.points > 0);
	}
	CHECK(apart > 300 && deep > 300);
}

// If the nearest features are a face and a corner, or crossed edges, the separation of two boxes is their distance.
static void test_box_separation_tight(void)
{
	ob_quat tilted = ob_quat_turn(ob_quat_identity(), ob_v3(.3, .4, 0));
	ob_placed b = place(OB_SHAPE_BOX, ob_v3(2, 2, .5), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed a = place(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 3), tilted);
	ob_manifold m;
	ob_manifold_boxes(&a, &b, 0, &m);
	CHECK_NEAR(m.separation, 2.5 - half_width(&a, ob_v3(0, 0, 1)), tiny);
	CHECK_NEAR(m.separation, box_distance(&a, &b), 1e-9);
}

static void test_unknown_shapes(void)
{
	ob_manifold m;
	uint64_t seed = 9;
	ob_placed plane = random_placed(&seed, OB_SHAPE_PLANE, 1);
	for (ob_shape other = OB_SHAPE_SPHERE; other <= OB_SHAPE_CYLINDER; other++) {
		ob_placed a = random_placed(&seed, OB_SHAPE_NONE, .1), b = random_placed(&seed, other, .1);
		CHECK(!ob_manifold_find(&a, &b, 1, &m) && m.points == 0 && isinf(m.separation));
		CHECK(!ob_manifold_find(&b, &a, 1, &m) && m.points == 0 && isinf(m.separation));
	}
	CHECK(!ob_manifold_find(&plane, &plane, 1, &m));
}

// Numbers of a simulator that has stored anywhere: infinities, no numbers, sizes below 0. No search reads or writes beyond
// its arrays, as the sanitizers would tell, and there are 0 .. 4 points.
static void test_senseless(void)
{
	static const double senseless[] = { NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300, 0, -1 };
	enum { WORDS = sizeof senseless / sizeof *senseless, PAIRS = 200000 };
	uint64_t seed = 10;
	bool fine = true;
	for (int i = 0; i < PAIRS; i++) {
		ob_placed of[2];
		for (int k = 0; k < 2; k++) {
			const ob_shape shape = OB_SHAPE_SPHERE + (ob_shape)(5 * uniform(&seed));
			ob_placed *p = &of[k];
			*p = random_placed(&seed, shape, 1);
			p->v = random_vector(&seed, 1), p->w = random_vector(&seed, 1);
			p->rest_depth = 1e-3, p->far_future = 1;
			double *const number[] = { &p->size.x,     &p->size.y, &p->size.z,    &p->p.x,
						   &p->r.m[0][0],  &p->v.x,    &p->v.z,       &p->w.x,
						   &p->w.y,        &p->w.z,    &p->r.m[2][1], &p->rest_depth,
						   &p->far_future, &p->a.z };
			for (int change = (int)(4 * uniform(&seed)); change > 0; change--) {
				double *to = number[(size_t)(sizeof number / sizeof *number * uniform(&seed))];
				*to = senseless[(int)(WORDS * uniform(&seed))];
			}
		}
		ob_manifold m = { .valid_path = INFINITY };
		ob_manifold_find(&of[0], &of[1], .01, &m);
		fine &= m.points >= 0 && m.points <= 4;
	}
	CHECK(fine);
}

int main(void)
{
	test_sphere_with_sphere_and_plane();
	test_sphere_outside_box();
	test_sphere_inside_box();
	test_box_on_plane();
	test_boxes_flat();
	test_boxes_on_corner_and_edge();
	test_boxes_meet_along();
	test_any();
	test_box_separation();
	test_box_separation_tight();
	test_unknown_shapes();
	test_senseless();
	return check_end();
}
