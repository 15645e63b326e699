// A wall hit by a ball every half second: none of its bodies rests for longer, so an engine that skips bodies in
// equilibrium gains little.
//
// Body 0 is the ground, then come the bricks, then the balls. A constant force balances the weight of a ball, so that
// it flies on a straight line, from alternating sides, each towards another brick. It bounces off, and its way back is
// free.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "measure/measure.h"
#include "world/world.h"

enum { ROWS = 6, ROW_BRICKS = 5, BRICKS = 27, BALLS = 19, SEEDS = 5 }; // every other row has one brick less
enum { WORST, GROWTH, DRIFT, FALLEN, MISSED, FIGURES };
enum { MEMORY_LOWEST }; // J
static const double every = .5, speed = 6, radius = .15, ball_mass = 20; // s, m/s, m, kg
static const ob_vec3 half = { .5, .25, .25 }; // m, half size of a brick of 500 kg

// Shuffles the bricks for each run (Fisher and Yates); returns their bodies' ids.
static void draw_aims(uint32_t aim[BRICKS], uint64_t *seed)
{
	for (uint32_t i = 0; i < BRICKS; i++) {
		uint32_t j = (uint32_t)(ob_splitmix_real(seed) * (i + 1));
		aim[i] = aim[j];
		aim[j] = 1 + i;
	}
}

static void build_bricks(ob_world *w)
{
	for (int row = 0; row < ROWS; row++) {
		int bricks = ROW_BRICKS - row % 2;
		for (int i = 0; i < bricks; i++)
			ob_world_box(w, 500, half,
				     ob_v3((2 * half.x + .01) * (i - .5 * (bricks - 1)), 0, half.z * (2 * row + 1)));
	}
}

static void build_hits(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 25 + run;
	uint32_t aim[BRICKS];
	ob_world_ground(w);
	build_bricks(w);
	draw_aims(aim, &seed);
	for (uint32_t k = 0; k < BALLS; k++) {
		double side = k % 2 ? 1 : -1, way = half.y + radius + speed * every * (k + 1);
		ob_vec3 target = ob_add(w->state[aim[k]].pose.p, ob_splitmix_vector(&seed, .05));
		ob_world_body b = ob_world_sphere(w, ball_mass, radius, ob_v3(target.x, side * way, target.z));
		b.passport->force = ob_scale(w->gravity, -ball_mass);
		b.passport->restitution = .5;
		b.state->v = ob_v3(0, -side * speed, 0);
	}
}

// The balls' own force has a potential, too.
static double energy_of(const ob_case_run_state *t)
{
	double sum = ob_look_energy(t);
	for (uint32_t id = 0; id < t->world->objects; id++)
		sum -= ob_dot(t->world->passport[id].force, ob_look_at(t, id).pose.p);
	return sum;
}

static void observe_hits(ob_case_run_state *t)
{
	double energy = energy_of(t), fallen = 0;
	ob_look_penetration(t, &t->figure[WORST]);
	if (!t->frame)
		t->memory[MEMORY_LOWEST] = energy;
	t->memory[MEMORY_LOWEST] = fmin(t->memory[MEMORY_LOWEST], energy);
	ob_look_keep(&t->figure[GROWTH], (energy - t->memory[MEMORY_LOWEST]) / (.5 * ball_mass * speed * speed));
	for (uint32_t id = 1; id <= BRICKS; id++) {
		ob_vec3 moved = ob_look_moved(t, id);
		ob_look_keep(&t->figure[DRIFT], 1e3 * hypot(moved.x, moved.y));
		fallen += ob_norm(moved) > .25;
	}
	t->figure[FALLEN] = fallen;
	if (fallen > 0)
		t->failed = "fell";
}

// A ball has hit once it flies back.
static void judge_hits(ob_case_run_state *t)
{
	for (uint32_t id = 1 + BRICKS; id < t->world->objects; id++)
		t->figure[MISSED] += ob_look_at(t, id).v.y * t->world->state[id].v.y > -.01;
}

const ob_case ob_case_hit_wall = {
	.row = 26,
	.name = "hit-wall",
	.title = "Wall hit every half second",
	.setup = "A wall of 27 bricks of 1 x .5 x .5 m and 500 kg, six rows in bond, friction .5, is hit every half "
		 "second "
		 "by a weightless ball of 20 kg at 6 m/s, e = .5, from one side and from the other; 10 s; the worst of "
		 "five "
		 "such.",
	.others = "not measured by others",
	.compared = true,
	.duration = 10,
	.runs = SEEDS,
	.figures = FIGURES,
	.figure = { { "worst penetration", "mm", .5, "no penetration" },
		    { "growth of energy", "1", .1, "none: largest rise from its lowest so far, over that of a ball" },
		    { "drift", "mm", NAN,
		      "what the hits and Coulomb's friction leave: farthest that a brick gets aside" },
		    { "bricks that fell", "1", 0, "none: a hit moves a brick by millimetres" },
		    { "balls that did not bounce", "1", 0, "each of the 19 hits, and flies back" } },
	.build = build_hits,
	.observe = observe_hits,
	.judge = judge_hits,
};
