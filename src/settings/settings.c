#include "settings/settings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"

#define UNSET UINT32_MAX // in counts, choices and switches; NaN in reals

#define MEMBER(member) .offset = offsetof(ob_run_settings, member)

const ob_setting ob_setting_table[OB_SETTINGS] = {
	[OB_SETTING_ARCHITECTURE] = { "arch", OB_SETTING_CHOICE, MEMBER(monolith), .unit = "",
				      .names = OB_ARCHITECTURE_NAMES },
	[OB_SETTING_STEP] = { "step", OB_SETTING_REAL, MEMBER(step_length), 1e-9, 10, .unit = "s" },
	[OB_SETTING_TOLERANCE] = { "tolerance", OB_SETTING_REAL, MEMBER(tolerance), 1e-6, 1, .unit = "m" },
	[OB_SETTING_SUBSTEPS] = { "substeps", OB_SETTING_COUNT, MEMBER(substeps), 1, 1000, .unit = "" },
	[OB_SETTING_ITERATIONS] = { "iterations", OB_SETTING_COUNT, MEMBER(iterations), 0, 100000, .unit = "" },
	[OB_SETTING_SOLVER] = { "solver", OB_SETTING_CHOICE, MEMBER(solver), .unit = "", .names = OB_SOLVER_NAMES },
	[OB_SETTING_LAG] = { "lag", OB_SETTING_COUNT, MEMBER(lag), 0, 256, .unit = "" },
	[OB_SETTING_INTEGRATOR] = { "integrator", OB_SETTING_CHOICE, MEMBER(integrator), .unit = "",
				    .names = OB_INTEGRATOR_NAMES },
	[OB_SETTING_SLEEPING] = { "sleeping", OB_SETTING_SWITCH, MEMBER(sleeping), .unit = "",
				  .names = OB_SWITCH_NAMES },
	[OB_SETTING_NARROW_PHASE] = { "narrow", OB_SETTING_CHOICE, MEMBER(narrow_phase), .unit = "",
				      .names = OB_NARROW_PHASE_NAMES },
	[OB_SETTING_LOAD] = { "load", OB_SETTING_COUNT, MEMBER(load), 0, 1e9, .unit = "" },
};

static const struct {
	const char *former, *now;
} renamed[] = { { "passes", "iterations" }, { "exchange", "solver" }, { "parts", "profile" } };

ob_units ob_run_settings_units(const ob_run_settings *s)
{
	double length = s->tolerance > 0 ? s->tolerance / OB_DEFAULT_TOLERANCE : 1;
	return (ob_units){ length, sqrt(length), sqrt(length) };
}

ob_run_settings ob_run_settings_default(void)
{
	return (ob_run_settings){
		.gravity = { 0, 0, -9.81 },
		.step_length = OB_DEFAULT_STEP,
		.tolerance = OB_DEFAULT_TOLERANCE,
		.substeps = OB_DEFAULT_SUBSTEPS,
		.iterations = OB_DEFAULT_ITERATIONS,
		.solver = OB_SOLVER_COLOURED,
		.lag = 1,
		.integrator = OB_INTEGRATOR_EXACT,
		.narrow_phase = OB_NARROW_OBB,
		.sleeping = 1,
	};
}

uint32_t ob_run_settings_least_substeps(double tolerance)
{
	uint32_t least = OB_DEFAULT_SUBSTEPS;
	while (least > 1 && least * tolerance >= 2 * OB_DEFAULT_SUBSTEPS * OB_DEFAULT_TOLERANCE)
		least /= 2;
	return least;
}

double ob_run_settings_coarseness(const ob_run_settings *s)
{
	return s->tolerance > 0 && s->substeps < OB_DEFAULT_SUBSTEPS ? (double)OB_DEFAULT_SUBSTEPS / s->substeps : 1;
}

ob_run_settings ob_run_settings_unset(void)
{
	ob_run_settings layer = { 0 };
	for (int i = 0; i < OB_SETTINGS; i++) {
		char *at = (char *)&layer + ob_setting_table[i].offset;
		if (ob_setting_table[i].kind == OB_SETTING_REAL)
			*(double *)at = NAN;
		else
			*(uint32_t *)at = UNSET;
	}
	return layer;
}

bool ob_setting_is_set(const ob_run_settings *layer, ob_setting_id id)
{
	const char *at = (const char *)layer + ob_setting_table[id].offset;
	return ob_setting_table[id].kind == OB_SETTING_REAL ? !isnan(*(const double *)at)
							    : *(const uint32_t *)at != UNSET;
}

void ob_run_settings_overlay(ob_run_settings *s, const ob_run_settings *layer)
{
	if (ob_setting_is_set(layer, OB_SETTING_TOLERANCE)) {
		s->substeps = ob_run_settings_least_substeps(layer->tolerance);
		s->iterations = OB_DEFAULT_TOLERANCE_ITERATIONS;
	} else if (ob_setting_is_set(layer, OB_SETTING_SUBSTEPS)) {
		s->tolerance = 0;
	}
	for (int i = 0; i < OB_SETTINGS; i++) {
		const ob_setting *t = &ob_setting_table[i];
		if (ob_setting_is_set(layer, i))
			memcpy((char *)s + t->offset, (const char *)layer + t->offset,
			       t->kind == OB_SETTING_REAL ? sizeof(double) : sizeof(uint32_t));
	}
}

// Rejects settings that a monolith does not support.
static bool check_monolith(const ob_run_settings *layer, ob_error *e)
{
	static const ob_setting_id of_objects[] = { OB_SETTING_TOLERANCE, OB_SETTING_SOLVER, OB_SETTING_LAG,
						    OB_SETTING_INTEGRATOR };
	for (size_t i = 0; i < sizeof of_objects / sizeof *of_objects; i++)
		if (ob_setting_is_set(layer, of_objects[i]))
			return ob_fail(e, "--%s means nothing to --arch monolith",
				       ob_setting_table[of_objects[i]].name);
	return true;
}

bool ob_run_settings_resolve(ob_run_settings *s, const ob_run_settings *layer, ob_error *e)
{
	ob_run_settings asked = *s;
	ob_run_settings_overlay(&asked, layer);
	if (asked.monolith) {
		if (!check_monolith(layer, e))
			return false;
		// once a step, as usual in virtual environments
		s->substeps = 1;
		s->iterations = OB_DEFAULT_MONOLITH_ITERATIONS;
	}
	if (asked.monolith || asked.solver == OB_SOLVER_GHOST || asked.solver == OB_SOLVER_LAGGED)
		s->tolerance = 0;
	ob_run_settings_overlay(s, layer);

	if (!s->monolith && s->iterations == 0)
		return ob_fail(e, "--iterations 0 is ODE's exact solver, for --arch monolith; object simulators take "
				  "1 at least");
	if (s->solver != OB_SOLVER_LAGGED) {
		if (ob_setting_is_set(layer, OB_SETTING_LAG))
			return ob_fail(e, "--lag is for --solver lagged; this run's is %s",
				       ob_setting_print(s, OB_SETTING_SOLVER).text);
		s->lag = 0;
	}
	if (s->tolerance > 0 && s->integrator == OB_INTEGRATOR_ODE) {
		// With n substeps, ODE's stepper falls short by g H^2 / (2 n) in a step of length H.
		double short_by = .5 * ob_norm(s->gravity) * s->step_length * s->step_length;
		while (short_by / s->substeps > s->tolerance && 2 * s->substeps <= OB_MAX_SUBSTEPS)
			s->substeps *= 2;
		if (short_by / s->substeps > s->tolerance)
			return ob_fail(
				e,
				"--integrator ode would need %.3g substeps to keep the tolerance of %g m, and there "
				"are %d at most: take a smaller --step or a larger --tolerance, or fix --substeps",
				short_by / s->tolerance, s->tolerance, OB_MAX_SUBSTEPS);
	}
	return true;
}

static uint32_t names_in(const char *names)
{
	uint32_t n = 1;
	for (; *names; names++)
		n += *names == '|';
	return n;
}

static bool in_range(const ob_run_settings *s, const ob_setting *t)
{
	const char *at = (const char *)s + t->offset;
	const double real = t->kind == OB_SETTING_REAL ? *(const double *)at : 0;
	const uint32_t count = t->kind == OB_SETTING_REAL ? 0 : *(const uint32_t *)at;
	switch (t->kind) {
	case OB_SETTING_REAL:
		if (t->offset == offsetof(ob_run_settings, tolerance) && real == 0) // no tolerance
			return true;
		return real >= t->least && real <= t->most && !(t->above && real == t->least);
	case OB_SETTING_COUNT: // ODE's stepper may need more substeps than a caller may request
		return count >= t->least &&
		       count <= (t->offset == offsetof(ob_run_settings, substeps) ? OB_MAX_SUBSTEPS : t->most);
	case OB_SETTING_CHOICE:
	case OB_SETTING_SWITCH:
		return count < names_in(t->names);
	}
	return false;
}

bool ob_run_settings_check(const ob_run_settings *s, ob_error *e)
{
	const ob_vec3 g = s->gravity;
	if (!(fmax(fabs(g.x), fmax(fabs(g.y), fabs(g.z))) <= OB_GRAVITY_MOST) || isnan(g.x + g.y + g.z))
		return ob_fail(e, "gravity: expected up to %g m/s^2 along each axis, got %s, %s, %s", OB_GRAVITY_MOST,
			       ob_number_text(g.x).text, ob_number_text(g.y).text, ob_number_text(g.z).text);
	if (s->fault.probability != 0) // drawn anew
		return ob_fail(e, "a fault is asked for");
	for (int i = 0; i < OB_SETTINGS; i++)
		if (!in_range(s, &ob_setting_table[i]))
			return ob_fail(e, "%s is out of its range", ob_setting_table[i].name);
	return true;
}

bool ob_setting_find(const char *names, const char *word, uint32_t *value)
{
	size_t length = strlen(word);
	for (uint32_t i = 0; *names; i++) {
		size_t n = strcspn(names, "|");
		if (n == length && strncmp(names, word, n) == 0) {
			*value = i;
			return true;
		}
		names += n + (names[n] == '|');
	}
	return false;
}

bool ob_harden_read(uint32_t *measures, const char *list, ob_error *e)
{
	const uint32_t of_outboxes = 1 << OB_HARDEN_CHECKSUM | 1 << OB_HARDEN_PAGES;
	uint32_t found = list && !*list ? OB_HARDEN_ALL : 0;
	while (list && *list) {
		char word[16];
		const int n = (int)strcspn(list, ",");
		uint32_t measure;
		snprintf(word, sizeof word, "%.*s", n, list);
		if (!ob_setting_find(OB_HARDEN_NAMES, word, &measure))
			return ob_fail(e, "--harden=%.*s: expected some of %s, with commas between them", n, list,
				       OB_HARDEN_NAMES);
		found |= 1u << measure;
		list += n + (list[n] == ',');
	}
	*measures = found & of_outboxes ? found | 1 << OB_HARDEN_OUTBOX : found;
	return true;
}

ob_setting_word ob_setting_print(const ob_run_settings *s, ob_setting_id id)
{
	const char *names = ob_setting_table[id].names;
	uint32_t value = *(const uint32_t *)((const char *)s + ob_setting_table[id].offset);
	ob_setting_word word = { "?" };
	for (; value > 0 && *names; value--) {
		names += strcspn(names, "|");
		names += *names == '|';
	}
	size_t n = strcspn(names, "|");
	if (n > 0 && n < sizeof word.text) {
		memcpy(word.text, names, n);
		word.text[n] = 0;
	}
	return word;
}

const char *ob_setting_renamed(const char *former)
{
	for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++)
		if (strcmp(renamed[i].former, former) == 0)
			return renamed[i].now;
	return NULL;
}

const char *ob_setting_former(const char *name)
{
	for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++)
		if (strcmp(renamed[i].now, name) == 0)
			return renamed[i].former;
	return NULL;
}
