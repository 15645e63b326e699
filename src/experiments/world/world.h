// Worlds: objects by their body properties, initial states, and gravity: the input of engines.
//
// A body's id is its place in the order of building. Friction is .5 and restitution 0 until they are set; a body starts
// at rest and unturned. Running out of memory ends the program. The same seed gives the same bits on every machine.
// Thread-safety: one thread per world.
#ifndef OB_WORLD_WORLD_H
#define OB_WORLD_WORLD_H

#include <ob/hull.h>
#include <ob/joint.h>
#include <ob/motion.h>

#include "hull/hull.h"
#include "motion/path.h"
#include "terrain/terrain.h"

#define OB_WORLD_GRAVITY 9.81 // m/s^2

// Initialise with { .gravity = ... } alone.
typedef struct ob_world {
	ob_vec3 gravity; // m/s^2
	uint32_t objects, objects_max; // number, capacity
	ob_passport
		*passport; // [objects], id = index, inertia filled; force is constant, at the centre (N, world frame)
	ob_state *state; // [objects]
	uint32_t paths; // swinging kinematic bodies
	struct ob_world_path {
		uint32_t id;
		ob_path path;
	} * path; // [paths]
	uint32_t hulls;
	ob_hull *hull; // [hulls], by the number in passports
	ob_terrain_set *terrains; // by the number in passports; NULL: there are none
	uint32_t joints;
	ob_joint_passport *joint; // [joints]
} ob_world;

// Body to edit freely; both pointers hold until the next body is built.
typedef struct ob_world_body {
	ob_passport *passport;
	ob_state *state;
} ob_world_body;

// Adds a body. size as in ob_shape; mass in kg, 0: static; p: centre. The inertia is that of a homogeneous body.
ob_world_body ob_world_add(ob_world *w, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p);
// Kinds of prescribed motion in a world. An engine that supports surfaces supports kinematic bodies, too.
typedef enum ob_world_drive {
	OB_WORLD_DRIVES_NOTHING,
	OB_WORLD_DRIVES_BODIES, // kinematic bodies
	OB_WORLD_DRIVES_SURFACES, // surfaces of static or kinematic bodies
} ob_world_drive;
ob_world_drive ob_world_drives(const ob_world *w);
// Path of a body; NULL if it has none.
const ob_path *ob_world_path(const ob_world *w, uint32_t id);
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
void ob_world_finish(ob_world *w);

#endif
