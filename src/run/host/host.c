#include "host/host.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "free/free.h"
#include "host/accounting.h"
#include "host/host_state.h"
#include "host/restart.h"
#include "ode/ode_body.h"
#include "ode/ode_world.h"
#include "scene/object_limits.h"
#include "step/sim.h"

enum { POOL_SPARE = 64, WORKERS_MAX = 100000 };
static const double default_patience = 60; // s
static const double rank_leave_timeout = 3600; // s: rank 0 may have much to write; the death of a rank ends the others
static const double interrupted_leave_timeout = .02; // s: Ctrl-C does not wait for the end of a long step

static bool has_outboxes(const ob_host_config *c)
{
	return c->harden & 1 << OB_HARDEN_OUTBOX;
}

// Refuses what cannot be done with joints.
static bool check_joints(const ob_scene *scene, const ob_host_config *c, ob_error *e)
{
	const ob_run_settings *r = &c->run, usual = ob_run_settings_default();
	const char *lacks = !scene->joints                                          ? NULL
			    : c->free                                               ? "sync: a free run"
			    : r->solver != usual.solver                             ? "solver: such a run"
			    : r->integrator != usual.integrator                     ? "integrator: such a run"
			    : r->narrow_phase != usual.narrow_phase && !r->monolith ? "narrow phase: such a run"
										    : NULL;
	return !lacks || ob_fail(e,
				 "%s has no joints, as this scene has: take simulators in lockstep, with the usual "
				 "methods",
				 lacks);
}

// Numbers that the universe keeps of all sensors.
static uint64_t sensor_numbers(const ob_scene *scene, const ob_host_config *c)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < scene->sensors; i++)
		sum += ob_sensor_room(&scene->sensor[i], c->run.step_length);
	return sum;
}

// Refuses what cannot be done with sensors.
static bool check_sensors(const ob_scene *scene, const ob_host_config *c, ob_error *e)
{
	if (scene->sensors && (c->free || c->ranks.ranks > 1))
		return ob_fail(e, "sensors: %s has none, as this scene has: take simulators in lockstep, on one rank",
			       c->free ? "a free run" : "a run of several ranks");
	if (sensor_numbers(scene, c) > OB_SENSOR_NUMBERS_MAX)
		return ob_fail(
			e,
			"sensors: their samples of a step, of their delays and those kept take above %d MiB: take "
			"lower rates, shorter delays or less to keep",
			OB_SENSOR_NUMBERS_MAX >> 17);
	return ob_cameras_check(scene, e);
}

// Refuses joints that ODE does not have.
static bool check_ode_joints(const ob_scene *scene, ob_error *e)
{
	for (uint32_t i = 0; i < scene->joints; i++)
		if (!ob_ode_has_joint(&scene->joint[i]))
			return ob_fail(
				e,
				"arch: the one ODE world has no joint as \"%s\": neither distances that change, "
				"nor armatures, nor two of friction, spring and motor along an axis; take object "
				"simulators",
				scene->joint[i].name);
	return true;
}

// Refuses what takes processes of its own.
static bool check_inside(const ob_host_config *c, ob_error *e)
{
	const char *lacks = c->workers != 1      ? "other workers"
			    : c->free            ? "free runs"
			    : c->ranks.ranks > 1 ? "ranks"
			    : c->trace           ? "traces"
						 : NULL;
	return !lacks || ob_fail(e, "inside: a run within a program has no %s; take one outside", lacks);
}

static bool check_config(const ob_scene *scene, const ob_host_config *c, ob_error *e)
{
	const ob_run_settings *r = &c->run;
	if (!(r->step_length > 0 && isfinite(r->step_length)))
		return ob_fail(e, "step: must be a positive number of seconds, is %g", r->step_length);
	if (r->substeps < 1)
		return ob_fail(e, "substeps: must be at least 1");
	if (r->tolerance > 0 && r->substeps > OB_MAX_SUBSTEPS)
		return ob_fail(e, "substeps: a tolerance chooses %d at most, not %u", OB_MAX_SUBSTEPS, r->substeps);
	if (c->workers > WORKERS_MAX ||
	    (c->workers == 0 && (uint64_t)scene->objects + c->spare + (scene->scripts ? scene->room : 0) > WORKERS_MAX))
		return ob_fail(e, "workers: at most %d, asked for %llu", WORKERS_MAX,
			       c->workers ? (unsigned long long)c->workers
					  : (unsigned long long)scene->objects + c->spare +
						    (scene->scripts ? scene->room : 0));
	if (c->isolation == OB_ISOLATION_INSIDE && !check_inside(c, e))
		return false;
	if (c->harden && (c->isolation != OB_ISOLATION_PROCESS || r->monolith))
		return ob_fail(e, "harden: only object simulators in processes can be contained");
	if (c->ranks.ranks > 1 && (!has_outboxes(c) || c->workers == 0 || c->on_death != OB_ON_DEATH_ABORT))
		return ob_fail(e, "ranks: take simulators in a pool, with outboxes, and let a death end the run");
	if (ob_on_death_freezes_failed(c->on_death) && r->monolith)
		return ob_fail(e, "on death: a monolith is one simulator, without which there is nothing to go on");
	if (c->limit.deaths > OB_RESTART_LIMIT_MAX || (c->limit.deaths && !(c->limit.seconds > 0)))
		return ob_fail(e, "restart limit: expected at most %d deaths in some seconds", OB_RESTART_LIMIT_MAX);
	if (r->monolith && scene->hulls > 0) // few of ODE's convex geometries collide with each other
		return ob_fail(e, "arch: the one ODE world has no hulls, as this scene has: take object simulators");
	if (!check_sensors(scene, c, e) || !check_joints(scene, c, e) || (r->monolith && !check_ode_joints(scene, e)))
		return false;
	for (uint32_t i = 0; i < scene->objects; i++) {
		if (!ob_object_check(&scene->object[i], e))
			return false;
	}
	return true;
}

// The soft limit is a default that a program may raise; the hard one is the administrator's.
static void raise_task_limit(void)
{
	struct rlimit r;
	if (getrlimit(RLIMIT_NPROC, &r) == 0 && r.rlim_cur < r.rlim_max) {
		r.rlim_cur = r.rlim_max;
		setrlimit(RLIMIT_NPROC, &r);
	}
}

// Returns the texts of all scripts with their directory, as the universe keeps them; NULL: no memory. The caller frees
// it.
static ob_script_directory *script_texts(const ob_scene *scene, uint32_t *bytes)
{
	uint32_t size = sizeof(ob_script_directory);
	for (uint32_t i = 0; i < scene->scripts; i++)
		size += scene->script[i].size;
	ob_script_directory *d = calloc(1, size);
	if (!d)
		return NULL;
	*bytes = size;
	d->scripts = scene->scripts;
	size = sizeof *d;
	for (uint32_t i = 0; i < scene->scripts; i++) {
		const ob_script_def *s = &scene->script[i];
		memcpy(d->text[i].name, s->name, sizeof d->text[i].name);
		d->text[i].offset = size;
		d->text[i].size = s->size;
		memcpy((char *)d + size, s->text, s->size);
		size += s->size;
	}
	return d;
}

static uint32_t scripted_objects(const ob_scene *scene)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < scene->objects; i++)
		n += scene->object[i].script > 0;
	return n;
}

// Workers of all ranks' pools: no more than objects that may exist, as an object has one worker at a time.
static uint32_t pool_workers(const ob_host_config *c, uint32_t capacity)
{
	const uint32_t ranks = c->ranks.ranks ? c->ranks.ranks : 1, most = (capacity + ranks - 1) / ranks;
	if (c->workers <= most)
		return c->workers * ranks;
	if (c->ranks.rank == 0)
		ob_log_note("%u workers for at most %u objects: %u are started, more would have nothing to do",
			    c->workers, capacity, most);
	return most * ranks;
}

// Room for as many joints more as for objects.
static uint32_t most_joints(const ob_scene *scene, const ob_host_config *c, uint32_t capacity)
{
	if (c->run.monolith || c->free)
		return scene->joints;
	const uint32_t most = scene->joints + capacity - scene->objects, saved = c->from ? c->from->universe.joints : 0;
	return most > saved ? most : saved;
}

static ob_universe *make_universe(const ob_scene *scene, const ob_host_config *c, const ob_spawn *spawn, ob_error *e)
{
	bool one_per_object = c->workers == 0 && !c->run.monolith;
	uint32_t spare = one_per_object || c->spare > POOL_SPARE ? c->spare : POOL_SPARE;
	if (scene->scripts)
		spare += scene->room;
	uint32_t capacity = scene->objects + spare > 0 ? scene->objects + spare : 1;
	if (c->from && c->from->population.count > capacity)
		capacity = c->from->population.count;
	ob_universe_setup setup = {
		.name = c->name,
		.capacity = capacity,
		.workers = one_per_object    ? capacity
			   : c->run.monolith ? 1
					     : pool_workers(c, capacity),
		.rank = c->ranks.rank,
		.ranks = c->ranks.ranks,
		.shares_contacts = c->shares_contacts,
		.hulls = c->run.monolith ? 0 : OB_SCENE_HULLS_MAX,
		.isolation = spawn->name,
		.terrains = scene->terrains,
		.traced = c->trace != NULL,
		.checked = c->check,
		.harden = c->harden,
		.run = c->run,
		.joints = most_joints(scene, c, capacity),
		.sensors = scene->sensors,
		.sensor_values = (uint32_t)sensor_numbers(scene, c),
	};
	setup.run.one_per_object = one_per_object;
	setup.run.freezes = ob_on_death_freezes_failed(c->on_death);
	setup.run.budget = c->budget;
	setup.workers += has_outboxes(c); // the arranger
	ob_free_settings settings;
	if (c->free) {
		settings = *c->free;
		settings.objects = scene->objects;
		setup.free = &settings;
		setup.history = ob_free_plan_depth(&settings, c->run.step_length, capacity);
	}
	ob_script_directory *texts = NULL;
	if (scene->scripts) {
		texts = script_texts(scene, &setup.script_bytes);
		if (!texts)
			return ob_fail(e, "out of memory"), NULL;
		if (spawn->pass && ob_script_count_foreign(texts, UINT32_MAX)) {
			free(texts);
			ob_fail(e, "inside: a run within a program has no FMUs; take one outside");
			return NULL;
		}
		setup.script_text = texts;
		setup.script_cells = scripted_objects(scene) + scene->room + (scene->avatar ? c->spare : 0);
		setup.script_cells += !setup.script_cells;
		if (c->from && c->from->universe.script_cells > setup.script_cells)
			setup.script_cells = c->from->universe.script_cells;
	}
	ob_universe *u = ob_universe_create(&setup, e);
	free(texts);
	return u;
}

static bool start_timeline(ob_host *h, const char *path, ob_error *e)
{
	h->timeline = path ? ob_timeline_start(h->u, path, e) : NULL;
	return !path || h->timeline;
}

static bool load(ob_host *h, const ob_saved_host *from, ob_error *e)
{
	if (!ob_universe_load(h->u, &from->universe, e) || !ob_population_load(h->population, &from->population, e))
		return false;
	ob_sim_restore(h->u);
	*ob_worker_counters(h->u, 0) = from->counters;
	return true;
}

static bool check_paths(const ob_scene *scene, double step_length, ob_error *e)
{
	uint32_t which = 0;
	for (uint32_t i = 0; i < scene->objects; i++) {
		const ob_path *path = scene->object[i].path;
		if (path && path->points && !ob_path_fits(path, step_length, &which))
			return ob_fail(e,
				       "object \"%s\": points %u and %u of its path are less than two steps of %g s "
				       "apart; take them apart, or try a smaller --step",
				       scene->object[i].passport.name, which, which + 1, step_length);
	}
	return true;
}

// Places the objects of the scene's start, or of the saved run.
static bool place_objects(ob_host *h, const ob_scene *scene, const ob_host_config *config, ob_error *e)
{
	const ob_saved_host *from = config->from;
	if (!check_paths(scene, ob_universe_settings(h->u)->step_length, e) ||
	    !ob_universe_reserve(h->u, scene->objects, e))
		return false;
	if (!ob_reserve_joints(h->u, scene->joints))
		return ob_fail(e, "/dev/shm is full: no room for the scene's joints");
	ob_ode_init();
	h->roster = ob_roster_create();
	h->requests = ob_requests_create();
	h->operations = ob_requests_create();
	h->wishes = ob_requests_create();
	h->blocks = calloc(h->workers, sizeof *h->blocks);
	h->restart.stalled = calloc(h->workers, sizeof *h->restart.stalled);
	if (!h->requests || !h->operations || !h->wishes || !h->roster || !h->blocks || !h->restart.stalled)
		return ob_fail(e, "out of memory");
	h->population = ob_population_create(scene, h->u, h->roster, e);
	if (!h->population)
		return false;
	ob_joints_write(h->u, scene->joint, scene->joints);
	ob_sensors_write(h->u, scene->sensor, scene->sensors);
	if (!from)
		ob_population_update(h->population, 0, h->requests);
	else if (!load(h, from, e))
		return false;
	h->log = config->log;
	ob_population_set_log(h->population, config->log);
	if (config->replay &&
	    (!ob_population_replay(h->population, config->replay->request, config->replay->requests) ||
	     !ob_restart_replay(h, config->replay)))
		return ob_fail(e, "out of memory");
	if (!config->free) { // a free simulator goes on alone where it had published
		ob_restart_prepare(h);
		ob_restart_checkpoint(h, false);
	}
	return true;
}

// Waits for all workers. Workers that die before they are ready are restarted, too.
static bool wait_until_ready(ob_host *h, ob_error *e)
{
	bool ready = ob_host_wait_for_workers(h, e);
	while (!ready && h->restart.requested && !h->failed)
		ready = ob_restart(h);
	if (!ready && h->failed)
		ob_fail(e, "%s", h->failure.text);
	return ready;
}

// Cameras come after all that forks.
static bool start_cameras(ob_host *h, ob_error *e)
{
	bool needed = false;
	for (uint32_t i = 0; i < h->scene->sensors; i++)
		needed |= h->scene->sensor[i].kind == OB_SENSOR_CAMERA;
	return !needed || (h->cameras = ob_cameras_create(h->scene, h->u, e));
}

static bool start_workers(ob_host *h, ob_error *e)
{
	const bool apart = !h->spawn->pass;
	if (apart)
		h->interrupt_fd = ob_interrupt_watch();
	if (apart && h->interrupt_fd < 0)
		return ob_fail(e, "cannot watch for signals: %s", strerror(errno));
	h->running_workers = 0;
	for (uint32_t w = 0; w < h->workers; w++)
		h->running_workers += apart && ob_worker_is_here(h->u, w);
	h->group = h->spawn->start(
		&(ob_worker_group_setup){ .u = h->u, .fork_server = h->fork_server, .run = ob_worker_live }, e);
	return h->group && (!apart || ob_supervisor_start(h, e)) && wait_until_ready(h, e);
}

ob_host *ob_host_start(const ob_scene *scene, const ob_host_config *config, ob_error *e)
{
	double began = ob_clock_wall();
	if (!check_config(scene, config, e))
		return NULL;
	ob_host *h = calloc(1, sizeof *h);
	if (!h) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	h->caller.fd = h->wake_fd = h->interrupt_fd = h->asked.events = h->asked.socket = -1;
	h->patience = config->patience > 0 ? config->patience : default_patience;
	h->saved = config->saved;
	h->free_end = config->free && isfinite(config->free->end)
			      ? (uint64_t)ceil(config->free->end / config->run.step_length - 1e-9)
			      : UINT64_MAX;
	h->free_window =
		config->free_window > 0 ? (uint64_t)ceil(config->free_window / config->run.step_length) : UINT64_MAX;
	h->free_pace = NAN; // none was set
	h->on_death = config->on_death;
	h->limit = config->limit;
	h->control = config->control;
	h->returns = config->returns;
	h->scene = scene;
	h->takes_wishes = config->wishes;
	h->fixed = config->fixed;
	h->checkpoint = config->checkpoint;
	h->pace = config->pace;
	h->spawn = config->isolation == OB_ISOLATION_PROCESS  ? &ob_spawn_processes
		   : config->isolation == OB_ISOLATION_INSIDE ? &ob_spawn_inside
							      : &ob_spawn_threads;
	pthread_mutex_init(&h->failure_lock, NULL);
	pthread_mutex_init(&h->interval.lock, NULL);
	if (!h->spawn->pass)
		raise_task_limit();
	h->u = make_universe(scene, config, h->spawn, e);
	h->workers = h->u ? ob_universe_workers(h->u) : 0;
	// the fork server first: it and its children inherit as little as possible
	h->fork_server = h->u && !h->spawn->pass ? ob_fork_server_start(h->u, ob_worker_live, h->patience, e) : NULL;
	if (!(h->fork_server || (h->u && h->spawn->pass)) || !start_timeline(h, config->trace, e) ||
	    !place_objects(h, scene, config, e) || !start_workers(h, e) || !start_cameras(h, e)) {
		ob_host_stop(h);
		return NULL;
	}
	h->startup = ob_clock_wall() - began;
	return h;
}

bool ob_host_interrupted(const ob_host *h)
{
	return h->interrupted;
}
bool ob_host_broke_invariant(const ob_host *h)
{
	return ob_step_failed(h->u, NULL) == OB_STEP_BROKEN;
}
const ob_universe *ob_host_universe(const ob_host *h)
{
	return h->u;
}
const ob_roster *ob_host_roster(const ob_host *h)
{
	return h->roster;
}

static void get_memory(const ob_host *h, ob_host_times *out)
{
	ob_worker_info info;
	for (uint32_t w = 0; w < h->workers && h->spawn->own_memory; w++) {
		if (ob_universe_get_worker(h->u, w, &info))
			out->worker_memory_bytes += ob_memory_of_process(info.pid);
	}
	out->memory_bytes = out->worker_memory_bytes + ob_memory_of_process(getpid()) +
			    ob_memory_of_process(ob_fork_server_pid(h->fork_server)) +
			    ob_memory_of_universe(ob_universe_name(h->u));
}

// True if workers count tasks. Contained simulators, and those of one object each, do not.
static bool has_task_times(const ob_universe *u)
{
	return !ob_universe_contains(u) && !ob_universe_settings(u)->one_per_object;
}

uint32_t ob_host_get_script_errors(ob_host *h, ob_script_error out[OB_SCRIPT_ERRORS_KEPT])
{
	return ob_script_log_first(&h->scripts, out, OB_SCRIPT_ERRORS_KEPT);
}

void ob_host_get_times(ob_host *h, ob_host_times *out)
{
	const ob_latency *steps = ob_step_latency(h->u);
	*out = (ob_host_times){
		.startup_s = h->startup,
		.wall_s = h->wall,
		.step_p50_s = ob_latency_percentile(steps, .5),
		.step_p90_s = ob_latency_percentile(steps, .9),
		.step_p99_s = ob_latency_percentile(steps, .99),
		.step_max_s = ob_latency_percentile(steps, 1),
		.critical_s = 1e-9 * (double)ob_critical_path(h->u),
		.alone_s = 1e-9 * (double)ob_time_alone(h->u),
		.simulated_s = has_task_times(h->u) ? 1e-9 * (double)ob_simulated_path(h->u) : NAN,
	};
	get_memory(h, out);
	pthread_mutex_lock(&h->failure_lock); // the supervisor may just be counting a death
	out->deaths = h->restart.deaths;
	pthread_mutex_unlock(&h->failure_lock);
	out->frozen = h->restart.frozen;
	if (!h->cpu_counted)
		return;
	out->cpu_s = 1e-9 * (double)(ob_host_read_cpu(h) - h->cpu_before);
	out->host_cpu_s = ob_clock_process_cpu() - h->own_cpu_before - (h->spawn->own_memory ? 0 : out->cpu_s);
	uint64_t switches = ob_host_count_switches(h) + h->restart.switches;
	out->switches = switches > h->switches_before ? switches - h->switches_before : 0;
	out->elapsed_s = h->last_end - h->first_start;
	out->gate_s = ob_host_gate_time(h, h->last_end) - h->gate_before;
}

void ob_host_trace(ob_host *h, ob_trace_kind kind, uint64_t begin, uint32_t number)
{
	if (h->timeline)
		ob_trace_span(h->u, ob_trace_host(h->u), kind, begin, number, 0);
}

bool ob_host_end_trace(ob_host *h, ob_timeline_sums *sums, ob_error *e)
{
	ob_timeline *t = h->timeline;
	ob_death deaths[OB_DEATHS_KEPT];
	h->timeline = NULL;
	return ob_timeline_finish(t, deaths, ob_host_get_deaths(h, deaths), sums, e);
}

bool ob_host_count_saved(ob_host *h, ob_saved_host *out)
{
	if (h->interval.running || h->failed || ob_universe_settings(h->u)->monolith)
		return false;
	ob_universe_count_saved(h->u, &out->universe);
	ob_population_count_saved(h->population, &out->population);
	return true;
}

// Saves the run. Times belong to this process and are not saved.
void ob_host_save(ob_host *h, ob_saved_host *out)
{
	ob_universe_save(h->u, &out->universe);
	ob_population_save(h->population, &out->population);
	ob_universe_count(h->u, &out->counters);
	memset(out->counters.time_ns, 0, sizeof out->counters.time_ns);
	out->counters.held_ns = out->counters.gate_ns = out->counters.gate_cpu_ns = out->counters.since_ns = 0;
}

void ob_host_stop(ob_host *h)
{
	bool left = true;
	if (!h)
		return;
	h->ending = true;
	if (h->u) {
		ob_universe_set_state(h->u, h->failed ? OB_UNIVERSE_FAILED : OB_UNIVERSE_FINISHED);
		ob_host_halt(h);
	}
	ob_supervisor_stop(h);
	if (h->group)
		left = h->spawn->join(h->group, h->interrupted                ? interrupted_leave_timeout
						: ob_universe_ranks(h->u) > 1 ? rank_leave_timeout
									      : h->spawn->leave_timeout);
	ob_timeline_sums sums;
	ob_error e;
	if (!ob_host_end_trace(h, &sums, &e))
		ob_log_warn("%s", e.text);
	ob_fork_server_stop(h->fork_server);
	if (h->u)
		ob_universe_unlink(h->u);
	if (h->u && left)
		ob_universe_destroy(h->u, true);
	if (!left && !h->interrupted)
		ob_log_warn("a simulator's thread does not return; its memory stays until this program ends");
	if (h->interrupt_fd >= 0)
		ob_interrupt_release();
	ob_restart_finish(h);
	ob_cameras_destroy(h->cameras);
	ob_snapshots_finish(&h->snapshots);
	ob_population_destroy(h->population);
	ob_requests_destroy(h->requests);
	ob_requests_destroy(h->operations);
	ob_requests_destroy(h->wishes);
	ob_roster_destroy(h->roster);
	pthread_mutex_destroy(&h->failure_lock);
	pthread_mutex_destroy(&h->interval.lock);
	free(h->blocks);
	ob_script_log_finish(&h->scripts);
	free(h);
}
