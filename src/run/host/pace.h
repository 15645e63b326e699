// The pace of a run: simulated time per second of the wall clock, or paused. The thread that runs the universe waits
// for the pace; viewers pause, step, or change the rate.
//
//                        due step
//       rate 1         /        .  a universe that cannot keep up falls behind by at most OB_PACE_BEHIND of
//                    /   .         wall time. Then the line restarts where the universe is, and time has slipped
//                  /  .
//                / .  done steps
//
// Thread-safety: wait is one thread's; the rest may be called by any.
#ifndef OB_HOST_PACE_H
#define OB_HOST_PACE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define OB_PACE_BEHIND .1 // s
#define OB_PACE_MAX INFINITY // the rate of "as fast as possible"

typedef struct ob_pace_state {
	double rate; // simulated seconds a second, > 0; OB_PACE_MAX
	bool paused;
} ob_pace_state;

typedef struct ob_pace {
	pthread_mutex_t lock; // guards the fields below
	pthread_cond_t changed;
	ob_pace_state state;
	uint64_t allowed; // steps that may still be made while it is paused
	uint64_t stop; // step at which it is paused; UINT64_MAX: none
	bool drawn; // the line begins at a step and an instant:
	uint64_t from_step;
	double from_wall; // s
} ob_pace;

void ob_pace_begin(ob_pace *p, double rate, bool paused);
void ob_pace_end(ob_pace *p); // no thread waits any more

ob_pace_state ob_pace_get(ob_pace *p);
void ob_pace_set_rate(ob_pace *p, double rate);
void ob_pace_set_paused(ob_pace *p, bool paused);
void ob_pace_allow(ob_pace *p, uint64_t steps); // more, while it is paused
void ob_pace_run_until(ob_pace *p, uint64_t step); // goes on, and is paused at this step, unless it is set anew before

void ob_pace_restart(ob_pace *p); // the universe was put back: the line begins anew

// Step up to which a universe with "done" complete steps of step_length (s) may run. Waits for at most "patience" (s)
// until that is more than "done". UINT64_MAX: no limit. While it is paused, at most "most" of the allowed steps are taken
// at once, and the others stay allowed.
uint64_t ob_pace_wait(ob_pace *p, uint64_t done, double step_length, uint64_t most, double patience);

#endif
