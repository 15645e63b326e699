// Balls bouncing on the ground.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum { MEMORY_LAST, MEMORY_BOUNCES, MEMORY_APEX }; // body 1's state in ob_case_run_state.memory

enum { RADIUS, RESTITUTION }; // variant: m

static void build_ball(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	ob_world_sphere(w, 1, variant[RADIUS], ob_v3(0, 0, 1 + variant[RADIUS]));
	ob_world_material(w, .5, variant[RESTITUTION]);
}

// Counts the turns of body 1 from falling to rising.
static int bounces(ob_case_run_state *t)
{
	double v = ob_look_at(t, 1).v.z;
	t->memory[MEMORY_BOUNCES] += t->memory[MEMORY_LAST] < 0 && v > 0;
	t->memory[MEMORY_LAST] = v;
	return (int)t->memory[MEMORY_BOUNCES];
}

static void fail_without_bounces(ob_case_run_state *t)
{
	if (!ob_look_fail_below(t) && t->memory[MEMORY_BOUNCES] < 1)
		t->failed = "never bounced";
}

static void observe_bounce(ob_case_run_state *t)
{
	double scale = t->world->passport[1].mass * ob_look_gravity(t); // J, a drop of 1 m
	if (!t->frame)
		t->memory[MEMORY_APEX] = ob_look_energy(t);
	bounces(t);
	ob_look_keep(&t->figure[0], fabs(ob_look_energy(t) - t->memory[MEMORY_APEX]) / scale);
}

static void judge_bounce(ob_case_run_state *t)
{
	t->figure[1] = fabs(t->memory[MEMORY_BOUNCES] - 100);
	fail_without_bounces(t);
}

const ob_case ob_case_bounce = {
	.row = 4,
	.name = "bounce",
	.title = "Bouncing ball, e = 1",
	.setup = "A sphere of radius .5 m is dropped from 1 m on a fixed ground and bounces a hundred times.",
	.others = "ODE loses 62 % at 240 Hz",
	.compared = true,
	.duration = 90, // the hundredth comes after 199 sqrt(2 h / g) = 89.9 s
	.figures = 2,
	.figure = { { "error of energy", "1", 1e-12, "energy at the start, over that of the drop" },
		    { "bounces too many or too few", "1", 0, "drop and rebound take 2 sqrt(2 h / g) (Galilei 1638)" } },
	.build = build_ball,
	.variant = { .5, 1 },
	.observe = observe_bounce,
	.judge = judge_bounce,
};

enum { APEXES = 4 };

// Apex of each flight, from its highest frame: the rest of the rise is v^2 / 2 g.
static void observe_apexes(ob_case_run_state *t)
{
	int k = bounces(t);
	ob_state b = ob_look_at(t, 1);
	double bottom = b.pose.p.z - t->world->passport[1].size.x;
	if (k > APEXES || (t->body_memory[k] > 0 && bottom <= t->body_memory[k]))
		return;
	t->body_memory[k] = bottom;
	t->memory[MEMORY_APEX + k] = bottom + b.v.z * b.v.z / (2 * ob_look_gravity(t));
}

static void judge_apexes(ob_case_run_state *t)
{
	for (int k = 1; k <= APEXES; k++)
		ob_look_keep(&t->figure[0], fabs(t->memory[MEMORY_APEX + k] - ob_reference_apex(1, .8, k)));
	fail_without_bounces(t);
}

const ob_case ob_case_apexes = {
	.row = 5,
	.name = "apexes",
	.title = "Heights of a ball, e = .8",
	.setup = "A sphere of radius .1 m is dropped from 1 m with restitution .8; its next four highest points.",
	.others = "-12 % to +81 %",
	.duration = 2.5, // the fifth impact comes at 2.58 s
	.figures = 1,
	.figure = { { "worst error of height", "m", 1e-9, "h e^(2 k) (Newton 1687)" } },
	.build = build_ball,
	.variant = { .1, .8 },
	.observe = observe_apexes,
	.judge = judge_apexes,
};

static void build_bouncing_49(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_balls(w, 49);
}

static void observe_bouncing_49(ob_case_run_state *t)
{
	double error = ob_look_energy(t) - 49 * 10 * ob_look_gravity(t) * 5;
	bounces(t);
	if (t->frame)
		t->figure[0] += (error * error - t->figure[0]) / t->frame; // mean over the frames
	ob_look_fail_below(t);
}

const ob_case ob_case_bouncing_49 = {
	.row = 6,
	.name = "bouncing-49",
	.title = "SimBenchmark's bouncing test",
	.setup = "7 x 7 elastic spheres of radius .1 m and 10 kg, 2 m apart, fall from a height of 5 m without "
		 "friction; 20 s.",
	.others = "at 1 ms: RaiSim .019 J^2, ODE 185 J^2",
	.duration = 20,
	.figures = 1,
	.figure = { { "mean squared error of energy", "J^2", 1e-8, "49 m g h (Kang and Hwangbo 2018)" } },
	.build = build_bouncing_49,
	.observe = observe_bouncing_49,
	.judge = fail_without_bounces,
};
