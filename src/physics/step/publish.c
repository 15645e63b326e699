#include "step/publish.h"

#include "exchange/results.h"
#include "motion/flight.h"

void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due)
{
	if (!ob_state_is_sane(&(ob_state){ { m->p, m->q }, m->v, m->w }) || !isfinite(m->path))
		ob_step_fail(s->u, OB_STEP_DIVERGED, id);
	ob_commit_result(s->u, &(ob_found_result){ .id = id, .state = state, .due = due, .motion = *m });
}

static void trace_state_change(ob_sim *s, uint32_t id, const ob_motion *next)
{
	if (s->span.traced)
		ob_trace_moves(s->u, s->worker, id, ob_newest_motion(s->u, id)->flags, next->flags);
}

// Prefetches an island's members, which lie anywhere, as islands are sorted by work. halo: NULL on a single rank.
static void prefetch_members(const ob_universe *u, const ob_halo *halo, uint32_t island)
{
	enum { MOST = 8 };
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_island *is = &data->island[island];
	for (uint32_t k = 0; k < is->members && k < MOST; k++) {
		const uint32_t id = data->member[is->first_member + k];
		__builtin_prefetch(&data->result_island[id], 1);
		if (halo) {
			ob_prefetch_versions(u, id);
			continue;
		}
		__builtin_prefetch(&data->schedule[id]);
		ob_prefetch_slot(u, id);
	}
}

static void publish(ob_sim *s, ob_halo *halo, uint32_t id)
{
	trace_state_change(s, id, ob_staged_motion(s->u, id));
	ob_commit_motion(s->u, id);
	ob_halo_note_published(halo, s->u, id);
}

void ob_results_commit(ob_sim *s, uint32_t first, uint32_t end)
{
	enum { AHEAD = 4 };
	const ob_step_data *data = s->data;
	const bool others_copy = s->settings->one_per_object && !ob_universe_contains(s->u);
	ob_halo *halo = ob_cluster_halo(s->cluster);
	int32_t woken = 0;
	for (uint32_t i = first; i < end; i++) {
		const ob_island *is = &data->island[i];
		if (i + AHEAD < end)
			prefetch_members(s->u, halo, i + AHEAD);
		for (uint32_t k = 0; k < is->members; k++) {
			const uint32_t id = data->member[is->first_member + k];
			data->result_island[id] = UINT32_MAX;
			if (!halo) { // else bodies that wake are counted where a result is committed
				woken += data->schedule[id].state != OB_SCHEDULE_ASLEEP;
				woken -= !(ob_newest_motion(s->u, id)->flags & OB_MOTION_ASLEEP);
			}
			if (others_copy && k > 0)
				continue;
			publish(s, halo, id);
		}
	}
	for (uint32_t id; ob_halo_take_received(halo, &id);)
		publish(s, halo, id);
	ob_step_woken(s->u, woken);
}

void ob_result_copy(ob_sim *s, uint32_t id)
{
	const ob_motion *m = &s->data->result[id];
	trace_state_change(s, id, m);
	ob_publish_motion(s->u, id, m);
}

// ---- now

const ob_motion *ob_result_of(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (data->schedule[id].since <= ob_step_count(u)) // it was solved in none since
		return ob_newest_motion(u, id);
	return ob_is_left_in_result(u, id) ? &data->result[id] : ob_staged_motion(u, id);
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
	const double time = time_after(u, steps);
	if (ob_published_stands(m, ob_passport_of(u, id), time))
		return m->p;
	return ob_centre_at(m, time);
}

double ob_path_now(const ob_motion *m, uint64_t steps)
{
	return m->path + ((double)steps - m->step) * (double)m->reach;
}
