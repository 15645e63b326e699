// obsim compare --sync lockstep,free: reads the command line; compare/sync.h does the rest.
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
#include "shape/shape.h"

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
static bool load_point(ob_sync_comparison *c, ob_sync_point *p, const ob_arguments *a, ob_error *e)
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

static bool prepare(ob_sync_comparison *c, const ob_arguments *a, ob_error *e)
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
		fine = load_point(c, &c->point[i], a, e);
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
	if (!prepare(c, a, &e)) {
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
