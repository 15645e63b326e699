#include "step/critical_path.h"

#include "step/island_builder.h"

// Finish time (ns) of each simulated worker.
typedef struct crew {
	uint64_t until[OB_SIMULATED_WORKERS];
	uint32_t count;
} crew;

static void claim(crew *c, uint64_t task)
{
	uint32_t first = 0;
	for (uint32_t i = 1; i < c->count; i++)
		first = c->until[i] < c->until[first] ? i : first;
	c->until[first] += task;
}

static void claim_tasks(crew *c, ob_universe *u, uint32_t per_worker)
{
	const uint32_t tasks = ob_task_count(u);
	if (per_worker && 1 + tasks / per_worker < c->count)
		c->count = 1 + tasks / per_worker;
	for (uint32_t i = 0; i < tasks; i++)
		claim(c, ob_task_take_time(u, i));
}

// Claims chunks of islands. Unsolved islands come first in the list, the largest ahead.
static void claim_chunks(crew *c, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t unsolved = data->count->unsolved;
	uint64_t total = 0, filled = 0, chunk = 0;
	for (uint32_t i = 0; i < unsolved; i++)
		total += data->island[i].work;
	const uint64_t most = ob_islands_chunk_work(total, OB_SIMULATED_WORKERS);
	for (uint32_t i = 0; i < unsolved; i++) {
		chunk += ob_task_take_time(u, i);
		filled += data->island[i].work;
		if (filled < most && i + 1 < unsolved)
			continue;
		claim(c, chunk);
		chunk = filled = 0;
	}
}

void ob_critical_path_close(ob_universe *u, ob_phase phase, uint32_t per_worker)
{
	crew c = { .count = OB_SIMULATED_WORKERS };
	const uint64_t beside = ob_phase_close(u);
	uint64_t last = 0;
	if (ob_universe_settings(u)->timed && phase == OB_PHASE_ISLANDS)
		claim_chunks(&c, u);
	else if (ob_universe_settings(u)->timed)
		claim_tasks(&c, u, per_worker);
	for (uint32_t i = 0; i < c.count; i++)
		last = c.until[i] > last ? c.until[i] : last;
	ob_critical_add(u, 0, last + beside);
}
