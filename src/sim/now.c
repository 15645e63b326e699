#include "sim/now.h"

static bool still(const ob_motion *m, const ob_passport *pass, double time)
{
	return m->t0 == time || pass->flags & OB_OBJECT_STATIC || m->flags & OB_MOTION_RESTS;
}

ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	const ob_passport *pass = ob_passport_of(u, id);
	double time = (double)steps * ob_universe_settings(u)->step_length;
	if (still(m, pass, time))
		return (ob_state){ { m->p, m->q }, m->v, m->w };
	return ob_motion_at(m, pass->inertia, time);
}

ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps)
{
	double time = (double)steps * ob_universe_settings(u)->step_length, s = time - m->t0;
	if (still(m, ob_passport_of(u, id), time))
		return m->p;
	return ob_madd(ob_madd(m->p, s, m->v), .5 * s * s, m->a);
}

double ob_path_now(const ob_motion *m, uint64_t steps)
{
	return m->path + ((double)steps - m->step) * (double)m->reach;
}
