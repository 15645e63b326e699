// The narrow phase: where the two bodies of a pair touch, now or within the coming partial substep.
#ifndef OB_SIM_NARROWPHASE_H
#define OB_SIM_NARROWPHASE_H

#include "contact/manifold.h"
#include "sim/state.h"

// Fills m with the pair's points, their gaps as of now. Fast pairs are followed through the partial substep: *when is
// the time into it at which the points were found (s; 0 otherwise), and their arms run from where the centres are then.
// tolerance: m, gaps up to it are always found. Both bodies' poses must be up to date (ob_body_update_pose).
void ob_narrowphase_find(ob_sim *s, const ob_contact *t, double tolerance, ob_manifold *m, double *when);

// m: the distance of two rows of the island, or less; beyond the margin, some more than that.
double ob_narrowphase_distance(ob_sim *s, uint32_t a, uint32_t b, double margin);

// How deep (m) a shape of this thickness (m) may be in others while it rests on them, and which future (s) is far: see
// ob_placed. pressed: something presses them together; where nothing does, hits leave nothing at rest in another.
double ob_narrowphase_rest_depth(const ob_sim *s, double thickness, bool pressed);
double ob_narrowphase_far_future(const ob_sim *s);

// A body of the island as collision tests take it, in this pose and at these rates.
void ob_narrowphase_place(const ob_sim *s, uint32_t row, ob_vec3 p, const ob_mat3 *r, ob_vec3 v, ob_vec3 w,
			  ob_placed *out);

// The collision test of any two shapes that the run's settings ask for.
ob_manifold_finder ob_narrowphase_finder(ob_sim *s);

// Time of impact of the two, if they go on as they do (s from now); infinity: not before "horizon".
double ob_narrowphase_time_of_impact(ob_sim *s, const ob_contact *t, double horizon);

// The narrow phase that asks no more than whether boxes overlap: ob_manifold_find for the axis-aligned boxes of the two
// shapes, which grow and shrink as what is inside them turns. A plane's box would be all of space: it stays a plane.
// Pure function.
void ob_manifold_aabb(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
