// Rows of an island's joints: equality constraints, solved together by sparse elimination (solver/sparse_solver.h).
//
// A row is one number g of the poses of its two ends that must stay 0, with its derivative J by their motions. There are
// four types, each with one case in value_of and one in find_row (joint_rows.c); a kind of joint is a list of them.
//
//   along    n . (p_a - p_b)   n an axis of the second end: the origins part along it
//   across   x . y             x an axis of the first end, y of the second: they lean
//   length   |p_a - p_b| - l   a distance
//   turn     angle             about the z axes of both ends
//
// Forces along a free axis add a row (solver/joint_axis.h) while something holds it, and among contacts another
// one, with the compliance of its spring and damper.
//
// The two axes of a universal, the three of a ball's turns, and its angle, are parts: joints of their own with no rows but
// those of their axis, which follow the joint. Their values are turns:
//
//   arm      about x of the first end, or y of the second, from the other end to the cross
//   twist    a component of the rotation from the second end to the first, in the second's frame
//   angle    the length of that rotation
//
// The elimination needs some compliance, which also makes rows that depend on each other harmless. What it leaves is solved
// for again, so nothing of it is left in the solution.
#ifndef OB_SOLVER_JOINT_ROWS_H
#define OB_SOLVER_JOINT_ROWS_H

#include "solver/solver.h"

// Loads the joints, after the bodies.
void ob_joints_load(ob_solver *s, const ob_island_input *in);
// Finds the ends of all joints and the violation of their rows, at the present poses and this time (s) of the run.
void ob_joints_find(ob_island_work *w, double time);
// Finds the rows of a joint, whose ends have been found.
void ob_joint_find_rows(const ob_island_work *w, ob_held_joint *j);
// Sets the inertias of the bodies that an elimination links.
void ob_joints_set_inertias(const ob_island_work *w, ob_sparse_solver *t);
// Finds the rows of all joints, whose ends have been found, and factors their equations.
void ob_joints_factor(ob_island_work *w);
// Lets go of all axes: nothing acts along them.
void ob_joints_free_axes(ob_island_work *w);
// Finds all joints and factors their equations, at the present poses and this time (s) of the run, with free axes.
void ob_joints_find_free(ob_island_work *w, double time);
// Finds the response of each axis, with all joints, by the factors.
void ob_joints_find_responses(ob_island_work *w);
// Velocity of a row (m/s, rad/s) at the velocities in rows.
double ob_joint_row_velocity(const ob_held_joint *j, uint32_t r, const ob_body_row *rows);
// Adds the response to so much of each row's impulse to the velocities, or to displacements.
void ob_joint_respond(const ob_held_joint *j, const double *impulse, ob_body_row *rows);
// Finds the impulses x that change each row's velocity by its y. They are equal and opposite, so what is left by the
// elimination changes no momentum.
void ob_joints_find_impulses(ob_island_work *w);
// Changes velocities such that each row moves as its target says. Adds the impulses to the joints' sums.
void ob_joints_solve(ob_island_work *w, ob_body_row *rows);
// Adds the joints' share to a change of velocities that contacts make, such that no row moves: the impulses are "share".
void ob_joints_follow(ob_island_work *w, ob_body_row *change);
// Adds so much of this share to the joints' sums, after the velocities have changed by as much.
void ob_joints_add_share(ob_island_work *w, double part);
// Solves the joints on the velocities u that contacts have left; rows of axes change until they are within their bounds.
void ob_joints_iterate(ob_island_work *w);
// Rate (m/s, rad/s) of a joint's axis at the velocities in rows; gives it an impulse (N s, N m s).
double ob_joint_axis_rate(const ob_held_joint *j, const ob_body_row *rows);
void ob_joint_push_axis(ob_held_joint *j, double impulse, ob_body_row *rows);

void ob_joints_finish(ob_joint_set *j);

#endif
