// A simulator of a free run: it has a time of its own, and moves its object by one step of its own at a time.
//
//   due (worker.c)      its time has come by the clock, the host, and the bound of the lag (lag.c)
//      │
//   neighbours.c        finds who is near, by its own AABB query
//      │
//   view.c              reads their motions at its own time; has the island solver move its object among them
//   table/free.h        publishes a version
//
// All that it needs to go on lies in the universe: a successor in another process begins at the newest version. Thread-
// safety: a simulator belongs to its worker.
#ifndef OB_FREE_SIMULATOR_H
#define OB_FREE_SIMULATOR_H

#include <math.h>

#include "free/boxes.h"
#include "free/schedule.h"
#include "solver/solver.h"
#include "table/free.h"

// An object near, and the warm start of the contact with it.
typedef struct ob_free_neighbour {
	uint32_t id, generation;
	ob_free_kind kind;
	uint64_t passport_version;
	ob_passport passport;
	const ob_hull *hull;
	ob_found_contact contact; // in the last step; kept == 0: none
	uint64_t version; // the motion's, in the last step
	double apart; // s, own time until which the two cannot touch, if it flies on as that version says
	double bound; // s that the simulator may be ahead of it, as far as contact is concerned
} ob_free_neighbour;

// A neighbour as it is seen at the simulator's time.
typedef struct ob_free_seen {
	uint32_t neighbour; // index
	uint64_t version; // 0: prescribed
	ob_motion motion;
	ob_state now;
} ob_free_seen;

typedef struct ob_free_sim {
	uint32_t id, generation;
	bool present, failed;
	bool anew; // it has not stepped since it began
	double time; // s, own; in flight, until which it holds, as of the last look at that
	double rate; // Hz, of its steps
	double step; // s: longest that the next one should have, by what happens to it and to those that it touches
	double base; // s: steps are counted from here, so that their lengths do not add up rounding
	uint64_t since_base;
	uint64_t random; // of the jitter
	ob_motion motion; // as published
	uint64_t passport_version;
	ob_passport passport;
	const ob_hull *hull;
	float bounds[6]; // as published
	bool bounded; // they are
	double covered; // s, own time until which they hold a flight that goes on
	bool flies; // it touches nothing: until something near changes, the newest version holds
	bool aloft; // in a flight, and does nothing before it ends (table/free.h)
	bool relisted; // neighbours have come or gone since the last step
	ob_free_neighbour *neighbour;
	uint32_t neighbours, neighbours_max;
	uint32_t blocker; // neighbour that is too far behind; OB_NO_OBJECT = none
	double needed; // s: its time from which on it blocks no more
	ob_free_counts counts;
} ob_free_sim;

// Memory that a worker's simulators share: the solver and its scratch memory.
typedef struct ob_free_scratch {
	ob_universe *u;
	uint32_t worker;
	const ob_free_settings *free;
	ob_free_schedule *schedule; // NULL: none
	ob_run_settings run; // the island solver's: its step is the running simulator's
	double boundary; // s, between boundaries of the host
	uint32_t substeps; // each step's, at the run's rate
	ob_free_sim *all; // [sims] the worker's, ascending by id
	uint32_t sims;
	ob_free_boxes boxes;
	ob_solver solver;
	ob_free_sim *sim; // running
	ob_island_object *object;
	ob_passport *passport;
	ob_motion *motion;
	ob_island_pair *pair;
	ob_free_seen *seen; // [near]: ascending by id
	uint32_t near, max; // max: elements of each
	ob_motion end; // result of the solver for the running simulator's object
	bool flew; // it touched nothing
	double closing; // s: longest that the next step should be, by those that it may touch soon
	bool failed;
} ob_free_scratch;

enum { OB_FREE_SHORTEST = 8 }; // the shortest step of a simulator is so small a part of the usual one

// Longest time, s, by which a simulator may be ahead of any other where the lag is bounded and there is no clock; else 0.
static inline double ob_free_lead(const ob_free_settings *f, double step)
{
	return isinf(f->pace) && !isinf(f->max_lag) ? 2 * step : 0;
}

// Begins a simulator, or begins it anew, at the newest version of its object.
bool ob_free_sim_begin(ob_free_sim *s, ob_universe *u, uint32_t id);
void ob_free_sim_finish(ob_free_sim *s);
// End of the next step, s, if it were made now.
double ob_free_sim_next(const ob_free_sim *s, const ob_free_scratch *x);
// Looks until when its flight holds, if others may have lowered that.
void ob_free_sim_look(ob_free_sim *s, const ob_universe *u);
// Moves the object through its next step and publishes it; or lets it fly on until something may happen to it. false: it
// diverged, and steps no more.
bool ob_free_sim_step(ob_free_sim *s, ob_free_scratch *x);

#endif
