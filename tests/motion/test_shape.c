// Bounding boxes of shapes, still and moving: they contain the shapes, and still ones are tight.
#include <float.h>
#include <string.h>

#include <ob/motion.h>

#include "check.h"
#include "random.h"

static const ob_shape SHAPES[] = { OB_SHAPE_NONE, OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
enum { KINDS = sizeof SHAPES / sizeof *SHAPES };

// Farthest point of a shape (body frame) along d, from the shapes' definitions in ob/universe.h.
static ob_vec3 farthest(ob_shape shape, ob_vec3 size, ob_vec3 d)
{
	double n = ob_norm(d), flat = sqrt(d.x * d.x + d.y * d.y), up = copysign(size.y, d.z);
	switch (shape) {
	case OB_SHAPE_SPHERE:
		return ob_scale(d, size.x / n);
	case OB_SHAPE_BOX:
		return ob_v3(copysign(size.x, d.x), copysign(size.y, d.y), copysign(size.z, d.z));
	case OB_SHAPE_CAPSULE:
		return ob_madd(ob_v3(0, 0, up), size.x / n, d);
	case OB_SHAPE_CYLINDER:
		return flat > 0 ? ob_v3(size.x * d.x / flat, size.x * d.y / flat, up) : ob_v3(0, 0, up);
	default:
		return ob_v3(0, 0, 0);
	}
}

static double component(ob_vec3 v, int i)
{
	return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

static ob_vec3 random_size(uint64_t *seed)
{
	double x = within(seed, .01, 2), y = within(seed, .01, 2), z = within(seed, .01, 2);
	return ob_v3(x, y, z);
}

static void test_tight(void)
{
	uint64_t seed = 10;
	for (int k = 0; k < 1000 * KINDS; k++) {
		ob_shape shape = SHAPES[k % KINDS];
		ob_vec3 size = random_size(&seed);
		ob_pose pose = { random_vector(&seed, 5),
				 k < 10 * KINDS ? ob_quat_identity() : random_attitude(&seed) };
		ob_mat3 r = ob_quat_matrix(pose.q);
		double box[6], radius = ob_shape_radius(shape, size);
		ob_shape_bounds(shape, size, pose, box);
		for (int i = 0; i < 6; i++) {
			double way = i < 3 ? -1 : 1;
			ob_vec3 axis = ob_v3(i % 3 == 0 ? way : 0, i % 3 == 1 ? way : 0, i % 3 == 2 ? way : 0);
			ob_vec3 corner = farthest(shape, size, ob_rotate_back(&r, axis));
			double reach = component(ob_add(pose.p, ob_rotate(&r, corner)), i % 3);
			CHECK_NEAR(box[i], reach, 1e-14);
			CHECK(ob_norm(corner) <= radius * (1 + 1e-15));
		}
	}
}

static void test_known(void)
{
	ob_vec3 size = ob_v3(3, 4, 12);
	ob_pose pose = { { 1, 2, 3 }, { 1, 0, 0, 0 } };
	double box[6];
	ob_shape_bounds(OB_SHAPE_BOX, size, pose, box);
	CHECK(box[0] == -2 && box[1] == -2 && box[2] == -9 && box[3] == 4 && box[4] == 6 && box[5] == 15);
	ob_shape_bounds(OB_SHAPE_PLANE, size, pose, box);
	for (int i = 0; i < 6; i++)
		CHECK(box[i] == (i < 3 ? -INFINITY : INFINITY));
	CHECK(ob_shape_radius(OB_SHAPE_SPHERE, size) == 3);
	CHECK(ob_shape_radius(OB_SHAPE_BOX, size) == 13);
	CHECK(ob_shape_radius(OB_SHAPE_PLANE, size) == INFINITY);
	CHECK(ob_shape_radius(OB_SHAPE_CAPSULE, size) == 7);
	CHECK(ob_shape_radius(OB_SHAPE_CYLINDER, size) == 5);
	CHECK(ob_shape_thickness(OB_SHAPE_SPHERE, size) == 6);
	CHECK(ob_shape_thickness(OB_SHAPE_BOX, size) == 6);
	CHECK(ob_shape_thickness(OB_SHAPE_BOX, ob_v3(3, .5, 1)) == 1);
	CHECK(ob_shape_thickness(OB_SHAPE_PLANE, size) == INFINITY);
	CHECK(ob_shape_thickness(OB_SHAPE_CAPSULE, size) == 6);
	CHECK(ob_shape_thickness(OB_SHAPE_CYLINDER, size) == 6);
	CHECK(ob_shape_thickness(OB_SHAPE_CYLINDER, ob_v3(3, 1, 0)) == 2);
}

// The box contains the shape to the last digit, at any moment of the sweep, for the plane too.
static void test_swept_holds(void)
{
	uint64_t seed = 11;
	for (int k = 0; k < 400 * KINDS; k++) {
		ob_shape shape = SHAPES[k % KINDS];
		ob_vec3 size = random_size(&seed), inertia = random_inertia(&seed), zero = ob_v3(0, 0, 0);
		ob_motion m = { .t0 = within(&seed, 0, 3), .q = random_attitude(&seed) };
		m.p = random_vector(&seed, pow(10, within(&seed, -3, 4)));
		m.v = random_vector(&seed, 10);
		m.w = k % 3 ? random_vector(&seed, 10) : zero;
		m.a = k % 4 ? random_vector(&seed, 10) : zero;
		double s = within(&seed, 0, 3), swept[6], box[6];
		ob_motion_swept_bounds(&m, shape, size, s, swept);
		for (int j = 0; j <= 50; j++) {
			ob_shape_bounds(shape, size, ob_motion_at(&m, inertia, m.t0 + s * j / 50).pose, box);
			for (int i = 0; i < 3; i++)
				CHECK(swept[i] <= box[i] && box[i + 3] <= swept[i + 3]);
		}
	}
}

// Tight as promised: the sweep of a body that does not turn is tight, the vertex of its parabola included.
static void test_swept_tight(void)
{
	ob_vec3 size = ob_v3(.5, .25, 1);
	ob_motion m = { .p = { 1, 0, 2 }, .q = { 1, 0, 0, 0 }, .v = { 3, 0, 5 }, .a = { 0, 0, -10 } };
	double box[6];
	ob_motion_swept_bounds(&m, OB_SHAPE_BOX, size, .75, box);
	const double expected[6] = { .5, -.25, 1, 1 + 2.25 + .5, .25, 2 + 1.25 + 1 };
	for (int i = 0; i < 6; i++)
		CHECK_NEAR(box[i], expected[i], 1e-13);
	m.w = ob_v3(0, 0, 1e-3);
	ob_motion_swept_bounds(&m, OB_SHAPE_BOX, size, .75, box);
	CHECK_NEAR(box[1], -ob_norm(size), 1e-14);
	ob_motion_swept_bounds(&m, OB_SHAPE_BOX, size, INFINITY, box);
	CHECK(box[0] == 1 - ob_norm(size) && box[3] == INFINITY);
	CHECK(box[2] == -INFINITY);
	CHECK_NEAR(box[5], 2 + 1.25 + ob_norm(size), 1e-14);
	CHECK_NEAR(box[4], ob_norm(size), 0);
	ob_motion_swept_bounds(&m, OB_SHAPE_PLANE, size, 1, box);
	for (int i = 0; i < 6; i++)
		CHECK(box[i] == (i < 3 ? -INFINITY : INFINITY));
}

// Every shape has a name of its own, and nothing else has one.
static void test_names(void)
{
	for (int a = OB_SHAPE_SPHERE; a <= OB_SHAPE_HULL; a++) {
		CHECK(*ob_shape_name((ob_shape)a));
		for (int b = OB_SHAPE_SPHERE; b < a; b++)
			CHECK(strcmp(ob_shape_name((ob_shape)a), ob_shape_name((ob_shape)b)) != 0);
	}
	CHECK(!*ob_shape_name(OB_SHAPE_NONE) && !*ob_shape_name((ob_shape)(OB_SHAPE_TERRAIN + 1)));
}

int main(void)
{
	test_tight();
	test_known();
	test_swept_holds();
	test_swept_tight();
	test_names();
	return check_end();
}
