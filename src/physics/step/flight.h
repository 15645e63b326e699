// Free flight. An object that touches nothing follows a closed form from the start of its flight. When it is solved,
// its next impact on a plane is computed ahead (conservative advancement), and no step solves it before that. The
// forecast detects other objects that may touch it (late_contacts.h); two flying objects that meet are moved together. Terrain
// that is flat as far as the fat AABB reaches (terrain.h) is a plane to a flight that the forecast has ended.
//
//   solved              not solved              solved
//   ──┬───────────────┬───────────── … ──────┬──────────┬──
//     │ flight        │ (readers evaluate it)  │ impact │      valid_until = the impact, or the horizon
//     └─ published ───┴──> valid_until ────────┴─ published
#ifndef OB_STEP_FLIGHT_H
#define OB_STEP_FLIGHT_H

#include "motion/deviation.h"
#include "motion/flight.h"
#include "step/state.h"

// Returns the flight of an object without contacts at the start of the running step. It is the published one; if the
// external acceleration has changed since, one that begins now. It meets no plane before valid_until.
ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id);
// Returns the state at an instant (s): the same bits as ob_state_now, with the worker's cached rotation.
ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *flight, double time);

enum { OB_COURSES = OB_LANDINGS }; // courses that are followed side by side, at most

// Prepares the next calls of ob_ballistic_state for n objects (up to OB_COURSES) at the same instant (s). Does not
// change their results.
void ob_ballistic_prepare(ob_sim *s, const uint32_t *id, const ob_motion *const *flight, double time, uint32_t n);

// Moves up to OB_COURSES objects without contacts through the running step, with their impacts on planes, and publishes
// their motions. Each result depends on its object alone. done[k] false: the contact solver must move object k; nothing
// was changed for it.
void ob_ballistic_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done);
// Moves two objects that are near nothing but each other and planes: makes their impacts at the right instants, and
// publishes the flights that follow (ballistic_pair.c). Uses no substeps, and no frame: two bodies that fall alike
// approach in straight lines. Returns false, with nothing published, if the contact solver must move them.
bool ob_ballistic_pair_advance(ob_sim *s, const uint32_t id[2]);

// Publishes the motion m of an object that must be solved in the next step, or rests until something comes near.
// Updates its fat AABB for that step from its state at the end of this one, its schedule record, and m->reach.
void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end);

// ---- course: a flight within the running step, known from one impact to the next
//
//   begin ──> follow ──> rebound (on a plane), or set_off (with velocities after another hit) ──> publish
//               ^                                │
//               └──────── find_landings <────────┘

typedef struct ob_course {
	uint32_t id, impacts;
	ob_motion m; // flight since the last impact; at valid_until it meets a plane, or is not computed further
	ob_spin *spin; // rotation of m; NULL: none, or none visible
	ob_spin own;
	uint32_t plane; // plane met at valid_until, or terrain; UINT32_MAX: the contact solver must find what it meets
	ob_half_space ground; // of that plane
	uint64_t work; // work of the search for landings (step/budget.h); the object's share notes it
	double since, horizon; // s: present time of the course; bound of the time for which it is computed
} ob_course;

// Begins n courses, up to OB_COURSES, of different objects.
void ob_courses_begin(ob_sim *s, const uint32_t *id, ob_course *c, uint32_t n);
// Finds the next landing of each course from its present time on.
void ob_courses_find_landings(ob_sim *s, ob_course *const *c, uint32_t n);
// Advances to an instant (s) that is not later than m.valid_until.
void ob_course_follow(ob_sim *s, ob_course *c, double until);
// Returns the present state of the course.
ob_state ob_course_state(ob_sim *s, const ob_course *c);
// Returns its deviation (motion/deviation.h) at the step's end.
ob_deviation ob_course_deviation(const ob_sim *s, const ob_course *c);
// Continues from the state after an impact; most: the larger deviation of those that met. Returns false if the object was
// hit too often for a step.
bool ob_course_set_off(ob_sim *s, ob_course *c, const ob_state *at, ob_deviation most);
// Rebounds from the plane that it has reached. Returns false if it does not rebound, or was hit too often.
bool ob_course_rebound(ob_sim *s, ob_course *c);
// Publishes the course at the step's end.
void ob_course_publish(ob_sim *s, ob_course *c);

#endif
