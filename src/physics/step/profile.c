#include "step/profile.h"

#include <string.h>

#include "step/island_builder.h"

// Adds the time since the last change to the running section.
static void count_section(ob_sim *s)
{
	uint64_t since = s->times.since;
	s->times.since = s->times.shown ? ob_trace_span(s->u, s->worker, OB_TRACE_PROFILE, since, s->times.section, 0)
					: ob_clock_ns();
	s->times.wall[s->times.section] += s->times.since - since;
}

void ob_profile_change(ob_sim *s, ob_profile_section section)
{
	if (section == s->times.section)
		return;
	count_section(s);
	s->times.section = section;
}

void ob_profile_begin(ob_sim *s, ob_profile_section section)
{
	if (!s->times.timed)
		return;
	memset(s->times.wall, 0, sizeof s->times.wall);
	s->times.asking = 0;
	s->times.section = section;
	s->times.since = ob_clock_ns();
	s->times.cpu = ob_clock_thread_cpu();
	s->tasks.since = s->times.since;
	s->tasks.cpu = s->times.cpu;
	s->tasks.n = 0;
	s->tasks.sum = s->tasks.told = 0;
	if (!s->solver.counters.since_ns)
		return;
	s->solver.counters.gate_ns += s->times.since - s->solver.counters.since_ns;
	s->solver.counters.gate_cpu_ns += (uint64_t)(1e9 * (s->times.cpu - s->times.cpu_end));
}

// Divides the CPU time since the clock was read, its reading included, among the tasks. So a task in which the worker
// lost its core for a while counts for no more than all of them took.
static void share_out(ob_sim *s, double cpu)
{
	const double took = 1e9 * (cpu - s->tasks.cpu), share = s->tasks.sum ? took / (double)s->tasks.sum : 0;
	for (uint32_t i = 0; i < s->tasks.n; i++) {
		const uint32_t ns = (uint32_t)(share * s->tasks.ns[i]);
		ob_task_took(s->u, s->tasks.task[i], ns);
		s->tasks.told += ns;
	}
	s->tasks.cpu = cpu;
	s->tasks.n = 0;
	s->tasks.sum = 0;
}

// Reads the CPU clock. A worker loses its core mostly in a system call, such as this one. Such time belongs to
// no section, nor to a task.
static double ask_cpu_clock(ob_sim *s)
{
	count_section(s);
	const double cpu = ob_clock_thread_cpu();
	const uint64_t before = s->times.since;
	s->times.since = s->tasks.since = ob_clock_ns();
	s->times.asking += s->times.since - before;
	return cpu;
}

void ob_profile_task(ob_sim *s, uint32_t task)
{
	enum { LONG_NS = 100000 }; // reading the clock costs little in comparison
	const uint64_t now = ob_clock_ns(), ns = now - s->tasks.since;
	s->tasks.since = now;
	s->tasks.task[s->tasks.n] = task;
	s->tasks.ns[s->tasks.n++] = ns < UINT32_MAX ? (uint32_t)ns : UINT32_MAX;
	s->tasks.sum += ns;
	if (s->tasks.n == OB_TASKS_TIMED || s->tasks.sum > LONG_NS)
		share_out(s, ask_cpu_clock(s));
}

uint64_t ob_profile_beside(const ob_sim *s, uint64_t worked)
{
	return worked > s->tasks.told ? worked - s->tasks.told : 0;
}

uint64_t ob_profile_end(ob_sim *s)
{
	double wall = 0;
	if (!s->times.timed)
		return 0;
	count_section(s);
	s->times.cpu_end = ob_clock_thread_cpu();
	share_out(s, s->times.cpu_end);
	double cpu = 1e9 * (s->times.cpu_end - s->times.cpu);
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++)
		wall += (double)s->times.wall[i];
	for (int i = 0; i < OB_PROFILE_SECTIONS && wall > 0; i++)
		s->solver.counters.time_ns[i] += (uint64_t)((double)s->times.wall[i] * ob_min(1, cpu / wall));
	s->solver.counters.held_ns += (uint64_t)ob_max(0, wall + (double)s->times.asking - cpu);
	s->solver.counters.since_ns = s->times.since;
	return (uint64_t)cpu;
}

// Makes each section a span in the trace, until hide_sections. The first is LOAD. Returns now (ns).
static uint64_t show_sections(ob_sim *s)
{
	if (s->times.timed)
		count_section(s);
	else
		s->times.since = ob_clock_ns();
	s->times.section = OB_PROFILE_LOAD;
	s->times.shown = s->solver.timed = true;
	return s->times.since;
}

static void hide_sections(ob_sim *s)
{
	count_section(s);
	s->times.shown = false;
	s->solver.timed = s->times.timed;
}

enum { LARGE_ISLAND = 64, SAMPLED_STEPS = 16 };

static uint32_t islands_solved(const ob_sim *s)
{
	return (uint32_t)(s->solver.counters.ballistic_advances + s->solver.counters.island_steps);
}
static uint32_t members_solved(const ob_sim *s)
{
	return (uint32_t)(s->solver.counters.ballistic_advances + s->solver.counters.body_steps);
}

void ob_span_turn_to(ob_sim *s, ob_trace_kind next)
{
	uint32_t islands = islands_solved(s), members = members_solved(s);
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
	const ob_step_data *data = s->data;
	uint32_t first = data->chunk[chunk], end = data->chunk[chunk + 1], members = 0;
	for (uint32_t i = first; i < end; i++)
		members += data->island[i].members;
	ob_trace_span(s->u, s->worker, OB_TRACE_CHUNK, s->span.chunk, end - first, members);
}

bool ob_span_island_begin(ob_sim *s, uint32_t i, bool first)
{
	if (!s->span.traced)
		return false;
	bool sampled = first && ob_step_count(s->u) % SAMPLED_STEPS == 0;
	if (!sampled && s->data->island[i].members < LARGE_ISLAND)
		return false;
	s->span.island = show_sections(s);
	return true;
}

void ob_span_island_end(ob_sim *s, uint32_t i)
{
	const ob_step_data *data = s->data;
	const ob_island *is = &data->island[i];
	hide_sections(s);
	ob_trace_span(s->u, s->worker, OB_TRACE_ISLAND, s->span.island, data->member[is->first_member], is->members);
}

// ---- critical path

// Finish time (ns) of each simulated worker.
typedef struct crew {
	uint64_t until[OB_SIMULATED_WORKERS];
	uint32_t count;
} crew;

static void claim(crew *c, uint64_t task)
{
	uint32_t first = 0;
	for (uint32_t i = 1; i < c->count; i++)
		first = c->until[i] < c->until[first] ? i : first;
	c->until[first] += task;
}

static void claim_tasks(crew *c, ob_universe *u, uint32_t per_worker)
{
	const uint32_t tasks = ob_task_count(u);
	if (per_worker && 1 + tasks / per_worker < c->count)
		c->count = 1 + tasks / per_worker;
	for (uint32_t i = 0; i < tasks; i++)
		claim(c, ob_task_take_time(u, i));
}

// Claims chunks of islands. Unsolved islands come first in the list, the largest ahead.
static void claim_chunks(crew *c, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t unsolved = data->count->unsolved;
	uint64_t total = 0, filled = 0, chunk = 0;
	for (uint32_t i = 0; i < unsolved; i++)
		total += data->island[i].work;
	const uint64_t most = ob_islands_chunk_work(total, OB_SIMULATED_WORKERS);
	for (uint32_t i = 0; i < unsolved; i++) {
		chunk += ob_task_take_time(u, i);
		filled += data->island[i].work;
		if (filled < most && i + 1 < unsolved)
			continue;
		claim(c, chunk);
		chunk = filled = 0;
	}
}

void ob_critical_path_close(ob_universe *u, ob_phase phase, uint32_t per_worker)
{
	crew c = { .count = OB_SIMULATED_WORKERS };
	const uint64_t beside = ob_phase_close(u);
	uint64_t last = 0;
	if (ob_universe_settings(u)->timed && phase == OB_PHASE_ISLANDS)
		claim_chunks(&c, u);
	else if (ob_universe_settings(u)->timed)
		claim_tasks(&c, u, per_worker);
	for (uint32_t i = 0; i < c.count; i++)
		last = c.until[i] > last ? c.until[i] : last;
	ob_critical_add(u, 0, last + beside);
}
