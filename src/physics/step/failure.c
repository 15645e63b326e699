// Reasons why a run cannot go on, as the host shows them.
#include <stdio.h>
#include <stdlib.h>

#include "base/allocate.h"
#include "schedule/calendar.h"
#include "step/budget.h"
#include "step/islands.h"
#include "step/sim.h"
#include "table/free.h"

enum { NAMED = 120 }; // bytes of "object 4294967295 (" and a name

// Returns "object 3 (crate)", in one of two texts of the thread in turn.
static const char *name_of(const ob_universe *u, uint32_t id)
{
	static _Thread_local char texts[2][NAMED];
	static _Thread_local unsigned turn;
	char *text = texts[turn++ % 2];
	const char *name = ob_passport_of(u, id)->name;
	snprintf(text, NAMED, "object %u%s%.*s%s", id, *name ? " (" : "", OB_NAME_MAX, name, *name ? ")" : "");
	return text;
}

static bool is_crowded(ob_step_failure why)
{
	return why == OB_STEP_PAIRS_FULL || why == OB_STEP_NEIGHBOURS_FULL;
}

// Size of an object's share in the pairs that are too many: their number, or the extent of its fat AABB while the queries
// are not complete, as those that find no room depend on the order of workers.
static double crowding(const ob_universe *u, uint32_t id, const uint32_t *pairs)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const float *b = data->bounds[id];
	if (!ob_schedule_is_dynamic(&data->schedule[id]))
		return 0;
	return ob_step_failed(u, NULL) == OB_STEP_PAIRS_FULL
		       ? pairs[id]
		       : (double)(b[3] - b[0]) + (double)(b[4] - b[1]) + (double)(b[5] - b[2]);
}

// Counts the pairs of each object. The caller frees them.
static uint32_t *count_pairs(const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t *pairs = ob_allocate_zeroed((data->objects_max + 1) * sizeof *pairs);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->a == k->b || k->a >= data->objects_max || k->b >= data->objects_max)
			continue;
		pairs[k->a]++, pairs[k->b]++;
	}
	return pairs;
}

// Lists objects that have at least half as large a share as the most crowded one, which comes first.
static uint32_t list_crowd(const ob_universe *u, const uint32_t *pairs, uint32_t *ids, uint32_t most)
{
	uint32_t worst = 0, n = 0;
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		if (crowding(u, id, pairs) > crowding(u, worst, pairs))
			worst = id;
	if (most > 0)
		ids[n++] = worst;
	for (uint32_t id = 0; id < ob_universe_ids(u) && n < most; id++)
		if (id != worst && crowding(u, id, pairs) * 2 >= crowding(u, worst, pairs) &&
		    crowding(u, id, pairs) > 0)
			ids[n++] = id;
	return n;
}

uint32_t ob_crowd(const ob_universe *u, uint32_t *ids, uint32_t most)
{
	uint32_t *pairs = count_pairs(u);
	const uint32_t n = list_crowd(u, pairs, ids, most);
	free(pairs);
	return n;
}

// Cost of the object's island in this step; 0: it has none.
static uint64_t cost_of_island(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t place = data->result_island[id];
	return place < data->count->islands ? (uint64_t)data->effort[id] * data->island[place].members : 0;
}

void ob_crowd_limit_work(ob_universe *u, bool solved)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (ob_step_failed(u, NULL) != OB_STEP_OK || data->count->work <= ob_work_limit(u))
		return;
	const uint32_t ids = ob_universe_ids(u);
	uint32_t *pairs = count_pairs(u), worst = 0;
	uint64_t *cost = ob_allocate_zeroed((ids + 1) * sizeof *cost);
	for (uint32_t id = 0; id < ids; id++) {
		cost[id] = !ob_schedule_is_dynamic(&data->schedule[id]) ? 0
			   : solved                                     ? cost_of_island(u, id)
									: pairs[id];
		worst = cost[id] > cost[worst] ? id : worst;
	}
	for (uint32_t id = 0; id < ids; id++)
		if (cost[id] > 0 && 2 * cost[id] >= cost[worst])
			data->effort[id] = OB_EFFORT_GIVEN_UP;
	free(cost);
	free(pairs);
	ob_step_fail(u, OB_STEP_OVERWORKED, worst);
}

// Names the object with most pairs, or the largest: it is too large, or too fast.
static void describe_crowd(const ob_universe *u, uint32_t most, char *text, size_t size)
{
	uint32_t *pairs = count_pairs(u), id;
	char count[32] = "";
	list_crowd(u, pairs, &id, 1);
	if (ob_step_failed(u, NULL) == OB_STEP_PAIRS_FULL)
		snprintf(count, sizeof count, ", which has %u,", pairs[id]);
	snprintf(text, size,
		 "more than %u pairs of neighbours, with each other and with surfaces of terrain; make %s%s smaller or "
		 "slower, or try a smaller --step",
		 most, name_of(u, id), count);
	free(pairs);
}

// Names some objects of the island that took so much work.
static void describe_work(const ob_universe *u, uint32_t object, unsigned long long step, char *text, size_t size)
{
	enum { SHOWN = 4 };
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t place = data->result_island[object];
	const ob_island *is = place < data->count->islands && place < data->objects_max ? &data->island[place] : NULL;
	int n = snprintf(text, size, "step %llu takes more work than a step may: ", step);
	for (uint32_t i = 0; is && i < is->members && i < SHOWN && is->first_member + i < data->objects_max; i++) {
		uint32_t id = data->member[is->first_member + i];
		if (id < data->objects_max)
			n += snprintf(text + n, size - (size_t)n, "%s%s", i ? ", " : "", name_of(u, id));
	}
	if (!is)
		n += snprintf(text + n, size - (size_t)n, "%s", name_of(u, object));
	if (is && is->members > SHOWN)
		n += snprintf(text + n, size - (size_t)n, " and %u more", is->members - SHOWN);
	if (data->script_of && object < data->objects_max && data->script_of[object])
		n += snprintf(text + n, size - (size_t)n, " would need millions of instructions of scripts, or of");
	else
		n += snprintf(text + n, size - (size_t)n, " would need millions of");
	snprintf(text + n, size - (size_t)n,
		 " substeps or collision tests; make what is fast slower, what is thin thicker, or try a smaller "
		 "--step");
}

// Names the culprit, which is known if simulators are contained.
static const char *damage(const ob_universe *u)
{
	static _Thread_local char text[OB_STEP_BLAME_MAX + 32];
	const struct ob_step_counts *count = ob_universe_step_data(u)->count;
	if (!ob_universe_contains(u) || !count->culprit)
		return "what simulators share makes no sense: one of them has written where it should not";
	snprintf(text, sizeof text, "simulator %u %.*s", count->culprit - 1, (int)sizeof count->blamed_for - 1,
		 count->blamed_for);
	return text;
}

const char *ob_sim_failure(const ob_universe *u)
{
	static _Thread_local char text[6 * NAMED + 256];
	const ob_step_data *data = ob_universe_step_data(u);
	const unsigned long long step = ob_step_count(u) + 1;
	uint32_t object;
	switch (ob_step_failed(u, &object)) {
	case OB_STEP_PAIRS_FULL:
	case OB_STEP_NEIGHBOURS_FULL:
		describe_crowd(u, data->pairs_max, text, sizeof text);
		return text;
	case OB_STEP_DIVERGED:
		snprintf(text, sizeof text,
			 "%s diverged in step %llu: its state is no longer a number, or beyond 1e15 m, m/s or rad/s; "
			 "try more "
			 "substeps or a smaller step",
			 name_of(u, object), step);
		return text;
	case OB_STEP_ENGINE:
		snprintf(
			text, sizeof text,
			"the solver gave up in step %llu at %s, whose state is too wild for it; try more substeps or a "
			"smaller step",
			step, name_of(u, object));
		return text;
	case OB_STEP_OVERWORKED:
		describe_work(u, object, step, text, sizeof text);
		return text;
	case OB_STEP_SURFACES_FULL:
		snprintf(text, sizeof text,
			 "%s is near more surfaces of terrain than a step takes, %u and %u more for each body that it "
			 "touches; make it smaller or slower, take a mesh of fewer triangles, or try a smaller --step",
			 name_of(u, object), OB_SURFACES_OF_AN_ISLAND, OB_SURFACES_OF_A_BODY);
		return text;
	case OB_STEP_BROKEN:
		snprintf(text, sizeof text, "what simulators share is wrong when %llu steps are complete: %.*s",
			 step - 1, (int)sizeof data->count->blamed_for - 1, data->count->blamed_for);
		return text;
	case OB_STEP_UNPLANNED:
		snprintf(text, sizeof text, "%.*s: %.*s", (int)sizeof ob_free_settings_of(u)->schedule,
			 ob_free_settings_of(u)->schedule, (int)sizeof data->count->blamed_for - 1,
			 data->count->blamed_for);
		return text;
	case OB_STEP_LEFT:
		return ob_universe_ranks(u) > 1 ? "another rank has left the run" : "the run was stopped";
	case OB_STEP_MEMORY_FULL:
		return "/dev/shm is full, and more objects touch: enlarge it (mount -o remount,size=..., docker run "
		       "--shm-size=...) or take fewer objects";
	case OB_STEP_OK:
		return NULL;
	default:
		return damage(u);
	}
}

uint32_t ob_sim_culprit(const ob_universe *u)
{
	return ob_universe_contains(u) ? ob_universe_step_data(u)->count->culprit - 1 : UINT32_MAX;
}

bool ob_sim_failed_alone(const ob_universe *u, uint32_t *object)
{
	const ob_step_failure why = ob_step_failed(u, object);
	if (is_crowded(why))
		ob_crowd(u, object, 1);
	return is_crowded(why) || why == OB_STEP_OVERWORKED || why == OB_STEP_SURFACES_FULL ||
	       why == OB_STEP_DIVERGED || why == OB_STEP_ENGINE;
}

bool ob_sim_damaged(const ob_universe *u)
{
	return ob_step_failed(u, NULL) >= OB_STEP_DAMAGED;
}
