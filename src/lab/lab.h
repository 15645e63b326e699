// The lab: cases x engines x settings, one attempt after the other, into one list of results and its file.
// Thread-safety: as ob_attempt_run.
#ifndef OB_LAB_LAB_H
#define OB_LAB_LAB_H

#include "lab/list.h"
#include "lab/result.h"
#include "lab/sweep.h"

typedef struct ob_lab_progress {
	const ob_case *of;
	const ob_engine_kind *engine;
	ob_run_settings settings;
	size_t done, all; // attempts of this call; what an earlier one has left does not count
	double left; // s, a guess; NAN = none yet
} ob_lab_progress;

typedef struct ob_lab_plan {
	ob_case_list cases;
	ob_engine_list engines;
	ob_sweep sweep;
	uint32_t repeats; // 1 .. OB_REPEATS
	double limit; // s, of each attempt: as there
	const char *file; // written after each attempt
	void (*tick)(const ob_lab_progress *p, void *with); // a few times a second; NULL = not wanted
	void *with;
} ob_lab_plan;

// Does what r does not have yet. Engines and settings take turns, repeat by repeat, so that a busy minute of the machine
// hits all of a case alike. What is finer than a setting that ran out of time fails with it, untried. false and e:
// interrupted, or the file cannot be written; what was done until then is in both.
bool ob_lab_run(const ob_lab_plan *p, ob_results *r, ob_error *e);

#endif
