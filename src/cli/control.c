// obsim control: one scene that a program leads step by step (include/ob/control.h).
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/log.h"
#include "checkpoint/saved_run.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "cli/save.h"
#include "host/control.h"
#include "host/host.h"
#include "table/table.h"

typedef struct led_run {
	const ob_arguments *a;
	ob_run_request q;
	ob_scene *scene;
	uint64_t room; // for objects that the program adds
	const char *
		*defines; // [q.scene_options.define_count], with words of their own behind those of the command line
	uint32_t own; // words of their own
	ob_saved_run saved; // start of a resumed run; else zeroed
	ob_checkpoint_file saved_file; // storage of saved
	ob_control *control;
	ob_host *host;
} led_run;

// ---- the scene

static bool load(led_run *r, ob_error *e)
{
	ob_run_request *q = &r->q;
	if (!ob_request_read(q, r->a, e) ||
	    !ob_number_count("room", r->a->value[OB_OPTION_ROOM], 0, 1000000, &r->room, e))
		return false;
	if (!q->resume) {
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
static const char **add_defines(const led_run *r, const char *words, uint32_t count)
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

// ---- the run

static bool start(led_run *r, ob_error *e)
{
	ob_host_config config = ob_request_host(&r->q);
	config.control = r->control;
	config.spare = (uint32_t)r->room;
	config.from = r->saved.host.universe.ids ? &r->saved.host : NULL;
	r->host = ob_host_start(r->scene, &config, e);
	if (r->host)
		ob_warn_of_overlap(r->host);
	return r->host;
}

// Begins the run anew, as a reset wants it. false and e: the run has ended.
static bool reset(led_run *r, ob_error *e)
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
	return start(r, e);
}

// Saves the run as it stands, and answers.
static void save(led_run *r)
{
	uint32_t words;
	const uint64_t *seed;
	ob_error e;
	const char *path = ob_control_words(r->control, &words, &seed);
	const bool fine = ob_save_led_run(&r->q, r->scene, r->host, path, &e);
	ob_control_reply(r->control, r->host, fine ? NULL : &e);
}

// Last step that the run may make; a motion carries its step as 32 bits.
static uint64_t last_step(const led_run *r)
{
	return r->a->value[OB_OPTION_DURATION] ? ob_request_steps(r->q.duration, r->q.run.step_length) : UINT32_MAX - 2;
}

// Leads the run until the program leaves. false and e: it has failed, or was interrupted.
static bool lead(led_run *r, ob_error *e)
{
	uint64_t step = ob_step_count(ob_host_universe(r->host));
	for (;;) {
		ob_host_go(r->host, step);
		if (!ob_host_wait(r->host, e))
			return false;
		switch (ob_control_next(r->control, r->host, last_step(r), &step)) {
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
			step = ob_step_count(ob_host_universe(r->host));
			break;
		}
	}
}

static int carry_out(led_run *r)
{
	ob_error e;
	bool fine = start(r, &e);
	if (fine) {
		printf("%s waits as universe \"%s\" for a program to control it.\n", r->scene->title,
		       ob_universe_name(ob_host_universe(r->host)));
		fflush(stdout);
		fine = lead(r, &e);
	}
	if (fine)
		return OB_EXIT_OK;
	ob_control_end(r->control, e.text);
	return ob_command_fail(r->host && ob_host_broke_invariant(r->host) ? OB_EXIT_BROKEN : OB_EXIT_FAILED, e.text);
}

static void finish(led_run *r)
{
	ob_control_destroy(r->control);
	ob_scene_free(r->scene);
	if (r->defines)
		forget_defines(r->defines, r->q.scene_options.define_count - r->own, r->q.scene_options.define_count);
	ob_saved_run_close(&r->saved, &r->saved_file);
}

int ob_command_control(const ob_arguments *a)
{
	led_run r = { .a = a, .room = 1000 };
	ob_error e;
	r.control = load(&r, &e) ? ob_control_create(&e) : NULL;
	if (!r.control) {
		finish(&r);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const int code = carry_out(&r);
	ob_host_stop(r.host);
	ob_interrupt_release();
	finish(&r);
	return code;
}
