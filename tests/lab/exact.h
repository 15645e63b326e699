// Exact motions of the bodies of cases, at any time, for fake engines.
#ifndef OB_TESTS_LAB_EXACT_H
#define OB_TESTS_LAB_EXACT_H

#include "engine/engine.h"

typedef ob_state (*exact_motion)(const ob_world *w, uint32_t id, double t);

ob_state exact_rest(const ob_world *w, uint32_t id, double t);
ob_state exact_flight(const ob_world *w, uint32_t id, double t); // and spin
ob_state exact_bounces(const ob_world *w, uint32_t id, double t); // on a plane at z = 0
ob_state exact_meeting(const ob_world *w, uint32_t id, double t); // pairs along x, in the order of ids
ob_state exact_cradle(const ob_world *w, uint32_t id, double t);
ob_state exact_push(const ob_world *w, uint32_t id, double t); // box 1 pushed by its force, the rest roll on it
ob_state exact_slide(const ob_world *w, uint32_t id, double t); // blocks and spheres down plane 0
ob_state exact_stop(const ob_world *w, uint32_t id, double t); // blocks on level ground
ob_state exact_slip(const ob_world *w, uint32_t id, double t); // a sphere on level ground
ob_state exact_halt(const ob_world *w, uint32_t id, double t); // flies 2.5 m, to stop before its target
// thin ones on level ground; valid once they have stopped
ob_state exact_plate(const ob_world *w, uint32_t id, double t);
ob_state exact_drop(const ob_world *w, uint32_t id, double t); // anything from a height of 1 m, straight up again
ob_state exact_disk(const ob_world *w, uint32_t id, double t); // on its rim, its centre at rest
ob_state exact_roll(const ob_world *w, uint32_t id, double t); // on level ground, without slip
ob_state exact_pull(const ob_world *w, uint32_t id, double t); // pulled by its force, against friction
ob_state exact_round(const ob_world *w, uint32_t id, double t); // cylinders and capsules down the slope of body 0
ob_state exact_shaken(const ob_world *w, uint32_t id, double t); // blocks on swinging tables
ob_state exact_ridden(const ob_world *w, uint32_t id, double t); // all as body 0, which swings from rest
ob_state exact_belt(const ob_world *w, uint32_t id, double t); // blocks on belts
ob_state exact_turntable(const ob_world *w, uint32_t id, double t); // boxes that stay, or leave straight

#endif
