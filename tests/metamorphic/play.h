// A random scene is run by obsim's engine, with the settings that it says, and what is to be compared or conserved is
// kept of it.
#ifndef OB_TESTS_METAMORPHIC_PLAY_H
#define OB_TESTS_METAMORPHIC_PLAY_H

#include "random_scene.h"

enum { PLAY_SAMPLES = 4, PLAY_STEPS = 60 };

typedef struct played {
	bool failed; // it could not be run to the end
	char why[160];
	double depth; // m, of penetration at the start
	ob_state at[PLAY_SAMPLES][SCENE_BODIES]; // after equal parts of the steps
	uint64_t hash; // of the last state
	double momentum, spin; // the most that they were off: of the sum of all bodies' at the start
	double energy; // the most that it was above the least before, net of position recovery: of what there was to
		       // lose
	bool touched;
} played;

// workers: threads, or 0: in the caller's own. The last sample is after that many steps.
void play(const random_scene *s, uint32_t workers, uint64_t steps, played *out);

#endif
