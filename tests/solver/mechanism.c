#include "mechanism.h"

#include <stdlib.h>
#include <string.h>

#include "shape/shape.h"

static bool spend(void *with, uint64_t work)
{
	return false;
}

static void begin_attempt(void *with) {}

static void touch(void *with, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	abort();
}

static void fail(void *with, uint32_t object)
{
	abort();
}

static void keep_contact(void *with, const ob_found_contact *c)
{
	abort();
}

static void keep_joint(void *with, const ob_found_joint *j)
{
	((mechanism *)with)->load[j->joint] = *j;
}

static void keep_motion(void *with, const ob_island_object *object, ob_motion *m, bool free)
{
	((mechanism *)with)->motion[object->id] = *m;
	if (free)
		abort();
}

mechanism *mechanism_create(double g)
{
	mechanism *m = calloc(1, sizeof *m);
	const ob_island_calls calls = { m,    spend,        NULL,       begin_attempt, touch,
					fail, keep_contact, keep_joint, keep_motion };
	m->run = ob_run_settings_default();
	m->run.gravity = ob_v3(0, 0, -g);
	m->run.step_length = step_length;
	if (!ob_solver_create(&m->solver, &m->run, &calls, BODIES))
		abort();
	return m;
}

void mechanism_destroy(mechanism *m)
{
	ob_solver_finish(&m->solver);
	free(m);
}

uint32_t mechanism_add(mechanism *m, ob_shape shape, ob_vec3 size, double mass, ob_vec3 at)
{
	const uint32_t id = m->bodies++;
	m->passport[id] = (ob_passport){ .id = id,
					 .flags = OB_OBJECT_PRESENT,
					 .shape = (uint8_t)shape,
					 .size = size,
					 .mass = mass,
					 .inertia = ob_shape_inertia(shape, size, NULL, mass) };
	m->motion[id] = (ob_motion){ .p = at, .q = ob_quat_identity() };
	return id;
}

ob_joint_passport *mechanism_join(mechanism *m, ob_joint_kind kind, uint32_t a, uint32_t b, ob_vec3 at, ob_quat q)
{
	ob_joint_passport *j = &m->joint[m->joints++];
	*j = (ob_joint_passport){
		.object = { a, b }, .kind = kind, .breaks_force = INFINITY, .breaks_torque = INFINITY
	};
	for (int side = 0; side < 2; side++) {
		const uint32_t id = j->object[side];
		if (id == OB_JOINT_WORLD) {
			j->frame[side] = (ob_pose){ at, q };
			continue;
		}
		const ob_mat3 r = ob_quat_matrix(m->motion[id].q);
		j->frame[side] = (ob_pose){ ob_rotate_back(&r, ob_sub(at, m->motion[id].p)),
					    ob_quat_mul(ob_quat_conjugate(m->motion[id].q), q) };
	}
	return j;
}

void mechanism_step(mechanism *m)
{
	ob_island_object object[BODIES];
	ob_island_joint joint[JOINTS];
	const ob_motion *was = m->motion;
	ob_motion before[BODIES];
	memcpy(before, was, sizeof before);
	for (uint32_t k = 0; k < m->bodies; k++)
		object[k] = (ob_island_object){ .id = k,
						.passport = &m->passport[k],
						.motion = &before[k],
						.now = { { before[k].p, before[k].q }, before[k].v, before[k].w },
						.path = before[k].path };
	for (uint32_t k = 0; k < m->joints; k++) {
		joint[k] = (ob_island_joint){ .number = k, .joint = &m->joint[k] };
		for (int side = 0; side < 2; side++)
			joint[k].object[side] =
				m->joint[k].object[side] == OB_JOINT_WORLD ? OB_NO_FIXED : m->joint[k].object[side];
	}
	ob_island_solve(&m->solver, &(ob_island_input){ .step = m->steps++,
							.members = m->bodies,
							.objects = m->bodies,
							.joints = m->joints,
							.object = object,
							.joint = joint });
}

ob_vec3 mechanism_spin(const mechanism *m, uint32_t id)
{
	const ob_mat3 r = ob_quat_matrix(m->motion[id].q);
	const ob_vec3 k = m->passport[id].inertia, w = ob_rotate_back(&r, m->motion[id].w);
	return ob_rotate(&r, ob_v3(k.x * w.x, k.y * w.y, k.z * w.z));
}

double mechanism_energy(const mechanism *m)
{
	double sum = 0;
	for (uint32_t id = 0; id < m->bodies; id++) {
		const ob_motion *x = &m->motion[id];
		sum += .5 * m->passport[id].mass * ob_norm2(x->v) + .5 * ob_dot(x->w, mechanism_spin(m, id)) -
		       m->passport[id].mass * ob_dot(m->run.gravity, x->p);
	}
	return sum;
}

double mechanism_parted(const mechanism *m)
{
	double most = 0;
	for (uint32_t k = 0; k < m->joints; k++) {
		const ob_joint_passport *j = &m->joint[k];
		ob_vec3 at[2], z[2];
		for (int side = 0; side < 2; side++) {
			const uint32_t id = j->object[side];
			const ob_quat q = id == OB_JOINT_WORLD ? ob_quat_identity() : m->motion[id].q;
			const ob_mat3 r = ob_quat_matrix(q), axes = ob_quat_matrix(ob_quat_mul(q, j->frame[side].q));
			at[side] = ob_rotate(&r, j->frame[side].p);
			if (id != OB_JOINT_WORLD)
				at[side] = ob_add(at[side], m->motion[id].p);
			z[side] = ob_column(&axes, 2);
		}
		const ob_vec3 apart = ob_sub(at[0], at[1]);
		const bool leans = j->kind == OB_JOINT_HINGE || j->kind == OB_JOINT_FIXED || j->kind == OB_JOINT_SLIDER;
		most = fmax(most, j->kind == OB_JOINT_DISTANCE ? fabs(ob_norm(apart) - j->length)
				  : j->kind == OB_JOINT_SLIDER ? ob_norm(ob_cross(apart, z[1]))
							       : ob_norm(apart));
		if (leans)
			most = fmax(most, ob_norm(ob_cross(z[0], z[1])));
	}
	return most;
}

mechanism *mechanism_pendulum(double angle)
{
	mechanism *m = mechanism_create(gravity);
	const uint32_t bob = mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(sin(angle), 0, -cos(angle)));
	mechanism_join(m, OB_JOINT_HINGE, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), y_axis);
	return m;
}

ob_joint_axis *mechanism_drive(mechanism *m)
{
	ob_joint_passport *j = &m->joint[m->joints - 1];
	j->flags |= OB_JOINT_DRIVEN;
	j->axis = (ob_joint_axis){ .low = -INFINITY, .high = INFINITY };
	return &j->axis;
}

void mechanism_steps(mechanism *m, int n)
{
	for (int i = 0; i < n; i++)
		mechanism_step(m);
}
