#include "sim/prefetch.h"

enum { MOST = 12, LINE = 64 }; // members and pairs of an island; bytes of a cache line

static inline void fetch(const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes; i += LINE)
		__builtin_prefetch((const char *)from + i);
}

static void fetch_object(ob_sim *s, uint32_t id)
{
	fetch(ob_newest_motion(s->u, id), sizeof(ob_motion));
	fetch(ob_passport_of(s->u, id), sizeof(ob_passport));
}

void ob_prefetch_pair(ob_sim *s, const ob_pair_key *k)
{
	fetch_object(s, k->a);
	fetch_object(s, k->b);
}

void ob_prefetch_island(ob_sim *s, uint32_t i)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	const ob_island *is = &ex->island[i];
	for (uint32_t k = 0; k < is->members && k < MOST; k++)
		fetch_object(s, ex->member[is->first_member + k]);
	// The version that was written in the last step, if the pair was solved then.
	const uint64_t step = ob_step_count(s->u);
	for (uint32_t k = 0; k < is->pairs && k < MOST; k++) {
		const ob_pair_key *key = &ex->pair[ex->island_pair[is->first_pair + k]];
		const ob_pair_record *r = &ex->record[key->record];
		if (!key->active)
			continue;
		fetch(r->stamp, sizeof r->stamp);
		fetch(&r->version[step & 1], sizeof r->version[0]);
		fetch(&r->version[~step & 1], sizeof r->version[0]);
	}
}
