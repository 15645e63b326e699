// Free simulators led by hand, in one thread: each step is chosen by the caller, so that lags, orders and kills repeat.
#ifndef OB_TESTS_FREE_HAND_H
#define OB_TESTS_FREE_HAND_H

#include "free/free.h"
#include "free/lag.h"
#include "free/view.h"

enum { HAND_OBJECTS = 64, HAND_MOST = 128 };

typedef struct hand {
	ob_universe *u;
	uint32_t objects;
	ob_free_sim sim[HAND_MOST];
	ob_free_scratch scratch;
} hand;

// A universe without objects. f->objects and the depths follow.
hand *hand_create(ob_free_settings f, ob_vec3 gravity);
// The same with room for so many objects; hand_create has room for HAND_OBJECTS.
hand *hand_create_for(uint32_t objects, ob_free_settings f, ob_vec3 gravity);
void hand_destroy(hand *h);
// Adds an object; returns its id. mass 0: static.
uint32_t hand_add(hand *h, ob_shape shape, ob_vec3 size, double mass, ob_vec3 at, ob_vec3 velocity, double restitution);
// Removes an object, while all wait.
void hand_remove(hand *h, uint32_t id);
// Lets the simulators run until so many steps (1/60 s) of the host.
void hand_until(hand *h, uint64_t step);
// Makes one step of an object. false: it is blocked, or at the host's boundary.
bool hand_step(hand *h, uint32_t id);
// Steps all in a random order until all are at the boundary. kills: probability that a simulator begins anew after a step.
// Returns false if nobody could step before that.
bool hand_run(hand *h, uint64_t *random, double kills);
// The same with simulators that are stopped for a while. stops: probability of that after a step. Once all others wait for those
// that are stopped, each goes on, or begins anew.
bool hand_run_with_stops(hand *h, uint64_t *random, double kills, double stops);
// Steps all without a lag, the earliest first, until all are at the boundary. false: it is blocked.
bool hand_run_in_order(hand *h);
bool hand_is_there(hand *h);

#endif
