#include "cluster/halo.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/peers.h"
#include "schedule/pair_checks.h"
#include "table/home.h"

// Digest of the motion published as this version of the body's; version 0: none is known.
typedef struct known {
	uint64_t version, digest;
} known;

enum { MOTION = 1, BEFORE };

struct ob_halo {
	uint32_t rank, ranks;
	bool partial; // some rank may lack the motion of some body
	// [object], own bodies: another rank may lack MOTION = the motion; BEFORE = the one before this step
	uint8_t *owed;
	uint8_t *inland; // [object], own bodies: 1 = no neighbour was elsewhere when a simulator got it
	uint64_t *sent; // [object], own bodies: bit r = rank r has the motion, for the first 64 ranks
	uint16_t *owner; // [object]: 1 + rank of its home; 0 = not a body
	uint32_t *received; // bodies of other ranks with motions received in this step, published at its end
	uint32_t received_count;
	uint8_t *is_received; // [object]: 1 = it is in received
	known *known; // [object]
	uint64_t *staged; // [object]: digest of its staged motion
	ob_mail *out; // [ranks]: mail to each
};

// A body that is sent: its motion before the step, and after it, if it was solved in it.
typedef struct body_parcel {
	ob_parcel head; // its bytes: all of this, or up to "after"
	uint32_t id, home; // UINT32_MAX: it is not the sender's
	ob_schedule schedule;
	ob_motion before, after;
} body_parcel;

// State of one of the body's pairs.
typedef struct pair_parcel {
	ob_parcel head;
	uint32_t pair, clear_until, clear_as_of, expected;
	double limit;
} pair_parcel;

ob_halo *ob_halo_create(const ob_universe *u)
{
	const uint32_t objects = ob_universe_capacity(u);
	ob_halo *h = calloc(1, sizeof *h);
	if (!h)
		return NULL;
	h->rank = ob_universe_rank(u);
	h->ranks = ob_universe_ranks(u);
	h->owed = calloc(objects, sizeof *h->owed);
	h->inland = calloc(objects, sizeof *h->inland);
	h->sent = calloc(objects, sizeof *h->sent);
	h->owner = calloc(objects, sizeof *h->owner);
	h->received = calloc(objects, sizeof *h->received);
	h->is_received = calloc(objects, sizeof *h->is_received);
	h->known = calloc(objects, sizeof *h->known);
	h->staged = calloc(objects, sizeof *h->staged);
	h->out = calloc(h->ranks, sizeof *h->out);
	if (h->owed && h->inland && h->sent && h->owner && h->received && h->is_received && h->known && h->staged &&
	    h->out)
		return h;
	ob_halo_destroy(h);
	return NULL;
}

void ob_halo_destroy(ob_halo *h)
{
	if (!h)
		return;
	for (uint32_t r = 0; h->out && r < h->ranks; r++)
		ob_mail_finish(&h->out[r]);
	free(h->owed);
	free(h->inland);
	free(h->sent);
	free(h->owner);
	free(h->received);
	free(h->is_received);
	free(h->known);
	free(h->staged);
	free(h->out);
	free(h);
}

void ob_halo_settle(ob_halo *h, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (h->known[id].version != ob_motion_version(u, id))
			h->known[id].version = 0; // another motion was published, which needs no digest
		if (!ob_schedule_is_dynamic(&data->schedule[id]))
			h->owner[id] = 0;
		if (h->owner[id] || !ob_schedule_is_dynamic(&data->schedule[id]))
			continue;
		ob_home_set(u, id, ob_home_of(u, id)); // keeps it when the number of objects changes
		h->owner[id] = (uint16_t)(1 + ob_home_rank(u, id));
	}
}

bool ob_halo_is_partial(const ob_halo *h)
{
	return h->partial;
}

void ob_halo_part(ob_halo *h)
{
	h->partial = true;
}

// ---- digests

static uint64_t digest_of(const ob_motion *m)
{
	return ob_digest_words(m, sizeof *m);
}

bool ob_halo_digest(const ob_halo *h, const ob_universe *u, uint32_t id, uint64_t *digest)
{
	const known *k = &h->known[id];
	*digest = digest_of(ob_newest_motion(u, id));
	return !k->version || (k->version == ob_motion_version(u, id) && k->digest == *digest);
}

void ob_halo_note(ob_halo *h, uint32_t id, const ob_motion *staged)
{
	h->staged[id] = digest_of(staged);
	if (h->owner[id] == 1 + h->rank || h->is_received[id])
		return;
	h->is_received[id] = 1;
	h->received[h->received_count++] = id;
}

bool ob_halo_take_received(ob_halo *h, uint32_t *id)
{
	while (h && h->received_count) {
		*id = h->received[--h->received_count];
		h->is_received[*id] = 0;
		if (h->owner[*id] != 1 + h->rank) // else it moved here since, and was solved again
			return true;
	}
	return false;
}

void ob_halo_note_published(ob_halo *h, const ob_universe *u, uint32_t id)
{
	if (!h)
		return;
	h->known[id] = (known){ ob_motion_version(u, id), h->staged[id] };
	if (h->owed[id] == BEFORE)
		h->owed[id] = 0;
}

// ---- ranks that are sent a motion

static uint64_t bit_of(uint32_t rank)
{
	return rank < 64 ? UINT64_C(1) << rank : 0;
}

static void note_sent(ob_halo *h, uint32_t id, uint32_t rank)
{
	h->sent[id] |= bit_of(rank);
}

void ob_halo_prefetch(const ob_halo *h, uint32_t id)
{
	__builtin_prefetch(&h->known[id]);
	__builtin_prefetch(&h->staged[id], 1);
	__builtin_prefetch(&h->owner[id]);
}

bool ob_halo_is_elsewhere(const ob_halo *h, uint32_t id)
{
	return h && h->owner[id] && h->owner[id] != 1 + h->rank;
}

void ob_halo_note_border(ob_halo *h, uint32_t id, bool is_at)
{
	if (h)
		h->inland[id] = !is_at;
}

bool ob_halo_address(ob_halo *h, const ob_universe *u, uint32_t id, bool all, bool *to)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint64_t sent = data->count->merged ? h->sent[id] : 0; // void after a merge
	ob_pair_place at;
	for (uint32_t r = 0; r < h->ranks; r++)
		to[r] = all || sent & bit_of(r);
	for (uint32_t link = all || h->inland[id] ? 0 : data->first_pair[id]; ob_pair_at(data, link, &at);
	     link = ob_pair_next(data, at)) {
		const uint32_t other = at.side ? data->pair[at.pair].a : data->pair[at.pair].b;
		if (ob_object_in_range(data, other) && h->owner[other])
			to[h->owner[other] - 1] = true;
	}
	to[ob_universe_rank(u)] = true;
	if (all && h->owed[id])
		h->owed[id] = BEFORE;
	h->sent[id] = 0;
	for (uint32_t r = 0; r < h->ranks; r++) {
		if (!to[r])
			h->owed[id] = MOTION;
		else if (!all || !h->owed[id]) // else it may lack the motion before the step
			note_sent(h, id, r);
	}
	return all && h->owed[id];
}

// ---- parcels

// True if a rank has solved the body in this step, as far as this rank knows.
static bool was_solved(const ob_universe *u, uint32_t id)
{
	return ob_universe_step_data(u)->schedule[id].since > ob_step_count(u);
}

// Packs a body; after: with the motion found in this step.
static void pack_body(ob_mail *to, const ob_universe *u, uint32_t id, bool after)
{
	body_parcel b = { .head = { OB_PARCEL_BODY, after ? sizeof b : offsetof(body_parcel, after) },
			  .id = id,
			  .home = ob_worker_is_here(u, ob_home_of(u, id)) ? ob_home_of(u, id) : UINT32_MAX,
			  .schedule = ob_universe_step_data(u)->schedule[id],
			  .before = *ob_newest_motion(u, id) };
	if (after)
		b.after = *ob_staged_motion(u, id);
	ob_mail_append(to, &b, b.head.bytes);
}

static void pack_pair(ob_mail *to, const ob_universe *u, uint32_t pair)
{
	const ob_pair_key *k = &ob_universe_step_data(u)->pair[pair];
	const pair_parcel p = {
		{ OB_PARCEL_PAIR, sizeof p }, pair, k->clear_until, k->clear_as_of, k->expected, k->limit
	};
	ob_mail_append(to, &p, sizeof p);
}

static bool take_body(ob_halo *h, ob_universe *u, const char *from, size_t bytes)
{
	const bool after = bytes == sizeof(body_parcel);
	body_parcel b;
	if (!after && bytes != offsetof(body_parcel, after))
		return false;
	memcpy(&b, from, bytes);
	const uint32_t id = b.id;
	if (id >= ob_universe_ids(u) || (b.home != UINT32_MAX && b.home >= ob_universe_simulators(u)))
		return false;
	if (b.home != UINT32_MAX)
		ob_home_set(u, id, b.home);
	if (memcmp(&b.before, ob_newest_motion(u, id), sizeof b.before) != 0) {
		ob_publish_motion(u, id, &b.before);
		h->known[id] = (known){ ob_motion_version(u, id), digest_of(&b.before) };
	}
	ob_universe_step_data(u)->schedule[id] = b.schedule;
	if (after) {
		ob_stage_motion(u, id, &b.after);
		ob_halo_note(h, id, &b.after);
	}
	return true;
}

static bool take_pair(const ob_universe *u, const char *from, size_t bytes)
{
	const ob_step_data *data = ob_universe_step_data(u);
	pair_parcel p;
	if (bytes != sizeof p)
		return false;
	memcpy(&p, from, sizeof p);
	if (p.pair >= ob_pairs_end(data))
		return false;
	ob_pair_key *k = &data->pair[p.pair];
	k->limit = p.limit;
	k->clear_until = p.clear_until;
	k->clear_as_of = p.clear_as_of;
	k->expected = p.expected != 0;
	return true;
}

bool ob_halo_take(ob_halo *h, ob_universe *u, const char *parcel, const ob_parcel *head)
{
	return head->kind == OB_PARCEL_BODY ? take_body(h, u, parcel, head->bytes)
					    : head->kind == OB_PARCEL_PAIR && take_pair(u, parcel, head->bytes);
}

static bool take(void *halo, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from)
{
	return ob_halo_take(halo, u, parcel, head);
}

// ---- exchanges

bool ob_halo_meet(ob_halo *h, ob_universe *u, ob_peers *p)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t checks = ob_checks_count(data);
	bool meet = false;
	for (uint32_t r = 0; r < h->ranks; r++)
		ob_peers_begin(&h->out[r]);
	for (uint32_t i = 0; h->partial && i < checks; i++) {
		const ob_pair_key *k = &data->pair[data->check[i]];
		if (!ob_pair_is_across(u, k))
			continue;
		meet = true;
		for (int side = 0; side < 2; side++) {
			const uint32_t id = side ? k->b : k->a, to = ob_home_rank(u, side ? k->a : k->b);
			if (ob_home_rank(u, id) != p->rank || h->sent[id] & bit_of(to))
				continue;
			pack_body(&h->out[to], u, id, was_solved(u, id));
			note_sent(h, id, to);
		}
	}
	return !meet || ob_parcels_exchange(p, u, OB_PEERS_MEET, h->out, true, take, h);
}

void ob_halo_rehome(ob_halo *h, ob_universe *u, uint32_t id, uint32_t simulator)
{
	ob_home_set(u, id, simulator);
	h->owner[id] = (uint16_t)(1 + ob_home_rank(u, id));
	h->owed[id] = h->partial ? MOTION : 0;
	h->sent[id] = 0;
}

void ob_halo_give(const ob_halo *h, const ob_universe *u, uint32_t id, ob_mail *mail)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t to = ob_home_rank(u, id);
	ob_pair_place at;
	if (h->partial)
		pack_body(mail, u, id, false);
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		const uint32_t other = at.side ? data->pair[at.pair].a : data->pair[at.pair].b;
		pack_pair(mail, u, at.pair);
		data->pair[at.pair].late = 0; // islands were merged for it; without this it would stay late here
		if (h->partial && ob_object_in_range(data, other) && ob_schedule_is_dynamic(&data->schedule[other]) &&
		    ob_home_rank(u, other) != to)
			pack_body(mail, u, other, data->count->merged && was_solved(u, other));
	}
}

bool ob_halo_share_pairs(ob_halo *h, ob_universe *u, ob_peers *p)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_peers_begin(&h->out[0]);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->a != k->b && ob_object_in_range(data, k->a) && ob_object_in_range(data, k->b) &&
		    ob_pair_is_checked_here(u, k))
			pack_pair(&h->out[0], u, i);
	}
	return ob_parcels_exchange(p, u, OB_PEERS_GATHER, &h->out[0], false, take, h);
}

bool ob_halo_gather(ob_halo *h, ob_universe *u, ob_peers *p)
{
	const uint32_t ids = ob_universe_ids(u);
	ob_peers_begin(&h->out[0]);
	for (uint32_t id = 0; id < ids; id++)
		if (h->owner[id] == 1 + p->rank && h->owed[id])
			pack_body(&h->out[0], u, id, false);
	if (!ob_parcels_exchange(p, u, OB_PEERS_LOOK, &h->out[0], false, take, h))
		return false;
	h->partial = false;
	memset(h->owed, 0, ids * sizeof *h->owed);
	return true;
}
