// The narrow phase: finds where the two bodies of a pair touch, now or within the coming partial substep.
#ifndef OB_SOLVER_NARROWPHASE_H
#define OB_SOLVER_NARROWPHASE_H

#include "contact/manifold.h"
#include "solver/solver.h"

// Fills m with the pair's points and their present gaps. Fast pairs are followed through the partial substep: *when is
// the time into it at which the points were found (s; 0 otherwise), and their arms run from the centres at that time.
// tolerance: m, gaps up to it are always found. Both bodies' poses must be up to date (ob_body_update_pose).
void ob_narrowphase_find(ob_solver *s, const ob_contact *t, double tolerance, ob_manifold *m, double *when);

// Lower bound, m, of the distance of two rows of the island, compounds as the hull of their parts; beyond the margin, a
// value somewhat larger than it.
double ob_narrowphase_distance(ob_solver *s, uint32_t a, uint32_t b, double margin);

// Depth (m) to which a shape of this thickness (m) may rest in others, and the time (s) that counts as far future: see
// ob_placed. pressed: something presses the bodies together; without it, hits leave nothing at rest in another body.
double ob_narrowphase_rest_depth(const ob_solver *s, double thickness, bool pressed);
double ob_narrowphase_far_future(const ob_solver *s);

// Fills in a body of the island for collision tests, in this pose and at these rates. part: of a compound; NULL: all of
// the body.
void ob_narrowphase_place(const ob_solver *s, uint32_t row, const ob_hull *part, ob_vec3 p, const ob_mat3 *r, ob_vec3 v,
			  ob_vec3 w, ob_placed *out);

// Returns the collision test that the run's settings ask for; it takes any two shapes.
ob_manifold_finder ob_narrowphase_finder(ob_solver *s);
// The same for searches in time (contact/manifold.h): notes the work of an advance, too.
ob_manifold_finder ob_narrowphase_follower(ob_solver *s);

// Time of impact (s from now) of the two, if they go on as they do; infinity: not before "horizon".
double ob_narrowphase_time_of_impact(ob_solver *s, const ob_contact *t, double horizon);

// Tests two shapes, and notes the work of finding their points: ob_methods.find.
void ob_shapes_find(ob_solver *s, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// Finds the area of a contact with a lane at the present poses. Returns false if it is a parallelogram, or no area.
bool ob_narrowphase_area(const ob_solver *s, const ob_contact *contact, ob_contact_area *out);

#endif
