// Three ranks with only the motions that they need: bodies move, collide, separate, and change their rank, solved or
// not, at random. Each rank always has its own bodies' and their neighbours' motions, to the last bit, and after a
// gathering all. Damage to them is detected.
#include "check.h"

#include "cluster/halo.h"
#include "cluster/little_ranks.h"
#include "motion/random.h"
#include "step/little_universe.h"
#include "step/pairs.h"
#include "table/home.h"
#include "table/layout.h"

enum { RANKS = LITTLE_RANKS, BODIES = 40, STEPS = 60, MOST_PAIRS = 60, SEEDS = 20 };

// Events, the same for all ranks, and the expected state.
typedef struct story {
	little_exchange x;
	ob_motion now[BODIES], next[BODIES];
	bool told[BODIES][RANKS], restored[BODIES], solved[BODIES];
	uint32_t home[BODIES];
	uint32_t pairs, fresh; // the last of them are fresh
	ob_pair_key pair[MOST_PAIRS];
	bool all, again, gathers;
	uint64_t seed;
} story;

typedef struct rank {
	story *s;
	uint32_t number, wrong, lacked;
	ob_universe *u;
	ob_halo *h;
	little_wire wire;
	ob_peers p;
	ob_mail mail[RANKS];
} rank;

static uint32_t any(uint64_t *seed, uint32_t of)
{
	const uint32_t i = (uint32_t)(of * uniform(seed));
	return i < of ? i : of - 1;
}

// Draws the bodies to solve, their solvers and new states, and the pairs after that. A fifth of the bodies is fast:
// none of their pairs lasts.
static void tell_on(story *s)
{
	uint64_t *seed = &s->seed;
	s->all = uniform(seed) < .2;
	s->again = uniform(seed) < .3;
	s->gathers = uniform(seed) < .2;
	for (uint32_t id = 0; id < BODIES; id++) {
		s->solved[id] = uniform(seed) < .5;
		if (uniform(seed) < (s->solved[id] ? .1 : .03))
			s->home[id] = any(seed, RANKS);
		s->next[id] = s->now[id];
		s->next[id].p.x = within(seed, -1, 1);
	}
	for (uint32_t i = 0; i < s->pairs; i++)
		if (s->pair[i].a % 5 == 0 || uniform(seed) < .1)
			s->pair[i--] = s->pair[--s->pairs];
	for (s->fresh = 0; s->fresh < 5 && s->pairs < MOST_PAIRS; s->fresh++, s->pairs++) {
		const uint32_t a = any(seed, BODIES - 1), b = a + 1 + any(seed, BODIES - 1 - a);
		s->pair[s->pairs] = (ob_pair_key){ .a = a, .b = b, .record = OB_NO_RECORD };
	}
}

static void link_pairs(const rank *r, uint32_t pairs)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	memcpy(data->pair, r->s->pair, pairs * sizeof *data->pair);
	data->count->pairs = pairs;
	ob_pairs_link(r->u);
}

static bool take(void *halo, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from)
{
	return ob_halo_take(halo, u, parcel, head);
}

// All ranks know the bodies' homes; the previous owner sends a body to the new one.
static void move(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	const story *s = r->s;
	uint32_t left = 0, leaving[BODIES];
	for (uint32_t id = 0; id < BODIES; id++) {
		const uint32_t before = ob_home_of(r->u, id);
		data->result_island[id] = s->solved[id] && s->home[id] == r->number ? 0 : UINT32_MAX;
		if (before == s->home[id])
			continue;
		ob_halo_rehome(r->h, r->u, id, s->home[id]);
		if (before == r->number)
			leaving[left++] = id;
	}
	for (uint32_t to = 0; to < RANKS; to++)
		ob_peers_begin(&r->mail[to]);
	for (uint32_t i = 0; i < left; i++)
		ob_halo_give(r->h, r->u, leaving[i], &r->mail[s->home[leaving[i]]]);
	r->wrong += !ob_parcels_exchange(&r->p, r->u, OB_PEERS_MOVE, r->mail, true, take, r->h);
}

static bool is_true(const rank *r, uint32_t id)
{
	return memcmp(ob_newest_motion(r->u, id), &r->s->now[id], sizeof(ob_motion)) == 0;
}

// The view of the rank that lists its pairs (step/island_builder.c).
static void note_border(rank *r, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(r->u);
	ob_pair_place at;
	bool is_at = false;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at))
		is_at |= ob_halo_is_elsewhere(r->h, at.side ? data->pair[at.pair].a : data->pair[at.pair].b);
	ob_halo_note_border(r->h, id, is_at);
}

// The owner computes the next motion from the last one; receivers need the last one, too, unless it is restored.
static void solve(rank *r)
{
	story *s = r->s;
	uint64_t digest;
	for (uint32_t id = 0; id < BODIES; id++)
		if (s->solved[id] && s->home[id] == r->number) {
			note_border(r, id);
			s->restored[id] = ob_halo_address(r->h, r->u, id, s->all, s->told[id]);
		}
	if (!s->all)
		ob_halo_part(r->h);
	little_meet(&r->wire);
	for (uint32_t id = 0; id < BODIES; id++) {
		if (!s->solved[id])
			continue;
		const bool told = s->told[id][r->number];
		const bool knows = told && (!s->restored[id] || s->home[id] == r->number);
		r->wrong += knows && (!is_true(r, id) || !ob_halo_digest(r->h, r->u, id, &digest));
		r->lacked += !told;
		if (!told)
			continue;
		ob_universe_step_data(r->u)->schedule[id].since = (uint32_t)ob_step_count(r->u) + 1;
		ob_stage_motion(r->u, id, &s->next[id]);
		ob_halo_note(r->h, id, &s->next[id]);
	}
}

static void meet(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	link_pairs(r, r->s->pairs);
	for (uint32_t i = 0; i < r->s->fresh; i++)
		data->check[i] = r->s->pairs - r->s->fresh + i;
	data->count->checks = r->s->fresh;
	r->wrong += !ob_halo_meet(r->h, r->u, &r->p);
}

static void publish(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	uint32_t id;
	for (id = 0; id < BODIES; id++)
		if (data->result_island[id] != UINT32_MAX) {
			data->result_island[id] = UINT32_MAX;
			ob_commit_motion(r->u, id);
			ob_halo_note_published(r->h, r->u, id);
		}
	while (ob_halo_take_received(r->h, &id)) {
		r->wrong += r->s->home[id] == r->number || !r->s->solved[id];
		ob_commit_motion(r->u, id);
		ob_halo_note_published(r->h, r->u, id);
	}
	for (id = 0; id < BODIES; id++)
		data->schedule[id].since = 0;
}

static void check(rank *r, bool everything)
{
	const story *s = r->s;
	bool needed[BODIES] = { false };
	for (uint32_t id = 0; id < BODIES; id++)
		needed[id] = everything || s->home[id] == r->number;
	for (uint32_t i = 0; i < s->pairs; i++) {
		needed[s->pair[i].a] |= s->home[s->pair[i].b] == r->number;
		needed[s->pair[i].b] |= s->home[s->pair[i].a] == r->number;
	}
	for (uint32_t id = 0; id < BODIES; id++)
		r->wrong += needed[id] && !is_true(r, id);
}

static void *live(void *arg)
{
	rank *r = arg;
	story *s = r->s;
	ob_halo_settle(r->h, r->u);
	for (int step = 0; step < STEPS; step++) {
		if (r->number == 0)
			tell_on(s);
		little_meet(&r->wire);
		move(r);
		solve(r);
		meet(r);
		little_meet(&r->wire);
		if (s->again) // like islands that late contacts merge
			solve(r);
		publish(r);
		little_meet(&r->wire);
		if (r->number == 0)
			for (uint32_t id = 0; id < BODIES; id++)
				s->now[id] = s->solved[id] ? s->next[id] : s->now[id];
		little_meet(&r->wire);
		if (s->gathers)
			r->wrong += !ob_halo_gather(r->h, r->u, &r->p) || ob_halo_is_partial(r->h);
		check(r, s->gathers);
		little_meet(&r->wire);
	}
	return NULL;
}

static void check_story(const little_scene *scene, uint64_t seed, uint32_t *lacked)
{
	static story s;
	rank r[RANKS];
	pthread_t thread[RANKS];
	memset(&s, 0, sizeof s);
	s.seed = seed;
	little_exchange_open(&s.x);
	for (uint32_t i = 0; i < RANKS; i++) {
		r[i] = (rank){ .s = &s, .number = i, .u = little_populate(scene, RANKS) };
		r[i].u->rank = i;
		r[i].u->ranks = RANKS;
		r[i].h = ob_halo_create(r[i].u);
		r[i].wire = (little_wire){ .x = &s.x, .rank = i };
		r[i].p = little_peers(&r[i].wire);
		link_pairs(&r[i], 0);
		memset(ob_universe_step_data(r[i].u)->result_island, 0xff, BODIES * sizeof(uint32_t));
	}
	for (uint32_t id = 0; id < BODIES; id++) {
		s.now[id] = *ob_newest_motion(r[0].u, id);
		s.home[id] = ob_home_of(r[0].u, id);
	}
	for (uint32_t i = 0; i < RANKS; i++)
		CHECK(pthread_create(&thread[i], NULL, live, &r[i]) == 0);
	for (uint32_t i = 0; i < RANKS; i++) {
		pthread_join(thread[i], NULL);
		CHECK(r[i].wrong == 0);
		*lacked += r[i].lacked;
		for (uint32_t to = 0; to < RANKS; to++)
			ob_mail_finish(&r[i].mail[to]);
		free(r[i].wire.heard);
		ob_halo_destroy(r[i].h);
		ob_universe_destroy(r[i].u, true);
	}
	little_exchange_close(&s.x);
}

static void check_damage(const little_scene *scene)
{
	ob_universe *u = little_populate(scene, RANKS);
	u->ranks = RANKS;
	ob_halo *h = ob_halo_create(u);
	ob_motion m = *ob_newest_motion(u, 0);
	uint64_t before, after;
	ob_halo_settle(h, u);
	CHECK(ob_halo_digest(h, u, 0, &before)); // the host's publications have no digest
	ob_stage_motion(u, 0, &m);
	ob_halo_note(h, 0, &m);
	ob_commit_motion(u, 0);
	ob_halo_note_published(h, u, 0);
	CHECK(ob_halo_digest(h, u, 0, &after) && after == before);
	((unsigned char *)ob_newest_motion(u, 0))[sizeof m / 2] ^= 1;
	CHECK(!ob_halo_digest(h, u, 0, &after) && after != before);
	ob_publish_motion(u, 0, &m);
	CHECK(!ob_halo_digest(h, u, 0, &after) && after == before); // it differs from the published one
	ob_halo_settle(h, u); // the host's applies
	CHECK(ob_halo_digest(h, u, 0, &after) && after == before);
	ob_halo_destroy(h);
	ob_universe_destroy(u, true);
}

int main(void)
{
	little_scene *scene = little_scene_new();
	uint32_t lacked = 0;
	for (int i = 0; i < BODIES; i++)
		ob_world_sphere(&scene->world, 1, .1, ob_v3(i, 0, 0));
	for (uint64_t seed = 1; seed <= SEEDS; seed++)
		check_story(scene, seed, &lacked);
	CHECK(lacked > SEEDS * STEPS); // else all ranks would have had all motions
	check_damage(scene);
	free(scene);
	return check_end();
}
