// Builds the worlds of cases, body by body. A body's id is its place in the order of building; friction is .5 and
// restitution 0 until they are set; it starts at rest and unturned. Running out of memory ends the program.
// Thread-safety: one thread per world.
#ifndef OB_LAB_BUILD_H
#define OB_LAB_BUILD_H

#include "engine/engine.h"

#define OB_BUILD_GRAVITY 9.81 // m/s^2

// To be changed at will; both pointers hold until the next body is built.
typedef struct ob_build_body {
	ob_passport *passport;
	ob_state *state;
} ob_build_body;

// Half extents and radius in m; mass in kg, 0 = never moves; p = centre.
ob_build_body ob_build_box(ob_engine_world *w, double mass, ob_vec3 half, ob_vec3 p);
ob_build_body ob_build_sphere(ob_engine_world *w, double mass, double radius, ob_vec3 p);
// The plane z = 0, and the same tilted by a turn "angle" (rad) about y: what lies on it slides towards +x.
ob_build_body ob_build_ground(ob_engine_world *w);
ob_build_body ob_build_slope(ob_engine_world *w, double angle);
// n unit cubes of 1000 kg one on the other, their centres up to 10 mm off the axis in x and in y; no ground.
void ob_build_stack(ob_engine_world *w, int n, ob_vec3 foot, uint64_t seed);
// n boxes in columns of four, 1.8 m apart, over a ground: half extents of .1 to .5 m, 1000 kg/m^3, turned at random, the
// lowest between 2.8 and 3.8 m up.
void ob_build_falling(ob_engine_world *w, uint32_t n, uint64_t seed);
// n such boxes 4 m apart, at heights of 2 to 10 m, thrown up at up to 4 m/s, with restitution .8.
void ob_build_sparse(ob_engine_world *w, uint32_t n, uint64_t seed);
// n elastic spheres of radius .1 m and 10 kg in a square, 2 m apart, fall from a height of 5 m without friction.
void ob_build_balls(ob_engine_world *w, uint32_t n);
// Friction and restitution of all bodies built so far.
void ob_build_material(ob_engine_world *w, double friction, double restitution);
void ob_build_finish(ob_engine_world *w);

// Random numbers that are the same on every machine: splitmix64 (Steele, Lea and Flood 2014).
double ob_build_uniform(uint64_t *seed); // in [0, 1)
double ob_build_within(uint64_t *seed, double low, double high);
ob_vec3 ob_build_vector(uint64_t *seed, double size); // each component within +-size
ob_quat ob_build_attitude(uint64_t *seed); // of a random direction in the four components' cube: any

#endif
