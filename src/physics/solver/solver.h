// The solver: moves the bodies of one island through one step. It knows bodies, pairs and settings, and no universe, worker
// or rank: a function from what it may read (ob_island_input) to what it reports (ob_island_calls).
//
//                       ob_island_input                                     ob_island_calls
//   step/islands.c      ────────────────>  ob_island_solve (island_solver.c)  ────────────────>  step/islands.c
//   reads the universe   bodies, pairs,                                       motions, contacts,   hands results over
//                        contacts of the step before                          touches, work
//
// Thread-safety: a solver belongs to one thread. The same input gives the same bits on every processor.
#ifndef OB_SOLVER_SOLVER_H
#define OB_SOLVER_SOLVER_H

#include <ob/joint.h>
#include <ob/motion.h>

#include "contact/manifold.h"
#include "settings/settings.h"
#include "solver/island.h"
#include "solver/ode_bodies.h"
#include "table/counters.h"
#include "table/pair_state.h"

// An object that the solver may read: a member of the island, or one that a member may touch.
typedef struct ob_island_object {
	uint32_t id;
	const ob_passport *passport;
	const ob_hull *hull; // NULL: not a hull
	const ob_motion *motion; // published before the step
	ob_state now; // at the step's start
	double path; // m, as ob_motion.path, at the step's start
	ob_vec3 torque; // N m, world, external; members alone
} ob_island_object;

// A pair of which one or both objects are members.
typedef struct ob_island_pair {
	uint32_t pair; // number with which its contact is reported
	uint32_t a, b; // indices of objects
	uint32_t fixed; // index of the one that is no member; OB_NO_FIXED: both are members
	const ob_hull
		*part[2]; // of a and b, those of compounds: the parts that may touch; NULL: their own hulls, if any
	double limit; // m, as ob_pair_key.limit
	bool kept; // its state has been kept, so it is to be reported from now on
	bool newest; // its state was written in the step before
	const ob_pair_state *before; // state at the step's start; NULL: they have never touched
	const double *impulse_b; // impulses on b where each side is solved apart; read only if the solver uses ghosts
} ob_island_pair;

#define OB_NO_FIXED UINT32_MAX

// A joint of which one or both objects are members.
typedef struct ob_island_joint {
	uint32_t number; // with which its load is reported
	const ob_joint_passport *joint;
	uint32_t object[2]; // indices of objects; OB_NO_FIXED: the world
} ob_island_joint;

typedef struct ob_island_input {
	uint64_t step; // number of complete steps
	uint32_t members, objects, pairs, joints;
	// [objects]: the members by ascending id, then the others as the pairs name them
	const ob_island_object *object;
	const ob_island_pair *pair;
	const ob_island_joint *joint; // [joints], in an order that does not depend on the run
	bool feels; // touches are to be reported
} ob_island_input;

// A contact as the solver leaves it. kept: it touches or has touched, so its state is worth keeping.
typedef struct ob_found_contact {
	uint32_t pair; // as ob_island_pair.pair
	uint8_t active, kept, two_sided, reserved; // two_sided: impulse_b is valid
	double limit;
	ob_pair_state state;
	double impulse_b[OB_PAIR_ROWS];
} ob_found_contact;

// Action of a joint on its first object, as ob_joint_load: mean over the step, or over the substep in which it broke.
typedef struct ob_found_joint {
	uint32_t joint; // as ob_island_joint.number
	uint32_t broke; // 1 = it has broken in this step
	ob_vec3 force, torque;
	double along;
} ob_found_joint;

// Reports and requests of the solver while it works.
typedef struct ob_island_calls {
	void *with;
	// Counts work (solver/budget.h). Returns true if no more may be done.
	bool (*spend)(void *with, uint64_t work);
	// From here on, time counts for this section. Called only if "timed" is set.
	void (*enter)(void *with, ob_profile_section section);
	// An attempt to solve the step begins: touches reported before are void.
	void (*attempt)(void *with);
	// Two objects began to touch, at this point (m, world), with so much more of a normal impulse (N s).
	void (*touch)(void *with, uint32_t a, uint32_t b, double impulse, ob_vec3 point);
	// The engine could not move this object: the step fails.
	void (*fail)(void *with, uint32_t object);
	// Results, of the attempt that stands: each contact, each joint, then the motion of each member after the step. free: it
	// touched nothing, so its flight goes on. m->reach is left to the caller.
	void (*contact)(void *with, const ob_found_contact *c);
	void (*joint)(void *with, const ob_found_joint *j);
	void (*motion)(void *with, const ob_island_object *object, ob_motion *m, bool free);
} ob_island_calls;

// Methods of a run, chosen when it begins (solver/methods.h). The solver calls them, and does not ask which they are.
struct ob_solver;
typedef struct ob_methods {
	// Narrow phase of two shapes, as ob_manifold_find.
	void (*find)(struct ob_solver *s, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
	// Loads a pair as the next contacts; the first has its bodies.
	void (*load)(struct ob_solver *s, const ob_island_pair *pair);
	// Shows the motion of each body to its neighbours.
	void (*follow)(struct ob_solver *s);
	// Shows them the velocities (v or u) before an iteration, counted from 0. true: any may have changed.
	bool (*read)(struct ob_solver *s, ob_body_row *rows, uint32_t iteration);
	// Moves a body of the island through the partial substep. smooth: (m/s)^2, squares of larger changes are jumps.
	void (*move)(struct ob_solver *s, uint32_t row, double smooth);
	uint32_t sides; // contacts that a pair of two moving bodies becomes
	bool jacobi; // all contacts are solved on the same state
	bool restless; // bodies may change without being hit
	bool exact; // free motion is in closed form
	bool boxes; // axis-aligned boxes collide, in place of shapes
	bool instants; // hits are solved at their instants: motions are exact, shapes collide, bodies agree on impulses
} ob_methods;

typedef struct ob_solver {
	const ob_run_settings *settings;
	ob_island_calls calls;
	bool timed;
	struct { // solver/budget.h
		uint64_t noted, told; // work; part of it that "spend" knows
		bool spent;
	} budget;
	ob_counters counters;
	ob_methods methods;
	ob_ode_bodies ode_bodies;
	struct { // solver/estimate.h
		struct ob_probe *probe, *finer; // NULL: no estimates are made
	} estimate;
	const ob_island_input *in; // input of the running call
	ob_island_work island; // scratch
} ob_solver;

// Makes a solver in zeroed memory. objects: for how many ODE bodies are kept. Returns false if there is no memory.
bool ob_solver_create(ob_solver *s, const ob_run_settings *settings, const ob_island_calls *calls, uint32_t objects);
void ob_solver_finish(ob_solver *s);

// Solves an island through the coming step, and reports its contacts and motions.
void ob_island_solve(ob_solver *s, const ob_island_input *in);

static inline void ob_solver_enter(ob_solver *s, ob_profile_section section)
{
	if (s->timed)
		s->calls.enter(s->calls.with, section);
}

// True if the substeps of the member were refined (solver/refinement.h) in the step before.
static inline bool ob_is_refined(const ob_island_object *member)
{
	return member->motion->flags & OB_MOTION_REFINED;
}

// True if only joints hold the island's bodies: they fly (solver/joints.h).
static inline bool ob_flies_with_joints(const ob_island_input *in)
{
	return in->joints && !in->pairs;
}

// Gravity and the constant force of the passport (m/s^2); 0 for static objects.
static inline ob_vec3 ob_external_acceleration(const ob_run_settings *run, const ob_passport *p)
{
	return p->mass > 0 ? ob_madd(run->gravity, 1 / p->mass, p->force) : ob_v3(0, 0, 0);
}

#endif
