// How fast two bodies move, one against the other: the same in every frame of reference. What goes along a plane does
// not count, for a plane is the same everywhere.
#ifndef OB_SIM_RELATIVE_SPEED_H
#define OB_SIM_RELATIVE_SPEED_H

#include "sim/island.h"

// m/s: at v, one's velocity less the other's, how fast they come nearer or part, but for turning. ra, rb: their
// attitudes.
double ob_relative_speed(ob_shape a, const ob_mat3 *ra, ob_shape b, const ob_mat3 *rb, ob_vec3 v);
// m/s: the velocity of a's centre less that of b's; of a surface that turns, at the centre of the other one.
ob_vec3 ob_contact_velocity(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact);
// m/s, bound of the speed at which two points of the pair come nearer or part.
double ob_contact_speed(const ob_island_work *w, const ob_contact *contact);

#endif
