#include "sim/island_builder.h"

#include <string.h>

#include "sim/broadphase.h"

enum { NONE = UINT32_MAX };
enum { LEAST_SHARE = 48 }; // work of a chunk, some us: for less the gate would cost more than a second worker gains

// The arranger's view while it plans: a union-find forest of islands, whose roots are the lowest ids of their trees.
typedef struct plan {
	ob_universe *u;
	ob_step_data *ex;
	uint32_t ids;
	uint32_t *parent; // [id]
	uint32_t *island_of; // [root]
	uint32_t *before; // [id]: its island of the plan that is mended; NULL = this is the step's first
	uint64_t step; // that is planned
} plan;

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static bool dynamic(const plan *p, uint32_t id)
{
	return p->ex->schedule[id].state >= OB_SCHEDULE_AWAKE;
}

// In no island unless something wakes it. What fell asleep in this very step is not.
static bool asleep(const plan *p, uint32_t id)
{
	return p->ex->schedule[id].state >= OB_SCHEDULE_ASLEEP && (!p->before || p->before[id] == NONE);
}

// Must the object be looked after in this step, whatever comes near it? What flies by itself need not.
static bool due(const plan *p, uint32_t id)
{
	return p->before ? p->before[id] != NONE : p->ex->schedule[id].due <= p->step;
}

// Does what links the two draw both into the step?
static bool draws(const plan *p, const ob_pair_key *k)
{
	const ob_schedule *a = &p->ex->schedule[k->a], *b = &p->ex->schedule[k->b];
	return p->before ? k->late : a->state == OB_SCHEDULE_AWAKE || b->state == OB_SCHEDULE_AWAKE;
}

static bool joins(const plan *p, const ob_pair_key *k)
{
	if (!dynamic(p, k->a) || !dynamic(p, k->b))
		return false;
	return !p->before || k->late || (k->active && asleep(p, k->a) && asleep(p, k->b));
}

static void unite(plan *p, uint32_t i, uint32_t j)
{
	uint32_t a = root_of(p->parent, i), b = root_of(p->parent, j);
	if (a < b)
		p->parent[b] = a;
	else
		p->parent[a] = b;
}

// Only pairs that touch or come near link anything: few of all there are, told by their flags alone.
static bool links(const plan *p, const ob_pair_key *k)
{
	return k->active | (p->before ? k->late : k->expected);
}

// Notes whom they draw into the step, too: island_of is 0 there.
static void grow_islands(plan *p)
{
	ob_step_data *ex = p->ex;
	for (uint32_t id = 0; id < p->ids; id++)
		p->parent[id] = id;
	memset(p->island_of, 0xff, p->ids * sizeof *p->island_of); // NONE
	for (uint32_t i = 0; p->before && i < ex->count->islands; i++) {
		const uint32_t *member = ex->member + ex->island[i].first_member;
		for (uint32_t k = 1; k < ex->island[i].members; k++)
			unite(p, member[0], member[k]);
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		if (!links(p, k))
			continue;
		if (draws(p, k))
			p->island_of[dynamic(p, k->a) ? k->a : k->b] = 0;
		if (joins(p, k))
			unite(p, k->a, k->b);
	}
}

// Numbers the awake trees by their lowest id and lists their members in ascending order.
static void list_members(plan *p)
{
	ob_step_data *ex = p->ex;
	uint32_t n = 0, total = 0;
	for (uint32_t id = 0; id < p->ids; id++) // a tree with one member that is due, or drawn, is solved
		if (dynamic(p, id) && (p->island_of[id] != NONE || due(p, id)))
			p->island_of[root_of(p->parent, id)] = 0;
	for (uint32_t id = 0; id < p->ids; id++) {
		uint32_t root = root_of(p->parent, id);
		ex->result_island[id] = NONE;
		if (p->island_of[root] == NONE || !dynamic(p, id))
			continue;
		if (root == id) {
			p->island_of[id] = n;
			ex->island[n++] = (ob_island){ .first_member = 0 };
		}
		ex->result_island[id] = p->island_of[root];
		ex->island[p->island_of[root]].members++;
	}
	for (uint32_t i = 0; i < n; i++) {
		ex->island[i].first_member = total;
		total += ex->island[i].members;
		ex->island[i].members = 0;
	}
	for (uint32_t id = 0; id < p->ids; id++)
		if (ex->result_island[id] != NONE) {
			ob_island *is = &ex->island[ex->result_island[id]];
			ex->member[is->first_member + is->members++] = id;
		}
	ex->count->islands = n;
}

// An island that stands has the members that it had, and none of them met anything.
static void mark_solved(plan *p)
{
	ob_step_data *ex = p->ex;
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		const uint32_t *member = ex->member + ex->island[i].first_member;
		ex->island[i].solved = 1;
		for (uint32_t k = 0; k < ex->island[i].members; k++)
			if (p->before[member[k]] == NONE || p->before[member[k]] != p->before[member[0]])
				ex->island[i].solved = 0;
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		if (k->late)
			ex->island[ex->result_island[dynamic(p, k->a) ? k->a : k->b]].solved = 0;
	}
}

static bool again(const plan *p, uint32_t island)
{
	return island != NONE && !p->ex->island[island].solved;
}

// Whose solver looks after a pair: what members of one island may touch, and the fixed ones around them. Of what is
// solved again nothing is known that was found in the step. What does not move is in no island.
static uint32_t island_of_pair(const plan *p, ob_pair_key *k)
{
	const uint32_t ia = p->ex->result_island[k->a], ib = p->ex->result_island[k->b], i = ia != NONE ? ia : ib;
	if (p->before && (again(p, ia) || again(p, ib)))
		k->limit = -INFINITY;
	if (i == NONE || (ia != ib && ((ia != NONE && ib != NONE) || (dynamic(p, k->a) && dynamic(p, k->b)))))
		return NONE;
	if (p->before && p->ex->island[i].solved)
		return k->in_island ? i : NONE;
	if (k->active)
		return i;
	const ob_schedule *a = &p->ex->schedule[k->a], *b = &p->ex->schedule[k->b];
	double paths = ob_schedule_path(a, p->step) + ob_schedule_path(b, p->step);
	return a->reach + b->reach >= k->limit - paths ? i : NONE;
}

static void list_pairs(plan *p)
{
	ob_step_data *ex = p->ex;
	uint32_t total = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		ob_pair_key *k = &ex->pair[i];
		uint32_t island = island_of_pair(p, k);
		if (k->in_island != (island != NONE))
			k->in_island = island != NONE;
		if (k->record != OB_NO_RECORD && !p->before && !k->active)
			ob_pair_let_go(p->u, k);
		if (island != NONE)
			ex->island[island].pairs++;
	}
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		ex->island[i].first_pair = total;
		total += ex->island[i].pairs;
		ex->island[i].pairs = 0;
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		if (!k->in_island)
			continue;
		uint32_t ia = ex->result_island[k->a];
		ob_island *is = &ex->island[ia != NONE ? ia : ex->result_island[k->b]];
		ex->island_pair[is->first_pair + is->pairs++] = i;
	}
}

// What its members have cost in the last step, or at least what islands of such a size do.
static uint32_t work_of(const plan *p, const ob_island *is)
{
	uint32_t sum = 1 + is->members + 8 * is->pairs;
	for (uint32_t k = 0; is->pairs && k < is->members; k++)
		sum += p->ex->effort[p->ex->member[is->first_member + k]];
	return sum;
}

// island[i] shall be what now is island[from[i]]. from is used up.
static void permute(ob_island *island, uint32_t *from, uint32_t n)
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

// The largest first, and what is equal as it was; what is not to be solved has no work. Digit by digit, from the
// lowest: islands come by the ten thousand, and there are no more than two or three digits.
static void sort_by_work(plan *p)
{
	enum { BITS = 8, DIGITS = 1 << BITS };
	const ob_island *island = p->ex->island;
	uint32_t n = p->ex->count->islands, *from = p->parent, *to = p->island_of, largest = 0; // both have been used
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
	permute(p->ex->island, from, n);
}

// Largest first, so that no worker starts on a big one when the others are done; small ones in handfuls.
static void make_chunks(plan *p)
{
	ob_step_data *ex = p->ex;
	uint64_t total = 0, filled = 0;
	uint32_t n = ex->count->islands, unsolved = 0, chunks = 0;
	for (uint32_t i = 0; i < n; i++)
		ex->island[i].work = ex->island[i].solved ? 0 : work_of(p, &ex->island[i]);
	sort_by_work(p);
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t m = 0; m < ex->island[i].members; m++)
			ex->result_island[ex->member[ex->island[i].first_member + m]] = i;
		if (ex->island[i].solved)
			continue;
		total += ex->island[i].work;
		unsolved++;
	}
	uint64_t share = total / (16 * (uint64_t)ob_universe_workers(p->u)) + 1;
	share = share > LEAST_SHARE ? share : LEAST_SHARE;
	for (uint32_t i = 0; i < unsolved; i++) {
		if (i == 0 || filled >= share)
			ex->chunk[chunks++] = i, filled = 0;
		filled += ex->island[i].work;
	}
	ex->chunk[chunks] = unsolved;
	ex->count->chunks = chunks;
}

static void plan_all(plan *p)
{
	grow_islands(p);
	list_members(p);
	if (p->before)
		mark_solved(p);
	list_pairs(p);
	make_chunks(p);
}

void ob_islands_plan(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t ids = ob_universe_ids(u);
	ex->count->merged = 0;
	plan_all(&(plan){ u, ex, ids, ex->scratch, ex->scratch + ids, NULL, ob_step_count(u) });
}

void ob_islands_merge(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t ids = ob_universe_ids(u), *before = ex->scratch + 2 * ids;
	ex->count->merged = 1;
	memcpy(before, ex->result_island, ids * sizeof *before);
	plan_all(&(plan){ u, ex, ids, ex->scratch, ex->scratch + ids, before, ob_step_count(u) });
}
