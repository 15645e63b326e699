// Regions of random worlds: every rank finds the same; touching bodies share one; each simulator has its share of the
// work, as far as islands allow; and few bodies have neighbours of another rank's, compared with the best of simple
// cuts. As bodies mix, and work gathers in a corner, so it stays.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cluster/regions.h"
#include "motion/random.h"
#include "step/little_universe.h"
#include "step/pairs.h"
#include "table/home.h"
#include "table/layout.h"

enum { BODIES = 600, RANKS = 4, EACH = 2, SIMULATORS = RANKS * EACH, SEEDS = 12 };

typedef struct place {
	double at[3], half; // m
} place;

typedef struct world {
	double side[3]; // m
	place body[BODIES];
	bool touches; // some of the overlapping pairs are in contact
} world;

static void fill(world *w, uint64_t *seed)
{
	for (int c = 0; c < 3; c++)
		w->side[c] = within(seed, 5, 40);
	const double spacing = cbrt(w->side[0] * w->side[1] * w->side[2] / BODIES);
	for (uint32_t i = 0; i < BODIES; i++) {
		for (int c = 0; c < 3; c++)
			w->body[i].at[c] = within(seed, 0, w->side[c]);
		w->body[i].half = within(seed, .2, .6) * spacing;
	}
}

static bool overlap(const place *a, const place *b)
{
	bool near = true;
	for (int c = 0; c < 3; c++)
		near &= fabs(a->at[c] - b->at[c]) < a->half + b->half;
	return near;
}

// The ids of overlapping bodies decide if they touch.
static void write_world(ob_universe *u, const world *w)
{
	ob_step_data *data = ob_universe_step_data(u);
	uint32_t n = 0;
	for (uint32_t i = 0; i < BODIES; i++) {
		for (int c = 0; c < 3; c++) {
			data->bounds[i][c] = (float)(w->body[i].at[c] - w->body[i].half);
			data->bounds[i][3 + c] = (float)(w->body[i].at[c] + w->body[i].half);
		}
		data->result_island[i] = UINT32_MAX;
	}
	for (uint32_t a = 0; a < BODIES; a++)
		for (uint32_t b = a + 1; b < BODIES && n < data->pairs_max; b++)
			if (overlap(&w->body[a], &w->body[b]))
				data->pair[n++] = (ob_pair_key){ .a = a,
								 .b = b,
								 .record = OB_NO_RECORD,
								 .active = w->touches && (a * 31 + b) % 9 == 0 };
	CHECK(n < data->pairs_max);
	data->count->pairs = n;
	ob_pairs_link(u);
}

// Number of copies: bodies with neighbours on other ranks, counted once for each of those ranks.
static uint32_t copies(const ob_universe *u, const uint32_t *rank)
{
	static bool has[BODIES][RANKS];
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t n = 0;
	memset(has, 0, sizeof has);
	for (uint32_t i = 0; i < data->count->pairs; i++)
		has[data->pair[i].a][rank[data->pair[i].b]] = has[data->pair[i].b][rank[data->pair[i].a]] = true;
	for (uint32_t i = 0; i < BODIES; i++)
		for (uint32_t r = 0; r < RANKS; r++)
			n += has[i][r] && r != rank[i];
	return n;
}

static const world *sorted_world;
static int sorted_axis;

static int along(const void *a, const void *b)
{
	const uint32_t *i = a, *k = b;
	const double x = sorted_world->body[*i].at[sorted_axis], y = sorted_world->body[*k].at[sorted_axis];
	return (x > y) - (x < y);
}

static void sort(const world *w, uint32_t *id, uint32_t n, int axis)
{
	sorted_world = w;
	sorted_axis = axis;
	qsort(id, n, sizeof *id, along);
}

// The smallest number of copies for slices along an axis, and for halves of halves along two.
static uint32_t simple_copies(const ob_universe *u, const world *w)
{
	static uint32_t id[BODIES], rank[BODIES];
	uint32_t best = UINT32_MAX;
	for (int cut = 0; cut < 9; cut++) {
		for (uint32_t i = 0; i < BODIES; i++)
			id[i] = i;
		sort(w, id, BODIES, cut / 3);
		for (uint32_t half = 0; half < 2; half++)
			sort(w, id + half * (BODIES / 2), BODIES / 2, cut % 3);
		for (uint32_t i = 0; i < BODIES; i++)
			rank[id[i]] = i * RANKS / BODIES;
		const uint32_t found = copies(u, rank);
		best = found < best ? found : best;
	}
	return best;
}

static void ranks_of(const ob_universe *u, const ob_regions *r, uint32_t *rank)
{
	for (uint32_t i = 0; i < BODIES; i++)
		rank[i] = ob_universe_rank_of(u, ob_regions_at(r, i));
}

static uint32_t largest_group(const ob_universe *u)
{
	static uint32_t group[BODIES], size[BODIES];
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t largest = 0;
	memset(size, 0, sizeof size);
	for (uint32_t i = 0; i < BODIES; i++)
		group[i] = i;
	for (uint32_t i = 0; i < data->count->pairs; i++) {
		const uint32_t a = group[data->pair[i].a], b = group[data->pair[i].b];
		for (uint32_t k = 0; data->pair[i].active && k < BODIES; k++)
			group[k] = group[k] == b ? a : group[k];
	}
	for (uint32_t i = 0; i < BODIES; i++)
		largest = ++size[group[i]] > largest ? size[group[i]] : largest;
	return largest;
}

static void check_whole(const ob_universe *u, const ob_regions *r)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t cut = 0;
	for (uint32_t i = 0; i < data->count->pairs; i++)
		cut += data->pair[i].active && ob_regions_at(r, data->pair[i].a) != ob_regions_at(r, data->pair[i].b);
	CHECK(cut == 0);
}

// Each simulator has its share of "weight", except for some groups: each of the cuts above may err by one.
static void check_shares(const ob_regions *r, const uint32_t *weight, uint32_t most)
{
	double sum = 0, load[SIMULATORS] = { 0 };
	for (uint32_t i = 0; i < BODIES; i++)
		sum += weight[i], load[ob_regions_at(r, i)] += weight[i];
	for (uint32_t s = 0; s < SIMULATORS; s++)
		CHECK(fabs(load[s] - sum / SIMULATORS) <= 1.01 * most + 2);
}

static void check_cut(ob_universe *u, const world *w)
{
	static uint32_t rank[BODIES], first[BODIES], one[BODIES];
	for (u->rank = 0; u->rank < RANKS; u->rank++) {
		memset(ob_universe_step_data(u)->home, 0, BODIES * sizeof(uint32_t));
		ob_regions *r = ob_regions_create(u);
		ob_regions_settle(r, u);
		ranks_of(u, r, rank);
		for (uint32_t i = 0; i < BODIES; i++) {
			first[i] = u->rank ? first[i] : ob_regions_at(r, i);
			CHECK(first[i] == ob_regions_at(r, i) && ob_home_of(u, i) == first[i]);
			one[i] = 1;
		}
		check_whole(u, r);
		check_shares(r, one, largest_group(u));
		CHECK(copies(u, rank) <= (w->touches ? 1.6 : 1.3) * simple_copies(u, w) + 10);
		ob_regions_destroy(r);
	}
	u->rank = 0;
}

// All bodies move elsewhere, some at a time.
static void check_mixing(ob_universe *u, world *w, uint64_t *seed)
{
	static uint32_t rank[BODIES];
	world next = *w;
	uint32_t left, fliers = 0;
	memset(ob_universe_step_data(u)->home, 0, BODIES * sizeof(uint32_t));
	ob_regions *r = ob_regions_create(u);
	ob_regions_settle(r, u);
	for (uint32_t i = 0; i < BODIES; i++) // another world of the same sides
		for (int c = 0; c < 3; c++)
			next.body[i].at[c] = within(seed, 0, w->side[c]);
	for (uint32_t i = 0; i < BODIES; i++) {
		w->body[i] = next.body[i];
		ob_requery_append(u, i);
		if (i % 50 != 49)
			continue;
		write_world(u, w);
		for (u->rank = 0; u->rank < RANKS; u->rank++) {
			ob_regions_follow(r, u);
			const uint32_t *flier = ob_regions_find_fliers(r, u, &left);
			fliers += left;
			for (uint32_t k = 0; k < left; k++) {
				CHECK(ob_home_rank(u, flier[k]) == u->rank && flier[k] <= i && flier[k] + 50 > i);
				CHECK(ob_universe_rank_of(u, ob_regions_at(r, flier[k])) != u->rank);
				ob_regions_take(r, flier[k], ob_regions_at(r, flier[k]));
				ob_home_set(u, flier[k], ob_regions_at(r, flier[k]));
			}
		}
		u->rank = 0;
		ob_requery_reset(u);
		for (uint32_t k = i + 1; k < BODIES; k++)
			CHECK(ob_universe_rank_of(u, ob_regions_at(r, k)) == ob_home_rank(u, k)); // no other rank
	}
	ranks_of(u, r, rank);
	CHECK(copies(u, rank) <= 1.5 * simple_copies(u, w) + 10);
	CHECK(fliers > BODIES / 4);
	ob_regions_destroy(r);
}

// The other ranks, which have noted the same costs of bodies.
typedef struct echo {
	char *bytes;
	size_t at[RANKS + 1];
} echo;

static const char *gather(void *wire, const void *mine, size_t n, const size_t **at)
{
	echo *w = wire;
	w->bytes = realloc(w->bytes, RANKS * n);
	for (size_t r = 0; r < RANKS && w->bytes; r++) {
		memcpy(w->bytes + r * n, mine, n);
		w->at[r + 1] = (r + 1) * n;
	}
	*at = w->at;
	return w->bytes;
}

// Bodies near a corner cost much more: regions are drawn again after a while of that, and no earlier.
static void check_work(ob_universe *u, const world *w)
{
	static uint32_t work[BODIES], before[BODIES];
	uint32_t changed = 0, rounds = 0;
	echo wire = { .bytes = NULL };
	ob_peers p = { .ranks = RANKS, .gather = gather, .wire = &wire };
	memset(ob_universe_step_data(u)->home, 0, BODIES * sizeof(uint32_t));
	ob_regions *r = ob_regions_create(u);
	ob_regions_settle(r, u);
	for (uint32_t i = 0; i < BODIES; i++) {
		work[i] = w->body[i].at[0] < w->side[0] / 3 ? 900 : 9;
		before[i] = ob_regions_at(r, i);
	}
	for (; !changed && rounds < 1000; rounds++) {
		for (uint32_t i = 0; i < BODIES; i++)
			ob_regions_note(r, i, ob_regions_at(r, i), work[i], rounds > 0);
		const ob_regions_work sum = ob_regions_work_of(r);
		CHECK(ob_regions_renew(r, u, &p, &sum));
		for (uint32_t i = 0; i < BODIES; i++)
			changed += before[i] != ob_regions_at(r, i);
	}
	CHECK(changed > 0 && rounds > 1 && rounds < 100);
	check_whole(u, r);
	check_shares(r, work, 900 * largest_group(u));
	ob_regions_destroy(r);
	free(wire.bytes);
}

// A moved body, and its contacts, are at its target, and count there.
static void check_pins(ob_universe *u)
{
	static uint32_t weight[BODIES];
	ob_step_data *data = ob_universe_step_data(u);
	memset(data->home, 0, BODIES * sizeof(uint32_t));
	for (uint32_t i = 0; i < BODIES; i++) {
		data->pin[i] = i % 40 ? 0 : 1 + 3;
		weight[i] = 1;
	}
	ob_regions *r = ob_regions_create(u);
	ob_regions_settle(r, u);
	for (uint32_t i = 0; i < BODIES; i++)
		CHECK(!data->pin[i] || ob_regions_at(r, i) == 3);
	check_whole(u, r);
	check_shares(r, weight, 2 * largest_group(u));
	memset(data->pin, 0, BODIES * sizeof *data->pin);
	ob_regions_destroy(r);
}

int main(void)
{
	little_scene *scene = little_scene_new();
	static world w;
	for (int i = 0; i < BODIES; i++)
		ob_world_sphere(&scene->world, 1, .1, ob_v3(i, 0, 0));
	ob_universe *u = little_populate(scene, SIMULATORS);
	u->ranks = RANKS;
	ob_requery_reset(u);
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		uint64_t chance = seed;
		w.touches = seed % 2;
		fill(&w, &chance);
		write_world(u, &w);
		check_cut(u, &w);
		check_work(u, &w);
		check_pins(u);
		check_mixing(u, &w, &chance);
	}
	ob_universe_destroy(u, true);
	free(scene);
	return check_end();
}
