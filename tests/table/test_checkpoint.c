// A restored universe equals the one that was copied, after any changes in between, and its readers never see a torn
// motion.
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../check.h"
#include "table/checkpoint.h"
#include "table/home.h"
#include "table/layout.h"

enum { OBJECTS = 300, WORKERS = 3 };

static ob_universe *make(void)
{
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "test-checkpoint-%d", (int)getpid());
	ob_universe_setup setup = { .name = name, .capacity = OBJECTS, .workers = WORKERS, .isolation = "process" };
	setup.run = (ob_run_settings){ .step_length = .01, .substeps = 1 };
	ob_universe *u = ob_universe_create(&setup, &e);
	CHECK(u);
	for (uint32_t id = 0; id < OBJECTS; id++) {
		ob_passport p = { .id = id, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_SPHERE, .mass = 1 };
		ob_write_passport(u, id, &p);
	}
	return u;
}

// All numbers of a motion are equal, so that a torn one shows.
static ob_motion motion(double x)
{
	ob_motion m = { .t0 = x, .p = ob_v3(x, x, x), .v = ob_v3(x, x, x), .w = ob_v3(x, x, x), .a = ob_v3(x, x, x) };
	m.q = ob_quat_identity();
	m.path = m.valid_until = x;
	return m;
}

static void publish_all(ob_universe *u, double x)
{
	for (uint32_t id = 0; id < OBJECTS; id++) {
		ob_motion m = motion(x + id);
		ob_publish_motion(u, id, &m);
	}
}

// The areas of the step, byte by byte, without the scheduler's scratch.
static char *step_bytes(const ob_universe *u, size_t *n)
{
	*n = u->header.area[OB_AREA_SCRATCH] - u->header.area[OB_AREA_REQUERY];
	return u->base + u->header.area[OB_AREA_REQUERY];
}

static void scatter(ob_universe *u, unsigned seed, int times)
{
	size_t n;
	char *bytes = step_bytes(u, &n);
	for (int i = 0; i < times; i++) {
		seed = seed * 1664525u + 1013904223u;
		bytes[seed % n] = (char)(seed >> 24);
	}
}

// Changes the universe: steps, claims, pages that were not in use, and a gate stopped in the middle of a phase.
static void go_astray(ob_universe *u, unsigned seed)
{
	uint32_t index;
	publish_all(u, 1e6 + seed);
	ob_motion m = motion(7);
	ob_stage_motion(u, 5, &m);
	scatter(u, seed, 2000);
	ob_task_reset(u, 100, 1);
	ob_task_claim(u, &index);
	ob_requery_append(u, 17);
	ob_neighbours_reserve(u, 0, 1000);
	ob_step_complete(u, 1, 2, 3);
	ob_worker_announce(u, 1, 42, 42, 0);
	ob_gate_open(u, OB_PHASE_ISLANDS, NULL, 0);
	ob_turn_arrive(u, 2);
	ob_gate_stop(u);
}

static void check_as_taken(ob_universe *u, const char *bytes)
{
	size_t n;
	ob_worker_info info;
	const char *now = step_bytes(u, &n);
	CHECK(!memcmp(bytes, now, n));
	for (uint32_t id = 0; id < OBJECTS; id++) {
		ob_motion expected = motion(3. + id);
		CHECK(!memcmp(ob_newest_motion(u, id), &expected, sizeof expected));
	}
	CHECK(ob_step_count(u) == 1 && u->control->awake == 9 && u->control->pairs == 8 && u->control->islands == 7);
	CHECK(u->control->requery_count == 1 && u->control->neighbours_used == 10);
	CHECK(ob_universe_get_worker(u, 1, &info) && info.pid == 0);
	CHECK(ob_gate_host_wait(u, 0) && u->gate->stop == 0); // the host has the turn
	ob_gate_open(u, OB_PHASE_BROADPHASE, NULL, 0);
	for (uint32_t w = 0; w < WORKERS; w++) {
		CHECK(ob_turn_wait(u, w) == OB_PHASE_BROADPHASE);
		CHECK(ob_turn_arrive(u, w) == (w == WORKERS - 1));
	}
}

static void test_put_back(void)
{
	size_t n;
	ob_universe *u = make();
	ob_checkpoint *c = ob_checkpoint_create();
	CHECK(c);
	publish_all(u, 3);
	scatter(u, 1, 500);
	ob_requery_append(u, 4);
	ob_neighbours_reserve(u, 0, 10);
	ob_step_complete(u, 9, 8, 7);
	char *bytes = step_bytes(u, &n), *kept = malloc(n);
	memcpy(kept, bytes, n); // brings all pages into use
	for (unsigned life = 0; life < 5; life++) {
		if (life % 2 == 0)
			CHECK(ob_checkpoint_take(c, u) && ob_checkpoint_step(c) == 1);
		go_astray(u, life);
		ob_checkpoint_put_back(c, u);
		ob_checkpoint_forget_workers(u);
		check_as_taken(u, kept);
	}
	free(kept);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(u, true);
}

// Pages that came into use after it was taken are zero again.
// Moves of simulators outlive deaths, but not their objects: of one that came after the checkpoint, or had an earlier one's
// number then.
static void test_moves(void)
{
	enum { STAYS = 3, COMES = 5, ANOTHER = 7 };
	ob_universe *u = make();
	ob_checkpoint *c = ob_checkpoint_create();
	ob_passport p = { .id = COMES };
	ob_write_passport(u, COMES, &p);
	CHECK(ob_checkpoint_take(c, u));
	p = (ob_passport){ .id = COMES, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_SPHERE, .mass = 1 };
	ob_write_passport(u, COMES, &p);
	p = (ob_passport){ .id = ANOTHER, .generation = 9, .flags = OB_OBJECT_PRESENT, .mass = 1 };
	ob_write_passport(u, ANOTHER, &p);
	for (uint32_t id = STAYS; id <= ANOTHER; id += 2) {
		CHECK(ob_move_ask(u, id, 1));
		ob_move_make(u, ob_move_take(u));
	}
	ob_checkpoint_put_back(c, u);
	CHECK(ob_universe_step_data(u)->pin[STAYS] == 2 && ob_moves_were_made(u));
	CHECK(ob_universe_step_data(u)->pin[COMES] == 0 && ob_universe_step_data(u)->pin[ANOTHER] == 0);
	ob_pin_drop(u, STAYS);
	CHECK(!ob_moves_were_made(u));
	ob_checkpoint_destroy(c);
	ob_universe_destroy(u, true);
}

static void test_new_pages(void)
{
	size_t n, set = 0;
	ob_universe *u = make();
	ob_checkpoint *c = ob_checkpoint_create();
	CHECK(ob_checkpoint_take(c, u));
	scatter(u, 5, 20000);
	ob_checkpoint_put_back(c, u);
	const char *bytes = step_bytes(u, &n);
	for (size_t i = 0; i < n; i++)
		set += bytes[i] != 0;
	CHECK(set == 0);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(u, true);
}

typedef struct look {
	ob_universe *u;
	atomic_bool over;
	atomic_uint looks;
	unsigned torn;
} look;

static void *keep_looking(void *argument)
{
	look *l = argument;
	ob_motion m;
	for (uint32_t id = 0; !l->over; id = (id + 1) % OBJECTS) {
		bool whole = ob_universe_get_motion(l->u, id, &m);
		l->torn += !whole || m.p.x != m.t0 || m.w.z != m.t0 || m.path != m.t0;
		l->looks++;
	}
	return NULL;
}

static void test_readers(void)
{
	pthread_t thread;
	look l = { .u = make() };
	ob_checkpoint *c = ob_checkpoint_create();
	publish_all(l.u, 3);
	CHECK(ob_checkpoint_take(c, l.u));
	pthread_create(&thread, NULL, keep_looking, &l);
	for (int i = 0; i < 300 || l.looks < 100000; i++) {
		publish_all(l.u, i);
		ob_checkpoint_put_back(c, l.u);
	}
	l.over = true;
	pthread_join(thread, NULL);
	CHECK(l.torn == 0);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(l.u, true);
}

static void *look_for_present(void *argument)
{
	look *l = argument;
	ob_passport p;
	ob_motion m;
	for (uint32_t id = 0; !l->over; id = (id + 1) % OBJECTS) {
		const uint64_t version = ob_universe_get_passport_version(l->u, id);
		const bool present = ob_universe_get_passport(l->u, id, &p) && p.flags & OB_OBJECT_PRESENT;
		l->torn += present && !ob_universe_get_motion(l->u, id, &m) &&
			   ob_universe_get_passport_version(l->u, id) == version;
		l->looks++;
	}
	return NULL;
}

// An object that came after the checkpoint goes before its motion does: whatever is present has one.
static void test_comers(void)
{
	pthread_t thread;
	look l = { .u = make() };
	const ob_passport none = { .id = 0 };
	ob_checkpoint *c = ob_checkpoint_create();
	for (uint32_t id = 0; id < OBJECTS; id++)
		ob_write_passport(l.u, id, &none);
	CHECK(ob_checkpoint_take(c, l.u));
	pthread_create(&thread, NULL, look_for_present, &l);
	for (int i = 0; i < 300 || l.looks < 100000; i++) {
		publish_all(l.u, i);
		for (uint32_t id = 0; id < OBJECTS; id++) {
			const ob_passport p = { .id = id, .flags = OB_OBJECT_PRESENT, .mass = 1 };
			ob_write_passport(l.u, id, &p);
		}
		ob_checkpoint_put_back(c, l.u);
	}
	l.over = true;
	pthread_join(thread, NULL);
	CHECK(l.torn == 0);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(l.u, true);
}

static void *note_deaths(void *argument)
{
	look *l = argument;
	for (; !l->over; l->looks++)
		ob_universe_note_death(l->u, "killed while the universe is paused");
	return NULL;
}

// Simulators may die while the universe is paused: checkpoints are unaffected, and preserve the deaths. (A finding of
// the thread sanitizer ends the test.)
static void test_deaths(void)
{
	pthread_t thread;
	look l = { .u = make() };
	ob_checkpoint *c = ob_checkpoint_create();
	publish_all(l.u, 3);
	pthread_create(&thread, NULL, note_deaths, &l);
	for (int i = 0; i < 100 || l.looks < 1000; i++) {
		CHECK(ob_checkpoint_take(c, l.u));
		ob_checkpoint_put_back(c, l.u);
	}
	l.over = true;
	pthread_join(thread, NULL);
	CHECK(l.u->control->deaths == l.looks);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(l.u, true);
}

int main(void)
{
	test_put_back();
	test_moves();
	test_new_pages();
	test_readers();
	test_comers();
	test_deaths();
	return check_end();
}
