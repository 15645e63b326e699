// Settings of a run: defaults, layers on top of each other, and their resolution for each architecture and solver.
#include <string.h>

#include "check.h"
#include "settings/settings.h"

static ob_settings layer;

// Gives one setting more to the layer.
static const ob_settings * and (ob_setting_id id, double value)
{
	const ob_setting *s = &ob_setting_table[id];
	layer.given |= 1ull << id;
	if (s->kind == OB_SETTING_REAL)
		*(double *)((char *)&layer + s->offset) = value;
	else
		*(uint32_t *)((char *)&layer + s->offset) = (uint32_t)value;
	return &layer;
}

// A layer with one setting.
static const ob_settings *with(ob_setting_id id, double value)
{
	layer = (ob_settings){ 0 };
	return and(id, value);
}

static bool resolve(ob_run_settings *s, const ob_settings *asked)
{
	ob_error e;
	return ob_run_settings_resolve(s, asked, &e);
}

static void check_refused(ob_run_settings s, const ob_settings *asked, const char *part)
{
	ob_error e = { "" };
	CHECK(!ob_run_settings_resolve(&s, asked, &e));
	CHECK(strstr(e.text, part));
}

static void test_layers(void)
{
	const ob_settings unset = { 0 };
	ob_run_settings s = ob_run_settings_default();
	for (int i = 0; i < OB_SETTINGS; i++) {
		CHECK(!ob_setting_is_set(&unset, i));
		for (int k = 0; ob_setting_table[i].kind != OB_SETTING_TEXT && k < OB_SETTINGS; k++)
			CHECK(ob_setting_is_set(with(i, 1), k) == (i == k));
	}
	ob_run_settings_overlay(&s, &unset);
	CHECK(s.tolerance == 1e-3 && s.substeps == 8 && s.iterations == 16 && s.step_length == 1. / 60 && s.sleeping);
	ob_run_settings_overlay(&s, with(OB_SETTING_SUBSTEPS, 4)); // numbers stand above a tolerance
	CHECK(s.tolerance == 0 && s.substeps == 4 && s.iterations == 16);
	ob_run_settings_overlay(&s, with(OB_SETTING_TOLERANCE, .5e-3)); // and a tolerance above numbers
	CHECK(s.tolerance == .5e-3 && s.substeps == 8 && s.iterations == 64);
	ob_run_settings_overlay(&s, with(OB_SETTING_ITERATIONS, 5));
	CHECK(s.tolerance == .5e-3 && s.substeps == 8 && s.iterations == 5);
}

// A smaller tolerance never chooses from fewer substeps, and the default one from the default number.
static void test_least_substeps(void)
{
	CHECK(ob_run_settings_least_substeps(OB_DEFAULT_TOLERANCE) == OB_DEFAULT_SUBSTEPS);
	CHECK(ob_run_settings_least_substeps(1) == 1);
	for (double tolerance = 1; tolerance > 1e-6; tolerance *= .7)
		CHECK(ob_run_settings_least_substeps(.7 * tolerance) >= ob_run_settings_least_substeps(tolerance));
	ob_run_settings s = ob_run_settings_default();
	CHECK(ob_run_settings_coarseness(&s) == 1);
	s.tolerance = OB_DEFAULT_TOLERANCE / 10;
	CHECK(ob_run_settings_coarseness(&s) == 1);
	s.substeps = 2;
	CHECK(ob_run_settings_coarseness(&s) == OB_DEFAULT_SUBSTEPS / 2);
	s.tolerance = 0;
	CHECK(ob_run_settings_coarseness(&s) == 1);
}

static void test_exactness(void)
{
	ob_run_settings s = ob_run_settings_default();
	CHECK(resolve(&s, NULL) && s.tolerance == 1e-3 && s.substeps == 8 && s.iterations == 16 && s.lag == 0);
	s = ob_run_settings_default();
	with(OB_SETTING_TOLERANCE, .1e-3);
	and(OB_SETTING_INTEGRATOR, OB_INTEGRATOR_ODE);
	CHECK(resolve(&s, &layer) && s.substeps == 16); // g H^2 / 2 = 1.36 mm
	for (double step = 1. / 480; step <= 10; step *= 2) { // never more than can be counted, at any step
		s = ob_run_settings_default();
		with(OB_SETTING_TOLERANCE, .1e-3);
		and(OB_SETTING_INTEGRATOR, OB_INTEGRATOR_ODE);
		and(OB_SETTING_STEP, step);
		ob_error e;
		if (ob_run_settings_resolve(&s, &layer, &e))
			CHECK(s.substeps <= OB_MAX_SUBSTEPS && .5 * 9.81 * step * step / s.substeps <= .1e-3);
		else
			CHECK(step > .1 && strstr(e.text, "1024 at most"));
	}
	s = ob_run_settings_default();
	CHECK(resolve(&s, with(OB_SETTING_SOLVER, OB_SOLVER_GHOST)) && s.tolerance == 0 && s.substeps == 8);
	s = ob_run_settings_default();
	with(OB_SETTING_SOLVER, OB_SOLVER_GHOST);
	and(OB_SETTING_TOLERANCE, 2e-3); // explicit, so it stays
	CHECK(resolve(&s, &layer) && s.tolerance == 2e-3);
	check_refused(ob_run_settings_default(), with(OB_SETTING_ITERATIONS, 0), "--arch monolith");
}

static void test_lag(void)
{
	ob_run_settings s = ob_run_settings_default();
	CHECK(resolve(&s, with(OB_SETTING_SOLVER, OB_SOLVER_LAGGED)) && s.lag == 1);
	s = ob_run_settings_default();
	with(OB_SETTING_SOLVER, OB_SOLVER_LAGGED);
	and(OB_SETTING_LAG, 0);
	CHECK(resolve(&s, &layer) && s.lag == 0);
	check_refused(ob_run_settings_default(), with(OB_SETTING_LAG, 2),
		      "--set solver=lagged; this run's is coloured");
}

static void test_monolith(void)
{
	ob_run_settings s = ob_run_settings_default();
	CHECK(resolve(&s, with(OB_SETTING_ARCHITECTURE, 1)));
	CHECK(s.monolith == 1 && s.tolerance == 0 && s.substeps == 1 && s.iterations == 20);
	s = ob_run_settings_default();
	with(OB_SETTING_ARCHITECTURE, 1);
	and(OB_SETTING_SUBSTEPS, 3);
	and(OB_SETTING_ITERATIONS, 0);
	CHECK(resolve(&s, &layer) && s.substeps == 3 && s.iterations == 0);
	static const ob_setting_id of_objects[] = { OB_SETTING_TOLERANCE, OB_SETTING_SOLVER, OB_SETTING_LAG,
						    OB_SETTING_INTEGRATOR };
	for (size_t i = 0; i < sizeof of_objects / sizeof *of_objects; i++) {
		with(of_objects[i], 1);
		and(OB_SETTING_ARCHITECTURE, 1);
		check_refused(ob_run_settings_default(), &layer, "means nothing to --arch monolith");
	}
}

static void test_names(void)
{
	ob_run_settings s = ob_run_settings_default();
	uint32_t value = 9;
	for (int i = 0; i < OB_RUN_SETTINGS; i++) {
		const ob_setting *t = &ob_setting_table[i];
		if (t->kind != OB_SETTING_CHOICE && t->kind != OB_SETTING_SWITCH)
			continue;
		for (uint32_t k = 0; k < 2; k++) {
			ob_run_settings_overlay(&s, with(i, k));
			CHECK(ob_setting_find(t->form, ob_setting_print(&s, i).text, &value) && value == k);
		}
	}
	CHECK(ob_setting_find(OB_SOLVER_NAMES, "lagged", &value) && value == OB_SOLVER_LAGGED);
	CHECK(!ob_setting_find(OB_SOLVER_NAMES, "lag", &value) && !ob_setting_find(OB_SOLVER_NAMES, "", &value));
	s.solver = 1000;
	CHECK(strcmp(ob_setting_print(&s, OB_SETTING_SOLVER).text, "?") == 0);
	CHECK(strcmp(ob_setting_renamed("passes"), "iterations") == 0 && !ob_setting_renamed("iterations"));
	CHECK(ob_setting_by_name("passes") == OB_SETTING_ITERATIONS && ob_setting_by_name("pass") < 0);
	CHECK(strcmp(ob_setting_option(OB_SETTING_LAG).text, "set lag") == 0);
	CHECK(strcmp(ob_setting_option(OB_SETTING_TOLERANCE).text, "tolerance") == 0);
	CHECK(strcmp(ob_setting_former("solver"), "exchange") == 0 && !ob_setting_former("exchange"));
}

// Every name is one word that scenes may use. Settings of free running overwrite those of the layer below.
static void test_table(void)
{
	for (int i = 0; i < OB_SETTINGS; i++) {
		const ob_setting *t = &ob_setting_table[i];
		CHECK(strspn(t->name, "abcdefghijklmnopqrstuvwxyz_") == strlen(t->name) && *t->form && *t->help);
		CHECK(ob_setting_by_name(t->name) == i);
		CHECK((t->kind != OB_SETTING_REAL && t->kind != OB_SETTING_COUNT) || t->least < t->most);
	}
	ob_settings below = *with(OB_SETTING_MAX_LAG, .5);
	below.given |= 1ull << OB_SETTING_SYNC;
	below.sync = 1;
	with(OB_SETTING_MAX_LAG, .25);
	ob_settings_overlay(&below, and(OB_SETTING_DELAY, .1));
	CHECK(below.sync == 1 && below.free.max_lag == .25 && below.free.delay == .1);
	CHECK(ob_setting_is_set(&below, OB_SETTING_DELAY) && !ob_setting_is_set(&below, OB_SETTING_JITTER));
}

int main(void)
{
	test_layers();
	test_least_substeps();
	test_exactness();
	test_lag();
	test_monolith();
	test_names();
	test_table();
	return check_end();
}
