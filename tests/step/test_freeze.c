// A frozen body stands where it was, and is an obstacle to all others; if failures are frozen each island has a budget
// of its own.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"

// A body frozen in the air: the body above it falls and comes to rest on it.
static void test_obstacle(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 500, ob_v3(.5, .5, .5), ob_v3(0, 0, 3)).state->w = ob_v3(0, 0, 2);
	ob_world_box(&s->world, 500, ob_v3(.25, .25, .25), ob_v3(0, 0, 5));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 10);
	const ob_state before = little_state(&l, 1);
	CHECK(before.v.z < -1);
	CHECK(ob_sim_freeze(l.u, 1));
	CHECK(!ob_sim_freeze(l.u, 1) && !ob_sim_freeze(l.u, 0));
	ob_passport p;
	CHECK(ob_universe_get_passport(l.u, 1, &p));
	CHECK(p.flags == (OB_OBJECT_PRESENT | OB_OBJECT_STATIC | OB_OBJECT_FROZEN) && p.mass == 0);
	little_run(&l, 300);
	const ob_state after = little_state(&l, 1);
	CHECK(memcmp(&after.pose, &before.pose, sizeof after.pose) == 0);
	CHECK(ob_norm(after.v) == 0 && ob_norm(after.w) == 0);
	CHECK(fabs(little_state(&l, 2).pose.p.z - (after.pose.p.z + .75)) < 1e-3);
	little_close(&l);
	free(s);
}

// When a body is frozen, those on it wake, and stay; those below it carry no load any more.
static void test_stack(void)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	for (int i = 0; i < 5; i++)
		ob_world_box(&s->world, 500, ob_v3(.25, .25, .25), ob_v3(0, 0, .25 + .5 * i));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 240);
	CHECK(little_asleep(&l, 5));
	CHECK(ob_sim_freeze(l.u, 3));
	little_run(&l, 1);
	CHECK(!little_asleep(&l, 4) && !little_asleep(&l, 2));
	little_run(&l, 240);
	for (uint32_t i = 1; i <= 5; i++)
		CHECK(fabs(little_state(&l, i).pose.p.z - (.5 * i - .25)) < 1e-3);
	little_close(&l);
	free(s);
}

// All islands together have the step's budget, whether those that are too much are frozen or not.
static void test_budget(bool freezes)
{
	little_scene *s = little_scene_new();
	s->run.freezes = freezes;
	ob_world_ground(&s->world);
	for (int i = 0; i < 40; i++)
		ob_world_box(&s->world, 500, ob_v3(.5, .5, .5), ob_v3(.1 * (i % 2), 0, .5 + .9 * i));
	little_universe l;
	little_open(&l, s);
	ob_step_work_add(l.u, UINT64_C(1) << 40);
	ob_gate_set_pause_step(l.u, 1);
	ob_sim_resume(l.u);
	while (!ob_gate_host_wait(l.u, 0))
		ob_step(l.sim);
	CHECK(ob_step_failed(l.u, NULL) == OB_STEP_OVERWORKED);
	uint32_t object, ids[50];
	CHECK(ob_sim_failed_alone(l.u, &object) && object == 1);
	CHECK(ob_sim_failed_objects(l.u, object, ids, 50) == 40 && ids[0] == 1 && ids[39] == 40);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_obstacle();
	test_stack();
	test_budget(false);
	test_budget(true);
	return check_end();
}
