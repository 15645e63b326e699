// Worlds that tests and benchmarks build: bodies, and whole scenes.
//
// A body's id is its place in the order of building. Friction is .5 and restitution 0 until they are set; a body starts
// at rest and unturned. Running out of memory ends the program. The same seed gives the same bits on every machine.
#ifndef OB_TESTS_WORLD_BUILDERS_H
#define OB_TESTS_WORLD_BUILDERS_H

#include "engine/world.h"

// Body to edit freely; both pointers hold until the next body is built.
typedef struct ob_world_body {
	ob_passport *passport;
	ob_state *state;
} ob_world_body;

// Adds a body. size as in ob_shape; mass in kg, 0: static; p: centre. The inertia is that of a homogeneous body.
ob_world_body ob_world_add(ob_world *w, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p);
// Half extents and radius in m.
ob_world_body ob_world_box(ob_world *w, double mass, ob_vec3 half, ob_vec3 p);
ob_world_body ob_world_sphere(ob_world *w, double mass, double radius, ob_vec3 p);
// half: half the length of the side, along z.
ob_world_body ob_world_cylinder(ob_world *w, double mass, double radius, double half, ob_vec3 p);
ob_world_body ob_world_capsule(ob_world *w, double mass, double radius, double half, ob_vec3 p);
// Joins two bodies, or one and the world (b: OB_JOINT_WORLD), as they are. frame: the joint's, at a place; its axes are
// those of ob/joint.h. The joint may be edited until the next one is built; "axis" has no limits, and acts if its flag is set.
ob_joint_passport *ob_world_join(ob_world *w, ob_joint_kind kind, uint32_t a, uint32_t b, ob_pose frame);
// A ragdoll of ten bodies and nine joints, 1.8 m tall, with its feet's origin at p, turned by "lean" (rad): crosses at neck,
// shoulders and hips, hinges at elbows and knees, all with limits and dry friction.
void ob_world_ragdoll(ob_world *w, ob_vec3 p, double lean);
ob_world_body ob_world_ground(ob_world *w); // plane z = 0
// Sets friction and restitution of all bodies built so far.
void ob_world_material(ob_world *w, double friction, double restitution);

// Makes a body kinematic: it keeps its state's velocities, and contacts do not affect it.
void ob_world_kinematic(ob_world_body b);
// Makes a body swing about its place: displacement amplitude * sin(frequency t + phase) (m; rad/s, rad). Contacts do
// not affect it.
void ob_world_swing(ob_world *w, ob_world_body b, ob_vec3 amplitude, double frequency, double phase);
// Adds the hull of these points (m), with their origin at p; the body's own frame differs (ob/hull.h). Points without a
// hull end the program.
ob_world_body ob_world_hull(ob_world *w, double mass, const ob_vec3 *point, uint32_t points, ob_vec3 p);
// Adds a compound of these parts, with the origin of their points at p.
ob_world_body ob_world_compound(ob_world *w, double mass, const ob_hull_part *part, uint32_t parts, ob_vec3 p);
// Adds a terrain, and frees it; NULL ends the program. p: its origin.
ob_world_body ob_world_terrain(ob_world *w, ob_terrain *t, ob_vec3 p);
// The ground turned by "angle" (rad) about y: bodies on it slide towards +x.
ob_world_body ob_world_slope(ob_world *w, double angle);
// n unit cubes of 1000 kg in a stack, centres up to 10 mm off the axis in x and in y; no ground.
void ob_world_stack(ob_world *w, int n, ob_vec3 foot, uint64_t seed);
// n boxes in columns of four, 1.8 m apart, over a ground: half extents of .1 to .5 m, 1000 kg/m^3, random attitudes.
// The lowest are between 2.8 and 3.8 m up.
void ob_world_falling(ob_world *w, uint32_t n, uint64_t seed);
// Same with cylinders of the boxes' heights, or capsules twice as long as thick, of the same volumes.
void ob_world_falling_solids(ob_world *w, ob_shape shape, uint32_t n, uint64_t seed);
// n such boxes 4 m apart, at heights of 2 to 10 m, thrown up at up to 4 m/s, with restitution .8.
void ob_world_sparse(ob_world *w, uint32_t n, uint64_t seed);
// n elastic spheres of radius .1 m and 10 kg in a square, 2 m apart, fall from a height of 5 m without friction.
void ob_world_balls(ob_world *w, uint32_t n);
// Normalises a random point of the cube of four components.
ob_quat ob_world_random_attitude(uint64_t *seed);

#endif
