// Runs one engine in one scene, in a process of its own, for bench/run.py.
//
//   bench_engine SCENE ENGINE time|look|parts [KEY=VALUE ...]
//
// ENGINE: one of the lab's, "ode-hash", or "host" for obsim through its host, the only one that reports its parts. KEY:
// duration, step (s), substeps, iterations, tolerance (m), sleeping, workers, processes; from (s), parts alone.
// Defaults are the engine's and the scene's own. Exit: 0 done; 1 the engine failed, with the reason in the last line; 2
// invalid arguments.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine.h"

static bool set(bench_order *o, const char *word)
{
	const char *equals = strchr(word, '=');
	char *end = NULL;
	double value = equals ? strtod(equals + 1, &end) : NAN;
	if (!equals || !end || *end || !(value >= 0))
		return false;
	struct {
		const char *key;
		double *number;
		uint32_t *count;
		bool *flag;
	} known[] = {
		{ "from", .number = &o->from },
		{ "duration", .number = &o->duration },
		{ "step", .number = &o->settings.step_length },
		{ "substeps", .count = &o->settings.substeps },
		{ "iterations", .count = &o->settings.iterations },
		{ "tolerance", .number = &o->settings.tolerance },
		{ "sleeping", .count = &o->settings.sleeping },
		{ "workers", .count = &o->workers },
		{ "processes", .flag = &o->processes },
	};
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		if (strncmp(known[i].key, word, (size_t)(equals - word)) || known[i].key[equals - word])
			continue;
		if (known[i].number)
			*known[i].number = value;
		else if (known[i].count)
			*known[i].count = (uint32_t)value;
		else
			*known[i].flag = value > 0;
		return true;
	}
	return false;
}

static const ob_engine_kind *find(const char *name)
{
	if (!strcmp(name, ob_engine_ode_hash.name))
		return &ob_engine_ode_hash;
	return ob_engine_find(strcmp(name, "host") ? name : "obsim");
}

static int misused(const char *what, const char *word)
{
	fprintf(stderr, "bench_engine: %s %s\n", what, word);
	return 2;
}

int main(int argc, char **argv)
{
	if (argc < 4) {
		fprintf(stderr, "usage: bench_engine SCENE ENGINE time|look|parts [KEY=VALUE ...]\n");
		return 2;
	}
	ob_error e = { "" };
	const bench_scene *scene = bench_scene_find(argv[1], &e);
	if (!scene)
		return misused(e.text, "");
	const ob_engine_kind *kind = find(argv[2]);
	if (!kind)
		return misused("no engine", argv[2]);
	bench_order o = { .scene = scene, .duration = scene->of.duration, .settings = kind->usual, .workers = 1 };
	o.settings.step_length = ob_case_step;
	o.settings.sleeping = scene->sleeping;
	for (int i = 4; i < argc; i++)
		if (!set(&o, argv[i]))
			return misused("not understood:", argv[i]);
	bool host = !strcmp(argv[2], "host"), look = !strcmp(argv[3], "look"), parts = !strcmp(argv[3], "parts"), done;
	if (!look && !parts && strcmp(argv[3], "time"))
		return misused("not understood:", argv[3]);
	if (host ? look : parts)
		return misused("this engine cannot do", argv[3]);
	if (look)
		done = bench_look(&o, kind, &e);
	else if (parts)
		done = bench_parts(&o, &e);
	else
		done = host ? bench_time_host(&o, &e) : bench_time(&o, kind, &e);
	if (!done)
		printf("failed\t\t%s\n", e.text);
	return done ? 0 : 1;
}
