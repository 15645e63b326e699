// Misbehaves as the environment says, WILD="MOMENT DEED [NUMBER]". Moments: load, instantiate, initialize, step, state, free,
// unload. In a step and in its state only from .2 s on, and only if variable 1 is not 0. 4: a force, 1 N.
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "model.h"

const double model_start[MODEL_VALUES] = { [1] = 1 };

static void fork_ten(void)
{
	for (int i = 0; i < 10; i++)
		if (fork() == 0)
			for (;;)
				sleep(1);
}

static void flood(void)
{
	static const char line[] = "\033[31m\033]0;title\007 said in vain \x9b 31m\r\n";
	char lines[100 * (sizeof line - 1)];
	for (size_t i = 0; i < sizeof lines; i++)
		lines[i] = line[i % (sizeof line - 1)];
	for (size_t n = 0; n < 25000000; n += sizeof lines)
		if (printf("%s", line) < 0 || write(STDERR_FILENO, lines, sizeof lines) < 0)
			abort();
}

static int recurse(volatile char *above)
{
	volatile char here[4096];
	here[0] = above ? *above : 0;
	return here[0] == 1 ? 0 : recurse(here) + here[0];
}

static void *leave_soon(void *nothing)
{
	usleep(2000);
	_exit(7);
}

static void misbehave(const char *deed, int number)
{
	pthread_t thread;
	if (strcmp(deed, "exit") == 0)
		exit(number);
	else if (strcmp(deed, "_exit") == 0)
		_exit(number);
	else if (strcmp(deed, "signal") == 0)
		kill(getpid(), number);
	else if (strcmp(deed, "hang") == 0)
		for (volatile int i = 0;; i++)
			;
	else if (strcmp(deed, "sleep") == 0)
		for (;;)
			sleep(1);
	else if (strcmp(deed, "fork") == 0)
		fork_ten();
	else if (strcmp(deed, "system") == 0)
		exit(system("sleep 1000 &"));
	else if (strcmp(deed, "kill") == 0)
		kill(getppid(), SIGKILL);
	else if (strcmp(deed, "flood") == 0)
		flood();
	else if (strcmp(deed, "overflow") == 0)
		recurse(NULL);
	else if (strcmp(deed, "close") == 0)
		close_range(0, ~0U, 0);
	else if (strcmp(deed, "handlers") == 0)
		for (int s = 1; s < NSIG; s++)
			signal(s, SIG_IGN);
	else if (strcmp(deed, "thread") == 0 && pthread_create(&thread, NULL, leave_soon, NULL) == 0)
		pthread_detach(thread);
}

void model_at(const char *moment)
{
	char when[20], deed[20];
	int number = 0;
	const char *wild = getenv("WILD");
	if (wild && sscanf(wild, "%19s %19s %d", when, deed, &number) >= 2 && strcmp(when, moment) == 0)
		misbehave(deed, number);
}

__attribute__((constructor)) static void load(void)
{
	model_at("load");
}

__attribute__((destructor)) static void unload(void)
{
	model_at("unload");
}

bool model_step(double v[MODEL_VALUES], double time, double length)
{
	v[4] = 1;
	if (time >= .2 && v[1] != 0)
		model_at("step");
	v[0] = time;
	return true;
}

void model_give_state(const double v[MODEL_VALUES])
{
	if (v[0] >= .2 && v[1] != 0)
		model_at("state");
}
