// Simulators are killed, or stopped, at any instant, and the run ends in the same bits as if nobody had touched it.
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "check.h"
#include "host/host_state.h"
#include "host/restart.h"
#include "little_scene.h"
#include "workers.h"

enum { STEPS = 400, BALLS = 40 };

// A heap that keeps all pairs busy: balls that fall onto each other. The caller frees object.
static ob_scene heap(void)
{
	ob_scene s = little_scene(BALLS);
	for (int i = 1; i <= BALLS; i++) {
		s.object[i].state.pose.p = ob_v3(.11 * (i % 3), .12 * (i / 3 % 3) + .01 * i, .3 + .22 * (i / 9));
		s.object[i].passport.restitution = .3;
	}
	return s;
}

// FNV-1a over what is there at the end.
static uint64_t hash_of(const ob_host *h)
{
	const ob_universe *u = ob_host_universe(h);
	uint64_t hash = 14695981039346656037u;
	for (uint32_t id = 0; id < ob_universe_capacity(u); id++) {
		ob_motion m;
		if (!ob_universe_get_motion(u, id, &m))
			continue;
		const unsigned char *byte = (const unsigned char *)&m.p;
		for (size_t i = 0; i < sizeof m.p + sizeof m.q + sizeof m.v + sizeof m.w; i++)
			hash = (hash ^ byte[i]) * 1099511628211u;
	}
	return hash;
}

// Deals blows to the simulators of a host, each at some instant after it was asked for.
typedef struct killer {
	ob_host *h;
	uint32_t workers;
	unsigned seed;
	int signal;
	atomic_bool asked, over;
	atomic_uint dealt; // blows so far
} killer;

static unsigned draw(killer *k)
{
	k->seed = k->seed * 1664525u + 1013904223u;
	return k->seed >> 8;
}

static void strike(killer *k)
{
	ob_worker_info info;
	pause_us((int)(draw(k) % 3000));
	while (!k->over) { // a worker that is being restarted has no pid yet
		bool there = ob_universe_get_worker(ob_host_universe(k->h), draw(k) % k->workers, &info) && info.pid;
		if (there && kill(info.pid, k->signal) == 0) {
			k->dealt++;
			return;
		}
		pause_us(100);
	}
}

static void *kill_when_asked(void *argument)
{
	killer *k = argument;
	for (; !k->over; pause_us(50))
		if (atomic_exchange(&k->asked, false))
			strike(k);
	return NULL;
}

// Runs to the end, and asks for a blow "blows" times on the way; each comes before the next is asked for, and before the
// end.
static uint64_t end_of(const ob_scene *s, const ob_host_config *c, killer *k, unsigned blows, uint32_t *deaths)
{
	ob_error e = { "" };
	ob_host_times times;
	pthread_t thread;
	ob_host *h = ob_host_start(s, c, &e);
	CHECK(h);
	k->h = h;
	k->workers = ob_universe_workers(ob_host_universe(h));
	pthread_create(&thread, NULL, kill_when_asked, k);
	unsigned asked = 0;
	for (uint64_t step = 0; step <= STEPS; step++) {
		uint64_t in_part = blows ? step % (STEPS / (blows + 1)) : 0;
		if (in_part == 1 && asked < blows)
			k->asked = ++asked > 0;
		while (in_part == STEPS / (blows + 1) - 1 && k->dealt < asked)
			pause_us(100);
		ob_host_go(h, step);
		bool went = ob_host_wait(h, &e);
		CHECK(went);
		CHECK(steps_of(h) == step); // never seen going back
		if (!went)
			printf("%s\n", e.text);
		if (blows)
			pause_us(100); // time to strike
	}
	uint64_t hash = hash_of(h);
	k->over = true;
	pthread_join(thread, NULL);
	ob_host_get_times(h, &times);
	*deaths = times.deaths;
	ob_host_stop(h);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	return hash;
}

static void test_deaths(const char *what, const ob_scene *s, uint32_t workers, int signal, bool sleeping)
{
	uint32_t deaths, sum = 0, blows = signal == SIGSTOP ? 2 : 3;
	ob_host_config c = little_config(s, OB_ISOLATION_THREAD, 1);
	c.run.sleeping = sleeping;
	uint64_t expected = end_of(s, &c, &(killer){ .seed = 1 }, 0, &deaths);
	CHECK(deaths == 0);
	c = little_config(s, OB_ISOLATION_PROCESS, workers);
	c.run.sleeping = sleeping;
	c.stall_timeout = signal == SIGSTOP ? 1 : 0;
	for (unsigned seed = 0; seed < (signal == SIGSTOP ? 1 : 2); seed++) {
		killer k = { .seed = 7 * seed + workers, .signal = signal };
		CHECK(end_of(s, &c, &k, blows, &deaths) == expected);
		sum += deaths;
	}
	CHECK(sum > 0);
	printf("%s, %u workers, signal %d: %u restarts\n", what, workers, signal, sum);
}

// Where objects are added and removed a checkpoint is taken at once, as far as there is time.
static void test_visitors(void)
{
	ob_scene s = heap();
	for (int i = 30; i <= BALLS; i++) {
		s.object[i].born = .1 * (i - 29);
		s.object[i].dies = i % 2 ? .1 * (i - 29) + 1 : INFINITY;
	}
	test_deaths("visitors", &s, 2, SIGKILL, false);
	free(s.object);
}

// A simulator that dies while the universe stands still is restarted at the next step.
static void test_killed_in_a_pause(void)
{
	ob_scene s = heap();
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	ob_host_times times;
	ob_host *h = ob_host_start(&s, &c, &e);
	for (uint64_t step = 10; step <= 50; step += 20) {
		ob_host_go(h, step);
		CHECK(ob_host_wait(h, &e) && steps_of(h) == step);
		kill(pid_of_worker(ob_host_universe(h), 1), SIGKILL);
		while (!h->restart.requested)
			pause_ms(1);
		CHECK(steps_of(h) == step);
	}
	ob_host_go(h, 51);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 51);
	ob_host_get_times(h, &times);
	CHECK(times.deaths == 3 && times.cpu_s > 0 && times.cpu_s < 1e3);
	ob_host_stop(h);
	free(s.object);
}

// Ctrl-C during a restart: a clean end.
static void test_interrupted(void)
{
	ob_scene s = heap();
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 0);
	ob_error e = { "" };
	for (int us = 0; us < 20000; us += 2000) {
		ob_host *h = ob_host_start(&s, &c, &e);
		ob_host_go(h, 1000000000);
		pause_ms(5);
		kill(pid_of_worker(ob_host_universe(h), 3), SIGKILL);
		pause_us(us);
		kill(getpid(), SIGINT);
		CHECK(!ob_host_wait(h, &e) && ob_host_interrupted(h));
		ob_host_stop(h);
		CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	}
	free(s.object);
}

// Where each simulator that is restarted dies of the same, the run gives up: here of a damaged table.
static void test_again_and_again(void)
{
	ob_scene s = heap();
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	ob_host *h = ob_host_start(&s, &c, &e);
	ob_host_go(h, 100);
	CHECK(ob_host_wait(h, &e));
	ob_step_data *ex = ob_universe_step_data(ob_host_universe(h));
	for (uint32_t i = 0; i < ex->count->pairs; i++)
		ex->pair[i].record = ex->pair[i].active ? OB_NO_RECORD - 1 : OB_NO_RECORD;
	while (!ob_restart_checkpoint_due(h)) // so that the checkpoint is damaged, too
		pause_ms(10);
	ob_host_go(h, 200);
	CHECK(!ob_host_wait(h, &e) && !ob_host_interrupted(h));
	printf("%s\n", e.text);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // which make a report and an exit code of the signal
	CHECK(strstr(e.text, "killed by SIG") && strstr(e.text, "; giving up: simulators failed "));
#endif
	ob_host_stop(h);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

int main(void)
{
	ob_scene s = heap();
	test_deaths("heap", &s, 1, SIGKILL, false);
	test_deaths("heap", &s, 2, SIGKILL, false);
	test_deaths("heap", &s, 3, SIGKILL, true);
	test_deaths("heap", &s, 0, SIGKILL, false);
	test_deaths("heap", &s, 2, SIGSTOP, false);
	free(s.object);
	test_visitors();
	test_killed_in_a_pause();
	test_interrupted();
	test_again_and_again();
	return check_end();
}
