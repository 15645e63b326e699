#include "sim/publish.h"

#include "motion/published.h"

static uint32_t leader_of(const ob_step_data *ex, uint32_t island)
{
	return ex->member[ex->island[island].first_member];
}

// In the result area, not in its slot?
static bool left_aside(const ob_universe *u, uint32_t id, uint32_t island)
{
	return ob_universe_settings(u)->one_per_object && leader_of(ob_universe_step_data(u), island) != id;
}

void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due)
{
	ob_step_data *ex = s->data;
	ex->schedule[id] = (ob_schedule){ m->path, m->reach, state, m->step, due };
	if (left_aside(s->u, id, ex->result_island[id]))
		ex->result[id] = *m;
	else
		ob_stage_motion(s->u, id, m);
}

const ob_motion *ob_result_of(const ob_universe *u, uint32_t id)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	uint32_t island = ex->result_island[id];
	if (island == UINT32_MAX)
		return ob_newest_motion(u, id);
	return left_aside(u, id, island) ? &ex->result[id] : ob_staged_motion(u, id);
}

static void note_moves(ob_sim *s, uint32_t id, const ob_motion *next)
{
	if (s->span.traced)
		ob_trace_moves(s->u, s->worker, id, ob_newest_motion(s->u, id)->flags, next->flags);
}

void ob_results_commit(ob_sim *s)
{
	ob_step_data *ex = ob_universe_step_data(s->u);
	bool alone = ob_universe_settings(s->u)->one_per_object;
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		const ob_island *is = &ex->island[i];
		for (uint32_t k = 0; k < is->members; k++) {
			uint32_t id = ex->member[is->first_member + k];
			ex->result_island[id] = UINT32_MAX;
			if (alone && k > 0)
				continue;
			note_moves(s, id, ob_staged_motion(s->u, id));
			ob_commit_motion(s->u, id);
		}
	}
}

void ob_result_copy(ob_sim *s, uint32_t id)
{
	const ob_motion *m = &ob_universe_step_data(s->u)->result[id];
	note_moves(s, id, m);
	ob_publish_motion(s->u, id, m);
}

static double time_of(const ob_universe *u, uint64_t steps)
{
	return (double)steps * ob_universe_settings(u)->step_length;
}

ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	return ob_published_at(m, ob_passport_of(u, id), time_of(u, steps));
}

ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	double time = time_of(u, steps), s = time - m->t0;
	if (ob_published_stands(m, ob_passport_of(u, id), time))
		return m->p;
	return ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a);
}

double ob_path_now(const ob_motion *m, uint64_t steps)
{
	return m->path + ((double)steps - m->step) * (double)m->reach;
}
