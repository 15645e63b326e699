// Standing structures beyond the cases of the lab: energy and drift of stacks, heavy on light, a stack that drops onto
// itself, bricks at the full overhang and cards just held by friction, to a millimetre.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/mechanics.h"

typedef struct outcome {
	double deepest, drift, sunk; // m: at any moment; largest sideways motion of a body; and down
	double deepest_end; // m
	double gained; // share of the energy, at most
	bool asleep; // some body
} outcome;

static outcome watch(little_scene *s, double seconds)
{
	outcome out = { 0 };
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	for (int step = 0; step < lround(60 * seconds); step++) {
		little_run(&l, 1);
		out.deepest = fmax(out.deepest, little_penetration(&l).max_m);
		out.gained = fmax(out.gained, little_energy(&l) / energy - 1);
	}
	for (uint32_t i = 0; i < s->world.objects; i++) {
		ob_vec3 moved = ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p);
		out.drift = fmax(out.drift, hypot(moved.x, moved.y));
		out.sunk = fmax(out.sunk, -moved.z);
		out.asleep |= little_asleep(&l, i);
	}
	out.deepest_end = little_penetration(&l).max_m;
	little_close(&l);
	free(s);
	return out;
}

static void test_stack(int n)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, n, ob_v3(0, 0, 0), 7);
	outcome o = watch(s, 20);
	printf("stack of %d: %.3f mm deep, drifts %.3f mm, energy gained %.1e\n", n, 1e3 * o.deepest, 1e3 * o.drift,
	       o.gained);
	CHECK(o.deepest <= .5e-3);
	CHECK(o.drift <= 1e-3);
	CHECK(o.sunk <= n * .1e-3);
	CHECK(o.gained <= 1e-9);
	CHECK(!o.asleep);
}

// A heavy cube on a stack of n light ones
static void test_heavy_on_light(int n, double ratio, double deepest)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, n, ob_v3(0, 0, 0), 7);
	ob_world_box(&s->world, ratio * 1000, ob_v3(.5, .5, .5), ob_v3(.005, .005, n + .5));
	outcome o = watch(s, 10);
	printf("%g:1 on %d: %.3f mm deep, drifts %.3f mm, energy gained %.1e\n", ratio, n, 1e3 * o.deepest,
	       1e3 * o.drift, o.gained);
	CHECK(o.deepest <= deepest);
	CHECK(o.sunk <= (n + 1) * deepest && o.drift <= 1e-3);
	CHECK(o.gained <= 1e-9);
}

// A stack that falls onto itself, each cube by a hundredth of its size, comes to rest where it lands.
static void test_rattled_stack(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 20, ob_v3(0, 0, 0), 7);
	for (uint32_t i = 1; i <= 20; i++)
		s->world.state[i].pose.p.z += .01 * i;
	outcome o = watch(s, 10);
	printf("rattled stack of 20: %.3f mm deep at the end, drifts %.3f mm\n", 1e3 * o.deepest_end, 1e3 * o.drift);
	CHECK(o.deepest_end <= .5e-3);
	CHECK(o.drift <= 10e-3);
}

// ---- bricks: 1 m long, each shifted by "stretch" times the limit of the harmonic series

enum { BRICKS = 4 };

static void lay_bricks(little_scene *s, double stretch)
{
	const double height = 3, edge = 0, half = .125;
	double end = edge;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 0, ob_v3(2, 1, .5 * height), ob_v3(edge - 2, 0, .5 * height));
	for (int level = 0; level < BRICKS; level++) {
		end += stretch * ob_reference_overhang_shift(BRICKS - level);
		ob_world_box(&s->world, 100, ob_v3(.5, .25, half), ob_v3(end - .5, 0, height + half * (1 + 2 * level)));
	}
}

// Largest displacement of a brick after 20 s (m).
static double bricks_moved(double stretch)
{
	little_scene *s = little_scene_new();
	lay_bricks(s, stretch);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 20);
	double moved = 0;
	for (uint32_t i = 2; i < s->world.objects; i++)
		moved = fmax(moved, ob_norm(ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p)));
	little_close(&l);
	free(s);
	return moved;
}

static void test_overhang(void)
{
	double stands = bricks_moved(1), topples = bricks_moved(1.01);
	printf("overhang of %.4f lengths: moved %.2e mm; 1 %% more: %.2f m\n", ob_reference_overhang(BRICKS),
	       1e3 * stands, topples);
	CHECK(stands < 1e-3);
	CHECK(topples > 1);
}

// ---- cards: the two touch along their inner upper edges, on which a rim of paper does not slip

static const double length = 1, thickness = .01; // m

static void lean_card(little_scene *s, double angle)
{
	double turn = fabs(angle), side = angle > 0 ? 1 : -1;
	ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 foot = ob_v3(-side * length * sin(turn), 0, 0); // inner lower edge
	ob_vec3 from_centre = ob_rotate(&r, ob_v3(.5 * side * thickness, 0, -.5 * length));
	ob_world_box(&s->world, 1, ob_v3(.5 * thickness, .3, .5 * length), ob_sub(foot, from_centre)).state->pose.q = q;
}

// Largest displacement of a card in so many seconds (m), with this friction between card and ground.
static double cards_moved(double angle, double mu, double time)
{
	const double rough = 1; // between the cards: holds any push up to 45 degrees
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world).passport->friction = mu * mu / rough;
	lean_card(s, angle);
	lean_card(s, -angle);
	s->world.passport[1].friction = s->world.passport[2].friction = rough;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	double moved = 0;
	for (uint32_t i = 1; i <= 2; i++)
		moved = fmax(moved, ob_norm(ob_sub(little_state(&l, i).pose.p, s->world.state[i].pose.p)));
	little_close(&l);
	free(s);
	return moved;
}

static void test_cards(void)
{
	for (double degrees = 15; degrees <= 40; degrees += 12.5) {
		double angle = degrees * M_PI / 180, mu = ob_reference_cards_grip(angle, length, thickness);
		double stands = cards_moved(angle, 1.02 * mu, 60), falls = cards_moved(angle, .98 * mu, 60);
		printf("cards at %.1f degrees, mu %.4f: 2 %% more moved %.2e mm, 2 %% less %.2f m\n", degrees, mu,
		       1e3 * stands, falls);
		CHECK(stands < 1e-3);
		CHECK(falls > .1);
	}
}

int main(void)
{
	test_stack(10);
	test_stack(20);
	test_heavy_on_light(10, 100, 2e-3);
	test_rattled_stack();
	test_overhang();
	test_cards();
	return check_end();
}
