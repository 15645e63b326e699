#include "solver/relative_speed.h"

#include "motion/drift.h"
#include "shape/shape.h"

double ob_relative_speed(ob_shape a, const ob_mat3 *ra, ob_shape b, const ob_mat3 *rb, ob_vec3 v)
{
	const bool first = ob_shape_is(a, OB_UNBOUNDED);
	if (!first && !ob_shape_is(b, OB_UNBOUNDED))
		return ob_norm(v);
	return fabs(ob_dot(v, ob_column(first ? ra : rb, 2)));
}

ob_vec3 ob_contact_velocity(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	const double *va = rows[contact->a], *vb = rows[contact->b];
	const ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	if (!(a->surface | b->surface) || (a->surface ? a : b)->rolls)
		return rel;
	const double *turn = a->surface ? va : vb; // the sign of the other body's arm from it is that of its velocity
	return ob_sub(rel, ob_cross(ob_v3(turn[3], turn[4], turn[5]), ob_sub(a->p, b->p)));
}

double ob_spin_lever(const ob_body *body, ob_vec3 n, const ob_vec3 *arm, uint32_t points)
{
	double most = 0;
	if (!ob_shape_is(body->shape, OB_AXIAL))
		return 0;
	const ob_vec3 across = ob_cross(n, ob_column(&body->r, 2));
	for (uint32_t j = 0; j < points; j++)
		most = ob_max(most, fabs(ob_dot(across, arm[j])));
	return most;
}

// Returns the rate, rad/s, about a round body's axis.
static double spin_of(const ob_body *body, const double *v)
{
	return fabs(ob_dot(ob_column(&body->r, 2), ob_v3(v[3], v[4], v[5])));
}

double ob_contact_speed(const ob_island_work *w, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	const ob_vec3 rel = ob_contact_velocity(w, w->v, contact);
	double speed = ob_relative_speed(a->shape, &a->r, b->shape, &b->r, rel) + a->turning + b->turning;
	if (contact->spin_lever_a > 0)
		speed += contact->spin_lever_a * spin_of(a, w->v[contact->a]);
	if (contact->spin_lever_b > 0)
		speed += contact->spin_lever_b * spin_of(b, w->v[contact->b]);
	return speed;
}

static double turn_rate_of(const ob_body *body, const double *v, double spin_lever)
{
	const ob_vec3 w = ob_v3(v[3], v[4], v[5]);
	if (ob_shape_is(body->shape, OB_ISOTROPIC))
		return 0;
	if (!ob_shape_is(body->shape, OB_AXIAL))
		return ob_norm(w);
	const ob_vec3 axis = ob_column(&body->r, 2);
	return ob_norm(ob_cross(axis, w)) + spin_lever / body->radius * fabs(ob_dot(axis, w));
}

double ob_contact_turn_rate(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact)
{
	return turn_rate_of(&w->body[contact->a], rows[contact->a], contact->spin_lever_a) +
	       turn_rate_of(&w->body[contact->b], rows[contact->b], contact->spin_lever_b);
}

double ob_turning_speed(ob_shape shape, ob_vec3 size, ob_vec3 inertia, ob_vec3 w, double s)
{
	if (ob_shape_is(shape, OB_AXIAL) && inertia.x == inertia.y) // its axis turns at a constant rate
		w.z = 0, s = 0;
	double rate = ob_shape_is(shape, OB_ISOTROPIC) ? 0 : ob_drift_bound(w, inertia, s);
	return rate == 0 ? 0 : rate * ob_shape_radius(shape, size);
}
