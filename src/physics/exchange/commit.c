#include "exchange/committer.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "table/home.h"
#include "table/layout.h"

enum { NONE = UINT32_MAX };

ob_committer *ob_committer_create(const ob_universe *u, ob_cluster *cluster)
{
	const uint32_t objects = ob_universe_capacity(u);
	ob_committer *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->island_owner = calloc(objects, sizeof *c->island_owner);
	c->query_owner = calloc(objects, sizeof *c->query_owner);
	c->had = calloc(objects, sizeof *c->had);
	c->cluster = cluster;
	c->rank = ob_universe_rank(u);
	c->ranks = ob_universe_ranks(u);
	if (c->island_owner && c->query_owner && c->had && (!cluster || ob_committer_share(c)))
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

static bool is_sound(const ob_motion *m, const ob_universe *u)
{
	return ob_motion_makes_sense(m) && isfinite(m->path) && m->reach >= 0 && isfinite(m->reach) &&
	       m->rest_time >= 0 && isfinite(m->rest_time) && m->step == ob_step_count(u) + 1 &&
	       m->island < ob_universe_ids(u) && m->substeps < 1 << OB_SUBSTEP_CHOICES && !(m->flags >> 8) &&
	       !(m->flags & OB_MOTION_SWINGS);
}

// True if this simulator was given the island.
static bool owns_island(const ob_committer *c, uint32_t worker, uint32_t island)
{
	return island < c->solved && c->island_owner[island] == worker;
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
	uint64_t *received = &c->received[ob_universe_rank_of(u, from->worker)];
	bool whole;
	*received = ob_committer_digest_before(c, u, id, *received, &whole);
	if (!whole && !c->damaged)
		c->damaged = OB_PEERS_MOTION | (1 + id);
}

// Notes a result for the exchange among ranks, before it is written.
static void note_for_ranks(ob_committer *c, ob_universe *u, const ob_mail_record *from, const ob_found_result *r)
{
	if (from->kind != OB_RECORD_RESTORED)
		note_before(c, u, from, r->id);
	ob_halo_note(c->cluster->parts.halo, r->id, &r->motion);
	if (ob_worker_is_here(u, from->worker))
		count_woken(c, u, r->id, r->state);
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
	if (here)
		c->due--;
	if (c->cluster)
		note_for_ranks(c, u, from, r);
	ob_write_result(u, r);
	if (!here) {
		ob_home_set(u, r->id, from->worker);
		ob_pairs_follow(u, r->id);
	}
	return NULL;
}

static const char *commit_bounds(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_bounds_record *r = from->data;
	if (from->bytes != sizeof *r || r->id >= ob_universe_ids(u) || !solves(c, u, from->worker, r->id))
		return "has moved what it was not given";
	for (int i = 0; i < 3; i++)
		if (!(r->box[i] <= r->box[3 + i]) || isinf(r->box[i]) || isinf(r->box[3 + i]))
			return "has found bounds that make no sense";
	ob_write_bounds(u, r->id, r->box);
	return NULL;
}

static const char *commit_effort(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_effort_record *r = from->data;
	if (from->bytes != sizeof *r || !owns_island(c, from->worker, r->island) || r->share > OB_EFFORT_GIVEN_UP)
		return "has counted what it was not given";
	ob_write_effort(u, r->island, r->share);
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
	return !c->cluster || ob_universe_shares_contacts(u) || ob_worker_is_here(u, from->worker);
}

static const char *commit_contact(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_found_contact *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const bool whole = is_whole(c, u, from);
	if (from->bytes < offsetof(ob_found_contact, state) ||
	    from->bytes != (whole ? ob_contact_bytes(r) : offsetof(ob_found_contact, state)) ||
	    r->pair >= ob_pairs_end(data))
		return "has found a contact that does not exist";
	const ob_pair_key *k = &data->pair[r->pair];
	const bool here = ob_worker_is_here(u, from->worker);
	if ((here && !k->in_island) || !(solves(c, u, from->worker, k->a) || solves(c, u, from->worker, k->b)))
		return "has found a contact of bodies that it was not given";
	if (!is_sound_contact(r, whole))
		return "has found a contact that makes no sense";
	const uint32_t record = ob_write_contact_key(u, r);
	if (!r->active && k->record != OB_NO_RECORD && !here)
		ob_cluster_note(u, &c->cluster->parted, r->pair);
	if (record == OB_NO_RECORD)
		return NULL;
	const int version = whole ? ob_write_contact_state(u, r, record) : -1;
	if (c->cluster)
		ob_holdings_note(c->cluster->parts.holdings, u, record, version, &r->state,
				 ob_universe_shares_contacts(u) ? OB_ALL_RANKS : ob_universe_rank_of(u, from->worker));
	return NULL;
}

// The simulator was given the island of one of its objects, and so of both.
static const char *commit_joint(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_found_joint *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	if (from->bytes != sizeof *r || r->joint >= ob_joints_end(data))
		return "has found a joint that does not exist";
	const ob_joint_passport *j = &data->joint[r->joint];
	bool given = false;
	for (int side = 0; side < 2; side++)
		given |= j->object[side] < ob_universe_ids(u) &&
			 ob_schedule_is_dynamic(&data->schedule[j->object[side]]) &&
			 solves(c, u, from->worker, j->object[side]);
	if (!given || !ob_joint_holds(u, j))
		return "has found a joint of bodies that it was not given";
	if (r->broke > 1 || !ob_is_finite(r->force) || !ob_is_finite(r->torque) || !isfinite(r->along))
		return "has found a load of a joint that makes no sense";
	ob_write_joint(u, r);
	return NULL;
}

static const char *commit_touch(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	const ob_touch_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	if (from->bytes != sizeof *r || r->id >= ob_universe_ids(u) || !data->script_of || !data->script_of[r->id] ||
	    !solves(c, u, from->worker, r->id))
		return "has felt for what it was not given";
	if ((r->other >= ob_universe_ids(u) && r->other != OB_NO_OBJECT) || !isfinite(r->impulse) ||
	    !ob_is_finite(r->point))
		return "has felt what makes no sense";
	ob_write_touch(u, r);
	return NULL;
}

static bool is_sound_script(const ob_script_record *r, size_t bytes)
{
	enum { FLAGS = 2 * OB_SCRIPT_BROKE - 1, ASKS = 2 * OB_SCRIPT_ASKS_ERROR - 1 };
	return bytes >= sizeof *r && r->state_bytes <= OB_SCRIPT_STATE_BYTES &&
	       bytes == sizeof *r + ob_in_words(r->state_bytes) && r->outbox_bytes <= OB_SCRIPT_OUTBOX_BYTES &&
	       r->outbox_bytes % 8 == 0 && !(r->flags & ~(uint32_t)FLAGS) && !(r->asks & ~(uint32_t)ASKS) &&
	       ob_is_finite(r->force) && ob_is_finite(r->next_torque) && ob_is_finite(r->push) &&
	       ob_is_finite(r->twist) && isfinite(r->colour[0] + r->colour[1] + r->colour[2] + r->colour[3]) &&
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
	const ob_script_record *r = from->data;
	if (from->bytes < sizeof *r || r->cell >= ob_universe_step_data(u)->script_cells ||
	    c->query_owner[r->cell] != from->worker || c->had[r->cell])
		return "has run a script that it was not given";
	if (!is_sound_script(r, from->bytes))
		return "has run a script to what makes no sense";
	ob_write_script(u, r);
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
		if (post->kind >= OB_REQUEST_AT_ONCE || post->bytes % 8 || post->used > post->bytes ||
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
	const ob_posts_record *r = from->data;
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
	ob_write_check(u, r);
	if (!ob_worker_is_here(u, from->worker))
		ob_cluster_note(u, &c->cluster->checked, r->pair);
	if (c->cluster && (r->late || r->expected) && ob_pair_is_across(u, &ob_universe_step_data(u)->pair[r->pair]))
		ob_cluster_note(u, &c->cluster->links_across, r->pair);
	return NULL;
}

// Commits a part of the changes to an object's neighbours. Parts arrive in order, from the first on.
static const char *commit_neighbours(ob_committer *c, ob_universe *u, const ob_mail_record *from)
{
	static const char *const wrong = "has found neighbours that make no sense";
	const ob_neighbours_record *r = from->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	if (from->bytes < sizeof *r || r->id >= ids || c->query_owner[r->id] != from->worker)
		return "has looked for neighbours of what it was not given";
	if (ob_step_failed(u, NULL) != OB_STEP_OK) // there was no room for an earlier part
		return NULL;
	if (r->count > OB_CHANGES_AT_ONCE || from->bytes != sizeof *r + (r->count + 1) / 2 * sizeof(uint64_t) ||
	    r->first != c->had[r->id] || r->first > r->total || r->neighbours > ids ||
	    r->total > ids + ob_pairs_end(data) || r->count > r->total - r->first || (!r->count && r->total))
		return wrong;
	for (uint32_t i = 0; i < r->count; i++)
		if (!ob_is_pair_change(data, r->id, r->change[i], ids))
			return wrong;
	if (r->first && data->neighbour_id[data->neighbours[r->id].offset] != r->total)
		return wrong;
	if (r->first == 0 && !ob_reserve_changes(u, r->id, r->neighbours, r->total))
		return NULL;
	if (r->count)
		memcpy(data->neighbour_id + data->neighbours[r->id].offset + 1 + r->first, r->change,
		       r->count * sizeof *r->change);
	c->had[r->id] += r->count;
	if (c->had[r->id] == r->total)
		c->due--, c->query_owner[r->id] = NONE;
	return NULL;
}

static const char *commit_end(ob_committer *c, ob_universe *u, const ob_mail_record *from)
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

enum { // phases, as bits
	ISLANDS = 1 << OB_PHASE_ISLANDS,
	SCRIPTS = 1 << OB_PHASE_SCRIPTS,
	PAIRS = 1 << OB_PHASE_FORECAST | 1 << OB_PHASE_LATE_CONTACTS,
	BOXES = 1 << OB_PHASE_BROADPHASE_START | 1 << OB_PHASE_BROADPHASE,
};

// Kinds of records: phases whose tasks they fit, the function that commits them, and the error in any other phase.
static const struct {
	uint32_t phases;
	const char *(*commit)(ob_committer *c, ob_universe *u, const ob_mail_record *r);
	const char *error;
} kinds[] = {
	[OB_RECORD_END] = { UINT32_MAX, commit_end, NULL },
	[OB_RECORD_RESULT] = { ISLANDS, commit_result, "has solved what was not to be solved" },
	[OB_RECORD_RESTORED] = { ISLANDS, commit_result, "has solved what was not to be solved" },
	[OB_RECORD_BOUNDS] = { ISLANDS, commit_bounds, "has moved what was not to be moved" },
	[OB_RECORD_EFFORT] = { ISLANDS, commit_effort, "has counted what was not to be counted" },
	[OB_RECORD_CONTACT] = { ISLANDS, commit_contact, "has found a contact out of turn" },
	[OB_RECORD_JOINT] = { ISLANDS, commit_joint, "has found a joint out of turn" },
	[OB_RECORD_TOUCH] = { ISLANDS, commit_touch, "has felt out of turn" },
	[OB_RECORD_SCRIPT] = { SCRIPTS, commit_script, "has run a script out of turn" },
	[OB_RECORD_POSTS] = { SCRIPTS, commit_posts, "has asked for a script out of turn" },
	[OB_RECORD_CHECK] = { PAIRS, commit_check, "has checked a pair out of turn" },
	[OB_RECORD_NEIGHBOURS] = { BOXES, commit_neighbours, "has found neighbours out of turn" },
};

// Commits a record. Returns NULL, or the error in it.
static const char *commit_record(ob_committer *c, ob_universe *u, ob_phase phase, const ob_mail_record *r)
{
	if (r->kind >= sizeof kinds / sizeof *kinds || !kinds[r->kind].commit)
		return "has handed over what is unknown";
	return kinds[r->kind].phases >> phase & 1 ? kinds[r->kind].commit(c, u, r) : kinds[r->kind].error;
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
	else if (ob_universe_settings(u)->freezes)
		ob_step_work_add(u, end->work); // compared when the phase ends
	else
		ob_work_add(u, end->work, end->worked_on);
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

static bool collect(ob_committer *c, ob_universe *u, ob_phase phase)
{
	const uint32_t in = 1u << phase;
	c->due = c->solved = 0;
	c->all = NULL;
	if (in & ISLANDS)
		give_islands(c, u);
	if (in & BOXES)
		give_queries(c, u);
	if (in & SCRIPTS)
		give_scripts(c, u);
	if (in & (ISLANDS | BOXES))
		memset(c->had, 0, ob_universe_ids(u) * sizeof *c->had);
	if (in & SCRIPTS)
		memset(c->had, 0, ob_universe_step_data(u)->script_cells * sizeof *c->had);
	return ob_mail_collect(u, &c->mail);
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

static void compare_before(ob_committer *c)
{
	uint64_t sent;
	for (uint32_t rank = 0; rank < c->ranks; rank++) {
		memcpy(&sent, c->all + c->at[rank] + sizeof(ob_peers_head), sizeof sent);
		c->differs |= rank != c->rank && sent != c->received[rank];
	}
}

// Commits which islands were given up, and no results, where a phase has failed.
static void commit_given_up(ob_committer *c, ob_universe *u, ob_phase phase)
{
	ob_mail_record r;
	for (uint32_t rank = 0; rank < mails(c); rank++) {
		ob_record_reader from = { .mail = ob_committer_mail_of(c, rank), .commits = true };
		while (ob_committer_next(c, u, &from, &r))
			if (r.kind == OB_RECORD_EFFORT)
				commit_record(c, u, phase, &r);
	}
}

static void commit_mails(ob_committer *c, ob_universe *u, ob_phase phase)
{
	uint32_t worker = 0;
	if (fails(c, u)) {
		commit_given_up(c, u, phase);
		return;
	}
	for (uint32_t rank = 0; rank < mails(c); rank++)
		if (!commit_records(c, u, phase, ob_committer_mail_of(c, rank), &worker))
			return;
	if (c->all && c->dealt_to_each)
		compare_before(c);
	if (c->due && ob_step_failed(u, NULL) == OB_STEP_OK)
		ob_step_blame(u, worker, "or another has not done all that it was given");
}

bool ob_commit(ob_committer *c, ob_universe *u, ob_phase phase)
{
	const bool alone = !c->cluster || phase == OB_PHASE_RESUME; // each rank's arranger resumes the run by itself
	const uint64_t digest = alone ? 0 : ob_peers_digest(u);
	if (!collect(c, u, phase))
		return false;
	if (alone || ob_committer_exchange(c, u, phase, digest))
		commit_mails(c, u, phase);
	return true;
}
