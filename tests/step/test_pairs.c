// Pairs are those whose boxes overlap, for any order of queries; each has a record of its own while it is in contact.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "step/broadphase.h"
#include "step/pairs.h"

#include "motion/random.h"

enum { BODIES = 200, STATICS = 20 };

static little_scene *scene(uint64_t *seed)
{
	little_scene *s = little_scene_new();
	for (int i = 0; i < BODIES; i++) {
		double r = within(seed, .1, .5);
		ob_world_sphere(&s->world, i < STATICS ? 0 : 1, r, random_vector(seed, 4));
	}
	ob_world_ground(&s->world).state->pose.p.z = -2;
	return s;
}

static void shuffle(uint64_t *seed, uint32_t *id, uint32_t n)
{
	for (uint32_t i = n; i > 1; i--) {
		uint32_t j = (uint32_t)(i * uniform(seed)), t = id[i - 1];
		id[i - 1] = id[j];
		id[j] = t;
	}
}

// Runs a BROADPHASE phase: objects to requery go into the index and are queried, then the pairs are merged.
static void look_around(ob_universe *u)
{
	uint32_t count;
	const uint32_t *list = ob_requery_list(u, &count);
	for (uint32_t i = 0; i < count; i++)
		ob_index_put(u, list[i]);
	for (uint32_t i = 0; i < count; i++)
		ob_pairs_query(u, list[i], &(uint64_t){ 0 });
	ob_pairs_merge(u, ob_step_count(u));
	ob_pairs_measure(u, ob_step_count(u));
	ob_requery_list(u, &count);
	CHECK(count == 0);
}

// Moves these objects, in this order, to places that the seed determines.
static void move(ob_universe *u, const uint32_t *id, uint32_t n, uint64_t seed)
{
	for (uint32_t i = 0; i < n; i++) {
		uint64_t own = seed * 1000 + id[i];
		ob_motion m = *ob_newest_motion(u, id[i]);
		m.p = random_vector(&own, 4);
		ob_publish_motion(u, id[i], &m);
		ob_fat_aabb_renew(u, id[i], &(ob_state){ .pose = { m.p, m.q } }, .01);
	}
}

static bool overlap(const ob_universe *u, uint32_t i, uint32_t j)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	const float *a = ex->bounds[i], *b = ex->bounds[j];
	if (ex->schedule[i].state < OB_SCHEDULE_AWAKE && ex->schedule[j].state < OB_SCHEDULE_AWAKE)
		return false;
	if (j == BODIES) // the ground
		return a[2] <= -2;
	for (int c = 0; c < 3; c++)
		if (a[c] > b[3 + c] || b[c] > a[3 + c])
			return false;
	return true;
}

static uint32_t pairs_in_use(const ob_step_data *ex)
{
	return ex->count->pairs - ex->count->pairs_idle;
}

// Number of times that the list of an object has this pair.
static int times_listed(const ob_step_data *ex, uint32_t id, uint32_t pair)
{
	int times = 0;
	ob_pair_place at;
	for (uint32_t link = ex->first_pair[id]; ob_pair_at(ex, link, &at); link = ob_pair_next(ex, at))
		times += at.pair == pair;
	return times;
}

// Number of pairs of two objects; each must be once in the list of each movable one.
static uint32_t pairs_of(const ob_step_data *ex, uint32_t a, uint32_t b)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		const ob_pair_key *k = &ex->pair[i];
		if (k->a != a || k->b != b)
			continue;
		n++;
		CHECK(times_listed(ex, a, i) == ob_has_pairs(ex, a) && times_listed(ex, b, i) == ob_has_pairs(ex, b));
	}
	return n;
}

// Exactly the overlapping ones, each once.
static void check_pairs(const ob_universe *u)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	uint32_t k = 0, n = pairs_in_use(ex);
	for (uint32_t i = 0; i <= BODIES; i++)
		for (uint32_t j = i + 1; j <= BODIES; j++)
			if (overlap(u, i, j)) {
				CHECK(pairs_of(ex, i, j) == 1);
				k++;
			}
	CHECK(k == n && n > BODIES / 2);
	CHECK(ob_step_failed(u, NULL) == OB_STEP_OK);
}

// Each record belongs to one pair or is free: none is lost, none is assigned twice.
static void check_records(const ob_universe *u)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	bool *used = calloc(ex->pairs_max, sizeof *used);
	int32_t taken = 0, free_ones = ex->count->records_free > 0 ? ex->count->records_free : 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		uint32_t record = ex->pair[i].record;
		if (record == OB_NO_RECORD)
			continue;
		taken++;
		CHECK(record < ex->count->records_used && !used[record]);
		used[record] = true;
		CHECK(!ex->record[record].stamp[0] && !ex->record[record].stamp[1]);
	}
	for (int32_t i = 0; i < free_ones; i++) {
		CHECK(!used[ex->record_free[i]]);
		used[ex->record_free[i]] = true;
	}
	CHECK((int32_t)ex->count->records_used == taken + free_ones);
	free(used);
}

// Between steps the records of pairs without contact are released; then a share of the pairs comes into contact.
static void touch(ob_universe *u, uint64_t *seed, double share)
{
	ob_step_data *ex = ob_universe_step_data(u);
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		ob_pair_key *k = &ex->pair[i];
		if (k->a == k->b)
			continue;
		k->active = uniform(seed) < share;
		if (!k->active)
			ob_pair_release_record(u, k);
	}
	for (uint32_t i = 0; i < ex->count->pairs; i++) {
		ob_pair_key *k = &ex->pair[i];
		if (k->active && k->record == OB_NO_RECORD)
			k->record = ob_record_take(u);
	}
	check_records(u);
}

// No limit may exceed the distance of the pair: it could be in contact before its members have moved that far.
static void check_limits(const ob_universe *u)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	for (uint32_t k = 0; k < ex->count->pairs; k++) {
		const ob_pair_key *p = &ex->pair[k];
		if (p->a == p->b)
			continue;
		const ob_motion *a = ob_newest_motion(u, p->a), *b = ob_newest_motion(u, p->b);
		double ra = ob_passport_of(u, p->a)->size.x, rb = ob_passport_of(u, p->b)->size.x;
		double apart = p->b == BODIES ? a->p.z + 2 - ra : ob_norm(ob_sub(a->p, b->p)) - ra - rb;
		CHECK(p->limit <= fmax(apart, 0) + 1e-12);
		CHECK(p->limit < 0 || p->limit >= apart - 1e-12); // spheres: the bound is the distance
	}
}

static void test_merge(void)
{
	uint64_t seed = 1;
	little_scene *s = scene(&seed);
	ob_universe *u = little_populate(s, 1);
	look_around(u);
	check_pairs(u);
	check_limits(u);
	for (uint64_t round = 1; round <= 30; round++) {
		uint32_t id[BODIES], n = 0;
		for (uint32_t i = STATICS; i < BODIES; i++)
			if (uniform(&seed) < .2)
				id[n++] = i;
		touch(u, &seed, .1 * (double)(round % 5));
		touch(u, &seed, 0);
		move(u, id, n, round);
		look_around(u);
		check_pairs(u);
	}
	ob_universe_destroy(u, true);
	free(s);
}

// Two universes, the same moves in another order: the same bytes.
static void test_order(void)
{
	uint64_t seed = 2, other = 3;
	little_scene *s = scene(&seed);
	ob_universe *u[2] = { little_populate(s, 1), little_populate(s, 1) };
	for (uint64_t round = 0; round <= 20; round++) {
		uint32_t id[BODIES], n = 0;
		for (uint32_t i = STATICS; i < BODIES && round; i++)
			if (uniform(&seed) < .3)
				id[n++] = i;
		for (int k = 0; k < 2; k++) {
			shuffle(&other, id, n);
			move(u[k], id, n, round);
			look_around(u[k]);
		}
		const ob_step_data *x = ob_universe_step_data(u[0]), *y = ob_universe_step_data(u[1]);
		CHECK(x->count->pairs == y->count->pairs);
		for (uint32_t i = 0; i < x->count->pairs; i++) {
			const ob_pair_key *p = &x->pair[i], *q = &y->pair[i];
			CHECK(p->a == q->a && p->b == q->b && p->record == q->record && p->limit == q->limit);
		}
	}
	ob_universe_destroy(u[0], true);
	ob_universe_destroy(u[1], true);
	free(s);
}

// A pair in contact is released when the contact ends, not when its members' boxes separate.
static void test_active_stays(void)
{
	uint64_t seed = 4;
	little_scene *s = scene(&seed);
	ob_universe *u = little_populate(s, 1);
	ob_step_data *ex = ob_universe_step_data(u);
	look_around(u);
	uint32_t k = 0;
	while (ex->pair[k].a < STATICS || ex->pair[k].b == BODIES || ex->pair[k].b < STATICS)
		k++;
	uint32_t a = ex->pair[k].a, b = ex->pair[k].b, record = ob_record_take(u), before = pairs_in_use(ex);
	ex->pair[k].active = 1;
	ex->pair[k].record = record;
	ob_motion m = *ob_newest_motion(u, a);
	m.p = ob_v3(100, 0, 100);
	ob_publish_motion(u, a, &m);
	ob_fat_aabb_renew(u, a, &(ob_state){ .pose = { m.p, m.q } }, 0);
	look_around(u);
	int of_a = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		if (ex->pair[i].a == a || ex->pair[i].b == a) {
			of_a++;
			CHECK(ex->pair[i].a == a && ex->pair[i].b == b && ex->pair[i].record == record);
		}
	CHECK(of_a == 1 && pairs_in_use(ex) < before);
	ob_pairs_drop(u, a);
	check_records(u);
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		CHECK(ex->pair[i].a == ex->pair[i].b || (ex->pair[i].a != a && ex->pair[i].b != a));
	ob_universe_destroy(u, true);
	free(s);
}

// The version before the step is read, the other written, however often the step is done.
static uint32_t pairs_with(const ob_step_data *ex, uint32_t id)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		n += ex->pair[i].a != ex->pair[i].b && (ex->pair[i].a == id || ex->pair[i].b == id);
	return n;
}

// One object comes near more others than a query usually finds, and leaves them all.
static void test_crowd(void)
{
	enum { CROWD = 400, ONE = 350 };
	uint64_t seed = 5;
	little_scene *s = little_scene_new();
	for (int i = 0; i < CROWD; i++)
		ob_world_sphere(&s->world, 1, .1, random_vector(&seed, 4));
	ob_universe *u = little_populate(s, 1);
	const ob_step_data *ex = ob_universe_step_data(u);
	ob_motion m = *ob_newest_motion(u, ONE);
	look_around(u);
	ob_fat_aabb_renew(u, ONE, &(ob_state){ .pose = { m.p, m.q } }, 20);
	look_around(u);
	CHECK(pairs_with(ex, ONE) == CROWD - 1);
	m.p = ob_v3(100, 0, 100);
	ob_publish_motion(u, ONE, &m);
	ob_fat_aabb_renew(u, ONE, &(ob_state){ .pose = { m.p, m.q } }, 0);
	look_around(u);
	CHECK(pairs_with(ex, ONE) == 0 && ob_step_failed(u, NULL) == OB_STEP_OK);
	ob_universe_destroy(u, true);
	free(s);
}

static void test_versions(void)
{
	ob_pair_record r;
	memset(&r, 0, sizeof r);
	CHECK(ob_pair_before(&r, 0) == NULL);
	for (uint64_t step = 0; step < 6; step++) {
		const ob_pair_state *before = ob_pair_before(&r, step);
		for (uint32_t again = 0; again < 3; again++) {
			ob_pair_state *next = ob_pair_write(&r, step);
			CHECK(next != before);
			next->points = (uint32_t)step + 10 * again;
			CHECK(ob_pair_before(&r, step) == before);
		}
		CHECK(ob_pair_before(&r, step + 1) != before && ob_pair_before(&r, step + 1)->points == step + 20);
		CHECK(ob_pair_before(&r, step + 7) == ob_pair_before(&r, step + 1)); // kept while not written
		step += step == 3; // steps may be skipped
	}
}

// The fat AABB of a body that moves along x extends ahead by its way in two steps, and elsewhere no farther than at
// rest.
static void test_fat_aabb(void)
{
	const double r = .5, v = 3;
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 1, r, ob_v3(0, 0, 0)).state->v.x = v;
	s->run.gravity = ob_v3(0, 0, 0);
	ob_universe *u = little_populate(s, 1);
	const float *box = ob_universe_step_data(u)->bounds[0];
	const double reach = v * s->run.step_length, margin = .04;
	CHECK_NEAR(box[0], -r - margin, 1e-6);
	CHECK_NEAR(box[3], r + 2 * reach + margin, 1e-6);
	for (int c = 1; c < 3; c++) {
		CHECK_NEAR(box[c], -r - margin, 1e-6);
		CHECK_NEAR(box[3 + c], r + margin, 1e-6);
	}
	float old[6];
	memcpy(old, box, sizeof old);
	ob_state now = { .pose = { { reach, 0, 0 }, ob_quat_identity() }, .v = { v, 0, 0 } };
	ob_fat_aabb_update(u, 0, &now, reach, 0); // still holds it
	CHECK(!memcmp(old, box, sizeof old));
	now.v = ob_v3(0, 0, 0);
	ob_fat_aabb_update(u, 0, &now, 0, 0); // it stopped, and the box is no larger than a box at rest may be
	CHECK(!memcmp(old, box, sizeof old));
	now.pose.p.x = 4 * reach;
	ob_fat_aabb_update(u, 0, &now, 0, 4 * reach); // it has left it; the new one covers the old place
	CHECK_NEAR(box[0], -r - margin, 1e-6);
	CHECK_NEAR(box[3], now.pose.p.x + r + margin, 1e-6);
	ob_universe_destroy(u, true);
	free(s);
}

// The column of a fallen body's fat AABBs is released after a while, though it is no wider than the body.
static void test_column(void)
{
	little_scene *s = little_scene_new();
	ob_world_sphere(&s->world, 1, .5, ob_v3(0, 0, 0));
	ob_universe *u = little_populate(s, 1);
	float *box = ob_universe_step_data(u)->bounds[0];
	box[5] = 10;
	const ob_state now = { .pose.q = ob_quat_identity() };
	ob_fat_aabb_update(u, 0, &now, 0, 0);
	CHECK_NEAR(box[5], .54, 1e-6);
	ob_universe_destroy(u, true);
	free(s);
}

int main(void)
{
	test_merge();
	test_order();
	test_active_stays();
	test_crowd();
	test_versions();
	test_fat_aabb();
	test_column();
	return check_end();
}
