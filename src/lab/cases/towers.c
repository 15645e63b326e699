// Structures with many cycles that stand for a minute, awake.
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "world/world.h"

enum { LAYERS = 100, PYRAMID = 15 };

// Two planks a layer, across those below.
static void build_crib(ob_world *w, uint32_t run, const double *variant)
{
	static const ob_vec3 along_x = { .6, .12, .04 }, along_y = { .12, .6, .04 }; // m, half
	ob_world_ground(w);
	for (int layer = 0; layer < LAYERS; layer++) {
		for (int side = -1; side <= 1; side += 2) {
			double z = along_x.z * (2 * layer + 1), off = side * .45;
			if (layer % 2)
				ob_world_box(w, 14, along_y, ob_v3(off, 0, z));
			else
				ob_world_box(w, 14, along_x, ob_v3(0, off, z));
		}
	}
}

static void build_pyramid(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	for (int row = 0; row < PYRAMID; row++)
		for (int i = 0; i < PYRAMID - row; i++)
			ob_world_box(w, 1000, ob_v3(.5, .5, .5), ob_v3(0, i - .5 * (PYRAMID - row - 1), .5 + row));
}

// Observes six times a second: no motion in it is fast.
static void observe_tower(ob_case_run_state *t)
{
	if (t->frame % 10 == 0)
		ob_stand_observe(t);
}

#define TOWER_CASE \
	.row = 35, .duration = 60, .figures = OB_STAND_FIGURES, .figure = OB_STAND_FIGURE(.5, .1), \
	.observe = observe_tower, .judge = ob_stand_judge

const ob_case ob_case_crib_tower = {
	.name = "crib-tower",
	.title = "Crib tower of 200 planks",
	.setup = "200 planks of 1.2 x .24 x .08 m, two a layer and crosswise, friction .5, stand for 60 s, awake.",
	.build = build_crib,
	TOWER_CASE,
};

const ob_case ob_case_touching_pyramid = {
	.name = "touching-pyramid",
	.title = "Pyramid of 120 that touch",
	.setup = "120 cubes of 1 m and 1000 kg in fifteen rows, neighbours touching, friction .5, stand for 60 s, "
		 "awake.",
	.build = build_pyramid,
	TOWER_CASE,
};
