// Results: their order, their conversion from records, values read from them.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "lab/lab.h"

static ob_result make(const char *name, const char *engine, uint32_t substeps, double cost, double error)
{
	ob_result r = { .of = ob_case_find(name), .engine = ob_engine_find(engine) };
	r.settings = r.engine->usual;
	r.settings.substeps = substeps;
	r.settings.tolerance = 0;
	ob_case_result o = { .cpu_s = cost, .wall_s = 2 * cost, .body_seconds = 1 };
	for (uint32_t i = 0; i < r.of->figures; i++)
		o.figure[i] = error;
	ob_result_repeat(&r, &o);
	return r;
}

static void add(ob_results *to, ob_result r)
{
	CHECK(ob_results_add(to, &r));
}

static void test_order(void)
{
	ob_results r = { 0 };
	add(&r, make("pile", "obsim", 8, 1, 1));
	add(&r, make("stack-10", "ode-quick", 1, 1, 1));
	add(&r, make("stack-10", "obsim", 16, 1, 1));
	ob_result one = make("stack-10", "obsim", 0, 1, 1);
	one.settings.tolerance = 1e-4;
	add(&r, one);
	one.settings.tolerance = 1e-3;
	add(&r, one);
	add(&r, make("stack-10", "obsim", 2, 1, 1));
	static const uint32_t substeps[] = { 2, 16, 0, 0, 1, 8 };
	CHECK(r.count == 6);
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].settings.substeps == substeps[i]);
	CHECK(r.result[2].settings.tolerance == 1e-3 && r.result[3].settings.tolerance == 1e-4);
	CHECK(strcmp(r.result[4].engine->name, "ode-quick") == 0);
	CHECK(strcmp(r.result[5].of->name, "pile") == 0);
	CHECK(ob_results_find(&r, one.of, one.engine, &one.settings) == &r.result[2]);
	one.settings.lag++;
	CHECK(!ob_results_find(&r, one.of, one.engine, &one.settings));
	ob_results_finish(&r);
	CHECK(r.count == 0 && !r.result);
}

static void test_repeats(void)
{
	ob_result r = make("pile", "obsim", 8, 3, .5);
	ob_case_result again = r.outcome;
	again.cpu_s = 1;
	again.wall_s = 9;
	again.figure[1] = .7;
	ob_result_repeat(&r, &again);
	CHECK(r.repeats == 2 && r.outcome.cpu_s == 2 && r.outcome.wall_s == 7.5);
	again.cpu_s = 1.5;
	again.figure[1] = .1;
	ob_result_repeat(&r, &again);
	CHECK(r.outcome.cpu_s == 1.5 && r.outcome.figure[0] == .5 && r.outcome.figure[1] == .7 && !*r.outcome.failed);
	strcpy(again.failed, "fell");
	ob_result_repeat(&r, &again);
	CHECK(strcmp(r.outcome.failed, "fell") == 0);
	for (int i = 0; i < 2 * OB_REPEATS; i++)
		ob_result_repeat(&r, &again);
	CHECK(r.repeats == OB_REPEATS && r.outcome.cpu_s == 1.5);
}

static void add_record(ob_records *to, const char *of, const char *configuration, uint32_t repeat, ob_failure failure)
{
	ob_record r = { .repeat = repeat, .failure = failure, .took_s = 9, .took_cpu_s = 8 };
	snprintf(r.of, sizeof r.of, "%s", of);
	snprintf(r.configuration, sizeof r.configuration, "%s", configuration);
	for (int i = 0; i < OB_LAB_METRICS; i++)
		r.metric[i] = failure > OB_FAILURE_OUTCOME ? NAN : 1 + repeat;
	if (failure)
		strcpy(r.reason, "fell");
	CHECK(ob_records_add(to, &r));
}

// Converts the experiment's records to results.
static void test_records(void)
{
	ob_records from = { .machine = "A processor", .commit = "c0ffee" };
	ob_results r;
	ob_error e;
	add_record(&from, "pile", "obsim substeps=8 iterations=16", 1, OB_FAILURE_NONE);
	add_record(&from, "pile", "obsim substeps=8 iterations=16", 0, OB_FAILURE_NONE);
	add_record(&from, "stack-10", "obsim iterations=64 tolerance=5e-05", 0, OB_FAILURE_TIME);
	CHECK(ob_lab_results(&from, &r, &e) && r.count == 2 && !strcmp(r.commit, "c0ffee"));
	const ob_result *late = &r.result[0], *pile = &r.result[1];
	CHECK(late->settings.tolerance == 5e-5 && late->settings.substeps == 0 && late->settings.iterations == 64);
	CHECK(isinf(late->outcome.figure[0]) && isnan(late->outcome.body_seconds) && late->outcome.cpu_s == 8);
	CHECK(!strcmp(late->outcome.failed, "fell"));
	CHECK(pile->repeats == 2 && pile->outcome.cpu_s == 1.5 && pile->outcome.figure[0] == 2 &&
	      !*pile->outcome.failed);
	CHECK(pile->settings.step_length == ob_case_step && pile->settings.substeps == 8);
	ob_results_finish(&r);
	add_record(&from, "pillow", "obsim", 0, OB_FAILURE_NONE);
	CHECK(!ob_lab_results(&from, &r, &e) && strstr(e.text, "no case 'pillow'"));
	ob_results_finish(&r);
	ob_records_finish(&from);
}

static void test_configuration(void)
{
	const ob_engine_kind *own = ob_engine_find("obsim"), *k;
	const ob_case *c = ob_case_find("pile");
	ob_run_settings s = own->usual, back;
	char text[OB_CONFIGURATION_KEY];
	ob_error e;
	s.step_length = ob_case_step;
	s.tolerance = 5e-4 / 3;
	ob_lab_print_configuration(text, sizeof text, own, &s);
	CHECK(ob_lab_read_configuration(text, c, &k, &back, &e));
	CHECK(k == own && !memcmp(&s, &back, sizeof s));
	CHECK(!ob_lab_read_configuration("physx substeps=1", c, &k, &back, &e) && strstr(e.text, "no engine 'physx'"));
	CHECK(!ob_lab_read_configuration("obsim substeps", c, &k, &back, &e));
	CHECK(!ob_lab_read_configuration("obsim steps=3", c, &k, &back, &e));
}

static void test_schedule(void)
{
	ob_lab_plan p = { .repeats = 2 };
	char word[64];
	ob_error e;
	ob_trials s = { 0 };
	CHECK(ob_list_add_cases(&p.cases, "projectile") && ob_list_engines(&p.engines, "obsim,ode-quick", word));
	CHECK(ob_sweep_parse(&p.sweep, "substeps=1,2", &e) && ob_lab_schedule(&p, &s, &e));
	// the usual settings of each, and the swept ones; then the same again
	CHECK(s.count >= 8 && s.count % 2 == 0 && !strcmp(s.trial[0].of, "projectile"));
	for (size_t i = 0; i < s.count; i++)
		CHECK(s.trial[i].guess_s > 0 && s.trial[i].repeat == (i >= s.count / 2));
	ob_trials_finish(&s);
}

static double at(const ob_results *r, double error)
{
	return ob_cost_at(r, ob_case_find("pile"), ob_engine_find("obsim"), error);
}

static void test_equal(void)
{
	ob_results r = { 0 };
	CHECK(isnan(at(&r, 1)));
	add(&r, make("pile", "ode-quick", 1, 1e-6, 1e-6)); // others' points do not count
	add(&r, make("stack-10", "obsim", 1, 1e-6, 1e-6));
	CHECK(isnan(at(&r, 1)));
	add(&r, make("pile", "obsim", 1, 1e-3, 1e-1));
	add(&r, make("pile", "obsim", 4, 1e-1, 1e-5));
	CHECK_NEAR(at(&r, 1), 1e-3, 1e-15); // no cheaper than the cheapest
	CHECK_NEAR(at(&r, 1e-1), 1e-3, 1e-15);
	CHECK_NEAR(at(&r, 1e-3), 1e-2, 1e-14); // half-way in the logarithms
	CHECK_NEAR(at(&r, 1e-4), pow(10, -1.5), 1e-13);
	CHECK_NEAR(at(&r, 1e-5), 1e-1, 1e-13);
	CHECK(isnan(at(&r, .9e-5))); // nothing beyond the last
	add(&r, make("pile", "obsim", 2, 2e-2, 2e-1)); // worse in both than the first: not on the envelope
	CHECK_NEAR(at(&r, 1e-3), 1e-2, 1e-14);
	add(&r, make("pile", "obsim", 3, 1e-2, 1e-4)); // better than the line
	CHECK_NEAR(at(&r, 1e-4), 1e-2, 1e-14);
	CHECK_NEAR(at(&r, 1e-2), pow(10, -3 + 1. / 3), 1e-13);
	ob_result failed = make("pile", "obsim", 5, 1e-5, 1e-9);
	strcpy(failed.outcome.failed, "fell");
	add(&r, failed);
	add(&r, make("pile", "obsim", 6, 1e-5, NAN));
	CHECK_NEAR(at(&r, 1e-4), 1e-2, 1e-14);
	CHECK(isnan(at(&r, 1e-8)));
	add(&r, make("pile", "obsim", 7, 1, 0)); // exact: a step down, not a line
	CHECK_NEAR(at(&r, 1e-8), 1, 0);
	CHECK_NEAR(at(&r, 0), 1, 0);
	CHECK_NEAR(at(&r, 1e-5), 1e-1, 1e-13);
	ob_results_finish(&r);
}

int main(void)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	test_order();
	test_repeats();
	test_records();
	test_configuration();
	test_schedule();
	test_equal();
	return check_end();
}
