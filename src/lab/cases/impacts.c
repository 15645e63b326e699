// Impacts in free space: the head-on pair and Newton's cradle.
#include "lab/cases/cases.h"
#include "lab/cases/head_on.h"
#include "lab/look.h"
#include "reference/mechanics.h"
#include "world/world.h"

ob_head_on ob_head_on_of(uint32_t run)
{
	static const double restitution[] = { 0, .5, 1 };
	return (ob_head_on){
		.ratio = run / 3 % 2 ? 1000 : 1,
		.e = restitution[run % 3],
		.boxes = run / 6,
	};
}

void ob_head_on_build(ob_world *w, uint32_t run, const double *at)
{
	ob_head_on h = ob_head_on_of(run);
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 2; i++) {
		double mass = i ? h.ratio : 1;
		ob_vec3 p = ob_v3(*at + 1.537 * i, 0, 0); // they touch within a frame, not at its end
		ob_world_body b =
			h.boxes ? ob_world_box(w, mass, ob_v3(.5, .5, .5), p) : ob_world_sphere(w, mass, .5, p);
		b.passport->friction = .3;
		b.passport->restitution = h.e;
		b.state->v.x = !i;
	}
}

double ob_head_on_error(const ob_case_run_state *t, uint32_t first)
{
	ob_head_on h = ob_head_on_of(t->run);
	ob_reference_pair exact = ob_reference_impact(1, h.ratio, (ob_reference_pair){ 1, 0 }, h.e);
	double a = ob_norm(ob_sub(ob_look_at(t, first).v, ob_v3(exact.a, 0, 0)));
	double b = ob_norm(ob_sub(ob_look_at(t, first + 1).v, ob_v3(exact.b, 0, 0)));
	return fmax(a, b);
}

bool ob_head_on_missed(const ob_case_run_state *t, uint32_t first)
{
	ob_state a = ob_look_at(t, first), b = ob_look_at(t, first + 1);
	return a.v.x > .999 || a.pose.p.x > b.pose.p.x;
}

static void observe_head_on(ob_case_run_state *t)
{
	double momentum = ob_norm(ob_sub(ob_measure_momentum(&t->now), ob_v3(1, 0, 0)));
	ob_look_keep(&t->figure[2], momentum);
	ob_look_keep(&t->figure[3], (ob_look_energy(t) - .5) / .5);
}

static void judge_head_on(ob_case_run_state *t)
{
	t->figure[ob_head_on_of(t->run).e > 0 ? 0 : 1] = ob_head_on_error(t, 0);
	if (ob_head_on_missed(t, 0))
		t->failed = "passed through";
}

#define IMPACT "impact of two bodies (Newton 1687)"

const ob_case ob_case_head_on = {
	.row = 2,
	.name = "head-on",
	.title = "Head-on pair",
	.setup = "A sphere meets a sphere, and a box a box, head-on at 1 m/s in free space: masses 1:1 and 1:1000, "
		 "restitution 0, .5 and 1.",
	.others = "relative errors of 4e-7 at best",
	.duration = 2,
	.runs = OB_HEAD_ON_RUNS,
	.figures = 4,
	.figure = { { "error of velocities, e > 0", "1", 1e-12, IMPACT },
		    { "error of velocities, e = 0", "1", 1e-8, IMPACT },
		    { "error of momentum", "1", 1e-15, "momentum at the start" },
		    { "gain of energy", "1", 1e-15, "energy at the start; the target is rounding" } },
	.build = ob_head_on_build,
	.observe = observe_head_on,
	.judge = judge_head_on,
};

enum { CRADLE = 5 };

// Incoming balls touch each other, as do those at rest; .7 m between. variant: number of those that come in
static void build_cradle(ob_world *w, uint32_t run, const double *variant)
{
	w->gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < CRADLE; i++) {
		ob_world_body b = ob_world_sphere(w, 1, .5, ob_v3(i + (i < variant[0] ? 0 : .7), 0, 0));
		b.state->v.x = i < variant[0];
	}
	ob_world_material(w, 0, 1);
}

static void observe_cradle(ob_case_run_state *t)
{
	if (!t->frame)
		t->memory[0] = ob_look_energy(t);
	ob_look_keep(&t->figure[1], ob_look_energy(t) / t->memory[0] - 1);
}

static void judge_cradle(ob_case_run_state *t)
{
	double exact[CRADLE];
	ob_reference_cradle(CRADLE, (int)t->of->variant[0], 1, exact);
	for (uint32_t i = 0; i < CRADLE; i++)
		ob_look_keep(&t->figure[0], ob_norm(ob_sub(ob_look_at(t, i).v, ob_v3(exact[i], 0, 0))));
}

// clang-format off
#define CRADLE_FIGURES \
	{ { "error of velocities", "1", 1e-9, "as many leave as came in (Herrmann and Seitz 1982)" }, \
	  { "gain of energy", "1", 1e-9, "energy at the start" } }
// clang-format on

const ob_case ob_case_cradle_1 = {
	.row = 3,
	.name = "cradle-1",
	.title = "Newton's cradle, one comes in",
	.setup = "Five equal elastic spheres in a row: four touch and rest, one comes in at 1 m/s.",
	.others = "all fail: the last leaves at .40 to .55 of the speed; some gain energy",
	.duration = 3,
	.figures = 2,
	.figure = CRADLE_FIGURES,
	.build = build_cradle,
	.variant = { 1 },
	.observe = observe_cradle,
	.judge = judge_cradle,
};

const ob_case ob_case_cradle_2 = {
	.row = 3,
	.name = "cradle-2",
	.title = "Newton's cradle, two come in",
	.setup = "Five equal elastic spheres in a row: three touch and rest, two that touch come in at 1 m/s.",
	.others = "all fail: .40 to .55 of the speed; some gain energy",
	.duration = 3,
	.figures = 2,
	.figure = CRADLE_FIGURES,
	.build = build_cradle,
	.variant = { 2 },
	.observe = observe_cradle,
	.judge = judge_cradle,
};
