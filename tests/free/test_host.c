// Free runs led by the host: threads and processes, births and deaths, requests, kills. Argument: "thread" or "process".
#include <math.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include "../check.h"
#include "../host/little_scene.h"

#include "base/clock.h"
#include "free/free.h"
#include "host/free_run.h"
#include "host/host_state.h"
#include "host/stall.h"

static ob_coupling coupling = OB_COUPLING_OWN;

static ob_host *start_with(const ob_scene *s, ob_isolation isolation, uint32_t workers, double lag, double pace,
			   double patience, ob_on_death policy)
{
	ob_error e = { "" };
	const bool grouped = coupling == OB_COUPLING_GROUP;
	const double rate = grouped ? 1 / s->run.step_length : 200;
	const ob_free_settings f = { .update_rate = rate,
				     .rate_most = rate,
				     .max_lag = lag,
				     .jitter = grouped ? 0 : .2,
				     .pace = pace,
				     .end = 1e3,
				     .seed = 1,
				     .coupling = coupling };
	ob_host_config c = { .isolation = isolation,
			     .workers = workers,
			     .spare = 2,
			     .run = s->run,
			     .free = &f,
			     .patience = patience,
			     .on_death = policy };
	c.run.substeps = 1;
	c.run.iterations = 16;
	ob_host *h = ob_host_start(s, &c, &e);
	if (!h)
		fprintf(stderr, "start: %s\n", e.text);
	return h;
}

static ob_host *start(const ob_scene *s, ob_isolation isolation, uint32_t workers, double lag)
{
	return start_with(s, isolation, workers, lag, INFINITY, 0, OB_ON_DEATH_RESTART);
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
	CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = more }, &e) &&
	      ob_host_request_remove(h, 1, 1));
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

static int32_t pid_of(const ob_host *h, uint32_t worker)
{
	ob_worker_info w;
	CHECK(ob_universe_get_worker(ob_host_universe(h), worker, &w) && w.pid > 1);
	return w.pid;
}

// Workers (bits) that are stopped for longer than the run's patience are killed, named, and go on where they had published;
// others are left alone. Meanwhile some of them touch each other, so the wait for the stopped ones is a chain.
static void test_stops(uint32_t workers, uint32_t stopped)
{
	enum { BALLS = 6, MOST = BALLS + 1 };
	ob_scene s = busy_heap(BALLS);
	ob_host *h = start_with(&s, OB_ISOLATION_PROCESS, workers, .01, INFINITY, 1, OB_ON_DEATH_RESTART);
	int32_t before[MOST] = { 0 };
	ob_death death[OB_DEATHS_KEPT];
	const uint32_t first = !workers, end = workers ? workers : MOST; // object 0 is the ground
	CHECK(h && reach(h, 1));
	for (uint32_t w = first; h && w < end; w++)
		before[w] = pid_of(h, w);
	for (uint32_t w = first; h && w < end; w++)
		if (stopped >> w & 1)
			CHECK(kill(before[w], SIGSTOP) == 0);
	CHECK(h && reach(h, 120));
	for (uint32_t w = first; h && w < end; w++)
		CHECK((pid_of(h, w) == before[w]) == !(stopped >> w & 1));
	const uint32_t n = h ? ob_host_get_deaths(h, death) : 0;
	CHECK(n == (uint32_t)__builtin_popcount(stopped));
	for (uint32_t i = 0; i < n; i++) {
		CHECK(death[i].cause == OB_DEATH_STALL && stopped >> death[i].worker & 1);
		CHECK(death[i].pid == before[death[i].worker] && strstr(death[i].text, "stopped by a signal"));
	}
	ob_host_stop(h);
	free(s.object);
}

// A stop that is shorter than the run's patience kills nothing. One that may not be mended ends the run, which names it.
static void test_other_stops(void)
{
	ob_scene s = busy_heap(6);
	ob_host *h = start(&s, OB_ISOLATION_PROCESS, 0, .01);
	ob_host_times t = { 0 };
	ob_error e = { "" };
	CHECK(h && reach(h, 1));
	if (h) {
		const int32_t pid = pid_of(h, 2);
		CHECK(kill(pid, SIGSTOP) == 0);
		nanosleep(&(struct timespec){ .tv_nsec = 300000000 }, NULL);
		CHECK(kill(pid, SIGCONT) == 0 && reach(h, 60));
		ob_host_get_times(h, &t);
		CHECK(t.deaths == 0 && pid_of(h, 2) == pid);
	}
	ob_host_stop(h);
	h = start_with(&s, OB_ISOLATION_PROCESS, 0, .01, INFINITY, 1, OB_ON_DEATH_ABORT);
	CHECK(h && reach(h, 1));
	if (h) {
		CHECK(kill(pid_of(h, 3), SIGSTOP) == 0);
		ob_host_go(h, 120);
		CHECK(!ob_host_wait(h, &e) && strstr(e.text, "waiting for simulator 3 (") &&
		      strstr(e.text, "stopped by"));
	}
	ob_host_stop(h);
	free(s.object);
}

// A slow clock that all wait for is no stall.
static void test_slow_clock(ob_isolation isolation)
{
	ob_scene s = busy_heap(6);
	ob_host *h = start_with(&s, isolation, 2, .01, 1e-6, 0, OB_ON_DEATH_RESTART);
	CHECK(h != NULL);
	if (!h)
		return;
	ob_host_go(h, 1);
	for (uint32_t id = 1; id <= 6; id++)
		while (ob_free_time(h->u, id) <= 0) // it may begin at once
			CHECK(ob_host_free_wait(h, .01) == false);
	ob_stall_watch watch = ob_stall_watch_start(h);
	watch.count.counted = 61; // s
	CHECK(!ob_stall_watch_look(&watch, h) && watch.count.counted == 0);
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
	test_slow_clock(isolation);
	coupling = OB_COUPLING_GROUP;
	test_heap(isolation, 2, INFINITY);
	test_heap(isolation, 0, INFINITY);
	test_requests(isolation);
	if (processes)
		test_kills();
	coupling = OB_COUPLING_OWN;
	if (processes) {
		test_kills();
		test_stops(0, 1 << 3);
		test_stops(0, 1 << 1 | 1 << 2 | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6);
		test_stops(0, 1 << 2 | 1 << 3 | 1 << 5);
		test_stops(2, 1 << 1);
		test_stops(3, 1 << 0 | 1 << 2);
		test_other_stops();
	}
	return check_end();
}
