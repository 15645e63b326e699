// Groups of a free run: sets of bodies that no body outside can touch before a horizon, whatever happens to either.
//
//   reach of a body   ball about its centre, at its own time, that holds it until the horizon:
//                     radius + (N t + A t^2 / 2) / sqrt(mass)
//   N^2 = 2 kinetic energy of its group: impacts within the group, and on what stands still, never raise it;
//   A = norm of the external forces, likewise: d N / dt <= A
//
// Groups are the finest sets in which balls of different groups do not overlap. Proof that none touches another before the
// horizon: at the first instant at which two would, each has been moved by its own members until then, so each body is in its
// ball, and balls of two groups are apart. An own time behind has a longer way to the horizon. Bodies that are at the horizon or
// beyond were groups of their own when they went there, with balls that held what is known now: they are left out.
//
// All bodies are one group where something may raise the energy, as moving surfaces do.
//
// Thread-safety: each worker has its own.
#ifndef OB_FREE_GROUPS_H
#define OB_FREE_GROUPS_H

#include "table/group.h"

// The part of a body that the search of groups needs.
typedef struct ob_group_ball {
	double at[3], reach; // m, centre at its own time; radius of the ball
	float bounds[6];
	uint32_t parent; // index; its own: it stands for its group
	bool grown; // since it was tested
} ob_group_ball;
static_assert(sizeof(ob_group_ball) == 64, "a cache line");

typedef struct ob_group_body {
	uint32_t id, step; // own time, in steps
	ob_group_place place;
	uint64_t version; // of the motion, as read
	ob_motion motion;
	double radius, mass, norm2, pull2; // m, kg, J twice, N^2 / kg
	double half[3]; // m, of a box about its centre that holds its ball and its fat AABB
	int32_t cell[3]; // of the grid
	// Properties of the group for which it stands:
	double group_norm2, group_pull2;
	uint32_t least; // own time of all, steps
	bool mine, even; // some are this worker's; all are at the step
	uint32_t other; // another worker that has one of them; OB_NO_WORKER: none
	const struct ob_group_body *behind; // one that is behind; NULL: none
} ob_group_body;

typedef struct ob_groups {
	ob_universe *u;
	ob_group_body *body; // [n] ascending by id
	ob_group_ball *ball; // [n]
	uint32_t *order; // [n] indices, of those considered first
	uint32_t n, considered;
	uint32_t *head, *next, buckets; // grid: [buckets], [n] links: 1 + index; 0 = end
	uint32_t large; // link to those that exceed a cell
	double half[3]; // m, of a cell
	uint32_t count; // groups
	bool alone; // a group of the worker's bodies may hold no other's, nor one at another step
	bool barred; // one does, or holds one that is behind: the search has ended there
	const ob_group_body *behind; // that one; NULL: none is
	bool joined; // any, in a round
	bool one; // energy may be gained: all bodies are one group
} ob_groups;

// Lists the bodies that move; again whenever objects come or go. false: no memory.
bool ob_groups_list(ob_groups *g, ob_universe *u);
void ob_groups_finish(ob_groups *g);
// Finds groups of the bodies whose own times are before `horizon` (steps), until then, as a worker at `step` sees them. Ends as soon as
// one of the worker's bodies cannot make its step, or, where the horizon is several steps away, cannot make all of them alone.
void ob_groups_find(ob_groups *g, uint32_t worker, uint32_t step, uint32_t horizon);
// True if the search has ended at a body that was behind, and is where it was.
bool ob_groups_are_barred(const ob_groups *g);
// Index of the body that stands for the group of one: its lowest id.
uint32_t ob_groups_root(ob_groups *g, uint32_t i);

#endif
