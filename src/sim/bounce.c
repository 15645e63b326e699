#include "sim/bounce.h"

#include "contact/rebound.h"
#include "motion/landing.h"

static const double slowest = 1e-4; // m/s: slower approaches are contacts
static const double met = 1e-9; // m, and more where coordinates are rounded: so near is on the plane

static ob_half_space half_space(const ob_universe *u, uint32_t plane)
{
	const ob_motion *m = ob_newest_motion(u, plane); // it never moves
	ob_mat3 r = ob_quat_matrix(m->q);
	ob_vec3 n = ob_column(&r, 2);
	return (ob_half_space){ n, ob_dot(n, m->p) };
}

// Objects that touch as boxes along the axes reach beyond the sphere round them.
static ob_flier flier(ob_sim *s, uint32_t id, const ob_motion *f)
{
	const ob_passport *pass = ob_passport_of(s->u, id);
	ob_flier out = { pass->shape, pass->size, pass->inertia, f->p, f->v, f->a, f->q, f->w, NULL };
	if (ob_universe_settings(s->u)->narrow_phase == OB_NARROW_AABB) {
		double reach = sqrt(3) * ob_shape_radius(pass->shape, pass->size);
		out.shape = OB_SHAPE_CYLINDER; // of which nothing is foreseen but when the sphere round it comes down
		out.size = ob_v3(reach, 0, 0);
	}
	if (out.shape != OB_SHAPE_SPHERE && ob_norm2(f->w) > 0)
		out.spin = ob_rotation_cache_get(&s->plans, id, f->q, f->w, pass->inertia);
	return out;
}

double ob_plane_impact_time(ob_sim *s, uint32_t id, const ob_motion *flight, double from, double until, uint32_t *plane)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	ob_flier f = flier(s, id, flight);
	double first = INFINITY;
	for (uint32_t i = 0; i < ex->count->planes; i++) {
		ob_half_space ground = half_space(s->u, ex->plane[i]);
		double t = ob_landing_time(&f, &ground, from - flight->t0, fmin(until, first) - flight->t0);
		if (flight->t0 + t < first)
			first = flight->t0 + t, *plane = ex->plane[i];
	}
	return fmax(first, from);
}

// The arm (m, world) of the lowest point that approaches; false: none is on the plane and does.
static bool striking_point(const ob_passport *pass, const ob_half_space *ground, const ob_state *s, ob_vec3 *arm)
{
	const ob_vec3 n = ground->normal;
	const double height = ob_dot(n, s->pose.p) - ground->offset, speed = ob_dot(n, s->v);
	double lowest = met + 1e-14 * (ob_norm(s->pose.p) + fabs(ground->offset));
	if (pass->shape == OB_SHAPE_SPHERE) {
		*arm = ob_scale(n, -pass->size.x);
		return height - pass->size.x < lowest && speed < -slowest;
	}
	bool found = false;
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	for (int k = 0; k < 8; k++) {
		ob_vec3 h = { k & 1 ? pass->size.x : -pass->size.x, k & 2 ? pass->size.y : -pass->size.y,
			      k & 4 ? pass->size.z : -pass->size.z };
		ob_vec3 at = ob_rotate(&r, h);
		double gap = height + ob_dot(n, at);
		if (gap < lowest && speed + ob_dot(n, ob_cross(s->w, at)) < -slowest)
			lowest = gap, *arm = at, found = true;
	}
	return found;
}

bool ob_plane_impact(const ob_sim *s, uint32_t id, uint32_t plane, ob_state *state)
{
	const ob_passport *pass = ob_passport_of(s->u, id), *fixed = ob_passport_of(s->u, plane);
	const ob_half_space ground = half_space(s->u, plane);
	ob_rebound r = { 1 / pass->mass, pass->inertia, sqrt(pass->friction * fixed->friction),
			 fmax(pass->restitution, fixed->restitution) };
	ob_vec3 arm;
	if (!(r.restitution > 0) || (pass->shape != OB_SHAPE_SPHERE && pass->shape != OB_SHAPE_BOX) ||
	    ob_universe_settings(s->u)->narrow_phase != OB_NARROW_OBB || !striking_point(pass, &ground, state, &arm))
		return false;
	ob_rebound_solve(&r, arm, ground.normal, state);
	return ob_dot(ground.normal, ob_add(state->v, ob_cross(state->w, arm))) > 0;
}
