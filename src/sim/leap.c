#include "sim/leap.h"

#include <string.h>

#include "sim/members.h"
#include "sim/perceive.h"
#include "sim/pull.h"

// Goes on from where the newest motion's flight began, unless something else pulls at the object now.
static bool goes_on(const ob_motion *before, const ob_flight *f, ob_vec3 a)
{
	return before->flight && before->flight == f->since && a.x == f->a.x && a.y == f->a.y && a.z == f->a.z;
}

// ob_motion_at, to the last bit, but for the plan of the spin, which is kept.
static ob_state flown(ob_sim *s, uint32_t id, const ob_flight *f, double time)
{
	ob_motion m = { .p = f->p, .q = f->q, .v = f->v, .a = f->a };
	ob_vec3 inertia = ob_passport_of(s->u, id)->inertia;
	ob_state end = ob_motion_at(&m, inertia, time);
	if (ob_norm2(f->w) > 0)
		ob_spin_at(ob_plans_spin(&s->plans, id, f->q, f->w, inertia), time, &end.pose.q, &end.w);
	return end;
}

ob_state ob_leap_end(ob_sim *s, uint32_t id, uint32_t *flight)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const ob_passport *pass = ob_passport_of(s->u, id);
	const ob_motion *before = ob_newest_motion(s->u, id);
	ob_flight *f = &ob_universe_exchange(s->u)->flight[id];
	uint64_t step = ob_step_count(s->u);
	ob_vec3 a = ob_pull(run, pass);
	if (!goes_on(before, f, a))
		*f = (ob_flight){ step * run->step_length, before->p, before->q, before->v, before->w, a,
				  (uint32_t)step + 1,      0 };
	*flight = f->since;
	return flown(s, id, f, (step + 1) * run->step_length - f->t0);
}

static ob_state end_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const ob_motion *before = ob_newest_motion(s->u, id);
	double h = run->step_length / run->substeps;
	ob_state now = { { before->p, before->q }, before->v, before->w };
	ob_vec3 force = ob_scale(ob_passport_of(s->u, id)->force, h);
	for (uint32_t i = 0; i < run->substeps; i++)
		ob_ode_body_step(ob_sim_ode(s, id), &now, force, ob_v3(0, 0, 0), h);
	return now;
}

void ob_leap(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const ob_passport *pass = ob_passport_of(s->u, id);
	const ob_motion *before = ob_newest_motion(s->u, id);
	uint64_t step = ob_step_count(s->u) + 1;
	uint32_t flight = 0;
	ob_state now = run->integrator == OB_INTEGRATOR_ODE ? end_by_ode(s, id) : ob_leap_end(s, id, &flight);
	ob_motion m = { .t0 = step * run->step_length,
			.valid_until = (step + 1) * run->step_length,
			.p = now.pose.p,
			.q = now.pose.q,
			.v = now.v,
			.w = now.w,
			.a = ob_pull(run, pass),
			.path = before->path + ob_step_reach(run, pass, before->v, before->w),
			.step = (uint32_t)step,
			.flags = OB_MOTION_FREE,
			.island = id,
			.flight = flight };
	if (!isfinite(m.p.x + m.p.y + m.p.z + m.q.w + m.w.x))
		ob_universe_exchange(s->u)->count->failure = OB_EXCHANGE_DIVERGED;
	ob_member_publish(s, id, &m);
}
