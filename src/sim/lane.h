// Which lane of which batch a touch is solved in. A colour's batches hold no moving body twice.
#ifndef OB_SIM_LANE_H
#define OB_SIM_LANE_H

#include "sim/state.h"

// Takes a lane of the first colour that neither body uses, or gives it back (and its impulses with it: what they
// predicted goes out of dv).
void ob_lane_take(ob_sim *s, ob_contact *t);
void ob_lane_leave(ob_island_work *w, ob_contact *t);
// Writes the touch's geometry into its lane. gap: m, of each point.
void ob_lane_fill(ob_island_work *w, const ob_contact *t, ob_vec3 normal, const double *gap);

// Impulses that go over from an old manifold to a new one.
typedef struct ob_saved_impulses {
	double impulse[OB_PAIR_ROWS];
	ob_vec3 arm[OB_PAIR_POINTS], friction, normal;
	uint32_t points;
} ob_saved_impulses;

// Takes the impulses out of the lane and of dv, before the geometry changes.
void ob_lane_save_impulses(ob_island_work *w, const ob_contact *t, ob_saved_impulses *old);
// Puts them back into the new geometry: points near an old one inherit its impulse, the friction force keeps its
// direction in the world.
void ob_lane_warm_start(ob_island_work *w, const ob_contact *t, ob_saved_impulses *old);

#endif
