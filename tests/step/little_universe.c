#include "little_universe.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "ode/ode_body.h"

static void give_up(const char *what, const char *why)
{
	fprintf(stderr, "%s: %s\n", what, why);
	exit(1);
}

little_scene *little_scene_new(void)
{
	little_scene *s = calloc(1, sizeof *s);
	if (!s)
		give_up("scene", "no memory");
	s->run = (ob_run_settings){
		.gravity = { 0, 0, -9.81 }, .step_length = 1. / 60, .substeps = 8, .iterations = 16
	};
	s->world = (ob_world){
		.gravity = s->run.gravity, .objects_max = LITTLE_MOST, .passport = s->passport, .state = s->state
	};
	return s;
}

// Returns the step at which it is due again.
static uint64_t prescribe(ob_universe *u, const ob_world *w)
{
	uint64_t next = UINT64_MAX;
	for (uint32_t id = 0; id < w->objects; id++) {
		if (!(ob_passport_of(u, id)->flags & OB_OBJECT_KINEMATIC))
			continue;
		const uint64_t due = ob_sim_prescribe(u, id, ob_world_path(w, id), 0);
		next = due < next ? due : next;
	}
	return next;
}

ob_universe *little_populate(const little_scene *s, uint32_t workers)
{
	static int made;
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-sim-%d-%d", (int)getpid(), made++);
	ob_universe_setup setup = { .name = name,
				    .capacity = s->capacity ? s->capacity : s->world.objects,
				    .workers = workers,
				    .hulls = s->world.hulls,
				    .joints = s->world.joints,
				    .terrains = s->world.terrains,
				    .isolation = "thread",
				    .checked = s->checked,
				    .harden = s->harden,
				    .run = s->run };
	ob_error e;
	ob_ode_init();
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u)
		give_up("universe", e.text);
	for (uint32_t i = 0; i < s->world.hulls; i++)
		if (!ob_write_hull(u, i, &s->world.hull[i]))
			give_up("hull", "no room");
	for (uint32_t i = 0; i < s->world.objects; i++)
		ob_write_passport(u, i, &s->world.passport[i]);
	ob_joints_write(u, s->world.joint, s->world.joints);
	for (uint32_t i = 0; i < s->world.objects; i++)
		ob_sim_place(u, i, &s->world.state[i]);
	prescribe(u, &s->world);
	return u;
}

void little_open(little_universe *l, const little_scene *s)
{
	ob_error e;
	*l = (little_universe){ .scene = s, .u = little_populate(s, 1) };
	ob_ode_thread_init();
	l->sim = ob_sim_create(l->u, 0, &e);
	if (!l->sim)
		give_up("simulators", e.text);
	little_run(l, 0);
}

void little_close(little_universe *l)
{
	ob_sim_destroy(l->sim);
	ob_ode_thread_finish();
	ob_snapshot_finish(&l->now);
	ob_universe_destroy(l->u, true);
}

// The worker and the host alternate in one thread: the host runs when the gate pauses.
void little_run(little_universe *l, uint64_t steps)
{
	ob_error e;
	const uint64_t end = ob_step_count(l->u) + steps;
	do {
		const uint64_t next = prescribe(l->u, &l->scene->world);
		ob_gate_set_pause_step(l->u, next < end ? next : end);
		ob_sim_resume(l->u);
		while (!ob_gate_host_wait(l->u, 0))
			ob_step(l->sim);
		if (ob_sim_failure(l->u))
			give_up("step", ob_sim_failure(l->u));
	} while (ob_step_count(l->u) < end);
	if (!ob_snapshot_take(&l->now, l->u, 0, &e))
		give_up("snapshot", e.text);
}

void little_run_to(little_universe *l, double time)
{
	little_run(l, (uint64_t)lround(time / l->scene->run.step_length) - ob_step_count(l->u));
}

void little_put(little_universe *l, uint32_t id)
{
	ob_write_passport(l->u, id, &l->scene->world.passport[id]);
	ob_sim_place(l->u, id, &l->scene->world.state[id]);
}

void little_take_away(little_universe *l, uint32_t id)
{
	ob_sim_remove(l->u, id);
}

ob_state little_state(const little_universe *l, uint32_t id)
{
	return ob_snapshot_state(&l->now, id);
}

double little_energy(const little_universe *l)
{
	return ob_measure_energy(&l->now, l->scene->run.gravity);
}

ob_penetration little_penetration(const little_universe *l)
{
	ob_penetration p;
	ob_measure_penetration(&l->now, &p);
	return p;
}

bool little_asleep(const little_universe *l, uint32_t id)
{
	return l->now.motion[id].flags & OB_MOTION_ASLEEP;
}
