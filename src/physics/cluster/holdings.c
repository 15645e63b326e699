#include "cluster/holdings.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "cluster/peers.h"
#include "schedule/pair_checks.h"
#include "table/home.h"

enum { ALL = 0 }; // a holder

struct ob_holdings {
	uint16_t *holder; // [record]: 1 + a rank, or ALL. A holder that is another rank may have passed it on since
	uint64_t (*digest)[2]; // [record], of each version here; 0 = unknown
	ob_mail out;
};

// A record that is sent.
typedef struct parcel {
	ob_parcel head;
	uint32_t pair, stamp; // index of the pair; as ob_pair_record.stamp
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS];
} parcel;

ob_holdings *ob_holdings_create(const ob_universe *u)
{
	const uint32_t records = ob_universe_step_data(u)->pairs_max;
	ob_holdings *h = calloc(1, sizeof *h);
	if (!h)
		return NULL;
	h->holder = calloc(records, sizeof *h->holder);
	h->digest = calloc(records, sizeof *h->digest);
	if (h->holder && h->digest)
		return h;
	ob_holdings_destroy(h);
	return NULL;
}

void ob_holdings_destroy(ob_holdings *h)
{
	if (!h)
		return;
	free(h->holder);
	free(h->digest);
	ob_mail_finish(&h->out);
	free(h);
}

static uint64_t digest_of(const ob_pair_state *state)
{
	return ob_digest_words(state, sizeof *state);
}

// Makes the contents here void: readers and solvers find none.
static void give_away(const ob_universe *u, uint32_t record)
{
	uint32_t *stamp = ob_universe_step_data(u)->record[record].stamp;
	stamp[0] = stamp[1] = 0;
}

void ob_holdings_note(ob_holdings *h, const ob_universe *u, uint32_t record, int version, const ob_pair_state *state,
		      uint32_t rank)
{
	const uint32_t before = h->holder[record];
	h->holder[record] = rank == OB_ALL_RANKS ? ALL : (uint16_t)(1 + rank);
	if (version >= 0)
		h->digest[record][version] = digest_of(state);
	else if (before == ALL || before == 1 + ob_universe_rank(u))
		give_away(u, record);
}

void ob_holdings_prefetch(const ob_holdings *h, uint32_t record)
{
	__builtin_prefetch(&h->holder[record]);
	__builtin_prefetch(h->digest[record], 1);
}

bool ob_holdings_here_alone(const ob_holdings *h, const ob_universe *u, uint32_t record)
{
	return h->holder[record] == 1 + ob_universe_rank(u);
}

// ---- holders

// One past the last island of a chunk to be solved, or less where the universe is damaged.
static uint32_t end_of_chunk(const ob_step_data *data, uint32_t chunk)
{
	const uint32_t end = data->chunk[chunk + 1];
	return end < data->count->islands ? end : data->count->islands;
}

static uint32_t chunks_of(const ob_step_data *data)
{
	return data->count->chunks < data->objects_max ? data->count->chunks : 0;
}

static uint32_t owner_of(const ob_universe *u, uint32_t chunk)
{
	return ob_task_first(u) + ob_task_owner(chunk, ob_task_workers(u));
}

// The k-th pair of an island, if its solver reads the pair's contents; NULL: it does not, or the universe is damaged.
static const ob_pair_key *kept_pair(const ob_step_data *data, const ob_island *is, uint32_t k, uint32_t *pair)
{
	*pair = is->first_pair + k < data->pairs_max ? data->island_pair[is->first_pair + k] : UINT32_MAX;
	if (*pair >= ob_pairs_end(data))
		return NULL;
	const ob_pair_key *key = &data->pair[*pair];
	return key->record < data->pairs_max && (key->active || data->count->merged) ? key : NULL;
}

// Version of the contents before the step; -1: none.
static int version_of(const ob_universe *u, uint32_t record)
{
	return ob_pair_newest(&ob_universe_step_data(u)->record[record], ob_step_count(u));
}

// Bytes of a parcel. Experimental solvers alone have impulses for each of the two sides.
static size_t parcel_bytes(const ob_universe *u)
{
	return ob_solver_is_two_sided(ob_universe_settings(u)->solver) ? sizeof(parcel) : offsetof(parcel, impulse_b);
}

static void pack(ob_mail *to, const ob_universe *u, uint32_t pair, uint32_t record)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const int version = version_of(u, record);
	const size_t bytes = parcel_bytes(u);
	parcel p = { .head = { OB_PARCEL_KEPT, (uint32_t)bytes }, .pair = pair };
	if (version < 0)
		return;
	p.stamp = data->record[record].stamp[version];
	p.state = data->record[record].version[version];
	if (bytes == sizeof p)
		memcpy(p.impulse_b, data->impulse_b[record][version], sizeof p.impulse_b);
	ob_mail_append(to, &p, bytes);
}

// Writes contents that another rank has sent; holder: 1 + the rank that holds them from now on, or ALL.
static bool take(ob_holdings *h, const ob_universe *u, const char *from, size_t bytes, uint16_t holder)
{
	const ob_step_data *data = ob_universe_step_data(u);
	parcel c;
	if (bytes != parcel_bytes(u))
		return false;
	memcpy(&c, from, bytes);
	ob_pair_key *k = c.pair < ob_pairs_end(data) ? &data->pair[c.pair] : NULL;
	const uint32_t record = k ? k->record : OB_NO_RECORD;
	if (record >= data->pairs_max || (holder != ALL && !ob_pair_is_checked_here(u, k)))
		return false;
	h->holder[record] = holder;
	data->record[record].version[0] = c.state;
	data->record[record].stamp[0] = c.stamp;
	data->record[record].stamp[1] = 0;
	if (bytes == sizeof c)
		memcpy(data->impulse_b[record][0], c.impulse_b, sizeof c.impulse_b);
	h->digest[record][0] = digest_of(&c.state);
	return true;
}

bool ob_holdings_take(ob_holdings *h, const ob_universe *u, const char *from, size_t bytes)
{
	return take(h, u, from, bytes, (uint16_t)(1 + ob_universe_rank(u)));
}

void ob_holdings_give(ob_holdings *h, const ob_universe *u, uint32_t id, ob_mail *mail)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t to = ob_home_rank(u, id);
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		ob_pair_key *k = &data->pair[at.pair];
		k->in_island = 0;
		if (k->record >= data->pairs_max || !ob_holdings_here_alone(h, u, k->record))
			continue;
		pack(mail, u, at.pair, k->record);
		give_away(u, k->record);
		h->holder[k->record] = (uint16_t)(1 + to);
	}
}

static bool take_for_all(void *h, ob_universe *u, const char *from, const ob_parcel *head, uint32_t rank)
{
	return head->kind == OB_PARCEL_KEPT && take(h, u, from, head->bytes, ALL);
}

bool ob_holdings_gather(ob_holdings *h, ob_universe *u, ob_peers *p)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_peers_begin(&h->out);
	for (uint32_t pair = 0; pair < ob_pairs_end(data); pair++) {
		const ob_pair_key *k = &data->pair[pair];
		if (k->a == k->b || k->record >= data->pairs_max || h->holder[k->record] == ALL)
			continue;
		if (h->holder[k->record] == 1 + p->rank)
			pack(&h->out, u, pair, k->record);
		h->holder[k->record] = ALL;
	}
	return ob_parcels_exchange(p, u, OB_PEERS_GATHER, &h->out, false, take_for_all, h);
}

// Contents of an island's pairs are prefetched in three steps: keys, stamps, contents.
typedef enum asked_for { KEYS, STAMPS, CONTENTS } asked_for;

static void prefetch_kept(const ob_holdings *h, const ob_universe *u, const ob_island *is, asked_for what)
{
	enum { LINE = 64, MOST = 16 };
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t pair;
	for (uint32_t k = 0; k < is->pairs && k < MOST; k++) {
		if (what == KEYS) {
			if (is->first_pair + k < data->pairs_max)
				__builtin_prefetch(&data->pair[data->island_pair[is->first_pair + k]]);
			continue;
		}
		const ob_pair_key *key = kept_pair(data, is, k, &pair);
		if (!key)
			continue;
		if (what == STAMPS) {
			__builtin_prefetch(data->record[key->record].stamp);
			__builtin_prefetch(h->digest[key->record]);
			continue;
		}
		const int version = version_of(u, key->record);
		const char *contents = (const char *)&data->record[key->record].version[version < 0 ? 0 : version];
		for (size_t at = 0; at < sizeof(ob_pair_state); at += LINE)
			__builtin_prefetch(contents + at);
	}
}

static uint32_t damaged_in(const ob_holdings *h, const ob_universe *u, const ob_island *is)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t pair;
	for (uint32_t k = 0; k < is->pairs; k++) {
		const ob_pair_key *key = kept_pair(data, is, k, &pair);
		const int version = key ? version_of(u, key->record) : -1;
		const uint64_t expected = version < 0 ? 0 : h->digest[key->record][version];
		if (expected && digest_of(&data->record[key->record].version[version]) != expected)
			return key->a < data->objects_max ? key->a : 0;
	}
	return OB_NO_OBJECT;
}

uint32_t ob_holdings_damaged(const ob_holdings *h, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t chunk = 0; chunk < chunks_of(data); chunk++) {
		const uint32_t end = ob_worker_is_here(u, owner_of(u, chunk)) ? end_of_chunk(data, chunk) : 0;
		for (uint32_t i = data->chunk[chunk]; i < end; i++) {
			for (asked_for what = KEYS; what <= CONTENTS; what++) {
				const uint32_t next = i + 2 * (1 + CONTENTS - what);
				if (next < end)
					prefetch_kept(h, u, &data->island[next], what);
			}
			const uint32_t object = damaged_in(h, u, &data->island[i]);
			if (object != OB_NO_OBJECT)
				return object;
		}
	}
	return OB_NO_OBJECT;
}
