// What goes wrong while a universe runs: a simulator is killed, hangs, Ctrl-C comes once or twice, the host is killed.
#include <pthread.h>
#include <string.h>

#include "check.h"
#include "crowd.h"
#include "little_scene.h"

enum { FOR_EVER = 100000000 };

typedef struct blow {
	int after_ms;
	pid_t victim;
	int signal;
	double when; // s, wall
} blow;

static void *strike(void *argument)
{
	blow *b = argument;
	pause_ms(b->after_ms);
	b->when = ob_clock_wall();
	kill(b->victim, b->signal);
	return NULL;
}

static void strike_later(blow *b, pthread_t *thread)
{
	pthread_create(thread, NULL, strike, b);
}

// A run that is struck; returns the seconds from the blow to the end of the wait, e the reason.
static double struck(ob_host *h, blow b, ob_error *e)
{
	pthread_t thread;
	strike_later(&b, &thread);
	ob_host_go(h, FOR_EVER);
	CHECK(!ob_host_wait(h, e));
	double ended = ob_clock_wall();
	pthread_join(thread, NULL);
	return ended - b.when;
}

static void test_killed_simulator(uint32_t workers, bool asleep)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, workers);
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	c.run.sleeping = asleep;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h != NULL);
	strcpy(name, ob_universe_name(ob_host_universe(h)));
	double took = struck(h, (blow){ 50, pid_of_worker(ob_host_universe(h), 1), SIGKILL, 0 }, &e);
	CHECK(took < .1 * SLOWED);
	CHECK(strstr(e.text, "simulator 1 ") && strstr(e.text, "SIGKILL") && !ob_host_interrupted(h));
	CHECK(workers || strstr(e.text, "\"ball 1\""));
	printf("%s (%.1f ms)\n", e.text, 1e3 * took);
	CHECK(!ob_host_wait(h, &e)); // stays so
	ob_host_stop(h);
	CHECK(!segment_exists(name) && waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

static void test_lost_keeper(void)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	ob_host *h = ob_host_start(&s, &c, &e);
	char path[64];
	int keeper = 0;
	snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)getpid(), (int)getpid());
	FILE *f = fopen(path, "r");
	CHECK(f && fscanf(f, "%d", &keeper) == 1);
	fclose(f);
	CHECK(struck(h, (blow){ 50, keeper, SIGKILL, 0 }, &e) < .1 * SLOWED);
	CHECK(strstr(e.text, "keeper"));
	ob_host_stop(h);
	CHECK(wait_until_nothing_left("test-none") >= 0); // its orphans came to this process
	free(s.object);
}

// The only one: of several, one that has nothing to do may hang without keeping the others from going on.
static void test_hanging_simulator(void)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 1);
	ob_error e = { "" };
	c.patience = .5;
	ob_host *h = ob_host_start(&s, &c, &e);
	double took = struck(h, (blow){ 50, pid_of_worker(ob_host_universe(h), 0), SIGSTOP, 0 }, &e);
	CHECK(took > .4 && took < 2 * SLOWED);
	CHECK(strstr(e.text, "was not complete"));
	ob_host_stop(h);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

// asleep: all objects lie on the ground and sleep, and steps pass without work
static void test_interrupt(ob_isolation isolation, int signal_number, bool asleep)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, isolation, 2);
	ob_error e = { "" };
	struct sigaction now;
	c.run.sleeping = asleep;
	signal(signal_number, SIG_DFL);
	ob_host *h = ob_host_start(&s, &c, &e);
	double took = struck(h, (blow){ 50, getpid(), signal_number, 0 }, &e);
	CHECK(took < .2 * SLOWED);
	CHECK(ob_host_interrupted(h) && strstr(e.text, "interrupted"));
	uint64_t step = steps_of(h);
	pause_ms(20);
	CHECK(step > 0 && steps_of(h) == step); // it stands
	ob_host_stop(h);
	sigaction(signal_number, NULL, &now);
	CHECK(now.sa_handler == SIG_DFL);
	free(s.object);
}

_Noreturn static void live_as_host(ob_isolation isolation, const char *name, int ready)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL); // should the test be ended
	ob_scene s = little_scene(40);
	ob_host_config c = little_config(&s, isolation, isolation == OB_ISOLATION_PROCESS ? 0 : 2);
	ob_error e;
	c.name = name;
	signal(SIGINT, SIG_DFL);
	ob_host *h = ob_host_start(&s, &c, &e);
	if (!h)
		_exit(1);
	ob_host_go(h, FOR_EVER);
	ssize_t ignored = write(ready, "r", 1);
	(void)ignored;
	for (;;)
		pause(); // as if busy elsewhere: it does not wait
}

// The host dies while its simulators run: by SIGKILL, or by a second Ctrl-C when the first was not heeded.
static void test_dying_host(ob_isolation isolation, int signal_number, int blows)
{
	int ready[2];
	char name[OB_NAME_MAX], byte;
	snprintf(name, sizeof name, "test-dying-%d", (int)getpid());
	CHECK(pipe(ready) == 0);
	pid_t host = fork();
	if (host == 0)
		live_as_host(isolation, name, ready[1]);
	close(ready[1]);
	CHECK(read(ready[0], &byte, 1) == 1);
	pause_ms(50);
	int dealt = 0;
	do { // two signals that come before the host has run once count as one: hence more, if need be
		kill(host, signal_number);
		pause_ms(20);
		dealt++;
	} while (waitpid(host, NULL, WNOHANG) == 0 && dealt < 50);
	CHECK(dealt >= blows && dealt < 50);
	double took = wait_until_nothing_left(name);
	CHECK(took >= 0 && took < SLOWED);
	printf("host dead by %d x signal %d: nothing left after %.0f ms\n", blows, signal_number, 1e3 * took + 20);
	close(ready[0]);
}

int main(void)
{
	adopt_orphans();
	test_killed_simulator(0, false);
	test_killed_simulator(0, true);
	test_killed_simulator(2, false);
	test_lost_keeper();
	test_hanging_simulator();
	for (int i = 0; i < 2; i++) {
		ob_isolation isolation = i ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
		test_interrupt(isolation, SIGINT, false);
		test_interrupt(isolation, SIGINT, true);
		test_interrupt(isolation, SIGTERM, false);
		test_dying_host(isolation, SIGKILL, 1);
		test_dying_host(isolation, SIGINT, 2);
	}
	return check_end();
}
