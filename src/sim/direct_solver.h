// The direct solve of an island's contacts, where iterations over its pairs would take too long.
//
// An iteration carries an impulse one pair further; n bodies on top of each other need about n^2 iterations, a load of
// n times its carrier's mass about as many. Where an island stands, all its contacts that hold are solved at once.
// Where they form trees on fixed bodies, that costs no more than some iterations (sim/tree_solver.h):
//
//        [3]                 breadth-first from the fixed bodies: 1 is a root (its
//        [2]    [5]          contact is an anchor), 2 is a child of 1, 3 of 2; 4 is a
//        [1]    [4]          root, 5 a child of 4. A contact that closes a cycle keeps
//      ==============        its impulses, which this solve takes as given.
//
// Where there are more contacts than bodies (walls, pyramids, towers of planks), all of them take part
// (sim/sparse_solver.h), after the iterations, in islands that have come to rest or do not move yet. There the solution
// has to be found to the end: each contact's error adds to a sway of the whole, in which no contact has a residual that
// an iteration would see, and a tower of planks of 16 layers creeps on what iterations leave. So direct solves go on
// for as long as they lead down; where one does not, conjugate iterations (sim/conjugate.h) bring the impulses nearer.
// While anything sways from a hit, there is no equilibrium to be found, and iterations do.
//
// Which rows hold follows from the last iteration: normals that press, or are about to (lambda D > r, the active set of
// a semismooth Newton step: Hintermueller, Ito and Kunisch 2003), those that neither press nor open (before the first
// impulses nothing presses, and what stands holds everywhere), friction and twist within their bounds. The solution
// for these rows is a direction: the impulses go along it, projected on the cones, as far as the residual energy
// x r + x A x / 2 falls (projected Newton: Bertsekas 1982). Iterations and direct solves take turns, as in the
// projected Gauss-Seidel method with subspace minimisation (Silcowitz, Niebe and Erleben 2010).
//
// Everything is a function of the island's published state: the same bits whoever solves it.
#ifndef OB_SIM_DIRECT_SOLVER_H
#define OB_SIM_DIRECT_SOLVER_H

#include "sim/state.h"

// Before the first substep of an island.
void ob_direct_begin(ob_direct_solver *f);
// Before the iterations of a partial substep.
void ob_direct_begin_partial(ob_direct_solver *f);
// True where a direct solve of trees is worth its cost, if the last iteration still changed velocities by "residual"
// m/s; then it has to be made.
bool ob_direct_wanted(ob_sim *s, double residual);
// True where the island stands, closes cycles, and is to be solved to the end.
bool ob_direct_settles(ob_sim *s, double residual);
// false: the solution does not lead down, or would cost too much; nothing has changed.
bool ob_direct_solve(ob_sim *s);
void ob_direct_finish(ob_direct_solver *f);

#endif
