// One case with one engine at one setting, in a child process of its own with a limit on its time: whatever the engine
// does there, the lab goes on and has a result.
// Thread-safety: one attempt at a time per process, by its only thread.
#ifndef OB_LAB_ATTEMPT_H
#define OB_LAB_ATTEMPT_H

#include "lab/case.h"

typedef struct ob_attempt {
	const ob_case *of;
	const ob_engine_kind *engine;
	ob_run_settings settings;
	double limit; // s of CPU, and four times as many of wall-clock time: a busy machine is not the engine's fault
	void (*tick)(void *with); // a few times a second while the child runs; NULL = not wanted
	void *with;
} ob_attempt;

// From begin to end SIGINT, SIGTERM and SIGHUP end the attempt that is under way, or the next one, and nothing else.
void ob_attempts_begin(void);
void ob_attempts_end(void);
bool ob_attempts_interrupted(void);

// Engines that crash, hang, end or cannot be made give a failed outcome with the reason: figures infinite, bodies times
// seconds not a number. false and e: no child could be started, or it was interrupted.
bool ob_attempt_run(const ob_attempt *a, ob_outcome *out, ob_error *e);
bool ob_attempt_ran_out(const ob_outcome *out); // of time
// The outcome of one that this limit, being longer, might let come to its end.
bool ob_attempt_had_less(const ob_outcome *out, double limit);

#endif
