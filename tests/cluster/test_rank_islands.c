// Three ranks form the same islands as one. Random bodies and pairs: each island is one rank's, whole, and its pairs
// are listed there and nowhere else; all ranks know the bodies' homes; bodies that meet another rank's are solved with
// those, in a step and when late contacts merge islands; no rank is overloaded; and moved bodies are at the rank that
// they were moved to. The expected islands are found by a flood over all pairs.
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "cluster/little_ranks.h"
#include "cluster/rank_islands.h"
#include "motion/random.h"
#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "step/island_builder.h"
#include "step/little_universe.h"
#include "step/pairs.h"
#include "table/home.h"
#include "table/layout.h"

enum {
	RANKS = LITTLE_RANKS,
	EACH = 2,
	BODIES = 240,
	MOST_PAIRS = 4 * BODIES,
	SEEDS = 60,
	PINNED = 7,
	NONE = UINT32_MAX
};

// Shared by all ranks: the input, and each rank's results.
typedef struct story {
	little_exchange x;
	uint64_t seed;
	bool even, pinned; // what bodies cost; some were moved
	uint32_t pairs, home[BODIES], effort[BODIES], pin[BODIES];
	bool asleep[BODIES];
	ob_pair_key pair[MOST_PAIRS];
	uint32_t lead[BODIES]; // expected: lowest id of the island; NONE: in no island
	uint32_t solver[BODIES], leader[BODIES], listed[MOST_PAIRS]; // actual
	uint32_t homes[RANKS][BODIES];
	uint64_t load[RANKS], largest;
	uint32_t moved, met, islands;
	uint32_t all_moved, all_met; // in all stories
} story;

typedef struct rank {
	story *s;
	ob_universe *u;
	ob_rank_islands *islands;
	ob_rank_parts parts;
	little_wire wire;
	ob_peers p;
	uint32_t wrong, met;
} rank;

static uint32_t any(uint64_t *seed, uint32_t of)
{
	const uint32_t i = (uint32_t)(of * uniform(seed));
	return i < of ? i : of - 1;
}

// Touching bodies are one rank's: they are linked at home. Bodies expected to touch may belong to two.
static void begin_story(story *s)
{
	const bool few = uniform(&s->seed) < .5;
	s->even = uniform(&s->seed) < .5;
	s->pairs = 0;
	s->pinned = uniform(&s->seed) < .3;
	for (uint32_t i = 0; i < BODIES; i++) {
		s->home[i] = s->even ? i * RANKS * EACH / BODIES : any(&s->seed, 2) ? 0 : any(&s->seed, RANKS * EACH);
		s->effort[i] = s->even ? 20 : any(&s->seed, 400);
		s->asleep[i] = uniform(&s->seed) < .4;
		s->pin[i] = s->pinned && i % 40 == PINNED ? 1 + any(&s->seed, RANKS * EACH) : 0;
	}
	for (uint32_t a = 0; a < BODIES; a++)
		for (uint32_t k = any(&s->seed, few ? 3 : 5); k > 0; k--) {
			const uint32_t b = a + 1 + any(&s->seed, 12);
			if (b >= BODIES || s->pairs == MOST_PAIRS)
				continue;
			const bool across = s->home[a] / EACH != s->home[b] / EACH;
			const double kind = uniform(&s->seed);
			s->pair[s->pairs++] = (ob_pair_key){ .a = a,
							     .b = b,
							     .record = OB_NO_RECORD,
							     .limit = 1e9,
							     .active = !across && kind<.3, .expected = kind> .8 &&
								       !(s->asleep[a] && s->asleep[b]) };
		}
}

static void join_all(uint32_t *lead, uint32_t a, uint32_t b)
{
	const uint32_t low = lead[a] < lead[b] ? lead[a] : lead[b], high = lead[a] < lead[b] ? lead[b] : lead[a];
	for (uint32_t i = 0; i < BODIES; i++)
		lead[i] = lead[i] == high ? low : lead[i];
}

// Groups linked to an awake body by the links of a step.
static void flood(story *s)
{
	static bool awake[BODIES];
	uint32_t group[BODIES];
	memset(awake, 0, sizeof awake);
	for (uint32_t i = 0; i < BODIES; i++)
		group[i] = i;
	for (uint32_t i = 0; i < s->pairs; i++)
		if (s->pair[i].active || s->pair[i].expected)
			join_all(group, s->pair[i].a, s->pair[i].b);
	for (uint32_t i = 0; i < BODIES; i++)
		awake[group[i]] |= !s->asleep[i];
	for (uint32_t i = 0; i < BODIES; i++)
		s->lead[i] = awake[group[i]] ? group[i] : NONE;
}

// Late contacts, of bodies in islands and others: the bodies of the islands that they join are solved again, and so are
// sleepers with their contacts. Afterwards only these have a leader.
static void flood_late(story *s)
{
	uint32_t group[BODIES];
	bool again[BODIES] = { false };
	for (uint32_t i = 0; i < BODIES; i++)
		group[i] = s->lead[i] == NONE ? i : s->lead[i];
	for (uint32_t i = 0; i < s->pairs; i++) // sleepers that no contact has woken
		if (s->pair[i].active && s->lead[s->pair[i].a] == NONE && s->lead[s->pair[i].b] == NONE)
			join_all(group, s->pair[i].a, s->pair[i].b);
	for (uint32_t i = 0; i < s->pairs; i++)
		if (s->pair[i].late)
			join_all(group, s->pair[i].a, s->pair[i].b);
	for (uint32_t i = 0; i < s->pairs; i++)
		if (s->pair[i].late)
			again[group[s->pair[i].a]] = true;
	for (uint32_t i = 0; i < BODIES; i++)
		s->lead[i] = again[group[i]] ? group[i] : NONE;
}

// ---- a rank

static void write_world(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	const ob_calendar look = ob_calendar_of_pairs(r->u);
	const story *s = r->s;
	ob_calendar_clear(&look); // there may have been more pairs before
	for (uint32_t i = 0; i < BODIES; i++) {
		const float at = (float)i;
		const float box[6] = { at, 0, 0, at + 1, 1, 1 };
		memcpy(data->bounds[i], box, sizeof box);
		data->schedule[i] = (ob_schedule){ .state = s->asleep[i] ? OB_SCHEDULE_ASLEEP : OB_SCHEDULE_AWAKE,
						   .due = s->asleep[i] ? UINT32_MAX : 0 };
		data->result_island[i] = UINT32_MAX;
		data->effort[i] = s->home[i] / EACH == r->p.rank ? s->effort[i] : 0; // other ranks do not have it
		data->pin[i] = s->pin[i];
		ob_halo_rehome(r->parts.halo, r->u, i, s->home[i]);
		ob_regions_take(r->parts.regions, i, s->home[i]);
	}
	memcpy(data->pair, s->pair, s->pairs * sizeof *data->pair);
	data->count->pairs = s->pairs;
	ob_pairs_link(r->u);
}

// Lists the pairs that link bodies of two ranks.
static uint32_t list_links_across(const rank *r, bool late, ob_rank_link *link)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < r->s->pairs; i++) {
		const ob_pair_key *k = &ob_universe_step_data(r->u)->pair[i];
		if ((late ? k->late : k->expected) && ob_pair_is_across(r->u, k))
			link[n++] = (ob_rank_link){ k->a, k->b };
	}
	return n;
}

static void share(rank *r, bool late)
{
	ob_rank_link link[MOST_PAIRS];
	bool islands;
	const uint32_t n = list_links_across(r, late, link);
	r->met = n;
	r->wrong += !ob_rank_islands_share(r->islands, r->u, &r->p, link, n, &islands) || !islands;
	ob_islands_list_members(r->u);
	ob_islands_deal(r->u, r->parts.regions);
	ob_islands_list_dealt_pairs(r->u, r->parts.halo);
}

static void build(rank *r)
{
	ob_rank_link link[MOST_PAIRS];
	ob_islands_begin(r->u);
	const uint32_t n = list_links_across(r, false, link);
	for (uint32_t i = 0; i < n; i++) {
		for (int side = 0; side < 2; side++)
			if (ob_home_rank(r->u, side ? link[i].b : link[i].a) == r->p.rank)
				ob_involve_due(r->u, side ? link[i].b : link[i].a);
	}
	for (uint32_t i = 0; i < ob_islands_link_tasks(r->u); i++)
		ob_islands_link(r->u, i);
	share(r, false);
}

// Each rank in turn publishes its results.
static void tell(rank *r)
{
	const ob_step_data *data = ob_universe_step_data(r->u);
	story *s = r->s;
	for (uint32_t turn = 0; turn < RANKS; turn++) {
		little_meet(&r->wire);
		if (turn != r->p.rank)
			continue;
		s->islands += data->count->islands;
		s->met += r->met;
		s->load[turn] = 0;
		for (uint32_t i = 0; i < data->count->unsolved; i++) {
			const ob_island *is = &data->island[i];
			s->load[turn] += is->work;
			s->largest = is->work > s->largest ? is->work : s->largest;
			for (uint32_t k = 0; k < is->members; k++) {
				const uint32_t id = data->member[is->first_member + k];
				r->wrong += s->solver[id] != NONE || data->effort[id] != s->effort[id] ||
					    !ob_worker_is_here(r->u, ob_home_of(r->u, id));
				s->solver[id] = turn;
				s->leader[id] = data->member[is->first_member];
				s->moved += s->home[id] / EACH != turn;
			}
			for (uint32_t k = 0; k < is->pairs; k++)
				s->listed[data->island_pair[is->first_pair + k]]++;
		}
		for (uint32_t id = 0; id < BODIES; id++)
			s->homes[turn][id] = ob_home_rank(r->u, id);
	}
	little_meet(&r->wire);
}

static void check(const story *s)
{
	for (uint32_t id = 0; id < BODIES; id++) {
		CHECK((s->solver[id] == NONE) == (s->lead[id] == NONE));
		CHECK(s->solver[id] == NONE || s->leader[id] == s->lead[id]);
		CHECK(s->solver[id] == NONE || s->solver[id] == s->solver[s->lead[id]]);
		CHECK(s->solver[id] == NONE || s->homes[0][id] == s->solver[id]);
		for (uint32_t r = 1; r < RANKS; r++)
			CHECK(s->homes[r][id] == s->homes[0][id]);
	}
	for (uint32_t i = 0; i < s->pairs; i++) {
		const ob_pair_key *k = &s->pair[i];
		const bool inside = s->lead[k->a] != NONE && s->lead[k->a] == s->lead[k->b];
		CHECK(s->listed[i] <= 1 && (!s->listed[i] || inside) && (s->listed[i] || !inside || !k->active));
	}
}

static void clear(story *s)
{
	memset(s->solver, 0xff, sizeof s->solver);
	memset(s->listed, 0, sizeof s->listed);
	s->islands = s->met = s->moved = 0;
	s->largest = 0;
}

// Checks the step: no rank exceeds its share by more than a tenth and one island; a moved body is at its new rank,
// unless several of its island were moved.
static void check_step(story *s)
{
	enum { LITTLE = 16 * 48 }; // not worth sharing
	uint64_t total = 0;
	check(s);
	for (uint32_t r = 0; r < RANKS; r++)
		total += s->load[r];
	for (uint32_t r = 0; r < RANKS && !s->met && !s->pinned; r++)
		CHECK(s->load[r] <= total / RANKS + total / (10 * RANKS) + 2 + s->largest ||
		      s->load[r] <= LITTLE + s->largest);
	for (uint32_t id = 0; id < BODIES; id++) {
		uint32_t pins = 0;
		for (uint32_t k = 0; k < BODIES; k++)
			pins += s->pin[k] && s->lead[k] == s->lead[id];
		if (s->pin[id] && s->lead[id] != NONE && pins == 1)
			CHECK(s->solver[id] == (s->pin[id] - 1) / EACH);
	}
}

// Brings some pairs outside of islands into late contact.
static void touch_late(story *s)
{
	for (uint32_t i = 0; i < s->pairs; i++) {
		ob_pair_key *k = &s->pair[i];
		const bool apart = s->lead[k->a] != s->lead[k->b] || s->lead[k->a] == NONE;
		k->late = apart && (!s->asleep[k->a] || !s->asleep[k->b]) && uniform(&s->seed) < .1;
		k->late |= i == 0;
	}
}

static void merge(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	data->count->checks = 0;
	for (uint32_t i = 0; i < r->s->pairs; i++) {
		data->pair[i].late = r->s->pair[i].late;
		data->pair[i].in_island = 0;
		if (r->s->pair[i].late)
			data->check[data->count->checks++] = i;
	}
	ob_islands_merge(r->u);
	share(r, true);
}

static void *live(void *arg)
{
	rank *r = arg;
	story *s = r->s;
	for (int seed = 0; seed < SEEDS; seed++) {
		if (r->p.rank == 0) {
			begin_story(s);
			flood(s);
			clear(s);
		}
		little_meet(&r->wire);
		write_world(r);
		build(r);
		tell(r);
		if (r->p.rank == 0) {
			check_step(s);
			s->all_met += s->met, s->all_moved += s->moved;
			for (uint32_t id = 0; id < BODIES; id++)
				s->home[id] = s->homes[0][id] * EACH;
			touch_late(s);
			flood_late(s);
			clear(s);
		}
		little_meet(&r->wire);
		merge(r);
		tell(r);
		if (r->p.rank == 0)
			check(s);
		little_meet(&r->wire);
	}
	return NULL;
}

static void open_rank(rank *r, story *s, const little_scene *scene, uint32_t number)
{
	*r = (rank){ .s = s, .u = little_populate(scene, RANKS * EACH) };
	r->u->rank = number;
	r->u->ranks = RANKS;
	r->parts = (ob_rank_parts){ ob_halo_create(r->u), ob_holdings_create(r->u), ob_regions_create(r->u) };
	r->islands = ob_rank_islands_create(r->u, &r->parts);
	r->wire = (little_wire){ .x = &s->x, .rank = number };
	r->p = little_peers(&r->wire);
	ob_requery_reset(r->u);
	CHECK(r->islands && r->parts.halo && r->parts.holdings && r->parts.regions);
}

static void close_rank(rank *r)
{
	CHECK(r->wrong == 0);
	ob_rank_islands_destroy(r->islands);
	ob_halo_destroy(r->parts.halo);
	ob_holdings_destroy(r->parts.holdings);
	ob_regions_destroy(r->parts.regions);
	free(r->wire.heard);
	ob_universe_destroy(r->u, true);
}

int main(void)
{
	static story s;
	rank r[RANKS];
	pthread_t thread[RANKS];
	little_scene *scene = little_scene_new();
	for (int i = 0; i < BODIES; i++)
		ob_world_sphere(&scene->world, 1, .1, ob_v3(i, 0, 0));
	little_exchange_open(&s.x);
	s.seed = 1;
	for (uint32_t i = 0; i < RANKS; i++)
		open_rank(&r[i], &s, scene, i);
	for (uint32_t i = 0; i < RANKS; i++)
		CHECK(pthread_create(&thread[i], NULL, live, &r[i]) == 0);
	for (uint32_t i = 0; i < RANKS; i++)
		pthread_join(thread[i], NULL);
	for (uint32_t i = 0; i < RANKS; i++)
		close_rank(&r[i]);
	CHECK(s.all_met > SEEDS && s.all_moved > SEEDS); // else nothing has been tested
	little_exchange_close(&s.x);
	free(scene);
	return check_end();
}
