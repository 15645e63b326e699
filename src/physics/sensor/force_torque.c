// Force and torque that a joint exerts on its first object, mean over the step, in the joint's frame there.
#include "sensor/sensor.h"

bool ob_sample_force_torque(const ob_sampled *x, double *value)
{
	const ob_joint_passport *j = x->joint;
	if (!j)
		return false;
	const ob_joint_load load = ob_joint_load_of(x->u, x->sensor->joint, ob_step_count(x->u) + 1);
	const ob_quat q = ob_moment_at(x->u, x->sensor->object, x->past, x->known, x->t).state.pose.q;
	const ob_mat3 r = ob_quat_matrix(ob_quat_mul(q, x->sensor->pose.q));
	const ob_vec3 force = ob_rotate_back(&r, load.force), torque = ob_rotate_back(&r, load.torque);
	value[0] = force.x, value[1] = force.y, value[2] = force.z;
	value[3] = torque.x, value[4] = torque.y, value[5] = torque.z;
	return true;
}
