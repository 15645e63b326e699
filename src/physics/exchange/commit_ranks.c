// Exchange of simulators' results among the arrangers of several ranks.
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/peers.h"
#include "exchange/committer.h"
#include "schedule/pair_checks.h"
#include "table/home.h"

bool ob_committer_share(ob_committer *c)
{
	c->dealt = calloc(c->ranks, sizeof *c->dealt);
	c->to = calloc(c->ranks, sizeof *c->to);
	c->sent = calloc(c->ranks, sizeof *c->sent);
	c->received = calloc(c->ranks, sizeof *c->received);
	return c->dealt && c->to && c->sent && c->received;
}

void ob_committer_finish_shared(ob_committer *c)
{
	ob_mail_finish(&c->out);
	for (uint32_t r = 0; c->dealt && r < c->ranks; r++)
		ob_mail_finish(&c->dealt[r]);
	free(c->dealt);
	free(c->to);
	free(c->sent);
	free(c->received);
}

// True if the others already know all that they would be sent of a contact: its existence, and the rank that keeps its
// state.
static bool is_known(const ob_committer *c, const ob_universe *u, const ob_found_contact *found)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k = found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	return k && k->active && found->active && k->record != OB_NO_RECORD &&
	       ob_holdings_here_alone(c->cluster->parts.holdings, u, k->record);
}

// Returns the bytes of a contact's record to send to the others. Only its existence is sent, unless its state is wanted
// everywhere. 0: nothing new.
static uint32_t contact_bytes_for_others(const ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	if (ob_universe_shares_contacts(u) || r->bytes < offsetof(ob_found_contact, state))
		return r->bytes;
	return is_known(c, u, r->data) ? 0 : (uint32_t)offsetof(ob_found_contact, state);
}

// Appends a result to the mails of other ranks. all: of every rank; else of those that have neighbours of the body.
static void put_result(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_found_result whole;
	ob_mail_record restored = { .worker = r->worker, .kind = OB_RECORD_RESTORED, .bytes = sizeof whole };
	const ob_found_result *found = r->data; // valid up to its motion, in both layouts
	if (!ob_committer_is_result(u, r) || !ob_is_sound_state(found->state)) // the commit will report it
		return;
	const bool restores = ob_halo_address(c->cluster->parts.halo, u, found->id, all, c->to);
	if (restores)
		restored.data = ob_committer_result_of(u, r, &whole);
	bool kept; // not used: the commit here tests the motion itself
	for (uint32_t to = 0; to < c->ranks; to++) {
		if (to == c->rank || !c->to[to])
			continue;
		if (!restores)
			c->sent[to] = ob_committer_digest_before(c, u, found->id, c->sent[to], &kept);
		ob_mail_append_record(&c->dealt[to], restores ? &restored : r);
	}
}

// Finds the ranks that need the result of a check of two ranks' bodies: all, if the pair links them or did; else the
// home ranks of both. No rank needs that of other checks.
static void find_concerned(ob_committer *c, const ob_universe *u, const ob_mail_record *r)
{
	const ob_check_record *found = r->data;
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k =
		r->bytes == sizeof *found && found->pair < ob_pairs_end(data) ? &data->pair[found->pair] : NULL;
	const bool across = k && ob_pair_is_across(u, k),
		   all = across && (k->expected || k->late || found->expected || found->late);
	memset(c->to, all, c->ranks * sizeof *c->to);
	for (int side = 0; across && side < 2; side++)
		c->to[ob_home_rank(u, side ? k->b : k->a)] = true;
}

static void put_for_each(ob_committer *c, const ob_universe *u, const ob_mail_record *r, bool all)
{
	ob_mail_record copy = *r;
	if (r->kind == OB_RECORD_RESULT) {
		put_result(c, u, r, all);
		return;
	}
	if (r->kind == OB_RECORD_EFFORT) // it concerns an island, which no other rank has
		return;
	if (r->kind == OB_RECORD_CHECK)
		find_concerned(c, u, r);
	if (r->kind == OB_RECORD_CONTACT && !(copy.bytes = contact_bytes_for_others(c, u, r)))
		return;
	for (uint32_t to = 0; to < c->ranks; to++)
		if (to != c->rank && (r->kind != OB_RECORD_CHECK || c->to[to]))
			ob_mail_append_record(&c->dealt[to], &copy);
}

// Sends each rank the records that it needs: results and checks concern ranks nearby.
static const char *deal_records(ob_committer *c, ob_universe *u, ob_peers_head head)
{
	const bool all = c->cluster->peers.look <= ob_step_count(u) + 1; // a reader needs all motions after this step
	const uint64_t nothing = 0;
	ob_record_reader own = { .mail = ob_committer_mail_of(c, c->rank) };
	ob_mail_record r;
	for (uint32_t to = 0; to < c->ranks; to++) {
		ob_peers_begin(&c->dealt[to]);
		ob_mail_append(&c->dealt[to], &nothing, sizeof nothing);
	}
	memset(c->sent, 0, c->ranks * sizeof *c->sent);
	memset(c->received, 0, c->ranks * sizeof *c->received);
	while (ob_committer_next(c, u, &own, &r))
		put_for_each(c, u, &r, all);
	for (uint32_t to = 0; to < c->ranks; to++)
		if (!c->dealt[to].lost)
			memcpy(c->dealt[to].bytes + sizeof head, &c->sent[to], sizeof *c->sent);
	if (!all && head.phase == OB_PHASE_ISLANDS)
		ob_halo_part(c->cluster->parts.halo);
	c->ahead = sizeof head + sizeof *c->sent;
	return ob_peers_exchange(&c->cluster->peers, u, head, c->dealt, true, &c->at);
}

static const char *say_to_all(ob_committer *c, ob_universe *u, ob_peers_head head)
{
	ob_mail own = ob_committer_mail_of(c, c->rank);
	ob_mail_record r;
	ob_peers_begin(&c->out);
	while (ob_mail_next(u, &own, &r))
		ob_mail_append_record(&c->out, &r);
	c->ahead = sizeof head;
	return ob_peers_exchange(&c->cluster->peers, u, head, &c->out, false, &c->at);
}

bool ob_committer_exchange(ob_committer *c, ob_universe *u, ob_phase phase, uint64_t digest)
{
	const bool islands = phase == OB_PHASE_ISLANDS;
	const uint32_t damaged = islands ? ob_holdings_damaged(c->cluster->parts.holdings, u) : OB_NO_OBJECT;
	const ob_peers_head head = { .phase = phase,
				     .digest = digest,
				     .damaged = damaged != OB_NO_OBJECT ? 1 + damaged : c->damaged,
				     .differs = c->differs,
				     .woken = c->woken };
	c->woken = 0;
	c->dealt_to_each = islands || phase == OB_PHASE_FORECAST || phase == OB_PHASE_LATE_CONTACTS;
	c->all = c->dealt_to_each ? deal_records(c, u, head) : say_to_all(c, u, head);
	return c->all;
}

// ---- record reader

// Reads the mails of simulators' records, some ahead, with prefetch.

enum { NONE = UINT32_MAX };

bool ob_committer_is_result(const ob_universe *u, const ob_mail_record *r)
{
	const ob_steady_record *steady = r->data;
	return (r->bytes == sizeof(ob_found_result) || r->bytes == sizeof *steady) && steady->id < ob_universe_ids(u);
}

const ob_found_result *ob_committer_result_of(const ob_universe *u, const ob_mail_record *from, ob_found_result *whole)
{
	const ob_steady_record *steady = from->data;
	char *motion = (char *)&whole->motion;
	if (!ob_committer_is_result(u, from))
		return NULL;
	if (from->bytes == sizeof *whole)
		return from->data;
	whole->id = steady->id, whole->state = steady->state, whole->due = steady->due, whole->reserved = 0;
	memcpy(motion, steady->motion, OB_MOTION_ACCELERATION);
	whole->motion.a = ob_newest_motion(u, steady->id)->a;
	memcpy(motion + OB_MOTION_BEHIND_IT, steady->motion + OB_MOTION_ACCELERATION,
	       sizeof whole->motion - OB_MOTION_BEHIND_IT);
	return whole;
}

ob_mail ob_committer_mail_of(const ob_committer *c, uint32_t rank)
{
	if (!c->all || rank == c->rank)
		return (ob_mail){ .bytes = c->mail.bytes, .used = c->mail.used };
	const size_t begin = c->at[rank] + c->ahead;
	return (ob_mail){ .bytes = (char *)c->all + begin, .used = c->at[rank + 1] - begin };
}

uint64_t ob_committer_digest_before(const ob_committer *c, const ob_universe *u, uint32_t id, uint64_t sum, bool *whole)
{
	uint64_t digest;
	*whole = ob_halo_digest(c->cluster->parts.halo, u, id, &digest);
	return ob_digest_word(sum + id, digest);
}

// ---- with prefetch

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
	if (c->cluster)
		ob_halo_prefetch(c->cluster->parts.halo, id);
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
	if (c->cluster)
		ob_holdings_prefetch(c->cluster->parts.holdings, record);
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
