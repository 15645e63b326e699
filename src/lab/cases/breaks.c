// The break: a ball hits fifteen touching balls in a triangle, along its line of symmetry. The result is symmetric.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "measure/measure.h"
#include "world/world.h"

enum { ROWS = 5, BALLS = 15, ASYMMETRY = 0, MOMENTUM, ANGULAR, GAIN, FIGURES };
static const double radius = .028, mass = .17, speed = 8; // m, kg, m/s

// Body 0 comes in along x; ball j of row i is body 1 + i (i + 1) / 2 + j.
static uint32_t ball(int i, int j)
{
	return (uint32_t)(1 + i * (i + 1) / 2 + j);
}

// Runs differ in restitution.
enum { RUNS = 4 };
static const double restitution[RUNS] = { 1, .9, .5, 0 };

// variant: the friction
static void build_break(ob_world *w, uint32_t run, const double *variant)
{
	w->gravity = ob_v3(0, 0, 0);
	ob_world_sphere(w, mass, radius, ob_v3(-.5, 0, 0)).state->v.x = speed;
	for (int i = 0; i < ROWS; i++)
		for (int j = 0; j <= i; j++)
			ob_world_sphere(w, mass, radius, ob_v3(i * sqrt(3) * radius, (2 * j - i) * radius, 0));
	ob_world_material(w, variant[0], restitution[run]);
}

// Largest deviation, over velocities and surface speeds, of two balls from mirror images in the plane y = 0.
static double asymmetry(const ob_case_run_state *t, uint32_t a, uint32_t b)
{
	ob_state p = ob_look_at(t, a), q = ob_look_at(t, b);
	ob_vec3 v = ob_v3(p.v.x - q.v.x, p.v.y + q.v.y, p.v.z - q.v.z);
	ob_vec3 w = ob_v3(p.w.x + q.w.x, p.w.y - q.w.y, p.w.z + q.w.z);
	return fmax(ob_norm(v), radius * ob_norm(w));
}

static void observe_break(ob_case_run_state *t)
{
	double p = mass * speed, energy = .5 * mass * speed * speed;
	ob_look_keep(&t->figure[ASYMMETRY], asymmetry(t, 0, 0));
	for (int i = 0; i < ROWS; i++)
		for (int j = 0; j <= i; j++)
			ob_look_keep(&t->figure[ASYMMETRY], asymmetry(t, ball(i, j), ball(i, i - j)));
	ob_look_keep(&t->figure[MOMENTUM], ob_norm(ob_sub(ob_measure_momentum(&t->now), ob_v3(p, 0, 0))) / p);
	ob_look_keep(&t->figure[ANGULAR], ob_norm(ob_measure_angular_momentum(&t->now)) / (p * radius));
	ob_look_keep(&t->figure[GAIN], ob_look_energy(t) / energy - 1);
}

static void judge_break(ob_case_run_state *t)
{
	if (ob_look_at(t, ball(ROWS - 1, 0)).v.x <= 0)
		t->failed = "the last row stands";
}

#define BREAK_CASE \
	.row = 29, .duration = 1, .runs = RUNS, .figures = FIGURES, .observe = observe_break, .judge = judge_break
// clang-format off
#define BREAK_FIGURE \
	{ { "asymmetry", "m/s", 1e-9, "none: the break is its own image" }, \
	  { "error of momentum", "1", 1e-12, "momentum at the start" }, \
	  { "error of angular momentum", "1", 1e-9, "none, over the momentum times a radius" }, \
	  { "gain of energy", "1", 1e-9, "energy at the start" } }
// clang-format on

const ob_case ob_case_break_smooth = {
	.name = "break-smooth",
	.slow = true,
	.title = "Break of fifteen smooth balls",
	.setup = "A ball at 8 m/s hits the tip of fifteen that touch in a triangle, in free space; restitution 1, .9, "
		 ".5 "
		 "and 0; no friction.",
	.figure = BREAK_FIGURE,
	.build = build_break,
	BREAK_CASE,
};

const ob_case ob_case_break_rough = {
	.name = "break-rough",
	.slow = true,
	.title = "Break of fifteen rough balls",
	.setup = "As before, with friction .2.",
	.figure = BREAK_FIGURE,
	.build = build_break,
	.variant = { .2 },
	BREAK_CASE,
};
