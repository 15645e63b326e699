// However many objects it moves, a solver keeps as many ODE bodies as it was told; a recreated body moves like the first.
#include <stdlib.h>

#include "check.h"
#include "ode/ode_body.h"
#include "solver/ode_bodies.h"

enum { OBJECTS = 1500, KEPT = 500 };

static const ob_vec3 gravity = { 0, 0, -9.81 };

static ob_passport box(uint32_t id)
{
	const double mass = 1 + id, inertia = mass * .02 / 3;
	return (ob_passport){ .id = id,
			      .flags = OB_OBJECT_PRESENT,
			      .shape = OB_SHAPE_BOX,
			      .size = { .1, .1, .1 },
			      .mass = mass,
			      .inertia = { inertia, inertia, inertia } };
}

static ob_state moved(ob_ode_bodies *w, const ob_passport *p)
{
	ob_state s = { { { .5, p->id, 2 }, ob_quat_identity() }, { 1, 2, 3 }, { .1, .2, .3 } };
	ob_ode_body_step(ob_ode_bodies_get(w, gravity, p->id, p), &s, ob_v3(1, 0, 0), ob_v3(0, 0, 1), .01);
	return s;
}

static bool same(ob_state a, ob_state b)
{
	return a.v.x == b.v.x && a.v.z == b.v.z && a.w.z == b.w.z && a.pose.p.y == b.pose.p.y;
}

static void test_share(void)
{
	ob_ode_bodies w = { 0 };
	CHECK(ob_ode_bodies_create(&w, KEPT));
	ob_state first[OBJECTS];
	for (uint32_t id = 0; id < OBJECTS; id++)
		first[id] = moved(&w, (ob_passport[]){ box(id) });
	for (uint32_t id = OBJECTS; id-- > 0;)
		CHECK(same(moved(&w, (ob_passport[]){ box(id) }), first[id]));
	CHECK(first[1].v.x != first[0].v.x); // of another mass
	const ob_passport p = box(7);
	CHECK(ob_ode_bodies_get(&w, gravity, 7, &p) == ob_ode_bodies_get(&w, gravity, 7, &p));
	ob_ode_bodies_finish(&w);
}

// Another object at the same place of the table, and of the same generation, as after a state was put back.
static void test_successor(void)
{
	ob_ode_bodies w = { 0 };
	CHECK(ob_ode_bodies_create(&w, KEPT));
	ob_passport p = box(5);
	const ob_state before = moved(&w, &p);
	p.mass *= 2, p.inertia = ob_scale(p.inertia, 2);
	const ob_state after = moved(&w, &p);
	CHECK_NEAR(after.v.x - 1, .5 * (before.v.x - 1), 1e-12);
	ob_ode_bodies_finish(&w);
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
