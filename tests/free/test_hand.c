// Free simulators in orders chosen at random: nobody waits in a circle, the bound of the lag is kept, and a simulator that
// begins anew goes on where it had published.
#include "hand.h"

#include "../check.h"

#include <math.h>
#include <stdlib.h>

#include "base/random.h"

static const ob_vec3 down = { 0, 0, -9.81 }, none = { 0, 0, 0 };

static ob_free_settings settings(double rate, double lag)
{
	return (ob_free_settings){ .update_rate = rate, .max_lag = lag, .end = INFINITY, .seed = 1 };
}

static ob_motion motion_of(const hand *h, uint32_t id)
{
	ob_motion m;
	ob_universe_get_motion(h->u, id, &m);
	return m;
}

// Steps of a simulator, and those that flights have saved it.
static uint64_t updates_of(const hand *h, uint32_t id)
{
	ob_free_counts counts;
	ob_free_get_counts(h->u, id, &counts);
	return counts.updates;
}

// A lone body flies as it must, whatever lengths its steps have; the common time is exact between two of its versions.
static void test_flight(void)
{
	ob_free_settings f = settings(77, INFINITY);
	f.jitter = .5;
	hand *h = hand_create(f, down);
	const uint32_t id = hand_add(h, OB_SHAPE_BOX, ob_v3(.1, .2, .3), 2, ob_v3(0, 0, 50), ob_v3(1, 0, 2), 0);
	uint64_t random = 3;
	hand_until(h, 60);
	CHECK(hand_run(h, &random, .1));
	for (uint64_t step = 1; step <= 60; step++) {
		CHECK(ob_free_complete(h->u, step) == step);
		const double t = (double)step / 60;
		const ob_motion m = motion_of(h, id);
		CHECK_NEAR(m.p.x, t, 1e-9);
		CHECK_NEAR(m.p.z, 50 + 2 * t - .5 * 9.81 * t * t, 1e-9);
		CHECK_NEAR(m.v.z, 2 - 9.81 * t, 1e-9);
	}
	hand_destroy(h);
}

// The common time is that of the last: nobody's later motion shows.
static void test_common_time(void)
{
	hand *h = hand_create(settings(60, INFINITY), none);
	const uint32_t a = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 0), ob_v3(1, 0, 0), 0),
		       b = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 9, 0), ob_v3(1, 0, 0), 0);
	hand_until(h, 20);
	CHECK(hand_step(h, a));
	CHECK(ob_free_complete(h->u, 20) == 0);
	CHECK(hand_step(h, b));
	ob_free_lower(h->u, b, 4. / 60); // or both would fly to the end
	CHECK(ob_free_complete(h->u, 20) == 4);
	CHECK_NEAR(motion_of(h, a).p.x, 4. / 60, 1e-12);
	CHECK_NEAR(motion_of(h, b).p.x, 4. / 60, 1e-12);
	hand_destroy(h);
}

// Two that touch: the one ahead waits for the other alone, at the bound.
static void test_bound(void)
{
	const double bound = 1e-3;
	hand *h = hand_create(settings(1000, bound), none);
	const uint32_t a = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 0), none, 0),
		       b = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 1, 0), none, 0);
	hand_until(h, 6);
	int ahead = 0;
	while (hand_step(h, a))
		ahead++;
	CHECK(ahead == 2); // it may begin at 0 and at the bound
	CHECK(h->sim[a].blocker == b);
	CHECK(hand_step(h, b));
	CHECK(ob_free_lag_is_over(&h->sim[a], h->u));
	CHECK(hand_step(h, a));
	CHECK(!hand_step(h, a));
	hand_destroy(h);
}

// Small worlds, some of whose simulators begin anew at random, and some of whose objects go: all come to the end.
static void test_no_deadlock(uint64_t worlds)
{
	for (uint64_t seed = 1; seed <= worlds; seed++) {
		uint64_t random = seed;
		ob_free_settings f = settings(100 + 400 * ob_splitmix_real(&random), .004 * ob_splitmix_real(&random));
		f.jitter = .4 * ob_splitmix_real(&random);
		f.delay = seed % 3 ? 0 : .005;
		hand *h = hand_create(f, down);
		hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
		const uint32_t n = 2 + (uint32_t)(ob_splitmix(&random) % 6);
		for (uint32_t i = 0; i < n; i++)
			hand_add(h, i % 2 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE, ob_v3(.2, .2, .2), 1,
				 ob_add(ob_v3(0, 0, .25 + .45 * i), ob_splitmix_vector(&random, .05)),
				 ob_splitmix_vector(&random, .5), seed % 2 ? 0 : .5);
		for (uint64_t step = 5; step <= 15; step += 5) {
			hand_until(h, step);
			CHECK(hand_run(h, &random, .1));
			CHECK(ob_free_complete(h->u, step) == step);
			if (ob_splitmix(&random) % 2)
				hand_remove(h, 1 + (uint32_t)(ob_splitmix(&random) % n));
			if (ob_splitmix(&random) % 2)
				hand_add(h, OB_SHAPE_SPHERE, ob_v3(.2, 0, 0), 1, ob_v3(.1, .1, 3), none, 0);
		}
		hand_destroy(h);
	}
}

// A ball that lands on the ground stays there.
static void test_ground(void)
{
	hand *h = hand_create(settings(480, .01), down);
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t ball = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, .6), none, 0);
	uint64_t random = 1;
	hand_until(h, 60);
	CHECK(hand_run(h, &random, 0));
	CHECK(ob_free_complete(h->u, 60) == 60);
	CHECK_NEAR(motion_of(h, ball).p.z, .5, 1e-4);
	CHECK_NEAR(motion_of(h, ball).v.z, 0, 1e-6);
	hand_destroy(h);
}

// A flight that nothing is near costs no versions; one that comes near is hit as always.
static void test_flight_costs_nothing(void)
{
	hand *h = hand_create(settings(1000, .002), down);
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t ball = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 3), none, 0);
	hand_until(h, 30);
	uint64_t random = 1;
	CHECK(hand_run(h, &random, .01));
	CHECK(updates_of(h, ball) >= 495);
	CHECK(ob_free_version(h->u, ball) < 50);
	CHECK_NEAR(ob_free_time(h->u, ball), .5, 1e-12);
	CHECK(ob_free_complete(h->u, 30) == 30);
	CHECK_NEAR(motion_of(h, ball).p.z, 3 - .5 * 9.81 * .25, 1e-9);
	hand_until(h, 90);
	CHECK(hand_run(h, &random, .01));
	CHECK(ob_free_complete(h->u, 90) == 90);
	CHECK_NEAR(motion_of(h, ball).p.z, .5, 1e-3);
	hand_destroy(h);
}

// A flight is where all may be; one that is lowered, or holds no longer, stays there, and its updates are counted.
static void test_flights_in_the_table(void)
{
	hand *h = hand_create(settings(60, INFINITY), down);
	const uint32_t a = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 9), none, 0),
		       b = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(5, 0, 9), none, 0);
	ob_free_counts counts = { 0 };
	hand_until(h, 4);
	ob_free_take_off(h->u, a, 9. / 60);
	ob_free_take_off(h->u, b, 5. / 60);
	CHECK_NEAR(ob_free_time(h->u, a), 4. / 60, 1e-12);
	CHECK_NEAR(ob_free_time(h->u, b), 4. / 60, 1e-12);
	CHECK(ob_free_complete(h->u, 4) == 4);
	CHECK_NEAR(motion_of(h, a).p.z, 9 - .5 * 9.81 * 16 / 3600, 1e-12);
	const uint64_t lowerings = ob_free_lowerings(h->u);
	const uint32_t word = ob_free_word(h->u, 0);
	ob_free_lower(h->u, a, 10. / 60); // it holds no longer than before
	CHECK(ob_free_lowerings(h->u) == lowerings && ob_free_word(h->u, 0) == word);
	ob_free_lower(h->u, a, 4. / 60);
	CHECK(ob_free_lowerings(h->u) == lowerings + 1 && ob_free_word(h->u, 0) != word);
	CHECK(ob_free_take_lowered(h->u, 0, 1 << b) == 0 && ob_free_take_lowered(h->u, 0, 1 << a | 1 << b) == 1u << a);
	ob_free_run_until(h->u, 6);
	CHECK_NEAR(ob_free_time(h->u, a), 4. / 60, 1e-12);
	CHECK_NEAR(ob_free_time(h->u, b), 5. / 60, 1e-12);
	CHECK_NEAR(ob_free_land(h->u, b, 0, &counts), 5. / 60, 1e-12);
	CHECK(counts.updates == 5 && ob_free_holds(h->u, b) == 0);
	ob_free_lower(h->u, b, 0);
	CHECK_NEAR(ob_free_land(h->u, b, 0, &counts), 5. / 60, 1e-12);
	ob_free_lower(h->u, a, 5.9 / 60);
	CHECK_NEAR(ob_free_land(h->u, a, .2 / 60, &counts), 4. / 60, 1e-12);
	hand_destroy(h);
}

// The grid of boxes finds those that a test of all finds: small, large, moved, infinite, and gone.
static void test_boxes(void)
{
	enum { ROUNDS = 200 };
	hand *h = hand_create(settings(60, INFINITY), none);
	ob_free_boxes grid = { 0 };
	uint32_t changed[OB_FREE_GROUP];
	uint64_t random = 1;
	while (h->objects < HAND_OBJECTS - 1)
		hand_add(h, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(9. * h->objects, 0, 0), none, 0);
	hand_until(h, 1);
	CHECK(ob_free_boxes_begin(&grid, h->u, true));
	for (int round = 0; round < ROUNDS; round++) {
		const uint32_t id = (uint32_t)(ob_splitmix(&random) % h->objects);
		const double size = round % 50 ? exp(8 * ob_splitmix_real(&random) - 4) : INFINITY;
		float box[6];
		for (int c = 0; c < 3; c++) {
			const double at = 20 * ob_splitmix_real(&random) - 10;
			box[c] = (float)(at - size), box[3 + c] = (float)(at + size);
		}
		ob_free_publish_bounds(h->u, id, box);
		if (round == ROUNDS / 2)
			ob_free_enter(h->u, 7, OB_FREE_ABSENT, 1, NULL);
		CHECK(!ob_free_boxes_are_current(&grid, h->u));
		CHECK(ob_free_boxes_look(&grid, h->u, 0, changed) > 0 && ob_free_boxes_are_current(&grid, h->u));
		const uint32_t n = ob_free_boxes_query(&grid, box);
		uint64_t found = 0, expected = 0;
		for (uint32_t i = 0; i < n; i++)
			found |= UINT64_C(1) << grid.found[i];
		for (uint32_t i = 0; i < h->objects; i++)
			if (ob_free_kind_of(h->u, i, NULL) != OB_FREE_ABSENT && ob_free_overlaps(h->u, i, box))
				expected |= UINT64_C(1) << i;
		CHECK(found == expected && n == (uint32_t)__builtin_popcountll(found));
	}
	ob_free_boxes_finish(&grid);
	hand_destroy(h);
}

// One of a hundred stops for a second of the others' time: those that do not touch it keep their rate, those that do wait
// for it, at the bound. Afterwards all come to the end.
static void test_one_stopped(void)
{
	enum { OBJECTS = 100, STOPPED = 2, RATE = 200 };
	const double lag = .02;
	hand *h = hand_create_for(OBJECTS + 1, settings(RATE, lag), down);
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	for (int i = 0; i < 3; i++) // a stack; its middle stops
		hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), 1, ob_v3(0, 0, i + .5), none, 0);
	while (h->objects <= OBJECTS) // those at the ground, and those in flight
		hand_add(h, OB_SHAPE_SPHERE, ob_v3(.4, 0, 0), 1,
			 ob_v3(3 + h->objects % 10, 3 + h->objects / 10, h->objects % 2 ? .4 : 8), none, 0);
	hand_until(h, 60);
	for (int round = 0; round < 4 * RATE; round++)
		for (uint32_t id = 1; id <= OBJECTS; id++)
			if (id != STOPPED)
				hand_step(h, id);
	for (uint32_t id = 1; id <= OBJECTS; id++) {
		const ob_free_sim *s = &h->sim[id];
		if (id == STOPPED)
			CHECK(s->counts.updates == 0);
		else if (id <= 3)
			CHECK(s->blocker == STOPPED && s->time > 0 && s->time <= lag + 1. / RATE + 1e-9);
		else
			CHECK(updates_of(h, id) >= .99 * RATE && s->blocker == OB_NO_OBJECT);
	}
	uint64_t random = 1;
	CHECK(hand_run(h, &random, 0));
	CHECK(ob_free_complete(h->u, 60) == 60);
	CHECK_NEAR(motion_of(h, 3).p.z, 2.5, .05);
	hand_destroy(h);
}

// A heavy ball falls on a light one on the ground: steps get shorter, or the light one would pass on its load too late.
static void test_light_between_heavy(void)
{
	hand *h = hand_create(settings(1000, .002), down);
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t low = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 10, ob_v3(0, 0, .5), none, 0),
		       light = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 1.5), none, 0),
		       heavy = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 10, ob_v3(0, 0, 2.9), ob_v3(0, 0, -8), 0);
	double least = 1;
	uint64_t random = 1;
	for (uint64_t step = 1; step <= 12; step++) {
		hand_until(h, step);
		CHECK(hand_run(h, &random, 0));
		CHECK(ob_free_complete(h->u, step) == step);
		const double z[3] = { motion_of(h, low).p.z, motion_of(h, light).p.z, motion_of(h, heavy).p.z };
		least = ob_min(least, ob_min(z[0] + .5, ob_min(z[1] - z[0], z[2] - z[1])));
	}
	CHECK(least > 1 - .045);
	CHECK(updates_of(h, light) > 205); // of 200 at the usual length
	hand_destroy(h);
}

// Each simulator steps at its own rate, and a slow one is hit as well.
static void test_rates(void)
{
	hand *h = hand_create(
		(ob_free_settings){ .update_rate = 100, .rate_most = 1000, .max_lag = .02, .end = INFINITY }, none);
	const uint32_t slow = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 0), none, 0),
		       fast = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(1.2, 0, 0), ob_v3(-1, 0, 0), 0);
	ob_free_set_rate(h->u, fast, 1000);
	uint64_t random = 1;
	for (uint64_t step = 10; step <= 60; step += 10) {
		hand_until(h, step);
		CHECK(hand_run(h, &random, 0));
	}
	CHECK(ob_free_complete(h->u, 60) == 60);
	CHECK(updates_of(h, slow) >= 98 && updates_of(h, slow) < 200);
	CHECK(updates_of(h, fast) >= 998);
	CHECK_NEAR(motion_of(h, slow).v.x, -.5, .1);
	hand_destroy(h);
}

// A box slides on another, which slides on the ground. Friction that the host changes, while all wait, holds at once for those
// near it, too.
static void test_friction_changes(uint32_t changed)
{
	hand *h = hand_create(settings(1000, .002), down);
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	hand_add(h, OB_SHAPE_BOX, ob_v3(2, .5, .1), 100, ob_v3(0, 0, .1), none, 0);
	hand_add(h, OB_SHAPE_BOX, ob_v3(.1, .1, .1), 1, ob_v3(-1, 0, .3), ob_v3(4, 0, 0), 0);
	uint64_t random = 1;
	hand_until(h, 6);
	CHECK(hand_run(h, &random, 0));
	CHECK(ob_free_complete(h->u, 6) == 6);
	const double before = motion_of(h, 2).v.x;
	CHECK_NEAR(before, 4 - .5 * 9.81 * .1, .1);
	ob_passport p;
	CHECK(ob_universe_get_passport(h->u, changed, &p));
	p.friction = 0;
	ob_write_passport(h->u, changed, &p);
	hand_until(h, 12);
	CHECK(hand_run(h, &random, 0));
	CHECK(ob_free_complete(h->u, 12) == 12);
	CHECK_NEAR(motion_of(h, 2).v.x, before, .02);
	hand_destroy(h);
}

// Argument: number of worlds; 100 without one.
int main(int argc, char **argv)
{
	test_flight();
	test_common_time();
	test_bound();
	test_no_deadlock(argc > 1 ? strtoull(argv[1], NULL, 10) : 100);
	test_ground();
	test_flight_costs_nothing();
	test_flights_in_the_table();
	test_boxes();
	test_one_stopped();
	test_light_between_heavy();
	test_rates();
	for (uint32_t changed = 1; changed <= 2; changed++)
		test_friction_changes(changed);
	return check_end();
}
