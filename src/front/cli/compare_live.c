// obsim compare --live: the scene in several worlds at once, on one page. Each is a run of its own: a universe with a host and
// workers. They take turns, step by step, so that each has all cores, and none goes on before all are at one instant.
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "cli/command.h"
#include "cli/request.h"
#include "cli/version.h"
#include "host/pace.h"
#include "measure/measure.h"
#include "serve/facts.h"
#include "serve/serve.h"

static const double patience = .05; // s, in which requests are taken while no step is due
static const double interval = .1; // s, between two messages with the figures

typedef struct kind {
	const char *name; // in words, before the number of workers
	const char *worker, *workers; // one and several; NULL: the number is not told
	const char *arch, *isolation, *sync; // as the options of obsim run; NULL: not given
} kind;
static const kind usual[] = { { "One ODE world", NULL, NULL, "monolith", "thread", "lockstep" },
			      { "Simulators in", "thread", "threads", NULL, "thread", "lockstep" },
			      { "Simulators in", "process", "processes", NULL, "process", "lockstep" } },
		  syncs[] = { { "In lockstep,", "thread", "threads", NULL, "thread", "lockstep" },
			      { "Free running,", "thread", "threads", NULL, "thread", "free" } };

typedef struct world {
	const kind *kind;
	char name[OB_NAME_MAX]; // of its universe
	ob_run_request q;
	ob_host *host;
	ob_snapshot now;
	double bodies_s; // simulated time of all bodies together
	double deepest; // m; NaN: too much work to measure
	ob_penetration depth; // at this step
	double *each; // [objects], m: deepest of each, over steps until a message has told it
	uint32_t objects;
	bool told;
} world;

typedef struct comparison {
	ob_scene *scene;
	ob_pace pace;
	world world[OB_SERVER_WORLDS];
	uint32_t worlds;
	double step; // s
	uint64_t last; // step at which all end
	char seed[24]; // that visitors have set
	ob_server *server;
	double told_at; // s
} comparison;

static bool check(const ob_arguments *a, ob_error *e)
{
	const uint64_t refused = OB_BIT(OB_OPTION_VARY) | OB_BIT(OB_OPTION_HARDEN) | OB_BIT(OB_OPTION_JSON) |
				 OB_BIT(OB_OPTION_REPEATS) | OB_BIT(OB_OPTION_SEEDS) | OB_BIT(OB_OPTION_OUT) |
				 OB_BIT(OB_OPTION_FRESH);
	const char *sync = a->setting[OB_SETTING_SYNC];
	if (!a->operand)
		return ob_fail(e, "no scene given: obsim compare --live falling_boxes");
	if (!ob_options_refuse(a, refused, 0, " does not go with --live, which shows one run of each: leave it away",
			       e))
		return false;
	return !sync || strchr(sync, ',') ||
	       ob_fail(e, "--sync %s: compare runs both ways: expected --sync lockstep,free", sync);
}

// Reads the request for a world: the options of the command line, without those that a monolith has not.
static bool read_world(world *w, const ob_arguments *a, ob_error *e)
{
	ob_arguments own = *a;
	own.command = OB_COMMAND_SERVE;
	own.setting[OB_SETTING_ARCHITECTURE] = w->kind->arch;
	own.value[OB_OPTION_ISOLATION] = w->kind->isolation;
	own.setting[OB_SETTING_SYNC] = w->kind->sync;
	for (int i = 0; w->kind == usual && i < OB_SETTINGS; i++)
		if (ob_setting_table[i].flags & OB_SETTING_OBJECTS)
			own.setting[i] = NULL;
	if (w->kind == usual)
		own.value[OB_OPTION_WORKERS] = NULL;
	return ob_request_read(&w->q, &own, e);
}

static bool start_world(comparison *c, uint32_t i, ob_error *e)
{
	world *w = &c->world[i];
	if (!ob_request_resolve(&w->q, c->scene, e))
		return false;
	ob_host_config config = ob_request_host(&w->q);
	snprintf(w->name, sizeof w->name, "obsim-%d-%u", (int)getpid(), i + 1);
	config.name = w->name;
	config.pace = &c->pace;
	config.wishes = true;
	w->host = ob_host_start(c->scene, &config, e);
	return w->host;
}

// Starts all, processes first: they are forked before there are threads. A scene that ODE cannot hold is compared without it.
static bool start(comparison *c, const ob_arguments *a, ob_error *e)
{
	const bool sync = a->setting[OB_SETTING_SYNC];
	const kind *const kinds = sync ? syncs : usual;
	c->worlds = sync ? sizeof syncs / sizeof *syncs : sizeof usual / sizeof *usual;
	for (uint32_t i = 0; i < c->worlds; i++) {
		c->world[i].kind = &kinds[i];
		if (!read_world(&c->world[i], a, e))
			return false;
	}
	c->scene = ob_scene_load(c->world->q.scene, &c->world->q.scene_options, e);
	for (uint32_t i = c->scene ? c->worlds : 0; i-- > 0;) {
		if (start_world(c, i, e))
			continue;
		if (i > 0 || sync)
			return false;
		ob_log_warn("without the one ODE world: %s", e->text);
		memmove(c->world, c->world + 1, --c->worlds * sizeof *c->world);
		c->world[c->worlds] = (world){ 0 };
	}
	if (!c->scene)
		return false;
	c->step = c->world->q.run.step_length;
	c->last = ob_request_steps(c->world->q.duration, c->step);
	return true;
}

static bool is_interrupted(void *host)
{
	return ob_host_interrupted(host);
}

// Takes and measures the state of a step.
static bool measure(world *w, ob_error *e)
{
	ob_error why;
	const double before = w->now.time;
	if (!ob_snapshot_take(&w->now, ob_host_universe(w->host), 0, e))
		return false;
	if (w->told || w->now.count > w->objects) {
		free(w->each);
		w->each = calloc(w->now.count, sizeof *w->each);
		w->objects = w->now.count;
		w->told = false;
	}
	if (!w->each)
		return ob_fail(e, "out of memory");
	for (uint32_t i = 0; i < w->now.count; i++)
		if ((w->now.passport[i].flags & (OB_OBJECT_PRESENT | OB_OBJECT_PRESCRIBED)) == OB_OBJECT_PRESENT)
			w->bodies_s += w->now.time - before;
	if (!isnan(w->deepest) && !ob_measure_depths(&w->now, w->each, &w->depth, is_interrupted, w->host, &why) &&
	    !ob_host_interrupted(w->host))
		ob_log_warn("%s: penetration is not measured from here on: %s", w->kind->name, why.text);
	w->deepest = w->depth.max_m > w->deepest || isnan(w->depth.max_m) ? w->depth.max_m : w->deepest;
	return true;
}

// Lets a world go to a step, in its turn, and measures it. A world that is there takes requests.
static bool turn(world *w, uint64_t step, ob_error *e)
{
	if (w->q.is_free)
		ob_host_set_pace(w->host, 0, step);
	ob_host_go(w->host, step);
	if (!ob_host_wait(w->host, e))
		return false;
	return step == w->now.step || measure(w, e);
}

static void put_number(ob_message *m, const char *name, double x)
{
	ob_message_print(m, isfinite(x) ? "\"%s\":%.17g," : "\"%s\":null,", name, x);
}

static void put_world(ob_message *m, world *w, double tolerance)
{
	ob_universe_info info;
	ob_host_times times;
	const char *separator = "";
	ob_host_get_times(w->host, &times);
	ob_universe_get_info(ob_host_universe(w->host), &info);
	ob_message_print(m, "{\"name\":\"%s", w->kind->name);
	if (w->kind->worker)
		ob_message_print(m, " %u %s", info.workers, info.workers == 1 ? w->kind->worker : w->kind->workers);
	ob_message_print(m, "\",");
	put_number(m, "time", w->now.time);
	put_number(m, "cpu", times.cpu_s / w->bodies_s);
	put_number(m, "depth", w->depth.max_m);
	put_number(m, "deepest", w->deepest);
	ob_message_print(m, "\"deep\":[");
	for (uint32_t i = 0; i < w->objects; i++) {
		if (w->each[i] > tolerance) {
			ob_message_print(m, "%s[%u,%.4g]", separator, i, w->each[i]);
			separator = ",";
		}
	}
	w->told = true;
	ob_message_print(m, "]}");
}

// Sends the page the figures of all worlds, which stand at one instant.
static void tell(comparison *c, uint64_t done)
{
	double tolerance = 0; // of those that have one
	for (uint32_t i = 0; i < c->worlds; i++)
		tolerance = fmax(tolerance, c->world[i].q.run.tolerance);
	tolerance = tolerance > 0 ? tolerance : OB_DEFAULT_TOLERANCE;
	ob_message *m = ob_message_new(true);
	if (!m)
		return;
	ob_message_print(m, "{\"comparison\":{\"ended\":%s,", done == c->last ? "true" : "false");
	put_number(m, "tolerance", tolerance);
	ob_message_print(m, "\"worlds\":[");
	for (uint32_t i = 0; i < c->worlds; i++) {
		ob_message_print(m, i ? "," : "");
		put_world(m, &c->world[i], tolerance);
	}
	ob_message_print(m, "]}}");
	ob_server_tell(c->server, m);
	c->told_at = ob_clock_wall();
}

// True if a visitor wishes another seed, or the same again.
static bool takes_seed(comparison *c)
{
	ob_request wish;
	bool taken = false;
	for (uint32_t i = 0; i < c->worlds; i++) {
		while (ob_host_take_wish(c->world[i].host, &wish)) {
			taken |= wish.kind == OB_REQUEST_SEED;
			if (wish.kind == OB_REQUEST_SEED)
				snprintf(c->seed, sizeof c->seed, "%llu", (unsigned long long)wish.seed);
			else
				ob_server_tell(c->server, ob_facts_notice("here only the seed can be set"));
		}
	}
	return taken;
}

// Runs all worlds at the pace until they are to start anew. false and e: Ctrl-C, or one failed.
static bool live(comparison *c, ob_error *e)
{
	bool goes = false;
	for (uint64_t done = 0; !takes_seed(c); done += goes) {
		const bool ended = done == c->last;
		goes = !ended && ob_pace_wait(&c->pace, done, c->step, 1, patience) > done;
		if (ended)
			nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * patience) }, NULL);
		for (uint32_t i = 0; i < c->worlds; i++) {
			if (ended)
				ob_host_finish(c->world[i].host);
			if (!turn(&c->world[i], done + goes, e))
				return false;
		}
		if (ob_clock_wall() > c->told_at + interval)
			tell(c, done + goes);
	}
	return true;
}

// Starts the server with the worlds, or lets it go on with them.
static bool serve(comparison *c, ob_server_config *server, ob_error *e)
{
	ob_host *host[OB_SERVER_WORLDS];
	server->scene = c->scene;
	for (uint32_t i = 0; i < c->worlds; i++) {
		host[i] = c->world[i].host;
		ob_host_go(host[i], 0);
		if (!ob_host_wait(host[i], e) || !measure(&c->world[i], e))
			return false;
	}
	if (c->server)
		return ob_server_go_on(c->server, c->scene, host, e);
	c->server = ob_server_start(server, host, c->worlds, &c->pace, e);
	if (!c->server)
		return false;
	printf("%s, %u worlds side by side, is at %s\nCtrl-C ends it.\n", c->scene->title, c->worlds,
	       ob_server_url(c->server, OB_ROLE_OPERATE));
	fflush(stdout);
	return true;
}

static void stop(comparison *c)
{
	for (uint32_t i = 0; i < c->worlds; i++) {
		ob_host_stop(c->world[i].host);
		ob_snapshot_finish(&c->world[i].now);
		free(c->world[i].each);
		c->world[i] = (world){ 0 };
	}
	ob_scene_free(c->scene);
	c->scene = NULL;
}

// Runs the scene, and again as often as visitors wish.
static int carry_out(comparison *c, ob_arguments *a, ob_server_config *server)
{
	ob_error e;
	int failed = OB_EXIT_USAGE;
	while (start(c, a, &e)) {
		failed = OB_EXIT_FAILED;
		if (!serve(c, server, &e) || !live(c, &e))
			break;
		ob_server_hold(c->server);
		stop(c);
		a->value[OB_OPTION_SEED] = c->seed;
		ob_pace_restart(&c->pace);
		ob_pace_set_paused(&c->pace, false);
	}
	const bool interrupted = c->server && ob_interrupt_came();
	ob_server_stop(c->server);
	stop(c);
	return interrupted ? OB_EXIT_OK : ob_command_fail(failed, e.text);
}

int ob_command_compare_live(const ob_arguments *a)
{
	ob_error e;
	ob_arguments own = *a;
	ob_server_config server = { .viewers = 64, .version = ob_version_commit };
	const char *listen = a->value[OB_OPTION_LISTEN];
	if (!ob_serve_check(&e) || !check(a, &e) ||
	    !ob_listen_read(&server.listen, listen ? listen : "127.0.0.1:8080", &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	comparison c = { 0 };
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch();
	ob_pace_begin(&c.pace, 1, true); // the page lets it go
	const int code = carry_out(&c, &own, &server);
	ob_pace_end(&c.pace);
	ob_interrupt_release();
	return code;
}
