// Hard cases of statics: bricks that reach as far over an edge as bricks can, and two cards that lean on each other.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/mechanics.h"

// ---- bricks: 1 m long, each shifted by "stretch" times what the harmonic series allows

enum { BRICKS = 4 };

static void lay_bricks(little_scene *s, double stretch)
{
	const double height = 3, edge = 0, half = .125;
	double end = edge;
	little_ground(s);
	little_box(s, 0, ob_v3(2, 1, .5 * height), ob_v3(edge - 2, 0, .5 * height));
	for (int level = 0; level < BRICKS; level++) {
		end += stretch * ob_reference_overhang_shift(BRICKS - level);
		little_box(s, 100, ob_v3(.5, .25, half), ob_v3(end - .5, 0, height + half * (1 + 2 * level)));
	}
}

// How far any brick has moved after 20 s (m).
static double bricks_moved(double stretch)
{
	little_scene *s = little_scene_new();
	lay_bricks(s, stretch);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 20);
	double moved = 0;
	for (uint32_t i = 2; i < s->objects; i++)
		moved = fmax(moved, ob_norm(ob_sub(little_state(&l, i).pose.p, s->object[i].state.pose.p)));
	little_close(&l);
	free(s);
	return moved;
}

static void test_overhang(void)
{
	double stands = bricks_moved(1), topples = bricks_moved(1.01);
	printf("overhang of %.4f lengths: moved %.2e mm; 1 %% more: %.2f m\n", ob_reference_overhang(BRICKS), 1e3 * stands,
	       topples);
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
	little_box(s, 1, ob_v3(.5 * thickness, .3, .5 * length), ob_sub(foot, from_centre))->state.pose.q = q;
}

// How far any card has moved in so many seconds (m), with this friction between card and ground.
static double cards_moved(double angle, double mu, double time)
{
	const double rough = 1; // between the cards: holds any push up to 45 degrees
	little_scene *s = little_scene_new();
	little_ground(s)->passport.friction = mu * mu / rough;
	lean_card(s, angle);
	lean_card(s, -angle);
	s->object[1].passport.friction = s->object[2].passport.friction = rough;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	double moved = 0;
	for (uint32_t i = 1; i <= 2; i++)
		moved = fmax(moved, ob_norm(ob_sub(little_state(&l, i).pose.p, s->object[i].state.pose.p)));
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
	test_overhang();
	test_cards();
	return check_end();
}
