// The object simulators that one worker runs, and the step.
//
// A worker is a thread or a process; it does not know which. All state that outlives a step lies in the
// universe, so any worker can run any object. An ob_sim is the worker's private side: scratch memory, and ODE bodies
// of some of the objects that it has run.
#ifndef OB_SIM_SIM_H
#define OB_SIM_SIM_H

#include <ob/motion.h>

#include "motion/path.h"
#include "table/table.h"

typedef struct ob_sim ob_sim;

ob_sim *ob_sim_create(ob_universe *u, uint32_t worker, ob_error *e); // in the worker's own thread
void ob_sim_destroy(ob_sim *s);

// How a worker runs the script of an object, which this module does not know: what is known of it (table/script_data.h), in
// the universe or in a copy. Gives how many instructions it took, the same whoever runs it.
typedef uint64_t (*ob_script_run)(void *runner, ob_script_turn *turn, ob_script_cell *cell);
void ob_sim_set_scripts(ob_sim *s, ob_script_run run, void *runner);

// How the arranger of a rank reaches the others (peers.h): gathers what each has to say, n bytes of it here, in the order of
// ranks; at: where each begins, and the end. NULL: no memory.
typedef struct ob_peers {
	uint32_t rank, ranks;
	const char *(*gather)(void *wire, const void *mine, size_t n, const size_t **at);
	// Likewise what each has to say to this one; mine[r], bytes[r] of it, to rank r
	const char *(*deal)(void *wire, const void *const *mine, const size_t *bytes, const size_t **at);
	void *wire;
	bool parted; // one has left, and all know it
	uint64_t look; // the first step at which some rank is to have all motions (halo.h), as all ranks know it
	uint32_t islands; // of all ranks, when those of a step are solved
	uint64_t move; // that rank 0 was asked for, as table/home.h, to be made before the next step's islands are built
} ob_peers;
// Of the arranger, before its first step: false and e, on all ranks, where one of them has other workers, objects or
// settings, or computes other bits.
bool ob_sim_join(ob_sim *s, const ob_peers *p, ob_error *e);
// When its run is over: tells those that may be waiting for it.
void ob_sim_leave(ob_sim *s);

// The worker takes part in one phase of the step (step.c shows them all): it waits at the gate until one opens to it,
// does its share and arrives; the last worker to arrive schedules the next phase, or the pause. false: STOP.
bool ob_step(ob_sim *s);
// The whole life of a worker: ob_step until STOP. Returns when the run is over.
void ob_sim_run(ob_sim *s);

// Host, before the first step and after it has changed passports: puts the object's first motion into its slot and the
// object on the broad phase's requery list. The universe must be starting or paused.
void ob_sim_place(ob_universe *u, uint32_t id, const ob_state *state);

// Host, before the first step and at a pause, after ob_sim_place: what a kinematic object does from now on. path NULL:
// it goes on as it was placed; born: the step of its first instant. Returns the step at which it must be called again,
// at a pause, for what it has published holds no longer; UINT64_MAX: never. To call it at other steps, too, changes nothing.
uint64_t ob_sim_prescribe(ob_universe *u, uint32_t id, const ob_path *path, uint64_t born);

// Host, at a pause: this constant force (N) acts on a dynamic object from now on. changes: another one has acted until now,
// and if the object rests, it wakes. Its passport does not tell: after a restart it is that of a later step.
void ob_sim_push(ob_universe *u, uint32_t id, ob_vec3 force, bool changes);

// Host, at the start, after ob_universe_load: what is not saved, and follows from what is: the spatial index, lists of pairs and
// calendars (sim/pairs.h).
void ob_sim_restore(ob_universe *u);

// Host, paused: takes an object away; its neighbours wake. Clears its passport.
void ob_sim_remove(ob_universe *u, uint32_t id);

// Host, paused: the object stays where it is from now on, static and without mass, for nobody simulates it any more; its
// neighbours wake. false: it is not there, or does not move anyway.
bool ob_sim_freeze(ob_universe *u, uint32_t id);
// Host, after the workers have left, before anything is put back: the objects in whose name a simulator failed that was
// busy with "object", or a step that failed because of it: its island's while islands are solved, else itself alone. At
// most so many ids; returns how many there are.
uint32_t ob_sim_failed_objects(const ob_universe *u, uint32_t object, uint32_t *ids, uint32_t most);

// Host, at the start and after each pause: opens the first phase. The run then goes on until the next pause step.
void ob_sim_resume(ob_universe *u);

// Host, paused: whether the pause is that of scripts, whose creations and removals (ob_script_requests) it is to carry
// out before it goes on with the step.
bool ob_sim_awaits_requests(const ob_universe *u);

// Host, paused: why the run cannot go on, as one line, which holds until the thread's next call; NULL if it
// can. A failed run pauses at once.
const char *ob_sim_failure(const ob_universe *u);
// Host, paused: whether that is because a simulator has written where it should not: another attempt may do better.
bool ob_sim_damaged(const ob_universe *u);
// Of damage: the worker that has done it; UINT32_MAX: it is not known.
uint32_t ob_sim_culprit(const ob_universe *u);
// Of a failure that is no damage: whether it is this object's, or its island's, so that the run could go on without.
bool ob_sim_failed_alone(const ob_universe *u, uint32_t *object);

#endif
