// Calendars against a plain list of due steps; and schedules of runs by calendars against a check of all bodies in each
// step, in their results and in their number of checks.
#include <pthread.h>
#include <stdlib.h>

#include "check.h"
#include "motion/random.h"
#include "schedule/calendar.h"
#include "step/little_universe.h"

enum { OBJECTS = 2000 };

static uint32_t random_below(uint64_t *seed, uint32_t n)
{
	return (uint32_t)(uniform(seed) * n);
}

// Entries are set, postponed and removed at random while steps go by: each step finds exactly the due ones.
static void test_entries(void)
{
	static uint32_t due[OBJECTS], found[OBJECTS];
	uint64_t seed = 31;
	little_scene *s = little_scene_new();
	for (int i = 0; i < OBJECTS; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(i, 0, 0));
	ob_universe *u = little_populate(s, 1);
	const ob_calendar c = ob_calendar_of_objects(u);
	ob_calendar_clear(&c);
	for (uint32_t i = 0; i < OBJECTS; i++)
		due[i] = UINT32_MAX;
	for (uint32_t step = 0; step < 2000; step++) {
		for (uint32_t k = random_below(&seed, 40); k > 0; k--) {
			const uint32_t i = random_below(&seed, OBJECTS);
			due[i] = uniform(&seed) < .1 ? UINT32_MAX : step + random_below(&seed, 400);
			ob_calendar_set(&c, i, due[i]);
		}
		uint32_t n = 0, wrong = 0;
		uint32_t first = UINT32_MAX;
		for (uint32_t i = 0; i < OBJECTS; i++)
			first = due[i] < first ? due[i] : first;
		CHECK(ob_calendar_first(&c) == first);
		const bool any = ob_calendar_is_due(&c, step);
		const bool taken = uniform(&seed) < .5;
		const uint32_t most = uniform(&seed) < .1 ? 1 + random_below(&seed, 20) : OBJECTS;
		const uint32_t listed =
			taken ? ob_calendar_take(&c, step, found, most) : ob_calendar_list(&c, step, found, most);
		for (uint32_t i = 0; i < OBJECTS; i++)
			if (due[i] <= step && n < most)
				wrong += n >= listed || found[n++] != i;
		CHECK(wrong == 0 && n == listed && any == (n > 0));
		for (uint32_t k = 0; k < listed && taken; k++)
			due[found[k]] = UINT32_MAX;
		for (uint32_t k = 0; k < listed; k++)
			if (uniform(&seed) < .8)
				due[found[k]] = UINT32_MAX, ob_calendar_set(&c, found[k], UINT32_MAX);
	}
	ob_universe_destroy(u, true);
	free(s);
}

typedef struct setter {
	ob_calendar calendar;
	const uint32_t *due; // [OBJECTS]
	uint32_t number, of;
	pthread_t thread;
} setter;

static void *set_own(void *arg)
{
	const setter *p = arg;
	for (uint32_t i = p->number; i < OBJECTS; i += p->of)
		ob_calendar_set(&p->calendar, i, p->due[i]);
	return NULL;
}

// Workers that set entries at the same time, each its own among those of the others, lose none.
static void test_entries_of_several(void)
{
	enum { SETTERS = 4 };
	static uint32_t due[OBJECTS], found[OBJECTS];
	uint64_t seed = 33;
	little_scene *s = little_scene_new();
	for (int i = 0; i < OBJECTS; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(i, 0, 0));
	ob_universe *u = little_populate(s, 1);
	const ob_calendar c = ob_calendar_of_objects(u);
	setter all[SETTERS];
	for (uint32_t run = 0; run < 50; run++) {
		uint32_t wrong = 0, n = 0;
		ob_calendar_clear(&c);
		for (uint32_t i = 0; i < OBJECTS; i++)
			due[i] = random_below(&seed, 100);
		for (uint32_t k = 0; k < SETTERS; k++) {
			all[k] = (setter){ .calendar = c, .due = due, .number = k, .of = SETTERS };
			CHECK(pthread_create(&all[k].thread, NULL, set_own, &all[k]) == 0);
		}
		for (uint32_t k = 0; k < SETTERS; k++)
			pthread_join(all[k].thread, NULL);
		const uint32_t listed = ob_calendar_list(&c, run, found, OBJECTS);
		for (uint32_t i = 0; i < OBJECTS; i++)
			if (due[i] <= run)
				wrong += n >= listed || found[n++] != i;
		CHECK(wrong == 0 && n == listed);
	}
	ob_universe_destroy(u, true);
	free(s);
}

// Balls that are thrown up and bounce, some of which collide.
static little_scene *thrown(uint32_t balls, double spacing)
{
	uint64_t seed = 32;
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world).passport->restitution = .7;
	for (uint32_t i = 0; i < balls; i++)
		ob_world_sphere(&s->world, 1, .2, ob_v3(spacing * (i % 12), spacing * (i / 12), within(&seed, 1, 4)))
			.state->v = random_vector(&seed, 2);
	return s;
}

// The same run with a check of each body and each pair in each step: the same bits, so nothing was missed.
static void test_nothing_missed(void)
{
	uint64_t hash[2];
	for (int all = 0; all < 2; all++) {
		little_scene *s = thrown(100, 1.2);
		little_universe l;
		little_open(&l, s);
		for (int step = 0; step < 240; step++) {
			const ob_calendar look = ob_calendar_of_pairs(l.u);
			const ob_step_data *data = ob_universe_step_data(l.u);
			for (uint32_t i = 0; all && i < data->count->pairs; i++)
				if (data->pair[i].a != data->pair[i].b)
					ob_calendar_set(&look, i, 0);
			little_run(&l, 1);
		}
		hash[all] = ob_measure_hash(&l.now);
		little_close(&l);
		free(s);
	}
	CHECK(hash[0] == hash[1]);
}

// Number of visits in the same run with so many bodies at rest: a resting body is not visited.
static uint64_t visits_with(uint32_t at_rest)
{
	little_scene *s = thrown(20, 3);
	s->run.sleeping = true;
	for (uint32_t i = 0; i < at_rest; i++)
		ob_world_box(&s->world, 1, ob_v3(.2, .2, .2), ob_v3(100 + 3. * (i % 40), 3. * (i / 40), .2));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 60); // all of the resting ones sleep by now
	const uint64_t before = ob_universe_step_data(l.u)->count->visits;
	little_run(&l, 60);
	const uint64_t visits = ob_universe_step_data(l.u)->count->visits - before;
	little_close(&l);
	free(s);
	return visits;
}

static void test_cost(void)
{
	const uint64_t alone = visits_with(0), among_many = visits_with(1600);
	CHECK(alone > 0);
	CHECK(among_many == alone);
}

// Few balls in flight are due in a step: the number of visits follows these, not the balls that fly on.
static void test_cost_of_flights(void)
{
	enum { BALLS = 1200, STEPS = 120, LOOKS = 16 };
	little_scene *s = thrown(BALLS, 6);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 1); // all are due in the first one
	const ob_step_data *data = ob_universe_step_data(l.u);
	const uint64_t before = data->count->visits;
	uint64_t solved = 0;
	for (int step = 0; step < STEPS; step++) {
		little_run(&l, 1);
		for (uint32_t id = 0; id < ob_universe_ids(l.u); id++)
			solved += ob_newest_motion(l.u, id)->step == ob_step_count(l.u);
	}
	const uint64_t visits = data->count->visits - before;
	CHECK(solved > BALLS);
	CHECK(visits <= LOOKS * solved);
	CHECK(LOOKS * solved < (uint64_t)BALLS * STEPS); // or the comparison would mean little
	little_close(&l);
	free(s);
}

int main(void)
{
	test_entries();
	test_entries_of_several();
	test_nothing_missed();
	test_cost();
	test_cost_of_flights();
	return check_end();
}
