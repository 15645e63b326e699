// Three ranks that know no more motions than they need: bodies move, meet and part, and go from rank to rank, solved or
// not, at random. Each rank always has its own and their neighbours', to the last bit, and after a gathering
// everybody's; what it has not it does not take for known. And damage to what it has is found.
#include "check.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "motion/random.h"
#include "sim/halo.h"
#include "sim/little_universe.h"
#include "sim/pairs.h"
#include "table/home.h"
#include "table/layout.h"

enum { RANKS = 3, BODIES = 40, STEPS = 60, MOST_PAIRS = 60, SEEDS = 20 };

// What is said, by rank: to each.
typedef struct exchange {
	pthread_barrier_t together;
	const void *said[RANKS][RANKS];
	size_t bytes[RANKS][RANKS];
} exchange;

// What happens, the same for all ranks, and what is true.
typedef struct story {
	exchange x;
	ob_motion now[BODIES], next[BODIES];
	bool told[BODIES][RANKS], restored[BODIES], solved[BODIES];
	uint32_t home[BODIES];
	uint32_t pairs, fresh; // of them the last
	ob_pair_key pair[MOST_PAIRS];
	bool all, again, gathers;
	uint64_t seed;
} story;

typedef struct rank {
	story *s;
	uint32_t number, wrong, lacked;
	ob_universe *u;
	ob_halo *h;
	ob_peers p;
	ob_mail mail[RANKS];
	char *heard;
	size_t at[RANKS + 1];
} rank;

static const char *hear(rank *r)
{
	exchange *x = &r->s->x;
	pthread_barrier_wait(&x->together);
	for (uint32_t from = 0; from < RANKS; from++)
		r->at[from + 1] = r->at[from] + x->bytes[from][r->number];
	free(r->heard);
	r->heard = malloc(r->at[RANKS]);
	for (uint32_t from = 0; r->heard && from < RANKS; from++)
		memcpy(r->heard + r->at[from], x->said[from][r->number], x->bytes[from][r->number]);
	pthread_barrier_wait(&x->together);
	return r->heard;
}

static const char *deal(void *wire, const void *const *mine, const size_t *bytes, const size_t **at)
{
	rank *r = wire;
	memcpy(r->s->x.said[r->number], mine, sizeof r->s->x.said[0]);
	memcpy(r->s->x.bytes[r->number], bytes, sizeof r->s->x.bytes[0]);
	*at = r->at;
	return hear(r);
}

static const char *gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	const void *const same[RANKS] = { mine, mine, mine };
	return deal(wire, same, (size_t[RANKS]){ n, n, n }, at);
}

static uint32_t any(uint64_t *seed, uint32_t of)
{
	const uint32_t i = (uint32_t)(of * uniform(seed));
	return i < of ? i : of - 1;
}

// Who is solved, by whom, and to what; which pairs there are then. A fifth of the bodies is fast: of their pairs none
// lasts.
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

static void move(rank *r)
{
	ob_step_data *data = ob_universe_step_data(r->u);
	const story *s = r->s;
	const size_t *at;
	const char *parcel;
	uint32_t n = 0, left = 0, leaving[BODIES];
	bool moved = false, sound = true;
	ob_parcel head;
	for (uint32_t id = 0; id < BODIES; id++) {
		data->result_island[id] = s->solved[id] ? n : UINT32_MAX;
		if (!s->solved[id] && ob_home_of(r->u, id) != s->home[id])
			leaving[left++] = id, ob_home_set(r->u, id, s->home[id]);
		if (!s->solved[id])
			continue;
		data->island[n] = (ob_island){ .first_member = n, .members = 1 };
		data->member[n++] = id;
		ob_home_set(r->u, id, s->home[id]);
	}
	data->count->islands = data->count->unsolved = n;
	for (uint32_t to = 0; to < RANKS; to++)
		r->wrong += !ob_peers_begin(&r->mail[to]);
	r->wrong += !ob_halo_move(r->h, r->u, leaving, left, r->mail, &moved);
	const char *all =
		moved ? ob_peers_deal(&r->p, r->u, (ob_peers_head){ .phase = OB_PEERS_MOVE }, r->mail, &at) : NULL;
	for (uint32_t from = 0; all && from < RANKS; from++) {
		const char *rest = all + at[from] + sizeof(ob_peers_head);
		size_t bytes = at[from + 1] - at[from] - sizeof(ob_peers_head);
		while (sound && from != r->number && (parcel = ob_parcel_next(&rest, &bytes, &head, &sound)))
			sound = ob_halo_take(r->h, r->u, parcel, &head);
	}
	r->wrong += !sound;
}

static bool is_true(const rank *r, uint32_t id)
{
	return ob_halo_has(r->h, id) && memcmp(ob_newest_motion(r->u, id), &r->s->now[id], sizeof(ob_motion)) == 0;
}

// As who lists its pairs sees it (sim/island_builder.c).
static void note_border(rank *r, uint32_t id)
{
	const ob_step_data *data = ob_universe_step_data(r->u);
	ob_pair_place at;
	bool is_at = false;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at))
		is_at |= ob_halo_is_elsewhere(r->h, at.side ? data->pair[at.pair].a : data->pair[at.pair].b);
	ob_halo_note_border(r->h, id, is_at);
}

// The owner finds the next motion, for which it needs the last; who is told needs that, too, unless it is restored.
static void solve(rank *r)
{
	story *s = r->s;
	uint64_t digest;
	for (uint32_t id = 0; id < BODIES; id++)
		if (s->solved[id] && s->home[id] == r->number) {
			note_border(r, id);
			s->restored[id] = ob_halo_tell(r->h, r->u, id, s->all, s->told[id]);
		}
	if (!s->all)
		ob_halo_part(r->h);
	pthread_barrier_wait(&s->x.together);
	for (uint32_t id = 0; id < BODIES; id++) {
		if (!s->solved[id])
			continue;
		const bool told = s->told[id][r->number];
		r->wrong += told && (!s->restored[id] || s->home[id] == r->number) && !is_true(r, id);
		r->wrong += ob_halo_has(r->h, id) && (!is_true(r, id) || !ob_halo_digest(r->h, r->u, id, &digest));
		r->lacked += !told;
		if (told)
			ob_stage_motion(r->u, id, &s->next[id]);
		ob_halo_note(r->h, id, told ? &s->next[id] : NULL);
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
	for (uint32_t id = 0; id < BODIES; id++) {
		ob_universe_step_data(r->u)->result_island[id] = UINT32_MAX;
		if (!r->s->solved[id] || !ob_halo_has_found(r->h, id))
			continue;
		ob_commit_motion(r->u, id);
		ob_halo_note_published(r->h, r->u, id);
	}
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
		r->wrong += (needed[id] || ob_halo_has(r->h, id)) && !is_true(r, id);
}

static void *live(void *arg)
{
	rank *r = arg;
	story *s = r->s;
	ob_halo_settle(r->h, r->u);
	for (int step = 0; step < STEPS; step++) {
		if (r->number == 0)
			tell_on(s);
		pthread_barrier_wait(&s->x.together);
		move(r);
		solve(r);
		meet(r);
		pthread_barrier_wait(&s->x.together);
		if (s->again) // as islands that late contacts merge
			solve(r);
		publish(r);
		pthread_barrier_wait(&s->x.together);
		if (r->number == 0)
			for (uint32_t id = 0; id < BODIES; id++)
				s->now[id] = s->solved[id] ? s->next[id] : s->now[id];
		pthread_barrier_wait(&s->x.together);
		if (s->gathers)
			r->wrong += !ob_halo_gather(r->h, r->u, &r->p) || ob_halo_is_partial(r->h);
		check(r, s->gathers);
		pthread_barrier_wait(&s->x.together);
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
	pthread_barrier_init(&s.x.together, NULL, RANKS);
	for (uint32_t i = 0; i < RANKS; i++) {
		r[i] = (rank){ .s = &s, .number = i, .u = little_populate(scene, RANKS) };
		r[i].u->rank = i;
		r[i].u->ranks = RANKS;
		r[i].h = ob_halo_create(r[i].u);
		r[i].p = (ob_peers){ .rank = i, .ranks = RANKS, .gather = gather, .deal = deal, .wire = &r[i] };
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
		free(r[i].heard);
		ob_halo_destroy(r[i].h);
		ob_universe_destroy(r[i].u, true);
	}
	pthread_barrier_destroy(&s.x.together);
}

static void check_damage(const little_scene *scene)
{
	ob_universe *u = little_populate(scene, RANKS);
	u->ranks = RANKS;
	ob_halo *h = ob_halo_create(u);
	ob_motion m = *ob_newest_motion(u, 0);
	uint64_t before, after;
	ob_halo_settle(h, u);
	CHECK(ob_halo_digest(h, u, 0, &before)); // nothing is known of what the host has published
	ob_stage_motion(u, 0, &m);
	ob_halo_note(h, 0, &m);
	ob_commit_motion(u, 0);
	ob_halo_note_published(h, u, 0);
	CHECK(ob_halo_digest(h, u, 0, &after) && after == before);
	((unsigned char *)ob_newest_motion(u, 0))[sizeof m / 2] ^= 1;
	CHECK(!ob_halo_digest(h, u, 0, &after) && after != before);
	ob_publish_motion(u, 0, &m);
	CHECK(!ob_halo_digest(h, u, 0, &after) && after == before); // it is not that which was found
	ob_halo_settle(h, u); // but the host's
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
	CHECK(lacked > SEEDS * STEPS); // else all would have known all
	check_damage(scene);
	free(scene);
	return check_end();
}
