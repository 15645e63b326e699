#include "step/now.h"

#include "exchange/results.h"
#include "motion/flight.h"

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
