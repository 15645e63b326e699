#include "exchange/results.h"

#include <string.h>

#include "exchange/committer.h"
#include "schedule/calendar.h"

static bool is_sane(ob_vec3 v)
{
	const double most = 1e15;
	return fabs(v.x) < most && fabs(v.y) < most && fabs(v.z) < most; // false for NaN
}

bool ob_state_is_sane(const ob_state *s)
{
	const ob_quat q = s->pose.q;
	const double norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
	return is_sane(s->pose.p) && is_sane(s->v) && is_sane(s->w) && norm2 > .5 && norm2 < 2;
}

// ---- in place

bool ob_is_left_in_result(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	return ob_universe_settings(u)->one_per_object && !ob_universe_contains(u) &&
	       data->member[data->island[data->result_island[id]].first_member] != id;
}

void ob_write_result(ob_universe *u, const ob_found_result *r)
{
	const ob_motion *m = &r->motion;
	ob_step_data *data = ob_universe_step_data(u);
	data->schedule[r->id] = (ob_schedule){ m->path, m->reach, r->state, m->step, r->due };
	ob_calendar_enter_due(u, r->id);
	if (ob_is_left_in_result(u, r->id))
		data->result[r->id] = *m;
	else
		ob_stage_motion(u, r->id, m);
}

void ob_write_bounds(ob_universe *u, uint32_t id, const float box[6])
{
	ob_step_data *data = ob_universe_step_data(u);
	memcpy(data->bounds[id], box, sizeof data->bounds[id]);
	ob_pairs_requery(u, id);
}

void ob_write_effort(ob_universe *u, uint32_t island, uint32_t share)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_island *is = &data->island[island];
	for (uint32_t i = 0; i < is->members; i++)
		data->effort[data->member[is->first_member + i]] = share;
}

uint32_t ob_write_contact_key(ob_universe *u, const ob_found_contact *c)
{
	ob_pair_key *k = &ob_universe_step_data(u)->pair[c->pair];
	k->limit = c->limit;
	k->active = c->active;
	if (!c->kept)
		return OB_NO_RECORD;
	if (k->record == OB_NO_RECORD)
		k->record = ob_record_take(u); // OB_NO_RECORD if memory is full; then the step has failed
	return k->record;
}

int ob_write_contact_state(ob_universe *u, const ob_found_contact *c, uint32_t record)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_pair_record *to = &data->record[record];
	ob_pair_state *p = ob_pair_write(to, ob_step_count(u));
	const int version = (int)(p - to->version);
	*p = c->state;
	if (c->two_sided)
		memcpy(data->impulse_b[record][version], c->impulse_b, sizeof c->impulse_b);
	return version;
}

// The scripts of its objects look for it before the next step.
static void note_break(ob_universe *u, const ob_joint_passport *j)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (int side = 0; data->script_of && side < 2; side++) {
		const uint32_t id = j->object[side], cell = id < data->objects_max ? data->script_of[id] : 0;
		if (cell)
			data->script_turn[cell - 1].flags |= OB_SCRIPT_BROKE;
	}
}

void ob_write_joint(ob_universe *u, const ob_found_joint *j)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_joint_state *to = &data->joint_state[j->joint];
	const uint32_t step = (uint32_t)ob_step_count(u) + 1, version = step % 2;
	to->version[version].force = j->force;
	to->version[version].torque = j->torque;
	to->version[version].along = j->along;
	to->stamp[version] = step;
	to->broke = j->broke ? step : 0;
	if (j->broke)
		note_break(u, &data->joint[j->joint]);
}

void ob_write_touch(ob_universe *u, const ob_touch_record *r)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t cell = data->script_of[r->id] - 1;
	ob_script_turn *turn = &data->script_turn[cell];
	ob_script_cell *c = &data->script_cell[cell];
	uint32_t i = 0;
	if (r->other == OB_NO_OBJECT) {
		turn->flags &= ~(uint32_t)OB_SCRIPT_TOUCHED;
		c->touches = 0;
		return;
	}
	turn->flags |= OB_SCRIPT_TOUCHED;
	while (i < c->touches && c->touch[i].other != r->other)
		i++;
	if (i == OB_SCRIPT_TOUCHES)
		return;
	if (i == c->touches)
		c->touch[c->touches++] = (ob_script_touch){ .other = r->other,
							    .generation = ob_passport_of(u, r->other)->generation,
							    .point = r->point };
	c->touch[i].impulse += r->impulse;
}

// Writes the cell as the run of its script has left it.
void ob_write_script(ob_universe *u, const ob_script_record *r)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_script_turn *turn = &data->script_turn[r->cell];
	ob_script_cell *c = &data->script_cell[r->cell];
	turn->flags = r->flags;
	turn->wake = r->wake;
	memcpy(c->random, r->random, sizeof c->random);
	c->force = r->force, c->next_torque = r->next_torque, c->push = r->push, c->twist = r->twist;
	memcpy(c->colour, r->colour, sizeof c->colour);
	c->asks = r->asks;
	c->state_bytes = r->state_bytes;
	memcpy(c->state, r->state, r->state_bytes);
	c->outbox_bytes = r->outbox_bytes;
	c->failed_step = r->failed_step;
	memcpy(c->error, r->error, sizeof c->error);
	c->inbox_bytes = c->touches = 0;
}

void ob_write_check(ob_universe *u, const ob_check_record *c)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_pair_key *k = &data->pair[c->pair];
	k->expected = c->expected;
	k->late = c->late;
	k->limit = c->limit;
	k->clear_until = c->clear_until;
	k->clear_as_of = c->clear_as_of;
}

uint32_t *ob_reserve_changes(ob_universe *u, uint32_t id, uint32_t neighbours, uint32_t total)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t offset = ob_neighbours_reserve(u, id, 1 + total);
	const bool full = offset == UINT32_MAX;
	data->neighbours[id] = (struct ob_neighbours){ full ? 0 : offset, full ? 0 : neighbours };
	if (full)
		return NULL;
	data->neighbour_id[offset] = total;
	return data->neighbour_id + offset + 1;
}

// ---- by the worker that found the result

// Hands over a record, if this simulator is contained. false: it can write the universe itself.
static bool hand_over(ob_universe *u, ob_record_kind kind, const void *record, size_t bytes)
{
	if (!ob_universe_contained(u))
		return false;
	ob_outbox_put(u, kind, record, bytes, NULL, 0);
	return true;
}

static void hand_over_result(ob_universe *u, const ob_found_result *r)
{
	const char *motion = (const char *)&r->motion;
	ob_steady_record steady = { r->id, r->state, r->due, 0, { 0 } };
	if (memcmp(&r->motion.a, &ob_newest_motion(u, r->id)->a, sizeof r->motion.a) != 0) {
		ob_outbox_put(u, OB_RECORD_RESULT, r, sizeof *r, NULL, 0);
		return;
	}
	memcpy(steady.motion, motion, OB_MOTION_ACCELERATION);
	memcpy(steady.motion + OB_MOTION_ACCELERATION, motion + OB_MOTION_BEHIND_IT,
	       sizeof r->motion - OB_MOTION_BEHIND_IT);
	ob_outbox_put(u, OB_RECORD_RESULT, &steady, sizeof steady, NULL, 0);
}

void ob_commit_result(ob_universe *u, const ob_found_result *r)
{
	if (ob_universe_contained(u))
		hand_over_result(u, r);
	else
		ob_write_result(u, r);
}

void ob_commit_bounds(ob_universe *u, uint32_t id, const float box[6])
{
	ob_bounds_record r = { .id = id };
	memcpy(r.box, box, sizeof r.box);
	if (!hand_over(u, OB_RECORD_BOUNDS, &r, sizeof r))
		ob_write_bounds(u, id, box);
}

void ob_commit_effort(ob_universe *u, uint32_t island, uint32_t share)
{
	const ob_effort_record r = { island, share };
	if (!hand_over(u, OB_RECORD_EFFORT, &r, sizeof r))
		ob_write_effort(u, island, r.share);
}

size_t ob_contact_bytes(const ob_found_contact *c)
{
	return !c->kept       ? offsetof(ob_found_contact, state)
	       : c->two_sided ? sizeof *c
			      : offsetof(ob_found_contact, impulse_b);
}

void ob_commit_contact(ob_universe *u, const ob_found_contact *c)
{
	if (hand_over(u, OB_RECORD_CONTACT, c, ob_contact_bytes(c)))
		return;
	const uint32_t record = ob_write_contact_key(u, c);
	if (record != OB_NO_RECORD)
		ob_write_contact_state(u, c, record);
}

void ob_commit_joint(ob_universe *u, const ob_found_joint *j)
{
	if (!hand_over(u, OB_RECORD_JOINT, j, sizeof *j))
		ob_write_joint(u, j);
}

void ob_commit_touch(ob_universe *u, uint32_t id, uint32_t other, double impulse, ob_vec3 point)
{
	const ob_touch_record r = { id, other, impulse, point };
	if (!hand_over(u, OB_RECORD_TOUCH, &r, sizeof r))
		ob_write_touch(u, &r);
}

void ob_hand_over_script(ob_universe *u, uint32_t cell, const ob_script_turn *turn, const ob_script_cell *c)
{
	ob_script_record r = { .cell = cell,
			       .flags = turn->flags,
			       .wake = turn->wake,
			       .asks = c->asks,
			       .state_bytes = c->state_bytes,
			       .outbox_bytes = c->outbox_bytes,
			       .failed_step = c->failed_step,
			       .force = c->force,
			       .next_torque = c->next_torque,
			       .push = c->push,
			       .twist = c->twist };
	memcpy(r.random, c->random, sizeof r.random);
	memcpy(r.colour, c->colour, sizeof r.colour);
	memcpy(r.error, c->error, sizeof r.error);
	ob_outbox_put(u, OB_RECORD_SCRIPT, &r, sizeof r, c->state, ob_in_words(c->state_bytes));
	for (uint32_t first = 0; first < c->outbox_bytes; first += OB_POSTS_AT_ONCE) {
		const uint32_t left = c->outbox_bytes - first, n = left < OB_POSTS_AT_ONCE ? left : OB_POSTS_AT_ONCE;
		const ob_posts_record part = { cell, first, n, 0 };
		ob_outbox_put(u, OB_RECORD_POSTS, &part, sizeof part, c->outbox + first, n);
	}
}

void ob_commit_check(ob_universe *u, uint32_t check, const ob_pair_key *k)
{
	const ob_check_record r = { .pair = ob_universe_step_data(u)->check[check],
				    .check = check,
				    .expected = k->expected,
				    .late = k->late,
				    .clear_until = k->clear_until,
				    .clear_as_of = k->clear_as_of,
				    .limit = k->limit };
	if (!hand_over(u, OB_RECORD_CHECK, &r, sizeof r))
		ob_write_check(u, &r);
}

void ob_commit_neighbours(ob_universe *u, uint32_t id, uint32_t neighbours, const uint32_t *changes, uint32_t count)
{
	if (!ob_universe_contained(u)) {
		uint32_t *to = ob_reserve_changes(u, id, neighbours, count);
		if (to && count)
			memcpy(to, changes, count * sizeof *changes);
		return;
	}
	uint32_t first = 0, part[OB_CHANGES_AT_ONCE];
	do {
		const uint32_t left = count - first, n = left < OB_CHANGES_AT_ONCE ? left : OB_CHANGES_AT_ONCE;
		const ob_neighbours_record r = { id, neighbours, count, first, n, 0 };
		memset(part, 0, sizeof part);
		for (uint32_t i = 0; i < n; i++)
			part[i] = changes[first + i];
		ob_outbox_put(u, OB_RECORD_NEIGHBOURS, &r, sizeof r, part, (n + 1) / 2 * sizeof(uint64_t));
		first += n;
	} while (first < count);
}

// ---- touches

// True for a body whose script has an on_contact.
static bool feels(const ob_step_data *data, uint32_t id)
{
	const uint32_t cell = data->script_of[id];
	return cell && ob_schedule_is_dynamic(&data->schedule[id]) &&
	       data->script_turn[cell - 1].flags & OB_SCRIPT_FEELS;
}

bool ob_touches_are_felt(const ob_universe *u, const ob_island *is)
{
	const ob_step_data *data = ob_universe_step_data(u);
	bool felt = false;
	for (uint32_t i = 0; data->script_of && i < is->members && !felt; i++)
		felt = feels(data, data->member[is->first_member + i]);
	return felt;
}

void ob_touches_begin(ob_universe *u, const ob_island *is)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; data->script_of && i < is->members; i++) {
		const uint32_t id = data->member[is->first_member + i];
		if (feels(data, id))
			ob_commit_touch(u, id, OB_NO_OBJECT, 0, ob_v3(0, 0, 0));
	}
}

void ob_touches_note(ob_universe *u, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (!data->script_of)
		return;
	if (feels(data, a))
		ob_commit_touch(u, a, b, impulse, point);
	if (feels(data, b))
		ob_commit_touch(u, b, a, impulse, point);
}
