// Observations of standing structures: stacks, pyramids, a heavy body on a light one.
#ifndef OB_LAB_CASES_STAND_H
#define OB_LAB_CASES_STAND_H

#include "lab/case.h"

enum { OB_STAND_WORST, OB_STAND_DRIFT, OB_STAND_FALLEN, OB_STAND_MEAN, OB_STAND_FIGURES }; // ob_case_run_state.figure

// Initialiser of the figures; targets in mm.
#define OB_STAND_FIGURE(worst, drift) \
	{ \
		{ "worst penetration", "mm", worst, "no penetration" }, \
			{ "drift", "mm", drift, "it stays: farthest that a body gets aside" }, \
			{ "bodies that fell", "1", 0, "none: the stack is stable" }, \
		{ \
			"mean penetration", "mm", NAN, "no penetration; over contacts and time" \
		} \
	}

// The rest of such a case: 20 s, awake.
#define OB_STAND_CASE .duration = 20, .figures = OB_STAND_FIGURES, .observe = ob_stand_observe, .judge = ob_stand_judge

// Fails the trial when a body is more than a quarter of a metre from its place.
void ob_stand_observe(ob_case_run_state *t);
// Same where the support has been carried so far (m).
void ob_stand_observe_at(ob_case_run_state *t, ob_vec3 carried);
void ob_stand_judge(ob_case_run_state *t);

#endif
