#include "host/pull.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/number.h"
#include "scene/object_limits.h"
#include "shape/shape.h"
#include "step/publish.h"
#include "step/sim.h"

static const double hand_speed = 100; // m/s: the most at which a drag moves a body
static const double spin_decay = 2; // 1/s, of a dragged body
static const double frequency_least = .1, frequency_most = 50; // Hz

bool ob_is_pull_request(const ob_request *r)
{
	return r->kind == OB_REQUEST_TORQUE || r->kind == OB_REQUEST_PUSH || r->kind == OB_REQUEST_DRAG;
}

ob_pull ob_pull_of_request(const ob_request *r)
{
	ob_pull pull = { .id = r->id, .generation = r->generation, .origin = r->origin };
	if (r->kind == OB_REQUEST_TORQUE) {
		pull.kind = OB_PULL_TORQUE;
		pull.value = r->twist;
		return pull;
	}
	pull.kind = r->kind == OB_REQUEST_PUSH ? OB_PULL_PUSH : OB_PULL_DRAG;
	pull.point = r->point;
	pull.value = r->kind == OB_REQUEST_PUSH ? r->force : r->target;
	pull.frequency = r->kind == OB_REQUEST_DRAG ? r->frequency : 0;
	return pull;
}

static bool check_point(const ob_pull *pull, const ob_passport *p, ob_error *e)
{
	const double most = 1.01 * ob_shape_radius((ob_shape)p->shape, p->size);
	return (ob_is_finite(pull->point) && ob_norm(pull->point) <= most) ||
	       ob_fail(e, "point: expected one of the object, at most %g m from its centre", most);
}

static bool check_drag(const ob_pull *pull, ob_error *e)
{
	const ob_vec3 t = pull->value;
	if (!(fabs(t.x) <= OB_PLACE_MOST && fabs(t.y) <= OB_PLACE_MOST && fabs(t.z) <= OB_PLACE_MOST))
		return ob_fail(e, "target: expected numbers from %g to %g m", -OB_PLACE_MOST, OB_PLACE_MOST);
	return (pull->frequency >= frequency_least && pull->frequency <= frequency_most) ||
	       ob_fail(e, "frequency: expected from %g to %g Hz, got %s", frequency_least, frequency_most,
		       ob_number_text(pull->frequency).text);
}

bool ob_pull_check(const ob_pull *pull, const ob_passport *p, ob_error *e)
{
	const ob_vec3 none = { 0 };
	if (p->flags & OB_OBJECT_PRESCRIBED)
		return ob_fail(e, "object %u (%.*s) does not move by forces", p->id, OB_NAME_MAX, p->name);
	if (pull->kind == OB_PULL_TORQUE)
		return ob_push_check(p, none, pull->value, e);
	if (!check_point(pull, p, e))
		return false;
	const double moment = ob_norm(pull->value) * ob_norm(pull->point);
	return pull->kind == OB_PULL_DRAG ? check_drag(pull, e)
					  : ob_push_check(p, pull->value, ob_v3(moment, moment, moment), e);
}

// ---- the list

static bool is_same(const ob_pull *a, const ob_pull *b)
{
	return a->kind == b->kind && a->id == b->id && a->generation == b->generation && a->origin == b->origin;
}

static void remove_at(ob_pulls *p, uint32_t i)
{
	memmove(&p->at[i], &p->at[i + 1], (--p->count - i) * sizeof *p->at);
}

static bool reserve(ob_pulls *p, uint32_t count)
{
	if (count <= p->room)
		return true;
	const uint32_t room = 2 * count;
	if (count > OB_PULLS_MAX || !OB_GROW(p->at, room))
		return false;
	p->room = room;
	return true;
}

bool ob_pulls_set(ob_pulls *p, const ob_pull *pull)
{
	const bool ends = pull->kind != OB_PULL_DRAG && ob_norm2(pull->value) == 0;
	uint32_t i = 0;
	while (i < p->count && !is_same(&p->at[i], pull))
		i++;
	if (ends && i < p->count)
		remove_at(p, i);
	if (ends)
		return true;
	if (i == p->count && !reserve(p, p->count + 1))
		return false;
	p->count += i == p->count;
	p->at[i] = *pull;
	return true;
}

void ob_pulls_release(ob_pulls *p, uint32_t id, uint32_t origin)
{
	for (uint32_t i = p->count; i-- > 0;)
		if (p->at[i].origin == origin && (id == UINT32_MAX || p->at[i].id == id))
			remove_at(p, i);
}

static bool is_viewers(const ob_pull *pull)
{
	return pull->origin > 0 && pull->origin < OB_ORIGIN_PROGRAM;
}

void ob_pulls_set_aside(ob_pulls *p)
{
	p->asides = 0;
	if (!p->count || !OB_GROW(p->aside, p->count))
		return;
	for (uint32_t i = 0; i < p->count; i++)
		if (is_viewers(&p->at[i]))
			p->aside[p->asides++] = p->at[i];
}

void ob_pulls_take_up(ob_pulls *p, const ob_universe *u)
{
	ob_error e;
	for (uint32_t i = p->count; i-- > 0;)
		if (is_viewers(&p->at[i]))
			remove_at(p, i);
	for (uint32_t i = 0; i < p->asides; i++) {
		const ob_pull *pull = &p->aside[i];
		const ob_passport *pass = pull->id < ob_universe_ids(u) ? ob_passport_of(u, pull->id) : NULL;
		if (pass && pass->flags & OB_OBJECT_PRESENT && pass->generation == pull->generation &&
		    ob_pull_check(pull, pass, &e))
			ob_pulls_set(p, pull);
	}
	p->asides = 0;
}

void ob_pulls_drop(ob_pulls *p, uint32_t id)
{
	for (uint32_t i = p->count; i-- > 0;)
		if (p->at[i].id == id)
			remove_at(p, i);
}

bool ob_pulls_copy(ob_pulls *to, const ob_pulls *from)
{
	if (!reserve(to, from->count))
		return false;
	if (from->count)
		memcpy(to->at, from->at, from->count * sizeof *to->at);
	to->count = from->count;
	return true;
}

void ob_pulls_finish(ob_pulls *p)
{
	free(p->at);
	free(p->aside);
	*p = (ob_pulls){ 0 };
}

// ---- impulses

typedef struct body {
	const ob_passport *p;
	ob_mat3 frame; // body to world
	ob_state now;
} body;

// Angular velocity that an angular impulse adds.
static ob_vec3 turned_by(const body *b, ob_vec3 twist)
{
	const ob_vec3 l = ob_rotate_back(&b->frame, twist), i = b->p->inertia;
	return ob_rotate(&b->frame, ob_v3(l.x / i.x, l.y / i.y, l.z / i.z));
}

static ob_vec3 spin_of(const body *b)
{
	const ob_vec3 w = ob_rotate_back(&b->frame, b->now.w), i = b->p->inertia;
	return ob_rotate(&b->frame, ob_v3(i.x * w.x, i.y * w.y, i.z * w.z));
}

// Column of K + s 1: velocity of the point by a unit impulse there, and the softness.
static ob_vec3 response(const body *b, ob_vec3 r, ob_vec3 unit, double softness)
{
	const ob_vec3 by_turn = ob_cross(turned_by(b, ob_cross(r, unit)), r);
	return ob_madd(by_turn, 1 / b->p->mass + softness, unit);
}

// x with [a b c] x = y, by Cramer's rule; the matrix is positive definite.
static ob_vec3 solve(ob_vec3 a, ob_vec3 b, ob_vec3 c, ob_vec3 y)
{
	const double d = 1 / ob_dot(a, ob_cross(b, c));
	return ob_v3(d * ob_dot(y, ob_cross(b, c)), d * ob_dot(a, ob_cross(y, c)), d * ob_dot(a, ob_cross(b, y)));
}

static ob_vec3 drag_impulse(const body *b, const ob_pull *pull, ob_vec3 r, double h)
{
	const double w = 2 * M_PI * pull->frequency, k = b->p->mass * w * w, d = 2 * b->p->mass * w,
		     softness = 1 / (h * (d + h * k)), most = 2 * hand_speed / w;
	const ob_vec3 v = ob_add(b->now.v, ob_cross(b->now.w, r)), off = ob_sub(ob_add(b->now.pose.p, r), pull->value);
	const double far = ob_norm(off), part = far > most ? most / far : 1;
	const ob_vec3 wanted = ob_madd(v, h * k * softness * part, off);
	return ob_scale(solve(response(b, r, ob_v3(1, 0, 0), softness), response(b, r, ob_v3(0, 1, 0), softness),
			      response(b, r, ob_v3(0, 0, 1), softness), wanted),
			-1);
}

static void act(const ob_pull *pull, ob_universe *u, double h)
{
	const ob_passport *p = ob_passport_of(u, pull->id);
	if (p->generation != pull->generation || p->flags & OB_OBJECT_PRESCRIBED)
		return; // frozen since
	const ob_state now = ob_state_now(u, pull->id, ob_newest_motion(u, pull->id), ob_step_count(u));
	const body b = { p, ob_quat_matrix(now.pose.q), now };
	const ob_vec3 r = ob_rotate(&b.frame, pull->point);
	ob_vec3 impulse = ob_scale(pull->value, h), twist = { 0 };
	if (pull->kind == OB_PULL_TORQUE)
		twist = impulse, impulse = ob_v3(0, 0, 0);
	else if (pull->kind == OB_PULL_PUSH)
		twist = ob_cross(r, impulse);
	else {
		impulse = drag_impulse(&b, pull, r, h);
		twist = ob_madd(ob_cross(r, impulse), -spin_decay * h / (1 + spin_decay * h), spin_of(&b));
	}
	ob_sim_kick(u, pull->id, impulse, twist);
}

void ob_pulls_act(const ob_pulls *p, ob_universe *u)
{
	const double h = .5 * ob_universe_settings(u)->step_length;
	for (uint32_t i = 0; i < p->count; i++)
		act(&p->at[i], u, h);
}
