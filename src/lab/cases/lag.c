// Cost of reading a partner late: the head-on pair, with the lag of the run's settings.
#include "lab/cases/cases.h"
#include "lab/cases/head_on.h"
#include "lab/look.h"
#include "world/world.h"

static void observe_lag(ob_case_run_state *t)
{
	double momentum = ob_norm(ob_sub(ob_measure_momentum(&t->now), ob_v3(1, 0, 0)));
	ob_look_keep(&t->figure[0], momentum);
	ob_look_keep(&t->figure[2], (ob_look_energy(t) - .5) / .5);
}

static void judge_lag(ob_case_run_state *t)
{
	t->figure[1] = ob_head_on_error(t, 0);
	if (ob_head_on_missed(t, 0))
		t->failed = "passed through";
}

const ob_case ob_case_lag = {
	.row = 24,
	.name = "lag",
	.title = "Partners that read late",
	.setup = "The head-on pairs, each body a simulator that computes the impulse for itself, on a state of its "
		 "partner that is so many iterations late. The target holds without lag.",
	.others = "no other engine couples simulators",
	.duration = 2,
	.runs = OB_HEAD_ON_RUNS,
	.figures = 3,
	.figure = { { "error of momentum", "1", 1e-15, "momentum at the start" },
		    { "error of velocities", "1", NAN, "impact of two bodies (Newton 1687)" },
		    { "gain of energy", "1", NAN, "energy at the start" } },
	.build = ob_head_on_build,
	.observe = observe_lag,
	.judge = judge_lag,
};
