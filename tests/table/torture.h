// Slot torture: one writer publishes as fast as it can, readers copy as fast as they can, and every word of every
// copy must belong to the same publication, no older than the copy before.
#ifndef OB_TESTS_TABLE_TORTURE_H
#define OB_TESTS_TABLE_TORTURE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct torture_result {
	uint64_t published, read;
	uint64_t torn; // copies whose words differ in age
	uint64_t backward; // copies older than the one before
	uint64_t refused; // reads that gave nothing
	uint64_t failed; // readers that crashed or could not start
	double seconds;
} torture_result;

torture_result torture_run(bool processes, uint32_t readers, uint64_t publishes);
// A writer process is killed and replaced "kills" times in the middle of its work; the readers go on.
torture_result torture_run_killed(uint32_t readers, uint32_t kills);

#endif
