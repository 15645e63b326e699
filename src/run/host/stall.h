// Stalls: neither a step nor a share of one (step/budget.h) is completed for longer than the run's patience. Where objects
// may be frozen each share has a budget of its own, so a step of many hard islands takes longer than one share may.
//
// Only time in which the run could have gone on counts. Time in which this process stood still does not (base/clock.h),
// so Ctrl-Z, a suspended machine and a debugger on the host end no run. While simulators compute, their CPU time
// counts: on a tenth of a core they get ten times the patience, but no more. If none computes and none is denied a
// core, they are stopped or wait for something: then wall time counts. In a free run time counts while a step is due by the
// clock. Waits for FMUs do not count: their owner bounds them (foreign.h).
//
// Thread-safety: the thread that waits for the run.
#ifndef OB_HOST_STALL_H
#define OB_HOST_STALL_H

#include "base/clock.h"
#include "host/host.h"

typedef struct ob_stall_watch {
	uint64_t step; // complete at the last look
	uint64_t shares; // hash of the objects on which the workers worked then
	ob_hang_count count; // since then
} ob_stall_watch;

ob_stall_watch ob_stall_watch_start(const ob_host *h);
// Call it about ten times a second. true: patience (s) has ended without a completed step or share.
bool ob_stall_watch_look(ob_stall_watch *s, ob_host *h);
// Names the workers that block the step: those that the gate still waits for or, if it waits for none, the one that
// schedules; in a free run those that hold the common time back. Example: "simulator 3 (task 4242, stopped by a signal),
// simulator 5 (task 4244, computing)". Text may be cut to size. Takes a tenth of a second, to see which of them compute.
// Returns the first, and marks all in h->blocks; OB_NO_WORKER: none blocks it.
uint32_t ob_stall_describe(ob_host *h, char *text, size_t size);

#endif
