// Depths against closed forms, and the closed forms against the search, which is independent of them.
#include "random.h"

#include "../check.h"

static ob_solid solid(ob_shape shape, ob_vec3 size, ob_vec3 p, ob_quat q)
{
	return (ob_solid){ shape, size, p, ob_quat_matrix(q), NULL };
}

static ob_quat about(ob_vec3 axis, double angle)
{
	return ob_quat_turn(ob_quat_identity(), ob_scale(axis, angle));
}

static const ob_vec3 X = { 1, 0, 0 }, Y = { 0, 1, 0 }, Z = { 0, 0, 1 };

static void boxes(void)
{
	ob_solid a = solid(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(0, 0, 0), ob_quat_identity());
	ob_solid b = solid(OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(.2, .1, .99), ob_quat_identity());
	CHECK_NEAR(ob_depth(&a, &b), .01, 1e-15);
	b.p.z = 1.5;
	CHECK_NEAR(ob_depth(&a, &b), -.5, 1e-15);
	b = solid(OB_SHAPE_BOX, b.size, ob_v3(0, 0, .5 + sqrt(.5) - .02), about(X, M_PI / 4)); // an edge on a face
	CHECK_NEAR(ob_depth(&a, &b), .02, 1e-15);
	// edge across edge, the separating axis along z
	a.r = ob_quat_matrix(about(X, M_PI / 4));
	b = solid(OB_SHAPE_BOX, b.size, ob_v3(0, 0, 2 * sqrt(.5) - .003), about(Y, M_PI / 4));
	CHECK_NEAR(ob_depth(&a, &b), .003, 1e-15);
}

static void planes(void)
{
	ob_solid plane = solid(OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 1), about(Y, .3));
	ob_vec3 n = ob_v3(sin(.3), 0, cos(.3));
	struct {
		ob_shape shape;
		double reach; // extent along n of the body tilted by .3 against z
	} of[] = { { OB_SHAPE_SPHERE, .2 },
		   { OB_SHAPE_BOX, .2 * sin(.3) + .4 * cos(.3) },
		   { OB_SHAPE_CAPSULE, .2 + .3 * cos(.3) },
		   { OB_SHAPE_CYLINDER, .2 * sin(.3) + .3 * cos(.3) } };
	for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
		ob_solid s = solid(of[i].shape, ob_v3(.2, .3, .4),
				   ob_add(ob_v3(0, 0, 1), ob_scale(n, of[i].reach - .01)), ob_quat_identity());
		CHECK_NEAR(ob_depth(&plane, &s), .01, 1e-15);
		CHECK_NEAR(ob_depth(&s, &plane), .01, 1e-15);
	}
	CHECK(ob_depth(&plane, &plane) == -INFINITY);
}

static void cylinders(void)
{
	ob_vec3 size = ob_v3(.5, 1, 0);
	ob_solid standing = solid(OB_SHAPE_CYLINDER, size, ob_v3(0, 0, 0), ob_quat_identity());
	ob_solid other = solid(OB_SHAPE_CYLINDER, size, ob_v3(.3, .2, 1.996), about(Z, 1));
	CHECK_NEAR(ob_depth(&standing, &other), .004, 1e-12); // cap on cap
	other.p = ob_v3(.6, .79, .3); // mantle along mantle
	CHECK_NEAR(ob_depth(&standing, &other), 1 - hypot(.6, .79), 1e-12);
	other = solid(OB_SHAPE_CYLINDER, size, ob_v3(0, .999, .3), about(X, M_PI / 2));
	other.p = ob_v3(.999, 0, .3); // crossed
	CHECK_NEAR(ob_depth(&standing, &other), .001, 1e-12);
	ob_solid box = solid(OB_SHAPE_BOX, ob_v3(1, 1, 1), ob_v3(.1, .2, -1.993), about(Z, .4));
	CHECK_NEAR(ob_depth(&standing, &box), .007, 1e-12);
	// the rim of a cylinder, tilted by .4, in the middle of a face: r sin + h cos along the normal
	ob_solid tilted = solid(OB_SHAPE_CYLINDER, size, ob_v3(0, 0, .5 * sin(.4) + cos(.4) - .002), about(X, .4));
	box.p = ob_v3(0, 0, -1);
	CHECK_NEAR(ob_depth(&tilted, &box), .002, 1e-9);
	ob_solid ball = solid(OB_SHAPE_SPHERE, ob_v3(.25, 0, 0), ob_v3(.5 + .15, 0, 1 + .2), ob_quat_identity());
	CHECK_NEAR(ob_depth(&standing, &ball), 0, 1e-15); // at the rim: a 3-4-5 triangle
	ob_solid capsule = solid(OB_SHAPE_CAPSULE, ob_v3(.2, .5, 0), ob_v3(0, 0, 1.19), about(Y, M_PI / 2));
	CHECK_NEAR(ob_depth(&standing, &capsule), .01, 1e-12); // lying on the cap
}

// Closed form against search for random overlapping pairs, in both orders.
static void agree(ob_shape one, ob_shape other, double tolerance)
{
	uint64_t seed = 20240601;
	int overlaps = 0;
	double worst = 0;
	for (int i = 0; i < 400; i++) {
		ob_solid a = random_solid(&seed, one, .8), b = random_solid(&seed, other, .8);
		double exact = ob_depth(&a, &b), searched = ob_depth_search(&a, &b);
		CHECK((exact > 0) == (searched > 0) || fabs(exact) < 1e-7);
		if (exact <= 0)
			continue;
		overlaps++;
		CHECK_NEAR(ob_depth(&b, &a), exact, 1e-12);
		worst = fmax(worst, fabs(exact - searched));
		CHECK_NEAR(searched, exact, tolerance);
	}
	printf("shapes %d and %d: %d overlaps, closed form and search differ by %.2g m at most\n", one, other, overlaps,
	       worst);
	CHECK(overlaps > 100);
}

// Shallow contacts with cylinders against a dense scatter of directions, whose result can only be too large.
static void shallow(ob_shape other)
{
	enum { DIRECTIONS = 100000 };
	uint64_t seed = 7;
	int overlaps = 0;
	for (int i = 0; i < 1000 && overlaps < 12; i++) {
		ob_solid a = random_solid(&seed, OB_SHAPE_CYLINDER, .8), b = random_solid(&seed, other, .8);
		double searched = ob_depth(&a, &b);
		if (searched <= 0 || searched > .05)
			continue;
		overlaps++;
		double least = INFINITY;
		for (int k = 0; k < DIRECTIONS; k++) {
			double z = (k + .5) / DIRECTIONS, r = sqrt(1 - z * z), angle = k * 2.399963229728653;
			ob_vec3 n = ob_v3(r * cos(angle), r * sin(angle), z);
			double x = ob_solid_extent(&a, n) + ob_solid_extent(&b, n) - fabs(ob_dot(n, ob_sub(b.p, a.p)));
			least = fmin(least, x);
		}
		CHECK(searched <= least);
		CHECK(searched > least - .01); // the scatter's own error: .004 rad, 2 m
	}
	CHECK(overlaps == 12);
}

int main(void)
{
	boxes();
	planes();
	cylinders();
	agree(OB_SHAPE_SPHERE, OB_SHAPE_BOX, 1e-9);
	agree(OB_SHAPE_SPHERE, OB_SHAPE_CAPSULE, 1e-9);
	agree(OB_SHAPE_SPHERE, OB_SHAPE_CYLINDER, 1e-9);
	agree(OB_SHAPE_BOX, OB_SHAPE_BOX, 1e-9);
	agree(OB_SHAPE_CAPSULE, OB_SHAPE_BOX, 1e-9);
	agree(OB_SHAPE_CAPSULE, OB_SHAPE_CAPSULE, 1e-9);
	shallow(OB_SHAPE_BOX);
	shallow(OB_SHAPE_CAPSULE);
	shallow(OB_SHAPE_CYLINDER);
	return check_end();
}
