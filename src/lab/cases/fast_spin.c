// Fast rotation near others: passing without contact, and hitting.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "measure/measure.h"
#include "world/world.h"

// ---- beside a ball, 10 mm from it at the nearest

enum { SPINNERS = 4 };
static const double drift = -4e-4; // m/s

// The first three spin about an axis towards the ball, but for a fifth; the last is slender, and its ends pass the
// ball. The balls drift nearer by 8 mm.
static void build_near(ob_world *w, uint32_t run, const double *variant)
{
	static const ob_shape shape[SPINNERS] = { OB_SHAPE_BOX, OB_SHAPE_CYLINDER, OB_SHAPE_CAPSULE, OB_SHAPE_BOX };
	static const ob_vec3 size[SPINNERS] = { { .2, .15, .1 }, { .1, .2, 0 }, { .1, .2, 0 }, { .02, .03, .4 } };
	static const ob_vec3 axis[SPINNERS] = { { .96, .2, .2 }, { .96, .2, .2 }, { .96, .2, .2 }, { .1, .99, .1 } };
	static const double ball = .2, gap = .01, rate = 50; // m, m, rad/s
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < SPINNERS; i++) {
		ob_vec3 at = ob_v3(0, 10 * i, 0);
		double reach = shape[i] == OB_SHAPE_CAPSULE ? size[i].x + size[i].y : ob_norm(size[i]);
		ob_world_add(w, shape[i], size[i], 5, at).state->w = ob_scale(axis[i], rate / ob_norm(axis[i]));
		ob_world_sphere(w, 5, ball, ob_madd(at, reach + ball + gap, ob_v3(1, 0, 0))).state->v.x = drift;
	}
}

// Angular momentum I w of one body.
static ob_vec3 spin_of(const ob_case_run_state *t, uint32_t id, const ob_state *s)
{
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_vec3 w = ob_rotate_back(&r, s->w), moment = t->world->passport[id].inertia;
	return ob_rotate(&r, ob_v3(moment.x * w.x, moment.y * w.y, moment.z * w.z));
}

static void observe_near(ob_case_run_state *t)
{
	for (uint32_t id = 0; id < 2 * SPINNERS; id += 2) {
		ob_state s = ob_look_at(t, id);
		ob_vec3 start = spin_of(t, id, &t->world->state[id]), now = spin_of(t, id, &s);
		double energy = ob_dot(start, t->world->state[id].w);
		ob_look_keep(&t->figure[0], ob_norm(ob_sub(now, start)) / ob_norm(start));
		ob_look_keep(&t->figure[1], fabs(ob_dot(now, s.w) / energy - 1));
		ob_look_keep(&t->figure[2], ob_norm(ob_sub(ob_look_moved(t, id + 1), ob_v3(drift * t->time, 0, 0))));
	}
}

// Every rotating body passes half a turn of each component of the attitude.
static void judge_near(ob_case_run_state *t)
{
	for (uint32_t id = 0; id < 2 * SPINNERS; id += 2) {
		ob_quat q = ob_look_at(t, id).pose.q;
		if (fabs(q.w) > 1 - 1e-9)
			t->failed = "nothing turned";
	}
}

const ob_case ob_case_near_spin = {
	.row = 33,
	.name = "near-spin",
	.title = "Fast spin beside a ball",
	.setup = "Two boxes, a cylinder and a capsule spin at 50 rad/s, each 10 mm from a ball that they "
		 "never touch, and that drifts by 8 mm towards them; in free space, 20 s.",
	.duration = 20,
	.figures = 3,
	.figure = { { "error of angular momentum", "1", 1e-12, "that at the start, as a vector" },
		    { "error of energy", "1", 1e-9, "energy at the start" },
		    { "error of the balls' way", "m", 1e-12, "v t: nothing touches them" } },
	.build = build_near,
	.observe = observe_near,
	.judge = judge_near,
};

// ---- rods that spin into a box beside them: rod 2 i and box 2 i + 1, each pair in a place of its own. In the last run
// the boxes are fixed.

enum { RODS = 12, DEPTH = 0, GAIN, ANGULAR, ROD_FIGURES };
enum { ROD_RUNS = 3 };
static const double apart = 40, rod_rate[ROD_RUNS] = { 30, 60, 30 }; // m, rad/s

static void build_rods(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 33 + run;
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < RODS; i++) {
		ob_vec3 at = ob_v3(apart * (i % 4), apart * (i / 4), 0);
		ob_vec3 axis = ob_add(ob_v3(0, i % 2 ? 1 : -1, 0), ob_splitmix_vector(&seed, .5));
		ob_world_body rod = ob_world_box(w, 4, ob_v3(.03, .03, .5), at);
		rod.state->w = ob_scale(axis, rod_rate[run] / ob_norm(axis));
		rod.passport->restitution = .5 * (i % 3);
		rod.passport->friction = .3;
		ob_world_body box = ob_world_box(w, run == ROD_RUNS - 1 ? 0 : 10, ob_v3(.2, .2, .2),
						 ob_madd(at, .42, ob_v3(1, 0, 0)));
		box.state->pose.q = ob_world_random_attitude(&seed);
		box.passport->friction = .3;
	}
}

// Angular momentum of a pair about its centre of mass
static ob_vec3 momentum_of(const ob_case_run_state *t, uint32_t first)
{
	ob_vec3 sum = ob_v3(0, 0, 0), centre = ob_v3(0, 0, 0), v = ob_v3(0, 0, 0);
	double mass = 0;
	for (uint32_t id = first; id < first + 2; id++) {
		double m = t->world->passport[id].mass;
		centre = ob_madd(centre, m, ob_look_at(t, id).pose.p);
		v = ob_madd(v, m, ob_look_at(t, id).v);
		mass += m;
	}
	for (uint32_t id = first; id < first + 2; id++) {
		ob_state s = ob_look_at(t, id);
		ob_vec3 arm = ob_madd(s.pose.p, -1 / mass, centre), u = ob_madd(s.v, -1 / mass, v);
		sum = ob_add(sum, ob_add(spin_of(t, id, &s), ob_scale(ob_cross(arm, u), t->world->passport[id].mass)));
	}
	return sum;
}

// In memory: each pair's angular momentum at the start
static void observe_rods(ob_case_run_state *t)
{
	ob_look_penetration(t, &t->figure[DEPTH]);
	if (!t->frame)
		t->memory[0] = ob_look_energy(t);
	ob_look_keep(&t->figure[GAIN], ob_look_energy(t) / t->memory[0] - 1);
	for (uint32_t i = 0; i < RODS && t->run < ROD_RUNS - 1; i++) {
		double *start = &t->body_memory[16 * i];
		ob_vec3 now = momentum_of(t, 2 * i);
		if (!t->frame) {
			start[0] = now.x;
			start[1] = now.y;
			start[2] = now.z;
		}
		ob_vec3 from = ob_v3(start[0], start[1], start[2]);
		ob_look_keep(&t->figure[ANGULAR], ob_norm(ob_sub(now, from)) / ob_norm(from));
	}
}

static void judge_rods(ob_case_run_state *t)
{
	for (uint32_t i = 0; i < RODS; i++)
		if (ob_norm(ob_look_moved(t, 2 * i)) < 1e-3)
			t->failed = "passed through";
}

const ob_case ob_case_spinning_rods = {
	.row = 33,
	.name = "spinning-rods",
	.slow = true,
	.title = "Rods that spin into a box",
	.setup = "Twelve rods of 1 m x 60 mm spin at 30 and 60 rad/s about oblique axes, each beside a box, free or "
		 "fixed, "
		 "that it hits; restitution 0, .5 and 1, friction .3; in free space.",
	.duration = 1.5,
	.runs = ROD_RUNS,
	.figures = ROD_FIGURES,
	.figure = { { "worst penetration", "mm", 1, "no penetration" },
		    { "gain of energy", "1", 1e-9, "energy at the start" },
		    { "error of angular momentum", "1", 1e-9,
		      "that of each pair about its centre of mass, at the start" } },
	.build = build_rods,
	.observe = observe_rods,
	.judge = judge_rods,
};
