// Inertial unit: acceleration of its place less gravity, and rate of turn, in its frame.
#include "sensor/sensor.h"

bool ob_sample_imu(const ob_sampled *x, double *value)
{
	const ob_moment m = ob_moment_at(x->u, x->sensor->object, &x->past[0], x->known, x->t);
	const ob_mat3 body = ob_quat_matrix(m.state.pose.q), r = ob_quat_matrix(x->sensor->pose.q);
	const ob_vec3 arm = ob_rotate(&body, x->sensor->pose.p), w = m.state.w;
	const ob_vec3 swing = ob_add(ob_cross(m.turn, arm), ob_cross(w, ob_cross(w, arm)));
	const ob_vec3 felt = ob_sub(ob_add(m.a, swing), ob_universe_settings(x->u)->gravity);
	const ob_vec3 own = ob_rotate_back(&body, felt), turn = ob_rotate_back(&body, w);
	const ob_vec3 a = ob_rotate_back(&r, own), g = ob_rotate_back(&r, turn);
	value[0] = a.x, value[1] = a.y, value[2] = a.z;
	value[3] = g.x, value[4] = g.y, value[5] = g.z;
	return true;
}
