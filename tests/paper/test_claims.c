// Verdicts of each claim, each from data made up for it, and the text for them.
#include <string.h>

#include "../check.h"
#include "made.h"
#include "paper/claims.h"

static ob_paper_claim claims[OB_PAPER_CLAIMS];

static const ob_paper_claim *judged(const ob_paper_results *r, const char *key)
{
	ob_paper_judge(r, claims);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		if (strcmp(claims[i].key, key) == 0)
			return &claims[i];
	return NULL;
}

// Only a conditional verdict has a condition, which is not repeated in the other texts.
static void expect(const ob_paper_results *r, const char *key, ob_paper_verdict verdict, const char *condition)
{
	const ob_paper_claim *c = judged(r, key);
	CHECK(c != NULL);
	if (!c)
		return;
	if (c->verdict != verdict)
		fprintf(stderr, "%s: %s\n", key, ob_paper_verdict_text(c->verdict));
	CHECK(c->verdict == verdict);
	CHECK((verdict == OB_PAPER_ONLY_IF) == (*c->condition != 0));
	if (condition)
		CHECK(strstr(c->condition, condition) != NULL);
	CHECK(*c->because != 0 && *c->itself != 0);
	CHECK(strlen(c->because) + 1 < sizeof c->because && strlen(c->condition) + 1 < sizeof c->condition);
}

static const ob_paper_metric runtimes[] = { OB_PAPER_STEP, OB_PAPER_TOTAL, OB_PAPER_ONE };

static void test_runtime(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "runtime", OB_PAPER_OPEN, NULL);
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_ONE, .1);
	expect(&r, "runtime", OB_PAPER_ONLY_IF, "runtime means the CPU time of one simulator");
	CHECK(strstr(judged(&r, "runtime")->because, " ms, 0.1 times (0.0994 to 0.101)") != NULL);
	CHECK(strstr(judged(&r, "runtime")->condition, "step") == NULL);
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_STEP, .5);
	expect(&r, "runtime", OB_PAPER_ONLY_IF, "the slowest simulator's step or the CPU time of one");
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_TOTAL, .5);
	expect(&r, "runtime", OB_PAPER_HOLDS, NULL);
	for (int i = 0; i < 3; i++)
		made_scale(&r, OB_PAPER_OBS, runtimes[i], 100);
	expect(&r, "runtime", OB_PAPER_FAILS, NULL);
	ob_records_finish(&r.records);
}

static double constant(double n)
{
	return .001;
}
static double linear(double n)
{
	return 1e-4 * n;
}
static double logarithmic(double n)
{
	return 1e-3 * log(n);
}
static double saturated(double n)
{
	return 2 * (1 - exp(-n / 60));
}
static double between(double n)
{
	return 1e-4 * pow(n, .62);
}

static void test_constant(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "constant", OB_PAPER_OPEN, NULL);
	made_growth(&r, OB_PAPER_OBS, constant);
	expect(&r, "constant", OB_PAPER_HOLDS, NULL);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_STEP, linear);
	expect(&r, "constant", OB_PAPER_ONLY_IF, "the CPU time of all simulators together or the CPU time of one");
	CHECK(strstr(judged(&r, "constant")->because, "goes as n^1.00 (") != NULL);
	for (int i = 1; i < 3; i++)
		made_set_growth(&r, OB_PAPER_OBS, runtimes[i], linear);
	expect(&r, "constant", OB_PAPER_FAILS, NULL);
	ob_records_finish(&r.records);
}

static void test_frames(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "frames", OB_PAPER_OPEN, NULL);
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_FPS, 1.1);
	expect(&r, "frames", OB_PAPER_HOLDS, NULL);
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_FPS, .7);
	expect(&r, "frames", OB_PAPER_FAILS, NULL);
	made_scale(&r, OB_PAPER_POOL, OB_PAPER_FPS, 1.2);
	expect(&r, "frames", OB_PAPER_ONLY_IF, "one thread per core");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++)
		made_scale(&r, s, OB_PAPER_FPS, NAN);
	expect(&r, "frames", OB_PAPER_OPEN, NULL);
	CHECK(strcmp(judged(&r, "frames")->because, "No frames were drawn.") == 0);
	CHECK(strncmp(judged(&r, "frames")->itself, "Higher in 10 of 15 experiments", 30) == 0);
	ob_records_finish(&r.records);
}

static void test_cpu(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "cpu", OB_PAPER_FAILS, NULL);
	made_scale(&r, OB_PAPER_POOL, OB_PAPER_CPU, .4);
	expect(&r, "cpu", OB_PAPER_ONLY_IF, "one thread per core");
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_ONE, .1);
	expect(&r, "cpu", OB_PAPER_ONLY_IF, ", or the CPU usage is that of one simulator");
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_CPU, .4);
	expect(&r, "cpu", OB_PAPER_HOLDS, NULL);
	CHECK(strstr(judged(&r, "cpu")->itself, "0.416 times") != NULL);
	ob_records_finish(&r.records);
	r = made_alike();
	made_scale(&r, OB_PAPER_OBS, OB_PAPER_CPU, .5);
	expect(&r, "cpu", OB_PAPER_OPEN, NULL);
	ob_records_finish(&r.records);
}

static void test_load(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "load", OB_PAPER_FAILS, NULL);
	CHECK(strstr(judged(&r, "load")->because, "lies within the noise") != NULL);
	made_scale(&r, OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL, 1.06);
	expect(&r, "load", OB_PAPER_FAILS, NULL);
	CHECK(strstr(judged(&r, "load")->because, "It would take 1 to 1") != NULL); // 150000 or so
	// 1 + 2016 pairs times .3 us, by 1 ms
	CHECK(strstr(judged(&r, "load")->because, "about 1.6 times") != NULL ||
	      strstr(judged(&r, "load")->because, "about 1.61 times") != NULL);
	made_scale(&r, OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL, 4 / 1.06);
	expect(&r, "load", OB_PAPER_ONLY_IF, "instead of 1 to 1000");
	CHECK(strncmp(judged(&r, "load")->condition, "1 to 30", 7) == 0 ||
	      strncmp(judged(&r, "load")->condition, "1 to 29", 7) == 0); // 9000 / 3
	made_scale(&r, OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL, 3);
	expect(&r, "load", OB_PAPER_HOLDS, NULL);
	CHECK(strncmp(judged(&r, "load")->itself, "7.0", 3) == 0); // not ten, by the paper's own tables
	CHECK(strstr(judged(&r, "load")->because, "pairs") == NULL);
	made_scatter(&r, OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL, .6); // the interval 7 to 16 includes ten
	expect(&r, "load", OB_PAPER_HOLDS, NULL);
	made_scatter(&r, OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL, 5);
	expect(&r, "load", OB_PAPER_OPEN, NULL);
	ob_records_finish(&r.records);
}

static void test_kept(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "kept", OB_PAPER_FAILS, NULL);
	CHECK(strstr(judged(&r, "kept")->because, "no reason") != NULL);
	made_scale(&r, OB_PAPER_COMMON_OBB, OB_PAPER_TOTAL, 2);
	expect(&r, "kept", OB_PAPER_OPEN, NULL);
	made_scale(&r, OB_PAPER_COMMON_OBB, OB_PAPER_TOTAL, 2);
	expect(&r, "kept", OB_PAPER_HOLDS, NULL);
	ob_records_finish(&r.records);
}

static void test_obb(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "obb", OB_PAPER_FAILS, NULL);
	CHECK(strstr(judged(&r, "obb")->because, "OBB is affordable without OBS") != NULL);
	made_scale(&r, OB_PAPER_OBS_OBB, OB_PAPER_STEP, .5);
	expect(&r, "obb", OB_PAPER_ONLY_IF, "a shorter step is meant");
	for (int q = 0; q < 2; q++) // a busy machine slows one of them down: the other gets no credit for it
		made_scale(&r, q ? OB_PAPER_COMMON_OBB : OB_PAPER_COMMON, OB_PAPER_PACE, .7);
	expect(&r, "obb", OB_PAPER_ONLY_IF, "a shorter step is meant");
	made_scale(&r, OB_PAPER_COMMON_OBB, OB_PAPER_BUSIEST, 16.7); // out of 16.7 ms
	expect(&r, "obb", OB_PAPER_OPEN, NULL);
	made_scale(&r, OB_PAPER_COMMON_OBB, OB_PAPER_BUSIEST, 2);
	expect(&r, "obb", OB_PAPER_HOLDS, NULL);
	made_scale(&r, OB_PAPER_OBS_OBB, OB_PAPER_BUSIEST, 20);
	expect(&r, "obb", OB_PAPER_FAILS, NULL);
	made_scale(&r, OB_PAPER_OBS_OBB, OB_PAPER_BUSIEST, NAN);
	expect(&r, "obb", OB_PAPER_OPEN, NULL);
	ob_records_finish(&r.records);
}

static void test_growth(void)
{
	ob_paper_results r = made_alike();
	expect(&r, "growth", OB_PAPER_OPEN, NULL);
	made_growth(&r, OB_PAPER_COMMON, linear);
	made_growth(&r, OB_PAPER_OBS, logarithmic);
	expect(&r, "growth", OB_PAPER_HOLDS, NULL);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_DEMAND, linear);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_CPU, saturated);
	expect(&r, "growth", OB_PAPER_ONLY_IF, "read off a monitor");
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_CPU, linear);
	expect(&r, "growth", OB_PAPER_FAILS, NULL);
	CHECK(strstr(judged(&r, "growth")->because, "the data prefer a line, more than a million to 1") != NULL);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_DEMAND, between);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_CPU, between);
	int prefers = ob_paper_prefers(&(ob_paper_growth){ .linear.n = 18, .favour = log(9) });
	CHECK(prefers == 0);
	ob_records_finish(&r.records);
}

// Failed runs must not shift pairs against each other.
static void test_failed_runs(void)
{
	ob_paper_results r = made_alike();
	for (size_t i = 0; i < r.records.count; i++)
		if (ob_paper_scenario_of(&r.records.record[i]) == OB_PAPER_OBS && r.records.record[i].repeat % 2) {
			r.records.record[i].failure = OB_FAILURE_CRASH;
			r.records.record[i].metric[OB_PAPER_CPU] = 1e9;
		}
	expect(&r, "cpu", OB_PAPER_FAILS, NULL);
	CHECK_NEAR(ob_paper_compare(&r, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_CPU).value, 1, .02);
	CHECK(ob_paper_compare(&r, OB_PAPER_OBS, OB_PAPER_COMMON, OB_PAPER_CPU).n == 8);
	ob_records_finish(&r.records);
}

// Without measurements there are no claims.
static void test_nothing(void)
{
	ob_paper_results r = { .objects = 64, .experiments = 15 };
	ob_paper_judge(&r, claims);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		CHECK(claims[i].verdict == OB_PAPER_OPEN);
}

int main(void)
{
	test_runtime();
	test_constant();
	test_frames();
	test_cpu();
	test_load();
	test_kept();
	test_obb();
	test_growth();
	test_failed_runs();
	test_nothing();
	return check_end();
}
