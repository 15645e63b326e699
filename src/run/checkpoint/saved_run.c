#include "checkpoint/saved_run.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/budget.h"
#include "base/utf8.h"

typedef enum saved_area {
	AREA_FACTS,
	AREA_SCENE, // path, ends with a 0
	AREA_TEXT,
	AREA_DEFINES, // texts, each ends with a 0
	AREA_COUNTERS,
	AREA_SLOTS,
	AREA_PASSPORTS,
	AREA_MOTIONS,
	AREA_SCHEDULE,
	AREA_BOUNDS,
	AREA_NEIGHBOURS,
	AREA_PLANES,
	AREA_PAIRS,
	AREA_RECORDS,
	AREA_SCRIPT_TURNS,
	AREA_SCRIPT_CELLS,
	AREA_SCRIPT_TEXTS,
	AREA_HULLS, // without the scene's
	AREA_PULLS,
	AREA_PATHS, // of requests
	AREA_PATH_POINTS,
	AREA_JOINTS,
	AREA_SENSORS,
	AREA_SAMPLES,
	AREAS
} saved_area;

// All scalar data.
typedef struct facts {
	uint64_t created, step, events, seed;
	uint32_t has_seed, checked;
	double duration;
	ob_run_settings settings;
	ob_saved_figures figures;
} facts;

static_assert(sizeof(facts) == 48 + sizeof(ob_run_settings) + 80, "facts");
static_assert(sizeof(ob_counters) % 8 == 0 && sizeof(ob_saved_slot) == 12, "counters, slots");

enum {
	OBJECTS_MAX = 1 << 20,
	PAIRS_MAX = 1 << 27,
	JOINTS_MAX = 1 << 24,
	TEXT_MAX = 1 << 23,
	DEFINES_MAX = 1 << 20,
	SCRIPTS_MAX = 1 << 28
};

static const ob_checkpoint_rule rules[AREAS] = {
	[AREA_FACTS] = { "settings", sizeof(facts), 1, 1 },
	[AREA_SCENE] = { "scene's name", 1, 1, PATH_MAX },
	[AREA_TEXT] = { "scene", 1, 0, TEXT_MAX },
	[AREA_DEFINES] = { "scene's parameters", 1, 0, DEFINES_MAX },
	[AREA_COUNTERS] = { "counters", sizeof(ob_counters), 1, 1 },
	[AREA_SLOTS] = { "slots", sizeof(ob_saved_slot), 0, OBJECTS_MAX },
	[AREA_PASSPORTS] = { "passports", sizeof(ob_passport), 0, OBJECTS_MAX },
	[AREA_MOTIONS] = { "motions", sizeof(ob_motion), 0, OBJECTS_MAX },
	[AREA_SCHEDULE] = { "schedule", sizeof(ob_schedule), 0, OBJECTS_MAX },
	[AREA_BOUNDS] = { "bounds", 6 * sizeof(float), 0, OBJECTS_MAX },
	[AREA_NEIGHBOURS] = { "neighbours", sizeof(uint32_t), 0, OBJECTS_MAX },
	[AREA_PLANES] = { "planes", sizeof(uint32_t), 0, OBJECTS_MAX },
	[AREA_PAIRS] = { "pairs", sizeof(ob_pair_key), 0, PAIRS_MAX },
	[AREA_RECORDS] = { "contact points", sizeof(ob_saved_record), 0, PAIRS_MAX },
	[AREA_SCRIPT_TURNS] = { "scripts' schedule", sizeof(ob_script_turn), 0, OBJECTS_MAX },
	[AREA_SCRIPT_CELLS] = { "scripts' state", sizeof(ob_script_cell), 0, OBJECTS_MAX },
	[AREA_SCRIPT_TEXTS] = { "scripts", 1, 0, SCRIPTS_MAX },
	[AREA_HULLS] = { "hulls", sizeof(ob_hull_corners), 0, OB_SCENE_HULLS_MAX },
	[AREA_PULLS] = { "pulls", sizeof(ob_pull), 0, OB_PULLS_MAX },
	[AREA_PATHS] = { "paths", sizeof(ob_given_path), 0, OB_GIVEN_PATHS_MAX },
	[AREA_PATH_POINTS] = { "points of paths", sizeof(ob_path_point), 0, OB_GIVEN_POINTS_MAX },
	[AREA_JOINTS] = { "joints", sizeof(ob_saved_joint), 0, JOINTS_MAX },
	[AREA_SENSORS] = { "sensors", sizeof(ob_sensor_cell), 0, OB_SENSORS_MAX },
	[AREA_SAMPLES] = { "samples of sensors", sizeof(double), 0, OB_SENSOR_NUMBERS_MAX },
};

// Points the arrays into the file's memory.
static void bind(ob_saved_run *r, const ob_checkpoint_file *f)
{
	ob_saved_universe *u = &r->host.universe;
	r->host.population.slot = f->area[AREA_SLOTS].at;
	u->passport = f->area[AREA_PASSPORTS].at;
	u->motion = f->area[AREA_MOTIONS].at;
	u->schedule = f->area[AREA_SCHEDULE].at;
	u->bounds = f->area[AREA_BOUNDS].at;
	u->neighbours = f->area[AREA_NEIGHBOURS].at;
	u->plane = f->area[AREA_PLANES].at;
	u->pair = f->area[AREA_PAIRS].at;
	u->record = f->area[AREA_RECORDS].at;
	u->script_turn = f->area[AREA_SCRIPT_TURNS].at;
	u->script_cell = f->area[AREA_SCRIPT_CELLS].at;
	u->script_text = f->area[AREA_SCRIPT_TEXTS].at;
	r->host.population.hull = f->area[AREA_HULLS].at;
	r->host.population.pull = f->area[AREA_PULLS].at;
	r->host.population.path = f->area[AREA_PATHS].at;
	r->host.population.point = f->area[AREA_PATH_POINTS].at;
	u->joint = f->area[AREA_JOINTS].at;
	u->sensor_cell = f->area[AREA_SENSORS].at;
	u->sensor_value = f->area[AREA_SAMPLES].at;
}

// ---- saving

static uint64_t defines_bytes(const ob_scene_options *o)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < o->define_count; i++)
		sum += strlen(o->defines[i]) + 1;
	return sum;
}

static void fill(const ob_saved_run *r, const ob_checkpoint_file *f)
{
	const facts all = { .created = r->created,
			    .step = r->host.universe.step,
			    .events = r->host.population.events,
			    .seed = r->options.seed,
			    .has_seed = r->options.has_seed,
			    .checked = r->host.universe.checked,
			    .duration = r->duration,
			    .settings = r->settings,
			    .figures = r->figures };
	memcpy(f->area[AREA_FACTS].at, &all, sizeof all);
	strcpy(f->area[AREA_SCENE].at, r->scene);
	memcpy(f->area[AREA_TEXT].at, r->text, r->text_size);
	char *define = f->area[AREA_DEFINES].at;
	for (uint32_t i = 0; i < r->options.define_count; i++)
		define = stpcpy(define, r->options.defines[i]) + 1;
	memcpy(f->area[AREA_COUNTERS].at, &r->host.counters, sizeof r->host.counters);
}

bool ob_saved_run_make(ob_saved_run *r, ob_checkpoint_file *f, ob_host *h, const char *program, ob_error *e)
{
	const ob_saved_universe *u = &r->host.universe;
	struct timespec now;
	if (!ob_host_count_saved(h, &r->host))
		return ob_fail(e, "the run does not stand between two steps");
	clock_gettime(CLOCK_REALTIME, &now);
	r->created = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
	uint64_t count[AREAS] = { [AREA_FACTS] = 1,
				  [AREA_SCENE] = strlen(r->scene) + 1,
				  [AREA_TEXT] = r->text_size,
				  [AREA_DEFINES] = defines_bytes(&r->options),
				  [AREA_COUNTERS] = 1,
				  [AREA_SLOTS] = r->host.population.count,
				  [AREA_PASSPORTS] = u->ids,
				  [AREA_MOTIONS] = u->ids,
				  [AREA_SCHEDULE] = u->ids,
				  [AREA_BOUNDS] = u->ids,
				  [AREA_NEIGHBOURS] = u->ids,
				  [AREA_PLANES] = u->planes,
				  [AREA_PAIRS] = u->pairs,
				  [AREA_RECORDS] = u->records,
				  [AREA_SCRIPT_TURNS] = u->script_cells,
				  [AREA_SCRIPT_CELLS] = u->script_cells,
				  [AREA_SCRIPT_TEXTS] = u->script_bytes,
				  [AREA_HULLS] = r->host.population.hulls,
				  [AREA_PULLS] = r->host.population.pulls,
				  [AREA_PATHS] = r->host.population.paths,
				  [AREA_PATH_POINTS] = r->host.population.points,
				  [AREA_JOINTS] = u->joints,
				  [AREA_SENSORS] = u->sensors,
				  [AREA_SAMPLES] = u->sensor_numbers };
	for (int i = 0; i < AREAS; i++)
		if (count[i] > rules[i].most)
			return ob_fail(e, "a checkpoint has no room for so many %s", rules[i].name);
	if (!ob_checkpoint_plan(f, rules, AREAS, count, program, e))
		return false;
	bind(r, f);
	ob_host_save(h, &r->host);
	fill(r, f);
	return true;
}

// ---- opening

static bool lengths_agree(const ob_checkpoint_file *f)
{
	const uint64_t ids = f->area[AREA_PASSPORTS].count;
	for (int i = AREA_PASSPORTS; i <= AREA_NEIGHBOURS; i++)
		if (f->area[i].count != ids)
			return false;
	if (f->area[AREA_SCRIPT_TURNS].count != f->area[AREA_SCRIPT_CELLS].count)
		return false;
	return f->area[AREA_PLANES].count <= ids && f->area[AREA_RECORDS].count <= f->area[AREA_PAIRS].count &&
	       ids <= f->area[AREA_SLOTS].count;
}

static bool open_facts(ob_saved_run *r, const ob_checkpoint_file *f, const char *name, ob_error *e)
{
	facts all;
	ob_error why;
	memcpy(&all, f->area[AREA_FACTS].at, sizeof all);
	r->created = all.created;
	r->options = (ob_scene_options){ .has_seed = all.has_seed, .seed = all.seed };
	r->duration = all.duration;
	r->settings = all.settings;
	r->figures = all.figures;
	r->host.universe.step = all.step;
	r->host.universe.checked = all.checked;
	r->host.population.events = all.events;
	if (!ob_run_settings_check(&r->settings, &why))
		return ob_fail(e, "%s: this checkpoint is damaged: %s", name, why.text);
	if (!(r->duration > 0 && r->duration <= 1e9) || all.has_seed > 1 || all.figures.started > 1 ||
	    all.figures.each_step > 1)
		return ob_fail(e, "%s: this checkpoint is damaged: its settings make no sense", name);
	return true;
}

static bool open_scene(ob_saved_run *r, const ob_checkpoint_file *f, const char *name, ob_error *e)
{
	const ob_checkpoint_area *path = &f->area[AREA_SCENE], *defines = &f->area[AREA_DEFINES];
	const char *text = defines->at, *end = text + defines->count;
	r->scene = path->at;
	r->text = f->area[AREA_TEXT].at;
	r->text_size = f->area[AREA_TEXT].count;
	if (strnlen(r->scene, path->count) != path->count - 1 || (text < end && end[-1]))
		return ob_fail(e, "%s: this checkpoint is damaged: its scene's name or parameters make no sense", name);
	ob_utf8_make_plain(path->at);
	for (const char *at = text; at < end; at += strlen(at) + 1)
		r->options.define_count++;
	r->defines = calloc(r->options.define_count + 1, sizeof *r->defines);
	if (!r->defines)
		return ob_fail(e, "%s: no memory", name);
	for (uint32_t i = 0; i < r->options.define_count; i++, text += strlen(text) + 1)
		r->defines[i] = text;
	r->options.defines = r->defines;
	return true;
}

static bool open_universe(ob_saved_run *r, const ob_checkpoint_file *f, const char *name, ob_error *e)
{
	ob_saved_universe *u = &r->host.universe;
	ob_error why;
	if (!lengths_agree(f))
		return ob_fail(e, "%s: this checkpoint is damaged: the lengths of its parts do not agree", name);
	bind(r, f);
	u->ids = (uint32_t)f->area[AREA_PASSPORTS].count;
	u->planes = (uint32_t)f->area[AREA_PLANES].count;
	u->pairs = (uint32_t)f->area[AREA_PAIRS].count;
	u->records = (uint32_t)f->area[AREA_RECORDS].count;
	u->script_cells = (uint32_t)f->area[AREA_SCRIPT_TURNS].count;
	u->script_bytes = (uint32_t)f->area[AREA_SCRIPT_TEXTS].count;
	r->host.population.count = (uint32_t)f->area[AREA_SLOTS].count;
	r->host.population.hulls = (uint32_t)f->area[AREA_HULLS].count;
	r->host.population.pulls = (uint32_t)f->area[AREA_PULLS].count;
	r->host.population.paths = (uint32_t)f->area[AREA_PATHS].count;
	r->host.population.points = (uint32_t)f->area[AREA_PATH_POINTS].count;
	u->joints = (uint32_t)f->area[AREA_JOINTS].count;
	u->sensors = (uint32_t)f->area[AREA_SENSORS].count;
	u->sensor_numbers = (uint32_t)f->area[AREA_SAMPLES].count;
	memcpy(&r->host.counters, f->area[AREA_COUNTERS].at, sizeof r->host.counters);
	return ob_saved_universe_check(u, &why) || ob_fail(e, "%s: this checkpoint is damaged: %s", name, why.text);
}

static bool open_parts(ob_saved_run *r, ob_checkpoint_file *f, const char *name, ob_error *e)
{
	*r = (ob_saved_run){ 0 };
	if (open_facts(r, f, name, e) && open_scene(r, f, name, e) && open_universe(r, f, name, e))
		return true;
	ob_saved_run_close(r, f);
	return false;
}

bool ob_saved_run_open(ob_saved_run *r, ob_checkpoint_file *f, const char *path, ob_error *e)
{
	return ob_checkpoint_read(f, rules, AREAS, path, e) && open_parts(r, f, path, e);
}

bool ob_saved_run_parse(ob_saved_run *r, ob_checkpoint_file *f, const void *bytes, size_t size, const char *name,
			ob_error *e)
{
	return ob_checkpoint_parse(f, rules, AREAS, bytes, size, name, e) && open_parts(r, f, name, e);
}

ob_scene *ob_saved_run_open_with_scene(ob_saved_run *r, ob_checkpoint_file *f, const char *path, ob_error *e)
{
	ob_budget_begin();
	ob_scene *s = ob_saved_run_open(r, f, path, e)
			      ? ob_scene_load_text(r->scene, r->text, r->text_size, &r->options, e)
			      : NULL;
	ob_budget_end();
	return s;
}

void ob_saved_run_close(ob_saved_run *r, ob_checkpoint_file *f)
{
	free(r->defines);
	*r = (ob_saved_run){ 0 };
	ob_checkpoint_finish(f);
}
