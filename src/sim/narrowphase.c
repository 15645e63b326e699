#include "sim/narrowphase.h"

#include "base/cpu.h"
#include "ode/ode_collide.h"

static const double swept_travel =
	.4; // of the smaller thickness: faster pairs are followed through the partial substep
static const double swept_gap = 1e-3; // m: so near counts as touching

// For the shapes that contact/ has no closed form for.
static void find_by_ode(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_ode_point point[8];
	ob_quat qa, qb;
	// dCollide takes quaternions; here, bodies have rotation matrices.
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

// ---- shapes as their axis-aligned boxes

// Half the width of the shape along the world's axis i.
static double half_width(const ob_placed *x, int i)
{
	const double *m = x->r.m[i];
	switch (x->shape) {
	case OB_SHAPE_SPHERE:
		return x->size.x;
	case OB_SHAPE_BOX:
		return fabs(m[0]) * x->size.x + fabs(m[1]) * x->size.y + fabs(m[2]) * x->size.z;
	case OB_SHAPE_CAPSULE:
		return x->size.x + fabs(m[2]) * x->size.y;
	case OB_SHAPE_CYLINDER:
		return x->size.x * sqrt(m[0] * m[0] + m[1] * m[1]) + fabs(m[2]) * x->size.y;
	default:
		return 0;
	}
}

static ob_placed box_around(const ob_placed *x)
{
	if (x->shape == OB_SHAPE_PLANE)
		return *x;
	return (ob_placed){ .shape = OB_SHAPE_BOX,
			    .size = ob_v3(half_width(x, 0), half_width(x, 1), half_width(x, 2)),
			    .p = x->p,
			    .r = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } },
			    .v = x->v };
}

void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_placed box_a = box_around(a), box_b = box_around(b);
	ob_manifold_find(&box_a, &box_b, margin, out);
}

// ---- the collision test of the run

static void find_manifold(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_sim *s = with;
	const ob_run_settings *run = s->settings;
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

// As find_manifold, with a separation that conservative advancement can use: for ODE's shapes it is known only up to
// the margin, so these are tested with a wide one, too.
static void find_with_separation(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	const double wide = .5 * fmin(ob_shape_thickness(a->shape, a->size), ob_shape_thickness(b->shape, b->size));
	find_manifold(with, a, b, margin, out);
	if (out->points || !(is_of_ode(a->shape) || is_of_ode(b->shape)) || !(wide > margin))
		return;
	ob_manifold far;
	find_manifold(with, a, b, wide, &far);
	out->separation = fmax(margin, far.separation);
}

ob_manifold_finder ob_narrowphase_finder(ob_sim *s)
{
	return (ob_manifold_finder){ find_with_separation, s };
}

static ob_placed placed(const ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	const double *v = w->v[row];
	return (ob_placed){
		body->shape, body->size, body->p, body->r, ob_v3(v[0], v[1], v[2]), ob_v3(v[3], v[4], v[5])
	};
}

// Bound of the speed at which any two points of the pair may approach (m/s), with external acceleration.
static double closing_speed(const ob_sim *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	const double *va = w->v[contact->a], *vb = w->v[contact->b];
	ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	double speed = ob_norm(rel);
	for (int side = 0; side < 2; side++) {
		const ob_body *body = &w->body[side ? contact->b : contact->a];
		const double *v = side ? vb : va;
		if (body->inv_mass > 0 && body->shape != OB_SHAPE_SPHERE)
			speed += body->radius * ob_norm(ob_v3(v[3], v[4], v[5]));
	}
	return speed + w->max_acceleration * w->h;
}

// Points as of the time of impact t, with gaps extrapolated back to now: those that close at that instant close then.
static void extrapolate_gaps_back(const ob_placed *a, const ob_placed *b, double t, ob_manifold *m)
{
	ob_vec3 rel = ob_sub(a->v, b->v);
	ob_vec3 pa = ob_madd(a->p, t, a->v), pb = ob_madd(b->p, t, b->v);
	for (int j = 0; j < m->points; j++) {
		ob_vec3 spin = ob_sub(ob_cross(a->w, ob_sub(m->at[j], pa)), ob_cross(b->w, ob_sub(m->at[j], pb)));
		m->gap[j] -= t * ob_dot(m->normal, ob_add(rel, spin));
	}
}

static double smaller_thickness(const ob_island_work *w, const ob_contact *contact)
{
	return fmin(w->body[contact->a].thickness, w->body[contact->b].thickness);
}

// The time of impact (s), and the points up to "reach" (m) then.
static double time_of_impact(ob_sim *s, const ob_contact *contact, double horizon, double reach, ob_manifold *m)
{
	const ob_island_work *w = &s->island;
	ob_placed a = placed(w, contact->a), b = placed(w, contact->b);
	double near = fmin(swept_gap, .25 * smaller_thickness(w, contact));
	s->counters.swept_tests++;
	return ob_time_of_impact(&a, &b, closing_speed(s, contact), horizon, near, reach, ob_narrowphase_finder(s), m);
}

double ob_narrowphase_time_of_impact(ob_sim *s, const ob_contact *contact, double horizon)
{
	ob_manifold m;
	return time_of_impact(s, contact, horizon, fmin(swept_gap, .25 * smaller_thickness(&s->island, contact)), &m);
}

void ob_narrowphase_find(ob_sim *s, const ob_contact *contact, double tolerance, ob_manifold *m, double *when)
{
	const ob_island_work *w = &s->island;
	ob_placed a = placed(w, contact->a), b = placed(w, contact->b);
	double thin = smaller_thickness(w, contact), travel = closing_speed(s, contact) * w->h;
	*when = 0;
	if (travel < swept_travel * thin) {
		find_manifold(s, &a, &b, fmin(tolerance + 1.5 * travel, fmax(.5 * thin, tolerance + travel)), m);
		return;
	}
	double impact =
		time_of_impact(s, contact, w->h, fmin(w->body[contact->a].radius, w->body[contact->b].radius), m);
	if (isinf(impact))
		return;
	*when = impact;
	extrapolate_gaps_back(&a, &b, *when, m);
}
