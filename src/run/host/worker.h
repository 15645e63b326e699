// A worker, the same in a thread, in a process and within a program: the code it runs, and the report of its end.
#ifndef OB_HOST_WORKER_H
#define OB_HOST_WORKER_H

#include "table/table.h"

enum { OB_WORKER_NO_MEMORY = 3 }; // exit code of a worker that could not get enough memory

// Code of a worker, in its own thread or process, from start to end. 0 = it left after STOP, as it should.
typedef int (*ob_worker_run)(ob_universe *u, uint32_t worker);

// The ob_worker_run of all runs: object simulators (or the monolith) until STOP.
int ob_worker_live(ob_universe *u, uint32_t worker);

// The same, step by step, for a thread that has other things to do, too (spawn_inside.c). All in one thread.
typedef struct ob_worker ob_worker;
// Begins a worker, which may be pinned to a core, and announces it. NULL and e: no memory.
ob_worker *ob_worker_begin(ob_universe *u, uint32_t number, bool pinned, ob_error *e);
// Takes part in phases until the host has its turn, or the gate is stopped. false: no memory; nothing of it may be used again.
bool ob_worker_pass(ob_worker *w);
void ob_worker_leave(ob_worker *w); // NULL is allowed

// Last lines that a process wrote on standard error, as many as fit, newest last, with | between them.
enum { OB_LAST_WORDS = 400 };

typedef struct ob_worker_end {
	uint32_t worker;
	int32_t pid; // of its process
	int32_t error; // errno when its start failed; else 0
	int32_t signal; // signal that killed it; else 0
	int32_t code; // its exit code; 0 = it left after STOP
	char words[OB_LAST_WORDS]; // "" = none; a thread has none of its own
} ob_worker_end;

// ---- death

// Death of a simulator, or a failure that counts as one: worker, cause, step and last words. Plain data; any thread.

// Policy for simulators that die, stall, or fail to solve their objects.
typedef enum ob_on_death {
	OB_ON_DEATH_RESTART, // all workers restart from the last checkpoint, and end in the same bits
	OB_ON_DEATH_FREEZE, // same, and the dead simulator's objects stay in place; so does an island that fails
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
	OB_DEATH_STALL, // no step was completed for longer than the run's patience
	OB_DEATH_DAMAGE, // it wrote invalid data
	OB_DEATH_FAILURE, // no process has died: its objects cannot be solved (overworked, diverged, rejected by ODE)
	OB_DEATH_CAUSES
} ob_death_cause;
#define OB_DEATH_CAUSE_NAMES "signal|exit|stall|damage|failure"

#define OB_NO_WORKER UINT32_MAX

typedef struct ob_death {
	ob_death_cause cause;
	uint32_t worker; // OB_NO_WORKER: unknown
	int32_t pid; // 0: unknown
	int32_t signal, code; // if the process has ended
	uint64_t step; // step in which it died, from 1
	uint64_t when; // ns, ob_clock_ns
	uint32_t object; // object that it simulated or solved at the time; OB_NO_OBJECT
	uint32_t frozen; // objects that stay in place because of it
	char name[OB_NAME_MAX]; // name of the object
	char text[400]; // all of this as a sentence, without a full stop
	char words[OB_LAST_WORDS]; // its last words; "" = none
} ob_death;

// Fills in object and name: the object that its worker ran or solved in this universe.
void ob_death_find_object(ob_death *d, const ob_universe *u);
// Writes one line: the text, the object if known, and the last words.
void ob_death_print(const ob_death *d, char *line, size_t size);

#endif
