// Things of a life beside its plain bodies: bodies in chains of joints, compounds, hulls, ground of triangles, bodies that
// follow paths, sensors, models of others, scripts that join and drive, FMUs.
#ifndef OB_TESTS_LIVES_THINGS_H
#define OB_TESTS_LIVES_THINGS_H

#include <ob/vec.h>

#include "writer.h"

typedef struct things {
	bool scripts, free, closed; // scripts may be had; only what a free run takes; nothing acts from outside
	uint64_t life; // its seed: files have it in their names
	char last[16]; // name of the chain's last body; "": none
	ob_vec3 at; // its place, m
	uint32_t meshes, fields;
	bool model, avatar;
} things;

// Writes thing i, which follows from its seed and the things before it.
void put_thing(writer *w, things *t, uint32_t i, uint64_t seed);
// Writes a body with an FMU, half of them such as fail, and its file.
void put_fmu(writer *w, uint64_t seed);
// Writes a joint of any kind, with limits, springs, motors, strength by chance; b: "" is the world.
void put_joint(writer *w, const char *a, const char *b, ob_vec3 at, const char *name);
// Writes a free body of any shape but compounds, for a universe that runs.
void put_any_body(writer *w);
// Folder of the files that scenes name: made by this program, or given.
const char *things_folder(void);
void things_use_folder(const char *path);

#endif
