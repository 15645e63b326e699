// Bodies of a free run in groups: workers that give them to each other by what they saw a while ago. A body is never in two places,
// and its own time never falls.
#include "table/group.h"

#include "../check.h"

#include <pthread.h>
#include <stdlib.h>

#include "base/random.h"

enum { BODIES = 4, WORKERS = 4, CHANGES = 200000 };

static ob_universe *u;
static uint32_t stopped;

static void create(void)
{
	ob_error e;
	const ob_free_settings settings = {
		.update_rate = 1000, .rate_most = 1000, .objects = BODIES, .coupling = OB_COUPLING_GROUP
	};
	const ob_universe_setup setup = { .capacity = BODIES,
					  .workers = WORKERS,
					  .isolation = "thread",
					  .run = ob_run_settings_default(),
					  .history = 8,
					  .free = &settings };
	u = ob_universe_create(&setup, &e);
	if (!u || !ob_universe_reserve(u, BODIES, &e)) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	const ob_motion m = { .q = { 1, 0, 0, 0 } };
	for (uint32_t id = 0; id < BODIES; id++)
		ob_group_enter(u, id, id % WORKERS, &m);
}

// Gives bodies away that it had when it looked, now or one look before, at later steps.
static void *pass_on(void *argument)
{
	const uint32_t number = (uint32_t)(uintptr_t)argument;
	uint64_t random = number;
	ob_group_place seen[BODIES] = { 0 };
	for (int i = 0; i < CHANGES; i++) {
		const uint32_t id = (uint32_t)(ob_splitmix(&random) % BODIES);
		const ob_group_place before = seen[id];
		seen[id] = ob_group_place_of(u, id);
		const ob_group_place known = ob_splitmix(&random) % 2 ? before : seen[id];
		if (known.worker == number && !known.held)
			ob_group_park(u, id, known, (uint32_t)(ob_splitmix(&random) % WORKERS),
				      known.step + (uint32_t)(ob_splitmix(&random) % 2));
	}
	__atomic_fetch_add(&stopped, 1, __ATOMIC_SEQ_CST);
	return NULL;
}

static void pass_on_bodies(void)
{
	pthread_t thread[WORKERS];
	uint32_t step[BODIES] = { 0 }, falls = 0;
	for (uint32_t w = 0; w < WORKERS; w++)
		pthread_create(&thread[w], NULL, pass_on, (void *)(uintptr_t)w);
	while (__atomic_load_n(&stopped, __ATOMIC_SEQ_CST) < WORKERS)
		for (uint32_t id = 0; id < BODIES; id++) {
			const uint32_t now = ob_group_step(u, id);
			falls += now < step[id];
			step[id] = now;
		}
	for (uint32_t w = 0; w < WORKERS; w++)
		pthread_join(thread[w], NULL);
	CHECK(falls == 0);
	for (uint32_t id = 0; id < BODIES; id++)
		CHECK(ob_group_step(u, id) > 0);
}

static void change_twice(void)
{
	const ob_group_place seen = ob_group_place_of(u, 0);
	CHECK(ob_group_park(u, 0, seen, 1, seen.step + 1));
	CHECK(!ob_group_park(u, 0, seen, 2, seen.step));
	CHECK(!ob_group_hold(u, 0, seen));
	CHECK(ob_group_hold(u, 0, ob_group_place_of(u, 0)) && ob_group_place_of(u, 0).held);
}

int main(void)
{
	create();
	pass_on_bodies();
	change_twice();
	ob_universe_destroy(u, true);
	return check_end();
}
