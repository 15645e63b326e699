// Swept settings, and cases and engines by name.
#include <string.h>

#include "check.h"
#include "lab/case.h"
#include "lab/lab.h"

static ob_run_settings settings[OB_SWEEP_SETTINGS];

static size_t sweep(const char *text, const char *name, const char *engine)
{
	ob_sweep s;
	ob_error e = { "" };
	bool fine = ob_sweep_parse(&s, text, &e);
	if (!fine)
		fprintf(stderr, "%s\n", e.text);
	CHECK(fine);
	return fine ? ob_sweep_settings(&s, ob_case_find(name), ob_engine_find(engine), settings) : 0;
}

static bool has(size_t n, uint32_t substeps, uint32_t iterations, double tolerance)
{
	int found = 0;
	for (size_t i = 0; i < n; i++)
		found += settings[i].substeps == substeps && settings[i].iterations == iterations &&
			 fabs(settings[i].tolerance - tolerance) < 1e-12;
	return found == 1;
}

static void test_settings(void)
{
	const ob_run_settings own = ob_engine_find("obsim")->usual, quick = ob_engine_find("ode-quick")->usual;
	CHECK(sweep("none", "pile", "obsim") == 1);
	CHECK(settings[0].substeps == own.substeps && settings[0].iterations == own.iterations);
	CHECK(settings[0].step_length == ob_case_step);

	size_t n = sweep("substeps=1,2,64", "pile", "ode-quick"); // the usual ones are among them
	CHECK(n == 3 && settings[0].substeps == quick.substeps && has(n, 64, quick.iterations, 0));
	n = sweep("iterations=5,50,substeps=1,4", "pile", "ode-quick");
	CHECK(n == 5 && has(n, 1, 5, 0) && has(n, 4, 5, 0) && has(n, 1, 50, 0) && has(n, 4, 50, 0) &&
	      has(n, quick.substeps, quick.iterations, 0));
	CHECK(sweep("iterations=5,50", "pile", "ode-world") == 1); // it has none
	CHECK(sweep("tolerance=5mm", "pile", "ode-quick") == 1);
	n = sweep("tolerance=5mm,.5 mm,2e-6m,7um", "pile", "obsim");
	CHECK(n == 5 && has(n, 0, 64, 5e-3) && has(n, 0, 64, 5e-4) && has(n, 0, 64, 2e-6) && has(n, 0, 64, 7e-6));
}

static void test_own(void)
{
	const ob_run_settings own = ob_engine_find("obsim")->usual;
	size_t n = sweep(NULL, "pile", "obsim");
	CHECK(has(n, 1, own.iterations, 0) && has(n, 32, own.iterations, 0) && has(n, 0, 64, 5e-4));
	CHECK(settings[0].substeps == own.substeps && settings[0].tolerance == own.tolerance);
	n = sweep(NULL, "pile", "ode-quick");
	CHECK(n == 6 && has(n, 32, 20, 0) && settings[0].substeps == 1);
	n = sweep(NULL, "lag", "obsim-lag");
	CHECK(n >= 4 && settings[0].lag == 0 && settings[1].lag == 1);
	for (size_t i = 1; i < n; i++)
		CHECK(settings[i].lag > settings[i - 1].lag && settings[i].substeps == own.substeps);
	CHECK(sweep(NULL, "pile", "obsim-lag") == 0);
	CHECK(sweep(NULL, "lag", "ode-quick") == 0);
}

static void refuse(const char *text, const char *saying)
{
	ob_sweep s;
	ob_error e = { "" };
	CHECK(!ob_sweep_parse(&s, text, &e));
	if (!strstr(e.text, saying)) {
		fprintf(stderr, "%s: said '%s' instead of '%s'\n", text, e.text, saying);
		CHECK(!"the right words");
	}
}

static void test_refused(void)
{
	refuse("", "expected none");
	refuse("fine", "expected none");
	refuse("substeps=", "whole number from 1 to");
	refuse("substeps=0", "whole number from 1 to");
	refuse("substeps=1,-2", "whole number");
	refuse("substeps=1,two", "whole number");
	refuse("substeps=4294967297", "whole number");
	refuse("passes=1", "there are substeps");
	refuse("tolerance=5mm,mm", "expected a length above 0, at most 1 m");
	refuse("tolerance=-5mm", "expected a length above 0, at most 1 m");
	refuse("tolerance=5km", "expected a length above 0, at most 1 m");
	refuse("lag=1,2,65", "from 0 to 64");
	refuse("lag=1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1", "at most 16");
}

static void test_cases(void)
{
	ob_case_list l = { 0 };
	CHECK(ob_list_add_cases(&l, "pile") && l.count == 1); // not pile-elastic
	CHECK(ob_list_add_cases(&l, "14") && l.count == 4); // before it, as in the table
	CHECK(!strcmp(l.of[0]->name, "stack-10") && !strcmp(l.of[3]->name, "pile"));
	CHECK(ob_list_add_cases(&l, "stack-*") && l.count == 4);
	CHECK(ob_list_add_cases(&l, "stack") && l.count == 4);
	CHECK(ob_list_add_cases(&l, "666") && l.count == 5 && l.of[0]->row == 7);
	CHECK(!ob_list_add_cases(&l, "stakc-10") && !ob_list_add_cases(&l, "99") && !ob_list_add_cases(&l, ""));
	CHECK(l.count == 5);
	ob_case_list all = { 0 }, quick = { 0 };
	ob_list_add_all(&all, false);
	ob_list_add_all(&quick, true);
	CHECK(all.count >= 25 && quick.count <= all.count && quick.count > 0);
	for (size_t i = 0; i < quick.count; i++)
		CHECK(!quick.of[i]->slow);
	CHECK(ob_list_add_cases(&l, "*") && l.count == all.count);
}

static void test_engines(void)
{
	ob_engine_list l;
	char word[64];
	CHECK(ob_list_engines(&l, "all", word) && l.count >= 7);
	CHECK(ob_list_engines(&l, "ode-quick,obsim", word) && l.count == 2);
	CHECK(!strcmp(l.of[0]->name, "obsim") && !strcmp(l.of[1]->name, "ode-quick"));
	CHECK(ob_list_engines(&l, "obsim-jacobi", word) && l.count == 1);
	CHECK(!ob_list_engines(&l, "obsim,ode", word) && !strcmp(word, "ode"));
	CHECK(!ob_list_engines(&l, "obsim,", word) && !strcmp(word, ""));
}

int main(void)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	test_settings();
	test_own();
	test_refused();
	test_cases();
	test_engines();
	return check_end();
}
