#include "schedule/pair_checks.h"

#include <math.h>

#include "schedule/calendar.h"
#include "table/home.h"

static bool lives_here(const ob_universe *u, uint32_t id)
{
	return ob_schedule_is_dynamic(&ob_universe_step_data(u)->schedule[id]) &&
	       ob_worker_is_here(u, ob_home_of(u, id));
}

bool ob_pair_is_known_here(const ob_universe *u, const ob_pair_key *k)
{
	return ob_universe_ranks(u) < 2 || lives_here(u, k->a) || lives_here(u, k->b);
}

bool ob_pair_is_checked_here(const ob_universe *u, const ob_pair_key *k)
{
	const bool a = ob_schedule_is_dynamic(&ob_universe_step_data(u)->schedule[k->a]);
	return ob_universe_ranks(u) < 2 || ob_worker_is_here(u, ob_home_of(u, a ? k->a : k->b));
}

static bool is_across(const ob_universe *u, uint32_t a, uint32_t b)
{
	const ob_step_data *data = ob_universe_step_data(u);
	return ob_schedule_is_dynamic(&data->schedule[a]) && ob_schedule_is_dynamic(&data->schedule[b]) &&
	       ob_home_rank(u, a) != ob_home_rank(u, b);
}

bool ob_pair_is_across(const ob_universe *u, const ob_pair_key *k)
{
	return is_across(u, k->a, k->b);
}

bool ob_joint_is_across(const ob_universe *u, const ob_joint_passport *j)
{
	const uint32_t most = ob_universe_step_data(u)->objects_max;
	return j->kind != OB_JOINT_APART && j->object[0] < most && j->object[1] < most && ob_joint_holds(u, j) &&
	       is_across(u, j->object[0], j->object[1]);
}

void ob_pair_enter_check(ob_universe *u, uint32_t pair, uint64_t step)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k = &data->pair[pair];
	const ob_calendar look = ob_calendar_of_pairs(u);
	if (step < data->count->next_due)
		data->count->next_due = (uint32_t)step;
	ob_calendar_set(&look, pair, ob_pair_is_checked_here(u, k) ? step : UINT32_MAX);
}

void ob_pairs_look(ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id], n = 0; ob_pair_at(data, link, &at) && n < data->objects_max;
	     link = ob_pair_next(data, at), n++)
		ob_pair_enter_check(u, at.pair, 0);
}

void ob_pairs_follow(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		ob_pair_key *k = &data->pair[at.pair];
		if (!ob_object_in_range(data, k->a) || !ob_object_in_range(data, k->b) ||
		    !ob_pair_is_checked_here(u, k))
			continue;
		if (data->count->merged)
			ob_pair_void_check(k);
		ob_calendar_set(&look, at.pair, ob_step_count(u) + 1);
	}
}
