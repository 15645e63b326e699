// Small random scenes, each given by its kind and its seed, for relations between runs (relation.h).
//
// Bodies of one scene are of like size; sizes, densities and materials of different scenes span decades.
#ifndef OB_TESTS_METAMORPHIC_RANDOM_SCENE_H
#define OB_TESTS_METAMORPHIC_RANDOM_SCENE_H

#include <stdio.h>

#include <ob/motion.h>

#include "motion/force.h"
#include "motion/path.h"
#include "settings/settings.h"

enum {
	SCENE_BODIES = 16,
	SCENE_POINTS = 20, // of a hull
};

typedef enum scene_kind {
	SCENE_HITS, // closed: flies together, hits, flies apart
	SCENE_SPINS, // closed: spins at up to 100 rad/s, slowly past each other
	SCENE_BOUNCE, // on a plane, with restitution
	SCENE_HEAP, // on a plane
	SCENE_STATICS, // on boxes that do not move
	SCENE_STACK, // of boxes, from the start
	SCENE_SLIDE, // boxes that lie flat slide and spin on a plane or on a box
	SCENE_ROLL, // what is round rolls on a plane
	SCENE_TABLES, // on a table or a belt that moves as it is told
	SCENE_PADDLES, // without gravity: hit by something that moves as it is told
	SCENE_PUSHED, // under forces that change in time, on a plane or without gravity
	SCENE_KINDS
} scene_kind;

extern const char *const scene_kind_name[SCENE_KINDS];

typedef struct scene_body {
	ob_shape shape;
	ob_vec3 size; // as in ob_shape
	double mass; // kg; 0: never moves, or as it is told
	double friction, restitution;
	ob_state state;
	bool driven; // moves as it is told: on with its state's velocities ..
	ob_path path; // .. or so, if it swings; no spline
	ob_vec3 running; // m/s, body frame: of its surface
	bool pushed;
	ob_force push; // a sine or a pulse
	uint32_t points;
	ob_vec3 point[SCENE_POINTS]; // m, of a hull, about its centre of mass; its state is that of this frame
} scene_body;

typedef struct random_scene {
	ob_run_settings run; // gravity included
	ob_vec3 lift; // m/s^2: what never moves speeds up like this
	uint32_t bodies;
	scene_body body[SCENE_BODIES];
} random_scene;

// shapes: bit 1 << OB_SHAPE_BOX and so on, those to draw from; a sphere where a kind can use none of them.
random_scene scene_draw(scene_kind kind, uint64_t seed, unsigned shapes);
// The centre of a hull of the body's points becomes their origin, and its size the hull's. false: there is none.
bool scene_make_hull(scene_body *b);
// Nothing fixed, no gravity, no forces.
bool scene_is_closed(const random_scene *s);
// As a scene file of obsim, to the last bit.
void scene_print(FILE *out, const random_scene *s);
// From such a file; false and a message where it cannot be read.
bool scene_read(const char *path, random_scene *s, ob_error *e);

#endif
