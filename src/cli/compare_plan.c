// What a comparison runs: the ways, and the values of what is varied.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "cli/compare.h"

const ob_way ob_way_table[OB_WAYS] = {
	[OB_WAY_MONOLITH] = { "monolith", "monolith", "monolith", "thread", OB_CROWD_ONE, 0, false },
	[OB_WAY_THREAD] = { "thread_1", "1 thread", "obs", "thread", OB_CROWD_ONE, 0, false },
	[OB_WAY_THREADS_2] = { "threads_2", "2 threads", "obs", "thread", OB_CROWD_TWO, 0, false },
	[OB_WAY_THREADS] = { "threads", "thread pool", "obs", "thread", OB_CROWD_POOL, 0, false },
	[OB_WAY_PROCESSES] = { "processes", "process pool", "obs", "process", OB_CROWD_POOL, 0, false },
	[OB_WAY_GROUPS] = { "process_groups", "groups of 60", "obs", "process", OB_CROWD_GROUPS, 0, false },
	// more than these make one workstation wait for its scheduler alone
	[OB_WAY_THREADS_EACH] = { "threads_each", "thread each", "obs", "thread", OB_CROWD_EACH, 4096, false },
	[OB_WAY_PROCESSES_EACH] = { "processes_each", "process each", "obs", "process", OB_CROWD_EACH, 1024, false },
	[OB_WAY_MONOLITH_OTHER] = { "monolith_other", "monolith", "monolith", "thread", OB_CROWD_ONE, 0, true },
	[OB_WAY_THREADS_OTHER] = { "threads_other", "thread pool", "obs", "thread", OB_CROWD_POOL, 0, true },
};
static uint32_t workers_of(const ob_way *w, uint32_t objects, uint32_t pool)
{
	switch (w->crowd) {
	case OB_CROWD_ONE:
		return 1;
	case OB_CROWD_TWO:
		return 2;
	case OB_CROWD_POOL:
		return pool;
	case OB_CROWD_GROUPS:
		return (objects + OB_GROUP - 1) / OB_GROUP;
	case OB_CROWD_EACH:
		return objects;
	}
	return 1;
}

bool ob_section_plan(ob_section *s, const ob_comparison *c)
{
	for (int i = 0; i < OB_WAYS; i++) {
		const ob_way *w = &ob_way_table[i];
		ob_cell *cell = &s->cell[i];
		cell->workers = workers_of(w, s->objects, c->pool);
		bool same = (i == OB_WAY_THREAD || i == OB_WAY_THREADS_2) && cell->workers == c->pool;
		if (same)
			snprintf(cell->why, sizeof cell->why, "the pool has as many");
		else if (i == OB_WAY_GROUPS && cell->workers < 2)
			snprintf(cell->why, sizeof cell->why, "%" PRIu32 " objects are one group", s->objects);
		else if (w->objects_max && s->objects > w->objects_max)
			snprintf(cell->why, sizeof cell->why,
				 "%" PRIu32 " objects are more than the %" PRIu32 " that are tried", s->objects,
				 w->objects_max);
		else
			cell->state = OB_WAY_DONE;
		cell->sample = calloc(c->repeats, sizeof *cell->sample);
		if (!cell->sample)
			return false;
	}
	return true;
}

bool ob_comparison_read_sections(ob_comparison *c, const char *vary, ob_error *e)
{
	c->sections = 1;
	if (!vary)
		return true;
	const char *value = strchr(vary, '=');
	if (!value || value == vary || !value[1])
		return ob_fail(e, "--vary %s: expected NAME=VALUE,VALUE, as in --vary n=100,1000", vary);
	int name = (int)(value - vary);
	for (c->sections = 0, value++; value; value = strchr(value, ','), value += value != NULL) {
		if (c->sections == OB_SECTIONS_MAX)
			return ob_fail(e, "--vary %s: at most %d values", vary, OB_SECTIONS_MAX);
		snprintf(c->section[c->sections++].define, sizeof c->section->define, "%.*s=%.*s", name, vary,
			 (int)strcspn(value, ","), value);
	}
	return true;
}
