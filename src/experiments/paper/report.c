#include "paper/paper.h"

#include <math.h>

#include "experiment/page.h"
#include "experiment/folder.h"
#include "experiment/json.h"
#include "experiment/table.h"
#include "paper/claims.h"
#include "paper_texts.h"

enum { COLUMNS = 6 };

// Measured results, the paper's, and verdicts.
typedef struct model {
	const ob_paper_results *here;
	ob_paper_results paper;
	ob_paper_claim claim[OB_PAPER_CLAIMS];
} model;

// ---- tables: 1 to 5 of the paper with ours beside them, then scenarios that it never ran

typedef struct table_plan {
	const char *id, *title;
	ob_paper_scenario scenario;
	size_t columns;
	struct {
		const char *head;
		bool paper; // as printed in the paper; otherwise measured here
		ob_paper_metric metric;
	} column[COLUMNS];
} table_plan;

#define PAPER(head, metric) \
	{ \
		head, true, metric \
	}
#define HERE(head, metric) \
	{ \
		head, false, metric \
	}
#define THREE_COLUMNS \
	PAPER("runtime, paper", OB_PAPER_STEP), HERE("runtime", OB_PAPER_STEP), PAPER("frames, paper", OB_PAPER_FPS), \
		HERE("frames", OB_PAPER_FPS), PAPER("CPU, paper", OB_PAPER_CPU), HERE("CPU", OB_PAPER_CPU)
#define RUNTIME_COLUMNS \
	HERE("step", OB_PAPER_STEP), HERE("all simulators", OB_PAPER_TOTAL), HERE("one simulator", OB_PAPER_ONE)

static const table_plan tables[] = {
	{ "table-1", "Table 1. The common environment (scenario 1)", OB_PAPER_COMMON, 6, { THREE_COLUMNS } },
	{ "table-2",
	  "Table 2. The common environment with the added load",
	  OB_PAPER_COMMON_LOAD,
	  6,
	  { THREE_COLUMNS } },
	{ "table-3",
	  "Table 3. Runtime of OBS (scenario 2)",
	  OB_PAPER_OBS,
	  4,
	  { PAPER("runtime, paper", OB_PAPER_STEP), RUNTIME_COLUMNS } },
	{ "table-4",
	  "Table 4. Frame rates of OBS",
	  OB_PAPER_OBS,
	  2,
	  { PAPER("frames, paper", OB_PAPER_FPS), HERE("frames", OB_PAPER_FPS) } },
	{ "table-5",
	  "Table 5. CPU usage of OBS",
	  OB_PAPER_OBS,
	  3,
	  { PAPER("CPU, paper", OB_PAPER_CPU), HERE("CPU of all simulators", OB_PAPER_CPU),
	    HERE("CPU of viewer and host", OB_PAPER_VIEWER) } },
	{ "obs-load",
	  "OBS with the added load, which the paper never ran",
	  OB_PAPER_OBS_LOAD,
	  5,
	  { RUNTIME_COLUMNS, HERE("frames", OB_PAPER_FPS), HERE("CPU", OB_PAPER_CPU) } },
	{ "obs-obb",
	  "OBS with OBB, which the paper never ran",
	  OB_PAPER_OBS_OBB,
	  5,
	  { RUNTIME_COLUMNS, HERE("frames", OB_PAPER_FPS), HERE("CPU", OB_PAPER_CPU) } },
};

enum { TABLES = sizeof tables / sizeof *tables };

static void add_number(ob_table *t, double v, bool printed)
{
	ob_table_add(t, "%s", ob_word_number(v).text);
	if (printed)
		ob_table_class(t, "theirs");
}

static ob_table *make_table(const model *m, const table_plan *plan)
{
	const uint32_t rows = m->here->experiments > m->paper.experiments ? m->here->experiments : m->paper.experiments;
	char align[1 + COLUMNS + 1] = "lrrrrrr";
	align[1 + plan->columns] = 0;
	ob_table *t = ob_table_new(align);
	ob_table_add(t, "experiment");
	for (size_t i = 0; i < plan->columns; i++) {
		ob_table_add(t, "%s", plan->column[i].head);
		ob_table_small(t, "%s", ob_paper_metrics[plan->column[i].metric].unit);
		if (plan->column[i].paper)
			ob_table_class(t, "theirs");
	}
	for (uint32_t row = 0; row < rows; row++) {
		ob_table_add(t, "%u", row + 1);
		for (size_t i = 0; i < plan->columns; i++) {
			const ob_metric *metric = &ob_paper_metrics[plan->column[i].metric];
			const ob_record *r =
				ob_paper_find(plan->column[i].paper ? &m->paper : m->here, plan->scenario, row);
			add_number(t, r ? r->metric[plan->column[i].metric] * metric->scale : NAN,
				   plan->column[i].paper);
		}
	}
	ob_table_add(t, "mean, 95 %%");
	for (size_t i = 0; i < plan->columns; i++) {
		const double scale = ob_paper_metrics[plan->column[i].metric].scale;
		ob_statistics s = ob_paper_summarise(plan->column[i].paper ? &m->paper : m->here, plan->scenario,
						     plan->column[i].metric);
		add_number(t, s.mean * scale, plan->column[i].paper);
		if (isfinite(s.mean_low))
			ob_table_small(t, "%s to %s", ob_word_number(s.mean_low * scale).text,
				       ob_word_number(s.mean_high * scale).text);
	}
	return t;
}

// ---- diagrams: the paper's figures, with ours added

enum { CURVE = 60 }; // points of a fitted line
enum { STYLE_OBS = 0, STYLE_POOL = 1, STYLE_ONE = 2, STYLE_COMMON = 5, STYLE_GUIDE = -1 };

static const struct {
	const char *name, *caption;
	ob_paper_metric metric;
	bool growth;
	ob_paper_scenario scenario; // of growth
	ob_chart_scale scale;
} charts[] = {
	{ "figure-14", "Figure 14. Runtime", OB_PAPER_STEP, false, 0, OB_SCALE_LOG },
	{ "figure-15", "Figure 15. Frame rates", OB_PAPER_FPS, false, 0, OB_SCALE_LOG },
	{ "figure-16", "Figure 16. CPU usage", OB_PAPER_CPU, false, 0, OB_SCALE_LOG },
	{ "figure-6-common", "Figure 6, the common environment. CPU against the number of objects", OB_PAPER_DEMAND,
	  true, OB_PAPER_COMMON, OB_SCALE_LINEAR },
	{ "figure-6-obs", "Figure 6, OBS. CPU against the number of objects", OB_PAPER_DEMAND, true, OB_PAPER_OBS,
	  OB_SCALE_LINEAR },
	{ "figure-6-obs-shown", "Figure 6, OBS as a system monitor shows it", OB_PAPER_CPU, true, OB_PAPER_OBS,
	  OB_SCALE_LINEAR },
};

static void add_experiments(ob_chart *c, const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m,
			    const char *title, int style, bool hollow)
{
	ob_chart_begin(c, style, hollow, title);
	for (uint32_t k = 0; k < r->experiments; k++) {
		const ob_record *at = ob_paper_find(r, s, k);
		if (at && isfinite(at->metric[m]))
			ob_chart_add(c, k + 1, at->metric[m] * ob_paper_metrics[m].scale, "", "");
	}
}

static void draw_experiments(ob_chart *c, const model *of, ob_paper_metric m)
{
	const ob_paper_results *here = of->here;
	const bool step = m == OB_PAPER_STEP;
	add_experiments(c, here, OB_PAPER_COMMON, m, step ? "common: the step" : "common", STYLE_COMMON, false);
	add_experiments(c, here, OB_PAPER_OBS, m,
			step ? "OBS, one process an object: the step" : "OBS, one process an object", STYLE_OBS, false);
	if (step)
		add_experiments(c, here, OB_PAPER_OBS, OB_PAPER_ONE, "OBS: CPU of one simulator", STYLE_ONE, false);
	else
		add_experiments(c, here, OB_PAPER_POOL, m, "OBS, one thread a core", STYLE_POOL, false);
	add_experiments(c, &of->paper, OB_PAPER_COMMON, m, "common, as printed in the paper", STYLE_COMMON, true);
	add_experiments(c, &of->paper, OB_PAPER_OBS, m, "OBS, as printed in the paper", STYLE_OBS, true);
	OB_SAY(c->x.label, "experiment");
	OB_SAY(c->subtitle, "here: %u boxes, other sizes and attitudes in each experiment; %s", here->objects,
	       here->records.machine);
}

static void draw_fit(ob_chart *c, const ob_line *l, bool logarithmic, double from, double to, double scale,
		     const char *label)
{
	ob_chart_begin(c, STYLE_GUIDE, false, "");
	for (int i = 0; i <= CURVE; i++) {
		double x = from + (to - from) * i / CURVE;
		double y = l->intercept + l->slope * (logarithmic ? log(x) : x);
		ob_chart_add(c, x, y * scale, i == CURVE ? label : "", "");
	}
}

static void draw_growth(ob_chart *c, const model *of, int chart)
{
	const ob_paper_metric m = charts[chart].metric;
	const ob_paper_scenario s = charts[chart].scenario;
	const double scale = ob_paper_metrics[m].scale;
	double from = INFINITY, to = 0;
	ob_chart_begin(c, s == OB_PAPER_OBS ? STYLE_OBS : STYLE_COMMON, false, ob_paper_setups[s].title)->line = false;
	for (size_t i = 0; i < of->here->records.count; i++) {
		const ob_record *at = &of->here->records.record[i];
		uint32_t objects;
		if (!ob_paper_is_growth(at->of, &objects) || ob_paper_scenario_of(at) != s || at->failure ||
		    !isfinite(at->metric[m]))
			continue;
		ob_chart_add(c, objects, at->metric[m] * scale, "", "");
		from = fmin(from, objects);
		to = fmax(to, objects);
	}
	ob_paper_growth g = ob_paper_grow(of->here, s, m);
	OB_SAY(c->x.label, "objects n");
	if (g.linear.n < 3 || !(to > from))
		return;
	draw_fit(c, &g.linear, false, from, to, scale, "line");
	draw_fit(c, &g.logarithmic, true, from, to, scale, "logarithm");
	int prefers = ob_paper_prefers(&g);
	OB_SAY(c->subtitle, "least squares: a + b n with b = %s (%s to %s) an object, a + b ln n; the data prefer %s",
	       ob_word_value(g.linear.slope, m).text, ob_word_value(g.linear.slope_low, m).text,
	       ob_word_value(g.linear.slope_high, m).text,
	       prefers > 0   ? "the line"
	       : prefers < 0 ? "the logarithm"
			     : "neither");
	if (prefers)
		OB_SAY(c->subtitle, ", %s", ob_word_odds(g.favour).text);
}

static ob_chart *make_chart(const model *of, int chart)
{
	const ob_paper_metric m = charts[chart].metric;
	ob_chart *c = ob_chart_new();
	OB_SAY(c->name, "%s", charts[chart].name);
	OB_SAY(c->title, "%s", charts[chart].caption);
	OB_SAY(c->y.label, "%s (%s)", m == OB_PAPER_STEP ? "runtime" : ob_paper_metrics[m].title,
	       ob_paper_metrics[m].unit);
	c->y.scale = charts[chart].scale;
	if (charts[chart].growth)
		draw_growth(c, of, chart);
	else
		draw_experiments(c, of, m);
	return c;
}

// ---- the page

static const char *const verdict_class[OB_PAPER_VERDICTS] = { "met", "partly", "missed", "open" };

static void write_cards(ob_page *p, const void *with)
{
	static const char *const texts[OB_PAPER_VERDICTS] = { "hold", "hold only under a condition", "do not hold",
							      "undecided by these runs" };
	const model *m = with;
	int count[OB_PAPER_VERDICTS] = { 0 };
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		count[m->claim[i].verdict]++;
	for (int v = 0; v < OB_PAPER_VERDICTS; v++)
		if (v != OB_PAPER_OPEN || count[v])
			ob_page_markup(p, "<li><b>%d of %d</b><span>claims %s</span></li>\n", count[v], OB_PAPER_CLAIMS,
				       texts[v]);
}

static void write_busy(ob_page *p, const void *with)
{
	static const double free_enough = .3;
	const model *m = with;
	if (m->here->busy > free_enough)
		ob_page_markup(p,
			       "<p class=\"warning\"><strong>The machine was busy with other work</strong> before "
			       "these runs began (load average %.1f). The step, the frame rate and the pace suffer "
			       "from that, CPU times much less.</p>\n",
			       m->here->busy);
}

static void write_claims(ob_page *p, const void *with)
{
	const model *m = with;
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &m->claim[i];
		ob_page_markup(p, "<tr id=\"claim-%s\"><th scope=\"row\">", c->key);
		ob_page_text(p, c->says);
		ob_page_markup(p, "<small>%s</small></th><td><strong class=\"verdict %s\">%s</strong>", c->where,
			       verdict_class[c->verdict], ob_paper_verdict_text(c->verdict));
		if (*c->condition)
			ob_page_markup(p, " ");
		ob_page_text(p, c->condition);
		ob_page_markup(p, "</td><td>");
		ob_page_text(p, c->because);
		ob_page_markup(p, "</td><td>");
		ob_page_text(p, c->itself);
		ob_page_markup(p, "</td></tr>\n");
	}
}

// Writes medians of all scenarios.
static void write_medians(ob_page *p, const void *with)
{
	static const ob_paper_metric shown[] = { OB_PAPER_STEP,  OB_PAPER_TOTAL, OB_PAPER_ONE, OB_PAPER_BUSIEST,
						 OB_PAPER_CPU,   OB_PAPER_PACE,  OB_PAPER_FPS, OB_PAPER_VIEWER,
						 OB_PAPER_TESTS, OB_PAPER_MEMORY };
	const model *m = with;
	ob_table *t = ob_table_new("lrrrrrrrr");
	ob_table_add(t, "%s", "");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++)
		ob_table_add(t, "%s", ob_paper_setups[s].title);
	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
		ob_table_add(t, "%s", ob_paper_metrics[shown[i]].title);
		for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
			ob_statistics of = ob_paper_summarise(m->here, s, shown[i]);
			ob_table_add_median(t, &ob_paper_metrics[shown[i]], &of);
		}
	}
	ob_table_html(t, p);
	ob_page_markup(p, "<dl>\n");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++)
		ob_page_term(p, ob_paper_setups[s].title, ob_paper_setups[s].what);
	ob_page_markup(p, "</dl>\n");
}

static void write_tables_of(ob_page *p, const model *m, bool printed)
{
	for (size_t i = 0; i < TABLES; i++) {
		if (tables[i].column[0].paper != printed)
			continue;
		ob_page_markup(p, "<section id=\"%s\">\n<h3>%s</h3>\n", tables[i].id, tables[i].title);
		ob_table_html(make_table(m, &tables[i]), p);
		ob_page_markup(p, "</section>\n");
	}
}

static void write_tables(ob_page *p, const void *with)
{
	write_tables_of(p, with, true);
}

static void write_never(ob_page *p, const void *with)
{
	static const struct {
		const char *what;
		ob_paper_scenario a, b;
		ob_paper_metric metric;
	} pairs[] = {
		{ "CPU time of OBS, against the same in lockstep", OB_PAPER_OBS, OB_PAPER_LOCKSTEP, OB_PAPER_TOTAL },
		{ "CPU time of OBS with the load, against OBS without", OB_PAPER_OBS_LOAD, OB_PAPER_OBS,
		  OB_PAPER_TOTAL },
		{ "CPU time of OBS with the load, against the common environment with it", OB_PAPER_OBS_LOAD,
		  OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL },
		{ "CPU time of OBS with OBB, against OBS with AABB", OB_PAPER_OBS_OBB, OB_PAPER_OBS, OB_PAPER_TOTAL },
		{ "CPU time of OBS with OBB, against the common environment with OBB", OB_PAPER_OBS_OBB,
		  OB_PAPER_COMMON_OBB, OB_PAPER_TOTAL },
		{ "the step of OBS with OBB, against that of the common environment with OBB", OB_PAPER_OBS_OBB,
		  OB_PAPER_COMMON_OBB, OB_PAPER_STEP },
	};
	const model *m = with;
	ob_page_markup(p, "<ul>\n");
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		ob_estimate r = ob_paper_compare(m->here, pairs[i].a, pairs[i].b, pairs[i].metric);
		ob_page_markup(p, "<li>%s: %s.</li>\n", pairs[i].what, ob_word_ratio(&r).text);
	}
	ob_page_markup(p, "</ul>\n");
	write_tables_of(p, m, false);
}

static void write_itself(ob_page *p, const void *with)
{
	const model *m = with;
	double busy[OB_PAPER_OBS + 1];
	for (int s = OB_PAPER_COMMON; s <= OB_PAPER_OBS; s++)
		busy[s] = ob_paper_summarise(&m->paper, s, OB_PAPER_STEP).mean *
			  ob_paper_summarise(&m->paper, s, OB_PAPER_FPS).mean;
	ob_page_markup(p, "Its runtime times its frame rate is ");
	ob_page_text(p, ob_word_number(busy[OB_PAPER_COMMON]).text);
	ob_page_markup(p, " in the common environment and ");
	ob_page_text(p, ob_word_number(busy[OB_PAPER_COMMON_LOAD]).text);
	ob_page_markup(p, " with the load: more than all of the time there is, so what its runtime measures cannot "
			  "have been done once in each frame.");
}

static void write_setting(ob_page *p, const void *with)
{
	const model *m = with;
	ob_page_term(p, "Machine", m->here->records.machine);
	ob_page_markup(p,
		       "<dt>obsim</dt><dd>commit <code>%s</code></dd>\n<dt>Runs</dt><dd>%u experiments with %u boxes "
		       "in each scenario, %zu runs in all</dd>\n<dt>Step</dt><dd>%.3f&nbsp;s, %d substep; at most %d "
		       "iterations</dd>\n",
		       m->here->records.commit, m->here->experiments, m->here->objects, m->here->records.count,
		       OB_PAPER_STEP_LENGTH, OB_PAPER_SUBSTEPS, OB_PAPER_ITERATIONS);
	for (size_t i = 0; i < m->here->records.count; i++) {
		const ob_record *r = &m->here->records.record[i];
		uint32_t objects;
		ob_paper_is_growth(r->of, &objects);
		if (!r->failure && !*r->note)
			continue;
		ob_page_markup(p, "<dt>%s</dt><dd>%s, %u objects, seed %llu: ", r->failure ? "Failed" : "No frames",
			       r->configuration, objects, (unsigned long long)r->seed);
		ob_page_text(p, r->failure ? r->reason : r->note);
		ob_page_markup(p, "</dd>\n");
	}
}

static void write_figures(ob_page *p, const void *with)
{
	for (size_t i = 0; i < sizeof charts / sizeof *charts; i++)
		ob_chart_html(make_chart(with, (int)i), p, "");
}

// ---- other forms

static void write_markdown(FILE *f, const void *with)
{
	const model *m = with;
	fprintf(f, "# The paper's claims, measured\n\n%s; obsim %s; %u experiments with %u boxes.\n\n",
		m->here->records.machine, m->here->records.commit, m->here->experiments, m->here->objects);
	fputs("| The paper says | Verdict | Measured | Its own tables |\n|---|---|---|---|\n", f);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &m->claim[i];
		fprintf(f, "| %s (%s) | **%s**%s%s | %s | %s |\n", c->says, c->where, ob_paper_verdict_text(c->verdict),
			*c->condition ? " " : "", c->condition, c->because, c->itself);
	}
	for (size_t i = 0; i < TABLES; i++) {
		fprintf(f, "\n## %s\n\n", tables[i].title);
		ob_table_markdown(make_table(m, &tables[i]), f);
	}
}

bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e)
{
	static const ob_page_slot slots[] = {
		{ "cards", write_cards },     { "busy", write_busy },       { "claims", write_claims },
		{ "medians", write_medians }, { "figures", write_figures }, { "tables", write_tables },
		{ "never", write_never },     { "itself", write_itself },   { "setting", write_setting },
	};
	const ob_report report = { "obsim: the paper's claims, measured", text_paper_css, text_paper_html, slots,
				   sizeof slots / sizeof *slots };
	model m = { .here = r, .paper = ob_paper_published() };
	ob_paper_judge(r, m.claim);
	bool fine = ob_folder_write(dir, "tables.md", write_markdown, &m, e) && ob_report_write(&report, dir, &m, e);
	ob_records_finish(&m.paper.records);
	return fine;
}

static void put_claim(ob_json *j, const ob_paper_claim *c)
{
	static const char *const verdicts[OB_PAPER_VERDICTS] = { "holds", "holds_only_if", "does_not_hold",
								 "cannot_be_told" };
	ob_json_open(j, NULL);
	ob_json_string(j, "claim", c->key);
	ob_json_string(j, "paper_says", c->says);
	ob_json_string(j, "where", c->where);
	ob_json_string(j, "verdict", verdicts[c->verdict]);
	ob_json_text(j, "only_if", c->condition);
	ob_json_string(j, "measured", c->because);
	ob_json_string(j, "paper_itself", c->itself);
	ob_json_close(j);
}

static void put_mean(ob_json *j, const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m)
{
	ob_statistics of = ob_paper_summarise(r, s, m);
	ob_json_open(j, ob_paper_metrics[m].key);
	ob_json_count(j, "n", of.n);
	ob_json_number(j, "mean", of.mean);
	ob_json_number(j, "low", of.mean_low);
	ob_json_number(j, "high", of.mean_high);
	ob_json_close(j);
}

static void put_record(ob_json *j, const ob_record *r)
{
	uint32_t objects;
	bool growth = ob_paper_is_growth(r->of, &objects);
	ob_json_open(j, NULL);
	ob_json_string(j, "scenario", r->configuration);
	ob_json_string(j, "series", growth ? "growth" : "experiment");
	ob_json_count(j, "experiment", r->repeat + 1);
	ob_json_count(j, "objects", objects);
	ob_json_count(j, "seed", r->seed);
	for (int m = 0; m < OB_PAPER_METRICS; m++)
		ob_json_number(j, ob_paper_metrics[m].key, r->metric[m]);
	ob_json_text(j, "failed", r->failure ? r->reason : "");
	ob_json_close(j);
}

void ob_paper_write_json(const ob_paper_results *r, const char *version, FILE *f)
{
	ob_json j = { .f = f };
	ob_paper_claim claim[OB_PAPER_CLAIMS];
	ob_paper_judge(r, claim);
	ob_json_open(&j, NULL);
	ob_json_string(&j, "version", version);
	ob_json_string(&j, "commit", r->records.commit);
	ob_json_string(&j, "machine", r->records.machine);
	ob_json_number(&j, "load_average_before", r->busy);
	ob_json_open_list(&j, "claims");
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		put_claim(&j, &claim[i]);
	ob_json_close_list(&j);
	ob_json_open(&j, "means");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
		ob_json_open(&j, ob_paper_setups[s].key);
		for (int m = 0; m < OB_PAPER_METRICS; m++)
			put_mean(&j, r, s, m);
		ob_json_close(&j);
	}
	ob_json_close(&j);
	ob_json_open_list(&j, "runs");
	for (size_t i = 0; i < r->records.count; i++)
		put_record(&j, &r->records.record[i]);
	ob_json_close_list(&j);
	ob_json_close(&j);
}
