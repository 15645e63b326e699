#include "sim/island_builder.h"

#include <string.h>

#include "sim/broadphase.h"

enum { NONE = UINT32_MAX };
enum { CHUNK_WORK_MIN = 48 }; // work of a chunk, some us: for less the gate would cost more than another worker gains

// What the scheduling worker builds islands with: a union-find forest, whose roots are the lowest ids of their trees.
typedef struct builder {
	ob_universe *u;
	ob_step_data *data;
	uint32_t ids;
	uint32_t *parent; // [id]
	uint32_t *island_of; // [root]
	uint32_t *previous; // [id]: its island before islands were merged; NULL = those of a new step are built
	uint64_t step; // that they are for
} builder;

// A parent is below its child, so this ends, whatever somebody has written there.
static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] < i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static bool is_dynamic(const builder *p, uint32_t id)
{
	return p->data->schedule[id].state >= OB_SCHEDULE_AWAKE;
}

// In no island unless something wakes it. False for what has fallen asleep in this very step.
static bool is_asleep(const builder *p, uint32_t id)
{
	return p->data->schedule[id].state >= OB_SCHEDULE_ASLEEP && (!p->previous || p->previous[id] == NONE);
}

// True if the object must be solved in this step, whatever comes near it; false in free flight.
static bool is_due(const builder *p, uint32_t id)
{
	return p->previous ? p->previous[id] != NONE : p->data->schedule[id].due <= p->step;
}

// True if the link between the two makes both be solved in this step.
static bool involves(const builder *p, const ob_pair_key *k)
{
	const ob_schedule *a = &p->data->schedule[k->a], *b = &p->data->schedule[k->b];
	return p->previous ? k->late : ob_schedule_moves(a) || ob_schedule_moves(b);
}

static bool joins_islands(const builder *p, const ob_pair_key *k)
{
	if (!is_dynamic(p, k->a) || !is_dynamic(p, k->b))
		return false;
	return !p->previous || k->late || (k->active && is_asleep(p, k->a) && is_asleep(p, k->b));
}

static void union_trees(builder *p, uint32_t i, uint32_t j)
{
	uint32_t a = root_of(p->parent, i), b = root_of(p->parent, j);
	if (a < b)
		p->parent[b] = a;
	else
		p->parent[a] = b;
}

static bool is_in_range(const builder *p, const ob_pair_key *k)
{
	return ob_object_in_range(p->data, k->a) && ob_object_in_range(p->data, k->b);
}

// Only pairs that touch or are expected to link anything: few of all pairs, told by their flags alone.
static bool is_link(const builder *p, const ob_pair_key *k)
{
	return (k->active | (p->previous ? k->late : k->expected)) && is_in_range(p, k);
}

// Also notes which objects the links involve: island_of is 0 there.
static void join_islands(builder *p)
{
	ob_step_data *data = p->data;
	for (uint32_t id = 0; id < p->ids; id++)
		p->parent[id] = id;
	memset(p->island_of, 0xff, p->ids * sizeof *p->island_of); // NONE
	for (uint32_t i = 0; p->previous && i < data->count->islands; i++) {
		const uint32_t *member = data->member + data->island[i].first_member;
		for (uint32_t k = 1; k < data->island[i].members; k++)
			union_trees(p, member[0], member[k]);
	}
	for (uint32_t i = 0; i < ob_pairs_count(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (!is_link(p, k))
			continue;
		if (involves(p, k))
			p->island_of[is_dynamic(p, k->a) ? k->a : k->b] = 0;
		if (joins_islands(p, k))
			union_trees(p, k->a, k->b);
	}
}

// Numbers the awake trees by their lowest id and lists their members in ascending order.
static void list_members(builder *p)
{
	ob_step_data *data = p->data;
	uint32_t n = 0, total = 0;
	for (uint32_t id = 0; id < p->ids; id++) // a tree with one member that is due, or involved, is solved
		if (is_dynamic(p, id) && (p->island_of[id] != NONE || is_due(p, id)))
			p->island_of[root_of(p->parent, id)] = 0;
	for (uint32_t id = 0; id < p->ids; id++) {
		uint32_t root = root_of(p->parent, id);
		data->result_island[id] = NONE;
		if (p->island_of[root] == NONE || !is_dynamic(p, id))
			continue;
		if (root == id) {
			p->island_of[id] = n;
			data->island[n++] = (ob_island){ .first_member = 0 };
		}
		data->result_island[id] = p->island_of[root];
		data->island[p->island_of[root]].members++;
	}
	for (uint32_t i = 0; i < n; i++) {
		data->island[i].first_member = total;
		total += data->island[i].members;
		data->island[i].members = 0;
	}
	for (uint32_t id = 0; id < p->ids; id++)
		if (data->result_island[id] != NONE) {
			ob_island *is = &data->island[data->result_island[id]];
			data->member[is->first_member + is->members++] = id;
		}
	data->count->islands = n;
}

// A solution stands if the island has the members that it had, and none of them has a late contact.
static void mark_solved(builder *p)
{
	ob_step_data *data = p->data;
	for (uint32_t i = 0; i < data->count->islands; i++) {
		const uint32_t *member = data->member + data->island[i].first_member;
		data->island[i].solved = 1;
		for (uint32_t k = 0; k < data->island[i].members; k++)
			if (p->previous[member[k]] == NONE || p->previous[member[k]] != p->previous[member[0]])
				data->island[i].solved = 0;
	}
	for (uint32_t i = 0; i < ob_pairs_count(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->late)
			data->island[data->result_island[is_dynamic(p, k->a) ? k->a : k->b]].solved = 0;
	}
}

static bool is_solved_again(const builder *p, uint32_t island)
{
	return island != NONE && !p->data->island[island].solved;
}

// The island that solves a pair: pairs of its members, and of a member and what does not move; NONE if they cannot
// touch in this step. What a step has found out about a pair is void if its island is solved again.
static uint32_t island_of_pair(const builder *p, ob_pair_key *k)
{
	const uint32_t ia = p->data->result_island[k->a], ib = p->data->result_island[k->b], i = ia != NONE ? ia : ib;
	if (p->previous && (is_solved_again(p, ia) || is_solved_again(p, ib)))
		k->limit = -INFINITY;
	if (i == NONE || (ia != ib && ((ia != NONE && ib != NONE) || (is_dynamic(p, k->a) && is_dynamic(p, k->b)))))
		return NONE;
	if (p->previous && p->data->island[i].solved)
		return k->in_island ? i : NONE;
	if (k->active)
		return i;
	const ob_schedule *a = &p->data->schedule[k->a], *b = &p->data->schedule[k->b];
	double paths = ob_schedule_path(a, p->step) + ob_schedule_path(b, p->step);
	return a->reach + b->reach >= k->limit - paths ? i : NONE;
}

static void list_pairs(builder *p)
{
	ob_step_data *data = p->data;
	uint32_t total = 0;
	for (uint32_t i = 0; i < ob_pairs_count(data); i++) {
		ob_pair_key *k = &data->pair[i];
		uint32_t island = is_in_range(p, k) ? island_of_pair(p, k) : NONE;
		if (k->in_island != (island != NONE))
			k->in_island = island != NONE;
		if (k->record != OB_NO_RECORD && !p->previous && !k->active)
			ob_pair_release_record(p->u, k);
		if (island != NONE)
			data->island[island].pairs++;
	}
	for (uint32_t i = 0; i < data->count->islands; i++) {
		data->island[i].first_pair = total;
		total += data->island[i].pairs;
		data->island[i].pairs = 0;
	}
	for (uint32_t i = 0; i < ob_pairs_count(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (!k->in_island)
			continue;
		uint32_t ia = data->result_island[k->a];
		ob_island *is = &data->island[ia != NONE ? ia : data->result_island[k->b]];
		data->island_pair[is->first_pair + is->pairs++] = i;
	}
}

// What its members have cost in the last step, and at least what islands of such a size do.
static uint32_t estimated_work(const builder *p, const ob_island *is)
{
	uint32_t sum = 1 + is->members + 8 * is->pairs;
	for (uint32_t k = 0; is->pairs && k < is->members; k++)
		sum += p->data->effort[p->data->member[is->first_member + k]];
	return sum;
}

// island[i] becomes what island[from[i]] was. from is overwritten.
static void permute_islands(ob_island *island, uint32_t *from, uint32_t n)
{
	for (uint32_t i = 0; i < n; i++) {
		const ob_island first = island[i];
		uint32_t to = i;
		for (uint32_t k = from[to]; k != i; to = k, k = from[to]) {
			island[to] = island[k];
			from[to] = to;
		}
		island[to] = first;
		from[to] = to;
	}
}

// The largest first, stable; islands that are not to be solved have no work. A radix sort: islands come by the ten
// thousand, and there are no more than two or three digits.
static void sort_by_work(builder *p)
{
	enum { BITS = 8, DIGITS = 1 << BITS };
	const ob_island *island = p->data->island;
	uint32_t n = p->data->count->islands, *from = p->parent, *to = p->island_of,
		 largest = 0; // whose contents are no longer needed
	for (uint32_t i = 0; i < n; i++) {
		from[i] = i;
		largest = island[i].work > largest ? island[i].work : largest;
	}
	for (uint32_t shift = 0; shift < 32 && largest >> shift; shift += BITS) {
		uint32_t first[DIGITS] = { 0 }, *digits = from;
		for (uint32_t i = 0; i < n; i++)
			first[island[i].work >> shift & (DIGITS - 1)]++;
		for (uint32_t d = DIGITS, sum = 0, there; d-- > 0; sum += there)
			there = first[d], first[d] = sum;
		for (uint32_t i = 0; i < n; i++)
			to[first[island[from[i]].work >> shift & (DIGITS - 1)]++] = from[i];
		from = to;
		to = digits;
	}
	permute_islands(p->data->island, from, n);
}

// Largest first, so that no worker starts on a large one when the others are done; small ones several at a time.
static void make_chunks(builder *p)
{
	ob_step_data *data = p->data;
	uint64_t total = 0, filled = 0;
	uint32_t n = data->count->islands, unsolved = 0, chunks = 0;
	for (uint32_t i = 0; i < n; i++)
		data->island[i].work = data->island[i].solved ? 0 : estimated_work(p, &data->island[i]);
	sort_by_work(p);
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t m = 0; m < data->island[i].members; m++)
			data->result_island[data->member[data->island[i].first_member + m]] = i;
		if (data->island[i].solved)
			continue;
		total += data->island[i].work;
		unsolved++;
	}
	uint64_t share = total / (16 * (uint64_t)ob_universe_workers(p->u)) + 1;
	share = share > CHUNK_WORK_MIN ? share : CHUNK_WORK_MIN;
	for (uint32_t i = 0; i < unsolved; i++) {
		if (i == 0 || filled >= share)
			data->chunk[chunks++] = i, filled = 0;
		filled += data->island[i].work;
	}
	data->chunk[chunks] = unsolved;
	data->count->chunks = chunks;
}

static void build(builder *p)
{
	join_islands(p);
	list_members(p);
	if (p->previous)
		mark_solved(p);
	list_pairs(p);
	make_chunks(p);
}

void ob_islands_build(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	uint32_t ids = ob_universe_ids(u);
	data->count->merged = 0;
	build(&(builder){ u, data, ids, data->scratch, data->scratch + ids, NULL, ob_step_count(u) });
}

void ob_islands_merge(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	uint32_t ids = ob_universe_ids(u), *previous = data->scratch + 2 * ids;
	data->count->merged = 1;
	memcpy(previous, data->result_island, ids * sizeof *previous);
	build(&(builder){ u, data, ids, data->scratch, data->scratch + ids, previous, ob_step_count(u) });
}
