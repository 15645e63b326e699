// On the stable or the unstable side of a limit: bricks over a table's edge, two leaning cards, an arch.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/arch.h"
#include "reference/mechanics.h"
#include "world/world.h"

enum { WRONG_SIDE, MOVED, SIDE_FIGURES };
// clang-format off
#define SIDE_FIGURE(reference) \
	{ { "on the wrong side", "1", 0, reference }, { "farthest that a body moved", "mm", NAN, reference } }
// clang-format on
static const double fallen = .05; // m

static void observe_side(ob_case_run_state *t)
{
	ob_look_keep(&t->figure[MOVED], 1e3 * ob_look_farthest(t));
	ob_look_fail_below(t);
}

static void judge_stands(ob_case_run_state *t)
{
	t->figure[WRONG_SIDE] = t->figure[MOVED] > 1e3 * fallen;
	if (t->figure[WRONG_SIDE] > 0 && !t->failed)
		t->failed = "fell";
}

static void judge_falls(ob_case_run_state *t)
{
	t->figure[WRONG_SIDE] = t->failed || t->figure[MOVED] <= 1e3 * fallen;
	if (t->figure[WRONG_SIDE] > 0 && !t->failed)
		t->failed = "stands";
}

enum { BRICKS = 4 };

// They balance on the edge. A rounding error grows e-fold three times a second; in 3 s it stays invisible. variant: share
// of the reach by which every brick is farther out than balance allows
static void build_bricks(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_box(w, 0, ob_v3(2, .5, .5), ob_v3(-2, 0, -.5)); // the table: its edge at x = 0
	ob_world_ground(w).state->pose.p.z = -4;
	double x = -.5;
	for (int i = 0; i < BRICKS; i++) {
		x += (1 + variant[0]) * ob_reference_overhang_shift(BRICKS - i);
		ob_world_box(w, 1, ob_v3(.5, .25, .1), ob_v3(x, 0, .1 + .2 * i));
	}
}

#define HARMONIC "sum of L / 2 k (Johnson 1955)"

const ob_case ob_case_overhang = {
	.row = 21,
	.name = "overhang",
	.title = "Bricks at the full overhang",
	.setup = "Four bricks reach 25/24 of their length over a table's edge, the most that can stand; 3 s.",
	.duration = 3,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(HARMONIC),
	.build = build_bricks,
	.observe = observe_side,
	.judge = judge_stands,
};

const ob_case ob_case_overhang_over = {
	.row = 21,
	.name = "overhang-over",
	.title = "Bricks 1 % over the overhang",
	.setup = "As before, every brick 1 % farther out: they must topple within 3 s.",
	.duration = 3,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(HARMONIC),
	.build = build_bricks,
	.variant = { .01 },
	.observe = observe_side,
	.judge = judge_falls,
};

// Cards of 1 m x 1 m x 20 mm that lean at 30 degrees to the vertical; their inner upper edges touch at x = 0. variant:
// friction on the ground, relative to what they need; the cards' own contact is rough.
static void build_cards(ob_world *w, uint32_t run, const double *variant)
{
	const double angle = M_PI / 6, length = 1, thickness = .02, rough = 2;
	double mu = variant[0] * ob_reference_cards_grip(angle, length, thickness);
	// axes of the left one
	ob_vec3 along = ob_v3(sin(angle), 0, cos(angle)), inner = ob_v3(cos(angle), 0, -sin(angle));
	ob_vec3 edge = ob_add(ob_scale(along, .5 * length), ob_scale(inner, .5 * thickness));
	ob_vec3 foot = ob_sub(ob_scale(inner, .5 * thickness), ob_scale(along, .5 * length));
	ob_world_ground(w);
	for (int side = -1; side <= 1; side += 2) {
		ob_vec3 p = ob_v3(side * edge.x, 0, -foot.z);
		ob_world_body b = ob_world_box(w, 1, ob_v3(.5 * thickness, .5, .5 * length), p);
		b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, -side * angle, 0));
	}
	ob_world_material(w, rough, 0);
	w->passport[0].friction = mu * mu / rough; // with a card's: mu
}

#define CARDS "mu >= (tan(angle) - d / l) / 2, by the balance of moments"

const ob_case ob_case_a_frame_stands = {
	.row = 22,
	.name = "a-frame-stands",
	.title = "Two cards that lean and stand",
	.setup = "Two boxes of 1 x 1 x .02 m lean on each other at 30 degrees to the vertical, with 2 % more "
		 "friction on the ground than they need; 60 s.",
	.duration = 60,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(CARDS),
	.build = build_cards,
	.variant = { 1.02 },
	.observe = observe_side,
	.judge = judge_stands,
};

const ob_case ob_case_a_frame_slides = {
	.row = 22,
	.name = "a-frame-slides",
	.title = "Two cards that lean and slide",
	.setup = "As before, with 2 % less friction than they need: they must slide down within 60 s.",
	.duration = 60,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(CARDS),
	.build = build_cards,
	.variant = { .98 },
	.observe = observe_side,
	.judge = judge_falls,
};

enum { VOUSSOIRS = 20 };

// variant: thickness, relative to the least stable one
static void build_arch(ob_world *w, uint32_t run, const double *variant)
{
	static const double radius = 5, half_depth = .5; // m
	const double half = .5 * variant[0] * ob_reference_arch_thickness(VOUSSOIRS, radius);
	ob_world_ground(w);
	for (int i = 0; i < VOUSSOIRS; i++) {
		ob_vec3 corner[8];
		for (int k = 0; k < 8; k++) {
			const double angle = M_PI * (i + (k & 1)) / VOUSSOIRS, r = radius + (k & 2 ? half : -half);
			corner[k] = ob_v3(r * cos(angle), k & 4 ? half_depth : -half_depth, r * sin(angle));
		}
		ob_world_hull(w, 1000, corner, 8, ob_v3(0, 0, 0));
	}
	ob_world_material(w, .9, 0);
}

#define THRUST "a line of thrust within all joints (Heyman 1969)"

const ob_case ob_case_arch_stands = {
	.row = 43,
	.name = "arch-stands",
	.title = "An arch that just stands",
	.setup =
		"Twenty voussoirs in a half circle of 5 m without mortar, .1 % thicker than they must be; friction .9; "
		"20 s.",
	.duration = 20,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(THRUST),
	.build = build_arch,
	.variant = { 1.001 },
	.observe = observe_side,
	.judge = judge_stands,
};

const ob_case ob_case_arch_falls = {
	.row = 43,
	.name = "arch-falls",
	.title = "An arch that just falls",
	.setup = "As before, .1 % thinner than they must be: it must fall within 20 s.",
	.duration = 20,
	.figures = SIDE_FIGURES,
	.figure = SIDE_FIGURE(THRUST),
	.build = build_arch,
	.variant = { .999 },
	.observe = observe_side,
	.judge = judge_falls,
};
