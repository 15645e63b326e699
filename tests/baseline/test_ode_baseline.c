// The other architecture against the same table: its published motions, and objects that come and go.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "baseline/ode_baseline.h"
#include "shape/shape.h"

#include "../check.h"

enum { CAPACITY = 8 };

static const double H = 1 / 60.;

static ob_universe *universe(uint32_t substeps)
{
	static int number;
	char name[40];
	snprintf(name, sizeof name, "test-monolith-%d-%d", (int)getpid(), number++);
	ob_universe_setup setup = { .name = name,
				    .capacity = CAPACITY,
				    .workers = 1,
				    .isolation = "thread",
				    .run = { .gravity = { 0, 0, -10 },
					     .step_length = H,
					     .substeps = substeps,
					     .sleeping = 1,
					     .monolith = 1,
					     .iterations = 20 } };
	ob_error e = { "" };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u)
		fprintf(stderr, "%s\n", e.text);
	return u;
}

static void put(ob_universe *u, uint32_t id, uint32_t generation, ob_shape shape, double mass, ob_vec3 at)
{
	ob_passport p = { .id = id,
			  .generation = generation,
			  .flags = OB_OBJECT_PRESENT,
			  .shape = shape,
			  .size = { .5, .5, .5 },
			  .mass = mass,
			  .friction = .5 };
	if (!(mass > 0))
		p.flags |= OB_OBJECT_STATIC;
	else
		p.inertia = ob_shape_inertia(shape, p.size, NULL, mass);
	ob_motion m = { .p = at, .q = ob_quat_identity(), .valid_until = INFINITY };
	ob_publish_motion(u, id, &m);
	ob_write_passport(u, id, &p);
}

static void take(ob_universe *u, uint32_t id)
{
	ob_passport p = *ob_passport_of(u, id);
	p.flags = 0;
	ob_write_passport(u, id, &p);
}

static void run(ob_ode_baseline *m, ob_universe *u, int steps)
{
	for (int i = 0; i < steps; i++) {
		ob_ode_baseline_step(m);
		ob_step_complete(u, ob_ode_baseline_awake(m), ob_ode_baseline_pairs(m), 1);
	}
}

static void test_flight(uint32_t substeps)
{
	ob_universe *u = universe(substeps);
	put(u, 0, 1, OB_SHAPE_PLANE, 0, ob_v3(0, 0, 0));
	put(u, 1, 1, OB_SHAPE_BOX, 2, ob_v3(0, 0, 20));
	ob_ode_baseline *m = ob_ode_baseline_create(u);
	run(m, u, 60);
	ob_motion now;
	CHECK(ob_universe_get_motion(u, 1, &now));
	CHECK(now.step == 60 && now.flags == 0);
	CHECK_NEAR(now.t0, 1, 1e-12);
	CHECK_NEAR(now.v.z, -10, 1e-10);
	CHECK_NEAR(now.p.z, 15 - 5 * H / substeps, 1e-10);
	CHECK(now.a.z == -10);
	float bounds[6];
	CHECK(ob_universe_get_bounds(u, 1, bounds));
	CHECK(bounds[2] < now.p.z - .5 - 10 * H && bounds[5] > now.p.z + .5); // until the next step
	CHECK_NEAR(now.path, 5 + 5 * H, .01);
	CHECK(ob_universe_get_motion(u, 0, &now) && now.step == 0); // static objects stay as placed
	CHECK(ob_ode_baseline_awake(m) == 1 && ob_ode_baseline_pairs(m) == 0);
	ob_ode_baseline_destroy(m);
	ob_ode_baseline_destroy(NULL);
	ob_universe_destroy(u, true);
}

static void test_rest_and_contacts(void)
{
	ob_universe *u = universe(1);
	put(u, 0, 1, OB_SHAPE_PLANE, 0, ob_v3(0, 0, 0));
	put(u, 1, 1, OB_SHAPE_BOX, 2, ob_v3(0, 0, .501));
	ob_ode_baseline *m = ob_ode_baseline_create(u);
	run(m, u, 5);
	ob_contact_point c[16];
	size_t n = ob_universe_get_contacts(u, c, 16);
	double push = 0;
	CHECK(n == 4);
	for (size_t i = 0; i < n && i < 16; i++) {
		CHECK(c[i].a == 0 && c[i].b == 1);
		CHECK_NEAR(c[i].normal.z, -1, 1e-9); // from the box to the plane
		CHECK_NEAR(c[i].position.z, 0, .01);
		CHECK_NEAR(fabs(c[i].position.x), .5, 1e-3);
		push += c[i].impulse;
	}
	CHECK(push > 0);
	ob_motion now;
	CHECK(ob_universe_get_motion(u, 1, &now) && now.a.z == 0); // held up
	run(m, u, 300);
	CHECK(ob_universe_get_motion(u, 1, &now) && now.flags == OB_MOTION_ASLEEP && now.v.z == 0);
	CHECK(ob_ode_baseline_awake(m) == 0);
	CHECK(now.valid_until == INFINITY && now.rest_time > 1);
	ob_ode_baseline_destroy(m);
	ob_universe_destroy(u, true);
}

static void test_come_and_go(void)
{
	ob_universe *u = universe(1);
	put(u, 0, 1, OB_SHAPE_PLANE, 0, ob_v3(0, 0, 0));
	put(u, 1, 1, OB_SHAPE_BOX, 2, ob_v3(0, 0, .5));
	put(u, 2, 1, OB_SHAPE_BOX, 2, ob_v3(0, 0, 1.5));
	ob_ode_baseline *m = ob_ode_baseline_create(u);
	run(m, u, 200);
	ob_motion now;
	CHECK(ob_universe_get_motion(u, 2, &now));
	CHECK_NEAR(now.p.z, 1.5, .01);
	take(u, 1);
	run(m, u, 60);
	CHECK(ob_universe_get_motion(u, 2, &now));
	CHECK_NEAR(now.p.z, .5, .02); // it fell, though it had slept
	put(u, 1, 2, OB_SHAPE_SPHERE, 2, ob_v3(5, 0, 3));
	put(u, 2, 2, OB_SHAPE_SPHERE, 2, ob_v3(8, 0, 3)); // another object under a number in use
	run(m, u, 120);
	CHECK(ob_universe_get_motion(u, 1, &now));
	CHECK_NEAR(now.p.x, 5, 1e-6);
	CHECK_NEAR(now.p.z, .5, .02);
	CHECK(ob_universe_get_motion(u, 2, &now));
	CHECK_NEAR(now.p.x, 8, 1e-6);
	ob_ode_baseline_destroy(m);
	ob_universe_destroy(u, true);
}

static void test_failure_is_told(void)
{
	ob_universe *u = universe(1);
	put(u, 0, 1, OB_SHAPE_SPHERE, 2, ob_v3(0, 0, 0));
	ob_motion broken = *ob_newest_motion(u, 0);
	broken.v.x = NAN;
	ob_publish_motion(u, 0, &broken);
	ob_ode_baseline *m = ob_ode_baseline_create(u);
	ob_ode_baseline_step(m);
	uint32_t object;
	CHECK(ob_step_failed(u, &object) == OB_STEP_DIVERGED && object == 0);
	ob_ode_baseline_destroy(m);
	ob_universe_destroy(u, true);
}

int main(void)
{
	test_flight(1);
	test_flight(4);
	test_rest_and_contacts();
	test_come_and_go();
	test_failure_is_told();
	return check_end();
}
