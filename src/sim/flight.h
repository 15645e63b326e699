// Free flight. An object that touches nothing follows a closed form from the instant at which its flight began. When it
// is solved, its next impact on a plane is computed ahead (conservative advancement), and no step solves it before
// that; what else may touch it, the forecast sees (late_contacts.h), and two that meet are moved together.
//
//   solved              not solved              solved
//   ──┬───────────────┬───────────── … ──────┬──────────┬──
//     │ flight        │ (readers evaluate it)  │ impact │      valid_until = the impact, or the horizon
//     └─ published ───┴──> valid_until ────────┴─ published
#ifndef OB_SIM_FLIGHT_H
#define OB_SIM_FLIGHT_H

#include "motion/flight.h"
#include "sim/state.h"

// The flight of an object without contacts at the start of the running step: the one published or, where its external
// acceleration has changed since, one that begins now. It meets no plane before valid_until.
ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id);
// As ob_state_now at an instant (s), to the last bit, with the worker's cached rotation.
ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *flight, double time);

enum { OB_COURSES = OB_LANDINGS }; // that are followed side by side, at most

// Makes ready what ob_ballistic_state is asked for next, of n objects (up to OB_COURSES) at the same instant. It gives
// what it would have given without that.
void ob_ballistic_prepare(ob_sim *s, const uint32_t *id, const ob_motion *const *flight, double time, uint32_t n);

// Moves up to OB_COURSES objects without contacts through the running step, each with its impacts on planes, and
// publishes their motions: what each does follows from itself alone. done, of each; false: the contact solver must do
// it, and nothing was changed.
void ob_ballistic_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done);
// Of two objects that are near nothing but each other and planes: their hits are made at their instants, and each goes
// on as a flight (ballistic_pair.c). Without substeps, and without a frame: two that fall alike are straight on their
// way to each other.
bool ob_ballistic_pair_advance(ob_sim *s, const uint32_t id[2]);

// Publishes the motion m of an object that must be solved in the next step, or rests until something comes near it: its
// fat AABB for that step, from its state at the end of this one, its schedule record, and m, which gets its reach.
void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end);

// ---- a flight within the running step: as far as it is known, from one impact to the next
//
//   begin ──> follow ──> rebound (on a plane), or set_off (as who has hit it leaves it) ──> publish
//               ^                                │
//               └──────── find_landings <────────┘

typedef struct ob_course {
	uint32_t id, impacts;
	ob_motion m; // since the last impact; it meets a plane at valid_until, or is not known beyond
	ob_spin *spin; // of m; NULL: it does not turn, or that cannot be seen
	ob_spin own;
	uint32_t plane; // that it meets
	uint64_t work; // of looking for where it lands (sim/budget.h): whose share it is, notes it
	double since, horizon; // s: so far it has come; and no farther is it computed
} ob_course;

// n: up to OB_COURSES, of different objects
void ob_courses_begin(ob_sim *s, const uint32_t *id, ob_course *c, uint32_t n);
// Where each goes from where it was hit.
void ob_courses_find_landings(ob_sim *s, ob_course *const *c, uint32_t n);
// To an instant (s) that is no later than m.valid_until.
void ob_course_follow(ob_sim *s, ob_course *c, double until);
// Where it has come to.
ob_state ob_course_state(ob_sim *s, const ob_course *c);
// It is hit there, and this is how it goes on. false: it has been hit too often for a step.
bool ob_course_set_off(ob_sim *s, ob_course *c, const ob_state *at);
// It has come to the plane. false: it does not rebound, or was hit too often.
bool ob_course_rebound(ob_sim *s, ob_course *c);
// At the step's end.
void ob_course_publish(ob_sim *s, ob_course *c);

#endif
