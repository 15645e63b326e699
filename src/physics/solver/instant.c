#include "solver/instant.h"

#include <string.h>

#include "motion/drift.h"
#include "solver/surfaces.h"

void ob_set_drift(ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		const double *dv = w->dv[i], most = OB_SMOOTH_ACCELERATION * w->max_acceleration * w->h;
		double linear = ob_norm(ob_v3(dv[0], dv[1], dv[2])), angular = ob_norm(ob_v3(dv[3], dv[4], dv[5]));
		ob_vec3 external = ob_scale(body->acceleration, w->h);
		w->body[i].loaded = linear + body->radius * angular <= most;
		if (body->loaded)
			memcpy(w->drift[i], dv, sizeof *w->drift);
		else
			memcpy(w->drift[i], (double[8]){ external.x, external.y, external.z }, sizeof *w->drift);
	}
	ob_surfaces_set_drift(w);
}

void ob_fly(const ob_island_work *w, uint32_t row, double t, ob_body_at *x)
{
	const ob_body *body = &w->body[row];
	const ob_vec3 a = ob_scale(ob_row_linear(w->drift[row]), 1 / w->h),
		      b = ob_scale(ob_row_angular(w->drift[row]), 1 / w->h);
	if (t == 0)
		return;
	x->p = ob_madd(ob_madd(x->p, t, x->v), .5 * t * t, a);
	x->v = ob_madd(x->v, t, a);
	if (body->inv_mass == 0 || (ob_norm2(x->w) == 0 && ob_norm2(b) == 0))
		return;
	if (body->isotropic) {
		x->q = ob_quat_turn(x->q, ob_madd(ob_scale(x->w, t), .5 * t * t, b));
	} else {
		(w->max_acceleration > 0 ? ob_drift_held : ob_drift)(x->q, x->w, body->inertia, t, &x->q, &x->w);
		x->q = ob_norm2(b) > 0 ? ob_quat_turn(x->q, ob_scale(b, .5 * t * t)) : x->q;
	}
	x->w = ob_madd(x->w, t, b);
	x->r = ob_quat_matrix(x->q);
}

ob_body_at ob_body_at_time(const ob_island_work *w, uint32_t row, double t)
{
	const ob_body *body = &w->body[row];
	if (body->surface) {
		const ob_state at = ob_surface_state(w, row, t);
		return (ob_body_at){ at.pose.p, at.v, at.w, at.pose.q, ob_quat_matrix(at.pose.q) };
	}
	ob_body_at x = { body->p, ob_row_linear(w->v[row]), ob_row_angular(w->v[row]), body->q, body->r };
	ob_fly(w, row, t, &x);
	return x;
}
