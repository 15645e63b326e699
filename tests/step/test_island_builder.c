// Islands against a flood fill over the pairs in contact, or expected to be.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "schedule/calendar.h"
#include "step/island_builder.h"
#include "step/pairs.h"
#include "table/layout.h"

#include "motion/random.h"

enum { BODIES = 300 };

// Bodies and pairs made by hand: the builder uses only schedule records and pairs.
static void random_graph(ob_universe *u, uint64_t seed, double density)
{
	ob_step_data *ex = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	uint32_t n = 0;
	ob_calendar_clear(&look); // the graph before may have had more pairs
	for (uint32_t i = 0; i < BODIES; i++) {
		double kind = uniform(&seed), path = within(&seed, 0, 10);
		double reach = uniform(&seed) < .1 ? within(&seed, .1, 1) : within(&seed, 0, .05);
		ex->neighbours[i] = (struct ob_neighbours){ 0, 0 }; // not queried
		ex->schedule[i] = (ob_schedule){ .path = path, .reach = (float)reach, .state = OB_SCHEDULE_AWAKE };
		if (kind < .1)
			ex->schedule[i].state = OB_SCHEDULE_STATIC;
		if (kind > .6)
			ex->schedule[i].state = OB_SCHEDULE_ASLEEP, ex->schedule[i].reach = 0,
			ex->schedule[i].due = UINT32_MAX;
		if (kind > .97)
			ex->schedule[i].state = OB_SCHEDULE_ABSENT;
	}
	for (uint32_t a = 0; a < BODIES; a++)
		for (uint32_t b = a + 1; b < BODIES; b++) {
			const ob_schedule *x = &ex->schedule[a], *y = &ex->schedule[b];
			bool fixed = x->state == OB_SCHEDULE_STATIC && y->state == OB_SCHEDULE_STATIC;
			if (uniform(&seed) > density / BODIES || fixed || !x->state || !y->state)
				continue;
			double limit = x->path + y->path + within(&seed, -.1, .5);
			double kind = uniform(&seed);
			ex->pair[n] = (ob_pair_key){ .a = a, .b = b, .record = n, .limit = limit };
			ex->pair[n].active = kind < .2;
			ex->pair[n].expected = kind > .2 && kind < .6 &&
					       (x->state == OB_SCHEDULE_AWAKE || y->state == OB_SCHEDULE_AWAKE);
			n++;
		}
	ex->count->pairs = n;
	for (uint32_t i = 0; i < BODIES; i++)
		ex->result_island[i] = UINT32_MAX;
	ob_pairs_link(u);
}

typedef struct flood {
	uint32_t island[BODIES]; // lowest id of the group
	bool united[BODIES]; // by lowest id: merged after separate solves, or hit a fixed body
} flood;

static bool moves(const ob_step_data *ex, uint32_t id)
{
	return ex->schedule[id].state == OB_SCHEDULE_AWAKE || ex->schedule[id].state == OB_SCHEDULE_ASLEEP;
}

static bool may_touch(const ob_step_data *ex, const ob_pair_key *k)
{
	const ob_schedule *a = &ex->schedule[k->a], *b = &ex->schedule[k->b];
	return k->active || a->reach + b->reach >= k->limit - a->path - b->path;
}

static void join(uint32_t *group, uint32_t a, uint32_t b)
{
	for (uint32_t i = 0; i < BODIES; i++)
		if (group[i] == (a < b ? b : a))
			group[i] = a < b ? a : b;
}

static void flood_fill(const ob_step_data *ex, flood *f)
{
	for (uint32_t i = 0; i < BODIES; i++)
		f->island[i] = i;
	for (uint32_t i = ex->count->pairs; i > 0; i--) { // another order than the plan's
		const ob_pair_key *k = &ex->pair[i - 1];
		if (moves(ex, k->a) && moves(ex, k->b) && f->island[k->a] != f->island[k->b] &&
		    (k->active || k->expected))
			join(f->island, f->island[k->a], f->island[k->b]);
	}
}

static bool awake_group(const ob_step_data *ex, const flood *f, uint32_t group)
{
	for (uint32_t i = 0; i < BODIES; i++)
		if (f->island[i] == group && ex->schedule[i].state == OB_SCHEDULE_AWAKE)
			return true;
	return false;
}

static void list_pairs_and_deal(ob_universe *u)
{
	for (uint32_t i = 0; i < ob_islands_list_tasks(u); i++)
		ob_islands_list_pairs(u, i);
	ob_islands_deal(u, NULL);
}

static void build(ob_universe *u)
{
	ob_islands_begin(u);
	for (uint32_t i = 0; i < ob_islands_link_tasks(u); i++)
		ob_islands_link(u, i);
	ob_islands_list_members(u);
	list_pairs_and_deal(u);
}

static void check_members(const ob_step_data *ex, const flood *f, const ob_island *is, uint32_t index)
{
	const uint32_t *member = ex->member + is->first_member;
	uint32_t group = f->island[member[0]], count = 0;
	CHECK(group == member[0]); // the lowest id leads
	for (uint32_t i = 0; i < BODIES; i++)
		if (moves(ex, i) && f->island[i] == group) {
			CHECK(count < is->members && member[count] == i);
			CHECK(ex->result_island[i] == index);
			count++;
		}
	CHECK(count == is->members);
}

static void check_island_pairs(const ob_step_data *ex, const flood *f, const ob_island *is)
{
	uint32_t group = f->island[ex->member[is->first_member]], count = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		uint32_t a = f->island[k->a], b = f->island[k->b];
		bool inside = (a == group || !moves(ex, k->a)) && (b == group || !moves(ex, k->b));
		if (!inside)
			continue;
		CHECK(k->in_island == may_touch(ex, k));
		if (k->in_island) {
			CHECK(count < is->pairs && ex->island_pair[is->first_pair + count] == i);
			count++;
		}
	}
	CHECK(count == is->pairs);
}

// Chunks of unsolved islands, largest first.
static void check_order(const ob_step_data *ex, uint32_t solved)
{
	uint32_t n = ex->count->islands - solved;
	CHECK(ex->count->chunks == 0 || ex->chunk[0] == 0);
	CHECK(ex->chunk[ex->count->chunks] == n);
	for (uint32_t i = 0; i < ex->count->chunks; i++)
		CHECK(ex->chunk[i] < ex->chunk[i + 1]);
	for (uint32_t i = 1; i < n; i++) {
		const ob_island *p = &ex->island[i - 1], *q = &ex->island[i];
		CHECK(p->members + 8 * p->pairs >= q->members + 8 * q->pairs);
	}
	for (uint32_t i = 0; i < ex->count->islands; i++)
		CHECK(ex->island[i].solved == (i >= n));
}

static void check_plan(const ob_step_data *ex)
{
	flood f;
	uint32_t groups = 0;
	flood_fill(ex, &f);
	for (uint32_t i = 0; i < BODIES; i++) {
		bool awake = moves(ex, i) && awake_group(ex, &f, f.island[i]);
		groups += awake && f.island[i] == i;
		CHECK(awake || ex->result_island[i] == UINT32_MAX);
	}
	CHECK(ex->count->islands == groups);
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		check_members(ex, &f, &ex->island[i], i);
		check_island_pairs(ex, &f, &ex->island[i]);
	}
	check_order(ex, 0);
}

// Clears the entries of all pairs, so that new ones are visible.
static void forget_entries(ob_universe *u)
{
	const ob_calendar look = ob_calendar_of_pairs(u);
	for (uint32_t i = 0; i < ob_universe_step_data(u)->count->pairs; i++)
		ob_calendar_set(&look, i, UINT32_MAX);
}

static bool is_solved_again(const ob_step_data *ex, uint32_t id)
{
	const uint32_t is = ex->result_island[id];
	return is != UINT32_MAX && !ex->island[is].solved;
}

// Pairs of islands solved again are checked again, and no others. All pairs in islands are in one list.
static void check_lists_after_reunion(const ob_universe *u)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	uint32_t inside = 0, listed = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		CHECK((ex->look.one[i] == UINT32_MAX - 1 - ob_step_count(u)) ==
		      (is_solved_again(ex, k->a) || is_solved_again(ex, k->b)));
		inside += k->in_island;
	}
	for (uint32_t i = 0; i < ex->count->islands; i++)
		for (uint32_t k = 0; k < ex->island[i].pairs; k++, listed++) {
			const ob_pair_key *pair = &ex->pair[ex->island_pair[ex->island[i].first_pair + k]];
			CHECK(pair->in_island && ex->result_island[moves(ex, pair->a) ? pair->a : pair->b] == i);
		}
	CHECK(inside == listed && ex->count->island_pairs == listed);
}

// Some pairs of different islands are in new contact, some bodies with a fixed one, and some have fallen asleep
// meanwhile: islands merged from several are solved again, the others stand.
static void check_reunion(ob_universe *u, uint64_t seed)
{
	ob_step_data *ex = ob_universe_step_data(u);
	static uint32_t before[BODIES];
	flood f;
	memcpy(before, ex->result_island, sizeof before);
	flood_fill(ex, &f); // the first plan's islands, and the groups of sleepers
	memset(f.united, 0, sizeof f.united);
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		ob_pair_key *k = &ex->pair[i];
		bool awake = before[k->a] != UINT32_MAX || before[k->b] != UINT32_MAX;
		k->late = awake && !k->in_island && uniform(&seed) < .05;
		if (!k->late)
			continue;
		if (moves(ex, k->a) && moves(ex, k->b) && f.island[k->a] != f.island[k->b]) {
			uint32_t x = f.island[k->a], y = f.island[k->b];
			join(f.island, x, y);
			f.united[x < y ? x : y] = true;
		}
		f.united[f.island[moves(ex, k->a) ? k->a : k->b]] = true;
	}
	for (uint32_t i = 0; i < BODIES; i++)
		if (before[i] != UINT32_MAX && uniform(&seed) < .1)
			ex->schedule[i].state = OB_SCHEDULE_ASLEEP;
	for (uint32_t i = 0; i < BODIES; i++) // a union may have been united again under a lower id
		f.united[f.island[i]] |= f.united[i];
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		ex->check[i] = i;
	ex->count->checks = ex->count->pairs;
	forget_entries(u);
	ob_islands_merge(u);
	ob_islands_list_members(u);
	list_pairs_and_deal(u);
	check_lists_after_reunion(u);
	uint32_t unsolved = 0;
	for (uint32_t i = 0; i < ex->count->islands; i++) {
		const ob_island *is = &ex->island[i];
		check_members(ex, &f, is, i);
		CHECK(is->solved == !f.united[ex->member[is->first_member]]);
		unsolved += !is->solved;
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		uint32_t id = moves(ex, k->a) ? k->a : k->b, is = ex->result_island[id];
		if (is != UINT32_MAX && !ex->island[is].solved)
			CHECK(isinf(k->limit)); // no result of the step holds
	}
	check_order(ex, ex->count->islands - unsolved);
}

int main(void)
{
	little_scene *s = little_scene_new();
	for (int i = 0; i < BODIES; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(i, 0, 0));
	uint32_t largest = 0, smallest = UINT32_MAX;
	for (uint32_t workers = 1; workers <= 3; workers += 2) {
		ob_universe *u = little_populate(s, workers);
		const ob_step_data *ex = ob_universe_step_data(u);
		CHECK(ob_universe_ids(u) == BODIES);
		for (uint64_t seed = 1; seed <= 60; seed++) {
			random_graph(u, seed, .5 + .1 * (double)seed);
			build(u);
			check_plan(ex);
			largest = ex->island[0].members > largest ? ex->island[0].members : largest;
			smallest = ex->island[0].members < smallest ? ex->island[0].members : smallest;
			check_reunion(u, seed);
		}
		ob_universe_destroy(u, true);
	}
	CHECK(largest > 100 && smallest < 30); // from many small ones to nearly all in one
	free(s);
	return check_end();
}
