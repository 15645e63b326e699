// A model as MuJoCo's parser reads it. Internal to the module.
#ifndef OB_IMPORT_LOAD_H
#define OB_IMPORT_LOAD_H

#include <stdbool.h>
#include <stdio.h>

#include <mujoco/mujoco.h>

#include <ob/error.h>

typedef struct ob_drawn {
	mjModel *model;
	mjData *data; // at the model's initial pose, with all frames in the world
	bool floats; // a URDF file without a link called world: its root, which has no joint, is free
} ob_drawn;

// Loads an MJCF or URDF file and the files that it names. looks: those of a URDF file, too. omitted: for a line for each
// part of the file that is left out or changed; NULL: none. Once in a process: a fault of MuJoCo's leaves its memory.
bool ob_drawn_load(const char *path, bool looks, FILE *omitted, ob_drawn *out, ob_error *e);

// True if the body has a mass and moments that an object may have.
bool ob_drawn_has_mass(const mjModel *m, int body);

// Body whose object the body belongs to: itself, or what it is fixed to if it has no mass; 0: the world.
int ob_drawn_holder(const mjModel *m, int body);

#endif
