#include "sim/flight.h"

#include "contact/impact.h"
#include "motion/flight.h"
#include "sim/broadphase.h"
#include "sim/publish.h"

// ---- impacts on planes

static const double contact_approach = 1e-4; // m/s: a slower approach is left to the contact solver
static const double on_plane_gap = 1e-9; // m, and more where coordinates are rounded: a point so near is on the plane

static ob_half_space half_space(const ob_universe *u, uint32_t plane)
{
	const ob_motion *m = ob_newest_motion(u, plane); // it never moves
	ob_mat3 r = ob_quat_matrix(m->q);
	ob_vec3 n = ob_column(&r, 2);
	return (ob_half_space){ n, ob_dot(n, m->p) };
}

// The flight as motion/flight.h takes it. Objects that touch as axis-aligned boxes reach beyond their bounding sphere.
static ob_flier landing_body(ob_sim *s, uint32_t id, const ob_motion *f)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	ob_flier out = { body->shape, body->size, body->inertia, f->p, f->v, f->a, f->q, f->w, NULL };
	if (s->settings->narrow_phase == OB_NARROW_AABB) {
		double reach = sqrt(3) * ob_shape_radius(body->shape, body->size);
		out.shape = OB_SHAPE_CYLINDER; // of which only the impact of the bounding sphere is computed
		out.size = ob_v3(reach, 0, 0);
	}
	if (out.shape != OB_SHAPE_SPHERE && ob_norm2(f->w) > 0)
		out.spin = ob_rotation_cache_get(&s->rotations, id, f->q, f->w, body->inertia);
	return out;
}

// When the flight first meets a plane (s), from an instant on; infinity: not until "until". plane: its id.
static double plane_impact_time(ob_sim *s, uint32_t id, const ob_motion *flight, double from, double until,
				uint32_t *plane)
{
	const ob_step_data *data = s->data;
	ob_flier f = landing_body(s, id, flight);
	double first = INFINITY;
	for (uint32_t i = 0; i < data->count->planes; i++) {
		ob_half_space ground = half_space(s->u, data->plane[i]);
		double t = ob_landing_time(&f, &ground, from - flight->t0, fmin(until, first) - flight->t0);
		if (flight->t0 + t < first)
			first = flight->t0 + t, *plane = data->plane[i];
	}
	return fmax(first, from);
}

// The arm (m, world) of the lowest point that is on the plane and approaches it; false: none.
static bool impact_point(const ob_passport *body, const ob_half_space *ground, const ob_state *s, ob_vec3 *arm)
{
	const ob_vec3 n = ground->normal;
	const double height = ob_dot(n, s->pose.p) - ground->offset, speed = ob_dot(n, s->v);
	double lowest = on_plane_gap + 1e-14 * (ob_norm(s->pose.p) + fabs(ground->offset));
	if (body->shape == OB_SHAPE_SPHERE) {
		*arm = ob_scale(n, -body->size.x);
		return height - body->size.x < lowest && speed < -contact_approach;
	}
	bool found = false;
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	for (int k = 0; k < 8; k++) {
		ob_vec3 h = { k & 1 ? body->size.x : -body->size.x, k & 2 ? body->size.y : -body->size.y,
			      k & 4 ? body->size.z : -body->size.z };
		ob_vec3 at = ob_rotate(&r, h);
		double gap = height + ob_dot(n, at);
		if (gap < lowest && speed + ob_dot(n, ob_cross(s->w, at)) < -contact_approach)
			lowest = gap, *arm = at, found = true;
	}
	return found;
}

// Changes velocities by the impact of the point that is on the plane. false: it does not rebound here.
static bool apply_plane_impact(const ob_sim *s, uint32_t id, uint32_t plane, ob_state *state)
{
	const ob_passport *body = ob_passport_of(s->u, id), *other = ob_passport_of(s->u, plane);
	const ob_half_space ground = half_space(s->u, plane);
	ob_point_impact r = { 1 / body->mass, body->inertia, sqrt(body->friction * other->friction),
			      fmax(body->restitution, other->restitution) };
	ob_vec3 arm;
	if (!(r.restitution > 0) || (body->shape != OB_SHAPE_SPHERE && body->shape != OB_SHAPE_BOX) ||
	    s->settings->narrow_phase != OB_NARROW_OBB || !impact_point(body, &ground, state, &arm))
		return false;
	ob_point_impact_solve(&r, arm, ground.normal, state);
	return ob_dot(ground.normal, ob_add(state->v, ob_cross(state->w, arm))) > 0;
}

// ---- flight

enum { IMPACTS_PER_STEP = 5 }; // at most; a body that hits planes more often is left to the contact solver

static const double flight_horizon = 2; // s: impacts are computed so far ahead

static bool same_vector(ob_vec3 a, ob_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	uint64_t step = ob_step_count(s->u);
	ob_motion m = *ob_newest_motion(s->u, id);
	ob_vec3 a = ob_external_acceleration(run, ob_passport_of(s->u, id));
	double now = (double)step * run->step_length;
	if (!same_vector(m.a, a)) {
		ob_state begin = ob_state_now(s->u, id, &m, step);
		m.p = begin.pose.p, m.q = begin.pose.q, m.v = begin.v, m.w = begin.w, m.a = a;
		m.t0 = m.valid_until = now;
	} else if (!(m.flags & OB_MOTION_FREE)) {
		m.valid_until = m.t0;
	}
	m.flags = 0;
	return m;
}

ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *f, double time)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	if (ob_published_stands(f, body, time))
		return (ob_state){ { f->p, f->q }, f->v, f->w };
	ob_motion m = { .t0 = f->t0, .p = f->p, .q = f->q, .v = f->v, .a = f->a };
	ob_state now = ob_motion_at(&m, body->inertia, time);
	if (ob_norm2(f->w) > 0)
		ob_spin_at(ob_rotation_cache_get(&s->rotations, id, f->q, f->w, body->inertia), time - f->t0,
			   &now.pose.q, &now.w);
	return now;
}

// Bound of the speed of any point of the object between two instants of the flight (m/s).
static double flight_speed_bound(const ob_passport *body, const ob_motion *f, double from, double until)
{
	double begin = ob_norm(ob_madd(f->v, from - f->t0, f->a)), end = ob_norm(ob_madd(f->v, until - f->t0, f->a));
	bool turns = body->shape != OB_SHAPE_SPHERE && ob_norm2(f->w) > 0;
	return fmax(begin, end) +
	       (turns ? ob_spin_bound(f->q, f->w, body->inertia) * ob_shape_radius(body->shape, body->size) : 0);
}

// Publishes the flight m that holds after the running step; m->path is that at the step's end.
static void publish_flight(ob_sim *s, uint32_t id, ob_motion *m)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	const uint64_t step = ob_step_count(s->u) + 1;
	const double h = run->step_length, end = (double)step * h;
	ob_state now = ob_ballistic_state(s, id, m, end);
	uint64_t due = m->flags & OB_MOTION_FREE ? (uint64_t)(m->valid_until / h) : step;
	due -= (double)due * h > m->valid_until && due > step; // the quotient may have been rounded up
	double last = (double)(due + 1) * h, reach = flight_speed_bound(body, m, end, last) * h;
	ob_motion rest = { .t0 = end, .p = now.pose.p, .q = now.pose.q, .v = now.v, .w = now.w, .a = m->a };
	double box[6];
	ob_motion_swept_bounds(&rest, body->shape, body->size, m->valid_until - end, box);
	m->step = (uint32_t)step;
	m->reach = (float)reach;
	m->island = id;
	m->substeps = 0;
	m->rest_time = 0;
	if (!isfinite(now.pose.p.x + now.pose.p.y + now.pose.p.z + now.pose.q.w + now.w.x))
		s->data->count->failure = OB_STEP_DIVERGED;
	ob_fat_aabb_sweep(s->u, id, box, reach);
	ob_result_stage(s, id, m, OB_SCHEDULE_AWAKE, (uint32_t)due);
}

void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	uint32_t state = m->flags & OB_MOTION_ASLEEP        ? OB_SCHEDULE_ASLEEP
			 : m->flags & OB_MOTION_EQUILIBRIUM ? OB_SCHEDULE_EQUILIBRIUM
							    : OB_SCHEDULE_AWAKE;
	double reach = state == OB_SCHEDULE_AWAKE ? ob_step_reach(run, body, end->v, end->w) : 0;
	ob_fat_aabb_update(s->u, id, end, reach);
	m->reach = (float)reach;
	ob_result_stage(s, id, m, state, state == OB_SCHEDULE_AWAKE ? m->step : UINT32_MAX);
}

static ob_state state_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_motion *before = ob_newest_motion(s->u, id);
	double h = run->step_length / run->substeps;
	ob_state now = { { before->p, before->q }, before->v, before->w };
	ob_vec3 force = ob_scale(ob_passport_of(s->u, id)->force, h);
	for (uint32_t i = 0; i < run->substeps; i++)
		ob_ode_body_step(ob_ode_bodies_get(&s->ode_bodies, s->u, id), &now, force, ob_v3(0, 0, 0), h);
	return now;
}

// ODE's stepper computes no impact ahead: one step.
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
			.path = before->path + ob_step_reach(run, body, before->v, before->w),
			.step = (uint32_t)step,
			.flags = OB_MOTION_FREE,
			.island = id };
	if (!isfinite(m.p.x + m.p.y + m.p.z + m.q.w + m.w.x))
		s->data->count->failure = OB_STEP_DIVERGED;
	ob_body_publish(s, id, &m, &end);
}

bool ob_ballistic_advance(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	if (run->integrator == OB_INTEGRATOR_ODE) {
		step_by_ode(s, id);
		return true;
	}
	const uint64_t step = ob_step_count(s->u);
	const double h = run->step_length, end = (double)(step + 1) * h, horizon = end + flight_horizon;
	ob_motion m = ob_ballistic_flight(s, id);
	double since = (double)step * h, from = fmax(m.valid_until, since);
	uint32_t plane = 0, impacts = 0;
	m.path = ob_path_now(&m, step);
	for (;;) {
		m.valid_until = fmin(horizon, plane_impact_time(s, id, &m, from, horizon, &plane));
		double until = fmin(m.valid_until, end);
		m.path += flight_speed_bound(body, &m, since, until) * (until - since);
		if (!(m.valid_until < end))
			break;
		ob_state at = ob_ballistic_state(s, id, &m, until);
		if (impacts++ == IMPACTS_PER_STEP || !apply_plane_impact(s, id, plane, &at))
			return false;
		m.p = at.pose.p, m.q = at.pose.q, m.v = at.v, m.w = at.w;
		m.t0 = since = from = until;
	}
	// After one impact, what was published before holds up to it; not up to the last of several.
	m.flags = impacts < 2 ? OB_MOTION_FREE : 0;
	s->counters.impacts += impacts;
	publish_flight(s, id, &m);
	return true;
}
