// Structures whose contacts close cycles stand where they were built, to the last micrometre: towers of planks,
// pyramids of bricks in contact, walls of random bricks, portals. That costs little: they are in equilibrium at once,
// and while a low one moves from a hit, no equilibrium is searched. A high one comes to rest when it lands.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"
#include "step/state.h"

// Largest displacement of a body (m) in so many seconds, in which nothing may sleep; rests: all are in equilibrium
// then.
static double moved(little_scene *s, double seconds, bool *rests)
{
	little_universe l;
	double most = 0;
	little_open(&l, s);
	for (double time = .25; time <= seconds; time += .25) {
		little_run_to(&l, time);
		for (uint32_t i = 0; i < s->world.objects; i++)
			most = fmax(most, ob_norm(ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p)));
	}
	*rests = true;
	for (uint32_t i = 0; i < s->world.objects; i++)
		*rests &= !(s->world.passport[i].mass > 0) || l.now.motion[i].flags & OB_MOTION_EQUILIBRIUM;
	little_close(&l);
	free(s);
	return most;
}

static void check_stands(const char *what, int n, little_scene *s, double seconds)
{
	bool rests;
	const double most = moved(s, seconds, &rests);
	CHECK(most < 1e-5);
	CHECK(rests);
	if (!(most < 1e-5 && rests))
		printf("%s %d: moved by %.2e m%s\n", what, n, most, rests ? "" : ", not in equilibrium");
}

static little_scene *on_ground(void)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3;
	ob_world_ground(&s->world);
	return s;
}

// Layers of planks, each layer across the one below.
static little_scene *crib_tower(int layers, int planks)
{
	little_scene *s = on_ground();
	for (int k = 0; k < layers; k++)
		for (int i = 0; i < planks; i++) {
			const double aside = .45 * (2. * i / (planks - 1) - 1), up = .05 + .1 * k;
			ob_world_box(&s->world, 10, k % 2 ? ob_v3(.06, .6, .05) : ob_v3(.6, .06, .05),
				     k % 2 ? ob_v3(aside, 0, up) : ob_v3(0, aside, up));
		}
	return s;
}

// Two planks a layer, .24 m high and .08 m wide, or the other way round; each up to "jitter" m aside, as it is drawn.
static little_scene *planks(int layers, bool on_edge, double jitter, uint64_t seed)
{
	little_scene *s = on_ground();
	const double high = on_edge ? .12 : .04, wide = on_edge ? .04 : .12;
	for (int k = 0; k < layers; k++)
		for (int side = -1; side <= 1; side += 2) {
			const double across = .45 * side + within(&seed, -jitter, jitter),
				     along = within(&seed, -jitter, jitter), up = (2 * k + 1) * high;
			ob_world_box(&s->world, 14, k % 2 ? ob_v3(wide, .6, high) : ob_v3(.6, wide, high),
				     k % 2 ? ob_v3(across, along, up) : ob_v3(along, across, up));
		}
	return s;
}

// pitch: m, from one cube of a metre to the next; at 1 they are in contact.
static little_scene *pyramid(int rows, double pitch)
{
	little_scene *s = on_ground();
	for (int row = 0; row < rows; row++)
		for (int i = 0; i < rows - row; i++)
			ob_world_box(&s->world, 1000, ob_v3(.5, .5, .5),
				     ob_v3(0, pitch * (i - .5 * (rows - 1 - row)), .5 + row));
	return s;
}

// Bricks of random lengths and depths, some of which touch, some not; each course within the one below.
static little_scene *random_wall(uint64_t seed, int courses, double length)
{
	little_scene *s = on_ground();
	const double height = .2;
	double from = 0, to = length;
	for (int course = 0; course < courses; course++) {
		double at = from += within(&seed, 0, .05), end = to;
		while (at < to - .3) {
			double brick = fmin(within(&seed, .45, .8), to - at), depth = within(&seed, .15, .3);
			ob_world_box(&s->world, 2000 * brick * height * depth, ob_v3(depth, .5 * brick, .5 * height),
				     ob_v3(0, at + .5 * brick, height * (course + .5)));
			end = at + brick;
			at = end + fmax(0, within(&seed, -.08, .08));
		}
		to = end;
	}
	return s;
}

// Storeys of posts under lintels that touch end to end.
static little_scene *portals(int storeys, int bays)
{
	little_scene *s = on_ground();
	for (int storey = 0; storey < storeys; storey++) {
		const double up = 1.2 * storey;
		for (int i = 0; i <= bays; i++)
			ob_world_box(&s->world, 40, ob_v3(.1, .1, .5), ob_v3(0, 1.2 * i, up + .5));
		for (int i = 0; i < bays; i++)
			ob_world_box(&s->world, 60, ob_v3(.12, .6, .1), ob_v3(0, 1.2 * i + .6, up + 1.1));
	}
	return s;
}

// Cubes on each other, each a little aside, as they are drawn.
static little_scene *stack(int cubes)
{
	little_scene *s = on_ground();
	ob_world_stack(&s->world, cubes, ob_v3(0, 0, 0), 14);
	return s;
}

// A wall in bond; a ball hits it in the middle at .1 s, and bounces off.
static little_scene *wall_to_be_hit(void)
{
	enum { ROWS = 6, BRICKS = 5 };
	const ob_vec3 half = { .5, .25, .25 };
	little_scene *s = on_ground();
	for (int row = 0; row < ROWS; row++) {
		const int bricks = BRICKS - row % 2;
		for (int i = 0; i < bricks; i++)
			ob_world_box(&s->world, 500, half,
				     ob_v3((2 * half.x + .01) * (i - .5 * (bricks - 1)), 0, half.z * (2 * row + 1)));
	}
	ob_world_body ball = ob_world_sphere(&s->world, 20, .15, ob_v3(.1, -1., .75));
	ball.passport->force = ob_v3(0, 0, 20 * 9.81);
	ball.passport->restitution = .5;
	ball.state->v = ob_v3(0, 6, 0);
	return s;
}

static uint64_t direct_solves(const little_universe *l)
{
	ob_counters sum;
	ob_universe_count(l->u, &sum);
	return sum.direct_solves;
}

// The bricks turn back now and then, each slow for a moment: a reversal is no rest.
static void test_wall_that_was_hit(void)
{
	little_scene *s = wall_to_be_hit();
	const uint32_t ball = s->world.objects - 1;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, .15);
	CHECK(little_state(&l, ball).v.y < 0);
	const uint64_t before = direct_solves(&l);
	CHECK(before > 0);
	little_run_to(&l, .4);
	CHECK(direct_solves(&l) == before);
	little_close(&l);
	free(s);
}

// A tower set down with gaps between its layers lands, and stands: after a second no plank moves aside. Depth that the
// landing has left is pushed out, so planks may rise.
static void test_landed_tower(int layers, bool on_edge)
{
	little_scene *s = planks(layers, on_edge, 5e-4, 4);
	for (int i = 1; i <= 2 * layers; i++)
		s->world.state[i].pose.p.z += 5e-4 * ((i + 1) / 2);
	little_universe l;
	ob_vec3 landed[2 * 60 + 1];
	double aside = 0;
	CHECK(s->world.objects == 2 * (uint32_t)layers + 1);
	little_open(&l, s);
	for (double time = 1; time <= 5; time += .25) {
		little_run_to(&l, time);
		for (uint32_t i = 1; i <= 2 * (uint32_t)layers; i++) {
			const ob_vec3 p = little_state(&l, i).pose.p;
			if (time == 1)
				landed[i] = p;
			aside = fmax(aside, hypot(p.x - landed[i].x, p.y - landed[i].y));
		}
	}
	printf("landed tower of %d layers%s: %.3f mm aside\n", layers, on_edge ? " on edge" : "", 1e3 * aside);
	CHECK(aside < 1e-4);
	little_close(&l);
	free(s);
}

int main(void)
{
	for (int layers = 15; layers <= 51; layers += 18) {
		test_landed_tower(layers, true);
		test_landed_tower(layers, false);
	}
	for (int cubes = 5; cubes <= 40; cubes *= 2)
		check_stands("stack", cubes, stack(cubes), .25);
	test_wall_that_was_hit();
	for (int layers = 12; layers <= 60; layers += 16)
		check_stands("crib tower", layers, crib_tower(layers, 2), 3);
	check_stands("crib tower", 100, crib_tower(100, 2), 2);
	check_stands("crib tower of three planks", 40, crib_tower(40, 3), 2);
	for (int layers = 20; layers <= 100; layers += 20) {
		check_stands("planks on edge", layers, planks(layers, true, 0, 1), 1);
		check_stands("planks on edge, 10 mm aside", layers, planks(layers, true, .01, 2), 1);
		check_stands("flat planks, 50 mm aside", layers, planks(layers, false, .05, 3), 1);
	}
	check_stands("touching pyramid", 8, pyramid(8, 1), 3);
	check_stands("touching pyramid", 15, pyramid(15, 1), 3);
	check_stands("pyramid", 15, pyramid(15, 1.05), 3);
	for (uint64_t seed = 1; seed <= 6; seed++)
		check_stands("random wall", (int)seed, random_wall(seed, 10, 5), 2);
	for (int storeys = 2; storeys <= 6; storeys += 2)
		check_stands("portals", storeys, portals(storeys, 4), 2);
	return check_end();
}
