#include <assert.h>
#include <math.h>

#include "elementary/elementary.h"

#include "table/layout.h"

const char *ob_profile_name(uint32_t section)
{
	static const char *const names[OB_PROFILE_SECTIONS] = {
		[OB_PROFILE_BROADPHASE] = "broadphase",
		[OB_PROFILE_SCHEDULE] = "schedule",
		[OB_PROFILE_BALLISTIC] = "ballistic",
		[OB_PROFILE_LOAD] = "load",
		[OB_PROFILE_NARROWPHASE] = "narrowphase",
		[OB_PROFILE_IMPACTS] = "impacts",
		[OB_PROFILE_SOLVE] = "solve",
		[OB_PROFILE_MOVE] = "move",
		[OB_PROFILE_PROJECT] = "project",
		[OB_PROFILE_PUBLISH] = "publish",
		[OB_PROFILE_SCRIPTS] = "scripts",
		[OB_PROFILE_ESTIMATE] = "estimate",
		[OB_PROFILE_VERIFY] = "verify",
	};
	return section < OB_PROFILE_SECTIONS && names[section] ? names[section] : "?";
}

static void add_counters(ob_counters *to, const ob_counters *c)
{
	to->ballistic_advances += c->ballistic_advances;
	to->body_steps += c->body_steps;
	to->body_substeps += c->body_substeps;
	to->island_steps += c->island_steps;
	to->islands_redone += c->islands_redone;
	to->island_merges += c->island_merges;
	to->islands_over += c->islands_over;
	for (int i = 0; i < OB_SUBSTEP_CHOICES; i++)
		to->chosen[i] += c->chosen[i];
	to->narrowphase_tests += c->narrowphase_tests;
	to->swept_tests += c->swept_tests;
	to->box_tests += c->box_tests;
	to->solver_iterations += c->solver_iterations;
	to->pair_solves += c->pair_solves;
	to->frictionless_solves += c->frictionless_solves;
	to->impact_iterations += c->impact_iterations;
	to->impacts += c->impacts;
	to->direct_solves += c->direct_solves;
	to->gyroscopic_steps += c->gyroscopic_steps;
	to->recovered += c->recovered;
	to->error = fmax(to->error, c->error);
	to->depth = fmax(to->depth, c->depth);
	to->creep = fmax(to->creep, c->creep);
	to->bounce = fmax(to->bounce, c->bounce);
	to->estimates += c->estimates;
	to->unbounded += c->unbounded;
	to->deviation = fmax(to->deviation, c->deviation);
	for (int i = 0; i < OB_ERROR_BINS; i++) {
		to->verified_step[i] += c->verified_step[i];
		to->verified_second[i] += c->verified_second[i];
	}
	for (int i = 0; i < 2; i++)
		to->verified_most[i] = fmax(to->verified_most[i], c->verified_most[i]);
	to->unverified += c->unverified;
	for (int i = 0; i < OB_PROFILE_SECTIONS; i++)
		to->time_ns[i] += c->time_ns[i];
	to->held_ns += c->held_ns;
	to->gate_ns += c->gate_ns;
	to->gate_cpu_ns += c->gate_cpu_ns;
}

void ob_counters_copy(ob_counters *to, const ob_counters *from)
{
	typedef uint64_t word __attribute__((may_alias));
	static_assert(sizeof *to % sizeof(word) == 0, "counters are whole words");
	const word *f = (const word *)from;
	word *t = (word *)to;
	for (size_t i = 0; i < sizeof *to / sizeof *t; i++)
		__atomic_store_n(&t[i], __atomic_load_n(&f[i], __ATOMIC_RELAXED), __ATOMIC_RELAXED);
}

void ob_universe_count(const ob_universe *u, ob_counters *sum)
{
	*sum = (ob_counters){ 0 };
	for (uint32_t w = 0; w < u->header.sizes.workers; w++) {
		ob_counters c;
		ob_counters_copy(&c, &u->worker[w].counters);
		add_counters(sum, &c);
	}
}

// ---- latency

static const double shortest = 1e-7, width = 1.02; // s, ratio

void ob_latency_add(ob_latency *l, double seconds)
{
	double bin = seconds > shortest ? floor(ob_log(seconds / shortest) / ob_log(width)) : 0;
	l->count[(int)fmin(bin, OB_LATENCY_BINS - 1)]++;
	l->total++;
}

double ob_latency_percentile(const ob_latency *l, double fraction)
{
	uint64_t rank = (uint64_t)ceil(fraction * (double)l->total), seen = 0;
	for (int i = 0; i < OB_LATENCY_BINS; i++) {
		seen += l->count[i];
		if (seen > 0 && seen >= rank)
			return shortest * ob_pow(width, i + .5);
	}
	return 0;
}
