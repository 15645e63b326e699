// Where the command line is silent, the scene decides.
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/request.h"
#include "cli/suggest.h"

uint64_t ob_request_steps(double duration, double step)
{
	// 10 s at 1/60 s are 600 steps, though the quotient of the doubles may be a little off
	double n = ceil(duration / step * (1 - 1e-12) - 1e-9);
	return n < 1 ? 1 : n < 1e18 ? (uint64_t)n : (uint64_t)1e18;
}

static bool check_camera(const char *name, const ob_scene *s, ob_error *e)
{
	ob_suggestion near = { .word = name };
	char all[512] = "";
	for (uint32_t i = 0; i < s->cameras; i++) {
		if (strcmp(s->camera[i].name, name) == 0)
			return true;
		ob_suggest_offer(&near, s->camera[i].name);
		size_t n = strlen(all);
		snprintf(all + n, sizeof all - n, "%s%s", i ? ", " : "", s->camera[i].name);
	}
	if (near.best)
		return ob_fail(e, "--camera %s: the scene has none of this name: did you mean %s?", name, near.best);
	return ob_fail(e, "--camera %s: the scene has none of this name, only: %s", name, all);
}

static ob_solver_kind exchange_of(const char *name)
{
	static const char *const names[] = {
		[OB_SOLVER_COLOURED] = "coloured",
		[OB_SOLVER_JACOBI] = "jacobi",
		[OB_SOLVER_GHOST] = "ghost",
		[OB_SOLVER_LAGGED] = "lagged",
	};
	ob_solver_kind kind = OB_SOLVER_COLOURED;
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (strcmp(names[i], name) == 0)
			kind = (ob_solver_kind)i;
	return kind;
}

// Exchanges that are wrong by design keep no tolerance: more substeps would not mend them.
static bool may_keep_one(const ob_run_request *r, const ob_run_settings *run)
{
	return !r->monolith && run->exchange != OB_SOLVER_GHOST && run->exchange != OB_SOLVER_LAGGED;
}

// Numbers on the command line stand above the scene's tolerance, and a tolerance there above the scene's numbers.
static void settle_exactness(ob_run_request *r, const ob_scene *s, ob_run_settings *run)
{
	bool own = r->tolerance > 0 && !r->monolith;
	if (!own)
		r->tolerance = r->substeps || !may_keep_one(r, run) ? 0 : s->tolerance;
	if (!r->passes)
		r->passes = own ? OB_SCENE_TOLERANT_PASSES : s->passes;
	run->tolerance = r->tolerance;
	run->passes = r->passes;
	if (r->tolerance > 0) {
		run->substeps = own ? 1 : s->substeps;
		// with n substeps ODE's stepper falls short by g H^2 / (2 n) in a step of length H
		double short_by = .5 * ob_norm(s->gravity) * r->step * r->step;
		while (run->integrator == OB_INTEGRATOR_ODE && short_by / run->substeps > r->tolerance)
			run->substeps *= 2;
		return;
	}
	// the monolith steps as a usual environment does: once per step, unless asked otherwise
	r->substeps = r->substeps ? r->substeps : r->monolith ? 1 : s->substeps;
	run->substeps = r->substeps;
}

static bool settle_lag(ob_run_request *r, const ob_scene *s, ob_run_settings *run, ob_error *e)
{
	if (run->exchange != OB_SOLVER_LAGGED)
		return r->lag == UINT32_MAX ||
		       ob_fail(e, "--lag is for --exchange lagged; this run's is %s", r->exchange);
	run->lag = r->lag == UINT32_MAX ? s->lag : r->lag;
	return true;
}

bool ob_request_settle(ob_run_request *r, const ob_scene *s, ob_run_settings *run, ob_error *e)
{
	r->duration = r->duration > 0 ? r->duration : s->duration;
	r->step = r->step > 0 ? r->step : s->step;
	r->exchange = r->exchange ? r->exchange : s->exchange;
	r->integrator = r->integrator ? r->integrator : s->integrator;
	r->sleeping = r->sleeping ? r->sleeping : s->sleeping ? "on" : "off";
	*run = (ob_run_settings){
		.gravity = s->gravity,
		.step_length = r->step,
		.exchange = exchange_of(r->exchange),
		.integrator = strcmp(r->integrator, "ode") == 0 ? OB_INTEGRATOR_ODE : OB_INTEGRATOR_EXACT,
		.sleeping = strcmp(r->sleeping, "on") == 0,
		.monolith = r->monolith,
		.iterations = r->iterations,
		.narrow_phase = r->narrow,
		.load = r->load,
		.timed = r->explain || r->measure == OB_MEASURE_PARTS,
	};
	settle_exactness(r, s, run);
	if (!settle_lag(r, s, run, e))
		return false;
	uint64_t steps = ob_request_steps(r->duration, r->step);
	// a motion carries its step as 32 bits
	if (steps > UINT32_MAX - 2)
		return ob_fail(e, "%g s in steps of %g s are too many steps (at most %" PRIu32 "): shorten --duration",
			       r->duration, r->step, UINT32_MAX - 2);
	return !r->frames.camera || check_camera(r->frames.camera, s, e);
}
