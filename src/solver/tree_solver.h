// The direct solve of a tree of bodies: finds the impulses that bring the joints' velocities to their targets.
//
// A joint is up to seven rows between a child and its parent: J_c v_c + J_p v_p is the speed at which they open or
// slide. These velocities are to change by y. The impulses x act on both bodies alike, each row softened by a tiny
// compliance e, which makes the answer unique where rows are redundant:
//
//                                                            J_c dv_c + J_p dv_p + e x = y      for each joint
//        root      M dv = p + sum of J^T x                                                      for each body
//       /    \   .
//      o      o    Leaf by leaf a body's unknowns are eliminated. The resistance of a leaf and its joint is added to
//     / \      \   the parent's inertia and push, and the parent becomes a leaf itself:
//    o   o      o
//   leaves              M_p += Z^T Z,  p_p += Z^T z   with  S = J_c M_c^-1 J_c^T + e = L L^T,
//                                                           Z = L^-1 J_p,  z = L^-1 (y - J_c M_c^-1 p_c)
//
// and back from the root: x = L^-T (z - Z dv_p), dv_c = M_c^-1 (p_c + J_c^T x). The inertia that gathers in a body is
// Featherstone's articulated-body inertia (1983); with multipliers for the joints the same elimination is Baraff's
// (1996). The cost is linear in the number of bodies.
#ifndef OB_SOLVER_TREE_SOLVER_H
#define OB_SOLVER_TREE_SOLVER_H

#include <stdint.h>

enum { OB_JOINT_ROWS = 7 };

// A body. Columns 0..5 of m: its inertia with that of eliminated children; column 6: the push on it.
typedef struct ob_link {
	double m[6][8];
	double root[6][6], inverse[6]; // Cholesky factor, inverse of its diagonal
	double change[6]; // dv
} ob_link;

// A joint. The child's matrix has a spare column: its eighth holds the child's push while sums over columns are made.
typedef struct ob_joint {
	uint32_t rows;
	double child[6][8]; // J_c^T, then its image under the inverse root of the child's inertia
	double parent[OB_JOINT_ROWS][8]; // J_p and, in column 6, y; then Z and z
	double compliance[OB_JOINT_ROWS];
	double root[OB_JOINT_ROWS][8], inverse[OB_JOINT_ROWS]; // L, inverse of its diagonal
	double x[OB_JOINT_ROWS]; // impulses
} ob_joint;

// Adds a joint to something that does not move to the body.
void ob_link_anchor(ob_link *child, const ob_joint *j);
// Eliminates a body that has no children left. No joint and no parent at the root.
void ob_link_eliminate(ob_link *child, ob_joint *j, ob_link *parent);
// Substitutes back, once the parent's change is known.
void ob_link_substitute(ob_link *child, ob_joint *j, const ob_link *parent);
// Sets the impulses of an anchor, once its body's change is known.
void ob_link_anchor_impulses(const ob_link *child, ob_joint *j);

#endif
