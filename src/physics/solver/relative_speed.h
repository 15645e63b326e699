// Relative speed of two bodies: the same in every frame of reference. Motion along a plane does not count, for a plane
// is the same everywhere.
#ifndef OB_SOLVER_RELATIVE_SPEED_H
#define OB_SOLVER_RELATIVE_SPEED_H

#include "solver/island.h"

// Speed, m/s, at which the centres come nearer or part, without rotation. v: a's velocity less b's; ra, rb: attitudes.
double ob_relative_speed(ob_shape a, const ob_mat3 *ra, ob_shape b, const ob_mat3 *rb, ob_vec3 v);
// Velocity, m/s, of a's centre less that of b's; for a surface that turns, taken at the centre of the other body.
ob_vec3 ob_contact_velocity(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact);
// Bound, m/s, of the speed at which the two surfaces come nearer or part, and the gaps of their contact change. A round
// body's spin about its axis moves no surface; it counts as far as it moves points fixed to the body.
double ob_contact_speed(const ob_island_work *w, const ob_contact *contact);
// Rate, rad/s, of rotations that change the contact's geometry, at the velocities in rows; 0 for spheres.
double ob_contact_turn_rate(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact);
// Lever, m: displacement along the normal n, per rad of spin about the body's axis, of contact points fixed to the
// body. 0 where n goes through the axis at each of them, as where a round body rolls. arm: m, from its centre.
double ob_spin_lever(const ob_body *body, ob_vec3 n, const ob_vec3 *arm, uint32_t points);

// Bounds the speed (m/s) that rotation adds to an object's surface within s seconds, from the angular velocity w
// (rad/s, body frame). 0 for spheres, without rotation, and for a round body that spins about its axis.
double ob_turning_speed(ob_shape shape, ob_vec3 size, ob_vec3 inertia, ob_vec3 w, double s);

#endif
