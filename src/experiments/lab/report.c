#include "lab/report.h"

#include <string.h>

#include "experiment/folder.h"
#include "experiment/json.h"
#include "lab/analysis.h"
#include "report_texts.h"

// ---- summary: the verdict, cost at equal error, all targets

static void write_card(ob_page *p, int part, int whole, const char *what)
{
	ob_page_markup(p, "<li><b>%d of %d</b><span>%s</span></li>\n", part, whole, what);
}

static void write_cards(ob_page *p, const void *with)
{
	const ob_lab_analysis *d = with;
	ob_lab_analysis_rows rows = ob_lab_analysis_count_rows(d);
	const ob_lab_analysis_lead l = ob_lab_analysis_measure_lead(d);
	if (rows.measured)
		write_card(p, rows.met, rows.measured,
			   "rows of hard cases: obsim meets every target, at 60 frames a second");
	size_t others = ob_lab_analysis_count_others(d), failed = 0, runs = 0;
	if (l.compared && others)
		write_card(p, l.ahead, l.compared, "cases: no other engine gets to the same error at less cost");
	for (size_t i = 0; i < d->results->count; i++) {
		runs++;
		failed += d->results->result[i].outcome.failed[0] != 0;
	}
	ob_page_markup(p, "<li><b>%zu</b><span>other engines, and %zu of obsim's couplings</span></li>\n", others,
		       d->engines - others);
	ob_page_markup(p, "<li><b>%zu</b><span>runs measured; %zu of them failed and are shown as such</span></li>\n",
		       runs, failed);
}

// Lists the rows with missed targets, so that they are easy to find.
static void write_missed(ob_page *p, const ob_lab_analysis *d)
{
	int missed = 0;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_lab_analysis_promised(d, *c);
		if (!r || ob_lab_analysis_meets_all(r))
			continue;
		ob_page_markup(p, "%s<a href=\"#%s\">", missed++ ? ", " : "<strong>Missed:</strong> ", (*c)->name);
		ob_page_text(p, (*c)->title);
		ob_page_markup(p, "</a>");
	}
	ob_page_markup(p, "%s", missed ? ". " : "No target is missed. ");
}

static void write_verdict(ob_page *p, const void *with)
{
	const ob_lab_analysis *d = with;
	const ob_lab_analysis_lead l = ob_lab_analysis_measure_lead(d);
	if (!d->own) {
		ob_page_markup(p, "obsim itself did not take part in these runs.");
		return;
	}
	write_missed(p, d);
	if (l.compared > l.ahead && ob_lab_analysis_count_others(d))
		ob_page_markup(p,
			       "Of the %d cases where another engine is cheaper at equal error, obsim is within twice "
			       "its cost in %d.",
			       l.compared - l.ahead, l.within);
}

static void write_equal(ob_page *p, const void *with)
{
	ob_table_html(ob_lab_table_equal(with, true, false), p);
	ob_page_markup(
		p,
		"<p class=\"note\">\u00b5s of CPU per body and simulated second; small: over obsim\u2019s. * No engine "
		"gets to the target: the error is obsim\u2019s least. \u201cnever\u201d: no setting that was tried "
		"gets there without failing. Variants of obsim\u2019s coupling are shown, but not ranked.</p>\n");
}

static void write_rows(ob_page *p, const void *with)
{
	ob_table_html(ob_lab_table_rows(with), p);
}

static void write_conserved(ob_page *p, const void *with)
{
	ob_table_html(ob_lab_table_conserved(with), p);
}

static void write_audit(ob_page *p, const void *with)
{
	ob_table *t = ob_lab_table_audit(with);
	if (!t)
		return;
	ob_page_markup(p, "<h2 id=\"audit\">Does the error fall?</h2>\n<p>obsim\u2019s errors over their targets, the "
			  "worst of each case, as its tolerance shrinks and as its substeps grow, and the order at "
			  "which they fall with the length of a substep. RISES: an error that is above its target is "
			  "larger at a finer setting; <code>audit.md</code> says which.</p>\n");
	ob_table_html(t, p);
}

static void write_promises(ob_page *p, const void *with)
{
	ob_chart_html(ob_lab_chart_promises(with), p, "");
}

// Writes a section's chart, below its heading and text unless an earlier one has them. Returns true if there is any so far.
static bool write_section(ob_page *p, bool begun, ob_chart *chart, const char *id, const char *title, const char *text)
{
	if (chart && !begun)
		ob_page_markup(p, "<h2 id=\"%s\">%s</h2>\n<p>%s</p>\n", id, title, text);
	begun |= chart != NULL;
	ob_chart_html(chart, p, "");
	return begun;
}

static void write_convergence(ob_page *p, const void *with)
{
	static const char *const cases[] = { "stack-10", "pile", "sliding" };
	bool begun = false;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const ob_case *c = ob_case_find(cases[i]);
		begun = write_section(p, begun, c ? ob_lab_chart_convergence(with, c) : NULL, "order",
				      "Order of convergence",
				      "Gain of doubling the substeps. An error of first order halves, one of second "
				      "order falls to a quarter; the observed order stands beside each name.");
	}
}

static void write_ghost(ob_page *p, const void *with)
{
	write_section(p, false, ob_lab_chart_ghost(with), "ghost", "Why neighbours must not be ghosts",
		      "The first thing that comes to mind when every body is a simulator of its own: treat each "
		      "neighbour as a body that nothing can move. Then both sides answer a hit with the whole of it, "
		      "momentum is not kept, and energy comes from nowhere. (Where bodies touch nothing but the ground "
		      "it makes no difference.) obsim can do so (<code>coupling=ghost</code>) only to show it.");
}

static void write_lag(ob_page *p, const void *with)
{
	write_section(p, false, ob_lab_chart_lag(with), "late", "Why partners must not be read late",
		      "Two bodies hit each other, each in its own simulator, and each works with a state of the other "
		      "that is some iterations old. Momentum is exact only where both sides see the same.");
}

static void write_free(ob_page *p, const void *with)
{
	bool begun = false;
	for (const ob_case *const *c = ob_cases; *c; c++)
		begun = write_section(p, begun, ob_lab_chart_delay(with, *c), "free", "Simulators that wait for nobody",
				      "Free simulators have times of their own. Their error over the delay after which "
				      "a neighbour sees what they publish; the error over the rate of their steps "
				      "stands with each case, lockstep beside it. Each side of a contact computes its "
				      "own response. Two runs of one setting differ.");
}

static void write_index(ob_page *p, const void *with)
{
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!ob_lab_analysis_next(with, *c, NULL, NULL))
			continue;
		ob_page_markup(p, "<li><a href=\"#%s\">", (*c)->name);
		ob_page_text(p, (*c)->title);
		ob_page_markup(p, "</a></li>\n");
	}
}

// ---- one case

static void write_case(ob_page *p, const ob_lab_analysis *d, const ob_case *c)
{
	const ob_result *promised = ob_lab_analysis_promised(d, c);
	const bool met = promised && ob_lab_analysis_meets_all(promised);
	ob_page_markup(p, "<section id=\"%s\">\n<h3>", c->name);
	ob_page_text(p, c->title);
	ob_page_markup(p, " ");
	if (promised)
		ob_page_markup(p, "<span class=\"badge %s\">%s</span>", met ? "met" : "missed", met ? "met" : "missed");
	ob_page_markup(p, "</h3>\n");
	ob_page_paragraph(p, "", c->setup);
	ob_page_markup(p, "<dl>\n<dt>Compared with</dt><dd>");
	for (uint32_t i = 0; i < c->figures; i++) {
		ob_page_markup(p, i ? "<br>" : "");
		ob_page_text(p, c->figure[i].name);
		ob_page_markup(p, ": ");
		ob_page_text(p, c->figure[i].reference);
	}
	ob_page_markup(p, "</dd>\n");
	ob_page_term(p, "Known of other engines", c->others ? c->others : "not measured elsewhere");
	ob_page_markup(p, "</dl>\n");
	ob_table_html(ob_lab_table_engines(d, c), p);
	// error over cost, or over delay in the case of late partners
	ob_chart_html(c == ob_case_find("lag") ? ob_lab_chart_lag(d) : ob_lab_chart_cost(d, c), p, "");
	ob_page_markup(p, "<details>\n<summary>All runs of this case</summary>\n");
	ob_table_html(ob_lab_table_runs(d, c), p);
	ob_page_markup(p, "</details>\n</section>\n");
}

static void write_all_cases(ob_page *p, const void *with)
{
	for (const ob_case *const *c = ob_cases; *c; c++)
		if (ob_lab_analysis_next(with, *c, NULL, NULL))
			write_case(p, with, *c);
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_lab_analysis *d = with;
	ob_page_term(p, "Machine", d->results->machine);
	ob_page_markup(p, "<dt>obsim</dt><dd>commit <code>%s</code></dd>\n", d->results->commit);
	for (size_t i = 0; i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		ob_page_markup(p, "<dt>");
		ob_page_text(p, k->title);
		ob_page_markup(p, "</dt><dd><code>");
		ob_page_text(p, k->name);
		ob_page_markup(p, "</code>%s", *k->version ? " " : "");
		ob_page_text(p, k->version);
		ob_page_markup(p, "; usual: %u step%s a frame", k->usual.substeps, k->usual.substeps == 1 ? "" : "s");
		if (k->usual.iterations)
			ob_page_markup(p, ", %u %s", k->usual.iterations,
				       ob_lab_analysis_is_obsim(k) ? "iterations at most" : "solver iterations");
		ob_page_markup(p, "</dd>\n");
	}
}

// ---- the files

typedef struct file {
	const char *name;
	void (*print)(FILE *f, const ob_lab_analysis *d, bool markdown);
	const ob_lab_analysis *analysis;
} file;

static void write_file(FILE *f, const void *with)
{
	const file *of = with;
	of->print(f, of->analysis, true);
}

bool ob_lab_report(const ob_results *r, const char *dir, ob_error *e)
{
	static const ob_page_slot slots[] = {
		{ "cards", write_cards },     { "verdict", write_verdict }, { "promises", write_promises },
		{ "equal", write_equal },     { "rows", write_rows },       { "conserved", write_conserved },
		{ "audit", write_audit },     { "ghost", write_ghost },     { "convergence", write_convergence },
		{ "lag", write_lag },         { "free", write_free },       { "index", write_index },
		{ "cases", write_all_cases }, { "setting", write_setting }
	};
	const ob_report report = { "obsim: accuracy, and speed against error", "", text_lab_html, slots,
				   sizeof slots / sizeof *slots };
	ob_lab_analysis d = ob_lab_analyse(r);
	const file files[] = { { "rows.md", ob_lab_print_rows, &d },
			       { "conserved.md", ob_lab_print_conserved, &d },
			       { "audit.md", ob_lab_print_audit, &d },
			       { "equal.md", ob_lab_print_equal, &d },
			       { "equal.csv", ob_lab_print_equal_csv, &d } };
	bool fine = ob_folder_make(dir, e);
	for (size_t i = 0; fine && i < sizeof files / sizeof *files; i++)
		fine = ob_folder_write(dir, files[i].name, write_file, &files[i], e);
	return fine && ob_report_write(&report, dir, &d, e);
}

// ---- json

static void put_settings(ob_json *j, const ob_run_settings *s)
{
	ob_json_open(j, "settings");
	ob_json_number(j, "step_s", s->step_length);
	ob_json_count(j, "substeps", s->substeps);
	ob_json_count(j, "iterations", s->iterations);
	ob_json_number(j, "tolerance_m", s->tolerance);
	ob_json_count(j, "lag", s->lag);
	ob_json_true(j, "sleeping", s->sleeping);
	ob_json_close(j);
}

static void put_figures(ob_json *j, const ob_result *r)
{
	ob_json_open_list(j, "figures");
	for (uint32_t i = 0; i < r->of->figures; i++) {
		const ob_figure_def *def = &r->of->figure[i];
		ob_json_open(j, NULL);
		ob_json_string(j, "name", def->name);
		ob_json_number(j, "value", r->outcome.figure[i]);
		ob_json_string(j, "unit", def->unit);
		ob_json_number(j, "target", def->target);
		if (ob_lab_analysis_has_target(r->of, i))
			ob_json_true(j, "met", ob_lab_analysis_meets(r, i));
		else
			ob_json_null(j, "met");
		ob_json_close(j);
	}
	ob_json_close_list(j);
}

static void put_conserved(ob_json *j, const ob_result *r)
{
	ob_json_open_list(j, "conserved");
	for (ob_conserved i = 0; i < OB_CONSERVED; i++) {
		ob_json_open(j, NULL);
		ob_json_string(j, "name", ob_conserved_kinds[i].title);
		ob_json_number(j, "value", r->outcome.conserved[i]);
		ob_json_number(j, "bound", ob_conserved_kinds[i].bound);
		ob_json_close(j);
	}
	ob_json_close_list(j);
}

static void put_result(ob_json *j, const ob_result *r)
{
	ob_json_open(j, NULL);
	ob_json_string(j, "case", r->of->name);
	ob_json_count(j, "row", (uint64_t)r->of->row);
	ob_json_string(j, "title", r->of->title);
	ob_json_string(j, "engine", r->engine->name);
	ob_json_string(j, "engine_version", r->engine->version);
	put_settings(j, &r->settings);
	ob_json_count(j, "repeats", r->repeats);
	ob_json_number(j, "cpu_s", r->outcome.cpu_s);
	ob_json_number(j, "wall_s", r->outcome.wall_s);
	ob_json_number(j, "bodies_times_simulated_s", r->outcome.body_seconds);
	ob_json_number(j, "cpu_s_per_body_and_simulated_s", ob_result_cost(r));
	ob_json_text(j, "failed", r->outcome.failed);
	put_figures(j, r);
	put_conserved(j, r);
	ob_json_close(j);
}

static void put_equal(ob_json *j, const ob_lab_analysis *d, const ob_case *c)
{
	ob_lab_analysis_equal q = ob_lab_analysis_compare(d, c);
	ob_json_open(j, NULL);
	ob_json_string(j, "case", c->name);
	ob_json_number(j, "error", q.error);
	ob_json_string(j, "unit", c->figure[0].unit);
	ob_json_true(j, "error_is_target", q.is_target);
	ob_json_true(j, "obsim_ahead", q.ahead);
	ob_json_open(j, "cpu_s_per_body_and_simulated_s");
	for (size_t i = 0; i < d->engines; i++)
		ob_json_number(j, d->engine[i]->name, q.cost[i]);
	ob_json_close(j);
	ob_json_close(j);
}

void ob_lab_write_json(const ob_results *r, const char *version, FILE *f)
{
	ob_json j = { .f = f };
	ob_lab_analysis d = ob_lab_analyse(r);
	ob_json_open(&j, NULL);
	ob_json_string(&j, "version", version);
	ob_json_string(&j, "commit", r->commit);
	ob_json_string(&j, "machine", r->machine);
	ob_json_open_list(&j, "results");
	for (size_t i = 0; i < r->count; i++)
		put_result(&j, &r->result[i]);
	ob_json_close_list(&j);
	ob_json_open_list(&j, "cost_at_equal_error");
	for (const ob_case *const *c = ob_cases; *c; c++)
		if ((*c)->compared && ob_lab_analysis_next(&d, *c, NULL, NULL))
			put_equal(&j, &d, *c);
	ob_json_close_list(&j);
	ob_json_close(&j);
}
