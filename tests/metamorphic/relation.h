// Relations: properties of any run, or between the runs of a scene and of a transformed one, for any scene and without
// knowledge of its motion.
//
// Motions are compared at 1 s and before, until a twin, with bodies displaced by 1e-12 m, has deviated by more than
// 1e-9 m: from there on chaos decides.
#ifndef OB_TESTS_METAMORPHIC_RELATION_H
#define OB_TESTS_METAMORPHIC_RELATION_H

#include "play.h"

typedef enum relation_id {
	RELATION_AGAIN, // run again: the same bits
	RELATION_WORKERS, // three workers: the same bits
	RELATION_MIRRORED,
	RELATION_TURNED, // about the vertical; by any rotation if nothing is vertical
	RELATION_TILTED, // by any rotation, together with gravity
	RELATION_MOVED, // by 1 to 1000 m
	RELATION_BOOSTED, // by 1 to 100 m/s, along all planes; static bodies become driven
	RELATION_REORDERED, // objects in another order
	RELATION_RESCALED, // other units of length, time and mass
	RELATION_REFINED, // twice the substeps, twice: the second time changes less
	RELATION_FAR, // another body far away
	RELATION_MOMENTUM, // conserved in a closed system
	RELATION_SPIN, // so is angular momentum
	RELATION_ENERGY, // never above its earlier least, net of position recovery; without work from outside
	RELATION_LIFTED, // all supports accelerate, with as much more gravity: no effect
	RELATION_REFRAMED, // the points of hulls in another frame and order
	RELATION_PEBBLE, // a body of 1e-9 of another's mass that lies on it, or leans on it
	RELATION_NEIGHBOUR, // a second one on the first: a pair that touches elsewhere in the island
	RELATION_IDLE, // the pebble is fixed: a joint that carries nothing
	RELATION_CUT, // a box in two pieces that are fixed together
	RELATION_BOLTED, // what lies still on another body is fixed to it
	RELATIONS
} relation_id;

extern const char *const relation_name[RELATIONS];

typedef struct judged {
	bool applies; // to such a scene
	bool counted; // a twin stays near enough to the end
	double error; // m, scaled; a relative error; or 1: bits differ
	double limit; // upper bound of error
	double when; // s, first sample above it
	char why[160]; // reason for which it could not be run; "" = it could
} judged;

// A scene's own run and its twin's, shared by all relations.
typedef struct original {
	const random_scene *scene;
	played base;
	int samples; // until which the twin is near
	bool valid; // it can be run, and nothing penetrates at the start
} original;

original relation_original(const random_scene *s, uint64_t steps);
// seed: for the angle, the velocity and so on. Before a relation fails, more twins are watched.
judged relation_judge(relation_id r, const original *o, uint64_t seed, uint64_t steps);
bool relation_fails(const judged *j);

#endif
