// Simulators are killed, or stopped, at any instant, and the run ends in the same bits as an undisturbed one.
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "base/sanitizer.h"
#include "check.h"
#include "host/host_state.h"
#include "host/restart.h"
#include "host/stall.h"
#include "little_scene.h"
#include "step/publish.h"
#include "workers.h"

// A fork takes .1 s under the thread sanitizer.
enum { STEPS = OB_SANITIZED ? 240 : 400, BALLS = OB_SANITIZED ? 15 : 40 };

// FNV-1a over the state at the end.
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

// Strikes the simulators of a host, each blow at some instant after its request.
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

// Runs to the end, and requests a blow "blows" times on the way; each comes before the next request, and before the
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
		CHECK(steps_of(h) == step); // it never goes back
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
	c.patience = signal == SIGSTOP ? 1 : 0;
	for (unsigned seed = 0; seed < (signal == SIGSTOP ? 1 : 2); seed++) {
		killer k = { .seed = 7 * seed + workers, .signal = signal };
		CHECK(end_of(s, &c, &k, blows, &deaths) == expected);
		sum += deaths;
	}
	CHECK(sum > 0);
	printf("%s, %u workers, signal %d: %u restarts\n", what, workers, signal, sum);
}

// A simulator that exits by itself, with any code, counts as one that was killed.
static void leave_with_7(int number)
{
	(void)number;
	_exit(7);
}

static void leave_with_0(int number)
{
	(void)number;
	_exit(0);
}

// Objects that the timetable adds and removes after a checkpoint are added and removed again.
static void test_visitors(void)
{
	ob_scene s = busy_heap(BALLS);
	for (int i = BALLS - 10; i <= BALLS; i++) {
		s.object[i].born = .1 * (i - BALLS + 11);
		s.object[i].dies = i % 2 ? s.object[i].born + 1 : INFINITY;
	}
	test_deaths("visitors", &s, 2, SIGKILL, false);
	free(s.object);
}

// Kills a simulator, and waits until the host has noticed.
static void kill_noticed(ob_host *h, uint32_t worker)
{
	kill(pid_of_worker(ob_host_universe(h), worker), SIGKILL);
	while (!h->restart.requested && !h->failed)
		pause_ms(1);
}

// Adds and removes balls by requests at some steps, in two pauses each. Kills a simulator in the step after each, long
// after the checkpoint, which is that of the start: no other is due before the end. early: the kill comes first, and the
// requests arrive when the run has begun again.
static uint64_t end_of_requests(const ob_scene *s, bool kills, bool early, unsigned *deaths)
{
	enum { FIRST = 20, EACH = 15, LAST = 200 };
	ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, 2);
	ob_host_times times;
	ob_error e = { "" };
	ob_host *h = ob_host_start(s, &c, &e);
	for (uint64_t step = FIRST; step <= LAST; step += EACH) {
		// s, of the last checkpoint: the next is due when this is a small share of the time
		h->restart.cost = 1e9;
		ob_object_def d = ball("visitor", .3, .001 * (double)step, 2), near = ball("second", .3, .2, 2.1);
		ob_passport p = { 0 };
		ob_host_go(h, step);
		CHECK(ob_host_wait(h, &e));
		const bool there = ob_universe_get_passport(ob_host_universe(h), (uint32_t)(step / EACH), &p);
		if (kills && early) {
			kill_noticed(h, step % 2);
			// at most: comings bring a checkpoint, after which others are due by time
			CHECK(ob_restart(h) && steps_of(h) <= step);
			h->started = steps_of(h) > 0;
		}
		CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = d }, &e));
		if (!early)
			ob_host_go(h, step); // a pause of its own
		CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = near }, &e));
		if (there)
			ob_host_request_remove(h, p.id, p.generation);
		ob_host_go(h, step + 1);
		CHECK(ob_host_wait(h, &e));
		if (kills && !early)
			kill_noticed(h, step % 2);
	}
	ob_host_go(h, STEPS);
	CHECK(ob_host_wait(h, &e));
	if (*e.text)
		fprintf(stderr, "%s\n", e.text);
	ob_host_get_times(h, &times);
	*deaths = times.deaths;
	const uint64_t hash = hash_of(h);
	ob_host_stop(h);
	return hash;
}

static void test_requested(void)
{
	ob_scene s = busy_heap(BALLS);
	unsigned deaths;
	for (int early = 0; early < 2; early++) {
		const uint64_t expected = end_of_requests(&s, false, early, &deaths);
		CHECK(deaths == 0);
		CHECK(end_of_requests(&s, true, early, &deaths) == expected && deaths > 10);
	}
	free(s.object);
}

// A simulator that dies while the universe stands still is restarted at the next step.
static void test_killed_in_a_pause(void)
{
	ob_scene s = busy_heap(BALLS);
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

// Freezes a simulator that dies in a certain step as it was when the step before was complete, independent of
// checkpoints.
static uint64_t end_without(const ob_scene *s, uint32_t victim, uint64_t step, int delay_ms, ob_state *frozen)
{
	ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, 0);
	ob_error e = { "" };
	ob_host_times times;
	ob_motion before, after;
	ob_death deaths[OB_DEATHS_KEPT];
	c.on_death = OB_ON_DEATH_FREEZE;
	ob_host *h = ob_host_start(s, &c, &e);
	ob_host_go(h, step / 2);
	CHECK(ob_host_wait(h, &e));
	pause_ms(delay_ms);
	ob_host_go(h, step);
	CHECK(ob_host_wait(h, &e) && ob_universe_get_motion(ob_host_universe(h), victim, &before));
	*frozen = ob_state_now(ob_host_universe(h), victim, &before, step);
	kill(pid_of_worker(ob_host_universe(h), victim), SIGKILL);
	while (!h->restart.requested)
		pause_ms(1);
	ob_host_go(h, 2 * step);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 2 * step);
	CHECK(ob_universe_get_motion(ob_host_universe(h), victim, &after));
	CHECK(ob_norm(ob_sub(after.p, frozen->pose.p)) == 0 && ob_norm(after.v) == 0);
	ob_host_get_times(h, &times);
	CHECK(times.deaths == 1 && times.frozen == 1);
	CHECK(ob_host_get_deaths(h, deaths) == 1 && deaths[0].object == victim && deaths[0].step == step + 1);
	uint64_t hash = hash_of(h);
	ob_host_stop(h);
	return hash;
}

static void test_frozen(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_state frozen[3];
	uint64_t hash[3];
	for (int i = 0; i < 3; i++)
		hash[i] = end_without(&s, 7, 60, 200 * i, &frozen[i]);
	CHECK(hash[0] == hash[1] && hash[0] == hash[2]);
	free(s.object);
}

// An object that diverges at once, and came in a later pause of the same step than others, is frozen in the first
// restart.
static void test_frozen_newcomer(ob_isolation isolation)
{
	ob_scene s = little_scene(0);
	s.run.gravity = ob_v3(0, 0, 1e20); // m/s^2: whatever moves diverges, and the guests do not
	ob_host_config c = little_config(&s, isolation, 2);
	ob_error e = { "" };
	ob_host_times times;
	c.on_death = OB_ON_DEATH_KEEP;
	c.limit = (ob_restart_limit){ 1, 1e6 }; // a frozen object is no death of a simulator
	c.spare = 8;
	ob_host *h = ob_host_start(&s, &c, &e);
	ob_object_def guest = ball("guest", 5, 5, 9), wild = ball("wild", 7, 7, 1);
	guest.passport.flags = OB_OBJECT_STATIC;
	guest.passport.mass = 0;
	for (uint64_t step = 0; step <= 20; step += 20) {
		ob_host_go(h, step);
		CHECK(ob_host_wait(h, &e));
		wild.state.pose.p.x += 2;
		for (int i = 0; i < 3; i++) {
			CHECK(ob_host_request(
				h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = *(i < 2 ? &guest : &wild) }, &e));
			ob_host_go(h, step); // a pause of its own
			CHECK(ob_host_wait(h, &e));
		}
	}
	ob_host_go(h, 40);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 40);
	ob_host_get_times(h, &times);
	CHECK(times.deaths == 2 && times.frozen == 2);
	ob_host_stop(h);
	free(s.object);
}

// Stops the first child that is neither of the two, as soon as it exists.
_Noreturn static void stop_next_child(pid_t parent, const pid_t known[2])
{
	char path[64];
	int child = 0;
	snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
	for (double until = ob_clock_wall() + WAIT_S; ob_clock_wall() < until;) {
		FILE *f = fopen(path, "r");
		while (f && fscanf(f, "%d", &child) == 1)
			if (child != known[0] && child != known[1]) {
				kill(child, SIGSTOP);
				_exit(0);
			}
		if (f)
			fclose(f);
	}
	_exit(1);
}

// A simulator is stopped before it is ready, in a restart: the run still goes on.
static void test_stopped_before_it_is_ready(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	ob_host_times times;
	c.patience = 1;
	ob_host *h = ob_host_start(&s, &c, &e);
	ob_host_go(h, 10);
	CHECK(ob_host_wait(h, &e));
	pid_t before[2] = { pid_of_worker(ob_host_universe(h), 0), pid_of_worker(ob_host_universe(h), 1) };
	kill(before[0], SIGKILL);
	while (!h->restart.requested)
		pause_ms(1);
	pid_t watcher = fork();
	if (watcher == 0)
		stop_next_child(ob_fork_server_pid(h->fork_server), before);
	ob_host_go(h, 300);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 300);
	CHECK(waitpid(watcher, NULL, 0) == watcher);
	ob_host_get_times(h, &times);
	CHECK(times.deaths >= 1);
	ob_host_stop(h);
	free(s.object);
}

// Ctrl-C during a restart: a clean end.
static void test_interrupted(void)
{
	ob_scene s = busy_heap(BALLS);
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

// If each restarted simulator dies of the same cause, the run gives up: here because of a damaged table.
static void test_again_and_again(void)
{
	ob_scene s = busy_heap(BALLS);
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
#if !defined(__SANITIZE_ADDRESS__) && \
	!defined(__SANITIZE_THREAD__) // which turn the signal into a report and an exit code
	CHECK(strstr(e.text, "killed by SIG") && strstr(e.text, "; giving up: simulators failed "));
#endif
	ob_host_stop(h);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

// Patience begins anew with each share of a step, as each may take all of the budget. One that goes on exceeds it.
static void test_patience_of_shares(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, 2);
	ob_error e = { "" };
	ob_host *h = ob_host_start(&s, &c, &e);
	ob_host_go(h, 1);
	CHECK(ob_host_wait(h, &e));
	ob_stall_watch watch = ob_stall_watch_start(h);
	for (uint32_t share = 0; share < 8; share++) {
		ob_worker_set_object(h->u, share % 2, 10 + share);
		watch.count.counted = 61; // s
		CHECK(!ob_stall_watch_look(&watch, h) && watch.count.counted == 0);
	}
	watch.count.counted = 61;
	CHECK(ob_stall_watch_look(&watch, h));
	ob_host_stop(h);
	free(s.object);
}

// Kills one simulator after the other, each before the first step after its start, on a machine on which each restart
// takes "seconds". Returns the number of restarts, 16 at most.
static unsigned kill_before_first_step(ob_host *h, int signal, double seconds)
{
	unsigned n = 0;
	for (; n < 16; n++) {
		kill(pid_of_worker(ob_host_universe(h), n % 2), signal);
		while (!h->restart.requested && !h->failed)
			pause_ms(1);
		h->restart.progress_at -= seconds;
		h->restart.fault_at -= seconds;
		if (!ob_restart(h))
			break;
	}
	h->started = steps_of(h) > 0;
	return n;
}

// Kills that come faster than steps end no run before its patience does. A simulator that leaves by itself soon does.
static void test_killed_before_first_step(void)
{
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	uint32_t deaths;
	const uint64_t expected = end_of(&s, &c, &(killer){ .seed = 1 }, 0, &deaths);
	const struct {
		int signal;
		double seconds; // of a restart
		unsigned least, most; // restarts
	} of[] = { { SIGKILL, 3, 16, 16 }, { SIGKILL, 30, 3, 4 }, { SIGUSR1, 3, 3, 4 } };
	for (int i = 0; i < 3; i++) {
		ob_host *h = ob_host_start(&s, &c, &e);
		ob_host_go(h, 20);
		CHECK(ob_host_wait(h, &e));
		const unsigned n = kill_before_first_step(h, of[i].signal, of[i].seconds);
		CHECK(n >= of[i].least && n <= of[i].most);
		ob_host_go(h, STEPS);
		const bool went = ob_host_wait(h, &e);
		CHECK(went == (n == 16));
		CHECK(went ? hash_of(h) == expected : strstr(e.text, "giving up: simulators failed ") != NULL);
		ob_host_stop(h);
	}
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

int main(void)
{
	ob_scene s = busy_heap(BALLS);
	signal(SIGUSR1, leave_with_7);
	signal(SIGUSR2, leave_with_0);
	test_deaths("heap", &s, 2, SIGUSR1, false);
	test_deaths("heap", &s, 0, SIGUSR2, false);
	test_deaths("heap", &s, 1, SIGKILL, false);
	test_deaths("heap", &s, 2, SIGKILL, false);
	test_deaths("heap", &s, 3, SIGKILL, true);
	test_deaths("heap", &s, 0, SIGKILL, false);
	test_deaths("heap", &s, 2, SIGSTOP, false);
	free(s.object);
	test_visitors();
	test_requested();
	test_killed_in_a_pause();
	test_frozen();
	test_frozen_newcomer(OB_ISOLATION_THREAD);
	test_frozen_newcomer(OB_ISOLATION_PROCESS);
	test_stopped_before_it_is_ready();
	test_interrupted();
	test_again_and_again();
	test_killed_before_first_step();
	test_patience_of_shares();
	return check_end();
}
