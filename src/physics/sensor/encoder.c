// Encoder: value and rate of a joint's first free axis.
#include "motion/joint_value.h"
#include "sensor/sensor.h"

bool ob_sample_encoder(const ob_sampled *x, double *value)
{
	ob_state states[2] = { { .pose.q = ob_quat_identity() }, { .pose.q = ob_quat_identity() } };
	const ob_joint_passport *j = x->joint;
	for (int side = 0; j && side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD)
			states[side] = ob_moment_at(x->u, j->object[side], &x->past[side], x->known, x->t).state;
	return j && ob_joint_value(j, states, &value[0], &value[1]);
}
