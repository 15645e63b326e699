// The critical path of simulated workers, of tasks whose time is known.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "step/profile.h"

enum { OBJECTS = 400 };

static ob_universe *timed_universe(little_scene *s)
{
	s->run.timed = true;
	for (int i = 0; i < OBJECTS; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(i, 0, 0));
	return little_populate(s, 1);
}

static uint64_t path_of(ob_universe *u, ob_phase phase, uint32_t per_worker)
{
	const uint64_t before = ob_simulated_path(u);
	ob_critical_path_close(u, phase, per_worker);
	return ob_simulated_path(u) - before;
}

static void take(ob_universe *u, uint32_t tasks, uint32_t ns)
{
	ob_task_reset(u, tasks, 1);
	for (uint32_t i = 0; i < tasks; i++)
		ob_task_took(u, i, ns);
}

// The first free worker takes the next task; few tasks go to few workers; each task counts once.
static void test_tasks(ob_universe *u)
{
	take(u, 32, 10);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 20);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 0);
	take(u, 33, 10);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 30);
	take(u, 32, 10);
	CHECK(path_of(u, OB_PHASE_BROADPHASE, 16) == 110); // 1 + 32 / 16 workers
	take(u, 40, 10);
	ob_task_took(u, 0, 90); // 100 for the first, the other 39 for fifteen workers
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 100);
	ob_task_took(u, 0, 90);
	ob_task_took(u, 39, 100);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 100);
}

// More tasks than objects: the sum is there.
static void test_many(ob_universe *u)
{
	take(u, 10 * OBJECTS, 16);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 10 * OBJECTS);
}

// The critical path includes the longest worker's time beside its tasks, and the serial part.
static void test_beside(ob_universe *u)
{
	const uint64_t before = ob_critical_path(u);
	take(u, 16, 10);
	ob_phase_worked(u, 100, 3);
	ob_phase_worked(u, 70, 5);
	CHECK(path_of(u, OB_PHASE_LATE_CONTACTS, 0) == 10 + 5);
	CHECK(ob_critical_path(u) - before == 100);
	ob_critical_add(u, 7, 7);
	CHECK(ob_critical_path(u) - before == 107);
}

// Islands are put into chunks as for the simulated workers: here one each, which all but the last two workers have
// once.
static void test_islands(ob_universe *u)
{
	enum { ISLANDS = 2 * OB_SIMULATED_WORKERS - 2 };
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; i <= ISLANDS; i++)
		data->island[i] = (ob_island){ .work = i < ISLANDS ? 1000 : 0, .solved = i == ISLANDS };
	data->count->islands = ISLANDS + 1;
	data->count->unsolved = ISLANDS;
	take(u, 0, 0);
	for (uint32_t i = 0; i < ISLANDS; i++)
		ob_task_took(u, i, i < OB_SIMULATED_WORKERS ? 100 : 10);
	CHECK(path_of(u, OB_PHASE_ISLANDS, 0) == 110);
	// Small ones are solved several at a time: all of the work is that of one chunk.
	for (uint32_t i = 0; i < ISLANDS; i++)
		data->island[i].work = 1;
	for (uint32_t i = 0; i < ISLANDS; i++)
		ob_task_took(u, i, 10);
	CHECK(path_of(u, OB_PHASE_ISLANDS, 0) == 10 * ISLANDS);
}

int main(void)
{
	little_scene *s = little_scene_new();
	ob_universe *u = timed_universe(s);
	test_tasks(u);
	test_many(u);
	test_beside(u);
	test_islands(u);
	ob_universe_destroy(u, true);
	free(s);
	return check_end();
}
