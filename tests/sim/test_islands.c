// Islands against a flood fill over the pairs that may touch within the step.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "sim/islands.h"

#include "motion/random.h"

enum { BODIES = 300 };

// Bodies and pairs by hand: nothing but briefs and pairs matters to the plan.
static void random_graph(ob_universe *u, uint64_t seed, double density)
{
	ob_exchange *ex = ob_universe_exchange(u);
	uint32_t n = 0;
	for (uint32_t i = 0; i < BODIES; i++) {
		double kind = uniform(&seed), path = within(&seed, 0, 10);
		double reach = uniform(&seed) < .1 ? within(&seed, .1, 1) : within(&seed, 0, .05);
		ex->perceived[i] = (struct ob_perceived){ 0, 0 }; // nobody has asked
		ex->brief[i] = (ob_brief){ path, (float)reach, kind < .1 ? OB_BRIEF_STATIC : OB_BRIEF_AWAKE };
		if (kind > .6)
			ex->brief[i].state = OB_BRIEF_ASLEEP, ex->brief[i].reach = 0;
		if (kind > .97)
			ex->brief[i].state = OB_BRIEF_ABSENT;
	}
	for (uint32_t a = 0; a < BODIES; a++)
		for (uint32_t b = a + 1; b < BODIES; b++) {
			const ob_brief *x = &ex->brief[a], *y = &ex->brief[b];
			bool fixed = x->state == OB_BRIEF_STATIC && y->state == OB_BRIEF_STATIC;
			if (uniform(&seed) > density / BODIES || fixed || !x->state || !y->state)
				continue;
			double limit = x->path + y->path + within(&seed, -.1, .5);
			ex->pair[n] = (ob_pair_key){ a, b, n, uniform(&seed) < .2, limit };
			n++;
		}
	ex->count->pairs = n;
}

typedef struct flood {
	uint32_t island[BODIES]; // lowest id of the group
	double reach[BODIES]; // own, or handed on
} flood;

static bool moves(const ob_exchange *ex, uint32_t id)
{
	return ex->brief[id].state == OB_BRIEF_AWAKE || ex->brief[id].state == OB_BRIEF_ASLEEP;
}

static double reach_of(const ob_exchange *ex, const flood *f, uint32_t id)
{
	return moves(ex, id) ? f->reach[id] : 0;
}

static double way(const ob_exchange *ex, const ob_pair_key *k)
{
	return k->active ? 0 : fmax(0, k->limit - ex->brief[k->a].path - ex->brief[k->b].path);
}

static bool may_touch(const ob_exchange *ex, const flood *f, const ob_pair_key *k)
{
	return k->active || reach_of(ex, f, k->a) + reach_of(ex, f, k->b) >= way(ex, k);
}

// What is left of the reach of body "from" to each other body, by Dijkstra's method (1959).
static void hand_on(const ob_exchange *ex, flood *f, uint32_t from)
{
	static double left[BODIES];
	bool done[BODIES] = { false };
	for (uint32_t i = 0; i < BODIES; i++)
		left[i] = -INFINITY;
	left[from] = ex->brief[from].reach;
	for (;;) {
		uint32_t next = BODIES;
		for (uint32_t i = 0; i < BODIES; i++)
			if (!done[i] && left[i] > 0 && (next == BODIES || left[i] > left[next]))
				next = i;
		if (next == BODIES)
			return;
		done[next] = true;
		f->reach[next] = fmax(f->reach[next], left[next]);
		for (uint32_t i = 0; i < ex->count->pairs; i++) {
			const ob_pair_key *k = &ex->pair[i];
			if ((k->a != next && k->b != next) || !moves(ex, k->a) || !moves(ex, k->b))
				continue;
			uint32_t other = k->a == next ? k->b : k->a;
			left[other] = fmax(left[other], left[next] - way(ex, k));
		}
	}
}

static void join(uint32_t *group, uint32_t a, uint32_t b)
{
	for (uint32_t i = 0; i < BODIES; i++)
		if (group[i] == (a < b ? b : a))
			group[i] = a < b ? a : b;
}

static void flood_fill(const ob_exchange *ex, flood *f)
{
	for (uint32_t i = 0; i < BODIES; i++)
		f->island[i] = i, f->reach[i] = ex->brief[i].reach;
	for (uint32_t i = 0; i < BODIES; i++)
		if (moves(ex, i))
			hand_on(ex, f, i);
	for (uint32_t i = ex->count->pairs; i > 0; i--) { // another order than the plan's
		const ob_pair_key *k = &ex->pair[i - 1];
		if (moves(ex, k->a) && moves(ex, k->b) && f->island[k->a] != f->island[k->b] && may_touch(ex, f, k))
			join(f->island, f->island[k->a], f->island[k->b]);
	}
}

static bool awake_group(const ob_exchange *ex, const flood *f, uint32_t group)
{
	for (uint32_t i = 0; i < BODIES; i++)
		if (f->island[i] == group && ex->brief[i].state == OB_BRIEF_AWAKE)
			return true;
	return false;
}

static void check_members(const ob_exchange *ex, const flood *f, const ob_island *is, uint32_t index)
{
	const uint32_t *member = ex->member + is->first_member;
	uint32_t group = f->island[member[0]], count = 0;
	CHECK(group == member[0]); // the lowest leads
	for (uint32_t i = 0; i < BODIES; i++)
		if (moves(ex, i) && f->island[i] == group) {
			CHECK(count < is->members && member[count] == i);
			CHECK(ex->result_island[i] == index);
			count++;
		}
	CHECK(count == is->members);
}

static void check_island_pairs(const ob_exchange *ex, const flood *f, const ob_island *is)
{
	uint32_t group = f->island[ex->member[is->first_member]], count = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		uint32_t of = f->island[moves(ex, k->a) ? k->a : k->b];
		if (of == group && may_touch(ex, f, k)) {
			CHECK(count < is->pairs && ex->island_pair[is->first_pair + count] == i);
			count++;
		}
	}
	CHECK(count == is->pairs);
}

static void check_plan(const ob_exchange *ex)
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
	CHECK(ex->chunk[0] == 0 && ex->chunk[ex->count->chunks] == ex->count->islands);
	for (uint32_t i = 0; i < ex->count->chunks; i++)
		CHECK(ex->chunk[i] < ex->chunk[i + 1]);
	for (uint32_t i = 1; i < ex->count->islands; i++) { // largest first
		const ob_island *p = &ex->island[i - 1], *q = &ex->island[i];
		CHECK(p->members + 8 * p->pairs >= q->members + 8 * q->pairs);
	}
}

// What may be hit by something faster than its box was claimed for looks farther around before the step.
static void test_larger_boxes(void)
{
	little_scene *s = little_scene_new();
	little_sphere(s, 1, .5, ob_v3(0, 0, 0));
	little_sphere(s, 1, .5, ob_v3(1.1, 0, 0));
	ob_universe *u = little_populate(s, 1);
	ob_exchange *ex = ob_universe_exchange(u);
	ob_rebound_reset(u);
	ex->perceived[0] = ex->perceived[1] = (struct ob_perceived){ 0, 0 };
	ex->brief[0].reach = 2;
	ex->pair[0] = (ob_pair_key){ 0, 1, 0, 0, .1 };
	ex->count->pairs = 1;
	CHECK(!ob_islands_plan(u));
	uint32_t count;
	const uint32_t *list = ob_rebound_list(u, &count);
	CHECK(count == 1 && list[0] == 1);
	CHECK(ex->bounds[1][0] <= 1.1 - .5 - 1.9 && ex->bounds[1][4] >= .5 + 1.9); // .1 m is the way to it
	ob_rebound_reset(u);
	ex->perceived[1] = (struct ob_perceived){ 0, 0 };
	CHECK(ob_islands_plan(u)); // now it holds
	CHECK(ex->count->islands == 1 && ex->island[0].members == 2 && ex->island[0].pairs == 1);
	ob_universe_destroy(u, true);
	free(s);
}

// As the arranger does it: those that must look farther around first do.
static bool plan(ob_universe *u)
{
	ob_exchange *ex = ob_universe_exchange(u);
	for (int i = 0; i < 3; i++) {
		if (ob_islands_plan(u))
			return true;
		for (uint32_t id = 0; id < BODIES; id++)
			ex->perceived[id] = (struct ob_perceived){ 0, 0 };
		ob_rebound_reset(u);
	}
	return false;
}

int main(void)
{
	test_larger_boxes();
	little_scene *s = little_scene_new();
	for (int i = 0; i < BODIES; i++)
		little_sphere(s, 1, .1, ob_v3(i, 0, 0));
	uint32_t largest = 0, smallest = UINT32_MAX;
	for (uint32_t workers = 1; workers <= 3; workers += 2) {
		ob_universe *u = little_populate(s, workers);
		const ob_exchange *ex = ob_universe_exchange(u);
		for (uint64_t seed = 1; seed <= 60; seed++) {
			random_graph(u, seed, .5 + .1 * (double)seed);
			CHECK(plan(u));
			check_plan(ex);
			largest = ex->island[0].members > largest ? ex->island[0].members : largest;
			smallest = ex->island[0].members < smallest ? ex->island[0].members : smallest;
		}
		ob_universe_destroy(u, true);
	}
	CHECK(largest > 100 && smallest < 30); // from many small ones to nearly all in one
	free(s);
	return check_end();
}
