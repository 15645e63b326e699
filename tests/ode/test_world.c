// World of the ODE baseline: fall, rest, bounce, sleep, contacts, objects added and removed, the same bits again.
#include <string.h>

#include "ode/ode_body.h"
#include "ode/ode_world.h"
#include "shape/shape.h"

#include "../check.h"

enum { OBJECTS = 16, POINTS = 64 };

static const double H = 1 / 240.;

static ob_ode_world *world(uint32_t iterations, bool sleeping)
{
	ob_ode_world_setup setup = {
		.gravity = { 0, 0, -10 }, .iterations = iterations, .objects = OBJECTS, .sleeping = sleeping
	};
	ob_ode_world *w = ob_ode_world_create(&setup);
	ob_passport plane = {
		.id = 0, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE, .friction = 1
	};
	ob_state s = { .pose = { { 0, 0, 0 }, { 1, 0, 0, 0 } } };
	ob_ode_world_add(w, &plane, &s);
	return w;
}

static void add(ob_ode_world *w, uint32_t id, ob_shape shape, ob_vec3 p, double restitution)
{
	ob_passport o = { .id = id,
			  .flags = OB_OBJECT_PRESENT,
			  .shape = shape,
			  .size = { .5, .5, .5 },
			  .mass = 2,
			  .friction = .5,
			  .restitution = restitution };
	o.inertia = ob_shape_inertia(shape, o.size, NULL, o.mass);
	ob_state s = { .pose = { p, { 1, 0, 0, 0 } } };
	ob_ode_world_add(w, &o, &s);
}

static void run(ob_ode_world *w, int steps)
{
	for (int i = 0; i < steps; i++)
		CHECK(ob_ode_world_step(w, H));
}

static ob_state get(const ob_ode_world *w, uint32_t id, bool *asleep, bool *touching)
{
	ob_state s;
	ob_ode_world_get(w, id, &s, asleep, touching);
	return s;
}

static void test_fall(void)
{
	ob_ode_world *w = world(20, false);
	bool asleep, touching;
	add(w, 3, OB_SHAPE_BOX, ob_v3(0, 0, 10), 0);
	run(w, 240);
	ob_state s = get(w, 3, &asleep, &touching);
	CHECK_NEAR(s.v.z, -10, 1e-12);
	CHECK_NEAR(s.pose.p.z, 10 - 5 - .5 * 10 * H, 1e-10); // semi-implicit
	CHECK(!asleep && !touching);
	run(w, 480);
	s = get(w, 3, &asleep, &touching);
	CHECK(touching);
	CHECK_NEAR(s.pose.p.z, .5, .005);
	ob_ode_world_destroy(w);
	ob_ode_world_destroy(NULL);
}

// Contact forces balance gravity for bodies on the ground, and points have the lower id first.
static void test_contacts(uint32_t iterations)
{
	ob_ode_world *w = world(iterations, false);
	ob_contact_point p[POINTS];
	double depth[POINTS], ground = 0, between = 0;
	add(w, 1, OB_SHAPE_BOX, ob_v3(0, 0, .5), 0);
	add(w, 2, OB_SHAPE_BOX, ob_v3(.1, 0, 1.5), 0);
	run(w, 480);
	size_t n = ob_ode_world_contacts(w, p, depth, POINTS);
	CHECK(n == 8);
	CHECK(ob_ode_world_contacts(w, p, depth, 3) == n);
	for (size_t i = 0; i < n; i++) {
		CHECK(p[i].b == p[i].a + 1);
		CHECK(!i || p[i].a >= p[i - 1].a);
		CHECK_NEAR(p[i].normal.z, -1, 1e-6); // from the upper, b, to the lower, a
		CHECK(depth[i] > -1e-12 && depth[i] < .005);
		CHECK(p[i].impulse > -1e-12);
		(p[i].a == 0 ? &ground : &between)[0] += p[i].impulse;
	}
	CHECK_NEAR(ground, 2 * 2 * 10 * H, .02 * 40 * H);
	CHECK_NEAR(between, 2 * 10 * H, .02 * 20 * H);
	ob_ode_world_destroy(w);
}

static void test_bounce(void)
{
	ob_ode_world *w = world(20, false);
	bool asleep, touching;
	double top = 0;
	add(w, 1, OB_SHAPE_SPHERE, ob_v3(0, 0, 1.5), .5); // 1 m of fall, .25 m of rise
	for (int i = 0; i < 240; i++) {
		run(w, 1);
		ob_state s = get(w, 1, &asleep, &touching);
		if (i > 120)
			top = fmax(top, s.pose.p.z - .5);
	}
	CHECK_NEAR(top, .25, .05);
	ob_ode_world_destroy(w);
}

static void test_sleep_and_removal(void)
{
	ob_ode_world *w = world(20, true);
	bool asleep, touching;
	add(w, 1, OB_SHAPE_BOX, ob_v3(0, 0, .5), 0);
	add(w, 2, OB_SHAPE_BOX, ob_v3(0, 0, 1.5), 0);
	run(w, 960);
	ob_state s = get(w, 2, &asleep, &touching);
	CHECK(asleep && touching);
	CHECK(s.v.z == 0 && s.w.x == 0);
	run(w, 10);
	ob_state later = get(w, 2, &asleep, &touching);
	CHECK(memcmp(&s, &later, sizeof s) == 0); // to the bit
	ob_ode_world_remove(w, 1); // its support
	ob_ode_world_remove(w, 1); // again: no effect
	run(w, 240);
	s = get(w, 2, &asleep, &touching);
	CHECK_NEAR(s.pose.p.z, .5, .01);
	add(w, 1, OB_SHAPE_BOX, ob_v3(0, 0, 3), 0); // the same id, another object
	run(w, 240);
	s = get(w, 1, &asleep, &touching);
	CHECK_NEAR(s.pose.p.z, 1.5, .02);
	ob_ode_world_destroy(w);
}

// Each shape stays upright, on the ground and on a box.
static void test_standing(ob_shape shape)
{
	ob_ode_world *w = world(20, false);
	bool asleep, touching;
	add(w, 1, shape, ob_v3(0, 0, .5), 0);
	add(w, 2, OB_SHAPE_BOX, ob_v3(3, 0, .5), 0);
	add(w, 3, shape, ob_v3(3.1, 0, 1.5), 0);
	run(w, 480);
	ob_state low = get(w, 1, &asleep, &touching), high = get(w, 3, &asleep, &touching);
	CHECK_NEAR(low.pose.p.z, .5, .01);
	CHECK_NEAR(high.pose.p.z, 1.5, .02);
	CHECK_NEAR(high.pose.p.x, 3.1, .02);
	CHECK_NEAR(fabs(high.pose.q.w), 1, 1e-3);
	ob_ode_world_destroy(w);
}

static void tower(ob_state out[OBJECTS])
{
	ob_ode_world *w = world(20, false);
	bool asleep, touching;
	for (uint32_t id = 1; id < OBJECTS; id++)
		add(w, id, id % 3 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE, ob_v3(.05 * id, .03 * (id % 4), 1.1 * id), .2);
	run(w, 600);
	for (uint32_t id = 0; id < OBJECTS; id++)
		out[id] = get(w, id, &asleep, &touching);
	ob_ode_world_destroy(w);
}

// More than 8 iterations: rows are shuffled, yet a second world of the process runs like the first.
static void test_same_bits(void)
{
	static ob_state a[OBJECTS], b[OBJECTS];
	tower(a);
	tower(b);
	CHECK(memcmp(a, b, sizeof a) == 0);
	CHECK(a[OBJECTS - 1].pose.p.z < 1.1 * (OBJECTS - 1) - 1); // it came down
}

// A cube on its edge, supported by the lower face of its bounding box; one beside it that touches only its box is
// pushed away, though they are separated.
static void test_boxed(void)
{
	ob_ode_world_setup setup = { .gravity = { 0, 0, -10 }, .iterations = 20, .objects = OBJECTS, .boxed = true };
	ob_ode_world *w = ob_ode_world_create(&setup);
	ob_passport plane = { .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE, .friction = 1 };
	ob_ode_world_add(w, &plane, &(ob_state){ .pose = { { 0, 0, 0 }, ob_quat_identity() } });
	ob_passport p = { .id = 1, .shape = OB_SHAPE_BOX, .size = { .5, .5, .5 }, .mass = 1, .friction = .5 };
	p.inertia = ob_shape_inertia(p.shape, p.size, NULL, p.mass);
	double half = .5 * (cos(.6) + sin(.6)); // bounding box of a cube turned by .6 rad
	ob_quat turned = ob_quat_turn(ob_quat_identity(), ob_v3(.6, 0, 0));
	ob_ode_world_add(w, &p, &(ob_state){ .pose = { { 0, 0, half + .01 }, turned } });
	bool asleep, touching;
	for (int i = 0; i < 120; i++)
		ob_ode_world_step(w, 1. / 60);
	ob_state s = get(w, 1, &asleep, &touching);
	CHECK_NEAR(s.pose.p.z, half, .01);
	CHECK(touching && ob_norm(s.w) < .05);
	p.id = 2;
	ob_ode_world_add(w, &p, &(ob_state){ .pose = { { 0, half + .45, .5 }, ob_quat_identity() } });
	uint64_t tests = ob_ode_world_box_tests(w);
	ob_ode_world_step(w, 1. / 60);
	CHECK(ob_ode_world_box_tests(w) == tests + 3); // each with the ground, and the two
	ob_contact_point point[16];
	double depth[16];
	CHECK(ob_ode_world_contacts(w, point, depth, 16) == 12);
	CHECK(point[8].a == 1 && point[8].b == 2);
	CHECK_NEAR(point[8].normal.y, -1, 1e-12);
	CHECK_NEAR(depth[8], .05, .01);
	ob_ode_world_destroy(w);
}

// A failed assertion of ODE ends its world, not the program; others go on.
static void test_giving_up(void)
{
	bool full = true;
	ob_ode_world *w = world(0, false), *other = world(20, false);
	add(w, 1, OB_SHAPE_BOX, ob_v3(0, 0, 3), 0);
	add(w, 2, OB_SHAPE_BOX, ob_v3(5, 0, 3), 0);
	ob_passport p = { .id = 3, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_BOX, .size = { 1, 1, 1 }, .mass = 1 };
	p.inertia = ob_shape_inertia(p.shape, p.size, NULL, p.mass);
	ob_ode_world_add(w, &p, &(ob_state){ { { 0, 0, 9 }, { 1, 0, 0, 0 } }, { 0, 0, 0 }, { 1e200, 1e200, 0 } });
	bool stepped = true;
	for (int i = 0; i < 10 && stepped; i++)
		stepped = ob_ode_world_step(w, H);
	CHECK(!stepped && ob_ode_world_culprit(w, &full) == 3 && !full);
	run(other, 10);
	ob_ode_world_destroy(w);
	ob_ode_world_destroy(other);
}

// More pairs than fit: the object with most of them is named.
static void test_full(void)
{
	bool full = false, stepped = true;
	ob_ode_world_setup setup = { .gravity = { 0, 0, -10 }, .iterations = 20, .objects = OBJECTS, .pairs_max = 3 };
	ob_ode_world *w = ob_ode_world_create(&setup);
	for (uint32_t id = 0; id < OBJECTS; id++)
		add(w, id, OB_SHAPE_SPHERE, ob_v3(id == 7 ? 0 : 2. * id, 0, 0), 0);
	for (uint32_t id = 0; id < 300 && stepped; id++)
		stepped = ob_ode_world_step(w, H);
	CHECK(stepped); // few touch
	ob_ode_world_destroy(w);
	setup.objects = 400;
	w = ob_ode_world_create(&setup);
	for (uint32_t id = 0; id < 400; id++)
		add(w, id, OB_SHAPE_SPHERE, ob_v3(0, 0, id == 7 ? 3 : .001 * id), 0);
	CHECK(!ob_ode_world_step(w, H));
	CHECK(ob_ode_world_culprit(w, &full) != 7 && full);
	ob_ode_world_destroy(w);
}

// A lift carries a box up, and a belt carries one along, at their own speeds.
static void test_driven(void)
{
	ob_ode_world *w = world(20, true);
	bool asleep, touching;
	ob_passport p = { .id = 1, .flags = OB_OBJECT_PRESENT | OB_OBJECT_KINEMATIC, .shape = OB_SHAPE_BOX };
	p.size = ob_v3(2, 2, .5);
	p.friction = 1;
	ob_state lift = { .pose = { { 0, 0, .6 }, { 1, 0, 0, 0 } }, .v = { 0, 0, 1 } };
	ob_ode_world_add(w, &p, &lift);
	add(w, 2, OB_SHAPE_BOX, ob_v3(0, 0, 1.6), 0);
	p.id = 3;
	p.flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC;
	p.surface_velocity = ob_v3(0, 1.5, 0);
	const ob_state belt = { .pose = { { 10, 0, 1 }, { 1, 0, 0, 0 } } };
	ob_ode_world_add(w, &p, &belt);
	add(w, 4, OB_SHAPE_BOX, ob_v3(10, -1.5, 2), 0);
	for (int i = 0; i < 240; i++) {
		lift.pose.p.z = .6 + i * H;
		ob_ode_world_drive(w, 1, &lift);
		run(w, 1);
	}
	CHECK_NEAR(get(w, 2, &asleep, &touching).pose.p.z, 2.6, .02);
	CHECK_NEAR(get(w, 2, &asleep, &touching).v.z, 1, .01);
	CHECK_NEAR(get(w, 4, &asleep, &touching).v.y, 1.5, .01);
	CHECK_NEAR(get(w, 4, &asleep, &touching).pose.p.y, -1.5 + 1.5 - 1.5 * .5 * 1.5 / 7.07, .05);
	ob_ode_world_destroy(w);
}

int main(void)
{
	ob_ode_thread_init();
	test_giving_up();
	test_full();
	test_fall();
	test_contacts(20);
	test_contacts(0);
	test_bounce();
	test_sleep_and_removal();
	test_standing(OB_SHAPE_BOX);
	test_standing(OB_SHAPE_SPHERE);
	test_standing(OB_SHAPE_CYLINDER);
	test_same_bits();
	test_boxed();
	test_driven();
	ob_ode_thread_finish();
	return check_end();
}
