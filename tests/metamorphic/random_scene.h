// Small random scenes, each given by its kind and its seed, for relations between runs (relation.h).
//
// Bodies of one scene are of similar size; sizes, densities and materials of different scenes span decades.
#ifndef OB_TESTS_METAMORPHIC_RANDOM_SCENE_H
#define OB_TESTS_METAMORPHIC_RANDOM_SCENE_H

#include <stdio.h>

#include <ob/motion.h>

#include "motion/force.h"
#include "motion/path.h"
#include "settings/settings.h"

enum {
	SCENE_BODIES = 16,
	SCENE_POINTS = 20, // per hull
};

typedef enum scene_kind {
	SCENE_HITS, // closed: fly together, hit, fly apart
	SCENE_SPINS, // closed: spin at up to 100 rad/s, slowly past each other
	SCENE_BOUNCE, // on a plane, with restitution
	SCENE_HEAP, // on a plane
	SCENE_STATICS, // on fixed boxes
	SCENE_STACK, // stacked boxes, from the start
	SCENE_SLIDE, // boxes that lie flat slide and spin on a plane or on a box
	SCENE_ROLL, // round bodies roll on a plane
	SCENE_TABLES, // on a driven table or belt
	SCENE_PADDLES, // without gravity: hit by driven bodies
	SCENE_PUSHED, // under time-dependent forces, on a plane or without gravity
	SCENE_KINDS
} scene_kind;

extern const char *const scene_kind_name[SCENE_KINDS];

typedef struct scene_body {
	ob_shape shape;
	ob_vec3 size; // as in ob_shape
	double mass; // kg; 0: static or driven
	double friction, restitution;
	ob_state state;
	bool driven; // kinematic: keeps its state's velocities, unless it swings
	ob_path path; // its path, if it swings; no spline
	ob_vec3 running; // m/s, body frame: velocity of its surface
	bool pushed;
	ob_force push; // a sine or a pulse
	uint32_t points;
	ob_vec3 point[SCENE_POINTS]; // m, points of a hull, about its centre of mass; its state is that of this frame
	uint32_t fixed; // 1 + number of the body to which it is fixed; 0: none, as in all that are drawn
	bool passes; // it touches nothing
} scene_body;

typedef struct random_scene {
	ob_run_settings run; // gravity included
	ob_vec3 lift; // m/s^2: acceleration of static bodies
	uint32_t bodies;
	scene_body body[SCENE_BODIES];
} random_scene;

// shapes: bits 1 << OB_SHAPE_BOX and so on, to draw from; a sphere if a kind can use none of them.
random_scene scene_draw(scene_kind kind, uint64_t seed, unsigned shapes);
// Makes the centre of the hull of the body's points their origin, and sets its size to the hull's. Returns false if
// there is no hull.
bool scene_make_hull(scene_body *b);
// True without fixed bodies, gravity, forces.
bool scene_is_closed(const random_scene *s);
// Prints it as a scene file of obsim, to the last bit.
void scene_print(FILE *out, const random_scene *s);
// Reads such a file; returns false and a message on failure.
bool scene_read(const char *path, random_scene *s, ob_error *e);

#endif
