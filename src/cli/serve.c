// obsim serve: one scene that runs while people view and change it in their browsers.
#include "serve/serve.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "cli/rerun.h"
#include "cli/version.h"
#include "serve/film.h"

static const double patience = .05; // s, in which requests are taken while no step is due
static const double go_time = .02; // s that the universe runs between checks if it is not paced

typedef struct serve_request {
	ob_run_request run;
	ob_server_config server;
	uint32_t room; // for objects that viewers add
	bool paused;
	ob_request_log *log; // NULL: none
} serve_request;

static bool read_count(const ob_arguments *a, ob_option_id id, uint32_t most, uint32_t *out, ob_error *e)
{
	uint64_t n = *out;
	bool fine = ob_number_count(ob_option_table[id].name, a->value[id], id == OB_OPTION_VIEWERS, most, &n, e);
	*out = (uint32_t)n;
	return fine;
}

static bool read_request(serve_request *q, const ob_arguments *a, ob_error *e)
{
	const char *listen = a->value[OB_OPTION_LISTEN];
	*q = (serve_request){ .server = { .look_only = a->value[OB_OPTION_READONLY] != NULL,
					  .viewers = 64,
					  .version = ob_version_commit },
			      .room = 1000,
			      .paused = a->value[OB_OPTION_PAUSED] != NULL };
	return ob_request_read(&q->run, a, e) &&
	       ob_listen_read(&q->server.listen, listen ? listen : "127.0.0.1:8080", e) &&
	       read_count(a, OB_OPTION_VIEWERS, 10000, &q->server.viewers, e) &&
	       read_count(a, OB_OPTION_ROOM, 1000000, &q->room, e);
}

// Runs the universe at its pace until Ctrl-C. After the duration's end it stands still for viewers.
static bool live(ob_host *h, ob_pace *pace, const serve_request *s, uint64_t last, ob_error *e)
{
	const ob_run_request *q = &s->run;
	uint64_t done = 0, batch = 1, next_state = 0;
	double began = ob_clock_wall();
	bool at_once = false;
	ob_host_go(h, 0);
	while (ob_host_wait(h, e)) {
		double took = ob_clock_wall() - began;
		ob_rerun_log_state(s->log, h, &next_state);
		if (ob_host_operate(h)) {
			done = ob_step_count(ob_host_universe(h));
			ob_pace_restart(pace);
		}
		if (at_once && took < .5 * go_time)
			batch *= 2;
		else if (took > 2 * go_time && batch > 1)
			batch /= 2;
		uint64_t due = ob_pace_wait(pace, done, q->run.step_length, patience);
		at_once = due == UINT64_MAX && done < last;
		due = at_once ? done + batch : due;
		due = due < last ? due : last;
		if (done == last) { // the end is reached, and viewers stay
			ob_host_finish(h);
			nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * patience) }, NULL);
		}
		began = ob_clock_wall();
		ob_host_go(h, due); // while no step is due, requests are still taken
		done = due;
	}
	return ob_host_interrupted(h);
}

static int carry_out(ob_host *h, const serve_request *q, uint64_t last)
{
	ob_error e;
	ob_pace pace;
	bool ended = false;
	ob_warn_of_overlap(h);
	ob_pace_begin(&pace, q->run.pace, q->paused);
	ob_server *server = ob_server_start(&q->server, h, &pace, &e);
	if (server) {
		printf("%s is at %s\n", q->server.scene->title, ob_server_url(server, OB_ROLE_OPERATE));
		for (ob_role r = OB_ROLE_OPERATE; r-- > OB_ROLE_WATCH;)
			if (*ob_server_url(server, r))
				printf("To %s: %s\n", ob_role_name(r), ob_server_url(server, r));
		printf("Ctrl-C ends it.\n");
		fflush(stdout);
		ended = live(h, &pace, q, last, &e);
	}
	ob_server_stop(server);
	ob_pace_end(&pace);
	const int failed = ob_host_broke_invariant(h) ? OB_EXIT_BROKEN : OB_EXIT_FAILED;
	return ended ? OB_EXIT_OK : ob_command_fail(failed, e.text);
}

// Serves until Ctrl-C
static int show_film(const serve_request *q, ob_error *e)
{
	ob_server *server = ob_server_start(&q->server, NULL, NULL, e);
	if (!server)
		return ob_command_fail(OB_EXIT_FAILED, e->text);
	printf("%s, recorded, is at %s\nCtrl-C ends it.\n", q->server.scene->title,
	       ob_server_url(server, OB_ROLE_OPERATE));
	fflush(stdout);
	while (!ob_interrupt_came())
		nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * patience) }, NULL);
	ob_server_stop(server);
	return OB_EXIT_OK;
}

static bool read_replay_request(serve_request *q, const ob_arguments *a, ob_error *e)
{
	static const ob_option_id allowed[] = { OB_OPTION_REPLAY, OB_OPTION_LISTEN, OB_OPTION_PATIENCE };
	const char *listen = a->value[OB_OPTION_LISTEN];
	*q = (serve_request){ .server = { .look_only = true, .version = ob_version_commit } };
	return ob_request_check_replay(a, allowed, sizeof allowed / sizeof *allowed, e) &&
	       ob_listen_read(&q->server.listen, listen ? listen : "127.0.0.1:8080", e);
}

static int serve_replay(const ob_arguments *a)
{
	serve_request q;
	ob_error e;
	const char *path = a->value[OB_OPTION_REPLAY];
	double seconds = OB_FILM_SECONDS;
	const bool fine =
		ob_serve_check(&e) && read_replay_request(&q, a, &e) && ob_request_read_patience(a, &seconds, &e);
	ob_recording *r = fine ? ob_recording_open(path, &e) : NULL;
	ob_message *film = r ? ob_film_make(r, path, seconds, &e) : NULL;
	int code;
	if (film) {
		q.server.scene = &ob_recording_get_info(r)->scene;
		q.server.film = film;
		signal(SIGPIPE, SIG_IGN);
		ob_interrupt_watch();
		code = show_film(&q, &e);
		ob_interrupt_release();
	} else {
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	ob_message_release(film);
	ob_recording_close(r);
	return code;
}

int ob_command_serve(const ob_arguments *a)
{
	if (a->value[OB_OPTION_REPLAY])
		return serve_replay(a);
	serve_request q;
	ob_error e;
	if (!ob_serve_check(&e) || !read_request(&q, a, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	ob_scene *scene = ob_scene_load(q.run.scene, &q.run.scene_options, &e);
	if (!scene || !ob_request_resolve(&q.run, scene, &e)) {
		ob_scene_free(scene);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	q.server.scene = scene;
	ob_host_config config = ob_request_host(&q.run);
	if (!a->value[OB_OPTION_ON_DEATH] && !config.run.monolith && !scene->scripts) // neither can be frozen
		config.on_death = OB_ON_DEATH_KEEP;
	config.spare = q.room;
	config.returns = true;
	// a motion carries its step as 32 bits
	uint64_t last =
		a->value[OB_OPTION_DURATION] ? ob_request_steps(q.run.duration, q.run.run.step_length) : UINT32_MAX - 2;
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const char *path = a->value[OB_OPTION_LOG_REQUESTS];
	const ob_request_log_head head = ob_rerun_head(&q.run, scene, q.room);
	config.log = q.log = path ? ob_request_log_create(path, &head, &e) : NULL;
	ob_host *h = !path || q.log ? ob_host_start(scene, &config, &e) : NULL;
	int code = h ? carry_out(h, &q, last) : ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_host_stop(h);
	if (!ob_request_log_close(q.log, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_interrupt_release();
	ob_scene_free(scene);
	return code;
}
