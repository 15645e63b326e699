// Rolling spheres: under a pushed box, after sliding, down a slope.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum { BOX = 1, BALL = 2, BALLS = 25 };
static const double push = 150; // N

// variant: the direction, along x and y
static void build_push(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w).passport->friction = .2; // with the box's .8: .4
	ob_world_body box = ob_world_box(w, 10, ob_v3(10, 10, .5), ob_v3(0, 0, .5 - 2e-5));
	box.passport->friction = .8;
	box.passport->force = ob_scale(ob_v3(variant[0], variant[1], 0), push);
	for (int i = 0; i < BALLS; i++) {
		ob_vec3 p = ob_v3(2 * (i / 5) - 4, 2 * (i % 5) - 4, 1.5 - 6e-5);
		ob_world_sphere(w, 1, .5, p).passport->friction = .8;
	}
}

static double squared_error(const ob_case_run_state *t, uint32_t id, double acceleration)
{
	ob_vec3 direction = ob_scale(t->world->passport[BOX].force, 1 / push);
	return ob_norm2(ob_sub(ob_look_at(t, id).v, ob_scale(direction, acceleration * t->time)));
}

static void observe_push(ob_case_run_state *t)
{
	ob_reference_rolling exact = ob_reference_push(push, .4, 10, 1, BALLS, ob_look_gravity(t));
	double error = squared_error(t, BOX, exact.box_a) + squared_error(t, BALL, exact.ball_a);
	if (t->frame)
		t->figure[0] += (error - t->figure[0]) / t->frame; // mean over the frames
}

static void judge_push(ob_case_run_state *t)
{
	ob_vec3 moved = ob_look_moved(t, BOX);
	if (hypot(moved.x, moved.y) < .1)
		t->failed = "nothing moved";
}

#define PUSH_SETUP \
	"A box of 20 x 20 x 1 m and 10 kg on the ground (friction .4) is pushed by 150 N; 25 spheres of 1 kg roll on " \
	"it " \
	"(friction .8); 4 s. The force goes along "
// clang-format off
#define PUSH_FIGURE \
	{ { "mean squared error of velocities", "m^2/s^2", 1e-6, "SimBenchmark's rolling test (Kang and Hwangbo 2018)" } }
// clang-format on

const ob_case ob_case_rolling_diagonal = {
	.row = 9,
	.name = "rolling-diagonal",
	.title = "Rolling, pushed aslant",
	.setup = PUSH_SETUP "(1/2, sqrt(3)/2).",
	.others = "Jolt 9e-4; Box3D 1e-6 at 240 Hz; ODE 3.1: nothing moves",
	.compared = true,
	.duration = 4,
	.figures = 1,
	.figure = PUSH_FIGURE,
	.build = build_push,
	.variant = { .5, .86602540378443865 },
	.observe = observe_push,
	.judge = judge_push,
};

const ob_case ob_case_rolling_y = {
	.row = 9,
	.name = "rolling-y",
	.title = "Rolling, pushed along y",
	.setup = PUSH_SETUP "y.",
	.others = "Jolt 9e-4; Box3D 1e-6 at 240 Hz",
	.duration = 4,
	.figures = 1,
	.figure = PUSH_FIGURE,
	.build = build_push,
	.variant = { 0, 1 },
	.observe = observe_push,
	.judge = judge_push,
};

static void build_slip_to_roll(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	ob_world_sphere(w, 10, .5, ob_v3(0, 0, .5)).state->v.x = 7;
	ob_world_material(w, .2, 0);
}

enum { MEMORY_SLIP, MEMORY_ROLLS }; // m/s in the last frame; s

// Rolling begins between frames: when the last slip has fallen to 0 at its rate.
static void observe_slip_to_roll(ob_case_run_state *t)
{
	ob_state b = ob_look_at(t, 1);
	double slip = b.v.x - b.w.y * .5, lost = t->memory[MEMORY_SLIP] - slip;
	if (t->frame && slip > .05 * 7 && lost > 0)
		t->memory[MEMORY_ROLLS] = t->time + slip / lost * t->settings.step_length;
	t->memory[MEMORY_SLIP] = slip;
}

static void judge_slip_to_roll(ob_case_run_state *t)
{
	double g = ob_look_gravity(t);
	t->figure[0] = fabs(ob_look_at(t, 1).v.x / ob_reference_roll_speed(7) - 1);
	t->figure[1] = fabs(t->memory[MEMORY_ROLLS] / ob_reference_roll_time(7, .2, g) - 1);
	ob_look_fail_below(t);
}

const ob_case ob_case_slip_to_roll = {
	.row = 12,
	.name = "slip-to-roll",
	.title = "From slipping to rolling",
	.setup = "A sphere is set down at 7 m/s without spin; friction .2; 3 s.",
	.duration = 3,
	.figures = 2,
	.figure = { { "error of the final speed", "1", 1e-3, "5/7 v (Routh 1905)" },
		    { "error of the time when it rolls", "1", 1e-3, "2 v / (7 mu g) (Routh 1905)" } },
	.build = build_slip_to_roll,
	.observe = observe_slip_to_roll,
	.judge = judge_slip_to_roll,
};

static const double slope = 20 * M_PI / 180; // rad

// variant: friction, relative to what rolling needs
static void build_ball_on_slope(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_body s = ob_world_slope(w, slope);
	ob_mat3 r = ob_quat_matrix(s.state->pose.q);
	ob_world_sphere(w, 10, .5, ob_scale(ob_column(&r, 2), .5));
	ob_world_material(w, variant[0] * ob_reference_ball_grip(slope), 0);
}

static void judge_ball_on_slope(ob_case_run_state *t)
{
	ob_mat3 r = ob_quat_matrix(t->world->state[0].pose.q);
	ob_vec3 down = ob_column(&r, 0);
	double a = ob_reference_ball_incline(ob_look_gravity(t), slope, t->world->passport[1].friction);
	t->figure[0] = fabs(ob_dot(ob_look_at(t, 1).v, down) / (a * t->time) - 1);
	t->figure[1] = fabs(ob_dot(ob_look_moved(t, 1), down) / (.5 * a * t->time * t->time) - 1);
}

const ob_case ob_case_sphere_incline_roll = {
	.row = 13,
	.name = "sphere-incline-roll",
	.title = "Sphere rolls down a slope",
	.setup = "A sphere on a slope of 20 degrees, friction 10 % above 2/7 tan(20); 2 s.",
	.duration = 2,
	.figures = 2,
	.figure = { { "error of the speed", "1", 1e-3, "5/7 g sin t (Routh 1905)" },
		    { "error of the way", "1", 1e-3, "5/14 g sin t^2 (Routh 1905)" } },
	.build = build_ball_on_slope,
	.variant = { 1.1 },
	.judge = judge_ball_on_slope,
};

const ob_case ob_case_sphere_incline_slip = {
	.row = 13,
	.name = "sphere-incline-slip",
	.title = "Sphere slips down a slope",
	.setup = "A sphere on a slope of 20 degrees, friction 10 % below 2/7 tan(20); 2 s.",
	.duration = 2,
	.figures = 2,
	.figure = { { "error of the speed", "1", 1e-3, "g (sin - mu cos) t (Routh 1905)" },
		    { "error of the way", "1", 1e-3, "g (sin - mu cos) t^2 / 2 (Routh 1905)" } },
	.build = build_ball_on_slope,
	.variant = { .9 },
	.judge = judge_ball_on_slope,
};
