// Publications of a free run whose bodies are solved in groups (docs/design/free.md). Each worker has a world of its own, in
// private memory, that holds some bodies and takes lockstep's steps with them. A body's place says who has it:
//
//   held by worker w          its own time is that of w's world: `made` steps of w
//   parked for worker w       its own time is the step at which it was parked; w takes it into its world when that is there
//
//   world of w   ... step k ──> versions of all bodies that were solved ──> made[w] = k + 1
//                               step k + 1, seen by nobody yet              one store: all of them hold
//
// A version of a body has a motion, in the ring of table/free.h, and all else that its next step needs: schedule record, fat
// AABB, and the pairs. They are published before `made` moves. So a worker that is
// killed leaves all its bodies at one step, and its successor goes on from their newest versions that are not after that step:
// the bits are the same. A version that was published for a step that was not made is published again.
//
// Only the worker that has a body may publish it, hold it or park it. A body may come to a worker at any moment, so a change names
// the place from which it is made. An own time never falls.
#ifndef OB_TABLE_GROUP_H
#define OB_TABLE_GROUP_H

#include "table/free.h"

#define OB_NO_WORKER UINT32_MAX
#define OB_GROUP_EMPTY UINT32_MAX // steps made by a worker that holds no body: it may take any
enum { OB_GROUP_VERSIONS = 4 }; // states of a body that are kept
enum {
	OB_GROUP_CONTACTS = 1024, // that a body may be the lower one of
	OB_GROUP_USUALLY = 8, // of these, that memory is there for
	OB_GROUP_SELDOM = OB_GROUP_CONTACTS - OB_GROUP_USUALLY
};

// A contact that goes on beyond a step.
typedef struct ob_group_contact {
	ob_pair_key key; // its record is 0 if it has a state, else OB_NO_RECORD
	uint32_t check; // step in which the pair must be checked; UINT32_MAX: none
	uint32_t stamp; // as ob_pair_record.stamp
	// If it has a state:
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS]; // impulse on body b, if the two do not agree on one
} ob_group_contact;

typedef struct ob_group_state {
	ob_schedule schedule;
	float bounds[6];
	uint32_t neighbours; // that its last query found
	uint32_t contacts;
	uint32_t step, queried; // complete when the version holds; when that query was made
} ob_group_state;

static_assert(sizeof(ob_group_state) == 64 && sizeof(ob_group_contact) == 352, "groups");

typedef struct ob_group_place {
	uint32_t worker, step; // step: of a parked body
	bool held;
} ob_group_place;

// True if the universe is of such a run.
bool ob_group_is(const ob_universe *u);

// ---- all

ob_group_place ob_group_place_of(const ob_universe *u, uint32_t id);
uint32_t ob_group_step(const ob_universe *u, uint32_t id); // own time, in steps
uint32_t ob_group_made(const ob_universe *u, uint32_t worker);
// Copies the newest motion that held when so many steps were complete, and the fat AABB if bounds is not NULL. Returns its
// version; 0: it is not kept.
uint64_t ob_group_read(const ob_universe *u, uint32_t id, uint32_t step, ob_motion *m, float bounds[6]);
// Adds to the numbers of versions that a worker has published, and of its waits for others.
void ob_group_count(const ob_universe *u, uint32_t worker, uint64_t *updates, uint64_t *waits);
// Worker that a worker waits for. false: none.
bool ob_group_blocker(const ob_universe *u, uint32_t worker, uint32_t *blocker);

// ---- host, while all wait

// Enters an object that was placed: parked for a worker at the present step. m, schedule, bounds: as placed.
void ob_group_enter(ob_universe *u, uint32_t id, uint32_t worker, const ob_motion *m);

// ---- the worker that has the body

// Takes back versions that were published for steps after this one.
void ob_group_take_back(ob_universe *u, uint32_t id, uint32_t step);
// Copies all of the newest version. contact: [OB_GROUP_CONTACTS].
void ob_group_get(const ob_universe *u, uint32_t id, ob_motion *m, ob_group_state *s, ob_group_contact *contact);
// Publishes a version that holds once its worker has made s->step steps. false: no memory, and the run has failed.
bool ob_group_put(ob_universe *u, uint32_t id, const ob_motion *m, const ob_group_state *s,
		  const ob_group_contact *contact);
// Parks a body for a worker at a step; or holds one that is parked for this worker. known: its place, as this worker has seen it.
// false: it is elsewhere by now, and stays there.
bool ob_group_park(ob_universe *u, uint32_t id, ob_group_place known, uint32_t worker, uint32_t step);
bool ob_group_hold(ob_universe *u, uint32_t id, ob_group_place known);

// ---- a worker

// Says that the bodies that it holds have made so many steps, and wakes workers that wait for it.
void ob_group_make(ob_universe *u, uint32_t worker, uint32_t steps, uint64_t updates);
// Wakes a worker that may have to take a body; and those that wait for this one.
void ob_group_notify(ob_universe *u, uint32_t worker, uint32_t other);
// Says that the worker is about to wait for another, or for none (OB_NO_WORKER); it then looks once more, and may wait.
void ob_group_await(ob_universe *u, uint32_t worker, uint32_t blocker);
// Sleeps until the worker's word is not `seen` any more, or some time has passed.
void ob_group_wait(ob_universe *u, uint32_t worker, uint32_t seen);

#endif
