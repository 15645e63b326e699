// The scenes that engines are measured in: every case of the lab by its name, and worlds of any number of bodies.
// Thread-safety: one thread at a time.
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include "lab/case.h"

typedef struct bench_scene {
	ob_case of; // what is built, looked at, and for how long
	uint32_t bodies; // of a world of any number; 0 = the case's own
	bool sleeping; // what rests may sleep
} bench_scene;

// "pile", "falling-1000", "cylinders-1000", "capsules-1000" (as many boxes, of the same volumes: "falling"),
// "sparse-10000", "balls-49". NULL and e: there is none of this name. What it returns holds
// until the next call.
const bench_scene *bench_scene_find(const char *name, ob_error *e);

#endif
