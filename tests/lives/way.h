// Ways to run a life: threads, processes whose simulators are killed, hardened ones, which all end alike; and a free run,
// whose simulators are killed or stopped, which ends, in groups as the others.
#ifndef OB_TESTS_LIVES_WAY_H
#define OB_TESTS_LIVES_WAY_H

#include "life.h"

typedef enum way { WAY_THREADS, WAY_ONE_THREAD, WAY_PROCESSES, WAY_HARDENED, WAY_FREE, WAYS } way;
#define WAY_NAMES "threads", "one thread, resumed", "processes, killed", "hardened, killed", "free, killed or stopped"

typedef struct outcome {
	uint64_t hash; // motions, passports, state of scripts
	uint32_t objects, deaths;
	bool failed, broken; // the run; of an invariant
	char text[400]; // why; "" if it has not
} outcome;

// Runs a life, in a process of its own: a crash or a hang is a failure, too.
outcome way_run(const life *l, way w);
// True if both ended in the same state, or failed for the same reason, which is none of obsim's. w: of b; a free run has to end
// well, where a has no objects as there is nothing to compare with.
bool outcomes_agree(way w, const outcome *a, const outcome *b);

#endif
