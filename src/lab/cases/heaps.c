// Heaps: standing pyramids, dropped piles.
#include "base/random.h"
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "lab/heap.h"
#include "lab/look.h"
#include "world/world.h"

// variant: the number of rows
static void build_pyramid(ob_world *w, uint32_t run, const double *variant)
{
	const int rows = (int)variant[0];
	ob_world_ground(w);
	for (int row = 0; row < rows; row++)
		for (int i = 0; i < rows - row; i++)
			ob_world_box(w, 1000, ob_v3(.5, .5, .5),
				     ob_v3(0, 1.05 * (i - .5 * (rows - row - 1)), .5 + row));
}

const ob_case ob_case_pyramid_10 = {
	.row = 16,
	.name = "pyramid-10",
	.title = "Pyramid of 10 rows",
	.setup = "55 cubes of 1 m and 1000 kg in ten rows, 50 mm between neighbours, friction .5; 20 s.",
	.others = "sag of 12 to 23 mm",
	.figure = OB_STAND_FIGURE(.5, 1),
	.build = build_pyramid,
	.variant = { 10 },
	OB_STAND_CASE,
};

const ob_case ob_case_pyramid_15 = {
	.row = 16,
	.name = "pyramid-15",
	.title = "Pyramid of 15 rows",
	.setup = "120 cubes of 1 m and 1000 kg in fifteen rows, 50 mm between neighbours, friction .5; 20 s.",
	.others = "sag of 12 to 23 mm",
	.figure = OB_STAND_FIGURE(.5, 1),
	.build = build_pyramid,
	.variant = { 15 },
	OB_STAND_CASE,
};

enum { SEEDS = 5 }; // dropping is chaotic: a run for each, and the worst counts

// A loose grid: .25 and .3 m between boxes, displaced by up to 5 cm and turned by up to .15 rad about each axis. The
// lowest centres are half a metre above their final place. variant: the restitution
static void build_pile(ob_world *w, uint32_t run, const double *variant)
{
	uint64_t seed = 17 + run;
	ob_world_ground(w);
	for (int i = 0; i < 216; i++) {
		ob_vec3 p = ob_v3((i % 6 - 2.5) * .75, (i / 6 % 6 - 2.5) * .75, .75 + .8 * (i / 36));
		p = ob_add(p, ob_splitmix_vector(&seed, .05));
		ob_vec3 turn = ob_splitmix_vector(&seed, .15);
		ob_world_box(w, 125, ob_v3(.25, .25, .25), p).state->pose.q = ob_quat_turn(ob_quat_identity(), turn);
	}
	ob_world_material(w, .5, variant[0]);
}

static void build_falling(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_falling(w, 100, 100 + run);
}

// clang-format off
#define PILE_FIGURE(mean, settled, worst, gain) \
	{ { "settled mean penetration", "mm", mean, "no penetration; in the last second" }, \
	  { "settled worst penetration", "mm", settled, "no penetration; in the last second" }, \
	  { "worst penetration at any moment", "mm", worst, "no penetration" }, \
	  { "growth of energy", "1", gain, "none: largest rise from its lowest so far, over that at the start" } }
// clang-format on
#define DROPPING \
	.duration = 10, .runs = SEEDS, .figures = OB_HEAP_FIGURES, .observe = ob_heap_observe, .judge = ob_heap_judge

const ob_case ob_case_pile = {
	.row = 17,
	.name = "pile",
	.title = "Pile of 216 boxes",
	.setup = "216 boxes of .5 m in a loose grid of 6 x 6 x 6, slightly turned, drop half a metre; friction .5, "
		 "no restitution; 10 s; the worst of five such.",
	.others = "worst impact 30 to 525 mm in every engine",
	.compared = true,
	.figure = PILE_FIGURE(.5, 2, 2, 1e-5),
	.build = build_pile,
	DROPPING,
};

const ob_case ob_case_pile_elastic = {
	.row = 17,
	.name = "pile-elastic",
	.title = "Pile of 216 boxes, e = .5",
	.setup = "As the pile, with restitution .5.",
	.others = "worst impact 30 to 525 mm in every engine",
	.figure = PILE_FIGURE(.5, 2, 2, 1e-5),
	.build = build_pile,
	.variant = { .5 },
	DROPPING,
};

const ob_case ob_case_falling_100 = {
	.row = 17,
	.name = "falling-100",
	.title = "100 falling boxes",
	.setup = "Columns of four boxes with half extents of .1 to .5 m, turned at random, drop on the ground; "
		 "friction .5; 10 s; the worst of five such.",
	.others = "worst of 1000 such: Box3D 213 mm, Jolt 215 mm, ODE 309 mm, Bullet 606 mm",
	.figure = PILE_FIGURE(NAN, NAN, NAN, 1e-5),
	.build = build_falling,
	DROPPING,
};
