// obsim compare: reads the command line; compare/ does the rest.
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "cli/terminal.h"
#include "cli/version.h"
#include "compare/compare.h"
#include "compare/sync.h"
#include "ranks/ranks.h"
#include "render/render.h"
#include "shape/shape.h"

enum { USUAL_REPEATS = 3, WIDTH_LEAST = 80, WIDTH_MOST = 100 };

// Adds an option that each run gets unchanged, if it is passed, and shows it in either case.
static bool pass_one(ob_comparison *c, const char *option, const char *value, bool passed, bool objects_only,
		     ob_error *e)
{
	const size_t used = strlen(c->options), room = sizeof c->options - used;
	ob_compare_option *o = &c->pass[c->passed];
	if (passed && c->passed == OB_COMPARE_OPTIONS)
		return ob_fail(e, "more than %d options", OB_COMPARE_OPTIONS);
	if (passed && asprintf(&o->text, "%s%s%s", option, option[1] == '-' ? "=" : "", value) < 0)
		return ob_fail(e, "out of memory");
	if (passed)
		c->pass[c->passed++].objects_only = objects_only;
	return (size_t)snprintf(c->options + used, room, " %s %s", option, value) < room ||
	       ob_fail(e, "the options are too long");
}

// Passes on parameters of the scene, the duration and settings; compare itself sets workers, seed and narrow phase.
static bool pass_on(ob_comparison *c, const ob_arguments *a, ob_error *e)
{
	const char *duration = a->value[OB_OPTION_DURATION], *workers = a->value[OB_OPTION_WORKERS];
	bool fine = true;
	for (uint32_t i = 0; fine && i < a->defines; i++)
		fine = pass_one(c, "-D", a->define[i], true, false, e);
	fine = fine && (!duration || pass_one(c, "--duration", duration, true, false, e)) &&
	       (!workers || pass_one(c, "--workers", workers, false, false, e));
	for (int i = 0; fine && i < OB_SETTINGS; i++) {
		const ob_setting *s = &ob_setting_table[i];
		const bool own = s->flags & OB_SETTING_OPTION;
		char option[32], value[64];
		if (!a->setting[i])
			continue;
		snprintf(option, sizeof option, "--%s", own ? s->name : "set");
		snprintf(value, sizeof value, "%s%s%s", own ? "" : s->name, own ? "" : "=", a->setting[i]);
		fine = pass_one(c, option, value, i != OB_SETTING_NARROW_PHASE, s->flags & OB_SETTING_OBJECTS, e);
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
	fine = fine && (!c->drawn || ob_render_check(e));
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
	if (a->setting[OB_SETTING_SYNC])
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

// ---- compare sync

// obsim compare --sync lockstep,free: reads the command line; compare/sync.h does the rest.

enum { USUAL_SEEDS = 8, WIDTH = 160 };
static const double usual_duration = 1.25, rate = 1000, jitter = .3; // s, Hz, share
static const double budget = 480; // s: with fewer seeds than usual where they take longer

static bool check(const ob_arguments *a, ob_error *e)
{
	const uint64_t known = OB_BIT(OB_OPTION_DEFINE) | OB_BIT(OB_OPTION_DURATION) | OB_BIT(OB_OPTION_VARY) |
			       OB_BIT(OB_OPTION_SEED) | OB_BIT(OB_OPTION_SEEDS) | OB_BIT(OB_OPTION_OUT) |
			       OB_BIT(OB_OPTION_FRESH);
	const char *sync = a->setting[OB_SETTING_SYNC];
	if (!strchr(sync, ','))
		return ob_fail(e, "--sync %s: compare runs both ways: expected --sync lockstep,free", sync);
	if (!ob_options_refuse(a, ~known, ~OB_BIT(OB_SETTING_SYNC),
			       " does not go with --sync lockstep,free: leave it away", e))
		return false;
	return !a->value[OB_OPTION_FRESH] || a->value[OB_OPTION_OUT] ||
	       ob_fail(e, "--fresh runs again what a folder has: it needs --out");
}

static int by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

// Number, mass and size of what moves.
static bool measure(ob_sync_point *p, const ob_scene *s, ob_error *e)
{
	double *size = malloc((s->objects + 1) * sizeof *size);
	for (uint32_t i = 0; size && i < s->objects; i++) {
		const ob_passport *o = &s->object[i].passport;
		if (o->flags & OB_OBJECT_PRESCRIBED)
			continue;
		size[p->objects++] = ob_shape_thickness(o->shape, o->size);
		p->mass += o->mass;
	}
	if (size && p->objects) {
		qsort(size, p->objects, sizeof *size, by_size);
		p->size = size[p->objects / 2];
	}
	free(size);
	return p->objects || ob_fail(e, "nothing moves in the scene: there is nothing to compare");
}

// Loads the scene with a value of the sweep, so that each is tried before anything runs.
static bool load_sync_point(ob_sync_comparison *c, ob_sync_point *p, const ob_arguments *a, ob_error *e)
{
	ob_arguments own;
	ob_run_request r;
	if (!ob_options_define(&own, a, p->define, e))
		return false;
	own.setting[OB_SETTING_SYNC] = NULL;
	ob_scene *s = ob_request_read(&r, &own, e) ? ob_scene_load(r.scene, &r.scene_options, e) : NULL;
	bool fine = s && measure(p, s, e);
	if (fine) {
		const char *slash = strrchr(c->scene, '/');
		uint64_t hash = ob_hash_on(OB_HASH_BEGIN, s->text, s->text_size);
		for (uint32_t i = 0; i < own.defines; i++)
			hash = ob_hash_on(hash, own.define[i], strlen(own.define[i]) + 1);
		if (a->value[OB_OPTION_DURATION])
			c->duration = r.duration;
		hash = ob_hash_on(hash, &c->duration, sizeof c->duration);
		p->seed = r.scene_options.has_seed ? r.scene_options.seed : s->seed;
		char key[sizeof p->key];
		snprintf(key, sizeof key, "%.80s%s%s @%016" PRIx64, slash ? slash + 1 : c->scene, *p->define ? " " : "",
			 p->define, hash);
		memcpy(p->key, key, sizeof key);
	}
	ob_scene_free(s);
	free(own.define);
	return fine;
}

static bool prepare_sync(ob_sync_comparison *c, const ob_arguments *a, ob_error *e)
{
	uint64_t seeds = USUAL_SEEDS;
	ob_comparison *points = calloc(1, sizeof *points);
	bool fine =
		check(a, e) && (points || ob_fail(e, "out of memory")) &&
		ob_number_count("seeds", a->value[OB_OPTION_SEEDS], 1, OB_COMPARE_RUNS, &seeds, e) &&
		ob_comparison_read_points(points, a->value[OB_OPTION_VARY], e) &&
		(a->defines <= OB_SYNC_DEFINES || ob_fail(e, "more than %d parameters of the scene", OB_SYNC_DEFINES));
	const bool timed = !a->value[OB_OPTION_SEEDS] && ob_ranks_started().ranks < 2; // ranks would not stop alike
	*c = (ob_sync_comparison){ .scene = a->operand,
				   .seeds = (uint32_t)seeds,
				   .budget = timed ? budget : INFINITY,
				   .duration = usual_duration,
				   .rate = rate,
				   .jitter = jitter };
	for (uint32_t i = 0; fine && i < a->defines; i++)
		c->define[c->defines++] = a->define[i];
	for (uint32_t i = 0; fine && i < points->points; i++) {
		memcpy(c->point[i].define, points->point[i].define, sizeof c->point[i].define);
		fine = load_sync_point(c, &c->point[i], a, e);
	}
	c->points = points ? points->points : 0;
	free(points);
	return fine;
}

int ob_command_compare_sync(const ob_arguments *a)
{
	const char *folder = a->value[OB_OPTION_OUT];
	int columns = WIDTH, lines, code = OB_EXIT_OK;
	ob_error e;
	ob_sync_comparison *c = calloc(1, sizeof *c);
	if (!c)
		return ob_command_fail(OB_EXIT_FAILED, "out of memory");
	if (!prepare_sync(c, a, &e)) {
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	} else if (!ob_sync_run(c, ob_version_commit, folder, a->value[OB_OPTION_FRESH], &e)) {
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	} else {
		if (isatty(STDOUT_FILENO))
			ob_terminal_size(&columns, &lines);
		ob_sync_print(c, stdout, (size_t)columns);
		if (folder && !ob_sync_write_folder(c, folder, &e))
			code = ob_command_fail(OB_EXIT_FAILED, e.text);
		else if (folder)
			printf("\n%s/report.html shows it all; %s/results.csv has every run.\n", folder, folder);
	}
	ob_sync_finish(c);
	free(c);
	return code;
}
