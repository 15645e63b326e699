// Worlds: objects by their passports, where they start, and gravity. What engines, cases, benchmarks and tests simulate
// is built here, body by body or as one of the scenes that several of them share.
//
// A body's id is its place in the order of building; friction is .5 and restitution 0 until they are set; it starts at
// rest and unturned. Running out of memory ends the program. The same seed gives the same bits on every machine.
// Thread-safety: one thread per world.
#ifndef OB_WORLD_WORLD_H
#define OB_WORLD_WORLD_H

#include <ob/hull.h>
#include <ob/motion.h>

#include "motion/path.h"

#define OB_WORLD_GRAVITY 9.81 // m/s^2

// Start with { .gravity = ... } and nothing else.
typedef struct ob_world {
	ob_vec3 gravity; // m/s^2
	uint32_t objects, objects_max; // there are, there is room for
	ob_passport
		*passport; // [objects], id = index, inertia filled; force is constant, at the centre (N, world frame)
	ob_state *state; // [objects]
	uint32_t paths; // of kinematic bodies that swing
	struct ob_world_path {
		uint32_t id;
		ob_path path;
	} *path; // [paths]
	uint32_t hulls;
	ob_hull *hull; // [hulls], by the number in passports
} ob_world;

// To be changed at will; both pointers hold until the next body is built.
typedef struct ob_world_body {
	ob_passport *passport;
	ob_state *state;
} ob_world_body;

// size as in ob_shape; mass in kg, 0 = never moves; p = centre. The inertia is that of a homogeneous body.
ob_world_body ob_world_add(ob_world *w, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p);
// The body moves on with its state's velocities, whatever touches it.
void ob_world_kinematic(ob_world_body b);
// The same to and fro about its place: sin(frequency t + phase) of the amplitude (m; rad/s, rad) away from it.
void ob_world_swing(ob_world *w, ob_world_body b, ob_vec3 amplitude, double frequency, double phase);
// What a world moves whatever touches it. What moves kinematic bodies and surfaces takes kinematic bodies alone, too.
typedef enum ob_world_drive {
	OB_WORLD_DRIVES_NOTHING,
	OB_WORLD_DRIVES_BODIES, // kinematic ones
	OB_WORLD_DRIVES_SURFACES, // of bodies that are static or kinematic
} ob_world_drive;
ob_world_drive ob_world_drives(const ob_world *w);
// NULL: it has none
const ob_path *ob_world_path(const ob_world *w, uint32_t id);
// Half extents and radius in m.
ob_world_body ob_world_box(ob_world *w, double mass, ob_vec3 half, ob_vec3 p);
ob_world_body ob_world_sphere(ob_world *w, double mass, double radius, ob_vec3 p);
// The hull of these points (m), whose origin is at p; the body's own frame is another (ob/hull.h). Points that have
// none end the program.
ob_world_body ob_world_hull(ob_world *w, double mass, const ob_vec3 *point, uint32_t points, ob_vec3 p);
// The plane z = 0, and the same tilted by a turn "angle" (rad) about y: what lies on it slides towards +x.
ob_world_body ob_world_ground(ob_world *w);
ob_world_body ob_world_slope(ob_world *w, double angle);
// n unit cubes of 1000 kg one on the other, their centres up to 10 mm off the axis in x and in y; no ground.
void ob_world_stack(ob_world *w, int n, ob_vec3 foot, uint64_t seed);
// n boxes in columns of four, 1.8 m apart, over a ground: half extents of .1 to .5 m, 1000 kg/m^3, turned at random,
// the lowest between 2.8 and 3.8 m up.
void ob_world_falling(ob_world *w, uint32_t n, uint64_t seed);
// The same with cylinders as high as those boxes, or capsules twice as long as thick, of the same volumes.
void ob_world_falling_solids(ob_world *w, ob_shape shape, uint32_t n, uint64_t seed);
// n such boxes 4 m apart, at heights of 2 to 10 m, thrown up at up to 4 m/s, with restitution .8.
void ob_world_sparse(ob_world *w, uint32_t n, uint64_t seed);
// n elastic spheres of radius .1 m and 10 kg in a square, 2 m apart, fall from a height of 5 m without friction.
void ob_world_balls(ob_world *w, uint32_t n);
// Friction and restitution of all bodies built so far.
void ob_world_material(ob_world *w, double friction, double restitution);
void ob_world_finish(ob_world *w);

// Of a random direction in the four components' cube: any.
ob_quat ob_world_random_attitude(uint64_t *seed);

#endif
