// Scripts of objects, in a worker. A runner belongs to the worker: it has an interpreter for each text that the worker
// has run, in the sandbox of scenes (scene/sandbox.h), with its own limits.
//
// An interpreter keeps no state between calls: values outside of functions are frozen once the text has been read, and
// the state of an object lies in its cell of the universe (table/step_data.h). So any worker, also a new one, can run
// any object. A hundred thousand objects with one script need one interpreter per worker.
//
// A script that fails (an error, an endless loop, too much memory) is stopped, and its requests of this step are
// dropped; others run on.
//
// Thread-safety: one thread per runner, within the phase in which scripts run (step/scripts.h).
#ifndef OB_SCRIPT_SCRIPT_H
#define OB_SCRIPT_SCRIPT_H

#include "table/table.h"

#define OB_SCRIPT_INSTRUCTIONS 1000000 // instructions of the Lua machine, per call
#define OB_SCRIPT_MEMORY ((size_t)4 << 20) // bytes, of an interpreter
#define OB_SCRIPT_STRING ((size_t)64 << 10) // bytes, one string

typedef struct ob_script_runner ob_script_runner;

ob_script_runner *ob_script_runner_create(ob_universe *u, uint32_t worker); // NULL: no memory
void ob_script_runner_destroy(ob_script_runner *r); // NULL is allowed
// Makes the due calls of a script, and writes results only to its turn and its cell. An ob_script_run of step/sim.h.
uint64_t ob_script_runner_run(void *runner, ob_script_turn *const *turn, ob_script_cell *const *cell, uint32_t n);

#endif
