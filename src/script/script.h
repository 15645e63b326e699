// The scripts of objects, as a worker runs them. A runner is the worker's own: an interpreter for each text that it has
// met, in the sandbox of scenes (scene/sandbox.h), with limits of its own.
//
// An interpreter keeps nothing from call to call: all that a script says at its outside is frozen when it has been
// read, and what an object is to keep lies in its cell of the universe (table/script_data.h). So it does not matter
// which worker runs which object, or whether it is a new one; and a hundred thousand objects with one script need one
// interpreter each worker.
//
// A script that fails (an error, a loop without end, too much memory) is stopped, with what it asked for in this step,
// and no other is.
//
// Thread-safety: one thread each runner, within the phase in which scripts run (sim/scripts.h).
#ifndef OB_SCRIPT_SCRIPT_H
#define OB_SCRIPT_SCRIPT_H

#include "table/table.h"

#define OB_SCRIPT_INSTRUCTIONS 1000000 // of the Lua machine, each call
#define OB_SCRIPT_MEMORY ((size_t)4 << 20) // bytes, of an interpreter

typedef struct ob_script_runner ob_script_runner;

ob_script_runner *ob_script_runner_create(ob_universe *u); // NULL: no memory
void ob_script_runner_destroy(ob_script_runner *r); // NULL is allowed
// Calls what is due of a script, and writes what comes of it to its turn and its cell alone. An ob_script_run of sim/sim.h.
uint64_t ob_script_runner_run(void *runner, ob_script_turn *turn, ob_script_cell *cell);

#endif
