// The direct solve of an island's contacts, where exchanges from pair to pair would take too long.
//
// Exchanges carry an impulse one pair further per round; n bodies on top of each other need about n^2 rounds, a load
// of n times its carrier's mass about as many. Where an island stands, all its contacts that hold are solved at once.
// Where they form a forest on fixed bodies, that costs no more than some rounds (sim/articulated.h):
//
//        [3]                 breadth-first from the fixed bodies: 1 is a root (its
//        [2]    [5]          contact is an anchor), 2 hangs on 1, 3 on 2; 4 is a
//        [1]    [4]          root, 5 hangs on 4. A contact that closes a cycle stays
//      ==============        as it is: what it gives is a given of this solve.
//
// Where there are more contacts than bodies (walls, pyramids, heaps), all of them take part (sim/truss.h). That costs
// as much as many rounds, so it is tried in two steps of eight, after the rounds, and given up where the residual does
// not halve. What it is for is rest: an island that it brings to equilibrium need not be solved again (sim/calm.h).
//
// Which rows hold is read off the last round: normals that press, or are about to (lambda D > r, the active set of a
// semismooth Newton step: Hintermueller, Ito and Kunisch 2003), friction and twist below their bounds. The solution
// for these rows is a direction: the impulses go along it, projected on the cones, as far as the residual energy
// x r + x A x / 2 falls (projected Newton: Bertsekas 1982). Rounds and solves take turns, as in the projected
// Gauss-Seidel method with subspace minimisation (Silcowitz, Niebe and Erleben 2010).
//
// Everything is a function of the island's published state: the same bits whoever solves it.
#ifndef OB_SIM_FOREST_H
#define OB_SIM_FOREST_H

#include <stdbool.h>
#include <stdint.h>

#include "contact/batch.h"
#include "sim/articulated.h"
#include "sim/truss.h"

// A contact that takes part. parent: row of a fixed body if it is an anchor.
typedef struct ob_direct_contact {
	uint32_t touch, child, parent;
	uint8_t row[OB_JOINT_ROWS]; // of the batch, for each row of the joint
	ob_joint joint;
} ob_direct_contact;

// Working state of one island's step; memory grown as needed, never shrunk.
typedef struct ob_direct_solver {
	enum {
		OB_DIRECT_UNKNOWN,
		OB_DIRECT_UNFIT,
		OB_DIRECT_FOREST,
		OB_DIRECT_CYCLIC
	} fit; // for the running stride: stands still, has no cycles, or has some
	bool recent; // the last substep was solved directly
	bool hopeless; // a solve of this step led nowhere
	int solved; // times in the running stride
	double left[2]; // m/s, before the last solve and the one before: the most that a round changed
	uint32_t rows_max, contacts_max, batches_max;
	ob_link *link; // [row]
	uint32_t *order; // rows, parents before children
	uint32_t *up; // [row]: its contact
	uint32_t contacts;
	ob_direct_contact *contact;
	ob_sparse_solver truss;
	lanes (*rate)[OB_ROWS], (*change)[OB_ROWS]; // [batch]: residual velocities; changes of impulses
} ob_direct_solver;

struct ob_sim;
struct ob_island_work;

// Before the first substep of an island.
void ob_direct_begin(ob_direct_solver *f);
// Before the rounds of a stride.
void ob_direct_begin_partial(ob_direct_solver *f);
// Is a direct solve worth while, if the last round still changed velocities by "left" m/s? If so, it has to be made.
bool ob_direct_wanted(struct ob_sim *s, double left, bool rounds_go_on);
void ob_direct_solve(struct ob_sim *s);
void ob_direct_finish(ob_direct_solver *f);

#endif
