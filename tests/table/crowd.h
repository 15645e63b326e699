// A crowd of workers for the concurrent tests and benchmarks: threads or forked processes, the same function in each.
#ifndef OB_TESTS_TABLE_CROWD_H
#define OB_TESTS_TABLE_CROWD_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

typedef struct crowd crowd;

typedef struct crowd_member {
	crowd *crowd;
	uint32_t number;
	pthread_t thread;
	pid_t pid;
} crowd_member;

struct crowd {
	bool processes;
	uint32_t count;
	int (*run)(void *shared, uint32_t number); // 0 = fine
	void *shared; // memory that forked children share
	crowd_member *member;
};

// Zeroed memory that forked children share. Never freed: the tests end.
void *crowd_memory(size_t bytes);
bool crowd_start(crowd *c);
// Waits for all; returns how many failed (a killed process counts).
uint32_t crowd_join(crowd *c);

#endif
