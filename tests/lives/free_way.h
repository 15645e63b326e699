// A free run of a life: with own responses its bits differ from run to run; in groups it ends in lockstep's, momentum stays, and no
// energy comes.
#ifndef OB_TESTS_LIVES_FREE_WAY_H
#define OB_TESTS_LIVES_FREE_WAY_H

#include "run.h"

// True if it runs in groups, and nothing but deaths and pauses comes from outside: then it ends as in lockstep.
bool free_way_repeats(const life *l);
// Settings of the run, drawn from the life's seed, in place of those in lockstep.
void free_way_settings(run *r);
// Momentum (N s) and energy (J) while all stand.
typedef struct free_sums {
	ob_vec3 momentum;
	double size, energy; // size: sum of magnitudes of momenta
} free_sums;
free_sums free_way_measure(run *r);
// Compares them at the begin and the end of a closed life that ran in groups. false and e: momentum or energy has come from nowhere.
bool free_way_check(run *r, const free_sums *begin);

#endif
