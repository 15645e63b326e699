// Simulators move from worker to worker, and the run ends in the bits of one without moves.
#include "base/sanitizer.h"
#include "check.h"
#include "host/host_state.h"
#include "little_scene.h"
#include "measure/measure.h"
#include "table/home.h"
#include "workers.h"

enum { STEPS = 300, BALLS = 40, WORKERS = 3, SEEDS = OB_SANITIZED ? 1 : 3 };

static unsigned draw(unsigned *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return *seed >> 8;
}

static void step_to(ob_host *h, uint64_t step)
{
	ob_error e = { "" };
	ob_host_go(h, step);
	const bool went = ob_host_wait(h, &e);
	CHECK(went && steps_of(h) == step);
	if (!went)
		printf("%s\n", e.text);
}

static uint64_t hash_of(const ob_host *h)
{
	ob_snapshot s = { 0 };
	CHECK(ob_snapshot_take(&s, ob_host_universe(h), 0, NULL));
	const uint64_t hash = ob_measure_hash(&s);
	ob_snapshot_finish(&s);
	return hash;
}

// seed 0: no moves. kill_at: a simulator is killed after each such number of steps; 0 = none
static uint64_t end_of(const ob_scene *s, const ob_host_config *c, unsigned seed, uint64_t kill_at)
{
	ob_error e = { "" };
	ob_host *h = ob_host_start(s, c, &e);
	CHECK(h);
	for (uint64_t step = 0; step <= STEPS; step++) {
		if (seed)
			CHECK(ob_move_ask(h->u, 1 + draw(&seed) % BALLS, draw(&seed) % c->workers));
		step_to(h, step + 1);
		if (!kill_at || (step + 1) % kill_at)
			continue;
		kill(pid_of_worker(h->u, draw(&seed) % c->workers), SIGKILL);
		while (!h->restart.requested)
			pause_ms(1);
	}
	const uint64_t hash = hash_of(h);
	ob_host_stop(h);
	return hash;
}

static void test_same_bits(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_host_config one = little_config(&s, OB_ISOLATION_THREAD, 1);
	const uint64_t expected = end_of(&s, &one, 0, 0);
	for (int kind = 0; kind < 3; kind++) {
		ob_host_config c = little_config(&s, kind ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD, WORKERS);
		c.harden = kind == 2 ? 1 << OB_HARDEN_OUTBOX : 0;
		for (unsigned seed = 1; seed <= SEEDS; seed++)
			CHECK(end_of(&s, &c, seed, kind ? 40 * seed : 0) == expected);
	}
	free(s.object);
}

static uint32_t objects_of(const ob_host *h, uint32_t worker)
{
	ob_worker_info info = { 0 };
	CHECK(ob_universe_get_worker(ob_host_universe(h), worker, &info));
	return info.objects;
}

// All move to one worker, which then has all the work, also when another one has been killed.
static void test_moved(const ob_scene *s, ob_isolation isolation, uint32_t harden)
{
	ob_host_config c = little_config(s, isolation, WORKERS);
	ob_error e = { "" };
	uint32_t home, solved = 0;
	c.harden = harden;
	ob_host *h = ob_host_start(s, &c, &e);
	step_to(h, 0);
	CHECK(!ob_universe_get_home(h->u, 0, &home)); // the ground
	CHECK(ob_move_ask(h->u, 1, 2) && !ob_move_ask(h->u, 1, 1)); // one at a time
	step_to(h, 1);
	CHECK(ob_universe_get_home(h->u, 1, &home) && home == 2);
	for (uint32_t id = 1; id <= BALLS; id++) {
		CHECK(ob_move_ask(h->u, id, 1));
		step_to(h, 1 + id);
		CHECK(ob_universe_get_home(h->u, id, &home) && home == 1);
	}
	if (isolation == OB_ISOLATION_PROCESS) {
		kill(pid_of_worker(h->u, 1), SIGKILL);
		while (!h->restart.requested)
			pause_ms(1);
	}
	for (uint64_t step = BALLS + 2; step < 2 * BALLS; step++) {
		step_to(h, step);
		solved += objects_of(h, 1);
		CHECK(objects_of(h, 0) == 0 && objects_of(h, 2) == 0);
	}
	CHECK(solved > 0);
	for (uint32_t id = 1; id <= BALLS; id++)
		CHECK(ob_universe_get_home(h->u, id, &home) && home == 1);
	ob_host_stop(h);
}

// An object that reuses the number of another does not inherit its move.
static void test_number_again(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, WORKERS);
	ob_error e = { "" };
	ob_passport p;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(ob_move_ask(h->u, 7, 2));
	step_to(h, 1);
	CHECK(ob_moves_were_made(h->u) && ob_universe_get_passport(h->u, 7, &p));
	CHECK(ob_host_request_remove(h, 7, p.generation));
	step_to(h, 2);
	CHECK(!ob_universe_get_passport(h->u, 7, &p) && !ob_moves_were_made(h->u));
	CHECK(ob_move_ask(h->u, 7, 2)); // the object is removed before the move is carried out
	step_to(h, 3);
	CHECK(!ob_moves_were_made(h->u));
	ob_host_stop(h);
	free(s.object);
}

int main(void)
{
	ob_scene s = busy_heap(BALLS);
	test_same_bits();
	test_moved(&s, OB_ISOLATION_THREAD, 0);
	test_moved(&s, OB_ISOLATION_PROCESS, 0);
	test_moved(&s, OB_ISOLATION_PROCESS, 1 << OB_HARDEN_OUTBOX);
	test_number_again();
	free(s.object);
	return check_end();
}
