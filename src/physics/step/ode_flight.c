#include "step/ode_flight.h"

#include "step/broadphase.h"
#include "step/budget.h"
#include "step/flight.h"

static ob_state state_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_motion *before = ob_newest_motion(s->u, id);
	double h = run->step_length / run->substeps;
	ob_state now = { { before->p, before->q }, before->v, before->w };
	ob_vec3 force = ob_scale(ob_passport_of(s->u, id)->force, h);
	bool done = true;
	enum { WORK_OF_SUBSTEP = 32 };
	for (uint32_t i = 0; i < run->substeps && done && !ob_budget_spent(&s->solver); i++) {
		ob_budget_note(&s->solver, WORK_OF_SUBSTEP);
		done = ob_ode_body_step(
			ob_ode_bodies_get(&s->solver.ode_bodies, run->gravity, id, ob_passport_of(s->u, id)), &now,
			force, ob_v3(0, 0, 0), h);
	}
	if (!done)
		ob_step_fail(s->u, OB_STEP_ENGINE, id);
	return now;
}

static void step_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	const ob_motion *before = ob_newest_motion(s->u, id);
	uint64_t step = ob_step_count(s->u) + 1;
	ob_state end = state_by_ode(s, id);
	ob_motion m = { .t0 = (double)step * run->step_length,
			.valid_until = (double)(step + 1) * run->step_length,
			.p = end.pose.p,
			.q = end.pose.q,
			.v = end.v,
			.w = end.w,
			.a = ob_external_acceleration(run, body),
			.path = before->path + ob_step_reach(run, body, before->q, before->v, before->w),
			.step = (uint32_t)step,
			.flags = OB_MOTION_FREE,
			.island = id };
	ob_body_publish(s, id, &m, &end);
}

void ob_ode_flight_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done)
{
	for (uint32_t k = 0; k < n; k++) {
		ob_budget_begin_share(s, id[k]);
		step_by_ode(s, id[k]);
		done[k] = true;
	}
}
