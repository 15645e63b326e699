#include "sim/profile.h"

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

enum { LARGE_ISLAND = 64, SAMPLED_STEPS = 16 };

static uint32_t islands_done(const ob_sim *s)
{
	return (uint32_t)(s->counters.ballistic_advances + s->counters.island_steps);
}
static uint32_t members_done(const ob_sim *s)
{
	return (uint32_t)(s->counters.ballistic_advances + s->counters.body_steps);
}

void ob_span_turn_to(ob_sim *s, ob_trace_kind next)
{
	uint32_t islands = islands_done(s), members = members_done(s);
	if (s->span.kind == OB_TRACE_NONE)
		s->span.since = ob_clock_ns();
	else
		s->span.since = ob_trace_span(s->u, s->worker, s->span.kind, s->span.since, islands - s->span.islands,
					      members - s->span.members);
	s->span.kind = next;
	s->span.islands = islands;
	s->span.members = members;
	ob_trace_doing(s->u, s->worker, next, s->span.since);
}

void ob_span_chunk_begin(ob_sim *s)
{
	if (s->span.traced)
		s->span.chunk = ob_clock_ns();
}

void ob_span_chunk_end(ob_sim *s, uint32_t chunk)
{
	if (!s->span.traced)
		return;
	const ob_step_data *ex = ob_universe_step_data(s->u);
	uint32_t first = ex->chunk[chunk], end = ex->chunk[chunk + 1], members = 0;
	for (uint32_t i = first; i < end; i++)
		members += ex->island[i].members;
	ob_trace_span(s->u, s->worker, OB_TRACE_CHUNK, s->span.chunk, end - first, members);
}

bool ob_span_island_begin(ob_sim *s, uint32_t i, bool first)
{
	if (!s->span.traced)
		return false;
	bool sampled = first && ob_step_count(s->u) % SAMPLED_STEPS == 0;
	if (!sampled && ob_universe_step_data(s->u)->island[i].members < LARGE_ISLAND)
		return false;
	s->span.island = ob_profile_show(s);
	return true;
}

void ob_span_island_end(ob_sim *s, uint32_t i)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	const ob_island *is = &ex->island[i];
	ob_profile_hide(s);
	ob_trace_span(s->u, s->worker, OB_TRACE_ISLAND, s->span.island, ex->member[is->first_member], is->members);
}
