// Relations: what must be true of a run, or between the runs of a scene and of the same scene seen otherwise, whatever
// the scene and without knowing how it goes on.
//
// Motions are compared at 1 s and before, up to where a twin, whose bodies began 1e-12 m elsewhere, has gone more than
// 1e-9 m another way: from there on chaos decides.
#ifndef OB_TESTS_METAMORPHIC_RELATION_H
#define OB_TESTS_METAMORPHIC_RELATION_H

#include "play.h"

typedef enum relation_id {
	RELATION_AGAIN, // run again: the same bits
	RELATION_WORKERS, // three workers: the same bits
	RELATION_MIRRORED,
	RELATION_TURNED, // about the vertical; by any rotation where nothing is vertical
	RELATION_TILTED, // by any rotation, gravity with it
	RELATION_MOVED, // by 1 to 1000 m
	RELATION_BOOSTED, // by 1 to 100 m/s, along all planes; what stands then moves as it is told
	RELATION_REORDERED, // objects in another order
	RELATION_RESCALED, // other units of length, time and mass
	RELATION_REFINED, // twice the substeps, twice: the second time it changes less
	RELATION_FAR, // something else far away
	RELATION_MOMENTUM, // kept in a closed system
	RELATION_SPIN, // so is angular momentum
	RELATION_ENERGY, // never more than before, net of position recovery; where no work is done from outside
	RELATION_LIFTED, // all that stands speeds up, with as much more gravity: nothing is felt of it
	RELATION_REFRAMED, // the points of hulls in another frame and order
	RELATIONS
} relation_id;

extern const char *const relation_name[RELATIONS];

typedef struct judged {
	bool applies; // to such a scene
	bool counted; // a twin stays near enough to the end
	double error; // m, scaled; a share of what there is; or 1: bits differ
	double limit; // error is to be at most this
	double when; // s, of the first sample at which it is above
	char why[160]; // it could not be run; "" = it could
} judged;

// A scene's own run and its twin's, which all relations share.
typedef struct original {
	const random_scene *scene;
	played base;
	int samples; // at which the twin is near
	bool valid; // it can be run, and nothing penetrates at the start
} original;

original relation_original(const random_scene *s, uint64_t steps);
// seed: of the angle, the velocity and so on
judged relation_judge(relation_id r, const original *o, uint64_t seed, uint64_t steps);
bool relation_fails(const judged *j);

#endif
