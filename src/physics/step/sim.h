// Object simulators that one worker runs, and the step.
//
// A worker is a thread or a process; the code is the same. All state that outlives a step lies in the universe, so any
// worker can run any object. An ob_sim is the worker's private side: scratch memory, and ODE bodies of some of the
// objects that it has run.
#ifndef OB_STEP_SIM_H
#define OB_STEP_SIM_H

#include <ob/motion.h>

#include "cluster/peers.h"
#include "motion/path.h"
#include "table/table.h"

typedef struct ob_sim ob_sim;

ob_sim *ob_sim_create(ob_universe *u, uint32_t worker, ob_error *e); // in the worker's own thread
void ob_sim_destroy(ob_sim *s);

// Runs the scripts of n objects, for this module, which has no interpreter: of one, or of up to OB_SCRIPT_BATCH that have the
// same foreign code. turn, cell: data of the scripts (table/step_data.h), in the universe or in a copy. Returns the number
// of instructions of each, the same on any worker.
typedef uint64_t (*ob_script_run)(void *runner, ob_script_turn *const *turn, ob_script_cell *const *cell, uint32_t n);
void ob_sim_set_scripts(ob_sim *s, ob_script_run run, void *runner);

// Connects the arranger with the others before its first step. false and e, on all ranks: one of them has other
// workers, objects or settings, or computes other bits.
bool ob_sim_join(ob_sim *s, const ob_peers *p, ob_error *e);
// Sends the others that this rank's run is over, as they may be waiting for it.
void ob_sim_leave(ob_sim *s);

// Takes part in one phase of the step (step.c shows them all): the worker waits at the gate until one opens to it, does
// its share and arrives. The last worker to arrive schedules the next phase, or the pause. false: STOP.
bool ob_step(ob_sim *s);
// Runs a worker: ob_step until STOP. Returns when the run is over.
void ob_sim_run(ob_sim *s);

// Host, before the first step and after it has changed passports: puts the object's first motion into its slot and the
// object on the broad phase's requery list. The universe must be starting or paused.
void ob_sim_place(ob_universe *u, uint32_t id, const ob_state *state);

// Host, before the first step and at a pause, after ob_sim_place: sets the path of a kinematic object from now on. path
// NULL: it goes on as it was placed; born: the step of its first instant. Returns the step at which it must be called
// again, at a pause, as the published motion ends there; UINT64_MAX: never. More calls change nothing.
uint64_t ob_sim_prescribe(ob_universe *u, uint32_t id, const ob_path *path, uint64_t born);

// Host, at a pause: sets the constant external force (N) on a dynamic object. changes: it differs from the one until
// now, so an object at rest wakes. The passport does not show this: after a restart it holds the force of a later step.
void ob_sim_push(ob_universe *u, uint32_t id, ob_vec3 force, bool changes);

// Host, at a pause, or a simulator where scripts' changes are carried out: adds an impulse (N s) and an angular impulse
// (N m s), world frame, to a dynamic object. Its motion that was computed ahead becomes void, which serves a change of its
// force, too.
void ob_sim_kick(ob_universe *u, uint32_t id, ob_vec3 push, ob_vec3 twist);

// Host, at a pause, or a simulator where scripts' changes are carried out: wakes the objects of a joint. Returns true if one
// was asleep.
bool ob_sim_wake_joined(ob_universe *u, const ob_joint_passport *j);

// Host, at a pause: the object goes on from this state; its contacts end, and its neighbours wake.
void ob_sim_place_anew(ob_universe *u, uint32_t id, const ob_state *state);

// Host, at the start, after ob_universe_load: rebuilds what is not saved: the spatial index, lists of pairs and
// calendars (step/pairs.h).
void ob_sim_restore(ob_universe *u);

// An object as another universe has it when so many steps are complete.
typedef struct ob_taken_object {
	uint32_t id;
	uint32_t neighbours; // as ob_step_data.neighbours
	ob_motion before, motion; // one step ago, and now
	ob_schedule schedule;
	float bounds[6];
} ob_taken_object;
// Same for an object that comes from another universe, after its passport, or goes on in one, which nothing here touches. Its
// pairs follow (ob_pairs_take_in, ob_pairs_meet).
void ob_sim_take_in(ob_universe *u, const ob_taken_object *o);
void ob_sim_hand_out(ob_universe *u, uint32_t id);
// Same, after all of these: begins the pairs of an object with those that came from other universes, as the step that is complete
// would have begun them with both here. Counts them as neighbours. queried: [objects] steps complete when each last looked for these.
void ob_sim_meet(ob_sim *s, uint32_t id, const uint32_t *queried);

// Host, paused: removes an object and clears its passport; its neighbours wake.
void ob_sim_remove(ob_universe *u, uint32_t id);

// Host, paused: makes the object static and massless where it is, as no worker simulates it any more; its neighbours
// wake. false: it does not exist, or does not move anyway.
bool ob_sim_freeze(ob_universe *u, uint32_t id);
// Host, after the workers have left, before anything is restored: lists the objects for which a simulator, or a step,
// failed at "object": those of all islands that were given up, or of its island while islands are solved, else itself alone.
// Writes at most `most` ids; returns how many there are.
uint32_t ob_sim_failed_objects(const ob_universe *u, uint32_t object, uint32_t *ids, uint32_t most);

// Host, at the start and after each pause: opens the first phase. The run then goes on until the next pause step.
void ob_sim_resume(ob_universe *u);

// Host, paused: true if scripts have caused the pause: the host carries out their creations and removals
// (ob_script_requests) before the step goes on.
bool ob_sim_awaits_requests(const ob_universe *u);
// Host, paused before the scripts of a step: the run pauses once they have run, too, even if none is due.
void ob_sim_pause_after_scripts(ob_universe *u, bool wanted);

// Host, paused: returns the reason why the run cannot go on, as one line that holds until the thread's next call; NULL
// if it can. A failed run pauses at once.
const char *ob_sim_failure(const ob_universe *u);
// Host, paused: true if a simulator has written outside its own data: another attempt may succeed.
bool ob_sim_damaged(const ob_universe *u);
// Returns the worker that has caused the damage; UINT32_MAX: unknown.
uint32_t ob_sim_culprit(const ob_universe *u);
// True for a failure without damage that concerns one object, or its island, alone: the run could go on without it.
bool ob_sim_failed_alone(const ob_universe *u, uint32_t *object);

#endif
