// Failures of a running universe: a simulator is killed and cannot be restarted, or stalls, Ctrl-C comes once or twice,
// the fork server or the host is killed.
#include <pthread.h>
#include <string.h>

#include "base/sanitizer.h"
#include "check.h"
#include "little_scene.h"
#include "workers.h"

enum { FOR_EVER = 100000000 };

typedef struct blow {
	int after_ms;
	pid_t victim;
	int signal;
} blow;

static pid_t fork_server_of_this(void)
{
	char path[64];
	int server = 0;
	snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)getpid(), (int)getpid());
	FILE *f = fopen(path, "r");
	CHECK(f && fscanf(f, "%d", &server) == 1);
	fclose(f);
	return server;
}

static void *strike(void *argument)
{
	const blow *b = argument;
	pause_ms(b->after_ms);
	kill(b->victim, b->signal);
	return NULL;
}

// A run that ends early; e is the reason.
static void run_to_its_end(ob_host *h, ob_error *e)
{
	ob_host_go(h, FOR_EVER);
	CHECK(!ob_host_wait(h, e));
}

// A run until a line is written to standard error; e holds the line.
static void run_until_said(ob_host *h, ob_error *e)
{
	FILE *said = tmpfile();
	int before = dup(STDERR_FILENO);
	size_t n = 0;
	dup2(fileno(said), STDERR_FILENO);
	for (double until = ob_clock_wall() + WAIT_S; n == 0 && ob_clock_wall() < until;) {
		ob_host_go(h, steps_of(h) + 10);
		CHECK(ob_host_wait(h, e));
		rewind(said);
		n = fread(e->text, 1, sizeof e->text - 1, said);
	}
	e->text[n] = 0;
	dup2(before, STDERR_FILENO);
	close(before);
	fclose(said);
}

// Calls "run" on a host and sends "victim" a signal some time later.
static void strike_during(ob_host *h, int after_ms, pid_t victim, int signal_number, void (*run)(ob_host *, ob_error *),
			  ob_error *e)
{
	blow b = { .after_ms = after_ms, .victim = victim, .signal = signal_number };
	pthread_t thread;
	pthread_create(&thread, NULL, strike, &b);
	run(h, e);
	pthread_join(thread, NULL);
}

// A monolith's world lies in its simulator's memory, and dies with it.
static void test_killed_simulator(void)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 1);
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	c.run.monolith = 1;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h != NULL);
	strcpy(name, ob_universe_name(ob_host_universe(h)));
	strike_during(h, 50, pid_of_worker(ob_host_universe(h), 0), SIGKILL, run_to_its_end, &e);
	CHECK(strstr(e.text, "simulator 0 ") && strstr(e.text, "SIGKILL") && !ob_host_interrupted(h));
	printf("%s\n", e.text);
	CHECK(!ob_host_wait(h, &e)); // fails again
	ob_host_stop(h);
	CHECK(!segment_exists(name) && waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

static void test_killed_fork_server(void)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, 2);
	ob_error e = { "" };
	ob_host *h = ob_host_start(&s, &c, &e);
	strike_during(h, 50, fork_server_of_this(), SIGKILL, run_to_its_end, &e);
	CHECK(strstr(e.text, "fork server"));
	ob_host_stop(h);
	CHECK(nothing_left("test-none")); // its orphans became children of this process
	free(s.object);
}

// Stalls a simulator that has work. The objects of the run fall endlessly, are solved in every step, and are so many
// that each worker has some. All are restarted. False: another simulator was named, which still computes.
static bool stall(uint32_t workers, uint32_t victim, double patience)
{
	ob_scene s = little_scene(200);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, workers);
	ob_error e = { "" };
	char name[OB_NAME_MAX], who[64];
	c.patience = patience;
	c.run.integrator = OB_INTEGRATOR_ODE; // no ballistic advance
	for (uint32_t i = 1; i < s.objects; i++)
		s.object[i].state.pose.p.z = 1e6;
	ob_host *h = ob_host_start(&s, &c, &e);
	strcpy(name, ob_universe_name(ob_host_universe(h)));
	pid_t pid = pid_of_worker(ob_host_universe(h), victim);
	strike_during(h, 50, pid, SIGSTOP, run_until_said, &e);
	CHECK(strstr(e.text, "was not complete after") && strstr(e.text, "; waiting for simulator"));
	snprintf(who, sizeof who, "simulator %u (task %d, stopped", victim, (int)pid);
	bool found = strstr(e.text, who);
	printf("%s", e.text);
	ob_host_stop(h);
	CHECK(!segment_exists(name) && waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
	return found;
}

// A stalled simulator is named after the timeout, which grows if the machine is too slow for a short one.
static void test_stalled_simulator(uint32_t workers, uint32_t victim)
{
	bool found = false;
	for (double timeout = .5; !found && timeout < 100; timeout *= 5)
		found = stall(workers, victim, timeout);
	CHECK(found);
}

enum { LATER = OB_SANITIZED ? 20000 : 100000 }; // steps
// A simulator stalls while it has no work: the run goes on without it, to its end, and leaves nothing behind.
static void test_stalled_idle_simulator(uint32_t workers, uint32_t victim)
{
	ob_scene s = little_scene(6);
	ob_host_config c = little_config(&s, OB_ISOLATION_PROCESS, workers);
	ob_error e = { "" };
	char name[OB_NAME_MAX];
	c.patience = WAIT_S;
	c.run.sleeping = true;
	ob_host *h = ob_host_start(&s, &c, &e);
	strcpy(name, ob_universe_name(ob_host_universe(h)));
	ob_host_go(h, 400); // all lie on the ground and sleep
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 400);
	kill(pid_of_worker(ob_host_universe(h), victim), SIGSTOP);
	for (uint64_t step = 401; step < 500; step++) {
		ob_host_go(h, step);
		CHECK(ob_host_wait(h, &e) && steps_of(h) == step);
	}
	ob_host_go(h, LATER);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == LATER);
	ob_host_stop(h);
	CHECK(!segment_exists(name) && waitpid(-1, NULL, WNOHANG) < 0);
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
	strike_during(h, 50, getpid(), signal_number, run_to_its_end, &e);
	CHECK(ob_host_interrupted(h) && strstr(e.text, "interrupted"));
	uint64_t step = steps_of(h);
	pause_ms(20);
	CHECK(steps_of(h) <= step + 1); // it stands still; on a busy machine a step under way may end later
	ob_host_stop(h);
	sigaction(signal_number, NULL, &now);
	CHECK(now.sa_handler == SIG_DFL);
	free(s.object);
}

_Noreturn static void run_host(ob_isolation isolation, const char *name, int ready)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL); // if the test is ended
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
		pause(); // busy elsewhere: it does not wait
}

// The host dies while its simulators run: by SIGKILL, or by a second Ctrl-C when it does not react to the first.
static void test_dying_host(ob_isolation isolation, int signal_number, int blows)
{
	int ready[2];
	char name[OB_NAME_MAX], byte;
	snprintf(name, sizeof name, "test-dying-%d", (int)getpid());
	CHECK(pipe(ready) == 0);
	pid_t host = fork();
	if (host == 0)
		run_host(isolation, name, ready[1]);
	close(ready[1]);
	CHECK(read(ready[0], &byte, 1) == 1);
	pause_ms(50);
	int dealt = 0;
	do { // two signals before the host has run once count as one: so more are sent if need be
		kill(host, signal_number);
		pause_ms(20);
		dealt++;
	} while (waitpid(host, NULL, WNOHANG) == 0 && dealt < 50 * WAIT_S);
	CHECK(dealt >= blows && dealt < 50 * WAIT_S);
	CHECK(nothing_left(name));
	close(ready[0]);
}

int main(void)
{
	adopt_orphans();
	test_killed_simulator();
	test_killed_fork_server();
	for (uint32_t workers = 1; workers < 4; workers++) {
		for (uint32_t victim = 0; victim < workers; victim++) {
			test_stalled_simulator(workers, victim);
			test_stalled_idle_simulator(workers, victim);
		}
	}
	test_stalled_simulator(0, 7);
	test_stalled_idle_simulator(0, 3);
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
