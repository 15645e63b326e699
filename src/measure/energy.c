#include "measure/measure.h"

static bool moves(const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	return p->flags & OB_OBJECT_PRESENT && !(p->flags & OB_OBJECT_STATIC) && p->mass > 0;
}

// I w in the world frame (kg m^2/s), from the principal moments in the body frame.
static ob_vec3 spin(const ob_passport *p, const ob_state *s)
{
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_vec3 w = ob_rotate_back(&r, s->w);
	return ob_rotate(&r, ob_v3(p->inertia.x * w.x, p->inertia.y * w.y, p->inertia.z * w.z));
}

double ob_measure_energy(const ob_snapshot *s, ob_vec3 gravity)
{
	double sum = 0;
	for (uint32_t id = 0; id < s->count; id++) {
		if (!moves(s, id))
			continue;
		const ob_passport *p = &s->passport[id];
		ob_state state = ob_snapshot_state(s, id);
		sum += .5 * p->mass * ob_norm2(state.v) + .5 * ob_dot(state.w, spin(p, &state)) -
		       p->mass * ob_dot(gravity, state.pose.p) - ob_dot(p->force, state.pose.p);
	}
	return sum;
}

ob_vec3 ob_measure_momentum(const ob_snapshot *s)
{
	ob_vec3 sum = ob_v3(0, 0, 0);
	for (uint32_t id = 0; id < s->count; id++)
		if (moves(s, id))
			sum = ob_madd(sum, s->passport[id].mass, ob_snapshot_state(s, id).v);
	return sum;
}

ob_vec3 ob_measure_angular_momentum(const ob_snapshot *s)
{
	ob_vec3 sum = ob_v3(0, 0, 0);
	for (uint32_t id = 0; id < s->count; id++) {
		if (!moves(s, id))
			continue;
		const ob_passport *p = &s->passport[id];
		ob_state state = ob_snapshot_state(s, id);
		sum = ob_add(ob_madd(sum, p->mass, ob_cross(state.pose.p, state.v)), spin(p, &state));
	}
	return sum;
}
