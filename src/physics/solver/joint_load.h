// Loads of joints: the impulses that each has given in the step, and joints that break by them.
//
// A step has parts: flights between two substeps (solver/joints.h), or substeps among contacts. Impulses are noted as they
// are given. At the end of a part each joint has acted with the mean force impulse / time. The joint that exceeds
// its strength most breaks: after flights the part is flown again without it, from its begin; among contacts it holds until
// the part's end. So a joint breaks within a substep of its force, and the others take over its load before they break.
#ifndef OB_SOLVER_JOINT_LOAD_H
#define OB_SOLVER_JOINT_LOAD_H

#include "solver/solver.h"

// Notes so much of the impulse of each row; of one of them.
void ob_joint_note(ob_held_joint *j, const double *impulse);
void ob_joint_note_row(ob_held_joint *j, uint32_t r, double impulse);
// Drops what was noted since the begin of the part, for all joints.
void ob_joint_loads_begin(ob_joint_set *set);
// Keeps what was noted since then; and goes back to that.
void ob_joint_loads_keep(ob_joint_set *set);
void ob_joint_loads_put_back(ob_joint_set *set);
// Finds the joint that exceeds its strength most, by what was noted in a part of h (s). NULL: none does.
ob_held_joint *ob_joint_loads_weakest(ob_joint_set *set, double h);
// Lets it break by that. Rows are to be factored anew.
void ob_joint_break(ob_island_work *w, ob_held_joint *j, double h);
// Adds a part to the step.
void ob_joint_loads_end(ob_joint_set *set);
void ob_joint_loads_report(ob_solver *s);

#endif
