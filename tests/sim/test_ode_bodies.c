// A worker keeps no more ODE bodies than its share, with any number of objects; a recreated body steps like the first.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "ode/ode_body.h"
#include "solver/ode_bodies.h"

enum { OBJECTS = 1500, WORKERS = 3 };

static ob_state stepped(ob_ode_bodies *w, const ob_universe *u, uint32_t id)
{
	ob_state s = { { { .5, id, 2 }, ob_quat_identity() }, { 1, 2, 3 }, { .1, .2, .3 } };
	ob_ode_body_step(ob_ode_bodies_get(w, u, id), &s, ob_v3(1, 0, 0), ob_v3(0, 0, 1), .01);
	return s;
}

static bool same(ob_state a, ob_state b)
{
	return a.v.x == b.v.x && a.v.z == b.v.z && a.w.z == b.w.z && a.pose.p.y == b.pose.p.y;
}

static ob_universe *populate(void)
{
	little_scene *s = little_scene_new();
	for (int i = 0; i < OBJECTS; i++)
		ob_world_box(&s->world, 1 + i, ob_v3(.1, .1, .1), ob_v3(0, i, 1));
	ob_universe *u = little_populate(s, WORKERS);
	free(s);
	return u;
}

static void test_share(void)
{
	ob_universe *u = populate();
	ob_ode_bodies w = { 0 };
	CHECK(ob_ode_bodies_create(&w, u));
	CHECK(w.slots * WORKERS == OBJECTS);
	ob_state first[OBJECTS];
	for (uint32_t id = 0; id < OBJECTS; id++)
		first[id] = stepped(&w, u, id);
	for (uint32_t id = OBJECTS; id-- > 0;)
		CHECK(same(stepped(&w, u, id), first[id]));
	CHECK(first[1].v.x != first[0].v.x); // of another mass
	CHECK(ob_ode_bodies_get(&w, u, 7) == ob_ode_bodies_get(&w, u, 7));
	ob_ode_bodies_finish(&w);
	ob_universe_destroy(u, true);
}

// Another object at the same place of the table.
static void test_successor(void)
{
	ob_universe *u = populate();
	ob_ode_bodies w = { 0 };
	CHECK(ob_ode_bodies_create(&w, u));
	ob_state before = stepped(&w, u, 5);
	ob_passport p = *ob_passport_of(u, 5);
	p.mass *= 2, p.inertia = ob_scale(p.inertia, 2), p.generation++;
	ob_write_passport(u, 5, &p);
	ob_state after = stepped(&w, u, 5);
	CHECK_NEAR(after.v.x - 1, .5 * (before.v.x - 1), 1e-12);
	ob_ode_bodies_finish(&w);
	ob_universe_destroy(u, true);
}

int main(void)
{
	ob_ode_init();
	ob_ode_thread_init();
	test_share();
	test_successor();
	ob_ode_thread_finish();
	return check_end();
}
