// Audit of made-up results: rises are found and named; errors at the level of rounding are not.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "printed.h"
#include "lab/analysis.h"

static ob_results made;

// obsim in a case at a tolerance (m), or at so many substeps: all figures at "error" times their targets.
static ob_result *add(const char *name, double tolerance, uint32_t substeps, double error)
{
	ob_result r = { .of = ob_case_find(name), .engine = ob_engine_find("obsim") };
	r.settings = r.engine->usual;
	r.settings.tolerance = tolerance;
	r.settings.substeps = substeps;
	ob_case_result o = { .cpu_s = 1, .body_seconds = 1 };
	for (uint32_t i = 0; i < r.of->figures; i++)
		o.figure[i] = error * r.of->figure[i].target;
	ob_result_repeat(&r, &o);
	CHECK(ob_results_add(&made, &r));
	return ob_results_find(&made, r.of, r.engine, &r.settings);
}

static ob_audit audit(const char *name)
{
	ob_lab_analysis d = ob_lab_analyse(&made);
	return ob_lab_audit(&d, ob_case_find(name));
}

// First order in the substeps, from above the target to below.
static void test_falls(void)
{
	for (uint32_t n = 4; n <= 256; n *= 2)
		add("apexes", 0, n, 64. / n);
	add("apexes", 1e-2, 0, 3);
	add("apexes", 1e-3, 0, 3.1); // practically the same
	add("apexes", 1e-5, 0, .5); // the one between was not run
	add("apexes", 1e-3, 8, 99); // the usual setting is not part of the audit
	ob_audit a = audit("apexes");
	CHECK(a.measured == 10 && a.above.figure < 0 && a.below.figure < 0);
	CHECK_NEAR(a.order, 1, 1e-9);
	CHECK(a.ratio[0] == 3 && isnan(a.ratio[2]) && a.ratio[4] == 16);
}

static void test_rises(void)
{
	add("bounce", 1e-2, 0, 2)->outcome.figure[1] = 0;
	add("bounce", 1e-3, 0, 3)->outcome.figure[1] = 0;
	add("bounce", 1e-4, 0, 9)->outcome.figure[1] = 0;
	add("bounce", 0, 4, .1);
	add("bounce", 0, 8, .4);
	add("bounce", 0, 16, 1e-5);
	add("bounce", 0, 32, 9e-4); // at the level of rounding
	ob_audit a = audit("bounce");
	CHECK(a.above.figure == 0 && a.above.setting == 2 && a.below.figure == 0 && a.below.setting == 5);
	CHECK_NEAR(a.above.times, 3, 1e-12);
	CHECK_NEAR(a.below.times, 4, 1e-12);
	add("bounce", 0, 64, .5)->outcome.figure[1] = 2; // nothing is below a target of 0
	a = audit("bounce");
	CHECK(a.above.figure == 1 && isinf(a.above.times));
}

static void test_failures(void)
{
	strcpy(add("stack-10", 1e-2, 0, 5)->outcome.failed, "fell"); // coarser: no rise
	add("stack-10", 1e-3, 0, .2);
	add("stack-10", 0, 4, .2);
	add("stack-10", 0, 8, .2)->outcome.body_seconds = NAN; // out of time
	ob_audit a = audit("stack-10");
	CHECK(a.measured == 3 && isinf(a.ratio[0]) && a.above.figure < 0 && !a.result[5]);
	strcpy(add("stack-10", 0, 16, .1)->outcome.failed, "fell");
	a = audit("stack-10");
	CHECK(a.above.figure == 0 && a.above.setting == 6 && isinf(a.above.times));
}

static void test_flat(void)
{
	for (uint32_t n = 4; n <= 256; n *= 2)
		add("projectile", 0, n, .5 + .001 * n);
	CHECK(isnan(audit("projectile").order));
	for (uint32_t n = 4; n <= 256; n *= 2)
		add("spin", 0, n, 5);
	CHECK_NEAR(audit("spin").order, 0, 1e-12);
}

static void test_print(void)
{
	ob_lab_analysis d = ob_lab_analyse(&made);
	FILE *f = begin();
	ob_lab_print_audit(f, &d, true);
	fclose(f);
	CHECK(strstr(text, "RISES") && strstr(text, "in 2 of 3 cases:\n") &&
	      strstr(text, "- `bounce`: bounces too many"));
	CHECK(strstr(text, "- `stack-10`: worst penetration, at 16 substeps, where the coarser"));
	CHECK(strstr(text, "- `bounce`: error of energy, at 64 substeps, 556 times"));
	free(text);
	ob_results none = { 0 };
	d = ob_lab_analyse(&none);
	f = begin();
	ob_lab_print_audit(f, &d, true);
	expect(f, "");
}

int main(void)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	test_falls();
	test_rises();
	test_failures();
	test_print();
	test_flat();
	ob_results_finish(&made);
	return check_end();
}
