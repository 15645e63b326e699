// Worlds: objects by their body properties, initial states, and gravity: the input of engines.
//
// A body's id is its place. Thread-safety: one thread per world.
#ifndef OB_ENGINE_WORLD_H
#define OB_ENGINE_WORLD_H

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

// Kinds of prescribed motion in a world. An engine that supports surfaces supports kinematic bodies, too.
typedef enum ob_world_drive {
	OB_WORLD_DRIVES_NOTHING,
	OB_WORLD_DRIVES_BODIES, // kinematic bodies
	OB_WORLD_DRIVES_SURFACES, // surfaces of static or kinematic bodies
} ob_world_drive;
ob_world_drive ob_world_drives(const ob_world *w);
// Path of a body; NULL if it has none.
const ob_path *ob_world_path(const ob_world *w, uint32_t id);
void ob_world_finish(ob_world *w);

// ---- drive

// Kinematic bodies, for engines that move them step by step. Internal to the module. One thread per drive.

typedef struct ob_drive {
	uint32_t count;
	struct ob_driven {
		uint32_t id;
		ob_state from; // at time 0
		double frequency; // rad/s; 0: constant motion
		ob_vec3 a; // m/s^2, if it swings, at time 0
	} * body; // [count]
} ob_drive;

bool ob_drive_init(ob_drive *d, const ob_world *w); // all kinematic bodies; false: out of memory
void ob_drive_finish(ob_drive *d);
// State of body i at time t (s), with constant velocities that bring it within h (s) to its place at that time.
ob_state ob_drive_step(const ob_drive *d, uint32_t i, double t, double h);

// ---- joint tree

// Spanning tree of a world's joints, for engines whose coordinates are the values of joints. Pure; any thread.

// joint: [objects], the joint that holds each object to its parent; OB_JOINT_WORLD: it is static, or free. Distances, and joints
// that would close a loop, are left out, balls before all others. false: no memory.
bool ob_joint_tree(const ob_world *w, uint32_t *joint);
// Object that holds this one by that joint: static, or the world (OB_JOINT_WORLD), or one that moves.
static inline uint32_t ob_joint_other(const ob_joint_passport *j, uint32_t object)
{
	return j->object[j->object[0] == object];
}

#endif
