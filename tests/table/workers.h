// A group of workers for the concurrent tests and benchmarks: threads or forked processes, the same function in each.
#ifndef OB_TESTS_TABLE_WORKERS_H
#define OB_TESTS_TABLE_WORKERS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct worker_group worker_group;

typedef struct worker_group_member {
	worker_group *group;
	uint32_t number;
	pthread_t thread;
	pid_t pid;
} worker_group_member;

struct worker_group {
	bool processes;
	uint32_t count;
	int (*run)(void *shared, uint32_t number); // 0 = fine
	void *shared; // memory shared with forked children
	worker_group_member *member;
};

// Zeroed memory shared with forked children. Never freed: the tests end.
void *shared_memory(size_t bytes);
bool worker_group_start(worker_group *g);
// Waits for all; returns the number of failed ones (a killed process counts).
uint32_t worker_group_join(worker_group *g);

#endif
