#include "sim/publish.h"

#include "motion/flight.h"

static uint32_t leader_of_island(const ob_step_data *data, uint32_t island)
{
	return data->member[data->island[island].first_member];
}

// With a worker per object: does the island's leader leave the object's motion in ob_step_data.result, not in its slot?
static bool is_left_in_result(const ob_universe *u, uint32_t id, uint32_t island)
{
	return ob_universe_settings(u)->one_per_object && leader_of_island(ob_universe_step_data(u), island) != id;
}

void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due)
{
	ob_step_data *data = s->data;
	data->schedule[id] = (ob_schedule){ m->path, m->reach, state, m->step, due };
	if (is_left_in_result(s->u, id, data->result_island[id]))
		data->result[id] = *m;
	else
		ob_stage_motion(s->u, id, m);
}

const ob_motion *ob_result_of(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t island = data->result_island[id];
	if (island == UINT32_MAX)
		return ob_newest_motion(u, id);
	return is_left_in_result(u, id, island) ? &data->result[id] : ob_staged_motion(u, id);
}

static void trace_state_change(ob_sim *s, uint32_t id, const ob_motion *next)
{
	if (s->span.traced)
		ob_trace_moves(s->u, s->worker, id, ob_newest_motion(s->u, id)->flags, next->flags);
}

void ob_results_commit(ob_sim *s)
{
	ob_step_data *data = s->data;
	bool one_per_object = s->settings->one_per_object;
	for (uint32_t i = 0; i < data->count->islands; i++) {
		const ob_island *is = &data->island[i];
		for (uint32_t k = 0; k < is->members; k++) {
			uint32_t id = data->member[is->first_member + k];
			data->result_island[id] = UINT32_MAX;
			if (one_per_object && k > 0)
				continue;
			trace_state_change(s, id, ob_staged_motion(s->u, id));
			ob_commit_motion(s->u, id);
		}
	}
}

void ob_result_copy(ob_sim *s, uint32_t id)
{
	const ob_motion *m = &s->data->result[id];
	trace_state_change(s, id, m);
	ob_publish_motion(s->u, id, m);
}

static double time_after(const ob_universe *u, uint64_t steps)
{
	return (double)steps * ob_universe_settings(u)->step_length;
}

ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	return ob_published_at(m, ob_passport_of(u, id), time_after(u, steps));
}

ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	double time = time_after(u, steps), s = time - m->t0;
	if (ob_published_stands(m, ob_passport_of(u, id), time))
		return m->p;
	return ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a);
}

double ob_path_now(const ob_motion *m, uint64_t steps)
{
	return m->path + ((double)steps - m->step) * (double)m->reach;
}
