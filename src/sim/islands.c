#include "sim/islands.h"

#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "sim/pairs.h"
#include "sim/perceive.h"

enum { NONE = UINT32_MAX };

static const double enough = 1e-4; // m: reaches that differ by less are not handed on

// The arranger's view while it plans: a union-find forest of islands, whose roots are the lowest ids of their trees.
//
// An object gets as far in the step as it is fast, its reach; and what is hit gets as far as what hits it had still to
// go. So reaches are handed on along pairs, less the distance between the two:
//
//   reach .50 ─────.10───── .40 ─────.30───── .10 ─────.20───── what is here is not hit in this step
//
// An island is all that may touch each other with these reaches. One fast object draws in what lies in its way, and not
// the surroundings of its surroundings.
typedef struct plan {
	ob_universe *u;
	ob_exchange *ex;
	uint32_t ids;
	uint32_t *parent; // [id]
	uint32_t *island_of; // [root]
	float *reach; // [id]: m in the next step, its own or handed on
} plan;

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static bool dynamic(const plan *p, uint32_t id)
{
	return p->ex->brief[id].state >= OB_BRIEF_AWAKE;
}

static bool asleep(const plan *p, uint32_t id)
{
	return p->ex->brief[id].state == OB_BRIEF_ASLEEP;
}

static double reach_of(const plan *p, uint32_t id)
{
	return dynamic(p, id) ? p->reach[id] : 0;
}

// Lower bound of the distance (m).
static double distance(const plan *p, const ob_pair_key *k)
{
	return k->limit - p->ex->brief[k->a].path - p->ex->brief[k->b].path;
}

static bool may_touch(const plan *p, const ob_pair_key *k)
{
	return k->active || reach_of(p, k->a) + reach_of(p, k->b) >= distance(p, k);
}

static void unite(uint32_t *parent, uint32_t a, uint32_t b)
{
	uint32_t low = a < b ? a : b, high = a < b ? b : a;
	parent[high] = low;
}

// Paths use up what is known of a distance, also those of objects that fly side by side. Where that would join two
// that are alone, it is measured anew.
static void measure_distances(plan *p)
{
	for (uint32_t i = 0; i < p->ex->count->pairs; i++) {
		ob_pair_key *k = &p->ex->pair[i];
		if (k->active || (asleep(p, k->a) && asleep(p, k->b)) || !may_touch(p, k))
			continue;
		double apart = ob_pairs_apart(p->u, k->a, k->b);
		if (apart > 0)
			k->limit = fmax(k->limit, p->ex->brief[k->a].path + p->ex->brief[k->b].path + apart);
	}
}

static void hand_on(plan *p)
{
	for (bool again = true; again;) {
		again = false;
		for (uint32_t i = 0; i < p->ex->count->pairs; i++) {
			const ob_pair_key *k = &p->ex->pair[i];
			if (!dynamic(p, k->a) || !dynamic(p, k->b))
				continue;
			double way = k->active ? 0 : fmax(0, distance(p, k)), least = way + enough;
			float *a = &p->reach[k->a], *b = &p->reach[k->b];
			if (*a > *b + least)
				*b = (float)(*a - way), again = true;
			else if (*b > *a + least)
				*a = (float)(*b - way), again = true;
		}
	}
}

static void grow_islands(plan *p)
{
	for (uint32_t id = 0; id < p->ids; id++)
		p->parent[id] = id;
	for (uint32_t i = 0; i < p->ex->count->pairs; i++) {
		const ob_pair_key *k = &p->ex->pair[i];
		if (!dynamic(p, k->a) || !dynamic(p, k->b) || !may_touch(p, k))
			continue;
		uint32_t a = root_of(p->parent, k->a), b = root_of(p->parent, k->b);
		if (a != b)
			unite(p->parent, a, b);
	}
}

// Members that may be hit by something faster than what their boxes were claimed for claim larger ones.
static bool boxes_suffice(plan *p)
{
	bool suffice = true;
	for (uint32_t id = 0; id < p->ids; id++) {
		if (!dynamic(p, id) || reach_of(p, id) <= p->ex->brief[id].reach + .02)
			continue;
		const ob_motion *m = ob_newest_motion(p->u, id);
		const ob_passport *pass = ob_passport_of(p->u, id);
		ob_claim_bounds_wider(p->u, id, pass->shape, pass->size, (ob_pose){ m->p, m->q }, reach_of(p, id));
		suffice &= !ob_perceive_asked(p->u, id);
	}
	return suffice;
}

// Numbers the awake trees by their lowest id and lists their members in ascending order.
static void list_members(plan *p)
{
	ob_exchange *ex = p->ex;
	uint32_t n = 0, total = 0;
	for (uint32_t id = 0; id < p->ids; id++)
		p->island_of[id] = NONE;
	for (uint32_t id = 0; id < p->ids; id++) // a tree with one awake member is awake
		if (dynamic(p, id) && !asleep(p, id))
			p->island_of[root_of(p->parent, id)] = 0;
	for (uint32_t id = 0; id < p->ids; id++) {
		ex->result_island[id] = NONE;
		if (!dynamic(p, id) || p->island_of[root_of(p->parent, id)] == NONE)
			continue;
		uint32_t root = root_of(p->parent, id);
		if (root == id) {
			p->island_of[id] = n;
			ex->island[n++] = (ob_island){ 0, 0, 0, 0 };
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

static uint32_t island_of_pair(const plan *p, const ob_pair_key *k)
{
	uint32_t i = dynamic(p, k->a) ? p->ex->result_island[k->a] : p->ex->result_island[k->b];
	return i != NONE && may_touch(p, k) ? i : NONE;
}

static void list_pairs(plan *p)
{
	ob_exchange *ex = p->ex;
	uint32_t total = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		uint32_t island = island_of_pair(p, &ex->pair[i]);
		if (island != NONE)
			ex->island[island].pairs++;
	}
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		ex->island[i].first_pair = total;
		total += ex->island[i].pairs;
		ex->island[i].pairs = 0;
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		uint32_t island = island_of_pair(p, &ex->pair[i]);
		if (island != NONE)
			ex->island_pair[ex->island[island].first_pair + ex->island[island].pairs++] = i;
	}
}

static uint32_t work_of(const ob_island *i)
{
	return 1 + i->members + 8 * i->pairs;
}

static int by_work(const void *x, const void *y)
{
	const ob_island *a = x, *b = y;
	uint32_t wa = work_of(a), wb = work_of(b);
	if (wa != wb)
		return wa < wb ? 1 : -1;
	return a->first_member < b->first_member ? -1 : 1;
}

// Largest first, so that no worker starts on a big one when the others are done; small ones in handfuls.
static void make_chunks(plan *p)
{
	ob_exchange *ex = p->ex;
	uint64_t total = 0, filled = 0;
	uint32_t n = ex->count->islands, chunks = 0;
	qsort(ex->island, n, sizeof *ex->island, by_work);
	for (uint32_t i = 0; i < n; i++) {
		total += work_of(&ex->island[i]);
		for (uint32_t m = 0; m < ex->island[i].members; m++)
			ex->result_island[ex->member[ex->island[i].first_member + m]] = i;
	}
	uint64_t share = total / (16 * (uint64_t)ob_universe_workers(p->u)) + 1;
	for (uint32_t i = 0; i < n; i++) {
		if (i == 0 || filled >= share)
			ex->chunk[chunks++] = i, filled = 0;
		filled += work_of(&ex->island[i]);
	}
	ex->chunk[chunks] = n;
	ex->count->chunks = chunks;
}

bool ob_islands_plan(ob_universe *u)
{
	ob_exchange *ex = ob_universe_exchange(u);
	uint32_t ids = ob_universe_ids(u);
	plan p = { u, ex, ids, ex->scratch, ex->scratch + ids, ex->island_reach };
	for (uint32_t id = 0; id < ids; id++)
		p.reach[id] = ex->brief[id].reach;
	measure_distances(&p);
	hand_on(&p);
	if (!boxes_suffice(&p))
		return false;
	grow_islands(&p);
	list_members(&p);
	list_pairs(&p);
	make_chunks(&p);
	return true;
}
