// Stacks of equal cubes, and stacks with a heavy one on top.
#include "lab/cases/cases.h"
#include "lab/cases/stand.h"
#include "world/world.h"

enum { SEEDS = 5 }; // a run for each

static void build_stack(ob_world *w, int n, uint32_t run)
{
	ob_world_ground(w);
	ob_world_stack(w, n, ob_v3(0, 0, 0), 14 + run);
}

static void build_stack_10(ob_world *w, uint32_t run)
{
	build_stack(w, 10, run);
}

static void build_stack_20(ob_world *w, uint32_t run)
{
	build_stack(w, 20, run);
}

static void build_stack_40(ob_world *w, uint32_t run)
{
	build_stack(w, 40, run);
}

// Stacks n cubes of 1000 kg under one that is "ratio" times as heavy.
static void build_heavy(ob_world *w, int n, double ratio, uint32_t run)
{
	build_stack(w, n + 1, run);
	ob_passport *top = &w->passport[w->objects - 1];
	top->mass *= ratio;
	top->inertia = ob_scale(top->inertia, ratio);
}

static void build_heavy_100(ob_world *w, uint32_t run)
{
	build_heavy(w, 1, 100, run);
}

static void build_heavy_1000(ob_world *w, uint32_t run)
{
	build_heavy(w, 1, 1000, run);
}

static void build_heavy_on_stack(ob_world *w, uint32_t run)
{
	build_heavy(w, 10, 100, run);
}

const ob_case ob_case_stack_10 = {
	.row = 14,
	.name = "stack-10",
	.title = "Stack of 10",
	.setup = "Ten cubes of 1 m and 1000 kg, each up to 10 mm off the axis, friction .5, stand for 20 s, awake; the "
		 "worst of five such.",
	.others = "sag at 240 Hz: Bullet .68 mm, Jolt .84 mm, ODE 1.16 mm, Box3D 25.5 mm",
	.quick = true,
	.compared = true,
	.figure = OB_STAND_FIGURE(.5, NAN),
	.build = build_stack_10,
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_stack_20 = {
	.row = 14,
	.name = "stack-20",
	.title = "Stack of 20",
	.setup = "As the stack of 10, with twenty cubes.",
	.others = "at 60 Hz it falls in Jolt, Bullet and ODE; Box3D sags 106 mm",
	.quick = true,
	.figure = OB_STAND_FIGURE(.5, 1),
	.build = build_stack_20,
	.runs = SEEDS,
	OB_STAND_CASE,
};

const ob_case ob_case_stack_40 = {
	.row = 14,
	.name = "stack-40",
	.title = "Stack of 40",
	.setup = "As the stack of 10, with forty cubes.",
	.others = "at 60 Hz already a stack of 20 falls in Jolt, Bullet and ODE",
	.quick = true,
	.figure = OB_STAND_FIGURE(.5, 10),
	.build = build_stack_40,
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
	.quick = true,
	.figure = OB_STAND_FIGURE(.6, NAN),
	.build = build_heavy_100,
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
	.quick = true,
	.compared = true,
	.figure = OB_STAND_FIGURE(2, NAN),
	.build = build_heavy_1000,
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
	.quick = true,
	.figure = OB_STAND_FIGURE(NAN, NAN),
	.build = build_heavy_on_stack,
	.runs = SEEDS,
	OB_STAND_CASE,
};
