#include "cli/led_run.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/log.h"
#include "checkpoint/saved_run.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "cli/version.h"
#include "host/host.h"
#include "table/table.h"

// ---- the scene

// Inside, the caller is the only worker.
static bool take_inside(ob_run_request *q, const ob_arguments *a, ob_error *e)
{
	if (q->isolation_given || q->harden)
		return ob_fail(e, "inside: the program is the only worker: leave --%s away",
			       q->isolation_given ? "isolation" : "harden");
	q->isolation = OB_ISOLATION_INSIDE;
	q->workers = a->value[OB_OPTION_WORKERS] ? q->workers : 1;
	return true;
}

static bool load(ob_led_run *r, bool inside, ob_error *e)
{
	ob_run_request *q = &r->q;
	if (!ob_request_read(q, r->a, e) || (inside && !take_inside(q, r->a, e)) ||
	    !ob_number_count("room", r->a->value[OB_OPTION_ROOM], 0, 1000000, &r->room, e))
		return false;
	if (!q->resume) {
		snprintf(r->path, sizeof r->path, "%s", q->scene);
		q->scene = r->path;
		r->scene = ob_scene_load(q->scene, &q->scene_options, e);
		return r->scene && ob_request_resolve(q, r->scene, e);
	}
	r->scene = ob_saved_run_open_with_scene(&r->saved, &r->saved_file, q->resume, e);
	return r->scene && ob_request_resume(q, &r->saved, r->scene, e);
}

static void forget_defines(const char **defines, uint32_t first, uint32_t count)
{
	for (uint32_t i = first; i < count; i++)
		free((char *)defines[i]);
	free(defines);
}

// Copies the parameters so far, and those of a reset behind them, where they count.
static const char **add_defines(const ob_led_run *r, const char *words, uint32_t count)
{
	const ob_scene_options *o = &r->q.scene_options;
	const uint32_t first = o->define_count - r->own;
	const char **all = calloc(o->define_count + count + 1, sizeof *all);
	bool fine = all;
	for (uint32_t i = 0; fine && i < o->define_count + count; i++) {
		const char *word = i < o->define_count ? o->defines[i] : words;
		words += i < o->define_count ? 0 : strlen(words) + 1;
		all[i] = i < first ? word : strdup(word);
		fine = all[i];
	}
	if (fine || !all)
		return all;
	forget_defines(all, first, o->define_count + count);
	return NULL;
}

// ---- the record

static void end_record(ob_led_run *r)
{
	ob_error e;
	if (!ob_recorder_close(r->recorder, &e))
		ob_log_warn("%s", e.text);
	r->recorder = NULL;
}

// Records the state where the run stands, if it is the next one. Those that are put back are in the record already.
static bool record(ob_led_run *r, ob_error *e)
{
	const ob_universe *u = ob_host_universe(r->host);
	const uint64_t step = ob_step_count(u), every = r->scene->record_every;
	if (!r->recorder || step % every || (r->recorded != UINT64_MAX && step != r->recorded + every))
		return true;
	r->recorded = step;
	return ob_snapshot_take(&r->now, u, 0, e) && ob_recorder_sense(r->recorder, u, e) &&
	       ob_recorder_append(r->recorder, &r->now, e);
}

// Runs to a step, and records the states on the way. A program that calls ends the way.
static bool go(ob_led_run *r, uint64_t step, ob_error *e)
{
	const ob_universe *u = ob_host_universe(r->host);
	uint64_t next;
	do {
		next = (ob_step_count(u) / r->scene->record_every + 1) * r->scene->record_every;
		next = r->recorder && next < step ? next : step;
		ob_host_go(r->host, next);
		if (!ob_host_wait(r->host, e) || !record(r, e))
			return false;
	} while (next < step && ob_step_count(u) == next);
	return true;
}

// ---- the run

bool ob_led_run_start(ob_led_run *r, ob_error *e)
{
	ob_host_config config = ob_request_host(&r->q);
	config.control = r->control;
	config.spare = (uint32_t)r->room;
	config.from = r->saved.host.universe.ids ? &r->saved.host : NULL;
	r->host = ob_host_start(r->scene, &config, e);
	if (!r->host)
		return false;
	ob_warn_of_overlap(r->host);
	r->step = ob_step_count(ob_host_universe(r->host));
	end_record(r);
	r->recorded = UINT64_MAX;
	if (r->q.record && !(r->recorder = ob_request_record(&r->q, r->scene, ob_host_universe(r->host), e)))
		return false;
	return go(r, r->step, e);
}

// Begins the run anew, as a reset wants it. false and e: the run has ended.
static bool reset(ob_led_run *r, ob_error *e)
{
	uint32_t words;
	const uint64_t *seed;
	const char *word = ob_control_words(r->control, &words, &seed);
	ob_run_request q = r->q;
	ob_scene_options *o = &q.scene_options;
	const uint32_t first = o->define_count - r->own;
	const char **defines = add_defines(r, word, words);
	o->defines = defines;
	o->define_count += words;
	o->has_seed |= seed != NULL;
	o->seed = seed ? *seed : o->seed;
	ob_scene *scene = !defines   ? NULL
			  : q.resume ? ob_scene_load_text(q.scene, r->scene->text, r->scene->text_size, o, e)
				     : ob_scene_load(q.scene, o, e);
	if (!defines)
		ob_fail(e, "out of memory");
	if (!scene || (!q.resume && !ob_request_resolve(&q, scene, e))) {
		ob_scene_free(scene);
		if (defines)
			forget_defines(defines, first, o->define_count);
		ob_control_reply(r->control, r->host, e);
		return true;
	}
	ob_host_stop(r->host);
	ob_scene_free(r->scene);
	if (r->defines)
		forget_defines(r->defines, first, r->q.scene_options.define_count);
	r->q = q;
	r->scene = scene;
	r->defines = defines;
	r->own += words;
	r->saved.host.universe.ids = 0; // from the scene's start
	return ob_led_run_start(r, e);
}

// Saves the run as it stands, and answers.
static void save(ob_led_run *r)
{
	uint32_t words;
	const uint64_t *seed;
	ob_error e;
	const char *path = ob_control_words(r->control, &words, &seed);
	const bool fine = ob_save_led_run(&r->q, r->scene, r->host, path, &e);
	ob_control_reply(r->control, r->host, fine ? NULL : &e);
}

// Last step that the run may make; a motion carries its step as 32 bits.
static uint64_t last_step(const ob_led_run *r)
{
	return r->a->value[OB_OPTION_DURATION] ? ob_request_steps(r->q.duration, r->q.run.step_length) : UINT32_MAX - 2;
}

bool ob_led_run_load(ob_led_run *r, const ob_arguments *a, bool inside, ob_error *e)
{
	*r = (ob_led_run){ .a = a, .room = 1000 };
	if (!load(r, inside, e))
		return false;
	r->control = ob_control_create(inside, e);
	return r->control;
}

bool ob_led_run_go_on(ob_led_run *r, ob_error *e)
{
	for (;;) {
		switch (ob_control_next(r->control, r->host, last_step(r), &r->step)) {
		case OB_CONTROL_LEFT:
			return true;
		case OB_CONTROL_GOES_ON:
			break;
		case OB_CONTROL_SAVES:
			save(r);
			break;
		case OB_CONTROL_RESETS:
			if (!reset(r, e))
				return false;
			break;
		}
		if (r->q.isolation == OB_ISOLATION_INSIDE && ob_control_answered(r->control))
			return true;
		if (!go(r, r->step, e))
			return false;
	}
}

void ob_led_run_finish(ob_led_run *r)
{
	end_record(r);
	ob_snapshot_finish(&r->now);
	ob_host_stop(r->host);
	ob_control_destroy(r->control);
	ob_scene_free(r->scene);
	if (r->defines)
		forget_defines(r->defines, r->q.scene_options.define_count - r->own, r->q.scene_options.define_count);
	ob_saved_run_close(&r->saved, &r->saved_file);
}

// ---- control

// obsim control: one scene that a program leads step by step (include/ob/control.h).

static int carry_out(ob_led_run *r)
{
	ob_error e;
	bool fine = ob_led_run_start(r, &e);
	if (fine) {
		printf("%s waits as universe \"%s\" for a program to control it.\n", r->scene->title,
		       ob_universe_name(ob_host_universe(r->host)));
		fflush(stdout);
		fine = ob_led_run_go_on(r, &e);
	}
	if (fine)
		return OB_EXIT_OK;
	ob_control_end(r->control, e.text);
	return ob_command_fail(r->host && ob_host_broke_invariant(r->host) ? OB_EXIT_BROKEN : OB_EXIT_FAILED, e.text);
}

int ob_command_control(const ob_arguments *a)
{
	ob_led_run r;
	ob_error e;
	if (!ob_led_run_load(&r, a, false, &e)) {
		ob_led_run_finish(&r);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const int code = carry_out(&r);
	ob_led_run_finish(&r);
	ob_interrupt_release();
	return code;
}

// ---- save

bool ob_save_led_run(const ob_run_request *r, const ob_scene *s, ob_host *h, const char *path, ob_error *e)
{
	ob_checkpoint_file f = { 0 };
	ob_saved_run now = { .scene = r->scene,
			     .text = s->text,
			     .text_size = s->text_size,
			     .options = r->scene_options,
			     .duration = r->duration,
			     .settings = r->run };
	now.settings.timed = now.settings.freezes = now.settings.budget = now.settings.verify = 0;
	now.settings.fault = (ob_fault_plan){ 0 };
	bool fine = !r->run.monolith || ob_fail(e, "the one ODE world cannot be saved: take object simulators");
	fine = fine && ob_output_fits("save", path, 0, e);
	fine = fine && ob_saved_run_make(&now, &f, h, ob_version_words, e);
	if (fine) {
		ob_checkpoint_seal(&f);
		fine = ob_checkpoint_write(&f, path, e);
	}
	ob_checkpoint_finish(&f);
	return fine;
}
