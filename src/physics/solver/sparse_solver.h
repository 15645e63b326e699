// Direct solve of bodies that joints connect, in trees and in cycles: finds the impulses that bring the joints'
// velocities to their targets.
//
// A joint is up to seven rows between a child and its parent: J_c v_c + J_p v_p is the speed at which they open or
// slide. These velocities are to change by y. The impulses x act on both bodies alike, each row softened by a tiny
// compliance e, which makes the answer unique where rows are redundant:
//
//      J_c dv_c + J_p dv_p + e x = y      for each joint,      M dv = sum of J^T x      for each body.
//
// The impulses are eliminated first. The remaining matrix has one 6 x 6 block for each body and for each two bodies that
// share a joint,
//
//      (M + J^T e^-1 J) dv = J^T e^-1 y,      x = e^-1 (y - J dv)
//
// positive definite, and sparse. It is factored by block Cholesky elimination, the body with the fewest remaining
// neighbours first (Tinney and Walker 1967; George and Liu 1989). Eliminating a body links all its neighbours:
//
//        o───o───o             o───o───o         The cost is the sum of squares of the numbers of neighbours. It
//        │   │   │      ──>    │ ╱ │   │         is known before any arithmetic is done; if it is too high,
//        x───o───o               ──o───o         as in thick heaps, there is no solve.
//
// A leaf links nothing: it adds to its parent's block the inertia of an articulated body (Featherstone 1983), and the
// parent becomes a leaf itself. So trees take time and memory linear in the number of bodies.
#ifndef OB_SOLVER_SPARSE_SOLVER_H
#define OB_SOLVER_SPARSE_SOLVER_H

#include <stdbool.h>
#include <stdint.h>

enum { OB_SPARSE_FIXED = UINT32_MAX }; // a parent that does not move
enum { OB_JOINT_ROWS = 7 };

typedef struct ob_joint {
	uint32_t rows;
	double child[OB_JOINT_ROWS][6], parent[OB_JOINT_ROWS][6]; // J_c, J_p
	double y[OB_JOINT_ROWS]; // m/s, rad/s
	double stiffness[OB_JOINT_ROWS]; // e^-1
	double x[OB_JOINT_ROWS]; // impulses
} ob_joint;

typedef double ob_sparse_block[6][6];

// A body in the graph of joints.
typedef struct ob_sparse_node {
	uint32_t edges, degree; // its first edge; number of neighbours that are not eliminated yet
	uint32_t next, previous; // bodies of the same degree
	uint32_t place; // in the order of elimination; UINT32_MAX: not eliminated yet
	uint32_t mark; // scratch
	bool linked; // a joint has it
} ob_sparse_node;

// Edge from a body to a neighbour, which may have been eliminated since.
typedef struct ob_sparse_edge {
	uint32_t to, next;
} ob_sparse_edge;

// Memory grown as needed, never shrunk. Bodies have numbers from 0.
typedef struct ob_sparse_solver {
	uint32_t bodies, bodies_max;
	uint32_t unlinked; // bodies without a joint: first in the order, and left alone
	ob_sparse_node *node; // [body]
	uint32_t *least; // [degree]: first body of this degree
	uint32_t edges, edges_max;
	ob_sparse_edge *edge;
	uint32_t *order; // bodies in the order of elimination
	uint32_t *first; // [bodies + 1], by place in the order: range in below
	uint32_t below_max, *below; // neighbours that remain when a body is eliminated
	uint32_t blocks_max;
	ob_sparse_block *block; // one for each entry of below: the eliminated body's rows, the neighbour's columns
	ob_sparse_block *own; // [body]
	double (*inverse)[6]; // [body]: inverses of its factor's diagonal
	double (*change)[6]; // [body]: the right-hand side, then dv
	ob_sparse_block *response, *between; // [body], [block]: the inverse, where the factors have blocks
	ob_sparse_block *shares; // [block]: scratch
	uint32_t response_max, between_max;
} ob_sparse_solver;

void ob_sparse_begin(ob_sparse_solver *t, uint32_t bodies);
// Names a joint. Bodies that no joint links take no part.
void ob_sparse_link(ob_sparse_solver *t, uint32_t child, uint32_t parent);
// Plans the elimination, after the links. false: the solve would cost more than "most" block products for each body.
bool ob_sparse_analyse(ob_sparse_solver *t, uint32_t most);
// True if a joint links the body: it needs an inertia.
static inline bool ob_sparse_is_linked(const ob_sparse_solver *t, uint32_t body)
{
	return t->node[body].linked;
}
// Sets the body's inertia.
void ob_sparse_set_inertia(ob_sparse_solver *t, uint32_t body, double (*m)[6]);
void ob_sparse_add_joint(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent);
// For several right-hand sides of the same joints. Clear, then set inertias and add joints; factor; then for each side
// begin it, push with the joints' y, and substitute.
void ob_sparse_clear(ob_sparse_solver *t);
void ob_sparse_factor(ob_sparse_solver *t);
void ob_sparse_begin_side(ob_sparse_solver *t);
void ob_sparse_push(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent);
void ob_sparse_substitute(ob_sparse_solver *t);
// Sets the joint's impulses.
void ob_sparse_joint_impulses(const ob_sparse_solver *t, ob_joint *j, uint32_t child, uint32_t parent);
// After ob_sparse_factor: finds the blocks of the inverse that the matrix and its factors have, from the last eliminated body
// to the first (Takahashi, Fagan and Chen 1973). Trees take linear time.
void ob_sparse_invert(ob_sparse_solver *t);
// After that: velocity of a row of a joint of these two bodies by its own unit impulse.
double ob_sparse_response(const ob_sparse_solver *t, const double *of_child, const double *of_parent, uint32_t child,
			  uint32_t parent);
void ob_sparse_finish(ob_sparse_solver *t);

#endif
