// Takes samples of all kinds. See sensor.h.
#include "sensor/sensor.h"

typedef bool sample(const ob_sampled *x, double *value);

static sample *const kinds[OB_SENSOR_KINDS] = {
	[OB_SENSOR_IMU] = ob_sample_imu,
	[OB_SENSOR_ENCODER] = ob_sample_encoder,
	[OB_SENSOR_FORCE_TORQUE] = ob_sample_force_torque,
	[OB_SENSOR_TOUCH] = ob_sample_touch,
	[OB_SENSOR_LIDAR] = ob_sample_lidar,
};

static const ob_joint_passport *joint_of(const ob_universe *u, const ob_sensor_passport *s)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (s->kind != OB_SENSOR_ENCODER && s->kind != OB_SENSOR_FORCE_TORQUE)
		return NULL;
	const ob_joint_passport *j = s->joint < ob_joints_end(data) ? &data->joint[s->joint] : NULL;
	return j && j->object[0] == s->object && ob_joint_holds(u, j) ? j : NULL;
}

// Keeps states for the next step.
static void look_back(const ob_sampled *x, ob_sensor_cell *c, uint64_t step)
{
	ob_moment_pass(x->u, x->sensor->object, &c->past[0]);
	if (x->joint && x->joint->object[1] != OB_JOINT_WORLD)
		ob_moment_pass(x->u, x->joint->object[1], &c->past[1]);
	c->known = x->known < OB_PAST_STEPS + 1 ? x->known + 1 : x->known;
	c->step = step + 1;
}

void ob_sensor_sample(ob_universe *u, uint32_t sensor)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_sensor_passport *s = &data->sensor[sensor];
	ob_sensor_cell *c = &data->sensor_cell[sensor];
	const uint64_t step = ob_step_count(u);
	const double h = ob_universe_settings(u)->step_length, end = (double)(step + 1) * h;
	ob_sampled x = { u, s, joint_of(u, s), c->past, 0, 0 };
	double value[OB_SENSOR_VALUES_MAX];
	if (s->kind == OB_SENSOR_CAMERA) // the host draws its pictures
		return;
	if (!ob_sensor_makes_sense(u, s)) {
		ob_step_fail(u, OB_STEP_DAMAGED, 0);
		return;
	}
	const ob_passport *object = ob_passport_of(u, s->object);
	if (!(object->flags & OB_OBJECT_PRESENT) || object->generation != s->generation)
		return;
	x.known = c->step == step && c->known <= OB_PAST_STEPS + 1 ? c->known : 0;
	for (uint64_t k = c->taken + 1, last = ob_sensor_due(s, h, step + 1, 0); k <= last; k++) {
		x.t = ob_min((double)k / s->rate, end);
		if (!kinds[s->kind](&x, value))
			break;
		ob_sensor_add_noise(s, k, value);
		ob_sensor_publish(u, sensor, x.t, value);
	}
	if (s->kind == OB_SENSOR_IMU || s->kind == OB_SENSOR_ENCODER)
		look_back(&x, c, step);
}
