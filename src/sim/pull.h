// What accelerates an object that touches nothing. Pure functions.
#ifndef OB_SIM_PULL_H
#define OB_SIM_PULL_H

#include "table/table.h"

// Gravity and the constant force of its passport, m/s^2; nothing pulls at what never moves.
static inline ob_vec3 ob_external_acceleration(const ob_run_settings *run, const ob_passport *p)
{
	return p->mass > 0 ? ob_madd(run->gravity, 1 / p->mass, p->force) : ob_v3(0, 0, 0);
}

#endif
