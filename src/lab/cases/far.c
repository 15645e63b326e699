// Far from the origin, where positions have fewer digits: the same scene twice in one world, at the origin and 10 km
// away.
#include "lab/cases/cases.h"
#include "lab/cases/head_on.h"
#include "lab/look.h"
#include "world/world.h"

static const ob_vec3 away = { 10e3, 0, 0 }; // m

// m: largest distance of body "near" from its double "far", minus their initial distance.
static double apart(const ob_case_run_state *t, uint32_t near, uint32_t far)
{
	return ob_norm(ob_sub(ob_look_moved(t, far), ob_look_moved(t, near)));
}

// Each stack has a slab of its own, before it in the order of ids, so that the iterations of both run in the same order
// and only the place differs.
enum { STACK = 10, FAR_SLAB = STACK + 1 };

static void build_slab_and_stack(ob_world *w, ob_vec3 foot)
{
	ob_world_box(w, 0, ob_v3(5, 5, .5), ob_add(foot, ob_v3(0, 0, -.5)));
	ob_world_stack(w, STACK, foot, 14);
}

static void build_stacks(ob_world *w, uint32_t run, const double *variant)
{
	build_slab_and_stack(w, ob_v3(0, 0, 0));
	build_slab_and_stack(w, away);
}

static double penetration(const ob_case_run_state *t, uint32_t first)
{
	ob_snapshot part = { .time = t->now.time, .count = STACK + 1 };
	part.passport = t->now.passport + first;
	part.motion = t->now.motion + first;
	ob_penetration p;
	ob_measure_penetration(&part, &p);
	return p.max_m;
}

enum { FAR_WORST, APART, DEEPER };

static void observe_stacks(ob_case_run_state *t)
{
	double near = penetration(t, 0), far = penetration(t, FAR_SLAB);
	ob_look_keep(&t->figure[FAR_WORST], 1e3 * far);
	ob_look_keep(&t->figure[DEEPER], fabs(far - near));
	for (uint32_t i = 1; i <= STACK; i++)
		ob_look_keep(&t->figure[APART], apart(t, i, FAR_SLAB + i));
}

static void judge_stacks(ob_case_run_state *t)
{
	if (ob_look_farthest(t) > .25)
		t->failed = "fell";
}

const ob_case ob_case_far_stack = {
	.row = 23,
	.name = "far-stack",
	.title = "Stack of 10 at 10 km",
	.setup = "The stack of 10 at the origin and the same 10 km away; 20 s.",
	.duration = 20,
	.figures = 3,
	.figure = { { "worst penetration at 10 km", "mm", .5, "no penetration" },
		    { "difference of ways", "m", 1e-6, "the stack at the origin" },
		    { "difference of penetrations", "m", 1e-6, "the stack at the origin" } },
	.build = build_stacks,
	.observe = observe_stacks,
	.judge = judge_stacks,
};

static void build_pairs(ob_world *w, uint32_t run, const double *variant)
{
	ob_head_on_build(w, run, variant);
	ob_head_on_build(w, run, &away.x);
}

static void judge_pairs(ob_case_run_state *t)
{
	t->figure[0] = ob_head_on_error(t, 2);
	t->figure[1] = fmax(apart(t, 0, 2), apart(t, 1, 3));
	if (ob_head_on_missed(t, 0) || ob_head_on_missed(t, 2))
		t->failed = "passed through";
}

const ob_case ob_case_far_head_on = {
	.row = 23,
	.name = "far-head-on",
	.title = "Head-on pair at 10 km",
	.setup = "The head-on pairs at the origin and the same 10 km away.",
	.duration = 2,
	.runs = OB_HEAD_ON_RUNS,
	.figures = 2,
	.figure = { { "error of velocities at 10 km", "1", 1e-6, "impact of two bodies (Newton 1687)" },
		    { "difference of ways", "m", 1e-6, "the pair at the origin" } },
	.build = build_pairs,
	.judge = judge_pairs,
};
