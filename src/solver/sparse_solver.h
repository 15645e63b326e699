// The direct solve of bodies whose joints close cycles (walls, pyramids, heaps): the same equations as in
// solver/tree_solver.h, with the impulses eliminated first. The remaining matrix has one 6 x 6 block for each body and for
// each two bodies that share a joint,
//
//      (M + J^T e^-1 J) dv = J^T e^-1 y,      x = e^-1 (y - J dv)
//
// positive definite, and sparse. It is factored by block Cholesky elimination, the body with the fewest remaining
// neighbours first (Tinney and Walker 1967; George and Liu 1989). Eliminating a body links all its neighbours:
//
//        o───o───o             o───o───o         The cost is the sum of squares of the numbers of neighbours. It
//        │   │   │      ──>    │ ╱ │   │         is known before any arithmetic is done; if it is too high,
//        x───o───o               ──o───o         as in thick heaps, there is no solve.
#ifndef OB_SOLVER_SPARSE_SOLVER_H
#define OB_SOLVER_SPARSE_SOLVER_H

#include <stdbool.h>
#include <stdint.h>

#include "solver/tree_solver.h"

enum { OB_SPARSE_FIXED = UINT32_MAX }; // a parent that does not move

typedef double ob_sparse_block[6][6];

// Memory grown as needed, never shrunk. Bodies have numbers from 0.
typedef struct ob_sparse_solver {
	uint32_t bodies, bodies_max, words; // 64 bodies to a word
	uint64_t *adjacent; // [body][words]: bit per neighbour that is not eliminated yet
	uint32_t *order, *place; // bodies in the order of elimination; [body]: its place in it
	uint32_t *first; // [bodies + 1], by place in the order: range in below
	uint32_t below_max, *below; // neighbours that remain when a body is eliminated
	uint32_t *at; // [body][body]: block of the pair
	uint32_t blocks_max;
	ob_sparse_block *block; // one for each entry of below: the neighbour's rows, the eliminated body's columns
	ob_sparse_block *own; // [body]
	double (*inverse)[6]; // [body]: inverses of its factor's diagonal
	double (*change)[6]; // [body]: the right-hand side, then dv
} ob_sparse_solver;

void ob_sparse_begin(ob_sparse_solver *t, uint32_t bodies);
void ob_sparse_link(ob_sparse_solver *t, uint32_t child, uint32_t parent);
// Plans the elimination, after the links. false: the solve would cost more than "most" block products for each body.
bool ob_sparse_analyse(ob_sparse_solver *t, uint32_t most);
void ob_sparse_add_inertia(ob_sparse_solver *t, uint32_t body, double m[6][8]);
void ob_sparse_add_joint(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent);
void ob_sparse_solve(ob_sparse_solver *t);
// Sets the joint's impulses.
void ob_sparse_joint_impulses(const ob_sparse_solver *t, ob_joint *j, uint32_t child, uint32_t parent);
void ob_sparse_finish(ob_sparse_solver *t);

#endif
