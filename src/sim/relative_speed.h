// How fast two bodies move, one against the other: the same in every frame of reference. What goes along a plane does
// not count, for a plane is the same everywhere.
#ifndef OB_SIM_RELATIVE_SPEED_H
#define OB_SIM_RELATIVE_SPEED_H

#include "sim/island.h"

// A capsule or a cylinder: it looks the same however it has spun about its axis, z of its frame.
static inline bool ob_has_axis(ob_shape s)
{
	return s == OB_SHAPE_CAPSULE || s == OB_SHAPE_CYLINDER;
}

// m/s: at v, one's velocity less the other's, how fast they come nearer or part, but for turning. ra, rb: their
// attitudes.
double ob_relative_speed(ob_shape a, const ob_mat3 *ra, ob_shape b, const ob_mat3 *rb, ob_vec3 v);
// m/s: the velocity of a's centre less that of b's; of a surface that turns, at the centre of the other one.
ob_vec3 ob_contact_velocity(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact);
// m/s, bound of the speed at which the surfaces of the two come nearer or part, and the gaps of their contact change. A
// round body's spin about its axis moves no surface; it counts as far as it moves points that go with the body.
double ob_contact_speed(const ob_island_work *w, const ob_contact *contact);
// rad/s, at the velocities in rows, of what changes the contact's geometry by turning; 0 for spheres.
double ob_contact_turn_rate(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact);
// m: by how much its spin about its axis (rad) would move those points of the body along the normal n that go with it.
// 0 where n goes through the axis at each of them, as where a round body rolls. arm: m, from its centre.
double ob_spin_lever(const ob_body *body, ob_vec3 n, const ob_vec3 *arm, uint32_t points);

#endif
