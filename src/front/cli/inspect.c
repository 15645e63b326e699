// obsim inspect: the contents of a checkpoint.
#include <inttypes.h>
#include <string.h>
#include <time.h>

#include "base/utf8.h"
#include "checkpoint/saved_run.h"
#include "cli/command.h"
#include "cli/quantity.h"
#include "experiment/json.h"
#include "measure/measure.h"

// Figures derived from the file's contents.
typedef struct summary {
	uint64_t objects, bodies, asleep, touching;
	double time; // s
	char state_hash[17], created[32];
} summary;

static void summarize(const ob_saved_run *r, summary *out)
{
	const ob_saved_universe *u = &r->host.universe;
	const ob_snapshot now = { .step = u->step,
				  .time = (double)u->step * r->settings.step_length,
				  .count = u->ids,
				  .passport = u->passport,
				  .motion = u->motion };
	*out = (summary){ .time = now.time };
	for (uint32_t id = 0; id < u->ids; id++) {
		bool present = u->passport[id].flags & OB_OBJECT_PRESENT;
		out->objects += present;
		out->bodies += present && !(u->passport[id].flags & OB_OBJECT_PRESCRIBED);
		out->asleep += present && u->motion[id].flags & OB_MOTION_ASLEEP;
	}
	for (uint32_t i = 0; i < u->pairs; i++)
		out->touching += u->pair[i].active;
	snprintf(out->state_hash, sizeof out->state_hash, "%016" PRIx64, ob_measure_hash(&now));
	time_t seconds = (time_t)(r->created / 1000000000u);
	struct tm utc;
	if (gmtime_r(&seconds, &utc))
		strftime(out->created, sizeof out->created, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

static void print_settings(const ob_run_settings *s, FILE *f)
{
	ob_quantity q;
	fprintf(f, "  settings     %s, %s, %s, steps of %g s, ", ob_setting_print(s, OB_SETTING_SOLVER).text,
		ob_setting_print(s, OB_SETTING_INTEGRATOR).text, ob_setting_print(s, OB_SETTING_NARROW_PHASE).text,
		s->step_length);
	if (s->tolerance > 0)
		fprintf(f, "tolerance %s, ", ob_quantity_text(&q, s->tolerance, "m"));
	fprintf(f, "%" PRIu32 " substeps of up to %" PRIu32 " iterations, sleeping %s\n", s->substeps, s->iterations,
		ob_setting_print(s, OB_SETTING_SLEEPING).text);
}

static void print(const char *path, const ob_saved_run *r, const ob_checkpoint_file *file, const summary *s)
{
	const ob_saved_universe *u = &r->host.universe;
	ob_quantity bytes;
	printf("%s: a whole checkpoint, %s, version %d, of %s by obsim %s\n", path,
	       ob_quantity_text(&bytes, (double)file->size, "B"), OB_CHECKPOINT_VERSION, s->created, file->program);
	printf("  scene        %s", r->scene);
	for (uint32_t i = 0; i < r->options.define_count; i++) {
		char define[256];
		snprintf(define, sizeof define, "%s", r->options.defines[i]);
		ob_utf8_make_plain(define);
		printf(", -D %s", define);
	}
	if (r->options.has_seed)
		printf(", --seed %" PRIu64, r->options.seed);
	printf(" (%zu bytes of Lua)\n", r->text_size);
	printf("  time         %g s of %g s, step %" PRIu64 "\n", s->time, r->duration, u->step);
	printf("  objects      %" PRIu64 ", of which %" PRIu64 " move and %" PRIu64 " sleep; %" PRIu32
	       " pairs near each other, %" PRIu64 " touch\n",
	       s->objects, s->bodies, s->asleep, u->pairs, s->touching);
	print_settings(&r->settings, stdout);
	printf("  state        %s\n", s->state_hash);
}

static void print_json_settings(const ob_run_settings *s, ob_json *j)
{
	for (int i = 0; i < OB_RUN_SETTINGS; i++) {
		const ob_setting *t = &ob_setting_table[i];
		const void *at = (const char *)s + t->offset;
		if (t->kind == OB_SETTING_REAL)
			ob_json_number(j, t->name, *(const double *)at);
		else if (t->kind == OB_SETTING_COUNT)
			ob_json_count(j, t->name, *(const uint32_t *)at);
		else
			ob_json_string(j, t->name, ob_setting_print(s, (ob_setting_id)i).text);
	}
}

static void print_json(const char *path, const ob_saved_run *r, const ob_checkpoint_file *file, const summary *s)
{
	const ob_saved_universe *u = &r->host.universe;
	ob_json j = { .f = stdout };
	ob_json_open(&j, NULL);
	ob_json_string(&j, "file", path);
	ob_json_count(&j, "bytes", file->size);
	ob_json_count(&j, "version", OB_CHECKPOINT_VERSION);
	ob_json_string(&j, "program", file->program);
	ob_json_string(&j, "created", s->created);
	ob_json_string(&j, "scene", r->scene);
	ob_json_count(&j, "scene_bytes", r->text_size);
	ob_json_open_list(&j, "defines");
	for (uint32_t i = 0; i < r->options.define_count; i++)
		ob_json_string(&j, NULL, r->options.defines[i]);
	ob_json_close_list(&j);
	if (r->options.has_seed)
		ob_json_count(&j, "seed", r->options.seed);
	else
		ob_json_null(&j, "seed");
	ob_json_count(&j, "steps", u->step);
	ob_json_number(&j, "simulated_s", s->time);
	ob_json_number(&j, "duration_s", r->duration);
	ob_json_count(&j, "objects", s->objects);
	ob_json_count(&j, "bodies", s->bodies);
	ob_json_count(&j, "asleep", s->asleep);
	ob_json_count(&j, "pairs", u->pairs);
	ob_json_count(&j, "touching_pairs", s->touching);
	print_json_settings(&r->settings, &j);
	ob_json_string(&j, "state_hash", s->state_hash);
	ob_json_close(&j);
}

int ob_command_inspect(const ob_arguments *a)
{
	ob_error e;
	ob_saved_run run;
	ob_checkpoint_file file = { 0 };
	summary s;
	if (!a->operand)
		return ob_command_fail(OB_EXIT_USAGE, "no checkpoint given: obsim inspect FILE");
	if (!ob_saved_run_open(&run, &file, a->operand, &e)) {
		ob_checkpoint_finish(&file);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	summarize(&run, &s);
	if (a->value[OB_OPTION_JSON_OUT])
		print_json(a->operand, &run, &file, &s);
	else
		print(a->operand, &run, &file, &s);
	ob_saved_run_close(&run, &file);
	return OB_EXIT_OK;
}
