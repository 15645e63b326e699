#include "paper/trial.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "base/random.h"
#include "host/host.h"
#include "paper/viewer.h"

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
	uint32_t columns = (boxes + LEVELS - 1) / LEVELS, side = (uint32_t)ceil(sqrt(columns));
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
	return ob_viewer_show(c->viewer, &c->now) || ob_fail(e, "out of memory");
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
	c->viewer = ob_viewer_open(&c->scene, &c->now, e);
	if (!c->viewer)
		return true;
	bool fine = take_reading(c, &from, e);
	uint64_t frames = ob_viewer_frames(c->viewer);
	c->due = ob_clock_wall();
	double limit = c->due + slowest_frame;
	do
		fine = fine && steps_for(c, c->trial->watched_s, e);
	while (fine && ob_viewer_frames(c->viewer) == frames && ob_clock_wall() < limit);
	frames = ob_viewer_frames(c->viewer) - frames;
	fine = fine && take_reading(c, &to, e);
	if (fine) {
		double wall = to.wall - from.wall;
		double threads = c->setup->each ? 0 : to.total - from.total;
		metric[OB_PAPER_FPS] = (double)frames / wall;
		metric[OB_PAPER_VIEWER] = (to.own - from.own - threads) / wall;
	}
	free(from.worker);
	free(to.worker);
	return ob_viewer_close(c->viewer, fine ? e : NULL) && fine;
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
