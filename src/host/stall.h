// Stalls: no step is completed for longer than the run has patience.
//
// What counts is time in which the run could have gone on. Time in which this process stood still does not
// (base/clock.h), so Ctrl-Z, a suspended machine and a debugger on the host end no run. Where simulators compute, their
// CPU time counts, so a machine that gives them a tenth of a core gives them ten times the patience, but no more. Where
// none computes and none is kept from it, they are stopped or wait for something: then time on the wall counts.
//
// Thread-safety: the thread that waits for the run.
#ifndef OB_HOST_STALL_H
#define OB_HOST_STALL_H

#include "base/clock.h"
#include "host/host.h"

typedef struct ob_stall_watch {
	uint64_t step; // complete when it was last looked
	ob_hang_clock clock; // since then
	double looked, counted; // s: of the clock at the last look; so far
	uint64_t cpu_ns; // of all workers at the last look; 0 = not known
} ob_stall_watch;

ob_stall_watch ob_stall_watch_start(const ob_host *h);
// To be called some ten times a second. true: patience (s) has ended without a completed step.
bool ob_stall_watch_look(ob_stall_watch *s, ob_host *h);
// The first of the workers that block the step, those
// that the next function names; UINT32_MAX: nobody does.
uint32_t ob_stall_first(const ob_host *h);
// Names the workers that block the step, those that the gate still waits for or, where it waits for none, the one that
// schedules: "simulator 3 (task 4242, stopped by a signal), simulator 5 (task 4244, computing)". Text may be cut to
// size. Takes a tenth of a second, to see which of them compute.
void ob_stall_describe(const ob_host *h, char *text, size_t size);

#endif
