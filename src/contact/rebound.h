// One point of a body hits what does not move: the impact of contact/impact.h with a single point, which is most of
// what happens to bodies that fly. Pure functions, thread-safe.
#ifndef OB_CONTACT_REBOUND_H
#define OB_CONTACT_REBOUND_H

#include <ob/motion.h>

typedef struct ob_rebound {
	double inv_mass; // 1/kg
	ob_vec3 inertia; // kg m^2, principal
	double friction, restitution; // of the pair
} ob_rebound;

// Changes state->v and state->w by the impulse on the point at "arm" (m, from the centre, world frame) of a surface with
// this unit normal. The point must approach. The normal velocity afterwards is -restitution times that before where
// friction sticks or there is none, and energy never grows.
void ob_rebound_solve(const ob_rebound *r, ob_vec3 arm, ob_vec3 normal, ob_state *state);

#endif
