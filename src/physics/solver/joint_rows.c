#include "solver/joint_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "motion/joint_value.h"
#include "solver/joint_axis.h"
#include "solver/joint_load.h"
#include "solver/six.h"

static const double compliance = 1e-8; // share of a row's own response; it leaves as much as rounding does

// ---- rows

typedef struct row_rule {
	enum { NO_ROW, ALONG, ACROSS, LENGTH, TURN, FIRST_ARM, SECOND_ARM, TWIST, ANGLE } type;
	int a, b; // axes of the first and the second end
} row_rule;

#define PLACE \
	{ ALONG, 0, 0 }, { ALONG, 0, 1 }, \
	{ \
		ALONG, 0, 2 \
	}
#define SAME_Z \
	{ ACROSS, 0, 2 }, \
	{ \
		ACROSS, 1, 2 \
	}
#define SAME_X \
	{ \
		ACROSS, 0, 1 \
	}

static const row_rule rules[OB_JOINT_KINDS][OB_JOINT_ROWS] = {
	[OB_JOINT_BALL] = { PLACE },
	[OB_JOINT_HINGE] = { PLACE, SAME_Z },
	[OB_JOINT_SLIDER] = { { ALONG, 0, 0 }, { ALONG, 0, 1 }, SAME_Z, SAME_X },
	[OB_JOINT_FIXED] = { PLACE, SAME_Z, SAME_X },
	[OB_JOINT_UNIVERSAL] = { PLACE, { ACROSS, 0, 1 } },
	[OB_JOINT_DISTANCE] = { { LENGTH, 0, 0 } },
};

static const row_rule axis_rules[OB_JOINT_KINDS] = {
	[OB_JOINT_HINGE] = { TURN, 2, 2 },
	[OB_JOINT_SLIDER] = { ALONG, 0, 2 },
	[OB_JOINT_DISTANCE] = { LENGTH, 0, 0 },
};

enum { PARTS_MAX = 4 };

// Axes of the parts of a joint.
static const row_rule part_rules[OB_JOINT_KINDS][PARTS_MAX] = {
	[OB_JOINT_UNIVERSAL] = { { FIRST_ARM, 0, 0 }, { SECOND_ARM, 0, 0 } },
	[OB_JOINT_BALL] = { { TWIST, 0, 0 }, { TWIST, 0, 1 }, { TWIST, 0, 2 }, { ANGLE, 0, 0 } },
};

static const row_rule *axis_rule_of(const ob_held_joint *j)
{
	return j->part ? &part_rules[j->kind][j->part - 1] : &axis_rules[j->kind];
}

static const row_rule *rule_of(const ob_held_joint *j, uint32_t r)
{
	return r < j->base ? &rules[j->kind][r] : axis_rule_of(j);
}

static void set_row(double *row, ob_vec3 linear, ob_vec3 angular)
{
	row[0] = linear.x, row[1] = linear.y, row[2] = linear.z;
	row[3] = angular.x, row[4] = angular.y, row[5] = angular.z;
}

// Finds the place of an end at this time (s) of the run.
static void find_end(const ob_island_work *w, ob_joint_end *e, double time)
{
	ob_pose at = { ob_v3(0, 0, 0), ob_quat_identity() };
	if (e->row) {
		at = (ob_pose){ w->body[e->row].p, w->body[e->row].q };
	} else if (e->motion) {
		const ob_state now = ob_motion_at(e->motion, ob_v3(0, 0, 0), time);
		at = now.pose;
		set_row(e->given, now.v, now.w);
	}
	e->attitude = ob_quat_mul(at.q, e->frame.q);
	const ob_mat3 r = ob_quat_matrix(at.q), axes = ob_quat_matrix(e->attitude);
	e->arm = ob_rotate(&r, e->frame.p);
	e->at = ob_add(at.p, e->arm);
	for (int i = 0; i < 3; i++)
		e->axis[i] = ob_column(&axes, i);
}

// Attitude of the first end, in the frame of the second.
static ob_quat relative_attitude(const ob_held_joint *j)
{
	return ob_quat_mul(ob_quat_conjugate(j->end[1].attitude), j->end[0].attitude);
}

static double component(ob_vec3 v, int axis)
{
	return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// The number that a row holds or limits, at the places that its ends have.
static double value_of(const ob_held_joint *j, const row_rule *rule)
{
	const ob_joint_end *a = &j->end[0], *b = &j->end[1];
	const ob_vec3 apart = ob_sub(a->at, b->at);
	switch (rule->type) {
	case ALONG:
		return ob_dot(b->axis[rule->b], apart);
	case ACROSS:
		return ob_dot(a->axis[rule->a], b->axis[rule->b]);
	case TURN:
		return ob_joint_turn(j->axis, a->axis[0], b->axis[0], b->axis[1]);
	case FIRST_ARM:
		return ob_joint_turn(j->axis, a->axis[1], b->axis[1], ob_cross(a->axis[0], b->axis[1]));
	case SECOND_ARM:
		return ob_joint_turn(j->axis, a->axis[0], b->axis[0], ob_scale(b->axis[2], -1));
	case TWIST:
		return component(ob_joint_twist(relative_attitude(j)), rule->b);
	case ANGLE:
		return ob_norm(ob_joint_twist(relative_attitude(j)));
	default:
		return ob_norm(apart);
	}
}

// Turn (rad) of a ball along one of its axes since the flight began.
static double turned_since(const ob_held_joint *j, const row_rule *rule)
{
	if (rule->type != TWIST || j->along.flight == 0)
		return 0;
	const ob_quat since = ob_quat_mul(relative_attitude(j), ob_quat_conjugate(j->along.rotor_attitude));
	return component(ob_joint_twist(since), rule->b);
}

// Finds the violation of each row, at this time (s) of the run.
static void find_errors(ob_held_joint *j, double time)
{
	if (j->axis)
		ob_axis_find(j, value_of(j, axis_rule_of(j)), turned_since(j, axis_rule_of(j)), time);
	for (uint32_t r = 0; r < j->base; r++) {
		const row_rule *rule = &rules[j->kind][r];
		j->error[r] = value_of(j, rule) - (rule->type == LENGTH ? j->length : 0);
	}
}

void ob_joints_find(ob_island_work *w, double time)
{
	w->joints.now = time;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		find_end(w, &j->end[0], time);
		find_end(w, &j->end[1], time);
		find_errors(j, time);
	}
}

// Axis, in the world, about which the first end turns along a free axis.
static ob_vec3 axis_of_turn(const ob_held_joint *j, const row_rule *rule)
{
	const ob_joint_end *a = &j->end[0], *b = &j->end[1];
	if (rule->type == FIRST_ARM)
		return a->axis[0];
	if (rule->type == SECOND_ARM)
		return b->axis[1];
	if (rule->type != ANGLE)
		return b->axis[rule->b];
	const ob_vec3 twist = ob_joint_twist(relative_attitude(j));
	const double angle = ob_norm(twist);
	const ob_vec3 n = angle > 0 ? ob_scale(twist, 1 / angle) : ob_v3(0, 0, 1);
	return ob_madd(ob_madd(ob_scale(b->axis[0], n.x), n.y, b->axis[1]), n.z, b->axis[2]);
}

// Sets the derivative of a row's value by the motions of both ends.
static void find_row(const ob_held_joint *j, const row_rule *rule, double *of_a, double *of_b)
{
	const ob_joint_end *a = &j->end[0], *b = &j->end[1];
	const ob_vec3 apart = ob_sub(a->at, b->at), none = { 0, 0, 0 };
	if (rule->type == ACROSS) {
		const ob_vec3 turn = ob_cross(a->axis[rule->a], b->axis[rule->b]);
		set_row(of_a, none, turn);
		set_row(of_b, none, ob_scale(turn, -1));
		return;
	}
	if (rule->type >= TURN) {
		const ob_vec3 axis = axis_of_turn(j, rule);
		set_row(of_a, none, axis);
		set_row(of_b, none, ob_scale(axis, -1));
		return;
	}
	const bool along = rule->type == ALONG;
	const double far = ob_norm(apart);
	const ob_vec3 n = along ? b->axis[rule->b] : far > 0 ? ob_scale(apart, 1 / far) : ob_v3(0, 0, 1);
	set_row(of_a, n, ob_cross(a->arm, n));
	set_row(of_b, ob_scale(n, -1), ob_cross(n, along ? ob_add(b->arm, apart) : b->arm));
}

// Sets the response of an end to an impulse of a row. Returns its part of the row's velocity.
static double find_response(const ob_island_work *w, uint32_t body, const double *row, double *response)
{
	if (body == OB_SPARSE_FIXED)
		return 0;
	const ob_body *b = &w->body[1 + body];
	set_row(response, ob_scale(ob_row_linear(row), b->inv_mass), ob_body_turned_by(b, ob_row_angular(row)));
	return ob_six_dot(row, response);
}

void ob_joint_find_rows(const ob_island_work *w, ob_held_joint *j)
{
	const bool swapped = j->end[0].row == 0;
	for (uint32_t r = 0; r < j->rows.rows || r < j->base + (j->axis != NULL); r++) {
		double *child = j->rows.child[r], *parent = j->rows.parent[r];
		find_row(j, rule_of(j, r), swapped ? parent : child, swapped ? child : parent);
		const double response = find_response(w, j->child, child, j->response[0][r]) +
					find_response(w, j->parent, parent, j->response[1][r]),
			     soft = j->along.softness != 0 && r == j->base + j->along.engaged ? j->along.softness : 0;
		j->rows.stiffness[r] = 1 / (compliance * response + soft);
	}
}

void ob_joints_set_inertias(const ob_island_work *w, ob_sparse_solver *t)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_body *body = &w->body[row];
		ob_sparse_block m = { { 0 } };
		if (!ob_sparse_is_linked(t, row - 1))
			continue;
		for (int i = 0; i < 3; i++) {
			const double *r = body->r.m[i];
			m[i][i] = body->mass;
			for (int j = 0; j < 3; j++) {
				const double *q = body->r.m[j];
				m[3 + i][3 + j] = r[0] * q[0] * body->inertia.x + r[1] * q[1] * body->inertia.y +
						  r[2] * q[2] * body->inertia.z;
			}
		}
		ob_sparse_set_inertia(t, row - 1, m);
	}
}

void ob_joints_factor(ob_island_work *w)
{
	ob_joint_set *set = &w->joints;
	ob_sparse_clear(&set->sparse);
	ob_joints_set_inertias(w, &set->sparse);
	for (uint32_t i = 0; i < set->count; i++) {
		ob_held_joint *j = &set->joint[i];
		ob_joint_find_rows(w, j);
		ob_sparse_add_joint(&set->sparse, &j->rows, j->child, j->parent);
	}
	ob_sparse_factor(&set->sparse);
}

void ob_joints_free_axes(ob_island_work *w)
{
	for (uint32_t i = 0; w->joints.axes && i < w->joints.count; i++) {
		w->joints.joint[i].along.softness = 0;
		ob_axis_disengage(&w->joints.joint[i]);
	}
}

void ob_joints_find_free(ob_island_work *w, double time)
{
	ob_joints_free_axes(w);
	ob_joints_find(w, time);
	ob_joints_factor(w);
}

void ob_joints_find_responses(ob_island_work *w)
{
	ob_joint_set *set = &w->joints;
	ob_sparse_invert(&set->sparse);
	for (uint32_t i = 0; i < set->count; i++) {
		ob_held_joint *j = &set->joint[i];
		if (j->axis)
			j->along.response = ob_max(0, ob_sparse_response(&set->sparse, j->rows.child[j->base],
									 j->rows.parent[j->base], j->child, j->parent));
	}
}

// Velocity of a row at the velocities in rows; given: m/s, rad/s, of a parent that has no row.
static double row_velocity(const ob_held_joint *j, uint32_t r, const ob_body_row *rows, const double *given)
{
	const double *child = rows[1 + j->child], *parent = j->parent == OB_SPARSE_FIXED ? given : rows[1 + j->parent];
	return ob_six_dot(j->rows.child[r], child) + ob_six_dot(j->rows.parent[r], parent);
}

double ob_joint_row_velocity(const ob_held_joint *j, uint32_t r, const ob_body_row *rows)
{
	return row_velocity(j, r, rows, j->end[j->end[0].row != 0].given);
}

static void respond(const ob_held_joint *j, uint32_t r, double impulse, ob_body_row *rows)
{
	ob_six_add(rows[1 + j->child], impulse, j->response[0][r]);
	if (j->parent != OB_SPARSE_FIXED)
		ob_six_add(rows[1 + j->parent], impulse, j->response[1][r]);
}

void ob_joint_respond(const ob_held_joint *j, const double *impulse, ob_body_row *rows)
{
	for (uint32_t r = 0; r < j->rows.rows; r++)
		respond(j, r, impulse[r], rows);
}

double ob_joint_axis_rate(const ob_held_joint *j, const ob_body_row *rows)
{
	return ob_joint_row_velocity(j, j->base, rows);
}

void ob_joint_push_axis(ob_held_joint *j, double impulse, ob_body_row *rows)
{
	ob_joint_note_row(j, j->base, impulse);
	respond(j, j->base, impulse, rows);
}

void ob_joints_find_impulses(ob_island_work *w)
{
	ob_joint_set *set = &w->joints;
	ob_sparse_begin_side(&set->sparse);
	for (uint32_t i = 0; i < set->count; i++)
		ob_sparse_push(&set->sparse, &set->joint[i].rows, set->joint[i].child, set->joint[i].parent);
	ob_sparse_substitute(&set->sparse);
	for (uint32_t i = 0; i < set->count; i++)
		ob_sparse_joint_impulses(&set->sparse, &set->joint[i].rows, set->joint[i].child, set->joint[i].parent);
}

// Lets rows move as their targets say, or not at all by a change of velocities: then their impulses are its share. Each pass takes
// what the one before has left, until that is rounding.
static void solve(ob_island_work *w, ob_body_row *rows, bool change, int passes)
{
	static const ob_body_row none;
	double first = 0;
	for (int pass = 0; w->joints.count && pass < passes; pass++) {
		double most = 0;
		for (uint32_t i = 0; i < w->joints.count; i++) {
			ob_held_joint *j = &w->joints.joint[i];
			const double *sum = change ? j->share : j->sum;
			const double soft = j->along.softness;
			for (uint32_t r = 0; r < j->rows.rows; r++)
				j->rows.y[r] = change ? -row_velocity(j, r, rows, none)
						      : j->target[r] - ob_joint_row_velocity(j, r, rows);
			if (soft != 0)
				j->rows.y[j->base + j->along.engaged] -= soft * sum[j->base + j->along.engaged];
			for (uint32_t r = 0; r < j->rows.rows; r++)
				most = ob_max(most, fabs(j->rows.y[r]));
		}
		first = ob_max(first, most);
		if (most <= 1e-14 * first)
			return;
		ob_joints_find_impulses(w);
		for (uint32_t i = 0; i < w->joints.count; i++) {
			ob_held_joint *j = &w->joints.joint[i];
			double *sum = change ? j->share : j->sum;
			ob_joint_respond(j, j->rows.x, rows);
			if (!change)
				ob_joint_note(j, j->rows.x);
			for (uint32_t r = 0; r < j->rows.rows; r++)
				sum[r] += j->rows.x[r];
		}
	}
}

void ob_joints_solve(ob_island_work *w, ob_body_row *rows)
{
	solve(w, rows, false, 5);
}

void ob_joints_follow(ob_island_work *w, ob_body_row *change)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		memset(w->joints.joint[i].share, 0, sizeof w->joints.joint[i].share);
	solve(w, change, true, 2); // a line search takes up what is left
}

void ob_joints_add_share(ob_island_work *w, double part)
{
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		for (uint32_t r = 0; r < j->rows.rows; r++) {
			j->share[r] *= part;
			j->sum[r] += j->share[r];
		}
		ob_joint_note(j, j->share);
	}
}

void ob_joints_iterate(ob_island_work *w)
{
	enum { MOST_CHANGES = 8 };
	ob_joints_solve(w, w->u);
	for (int round = 0; w->joints.axes && round < MOST_CHANGES; round++) {
		bool changed = false;
		for (uint32_t i = 0; i < w->joints.count; i++) {
			ob_held_joint *j = &w->joints.joint[i];
			double more;
			if (!j->axis || !ob_axis_settle(j, ob_joint_axis_rate(j, w->u), w->h, &more))
				continue;
			ob_joint_push_axis(j, more, w->u);
			changed = true;
		}
		if (!changed)
			return;
		ob_joints_factor(w);
		ob_joints_solve(w, w->u);
	}
}

// ---- loading

static void load_end(ob_island_work *w, const ob_island_input *in, uint32_t object, ob_joint_end *e)
{
	if (object == OB_NO_FIXED)
		return;
	if (object < in->members)
		e->row = w->row_of[object];
	else
		e->motion = in->object[object].motion;
	if (e->row)
		w->body[e->row].moved_freely = false;
}

// True if something acts along an axis.
static bool acts(const ob_joint_axis *a)
{
	return isfinite(a->low) || isfinite(a->high) || a->stiffness > 0 || a->damping > 0 || a->friction > 0 ||
	       a->armature > 0 || a->motor != OB_MOTOR_NONE;
}

// Adds a joint that has no rows but those of an axis of another.
static void add_part(ob_island_work *w, uint32_t of, uint32_t part, const ob_joint_axis *axis)
{
	const ob_held_joint *whole = &w->joints.joint[of];
	ob_held_joint *j = &w->joints.joint[w->joints.count++];
	*j = (ob_held_joint){ .kind = whole->kind,
			      .breaks_force = INFINITY,
			      .breaks_torque = INFINITY,
			      .end = { whole->end[0], whole->end[1] },
			      .number = whole->number,
			      .part = part,
			      .child = whole->child,
			      .parent = whole->parent,
			      .own = *axis };
	j->axis = &j->own;
	w->joints.axes++;
	w->joints.damped |= ob_axis_is_damped(j);
	w->joints.soft |= ob_axis_is_soft(j);
	ob_sparse_link(&w->joints.sparse, j->child, j->parent);
}

// Adds the axes of a universal, or of a ball, along which something acts.
static void add_parts(ob_island_work *w, uint32_t of, const ob_joint_passport *from)
{
	const ob_joint_axis *a = &from->axis;
	if (from->kind == OB_JOINT_UNIVERSAL) {
		if (acts(a))
			add_part(w, of, 1, a);
		if (acts(&from->second))
			add_part(w, of, 2, &from->second);
		return;
	}
	const ob_joint_axis turns = { .low = -INFINITY,
				      .high = INFINITY,
				      .stiffness = a->stiffness,
				      .damping = a->damping,
				      .armature = a->armature };
	const ob_joint_axis angle = { .low = -INFINITY, .high = a->high, .restitution = a->restitution };
	for (uint32_t i = 1; acts(&turns) && i < PARTS_MAX; i++)
		add_part(w, of, i, &turns);
	if (acts(&angle))
		add_part(w, of, PARTS_MAX, &angle);
}

static void load_joint(ob_island_work *w, const ob_island_input *in, const ob_island_joint *from)
{
	const uint32_t at = w->joints.count++;
	ob_held_joint *j = &w->joints.joint[at];
	*j = (ob_held_joint){ .kind = from->joint->kind,
			      .length = from->joint->length,
			      .number = (uint32_t)(from - in->joint),
			      .breaks_force = from->joint->breaks_force,
			      .breaks_torque = from->joint->breaks_torque };
	w->joints.breakable |= isfinite(j->breaks_force) || isfinite(j->breaks_torque);
	for (int side = 0; side < 2; side++) {
		j->end[side].frame = from->joint->frame[side];
		load_end(w, in, from->object[side], &j->end[side]);
		w->body[j->end[side].row].joints += j->end[side].row != 0;
	}
	if (from->joint->flags & OB_JOINT_DRIVEN && axis_rules[j->kind].type != NO_ROW) {
		j->axis = &from->joint->axis;
		w->joints.axes++;
		w->joints.damped |= ob_axis_is_damped(j);
		w->joints.soft |= ob_axis_is_soft(j);
	}
	while (j->base < OB_JOINT_ROWS && rules[j->kind][j->base].type != NO_ROW)
		j->base++;
	if (j->axis && j->kind == OB_JOINT_DISTANCE)
		j->base = 0;
	j->rows.rows = j->base;
	const uint32_t a = j->end[0].row, b = j->end[1].row;
	j->child = (a ? a : b) - 1;
	j->parent = a && b ? b - 1 : OB_SPARSE_FIXED;
	ob_sparse_link(&w->joints.sparse, j->child, j->parent);
	if (from->joint->flags & OB_JOINT_DRIVEN && part_rules[j->kind][0].type != NO_ROW)
		add_parts(w, at, from->joint);
}

void ob_joints_load(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	ob_joint_set *set = &w->joints;
	set->count = 0;
	if (!in->joints)
		return;
	uint32_t most = 0;
	for (uint32_t i = 0; i < in->joints; i++)
		most += 1 + (in->joint[i].joint->flags & OB_JOINT_DRIVEN ? PARTS_MAX : 0);
	if (most > set->max) {
		set->max = most + most / 2;
		set->joint = ob_reallocate(set->joint, set->max * sizeof *set->joint);
	}
	set->step_begin = (double)in->step * s->settings->step_length;
	set->stiffness = set->swing = set->last_share = 0;
	set->axes = 0;
	set->failed = set->breakable = set->damped = set->soft = false;
	ob_sparse_begin(&set->sparse, w->bodies);
	for (uint32_t i = 0; i < in->joints; i++)
		load_joint(w, in, &in->joint[i]);
	ob_sparse_analyse(&set->sparse, UINT32_MAX);
	if ((set->axes || set->breakable) && 2 * w->bodies > set->kept_max) {
		set->kept_max = 3 * w->bodies;
		set->kept = ob_reallocate(set->kept, set->kept_max * sizeof *set->kept);
	}
}

void ob_joints_finish(ob_joint_set *j)
{
	free(j->joint);
	free(j->kept);
	ob_sparse_finish(&j->sparse);
}
