// Solver for a contact of a body that touches nothing else, with a static or kinematic one: solves it to the end at
// once. The law is that of an isolated lane of a batch (contact/batch.h), with the same limit surface
// (contact/patch.h). Here the four points lie side by side in place of four pairs. So a sweep over the rows, a step of
// Newton's method and the four edges of a patch are a few vector operations each.
//
// The path buys 16 % of a sparse scene: without it, scenes/sparse.lua takes 1.16 times the CPU.
//
// A sweep finds the points under load, and whether friction holds. Then a step of Newton's method makes all their rows
// obey the law. Sliding friction follows the load: it grows with the sum, turns with the slip, and moves with the
// centre of pressure. The step does not include the change of the loaded part's shape; an extrapolation from two rounds
// does (Anderson 1965, of depth one).
//
// Part of the kernels (contact/kernel.h): compiled once for each instruction set, with no operations contracted, under
// the name OB_SOLVE_LONE.
#ifndef OB_CONTACT_LONE_H
#define OB_CONTACT_LONE_H

#include "contact/batch.h"

// As ob_kernel.solve_lone.
void OB_SOLVE_LONE(ob_batch *b, int l, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		   const ob_body_row *d);

#endif
