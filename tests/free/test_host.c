// Free runs led by the host: threads and processes, births and deaths, requests, kills. Argument: "thread" or "process".
#include <math.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include "../check.h"
#include "../host/little_scene.h"

#include "base/clock.h"
#include "free/free.h"

static ob_host *start(const ob_scene *s, ob_isolation isolation, uint32_t workers, double lag)
{
	ob_error e = { "" };
	const ob_free_settings f = { .update_rate = 200,
				     .rate_most = 200,
				     .max_lag = lag,
				     .jitter = .2,
				     .pace = INFINITY,
				     .end = 1e3,
				     .seed = 1 };
	ob_host_config c = { .isolation = isolation, .workers = workers, .spare = 2, .run = s->run, .free = &f };
	c.run.substeps = 1;
	c.run.iterations = 16;
	ob_host *h = ob_host_start(s, &c, &e);
	if (!h)
		fprintf(stderr, "start: %s\n", e.text);
	return h;
}

static bool reach(ob_host *h, uint64_t step)
{
	ob_error e = { "" };
	ob_host_go(h, step);
	if (ob_host_wait(h, &e) && ob_step_count(ob_host_universe(h)) == step)
		return true;
	fprintf(stderr, "step %llu: %s\n", (unsigned long long)step, e.text);
	return false;
}

static uint32_t objects_of(const ob_host *h)
{
	ob_universe_info info;
	ob_universe_get_info(ob_host_universe(h), &info);
	return info.objects;
}

// Balls on each other and on the ground, with workers for some and for each.
static void test_heap(ob_isolation isolation, uint32_t workers, double lag)
{
	ob_scene s = busy_heap(12);
	s.object[3].born = .1, s.object[4].dies = .2;
	ob_host *h = start(&s, isolation, workers, lag);
	CHECK(h != NULL);
	for (uint64_t step = 0; h && step <= 40; step += 4)
		CHECK(reach(h, step));
	if (h) {
		ob_motion m;
		CHECK(objects_of(h) == 12);
		for (uint32_t id = 1; id <= 12; id++) // none has fallen through the ground
			CHECK(id == 4 || (ob_universe_get_motion(ob_host_universe(h), id, &m) && m.p.z > 0));
	}
	ob_host_stop(h);
	free(s.object);
}

// Requests are carried out where all simulators wait.
static void test_requests(ob_isolation isolation)
{
	ob_scene s = little_scene(3);
	ob_host *h = start(&s, isolation, 2, .01);
	ob_object_def more = ball("more", 5, 5, 3);
	ob_error e;
	CHECK(h && reach(h, 5));
	if (!h)
		return;
	CHECK(ob_host_request_add(h, &more, &e) && ob_host_request_remove(h, 1, 1));
	bool done = false;
	for (uint64_t step = 6; step < 2000 && !done; step += 20) {
		CHECK(reach(h, step));
		ob_passport p;
		done = ob_universe_get_passport(ob_host_universe(h), 4, &p) &&
		       !ob_universe_get_passport(ob_host_universe(h), 1, &p);
	}
	CHECK(done);
	CHECK(objects_of(h) == 4);
	ob_host_stop(h);
	free(s.object);
}

// Simulators that are killed go on where they had published: the same objects, and own times that never fall back.
static void test_kills(void)
{
	enum { KILLS = 8 };
	ob_scene s = busy_heap(6);
	ob_host *h = start(&s, OB_ISOLATION_PROCESS, 0, .01);
	CHECK(h && reach(h, 1));
	for (uint32_t i = 0; h && i < KILLS; i++) {
		const uint32_t id = 1 + i % 6;
		ob_worker_info w;
		CHECK(ob_universe_get_worker(ob_host_universe(h), id, &w) && w.pid > 1);
		const double before = ob_free_time(ob_host_universe(h), id);
		kill(w.pid, SIGKILL);
		CHECK(reach(h, 2 + 30 * i));
		CHECK(ob_free_time(ob_host_universe(h), id) >= before);
	}
	ob_host_times t = { 0 };
	// the last may have been killed ahead of the common time
	for (uint64_t step = 300; h && t.deaths < KILLS && step < 3000; step += 100) {
		CHECK(reach(h, step));
		ob_host_get_times(h, &t);
	}
	CHECK(t.deaths == KILLS);
	ob_host_stop(h);
	free(s.object);
}

int main(int argc, char **argv)
{
	const bool processes = argc > 1 && strcmp(argv[1], "process") == 0;
	const ob_isolation isolation = processes ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
	test_heap(isolation, 2, .01);
	test_heap(isolation, 3, INFINITY);
	test_heap(isolation, 0, .002);
	test_requests(isolation);
	if (processes)
		test_kills();
	return check_end();
}
