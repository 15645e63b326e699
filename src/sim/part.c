#include "sim/part.h"

#include <string.h>

// The running part's time so far.
static void count(ob_sim *s)
{
	uint64_t since = s->times.since;
	s->times.since =
		s->times.shown ? ob_trace_span(s->u, s->worker, OB_TRACE_PROFILE, since, s->times.part, 0) : ob_clock_ns();
	s->times.wall[s->times.part] += s->times.since - since;
}

void ob_profile_change(ob_sim *s, ob_profile_section part)
{
	if (part == s->times.part)
		return;
	count(s);
	s->times.part = part;
}

void ob_profile_begin(ob_sim *s, ob_profile_section part)
{
	if (!s->times.timed)
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

uint64_t ob_profile_end(ob_sim *s)
{
	double wall = 0;
	if (!s->times.timed)
		return 0;
	count(s);
	s->times.cpu_end = ob_clock_thread_cpu();
	double cpu = 1e9 * (s->times.cpu_end - s->times.cpu);
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++)
		wall += (double)s->times.wall[i];
	for (int i = 0; i < OB_PROFILE_SECTIONS && wall > 0; i++)
		s->counters.time_ns[i] += (uint64_t)((double)s->times.wall[i] * fmin(1, cpu / wall));
	s->counters.held_ns += (uint64_t)fmax(0, wall - cpu);
	s->counters.since_ns = s->times.since;
	return (uint64_t)cpu;
}

uint64_t ob_profile_show(ob_sim *s)
{
	if (s->times.timed)
		count(s);
	else
		s->times.since = ob_clock_ns();
	s->times.part = OB_PROFILE_LOAD;
	s->times.shown = s->times.wanted = true;
	return s->times.since;
}

void ob_profile_hide(ob_sim *s)
{
	count(s);
	s->times.shown = false;
	s->times.wanted = s->times.timed;
}
