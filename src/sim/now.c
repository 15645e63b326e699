#include "sim/now.h"

#include "motion/published.h"

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
