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
	if (!s->counters.since_ns)
		return;
	s->counters.gate_ns += s->times.since - s->counters.since_ns;
	s->counters.gate_cpu_ns += (uint64_t)(1e9 * (s->times.cpu - s->times.cpu_end));
}

uint64_t ob_part_end(ob_sim *s)
{
	double wall = 0;
	if (!s->times.wanted)
		return 0;
	ob_part_enter(s, s->times.part);
	s->times.cpu_end = ob_clock_thread_cpu();
	double cpu = 1e9 * (s->times.cpu_end - s->times.cpu);
	for (int i = 0; i < OB_PARTS; i++)
		wall += (double)s->times.wall[i];
	for (int i = 0; i < OB_PARTS && wall > 0; i++)
		s->counters.time_ns[i] += (uint64_t)((double)s->times.wall[i] * fmin(1, cpu / wall));
	s->counters.held_ns += (uint64_t)fmax(0, wall - cpu);
	s->counters.since_ns = s->times.since;
	return (uint64_t)cpu;
}
