// Push-apart: corrects penetrations in the positions; the correction never becomes velocity.
//
// If nothing external acts, a push keeps momentum, angular momentum and energy of the two bodies, too. Their
// displacements are equal and opposite, along the normals, but they change the angular momentum of bodies that move
// past each other. One turn of both about their centre of mass gives it back, in which no contact of theirs opens or
// slides. The energy of that turn is exchanged with their relative motion. If that has too little, they stay where they
// are.
#ifndef OB_SOLVER_PUSH_APART_H
#define OB_SOLVER_PUSH_APART_H

#include "solver/solver.h"

// Pushes penetrations beyond ob_solver_slop apart, at the partial substep's end: changes d and, where nothing external
// acts, poses and v.
void ob_push_apart(ob_solver *s);

#endif
