// What is left of penetrations is pushed out of the positions, and never becomes velocity.
//
// Where nothing external acts, a push keeps momentum, angular momentum and energy of the two bodies, too. Their
// displacements are equal and opposite, along the normals, but bodies that move past each other have another angular
// momentum in another place. What it changes is given back by one turn of both about their centre of mass, in which no
// contact of theirs opens or slides; the energy that this brings or takes is that of their motion against each other.
// Where that has too little to give, they stay where they are.
#ifndef OB_SIM_PUSH_APART_H
#define OB_SIM_PUSH_APART_H

#include "sim/state.h"

// Pushes penetrations beyond ob_solver_slop apart, at the partial substep's end: in d, and where nothing external acts
// in the poses and in v.
void ob_push_apart(ob_sim *s);

#endif
