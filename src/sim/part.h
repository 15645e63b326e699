// Which part of the step a worker's time goes to; costs nothing unless the run is timed, or traced in detail.
//
// A thread's CPU clock costs a system call, a hundred times as much as the clock on the wall. So parts are told apart by
// the wall, and the CPU time of the whole phase is shared out among them in proportion.
#ifndef OB_SIM_PART_H
#define OB_SIM_PART_H

#include "base/clock.h"
#include "sim/worker.h"

// From now on the worker's time counts for this part.
void ob_profile_change(ob_sim *s, ob_profile_section part);
static inline void ob_profile_enter(ob_sim *s, ob_profile_section part)
{
	if (s->times.wanted)
		ob_profile_change(s, part);
}

// Round a phase, or what the worker does between two; between an end and a beginning it waits at the gate. Returns ns of
// CPU since the beginning, 0 unless the run is timed.
void ob_profile_begin(ob_sim *s, ob_profile_section part);
uint64_t ob_profile_end(ob_sim *s);

// From now on, until hide, each part is a span in the trace. The first is LOAD. Returns now.
uint64_t ob_profile_show(ob_sim *s);
void ob_profile_hide(ob_sim *s);

#endif
