#include "lab/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "settings/settings.h"

#define SUBSTEPS OB_SETTING_SUBSTEPS
#define ITERATIONS OB_SETTING_ITERATIONS
#define TOLERANCE OB_SETTING_TOLERANCE
#define LAG OB_SETTING_LAG
static const double lag_most = 64; // iterations

static bool add_value(ob_sweep *s, const char *name, const char *text, ob_error *e)
{
	const int id = ob_setting_by_name(name);
	if ((id != SUBSTEPS && id != ITERATIONS && id != TOLERANCE && id != LAG) ||
	    strcmp(name, ob_setting_table[id].name))
		return ob_fail(e, "--sweep %s: there are substeps, iterations, tolerance and lag, as in substeps=1,2,4",
			       name);
	if (s->of[id].n == OB_SWEEP_VALUES)
		return ob_fail(e, "--sweep %s: at most %d values", name, OB_SWEEP_VALUES);
	double *v = &s->of[id].value[s->of[id].n++];
	ob_length l = { 0 };
	if (id == TOLERANCE) {
		*v = ob_length_read(text, &l) ? l.m : 0;
		return (*v > 0 && *v <= 1) ||
		       ob_fail(e, "--sweep tolerance=%s: expected a length above 0, at most 1 m, as .5mm", text);
	}
	const double least = id == LAG ? 0 : 1;
	const double most = id == SUBSTEPS ? OB_MAX_SUBSTEPS : id == LAG ? lag_most : ob_setting_table[id].most;
	*v = strtod(text, NULL);
	return (*text && strspn(text, "0123456789") == strlen(text) && *v >= least && *v <= most) ||
	       ob_fail(e, "--sweep %s=%s: expected a whole number from %g to %g", name, text, least, most);
}

static bool parse_lists(ob_sweep *s, char *rest, ob_error *e)
{
	const char *knob = NULL;
	for (char *word; (word = strsep(&rest, ","));) {
		char *value = strchr(word, '=');
		if (value) {
			*value++ = 0;
			knob = word;
		} else {
			value = word;
		}
		if (!knob)
			return ob_fail(e, "--sweep %s: expected none, or a knob and its values, as in substeps=1,2,4",
				       word);
		if (!add_value(s, knob, value, e))
			return false;
	}
	return true;
}

bool ob_sweep_parse(ob_sweep *s, const char *text, ob_error *e)
{
	*s = (ob_sweep){ .own = !text };
	if (!text || strcmp(text, "none") == 0)
		return true;
	char *copy = strdup(text);
	bool fine = copy ? parse_lists(s, copy, e) : ob_fail(e, "out of memory");
	free(copy);
	return fine;
}

static const ob_sweep *sensible(void)
{
	static const ob_sweep sweep = {
		.of[SUBSTEPS] = { 6, { 1, 2, 4, 8, 16, 32 } }, // 60 Hz .. 1920 Hz
		.of[TOLERANCE] = { 4, { 5e-3, 5e-4, 5e-5, 5e-6 } },
		.of[LAG] = { 5, { 0, 1, 2, 4, 8 } },
	};
	return &sweep;
}

typedef struct collection {
	ob_run_settings *to;
	size_t count;
} collection;

static void add(collection *c, ob_run_settings s)
{
	for (size_t i = 0; i < c->count; i++) {
		const ob_run_settings *t = &c->to[i];
		if (t->substeps == s.substeps && t->iterations == s.iterations && t->tolerance == s.tolerance &&
		    t->lag == s.lag)
			return;
	}
	if (c->count < OB_SWEEP_SETTINGS)
		c->to[c->count++] = s;
}

static void add_products(collection *to, const ob_sweep *s, const ob_run_settings *usual)
{
	// a setting that is not swept has its usual value alone; engines without iterations have 0
	size_t substeps = s->of[SUBSTEPS].n ? s->of[SUBSTEPS].n : 1;
	size_t iterations = s->of[ITERATIONS].n && usual->iterations ? s->of[ITERATIONS].n : 1;
	for (size_t i = 0; i < substeps; i++) {
		for (size_t j = 0; j < iterations; j++) {
			ob_run_settings one = *usual;
			if (s->of[SUBSTEPS].n) {
				one.substeps = (uint32_t)s->of[SUBSTEPS].value[i];
				one.tolerance = 0;
			}
			if (s->of[ITERATIONS].n && usual->iterations)
				one.iterations = (uint32_t)s->of[ITERATIONS].value[j];
			add(to, one);
		}
	}
}

size_t ob_sweep_settings(const ob_sweep *s, const ob_case *c, const ob_engine_kind *k,
			 ob_run_settings to[OB_SWEEP_SETTINGS])
{
	bool late = k->usual.lag > 0; // an engine with late partners has a case of its own
	if (late != (strcmp(c->name, "lag") == 0))
		return 0;
	ob_run_settings usual = k->usual;
	usual.step_length = ob_case_step;
	collection all = { to, 0 };
	const ob_sweep *sweep = s->own ? sensible() : s;
	if (late) {
		usual.lag = 0; // the promised setting
		add(&all, usual);
		for (size_t i = 0; i < sweep->of[LAG].n; i++) {
			usual.lag = (uint32_t)sweep->of[LAG].value[i];
			add(&all, usual);
		}
		return all.count;
	}
	add(&all, usual);
	add_products(&all, sweep, &usual);
	for (size_t i = 0; i < sweep->of[LAG].n && k->free; i++) {
		ob_run_settings one = usual;
		one.lag = (uint32_t)sweep->of[LAG].value[i];
		add(&all, one);
	}
	for (size_t i = 0; i < sweep->of[TOLERANCE].n && strcmp(k->name, "obsim") == 0; i++) {
		ob_run_settings one = usual;
		one.substeps = 0;
		one.iterations = OB_DEFAULT_TOLERANCE_ITERATIONS;
		one.tolerance = sweep->of[TOLERANCE].value[i];
		add(&all, one);
	}
	return all.count;
}
