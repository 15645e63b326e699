// Objects are created, changed and removed by the host, while the universe is paused.
#include <string.h>

#include "contact/batch.h"
#include "motion/flight.h"
#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "shape/shape.h"
#include "solver/solver.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/publish.h"
#include "step/pairs.h"
#include "step/sim.h"
#include "table/home.h"
#include "table/trace.h"

// Enters a changed schedule record in the calendar, and schedules checks of the object's pairs.
static void note_change(ob_universe *u, uint32_t id)
{
	ob_calendar_enter_due(u, id);
	ob_pairs_look(u, id);
}

// Ends all flights, as they have no impact computed on a new plane: all are solved in the next step.
static void end_flights(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (data->schedule[id].state != OB_SCHEDULE_AWAKE)
			continue;
		ob_motion m = *ob_newest_motion(u, id);
		m.flags &= ~(uint32_t)OB_MOTION_FREE;
		ob_publish_motion(u, id, &m);
		data->schedule[id].due = (uint32_t)ob_step_count(u);
		note_change(u, id);
	}
}

void ob_sim_place(ob_universe *u, uint32_t id, const ob_state *state)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_run_settings *run = ob_universe_settings(u);
	const ob_passport *p = ob_passport_of(u, id);
	const bool fixed = p->flags & OB_OBJECT_STATIC, prescribed = p->flags & OB_OBJECT_PRESCRIBED;
	ob_motion m = { .t0 = ob_step_count(u) * run->step_length,
			.valid_until = prescribed ? INFINITY : (double)ob_step_count(u) * run->step_length,
			.p = state->pose.p,
			.q = ob_quat_normalize(state->pose.q),
			.v = state->v,
			.w = state->w,
			.step = (uint32_t)ob_step_count(u),
			.island = id };
	if (fixed)
		m.v = m.w = ob_v3(0, 0, 0);
	else
		m.a = ob_external_acceleration(run, p), m.flags = OB_MOTION_FREE;
	double reach = fixed ? 0 : ob_step_reach(run, p, m.q, m.v, m.w);
	ob_fat_aabb_renew(u, id, &(ob_state){ { m.p, m.q }, m.v, m.w }, reach);
	uint32_t kind = !prescribed                           ? OB_SCHEDULE_AWAKE
			: !fixed                              ? OB_SCHEDULE_KINEMATIC
			: ob_shape_is(p->shape, OB_UNBOUNDED) ? OB_SCHEDULE_PLANE
							      : OB_SCHEDULE_STATIC;
	data->schedule[id] = (ob_schedule){ 0, (float)reach, kind, m.step, prescribed ? UINT32_MAX : m.step };
	data->result_island[id] = UINT32_MAX;
	note_change(u, id);
	ob_publish_motion(u, id, &m);
	if (kind == OB_SCHEDULE_PLANE)
		end_flights(u);
	if (ob_universe_traced(u))
		ob_trace_birth(u, id);
}

// ---- kinematic objects

// Bounds the speed, m/s, of any point of the object, from now until the motion ends.
static double prescribed_speed(const ob_passport *p, const ob_motion *m, double now)
{
	double speed = ob_norm(ob_velocity_at(m, now));
	if (m->flags & OB_MOTION_SWINGS)
		speed = sqrt(ob_norm2(m->v) + ob_norm2(m->a) / (m->frequency * m->frequency));
	else if (ob_norm2(m->a) > 0)
		speed = ob_max(speed, ob_norm(ob_velocity_at(m, m->valid_until)));
	return speed + (ob_shape_is(p->shape, OB_ISOTROPIC) ? 0 : ob_norm(m->w) * ob_shape_radius(p->shape, p->size));
}

// Makes the fat AABB hold the object for so long (s) from now on; infinity: for good.
static void hold_for(ob_universe *u, uint32_t id, const ob_motion *m, double now, double s)
{
	const ob_passport *p = ob_passport_of(u, id);
	ob_motion rest = *m;
	double box[6];
	if (!(m->flags & OB_MOTION_SWINGS)) {
		rest.p = ob_centre_at(m, now), rest.v = ob_velocity_at(m, now);
		rest.t0 = now;
	}
	if (ob_norm2(m->w) > 0)
		rest.q = ob_motion_at(m, p->inertia, now).pose.q;
	ob_motion_swept_bounds(&rest, (ob_shape)p->shape, p->size, s, box);
	ob_fat_aabb_set(u, id, box, ob_fat_aabb_margin(ob_universe_settings(u), (ob_shape)p->shape, p->size));
}

// Returns the number of steps after which the fat AABB of an object at this speed (m/s) is made anew: it covers some
// radii.
static uint64_t steps_held(const ob_universe *u, const ob_passport *p, double speed)
{
	enum { LEAST = 4, MOST = 512 };
	const double radii = 4, n = radii * ob_shape_radius((ob_shape)p->shape, p->size) /
				    (speed * ob_universe_settings(u)->step_length);
	return n < LEAST ? LEAST : n > MOST ? MOST : (uint64_t)n;
}

static void publish_prescribed(ob_universe *u, uint32_t id, ob_motion *m, double until)
{
	const ob_run_settings *run = ob_universe_settings(u);
	const ob_passport *p = ob_passport_of(u, id);
	ob_schedule *schedule = &ob_universe_step_data(u)->schedule[id];
	const uint32_t step = (uint32_t)ob_step_count(u);
	const double now = (double)step * run->step_length;
	m->path = ob_schedule_path(schedule, step);
	m->reach = (float)(prescribed_speed(p, m, now) * run->step_length);
	m->reach = nextafterf(m->reach, INFINITY);
	m->step = step;
	m->flags |= OB_MOTION_FREE;
	*schedule = (ob_schedule){ m->path, m->reach, OB_SCHEDULE_KINEMATIC, step, UINT32_MAX };
	note_change(u, id);
	hold_for(u, id, m, now, until - now);
	ob_publish_motion(u, id, m);
}

// True if the motion is that piece, between these instants (s): nothing is to be published.
static bool is_piece(const ob_motion *m, const ob_path_piece *piece, double begin, double end)
{
	return m->t0 == begin && m->valid_until == end && !(m->flags & OB_MOTION_SWINGS) && ob_equal(m->p, piece->p) &&
	       ob_equal(m->v, piece->v) && ob_equal(m->a, piece->a);
}

static uint64_t prescribe_spline(ob_universe *u, uint32_t id, const ob_path *path, uint64_t born)
{
	const double h = ob_universe_settings(u)->step_length;
	const uint64_t step = ob_step_count(u);
	const ob_path_piece piece = ob_path_piece_at(path, h, step - born);
	const uint64_t from = born + piece.from, until = piece.until == UINT64_MAX ? UINT64_MAX : born + piece.until;
	const double begin = (double)from * h, end = until == UINT64_MAX ? INFINITY : (double)until * h;
	ob_motion m = *ob_newest_motion(u, id);
	if (is_piece(&m, &piece, begin, end) && (!path->turns || ob_equal(m.w, piece.w)))
		return until;
	if (m.flags & OB_MOTION_SWINGS) { // an earlier path
		m.flags &= ~(uint32_t)OB_MOTION_SWINGS;
		m.rest_time = 0, m.island = id;
	}
	const ob_state turned = ob_motion_at(&m, ob_v3(0, 0, 0), begin);
	m.t0 = begin, m.valid_until = end;
	m.p = piece.p, m.v = piece.v, m.a = piece.a;
	m.q = path->turns ? piece.q : turned.pose.q;
	m.w = path->turns ? piece.w : m.w;
	publish_prescribed(u, id, &m, end);
	return until;
}

uint64_t ob_sim_prescribe(ob_universe *u, uint32_t id, const ob_path *path, uint64_t born)
{
	const ob_passport *p = ob_passport_of(u, id);
	const uint64_t step = ob_step_count(u);
	const double h = ob_universe_settings(u)->step_length, now = (double)step * h;
	ob_motion m = *ob_newest_motion(u, id);
	if (path && path->points)
		return prescribe_spline(u, id, path, born);
	if (path && !(m.flags & OB_MOTION_SWINGS)) {
		m.flags |= OB_MOTION_SWINGS;
		m.a = path->a, m.frequency = path->frequency;
		publish_prescribed(u, id, &m, INFINITY);
	}
	if (m.flags & OB_MOTION_SWINGS)
		return UINT64_MAX;
	const double speed = ob_norm(m.v);
	const uint64_t held = speed > 0 ? steps_held(u, p, speed) : UINT64_MAX;
	if (step == m.step) {
		m.rest_time = 0, m.island = id;
		publish_prescribed(u, id, &m, speed > 0 ? now + (double)held * h : INFINITY);
	} else if (speed > 0 && (step - m.step) % held == 0) {
		hold_for(u, id, &m, now, (double)held * h);
	}
	return speed > 0 ? step + held - (step - m.step) % held : UINT64_MAX;
}

// Rebuilds the index and lists. Objects with a pending query are put into the index when that is made.
void ob_sim_restore(ob_universe *u)
{
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (ob_universe_step_data(u)->schedule[id].state == OB_SCHEDULE_ABSENT)
			continue;
		if (!ob_broadphase_query_pending(u, id))
			ob_index_put(u, id);
		if (ob_universe_traced(u))
			ob_trace_birth(u, id);
	}
	ob_pairs_link(u);
}

static void wake_object(ob_universe *u, uint32_t id)
{
	const ob_passport *pass = ob_passport_of(u, id);
	ob_motion m = *ob_newest_motion(u, id);
	uint32_t flags = m.flags;
	m.flags &= ~(uint32_t)(OB_MOTION_RESTS | OB_MOTION_STEADY);
	m.rest_time = 0;
	ob_publish_motion(u, id, &m);
	if (ob_universe_traced(u))
		ob_trace_moves(u, ob_trace_host(u), id, flags, m.flags);
	ob_schedule *schedule = &ob_universe_step_data(u)->schedule[id];
	uint32_t steps = (uint32_t)ob_step_count(u);
	double reach = ob_step_reach(ob_universe_settings(u), pass, m.q, m.v, m.w);
	*schedule = (ob_schedule){ ob_schedule_path(schedule, steps), (float)reach, OB_SCHEDULE_AWAKE, steps, steps };
	note_change(u, id);
}

bool ob_sim_wake_joined(ob_universe *u, const ob_joint_passport *j)
{
	bool any = false;
	for (int side = 0; side < 2; side++) {
		const uint32_t id = j->object[side];
		if (id >= ob_universe_step_data(u)->objects_max ||
		    ob_universe_step_data(u)->schedule[id].state < OB_SCHEDULE_ASLEEP)
			continue;
		wake_object(u, id);
		any = true;
	}
	return any;
}

// Takes an object out of all that simulators share, but for its passport and its motion, which readers go on to see.
static void take_out(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		uint32_t other = k->a == id ? k->b : k->a;
		if ((k->a != id && k->b != id) || !k->active || other >= data->objects_max ||
		    !ob_schedule_is_dynamic(&data->schedule[other]))
			continue;
		wake_object(u, other);
	}
	for (uint32_t j = ob_joint_first(data, id); j; j = ob_joint_next(data, j, id))
		(void)ob_sim_wake_joined(u, &data->joint[j - 1]);
	ob_pairs_drop(u, id);
	ob_broadphase_remove(u, id);
	data->schedule[id] = (ob_schedule){ .state = OB_SCHEDULE_ABSENT };
	note_change(u, id);
	if (ob_universe_traced(u))
		ob_trace_death(u, id, ob_newest_motion(u, id)->flags);
	ob_pin_drop(u, id);
}

void ob_sim_take_in(ob_universe *u, const ob_taken_object *o)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t id = o->id;
	data->schedule[id] = o->schedule;
	data->result_island[id] = UINT32_MAX;
	memcpy(data->bounds[id], o->bounds, sizeof data->bounds[id]);
	ob_publish_motion(u, id, &o->before);
	if (memcmp(&o->before, &o->motion, sizeof o->motion) != 0)
		ob_publish_motion(u, id, &o->motion);
	ob_calendar_enter_due(u, id);
	data->count->checked = UINT32_MAX; // its pairs may be due for a check
	if (o->neighbours == UINT32_MAX) {
		ob_pairs_requery(u, id);
		return;
	}
	data->neighbours[id].count = o->neighbours;
	ob_index_put(u, id);
}

void ob_sim_hand_out(ob_universe *u, uint32_t id)
{
	ob_pairs_drop_listed(u, id);
	ob_broadphase_remove(u, id);
	ob_universe_step_data(u)->schedule[id] = (ob_schedule){ .state = OB_SCHEDULE_ABSENT };
	ob_calendar_enter_due(u, id);
}

static void replace(ob_universe *u, uint32_t id, const ob_passport *p, const ob_state *state)
{
	take_out(u, id);
	ob_write_passport(u, id, p);
	ob_sim_place(u, id, state);
}

void ob_sim_place_anew(ob_universe *u, uint32_t id, const ob_state *state)
{
	const ob_passport p = *ob_passport_of(u, id);
	replace(u, id, &p, state);
}

bool ob_sim_freeze(ob_universe *u, uint32_t id)
{
	ob_passport p = *ob_passport_of(u, id);
	if (!(p.flags & OB_OBJECT_PRESENT) || p.flags & OB_OBJECT_PRESCRIBED)
		return false;
	const ob_state now = ob_state_now(u, id, ob_newest_motion(u, id), ob_step_count(u));
	p.flags |= OB_OBJECT_STATIC | OB_OBJECT_FROZEN;
	p.mass = 0;
	p.surface_velocity = ob_v3(0, 0, 0); // it shares the force's memory
	p.inertia = ob_v3(0, 0, 0);
	replace(u, id, &p, &now);
	return true;
}

// Lists the members of all islands that were given up.
static uint32_t list_given_up(const ob_universe *u, uint32_t *ids, uint32_t most)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t n = 0;
	for (uint32_t id = 0; id < ob_universe_ids(u) && n < most; id++)
		if (data->effort[id] == OB_EFFORT_GIVEN_UP)
			ids[n++] = id;
	return n;
}

uint32_t ob_sim_failed_objects(const ob_universe *u, uint32_t object, uint32_t *ids, uint32_t most)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (object >= data->objects_max)
		return 0;
	const ob_step_failure why = ob_step_failed(u, NULL);
	if (why == OB_STEP_PAIRS_FULL || why == OB_STEP_NEIGHBOURS_FULL)
		return ob_crowd(u, ids, most);
	const bool worked = why == OB_STEP_OVERWORKED || why == OB_STEP_SURFACES_FULL;
	const uint32_t given_up = worked ? list_given_up(u, ids, most) : 0;
	if (given_up)
		return given_up;
	const uint32_t place = data->result_island[object];
	const bool solved = ob_gate_phase(u) == OB_PHASE_ISLANDS || worked;
	const ob_island *is = solved && place < data->objects_max ? &data->island[place] : NULL;
	if (!is || is->members > data->objects_max || is->first_member > data->objects_max - is->members) {
		ids[0] = object;
		return 1;
	}
	for (uint32_t i = 0; i < is->members && i < most; i++)
		ids[i] = data->member[is->first_member + i];
	return is->members;
}

void ob_sim_push(ob_universe *u, uint32_t id, ob_vec3 force, bool changes)
{
	ob_passport p = *ob_passport_of(u, id);
	ob_schedule *schedule = &ob_universe_step_data(u)->schedule[id];
	if (p.flags & OB_OBJECT_PRESCRIBED)
		return;
	if (p.force.x != force.x || p.force.y != force.y || p.force.z != force.z) {
		p.force = force;
		ob_write_passport(u, id, &p);
	}
	if (!changes)
		return;
	if (schedule->state == OB_SCHEDULE_ASLEEP || schedule->state == OB_SCHEDULE_EQUILIBRIUM)
		wake_object(u, id);
	if (schedule->state == OB_SCHEDULE_AWAKE) {
		schedule->due = (uint32_t)ob_step_count(u); // ends a flight that was computed ahead
		note_change(u, id);
	}
}

void ob_sim_remove(ob_universe *u, uint32_t id)
{
	take_out(u, id);
	ob_passport none = *ob_passport_of(u, id);
	none.flags = 0;
	ob_write_passport(u, id, &none);
}
