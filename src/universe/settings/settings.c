#include "settings/settings.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/random.h"

enum { SCENE = OB_SETTING_SCENE, OPTION = OB_SETTING_OPTION, ABOVE = OB_SETTING_ABOVE, OBJECTS = OB_SETTING_OBJECTS };

const ob_setting ob_setting_table[OB_SETTINGS] = {
#define X(id, name, kind, member, group, flags, least, most, form, help) \
	{ name, OB_SETTING_##kind, offsetof(ob_settings, member), OB_SETTING_##group, flags, least, most, form, help },
	OB_SETTING_LIST(X)
#undef X
};
_Static_assert(OB_SETTINGS <= 64, "each has a bit of ob_settings.given");
_Static_assert(offsetof(ob_settings, run) == 0, "offsets hold in ob_run_settings, too");

static const struct {
	const char *former, *now;
} renamed[] = { { "passes", "iterations" }, { "exchange", "solver" }, { "parts", "profile" } };

ob_fault_kind ob_fault_draw(const ob_fault_plan *p, uint32_t among, uint32_t worker, uint64_t chance, uint64_t *random)
{
	const uint32_t kinds = p->kinds & among;
	uint64_t state = p->seed;
	state = ob_splitmix(&state) + worker;
	state = ob_splitmix(&state) + chance;
	if (!kinds || ob_splitmix_real(&state) >= p->probability)
		return OB_FAULT_KINDS;
	uint32_t nth = (uint32_t)(ob_splitmix(&state) % (uint32_t)__builtin_popcount(kinds)), kind = 0;
	while (!(kinds >> kind & 1) || nth-- > 0)
		kind++;
	*random = state;
	return (ob_fault_kind)kind;
}

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

int ob_setting_by_name(const char *name)
{
	const char *now = ob_setting_renamed(name);
	for (int i = 0; i < OB_SETTINGS; i++)
		if (strcmp(ob_setting_table[i].name, now ? now : name) == 0)
			return i;
	return -1;
}

// Copies those of the first settings that a layer gives.
static void copy_given(void *to, const ob_settings *layer, int settings)
{
	static const size_t size[] = {
		[OB_SETTING_REAL] = sizeof(double),       [OB_SETTING_COUNT] = sizeof(uint32_t),
		[OB_SETTING_CHOICE] = sizeof(uint32_t),   [OB_SETTING_SWITCH] = sizeof(uint32_t),
		[OB_SETTING_TEXT] = sizeof(const char *),
	};
	for (int i = 0; i < settings; i++) {
		const ob_setting *t = &ob_setting_table[i];
		if (ob_setting_is_set(layer, i))
			memcpy((char *)to + t->offset, (const char *)layer + t->offset, size[t->kind]);
	}
}

void ob_settings_overlay(ob_settings *s, const ob_settings *layer)
{
	copy_given(s, layer, OB_SETTINGS);
	s->given |= layer->given;
}

void ob_run_settings_overlay(ob_run_settings *s, const ob_settings *layer)
{
	if (ob_setting_is_set(layer, OB_SETTING_TOLERANCE)) {
		s->substeps = ob_run_settings_least_substeps(layer->run.tolerance);
		s->iterations = OB_DEFAULT_TOLERANCE_ITERATIONS;
	} else if (ob_setting_is_set(layer, OB_SETTING_SUBSTEPS)) {
		s->tolerance = 0;
	}
	copy_given(s, layer, OB_RUN_SETTINGS);
}

// Rejects settings that a monolith does not support.
static bool check_monolith(const ob_settings *layer, ob_error *e)
{
	for (int i = 0; i < OB_SETTINGS; i++)
		if (ob_setting_is_set(layer, i) && ob_setting_table[i].flags & OBJECTS)
			return ob_fail(e, "--%s means nothing to --arch monolith", ob_setting_option(i).text);
	return true;
}

bool ob_run_settings_resolve(ob_run_settings *s, const ob_settings *layer, ob_error *e)
{
	static const ob_settings none;
	ob_run_settings asked = *s;
	layer = layer ? layer : &none;
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
		return ob_fail(e, "--set iterations=0 is ODE's exact solver, for --arch monolith; object simulators "
				  "take 1 at least");
	if (s->solver != OB_SOLVER_LAGGED) {
		if (ob_setting_is_set(layer, OB_SETTING_LAG))
			return ob_fail(e, "--set lag is for --set solver=lagged; this run's is %s",
				       ob_setting_print(s, OB_SETTING_SOLVER).text);
		s->lag = 0;
	}
	if (s->tolerance > 0 && s->integrator == OB_INTEGRATOR_ODE) {
		// With n substeps, ODE's stepper falls short by g H^2 / (2 n) in a step of length H.
		double short_by = .5 * ob_norm(s->gravity) * s->step_length * s->step_length;
		while (short_by / s->substeps > s->tolerance && 2 * s->substeps <= OB_MAX_SUBSTEPS)
			s->substeps *= 2;
		if (short_by / s->substeps > s->tolerance)
			return ob_fail(e,
				       "--set integrator=ode would need %.3g substeps to keep the tolerance of %g m, "
				       "and there "
				       "are %d at most: take a smaller --step or a larger --tolerance, or fix substeps "
				       "with --set",
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

static bool in_range(const ob_run_settings *s, ob_setting_id id)
{
	const ob_setting *t = &ob_setting_table[id];
	const char *at = (const char *)s + t->offset;
	const double value = t->kind == OB_SETTING_REAL ? *(const double *)at : *(const uint32_t *)at;
	if (t->kind == OB_SETTING_CHOICE || t->kind == OB_SETTING_SWITCH)
		return value < names_in(t->form);
	if (id == OB_SETTING_TOLERANCE && value == 0) // no tolerance
		return true;
	// ODE's stepper may need more substeps than a caller may request
	return value >= t->least && value <= (id == OB_SETTING_SUBSTEPS ? OB_MAX_SUBSTEPS : t->most);
}

bool ob_run_settings_check(const ob_run_settings *s, ob_error *e)
{
	const ob_vec3 g = s->gravity;
	if (!(fmax(fabs(g.x), fmax(fabs(g.y), fabs(g.z))) <= OB_GRAVITY_MOST) || isnan(g.x + g.y + g.z))
		return ob_fail(e, "gravity: expected up to %g m/s^2 along each axis, got %s, %s, %s", OB_GRAVITY_MOST,
			       ob_number_text(g.x).text, ob_number_text(g.y).text, ob_number_text(g.z).text);
	if (s->fault.probability != 0) // drawn anew
		return ob_fail(e, "a fault is asked for");
	for (int i = 0; i < OB_RUN_SETTINGS; i++)
		if (!in_range(s, (ob_setting_id)i))
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
	const char *names = ob_setting_table[id].form;
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

ob_setting_word ob_setting_option(ob_setting_id id)
{
	const ob_setting *t = &ob_setting_table[id];
	ob_setting_word word;
	snprintf(word.text, sizeof word.text, "%s%s", t->flags & OPTION ? "" : "set ", t->name);
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

// ---- length

bool ob_length_read(const char *text, ob_length *out)
{
	static const struct {
		const char *name;
		double metres;
	} units[] = { { "", 1 }, { "m", 1 }, { "cm", 1e-2 }, { "mm", 1e-3 }, { "um", 1e-6 }, { "nm", 1e-9 } };
	char *unit;
	const bool hexadecimal = text[0] == '0' && tolower((unsigned char)text[1]) == 'x';
	if (hexadecimal || (!isdigit((unsigned char)text[0]) && text[0] != '.'))
		return false; // nor a sign, a blank, nan or inf
	const double x = strtod(text, &unit);
	if (unit == text || !isfinite(x))
		return false;
	unit += strspn(unit, " ");
	*out = (ob_length){ .share = x / 100 };
	if (strcmp(unit, "%") == 0)
		return out->share > 0 && out->share <= 1;
	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcmp(unit, units[i].name) == 0) {
			*out = (ob_length){ .m = x * units[i].metres };
			return true;
		}
	return false;
}
