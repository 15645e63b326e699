// Joints of a universe: passports, and the list of each object; and the pairs that may touch. Written by the host, before the
// run and in pauses. The solver of a joint's island writes its state in each step.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion/joint_value.h"
#include "table/layout.h"
#include "table/pages.h"

// ---- numbers and lists

// Place that holds the first, or next, joint of the object behind all those of a lower number.
static uint32_t *place_of(ob_step_data *data, uint32_t id, uint32_t joint)
{
	uint32_t *at = &data->first_joint[id];
	while (*at && *at - 1 < joint && *at <= data->joints_max)
		at = &data->next_joint[*at - 1][data->joint[*at - 1].object[0] != id];
	return at;
}

static void link_joint(ob_step_data *data, uint32_t joint, bool in)
{
	for (int side = 0; side < 2; side++) {
		const uint32_t id = data->joint[joint].object[side];
		if (id >= data->objects_max)
			continue;
		uint32_t *at = place_of(data, id, joint);
		if (in) {
			data->next_joint[joint][side] = *at;
			*at = 1 + joint;
		} else if (*at == 1 + joint) {
			*at = data->next_joint[joint][side];
		}
	}
}

// ---- passports

// Readers in other threads and programs may read a passport while the host writes it. As in a slot (slot.h) each word is
// released, so a reader that has acquired a new one finds that "writes" has changed.
static void write_passport(ob_step_data *data, uint32_t joint, const ob_joint_passport *p)
{
	ob_joint_counts *count = data->joint_counts;
	ob_word *to = (ob_word *)(void *)&data->joint[joint];
	const ob_word *from = (const ob_word *)(const void *)p;
	const uint32_t writes = count->writes | 1; // a host that was killed has left it odd
	__atomic_store_n(&count->writes, writes, __ATOMIC_RELEASE);
	for (size_t i = 0; i < sizeof *p / sizeof *to; i++)
		__atomic_store_n(to + i, from[i], __ATOMIC_RELEASE);
	__atomic_store_n(&count->writes, writes + 1, __ATOMIC_RELEASE);
}

static bool read_passport(const ob_step_data *data, uint32_t joint, ob_joint_passport *out)
{
	const ob_joint_counts *count = data->joint_counts;
	const ob_word *from = (const ob_word *)(const void *)&data->joint[joint];
	ob_word *to = (ob_word *)(void *)out;
	for (int i = 0; i < OB_RING_TRIES; i++) {
		const uint32_t writes = __atomic_load_n(&count->writes, __ATOMIC_ACQUIRE);
		for (size_t k = 0; k < sizeof *out / sizeof *to; k++)
			to[k] = __atomic_load_n(from + k, __ATOMIC_ACQUIRE);
		if (writes % 2 == 0 && __atomic_load_n(&count->writes, __ATOMIC_RELAXED) == writes)
			return true;
	}
	return false;
}

static void set_end(ob_step_data *data, uint32_t end)
{
	__atomic_store_n(&data->joint_counts->used, end, __ATOMIC_RELEASE);
}

static_assert(sizeof(ob_joint_passport) == 416, "passport of a joint");

// Links from the last to the first, so that each one is linked at once.
void ob_joints_write(ob_universe *u, const ob_joint_passport *joint, uint32_t joints)
{
	ob_step_data *data = &u->step_data;
	if (!data->joints_max)
		return;
	memset(data->first_joint, 0, data->objects_max * sizeof *data->first_joint);
	for (uint32_t i = 0; i < joints; i++)
		write_passport(data, i, &joint[i]);
	set_end(data, joints);
	for (uint32_t i = joints; i-- > 0;)
		if (ob_joint_exists(&joint[i]))
			link_joint(data, i, true);
}

bool ob_reserve_joints(ob_universe *u, uint32_t joints)
{
	return ob_pages_take(u, OB_AREA_JOINT, 0, joints) && ob_pages_take(u, OB_AREA_JOINT_STATE, 0, joints) &&
	       ob_pages_take(u, OB_AREA_NEXT_JOINT, 0, joints);
}

uint32_t ob_joint_add(ob_universe *u, const ob_joint_passport *joint)
{
	ob_step_data *data = &u->step_data;
	const uint32_t end = ob_joints_end(data);
	uint32_t i = 0;
	while (i < end && ob_joint_exists(&data->joint[i]))
		i++;
	if (i == data->joints_max || !ob_reserve_joints(u, i + 1))
		return UINT32_MAX;
	ob_joint_passport named = *joint;
	const size_t n = strnlen(named.name, OB_NAME_MAX);
	if (n > 0 && n < OB_NAME_MAX - 12 && named.name[n - 1] == '#')
		snprintf(named.name + n, OB_NAME_MAX - n, "%u", i);
	data->joint_state[i] = (ob_joint_state){ 0 };
	write_passport(data, i, &named);
	set_end(data, i < end ? end : i + 1);
	link_joint(data, i, true);
	return i;
}

void ob_joint_remove(ob_universe *u, uint32_t joint)
{
	ob_step_data *data = &u->step_data;
	if (joint >= ob_joints_end(data) || !ob_joint_exists(&data->joint[joint]))
		return;
	link_joint(data, joint, false);
	write_passport(data, joint, &(ob_joint_passport){ 0 });
	memset(&data->joint_state[joint], 0, sizeof *data->joint_state);
}

void ob_joints_remove_of(ob_universe *u, uint32_t id)
{
	uint32_t j;
	while ((j = ob_joint_first(&u->step_data, id)))
		ob_joint_remove(u, j - 1);
}

// A list ascends, so each walk ends, even after stray writes.
uint32_t ob_joint_next(const ob_step_data *data, uint32_t joint, uint32_t id)
{
	const uint32_t next = data->next_joint[joint - 1][data->joint[joint - 1].object[0] != id];
	return next > joint && next <= data->joints_max ? next : 0;
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

// True if one of its objects is asleep: then its load is the last one.
static bool rests(const ob_universe *u, uint32_t joint)
{
	ob_motion m;
	bool any = false;
	for (int side = 0; side < 2; side++)
		any |= ob_universe_get_motion(u, u->step_data.joint[joint].object[side], &m) &&
		       m.flags & OB_MOTION_RESTS;
	return any;
}

ob_joint_load ob_joint_load_of(const ob_universe *u, uint32_t joint, uint64_t step)
{
	const ob_joint_state *s = &u->step_data.joint_state[joint];
	const bool broke = s->broke && s->broke <= step;
	const uint64_t of = broke ? s->broke : step;
	ob_joint_load out = { .broke = broke ? of : 0 };
	uint32_t last = of % 2;
	if (s->stamp[last] != of && s->stamp[!last] < of && s->stamp[!last] > s->stamp[last])
		last = !last;
	if (s->stamp[last] == of || (s->stamp[last] > 0 && s->stamp[last] < of && rests(u, joint))) {
		out.force = s->version[last].force;
		out.torque = s->version[last].torque;
		out.along = s->version[last].along;
	}
	return out;
}

ob_joint_load ob_joint_load_now(const ob_universe *u, uint32_t joint)
{
	return ob_joint_load_of(u, joint, ob_step_count(u));
}

bool ob_joint_holds(const ob_universe *u, const ob_joint_passport *j)
{
	if (!ob_joint_exists(j) || has_broken(u, (uint32_t)(j - u->step_data.joint)))
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
	const double sum = a->restitution + a->stiffness + a->damping + a->friction + a->motor_stiffness +
			   a->motor_damping + a->armature;
	return a->low <= a->high && a->motor < OB_MOTORS && a->most >= 0 && isfinite(a->target) && isfinite(a->rest) &&
	       isfinite(sum) && a->restitution >= 0 && a->restitution <= 1 && a->stiffness >= 0 && a->damping >= 0 &&
	       a->friction >= 0 && a->motor_stiffness >= 0 && a->motor_damping >= 0 && a->armature >= 0;
}

static bool pose_makes_sense(const ob_pose *p)
{
	const double n2 = p->q.w * p->q.w + p->q.x * p->q.x + p->q.y * p->q.y + p->q.z * p->q.z;
	return isfinite(ob_norm2(p->p)) && n2 > .9 && n2 < 1.1;
}

bool ob_joint_makes_sense(const ob_joint_passport *j)
{
	return j->kind < OB_JOINT_KINDS && ob_joint_exists(j) && j->object[0] != OB_JOINT_WORLD &&
	       axis_makes_sense(&j->axis) && axis_makes_sense(&j->second) && pose_makes_sense(&j->frame[0]) &&
	       pose_makes_sense(&j->frame[1]) && j->breaks_force > 0 && j->breaks_torque > 0 && isfinite(j->length) &&
	       memchr(j->name, 0, sizeof j->name);
}

uint32_t ob_universe_joints(const ob_universe *u)
{
	return ob_joints_end(&u->step_data);
}

bool ob_universe_get_joint(const ob_universe *u, uint32_t joint, ob_joint_passport *out)
{
	if (joint >= ob_joints_end(&u->step_data) || !read_passport(&u->step_data, joint, out))
		return false;
	out->flags = (out->flags & ~(uint32_t)OB_JOINT_BROKEN) | (has_broken(u, joint) ? OB_JOINT_BROKEN : 0);
	for (int side = 0; side < 2; side++) {
		ob_passport p;
		if (out->object[side] == OB_JOINT_WORLD)
			continue;
		if (!ob_universe_get_passport(u, out->object[side], &p) || p.generation != out->generation[side])
			return false;
	}
	return ob_joint_makes_sense(out);
}

bool ob_universe_get_joint_value(const ob_universe *u, uint32_t joint, double *value, double *rate)
{
	const ob_state none = { .pose.q = ob_quat_identity() };
	ob_state states[2] = { none, none };
	ob_joint_passport j;
	ob_passport p;
	ob_motion m;
	if (!ob_universe_get_joint(u, joint, &j) || j.flags & OB_JOINT_BROKEN)
		return false;
	const double now = (double)ob_step_count(u) * u->header.run.step_length;
	for (int side = 0; side < 2; side++) {
		if (j.object[side] == OB_JOINT_WORLD)
			continue;
		if (!ob_universe_get_passport(u, j.object[side], &p) || !ob_universe_get_motion(u, j.object[side], &m))
			return false;
		states[side] = ob_motion_at(&m, p.inertia, fmax(now, m.t0));
	}
	return ob_joint_value(&j, states, value, rate);
}

bool ob_universe_get_joint_values(const ob_universe *u, const uint32_t *joint, size_t n, double *values)
{
	bool fine = true;
	for (size_t i = 0; i < n && fine; i++)
		fine = ob_universe_get_joint_value(u, joint[i], &values[2 * i], &values[2 * i + 1]);
	return fine;
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
