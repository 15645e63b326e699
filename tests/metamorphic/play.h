// Runs a random scene with obsim's engine, with the scene's settings, and records its states and conserved quantities.
#ifndef OB_TESTS_METAMORPHIC_PLAY_H
#define OB_TESTS_METAMORPHIC_PLAY_H

#include "random_scene.h"

enum { PLAY_SAMPLES = 4, PLAY_STEPS = 60 };

typedef struct played {
	bool failed; // it could not be completed
	char why[160];
	double depth; // m, penetration at the start
	ob_state at[PLAY_SAMPLES][SCENE_BODIES]; // after equal parts of the steps
	uint64_t hash; // hash of the last state
	double momentum, spin; // largest errors, relative to the sum over all bodies at the start
	// largest rise above the least before, net of position recovery: relative to the available energy
	double energy;
	bool touched;
} played;

// A second of a scene, for each body.
typedef struct played_second {
	double said[SCENE_BODIES]; // m: sum of its estimates
	double off[SCENE_BODIES]; // m: distance of any surface point from a fine solution, at most, at the second's end
} played_second;

// Runs a scene up to a step, and for a second more; and goes on from the same state for that second with fixed substeps.
// Returns false if either failed.
bool play_beside(const random_scene *s, uint64_t step, uint32_t substeps, played_second *out);

// Runs a scene. workers: threads, or 0: in the caller's own. The last sample is after that many steps.
void play(const random_scene *s, uint32_t workers, uint64_t steps, played *out);

#endif
