#include "play.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "hull/hull.h"
#include "measure/measure.h"
#include "motion/deviation.h"
#include "ode/ode_body.h"
#include "shape/shape.h"
#include "step/sim.h"
#include "table/saved.h"
#include "world/builders.h"

enum { MOST_WORKERS = 8 };

typedef struct worker {
	ob_universe *u;
	uint32_t number;
	pthread_t thread;
	bool failed;
} worker;

typedef struct player {
	const random_scene *scene;
	uint64_t steps; // of the run
	ob_quat frame[SCENE_BODIES]; // principal axes of hulls, in the frame of their points
	ob_universe *u;
	ob_sim *sim; // NULL: workers have threads of their own
	uint32_t workers;
	worker crowd[MOST_WORKERS];
	ob_snapshot now;
	played *out;
} player;

static bool give_up(played *out, const char *why)
{
	out->failed = true;
	snprintf(out->why, sizeof out->why, "%.159s", why);
	return false;
}

static void *live(void *arg)
{
	worker *w = arg;
	ob_error e;
	ob_ode_thread_init();
	ob_sim *s = ob_sim_create(w->u, w->number, &e);
	w->failed = !s;
	if (s) {
		ob_sim_run(s);
		ob_sim_destroy(s);
	}
	ob_ode_thread_finish();
	return NULL;
}

static void add_body(ob_world *w, player *p, uint32_t i)
{
	const scene_body *b = &p->scene->body[i];
	const bool hull = b->shape == OB_SHAPE_HULL;
	ob_world_body o = hull ? ob_world_hull(w, b->mass, b->point, b->points, b->state.pose.p)
			       : ob_world_add(w, b->shape, b->size, b->mass, b->state.pose.p);
	p->frame[i] = hull ? o.state->pose.q : ob_quat_identity();
	o.passport->friction = b->friction;
	o.passport->restitution = b->restitution;
	o.passport->surface_velocity = b->running;
	*o.state = b->state;
	if (b->passes)
		o.passport->flags |= ((1u << OB_GROUPS) - 1) << OB_OBJECT_PASSES;
	if (hull) {
		const ob_mat3 r = ob_quat_matrix(p->frame[i]);
		o.state->pose.q = ob_quat_mul(b->state.pose.q, p->frame[i]);
		o.passport->surface_velocity = ob_rotate_back(&r, b->running);
	}
	if (b->driven || (b->mass == 0 && b->shape != OB_SHAPE_PLANE && ob_norm2(p->scene->lift) > 0))
		ob_world_kinematic(o);
}

static void join_bodies(ob_world *w, const random_scene *s)
{
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].fixed)
			ob_world_join(w, OB_JOINT_FIXED, i, s->body[i].fixed - 1, s->body[i].state.pose);
}

// Speeds up through the first half of a path that takes four times as long as the run.
static void prescribe(const player *p, uint32_t i)
{
	const scene_body *b = &p->scene->body[i];
	if (!(ob_passport_of(p->u, i)->flags & OB_OBJECT_KINEMATIC))
		return;
	const double time = 4 * (double)p->steps * p->scene->run.step_length;
	ob_path_point point[2] = { { .t = 0, .p = b->state.pose.p },
				   { .t = time, .p = ob_madd(b->state.pose.p, .25 * time * time, p->scene->lift) } };
	const ob_path lift = { .points = 2, .point = point };
	const ob_path *own = b->path.frequency > 0 ? &b->path : NULL; // NULL: constant velocities
	ob_sim_prescribe(p->u, i, b->driven ? own : &lift, 0);
}

static void put_hulls(player *p, const ob_world *w)
{
	for (uint32_t i = 0; i < w->hulls; i++)
		ob_write_hull(p->u, i, &w->hull[i]);
}

static void put_bodies(player *p, const ob_world *w)
{
	for (uint32_t i = 0; i < w->objects; i++)
		ob_write_passport(p->u, i, &w->passport[i]);
	ob_joints_write(p->u, w->joint, w->joints);
	for (uint32_t i = 0; i < w->objects; i++)
		ob_sim_place(p->u, i, &w->state[i]);
}

// As the host does before each step.
static void drive_bodies(const player *p)
{
	const uint64_t step = ob_step_count(p->u);
	const double h = p->scene->run.step_length;
	for (uint32_t i = 0; i < p->scene->bodies; i++) {
		prescribe(p, i);
		if (p->scene->body[i].pushed) {
			const ob_force *f = &p->scene->body[i].push;
			const ob_vec3 now = ob_force_mean(f, h, step),
				      before = step ? ob_force_mean(f, h, step - 1) : ob_v3(0, 0, 0);
			ob_sim_push(p->u, i, now, ob_norm2(ob_sub(now, before)) > 0);
		}
	}
}

static bool run_to(player *p, uint64_t step)
{
	ob_error e;
	drive_bodies(p);
	ob_gate_set_pause_step(p->u, step);
	ob_sim_resume(p->u);
	if (p->sim)
		while (!ob_gate_host_wait(p->u, 0))
			ob_step(p->sim);
	else if (!ob_gate_host_wait(p->u, 60))
		return give_up(p->out, "the workers do not come to a pause");
	if (ob_sim_failure(p->u))
		return give_up(p->out, ob_sim_failure(p->u));
	return ob_snapshot_take(&p->now, p->u, 0, &e) || give_up(p->out, e.text);
}

// from: a universe to go on with; NULL: the scene's start.
static bool open_player(player *p, uint32_t workers, const ob_saved_universe *from)
{
	static int made;
	char name[OB_NAME_MAX];
	ob_error e;
	snprintf(name, sizeof name, "metamorphic-%d-%d", (int)getpid(), made++);
	ob_world w = { .gravity = p->scene->run.gravity };
	for (uint32_t i = 0; i < p->scene->bodies; i++)
		add_body(&w, p, i);
	join_bodies(&w, p->scene);
	ob_universe_setup setup = { .name = name,
				    .capacity = p->scene->bodies,
				    .workers = workers ? workers : 1,
				    .hulls = w.hulls,
				    .joints = w.joints,
				    .isolation = "thread",
				    .run = p->scene->run };
	p->u = ob_universe_create(&setup, &e);
	if (p->u) {
		ob_universe_unlink(p->u);
		put_hulls(p, &w);
		if (!from)
			put_bodies(p, &w);
	}
	ob_world_finish(&w);
	if (!p->u || (from && !ob_universe_load(p->u, from, &e)))
		return give_up(p->out, e.text);
	if (from)
		ob_sim_restore(p->u);
	p->workers = workers;
	for (uint32_t i = 0; i < workers; i++) {
		p->crowd[i] = (worker){ .u = p->u, .number = i };
		if (pthread_create(&p->crowd[i].thread, NULL, live, &p->crowd[i]) != 0)
			abort();
	}
	if (!workers) {
		ob_ode_thread_init();
		p->sim = ob_sim_create(p->u, 0, &e);
	}
	return (workers || p->sim || give_up(p->out, e.text)) && run_to(p, from ? from->step : 0);
}

static void close_player(player *p)
{
	if (!p->u)
		return;
	if (p->workers)
		ob_gate_stop(p->u);
	for (uint32_t i = 0; i < p->workers; i++)
		pthread_join(p->crowd[i].thread, NULL);
	if (p->sim) {
		ob_sim_destroy(p->sim);
		ob_ode_thread_finish();
	}
	ob_snapshot_finish(&p->now);
	ob_universe_destroy(p->u, false);
}

// ---- conservation

typedef struct budget {
	ob_vec3 momentum, spin;
	double energy, least; // J: at the start; the least since, net
	double all_momentum, all_spin, to_lose; // scales of the errors
} budget;

static double energy_of(const player *p)
{
	return ob_measure_energy(&p->now, p->scene->run.gravity);
}

static budget budget_of(const player *p)
{
	const random_scene *s = p->scene;
	budget b = { ob_measure_momentum(&p->now), ob_measure_angular_momentum(&p->now), energy_of(p), 0, 0, 0, 0 };
	double lowest = INFINITY, g = ob_norm(s->run.gravity);
	for (uint32_t i = 0; i < s->bodies; i++) {
		const scene_body *o = &s->body[i];
		double r = ob_shape_radius(o->shape, o->size);
		double v = ob_norm(o->state.v), turn = ob_norm(o->state.w) * r;
		if (o->mass == 0)
			continue;
		b.all_momentum += o->mass * v;
		b.all_spin += o->mass * (v * ob_norm(o->state.pose.p) + turn * r);
		b.to_lose += o->mass * (.5 * v * v + .2 * turn * turn + g * r);
		if (g > 0)
			lowest = fmin(lowest, -ob_dot(s->run.gravity, o->state.pose.p) / g);
	}
	for (uint32_t i = 0; g > 0 && i < s->bodies; i++)
		b.to_lose += s->body[i].mass * g * (-ob_dot(s->run.gravity, s->body[i].state.pose.p) / g - lowest);
	return b;
}

static void audit(player *p, budget *b)
{
	ob_counters count;
	played *out = p->out;
	ob_universe_count(p->u, &count);
	double net = energy_of(p) - b->energy - count.recovered;
	b->least = fmin(b->least, net);
	out->energy = fmax(out->energy, (net - b->least) / b->to_lose);
	ob_vec3 lost = ob_sub(ob_measure_momentum(&p->now), b->momentum);
	ob_vec3 turned = ob_sub(ob_measure_angular_momentum(&p->now), b->spin);
	out->momentum = fmax(out->momentum, b->all_momentum > 0 ? ob_norm(lost) / b->all_momentum : 0);
	out->spin = fmax(out->spin, b->all_spin > 0 ? ob_norm(turned) / b->all_spin : 0);
	out->touched = count.pair_solves > 0 || count.impacts > 0;
}

// ---- a run

static ob_state state_of(const player *p, uint32_t i)
{
	ob_state x = ob_snapshot_state(&p->now, i);
	const ob_quat f = p->frame[i];
	if (p->scene->body[i].shape == OB_SHAPE_HULL)
		x.pose.q = ob_quat_mul(x.pose.q, (ob_quat){ f.w, -f.x, -f.y, -f.z });
	return x;
}

void play(const random_scene *s, uint32_t workers, uint64_t steps, played *out)
{
	player p = { .scene = s, .steps = steps, .out = out };
	*out = (played){ .failed = false };
	ob_ode_init();
	if (open_player(&p, workers, NULL)) {
		ob_penetration depth;
		ob_measure_penetration(&p.now, &depth);
		out->depth = depth.max_m;
		budget b = budget_of(&p);
		for (uint64_t step = 1; step <= steps && !out->failed; step++) {
			if (!run_to(&p, step))
				break;
			audit(&p, &b);
			if (step * PLAY_SAMPLES % steps)
				continue;
			uint64_t sample = step * PLAY_SAMPLES / steps - 1;
			for (uint32_t i = 0; i < s->bodies; i++)
				out->at[sample][i] = state_of(&p, i);
		}
		out->hash = ob_measure_hash(&p.now);
	}
	close_player(&p);
}

// ---- a second beside a fine solution of it

enum { SAVED_PAIRS = SCENE_BODIES * SCENE_BODIES };

typedef struct saved {
	ob_saved_universe universe;
	ob_passport passport[SCENE_BODIES];
	ob_motion motion[SCENE_BODIES];
	ob_schedule schedule[SCENE_BODIES];
	float bounds[SCENE_BODIES][6];
	uint32_t neighbours[SCENE_BODIES], plane[SCENE_BODIES];
	ob_pair_key pair[SAVED_PAIRS];
	ob_saved_record record[SAVED_PAIRS];
	ob_script_turn turn;
	ob_script_cell cell;
} saved;

static bool save(player *p, saved *to)
{
	ob_saved_universe *u = &to->universe;
	ob_universe_count_saved(p->u, u);
	if (u->ids > SCENE_BODIES || u->pairs > SAVED_PAIRS || u->script_cells || u->script_bytes)
		return give_up(p->out, "the universe does not fit");
	u->passport = to->passport, u->motion = to->motion, u->schedule = to->schedule, u->bounds = to->bounds;
	u->neighbours = to->neighbours, u->plane = to->plane, u->pair = to->pair, u->record = to->record;
	u->script_turn = &to->turn, u->script_cell = &to->cell;
	ob_universe_save(p->u, u);
	return true;
}

static double distance(const player *a, const player *b, uint32_t i)
{
	const scene_body *o = &a->scene->body[i];
	const ob_state x = state_of(a, i), y = state_of(b, i);
	const ob_quat p = x.pose.q, q = y.pose.q;
	const double same = fabs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z);
	double turn = ob_shape_is(o->shape, OB_ISOTROPIC) ? 0 : 2 * acos(fmin(1, same));
	if (ob_shape_is(o->shape, OB_AXIAL)) { // its turn about the axis moves no surface
		const ob_mat3 of_p = ob_quat_matrix(p), of_q = ob_quat_matrix(q);
		turn = ob_norm(ob_sub(ob_column(&of_p, 2), ob_column(&of_q, 2)));
	}
	return ob_norm(ob_sub(x.pose.p, y.pose.p)) + turn * ob_shape_radius(o->shape, o->size);
}

bool play_beside(const random_scene *s, uint64_t step, uint32_t substeps, played_second *out)
{
	static saved state;
	random_scene fine = *s;
	played ends[2] = { { .failed = false }, { .failed = false } };
	player p = { .scene = s, .steps = step + PLAY_STEPS, .out = &ends[0] },
	       q = { .scene = &fine, .steps = step + PLAY_STEPS, .out = &ends[1] };
	fine.run.tolerance = 0;
	fine.run.substeps = substeps;
	ob_ode_init();
	bool good = open_player(&p, 0, NULL) && run_to(&p, step) && save(&p, &state);
	for (uint64_t k = 1; good && k <= PLAY_STEPS; k++)
		good = run_to(&p, step + k);
	good = good && open_player(&q, 0, &state.universe);
	for (uint64_t k = 1; good && k <= PLAY_STEPS; k++)
		good = run_to(&q, step + k);
	for (uint32_t i = 0; good && i < s->bodies; i++) {
		const ob_motion *m = ob_newest_motion(p.u, i);
		out->said[i] = ob_deviation_at(m, step + PLAY_STEPS, s->run.step_length).place;
		out->off[i] = distance(&p, &q, i);
	}
	close_player(&q);
	close_player(&p);
	return good;
}
