#include "step/prefetch.h"

enum { PREFETCHED_MAX = 12, LINE = 64 }; // members and pairs of an island; bytes of a cache line

static inline void prefetch(const void *from, size_t bytes)
{
	for (size_t i = 0; i < bytes; i += LINE)
		__builtin_prefetch((const char *)from + i);
}

static void prefetch_object(ob_sim *s, uint32_t id)
{
	prefetch(ob_newest_motion(s->u, id), sizeof(ob_motion));
	prefetch(ob_passport_of(s->u, id), sizeof(ob_passport));
}

void ob_prefetch_schedule(const ob_universe *u, const ob_pair_key *k)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t id[2] = { k->a, k->b };
	for (int i = 0; i < 2; i++) {
		__builtin_prefetch(&data->schedule[id[i]]);
		__builtin_prefetch(&data->result_island[id[i]]);
		ob_prefetch_versions(u, id[i]);
	}
}

void ob_prefetch_checks(const ob_step_data *data, uint32_t i, uint32_t end)
{
	enum { PAIR_AHEAD = 16, BODIES_AHEAD = 8 };
	if (i + PAIR_AHEAD < end)
		__builtin_prefetch(&data->pair[data->check[i + PAIR_AHEAD]]);
	if (i + BODIES_AHEAD >= end)
		return;
	const ob_pair_key *k = &data->pair[data->check[i + BODIES_AHEAD]];
	__builtin_prefetch(&data->schedule[k->a]);
	__builtin_prefetch(&data->schedule[k->b]);
	__builtin_prefetch(&data->home[k->a]);
}

void ob_prefetch_link(const ob_universe *u, uint32_t link)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (!link)
		return;
	__builtin_prefetch(&data->pair[(link - 1) / 2]);
	__builtin_prefetch(&data->pair_links[(link - 1) / 2]);
}

void ob_prefetch_lists(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end)
{
	enum { HEAD_AHEAD = 16, PAIR_AHEAD = 8 };
	const ob_step_data *data = ob_universe_step_data(u);
	if (i + HEAD_AHEAD < end)
		__builtin_prefetch(&data->first_pair[ids[i + HEAD_AHEAD]]);
	if (i + PAIR_AHEAD < end && ids[i + PAIR_AHEAD] < data->objects_max)
		ob_prefetch_link(u, data->first_pair[ids[i + PAIR_AHEAD]]);
}

void ob_prefetch_pairs_of(const ob_universe *u, uint32_t i)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_prefetch_lists(u, data->member, i, data->objects_max);
}

void ob_prefetch_pair(ob_sim *s, const ob_pair_key *k)
{
	prefetch_object(s, k->a);
	prefetch_object(s, k->b);
}

void ob_prefetch_members(const ob_universe *u, uint32_t i)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_island *is = &data->island[i];
	for (uint32_t k = 0; k < is->members && k < PREFETCHED_MAX; k++)
		ob_prefetch_versions(u, data->member[is->first_member + k]);
}

void ob_prefetch_query(const ob_universe *u, uint32_t id)
{
	__builtin_prefetch(ob_universe_step_data(u)->bounds[id]);
	ob_prefetch_versions(u, id);
}

void ob_prefetch_island(ob_sim *s, uint32_t i)
{
	const ob_step_data *data = s->data;
	const ob_island *is = &data->island[i];
	for (uint32_t k = 0; k < is->members && k < PREFETCHED_MAX; k++)
		prefetch_object(s, data->member[is->first_member + k]);
	// Prefetches the version written in the last step, if the pair was solved then.
	const uint64_t step = ob_step_count(s->u);
	for (uint32_t k = 0; k < is->pairs && k < PREFETCHED_MAX; k++) {
		const ob_pair_key *key = &data->pair[data->island_pair[is->first_pair + k]];
		const ob_pair_record *r = &data->record[key->record];
		if (!key->active)
			continue;
		prefetch(r->stamp, sizeof r->stamp);
		prefetch(&r->version[step & 1], sizeof r->version[0]);
		prefetch(&r->version[~step & 1], sizeof r->version[0]);
	}
}
