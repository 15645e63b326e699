// A universe for tests: objects made by hand, one worker in the test's own thread.
//
//   little_scene *s = little_scene_new();
//   ob_world_ground(&s->world);
//   ob_world_sphere(&s->world, 1, .5, ob_v3(0, 0, 2)).passport->restitution = 1;
//   little_universe l;
//   little_open(&l, s);
//   little_run(&l, 120);
//   ... little_state(&l, 1) ...
//   little_close(&l);
//
// A failure ends the test with a message.
#ifndef OB_TESTS_STEP_LITTLE_UNIVERSE_H
#define OB_TESTS_STEP_LITTLE_UNIVERSE_H

#include <ob/motion.h>

#include "measure/measure.h"
#include "step/sim.h"
#include "world/builders.h"

enum { LITTLE_MOST = 2048 }; // objects

// Bodies are built with ob_world_box(&s->world, ...) and its like, at most LITTLE_MOST: returned pointers stay valid.
typedef struct little_scene {
	ob_run_settings run; // the program's own, but no sleeping; its gravity applies
	uint32_t capacity; // 0: the number of objects
	bool checked; // checks invariants after each step
	uint32_t harden; // measures, bits of 1 << ob_harden_measure
	ob_world world;
	ob_passport passport[LITTLE_MOST]; // the world's
	ob_state state[LITTLE_MOST];
} little_scene;

little_scene *little_scene_new(void); // free() it

typedef struct little_universe {
	const little_scene *scene;
	ob_universe *u;
	ob_sim *sim;
	ob_snapshot now; // read last
} little_universe;

// A universe with all objects in place, before its first step; for tests that bring their own workers.
ob_universe *little_populate(const little_scene *s, uint32_t workers);

void little_open(little_universe *l, const little_scene *s);
void little_close(little_universe *l);
// Runs a number of steps, then takes a snapshot.
void little_run(little_universe *l, uint64_t steps);
void little_run_to(little_universe *l, double time); // s
// Adds an object of the scene (at a free id), or removes it, between two runs.
void little_put(little_universe *l, uint32_t id);
void little_take_away(little_universe *l, uint32_t id);

ob_state little_state(const little_universe *l, uint32_t id); // as of the last snapshot
double little_energy(const little_universe *l); // J
ob_penetration little_penetration(const little_universe *l);
bool little_asleep(const little_universe *l, uint32_t id);

#endif
