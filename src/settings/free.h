// Settings of a free run (obsim run --sync free): simulators have times of their own, and no gate (docs/design/free.md).
#ifndef OB_SETTINGS_FREE_H
#define OB_SETTINGS_FREE_H

#include <stdint.h>

typedef enum ob_coupling {
	OB_COUPLING_OWN, // each simulator computes its own response to its neighbours
	OB_COUPLING_LEDGER, // the lower id computes a pair's impulse, and mails it
} ob_coupling;

#define OB_COUPLING_NAMES "own|ledger"
#define OB_SYNC_NAMES "lockstep|free"
#define OB_UPDATE_RATE_MOST 1e5 // Hz, of a run and of an object

// They lie in the table: a fixed size, no pointers.
typedef struct ob_free_settings {
	double update_rate; // Hz, of objects without one of their own; 0: the run is in lockstep
	double rate_most; // Hz, of any object
	double max_lag; // s that a simulator may be ahead of a neighbour; infinity: no bound
	double jitter; // 0 .. 1: share by which lengths of steps vary
	double delay; // s of own time after which a publication is seen
	double pace; // simulated seconds a second; infinity: as fast as possible
	double end; // s: no simulator goes beyond
	uint64_t seed; // of the jitter
	uint32_t coupling; // ob_coupling
	uint32_t heavy; // OB_COUPLING_OWN: 1 = neighbours count as infinitely heavy, 0 = as heavy as they are
	uint32_t objects; // of the scene: they are dealt to workers in blocks
	uint32_t replays; // 1 = the schedule is replayed, 0 = it is recorded
	char schedule[256]; // path of the schedule's file (free/schedule.h); "" = none
} ob_free_settings;

#endif
