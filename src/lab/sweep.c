#include "lab/sweep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "settings/length.h"

enum { SUBSTEPS_MAX = 1024, ITERATIONS_MAX = 100000, LAG_MAX = 64 };

static bool read_length(const char *text, double *out, ob_error *e)
{
	ob_length l;
	if (!ob_length_read(text, &l) || !(l.m > 0 && l.m <= 1))
		return ob_fail(e, "--sweep tolerance=%s: expected a length above 0, at most 1 m, as .5mm", text);
	*out = l.m;
	return true;
}

static bool read_count(const char *knob, const char *text, uint32_t least, uint32_t most, uint32_t *out, ob_error *e)
{
	char *end;
	unsigned long v = strtoul(text, &end, 10);
	if (!*text || strspn(text, "0123456789") != strlen(text) || v < least || v > most)
		return ob_fail(e, "--sweep %s=%s: expected a whole number from %u to %u", knob, text, least, most);
	*out = (uint32_t)v;
	return true;
}

static bool add_value(ob_sweep *s, const char *knob, const char *text, ob_error *e)
{
	size_t *count = !strcmp(knob, "substeps")     ? &s->substeps
			: !strcmp(knob, "iterations") ? &s->iterations
			: !strcmp(knob, "tolerance")  ? &s->tolerances
			: !strcmp(knob, "lag")        ? &s->lags
						      : NULL;
	if (!count)
		return ob_fail(e, "--sweep %s: there are substeps, iterations, tolerance and lag, as in substeps=1,2,4",
			       knob);
	if (*count == OB_SWEEP_VALUES)
		return ob_fail(e, "--sweep %s: at most %d values", knob, OB_SWEEP_VALUES);
	size_t i = (*count)++;
	if (count == &s->substeps)
		return read_count(knob, text, 1, SUBSTEPS_MAX, &s->substeps_list[i], e);
	if (count == &s->iterations)
		return read_count(knob, text, 1, ITERATIONS_MAX, &s->iterations_list[i], e);
	if (count == &s->lags)
		return read_count(knob, text, 0, LAG_MAX, &s->lag_list[i], e);
	return read_length(text, &s->tolerance_list[i], e);
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
		.substeps = 6,
		.substeps_list = { 1, 2, 4, 8, 16, 32 }, // 60 Hz .. 1920 Hz
		.tolerances = 4,
		.tolerance_list = { 5e-3, 5e-4, 5e-5, 5e-6 },
		.lags = 5,
		.lag_list = { 0, 1, 2, 4, 8 },
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
	size_t substeps = s->substeps ? s->substeps : 1;
	size_t iterations = s->iterations && usual->iterations ? s->iterations : 1;
	for (size_t i = 0; i < substeps; i++) {
		for (size_t j = 0; j < iterations; j++) {
			ob_run_settings one = *usual;
			if (s->substeps) {
				one.substeps = s->substeps_list[i];
				one.tolerance = 0;
			}
			if (s->iterations && usual->iterations)
				one.iterations = s->iterations_list[j];
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
		for (size_t i = 0; i < sweep->lags; i++) {
			usual.lag = sweep->lag_list[i];
			add(&all, usual);
		}
		return all.count;
	}
	add(&all, usual);
	add_products(&all, sweep, &usual);
	for (size_t i = 0; i < sweep->lags && k->free; i++) {
		ob_run_settings one = usual;
		one.lag = sweep->lag_list[i];
		add(&all, one);
	}
	for (size_t i = 0; i < sweep->tolerances && strcmp(k->name, "obsim") == 0; i++) {
		ob_run_settings one = usual;
		one.substeps = 0;
		one.iterations = OB_DEFAULT_TOLERANCE_ITERATIONS;
		one.tolerance = sweep->tolerance_list[i];
		add(&all, one);
	}
	return all.count;
}
