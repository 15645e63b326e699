// Fast bodies must not pass through thin ones: boxes at a wall, and at each other.
//
// A hundred aims share a world, each in a lane of its own, 40 m from the next; a run has one speed. Every box would be
// at its aim 3 to 4 m from its start.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "world/world.h"

enum { AIMS = 100, SIDE = 10 };
static const double lane = 40; // m
static const double far_enough = 5; // m travelled: by then it has hit

static ob_vec3 middle_of(int aim)
{
	return ob_v3(0, lane * (aim % SIDE), lane * (aim / SIDE));
}

// Shoots a box with random attitude and spin, up to a tenth off course, so that its centre would be at "target" after
// "way" metres.
static void build_shot(ob_world *w, uint64_t *seed, ob_vec3 target, double speed, double way)
{
	ob_vec3 v = ob_splitmix_vector(seed, .1 * fabs(speed));
	v.x = speed;
	ob_world_body b = ob_world_box(w, 8, ob_v3(.1, .1, .1), ob_madd(target, -way / fabs(speed), v));
	b.state->v = v;
	b.state->w = ob_splitmix_vector(seed, 1);
	b.state->pose.q = ob_world_random_attitude(seed);
}

static bool is_over(const ob_case_run_state *t, double speed)
{
	return t->time > far_enough / speed + 4 * t->settings.step_length;
}

// ---- row 18: the wall is body 2 i, the box body 2 i + 1

enum { WALL_SPEEDS = 5, MEMORY_HIT = 0, MEMORY_PASSED };
static const double wall_speed[WALL_SPEEDS] = { 10, 30, 100, 300, 1000 }; // m/s
static const double wall_half = 4; // m

static void build_thin_wall(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 18 + run;
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < AIMS; i++) {
		ob_world_box(w, 0, ob_v3(.01, wall_half, wall_half), middle_of(i));
		ob_vec3 target = ob_splitmix_vector(&seed, .25);
		target.x = 0;
		double way = ob_splitmix_within(&seed, 3, 4);
		build_shot(w, &seed, ob_add(middle_of(i), target), wall_speed[run], way);
	}
	ob_world_material(w, .3, 0);
}

// Half inside is as bad as through. Beyond the wall's rim, positions do not count.
static void observe_thin_wall(ob_case_run_state *t)
{
	double speed = wall_speed[t->run];
	for (uint32_t i = 0; i < AIMS && !is_over(t, speed); i++) {
		double *memory = &t->body_memory[8 * i];
		ob_state b = ob_look_at(t, 2 * i + 1);
		ob_vec3 off = ob_sub(b.pose.p, ob_look_at(t, 2 * i).pose.p);
		bool beside = fabs(off.y) > wall_half || fabs(off.z) > wall_half;
		if (b.v.x < .99 * speed)
			memory[MEMORY_HIT] = 1;
		if (off.x > -.05 && !beside)
			memory[MEMORY_PASSED] = 1;
	}
}

static double count(const ob_case_run_state *t, int what)
{
	double sum = 0;
	for (uint32_t i = 0; i < AIMS; i++)
		sum += t->body_memory[8 * i + (uint32_t)what];
	return sum;
}

static void judge_shots(ob_case_run_state *t)
{
	double passed = count(t, MEMORY_PASSED), missed = AIMS - count(t, MEMORY_HIT);
	t->figure[t->run] = fmax(passed, missed);
	if (passed > 0)
		t->failed = "passed through";
	else if (missed > 0)
		t->failed = "never arrived";
}

// clang-format off
#define PASSES(speed) { "passes of 100 at " speed " m/s", "1", 0, "a solid body passes through none" }
// clang-format on

const ob_case ob_case_thin_wall = {
	.row = 18,
	.name = "thin-wall",
	.title = "Thin wall",
	.setup = "Boxes of .2 m fly at a fixed wall of 20 mm, turned and aimed at random: 100 aims at each of 10, "
		 "30, 100, 300 and 1000 m/s.",
	.others = "ODE 77 to 100 of 100",
	.duration = .6,
	.runs = WALL_SPEEDS,
	.figures = WALL_SPEEDS,
	.figure = { PASSES("10"), PASSES("30"), PASSES("100"), PASSES("300"), PASSES("1000") },
	.build = build_thin_wall,
	.observe = observe_thin_wall,
	.judge = judge_shots,
};

// ---- row 19: the pair is bodies 2 i, from -x, and 2 i + 1

enum { BULLET_SPEEDS = 3 };
static const double bullet_speed[BULLET_SPEEDS] = { 200, 500, 1000 }; // m/s

static void build_bullets(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 19 + run;
	double speed = bullet_speed[run];
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < AIMS; i++) {
		ob_vec3 off = ob_splitmix_vector(&seed, .05);
		off.x = 0;
		double way = ob_splitmix_within(&seed, 3, 4);
		build_shot(w, &seed, middle_of(i), speed, way);
		build_shot(w, &seed, ob_add(middle_of(i), off), -speed, way);
	}
	ob_world_material(w, .3, 0);
}

// They have passed each other once their sides are swapped. A pair that hits and then slips past each other is slower.
static void observe_bullets(ob_case_run_state *t)
{
	double speed = bullet_speed[t->run];
	for (uint32_t i = 0; i < AIMS && !is_over(t, speed); i++) {
		double *memory = &t->body_memory[8 * i];
		ob_state a = ob_look_at(t, 2 * i), b = ob_look_at(t, 2 * i + 1);
		bool slower = a.v.x - b.v.x < 1.8 * speed;
		if (slower)
			memory[MEMORY_HIT] = 1;
		else if (a.pose.p.x > b.pose.p.x)
			memory[MEMORY_PASSED] = 1;
	}
}

const ob_case ob_case_bullets = {
	.row = 19,
	.name = "bullets",
	.title = "Two bullets head-on",
	.setup = "Boxes of .2 m fly at each other, turned and aimed at random: 100 pairs at each of +-200, 500 and "
		 "1000 m/s.",
	.others = "Box3D 75 to 100 of 100, Jolt 2 to 100",
	.duration = .15,
	.runs = BULLET_SPEEDS,
	.figures = BULLET_SPEEDS,
	.figure = { PASSES("200"), PASSES("500"), PASSES("1000") },
	.build = build_bullets,
	.observe = observe_bullets,
	.judge = judge_shots,
};
