#include "motion/published.h"

bool ob_published_stands(const ob_motion *m, const ob_passport *p, double t)
{
	return m->t0 == t || p->flags & OB_OBJECT_STATIC || m->flags & OB_MOTION_RESTS;
}

ob_state ob_published_at(const ob_motion *m, const ob_passport *p, double t)
{
	if (ob_published_stands(m, p, t))
		return (ob_state){ { m->p, m->q }, m->v, m->w };
	return ob_motion_at(m, p->inertia, t);
}
