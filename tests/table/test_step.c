// Claims of tasks, notes of late contacts, the requery list and the arena of neighbours, under 8 threads and 8
// processes.
#include "../check.h"

#include <string.h>

#include "workers.h"
#include "table/table.h"

enum { WORKERS = 8, OBJECTS = 5000, EACH = 3 };

typedef struct board {
	ob_universe *u;
	uint32_t claimed[OBJECTS];
	uint32_t arena[64 * OBJECTS + 65536]; // owner of each word
	uint32_t refused;
} board;

static int work(void *shared, uint32_t worker)
{
	board *b = shared;
	for (uint32_t i; ob_task_claim(b->u, &i);) {
		if (i >= OBJECTS)
			return 1;
		__atomic_fetch_add(&b->claimed[i], 1, __ATOMIC_RELAXED);
		uint32_t at = ob_neighbours_reserve(b->u, 0, EACH);
		if (at == UINT32_MAX)
			return 2;
		for (uint32_t k = 0; k < EACH; k++)
			b->arena[at + k]++; // plain: the place is this worker's alone
	}
	for (uint32_t i = worker; i < OBJECTS; i += WORKERS)
		if (i == OBJECTS / 2)
			ob_late_contacts_note(b->u);
	for (uint32_t i = worker % 2; i < OBJECTS; i += 2) // each id comes from four workers
		ob_requery_append(b->u, i);
	return 0;
}

static void run(bool processes)
{
	board *b = shared_memory(sizeof *b);
	ob_error e;
	ob_universe_setup setup = { .capacity = OBJECTS, .workers = WORKERS, .isolation = "thread" };
	b->u = ob_universe_create(&setup, &e);
	CHECK(b->u);
	if (!b->u)
		return;
	for (uint32_t round = 1; round <= 3; round++) {
		ob_task_reset(b->u, OBJECTS, 1);
		ob_late_contacts_reset(b->u);
		CHECK(!ob_universe_step_data(b->u)->count->late);
		ob_requery_reset(b->u);
		ob_neighbours_reset(b->u);
		worker_group g = { .processes = processes, .count = WORKERS, .run = work, .shared = b };
		CHECK(worker_group_start(&g) && worker_group_join(&g) == 0);
		CHECK(ob_universe_step_data(b->u)->count->late);
		uint32_t wrong = 0, count;
		for (uint32_t i = 0; i < OBJECTS; i++)
			wrong += b->claimed[i] != round;
		for (uint32_t i = 0; i < EACH * OBJECTS + 1; i++)
			wrong += b->arena[i] != (i < EACH * OBJECTS ? round : 0);
		const uint32_t *list = ob_requery_list(b->u, &count);
		CHECK(count == OBJECTS);
		static uint32_t seen[OBJECTS];
		memset(seen, 0, sizeof seen);
		for (uint32_t i = 0; i < count; i++)
			wrong += list[i] >= OBJECTS || seen[list[i]]++;
		CHECK(wrong == 0);
	}
	CHECK(ob_neighbours_reserve(b->u, 0, ob_universe_step_data(b->u)->neighbours_max) == UINT32_MAX); // full
	ob_neighbours_reset(b->u);
	CHECK(ob_neighbours_reserve(b->u, 0, ob_universe_step_data(b->u)->neighbours_max) == 0);
	CHECK(ob_neighbours_reserve(b->u, 0, 1) == UINT32_MAX);
	ob_universe_destroy(b->u, true);
}

int main(void)
{
	run(false);
	run(true);
	return check_end();
}
