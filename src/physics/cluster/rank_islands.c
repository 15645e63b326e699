#include "cluster/rank_islands.h"

#include <stdlib.h>
#include <string.h>

#include "schedule/calendar.h"
#include "schedule/involved.h"
#include "schedule/pair_checks.h"
#include "table/forest.h"
#include "table/home.h"

enum { NONE = UINT32_MAX };

// An island of this rank's bodies, as far as they are linked here.
typedef struct island {
	uint32_t root; // the body that names it
	uint32_t to; // simulator that is to solve it
	uint32_t votes; // lead of its bodies in that one's region over the others
	uint32_t pinned; // lowest of its bodies that are pinned to a simulator; NONE: none is
	uint64_t work;
	bool meets; // linked to another rank's
	bool leaves;
} island;

// Head of a rank's message, before its loads and ends.
typedef struct summary {
	uint64_t islands, loads, ends;
	uint64_t moves; // 1 = something goes to another rank in any case
	uint64_t least; // work of the smallest island that may go to another rank; UINT64_MAX: none may
	ob_regions_work work;
} summary;

// Work of islands that are to be solved by the rank.
typedef struct load {
	uint64_t rank, work;
} load;

// Island of a body at a link of two ranks' bodies.
typedef struct end {
	uint32_t root, to, pinned, reserved; // as island
	uint64_t work;
} end;

// A group of bodies that live with this simulator from now on.
typedef struct homes_parcel {
	ob_parcel head;
	uint32_t simulator, count;
	uint64_t solved; // 1 = they are an island, or part of one, that is to be solved
	struct {
		uint32_t id, effort;
	} body[];
} homes_parcel;

typedef struct leaving {
	uint32_t id, island; // index of the island
} leaving;

struct ob_rank_islands {
	const ob_rank_parts *parts;
	uint32_t rank, ranks;
	uint32_t islands;
	island *island; // [object]
	uint32_t *island_of; // [object], valid for roots
	uint8_t *leaves; // [object]: 1 = it is the root of an island that leaves
	uint32_t *parent; // [object]: for roots at borders (table/forest.h)
	uint32_t *best; // [object]: for these, the end with most work among its islands
	uint32_t *order; // [object]: islands that may go to another rank
	leaving *leaving; // [object]
	uint32_t *moved; // [object]: bodies that have a new home
	uint32_t moved_count;
	uint64_t *load; // [ranks]
	ob_mail out, ends; // ends: those of all links, in their order, a's and b's
	ob_mail *dealt; // [ranks]
};

ob_rank_islands *ob_rank_islands_create(const ob_universe *u, const ob_rank_parts *parts)
{
	const uint32_t objects = ob_universe_capacity(u);
	ob_rank_islands *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->parts = parts;
	s->rank = ob_universe_rank(u);
	s->ranks = ob_universe_ranks(u);
	s->island = calloc(objects, sizeof *s->island);
	s->island_of = calloc(objects, sizeof *s->island_of);
	s->leaves = calloc(objects, sizeof *s->leaves);
	s->parent = calloc(objects, sizeof *s->parent);
	s->best = calloc(objects, sizeof *s->best);
	s->order = calloc(objects, sizeof *s->order);
	s->leaving = calloc(objects, sizeof *s->leaving);
	s->moved = calloc(objects, sizeof *s->moved);
	s->load = calloc(s->ranks, sizeof *s->load);
	s->dealt = calloc(s->ranks, sizeof *s->dealt);
	if (s->island && s->island_of && s->leaves && s->parent && s->best && s->order && s->leaving && s->moved &&
	    s->load && s->dealt)
		return s;
	ob_rank_islands_destroy(s);
	return NULL;
}

void ob_rank_islands_destroy(ob_rank_islands *s)
{
	if (!s)
		return;
	for (uint32_t r = 0; s->dealt && r < s->ranks; r++)
		ob_mail_finish(&s->dealt[r]);
	ob_mail_finish(&s->out);
	ob_mail_finish(&s->ends);
	free(s->island);
	free(s->island_of);
	free(s->leaves);
	free(s->parent);
	free(s->best);
	free(s->order);
	free(s->leaving);
	free(s->moved);
	free(s->load);
	free(s->dealt);
	free(s);
}

static bool is_merging(const ob_universe *u)
{
	return ob_universe_step_data(u)->count->merged;
}

// ---- this rank's islands

// Votes for the simulator in whose region most of the island's bodies are (Boyer and Moore, MJRTY: a fast majority vote
// algorithm, 1981).
static void add_body(island *is, const ob_universe *u, const ob_regions *regions, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t at = ob_regions_at(regions, id), pin = data->pin[id];
	is->work += 1 + data->effort[id];
	if (pin && pin <= ob_universe_simulators(u) && pin <= data->objects_max && id < is->pinned)
		is->pinned = id;
	if (!is->votes)
		is->to = at;
	is->votes = is->to == at ? is->votes + 1 : is->votes - 1;
}

static void find_islands(ob_rank_islands *s, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t *body, *root, n = ob_involved_bodies(u, &body, &root);
	s->islands = 0;
	for (uint32_t i = 0; i < n; i++)
		if (root[body[i]] == body[i]) {
			s->island_of[body[i]] = s->islands;
			s->island[s->islands++] = (island){ .root = body[i], .pinned = NONE };
		}
	for (uint32_t i = 0; i < n; i++)
		add_body(&s->island[s->island_of[root[body[i]]]], u, s->parts->regions, body[i]);
	for (uint32_t i = 0; i < s->islands; i++) {
		island *is = &s->island[i];
		if (is->pinned != NONE)
			is->to = data->pin[is->pinned] - 1;
		else if (is_merging(u) && ob_universe_rank_of(u, is->to) != s->rank) // it is solved here already
			is->to = ob_home_of(u, is->root);
	}
}

static uint32_t own_end(const ob_universe *u, const ob_rank_link *k, uint32_t rank)
{
	return ob_home_rank(u, k->a) == rank ? k->a : ob_home_rank(u, k->b) == rank ? k->b : NONE;
}

static void add_ends(ob_rank_islands *s, ob_universe *u, const ob_rank_link *link, uint32_t links, uint64_t *ends)
{
	const uint32_t *body, *root;
	ob_involved_bodies(u, &body, &root);
	for (uint32_t i = 0; i < links; i++) {
		const uint32_t id = own_end(u, &link[i], s->rank);
		if (id == NONE)
			continue;
		island *is = &s->island[s->island_of[root[id]]];
		const end e = { .root = is->root, .to = is->to, .pinned = is->pinned, .work = is->work };
		is->meets = true;
		ob_mail_append(&s->out, &e, sizeof e);
		++*ends;
	}
}

static void add_loads(ob_rank_islands *s, const ob_universe *u, uint64_t *loads)
{
	memset(s->load, 0, s->ranks * sizeof *s->load);
	for (uint32_t i = 0; i < s->islands; i++)
		s->load[ob_universe_rank_of(u, s->island[i].to)] += s->island[i].work;
	for (uint32_t r = 0; r < s->ranks; r++) {
		const load of = { r, s->load[r] };
		if (!of.work)
			continue;
		ob_mail_append(&s->out, &of, sizeof of);
		++*loads;
	}
}

// True if the island may go to another rank for balance alone.
static bool may_spill(const ob_rank_islands *s, const ob_universe *u, const island *is)
{
	return !is->meets && is->pinned == NONE && ob_universe_rank_of(u, is->to) == s->rank;
}

static void write_summary(ob_rank_islands *s, ob_universe *u, const ob_rank_link *link, uint32_t links, uint32_t fliers)
{
	summary own = { .islands = s->islands,
			.moves = fliers > 0,
			.least = UINT64_MAX,
			.work = ob_regions_work_of(s->parts->regions) };
	const size_t at = s->out.used;
	ob_mail_append(&s->out, &own, sizeof own);
	if (!is_merging(u))
		add_loads(s, u, &own.loads);
	add_ends(s, u, link, links, &own.ends);
	for (uint32_t i = 0; i < s->islands && !is_merging(u); i++) {
		const island *is = &s->island[i];
		own.moves |= !is->meets && ob_universe_rank_of(u, is->to) != s->rank;
		if (may_spill(s, u, is) && is->work < own.least)
			own.least = is->work;
	}
	if (!s->out.lost)
		memcpy(s->out.bytes + at, &own, sizeof own);
}

// ---- totals of all ranks

// Sums over the messages of all ranks.
typedef struct totals {
	bool islands, moves;
	uint64_t most; // work: share of a rank
	ob_regions_work work;
} totals;

// Reads the summary of a rank, if the message has the length that it states.
static bool read_summary(const char *all, const size_t *at, uint32_t rank, summary *out)
{
	const size_t begin = at[rank] + sizeof(ob_peers_head), room = at[rank + 1] - begin;
	if (at[rank + 1] < begin + sizeof *out)
		return false;
	memcpy(out, all + begin, sizeof *out);
	return out->loads < room && out->ends < room &&
	       room == sizeof *out + out->loads * sizeof(load) + out->ends * sizeof(end);
}

static const char *behind_summary(const char *all, const size_t *at, uint32_t rank)
{
	return all + at[rank] + sizeof(ob_peers_head) + sizeof(summary);
}

static bool read_loads(ob_rank_islands *s, const char *from, uint64_t loads)
{
	for (uint64_t i = 0; i < loads; i++) {
		load of;
		memcpy(&of, from + i * sizeof of, sizeof of);
		if (of.rank >= s->ranks)
			return false;
		s->load[of.rank] += of.work;
	}
	return true;
}

static bool is_sound_end(const ob_universe *u, const end *e)
{
	return e->root < ob_universe_ids(u) && e->to < ob_universe_simulators(u);
}

// Reads the next end of a rank's message.
static bool take_end(ob_rank_islands *s, const ob_universe *u, const char **next, uint64_t *left, uint32_t rank)
{
	end e;
	if (!left[rank])
		return false;
	memcpy(&e, next[rank], sizeof e);
	next[rank] += sizeof e;
	left[rank]--;
	ob_mail_append(&s->ends, &e, sizeof e);
	return is_sound_end(u, &e) && !s->ends.lost;
}

// Reads the ends of all ranks. false: a rank has sent others than those of its bodies; or no memory.
static bool read_ends(ob_rank_islands *s, const ob_universe *u, const char *all, const size_t *at,
		      const ob_rank_link *link, uint32_t links)
{
	const char **next = calloc(s->ranks, sizeof *next);
	uint64_t *left = calloc(s->ranks, sizeof *left);
	bool sound = next && left;
	for (uint32_t r = 0; sound && r < s->ranks; r++) {
		summary of;
		sound = read_summary(all, at, r, &of);
		next[r] = behind_summary(all, at, r) + of.loads * sizeof(load);
		left[r] = of.ends;
	}
	ob_mail_clear(&s->ends);
	for (uint32_t i = 0; sound && i < links; i++)
		for (int side = 0; sound && side < 2; side++)
			sound = take_end(s, u, next, left, ob_home_rank(u, side ? link[i].b : link[i].a));
	free(next);
	free(left);
	return sound;
}

static end end_at(const ob_rank_islands *s, uint32_t i)
{
	end e;
	memcpy(&e, s->ends.bytes + i * sizeof e, sizeof e);
	return e;
}

// True if end a decides over b: a pinned one, the lowest body of several; else the one with more work.
static bool is_better(const end *a, const end *b)
{
	if (a->pinned != b->pinned)
		return a->pinned < b->pinned;
	return a->work != b->work ? a->work > b->work : a->root < b->root;
}

// Joins the islands that are linked. Returns true if there are any links.
static bool join_islands(ob_rank_islands *s, uint32_t links)
{
	for (uint32_t i = 0; i < 2 * links; i++) {
		const uint32_t root = end_at(s, i).root;
		s->parent[root] = root;
	}
	for (uint32_t i = 0; i < links; i++)
		ob_forest_join(s->parent, end_at(s, 2 * i).root, end_at(s, 2 * i + 1).root);
	for (uint32_t i = 0; i < 2 * links; i++)
		s->best[ob_forest_root(s->parent, end_at(s, i).root)] = i;
	for (uint32_t i = 0; i < 2 * links; i++) {
		const end e = end_at(s, i);
		uint32_t *best = &s->best[ob_forest_root(s->parent, e.root)];
		const end before = end_at(s, *best);
		if (is_better(&e, &before))
			*best = i;
	}
	for (uint32_t i = 0; i < s->islands; i++) {
		island *is = &s->island[i];
		if (is->meets)
			is->to = end_at(s, s->best[ob_forest_root(s->parent, is->root)]).to;
	}
	return links > 0;
}

static uint32_t least_loaded(const ob_rank_islands *s)
{
	uint32_t best = 0;
	for (uint32_t r = 1; r < s->ranks; r++)
		best = s->load[r] < s->load[best] ? r : best;
	return best;
}

// Adds up all ranks' messages. false: one is malformed, or no memory; then the step has failed.
static bool add_up(ob_rank_islands *s, ob_universe *u, const ob_peers *p, const char *all, const size_t *at,
		   const ob_rank_link *link, uint32_t links, totals *t)
{
	uint64_t work = 0;
	*t = (totals){ 0 };
	memset(s->load, 0, s->ranks * sizeof *s->load);
	for (uint32_t r = 0; r < s->ranks; r++) {
		summary of;
		if (!read_summary(all, at, r, &of) || !read_loads(s, behind_summary(all, at, r), of.loads)) {
			ob_peers_blame(p, u, r);
			return false;
		}
		t->islands |= of.islands > 0;
		t->moves |= of.moves > 0;
		t->work.all += of.work.all;
		t->work.spilled += of.work.spilled;
	}
	if (!read_ends(s, u, all, at, link, links)) {
		ob_step_fail(u, OB_STEP_DAMAGED, 0);
		return false;
	}
	t->moves |= join_islands(s, links);
	for (uint32_t r = 0; r < s->ranks; r++)
		work += s->load[r];
	t->most = ob_work_share(work, s->ranks);
	for (uint32_t r = 0; r < s->ranks && !is_merging(u); r++) {
		summary of;
		read_summary(all, at, r, &of);
		t->moves |= s->load[r] > t->most && of.least < s->load[r] - s->load[least_loaded(s)];
	}
	return true;
}

// ---- balance

// Islands that qsort compares in this thread.
static _Thread_local const island *islands_compared;

static int by_work(const void *a, const void *b)
{
	const island *x = &islands_compared[*(const uint32_t *)a], *y = &islands_compared[*(const uint32_t *)b];
	if (x->work != y->work)
		return x->work > y->work ? -1 : 1;
	return x->root < y->root ? -1 : x->root > y->root;
}

// Splits the spare capacity of other ranks among overloaded ranks in proportion to their excess.
static void leave_room_to_others(ob_rank_islands *s, uint64_t most)
{
	uint64_t over = 0;
	for (uint32_t r = 0; r < s->ranks; r++)
		over += s->load[r] > most ? s->load[r] - most : 0;
	const double share = (double)(s->load[s->rank] - most) / (double)over;
	for (uint32_t r = 0; r < s->ranks; r++)
		if (s->load[r] < most)
			s->load[r] = most - (uint64_t)((double)(most - s->load[r]) * share);
}

// Gives islands to less loaded ranks, the largest first.
static void spill(ob_rank_islands *s, const ob_universe *u, uint64_t most)
{
	const uint32_t each = ob_universe_simulators(u) / s->ranks;
	uint32_t n = 0;
	if (s->load[s->rank] <= most)
		return;
	leave_room_to_others(s, most);
	for (uint32_t i = 0; i < s->islands; i++)
		if (may_spill(s, u, &s->island[i]))
			s->order[n++] = i;
	islands_compared = s->island;
	qsort(s->order, n, sizeof *s->order, by_work);
	for (uint32_t i = 0; i < n && s->load[s->rank] > most; i++) {
		island *is = &s->island[s->order[i]];
		const uint32_t to = least_loaded(s);
		if (s->load[to] + is->work >= s->load[s->rank] || to * each >= ob_universe_capacity(u))
			continue;
		s->load[s->rank] -= is->work;
		s->load[to] += is->work;
		is->to = to * each;
		ob_regions_spill(s->parts->regions, is->work);
	}
}

// ---- sent bodies

static int by_island(const void *a, const void *b)
{
	const leaving *x = a, *y = b;
	if (x->island != y->island)
		return x->island < y->island ? -1 : 1;
	return x->id < y->id ? -1 : x->id > y->id;
}

// Lists bodies of islands that another rank solves, island by island; returns their number.
static uint32_t list_leaving(ob_rank_islands *s, ob_universe *u)
{
	const uint32_t *body, *root, bodies = ob_involved_bodies(u, &body, &root);
	uint32_t n = 0;
	for (uint32_t i = 0; i < s->islands; i++) {
		island *is = &s->island[i];
		is->leaves = ob_universe_rank_of(u, is->to) != s->rank;
		s->leaves[is->root] = is->leaves;
	}
	for (uint32_t i = 0; i < bodies; i++) {
		const uint32_t k = s->island_of[root[body[i]]];
		if (s->island[k].leaves)
			s->leaving[n++] = (leaving){ body[i], k };
	}
	qsort(s->leaving, n, sizeof *s->leaving, by_island);
	return n;
}

// Packs new homes of bodies, for all ranks.
static void put_homes(ob_rank_islands *s, const ob_universe *u, const leaving *body, uint32_t n, uint32_t simulator,
		      bool solved)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const homes_parcel h = { { OB_PARCEL_HOMES, (uint32_t)(sizeof h + n * sizeof *h.body) }, simulator, n, solved };
	for (uint32_t r = 0; r < s->ranks; r++) {
		ob_mail_append(&s->dealt[r], &h, sizeof h);
		for (uint32_t i = 0; i < n; i++) {
			const uint32_t of[2] = { body[i].id, data->effort[body[i].id] };
			ob_mail_append(&s->dealt[r], of, sizeof of);
		}
	}
}

static void rehome(ob_rank_islands *s, ob_universe *u, uint32_t id, uint32_t simulator)
{
	ob_halo_rehome(s->parts->halo, u, id, simulator);
	s->moved[s->moved_count++] = id;
}

static void give_bodies(ob_rank_islands *s, ob_universe *u)
{
	for (uint32_t i = 0; i < s->moved_count; i++) {
		ob_mail *to = &s->dealt[ob_home_rank(u, s->moved[i])];
		ob_holdings_give(s->parts->holdings, u, s->moved[i], to);
		ob_halo_give(s->parts->halo, u, s->moved[i], to);
	}
}

// Packs the bodies that leave, for each rank; their homes come first.
static void pack(ob_rank_islands *s, ob_universe *u, const uint32_t *flier, uint32_t fliers)
{
	const uint32_t n = list_leaving(s, u);
	s->moved_count = 0;
	for (uint32_t r = 0; r < s->ranks; r++)
		ob_peers_begin(&s->dealt[r]);
	for (uint32_t i = 0, k; i < n; i = k) {
		const uint32_t to = s->island[s->leaving[i].island].to;
		for (k = i; k < n && s->leaving[k].island == s->leaving[i].island; k++)
			rehome(s, u, s->leaving[k].id, to);
		put_homes(s, u, s->leaving + i, k - i, to, true);
	}
	ob_involved_drop(u, s->leaves);
	for (uint32_t i = 0; i < fliers; i++) {
		const leaving one = { .id = flier[i] };
		const uint32_t to = ob_regions_at(s->parts->regions, flier[i]);
		rehome(s, u, flier[i], to);
		put_homes(s, u, &one, 1, to, false);
	}
	give_bodies(s, u);
}

// ---- received bodies

static bool take_homes(ob_rank_islands *s, ob_universe *u, const char *parcel, size_t bytes, uint32_t from)
{
	const ob_step_data *data = ob_universe_step_data(u);
	homes_parcel h;
	uint32_t of[2], first = NONE;
	if (bytes < sizeof h)
		return false;
	memcpy(&h, parcel, sizeof h);
	if (h.simulator >= ob_universe_simulators(u) || h.count > ob_universe_ids(u) ||
	    bytes != sizeof h + h.count * sizeof of)
		return false;
	for (uint32_t i = 0; i < h.count; i++) {
		memcpy(of, parcel + sizeof h + i * sizeof of, sizeof of);
		const uint32_t id = of[0];
		if (id >= ob_universe_ids(u) || ob_home_rank(u, id) != from)
			return false;
		rehome(s, u, id, h.simulator);
		if (ob_universe_rank_of(u, h.simulator) != s->rank)
			continue;
		data->effort[id] = of[1];
		ob_regions_take(s->parts->regions, id, h.simulator);
		first = first == NONE ? id : first;
		if (h.solved)
			ob_involved_join(u, first, id);
	}
	return true;
}

static bool take_parcel(void *islands, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from)
{
	ob_rank_islands *s = islands;
	switch (head->kind) {
	case OB_PARCEL_HOMES:
		return take_homes(s, u, parcel, head->bytes, from);
	case OB_PARCEL_KEPT:
		return ob_holdings_take(s->parts->holdings, u, parcel, head->bytes);
	default:
		return ob_halo_take(s->parts->halo, u, parcel, head);
	}
}

// Makes moved bodies due at their new home, and schedules the pairs that are now checked here at once.
static void note_moved(const ob_rank_islands *s, ob_universe *u)
{
	for (uint32_t i = 0; i < s->moved_count; i++) {
		ob_calendar_enter_due(u, s->moved[i]);
		ob_pairs_look(u, s->moved[i]);
	}
}

static bool move(ob_rank_islands *s, ob_universe *u, ob_peers *p, const uint32_t *flier, uint32_t fliers)
{
	pack(s, u, flier, fliers);
	if (!ob_parcels_exchange(p, u, OB_PEERS_MOVE, s->dealt, true, take_parcel, s))
		return false;
	note_moved(s, u);
	return true;
}

bool ob_rank_islands_share(ob_rank_islands *s, ob_universe *u, ob_peers *p, const ob_rank_link *link, uint32_t links,
			   bool *islands)
{
	const size_t *at;
	uint32_t fliers = 0;
	totals t;
	*islands = true;
	if (is_merging(u) && !links)
		return true;
	const uint32_t *flier = is_merging(u) ? NULL : ob_regions_find_fliers(s->parts->regions, u, &fliers);
	find_islands(s, u);
	ob_peers_begin(&s->out);
	write_summary(s, u, link, links, fliers);
	const char *all = ob_peers_exchange(p, u, (ob_peers_head){ .phase = OB_PEERS_SHARE }, &s->out, false, &at);
	if (!all || !add_up(s, u, p, all, at, link, links, &t))
		return false;
	*islands = t.islands;
	if (!is_merging(u))
		spill(s, u, t.most);
	if (t.moves && !move(s, u, p, flier, fliers))
		return false;
	for (uint32_t i = 0; i < links; i++)
		if (ob_home_rank(u, link[i].a) == s->rank && ob_home_rank(u, link[i].b) == s->rank)
			ob_involved_join(u, link[i].a, link[i].b);
	return is_merging(u) || ob_regions_renew(s->parts->regions, u, p, &t.work);
}
