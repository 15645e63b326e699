// Free rotation of a body with three different moments.
#include "lab/cases/cases.h"
#include "lab/look.h"
#include "reference/spin.h"
#include "world/world.h"

// A flat box, as a body with moments 1 : 2 : 3 has no thickness; sets the moments exactly. It spins about its middle
// axis, the unstable one.
static void build_spin(ob_world *w, uint32_t run)
{
	w->gravity = ob_v3(0, 0, 0);
	ob_world_body b = ob_world_box(w, 6, ob_v3(1, sqrt(.5), .01), ob_v3(0, 0, 0));
	b.passport->inertia = ob_v3(1, 2, 3);
	b.state->w = ob_v3(.05, 5, .02);
}

enum { MEMORY_ENERGY, MEMORY_MOMENTUM }; // at the start; the momentum takes three places

static void observe_spin(ob_case_run_state *t)
{
	static _Thread_local ob_reference_spin exact; // too large for the trial's memory; planned anew in each run
	double energy = ob_look_energy(t), *memory = t->memory;
	ob_vec3 momentum = ob_measure_angular_momentum(&t->now);
	const ob_state *start = t->world->state;
	if (!t->frame) {
		ob_reference_spin_plan(&exact, start->pose.q, start->w, t->world->passport->inertia);
		memory[MEMORY_ENERGY] = energy;
		memory[MEMORY_MOMENTUM] = momentum.x;
		memory[MEMORY_MOMENTUM + 1] = momentum.y;
		memory[MEMORY_MOMENTUM + 2] = momentum.z;
	}
	ob_vec3 before = ob_v3(memory[MEMORY_MOMENTUM], memory[MEMORY_MOMENTUM + 1], memory[MEMORY_MOMENTUM + 2]);
	ob_quat q;
	ob_vec3 w;
	ob_reference_spin_at(&exact, t->time, &q, &w);
	ob_look_keep(&t->figure[0], fabs(energy / memory[MEMORY_ENERGY] - 1));
	ob_look_keep(&t->figure[1], ob_norm(ob_sub(momentum, before)) / ob_norm(before));
	ob_look_keep(&t->figure[2], ob_reference_turn_between(q, ob_look_at(t, 0).pose.q));
}

static void judge_spin(ob_case_run_state *t)
{
	ob_quat now = ob_look_at(t, 0).pose.q;
	if (ob_reference_turn_between(t->world->state->pose.q, now) == 0)
		t->failed = "nothing moved";
}

const ob_case ob_case_spin = {
	.row = 20,
	.name = "spin",
	.title = "Torque-free spin",
	.setup = "A body with moments of inertia 1 : 2 : 3 spins at (.05, 5, .02) rad/s, turning over again and "
		 "again; 300 s.",
	.others = "ODE loses 21 % of its energy; MuJoCo with Runge-Kutta 4 2e-7 in 60 s",
	.compared = true,
	.duration = 300,
	.figures = 3,
	.figure = { { "error of energy", "1", 1e-9, "energy at the start" },
		    { "error of angular momentum", "1", 1e-12, "momentum at the start, as a vector" },
		    { "error of attitude", "rad", 1e-8, "Jacobi's elliptic functions (Landau and Lifshitz 1976)" } },
	.build = build_spin,
	.observe = observe_spin,
	.judge = judge_spin,
};
