#include "sim/look.h"

#include "base/cpu.h"
#include "ode/ode_collide.h"
#include "sim/boxed.h"

static const double swept_step = .4; // of the smaller thickness: faster pairs are followed through the substep
static const double swept_gap = 1e-3; // m: so near counts as meeting

// The shapes that contact/ does not know go to ODE.
static void find_by_ode(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_ode_point point[8];
	ob_quat qa, qb;
	// dCollide wants quaternions; the rotation matrices are what moves here.
	const ob_mat3 *r[2] = { &a->r, &b->r };
	ob_quat *q[2] = { &qa, &qb };
	for (int i = 0; i < 2; i++) {
		const double(*m)[3] = r[i]->m;
		double w2 = 1 + m[0][0] + m[1][1] + m[2][2], x2 = 1 + m[0][0] - m[1][1] - m[2][2];
		double y2 = 1 - m[0][0] + m[1][1] - m[2][2], z2 = 1 - m[0][0] - m[1][1] + m[2][2];
		if (w2 >= x2 && w2 >= y2 && w2 >= z2)
			*q[i] = (ob_quat){ w2, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1] };
		else if (x2 >= y2 && x2 >= z2)
			*q[i] = (ob_quat){ m[2][1] - m[1][2], x2, m[0][1] + m[1][0], m[0][2] + m[2][0] };
		else if (y2 >= z2)
			*q[i] = (ob_quat){ m[0][2] - m[2][0], m[0][1] + m[1][0], y2, m[1][2] + m[2][1] };
		else
			*q[i] = (ob_quat){ m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], z2 };
		*q[i] = ob_quat_normalize(*q[i]);
	}
	int n = ob_ode_collide(a->shape, a->size, (ob_pose){ a->p, qa }, b->shape, b->size, (ob_pose){ b->p, qb },
			       margin, point, OB_PAIR_POINTS);
	out->points = n;
	out->separation = margin;
	for (int k = 0; k < n; k++) {
		out->normal = point[0].normal;
		out->at[k] = point[k].position;
		out->gap[k] = point[k].gap;
		out->separation = fmin(out->separation, point[k].gap);
	}
}

static void find(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_sim *s = with;
	const ob_run_settings *run = ob_universe_settings(s->u);
	if (run->narrow_phase == OB_NARROW_AABB) {
		s->counters.box_tests++;
		ob_synthetic_load(run->load);
		ob_manifold_aabb(a, b, margin, out);
	} else if (!ob_manifold_find(a, b, margin, out)) {
		find_by_ode(a, b, margin, out);
	}
}

static bool is_of_ode(ob_shape s)
{
	return s == OB_SHAPE_CAPSULE || s == OB_SHAPE_CYLINDER;
}

// As find, for one who advances by how far the two are apart: of ODE's shapes that is known only as far as the margin
// goes, so they are looked at with a wide one first.
static void find_from_afar(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const double wide = .5 * fmin(ob_shape_thickness(a->shape, a->size), ob_shape_thickness(b->shape, b->size));
	find(with, a, b, margin, out);
	if (out->points || !(is_of_ode(a->shape) || is_of_ode(b->shape)) || !(wide > margin))
		return;
	ob_manifold far;
	find(with, a, b, wide, &far);
	out->separation = fmax(margin, far.separation);
}

ob_manifold_finder ob_narrowphase_finder(ob_sim *s)
{
	return (ob_manifold_finder){ find_from_afar, s };
}

static ob_placed placed(const ob_island_work *w, uint32_t row)
{
	const ob_body *m = &w->member[row];
	const double *v = w->v[row];
	return (ob_placed){ m->shape, m->size, m->p, m->r, ob_v3(v[0], v[1], v[2]), ob_v3(v[3], v[4], v[5]) };
}

// Bound of the speed at which any two points of the pair may approach (m/s), with what pulls at them.
static double closing_speed(const ob_sim *s, const ob_contact *t)
{
	const ob_island_work *w = &s->island;
	const double *va = w->v[t->a], *vb = w->v[t->b];
	ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	double speed = ob_norm(rel);
	for (int side = 0; side < 2; side++) {
		const ob_body *m = &w->member[side ? t->b : t->a];
		const double *v = side ? vb : va;
		if (m->inv_mass > 0 && m->shape != OB_SHAPE_SPHERE)
			speed += m->radius * ob_norm(ob_v3(v[3], v[4], v[5]));
	}
	return speed + w->pull * w->h;
}

// Points as of the instant of meeting, with gaps wound back to now: what closes at that instant closes then.
static void wind_back(const ob_placed *a, const ob_placed *b, double t, ob_manifold *m)
{
	ob_vec3 rel = ob_sub(a->v, b->v);
	ob_vec3 pa = ob_madd(a->p, t, a->v), pb = ob_madd(b->p, t, b->v);
	for (int j = 0; j < m->points; j++) {
		ob_vec3 spin = ob_sub(ob_cross(a->w, ob_sub(m->at[j], pa)), ob_cross(b->w, ob_sub(m->at[j], pb)));
		m->gap[j] -= t * ob_dot(m->normal, ob_add(rel, spin));
	}
}

static double smaller_thickness(const ob_island_work *w, const ob_contact *t)
{
	return fmin(w->member[t->a].thickness, w->member[t->b].thickness);
}

// The time of meeting (s), and the points up to "reach" (m) then.
static double meet(ob_sim *s, const ob_contact *t, double horizon, double reach, ob_manifold *m)
{
	const ob_island_work *w = &s->island;
	ob_placed a = placed(w, t->a), b = placed(w, t->b);
	double near = fmin(swept_gap, .25 * smaller_thickness(w, t));
	s->counters.swept_tests++;
	return ob_time_of_impact(&a, &b, closing_speed(s, t), horizon, near, reach, ob_narrowphase_finder(s), m);
}

double ob_narrowphase_time_of_impact(ob_sim *s, const ob_contact *t, double horizon)
{
	ob_manifold m;
	return meet(s, t, horizon, fmin(swept_gap, .25 * smaller_thickness(&s->island, t)), &m);
}

void ob_narrowphase_find(ob_sim *s, const ob_contact *t, double tolerance, ob_manifold *m, double *when)
{
	const ob_island_work *w = &s->island;
	ob_placed a = placed(w, t->a), b = placed(w, t->b);
	double thin = smaller_thickness(w, t), travel = closing_speed(s, t) * w->h;
	*when = 0;
	if (travel < swept_step * thin) {
		find(s, &a, &b, fmin(tolerance + 1.5 * travel, fmax(.5 * thin, tolerance + travel)), m);
		return;
	}
	double met = meet(s, t, w->h, fmin(w->member[t->a].radius, w->member[t->b].radius), m);
	if (isinf(met))
		return;
	*when = met;
	wind_back(&a, &b, *when, m);
}
