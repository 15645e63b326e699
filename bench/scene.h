// Scenes that engines are measured in: every case of the lab by its name, and worlds of any number of bodies.
// Thread-safety: one thread at a time.
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include "lab/case.h"

typedef struct bench_scene {
	ob_case of; // name, duration; of the lab: world and observations, too
	void (*build)(ob_world *w, uint32_t bodies); // world of any size; NULL: a case of the lab
	uint32_t bodies;
	bool sleeping; // bodies at rest may sleep
	bool elastic; // keeps its energy; else bodies fall, and come to rest
} bench_scene;

// Finds "pile", "falling-1000", "cylinders-1000", "capsules-1000" (as many boxes, of the same volumes: "falling"),
// "sparse-10000", "balls-49". Returns NULL and e for an unknown name. The result is valid until the next call.
const bench_scene *bench_scene_find(const char *name, ob_error *e);

#endif
