#include "solver/surfaces.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "motion/drift.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "solver/relative_speed.h"

static void set_row(double *row, ob_vec3 linear, ob_vec3 angular)
{
	memcpy(row, (double[8]){ linear.x, linear.y, linear.z, angular.x, angular.y, angular.z }, sizeof(ob_body_row));
}

static bool goes(const ob_motion *m)
{
	return m->flags & OB_MOTION_SWINGS || ob_norm2(m->v) > 0 || ob_norm2(m->w) > 0 || ob_norm2(m->a) > 0;
}

bool ob_surface_moves(const ob_passport *p)
{
	return p->flags & OB_OBJECT_KINEMATIC || ob_norm2(p->surface_velocity) > 0;
}

// True if the body spins about an axis of symmetry: that moves its points along its surface, and no surface.
static bool spins_in_place(const ob_body *body, ob_vec3 rate)
{
	const double along = 1e-9; // sine of the angle between spin and axis
	if (ob_shape_is(body->shape, OB_ISOTROPIC))
		return true;
	return ob_shape_is(body->shape, OB_AXIAL) &&
	       ob_norm(ob_cross(ob_column(&body->r, 2), rate)) <= along * ob_norm(rate);
}

// Sets the speed bound as for a dynamic body.
static void set_speed_bound(ob_body *body, const ob_state *now)
{
	const double points = body->radius * ob_norm(now->w);
	body->turning = spins_in_place(body, now->w) ? 0 : points;
	body->speed = ob_norm(now->v) + points;
}

void ob_surface_add(ob_solver *s, uint32_t row, uint32_t pair, const ob_island_object *object)
{
	ob_island_work *w = &s->island;
	ob_surfaces *x = &w->surfaces;
	if (x->count == x->max) {
		x->max = 2 * x->max + 4;
		x->surface = ob_reallocate(x->surface, x->max * sizeof *x->surface);
	}
	ob_surface *surface = &x->surface[x->count++];
	ob_body *body = &w->body[row];
	*surface = (ob_surface){
		.row = row, .pair = pair, .motion = *object->motion, .running = object->passport->surface_velocity
	};
	body->surface = x->count;
	if (!goes(&surface->motion))
		return;
	const double now = x->step_begin;
	const ob_state state = ob_motion_at(&surface->motion, ob_v3(0, 0, 0), now);
	set_row(w->v[row], state.v, state.w);
	body->rolls = spins_in_place(body, state.w) && !ob_shape_is(body->shape, OB_RIMMED);
	body->acceleration = ob_acceleration_at(&surface->motion, now);
	set_speed_bound(body, &state);
}

// Finds the pair's row; surfaces are sorted by pair.
uint32_t ob_surface_row(const ob_island_work *w, uint32_t pair)
{
	const ob_surfaces *x = &w->surfaces;
	uint32_t low = 0, high = x->count;
	while (low < high) {
		const uint32_t middle = (low + high) / 2;
		if (x->surface[middle].pair < pair)
			low = middle + 1;
		else
			high = middle;
	}
	return low < x->count && x->surface[low].pair == pair ? x->surface[low].row : 0;
}

bool ob_surface_swings(const ob_island_work *w, uint32_t row)
{
	const uint32_t at = w->body[row].surface;
	return at && w->surfaces.surface[at - 1].motion.flags & OB_MOTION_SWINGS;
}

bool ob_surfaces_drive(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		const ob_surface *x = &w->surfaces.surface[i];
		if (x->motion.flags & OB_MOTION_SWINGS || ob_norm2(x->motion.w) > 0 || ob_norm2(x->running) > 0)
			return true;
	}
	return false;
}

void ob_surface_note_normal(ob_island_work *w, uint32_t row, ob_vec3 n)
{
	const double end = .7; // cosine of the angle to the axis: with more, the flat end of a cylinder
	ob_body *body = &w->body[row];
	if (body->surface && ob_shape_is(body->shape, OB_RIMMED))
		body->rolls = fabs(ob_dot(n, ob_column(&body->r, 2))) < end &&
			      spins_in_place(body, w->surfaces.surface[body->surface - 1].motion.w);
}

// Returns the rate, rad/s, at which a surface takes along what sticks to it.
static ob_vec3 turn_of(const ob_island_work *w, const ob_surface *x)
{
	return w->body[x->row].rolls ? ob_v3(0, 0, 0) : x->motion.w;
}

static bool turns(const ob_island_work *w, const ob_surface *x)
{
	return ob_norm2(turn_of(w, x)) > 0;
}

static const ob_contact *contact_of(const ob_island_work *w, const ob_surface *x)
{
	return &w->contact[x->contact];
}

static uint32_t carried_row(const ob_island_work *w, const ob_surface *x)
{
	const ob_contact *c = contact_of(w, x);
	return c->a == x->row ? c->b : c->a;
}

static bool touches(const ob_island_work *w, const ob_surface *x)
{
	return contact_of(w, x)->lane != OB_NO_LANE;
}

// Returns the gravity, m/s^2, that a carried body feels. The surface's rotation counts as far as it presses the two
// together: its acceleration along the contact, and away from it, acts by friction alone.
static double pressing(const ob_island_work *w, const ob_surface *x)
{
	const ob_contact *c = contact_of(w, x);
	const uint32_t row = carried_row(w, x), l = c->lane % OB_LANES;
	const ob_body *own = &w->body[x->row], *body = &w->body[row];
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	const ob_vec3 n = ob_batch_vector(b->n, l), turn = turn_of(w, x), arm = ob_sub(body->p, own->p),
		      inward = ob_cross(turn, ob_cross(turn, arm));
	return ob_norm(ob_sub(body->acceleration, own->acceleration)) +
	       ob_max(0, (c->a == row ? 1 : -1) * ob_dot(n, inward));
}

void ob_surfaces_begin(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_surfaces *x = &w->surfaces;
	for (uint32_t i = 0; x->count && i < w->contacts; i++)
		for (int side = 0; side < 2; side++) {
			const uint32_t at = w->body[side ? w->contact[i].b : w->contact[i].a].surface;
			if (at)
				x->surface[at - 1].contact = i;
		}
	for (uint32_t i = 0; i < x->count; i++)
		if (touches(w, &x->surface[i]))
			w->max_acceleration = ob_max(w->max_acceleration, pressing(w, &x->surface[i]));
}

static const double unnoticed_share = 1e-9; // share of gravity: a smaller acceleration along the contact counts as none
static const double sliding_share = .999; // share of its bound: a smaller friction impulse holds

// Returns the time, s, until the slip at the surface's contact is 0, where friction then reverses.
static double reversal(const ob_island_work *w, const ob_surface *x)
{
	const ob_contact *c = contact_of(w, x);
	const uint32_t row = carried_row(w, x), l = c->lane % OB_LANES;
	const ob_body *own = &w->body[x->row], *body = &w->body[row];
	if (c->lane == OB_NO_LANE || !(c->mu * ob_contact_load_of(w, contact_of(w, x)) > 0))
		return INFINITY;
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	const double bound = sliding_share * c->mu * ob_contact_load_of(w, contact_of(w, x)),
		     f[2] = { b->impulse[4][l], b->impulse[5][l] }, sign = c->a == row ? 1 : -1;
	const ob_vec3 t[2] = { { b->t1[0][l], b->t1[1][l], b->t1[2][l] }, { b->t2[0][l], b->t2[1][l], b->t2[2][l] } };
	if (f[0] * f[0] + f[1] * f[1] < bound * bound)
		return INFINITY;
	const double *va = w->v[c->a], *vb = w->v[c->b];
	double slip[2] = { 0, 0 };
	for (int i = 0; i < 3; i++) {
		slip[0] += b->t1[i][l] * (va[i] - vb[i]) + b->fa1[i][l] * va[3 + i] - b->fb1[i][l] * vb[3 + i];
		slip[1] += b->t2[i][l] * (va[i] - vb[i]) + b->fa2[i][l] * va[3 + i] - b->fb2[i][l] * vb[3 + i];
	}
	const ob_vec3 turn = turn_of(w, x), arm = ob_sub(body->p, own->p),
		      carried = ob_add(own->acceleration, ob_cross(turn, ob_cross(turn, arm)));
	const ob_vec3 outer = ob_sub(body->acceleration, carried);
	double s[2], a[2], both = 0, square = 0, along = 0;
	for (int k = 0; k < 2; k++) {
		s[k] = slip[k] - sign * ob_dot(t[k], x->now);
		a[k] = sign * ob_dot(t[k], outer) + body->inv_mass / w->h * f[k];
		both += s[k] * a[k];
		along += fabs(ob_dot(t[k], carried));
		square += a[k] * a[k];
	}
	return along > unnoticed_share * w->max_acceleration && both < 0 ? -both / square : INFINITY;
}

double ob_surfaces_reversal(const ob_solver *s, double h)
{
	const ob_island_work *w = &s->island;
	double first = INFINITY;
	for (uint32_t i = 0; i < w->surfaces.count; i++)
		if (ob_norm2(w->body[w->surfaces.surface[i].row].acceleration) > 0)
			first = ob_min(first, reversal(w, &w->surfaces.surface[i]));
	return first < h ? first : INFINITY;
}

void ob_surfaces_renew_contacts(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		const ob_surface *surface = &w->surfaces.surface[i];
		if (turns(w, surface) && touches(w, surface))
			w->contact[surface->contact].limit = -INFINITY;
	}
}

// Returns the surface's state in the island's frame; since: s, from the step's start.
static ob_state state_at(const ob_island_work *w, const ob_surface *x, const ob_body *body, double since)
{
	if (!goes(&x->motion))
		return (ob_state){ { body->p, body->q }, { 0, 0, 0 }, { 0, 0, 0 } };
	ob_state at = ob_motion_at(&x->motion, ob_v3(0, 0, 0), w->surfaces.step_begin + since);
	at.pose.p = ob_madd(at.pose.p, -.5 * since * since, w->frame);
	at.v = ob_madd(at.v, -since, w->frame);
	return at;
}

ob_state ob_surface_state(const ob_island_work *w, uint32_t row, double t)
{
	const ob_body *body = &w->body[row];
	return state_at(w, &w->surfaces.surface[body->surface - 1], body, w->time + t);
}

double ob_surface_bend(const ob_island_work *w, uint32_t row)
{
	const ob_surface *x = &w->surfaces.surface[w->body[row].surface - 1];
	if (!(x->motion.flags & OB_MOTION_SWINGS))
		return 0;
	const ob_vec3 by_rule = ob_scale(ob_add(x->begin.v, x->end.v), .5 * w->h);
	return ob_norm(ob_sub(ob_sub(x->end.pose.p, x->begin.pose.p), by_rule));
}

// Moves a point of the body in one pose to its place in another.
static ob_vec3 carried_to(const ob_pose *from, const ob_pose *to, ob_vec3 at)
{
	const ob_mat3 r = ob_quat_matrix(from->q), q = ob_quat_matrix(to->q);
	return ob_add(to->p, ob_rotate(&q, ob_rotate_back(&r, ob_sub(at, from->p))));
}

static ob_vec3 velocity_of(const ob_state *x, ob_vec3 at)
{
	return ob_add(x->v, ob_cross(x->w, ob_sub(at, x->pose.p)));
}

// Returns the running surface's velocity, world, in the plane of the contact.
static ob_vec3 running_velocity(const ob_island_work *w, const ob_surface *x)
{
	const ob_contact *c = contact_of(w, x);
	if (ob_norm2(x->running) == 0 || c->lane == OB_NO_LANE)
		return ob_v3(0, 0, 0);
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	const uint32_t l = c->lane % OB_LANES;
	const ob_vec3 n = ob_batch_vector(b->n, l), v = ob_rotate(&w->body[x->row].r, x->running);
	return ob_madd(v, -ob_dot(v, n), n);
}

void ob_surfaces_warm_start(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		ob_surface *x = &w->surfaces.surface[i];
		const ob_body *own = &w->body[x->row], *body = &w->body[carried_row(w, x)];
		const double *v = w->v[carried_row(w, x)];
		x->begin = state_at(w, x, own, w->time);
		x->end = state_at(w, x, own, w->time + w->h);
		ob_vec3 target = x->end.v;
		if (turns(w, x)) {
			const ob_vec3 at =
				body->halved ? body->start_p : ob_add(body->p, ob_row_linear(w->d[carried_row(w, x)]));
			const ob_vec3 slip = ob_sub(ob_row_linear(v), velocity_of(&x->begin, at));
			const ob_vec3 then = ob_madd(carried_to(&x->begin.pose, &x->end.pose, at), w->h, slip);
			target = ob_sub(velocity_of(&x->end, then), ob_cross(x->end.w, ob_sub(at, x->begin.pose.p)));
		}
		x->now = running_velocity(w, x);
		set_row(w->v[x->row], x->begin.v, x->begin.w);
		set_row(w->dv[x->row], ob_sub(target, x->begin.v), ob_sub(x->end.w, x->begin.w));
	}
}

void ob_surfaces_predict_velocities(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		const ob_surface *x = &w->surfaces.surface[i];
		const double *dv = w->dv[x->row];
		set_row(w->v[x->row], ob_add(x->begin.v, x->now), x->begin.w);
		for (int c = 0; c < 6; c++)
			w->u[x->row][c] = w->v[x->row][c] + dv[c];
	}
}

void ob_surfaces_set_drift(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		const ob_surface *x = &w->surfaces.surface[i];
		set_row(w->drift[x->row], ob_sub(x->end.v, x->begin.v), ob_sub(x->end.w, x->begin.w));
	}
}

ob_vec3 ob_surface_velocity(const ob_island_work *w, uint32_t row)
{
	const uint32_t at = w->body[row].surface;
	return at ? w->surfaces.surface[at - 1].now : ob_v3(0, 0, 0);
}

// Returns the motion that takes along what sticks to the surface.
static ob_state without_roll(const ob_island_work *w, const ob_surface *x, const ob_state *state)
{
	const bool rolls = w->body[x->row].rolls;
	return (ob_state){ .pose = { state->pose.p, rolls ? x->begin.pose.q : state->pose.q },
			   .v = state->v,
			   .w = rolls ? ob_v3(0, 0, 0) : state->w };
}

void ob_surfaces_carry(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->surfaces.count; i++)
		w->body[carried_row(w, &w->surfaces.surface[i])].carried = 0;
	for (uint32_t i = 0; i < w->surfaces.count; i++)
		w->body[carried_row(w, &w->surfaces.surface[i])].carried +=
			ob_contact_load_of(w, contact_of(w, &w->surfaces.surface[i]));
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		const ob_surface *x = &w->surfaces.surface[i];
		const uint32_t row = carried_row(w, x);
		const ob_body *body = &w->body[row];
		const double load = ob_contact_load_of(w, contact_of(w, x));
		if (!(load > 0) || body->halved || !(turns(w, x) || x->motion.flags & OB_MOTION_SWINGS))
			continue;
		const ob_state begin = without_roll(w, x, &x->begin), end = without_roll(w, x, &x->end);
		const ob_vec3 at = ob_add(body->p, ob_row_linear(w->d[row])),
			      then = carried_to(&begin.pose, &end.pose, at);
		const ob_vec3 by_rule = ob_scale(ob_add(velocity_of(&begin, at), velocity_of(&end, then)), .5 * w->h);
		const ob_vec3 rest = ob_scale(ob_sub(ob_sub(then, at), by_rule), load / body->carried);
		w->d[row][0] += rest.x, w->d[row][1] += rest.y, w->d[row][2] += rest.z;
	}
}

void ob_surface_halve(ob_solver *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	const ob_surface *x = &w->surfaces.surface[body->surface - 1];
	body->start_p = body->p;
	body->start_q = body->q;
	body->start_w = x->begin.w;
	body->halved = true;
	const ob_vec3 way = ob_scale(x->begin.v, .5 * w->h); // as halved bodies move: at the velocity at the start
	set_row(body->first_half, way, ob_v3(0, 0, 0));
	body->p = ob_add(body->p, way);
}

void ob_surfaces_undo_halves(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->surfaces.count; i++) {
		ob_body *body = &w->body[w->surfaces.surface[i].row];
		if (body->halved)
			body->p = body->start_p;
		body->halved = false;
	}
}

bool ob_surface_advance(ob_solver *s, uint32_t row, ob_pose *end)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	if (!body->surface)
		return false;
	const ob_surface *x = &w->surfaces.surface[body->surface - 1];
	const ob_vec3 from = body->halved ? body->start_p : body->p;
	*end = x->end.pose;
	set_row(w->v[row], x->end.v, x->end.w);
	if (!goes(&x->motion))
		return false;
	set_row(w->d[row], ob_sub(end->p, from), ob_small_turn(body->q, end->q));
	body->acceleration = ob_sub(ob_acceleration_at(&x->motion, w->surfaces.step_begin + w->time + w->h), w->frame);
	set_speed_bound(body, &x->end);
	body->path += (double)x->motion.reach * w->h / s->settings->step_length;
	return true;
}

bool ob_surfaces_carry_any(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->surfaces.count; i++)
		if (goes(&w->surfaces.surface[i].motion) && touches(w, &w->surfaces.surface[i]))
			return true;
	return false;
}

void ob_surfaces_finish(ob_surfaces *x)
{
	free(x->surface);
}
