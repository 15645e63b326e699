// Landing times on a plane, against paths followed in small steps.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "motion/flight.h"
#include "random.h"

typedef struct flight {
	ob_flier f;
	ob_spin spin;
	ob_half_space plane;
	ob_hull hull;
} flight;

// Any points: the surface between them is not needed.
static void random_corners(flight *x, uint64_t *seed)
{
	ob_hull *h = &x->hull;
	h->corners = 4 + (uint32_t)within(seed, 0, OB_HULL_CORNERS_MAX - 3);
	h->radius = 0;
	for (uint32_t k = 0; k < h->corners; k++) {
		h->corner[k] = random_vector(seed, .5);
		h->radius = fmax(h->radius, ob_norm(h->corner[k]));
	}
	x->f.size = ob_v3(h->radius, 0, 0);
	x->f.hull = h;
}

// Above an inclined plane, thrown and spinning.
static void random_flight(flight *x, ob_shape shape, uint64_t *seed)
{
	double a = within(seed, .05, .5), b = within(seed, .05, .5), c = within(seed, .05, .5);
	ob_vec3 n = random_vector(seed, 1), w = random_vector(seed, uniform(seed) < .3 ? 20 : 3);
	n = ob_scale(n, 1 / ob_norm(n));
	x->plane = (ob_half_space){ n, within(seed, -5, 5) };
	x->f = (ob_flier){ .shape = shape, .size = { a, b, c }, .inertia = random_inertia(seed) };
	if (shape == OB_SHAPE_HULL)
		random_corners(x, seed);
	x->f.v = random_vector(seed, 3);
	x->f.a = ob_madd(random_vector(seed, 1), uniform(seed) < .2 ? 5 : -5, n);
	x->f.q = random_attitude(seed);
	x->f.w = uniform(seed) < .1 ? ob_v3(0, 0, 0) : w;
	double radius = shape == OB_SHAPE_NONE ? a : ob_shape_radius(shape, x->f.size),
	       height = radius + within(seed, 0, 3);
	x->f.p = ob_madd(random_vector(seed, .1), x->plane.offset + height + .2, n);
	ob_spin_plan(&x->spin, x->f.q, x->f.w, x->f.inertia);
	x->f.spin = ob_norm2(x->f.w) > 0 ? &x->spin : NULL;
}

// Height (m) of the lowest point over the plane.
static double gap_at(const flight *x, double s)
{
	const ob_flier *f = &x->f;
	ob_quat q = f->q;
	ob_vec3 w, size = f->size;
	if (f->spin)
		ob_spin_at(f->spin, s, &q, &w);
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 n = ob_rotate_back(&r, x->plane.normal), p = ob_madd(ob_madd(f->p, s, f->v), .5 * s * s, f->a);
	double height = ob_dot(x->plane.normal, p) - x->plane.offset;
	switch (f->shape) {
	case OB_SHAPE_SPHERE:
		return height - size.x;
	case OB_SHAPE_BOX:
		return height - fabs(n.x) * size.x - fabs(n.y) * size.y - fabs(n.z) * size.z;
	case OB_SHAPE_CAPSULE:
		return height - fabs(n.z) * size.y - size.x;
	case OB_SHAPE_CYLINDER:
		return height - fabs(n.z) * size.y - sqrt(n.x * n.x + n.y * n.y) * size.x;
	case OB_SHAPE_HULL: {
		double least = INFINITY;
		for (uint32_t k = 0; k < f->hull->corners; k++)
			least = fmin(least, height + ob_dot(f->hull->corner[k], n));
		return least;
	}
	default:
		return height - size.x;
	}
}

static void check_landing(ob_shape shape, uint64_t *seed)
{
	flight x;
	random_flight(&x, shape, seed);
	const double until = 1.5, landing = ob_landing_time(&x.f, &x.plane, 0, until);
	CHECK(landing >= 0 && (landing <= until || isinf(landing)));
	for (int k = 0; k <= 600; k++) {
		double s = until * k / 600;
		CHECK(s >= landing || gap_at(&x, s) > -1e-10);
	}
	if (isinf(landing))
		return;
	CHECK_NEAR(gap_at(&x, landing), 0, 1e-9);
	// searched from an instant before, it is the same; a millisecond after a landing there may be another
	CHECK_NEAR(ob_landing_time(&x.f, &x.plane, .7 * landing, until), landing, 1e-9);
	CHECK(isinf(ob_landing_time(&x.f, &x.plane, 0, .9 * landing)));
}

// A corner that has just struck, and leaves: the next landing, of this corner or another, counts.
static void test_after_a_bounce(void)
{
	ob_flier ball = { .shape = OB_SHAPE_SPHERE, .size = { .5, 0, 0 }, .p = { 0, 0, .5 }, .v = { 0, 0, 3 } };
	ball.a = ob_v3(0, 0, -10), ball.q = ob_quat_identity();
	ob_half_space ground = { { 0, 0, 1 }, 0 };
	CHECK_NEAR(ob_landing_time(&ball, &ground, 0, 1), .6, 1e-15);
	CHECK(isinf(ob_landing_time(&ball, &ground, 0, .59)));
	ob_flier box = ball;
	box.shape = OB_SHAPE_BOX, box.size = ob_v3(.5, .5, .5), box.inertia = ob_v3(1, 1, 1);
	CHECK_NEAR(ob_landing_time(&box, &ground, 0, 1), .6, 1e-10);
	box.w = ob_v3(.1, 0, 0); // one edge leaves more slowly than the other, and comes down first
	ob_spin spin;
	ob_spin_plan(&spin, box.q, box.w, box.inertia);
	box.spin = &spin;
	double first = ob_landing_time(&box, &ground, 0, 1);
	CHECK(first < .6 && first > .57);
	box.shape = OB_SHAPE_CYLINDER; // its rim reaches as far as the box's edges
	CHECK_NEAR(ob_landing_time(&box, &ground, 0, 1), first, 1e-9);
	box.v.z = -1;
	CHECK_NEAR(ob_landing_time(&box, &ground, 0, 1), 0, 0);
	box.shape = OB_SHAPE_BOX;
	CHECK_NEAR(ob_landing_time(&box, &ground, 0, 1), 0, 0);
}

// A body lands at the same time beside any others as alone.
static void test_side_by_side(uint64_t *seed)
{
	static const ob_shape other[] = { OB_SHAPE_SPHERE, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER, OB_SHAPE_HULL,
					  OB_SHAPE_NONE };
	enum { OTHERS = sizeof other / sizeof *other };
	static flight x[OB_LANDINGS], alone;
	for (int k = 0; k < 4000; k++) {
		const int n = 1 + (int)(OB_LANDINGS * uniform(seed));
		const bool boxes = uniform(seed) < .8;
		ob_landing of[OB_LANDINGS];
		for (int i = 0; i < n; i++) {
			const ob_shape shape =
				boxes || uniform(seed) < .3 ? OB_SHAPE_BOX : other[(int)(OTHERS * uniform(seed))];
			random_flight(&x[i], shape, seed);
			if (x[i].f.spin)
				x[i].f.spin = &x[i].spin;
			of[i] = (ob_landing){ .flier = &x[i].f, .plane = &x[i].plane, .until = within(seed, 0, 3) };
			if (uniform(seed) < .3) // at its landing, or later
				of[i].from = ob_landing_time(&x[i].f, &x[i].plane, 0, of[i].until);
			if (isinf(of[i].from))
				of[i].from = within(seed, 0, of[i].until);
		}
		ob_landing_times(of, n);
		for (int i = 0; i < n; i++) {
			alone = x[i];
			ob_spin_plan(&alone.spin, alone.f.q, alone.f.w, alone.f.inertia);
			alone.f.spin = x[i].f.spin ? &alone.spin : NULL;
			alone.f.hull = &alone.hull;
			const double time = ob_landing_time(&alone.f, &alone.plane, of[i].from, of[i].until);
			CHECK(memcmp(&time, &of[i].time, sizeof time) == 0);
		}
	}
}

static void test_spin_bound(uint64_t *seed)
{
	ob_quat q = random_attitude(seed), at;
	ob_vec3 w = random_vector(seed, 5), inertia = random_inertia(seed), then;
	double bound = ob_spin_bound(q, w, inertia), most = 0;
	for (int k = 0; k < 200; k++) {
		ob_rotate_free(q, w, inertia, .02 * k, &at, &then);
		most = fmax(most, ob_norm(then));
	}
	CHECK(most <= bound * (1 + 1e-12));
}

int main(void)
{
	uint64_t seed = 5;
	static const ob_shape shapes[] = { OB_SHAPE_SPHERE,   OB_SHAPE_BOX,  OB_SHAPE_CAPSULE,
					   OB_SHAPE_CYLINDER, OB_SHAPE_HULL, OB_SHAPE_NONE };
	for (int k = 0; k < 6000; k++)
		check_landing(shapes[k % 6], &seed);
	for (int k = 0; k < 500; k++)
		test_spin_bound(&seed);
	test_after_a_bounce();
	test_side_by_side(&seed);
	return check_end();
}
