// A world as MuJoCo's model, in MJCF. Part of obsim-mujoco.so.
//
// Each object is a body. Joints that form a tree (world.h) are MuJoCo's joints, which its coordinates are the values of;
// their loops are closed by its equality constraints: a ball by "connect", a hinge by two of them, "fixed" by "weld". A distance
// is a tendon between two sites. Names are numbers: of the object for bodies and geometries, of the joint for what makes it,
// with ".2" for the second axis of a universal.
//
// A motor that holds a rate without a greatest force is an equality constraint: it is solved with all others, as a velocity
// actuator is not. Other motors are actuators.
#ifndef OB_ENGINE_MJCF_H
#define OB_ENGINE_MJCF_H

#include "settings/settings.h"
#include "engine/world.h"

enum {
	OB_MJCF_FILES = 100, // at most; bodies nest 48 deep in each
	OB_MJCF_PAIRS = 10000, // at most, with a friction or restitution of their own
};

typedef struct ob_mjcf {
	const ob_world *world;
	const uint32_t *tree; // [objects], as of ob_joint_tree
	double step; // s
	uint32_t iterations;
	const char *integrator; // "Euler", "RK4"
	uint32_t files; // written
	struct ob_mjcf_file {
		char *text; // free() it
		size_t length;
	} file[OB_MJCF_FILES];
} ob_mjcf;

// Name of a file; the first includes all others, as MuJoCo's parser takes no deep nesting.
void ob_mjcf_name(uint32_t file, char name[16]);
// Writes the files. false: the limits, or memory, do not suffice.
bool ob_mjcf_write(ob_mjcf *m);
bool ob_mjcf_moves(const ob_passport *o);

#endif
