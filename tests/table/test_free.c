// Versions of a free run: one writer, readers of any version that is kept; a writer that is killed anywhere.
// Argument: "threads" or "killed".
#include "table/free.h"

#include "../check.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/random.h"

enum { DEPTH = 8, OBJECT = 1, PUBLICATIONS = 100000, KILLS = 60 };

static ob_universe *u;

static void create(void)
{
	ob_error e;
	const ob_free_settings settings = {
		.update_rate = 1000, .rate_most = 1000, .objects = 2, .coupling = OB_COUPLING_OWN
	};
	const ob_universe_setup setup = { .capacity = 2,
					  .workers = 1,
					  .isolation = "thread",
					  .run = ob_run_settings_default(),
					  .history = DEPTH,
					  .free = &settings };
	u = ob_universe_create(&setup, &e);
	if (!u || !ob_universe_reserve(u, 2, &e)) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
}

// Version number n: each of its numbers follows from n.
static ob_motion make(uint64_t n)
{
	const double x = (double)n;
	return (ob_motion){ .t0 = x, .p = { x, x + 1, x + 2 }, .q = { 1, 0, 0, 0 }, .v = { x, -x, x }, .path = 3 * x };
}

static bool is_motion(const ob_motion *m)
{
	const double x = m->t0;
	return m->p.x == x && m->p.y == x + 1 && m->p.z == x + 2 && m->v.x == x && m->v.y == -x && m->path == 3 * x;
}

static void publish(uint64_t n)
{
	const ob_motion m = make(n);
	ob_free_publish(u, OBJECT, &m);
}

static uint64_t torn, wrong, reads;

// One reading of a random kept version.
static void read_once(uint64_t *random)
{
	ob_motion m, next;
	const double newest = ob_free_time(u, OBJECT), asked = newest - (double)(ob_splitmix(random) % DEPTH);
	const uint64_t v = ob_free_read(u, OBJECT, asked, &m, &next);
	reads++;
	torn += !v || !is_motion(&m) || (!isnan(next.t0) && !is_motion(&next));
	// a version is its number and its time at once; it is the one asked for, or that is not kept any more
	wrong += v &&
		 (m.t0 != (double)v || (m.t0 < asked && m.t0 != newest) || (!isnan(next.t0) && next.t0 != m.t0 + 1));
}

static void *write_all(void *unused)
{
	for (uint64_t n = 2; n < PUBLICATIONS; n++) {
		publish(n);
		if (n % 16 == 0) // simulators publish once a step: beside a writer without pause readers starve
			nanosleep(&(struct timespec){ .tv_nsec = 1000 }, NULL);
	}
	return NULL;
}

static void test_threads(void)
{
	pthread_t writer;
	uint64_t random = 1;
	publish(1);
	pthread_create(&writer, NULL, write_all, NULL);
	while (ob_free_version(u, OBJECT) < PUBLICATIONS - 1)
		read_once(&random);
	pthread_join(writer, NULL);
}

static void test_killed(void)
{
	uint64_t random = 2;
	publish(1);
	for (int i = 0; i < KILLS; i++) {
		const uint64_t before = ob_free_version(u, OBJECT);
		const pid_t writer = fork();
		if (writer == 0)
			for (uint64_t n = before + 1;; n++)
				publish(n);
		const uint64_t enough = before + 1 + ob_splitmix(&random) % 5000;
		while (ob_free_version(u, OBJECT) < enough)
			read_once(&random);
		kill(writer, SIGKILL);
		waitpid(writer, NULL, 0);
		for (int k = 0; k < 2 * DEPTH; k++)
			read_once(&random);
	}
}

// A reader that needs more than is kept gets the oldest.
static void test_oldest(void)
{
	ob_motion m, next;
	const uint64_t newest = ob_free_version(u, OBJECT), v = ob_free_read(u, OBJECT, -1, &m, &next);
	CHECK(v == newest - (DEPTH - 1) + 1);
	CHECK(next.t0 == m.t0 + 1);
	CHECK(ob_free_read(u, OBJECT, INFINITY, &m, &next) == newest && isnan(next.t0));
	CHECK(ob_free_read(u, 0, 0, &m, &next) == 0);
}

int main(int argc, char **argv)
{
	create();
	if (argc > 1 && strcmp(argv[1], "killed") == 0)
		test_killed();
	else
		test_threads();
	CHECK(torn == 0);
	CHECK(wrong == 0);
	CHECK(reads > 1000);
	test_oldest();
	ob_universe_destroy(u, true);
	return check_end();
}
