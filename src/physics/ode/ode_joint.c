#include "ode/ode_joint.h"

#include <stdlib.h>

#include "elementary/elementary.h"

struct ob_ode_joint {
	dJointID id;
	dJointFeedback feedback;
	ob_joint_passport p;
	ob_ode_end end[2];
	double middle; // value at which ODE's own is 0: it counts turns within +-pi
};

// ---- poses

static ob_pose compose(ob_pose a, ob_pose b)
{
	const ob_mat3 r = ob_quat_matrix(a.q);
	return (ob_pose){ ob_add(a.p, ob_rotate(&r, b.p)), ob_quat_normalize(ob_quat_mul(a.q, b.q)) };
}

static ob_pose inverse(ob_pose a)
{
	const ob_mat3 r = ob_quat_matrix(a.q);
	return (ob_pose){ ob_scale(ob_rotate_back(&r, a.p), -1), ob_quat_conjugate(a.q) };
}

static ob_pose pose_of(dBodyID body)
{
	const dReal *p = dBodyGetPosition(body), *q = dBodyGetQuaternion(body);
	return (ob_pose){ ob_v3(p[0], p[1], p[2]), { q[0], q[1], q[2], q[3] } };
}

static void place(dBodyID body, ob_pose at)
{
	dBodySetPosition(body, at.p.x, at.p.y, at.p.z);
	dBodySetQuaternion(body, (dQuaternion){ at.q.w, at.q.x, at.q.y, at.q.z });
}

// ---- making

static dJointID make(dWorldID world, const ob_joint_passport *p)
{
	switch ((ob_joint_kind)p->kind) {
	case OB_JOINT_BALL:
		return dJointCreateBall(world, 0);
	case OB_JOINT_HINGE:
		return dJointCreateHinge(world, 0);
	case OB_JOINT_SLIDER:
		return dJointCreateSlider(world, 0);
	case OB_JOINT_UNIVERSAL:
		return dJointCreateUniversal(world, 0);
	case OB_JOINT_DISTANCE:
		return dJointCreateDBall(world, 0);
	default:
		return dJointCreateFixed(world, 0);
	}
}

// ODE's first body must be one: that of the first object, unless it is static. Then all is as seen from the second.
static bool is_first(const ob_ode_joint *j)
{
	return j->end[0].body;
}

// Reads place and axes where both frames coincide with "at".
static void set_frames(const ob_ode_joint *j, ob_pose at)
{
	const ob_mat3 r = ob_quat_matrix(at.q);
	const bool first = is_first(j);
	const ob_vec3 o = at.p, x = ob_column(&r, first ? 0 : 1), y = ob_column(&r, first ? 1 : 0);
	const ob_vec3 z = ob_scale(ob_column(&r, 2), first ? 1 : -1);
	switch ((ob_joint_kind)j->p.kind) {
	case OB_JOINT_BALL:
		dJointSetBallAnchor(j->id, o.x, o.y, o.z);
		break;
	case OB_JOINT_HINGE:
		dJointSetHingeAnchor(j->id, o.x, o.y, o.z);
		dJointSetHingeAxis(j->id, z.x, z.y, z.z);
		break;
	case OB_JOINT_SLIDER:
		dJointSetSliderAxis(j->id, z.x, z.y, z.z);
		break;
	case OB_JOINT_UNIVERSAL:
		dJointSetUniversalAnchor(j->id, o.x, o.y, o.z);
		dJointSetUniversalAxis1(j->id, x.x, x.y, x.z);
		dJointSetUniversalAxis2(j->id, y.x, y.y, y.z);
		break;
	case OB_JOINT_DISTANCE:
		dJointSetDBallAnchor1(j->id, o.x, o.y, o.z);
		dJointSetDBallAnchor2(j->id, o.x, o.y, o.z);
		dJointSetDBallDistance(j->id, j->p.length);
		break;
	default:
		dJointSetFixed(j->id);
	}
}

// ODE reads frames from bodies as they stand: they are placed for a moment so that the joint's two frames coincide.
static void attach(ob_ode_joint *j)
{
	ob_pose at = { .q = ob_quat_identity() }, before[2] = { 0 };
	ob_pose frame[2] = { j->p.frame[0], j->p.frame[1] };
	const ob_quat turn = { ob_cos(.5 * j->middle), 0, 0, -ob_sin(.5 * j->middle) };
	frame[0].q = ob_quat_mul(frame[0].q, turn);
	for (int side = 0; side < 2; side++)
		if (!j->end[side].body)
			at = compose(j->end[side].placed, frame[side]);
	for (int side = 0; side < 2; side++) {
		if (!j->end[side].body)
			continue;
		before[side] = pose_of(j->end[side].body);
		place(j->end[side].body, compose(at, inverse(frame[side])));
	}
	dJointAttach(j->id, j->end[!is_first(j)].body, is_first(j) ? j->end[1].body : NULL);
	set_frames(j, at);
	for (int side = 0; side < 2; side++)
		if (j->end[side].body)
			place(j->end[side].body, before[side]);
}

ob_ode_joint *ob_ode_joint_create(dWorldID world, const ob_joint_passport *p, const ob_ode_end end[2])
{
	const double middle = .5 * (p->axis.low + p->axis.high);
	ob_ode_joint *j = calloc(1, sizeof *j);
	if (!j)
		return NULL;
	j->p = *p;
	j->end[0] = end[0], j->end[1] = end[1];
	j->middle = p->kind == OB_JOINT_HINGE && p->flags & OB_JOINT_DRIVEN && isfinite(middle) ? middle : 0;
	j->id = make(world, p);
	attach(j);
	dJointSetFeedback(j->id, &j->feedback);
	for (int side = 0; side < 2; side++) {
		if (!end[side].body)
			continue;
		dBodyEnable(end[side].body);
		dBodySetAutoDisableFlag(end[side].body, 0);
	}
	return j;
}

void ob_ode_joint_destroy(ob_ode_joint *j)
{
	if (!j)
		return;
	dJointDestroy(j->id);
	free(j);
}

// ---- along the axis

static void set(const ob_ode_joint *j, int parameter, double value)
{
	if (j->p.kind == OB_JOINT_HINGE)
		dJointSetHingeParam(j->id, parameter, value);
	else
		dJointSetSliderParam(j->id, parameter, value);
}

// Value of the axis, and the acceleration that a unit force along it gives to the joint's own two bodies.
static double value_of(const ob_ode_joint *j, double *response)
{
	const bool turns = j->p.kind == OB_JOINT_HINGE;
	dVector3 axis;
	*response = 0;
	if (turns)
		dJointGetHingeAxis(j->id, axis);
	for (int side = 0; side < 2; side++) {
		dMass m;
		if (!j->end[side].body || dBodyIsKinematic(j->end[side].body))
			continue;
		dBodyGetMass(j->end[side].body, &m);
		const ob_mat3 r = ob_quat_matrix(pose_of(j->end[side].body).q);
		const ob_vec3 n = turns ? ob_rotate_back(&r, ob_v3(axis[0], axis[1], axis[2])) : ob_v3(0, 0, 0);
		*response += turns ? n.x * n.x / m.I[0] + n.y * n.y / m.I[5] + n.z * n.z / m.I[10] : 1 / m.mass;
	}
	return turns ? dJointGetHingeAngle(j->id) + j->middle : dJointGetSliderPosition(j->id);
}

// Velocity and softness of a motor that is a spring to "rest" with a damper.
static void set_spring(const ob_ode_joint *j, double stiffness, double damping, double off, double h)
{
	const double sum = h * stiffness + damping;
	set(j, dParamVel, stiffness * off / sum);
	set(j, dParamCFM, 1 / sum);
}

void ob_ode_joint_drive(ob_ode_joint *j, const ob_joint_axis *a, double h)
{
	double response, most = INFINITY;
	if (!(j->p.flags & OB_JOINT_DRIVEN))
		return;
	const double value = value_of(j, &response), rate = a->motor == OB_MOTOR_RATE ? a->target : 0;
	set(j, dParamHiStop, isfinite(a->high) ? a->high - j->middle : dInfinity); // the lower must not exceed it
	set(j, dParamLoStop, isfinite(a->low) ? a->low - j->middle : -dInfinity);
	set(j, dParamBounce, a->restitution);
	set(j, dParamVel, rate);
	if (a->stiffness > 0 || a->damping > 0)
		set_spring(j, a->stiffness, a->damping, a->rest - value, h);
	else if (a->motor == OB_MOTOR_VALUE)
		set_spring(j, a->motor_stiffness, a->motor_damping, a->target - value, h);
	else if (a->motor == OB_MOTOR_NONE)
		most = a->friction;
	if (a->motor != OB_MOTOR_NONE)
		most = a->most;
	// at a stop ODE gives all that a motor has
	const double enough = 10 * (fabs(rate) + 1) / (h * response);
	set(j, dParamFMax, isfinite(most) ? most : isfinite(a->low) || isfinite(a->high) ? enough : dInfinity);
}

void ob_ode_joint_load(const ob_ode_joint *j, ob_joint_load *out)
{
	const dJointFeedback *f = &j->feedback;
	const int side = !is_first(j);
	const double sign = side ? -1 : 1;
	const ob_pose body = pose_of(j->end[side].body), at = compose(body, j->p.frame[side]);
	const ob_mat3 axes = ob_quat_matrix(at.q);
	const ob_vec3 force = ob_v3(f->f1[0], f->f1[1], f->f1[2]), torque = ob_v3(f->t1[0], f->t1[1], f->t1[2]);
	const ob_vec3 here = ob_sub(torque, ob_cross(ob_sub(at.p, body.p), force)), axis = ob_column(&axes, 2);
	*out = (ob_joint_load){ .force = ob_scale(force, sign), .torque = ob_scale(here, sign) };
	if (j->p.flags & OB_JOINT_DRIVEN)
		out->along = ob_dot(j->p.kind == OB_JOINT_HINGE ? out->torque : out->force, axis);
}
