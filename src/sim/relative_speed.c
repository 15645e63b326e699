#include "sim/relative_speed.h"

double ob_relative_speed(ob_shape a, const ob_mat3 *ra, ob_shape b, const ob_mat3 *rb, ob_vec3 v)
{
	if (a != OB_SHAPE_PLANE && b != OB_SHAPE_PLANE)
		return ob_norm(v);
	return fabs(ob_dot(v, ob_column(a == OB_SHAPE_PLANE ? ra : rb, 2)));
}

ob_vec3 ob_contact_velocity(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	const double *va = rows[contact->a], *vb = rows[contact->b];
	const ob_vec3 rel = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
	if (!(a->surface | b->surface))
		return rel;
	const double *turn = a->surface ? va : vb; // the other's arm from it has the sign that its velocity has
	return ob_sub(rel, ob_cross(ob_v3(turn[3], turn[4], turn[5]), ob_sub(a->p, b->p)));
}

double ob_contact_speed(const ob_island_work *w, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	const ob_vec3 rel = ob_contact_velocity(w, w->v, contact);
	return ob_relative_speed(a->shape, &a->r, b->shape, &b->r, rel) + a->turning + b->turning;
}
