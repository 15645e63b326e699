#include "sim/span.h"

#include "sim/part.h"

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
