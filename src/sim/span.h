// What the worker does, for the trace (table/trace.h); costs nothing but a look at a flag unless the run is traced.
//
//   level 0   wait | members | solve                                        | arrange | wait ...
//         1                    chunk            | chunk
//         2                    island | island  | island
//         3                    load look move solve ...
//
// Parts are some ten a substep, and most islands are small: to tell all of them would cost a fifth of the run. Shown in
// detail are large islands, and of the small ones the first of each chunk in every 16th step.
#ifndef OB_SIM_SPAN_H
#define OB_SIM_SPAN_H

#include "sim/worker.h"

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
