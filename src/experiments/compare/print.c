// Comparison as text and as JSON.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "compare/compare.h"
#include "experiment/json.h"
#include "experiment/process.h"
#include "experiment/table.h"

enum { HASH_DIGITS = 8 };

void ob_comparison_print_runs(const ob_comparison *c, char *to, size_t room)
{
	int n = snprintf(to, room, "%" PRIu32 " run%s of each", c->repeats, c->repeats == 1 ? "" : "s");
	if (c->seeds > 1)
		snprintf(to + n, room - (size_t)n, " of %" PRIu32 " seeds", c->seeds);
}

// ---- the table

static const char *between = " – "; // the ends of an interval

// Adds a row for the configurations listed, if at least one has the metric.
static void add_metric(ob_table *t, const ob_comparison *c, const ob_sweep_point *p, const int *id, int n,
		       ob_compare_metric metric, bool intervals)
{
	const ob_metric *m = &ob_compare_metric_table[metric];
	bool unit = strcmp(m->unit, "1") != 0, several = false, interval = false;
	ob_table_add(t, "  %s%s%s", m->title, unit ? ", " : "", unit ? m->unit : "");
	for (int i = 0; i < n; i++) {
		ob_estimate x = ob_comparison_spread(c, p, id[i], metric);
		const ob_word low = ob_word_number(x.low * m->scale), high = ob_word_number(x.high * m->scale);
		ob_table_add(t, "%s", ob_word_number(x.value * m->scale).text);
		if (intervals && !isnan(x.low) && strcmp(low.text, high.text) != 0)
			ob_table_small(t, "%s%s%s", low.text, between, high.text);
		several |= x.n > 1;
		interval |= x.interval;
	}
	if (metric != OB_COMPARE_COST || intervals || !several)
		return;
	ob_table_add(t, interval ? "    interval of 95 %%" : "    least to most");
	for (int i = 0; i < n; i++) {
		ob_estimate x = ob_comparison_spread(c, p, id[i], metric);
		ob_table_add(t, "%s–%s", ob_word_number(x.low * m->scale).text, ob_word_number(x.high * m->scale).text);
	}
}

static bool is_known(const ob_comparison *c, const ob_sweep_point *p, ob_compare_metric m)
{
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (!isnan(ob_comparison_spread(c, p, w, m).value))
			return true;
	return false;
}

// Final state of the first seed; "" = not run.
static const char *state_of(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id)
{
	for (uint32_t r = 0; r < c->repeats; r++) {
		const ob_record *one = ob_records_find(&c->records, p->key, ob_configuration_table[id].key, r, p->seed);
		if (one)
			return one->note;
	}
	return "";
}

ob_table *ob_comparison_table(const ob_comparison *c, const ob_sweep_point *p, bool intervals)
{
	char align[OB_CONFIGURATIONS + 2] = "l";
	int id[OB_CONFIGURATIONS], n = 0;
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (ob_comparison_is_done(c, p, w))
			id[n++] = w;
	memset(align + 1, 'r', (size_t)n);
	if (!n)
		return NULL;
	ob_table *t = ob_table_new(align);
	ob_table_add(t, "%s", "");
	for (int i = 0; i < n; i++)
		ob_table_add(t, "%s", ob_configuration_table[id[i]].title);
	ob_table_add(t, "  narrow phase");
	for (int i = 0; i < n; i++)
		ob_table_add(t, "%s", ob_configuration_table[id[i]].other_narrow ? c->other : c->narrow);
	ob_table_add(t, "  workers");
	for (int i = 0; i < n; i++)
		ob_table_add(t, "%" PRIu32, p->workers[id[i]]);
	const char *group = NULL, *shown = NULL;
	for (int m = 0; m < OB_COMPARE_SHOWN; m++) {
		group = ob_compare_metric_table[m].group ? ob_compare_metric_table[m].group : group;
		if (!is_known(c, p, m))
			continue;
		if (group != shown)
			ob_table_heading(t, "%s", group);
		shown = group;
		add_metric(t, c, p, id, n, m, intervals);
	}
	ob_table_add(t, "  state after it");
	for (int i = 0; i < n; i++)
		ob_table_add(t, "%.*s", HASH_DIGITS, state_of(c, p, id[i]));
	return t;
}

ob_table *ob_comparison_prices(const ob_comparison *c, const ob_sweep_point *p)
{
	ob_table *t = NULL;
	for (int w = 0; w < OB_CONFIGURATIONS; w++) {
		const ob_configuration_id without = ob_configuration_without(w);
		if (without == OB_CONFIGURATIONS || !ob_comparison_is_done(c, p, w) ||
		    !ob_comparison_is_done(c, p, without))
			continue;
		if (!t) {
			t = ob_table_new("llrr");
			ob_table_row(t, "What containment costs", "over", "CPU", "wall", NULL);
		}
		ob_table_add(t, "  %s", ob_configuration_table[w].title);
		ob_table_add(t, "%s", ob_configuration_table[without].title);
		for (int m = OB_COMPARE_CPU; m >= OB_COMPARE_WALL; m--) {
			ob_estimate r = ob_comparison_ratio(c, p, w, without, m);
			ob_table_add(t, "%.2f", r.value);
			if (!isnan(r.low))
				ob_table_small(t, "%.2f%s%.2f", r.low, between, r.high);
		}
	}
	return t;
}

// ---- the text

bool ob_comparison_left_out(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id,
			    const char *skipped, char *to, size_t room)
{
	const char *failed = ob_comparison_failure(c, p, id);
	snprintf(to, room, "%s: %s: %s", ob_configuration_table[id].title, failed ? "failed" : skipped,
		 failed ? failed : p->skipped[id]);
	return failed || *p->skipped[id];
}

static void print_point(const ob_comparison *c, const ob_sweep_point *p, FILE *f, size_t width)
{
	ob_verdict v;
	char line[640], runs[64];
	ob_verdict_make(&v, c, p);
	snprintf(line, sizeof line, "Thread or process? %s", *v.headline ? v.headline : "Not measured.");
	const char *const said[] = { line,
				     v.answer,
				     v.architecture,
				     v.narrow,
				     v.sum,
				     ob_comparison_agrees(c, p) ? "The object simulators end in the same bits."
								: "The object simulators DIFFER in their last state." };
	for (size_t i = 0; i < sizeof said / sizeof *said; i++)
		ob_word_wrap(f, "", said[i], width);
	ob_comparison_print_runs(c, runs, sizeof runs);
	snprintf(line, sizeof line, "%.300s%s%s: %" PRIu32 " objects, %" PRIu64 " steps of %g s, %g s simulated; %s%s",
		 c->scene, *p->define ? " " : "", p->define, p->objects, p->steps, p->step, p->simulated, runs,
		 c->repeats * c->seeds > 1 ? "; medians" : "");
	ob_utf8_make_plain(line); // file names may contain anything
	fputc('\n', f);
	ob_word_wrap(f, "", line, width);
	fputc('\n', f);
	ob_table_print(ob_comparison_table(c, p, false), f, width);
	ob_table *prices = ob_comparison_prices(c, p);
	if (prices)
		fputc('\n', f);
	ob_table_print(prices, f, width);
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (ob_comparison_left_out(c, p, w, "skipped", line, sizeof line))
			ob_word_wrap(f, "", line, width);
}

void ob_comparison_print(const ob_comparison *c, FILE *f, size_t width)
{
	for (uint32_t i = 0; i < c->points; i++) {
		if (i > 0)
			fputs("\n\n", f);
		print_point(c, &c->point[i], f, width);
	}
}

// ---- JSON

static void write_spread(const char *key, ob_estimate x, ob_json *j)
{
	ob_json_open(j, key);
	ob_json_number(j, "median", x.value);
	ob_json_number(j, "low", x.low);
	ob_json_number(j, "high", x.high);
	ob_json_count(j, "runs", x.n);
	ob_json_close(j);
}

static void write_price(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_json *j)
{
	const ob_configuration_id without = ob_configuration_without(id);
	if (without == OB_CONFIGURATIONS || !ob_comparison_is_done(c, p, id) || !ob_comparison_is_done(c, p, without))
		return;
	ob_json_open(j, ob_configuration_table[id].key);
	ob_json_string(j, "over", ob_configuration_table[without].key);
	write_spread("cpu", ob_comparison_ratio(c, p, id, without, OB_COMPARE_CPU), j);
	write_spread("wall", ob_comparison_ratio(c, p, id, without, OB_COMPARE_WALL), j);
	ob_json_close(j);
}

static void write_metrics(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_json *j)
{
	ob_json_open(j, "metrics");
	for (int m = 0; m < OB_COMPARE_SHOWN; m++)
		write_spread(ob_compare_metric_table[m].key, ob_comparison_spread(c, p, id, m), j);
	ob_json_close(j);
}

static void write_sample(const ob_record *r, ob_json *j)
{
	ob_json_open(j, NULL);
	ob_json_count(j, "repeat", r->repeat);
	ob_json_count(j, "seed", r->seed);
	ob_json_string(j, "state_hash", r->note);
	for (int m = 0; m < OB_COMPARE_METRICS; m++)
		if (!isnan(r->metric[m]))
			ob_json_number(j, ob_compare_metric_table[m].key, r->metric[m]);
	ob_json_close(j);
}

static void write_command(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_json *j)
{
	char **argv = ob_comparison_arguments(c, p, id, OB_COMPARE_SAMPLE, false, p->seed);
	ob_json_open_list(j, "command");
	for (char **at = argv; at && *at; at++)
		ob_json_string(j, NULL, *at);
	ob_json_close_list(j);
	ob_program_free_arguments(argv);
}

static void write_configuration(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_json *j)
{
	const ob_configuration *w = &ob_configuration_table[id];
	ob_json_open(j, w->key);
	ob_json_string(j, "narrow", w->other_narrow ? c->other : c->narrow);
	ob_json_count(j, "workers", p->workers[id]);
	write_command(c, p, id, j);
	write_metrics(c, p, id, j);
	ob_json_open_list(j, "samples");
	for (size_t i = 0; i < c->records.count; i++) {
		const ob_record *r = &c->records.record[i];
		if (!strcmp(r->of, p->key) && !strcmp(r->configuration, w->key))
			write_sample(r, j);
	}
	ob_json_close_list(j);
	ob_json_close(j);
}

static void write_point(const ob_comparison *c, const ob_sweep_point *p, ob_json *j)
{
	ob_verdict v;
	ob_verdict_make(&v, c, p);
	ob_json_open(j, NULL);
	ob_json_string(j, "define", p->define);
	ob_json_count(j, "objects", p->objects);
	ob_json_count(j, "steps", p->steps);
	ob_json_count(j, "seed", p->seed);
	ob_json_true(j, "hashes_agree", ob_comparison_agrees(c, p));
	ob_json_string(j, "headline", v.headline);
	ob_json_string(j, "answer", v.answer);
	ob_json_open(j, "configurations");
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (ob_comparison_is_done(c, p, w))
			write_configuration(c, p, w, j);
	ob_json_close(j);
	ob_json_open(j, "prices");
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		write_price(c, p, w, j);
	ob_json_close(j);
	ob_json_open(j, "skipped");
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (*p->skipped[w])
			ob_json_string(j, ob_configuration_table[w].key, p->skipped[w]);
	ob_json_close(j);
	ob_json_open(j, "failed");
	for (int w = 0; w < OB_CONFIGURATIONS; w++)
		if (ob_comparison_failure(c, p, w))
			ob_json_string(j, ob_configuration_table[w].key, ob_comparison_failure(c, p, w));
	ob_json_close(j);
	ob_json_close(j);
}

void ob_comparison_write_json(const ob_comparison *c, FILE *f)
{
	ob_json j = { .f = f };
	ob_json_open(&j, NULL);
	ob_json_string(&j, "scene", c->scene);
	ob_json_string(&j, "options", c->options);
	ob_json_string(&j, "commit", c->records.commit);
	ob_json_string(&j, "machine", c->records.machine);
	ob_json_count(&j, "repeats", c->repeats);
	ob_json_count(&j, "seeds", c->seeds);
	ob_json_open_list(&j, "points");
	for (uint32_t i = 0; i < c->points; i++)
		write_point(c, &c->point[i], &j);
	ob_json_close_list(&j);
	ob_json_close(&j);
}

// ---- verdict

// Verdict of a comparison, by rules: it depends on the runs alone.

enum { runs_least = 3 }; // fewer are inconclusive
static const double alike = .05; // ratios within this of 1 count as no difference

// Median of a metric with its unit.
static ob_word value(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id, ob_compare_metric m)
{
	return ob_word_metric(ob_comparison_spread(c, p, id, m).value, &ob_compare_metric_table[m]);
}

// " (0.98 to 1.02)"; empty for a single run.
static ob_word range(ob_estimate r)
{
	ob_word to = { "" };
	if (!isnan(r.low))
		OB_SAY(to.text, " (%.2f to %.2f)", r.low, r.high);
	return to;
}

static ob_estimate cost_over_pool(const ob_comparison *c, const ob_sweep_point *p, ob_configuration_id id)
{
	return ob_comparison_ratio(c, p, id, OB_CONFIGURATION_THREADS, OB_COMPARE_COST);
}

// Names the cheaper of the two pools, if any, and compares it with a worker per object.
static void write_headline(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	ob_estimate r = cost_over_pool(c, p, OB_CONFIGURATION_PROCESSES);
	ob_estimate each = cost_over_pool(c, p, OB_CONFIGURATION_THREADS_EACH);
	if (isnan(r.value))
		return;
	if (r.n < runs_least) {
		OB_SAY(v->headline, "Undecided after so few runs: use --repeats 6.");
		return;
	}
	if (r.low > 1 + alike)
		OB_SAY(v->headline, "Threads");
	else if (r.high < 1 - alike)
		OB_SAY(v->headline, "Processes");
	else
		OB_SAY(v->headline, "Either: they cost the same");
	if (each.low > 1 + alike)
		OB_SAY(v->headline, "; but let objects share them: one for each object costs %.1f times as much.",
		       each.value);
	else
		OB_SAY(v->headline, ".");
}

static void compare_pools(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id threads = OB_CONFIGURATION_THREADS, processes = OB_CONFIGURATION_PROCESSES;
	ob_estimate r = cost_over_pool(c, p, processes);
	if (isnan(r.value)) {
		OB_SAY(v->answer, "One of the two pools did not run. ");
		return;
	}
	OB_SAY(v->answer, "A pool of processes takes %.2f times the CPU of a pool of threads%s. ", r.value,
	       range(r).text);
	OB_SAY(v->answer, "Threads start in %s and need %s of memory, processes %s and %s. ",
	       value(c, p, threads, OB_COMPARE_STARTUP).text, value(c, p, threads, OB_COMPARE_MEMORY).text,
	       value(c, p, processes, OB_COMPARE_STARTUP).text, value(c, p, processes, OB_COMPARE_MEMORY).text);
}

static void compare_worker_counts(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	static const struct {
		ob_configuration_id id;
		const char *what;
	} counts[] = { { OB_CONFIGURATION_GROUPS, "Process groups of 60, which confine a crash, cost" },
		       { OB_CONFIGURATION_THREADS_EACH, "A thread for each object costs" },
		       { OB_CONFIGURATION_PROCESSES_EACH, "A process for each object costs" } };
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		const ob_estimate r = cost_over_pool(c, p, counts[i].id);
		if (!isnan(r.value))
			OB_SAY(v->answer, "%s %.2f times the thread pool%s. ", counts[i].what, r.value, range(r).text);
	}
}

static void compare_architectures(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	const ob_configuration_id pool = OB_CONFIGURATION_THREADS, monolith = OB_CONFIGURATION_MONOLITH;
	ob_estimate r = ob_comparison_ratio(c, p, pool, monolith, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	OB_SAY(v->architecture,
	       "One world or many? Object simulators in the thread pool take %.2f times the CPU of the monolith%s; the "
	       "deepest penetration is %s, in the monolith %s.",
	       r.value, range(r).text, value(c, p, pool, OB_COMPARE_WORST).text,
	       value(c, p, monolith, OB_COMPARE_WORST).text);
}

static void compare_narrow_phases(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p,
				  ob_configuration_id aabb, ob_configuration_id obb, const char *who)
{
	ob_estimate r = ob_comparison_ratio(c, p, aabb, obb, OB_COMPARE_COST);
	if (isnan(r.value))
		return;
	OB_SAY(v->narrow,
	       "In the %s boxes along the axes take %.2f times the CPU of true shapes%s; they leave contacts %s apart "
	       "(%s), penetrate by %s at most (%s). ",
	       who, r.value, range(r).text, value(c, p, aabb, OB_COMPARE_SEPARATION).text,
	       value(c, p, obb, OB_COMPARE_SEPARATION).text, value(c, p, aabb, OB_COMPARE_WORST).text,
	       value(c, p, obb, OB_COMPARE_WORST).text);
}

static void explain_time(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	double least = INFINITY;
	const char *where = "";
	for (int w = 0; w < OB_CONFIGURATIONS; w++) {
		ob_estimate r = ob_comparison_spread(c, p, w, OB_COMPARE_EXPLAINED);
		double share = fmin(r.value, r.low); // low is NaN for a single run
		if (share < least) {
			least = share;
			where = ob_configuration_table[w].title;
		}
	}
	if (isfinite(least))
		OB_SAY(v->sum,
		       "Work, waiting for a core, at the gate and for the host account for at least %.1f %% of the "
		       "workers' time (%s).",
		       100 * least, where);
}

void ob_verdict_make(ob_verdict *v, const ob_comparison *c, const ob_sweep_point *p)
{
	static const struct {
		ob_configuration_id own, other;
		const char *who;
	} pairs[] = { { OB_CONFIGURATION_THREADS, OB_CONFIGURATION_THREADS_OTHER, "thread pool" },
		      { OB_CONFIGURATION_MONOLITH, OB_CONFIGURATION_MONOLITH_OTHER, "monolith" } };
	bool obb_first = strcmp(c->narrow, "obb") == 0;
	memset(v, 0, sizeof *v);
	write_headline(v, c, p);
	compare_pools(v, c, p);
	compare_worker_counts(v, c, p);
	compare_architectures(v, c, p);
	for (int i = 0; i < 2; i++)
		compare_narrow_phases(v, c, p, obb_first ? pairs[i].other : pairs[i].own,
				      obb_first ? pairs[i].own : pairs[i].other, pairs[i].who);
	explain_time(v, c, p);
}
