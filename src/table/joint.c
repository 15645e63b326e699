// Joints of a universe: passports, and the list of each object; and the pairs that may touch. Written by the host before
// the run; then constant.
#include <math.h>
#include <string.h>

#include "motion/joint_value.h"
#include "table/layout.h"

// Links from the last to the first, so that each list ascends.
void ob_joints_write(ob_universe *u, const ob_joint_passport *joint, uint32_t joints)
{
	ob_step_data *data = &u->step_data;
	if (!joints)
		return;
	memcpy(data->joint, joint, joints * sizeof *joint);
	for (uint32_t i = joints; i-- > 0;)
		for (int side = 0; side < 2; side++) {
			const uint32_t id = joint[i].object[side];
			data->next_joint[i][side] = 0;
			if (id >= data->objects_max)
				continue;
			data->next_joint[i][side] = data->first_joint[id];
			data->first_joint[id] = 1 + i;
		}
}

// A list ascends, so each walk ends, even after stray writes.
uint32_t ob_joint_next(const ob_step_data *data, uint32_t joint, uint32_t id)
{
	const uint32_t next = data->next_joint[joint - 1][data->joint[joint - 1].object[0] != id];
	return next > joint && next <= data->joints ? next : 0;
}

bool ob_joint_holds(const ob_universe *u, const ob_joint_passport *j)
{
	for (int side = 0; side < 2; side++) {
		if (j->object[side] == OB_JOINT_WORLD)
			continue;
		if (j->object[side] >= u->step_data.objects_max)
			return false;
		const ob_passport *p = ob_passport_of(u, j->object[side]);
		if (!(p->flags & OB_OBJECT_PRESENT) || p->generation != j->generation[side])
			return false;
	}
	return true;
}

bool ob_may_touch(const ob_universe *u, uint32_t a, uint32_t b)
{
	const ob_step_data *data = &u->step_data;
	if (!ob_passport_collides(ob_passport_of(u, a), ob_passport_of(u, b)))
		return false;
	for (uint32_t j = ob_joint_first(data, a); j; j = ob_joint_next(data, j, a)) {
		const ob_joint_passport *joint = &data->joint[j - 1];
		if ((joint->object[0] == b || joint->object[1] == b) && !(joint->flags & OB_JOINT_COLLIDES) &&
		    ob_joint_holds(u, joint))
			return false;
	}
	return true;
}

// ---- readers

static bool axis_makes_sense(const ob_joint_axis *a)
{
	return a->low <= a->high && a->motor < OB_MOTORS && a->most >= 0 && isfinite(a->target);
}

uint32_t ob_universe_joints(const ob_universe *u)
{
	return u->step_data.joints;
}

static bool pose_makes_sense(const ob_pose *p)
{
	const double n2 = p->q.w * p->q.w + p->q.x * p->q.x + p->q.y * p->q.y + p->q.z * p->q.z;
	return isfinite(ob_norm2(p->p)) && n2 > .9 && n2 < 1.1;
}

bool ob_universe_get_joint(const ob_universe *u, uint32_t joint, ob_joint_passport *out)
{
	if (joint >= u->step_data.joints)
		return false;
	*out = u->step_data.joint[joint];
	for (int side = 0; side < 2; side++) {
		ob_passport p;
		if (out->object[side] == OB_JOINT_WORLD)
			continue;
		if (!ob_universe_get_passport(u, out->object[side], &p) || p.generation != out->generation[side])
			return false;
	}
	return out->kind < OB_JOINT_KINDS && axis_makes_sense(&out->axis) && pose_makes_sense(&out->frame[0]) &&
	       pose_makes_sense(&out->frame[1]) && isfinite(out->length) && memchr(out->name, 0, sizeof out->name);
}

bool ob_universe_get_joint_value(const ob_universe *u, uint32_t joint, double *value, double *rate)
{
	const ob_state none = { .pose.q = ob_quat_identity() };
	ob_state states[2] = { none, none };
	ob_universe_info info;
	ob_joint_passport j;
	ob_passport p;
	ob_motion m;
	if (!ob_universe_get_joint(u, joint, &j))
		return false;
	ob_universe_get_info(u, &info);
	for (int side = 0; side < 2; side++) {
		if (j.object[side] == OB_JOINT_WORLD)
			continue;
		if (!ob_universe_get_passport(u, j.object[side], &p) || !ob_universe_get_motion(u, j.object[side], &m))
			return false;
		states[side] = ob_motion_at(&m, p.inertia, fmax(info.time, m.t0));
	}
	return ob_joint_value(&j, states, value, rate);
}
