// Reads the mails of simulators' records, some ahead, with prefetch.
#include <stddef.h>
#include <string.h>

#include "cluster/digest.h"
#include "exchange/committer.h"

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
