#include "lab/lab.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab/scene.h"
#include "settings/settings.h"

#define CONSERVED(name, text) \
	{ \
		.key = name, .title = text, .unit = "1", .scale = 1, .target = NAN \
	}
#define FIGURE(n) \
	{ \
		.key = "figure" #n, .title = "figure " #n, .unit = "1", .scale = 1, .target = NAN \
	}
static const ob_metric metrics[OB_LAB_METRICS] = {
	[OB_LAB_CPU] = { .key = "cpu_s", .title = "CPU time of stepping", .unit = "s", .scale = 1, .target = NAN },
	[OB_LAB_WALL] = { .key = "wall_s", .title = "wall time of stepping", .unit = "s", .scale = 1, .target = NAN },
	[OB_LAB_BODY_SECONDS] = { .key = "bodies_times_simulated_s",
				  .title = "bodies times simulated time",
				  .unit = "s",
				  .scale = 1,
				  .target = NAN },
	[OB_LAB_CONSERVED + OB_CONSERVED_MOMENTUM] = CONSERVED("momentum_drift", "drift of momentum"),
	[OB_LAB_CONSERVED + OB_CONSERVED_ANGULAR] = CONSERVED("angular_momentum_drift", "drift of angular momentum"),
	[OB_LAB_CONSERVED + OB_CONSERVED_ENERGY] = CONSERVED("energy_gain", "gain of energy, net"),
	[OB_LAB_FIGURE] = FIGURE(1),
	FIGURE(2),
	FIGURE(3),
	FIGURE(4),
	FIGURE(5),
	FIGURE(6),
	FIGURE(7),
	FIGURE(8),
};

// Prints a number with as many digits as needed to read the same bits back.
static int print_exact(char *to, size_t room, const char *name, double v)
{
	char text[32];
	for (int digits = 6; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, v);
		if (strtod(text, NULL) == v)
			break;
	}
	return snprintf(to, room, " %s=%s", name, text);
}

void ob_lab_print_configuration(char *to, size_t room, const ob_engine_kind *k, const ob_run_settings *s)
{
	const struct {
		const char *name;
		double value;
	} parts[] = { { "substeps", s->substeps },
		      { "iterations", s->iterations },
		      { "tolerance", s->tolerance },
		      { "lag", s->lag } };
	size_t n = (size_t)snprintf(to, room, "%s", k->name);
	for (size_t i = 0; i < sizeof parts / sizeof *parts && n < room; i++)
		if (parts[i].value > 0)
			n += (size_t)print_exact(to + n, room - n, parts[i].name, parts[i].value);
}

bool ob_lab_read_configuration(const char *text, const ob_case *c, const ob_engine_kind **k, ob_run_settings *s,
			       ob_error *e)
{
	char copy[OB_CONFIGURATION_KEY];
	snprintf(copy, sizeof copy, "%s", text);
	char *rest = copy, *name = strsep(&rest, " ");
	*k = ob_engine_find(name);
	if (!*k)
		return ob_fail(e, "this program has no engine '%s'", name);
	*s = (*k)->usual;
	s->step_length = ob_case_step;
	s->tolerance = 0;
	s->substeps = s->iterations = s->lag = 0;
	for (char *word; (word = strsep(&rest, " "));) {
		char *value = strchr(word, '='), *end;
		double v = value ? strtod(value + 1, &end) : 0;
		if (!value || end == value + 1 || *end)
			return ob_fail(e, "'%s' is no configuration of an engine", text);
		*value = 0;
		if (!strcmp(word, "tolerance"))
			s->tolerance = v;
		else if (!strcmp(word, "substeps"))
			s->substeps = (uint32_t)v;
		else if (!strcmp(word, "iterations"))
			s->iterations = (uint32_t)v;
		else if (!strcmp(word, "lag"))
			s->lag = (uint32_t)v;
		else
			return ob_fail(e, "'%s' is no configuration of an engine", text);
	}
	return true;
}

// Meaning of the keys of a trial or a record.
typedef struct meaning {
	const ob_case *of;
	const ob_engine_kind *engine;
	ob_run_settings settings;
} meaning;

static bool find_meaning(const char *of, const char *configuration, meaning *m, ob_error *e)
{
	m->of = ob_case_find(of);
	if (!m->of)
		return ob_fail(e, "this program has no case '%s'", of);
	return ob_lab_read_configuration(configuration, m->of, &m->engine, &m->settings, e);
}

static bool run(const ob_trial *t, ob_record *out, ob_error *e)
{
	meaning m;
	ob_case_result o;
	if (!find_meaning(t->of, t->configuration, &m, e) || !ob_case_run(m.of, m.engine, &m.settings, &o, e))
		return false;
	out->metric[OB_LAB_CPU] = o.cpu_s;
	out->metric[OB_LAB_WALL] = o.wall_s;
	out->metric[OB_LAB_BODY_SECONDS] = o.body_seconds;
	for (int i = 0; i < OB_CONSERVED; i++)
		out->metric[OB_LAB_CONSERVED + i] = o.conserved[i];
	for (uint32_t i = 0; i < m.of->figures; i++)
		out->metric[OB_LAB_FIGURE + i] = o.figure[i];
	snprintf(out->reason, sizeof out->reason, "%s", o.failed);
	return true;
}

// True if it is finer, and nothing else is coarser.
static bool is_finer(const ob_trial *t, const ob_record *than)
{
	meaning a, b;
	if (!find_meaning(t->of, t->configuration, &a, NULL) ||
	    !find_meaning(than->of, than->configuration, &b, NULL) || a.engine != b.engine)
		return false;
	const ob_run_settings *s = &a.settings, *c = &b.settings;
	bool by_tolerance = s->tolerance > 0;
	return by_tolerance == (c->tolerance > 0) && s->iterations >= c->iterations &&
	       (by_tolerance ? s->tolerance < c->tolerance : s->substeps > c->substeps);
}

static int by_place(const ob_record *a, const ob_record *b)
{
	meaning m = { 0 }, n = { 0 };
	if (!find_meaning(a->of, a->configuration, &m, NULL) || !find_meaning(b->of, b->configuration, &n, NULL))
		return 0;
	return ob_result_order(&(ob_result){ .of = m.of, .engine = m.engine, .settings = m.settings },
			       &(ob_result){ .of = n.of, .engine = n.engine, .settings = n.settings });
}

// ---- columns of the file beside keys and metrics

enum { ROW, ENGINE, VERSION, STEP, SUBSTEPS, ITERATIONS, TOLERANCE, LAG, COST, FIGURES, COLUMNS };
static const char *const columns[COLUMNS] = { "row",         "engine",   "engine_version",
					      "step_s",      "substeps", "iterations",
					      "tolerance_m", "lag",      "cpu_s_per_body_and_simulated_s",
					      "figures" };

// Prints "1 worst penetration (mm, at most 0.5); 2 drift (mm)".
static void describe_figures(const ob_case *c, char *to, size_t room)
{
	size_t n = 0;
	for (uint32_t i = 0; i < c->figures && n < room; i++) {
		const ob_figure_def *def = &c->figure[i];
		n += (size_t)snprintf(to + n, room - n, "%s%u %s (%s", i ? "; " : "", i + 1, def->name, def->unit);
		if (n < room && isfinite(def->target))
			n += (size_t)snprintf(to + n, room - n, ", at most %g", def->target);
		if (n < room)
			n += (size_t)snprintf(to + n, room - n, ")");
	}
}

static void describe(const ob_record *r, size_t column, char *to, size_t room)
{
	meaning m;
	if (!find_meaning(r->of, r->configuration, &m, NULL))
		return;
	double cost = r->metric[OB_LAB_CPU] / r->metric[OB_LAB_BODY_SECONDS];
	const double number[COLUMNS] = { [ROW] = m.of->row,
					 [STEP] = m.settings.step_length,
					 [SUBSTEPS] = m.settings.substeps,
					 [ITERATIONS] = m.settings.iterations,
					 [TOLERANCE] = m.settings.tolerance,
					 [LAG] = m.settings.lag,
					 [COST] = cost };
	if (column == ENGINE)
		snprintf(to, room, "%s", m.engine->name);
	else if (column == VERSION)
		snprintf(to, room, "%s", m.engine->version);
	else if (column == FIGURES)
		describe_figures(m.of, to, room);
	else if (!isnan(number[column]))
		snprintf(to, room, column == STEP || column == COST ? "%.17g" : "%g", number[column]);
}

ob_experiment ob_lab_experiment(const char *commit, double limit)
{
	return (ob_experiment){ .name = "lab",
				.commit = commit,
				.metrics = OB_LAB_METRICS,
				.metric = metrics,
				.run = run,
				.limit_s = limit,
				.columns = COLUMNS,
				.column = columns,
				.describe = describe,
				.is_finer = is_finer,
				.order = by_place };
}

// ---- schedule

static uint32_t count_bodies(const ob_case *c)
{
	ob_world w;
	ob_error e;
	ob_scene *scene = ob_lab_scene_load(c, 0, &w, &e);
	const uint32_t bodies = scene ? w.objects : 0;
	ob_world_finish(&w);
	ob_scene_free(scene);
	return bodies;
}

// Time (s) of a case, assuming an engine that takes two microseconds for a substep of a body.
static double guess(const ob_case *c, uint32_t bodies, const ob_run_settings *s)
{
	static const double start = .02, body_substep = 2e-6;
	enum { SUBSTEPS_BY_TOLERANCE = 16 };
	return start + body_substep * bodies * ob_case_runs(c) * c->duration / s->step_length *
			       (s->substeps ? s->substeps : SUBSTEPS_BY_TOLERANCE);
}

bool ob_lab_schedule(const ob_lab_plan *p, ob_trials *to, ob_error *e)
{
	ob_run_settings *settings = calloc(OB_SWEEP_SETTINGS, sizeof *settings);
	bool fine = settings;
	for (size_t i = 0; fine && i < p->cases.count; i++) {
		const ob_case *c = p->cases.of[i];
		uint32_t bodies = count_bodies(c);
		size_t first = to->count;
		for (size_t j = 0; j < p->engines.count; j++) {
			size_t count = ob_sweep_settings(&p->sweep, c, p->engines.of[j], settings);
			for (size_t k = 0; fine && k < count; k++) {
				ob_trial t = { .guess_s = guess(c, bodies, &settings[k]) };
				snprintf(t.of, sizeof t.of, "%s", c->name);
				ob_lab_print_configuration(t.configuration, sizeof t.configuration, p->engines.of[j],
							   &settings[k]);
				fine = ob_trials_add(to, &t);
			}
		}
		fine = fine && ob_trials_repeat(to, first, p->repeats, OB_ORDER_SAME, false);
	}
	free(settings);
	return fine || ob_fail(e, "out of memory");
}

// ---- results

static ob_case_result outcome_of(const ob_case *c, const ob_record *r)
{
	bool measured = r->failure <= OB_FAILURE_OUTCOME;
	ob_case_result o = { .cpu_s = measured ? r->metric[OB_LAB_CPU] : r->took_cpu_s,
			     .wall_s = measured ? r->metric[OB_LAB_WALL] : r->took_s,
			     .body_seconds = r->metric[OB_LAB_BODY_SECONDS] };
	for (uint32_t i = 0; i < c->figures; i++)
		o.figure[i] = measured ? r->metric[OB_LAB_FIGURE + i] : INFINITY;
	for (int i = 0; i < OB_CONSERVED; i++)
		o.conserved[i] = r->metric[OB_LAB_CONSERVED + i];
	snprintf(o.failed, sizeof o.failed, "%.95s", r->reason);
	return o;
}

bool ob_lab_results(const ob_records *from, ob_results *to, ob_error *e)
{
	*to = (ob_results){ 0 };
	memcpy(to->machine, from->machine, sizeof to->machine);
	memcpy(to->commit, from->commit, sizeof to->commit);
	for (size_t i = 0; i < from->count; i++) {
		const ob_record *r = &from->record[i];
		meaning m;
		if (!find_meaning(r->of, r->configuration, &m, e))
			return false;
		ob_case_result o = outcome_of(m.of, r);
		ob_result one = { .of = m.of, .engine = m.engine, .settings = m.settings };
		ob_result *of = ob_results_find(to, m.of, m.engine, &m.settings);
		if (of) {
			ob_result_repeat(of, &o);
			continue;
		}
		ob_result_repeat(&one, &o);
		if (!ob_results_add(to, &one))
			return ob_fail(e, "out of memory");
	}
	return true;
}

// ---- sweep

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
