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
// Where there are more contacts than bodies (walls, pyramids, heaps), all of them take part (sim/sparse_solver.h). That
// costs as much as many iterations, so it is tried in two steps of eight, after the iterations, and given up where the
// residual does not halve. It serves rest: an island that it brings to equilibrium need not be solved again
// (sim/equilibrium.h).
//
// Which rows hold follows from the last iteration: normals that press, or are about to (lambda D > r, the active set of
// a semismooth Newton step: Hintermueller, Ito and Kunisch 2003), friction and twist below their bounds. The solution
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
// True where a direct solve is worth its cost, if the last iteration still changed velocities by "residual" m/s; then
// it has to be made. more_iterations: others will follow anyway.
bool ob_direct_wanted(ob_sim *s, double residual, bool more_iterations);
void ob_direct_solve(ob_sim *s);
void ob_direct_finish(ob_direct_solver *f);

#endif
