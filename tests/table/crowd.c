#include "crowd.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STACK_BYTES = 256 << 10 };

void *crowd_memory(size_t bytes)
{
	void *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (p == MAP_FAILED) {
		perror("mmap");
		exit(1);
	}
	return p;
}

static void *thread_main(void *argument)
{
	crowd_member *m = argument;
	return (void *)(intptr_t)m->crowd->run(m->crowd->shared, m->number);
}

static bool start_process(crowd_member *m)
{
	m->pid = fork();
	if (m->pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL); // a test that is timed out leaves no one behind
		_exit(m->crowd->run(m->crowd->shared, m->number));
	}
	return m->pid > 0;
}

bool crowd_start(crowd *c)
{
	pthread_attr_t attributes;
	pthread_attr_init(&attributes);
	pthread_attr_setstacksize(&attributes, STACK_BYTES);
	c->member = calloc(c->count, sizeof *c->member);
	bool fine = c->member;
	for (uint32_t i = 0; i < c->count && fine; i++) {
		crowd_member *m = c->member + i;
		*m = (crowd_member){ .crowd = c, .number = i };
		fine = c->processes ? start_process(m) : !pthread_create(&m->thread, &attributes, thread_main, m);
	}
	pthread_attr_destroy(&attributes);
	return fine;
}

uint32_t crowd_join(crowd *c)
{
	uint32_t failed = 0;
	for (uint32_t i = 0; i < c->count; i++) {
		crowd_member *m = c->member + i;
		void *result = NULL;
		int status = 0;
		if (c->processes)
			failed += waitpid(m->pid, &status, 0) != m->pid || status != 0;
		else
			failed += pthread_join(m->thread, &result) != 0 || result;
	}
	free(c->member);
	c->member = NULL;
	return failed;
}
