#include "sim/committer.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "sim/budget.h"
#include "sim/calendar.h"
#include "sim/halo.h"
#include "sim/pair_rank.h"
#include "table/home.h"

enum { NONE = UINT32_MAX };

// Record of a result whose acceleration is unchanged, as it mostly is: the motion without it.
enum { ACCELERATION = offsetof(ob_motion, a), BEHIND_IT = ACCELERATION + sizeof(ob_vec3) };
typedef struct steady_record {
	uint32_t id, state, due, reserved; // as in ob_found_result
	unsigned char motion[sizeof(ob_motion) - sizeof(ob_vec3)];
} steady_record;

typedef struct bounds_record {
	uint32_t id, reserved;
	float box[6];
} bounds_record;

typedef struct effort_record {
	uint32_t island, share;
} effort_record;

// Number of neighbours of an object, and a part of the changes to its pairs (ob_step_data.neighbour_id): "count" of
// "total", from "first" on.
typedef struct neighbours_record {
	uint32_t id, neighbours, total, first, count, reserved;
	uint32_t change[];
} neighbours_record;

typedef struct touch_record {
	uint32_t id, other; // as in ob_commit_touch
	double impulse;
	ob_vec3 point;
} touch_record;

// Result of a script's run without its outbox, which follows in parts. state: padded to whole words.
typedef struct script_record {
	uint32_t cell, flags, wake, asks, state_bytes, outbox_bytes, failed_step, reserved;
	uint64_t random[4];
	ob_vec3 force, next_torque, push, twist;
	float colour[4];
	char error[OB_SCRIPT_ERROR_BYTES];
	unsigned char state[];
} script_record;

// Part of a cell's outbox: "bytes" of it, whole words, from "first" on.
typedef struct posts_record {
	uint32_t cell, first, bytes, reserved;
	unsigned char part[];
} posts_record;

enum { CHANGES_AT_ONCE = 512, POSTS_AT_ONCE = 2048, MOST_EFFORT = 1 << 16 };

// ---- in place

bool ob_is_left_in_result(const ob_universe *u, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	return ob_universe_settings(u)->one_per_object && !ob_universe_contains(u) &&
	       data->member[data->island[data->result_island[id]].first_member] != id;
}

static void write_result(ob_universe *u, const ob_found_result *r)
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

static void write_bounds(ob_universe *u, uint32_t id, const float box[6])
{
	ob_step_data *data = ob_universe_step_data(u);
	memcpy(data->bounds[id], box, sizeof data->bounds[id]);
	if (data->neighbours[id].count != UINT32_MAX) { // none is pending
		data->neighbours[id].count = UINT32_MAX;
		ob_requery_append(u, id);
	}
}

static void write_effort(ob_universe *u, uint32_t island, uint32_t share)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_island *is = &data->island[island];
	for (uint32_t i = 0; i < is->members; i++)
		data->effort[data->member[is->first_member + i]] = share;
}

// Writes a contact without its warm-start state. Returns the record for that; OB_NO_RECORD: it needs none.
static uint32_t write_contact_key(ob_universe *u, const ob_found_contact *c)
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

// Writes the warm-start state. Returns the version to which it was written.
static int write_contact_state(ob_universe *u, const ob_found_contact *c, uint32_t record)
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

static void write_contact(ob_universe *u, const ob_found_contact *c)
{
	const uint32_t record = write_contact_key(u, c);
	if (record != OB_NO_RECORD)
		write_contact_state(u, c, record);
}

static void write_touch(ob_universe *u, const touch_record *r)
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
static void write_script(ob_universe *u, const script_record *r)
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

static void write_check(ob_universe *u, const ob_check_record *c)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_pair_key *k = &data->pair[c->pair];
	k->expected = c->expected;
	k->late = c->late;
	k->limit = c->limit;
	k->clear_until = c->clear_until;
	k->clear_as_of = c->clear_as_of;
}

// Reserves space for so many changes in the arena. Returns NULL if it is full; then the step has failed.
static uint32_t *reserve_changes(ob_universe *u, uint32_t id, uint32_t neighbours, uint32_t total)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t offset = ob_neighbours_reserve(u, id, 1 + total);
	const bool full = offset == NONE;
	data->neighbours[id] = (struct ob_neighbours){ full ? 0 : offset, full ? 0 : neighbours };
	if (full)
		return NULL;
	data->neighbour_id[offset] = total;
	return data->neighbour_id + offset + 1;
}

// ---- by the worker that found the result

static void hand_over_result(ob_universe *u, const ob_found_result *r)
{
	const char *motion = (const char *)&r->motion;
	steady_record steady = { r->id, r->state, r->due, 0, { 0 } };
	if (memcmp(&r->motion.a, &ob_newest_motion(u, r->id)->a, sizeof r->motion.a) != 0) {
		ob_outbox_put(u, OB_RECORD_RESULT, r, sizeof *r, NULL, 0);
		return;
	}
	memcpy(steady.motion, motion, ACCELERATION);
	memcpy(steady.motion + ACCELERATION, motion + BEHIND_IT, sizeof r->motion - BEHIND_IT);
	ob_outbox_put(u, OB_RECORD_RESULT, &steady, sizeof steady, NULL, 0);
}

void ob_commit_result(ob_sim *s, const ob_found_result *r)
{
	if (ob_universe_contained(s->u))
		hand_over_result(s->u, r);
	else
		write_result(s->u, r);
}

void ob_commit_bounds(ob_universe *u, uint32_t id, const float box[6])
{
	if (!ob_universe_contained(u)) {
		write_bounds(u, id, box);
		return;
	}
	bounds_record r = { .id = id };
	memcpy(r.box, box, sizeof r.box);
	ob_outbox_put(u, OB_RECORD_BOUNDS, &r, sizeof r, NULL, 0);
}

void ob_commit_effort(ob_sim *s, uint32_t island, uint32_t share)
{
	const effort_record r = { island,
				  share < MOST_EFFORT ? share : MOST_EFFORT }; // so that sums stay within bounds
	if (ob_universe_contained(s->u))
		ob_outbox_put(s->u, OB_RECORD_EFFORT, &r, sizeof r, NULL, 0);
	else
		write_effort(s->u, island, r.share);
}

// Returns the number of a contact's bytes that are handed over.
static size_t contact_bytes(const ob_found_contact *c)
{
	return !c->kept       ? offsetof(ob_found_contact, state)
	       : c->two_sided ? sizeof *c
			      : offsetof(ob_found_contact, impulse_b);
}

void ob_commit_contact(ob_sim *s, const ob_found_contact *c)
{
	if (ob_universe_contained(s->u))
		ob_outbox_put(s->u, OB_RECORD_CONTACT, c, contact_bytes(c), NULL, 0);
	else
		write_contact(s->u, c);
}

void ob_commit_touch(ob_universe *u, uint32_t id, uint32_t other, double impulse, ob_vec3 point)
{
	const touch_record r = { id, other, impulse, point };
	if (ob_universe_contained(u))
		ob_outbox_put(u, OB_RECORD_TOUCH, &r, sizeof r, NULL, 0);
	else
		write_touch(u, &r);
}

static size_t in_words(size_t bytes)
{
	return (bytes + 7) / 8 * 8;
}

void ob_hand_over_script(ob_sim *s, uint32_t cell, const ob_script_turn *turn, const ob_script_cell *c)
{
	script_record r = { .cell = cell,
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
	ob_outbox_put(s->u, OB_RECORD_SCRIPT, &r, sizeof r, c->state, in_words(c->state_bytes));
	for (uint32_t first = 0; first < c->outbox_bytes; first += POSTS_AT_ONCE) {
		const uint32_t left = c->outbox_bytes - first, n = left < POSTS_AT_ONCE ? left : POSTS_AT_ONCE;
		const posts_record part = { cell, first, n, 0 };
		ob_outbox_put(s->u, OB_RECORD_POSTS, &part, sizeof part, c->outbox + first, n);
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
	if (ob_universe_contained(u))
		ob_outbox_put(u, OB_RECORD_CHECK, &r, sizeof r, NULL, 0);
	else
		write_check(u, &r);
}

void ob_commit_neighbours(ob_universe *u, uint32_t id, uint32_t neighbours, const uint32_t *changes, uint32_t count)
{
	if (!ob_universe_contained(u)) {
		uint32_t *to = reserve_changes(u, id, neighbours, count);
		if (to && count)
			memcpy(to, changes, count * sizeof *changes);
		return;
	}
	uint32_t first = 0, part[CHANGES_AT_ONCE];
	do {
		const uint32_t left = count - first, n = left < CHANGES_AT_ONCE ? left : CHANGES_AT_ONCE;
		const neighbours_record r = { id, neighbours, count, first, n, 0 };
		memset(part, 0, sizeof part);
		for (uint32_t i = 0; i < n; i++)
			part[i] = changes[first + i];
		ob_outbox_put(u, OB_RECORD_NEIGHBOURS, &r, sizeof r, part, (n + 1) / 2 * sizeof(uint64_t));
		first += n;
	} while (first < count);
}

// ---- by the arranger

ob_committer *ob_committer_create(const ob_universe *u)
{
	const uint32_t objects = ob_universe_capacity(u);
	ob_committer *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->island_owner = calloc(objects, sizeof *c->island_owner);
	c->query_owner = calloc(objects, sizeof *c->query_owner);
	c->had = calloc(objects, sizeof *c->had);
	c->rank = ob_universe_rank(u);
	c->ranks = ob_universe_ranks(u);
	if (c->island_owner && c->query_owner && c->had && (c->ranks < 2 || ob_committer_share(c, u)))
		return c;
	ob_committer_destroy(c);
	return NULL;
}

void ob_committer_destroy(ob_committer *c)
{
	if (!c)
		return;
	ob_mail_finish(&c->mail);
	ob_committer_finish_shared(c);
	free(c->island_owner);
	free(c->query_owner);
	free(c->had);
	free(c);
}

// Returns the worker that has the task in the running phase.
static uint32_t owner_of_task(const ob_universe *u, uint32_t task)
{
	return ob_task_first(u) + ob_task_owner(task, ob_task_workers(u));
}

static void note_home(ob_universe *u, const ob_island *is, uint32_t worker)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t k = 0; k < is->members; k++)
		ob_home_set(u, data->member[is->first_member + k], worker);
}

static void give_islands(ob_committer *c, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const bool own = ob_universe_settings(u)->one_per_object;
	c->solved = data->chunk[data->count->chunks];
	for (uint32_t chunk = 0; chunk < data->count->chunks; chunk++)
		for (uint32_t i = data->chunk[chunk]; i < data->chunk[chunk + 1]; i++) {
			c->island_owner[i] = own ? data->member[data->island[i].first_member] : owner_of_task(u, chunk);
			c->due += data->island[i].members;
			if (!own)
				note_home(u, &data->island[i], c->island_owner[i]);
		}
}

static void give_queries(ob_committer *c, const ob_universe *u)
{
	const bool own = ob_universe_settings(u)->one_per_object;
	const uint32_t *list = ob_requery_list(u, &c->due);
	memset(c->query_owner, 0xff, ob_universe_ids(u) * sizeof *c->query_owner); // NONE
	for (uint32_t i = 0; i < c->due; i++)
		c->query_owner[list[i]] = own ? list[i] : owner_of_task(u, i);
}

static void give_scripts(ob_committer *c, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const bool own = ob_universe_settings(u)->one_per_object;
	c->due = data->script_counts->due;
	memset(c->query_owner, 0xff, data->script_cells * sizeof *c->query_owner); // NONE
	for (uint32_t i = 0; i < c->due; i++) {
		const uint32_t cell = data->script_due[i];
		c->query_owner[cell] = own ? data->script_turn[cell].object : owner_of_task(u, i);
	}
}

static bool finite3(ob_vec3 v)
{
	return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_sound(const ob_motion *m, const ob_universe *u)
{
	const double norm = m->q.w * m->q.w + m->q.x * m->q.x + m->q.y * m->q.y + m->q.z * m->q.z;
	return isfinite(m->t0) && !isnan(m->valid_until) && finite3(m->p) && finite3(m->v) && finite3(m->w) &&
	       finite3(m->a) && norm > .9 && norm < 1.1 && isfinite(m->path) && m->reach >= 0 && isfinite(m->reach) &&
	       m->rest_time >= 0 && isfinite(m->rest_time) && m->step == ob_step_count(u) + 1 &&
	       m->island < ob_universe_ids(u) && m->flags < OB_MOTION_SWINGS;
}

// True if this simulator was given the island.
static bool owns_island(const ob_committer *c, uint32_t worker, uint32_t island)
{
	return island < c->solved && c->island_owner[island] == worker;
}

bool ob_committer_is_result(const ob_universe *u, const ob_mail_record *r)
{
	const steady_record *steady = r->data;
	return (r->bytes == sizeof(ob_found_result) || r->bytes == sizeof *steady) && steady->id < ob_universe_ids(u);
}

const ob_found_result *ob_committer_result_of(const ob_universe *u, const ob_mail_record *from, ob_found_result *whole)
{
	const steady_record *steady = from->data;
	char *motion = (char *)&whole->motion;
	if (!ob_committer_is_result(u, from))
		return NULL;
	if (from->bytes == sizeof *whole)
		return from->data;
	whole->id = steady->id, whole->state = steady->state, whole->due = steady->due, whole->reserved = 0;
	memcpy(motion, steady->motion, ACCELERATION);
	whole->motion.a = ob_newest_motion(u, steady->id)->a;
	memcpy(motion + BEHIND_IT, steady->motion + ACCELERATION, sizeof whole->motion - BEHIND_IT);
	return whole;
}

// True if the worker was given the object's island. For simulators of other ranks, whose islands are unknown here, it
// suffices that the object lives on their rank.
static bool solves(const ob_committer *c, const ob_universe *u, uint32_t worker, uint32_t id)
{
	return ob_worker_is_here(u, worker) ? owns_island(c, worker, ob_universe_step_data(u)->result_island[id])
					    : ob_home_rank(u, id) == ob_universe_rank_of(u, worker);
}

static bool was_given(ob_committer *c, const ob_universe *u, uint32_t worker, uint32_t id)
{
	return solves(c, u, worker, id) && !c->had[id]++;
}

// Counts the change in the number of bodies awake, for the exchange among ranks. A result that comes again counts
// relative to the first one.
static void count_woken(ob_committer *c, ob_universe *u, uint32_t id, uint32_t state)
{
	const uint32_t before = ob_universe_step_data(u)->schedule[id].state;
	const int32_t woken = (int32_t)(state != OB_SCHEDULE_ASLEEP) - (int32_t)(before != OB_SCHEDULE_ASLEEP);
	c->woken += woken;
	ob_step_woken(u, woken);
}

static void note_before(ob_committer *c, const ob_universe *u, const ob_mail_record *from, uint32_t id)
{
	uint64_t *heard = &c->heard[ob_universe_rank_of(u, from->worker)];
	bool whole;
	*heard = ob_committer_digest_before(c, u, id, *heard, &whole);
	if (!whole && !c->damaged)
		c->damaged = OB_PEERS_MOTION | (1 + id);
}

static const char *commit_result(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const bool restored = from->kind == OB_RECORD_RESTORED, here = ob_worker_is_here(u, from->worker);
	ob_found_result whole;
	const ob_found_result *r = ob_committer_result_of(u, from, &whole);
	if (!r || !was_given(c, u, from->worker, r->id))
		return "has solved what it was not given";
	if (!is_sound(&r->motion, u) || !ob_is_sound_state(r->state) ||
	    (restored && (from->bytes != sizeof *r || here)))
		return "has found a motion that makes no sense";
	if (c->halo && !restored)
		note_before(c, u, from, r->id);
	if (c->halo)
		ob_halo_note(c->halo, r->id, &r->motion);
	if (here)
		c->due--;
	if (c->halo && here)
		count_woken(c, u, r->id, r->state);
	write_result(u, r);
	if (!here) {
		ob_home_set(u, r->id, from->worker);
		ob_pairs_follow(u, r->id);
	}
	return NULL;
}

static const char *commit_bounds(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const bounds_record *r = from->data;
	if (from->bytes != sizeof *r || r->id >= ob_universe_ids(u) || !solves(c, u, from->worker, r->id))
		return "has moved what it was not given";
	for (int i = 0; i < 3; i++)
		if (!(r->box[i] <= r->box[3 + i]) || isinf(r->box[i]) || isinf(r->box[3 + i]))
			return "has found bounds that make no sense";
	write_bounds(u, r->id, r->box);
	return NULL;
}

static const char *commit_effort(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const effort_record *r = from->data;
	if (from->bytes != sizeof *r || !owns_island(c, from->worker, r->island) || r->share > MOST_EFFORT)
		return "has counted what it was not given";
	write_effort(u, r->island, r->share);
	return NULL;
}

static bool is_sound_contact(const ob_found_contact *c, bool whole)
{
	const ob_pair_state *p = &c->state;
	bool sound = !isnan(c->limit) && c->active <= 1 && c->kept <= 1 && c->two_sided <= 1;
	if (!c->kept || !sound || !whole)
		return sound;
	double sum = p->substep + p->disc_radius + p->creep + p->normal.x + p->normal.y + p->normal.z + p->between.x +
		     p->between.y + p->between.z;
	for (int i = 0; i < OB_PAIR_ROWS; i++)
		sum += p->impulse[i] + (c->two_sided ? c->impulse_b[i] : 0);
	for (int i = 0; i < OB_PAIR_POINTS; i++)
		sum += p->arm_a[i].x + p->arm_a[i].y + p->arm_a[i].z + p->gap[i];
	return isfinite(sum) && p->points <= OB_PAIR_POINTS && p->substep > 0;
}

// False for contacts that arrive without their state: only their existence, as a rule, comes from other ranks.
static bool is_whole(const ob_committer *c, const ob_universe *u, const ob_mail_record *from)
{
	return c->ranks < 2 || ob_universe_shares_contacts(u) || ob_worker_is_here(u, from->worker);
}

static void note_pair(ob_universe *u, ob_mail *list, uint32_t pair)
{
	if (!ob_mail_append(list, &pair, sizeof pair))
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
}

static const char *commit_contact(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_found_contact *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const bool whole = is_whole(c, u, from);
	if (from->bytes < offsetof(ob_found_contact, state) ||
	    from->bytes != (whole ? contact_bytes(r) : offsetof(ob_found_contact, state)) ||
	    r->pair >= ob_pairs_end(data))
		return "has found a contact that does not exist";
	const ob_pair_key *k = &data->pair[r->pair];
	const bool here = ob_worker_is_here(u, from->worker);
	if ((here && !k->in_island) || !(solves(c, u, from->worker, k->a) || solves(c, u, from->worker, k->b)))
		return "has found a contact of bodies that it was not given";
	if (!is_sound_contact(r, whole))
		return "has found a contact that makes no sense";
	const uint32_t record = write_contact_key(u, r);
	if (!r->active && k->record != OB_NO_RECORD && !here)
		note_pair(u, &c->parted, r->pair);
	if (record == OB_NO_RECORD)
		return NULL;
	const int version = whole ? write_contact_state(u, r, record) : -1;
	if (c->holdings)
		ob_holdings_note(c->holdings, u, record, version, &r->state,
				 ob_universe_shares_contacts(u) ? OB_ALL_RANKS : ob_universe_rank_of(u, from->worker));
	return NULL;
}

static const char *commit_touch(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const touch_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	if (from->bytes != sizeof *r || r->id >= ob_universe_ids(u) || !data->script_of || !data->script_of[r->id] ||
	    !solves(c, u, from->worker, r->id))
		return "has felt for what it was not given";
	if ((r->other >= ob_universe_ids(u) && r->other != OB_NO_OBJECT) || !isfinite(r->impulse) || !finite3(r->point))
		return "has felt what makes no sense";
	write_touch(u, r);
	return NULL;
}

static bool is_sound_script(const script_record *r, size_t bytes)
{
	enum { FLAGS = 2 * OB_SCRIPT_WARNED - 1, ASKS = 2 * OB_SCRIPT_ASKS_ERROR - 1 };
	return bytes >= sizeof *r && r->state_bytes <= OB_SCRIPT_STATE_BYTES &&
	       bytes == sizeof *r + in_words(r->state_bytes) && r->outbox_bytes <= OB_SCRIPT_OUTBOX_BYTES &&
	       r->outbox_bytes % 8 == 0 && !(r->flags & ~(uint32_t)FLAGS) && !(r->asks & ~(uint32_t)ASKS) &&
	       finite3(r->force) && finite3(r->next_torque) && finite3(r->push) && finite3(r->twist) &&
	       isfinite(r->colour[0] + r->colour[1] + r->colour[2] + r->colour[3]) &&
	       memchr(r->error, 0, sizeof r->error);
}

static void have_script(ob_committer *c, const ob_universe *u, uint32_t cell)
{
	if (c->had[cell] <= ob_universe_step_data(u)->script_cell[cell].outbox_bytes)
		return;
	c->due--;
	c->query_owner[cell] = NONE;
}

static const char *commit_script(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const script_record *r = from->data;
	if (from->bytes < sizeof *r || r->cell >= ob_universe_step_data(u)->script_cells ||
	    c->query_owner[r->cell] != from->worker || c->had[r->cell])
		return "has run a script that it was not given";
	if (!is_sound_script(r, from->bytes))
		return "has run a script to what makes no sense";
	write_script(u, r);
	c->had[r->cell] = 1;
	have_script(c, u, r->cell);
	return NULL;
}

// True if the outbox consists of whole posts, one behind the other, to its end.
static bool are_sound_posts(const ob_script_cell *c)
{
	uint32_t at = 0;
	while (at + sizeof(ob_script_post) <= c->outbox_bytes) {
		const ob_script_post *post = (const ob_script_post *)(const void *)(c->outbox + at);
		at += (uint32_t)sizeof *post;
		if (post->kind > OB_SCRIPT_CREATE || post->bytes % 8 || post->used > post->bytes ||
		    post->bytes > c->outbox_bytes - at)
			return false;
		at += post->bytes;
	}
	return at == c->outbox_bytes;
}

// Commits a part of a script's outbox. Parts arrive in order, after the script's other results.
static const char *commit_posts(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	static const char *const wrong = "has run a script that asks for what makes no sense";
	const posts_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	if (from->bytes < sizeof *r || r->cell >= data->script_cells || c->query_owner[r->cell] != from->worker ||
	    !c->had[r->cell])
		return "has asked for a script that it was not given";
	ob_script_cell *cell = &data->script_cell[r->cell];
	if (!r->bytes || r->bytes % 8 || r->bytes != from->bytes - sizeof *r || r->first != c->had[r->cell] - 1 ||
	    r->bytes > cell->outbox_bytes - r->first)
		return wrong;
	memcpy(cell->outbox + r->first, r->part, r->bytes);
	c->had[r->cell] += r->bytes;
	if (c->had[r->cell] > cell->outbox_bytes && !are_sound_posts(cell))
		return wrong;
	have_script(c, u, r->cell);
	return NULL;
}

// True if the sender was given this check. Checks of other ranks are unknown here: it suffices that the pair exists.
static bool was_given_check(const ob_universe *u, const ob_mail_record *from)
{
	const ob_check_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	if (!ob_worker_is_here(u, from->worker))
		return r->pair < ob_pairs_end(data) && data->pair[r->pair].a != data->pair[r->pair].b;
	return r->check < ob_checks_count(data) && data->check[r->check] == r->pair &&
	       owner_of_task(u, r->check / OB_LATE_CONTACTS_BATCH) == from->worker;
}

static const char *commit_check(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_check_record *r = from->data;
	if (from->bytes != sizeof *r || !was_given_check(u, from))
		return "has checked what it was not given";
	if (isnan(r->limit) || r->expected > 1 || r->late > 1)
		return "has found about a pair what makes no sense";
	write_check(u, r);
	if (!ob_worker_is_here(u, from->worker))
		note_pair(u, &c->checked, r->pair);
	if (c->ranks > 1 && (r->late || r->expected) && ob_pair_is_across(u, &ob_universe_step_data(u)->pair[r->pair]))
		note_pair(u, &c->links_across, r->pair);
	return NULL;
}

// Commits a part of the changes to an object's neighbours. Parts arrive in order, from the first on.
static const char *commit_neighbours(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	static const char *const wrong = "has found neighbours that make no sense";
	const neighbours_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	if (from->bytes < sizeof *r || r->id >= ids || c->query_owner[r->id] != from->worker)
		return "has looked for neighbours of what it was not given";
	if (r->count > CHANGES_AT_ONCE || from->bytes != sizeof *r + (r->count + 1) / 2 * sizeof(uint64_t) ||
	    r->first != c->had[r->id] || r->first > r->total || r->neighbours > ids ||
	    r->total > ids + ob_pairs_end(data) || r->count > r->total - r->first || (!r->count && r->total))
		return wrong;
	for (uint32_t i = 0; i < r->count; i++)
		if (!ob_is_pair_change(data, r->id, r->change[i], ids))
			return wrong;
	if (r->first && data->neighbour_id[data->neighbours[r->id].offset] != r->total)
		return wrong;
	if (r->first == 0 && !reserve_changes(u, r->id, r->neighbours, r->total))
		return NULL;
	if (r->count)
		memcpy(data->neighbour_id + data->neighbours[r->id].offset + 1 + r->first, r->change,
		       r->count * sizeof *r->change);
	c->had[r->id] += r->count;
	if (c->had[r->id] == r->total)
		c->due--, c->query_owner[r->id] = NONE;
	return NULL;
}

static const char *commit_end(ob_universe *u, const ob_mail_record *from)
{
	const ob_outbox_end *end = from->data;
	ob_step_data *data = ob_universe_step_data(u);
	ob_worker_set_objects(u, from->worker, end->objects);
	if (end->late)
		ob_late_contacts_note(u);
	if (end->next_check && end->next_check - 1 < data->count->next_due)
		data->count->next_due = end->next_check - 1;
	ob_phase_worked(u, end->worked_ns, end->worked_ns);
	*ob_worker_counters(u, from->worker) = end->counters;
	return NULL;
}

// Commits a record. Returns NULL, or the error in it. Only kinds that fit the tasks of the phase are accepted.
static const char *commit_record(ob_committer *c, ob_universe *u, ob_phase phase, const ob_mail_record *r)
{
	const bool islands = phase == OB_PHASE_ISLANDS, scripts = phase == OB_PHASE_SCRIPTS,
		   pairs = phase == OB_PHASE_FORECAST || phase == OB_PHASE_LATE_CONTACTS,
		   boxes = phase == OB_PHASE_BROADPHASE_START || phase == OB_PHASE_BROADPHASE;
	switch (r->kind) {
	case OB_RECORD_END:
		return commit_end(u, r);
	case OB_RECORD_RESULT:
	case OB_RECORD_RESTORED:
		return islands ? commit_result(c, u, r) : "has solved what was not to be solved";
	case OB_RECORD_BOUNDS:
		return islands ? commit_bounds(c, u, r) : "has moved what was not to be moved";
	case OB_RECORD_EFFORT:
		return islands ? commit_effort(c, u, r) : "has counted what was not to be counted";
	case OB_RECORD_CONTACT:
		return islands ? commit_contact(c, u, r) : "has found a contact out of turn";
	case OB_RECORD_TOUCH:
		return islands ? commit_touch(c, u, r) : "has felt out of turn";
	case OB_RECORD_SCRIPT:
		return scripts ? commit_script(c, u, r) : "has run a script out of turn";
	case OB_RECORD_POSTS:
		return scripts ? commit_posts(c, u, r) : "has asked for a script out of turn";
	case OB_RECORD_CHECK:
		return pairs ? commit_check(c, u, r) : "has checked a pair out of turn";
	case OB_RECORD_NEIGHBOURS:
		return boxes ? commit_neighbours(c, u, r) : "has found neighbours out of turn";
	default:
		return "has handed over what is unknown";
	}
}

ob_mail ob_committer_mail_of(const ob_committer *c, uint32_t rank)
{
	if (!c->all || rank == c->rank)
		return (ob_mail){ .bytes = c->mail.bytes, .used = c->mail.used };
	const size_t begin = c->at[rank] + c->ahead;
	return (ob_mail){ .bytes = (char *)c->all + begin, .used = c->at[rank + 1] - begin };
}

static uint32_t mails(const ob_committer *c)
{
	return c->all ? c->ranks : 1;
}

static void note_end(ob_universe *u, const ob_mail_record *r)
{
	const ob_outbox_end *end = r->data;
	const uint32_t why = (uint32_t)end->failure, object = (uint32_t)(end->failure >> 32);
	if (r->bytes != sizeof *end || why >= OB_STEP_DAMAGED || object >= ob_universe_capacity(u) ||
	    end->worked_on >= ob_universe_capacity(u))
		ob_step_blame(u, r->worker, "has ended in a way that is unknown");
	else if (why)
		ob_step_fail(u, why, object);
	else
		ob_budget_add(u, end->work, end->worked_on);
}

// Reads the last record of every simulator, which says if it has failed. Returns true if any has: then results may be
// NaN, and are not read.
static bool fails(ob_committer *c, ob_universe *u)
{
	ob_mail_record r;
	for (uint32_t rank = 0; rank < mails(c); rank++)
		for (ob_mail m = ob_committer_mail_of(c, rank); ob_mail_next_end(&m, &r);)
			note_end(u, &r);
	return ob_step_failed(u, NULL) != OB_STEP_OK;
}

bool ob_commit_collect(ob_committer *c, ob_universe *u, ob_phase phase)
{
	const bool islands = phase == OB_PHASE_ISLANDS, scripts = phase == OB_PHASE_SCRIPTS,
		   boxes = phase == OB_PHASE_BROADPHASE_START || phase == OB_PHASE_BROADPHASE;
	c->due = c->solved = 0;
	c->all = NULL;
	if (islands)
		give_islands(c, u);
	if (boxes)
		give_queries(c, u);
	if (scripts)
		give_scripts(c, u);
	if (islands || boxes)
		memset(c->had, 0, ob_universe_ids(u) * sizeof *c->had);
	if (scripts)
		memset(c->had, 0, ob_universe_step_data(u)->script_cells * sizeof *c->had);
	return ob_mail_collect(u, &c->mail);
}

// ---- reading records, with prefetch

static uint32_t first_word(const ob_mail_record *r)
{
	uint32_t word = UINT32_MAX;
	if (r->bytes >= sizeof word)
		memcpy(&word, r->data, sizeof word);
	return word;
}

static void prefetch_body(const ob_committer *c, const ob_universe *u, uint32_t id, bool motion)
{
	const ob_step_data *data = ob_universe_step_data(u);
	__builtin_prefetch(&data->schedule[id], 1);
	__builtin_prefetch(&data->result_island[id]);
	__builtin_prefetch(&c->had[id], 1);
	if (c->halo)
		ob_halo_prefetch(c->halo, id);
	if (motion)
		ob_prefetch_slot(u, id);
}

// Prefetches the object or pair that a record is about.
static void prefetch_subject(const ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool commits)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t number = first_word(r);
	if (commits && r->kind == OB_RECORD_RESULT && number < data->objects_max)
		prefetch_body(c, u, number, true);
	else if ((r->kind == OB_RECORD_CONTACT || r->kind == OB_RECORD_CHECK) && number < data->pairs_max)
		__builtin_prefetch(&data->pair[number], 1);
	else if (commits && r->kind == OB_RECORD_BOUNDS && number < data->objects_max)
		__builtin_prefetch(data->bounds[number], 1);
}

// Returns the index of a contact's state; UINT32_MAX if it has none.
static uint32_t record_of(const ob_universe *u, const ob_mail_record *r)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t pair = first_word(r);
	const uint32_t record = r->kind == OB_RECORD_CONTACT && pair < data->pairs_max ? data->pair[pair].record : NONE;
	return record < data->pairs_max ? record : NONE;
}

static void prefetch_kept(const ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	const uint32_t record = record_of(u, r);
	if (record == NONE)
		return;
	if (c->holdings)
		ob_holdings_prefetch(c->holdings, record);
	if (r->bytes > offsetof(ob_found_contact, state))
		__builtin_prefetch(ob_universe_step_data(u)->record[record].stamp, 1);
}

// Prefetches the version of a contact's state that will be written.
static void prefetch_version(const ob_universe *u, const ob_mail_record *r)
{
	enum { LINE = 64 };
	const uint32_t record = record_of(u, r);
	if (record == NONE || r->bytes <= offsetof(ob_found_contact, state))
		return;
	const ob_pair_record *kept = &ob_universe_step_data(u)->record[record];
	const char *to = (const char *)&kept->version[ob_pair_newest(kept, ob_step_count(u)) == 0];
	for (size_t at = 0; at < sizeof kept->version[0]; at += LINE)
		__builtin_prefetch(to + at, 1);
}

bool ob_committer_next(const ob_committer *c, ob_universe *u, ob_record_reader *from, ob_mail_record *out)
{
	enum { MASK = OB_RECORDS_AHEAD - 1, KEPT = 10, VERSION = 5 };
	while (from->read - from->taken < OB_RECORDS_AHEAD &&
	       ob_mail_next(u, &from->mail, &from->ahead[from->read & MASK]))
		prefetch_subject(c, u, &from->ahead[from->read++ & MASK], from->commits);
	if (from->read == from->taken)
		return false;
	if (from->taken + KEPT < from->read)
		prefetch_kept(c, u, &from->ahead[(from->taken + KEPT) & MASK]);
	if (from->commits && from->taken + VERSION < from->read)
		prefetch_version(u, &from->ahead[(from->taken + VERSION) & MASK]);
	*out = from->ahead[from->taken++ & MASK];
	return true;
}

// Commits the records of one rank. worker: set to the sender of the last one read.
static bool commit_records(ob_committer *c, ob_universe *u, ob_phase phase, ob_mail m, uint32_t *worker)
{
	ob_record_reader from = { .mail = m, .commits = true };
	ob_mail_record r;
	while (ob_committer_next(c, u, &from, &r)) {
		const char *wrong = commit_record(c, u, phase, &r);
		*worker = r.worker;
		if (wrong) {
			ob_step_blame(u, r.worker, wrong);
			return false;
		}
	}
	return true;
}

void ob_commit_mail(ob_committer *c, ob_universe *u, ob_phase phase)
{
	uint32_t worker = 0;
	if (fails(c, u))
		return;
	for (uint32_t rank = 0; rank < mails(c); rank++)
		if (!commit_records(c, u, phase, ob_committer_mail_of(c, rank), &worker))
			return;
	if (c->all && c->dealt_to_each)
		ob_committer_compare_before(c);
	if (c->due && ob_step_failed(u, NULL) == OB_STEP_OK)
		ob_step_blame(u, worker, "or another has not done all that it was given");
}
