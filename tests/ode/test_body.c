// One object's own world: mass properties, a step, and independence of worlds in different threads.
#include <pthread.h>
#include <string.h>

#include <ode/ode.h>

#include "ode/ode_body.h"
#include "shape/shape.h"

#include "../check.h"

enum { THREADS = 4, STEPS = 20000 };

static const ob_vec3 G = { 0, 0, -9.81 };

// Moments of shapes are those that ODE would compute.
static void test_mass_properties(void)
{
	const ob_vec3 size = { .5, 1, 1.5 };
	dMass m[4];
	dMassSetSphereTotal(&m[0], 3, size.x);
	dMassSetBoxTotal(&m[1], 3, 2 * size.x, 2 * size.y, 2 * size.z);
	dMassSetCapsuleTotal(&m[2], 3, 3, size.x, 2 * size.y);
	dMassSetCylinderTotal(&m[3], 3, 3, size.x, 2 * size.y);
	const char *const name[] = { "sphere", "box", "capsule", "cylinder" };
	for (int i = 0; i < 4; i++) {
		const ob_vec3 inertia = ob_shape_inertia(ob_shape_named(name[i]), size, NULL, 3);
		CHECK_NEAR(inertia.x, m[i].I[0], 1e-14);
		CHECK_NEAR(inertia.y, m[i].I[5], 1e-14);
		CHECK_NEAR(inertia.z, m[i].I[10], 1e-14);
	}
}

static ob_passport box(void)
{
	ob_passport p = { .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_BOX, .size = { .1, .2, .3 }, .mass = 2 };
	p.inertia = ob_shape_inertia(p.shape, p.size, NULL, p.mass);
	return p;
}

static ob_state tumbling(void)
{
	return (ob_state){ { { 0, 0, 10 }, { 1, 0, 0, 0 } }, { 1, 2, 3 }, { 3, 2, 1 } };
}

static void test_step(void)
{
	ob_ode_stepper *stepper = ob_ode_stepper_create();
	ob_passport p = box();
	ob_ode_body *b = ob_ode_body_create(&p, G, stepper);
	ob_state s = { { { 1, 2, 3 }, { 1, 0, 0, 0 } }, { 0, 0, 0 }, { 0, 0, 0 } };
	double h = .01;
	ob_ode_body_step(b, &s, ob_v3(4, 0, 0), ob_v3(0, 0, .03), h);
	CHECK_NEAR(s.v.x, 4 / p.mass, 1e-14);
	CHECK_NEAR(s.v.z, G.z * h, 1e-15);
	CHECK_NEAR(s.w.z, .03 / p.inertia.z, 1e-14);
	CHECK_NEAR(s.pose.p.x, 1 + h * s.v.x, 1e-14); // semi-implicit, as ODE integrates
	CHECK_NEAR(s.pose.p.z, 3 + h * s.v.z, 1e-14);
	ob_vec3 v = s.v;
	ob_ode_body_step(b, &s, ob_v3(0, 0, 0), ob_v3(0, 0, 0), h);
	CHECK_NEAR(s.v.x, v.x, 1e-14); // the impulse acted in that step alone
	ob_ode_body_destroy(b);
	ob_ode_body_destroy(NULL);
	ob_ode_stepper_destroy(stepper);
	ob_ode_stepper_destroy(NULL);
}

// A body created anew for every step moves like one that lives on: the state is complete.
static void test_bodies_are_replaceable(void)
{
	ob_ode_stepper *stepper = ob_ode_stepper_create();
	ob_passport p = box();
	ob_ode_body *one = ob_ode_body_create(&p, G, stepper);
	ob_state a = tumbling(), b = a;
	for (int i = 0; i < 200; i++) {
		ob_ode_body *fresh = ob_ode_body_create(&p, G, stepper);
		ob_ode_body_step(one, &a, ob_v3(.1, 0, 0), ob_v3(0, .01, 0), .01);
		ob_ode_body_step(fresh, &b, ob_v3(.1, 0, 0), ob_v3(0, .01, 0), .01);
		ob_ode_body_destroy(fresh);
	}
	CHECK(memcmp(&a, &b, sizeof a) == 0);
	CHECK(fabs(a.w.x - 3) > 1e-3);
	ob_ode_body_destroy(one);
	ob_ode_stepper_destroy(stepper);
}

static void test_static_objects_stay(void)
{
	ob_ode_stepper *stepper = ob_ode_stepper_create();
	ob_passport p = { .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE };
	ob_ode_body *b = ob_ode_body_create(&p, G, stepper);
	ob_state s = tumbling(), before = s;
	ob_ode_body_step(b, &s, ob_v3(1, 1, 1), ob_v3(1, 1, 1), .1);
	CHECK(memcmp(&s, &before, sizeof s) == 0);
	ob_ode_body_destroy(b);
	ob_ode_stepper_destroy(stepper);
}

static void *tumble(void *out)
{
	ob_ode_thread_init();
	ob_ode_stepper *stepper = ob_ode_stepper_create();
	ob_passport p = box();
	ob_ode_body *b = ob_ode_body_create(&p, G, stepper);
	ob_state *s = out;
	*s = tumbling();
	for (int i = 0; i < STEPS; i++)
		ob_ode_body_step(b, s, ob_v3(0, 0, 2 * 9.81 * .001), ob_v3(0, 0, 0), .001);
	ob_ode_body_destroy(b);
	ob_ode_stepper_destroy(stepper);
	ob_ode_thread_finish();
	return NULL;
}

static void test_threads(void)
{
	pthread_t thread[THREADS];
	ob_state s[THREADS];
	for (int i = 0; i < THREADS; i++)
		CHECK(pthread_create(&thread[i], NULL, tumble, &s[i]) == 0);
	for (int i = 0; i < THREADS; i++)
		pthread_join(thread[i], NULL);
	for (int i = 1; i < THREADS; i++)
		CHECK(memcmp(&s[i], &s[0], sizeof s[0]) == 0);
	CHECK_NEAR(s[0].pose.p.x, 20, 1e-9);
}

int main(void)
{
	test_threads(); // first: they race to initialise ODE
	ob_ode_thread_init();
	test_mass_properties();
	test_step();
	test_bodies_are_replaceable();
	test_static_objects_stay();
	ob_ode_thread_finish();
	return check_end();
}
