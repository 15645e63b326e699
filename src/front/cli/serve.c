// obsim serve: one scene that runs while people view and change it in their browsers.
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "cli/led_run.h"
#include "cli/version.h"
#include "measure/measure.h"
#include "record/record.h"
#include "serve/facts.h"
#include "serve/film.h"
#include "serve/serve.h"

// ---- rerun

// Logs of requests (host/request_log.h): their heads, states, and the run that carries them out again.

enum { STATE_EVERY = 10 }; // steps

// Returns the head of a log of this run. spare: slots for objects added on request.
static ob_request_log_head rerun_head(const ob_run_request *r, const ob_scene *s, uint32_t spare)
{
	ob_request_log_head head = {
		.run = r->run, .seed = s->seed, .objects = s->objects, .spare = spare, .on_death = r->on_death
	};
	head.run.fault = (ob_fault_plan){ 0 };
	head.run.timed = head.run.verify = 0;
	return head;
}

static bool hash_of(const ob_host *h, uint64_t *hash, ob_error *e)
{
	ob_snapshot now = { 0 };
	const bool fine = ob_snapshot_take(&now, ob_host_universe(h), 0, e);
	if (fine)
		*hash = ob_measure_hash(&now);
	ob_snapshot_finish(&now);
	return fine;
}

// Logs the state if step *next has come, and advances *next. The universe stands still at a step boundary. log NULL:
// does nothing.
static void rerun_log_state(ob_request_log *log, const ob_host *h, uint64_t *next)
{
	const uint64_t step = ob_step_count(ob_host_universe(h));
	uint64_t hash;
	ob_error e;
	if (log && step >= *next && hash_of(h, &hash, &e)) {
		*next = step + STATE_EVERY;
		ob_request_log_state(log, step, hash);
	}
}

// Runs from state to state of the log. false and e: the run failed, or reached a different state.
static bool compare_states(ob_host *h, const ob_logged_requests *l, ob_error *e)
{
	uint64_t hash = 0;
	ob_host_go(h, 0);
	if (!ob_host_wait(h, e))
		return false;
	for (uint32_t i = 0; i < l->states; i++) {
		ob_host_go(h, l->state[i].step);
		if (!ob_host_wait(h, e) || !hash_of(h, &hash, e))
			return false;
		if (hash != l->state[i].hash)
			return ob_fail(e, "step %" PRIu64 ": state %016" PRIx64 ", the log has %016" PRIx64,
				       l->state[i].step, hash, l->state[i].hash);
	}
	printf("%u requests carried out again, %u objects frozen; %u states equal those of the log, the last "
	       "%016" PRIx64 " after step %" PRIu64 "\n",
	       l->requests, l->freezes, l->states, hash, l->states ? l->state[l->states - 1].step : 0);
	return true;
}

// Refuses options without effect: a replay ends with the log, and writes no files.
static bool check_options(const ob_arguments *a, ob_error *e)
{
	const uint64_t useless = OB_BIT(OB_OPTION_DURATION) | OB_BIT(OB_OPTION_PICTURES) | OB_BIT(OB_OPTION_RECORD) |
				 OB_BIT(OB_OPTION_SERIES) | OB_BIT(OB_OPTION_JSON) | OB_BIT(OB_OPTION_REPORT) |
				 OB_BIT(OB_OPTION_TRACE) | OB_BIT(OB_OPTION_EXPLAIN) | OB_BIT(OB_OPTION_RESUME) |
				 OB_BIT(OB_OPTION_CHECKPOINT) | OB_BIT(OB_OPTION_ON_DEATH);
	return ob_options_refuse(a, useless, 0,
				 ": --replay-requests does as the log says, and writes nothing; leave it away", e);
}

static bool prepare(const ob_arguments *a, ob_run_request *q, ob_scene **scene, ob_logged_requests *l, ob_error *e)
{
	const char *path = a->value[OB_OPTION_REPLAY_REQUESTS];
	if (!check_options(a, e) || !ob_request_read(q, a, e) || !ob_request_log_read(l, path, e))
		return false;
	*scene = ob_scene_load(q->scene, &q->scene_options, e);
	if (!*scene || !ob_request_resolve(q, *scene, e))
		return false;
	q->on_death = l->head.on_death <= OB_ON_DEATH_KEEP ? (ob_on_death)l->head.on_death : q->on_death;
	const ob_request_log_head own = rerun_head(q, *scene, l->head.spare);
	return memcmp(&own, &l->head, sizeof own) == 0 ||
	       ob_fail(e, "%s: it is of another scene, seed, -D or settings: give those of the run that was logged",
		       path);
}

int ob_command_rerun(const ob_arguments *a)
{
	ob_run_request q = { 0 };
	ob_logged_requests l = { 0 };
	ob_scene *scene = NULL;
	ob_error e;
	int code = OB_EXIT_OK;
	if (!prepare(a, &q, &scene, &l, &e)) {
		code = ob_command_fail(OB_EXIT_USAGE, e.text);
	} else {
		ob_host_config config = ob_request_host(&q);
		config.spare = l.head.spare;
		config.replay = &l;
		ob_interrupt_watch();
		ob_host *h = ob_host_start(scene, &config, &e);
		if (!h || !compare_states(h, &l, &e))
			code = ob_command_fail(h && ob_host_broke_invariant(h) ? OB_EXIT_BROKEN : OB_EXIT_FAILED,
					       e.text);
		ob_host_stop(h);
		ob_interrupt_release();
	}
	ob_logged_requests_finish(&l);
	ob_scene_free(scene);
	return code;
}

// ---- serve

static const double patience = .05; // s, in which requests are taken while no step is due
static const double go_time = .02; // s that the universe runs between checks if it cannot keep its pace
static const uint64_t paced_steps = 8; // in one go at least, if paced: it is not further behind at a usual rate
// Work of an island, in units of 2^15, with one more for each object of the scene: a quarter of a second of a core. Visitors
// wait for each other's objects.
static const uint32_t shared_budget = 256;
static const double free_window = .25; // s, of a free run: changes take effect when all simulators have come so far

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
					  .foxglove = a->value[OB_OPTION_FOXGLOVE] != NULL,
					  .viewers = 64,
					  .version = ob_version_commit },
			      .room = 1000,
			      .paused = a->value[OB_OPTION_PAUSED] != NULL };
	return ob_request_read(&q->run, a, e) &&
	       ob_listen_read(&q->server.listen, listen ? listen : "127.0.0.1:8080", e) &&
	       read_count(a, OB_OPTION_VIEWERS, 10000, &q->server.viewers, e) &&
	       read_count(a, OB_OPTION_ROOM, 1000000, &q->room, e);
}

typedef struct ob_define {
	char text[OB_NAME_MAX + 32]; // "name=value"
} ob_define;

// A run that is served. Parameters and a seed that visitors have set replace it by another one.
typedef struct serving {
	const ob_arguments *a; // from the command line
	ob_arguments own; // with what visitors have set; define is its own
	ob_define *set; // [sets], those parameters
	uint32_t sets;
	char seed[24]; // likewise; "": none
	const char *fixed; // why the scene cannot start anew; NULL: it can
	serve_request q;
	ob_scene *scene;
	ob_host *host;
	ob_pace *pace; // clock of this run and its successors
	ob_server *server;
	ob_recorder *recorder; // NULL: none
	ob_snapshot shown; // the latest recorded one
	uint64_t recorded; // its step; UINT64_MAX: none
	uint64_t last; // step at which the run ends
} serving;

static bool load(serving *s, ob_error *e)
{
	ob_run_request *q = &s->q.run;
	s->scene = ob_scene_load(q->scene, &q->scene_options, e);
	s->q.server.scene = s->scene;
	// a motion carries its step as 32 bits
	s->last = UINT32_MAX - 2;
	if (!s->scene || !ob_request_resolve(q, s->scene, e))
		return false;
	if (!s->a->value[OB_OPTION_ON_DEATH] && !q->run.monolith && !q->is_free) // none can be frozen
		q->on_death = OB_ON_DEATH_KEEP;
	if (s->a->value[OB_OPTION_DURATION])
		s->last = ob_request_steps(q->duration, q->run.step_length);
	else
		q->free.end = INFINITY;
	s->fixed = q->record                             ? "it is recorded (--record)"
		   : s->a->value[OB_OPTION_LOG_REQUESTS] ? "its requests are logged (--log-requests)"
		   : s->scene->meshes                    ? "viewers have its meshes already"
							 : NULL;
	s->q.server.fixed = s->fixed;
	s->q.server.saves = q->checkpoint;
	return true;
}

static bool start(serving *s, ob_error *e)
{
	const ob_run_request *q = &s->q.run;
	ob_host_config config = ob_request_host(q);
	if (!s->a->value[OB_OPTION_ON_DEATH] && ob_on_death_freezes_failed(config.on_death))
		config.budget = shared_budget + s->scene->objects;
	config.free_window = free_window;
	config.spare = s->q.room;
	config.returns = !q->record;
	config.wishes = true;
	config.fixed = s->fixed;
	config.checkpoint = q->checkpoint;
	config.pace = s->pace;
	config.log = s->q.log;
	s->host = ob_host_start(s->scene, &config, e);
	if (!s->host || !q->record)
		return s->host;
	s->recorder = ob_request_record(q, s->scene, ob_host_universe(s->host), e);
	return s->recorder;
}

// Records the step that the universe has reached.
static bool record(serving *s, ob_error *e)
{
	const uint64_t step = ob_step_count(ob_host_universe(s->host));
	if (!s->recorder || step % s->scene->record_every != 0 || step == s->recorded)
		return true;
	s->recorded = step;
	return ob_recorder_sense(s->recorder, ob_host_universe(s->host), e) &&
	       ob_snapshot_take(&s->shown, ob_host_universe(s->host), 0, e) &&
	       ob_recorder_append(s->recorder, &s->shown, e);
}

// Copies the parameters that visitors have set, with another one, unless it is NULL, in place of its former value.
static bool keep_parameter(serving *s, const ob_define *wish, ob_error *e)
{
	const size_t name = wish ? strcspn(wish->text, "=") + 1 : 0;
	const ob_define *before = s->set;
	uint32_t i = 0;
	s->set = calloc(s->sets + 1, sizeof *s->set);
	if (!s->set)
		return ob_fail(e, "out of memory");
	if (s->sets)
		memcpy(s->set, before, s->sets * sizeof *before);
	if (!wish)
		return true;
	while (i < s->sets && strncmp(s->set[i].text, wish->text, name) != 0)
		i++;
	s->sets += i == s->sets;
	s->set[i] = *wish;
	return true;
}

// Makes the arguments of the next run: those of the command line, and behind them what visitors have set.
static bool make_arguments(const serving *s, ob_arguments *own, ob_error *e)
{
	*own = *s->a;
	own->define = calloc(s->a->defines + s->sets + 1, sizeof *own->define);
	if (!own->define)
		return ob_fail(e, "out of memory");
	for (uint32_t i = 0; i < s->a->defines; i++)
		own->define[i] = s->a->define[i];
	for (uint32_t i = 0; i < s->sets; i++)
		own->define[own->defines++] = s->set[i].text;
	if (*s->seed)
		own->value[OB_OPTION_SEED] = s->seed;
	return true;
}

// Notes what a visitor has set. false and e: out of memory.
static bool keep_wish(serving *s, const ob_request *wish, ob_error *e)
{
	ob_define define;
	if (wish->kind == OB_REQUEST_SEED) {
		snprintf(s->seed, sizeof s->seed, "%llu", (unsigned long long)wish->seed);
		return keep_parameter(s, NULL, e);
	}
	const int n = snprintf(define.text, sizeof define.text, "%s", (const char *)wish->values);
	return n < (int)sizeof define.text ? keep_parameter(s, &define, e)
					   : ob_fail(e, "set: expected a shorter number");
}

// Starts the scene anew, as an operator wishes. An invalid scene is told to viewers, and the run goes on. false and e: the
// next run cannot be started.
static bool start_anew(serving *s, const ob_request *wish, ob_error *e)
{
	serving next = *s;
	ob_error why;
	next.scene = NULL;
	next.own.define = NULL;
	if (!keep_wish(&next, wish, &why) || !make_arguments(&next, &next.own, &why) ||
	    !read_request(&next.q, &next.own, &why) || !load(&next, &why)) {
		ob_scene_free(next.scene);
		free(next.own.define);
		free(next.set);
		ob_server_tell(s->server, ob_facts_notice(why.text));
		return true;
	}
	ob_server_hold(s->server);
	ob_host_stop(s->host);
	ob_scene_free(s->scene);
	free(s->own.define);
	free(s->set);
	*s = next;
	ob_pace_restart(s->pace);
	return start(s, e) && ob_server_go_on(s->server, s->scene, &s->host, e);
}

// Saves the run as a checkpoint, and tells viewers.
static void save(serving *s, const ob_request *wish)
{
	const char *asked = (const char *)wish->values, *path = *asked ? asked : s->q.run.checkpoint;
	ob_error text;
	if (ob_save_led_run(&s->q.run, s->scene, s->host, path, &text))
		ob_fail(&text, "a checkpoint of %.2f s is saved as %s",
			(double)ob_step_count(ob_host_universe(s->host)) * s->q.run.run.step_length, path);
	ob_server_tell(s->server, ob_facts_notice(text.text));
}

// Returns the next step of a free run, whose simulators follow the clock themselves; while paused, steps that are allowed.
static uint64_t pace_free(serving *s, uint64_t done)
{
	const ob_pace_state pace = ob_pace_get(s->pace);
	const uint64_t due =
		pace.paused ? ob_pace_wait(s->pace, done, s->q.run.run.step_length, 1, patience) : done + 1;
	ob_host_set_pace(s->host, pace.paused ? 0 : pace.rate, due);
	return due;
}

// Lets the run go to the next step that is due, for a while at most. Returns that step.
static uint64_t go_on(serving *s, uint64_t done, uint64_t *batch, bool *at_once)
{
	const uint64_t every = s->scene->record_every, state = s->recorder ? (done / every + 1) * every : UINT64_MAX;
	const uint64_t paced = *batch < paced_steps ? paced_steps : *batch;
	uint64_t due = s->q.run.is_free ? pace_free(s, done)
					: ob_pace_wait(s->pace, done, s->q.run.run.step_length,
						       paced < state - done ? paced : state - done, patience);
	const uint64_t most = due < UINT64_MAX ? paced : *batch;
	*at_once = due > done + most && done < s->last;
	due = *at_once ? done + most : due;
	due = due < s->last ? due : s->last;
	due = due < state ? due : state;
	if (done == s->last) { // the end is reached, and viewers stay
		ob_host_finish(s->host);
		nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * patience) }, NULL);
	}
	ob_host_go(s->host, due); // while no step is due, requests are still taken
	return due;
}

// Runs the universe at its pace until Ctrl-C. After the duration's end it stands still for viewers.
static bool live(serving *s, ob_error *e)
{
	uint64_t done = 0, batch = 1, next_state = 0;
	ob_request wish;
	double began = ob_clock_wall();
	bool at_once = false;
	ob_host_go(s->host, 0);
	while (ob_host_wait(s->host, e) && record(s, e)) {
		double took = ob_clock_wall() - began;
		rerun_log_state(s->q.log, s->host, &next_state);
		const bool wished = ob_host_take_wish(s->host, &wish);
		if (wished && wish.kind == OB_REQUEST_SAVE) {
			save(s, &wish);
		} else if (wished) {
			if (!start_anew(s, &wish, e))
				return false;
			done = 0;
			ob_host_go(s->host, 0);
			continue;
		}
		if (ob_host_operate(s->host)) {
			done = ob_step_count(ob_host_universe(s->host));
			ob_pace_restart(s->pace);
		}
		if (at_once && took < .5 * go_time)
			batch *= 2;
		else if (took > 2 * go_time && batch > 1)
			batch /= 2;
		began = ob_clock_wall();
		done = go_on(s, done, &batch, &at_once);
	}
	return s->host && ob_host_interrupted(s->host);
}

static int carry_out(serving *s)
{
	ob_error e;
	bool ended = false;
	ob_warn_of_overlap(s->host);
	s->server = ob_server_start(&s->q.server, &s->host, 1, s->pace, &e);
	if (s->server) {
		printf("%s is at %s\n", s->q.server.scene->title, ob_server_url(s->server, OB_ROLE_OPERATE));
		for (ob_role r = OB_ROLE_OPERATE; r-- > OB_ROLE_WATCH;)
			if (*ob_server_url(s->server, r))
				printf("To %s: %s\n", ob_role_name(r), ob_server_url(s->server, r));
		printf("Ctrl-C ends it.\n");
		fflush(stdout);
		ended = live(s, &e);
	}
	ob_server_stop(s->server);
	const int failed = s->host && ob_host_broke_invariant(s->host) ? OB_EXIT_BROKEN : OB_EXIT_FAILED;
	return ended ? OB_EXIT_OK : ob_command_fail(failed, e.text);
}

// Serves until Ctrl-C
static int show_film(const serve_request *q, ob_error *e)
{
	ob_server *server = ob_server_start(&q->server, NULL, 0, NULL, e);
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
	const char *listen = a->value[OB_OPTION_LISTEN];
	*q = (serve_request){ .server = { .look_only = true, .version = ob_version_commit } };
	return ob_request_check_replay(a, OB_BIT(OB_OPTION_REPLAY) | OB_BIT(OB_OPTION_LISTEN),
				       OB_BIT(OB_SETTING_PATIENCE), e) &&
	       ob_listen_read(&q->server.listen, listen ? listen : "127.0.0.1:8080", e);
}

static int serve_replay(const ob_arguments *a)
{
	serve_request q;
	ob_error e;
	const char *path = a->value[OB_OPTION_REPLAY];
	ob_settings asked = { .patience = OB_FILM_SECONDS };
	const bool fine =
		ob_serve_check(&e) && read_replay_request(&q, a, &e) && ob_request_read_settings(&asked, a, &e);
	ob_recording *r = fine ? ob_recording_open(path, &e) : NULL;
	ob_message *film = r ? ob_film_make(r, path, asked.patience, &e) : NULL;
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
	ob_pace pace;
	serving s = { .a = a, .recorded = UINT64_MAX, .pace = &pace };
	ob_error e;
	if (!ob_serve_check(&e) || !read_request(&s.q, a, &e) || !load(&s, &e)) {
		ob_scene_free(s.scene);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const char *path = a->value[OB_OPTION_LOG_REQUESTS];
	const ob_request_log_head head = rerun_head(&s.q.run, s.scene, s.q.room);
	s.q.log = path ? ob_request_log_create(path, &head, &e) : NULL;
	ob_pace_begin(&pace, s.q.run.pace, s.q.paused);
	int code = (!path || s.q.log) && start(&s, &e) ? carry_out(&s) : ob_command_fail(OB_EXIT_FAILED, e.text);
	if (s.recorder && !ob_recorder_close(s.recorder, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_snapshot_finish(&s.shown);
	ob_host_stop(s.host);
	ob_pace_end(&pace);
	if (!ob_request_log_close(s.q.log, &e))
		code = ob_command_fail(OB_EXIT_FAILED, e.text);
	ob_interrupt_release();
	ob_scene_free(s.scene);
	free(s.own.define);
	free(s.set);
	return code;
}
