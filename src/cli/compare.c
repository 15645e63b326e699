// obsim compare: one scene, run in all ways by turns, so that what the machine does meanwhile meets all alike.
#include "cli/compare.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "cli/child.h"
#include "cli/command.h"
#include "cli/compare_run.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "experiment/folder.h"

enum { USUAL_REPEATS = 3 };

static int count_runs(const ob_comparison *c)
{
	int ways = 0;
	for (uint32_t i = 0; i < c->sections; i++)
		for (int w = 0; w < OB_WAYS; w++)
			ways += c->section[i].cell[w].state == OB_WAY_DONE;
	return ways * (2 * (int)c->repeats + 1) + 4 * (int)c->sections;
}

static void run_all(ob_crew_run *p)
{
	ob_comparison *c = p->comparison;
	p->runs_planned = count_runs(c);
	for (uint32_t r = 0; r < c->repeats; r++)
		for (uint32_t i = 0; i < c->sections; i++)
			for (int w = 0; w < OB_WAYS && !ob_child_interrupted(); w++) {
				int way = r % 2 ? OB_WAYS - 1 - w : w; // to and fro
				if (ob_cell_is_done(&c->section[i], way))
					ob_crew_run_sample(p, &c->section[i], way);
			}
	for (uint32_t i = 0; i < c->sections && !ob_child_interrupted(); i++) {
		ob_section *s = &c->section[i];
		ob_crew_run_measured(p, s, OB_WAY_MONOLITH, OB_WAY_MONOLITH);
		ob_crew_run_measured(p, s, OB_WAY_THREAD, OB_WAY_PROCESSES_EACH);
		ob_crew_run_measured(p, s, OB_WAY_MONOLITH_OTHER, OB_WAY_MONOLITH_OTHER);
		ob_crew_run_measured(p, s, OB_WAY_THREADS_OTHER, OB_WAY_THREADS_OTHER);
		for (int w = 0; w < OB_WAYS && !ob_child_interrupted(); w++)
			if (ob_cell_is_done(s, w) && p->arguments->value[OB_OPTION_OUT])
				ob_crew_run_drawn(p, s, w);
	}
	if (isatty(STDERR_FILENO))
		fputs("\r\033[K", stderr);
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

static int tell(const ob_comparison *c, const ob_arguments *a)
{
	const char *json = a->value[OB_OPTION_JSON], *folder = a->value[OB_OPTION_OUT];
	ob_error e;
	ob_comparison_print(c, json && strcmp(json, "-") == 0 ? stderr : stdout);
	if ((json && !write_json(c, json, &e)) || (folder && !ob_comparison_write_folder(c, folder, &e)))
		return ob_command_fail(OB_EXIT_FAILED, e.text);
	for (uint32_t i = 0; i < c->sections; i++) {
		const ob_section *s = &c->section[i];
		if (!ob_section_agrees(s))
			return ob_command_fail(OB_EXIT_FAILED, "the object simulators did not end in the same state");
		for (int w = 0; w < OB_WAYS; w++) {
			if (s->cell[w].state != OB_WAY_FAILED)
				continue;
			ob_fail(&e, "%s: %s", ob_way_table[w].title, s->cell[w].why);
			return ob_command_fail(OB_EXIT_FAILED, e.text);
		}
	}
	return OB_EXIT_OK;
}

// Each value is tried on the scene before anything runs.
static bool load_section(ob_section *s, const ob_comparison *c, const ob_arguments *a, ob_error *e)
{
	ob_arguments own = *a;
	own.define = calloc(a->defines + 2, sizeof *own.define);
	if (!own.define)
		return ob_fail(e, "out of memory");
	if (a->defines)
		memcpy(own.define, a->define, a->defines * sizeof *own.define);
	if (*s->define)
		own.define[own.defines++] = s->define;
	ob_run_request request;
	ob_scene *scene = NULL;
	bool fine = ob_request_read(&request, &own, e);
	if (fine) {
		scene = ob_scene_load(request.scene, &request.scene_options, e);
		fine = scene && ob_request_settle(&request, scene, e);
	}
	s->objects = fine ? scene->objects : 0;
	ob_scene_free(scene);
	free(own.define);
	return fine && (ob_section_plan(s, c) || ob_fail(e, "out of memory"));
}

static void describe(ob_comparison *c, const ob_arguments *a)
{
	size_t used = 0;
	ob_provenance_machine(c->machine, sizeof c->machine);
	for (uint32_t i = 0; i < a->defines && used < sizeof c->options; i++)
		used += (size_t)snprintf(c->options + used, sizeof c->options - used, " -D %s", a->define[i]);
	for (int i = 0; i < OB_OPTIONS && used < sizeof c->options; i++)
		if (a->value[i] && i != OB_OPTION_JSON && i != OB_OPTION_OUT)
			used += (size_t)snprintf(c->options + used, sizeof c->options - used, " --%s %s",
						 ob_option_table[i].name, a->value[i]);
}

static bool prepare(ob_comparison *c, const ob_arguments *a, ob_error *e)
{
	ob_run_request request;
	uint64_t repeats = USUAL_REPEATS;
	if (!ob_request_read(&request, a, e))
		return false;
	if (request.workers == 0)
		return ob_fail(e, "--workers objects: compare has that as two of its ways; give the size of the pool, "
				  "or leave it away");
	if (!ob_number_count("repeats", a->value[OB_OPTION_REPEATS], 1, OB_REPEATS_MAX, &repeats, e) ||
	    !ob_comparison_read_sections(c, a->value[OB_OPTION_VARY], e))
		return false;
	c->scene = request.scene;
	ob_run_settings asked = ob_run_settings_default();
	ob_run_settings_overlay(&asked, &request.asked);
	c->narrow = asked.narrow_phase == OB_NARROW_AABB ? "aabb" : "obb";
	c->other = asked.narrow_phase == OB_NARROW_AABB ? "obb" : "aabb";
	c->load = asked.load;
	c->repeats = (uint32_t)repeats;
	c->pool = request.workers;
	describe(c, a);
	bool fine = true;
	for (uint32_t i = 0; fine && i < c->sections; i++)
		fine = load_section(&c->section[i], c, a, e);
	return fine;
}

static void finish(ob_comparison *c)
{
	for (uint32_t i = 0; c && i < c->sections; i++)
		for (int w = 0; w < OB_WAYS; w++)
			free(c->section[i].cell[w].sample);
	free(c);
}

int ob_command_compare(const ob_arguments *a)
{
	ob_error e;
	ob_comparison *c = calloc(1, sizeof *c);
	if (!c)
		return ob_command_fail(OB_EXIT_FAILED, "out of memory");
	int code = OB_EXIT_USAGE;
	if (!prepare(c, a, &e)) {
		ob_command_fail(code, e.text);
	} else {
		ob_crew_run p = { .arguments = a, .comparison = c };
		double began = ob_clock_wall();
		run_all(&p);
		c->took_s = ob_clock_wall() - began;
		code = ob_child_interrupted() ? ob_command_fail(OB_EXIT_FAILED, "interrupted") : tell(c, a);
	}
	finish(c);
	return code;
}
