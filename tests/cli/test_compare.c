// What a comparison says of made-up runs: each answer has to follow from the figures, and change with them.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cli/compare.h"

enum { RUNS = 7 };

// Costs (us per body and step) of RUNS samples round a middle; the machine is slower in each later one.
static void fill(ob_cell *c, double cost)
{
	c->state = OB_WAY_DONE;
	c->samples = RUNS;
	c->workers = 2;
	c->sample = calloc(RUNS, sizeof *c->sample);
	for (int i = 0; i < RUNS; i++)
		c->sample[i] = (ob_report){
			.steps = 100,
			.objects = 10,
			.workers = 2,
			.simulated_s = 2,
			.body_step_cpu_us = cost * (1 + .5 * i),
			.work_s = 1,
			.held_s = .5,
			.gate_s = .25,
			.idle_s = .15,
			.elapsed_s = 1,
			.state_hash = "0123456789abcdef",
		};
}

static ob_comparison *comparison(double processes, double each)
{
	ob_comparison *c = calloc(1, sizeof *c);
	c->narrow = "obb";
	c->other = "aabb";
	c->sections = 1;
	ob_section *s = c->section;
	fill(&s->cell[OB_WAY_MONOLITH], 1);
	fill(&s->cell[OB_WAY_THREADS], 2);
	fill(&s->cell[OB_WAY_PROCESSES], 2 * processes);
	fill(&s->cell[OB_WAY_THREADS_EACH], 2 * each);
	fill(&s->cell[OB_WAY_THREADS_OTHER], .5);
	return c;
}

static void finish(ob_comparison *c)
{
	for (int w = 0; w < OB_WAYS; w++)
		free(c->section->cell[w].sample);
	free(c);
}

static void check_headline(double processes, double each, const char *begins, bool share)
{
	ob_comparison *c = comparison(processes, each);
	ob_verdict v;
	ob_verdict_make(&v, c, c->section);
	CHECK(strncmp(v.headline, begins, strlen(begins)) == 0);
	CHECK(!!strstr(v.headline, "share") == share);
	finish(c);
}

static void test_too_few(void)
{
	ob_comparison *c = comparison(2, 3);
	c->section->cell[OB_WAY_PROCESSES].samples = 2;
	ob_verdict v;
	ob_verdict_make(&v, c, c->section);
	CHECK(strstr(v.headline, "cannot be told"));
	finish(c);
}

static void test_ratio(void)
{
	ob_comparison *c = comparison(1.2, 3);
	const ob_section *s = c->section;
	// run by run the drift of the machine cancels out
	ob_spread r = ob_ratio_of(&s->cell[OB_WAY_PROCESSES], &s->cell[OB_WAY_THREADS], OB_FIGURE_COST);
	CHECK_NEAR(r.median, 1.2, 1e-12);
	CHECK_NEAR(r.low, 1.2, 1e-12);
	CHECK_NEAR(r.high, 1.2, 1e-12);
	ob_spread cost = ob_spread_of(&s->cell[OB_WAY_THREADS], OB_FIGURE_COST);
	CHECK_NEAR(cost.median, 5e-6, 1e-18);
	CHECK(cost.low < cost.median && cost.median < cost.high);
	CHECK(isnan(ob_ratio_of(&s->cell[OB_WAY_GROUPS], &s->cell[OB_WAY_THREADS], OB_FIGURE_COST).median));
	CHECK_NEAR(ob_spread_of(&s->cell[OB_WAY_THREADS], OB_FIGURE_EXPLAINED).median, .95, 1e-12);
	finish(c);
}

static void test_text(void)
{
	ob_comparison *c = comparison(1, 3);
	ob_verdict v;
	ob_verdict_make(&v, c, c->section);
	CHECK(strstr(v.architecture, "2.00 times the CPU of the monolith"));
	CHECK(strstr(v.narrow, "take 0.25 times the CPU of true shapes"));
	CHECK(!strstr(v.narrow, "In the monolith")); // its other narrow phase did not run
	CHECK(strstr(v.sum, "95.0 %"));
	CHECK(!strstr(v.answer, "groups of"));
	// asked for the other way round, it is still boxes against shapes
	c->narrow = "aabb";
	c->other = "obb";
	ob_verdict_make(&v, c, c->section);
	CHECK(strstr(v.narrow, "take 4.00 times the CPU of true shapes"));
	finish(c);
}

static void test_agreement(void)
{
	ob_comparison *c = comparison(1, 3);
	ob_section *s = c->section;
	strcpy(s->cell[OB_WAY_MONOLITH].sample[0].state_hash, "another");
	for (int i = 0; i < RUNS; i++)
		strcpy(s->cell[OB_WAY_THREADS_OTHER].sample[i].state_hash, "boxed");
	CHECK(ob_section_agrees(s)); // these need not
	strcpy(s->cell[OB_WAY_PROCESSES].sample[RUNS - 1].state_hash, "another");
	CHECK(!ob_section_agrees(s));
	strcpy(s->cell[OB_WAY_PROCESSES].sample[RUNS - 1].state_hash, "0123456789abcdef");
	s->measured_differs = true;
	CHECK(!ob_section_agrees(s));
	finish(c);
}

int main(void)
{
	check_headline(1, 3, "Either", true);
	check_headline(1.04, 1, "Either", false);
	check_headline(1.06, 3, "Threads", true);
	check_headline(.9, 3, "Processes", true);
	test_too_few();
	test_ratio();
	test_text();
	test_agreement();
	return check_end();
}
