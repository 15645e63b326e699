// A worker's world in a free run solved in groups: a universe in its own memory, in which lockstep's step (step/sim.h) moves the
// bodies that the worker holds. Bodies that it does not hold are not there; static and kinematic ones always are.
//
//   shared universe: versions ──(take)──> world ──ob_step──> world, one step on ──(publish)──> versions, then `made`
//
// Thread-safety: a world belongs to its worker.
#ifndef OB_FREE_WORLD_H
#define OB_FREE_WORLD_H

#include "step/sim.h"
#include "table/group.h"

typedef struct ob_group_pair {
	ob_pair_key key;
	uint64_t check; // step of its next check
} ob_group_pair;

typedef struct ob_group_world {
	ob_universe *shared, *u;
	ob_sim *sim;
	uint32_t worker, step; // complete
	uint64_t *passport; // [capacity] versions of body properties, as known
	uint32_t *held, n; // [capacity] bodies that are here, in no order
	uint32_t *place; // [capacity] 1 + index in held; 0 = it is not here
	uint32_t *changed,
		*told; // [capacity] bodies to be published after the step; 1 + the step for which each was listed
	float (*box)[6]; // [capacity] fat AABBs as published
	uint32_t *queried,
		*counted; // [capacity] steps complete when each body last looked for neighbours; their number, as published
	ob_group_pair *known; // [pairs_max] pairs as published, by their indices in the world
	uint32_t pairs; // used ones lie before this index
	uint64_t fault_chances;
	ob_group_contact *contact; // [OB_GROUP_CONTACTS] scratch
} ob_group_world;

// Prepares zeroed memory. false and e: no memory.
bool ob_group_world_begin(ob_group_world *w, ob_universe *shared, uint32_t worker, ob_error *e);
void ob_group_world_finish(ob_group_world *w);
static inline bool ob_group_world_has(const ob_group_world *w, uint32_t id)
{
	return w->place[id];
}
// True if an object is the one that the world knows, and not a later one with its id.
bool ob_group_world_knows(const ob_group_world *w, uint32_t id);
// A chance of the worker to fail, as --fault has it: before each change that others see.
void ob_group_world_chance(ob_group_world *w);
// Bodies that move with which one of the world has pairs; they hold until the next call.
const uint32_t *ob_group_world_neighbours(ob_group_world *w, uint32_t id, uint32_t *n);
// Takes over objects that were placed, changed or removed, while all wait.
void ob_group_world_adopt(ob_group_world *w);
// Takes in n bodies that are parked for the worker at the world's step, with all that touch them; an empty world goes to
// their step.
void ob_group_world_take(ob_group_world *w, const uint32_t *id, uint32_t n);
// Parks n bodies for a worker, with all that touch them.
void ob_group_world_park(ob_group_world *w, const uint32_t *id, uint32_t n, uint32_t worker);
// Makes a step with all bodies, and publishes it. false: it has failed, and so has the run.
bool ob_group_world_step(ob_group_world *w);

#endif
