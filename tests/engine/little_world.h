// Small worlds for tests of engines.
#ifndef OB_TESTS_PEER_LITTLE_WORLD_H
#define OB_TESTS_PEER_LITTLE_WORLD_H

#include "engine/engine.h"
#include "world/builders.h"

enum { LITTLE_MOST = 256 }; // objects

typedef struct little_world {
	ob_world world; // initial state
	ob_state now[LITTLE_MOST]; // after little_run
} little_world;

little_world *little_world_new(void); // gravity 9.81 m/s^2 downwards
void little_world_free(little_world *l);
// Each returns the new object's id; friction .5, restitution 0, at rest. mass 0 (kg): static. Sizes as in ob_shape.
uint32_t little_add(little_world *l, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p);
uint32_t little_ground(little_world *l);
uint32_t little_cube(little_world *l, double mass, double half, ob_vec3 p);
uint32_t little_sphere(little_world *l, double mass, double radius, ob_vec3 p);

// Makes an engine with its usual settings except for the number of substeps (0: usual, too); a failure ends the test.
ob_engine *little_make(const ob_engine_kind *kind, const little_world *l, uint32_t substeps);
// Steps for so many seconds, then reads the states.
void little_step(const ob_engine_kind *kind, ob_engine *p, little_world *l, double seconds);
// Makes, steps and destroys an engine.
void little_run(const ob_engine_kind *kind, little_world *l, uint32_t substeps, double seconds);

#endif
