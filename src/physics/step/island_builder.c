#include "step/island_builder.h"

#include <string.h>

#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "step/pairs.h"
#include "step/prefetch.h"
#include "step/sort_ids.h"
#include "table/forest.h"
#include "table/home.h"

enum { NONE = UINT32_MAX };
enum { LINKED_AT_ONCE = 64 }; // bodies in a task: for fewer the gate costs more than another worker gains
// A chunk has OB_WORK_WORTH_A_WORKER. If that leaves CHUNKS_ABREAST chunks for each worker, it has the work of as many
// flights as are followed side by side.
enum { CHUNK_WORK_ABREAST = 160, CHUNKS_ABREAST = 4 };

static bool is_dynamic(const ob_involved *p, uint32_t id)
{
	return ob_schedule_is_dynamic(&p->data->schedule[id]);
}

// True for a body that this rank solves.
static bool is_own(const ob_involved *p, uint32_t id)
{
	return is_dynamic(p, id) && (p->alone || ob_worker_is_here(p->u, ob_home_of(p->u, id)));
}

// True, when islands are merged, if it is in an island that was solved; valid until members are listed anew.
static bool was_solved(const ob_involved *p, uint32_t id)
{
	return p->data->result_island[id] != NONE;
}

// True if it is in no island unless it is woken. False for bodies that have fallen asleep in this step.
static bool is_asleep(const ob_involved *p, uint32_t id)
{
	return p->data->schedule[id].state >= OB_SCHEDULE_ASLEEP && !was_solved(p, id);
}

static bool is_in_range(const ob_involved *p, const ob_pair_key *k)
{
	return ob_object_in_range(p->data, k->a) && ob_object_in_range(p->data, k->b);
}

// Body that a joint holds to another one; NONE: it holds no body that this rank solves.
static uint32_t joined_body(const ob_involved *p, uint32_t joint, uint32_t id)
{
	const ob_joint_passport *j = &p->data->joint[joint - 1];
	const uint32_t other = j->object[j->object[0] == id];
	return j->kind == OB_JOINT_APART || other == OB_JOINT_WORLD || other >= p->data->objects_max ||
			       !is_own(p, other) || !ob_joint_holds(p->u, j)
		       ? NONE
		       : other;
}

// ---- bodies involved, when islands are merged

// Involves both bodies of a link, so that they are solved in this step.
static void involve_link(ob_involved *p, const ob_pair_key *k)
{
	if (is_own(p, k->a) && is_own(p, k->b))
		ob_involve_joined(p, k->a, k->b);
	else if (is_own(p, k->a) || is_own(p, k->b))
		ob_involve_again(p, is_own(p, k->a) ? k->a : k->b);
}

// True if the pair links its bodies. Sleepers that are woken within a step wake the bodies that they touch; expected
// contacts concern the coming step then. Links to another rank's body are known to that rank, too (rank_islands.h).
// Most pairs link nothing, so their objects are tested last.
static bool is_link(const ob_involved *p, const ob_pair_key *k)
{
	return (p->merges ? k->active : k->active | k->expected) && is_in_range(p, k) && is_own(p, k->a) &&
	       is_own(p, k->b) && (!p->merges || (is_asleep(p, k->a) && is_asleep(p, k->b)));
}

// Involves all bodies of the object's island, which is solved again as a whole.
static void involve_island_of(ob_involved *p, uint32_t id)
{
	const uint32_t island = p->data->result_island[id];
	if (island == NONE) {
		ob_involve_again(p, id);
		return;
	}
	ob_island *is = &p->data->island[island];
	const uint32_t *member = p->data->member + is->first_member;
	if (!is->solved)
		return;
	is->solved = 0;
	ob_involve_again(p, member[0]);
	for (uint32_t k = 1; k < is->members; k++)
		ob_involve_joined(p, member[0], member[k]);
}

// Involves the islands of bodies with late contacts in this step. The solutions of all other islands stand.
static void involve_late(ob_involved *p)
{
	const ob_step_data *data = p->data;
	for (uint32_t i = 0; i < data->count->islands; i++)
		data->island[i].solved = 1;
	for (uint32_t i = 0; i < ob_checks_count(data); i++) {
		const ob_pair_key *k = &data->pair[data->check[i]];
		if (!k->late || !is_in_range(p, k))
			continue;
		for (int side = 0; side < 2; side++)
			if (is_own(p, side ? k->b : k->a))
				involve_island_of(p, side ? k->b : k->a);
		involve_link(p, k);
	}
}

// Involves the sleeping bodies that joints hold to one that is woken.
static void involve_joined(ob_involved *p, uint32_t id)
{
	const ob_step_data *data = p->data;
	for (uint32_t j = ob_joint_first(data, id); j; j = ob_joint_next(data, j, id)) {
		const uint32_t other = joined_body(p, j, id);
		if (other != NONE && is_asleep(p, other))
			ob_involve_joined(p, id, other);
	}
}

// Involves linked bodies; the list grows while the loop runs: breadth first.
static void involve_linked(ob_involved *p)
{
	const ob_step_data *data = p->data;
	for (uint32_t i = 0; i < p->bodies; i++) {
		ob_pair_place at;
		if (was_solved(p, p->body[i]))
			continue;
		for (uint32_t link = data->first_pair[p->body[i]]; ob_pair_at(data, link, &at);
		     link = ob_pair_next(data, at)) {
			data->count->visits++;
			if (is_link(p, &data->pair[at.pair]))
				ob_involve_joined(p, data->pair[at.pair].a, data->pair[at.pair].b);
		}
		involve_joined(p, p->body[i]);
	}
}

// ---- bodies involved in a new step

// Involves both bodies of a pair that touches, or is expected to, if one of them moves.
static void involve_pair(const ob_involved *p, const ob_pair_key *k)
{
	if (!(k->active | k->expected) || !is_in_range(p, k) ||
	    (!ob_schedule_moves(&p->data->schedule[k->a]) && !ob_schedule_moves(&p->data->schedule[k->b])))
		return;
	const bool a = is_own(p, k->a), b = is_own(p, k->b);
	if (a)
		ob_involve(p, k->a);
	if (b)
		ob_involve(p, k->b);
	if (a && b)
		ob_forest_join(p->parent, k->a, k->b);
}

static void make_roots(const ob_involved *p, uint32_t due)
{
	p->data->count->rooted = due >= OB_ISLANDS_MANY && due >= p->ids / 16;
	for (uint32_t i = 0; p->data->count->rooted && i < p->ids; i++)
		p->parent[i] = i;
}

// Involves the bodies that are due in this step, and those of linked pairs that are due for a check.
static void involve_due(const ob_involved *p)
{
	const ob_step_data *data = p->data;
	const ob_calendar solve = ob_calendar_of_objects(p->u), look = ob_calendar_of_pairs(p->u);
	const uint32_t most = ob_pairs_end(data), pairs = ob_calendar_list(&look, p->step, data->check, most);
	uint32_t *due = p->island_of; // scratch until islands are listed
	const uint32_t n = ob_calendar_list(&solve, p->step, due, p->ids);
	make_roots(p, n);
	for (uint32_t i = 0; i < n; i++)
		ob_involve(p, due[i]);
	for (uint32_t i = 0; i < pairs; i++) {
		ob_prefetch_checks(data, i, pairs);
		involve_pair(p, &data->pair[data->check[i]]);
	}
	data->count->due = data->count->involved;
}

// Joins the body to those that a joint holds to it, as follow_links does.
static void follow_joints(const ob_involved *p, uint32_t id, uint32_t *stack)
{
	const ob_step_data *data = p->data;
	for (uint32_t j = ob_joint_first(data, id); j; j = ob_joint_next(data, j, id)) {
		const uint32_t other = joined_body(p, j, id);
		if (other == NONE)
			continue;
		if (ob_involve(p, other)) {
			p->place[other] = *stack;
			*stack = other;
		}
		ob_forest_join(p->parent, id, other);
	}
}

// Joins the body to its linked bodies. Each body that is new goes on the caller's stack, through place[]: the task that
// has found it follows its links.
static void follow_links(const ob_involved *p, uint32_t id, uint32_t *stack, uint64_t *visits)
{
	const ob_step_data *data = p->data;
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		const ob_pair_key *k = &data->pair[at.pair];
		const uint32_t other = at.side ? k->a : k->b;
		++*visits;
		if (!is_link(p, k))
			continue;
		if (ob_involve(p, other)) {
			p->place[other] = *stack;
			*stack = other;
		}
		ob_forest_join(p->parent, k->a, k->b);
	}
	follow_joints(p, id, stack);
}

// Numbers the trees by their lowest id, as the first islands, and lists their members in ascending order, as the first.
static void list_members(ob_involved *p)
{
	ob_step_data *data = p->data;
	uint32_t n = 0, total = 0;
	for (uint32_t i = 0; i < p->bodies; i++) {
		const uint32_t id = p->body[i], root = p->parent[id];
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
	for (uint32_t i = 0; i < p->bodies; i++) {
		const uint32_t id = p->body[i];
		ob_island *is = &data->island[data->result_island[id]];
		data->member[is->first_member + is->members++] = id;
	}
	data->count->unsolved = n;
}

// ---- islands that stand while others are merged

// Moves the standing islands behind the first `unsolved` places, without a gap. Few have to be moved, as the members of
// each would have to be updated. Returns the end of the islands.
static uint32_t move_standing(const ob_involved *p, uint32_t unsolved)
{
	ob_step_data *data = p->data;
	const uint32_t before = data->count->islands;
	uint32_t standing = 0, to = unsolved;
	for (uint32_t i = 0; i < before; i++)
		standing += data->island[i].solved;
	const uint32_t end = unsolved + standing;
	for (uint32_t i = 0; i < before; i++) {
		const ob_island *is = &data->island[i];
		if ((i >= unsolved && i < end) || !is->solved)
			continue;
		while (to < before && data->island[to].solved)
			to++;
		for (uint32_t k = 0; k < is->members; k++)
			data->result_island[data->member[is->first_member + k]] = to;
		data->island[to++] = *is;
	}
	return end;
}

// Moves the members of standing islands behind those of the others, and their pairs to the front. Scratch: place[] and
// ob_step_data.check, which have been read.
static void move_lists_of_standing(const ob_involved *p, uint32_t first, uint32_t end)
{
	ob_step_data *data = p->data;
	uint32_t members = 0, pairs = 0, *member = p->place, *pair = data->check;
	for (uint32_t i = first; i < end; i++) {
		ob_island *is = &data->island[i];
		memcpy(member + members, data->member + is->first_member, is->members * sizeof *member);
		memcpy(pair + pairs, data->island_pair + is->first_pair, is->pairs * sizeof *pair);
		is->first_member = p->bodies + members;
		is->first_pair = pairs;
		members += is->members;
		pairs += is->pairs;
	}
	memcpy(data->member + p->bodies, member, members * sizeof *member);
	memcpy(data->island_pair, pair, pairs * sizeof *pair);
	data->count->island_pairs = pairs;
}

// ---- pairs

// Returns the island that solves a pair: pairs of its members, and of a member and a body that does not move; NONE if
// they cannot touch in this step. Results of a check within the step are void if the island is solved again.
static uint32_t island_of_pair(const ob_involved *p, ob_pair_key *k)
{
	const uint32_t ia = p->data->result_island[k->a], ib = p->data->result_island[k->b], i = ia != NONE ? ia : ib;
	if (p->merges)
		ob_pair_void_check(k);
	if (i == NONE || (ia != ib && ((ia != NONE && ib != NONE) || (is_dynamic(p, k->a) && is_dynamic(p, k->b)))))
		return NONE;
	if (k->active)
		return i;
	const ob_schedule *a = &p->data->schedule[k->a], *b = &p->data->schedule[k->b];
	double paths = ob_schedule_path(a, p->step) + ob_schedule_path(b, p->step);
	return a->reach + b->reach >= k->limit - paths ? i : NONE;
}

// Sorts pairs by their bodies' ids, ascending: a shell sort, for most islands have few pairs.
static void sort_pairs(const ob_step_data *data, uint32_t *pair, uint32_t n)
{
	static const uint32_t gaps[] = { 29524, 9841, 3280, 1093, 364, 121, 40, 13, 4, 1 };
	const ob_pair_key *all = data->pair;
	for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++) {
		const uint32_t gap = gaps[g];
		for (uint32_t i = gap; i < n; i++) {
			const uint32_t moved = pair[i];
			uint32_t at = i;
			for (; at >= gap && ob_pairs_by_ids(&all[moved], &all[pair[at - gap]]) < 0; at -= gap)
				pair[at] = pair[at - gap];
			pair[at] = moved;
		}
	}
}

// Estimates an island's work: the cost of its members in the last step, and at least the usual one for its size. On
// several ranks its pairs are listed after islands are dealt.
static uint32_t estimated_work(const ob_involved *p, const ob_island *is)
{
	uint32_t sum = 1 + is->members + 8 * is->pairs;
	for (uint32_t k = 0; (is->pairs || !p->alone) && k < is->members; k++)
		sum += p->data->effort[p->data->member[is->first_member + k]];
	return sum;
}

// Pairs of an island, as they are found.
typedef struct listing {
	uint32_t n, pair[256]; // number of pairs; the first of them
	ob_halo *halo; // of several ranks; else NULL
	uint64_t visits;
} listing;

// True if the pair is listed with the body on this side. A pair of two members is listed with a, if a is solved; so one
// island's task alone lists and writes it.
static bool is_listed_with(const ob_involved *p, const ob_pair_key *k, uint32_t side)
{
	return is_in_range(p, k) && (!side || !ob_is_to_be_solved(p->data, k->a));
}

// Lists the pairs of a body. in_island holds from here to the next islands. All pairs of the body, in an island or not,
// are checked after the solve (late_contacts.h).
static void list_pairs_of(const ob_involved *p, uint32_t id, uint32_t island, listing *to)
{
	ob_step_data *data = p->data;
	const ob_calendar look = ob_calendar_of_pairs(p->u);
	ob_pair_place at;
	bool at_border = false;
	for (uint32_t link = data->first_pair[id], next; ob_pair_at(data, link, &at); link = next) {
		ob_pair_key *k = &data->pair[at.pair];
		next = ob_pair_next(data, at);
		to->visits++;
		ob_prefetch_link(p->u, next);
		at_border |= is_in_range(p, k) && ob_halo_is_elsewhere(to->halo, at.side ? k->a : k->b);
		if (!is_listed_with(p, k, at.side))
			continue;
		if (p->alone || ob_pair_is_checked_here(p->u, k))
			ob_calendar_set(&look, at.pair, p->step + 1);
		const bool in_island = island_of_pair(p, k) == island;
		if (k->in_island != in_island)
			k->in_island = in_island;
		if (!in_island)
			continue;
		if (to->n < sizeof to->pair / sizeof *to->pair)
			to->pair[to->n] = at.pair;
		to->n++;
	}
	ob_halo_note_border(to->halo, id, at_border);
}

// Lists the pairs of a large island again, when their number is known.
static void list_all_again(const ob_involved *p, const ob_island *is)
{
	const ob_step_data *data = p->data;
	uint32_t n = 0;
	for (uint32_t k = 0; k < is->members; k++) {
		const uint32_t id = data->member[is->first_member + k];
		ob_pair_place at;
		for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at))
			if (is_listed_with(p, &data->pair[at.pair], at.side) && data->pair[at.pair].in_island &&
			    n < is->pairs)
				data->island_pair[is->first_pair + n++] = at.pair;
	}
}

static void list_pairs_of_island(const ob_involved *p, uint32_t island, listing *to)
{
	ob_step_data *data = p->data;
	ob_island *is = &data->island[island];
	to->n = 0;
	if (is->first_member > data->objects_max || is->members > data->objects_max - is->first_member) {
		data->count->failure = OB_STEP_DAMAGED;
		is->members = 0;
	}
	for (uint32_t k = 0; k < is->members; k++) {
		ob_prefetch_pairs_of(p->u, is->first_member + k);
		list_pairs_of(p, data->member[is->first_member + k], island, to);
	}
	is->first_pair = ob_island_pairs_reserve(p->u, to->n);
	is->pairs = is->first_pair == NONE ? 0 : to->n;
	if (to->n <= sizeof to->pair / sizeof *to->pair)
		memcpy(data->island_pair + is->first_pair, to->pair, is->pairs * sizeof *to->pair);
	else
		list_all_again(p, is);
	sort_pairs(data, data->island_pair + is->first_pair, is->pairs);
}

// Ends the islands of the step before: their pairs are in no island any more, and those that touch no longer lose their
// record. Pairs lie anywhere, and the worker that solved them has written them last.
static void end_islands(const ob_involved *p)
{
	enum { AHEAD = 16 };
	ob_step_data *data = p->data;
	for (uint32_t i = 0; i < data->count->island_pairs && i < data->pairs_max; i++) {
		if (data->island_pair[i] >= data->pairs_max) {
			data->count->failure = OB_STEP_DAMAGED;
			return;
		}
		if (i + AHEAD < data->count->island_pairs)
			__builtin_prefetch(&data->pair[data->island_pair[i + AHEAD]], 1);
		ob_pair_key *k = &data->pair[data->island_pair[i]];
		k->in_island = 0;
		if (k->record != OB_NO_RECORD && !k->active)
			ob_pair_release_record(p->u, k);
	}
	data->count->visits += data->count->island_pairs;
	data->count->island_pairs = 0;
}

// Sets island[i] to the former island[from[i]]. from is overwritten.
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

// Sorts the islands to be solved by work, largest first, stable. A radix sort: there may be tens of thousands of
// islands, and work has no more than two or three digits.
static void sort_by_work(ob_involved *p)
{
	enum { BITS = 8, DIGITS = 1 << BITS };
	const ob_island *island = p->data->island;
	uint32_t n = p->data->count->unsolved, *from = p->parent, *to = p->place,
		 largest = 0; // parent and place are scratch now
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

uint64_t ob_islands_chunk_work(uint64_t total, uint32_t workers)
{
	const uint64_t least = total / (64 * (uint64_t)workers) + 1, few = total / (CHUNKS_ABREAST * (uint64_t)workers),
		       share = least > few                ? least
			       : few < CHUNK_WORK_ABREAST ? few
							  : CHUNK_WORK_ABREAST;
	if (workers == 1)
		return UINT64_MAX;
	return share > OB_WORK_WORTH_A_WORKER ? share : OB_WORK_WORTH_A_WORKER;
}

// Makes chunks, largest first, so that no worker starts on a large island when the others are done; small islands share
// one.
static void make_chunks(ob_involved *p, uint64_t total)
{
	ob_step_data *data = p->data;
	const uint32_t unsolved = data->count->unsolved;
	const uint64_t share = ob_islands_chunk_work(total, ob_universe_workers(p->u));
	uint64_t filled = 0;
	uint32_t chunks = 0;
	for (uint32_t i = 0; i < unsolved; i++) {
		if (i == 0 || filled >= share)
			data->chunk[chunks++] = i, filled = 0;
		filled += data->island[i].work;
	}
	data->chunk[chunks] = unsolved;
	data->count->chunks = chunks;
}

// ---- several ranks, or moved simulators

// Simulators that share the islands, and their loads so far.
typedef struct shares {
	uint32_t first, count; // simulators of this rank: no more than there are objects
	uint32_t *load, *votes; // [count]
	uint32_t *owner; // [island]: index of a simulator
	uint32_t most; // largest load
	bool pins; // some object is pinned
	int shift; // right shift of work, so that loads fit 32 bits
	ob_regions *regions; // NULL: there is but one rank
} shares;

// Returns the simulator that is to solve the object: on several ranks that of its region; else the last that got it.
static uint32_t home_of(const ob_involved *p, const shares *s, uint32_t id)
{
	const uint32_t home = s->regions ? ob_regions_at(s->regions, id) : ob_home_of(p->u, id),
		       place = home - s->first;
	return place < s->count ? place : home % s->count;
}

// Returns the home of most members.
static uint32_t preferred_owner(const ob_involved *p, const shares *s, const ob_island *is)
{
	const ob_step_data *data = p->data;
	const uint32_t *member = data->member + is->first_member;
	uint32_t best = home_of(p, s, member[0]), most = 0;
	if (is->members == 1)
		return best;
	for (uint32_t k = 0; k < is->members; k++) {
		const uint32_t home = home_of(p, s, member[k]);
		if (++s->votes[home] > most)
			best = home, most = s->votes[home];
	}
	for (uint32_t k = 0; k < is->members; k++)
		s->votes[home_of(p, s, member[k])] = 0;
	return best;
}

// Returns the simulator to which a member is pinned, the first of several; UINT32_MAX: none is.
static uint32_t pin_of(const ob_involved *p, const shares *s, const ob_island *is)
{
	const ob_step_data *data = p->data;
	for (uint32_t k = 0; s->pins && k < is->members; k++) {
		const uint32_t pin = data->pin[data->member[is->first_member + k]];
		if (pin && pin - 1 - s->first < s->count)
			return pin - 1 - s->first;
	}
	return UINT32_MAX;
}

static uint32_t least_loaded(const shares *s)
{
	uint32_t best = 0;
	for (uint32_t w = 1; w < s->count; w++)
		best = s->load[w] < s->load[best] ? w : best;
	return best;
}

static void ask_for(ob_involved *p, shares *s, uint32_t island)
{
	const ob_island *is = &p->data->island[island];
	const uint32_t pin = pin_of(p, s, is);
	s->owner[island] = pin != UINT32_MAX ? pin : preferred_owner(p, s, is);
	s->load[s->owner[island]] += is->work >> s->shift;
}

// Moves an island from an overloaded simulator to the one that finishes first.
static void give_island(ob_involved *p, shares *s, uint32_t island)
{
	const ob_step_data *data = p->data;
	const ob_island *is = &data->island[island];
	const uint32_t work = is->work >> s->shift, asked = s->owner[island],
		       to = s->load[asked] > s->most ? least_loaded(s) : asked;
	const bool spills = to != asked && s->load[to] + work < s->load[asked] && pin_of(p, s, is) == UINT32_MAX;
	if (spills) {
		s->load[asked] -= work;
		s->load[to] += work;
		s->owner[island] = to;
	}
	for (uint32_t k = 0; k < is->members; k++) {
		const uint32_t id = data->member[is->first_member + k], simulator = s->first + s->owner[island];
		ob_home_set(p->u, id, simulator);
		ob_regions_note(s->regions, id, simulator, 1 + data->effort[id], spills);
	}
}

static uint32_t least_of(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

// Makes a chunk for each simulator from the islands of its region, or those that it solved before. If a simulator would
// get a tenth more than its share, others take islands, the largest first.
static void make_shares(ob_involved *p, uint64_t total, ob_regions *regions)
{
	ob_step_data *data = p->data;
	const uint32_t all = least_of(ob_universe_simulators(p->u), data->objects_max),
		       unsolved = data->count->unsolved;
	uint32_t first;
	const uint32_t each = ob_universe_simulators_here(p->u, &first);
	first = least_of(first, all);
	shares s = { .first = first,
		     .count = least_of(least_of(each, all - first), p->ids),
		     .load = p->body,
		     .votes = p->place,
		     .owner = p->island_of,
		     .pins = ob_moves_were_made(p->u),
		     .regions = regions };
	while (total >> s.shift > UINT32_MAX / 4)
		s.shift++;
	memset(data->chunk, 0, (all + 1) * sizeof *data->chunk);
	data->count->chunks = all;
	if (!s.count) // a rank with more simulators than there can be objects
		return;
	s.most = (uint32_t)(ob_work_share(total, s.count) >> s.shift);
	memset(s.load, 0, s.count * sizeof *s.load);
	memset(s.votes, 0, s.count * sizeof *s.votes);
	for (uint32_t i = 0; i < unsolved; i++)
		ask_for(p, &s, i);
	for (uint32_t i = 0; i < unsolved; i++)
		give_island(p, &s, i);
	for (uint32_t i = 0; i < unsolved; i++)
		data->chunk[first + s.owner[i] + 1]++;
	for (uint32_t w = 0; w < all; w++)
		data->chunk[w + 1] += data->chunk[w];
	memcpy(s.load, data->chunk + first, s.count * sizeof *s.load); // places of the next island of each
	for (uint32_t i = 0; i < unsolved; i++)
		p->parent[s.load[s.owner[i]]++] = i;
	permute_islands(data->island, p->parent, unsolved);
}

// ---- calls in their order

void ob_islands_begin(ob_universe *u)
{
	struct ob_step_counts *count = ob_universe_step_data(u)->count;
	count->merged = 0;
	count->involved = 0;
	const ob_involved p = ob_involved_begin(u, false);
	end_islands(&p);
	involve_due(&p);
}

static uint32_t end_of_task(uint32_t task, uint32_t each, uint32_t all)
{
	return all - task * each < each ? all : (task + 1) * each;
}

uint32_t ob_islands_link_tasks(const ob_universe *u)
{
	return (ob_universe_step_data(u)->count->due + LINKED_AT_ONCE - 1) / LINKED_AT_ONCE;
}

void ob_islands_link(ob_universe *u, uint32_t task)
{
	const ob_involved p = ob_involved_begin(u, false);
	const uint32_t end = end_of_task(task, LINKED_AT_ONCE, p.data->count->due);
	uint64_t visits = 0;
	uint32_t stack = NONE;
	for (uint32_t i = task * LINKED_AT_ONCE; i < end; i++) {
		ob_prefetch_lists(u, p.body, i, end);
		follow_links(&p, p.body[i], &stack, &visits);
	}
	while (stack != NONE) {
		const uint32_t id = stack;
		stack = p.place[id];
		follow_links(&p, id, &stack, &visits);
	}
	ob_step_visited(u, visits);
}

void ob_islands_list_members(ob_universe *u)
{
	ob_involved p = ob_involved_all(u);
	ob_sort_ids(p.body, p.bodies, p.ids, p.place); // place is scratch now
	p.data->count->visits += p.bodies;
	const uint32_t unsolved = ob_involved_roots(&p), end = p.merges ? move_standing(&p, unsolved) : unsolved;
	if (p.merges)
		move_lists_of_standing(&p, unsolved, end);
	list_members(&p);
	p.data->count->islands = end;
}

uint32_t ob_islands_list_tasks(const ob_universe *u)
{
	const bool alone = ob_universe_ranks(u) < 2; // on several ranks the owner lists an island's pairs
	return alone ? (ob_universe_step_data(u)->count->unsolved + OB_ISLANDS_AT_ONCE - 1) / OB_ISLANDS_AT_ONCE : 0;
}

void ob_islands_list_pairs(ob_universe *u, uint32_t task)
{
	const struct ob_step_counts *count = ob_universe_step_data(u)->count;
	const ob_involved p = ob_involved_begin(u, count->merged);
	const uint32_t end = end_of_task(task, OB_ISLANDS_AT_ONCE, count->unsolved);
	listing found;
	found.visits = 0;
	found.halo = NULL;
	for (uint32_t i = task * OB_ISLANDS_AT_ONCE; i < end; i++) {
		list_pairs_of_island(&p, i, &found);
		p.data->island[i].work = estimated_work(&p, &p.data->island[i]);
	}
	ob_step_visited(u, found.visits);
}

// Sets the order in which islands are solved, and the worker of each.
void ob_islands_deal(ob_universe *u, ob_regions *regions)
{
	ob_involved p = ob_involved_begin(u, ob_universe_step_data(u)->count->merged);
	ob_step_data *data = p.data;
	const uint32_t n = data->count->unsolved;
	uint64_t total = 0;
	for (uint32_t i = 0; i < n; i++) {
		if (regions)
			data->island[i].work = estimated_work(&p, &data->island[i]);
		total += data->island[i].work;
	}
	sort_by_work(&p);
	data->count->shared = regions || ob_moves_were_made(u);
	if (data->count->shared)
		make_shares(&p, total, regions);
	else
		make_chunks(&p, total);
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t m = 0; m < data->island[i].members; m++)
			data->result_island[data->member[data->island[i].first_member + m]] = i;
}

// Lists pairs in the order of member[].
void ob_islands_list_dealt_pairs(ob_universe *u, ob_halo *halo)
{
	const ob_involved p = ob_involved_begin(u, ob_universe_step_data(u)->count->merged);
	ob_step_data *data = p.data;
	listing found;
	found.visits = 0;
	found.halo = halo;
	for (uint32_t n = 0, at = 0; n < data->count->unsolved; n++) {
		const uint32_t i = data->result_island[data->member[at]];
		at += data->island[i].members;
		list_pairs_of_island(&p, i, &found);
	}
	data->count->visits += found.visits;
}

void ob_islands_merge(ob_universe *u)
{
	struct ob_step_counts *count = ob_universe_step_data(u)->count;
	ob_involved p = ob_involved_begin(u, true);
	count->merged = 1;
	involve_late(&p);
	involve_linked(&p);
	count->involved = p.bodies;
}
