// Which part of the step a worker's time goes to; costs nothing unless the run is timed.
#ifndef OB_SIM_PART_H
#define OB_SIM_PART_H

#include "base/clock.h"
#include "sim/worker.h"

// From now on the worker's time counts for this part. Returns the part that it counted for until now.
static inline ob_part ob_part_enter(ob_sim *s, ob_part part)
{
	ob_part before = s->part;
	s->part = part;
	if (s->timed) {
		uint64_t now = ob_clock_ns();
		if (before < OB_PARTS)
			s->counters.time_ns[before] += now - s->since;
		s->since = now;
	}
	return before;
}

#endif
