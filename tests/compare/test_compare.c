// Verdicts of a comparison from made-up runs: each answer must follow from the figures, and change with them. Options
// of each run.
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "compare/compare.h"
#include "experiment/process.h"

enum { RUNS = 7 };

static void add(ob_comparison *c, ob_configuration_id id, ob_compare_kind kind, uint32_t repeat, double cost,
		const char *state)
{
	ob_record r = { .repeat = repeat };
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	memcpy(r.of, c->point->key, sizeof r.of);
	ob_configuration_key(id, kind, r.configuration);
	snprintf(r.note, sizeof r.note, "%s", state);
	if (kind == OB_COMPARE_SAMPLE) {
		r.metric[OB_COMPARE_COST] = 1e-6 * cost;
		r.metric[OB_COMPARE_EXPLAINED] = .95;
		r.metric[OB_COMPARE_MEMORY] = 10e6;
	} else {
		r.metric[OB_COMPARE_WORST] = cost;
	}
	CHECK(ob_records_add(&c->records, &r));
}

// Costs (us per body and step) of samples; the machine is slower in each later one.
static void fill(ob_comparison *c, ob_configuration_id id, double cost)
{
	for (uint32_t i = 0; i < c->repeats; i++)
		add(c, id, OB_COMPARE_SAMPLE, i, cost * (1 + .5 * i), "0123456789abcdef");
}

static ob_comparison *make(double processes, double each, uint32_t runs)
{
	ob_comparison *c = calloc(1, sizeof *c);
	c->scene = "scenes/heap.lua";
	c->narrow = "obb";
	c->other = "aabb";
	c->points = c->seeds = 1;
	c->repeats = runs;
	c->pool = 2;
	ob_sweep_point *p = c->point;
	*p = (ob_sweep_point){
		.objects = 10, .steps = 100, .step = .01, .simulated = 1, .seed = 0, .key = "heap.lua @0"
	};
	for (int i = 0; i < OB_CONFIGURATIONS; i++)
		p->workers[i] = 2;
	fill(c, OB_CONFIGURATION_MONOLITH, 1);
	fill(c, OB_CONFIGURATION_THREADS, 2);
	fill(c, OB_CONFIGURATION_PROCESSES, 2 * processes);
	fill(c, OB_CONFIGURATION_THREADS_EACH, 2 * each);
	fill(c, OB_CONFIGURATION_THREADS_OTHER, .5);
	return c;
}

static void finish(ob_comparison *c)
{
	ob_comparison_finish(c);
	free(c);
}

static void check_headline(double processes, double each, const char *begins, bool share)
{
	ob_comparison *c = make(processes, each, RUNS);
	ob_verdict v;
	ob_verdict_make(&v, c, c->point);
	CHECK(strncmp(v.headline, begins, strlen(begins)) == 0);
	CHECK(!!strstr(v.headline, "share") == share);
	finish(c);
}

static void test_too_few(void)
{
	ob_comparison *c = make(2, 3, 2);
	ob_verdict v;
	ob_verdict_make(&v, c, c->point);
	CHECK(strstr(v.headline, "Undecided"));
	finish(c);
}

static void test_ratio(void)
{
	ob_comparison *c = make(1.2, 3, RUNS);
	const ob_sweep_point *p = c->point;
	// run by run, the drift of the machine cancels out
	ob_estimate r =
		ob_comparison_ratio(c, p, OB_CONFIGURATION_PROCESSES, OB_CONFIGURATION_THREADS, OB_COMPARE_COST);
	CHECK_NEAR(r.value, 1.2, 1e-12);
	CHECK_NEAR(r.low, 1.2, 1e-12);
	CHECK_NEAR(r.high, 1.2, 1e-12);
	ob_estimate cost = ob_comparison_spread(c, p, OB_CONFIGURATION_THREADS, OB_COMPARE_COST);
	CHECK_NEAR(cost.value, 5e-6, 1e-18);
	CHECK(cost.interval && cost.low < cost.value && cost.value < cost.high);
	CHECK(isnan(
		ob_comparison_ratio(c, p, OB_CONFIGURATION_GROUPS, OB_CONFIGURATION_THREADS, OB_COMPARE_COST).value));
	CHECK_NEAR(ob_comparison_spread(c, p, OB_CONFIGURATION_THREADS, OB_COMPARE_EXPLAINED).value, .95, 1e-12);
	// errors measured along one run of object simulators hold for all of them
	CHECK(isnan(ob_comparison_spread(c, p, OB_CONFIGURATION_PROCESSES, OB_COMPARE_WORST).value));
	add(c, OB_CONFIGURATION_THREADS, OB_COMPARE_MEASURED, 0, .004, "0123456789abcdef");
	CHECK_NEAR(ob_comparison_spread(c, p, OB_CONFIGURATION_PROCESSES, OB_COMPARE_WORST).value, .004, 0);
	CHECK(isnan(ob_comparison_spread(c, p, OB_CONFIGURATION_MONOLITH, OB_COMPARE_WORST).value));
	finish(c);
}

// Squeezes to words and numbers, with a blank between them.
static void squeeze(char *text)
{
	char *to = text;
	for (char *from = text; *from; from++) {
		const bool kept = isalnum((unsigned char)*from) || *from == '.';
		if (kept || (to > text && to[-1] != ' '))
			*to++ = kept ? *from : ' ';
	}
	*to = 0;
}

static void test_text(void)
{
	ob_comparison *c = make(1, 3, RUNS);
	ob_verdict v;
	ob_verdict_make(&v, c, c->point);
	CHECK(strstr(v.architecture, "2.00 times the CPU of the monolith"));
	CHECK(strstr(v.narrow, "take 0.25 times the CPU of true shapes"));
	CHECK(!strstr(v.narrow, "In the monolith")); // its other narrow phase did not run
	CHECK(strstr(v.sum, "95.0 %"));
	CHECK(!strstr(v.answer, "groups of"));
	CHECK(strstr(v.answer, "1.00 times the CPU of a pool of threads (1.00 to 1.00)"));
	// requested the other way round, it is still boxes against shapes
	c->narrow = "aabb";
	c->other = "obb";
	ob_verdict_make(&v, c, c->point);
	CHECK(strstr(v.narrow, "take 4.00 times the CPU of true shapes"));
	finish(c);
}

// The price of a measure is relative to the same run without it, run by run.
static void add_containment(ob_comparison *c, ob_configuration_id id, double cpu, double wall)
{
	fill(c, id, cpu);
	for (uint32_t i = 0; i < c->repeats; i++) {
		ob_record *r = &c->records.record[c->records.count - c->repeats + i];
		r->metric[OB_COMPARE_CPU] = cpu * (1 + .5 * i);
		r->metric[OB_COMPARE_WALL] = wall * (1 + .5 * i);
	}
}

static void test_prices(void)
{
	ob_comparison *c = make(1, 3, RUNS);
	ob_table *t = ob_comparison_prices(c, c->point);
	CHECK(!t);
	for (int i = 0; i < RUNS; i++) { // the plain pool's
		ob_record *r = &c->records.record[2 * RUNS + i];
		CHECK(!strcmp(r->configuration, "processes"));
		r->metric[OB_COMPARE_CPU] = r->metric[OB_COMPARE_WALL] = 1 + .5 * i;
	}
	add_containment(c, OB_CONFIGURATION_OUTBOX, 1.25, 1.5);
	add_containment(c, OB_CONFIGURATION_PAGES, 1.5, 1.5);
	add_containment(c, OB_CONFIGURATION_CALLS, 1.01, 1);
	add_containment(c, OB_CONFIGURATION_HARDENED, 1.75, 2);
	char text[4096] = "";
	FILE *f = fmemopen(text, sizeof text, "w");
	t = ob_comparison_prices(c, c->point);
	CHECK(t);
	ob_table_print(t, f, 0);
	fclose(f);
	static const char *const lines[] = { "outboxes process pool 1.25 1.25 1.25 1.50 1.50 1.50",
					     "with pages outboxes 1.20 1.20 1.20 1.00 1.00 1.00",
					     "system calls process pool 1.01 1.01 1.01 1.00 1.00 1.00",
					     "hardened pool process pool 1.75 1.75 1.75 2.00 2.00 2.00" };
	squeeze(text);
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		CHECK(strstr(text, lines[i]));
	CHECK(!strstr(text, "checksum") && !strstr(text, "each")); // were not run
	finish(c);
}

static void test_agreement(void)
{
	ob_comparison *c = make(1, 3, RUNS);
	const ob_sweep_point *p = c->point;
	for (size_t i = 0; i < c->records.count; i++) { // these are optional
		ob_record *r = &c->records.record[i];
		if (!strcmp(r->configuration, "threads_other") || !strcmp(r->configuration, "monolith"))
			strcpy(r->note, r->configuration);
	}
	CHECK(ob_comparison_agrees(c, p));
	ob_record *last = &c->records.record[3 * RUNS - 1];
	CHECK(!strcmp(last->configuration, "processes"));
	strcpy(last->note, "another");
	CHECK(!ob_comparison_agrees(c, p));
	last->seed = 5; // another state is expected
	CHECK(ob_comparison_agrees(c, p));
	add(c, OB_CONFIGURATION_THREADS, OB_COMPARE_MEASURED, 0, .004, "another");
	CHECK(!ob_comparison_agrees(c, p));
	finish(c);
}

static void test_failure(void)
{
	ob_comparison *c = make(1, 3, RUNS);
	c->records.record[0].failure = OB_FAILURE_ERROR;
	strcpy(c->records.record[0].reason, "no such thing");
	CHECK(!ob_comparison_is_done(c, c->point, OB_CONFIGURATION_MONOLITH));
	CHECK(strcmp(ob_comparison_failure(c, c->point, OB_CONFIGURATION_MONOLITH), "no such thing") == 0);
	CHECK(ob_comparison_is_done(c, c->point, OB_CONFIGURATION_THREADS));
	CHECK(!ob_comparison_is_done(c, c->point, OB_CONFIGURATION_GROUPS)); // was not run
	finish(c);
}

// ---- the text

static char said[1 << 16];

static void print(const ob_comparison *c, size_t width)
{
	FILE *f = fmemopen(said, sizeof said, "w");
	ob_comparison_print(c, f, width);
	fclose(f);
}

static size_t widest(const char *text)
{
	size_t most = 0;
	for (size_t n = 0; *text; text++) {
		n = *text == '\n' ? 0 : n + ((*text & 0xc0) != 0x80);
		most = n > most ? n : most;
	}
	return most;
}

static void test_print(void)
{
	ob_comparison *c = make(1, 3, RUNS);
	for (size_t width = 80; width <= 100; width += 20) {
		print(c, width);
		CHECK(widest(said) <= width && widest(said) > width - 20);
		CHECK(strncmp(said, "Thread or process? Either", 25) == 0); // the verdict comes first
		CHECK(strstr(said, "same bits") < strstr(said, "CPU per body and step, µs"));
		CHECK(strstr(said, "interval of 95 %") && strstr(said, "7 runs of"));
	}
	finish(c);
	c = make(1, 3, 3); // too few for an interval
	print(c, 100);
	CHECK(!strstr(said, "interval") && strstr(said, "least to most"));
	finish(c);
}

static void test_one_run(void)
{
	ob_comparison *c = make(1, 3, 1);
	ob_verdict v;
	ob_verdict_make(&v, c, c->point);
	CHECK(!strstr(v.answer, " to ") && !strstr(v.architecture, " to ") && !strstr(v.narrow, " to "));
	CHECK(strstr(v.sum, "95.0 %"));
	CHECK(isnan(ob_comparison_spread(c, c->point, OB_CONFIGURATION_THREADS, OB_COMPARE_COST).low));
	print(c, 100);
	CHECK(!strstr(said, "interval") && !strstr(said, "least to most") && !strstr(said, "median)") &&
	      strstr(said, "1 run of each\n"));
	finish(c);
}

// ---- options of each run

static bool says(char **argv, const char *word)
{
	for (; *argv; argv++)
		if (!strcmp(*argv, word))
			return true;
	return false;
}

static void test_arguments(void)
{
	char step[] = "--step=1/120", solver[] = "--set=solver=jacobi";
	ob_comparison *c = make(1, 3, 1);
	c->passed = 2;
	c->pass[0] = (ob_compare_option){ strdup(step), false };
	c->pass[1] = (ob_compare_option){ strdup(solver), true };
	strcpy(c->point->define, "n=5");
	for (int id = 0; id < OB_CONFIGURATIONS; id++) {
		bool monolith = strstr(ob_configuration_table[id].key, "monolith");
		char **argv = ob_comparison_arguments(c, c->point, id, OB_COMPARE_SAMPLE, false, 9);
		CHECK(says(argv, step) && says(argv, "-Dn=5") && says(argv, "--seed=9") &&
		      says(argv, "--set=measure=end"));
		CHECK(says(argv, solver) == !monolith &&
		      says(argv, "--workers=2") == (!monolith && !strstr(ob_configuration_table[id].key, "each")));
		CHECK(says(argv, ob_configuration_table[id].other_narrow ? "--set=narrow=aabb" : "--set=narrow=obb"));
		ob_program_free_arguments(argv);
	}
	char **argv = ob_comparison_arguments(c, c->point, OB_CONFIGURATION_PROCESSES_EACH, OB_COMPARE_SAMPLE, true, 0);
	CHECK(says(argv, "--set=measure=profile") && says(argv, "--workers=objects") &&
	      says(argv, "--isolation=process"));
	ob_program_free_arguments(argv);
	argv = ob_comparison_arguments(c, c->point, OB_CONFIGURATION_THREADS, OB_COMPARE_DRAWN, false, 0);
	CHECK(says(argv, "--out=/dev/null") && says(argv, "scenes/heap.lua"));
	ob_program_free_arguments(argv);
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
	test_prices();
	test_agreement();
	test_failure();
	test_print();
	test_one_run();
	test_arguments();
	return check_end();
}
