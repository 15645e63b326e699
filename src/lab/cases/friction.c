// Dry friction on blocks: on a slope just below and above the angle of friction, and sliding in all directions.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

static const double mu = .5;

// Slope of a case, as a share of the angle of friction.
static double slope_of(const double *variant)
{
	return variant[0] * ob_reference_friction_angle(mu);
}

static void build_block(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_body s = ob_world_slope(w, slope_of(variant));
	ob_quat q = s.state->pose.q;
	ob_mat3 r = ob_quat_matrix(q);
	ob_world_box(w, 500, ob_v3(.5, .5, .25), ob_scale(ob_column(&r, 2), .25)).state->pose.q = q;
	ob_world_material(w, mu, 0);
}

// Displacement (m) of the block along the slope, downwards and sideways.
static void crept(const ob_case_run_state *t, double *down, double *aside)
{
	ob_mat3 r = ob_quat_matrix(t->world->state[0].pose.q);
	ob_vec3 moved = ob_look_moved(t, 1);
	*down = ob_dot(moved, ob_column(&r, 0));
	*aside = ob_dot(moved, ob_column(&r, 1));
}

static void observe_stick(ob_case_run_state *t)
{
	double down, aside;
	crept(t, &down, &aside);
	ob_look_keep(&t->figure[0], 1e3 * hypot(down, aside));
}

static void judge_stick(ob_case_run_state *t)
{
	ob_mat3 r = ob_quat_matrix(t->world->state[0].pose.q);
	if (fabs(ob_dot(ob_look_moved(t, 1), ob_column(&r, 2))) > .1)
		t->failed = "left the slope";
}

const ob_case ob_case_incline_stick = {
	.row = 10,
	.name = "incline-stick",
	.title = "Block sticks on a slope",
	.setup = "A box of 1 x 1 x .5 m on a slope of .99 of the angle of friction, friction .5; 10 s.",
	.others = "ODE creeps 1.5 mm",
	.duration = 10,
	.figures = 1,
	.figure = { { "creep", "mm", .01, "none (Coulomb 1785)" } },
	.build = build_block,
	.variant = { .99 },
	.observe = observe_stick,
	.judge = judge_stick,
};

static void judge_slide(ob_case_run_state *t)
{
	double angle = slope_of(t->of->variant), down, aside;
	double exact = .5 * ob_reference_incline(ob_look_gravity(t), angle, mu) * t->time * t->time;
	crept(t, &down, &aside);
	t->figure[0] = hypot(down - exact, aside) / exact;
	if (hypot(down, aside) < .01 * exact)
		t->failed = "nothing moved";
}

const ob_case ob_case_incline_slide = {
	.row = 10,
	.name = "incline-slide",
	.title = "Block slides down a slope",
	.setup = "A box of 1 x 1 x .5 m on a slope of 1.01 of the angle of friction, friction .5; its way after 4 s.",
	.others = "ODE +7.3 %",
	.duration = 4,
	.figures = 1,
	.figure = { { "error of the way", "1", .003, "g (sin - mu cos) t^2 / 2 (Coulomb 1785)" } },
	.build = build_block,
	.variant = { 1.01 },
	.judge = judge_slide,
};

enum { HEADINGS = 12, MEMORY_SPEED = 0, MEMORY_STOPS = 1 };
static const double speed = 3; // m/s

// All in one world, 4 m apart. Headings 15 degrees apart, every other one reversed: along both axes and both diagonals,
// and into every quadrant.
static void build_sliding(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	for (int i = 0; i < HEADINGS; i++) {
		double heading = i * M_PI / 12 + (i % 2 ? M_PI : 0);
		ob_world_body b = ob_world_box(w, 500, ob_v3(.5, .5, .25), ob_v3(4 * i, 0, .25));
		b.state->v = ob_v3(speed * cos(heading), speed * sin(heading), 0);
	}
	ob_world_material(w, mu, 0);
}

// A block stops between frames: when its last speed has fallen to 0 at its deceleration.
static void observe_sliding(ob_case_run_state *t)
{
	for (uint32_t i = 1; i <= HEADINGS; i++) {
		double *memory = &t->body_memory[8 * i], v = ob_norm(ob_look_at(t, i).v),
		       lost = memory[MEMORY_SPEED] - v;
		if (t->frame && v > .05 * speed && lost > 0)
			memory[MEMORY_STOPS] = t->time + v / lost * t->settings.step_length;
		memory[MEMORY_SPEED] = v;
	}
}

static void judge_sliding(ob_case_run_state *t)
{
	double g = ob_look_gravity(t), way = ob_reference_stop_distance(speed, mu, g);
	double least = INFINITY, most = 0;
	for (uint32_t i = 1; i <= HEADINGS; i++) {
		ob_vec3 moved = ob_look_moved(t, i), along = ob_scale(t->world->state[i].v, 1 / speed);
		double went = hypot(moved.x, moved.y), stops = t->body_memory[8 * i + MEMORY_STOPS];
		ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_v3(moved.x, moved.y, 0), ob_scale(along, way))) / way);
		ob_look_keep(&t->figure[1], fabs(stops / ob_reference_stop_time(speed, mu, g) - 1));
		least = fmin(least, went);
		most = fmax(most, went);
	}
	t->figure[2] = (most - least) / way;
	ob_look_fail_below(t);
}

const ob_case ob_case_sliding = {
	.row = 11,
	.name = "sliding",
	.title = "Sliding in all directions",
	.setup = "Twelve boxes of 1 x 1 x .5 m start at 3 m/s in as many directions; friction .5; 1 s.",
	.others = "Box3D -.4 %; ODE -31 % along the diagonal",
	.duration = 1,
	.figures = 3,
	.figure = { { "worst error of the way", "1", 1e-3, "v^2 / (2 mu g) (Coulomb 1785)" },
		    { "worst error of the time", "1", 1e-3, "v / (mu g) (Coulomb 1785)" },
		    { "spread of the ways", "1", 1e-3, "the same in all directions" } },
	.build = build_sliding,
	.observe = observe_sliding,
	.judge = judge_sliding,
};
