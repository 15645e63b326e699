// What is known of a simulator's death, or of what counts as one: who, how, in which step, with which last words.
// Plain data; any thread.
#ifndef OB_HOST_DEATH_H
#define OB_HOST_DEATH_H

#include "host/worker.h"

// What becomes of a run whose simulators die, stall, or cannot solve what they have.
typedef enum ob_on_death {
	OB_ON_DEATH_RESTART, // all go on from the last checkpoint, and end in the same bits
	OB_ON_DEATH_FREEZE, // .. and the objects of the dead one stay where they were; an island that fails, too
	OB_ON_DEATH_ABORT, // the run ends
	OB_ON_DEATH_KEEP, // as RESTART, but an island that fails is frozen: no object ends the run
} ob_on_death;
#define OB_ON_DEATH_NAMES "restart|freeze|abort|keep"

// True if an object that cannot be solved (OB_DEATH_FAILURE) is frozen with its island; else it ends the universe.
static inline bool ob_on_death_freezes_failed(ob_on_death policy)
{
	return policy == OB_ON_DEATH_FREEZE || policy == OB_ON_DEATH_KEEP;
}

typedef enum ob_death_cause {
	OB_DEATH_SIGNAL,
	OB_DEATH_EXIT,
	OB_DEATH_STALL, // no step was completed for longer than the run has patience
	OB_DEATH_DAMAGE, // it has written, or handed over, what makes no sense
	OB_DEATH_FAILURE, // no process has died: its objects cannot be solved (overworked, diverged, given up by ODE)
	OB_DEATH_CAUSES
} ob_death_cause;
#define OB_DEATH_CAUSE_NAMES "signal|exit|stall|damage|failure"

#define OB_NO_WORKER UINT32_MAX

typedef struct ob_death {
	ob_death_cause cause;
	uint32_t worker; // OB_NO_WORKER: it is not known
	int32_t pid; // 0 = not known
	int32_t signal, code; // of a process that has ended
	uint64_t step; // in which it was, from 1
	uint64_t when; // ns, ob_clock_ns
	uint32_t object; // that it simulates, or was busy with; OB_NO_OBJECT
	uint32_t frozen; // objects that stay where they are for it
	char name[OB_NAME_MAX]; // of the object
	char text[400]; // all of this, as a sentence without an end
	char words[OB_LAST_WORDS]; // its last; "" = none
} ob_death;

// Fills in object and name: who its worker is, or was busy with, in this universe.
void ob_death_find_object(ob_death *d, const ob_universe *u);
// The text, with what is known of its object and its last words, on one line.
void ob_death_print(const ob_death *d, char *line, size_t size);

#endif
