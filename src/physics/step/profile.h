// The profile: CPU time of a worker by section of the step; and the spans of the trace. Both cost no more than a test
// of a flag unless the run is timed, or traced.
//
// Reading a thread's CPU clock costs a system call, a hundred times as much as the wall clock. So sections are measured
// by the wall clock, and the CPU time of the whole phase is divided among them in proportion.
#ifndef OB_STEP_PROFILE_H
#define OB_STEP_PROFILE_H

#include "base/clock.h"
#include "step/state.h"
#include "table/table.h"

// Counts the worker's time for this section from now on.
void ob_profile_change(ob_sim *s, ob_profile_section section);
static inline void ob_profile_enter(ob_sim *s, ob_profile_section section)
{
	if (s->solver.timed)
		ob_profile_change(s, section);
}

// Begin and end a worker's share of a phase, or a serial part; between an end and a beginning the worker waits at the
// gate. Returns ns of CPU since the beginning, 0 unless the run is timed.
void ob_profile_begin(ob_sim *s, ob_profile_section section);
uint64_t ob_profile_end(ob_sim *s);
// Notes that the worker has done this task, and no other since the last one, or since the phase began. As for sections,
// the CPU clock is read once for several tasks.
void ob_profile_task(ob_sim *s, uint32_t task);
static inline void ob_profile_task_done(ob_sim *s, uint32_t task)
{
	if (s->times.timed)
		ob_profile_task(s, task);
}
// CPU time, ns, of the phase that has ended which belongs to none of its tasks.
uint64_t ob_profile_beside(const ob_sim *s, uint64_t worked);

// ---- spans of the trace (table/trace.h)
//
//   level 0   wait | objects | solve                                        | schedule | wait ...
//         1                    chunk            | chunk
//         2                    island | island  | island
//         3                    load narrow-phase move solve ...
//
// There are some ten sections a substep, and most islands are small: tracing all would cost a fifth of the run. Traced
// in detail are large islands, and the first small one of each chunk in every 16th step.

// Level 0, without gaps: ends the running span, and begins the next.
void ob_span_turn_to(ob_sim *s, ob_trace_kind next);
static inline void ob_span_turn(ob_sim *s, ob_trace_kind next)
{
	if (s->span.traced)
		ob_span_turn_to(s, next);
}

void ob_span_chunk_begin(ob_sim *s);
void ob_span_chunk_end(ob_sim *s, uint32_t chunk);
// Begins an island's span. true: it is shown in detail, and ob_span_island_end ends it. first: it is its chunk's first.
bool ob_span_island_begin(ob_sim *s, uint32_t i, bool first);
void ob_span_island_end(ob_sim *s, uint32_t i);

// ---- critical path

// Critical path of more workers than there are: duration of steps with OB_SIMULATED_WORKERS workers, each on a core of
// its own, with wake-ups that cost nothing. Timed runs report it, with any number of workers.
//
//   phase       tasks as they were measured (CPU of each)         serial part
//   ISLANDS     [...............][....][...][..][.][.][.] ..       [index, pairs, islands]
//                      |           |     |    claimed in turns: each by the first free worker
//   worker 0    |---------------|                                  |
//   worker 1    |----||---||--| ..                                 | adds up as it is
//   ..                                                             |
//
// A task is the unit that a worker claims. In ISLANDS it is a chunk, whose size depends on the number of workers:
// islands are measured, and grouped into chunks here as island_builder.c does. Work beside tasks is added: as much as
// the busiest worker did of it in the phase.
//
// Not modelled: memory and caches shared by so many workers, and the time of a wake-up. The result is the bound set by
// the division of the work.
//
// Contained simulators do not report their tasks, and runs with a worker per object have none: neither has a critical
// path.

// Closes a timed phase and adds its critical path. The scheduling worker calls it at the phase's end, before anything
// else. per_worker: number of tasks per additional worker in such a phase; 0: all workers take part.
void ob_critical_path_close(ob_universe *u, ob_phase phase, uint32_t per_worker);

#endif
