#include "experiment/json.h"
#include "lab/report.h"
#include "lab/analysis.h"

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
