// Readers of the roster, many at once, while a writer replaces it: each sees one whole snapshot, never a mixture.
// Also the queue of requests: several threads push, one takes.
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "check.h"
#include "host/population.h"
#include "host/roster.h"

enum { READERS = 4, ROUNDS = 2000, ENTRIES = 100, PUSHERS = 3, PUSHES = 5000 };

static atomic_bool over;

static void fill(ob_roster_entry *entries, uint32_t n, uint32_t generation)
{
	for (uint32_t i = 0; i < n; i++) {
		entries[i] = (ob_roster_entry){ .id = 2 * i, .generation = generation, .script = (uint8_t)i };
		snprintf(entries[i].name, OB_NAME_MAX, "object %u", 2 * i);
	}
}

static void *read_on(void *argument)
{
	const ob_roster *r = argument;
	ob_roster_entry seen[ENTRIES], one;
	intptr_t mixed = 0;
	uint32_t newest = 0;
	while (!over) {
		size_t n = ob_roster_copy(r, seen, ENTRIES);
		// generation g has 1 + g mod ENTRIES entries, all of generation g
		mixed += n != 1 + seen[0].generation % ENTRIES || seen[0].generation < newest;
		newest = seen[0].generation;
		for (size_t i = 0; i < n; i++)
			mixed += seen[i].generation != newest || seen[i].id != 2 * i;
		if (ob_roster_find(r, 0, &one))
			mixed += one.generation < newest;
		else
			mixed++;
	}
	return (void *)mixed;
}

static void test_concurrent(void)
{
	pthread_t thread[READERS];
	ob_roster_entry entries[ENTRIES];
	ob_roster *r = ob_roster_create();
	fill(entries, 1, 0);
	CHECK(ob_roster_publish(r, entries, 1));
	for (int i = 0; i < READERS; i++)
		pthread_create(&thread[i], NULL, read_on, r);
	for (uint32_t g = 1; g <= ROUNDS; g++) {
		fill(entries, 1 + g % ENTRIES, g);
		CHECK(ob_roster_publish(r, entries, 1 + g % ENTRIES));
	}
	over = true;
	for (int i = 0; i < READERS; i++) {
		void *mixed;
		pthread_join(thread[i], &mixed);
		CHECK(mixed == NULL);
	}
	ob_roster_destroy(r);
}

static void test_lookup(void)
{
	ob_roster_entry entries[ENTRIES], found;
	ob_roster *r = ob_roster_create();
	CHECK(ob_roster_copy(r, entries, ENTRIES) == 0);
	CHECK(!ob_roster_find(r, 0, &found));
	fill(entries, ENTRIES, 7);
	CHECK(ob_roster_publish(r, entries, ENTRIES));
	CHECK(ob_roster_find(r, 42, &found) && found.script == 21 && found.generation == 7);
	CHECK(!ob_roster_find(r, 43, &found));
	CHECK(!ob_roster_find(r, UINT32_MAX, &found));
	CHECK(ob_roster_find(r, 198, &found) && !strcmp(found.name, "object 198"));
	CHECK(!ob_roster_find(r, 199, &found));
	CHECK(ob_roster_copy(r, &found, 1) == ENTRIES && found.id == 0);
	ob_roster_destroy(r);
}

static ob_requests *queue;

static void *push_on(void *argument)
{
	for (uint32_t i = 0; i < PUSHES; i++)
		ob_requests_push(queue, &(ob_request){ .id = i,
						       .kind = OB_REQUEST_ADD,
						       .def.passport.id = (uint32_t)(intptr_t)argument });
	return NULL;
}

static void test_requests(void)
{
	pthread_t thread[PUSHERS];
	uint32_t next[PUSHERS] = { 0 }, taken = 0;
	ob_request r;
	queue = ob_requests_create();
	CHECK(!ob_requests_waiting(queue) && !ob_requests_take(queue, &r));
	for (intptr_t i = 0; i < PUSHERS; i++)
		pthread_create(&thread[i], NULL, push_on, (void *)i);
	bool in_order = true;
	while (taken < PUSHERS * PUSHES) {
		if (!ob_requests_take(queue, &r))
			continue;
		taken++;
		in_order = in_order && r.id == next[r.def.passport.id]++;
	}
	CHECK(in_order); // for each pusher
	for (int i = 0; i < PUSHERS; i++)
		pthread_join(thread[i], NULL);
	CHECK(!ob_requests_waiting(queue));
	ob_requests_push(queue, &r);
	CHECK(ob_requests_waiting(queue));
	ob_requests_destroy(queue); // with one left in it: the leak checker would report it
}

int main(void)
{
	test_lookup();
	test_concurrent();
	test_requests();
	return check_end();
}
