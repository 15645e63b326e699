#include "sim/part.h"

#include <string.h>

void ob_part_begin(ob_sim *s, ob_part part)
{
	if (!s->times.wanted)
		return;
	memset(s->times.wall, 0, sizeof s->times.wall);
	s->times.part = part;
	s->times.since = ob_clock_ns();
	s->times.cpu = ob_clock_thread_cpu();
}

void ob_part_end(ob_sim *s)
{
	double wall = 0;
	if (!s->times.wanted)
		return;
	ob_part_enter(s, s->times.part);
	double cpu = 1e9 * (ob_clock_thread_cpu() - s->times.cpu);
	for (int i = 0; i < OB_PARTS; i++)
		wall += (double)s->times.wall[i];
	for (int i = 0; i < OB_PARTS && wall > 0; i++)
		s->counters.time_ns[i] += (uint64_t)((double)s->times.wall[i] * fmin(1, cpu / wall));
}
