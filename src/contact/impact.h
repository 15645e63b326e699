// Impacts with restitution, at their own instant inside a substep. Pure functions, thread-safe.
//
// Two bodies that approach faster than a threshold and will touch within the substep get one impulse: that of the
// plastic impact with friction, times 1 + e (Poisson's hypothesis for the whole block), so that each point that hits
// leaves at e times its approach at the instant of contact, and no pair ever gains energy. Newton's law point by point
// with friction does gain (Kane and Levinson 1985). One pair at a time, each on the velocities that the pair before has
// left: an impact travels through a row of touching spheres as it does in Newton's cradle.
#ifndef OB_CONTACT_IMPACT_H
#define OB_CONTACT_IMPACT_H

#include "contact/batch.h"

typedef struct ob_impact {
	double h; // s, substep
	double within; // s: later hits are left; at most h
	double e; // restitution
	double threshold; // m/s: slower approaches are left to the contact solver
	double split_a, split_b; // impacts that each body takes part in at once; 1 when coloured
} ob_impact;

// The state of all bodies at the substep's start.
typedef struct ob_impact_rows {
	const ob_body_row *v; // velocities
	const ob_body_row *dv; // change of velocity in the substep without the impact: acceleration times h
	const ob_body_row *d; // displacements since the gaps were measured
} ob_impact_rows;

// When will the first point of lane l of the batch hit (s)? Infinity: not within the substep.
double ob_impact_time(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at);

// Solves it: adds the changes to the rows out_v and, so that the old velocity holds until the instant, to out_d
// (which may be at->v and at->d themselves). Returns the instant of the last point's hit (s); < 0: nothing hits.
double ob_impact_solve(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at, ob_body_row *out_v,
		       ob_body_row *out_d);

// ---- an impact at a single point

typedef struct ob_point_impact {
	double inv_mass; // 1/kg
	ob_vec3 inertia; // kg m^2, principal
	double friction, restitution; // of the pair
} ob_point_impact;

// One point of a body hits what does not move: most of what happens to bodies that fly. Changes state->v and state->w
// by the impulse on the point at "arm" (m, from the centre, world frame) of a surface with this unit normal. The point
// must approach. The normal velocity afterwards is -restitution times that before where friction sticks or there is
// none, and energy never grows.
void ob_point_impact_solve(const ob_point_impact *r, ob_vec3 arm, ob_vec3 normal, ob_state *state);

#endif
