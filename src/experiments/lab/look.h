// Observations of cases in a trial: bodies now and at the start, the energy, the worst so far.
#ifndef OB_LAB_LOOK_H
#define OB_LAB_LOOK_H

#include "lab/case.h"

ob_state ob_look_at(const ob_case_run_state *t, uint32_t id);
ob_vec3 ob_look_moved(const ob_case_run_state *t, uint32_t id); // m, since the start
bool ob_look_moves(const ob_case_run_state *t, uint32_t id); // unaffected bodies (static, kinematic): false
double ob_look_energy(const ob_case_run_state *t); // J; potential energy is 0 at z = 0
double ob_look_farthest(const ob_case_run_state *t); // m: largest distance of a body from its start
// Fails the trial, and returns true, if a centre is a metre below the level ground: through it, not just deep in it.
bool ob_look_fail_below(ob_case_run_state *t);
// Fails the trial if no body is elsewhere than at its start.
void ob_look_fail_still(ob_case_run_state *t);
double ob_look_parted(const ob_case_run_state *t); // m: largest distance of the two places of a joint that must be one
// Penetrations now; keeps the worst (mm).
ob_penetration ob_look_penetration(const ob_case_run_state *t, double *worst);
double ob_look_gravity(const ob_case_run_state *t); // m/s^2, magnitude

// Sets the figure to the larger of the two. NaN counts as the largest, and stays.
void ob_look_keep(double *figure, double value);
// Same for all figures of two runs.
void ob_look_keep_all(double *figure, const double *value);

#endif
