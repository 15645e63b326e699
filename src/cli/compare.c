// obsim compare: reads the command line; compare/ does the rest.
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "cli/terminal.h"
#include "cli/version.h"
#include "compare/compare.h"
#include "plot/plot.h"
#include "ranks/ranks.h"
#include "render/render.h"

enum { USUAL_REPEATS = 3, WIDTH_LEAST = 80, WIDTH_MOST = 100 };

// Options of obsim run that each run of the comparison gets unchanged
static bool is_passed_on(ob_option_id id)
{
	switch (id) {
	case OB_OPTION_DEFINE:
	case OB_OPTION_WORKERS:
	case OB_OPTION_NARROW:
	case OB_OPTION_SEED:
	case OB_OPTION_HARDEN:
		return false; // set by compare itself
	default:
		return (ob_option_table[id].commands & OB_COMMAND_RUN) &&
		       (ob_option_table[id].commands & OB_COMMAND_COMPARE) && id != OB_OPTION_JSON &&
		       ob_option_table[id].argument;
	}
}

static bool means_nothing_to_a_monolith(ob_option_id id)
{
	return id == OB_OPTION_TOLERANCE || id == OB_OPTION_SOLVER || id == OB_OPTION_LAG || id == OB_OPTION_INTEGRATOR;
}

static bool pass_on(ob_comparison *c, const ob_arguments *a, ob_error *e)
{
	size_t used = 0;
	bool fine = a->defines + OB_OPTIONS <= OB_COMPARE_OPTIONS ||
		    ob_fail(e, "more than %d parameters of the scene", OB_COMPARE_OPTIONS - OB_OPTIONS);
	for (uint32_t i = 0; fine && i < a->defines; i++) {
		fine = asprintf(&c->pass[c->passed].text, "-D%s", a->define[i]) >= 0 || ob_fail(e, "out of memory");
		c->passed += fine;
		used += (size_t)snprintf(c->options + used, sizeof c->options - used, " -D %s", a->define[i]);
		fine = fine && (used < sizeof c->options || ob_fail(e, "the options are too long"));
	}
	for (int i = 0; fine && i < OB_OPTIONS; i++) {
		bool passed = is_passed_on(i);
		if (!a->value[i] || (!passed && i != OB_OPTION_WORKERS && i != OB_OPTION_NARROW))
			continue;
		if (passed) {
			ob_compare_option *o = &c->pass[c->passed];
			fine = asprintf(&o->text, "--%s=%s", ob_option_table[i].name, a->value[i]) >= 0 ||
			       ob_fail(e, "out of memory");
			o->objects_only = means_nothing_to_a_monolith(i);
			c->passed += fine;
		}
		used += (size_t)snprintf(c->options + used, sizeof c->options - used, " --%s %s",
					 ob_option_table[i].name, a->value[i]);
		fine = fine && (used < sizeof c->options || ob_fail(e, "the options are too long"));
	}
	return fine;
}

// Loads the scene with a value of the sweep. Each value is tried before anything runs.
static bool load_point(ob_sweep_point *p, const ob_arguments *a, ob_error *e)
{
	ob_arguments own;
	if (!ob_options_define(&own, a, p->define, e))
		return false;
	ob_run_request request;
	ob_scene *scene = NULL;
	bool fine = ob_request_read(&request, &own, e);
	if (fine) {
		scene = ob_scene_load(request.scene, &request.scene_options, e);
		fine = scene && ob_request_resolve(&request, scene, e);
	}
	if (fine) {
		p->objects = scene->objects;
		p->joints = scene->joints;
		p->seed = scene->seed;
		p->step = request.run.step_length;
		p->steps = ob_request_steps(request.duration, p->step);
		p->simulated = (double)p->steps * p->step;
	}
	ob_scene_free(scene);
	free(own.define);
	return fine;
}

static bool prepare(ob_comparison *c, const ob_arguments *a, ob_error *e)
{
	ob_run_request request;
	uint64_t repeats = USUAL_REPEATS, seeds = 1;
	if (!ob_request_read(&request, a, e) || !ob_harden_read(&c->harden, a->value[OB_OPTION_HARDEN], e))
		return false;
	if (request.workers == 0)
		return ob_fail(e,
			       "--workers objects: compare has that as two of its configurations; give the size of the "
			       "pool, or leave it away");
	if (a->value[OB_OPTION_FRESH] && !a->value[OB_OPTION_OUT])
		return ob_fail(e, "--fresh runs again what a folder has: it needs --out");
	if (!ob_number_count("repeats", a->value[OB_OPTION_REPEATS], 1, OB_COMPARE_RUNS, &repeats, e) ||
	    !ob_number_count("seeds", a->value[OB_OPTION_SEEDS], 1, OB_COMPARE_RUNS, &seeds, e) ||
	    !ob_comparison_read_points(c, a->value[OB_OPTION_VARY], e))
		return false;
	if (repeats * seeds > OB_COMPARE_RUNS)
		return ob_fail(e, "--repeats and --seeds: at most %d runs of each configuration", OB_COMPARE_RUNS);
	ob_run_settings asked = ob_run_settings_default();
	ob_run_settings_overlay(&asked, &request.asked);
	bool aabb = asked.narrow_phase == OB_NARROW_AABB;
	c->scene = request.scene;
	c->narrow = aabb ? "aabb" : "obb";
	c->other = aabb ? "obb" : "aabb";
	c->repeats = (uint32_t)repeats;
	c->seeds = (uint32_t)seeds;
	c->pool = request.workers;
	c->drawn = a->value[OB_OPTION_OUT] != NULL;
	bool fine = pass_on(c, a, e);
	for (uint32_t i = 0; fine && i < c->points; i++)
		fine = load_point(&c->point[i], a, e);
	fine = fine && (!c->drawn || (ob_render_check(e) && ob_plot_check(e)));
	return fine && ob_comparison_plan(c, e);
}

static bool write_json(const ob_comparison *c, const char *path, ob_error *e)
{
	bool out = strcmp(path, "-") == 0;
	FILE *f = out ? stdout : fopen(path, "we");
	if (f)
		ob_comparison_write_json(c, f);
	if (!f || fflush(f) != 0 || ferror(f) || (!out && fclose(f) != 0))
		return ob_fail(e, "--json %s: %s", path, strerror(errno));
	return true;
}

static size_t width_of(FILE *f)
{
	int columns = WIDTH_MOST, lines;
	if (isatty(fileno(f)))
		ob_terminal_size(&columns, &lines);
	return columns < WIDTH_LEAST ? WIDTH_LEAST : columns > WIDTH_MOST ? WIDTH_MOST : (size_t)columns;
}

static int report(const ob_comparison *c, const ob_arguments *a)
{
	const char *json = a->value[OB_OPTION_JSON], *folder = a->value[OB_OPTION_OUT];
	FILE *f = json && strcmp(json, "-") == 0 ? stderr : stdout;
	ob_error e;
	ob_comparison_print(c, f, width_of(f));
	if (folder)
		fprintf(f, "\n%s/report.html shows it all; %s/results.csv has every run.\n", folder, folder);
	if ((json && !write_json(c, json, &e)) || (folder && !ob_comparison_write_folder(c, folder, &e)))
		return ob_command_fail(OB_EXIT_FAILED, e.text);
	for (uint32_t i = 0; i < c->points; i++) {
		if (!ob_comparison_agrees(c, &c->point[i]))
			return ob_command_fail(OB_EXIT_FAILED, "the object simulators did not end in the same state");
		for (int w = 0; w < OB_CONFIGURATIONS; w++) {
			const char *failed = ob_comparison_failure(c, &c->point[i], w);
			if (!failed)
				continue;
			ob_fail(&e, "%s: %s", ob_configuration_table[w].title, failed);
			return ob_command_fail(OB_EXIT_FAILED, e.text);
		}
	}
	return OB_EXIT_OK;
}

int ob_command_compare(const ob_arguments *a)
{
	if (a->value[OB_OPTION_LIVE])
		return ob_command_compare_live(a);
	if (a->value[OB_OPTION_LISTEN])
		return ob_command_fail(OB_EXIT_USAGE, "--listen is for a page: add --live");
	if (a->value[OB_OPTION_SYNC])
		return ob_command_compare_sync(a);
	ob_error e;
	ob_comparison *c = calloc(1, sizeof *c);
	int code;
	if (!c)
		return ob_command_fail(OB_EXIT_FAILED, "out of memory");
	if (!prepare(c, a, &e))
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	else if (!ob_comparison_run(c, ob_version_commit, a->value[OB_OPTION_OUT], a->value[OB_OPTION_FRESH], &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	else
		code = ob_ranks_started().rank > 0 ? OB_EXIT_OK : report(c, a); // rank 0 has the records
	ob_comparison_finish(c);
	free(c);
	return code;
}
