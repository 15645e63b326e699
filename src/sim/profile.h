// Which part of the step a worker's time goes to; costs nothing unless the run is timed, or traced in detail.
//
// A thread's CPU clock costs a system call, a hundred times as much as the clock on the wall. So parts are told apart by
// the wall, and the CPU time of the whole phase is shared out among them in proportion.
#ifndef OB_SIM_PROFILE_H
#define OB_SIM_PROFILE_H

#include "base/clock.h"
#include "sim/state.h"

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

// What the worker does, for the trace (table/trace.h); costs nothing but a look at a flag unless the run is traced.
//
//   level 0   wait | members | solve                                        | arrange | wait ...
//         1                    chunk            | chunk
//         2                    island | island  | island
//         3                    load look move solve ...
//
// Parts are some ten a substep, and most islands are small: to tell all of them would cost a fifth of the run. Shown in
// detail are large islands, and of the small ones the first of each chunk in every 16th step.

// Level 0, without gaps: the worker has done this since the last one ended, and now begins with what comes next.
void ob_span_turn_to(ob_sim *s, ob_trace_kind next);
static inline void ob_span_turn(ob_sim *s, ob_trace_kind next)
{
	if (s->span.traced)
		ob_span_turn_to(s, next);
}

void ob_span_chunk_begin(ob_sim *s);
void ob_span_chunk_end(ob_sim *s, uint32_t chunk);
// true: island i is shown in detail, and ob_span_island_end ends it. first: of its chunk.
bool ob_span_island_begin(ob_sim *s, uint32_t i, bool first);
void ob_span_island_end(ob_sim *s, uint32_t i);

#endif
