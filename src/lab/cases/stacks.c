// Stacks of equal cubes, and stacks with a heavy one on top.
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "world/world.h"

enum { SEEDS = 5 }; // a run for each

// Number of cubes of 1000 kg; mass of the uppermost over theirs.
enum { CUBES, TOP };

static void build_stack(ob_world *w, uint32_t run, const double *variant)
{
	ob_world_ground(w);
	ob_world_stack(w, (int)variant[CUBES], ob_v3(0, 0, 0), 14 + run);
	ob_passport *top = &w->passport[w->objects - 1];
	top->mass *= variant[TOP];
	top->inertia = ob_scale(top->inertia, variant[TOP]);
}

const ob_case ob_case_stack_10 = {
	.row = 14,
	.name = "stack-10",
	.title = "Stack of 10",
	.setup = "Ten cubes of 1 m and 1000 kg, each up to 10 mm off the axis, friction .5, stand for 20 s, awake; the "
		 "worst of five such.",
	.others = "sag at 240 Hz: Bullet .68 mm, Jolt .84 mm, ODE 1.16 mm, Box3D 25.5 mm",
	.compared = true,
	.figure = OB_STAND_FIGURE(.5, NAN),
	.build = build_stack,
	.variant = { 10, 1 },
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_stack_20 = {
	.row = 14,
	.name = "stack-20",
	.title = "Stack of 20",
	.setup = "As the stack of 10, with twenty cubes.",
	.others = "at 60 Hz it falls in Jolt, Bullet and ODE; Box3D sags 106 mm",
	.figure = OB_STAND_FIGURE(.5, 1),
	.build = build_stack,
	.variant = { 20, 1 },
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_stack_40 = {
	.row = 14,
	.name = "stack-40",
	.title = "Stack of 40",
	.setup = "As the stack of 10, with forty cubes.",
	.others = "at 60 Hz already a stack of 20 falls in Jolt, Bullet and ODE",
	.figure = OB_STAND_FIGURE(.5, 10),
	.build = build_stack,
	.variant = { 40, 1 },
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_heavy_100 = {
	.row = 15,
	.name = "heavy-100",
	.title = "100 : 1 on one cube",
	.setup = "A cube of 100 t on a cube of 1 t, both of 1 m, up to 10 mm off the axis, friction .5; 20 s; the "
		 "worst of five such.",
	.others = "not measured at 100 : 1",
	.figure = OB_STAND_FIGURE(.6, NAN),
	.build = build_stack,
	.variant = { 2, 100 },
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_heavy_1000 = {
	.row = 15,
	.name = "heavy-1000",
	.title = "1000 : 1 on one cube",
	.setup = "A cube of 1000 t on a cube of 1 t, both of 1 m, up to 10 mm off the axis, friction .5; 20 s; the "
		 "worst of five such.",
	.others = "falls in Jolt, Bullet and ODE's QuickStep; Box3D fails",
	.compared = true,
	.figure = OB_STAND_FIGURE(2, NAN),
	.build = build_stack,
	.variant = { 2, 1000 },
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_heavy_on_stack = {
	.row = 15,
	.name = "heavy-on-stack",
	.title = "100 : 1 on a stack of 10",
	.setup = "A cube of 100 t on a stack of ten cubes of 1 t, all of 1 m, up to 10 mm off the axis, friction .5; "
		 "20 s; the worst of five such.",
	.others = "1000 : 1 on one cube falls in Jolt, Bullet and ODE's QuickStep",
	.figure = OB_STAND_FIGURE(NAN, NAN),
	.build = build_stack,
	.variant = { 11, 100 },
	.runs = SEEDS,
	OB_STAND_CASE,
};
