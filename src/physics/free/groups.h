// Groups of a free run: sets of bodies that no body outside can touch before a horizon, whatever happens to either.
//
//   reach of a body   ball about its centre, at its own time, that holds it until the horizon:
//                     radius + (N t + A t^2 / 2) / sqrt(mass)
//   N^2 = 2 kinetic energy of its group: impacts within the group, and on what stands still, never raise it;
//   A = norm of the external forces, likewise: d N / dt <= A
//
// Groups are the finest sets in which balls of different groups do not overlap. Proof that none touches another before the
// horizon: at the first instant at which two would, each has been moved by its own members until then, so each body is in its
// ball, and balls of two groups are apart. An own time behind has a longer way to the horizon. Bodies ahead were groups of
// their own when they went there, with balls that held what is known now: they are left out.
//
// All bodies are one group where something may raise the energy, as moving surfaces do.
//
// Thread-safety: each worker has its own.
#ifndef OB_FREE_GROUPS_H
#define OB_FREE_GROUPS_H

#include "table/group.h"

typedef struct ob_group_body {
	uint32_t id, step; // own time, in steps
	ob_group_place place;
	uint64_t version; // of the motion, as read
	ob_motion motion;
	float bounds[6];
	ob_vec3 p; // m, centre at its own time
	double radius, mass, norm2, pull2; // m, kg, J twice, N^2 / kg
	double reach; // m
	uint32_t parent; // index; its own: it stands for its group
	// Properties of the group for which it stands:
	double group_norm2, group_pull2;
	uint32_t least; // own time of all, steps
	bool mine; // some are this worker's
	uint32_t other, behind; // another worker that has one of them, or one that is behind; OB_NO_WORKER: none
} ob_group_body;

typedef struct ob_groups {
	ob_universe *u;
	ob_group_body *body; // [n] ascending by id
	uint32_t *order; // [n] indices of those considered, ascending by the low end of their balls along x
	uint32_t n, considered;
	bool one; // energy may be gained: all bodies are one group
} ob_groups;

// Lists the bodies that move; again whenever objects come or go. false: no memory.
bool ob_groups_list(ob_groups *g, ob_universe *u);
void ob_groups_finish(ob_groups *g);
// Finds groups of the bodies whose own times are at most `step`, until `horizon` (steps), as a worker sees them.
void ob_groups_find(ob_groups *g, uint32_t worker, uint32_t step, uint32_t horizon);
// Index of the body that stands for the group of one: its lowest id.
uint32_t ob_groups_root(ob_groups *g, uint32_t i);

#endif
