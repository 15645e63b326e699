#include "paper/paper.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "base/random.h"
#include "host/host.h"
#include "ranks/ranks.h"
#include "render/render.h"

enum { PAPER_EXPERIMENTS = 15, GROWING = 2, SUMS = 20000 };

static const uint32_t full_sizes[] = { 8, 16, 32, 64, 128, 256 }, quick_sizes[] = { 4, 8, 16 };
static const ob_paper_scenario growing[GROWING] = { OB_PAPER_COMMON, OB_PAPER_OBS };
static const double start_s = .4; // overhead of starting and ending
static const double limit_s = 300; // CPU of a trial: many times the largest

ob_paper_plan ob_paper_plan_full(void)
{
	return (ob_paper_plan){ 64, PAPER_EXPERIMENTS, 2.5, 1, sizeof full_sizes / sizeof *full_sizes, full_sizes, 3 };
}

ob_paper_plan ob_paper_plan_quick(void)
{
	return (ob_paper_plan){ 12, 2, .3, .2, sizeof quick_sizes / sizeof *quick_sizes, quick_sizes, 1 };
}

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e)
{
	const ob_paper_plan *p = t->what;
	uint32_t objects;
	bool growth = ob_paper_is_growth(t->of, &objects);
	ob_paper_trial one = { ob_paper_scenario_of(out), objects, t->seed, p->alone_s, growth ? 0 : p->watched_s };
	bool fine = ob_paper_trial_run(&one, out->metric, e);
	if (fine && *e->text) // no frame was drawn
		snprintf(out->note, sizeof out->note, "%.63s", e->text);
	return fine;
}

static const char *const columns[] = { "series", "objects" };

static void describe(const ob_record *r, size_t column, char *to, size_t room)
{
	uint32_t objects;
	bool growth = ob_paper_is_growth(r->of, &objects);
	if (column == 0)
		snprintf(to, room, "%s", growth ? "growth" : "experiment");
	else
		snprintf(to, room, "%u", objects);
}

ob_experiment ob_paper_experiment(const char *commit)
{
	return (ob_experiment){ .name = "paper",
				.commit = commit,
				.metrics = OB_PAPER_METRICS,
				.metric = ob_paper_metrics,
				.run = run_trial,
				.limit_s = limit_s,
				.columns = sizeof columns / sizeof *columns,
				.column = columns,
				.describe = describe };
}

static bool add_trial(const ob_paper_plan *p, ob_trials *s, bool growth, uint32_t objects, ob_paper_scenario scenario,
		      uint32_t repeat)
{
	ob_trial t = { .repeat = repeat,
		       .seed = repeat + 1,
		       .guess_s = start_s + p->alone_s + (growth ? 0 : p->watched_s),
		       .what = p };
	ob_paper_case_key(t.of, growth, objects);
	snprintf(t.configuration, sizeof t.configuration, "%s", ob_paper_setups[scenario].key);
	return ob_trials_add(s, &t);
}

bool ob_paper_schedule(const ob_paper_plan *p, ob_trials *s, ob_error *e)
{
	const size_t from = s->count;
	bool fine = true;
	for (int scenario = 0; fine && scenario < OB_PAPER_SCENARIOS; scenario++)
		fine = add_trial(p, s, false, p->objects, scenario, 0);
	fine = fine && ob_trials_repeat(s, from, p->experiments, OB_ORDER_ROTATED, true);
	// Shuffles the sizes in time, so that a machine that slows down does not look like growth.
	for (uint32_t repeat = 0; repeat < p->repeats; repeat++)
		for (uint32_t i = 0; fine && i < p->sizes * GROWING; i++) {
			uint32_t at = (i / GROWING * 5 + repeat) % (uint32_t)p->sizes;
			fine = add_trial(p, s, true, p->size[at], growing[(i + repeat) % GROWING], repeat);
		}
	return fine || ob_fail(e, "out of memory");
}

static double time_sum(void)
{
	double begun = ob_clock_thread_cpu();
	for (int i = 0; i < SUMS; i++)
		ob_synthetic_load(ob_paper_setups[OB_PAPER_COMMON_LOAD].load);
	return (ob_clock_thread_cpu() - begun) / SUMS;
}

static bool has_outcome(const ob_records *r, ob_error *e)
{
	for (size_t i = 0; i < r->count; i++)
		if (!r->record[i].failure)
			return true;
	return ob_fail(e, "%s", r->count ? r->record[r->count - 1].reason : "nothing was run");
}

bool ob_paper_run(const ob_paper_plan *p, const char *commit, const char *folder, bool fresh, ob_paper_results *r,
		  ob_error *e)
{
	const ob_experiment x = ob_paper_experiment(commit);
	ob_trials trials = { 0 };
	*r = (ob_paper_results){ .objects = p->objects, .experiments = p->experiments, .sum_s = time_sum() };
	if (getloadavg(&r->busy, 1) != 1)
		r->busy = NAN;
	bool fine = ob_paper_schedule(p, &trials, e) && ob_experiment_open(&x, folder, &r->records, e);
	if (fine && fresh)
		ob_records_drop(&r->records, &trials);
	fine = fine && ob_experiment_run(&x, &trials, &r->records, folder, e) &&
	       (ob_ranks_started().rank > 0 || has_outcome(&r->records, e));
	ob_trials_finish(&trials);
	return fine;
}

// ---- trial

// ---- viewer

// Viewer: a thread that draws the newest snapshot again and again, as fast as it can.

enum { OB_PAPER_WIDTH = 640, OB_PAPER_HEIGHT = 480 };

typedef struct ob_viewer ob_viewer;

struct ob_viewer {
	const ob_scene *scene;
	pthread_t thread;
	pthread_mutex_t lock; // guards the following fields, up to the empty line
	pthread_cond_t drawn;
	ob_snapshot newest;
	uint64_t frames;
	bool end, failed;
	ob_error why;

	ob_snapshot shown; // the thread's own
	uint8_t *rgba;
};

static void fail(ob_viewer *v, const ob_error *why)
{
	pthread_mutex_lock(&v->lock);
	v->failed = true;
	v->why = *why;
	pthread_cond_signal(&v->drawn);
	pthread_mutex_unlock(&v->lock);
}

// Copies the newest snapshot; returns false at the end.
static bool fetch(ob_viewer *v, ob_error *e)
{
	pthread_mutex_lock(&v->lock);
	bool on = !v->end;
	bool fine = !on || ob_snapshot_copy(&v->shown, &v->newest);
	pthread_mutex_unlock(&v->lock);
	if (!fine) {
		ob_fail(e, "out of memory");
		fail(v, e);
	}
	return on && fine;
}

static void *draw(void *argument)
{
	ob_viewer *v = argument;
	ob_error e;
	ob_render_setup setup = { .width = OB_PAPER_WIDTH, .height = OB_PAPER_HEIGHT, .samples = 1 };
	ob_renderer *r = ob_renderer_create(&setup, &v->scene->look, &e);
	if (!r)
		fail(v, &e);
	while (r && fetch(v, &e)) {
		if (!ob_renderer_draw(r, NULL, &v->shown, v->shown.time, &v->scene->camera[0], v->rgba, &e)) {
			fail(v, &e);
			break;
		}
		pthread_mutex_lock(&v->lock);
		v->frames++;
		pthread_cond_signal(&v->drawn);
		pthread_mutex_unlock(&v->lock);
	}
	ob_renderer_destroy(r);
	return NULL;
}

static bool wait_for_first(ob_viewer *v)
{
	pthread_mutex_lock(&v->lock);
	while (v->frames == 0 && !v->failed)
		pthread_cond_wait(&v->drawn, &v->lock);
	bool fine = !v->failed;
	pthread_mutex_unlock(&v->lock);
	return fine;
}

static void release(ob_viewer *v)
{
	pthread_mutex_destroy(&v->lock);
	pthread_cond_destroy(&v->drawn);
	ob_snapshot_finish(&v->newest);
	ob_snapshot_finish(&v->shown);
	free(v->rgba);
	free(v);
}

// Frees v. Returns false and e if drawing has failed in between.
static bool viewer_close(ob_viewer *v, ob_error *e)
{
	pthread_mutex_lock(&v->lock);
	v->end = true;
	pthread_mutex_unlock(&v->lock);
	pthread_join(v->thread, NULL);
	bool fine = !v->failed;
	if (!fine && e)
		*e = v->why;
	release(v);
	return fine;
}

// Returns once the first frame is drawn, which takes longer than others. The scene must outlive it. Returns NULL and e
// if drawing is impossible here. Call it after the host has started, which forks.
static ob_viewer *viewer_open(const ob_scene *scene, const ob_snapshot *first, ob_error *e)
{
	ob_viewer *v = calloc(1, sizeof *v);
	if (!v) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	v->scene = scene;
	pthread_mutex_init(&v->lock, NULL);
	pthread_cond_init(&v->drawn, NULL);
	v->rgba = malloc((size_t)OB_PAPER_WIDTH * OB_PAPER_HEIGHT * 4);
	if (!v->rgba || !ob_snapshot_copy(&v->newest, first) || pthread_create(&v->thread, NULL, draw, v) != 0) {
		ob_fail(e, "out of memory");
		release(v);
		return NULL;
	}
	if (!wait_for_first(v)) {
		viewer_close(v, e);
		return NULL;
	}
	return v;
}

// Sets the snapshot to draw from now on; copies it. Returns false if memory runs out. One thread.
static bool viewer_show(ob_viewer *v, const ob_snapshot *now)
{
	pthread_mutex_lock(&v->lock);
	bool fine = ob_snapshot_copy(&v->newest, now);
	pthread_mutex_unlock(&v->lock);
	return fine;
}

// drawn so far
static uint64_t viewer_frames(ob_viewer *v)
{
	pthread_mutex_lock(&v->lock);
	uint64_t n = v->frames;
	pthread_mutex_unlock(&v->lock);
	return n;
}

// ---- trial

static const double slowest_frame = 10; // s: minimum wait for the first frame

// ---- the scene: a ground, and boxes of different sizes that fall onto it in columns of four. The same seed gives the same boxes.

static const double spacing = 1.8; // m: exceeds the longest diagonal, so that no two boxes start in contact
static const double lowest = 1.5; // m
static const double density = 1000, friction = .5;
static const double least_side = .2, most_side = 1; // m
enum { LEVELS = 4 };

// Uniform over all attitudes (Shoemake 1992).
static ob_quat draw_attitude(uint64_t *state)
{
	double u = ob_splitmix_real(state), a = 2 * M_PI * ob_splitmix_real(state),
	       b = 2 * M_PI * ob_splitmix_real(state);
	return (ob_quat){ sqrt(1 - u) * sin(a), sqrt(1 - u) * cos(a), sqrt(u) * sin(b), sqrt(u) * cos(b) };
}

static void put_ground(ob_object_def *o)
{
	o->passport = (ob_passport){
		.flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC,
		.shape = OB_SHAPE_PLANE,
		.friction = friction,
		.colour = { .45f, .48f, .44f, 1 },
		.name = "ground",
	};
	o->state.pose.q = ob_quat_identity();
	o->dies = INFINITY;
}

static void put_box(ob_object_def *o, uint32_t id, uint32_t side, uint64_t *state)
{
	uint32_t column = (id - 1) / LEVELS, level = (id - 1) % LEVELS;
	double x = ob_splitmix_within(state, least_side, most_side),
	       y = ob_splitmix_within(state, least_side, most_side),
	       z = ob_splitmix_within(state, least_side, most_side), middle = .5 * (side - 1);
	o->passport = (ob_passport){
		.id = id,
		.flags = OB_OBJECT_PRESENT,
		.shape = OB_SHAPE_BOX,
		.size = ob_v3(x / 2, y / 2, z / 2),
		.mass = density * x * y * z,
		.friction = friction,
		.colour = { (float)(.15 + .7 * ob_splitmix_real(state)), (float)(.15 + .5 * ob_splitmix_real(state)),
			    (float)(.1 + .5 * ob_splitmix_real(state)), 1 },
		.roughness = .45f,
	};
	snprintf(o->passport.name, sizeof o->passport.name, "box#%u", id);
	o->state.pose.p =
		ob_v3((column % side - middle) * spacing, (column / side - middle) * spacing, lowest + level * spacing);
	o->state.pose.q = draw_attitude(state);
	o->dies = INFINITY;
}

static bool make_boxes(ob_scene *s, uint32_t boxes, uint64_t seed)
{
	uint32_t wide = (boxes + LEVELS - 1) / LEVELS, side = (uint32_t)ceil(sqrt(wide));
	double reach = side * spacing;
	*s = (ob_scene){
		.title = "falling boxes",
		.run = { .gravity = { 0, 0, -9.81 } },
		.seed = seed,
		.objects = boxes + 1,
		.object = calloc(boxes + 1, sizeof *s->object),
		.cameras = 1,
		.camera = calloc(1, sizeof *s->camera),
		.look = { .sky_top = { .11f, .29f, .58f },
			  .sky_horizon = { .72f, .81f, .88f },
			  .ground_colour = { .46f, .48f, .45f },
			  .grid = true,
			  .sun = ob_scale(ob_v3(-.45, -.5, .9), 1 / ob_norm(ob_v3(-.45, -.5, .9))) },
	};
	if (!s->object || !s->camera)
		return false;
	s->camera[0] = (ob_camera_def){ .name = "main",
					.eye = ob_v3(-reach - 4, -1.5 * reach - 6, .5 * reach + 3),
					.target = ob_v3(0, 0, 1.5),
					.fov = .8 };
	put_ground(&s->object[0]);
	for (uint32_t i = 1; i <= boxes; i++)
		put_box(&s->object[i], i, side, &seed);
	return true;
}

static void finish_boxes(ob_scene *s)
{
	free(s->object);
	free(s->camera);
}

// ---- the run

typedef struct session {
	const ob_paper_trial *trial;
	const ob_paper_setup *setup;
	ob_scene scene;
	ob_host *host;
	ob_viewer *viewer; // NULL = none
	ob_snapshot now;
	uint64_t steps;
	double due; // wall time of the next step's start
} session;

// Times used by the simulators up to now.
typedef struct reading {
	double wall, stepping, total, *worker; // s
	double own; // CPU of this process: host, viewer, and simulator threads
	uint64_t steps, box_tests;
} reading;

static double cpu_of_worker(const session *c, uint32_t w)
{
	ob_worker_info info;
	if (!ob_universe_get_worker(ob_host_universe(c->host), w, &info))
		return 0;
	return 1e-9 * (double)(c->setup->each ? ob_clock_cpu_of_process(info.pid) : ob_clock_cpu_of_thread(info.tid));
}

static bool take_reading(const session *c, reading *r, ob_error *e)
{
	const ob_universe *u = ob_host_universe(c->host);
	uint32_t workers = ob_universe_workers(u);
	ob_counters counters;
	ob_host_times times;
	*r = (reading){ .steps = c->steps, .worker = calloc(workers, sizeof *r->worker) };
	if (!r->worker)
		return ob_fail(e, "out of memory");
	for (uint32_t w = 0; w < workers; w++) {
		r->worker[w] = cpu_of_worker(c, w);
		r->total += r->worker[w];
	}
	ob_universe_count(u, &counters);
	ob_host_get_times(c->host, &times);
	r->box_tests = counters.box_tests;
	r->stepping = times.wall_s;
	r->own = ob_clock_process_cpu();
	r->wall = ob_clock_wall();
	return true;
}

static void wait_until(double due)
{
	struct timespec at = { .tv_sec = (time_t)due, .tv_nsec = (long)((due - floor(due)) * 1e9) };
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL) == EINTR)
		;
}

// Steps when it is due. A late step begins at once and does not catch up: the environment is slow. Free simulators have
// the same clock, and catch up.
static bool step(session *c, ob_error *e)
{
	double now = ob_clock_wall();
	if (now < c->due)
		wait_until(c->due);
	else if (!c->setup->free)
		c->due = now;
	c->due += OB_PAPER_STEP_LENGTH;
	ob_host_go(c->host, ++c->steps);
	if (!ob_host_wait(c->host, e))
		return false;
	if (!c->viewer)
		return true;
	if (!ob_snapshot_take(&c->now, ob_host_universe(c->host), 0, e))
		return false;
	return viewer_show(c->viewer, &c->now) || ob_fail(e, "out of memory");
}

static bool steps_for(session *c, double seconds, ob_error *e)
{
	double end = ob_clock_wall() + seconds;
	do {
		if (!step(c, e))
			return false;
	} while (c->due < end);
	return true;
}

static void fill_alone(const session *c, const reading *from, const reading *to, double wall, double *metric)
{
	double steps = (double)(to->steps - from->steps), most = 0;
	uint32_t workers = ob_universe_workers(ob_host_universe(c->host));
	for (uint32_t w = 0; w < workers; w++)
		most = fmax(most, to->worker[w] - from->worker[w]);
	double total = to->total - from->total;
	ob_host_times times;
	ob_host_get_times(c->host, &times);
	metric[OB_PAPER_STEP] = (to->stepping - from->stepping) / steps;
	metric[OB_PAPER_TOTAL] = total / steps;
	metric[OB_PAPER_ONE] = metric[OB_PAPER_TOTAL] / (c->setup->monolith ? 1 : c->trial->objects);
	metric[OB_PAPER_BUSIEST] = most / steps;
	metric[OB_PAPER_CPU] = total / wall;
	metric[OB_PAPER_DEMAND] = total / (steps * OB_PAPER_STEP_LENGTH);
	metric[OB_PAPER_PACE] = steps * OB_PAPER_STEP_LENGTH / wall;
	metric[OB_PAPER_TESTS] = (double)(to->box_tests - from->box_tests) / steps;
	metric[OB_PAPER_MEMORY] = (double)times.memory_bytes;
}

static bool measure_alone(session *c, double *metric, ob_error *e)
{
	reading from = { 0 }, to = { 0 };
	c->due = ob_clock_wall();
	bool fine = take_reading(c, &from, e);
	c->due = ob_clock_wall();
	double begun = c->due;
	fine = fine && steps_for(c, c->trial->alone_s, e);
	// to the end of the last step's slot
	double wall = fmax(c->due, ob_clock_wall()) - begun;
	fine = fine && take_reading(c, &to, e);
	if (fine)
		fill_alone(c, &from, &to, wall, metric);
	free(from.worker);
	free(to.worker);
	return fine;
}

// Without a renderer the rest of the trial is valid all the same; e has the reason.
static bool measure_watched(session *c, double *metric, ob_error *e)
{
	reading from = { 0 }, to = { 0 };
	if (!ob_snapshot_take(&c->now, ob_host_universe(c->host), 0, e))
		return false;
	c->viewer = viewer_open(&c->scene, &c->now, e);
	if (!c->viewer)
		return true;
	bool fine = take_reading(c, &from, e);
	uint64_t frames = viewer_frames(c->viewer);
	c->due = ob_clock_wall();
	double limit = c->due + slowest_frame;
	do
		fine = fine && steps_for(c, c->trial->watched_s, e);
	while (fine && viewer_frames(c->viewer) == frames && ob_clock_wall() < limit);
	frames = viewer_frames(c->viewer) - frames;
	fine = fine && take_reading(c, &to, e);
	if (fine) {
		double wall = to.wall - from.wall;
		double threads = c->setup->each ? 0 : to.total - from.total;
		metric[OB_PAPER_FPS] = (double)frames / wall;
		metric[OB_PAPER_VIEWER] = (to.own - from.own - threads) / wall;
	}
	free(from.worker);
	free(to.worker);
	return viewer_close(c->viewer, fine ? e : NULL) && fine;
}

static bool run(session *c, double *metric, ob_error *e)
{
	const ob_paper_setup *setup = c->setup;
	const double rate = 1 / OB_PAPER_STEP_LENGTH;
	const ob_free_settings free = { .update_rate = rate,
					.rate_most = rate,
					.max_lag = INFINITY,
					.pace = 1,
					.end = INFINITY,
					.seed = c->trial->seed,
					.coupling = OB_COUPLING_OWN };
	ob_host_config config = {
		.free = setup->free ? &free : NULL,
		.isolation = setup->each ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD,
		.workers = setup->each       ? 0
			   : setup->monolith ? 1
					     : (uint32_t)ob_cpu_count(),
		.run = { .gravity = c->scene.run.gravity,
			 .step_length = OB_PAPER_STEP_LENGTH,
			 .substeps = OB_PAPER_SUBSTEPS,
			 .iterations = OB_PAPER_ITERATIONS,
			 .monolith = setup->monolith,
			 .narrow_phase = setup->oriented ? OB_NARROW_OBB : OB_NARROW_AABB,
			 .load = setup->load },
	};
	c->host = ob_host_start(&c->scene, &config, e);
	if (!c->host)
		return false;
	ob_host_go(c->host, 0);
	return ob_host_wait(c->host, e) && measure_alone(c, metric, e) &&
	       (c->trial->watched_s <= 0 || measure_watched(c, metric, e));
}

bool ob_paper_trial_run(const ob_paper_trial *t, double metric[OB_PAPER_METRICS], ob_error *e)
{
	session c = { .trial = t, .setup = &ob_paper_setups[t->scenario] };
	e->text[0] = 0;
	bool fine = make_boxes(&c.scene, t->objects, t->seed) || ob_fail(e, "out of memory");
	fine = fine && run(&c, metric, e);
	ob_host_stop(c.host);
	ob_snapshot_finish(&c.now);
	finish_boxes(&c.scene);
	return fine;
}
