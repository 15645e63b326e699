// Joints of a universe: passports, and the list of each object; and the pairs that may touch. Written by the host before
// the run; then constant. The solver of a joint's island writes its state in each step.
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

// A joint that breaks in the running step holds until that is complete: its island may be solved again.
static bool has_broken(const ob_universe *u, uint32_t joint)
{
	const uint32_t broke = u->step_data.joint_state[joint].broke;
	return broke && broke <= ob_step_count(u);
}

bool ob_joint_broke_now(const ob_universe *u, uint32_t joint)
{
	return u->step_data.joint_state[joint].broke == ob_step_count(u) && ob_step_count(u) > 0;
}

ob_joint_load ob_joint_load_now(const ob_universe *u, uint32_t joint)
{
	const ob_joint_state *s = &u->step_data.joint_state[joint];
	const uint64_t step = ob_step_count(u), of = has_broken(u, joint) ? s->broke : step;
	ob_joint_load out = { .broke = has_broken(u, joint) ? of : 0 };
	if (s->stamp[of % 2] == of) {
		out.force = s->version[of % 2].force;
		out.torque = s->version[of % 2].torque;
		out.along = s->version[of % 2].along;
	}
	return out;
}

bool ob_joint_holds(const ob_universe *u, const ob_joint_passport *j)
{
	if (has_broken(u, (uint32_t)(j - u->step_data.joint)))
		return false;
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
	out->flags = (out->flags & ~(uint32_t)OB_JOINT_BROKEN) | (has_broken(u, joint) ? OB_JOINT_BROKEN : 0);
	for (int side = 0; side < 2; side++) {
		ob_passport p;
		if (out->object[side] == OB_JOINT_WORLD)
			continue;
		if (!ob_universe_get_passport(u, out->object[side], &p) || p.generation != out->generation[side])
			return false;
	}
	return out->kind < OB_JOINT_KINDS && axis_makes_sense(&out->axis) && out->breaks_force > 0 &&
	       out->breaks_torque > 0 && pose_makes_sense(&out->frame[0]) && pose_makes_sense(&out->frame[1]) &&
	       isfinite(out->length) && memchr(out->name, 0, sizeof out->name);
}

bool ob_universe_get_joint_value(const ob_universe *u, uint32_t joint, double *value, double *rate)
{
	const ob_state none = { .pose.q = ob_quat_identity() };
	ob_state states[2] = { none, none };
	ob_universe_info info;
	ob_joint_passport j;
	ob_passport p;
	ob_motion m;
	if (!ob_universe_get_joint(u, joint, &j) || j.flags & OB_JOINT_BROKEN)
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

bool ob_universe_get_joint_load(const ob_universe *u, uint32_t joint, ob_joint_load *out)
{
	enum { TRIES = 8 };
	ob_joint_passport j;
	if (!ob_universe_get_joint(u, joint, &j))
		return false;
	for (int i = 0; i < TRIES; i++) {
		const uint64_t step = ob_step_count(u);
		*out = ob_joint_load_now(u, joint);
		if (ob_step_count(u) == step)
			break;
	}
	return isfinite(ob_norm2(out->force) + ob_norm2(out->torque) + out->along);
}
