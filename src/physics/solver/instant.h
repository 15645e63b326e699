// Bodies at an instant within a partial substep, as impacts see them (solver/impacts.h).
#ifndef OB_SOLVER_INSTANT_H
#define OB_SOLVER_INSTANT_H

#include "solver/island.h"

#define OB_SMOOTH_ACCELERATION 3. // times the largest external one: more is the echo of an impact

// Sets the drift: dv without an impact's echo. The warm start of contacts that were just hit repeats their impact, and
// must not count as an approach.
void ob_set_drift(ob_island_work *w);
// Advances a body in free flight by t (s), forwards or backwards: a parabola, with the exact attitude but for the
// rotation by its contacts, which is added to second order.
void ob_fly(const ob_island_work *w, uint32_t row, double t, ob_body_at *x);
// Returns the body at t (s) into the partial substep. Its pose in w must be up to date. A surface follows its own motion.
ob_body_at ob_body_at_time(const ob_island_work *w, uint32_t row, double t);

#endif
