// A flight within the running step: as far as it is known, from one impact to the next. By flight.h for a body that is
// alone, by meeting.h for two.
//
//   begin ──> follow ──> rebound (on a plane), or set_off (as who has hit it leaves it) ──> follow ──> .. ──> publish
#ifndef OB_SIM_COURSE_H
#define OB_SIM_COURSE_H

#include "sim/state.h"

typedef struct ob_course {
	uint32_t id, impacts;
	bool alone; // the rotation is the cache's: another course may take its place there
	ob_motion m; // since the last impact; it meets a plane at valid_until, or is not known beyond
	ob_spin *spin; // of m; NULL: it does not turn, or that cannot be seen
	ob_spin own;
	uint32_t plane; // that it meets
	double since, horizon; // s: so far it has come; and no farther is it computed
} ob_course;

void ob_course_begin(ob_sim *s, uint32_t id, bool alone, ob_course *c);
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
