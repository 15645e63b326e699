// A universe for tests: objects by hand, one worker in the test's own thread.
//
//   little_scene *s = little_scene_new();
//   little_ground(s);
//   little_sphere(s, 1, .5, ob_v3(0, 0, 2))->passport.restitution = 1;
//   little_universe l;
//   little_open(&l, s);
//   little_run(&l, 120);
//   ... little_state(&l, 1) ...
//   little_close(&l);
//
// What fails on the way ends the test with a message.
#ifndef OB_TESTS_SIM_LITTLE_UNIVERSE_H
#define OB_TESTS_SIM_LITTLE_UNIVERSE_H

#include <ob/motion.h>

#include "measure/measure.h"
#include "sim/sim.h"

enum { LITTLE_MOST = 2048 }; // objects

typedef struct little_object {
	ob_passport passport;
	ob_state state;
} little_object;

typedef struct little_scene {
	ob_run_settings run; // the program's own, but no sleeping
	uint32_t objects, capacity; // capacity 0: as many as there are objects
	little_object object[LITTLE_MOST];
} little_scene;

little_scene *little_scene_new(void); // free() it

// Each returns the new object, to be changed at will; friction is .5, restitution 0. mass 0 (kg): static.
little_object *little_add(little_scene *s, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p);
little_object *little_ground(little_scene *s);
little_object *little_sphere(little_scene *s, double mass, double radius, ob_vec3 p);
little_object *little_box(little_scene *s, double mass, ob_vec3 half, ob_vec3 p);
// A stack of unit cubes of 1000 kg on a ground, each up to 10 mm off the axis.
void little_stack(little_scene *s, int n, uint64_t seed);

typedef struct little_universe {
	const little_scene *scene;
	ob_universe *u;
	ob_sim *sim;
	ob_snapshot now; // of the last look
} little_universe;

// A universe with all objects in place, before its first step; for tests that bring their own workers.
ob_universe *little_populate(const little_scene *s, uint32_t workers);

void little_open(little_universe *l, const little_scene *s);
void little_close(little_universe *l);
// So many steps on, then a look.
void little_run(little_universe *l, uint64_t steps);
void little_run_to(little_universe *l, double time); // s
// Puts an object of the scene (at a free id), or takes it away, between two runs.
void little_put(little_universe *l, uint32_t id);
void little_take_away(little_universe *l, uint32_t id);

ob_state little_state(const little_universe *l, uint32_t id); // as of the last look
double little_energy(const little_universe *l); // J
ob_penetration little_penetration(const little_universe *l);
bool little_asleep(const little_universe *l, uint32_t id);

#endif
