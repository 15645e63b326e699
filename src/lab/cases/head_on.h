// Head-on impact of two bodies: 12 runs, over shape, ratio of masses and restitution. Shared by the cases of the same
// impact near the origin, far from it, and with a partner's late state.
#ifndef OB_LAB_CASES_HEAD_ON_H
#define OB_LAB_CASES_HEAD_ON_H

#include "lab/case.h"

enum { OB_HEAD_ON_RUNS = 12 };

typedef struct ob_head_on {
	double ratio; // second mass over the first, which is 1 kg
	double e;
	bool boxes; // otherwise balls
} ob_head_on;

ob_head_on ob_head_on_of(uint32_t run);
// Adds the pair to a world without gravity: both are 1 m wide, and the first comes in at 1 m/s along x. at: its x (m).
void ob_head_on_build(ob_world *w, uint32_t run, const double *at);
// Error (m/s) of the velocities of bodies "first" and first + 1 against Newton's; the scene's scale is 1 m/s.
double ob_head_on_error(const ob_case_run_state *t, uint32_t first);
// True if they passed through each other, or never touched.
bool ob_head_on_missed(const ob_case_run_state *t, uint32_t first);

#endif
