#include "paper/report.h"

#include <math.h>

#include "experiment/folder.h"
#include "experiment/json.h"
#include "paper/trial.h"
#include "paper/words.h"
#include "paper_texts.h"

enum { COLUMNS = 6 };

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

static const table_plan tables[OB_PAPER_TABLES] = {
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

ob_paper_report_model ob_paper_report_model_make(const ob_paper_results *r)
{
	ob_paper_report_model m = { .here = r, .paper = ob_paper_published() };
	ob_paper_judge(r, m.claim);
	return m;
}

void ob_paper_report_model_finish(ob_paper_report_model *m)
{
	ob_records_finish(&m->paper.records);
}

// ---- tables

static void add_number(ob_table *t, double v, bool printed)
{
	ob_table_add(t, "%s", ob_word_number(v).text);
	if (printed)
		ob_table_class(t, "theirs");
}

ob_table *ob_paper_table_make(const ob_paper_report_model *m, int table)
{
	const table_plan *plan = &tables[table];
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

// ---- the page

static const char *const verdict_class[OB_PAPER_VERDICTS] = { "met", "partly", "missed", "open" };

static void write_cards(ob_page *p, const void *with)
{
	static const char *const texts[OB_PAPER_VERDICTS] = { "hold", "hold only under a condition", "do not hold",
							      "undecided by these runs" };
	const ob_paper_report_model *m = with;
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
	const ob_paper_report_model *m = with;
	if (m->here->busy > free_enough)
		ob_page_markup(
			p,
			"<p class=\"warning\"><strong>The machine was busy with other work</strong> before these runs "
			"began (load average %.1f). The step, the frame rate and the pace suffer from that, CPU "
			"times much less.</p>\n",
			m->here->busy);
}

static void write_claims(ob_page *p, const void *with)
{
	const ob_paper_report_model *m = with;
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
	const ob_paper_report_model *m = with;
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

static void write_tables_of(ob_page *p, const ob_paper_report_model *m, bool printed)
{
	for (int i = 0; i < OB_PAPER_TABLES; i++) {
		if (tables[i].column[0].paper != printed)
			continue;
		ob_page_markup(p, "<section id=\"%s\">\n<h3>%s</h3>\n", tables[i].id, tables[i].title);
		ob_table_html(ob_paper_table_make(m, i), p);
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
	const ob_paper_report_model *m = with;
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
	const ob_paper_report_model *m = with;
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
	const ob_paper_report_model *m = with;
	ob_page_markup(p, "<dt>Machine</dt><dd>");
	ob_page_text(p, m->here->records.machine);
	ob_page_markup(p, "</dd>\n<dt>obsim</dt><dd>commit <code>");
	ob_page_text(p, m->here->records.commit);
	ob_page_markup(p,
		       "</code></dd>\n<dt>Runs</dt><dd>%u experiments with %u boxes in each scenario, %zu runs in "
		       "all</dd>\n<dt>Step</dt><dd>%.3f&nbsp;s, %d substep; at most %d iterations</dd>\n",
		       m->here->experiments, m->here->objects, m->here->records.count, OB_PAPER_STEP_LENGTH,
		       OB_PAPER_SUBSTEPS, OB_PAPER_ITERATIONS);
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
	for (int i = 0; i < OB_PAPER_CHARTS; i++)
		ob_chart_html(ob_paper_chart_make(with, i), p, "");
}

// ---- other forms

static void write_markdown(FILE *f, const void *with)
{
	const ob_paper_report_model *m = with;
	fprintf(f, "# The paper's claims, measured\n\n%s; obsim %s; %u experiments with %u boxes.\n\n",
		m->here->records.machine, m->here->records.commit, m->here->experiments, m->here->objects);
	fputs("| The paper says | Verdict | Measured | Its own tables |\n|---|---|---|---|\n", f);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &m->claim[i];
		fprintf(f, "| %s (%s) | **%s**%s%s | %s | %s |\n", c->says, c->where, ob_paper_verdict_text(c->verdict),
			*c->condition ? " " : "", c->condition, c->because, c->itself);
	}
	for (int i = 0; i < OB_PAPER_TABLES; i++) {
		fprintf(f, "\n## %s\n\n", tables[i].title);
		ob_table_markdown(ob_paper_table_make(m, i), f);
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
	ob_paper_report_model m = ob_paper_report_model_make(r);
	bool fine = ob_folder_write(dir, "tables.md", write_markdown, &m, e) && ob_report_write(&report, dir, &m, e);
	ob_paper_report_model_finish(&m);
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
	if (*c->condition)
		ob_json_string(j, "only_if", c->condition);
	else
		ob_json_null(j, "only_if");
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
	if (r->failure)
		ob_json_string(j, "failed", r->reason);
	else
		ob_json_null(j, "failed");
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
