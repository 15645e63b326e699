// Conservation checks: quantities conserved by each kind of world; errors of a known size must be measured as such.
#include "lab/conservation.h"

#include "check.h"
#include "world/builders.h"

typedef struct scene {
	ob_world world;
	ob_motion motion[8];
	ob_snapshot now;
} scene;

static void take(scene *s, double t)
{
	s->now = (ob_snapshot){
		.time = t, .count = s->world.objects, .passport = s->world.passport, .motion = s->motion
	};
	for (uint32_t i = 0; i < s->world.objects; i++) {
		const ob_state *b = &s->world.state[i];
		s->motion[i] = (ob_motion){ .t0 = t, .valid_until = INFINITY, .p = b->pose.p, .q = b->pose.q };
		s->motion[i].v = b->v;
		s->motion[i].w = b->w;
	}
}

// Two boxes far apart in free space, one of them spinning.
static scene pair(void)
{
	scene s = { .world = { .gravity = { 0, 0, 0 } } };
	ob_world_box(&s.world, 2, ob_v3(.1, .2, .2), ob_v3(-50, 0, 0)).state->v = ob_v3(0, 3, 0);
	ob_world_sphere(&s.world, 2, .3, ob_v3(50, 0, 0)).state->w = ob_v3(0, 0, 5);
	return s;
}

static void test_closed(void)
{
	scene s = pair();
	ob_conservation c = ob_conservation_begin(&s.world);
	CHECK(c.closed);
	take(&s, 0);
	ob_conservation_look(&c, &s.now, 0);
	for (int i = 0; i < OB_CONSERVED; i++)
		CHECK(c.worst[i] == 0);
	s.world.state[1].w.z += .001;
	take(&s, 1);
	ob_conservation_look(&c, &s.now, 0);
	double moment = .4 * 2 * .09, scale = moment * 5.001 + 2 * 3 * .3; // radius of the box: .3
	CHECK(c.worst[OB_CONSERVED_MOMENTUM] == 0);
	CHECK_NEAR(c.worst[OB_CONSERVED_ANGULAR], moment * .001 / scale, 1e-12);
	double kinetic = .5 * moment * 5.001 * 5.001 + 9, gain = .5 * moment * (5.001 * 5.001 - 25);
	CHECK_NEAR(c.worst[OB_CONSERVED_ENERGY], gain / kinetic, 1e-12);
	s.world.state[0].v.x = .003;
	take(&s, 2);
	ob_conservation_look(&c, &s.now, 0);
	CHECK_NEAR(c.worst[OB_CONSERVED_MOMENTUM], 1e-3, 1e-8);
	ob_world_finish(&s.world);
}

// A ball that falls and gets back more energy than it had, some of it from being pushed out of the ground.
static void test_open(void)
{
	scene s = { .world = { .gravity = { 0, 0, -10 } } };
	ob_world_ground(&s.world);
	ob_world_sphere(&s.world, 2, .5, ob_v3(0, 0, 1));
	ob_conservation c = ob_conservation_begin(&s.world);
	CHECK(!c.closed && isnan(c.worst[OB_CONSERVED_MOMENTUM]) && isnan(c.worst[OB_CONSERVED_ANGULAR]));
	take(&s, 0);
	ob_conservation_look(&c, &s.now, 0);
	s.world.state[1].pose.p.z = .4; // a fall of .6 m, then at rest
	take(&s, 1);
	ob_conservation_look(&c, &s.now, 0);
	CHECK(c.worst[OB_CONSERVED_ENERGY] == 0);
	s.world.state[1].pose.p.z = .6; // up by 4 J, of which 3 were reported
	take(&s, 2);
	ob_conservation_look(&c, &s.now, 3);
	CHECK_NEAR(c.worst[OB_CONSERVED_ENERGY], 1 / (20 * .5), 1e-12);
	ob_world_finish(&s.world);
}

// A constant force acts: the world is not closed, and the force's work is no gain.
static void test_pulled(void)
{
	scene s = pair();
	s.world.passport[0].force = ob_v3(0, 4, 0);
	ob_conservation c = ob_conservation_begin(&s.world);
	CHECK(!c.closed);
	take(&s, 0);
	ob_conservation_look(&c, &s.now, 0);
	s.world.state[0].v.y += 2 * 2;
	s.world.state[0].pose.p.y += 3 * 2 + 2 * 2;
	take(&s, 2);
	ob_conservation_look(&c, &s.now, 0);
	CHECK_NEAR(c.worst[OB_CONSERVED_ENERGY], 0, 1e-15);
	ob_world_finish(&s.world);
}

static void test_keep(void)
{
	double worst[OB_CONSERVED] = { NAN, NAN, 1 };
	ob_conservation_keep(worst, (double[]){ NAN, 2, .5 });
	CHECK(isnan(worst[0]) && worst[1] == 2 && worst[2] == 1);
	ob_conservation_keep(worst, (double[]){ NAN, NAN, INFINITY });
	CHECK(isnan(worst[0]) && worst[1] == 2 && isinf(worst[2]));
}

int main(void)
{
	test_closed();
	test_open();
	test_pulled();
	test_keep();
	return check_end();
}
