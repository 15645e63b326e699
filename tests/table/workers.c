#include "workers.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STACK_BYTES = 256 << 10 };

void *shared_memory(size_t bytes)
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
	worker_group_member *m = argument;
	return (void *)(intptr_t)m->group->run(m->group->shared, m->number);
}

static bool start_process(worker_group_member *m)
{
	m->pid = fork();
	if (m->pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL); // a test that times out leaves no process behind
		_exit(m->group->run(m->group->shared, m->number));
	}
	return m->pid > 0;
}

bool worker_group_start(worker_group *g)
{
	pthread_attr_t attributes;
	pthread_attr_init(&attributes);
	pthread_attr_setstacksize(&attributes, STACK_BYTES);
	g->member = calloc(g->count, sizeof *g->member);
	bool fine = g->member;
	for (uint32_t i = 0; i < g->count && fine; i++) {
		worker_group_member *m = g->member + i;
		*m = (worker_group_member){ .group = g, .number = i };
		fine = g->processes ? start_process(m) : !pthread_create(&m->thread, &attributes, thread_main, m);
	}
	pthread_attr_destroy(&attributes);
	return fine;
}

uint32_t worker_group_join(worker_group *g)
{
	uint32_t failed = 0;
	for (uint32_t i = 0; i < g->count; i++) {
		worker_group_member *m = g->member + i;
		void *result = NULL;
		int status = 0;
		if (g->processes)
			failed += waitpid(m->pid, &status, 0) != m->pid || status != 0;
		else
			failed += pthread_join(m->thread, &result) != 0 || result;
	}
	free(g->member);
	g->member = NULL;
	return failed;
}
