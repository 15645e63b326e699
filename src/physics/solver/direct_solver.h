// Direct solve of an island's contacts, for cases in which iterations over its pairs would take too long.
//
// An iteration carries an impulse one pair further: a stack of n bodies takes about n^2 iterations, a load of n times
// its carrier's mass about as many. In an island that stands, all contacts that hold are solved at once, by elimination
// (solver/sparse_solver.h). There are two cases, with limits of their own:
//
//        [3]               trees: contacts and bodies are as many, at most. Bodies are
//        [2]    [5]        eliminated from leaf to root, which costs no more than some
//        [1]    [4]        iterations. Solves take turns with iterations while bodies
//      ==============      stand, as soon as these leave a residual.
//
//           [4]            cycles (walls, pyramids, towers of planks): there are more contacts
//        [1][2][3]         than bodies. Solved after the iterations, in islands at rest, not
//      ==============      yet moved, or stacked high.
//
// The solution of cycles must be found to the end. Each contact's error adds to a sway of the whole, in which no contact
// has a residual that an iteration would see: a tower of planks of 16 layers creeps by what iterations leave. So direct
// solves are repeated while they reduce the residual; when one does not, conjugate iterations (solver/conjugate.h) bring
// the impulses nearer. An island is stacked high if more than half as many contacts as a partial substep has iterations
// lead from what stands to one of its bodies: no impulse gets down from there and back. Iterations would keep a tower that
// lands swaying for ever, as deeper points on one side let it lean on; so it is solved so while it lands. In other islands
// that move, no equilibrium exists, and iterations are used.
//
// The last iteration shows which rows hold. Normals hold that press, or are about to (lambda D > r, the active set of a
// semismooth Newton step: Hintermueller, Ito and Kunisch 2003). Normals hold, too, that neither press nor open: before
// the first impulses nothing presses, and a standing body holds everywhere. Friction and twist hold within their
// bounds. The solution for these rows is a direction: the impulses move along it, projected on the cones, as far as the
// residual energy x r + x A x / 2 falls (projected Newton: Bertsekas 1982). Iterations and direct solves alternate, as
// in the projected Gauss-Seidel method with subspace minimisation (Silcowitz, Niebe and Erleben 2010).
//
// Four points of a contact, and four contacts of a plank, share a load in many ways. Iterations leave it uneven, and a step
// from there makes points pull, which the cones forbid: no share of it helps. Then the island is solved again as if it had no
// impulses yet. That solution is the shortest one, so the load is even. Points that pull are left out, and those that close
// come back, until neither is left (primal-dual active set: Hintermueller, Ito and Kunisch 2003). Friction that slides keeps
// its impulse: a plank on rollers would swing by 6 % too far.
//
// The rows' compliance hides what is softer: the sway of a tower is soft by the square of its height over its width. The
// next solve takes the rest, by a share that falls with the compliance.
//
// The result is a function of the island's published state: every worker finds the same bits.
#ifndef OB_SOLVER_DIRECT_SOLVER_H
#define OB_SOLVER_DIRECT_SOLVER_H

#include "solver/solver.h"

// Resets the solver before the first substep of an island.
void ob_direct_begin(ob_direct_solver *f);
// Resets it before the iterations of a partial substep.
void ob_direct_begin_partial(ob_direct_solver *f);
// True if no bodies slide or fall against each other faster than .02 m/s, and no joint is driven.
bool ob_direct_stands(const ob_island_work *w);
// True if a direct solve of trees is worth its cost after an iteration that still changed velocities by "residual"
// (m/s). Then the caller must make it.
bool ob_direct_wanted(ob_solver *s, double residual);
// True if the island stands, its contacts close cycles, and it has to be solved to the end. residual: m/s.
bool ob_direct_settles(ob_solver *s, double residual);
// Solves, and moves impulses and u along the solution. Returns false, with nothing changed, if the solution does not
// reduce the residual, or would cost too much.
bool ob_direct_solve(ob_solver *s);
void ob_direct_finish(ob_direct_solver *f);

#endif
