// Bodies on driven supports: shaking tables, belts, turntables; and stacks and piles that a table keeps from coming to
// rest.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "lab/heap.h"
#include "lab/look.h"
#include "measure/measure.h"
#include "reference/mechanics.h"
#include "world/world.h"

// ---- shaking tables

enum { TABLES = 6 };
static const double grip[TABLES] = { .1, .2, .3, .39, .41, .8 }; // friction; sticking all the time needs .4
static const double amplitude = .1; // m

static double frequency(double g)
{
	return sqrt(.4 * g / amplitude);
}

// Table i is body 2 i, its block the one after.
static void build_shaking(ob_world *w, uint32_t run, const double *variant)
{
	for (int i = 0; i < TABLES; i++) {
		ob_world_body table = ob_world_box(w, 0, ob_v3(2, 1, .1), ob_v3(0, 4 * i, -.1));
		ob_world_swing(w, table, ob_v3(amplitude, 0, 0), frequency(-w->gravity.z), 0);
		table.passport->friction = grip[i];
		ob_world_box(w, 10, ob_v3(.2, .2, .1), ob_v3(0, 4 * i, .1)).passport->friction = grip[i];
	}
}

enum { BLOCK_OFF, BLOCK_WAY }; // m, of a block's memory

static void observe_shaking(ob_case_run_state *t)
{
	const double g = ob_look_gravity(t);
	for (uint32_t i = 0; i < TABLES; i++) {
		const ob_vec3 moved = ob_look_moved(t, 2 * i + 1);
		const double exact = ob_reference_shaken_block(amplitude, frequency(g), grip[i], g, 0, t->time).x;
		double *memory = &t->body_memory[8 * i];
		memory[BLOCK_OFF] = fmax(memory[BLOCK_OFF], ob_norm(ob_sub(moved, ob_v3(exact, 0, 0))));
		memory[BLOCK_WAY] = fmax(memory[BLOCK_WAY], fabs(exact));
	}
}

static void judge_shaking(ob_case_run_state *t)
{
	for (uint32_t i = 0; i < TABLES; i++)
		ob_look_keep(&t->figure[0], t->body_memory[8 * i + BLOCK_OFF] / t->body_memory[8 * i + BLOCK_WAY]);
}

const ob_case ob_case_shaking_tables = {
	.row = 39,
	.name = "shaking-tables",
	.title = "Blocks on shaking tables",
	.setup =
		"Boxes of 10 kg on six tables that go to and fro by .1 m at up to .4 g; friction of .1, .2, .3 and .39 "
		"(they slide, and stop), .41 and .8 (they stick); the largest displacement that is missed at any "
		"moment, against the largest way; 5 s.",
	.duration = 5,
	.figures = 1,
	.figure = { { "error of the displacement", "1", .01, "each phase in closed form (Coulomb 1785)" } },
	.build = build_shaking,
	.observe = observe_shaking,
	.judge = judge_shaking,
};

// ---- belts

enum { BELTS = 4 };
static const double belt_speed[BELTS] = { .5, 1, 2, 3 }; // m/s
static const double mu = .3;

// Belt i is body 2 i, its box the one after.
static void build_belts(ob_world *w, uint32_t run, const double *variant)
{
	for (int i = 0; i < BELTS; i++) {
		ob_world_box(w, 0, ob_v3(6, .5, .1), ob_v3(4, 3 * i, -.1)).passport->surface_velocity =
			ob_v3(belt_speed[i], 0, 0);
		ob_world_box(w, 5, ob_v3(.2, .2, .2), ob_v3(0, 3 * i, .2));
	}
	ob_world_material(w, mu, 0);
}

enum { BOX_SPEED, BOX_REACHES }; // m/s; s

static void observe_belts(ob_case_run_state *t)
{
	const double pull = mu * ob_look_gravity(t), h = t->settings.step_length;
	for (uint32_t i = 0; i < BELTS; i++) {
		double *memory = &t->body_memory[8 * i], v = ob_look_at(t, 2 * i + 1).v.x;
		if (memory[BOX_REACHES] == 0 && v > (1 - 1e-6) * belt_speed[i])
			memory[BOX_REACHES] = t->time - h + (belt_speed[i] - memory[BOX_SPEED]) / pull;
		memory[BOX_SPEED] = v;
	}
}

static void judge_belts(ob_case_run_state *t)
{
	const double g = ob_look_gravity(t);
	for (uint32_t i = 0; i < BELTS; i++) {
		const double *memory = &t->body_memory[8 * i], time = ob_reference_stop_time(belt_speed[i], mu, g);
		const double way = belt_speed[i] * t->time - ob_reference_stop_distance(belt_speed[i], mu, g);
		const ob_vec3 off = ob_sub(ob_look_moved(t, 2 * i + 1), ob_v3(way, 0, 0));
		ob_look_keep(&t->figure[0], fabs(memory[BOX_REACHES] / time - 1));
		ob_look_keep(&t->figure[1], ob_norm(off) / way);
	}
}

const ob_case ob_case_belts = {
	.row = 40,
	.name = "belts",
	.title = "Boxes on conveyor belts",
	.setup = "Boxes are put down on four belts of .5 to 3 m/s, friction .3; when they have the belt's speed, and "
		 "their "
		 "way; 2 s.",
	.duration = 2,
	.figures = 2,
	.figure = { { "error of the time to the belt's speed", "1", .01, "v / (mu g) (Coulomb 1785)" },
		    { "error of the way", "1", .01, "v t - v^2 / (2 mu g)" } },
	.build = build_belts,
	.observe = observe_belts,
	.judge = judge_belts,
};

// ---- turntables

enum { TURNTABLES = 21 };
static const double rate = 2; // rad/s

static double share(uint32_t i) // relative to the limit
{
	return .9525 + .005 * i;
}

// Turntable i is body 2 i, its box the one after.
static void build_turntables(ob_world *w, uint32_t run, const double *variant)
{
	const double limit = ob_reference_turntable_radius(rate, .5, -w->gravity.z);
	for (uint32_t i = 0; i < TURNTABLES; i++) {
		const double y = 6. * i, r = share(i) * limit;
		ob_world_body table = ob_world_cylinder(w, 0, 2.5, .1, ob_v3(0, y, -.1));
		ob_world_kinematic(table);
		table.state->w.z = rate;
		ob_world_body b = ob_world_box(w, 5, ob_v3(.1, .1, .05), ob_v3(r, y, .05));
		b.state->v.y = rate * r;
		b.state->w.z = rate;
	}
	ob_world_material(w, .5, 0);
}

// The limit lies between the last box that stays and the first that does not.
static void judge_turntables(ob_case_run_state *t)
{
	const double c = cos(rate * t->time), s = sin(rate * t->time);
	double stays = 0, goes = INFINITY, crept = 0;
	for (uint32_t i = 0; i < TURNTABLES; i++) {
		const ob_vec3 from = ob_sub(t->world->state[2 * i + 1].pose.p, t->world->state[2 * i].pose.p),
			      to = ob_sub(ob_look_at(t, 2 * i + 1).pose.p, t->world->state[2 * i].pose.p);
		const double off = hypot(to.x - c * from.x, to.y - s * from.x);
		if (off < .05) {
			stays = fmax(stays, share(i));
			crept = fmax(crept, off);
		} else {
			goes = fmin(goes, share(i));
		}
	}
	t->figure[0] = stays < goes ? fabs(.5 * (stays + goes) - 1) : 1;
	t->figure[1] = 1e3 * crept;
}

const ob_case ob_case_turntables = {
	.row = 41,
	.name = "turntables",
	.title = "Boxes on turntables",
	.setup = "Boxes ride on turntables of 2 rad/s, from .9525 to 1.0525 of the radius at which friction of .5 "
		 "holds them, "
		 "each on its own; the radius from which they are thrown off, and the creep of those that stay; 6 s.",
	.duration = 6,
	.figures = 2,
	.figure = { { "error of the limit", "1", .01, "mu g = rate^2 r (Coulomb 1785, Huygens 1673)" },
		    { "creep of what stays", "mm", .01, "none" } },
	.build = build_turntables,
	.judge = judge_turntables,
};

// ---- shaken stacks and piles

enum { SEEDS = 5 }; // a run for each

// A table with its top at z = 0 swings along x, starting at rest at one end. It is body 0.
static void build_shaken_table(ob_world *w, double half, double acceleration)
{
	ob_world_body table = ob_world_box(w, 0, ob_v3(half, half, .5), ob_v3(-amplitude, 0, -.5));
	ob_world_swing(w, table, ob_v3(amplitude, 0, 0), sqrt(acceleration / amplitude), acos(0));
}

static void build_shaken_stack(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 4200 + run;
	build_shaken_table(w, 2, -.3 * w->gravity.z);
	for (int i = 0; i < 10; i++) {
		ob_vec3 off = ob_splitmix_vector(&seed, .01);
		ob_world_box(w, 250, ob_v3(.5, .5, .125), ob_v3(off.x, off.y, .125 + .25 * i));
	}
}

static void observe_shaken_stack(ob_case_run_state *t)
{
	const double f = ob_world_path(t->world, 0)->frequency;
	ob_stand_observe_at(t, ob_v3(amplitude * (cos(f * t->time) - 1), 0, 0));
}

const ob_case ob_case_shaken_stack = {
	.row = 42,
	.name = "shaken-stack",
	.title = "Shaken stack of 10",
	.setup = "Ten slabs of 1 x 1 x .25 m and 250 kg, each up to 10 mm off the axis, friction .5, ride on a table "
		 "that goes to and fro by .1 m at up to .3 g; nothing slips or tips, and nothing ever rests; 20 s; the "
		 "worst of five such.",
	.compared = true,
	.duration = 20,
	.runs = SEEDS,
	.figures = OB_STAND_FIGURES,
	.figure = { { "worst penetration", "mm", .5, "no penetration" },
		    { "creep", "mm", 1, "it rides along: farthest that a body is aside of where the table takes it" },
		    { "bodies that fell", "1", 0, "none: friction and width hold all of it" },
		    { "mean penetration", "mm", NAN, "no penetration; over contacts and time" } },
	.build = build_shaken_stack,
	.observe = observe_shaken_stack,
	.judge = ob_stand_judge,
};

static void build_shaken_pile(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 4250 + run;
	build_shaken_table(w, 15, -.6 * w->gravity.z);
	for (int i = 0; i < 64; i++) {
		ob_vec3 p = ob_v3((i % 4 - 1.5) * .75, (i / 4 % 4 - 1.5) * .75, .75 + .8 * (i / 16));
		p = ob_add(p, ob_splitmix_vector(&seed, .05));
		ob_vec3 turn = ob_splitmix_vector(&seed, .15);
		ob_world_box(w, 125, ob_v3(.25, .25, .25), p).state->pose.q = ob_quat_turn(ob_quat_identity(), turn);
	}
}

const ob_case ob_case_shaken_pile = {
	.row = 42,
	.name = "shaken-pile",
	.slow = true,
	.title = "Shaken pile of 64",
	.setup = "64 boxes of .5 m in a loose grid, slightly turned, drop half a metre on a table that goes to and fro "
		 "by .1 m at up to .6 g; friction .5, so that they slip all the time; 10 s; the worst of five such.",
	.compared = true,
	.duration = 10,
	.runs = SEEDS,
	.figures = OB_HEAP_GROWTH,
	.figure = { { "mean penetration in the last second", "mm", .5, "no penetration" },
		    { "worst penetration in the last second", "mm", 2, "no penetration" },
		    { "worst penetration at any moment", "mm", 2, "no penetration" } },
	.build = build_shaken_pile,
	.observe = ob_heap_observe,
	.judge = ob_heap_judge,
};
