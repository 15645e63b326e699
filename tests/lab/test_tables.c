// The lab's tables of made-up results.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "printed.h"
#include "lab/report.h"

static void expect_in(FILE *f, const char *const *what)
{
	fclose(f);
	for (; *what; what++) {
		if (!strstr(text, *what))
			fprintf(stderr, "no '%s' in:\n%s\n", *what, text);
		CHECK(strstr(text, *what));
	}
	free(text);
}

static ob_result make(const char *name, const char *engine, double cost, double error, const char *failed)
{
	ob_result r = { .of = ob_case_find(name), .engine = ob_engine_find(engine) };
	r.settings = r.engine->usual;
	ob_case_result o = { .cpu_s = cost, .wall_s = cost, .body_seconds = 1 };
	for (uint32_t i = 0; i < r.of->figures; i++)
		o.figure[i] = error * r.of->figure[i].target;
	snprintf(o.failed, sizeof o.failed, "%s", failed);
	ob_result_repeat(&r, &o);
	return r;
}

static void test_tables(void)
{
	ob_results r = { 0 };
	const ob_result list[] = {
		make("stack-10", "obsim", 2e-6, .5, ""),         make("stack-10", "ode-quick", 4e-6, 1, ""),
		make("stack-10", "ode-world", 1e-6, .1, "fell"), make("heavy-1000", "obsim", 6e-6, 1, ""),
		make("heavy-1000", "ode-world", 4e-6, .5, ""),   make("sliding", "obsim", 1, 2, ""),
		make("sliding", "ode-quick", 1, 2, "fell")
	};
	for (size_t i = 0; i < sizeof list / sizeof *list; i++)
		CHECK(ob_results_add(&r, &list[i]));
	ob_lab_analysis d = ob_lab_analyse(&r);
	CHECK(ob_lab_count_missed(&d) == ob_case_find("sliding")->figures);
	FILE *f = begin();
	ob_lab_print_rows(f, &d, false);
	expect_in(f, (const char *[]){ " 14  Stack of 10", "0.25 mm  \u2264 0.5 mm", "met", "0.5 mm (ODE QuickStep)",
				       " 11  Sliding", "MISSED", "all failed", NULL });
	r.result[0].outcome.conserved[OB_CONSERVED_MOMENTUM] = NAN;
	ob_results_find(&r, ob_case_find("sliding"), ob_engine_find("obsim"), &list[5].settings)
		->outcome.conserved[OB_CONSERVED_ENERGY] = 2e-9;
	f = begin();
	ob_lab_print_conserved(f, &d, false);
	expect_in(f, (const char *[]){ "momentum (\u2264 1e-12)", "2e-9  NOT KEPT", "0  kept",
				       "Not kept in 1 of 3 cases: sliding.", NULL });
	f = begin();
	ob_lab_print_equal(f, &d, false);
	expect_in(f, (const char *[]){ "Case", "at an error of", "0.5 mm", "4 (2\u00d7)", "never", "4 (0.67\u00d7)",
				       "obsim is ahead in 1 of 2; at worst it takes 1.5 times as long.", NULL });
	ob_results alone = { 0 }; // no other engine
	CHECK(ob_results_add(&alone, &list[0]));
	ob_lab_analysis own = ob_lab_analyse(&alone);
	f = begin();
	ob_lab_print_equal(f, &own, false);
	fclose(f);
	CHECK(strstr(text, "Stack of 10") && !strstr(text, "ahead"));
	free(text);
	ob_results_finish(&alone);
	f = begin();
	ob_lab_print_equal_csv(f, &d, false);
	expect_in(f, (const char *[]){ "case,error,", "\nstack-10,0.5,mm,1,obsim,", "\nstack-10,0.5,mm,1,ode-world,,\n",
				       NULL });
	ob_results_finish(&r);
	d = ob_lab_analyse(&r);
	f = begin();
	ob_lab_print_equal(f, &d, true);
	expect(f, "");
}

int main(void)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	test_tables();
	return check_end();
}
