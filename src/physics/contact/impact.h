// Impacts with restitution of any number of bodies at any number of points at one instant. Pure functions, thread-safe.
//
// The law holds for all points of a set at once. A point that approaches at u leaves at -e u or faster (Newton); it has
// an impulse only if it leaves at just that speed. Friction has a cone of its own at each point. It stops the sliding
// if it can, and otherwise opposes the sliding that is left afterwards (Coulomb; as one law: Moreau 1988). Without
// friction and with one e this is a generalised reflection (Smith, Kaufman, Vouga, Tamstorf and Grinspun 2012). Bodies
// break away, and symmetry is kept, as no point has a turn before another. Repeated while points approach, it passes an
// impact through touching spheres as Newton's cradle does.
//
// Newton's restitution with friction may gain energy (Kane and Levinson 1985), and so may points of different e that
// hit at once. Then as much of the set's plastic impact (e = 0, which only takes energy) is mixed in as makes the gain
// zero.
//
// Velocities after an impact are unique wherever Coulomb's law has one solution. If points can share a load in more
// than one way (four corners of a face), the solution is the one nearest to equal shares: symmetric for a symmetric
// set.
#ifndef OB_CONTACT_IMPACT_H
#define OB_CONTACT_IMPACT_H

#include "contact/batch.h"

// Body at the instant of the impact. Inverse mass and inertia are 0 if it cannot move.
typedef struct ob_impact_body {
	double inv_mass; // 1/kg
	double inv_inertia[6]; // world: xx xy xz yy yz zz
	ob_vec3 v, w; // m/s, rad/s
} ob_impact_body;

typedef struct ob_impact_point {
	uint32_t a, b; // bodies
	ob_vec3 normal; // unit, from b to a
	ob_vec3 arm_a, arm_b; // m, from each centre to the same point: angular momentum is conserved to rounding
	double mu, e; // coefficients of friction and of restitution
} ob_impact_point;

// Inverse inertia in world axes (xx xy xz yy yz zz) of a body with these principal moments (kg m^2) at the attitude r.
void ob_inverse_inertia(ob_vec3 inertia, const ob_mat3 *r, double *out);

// Speed (m/s) at which a point opens.
double ob_impact_opening(const ob_impact_body *body, const ob_impact_point *point);

// Larger sets take far longer.
enum { OB_IMPACT_MOST_POINTS = 36 };

// Largest speed (m/s) at which a point approaches; 0: none does.
double ob_impact_approach(const ob_impact_body *body, const ob_impact_point *point, uint32_t points);

// Budget of a computation. is_over receives the work done since its last call, in units of some 30 ns. It returns true
// to end the computation at once, with the velocities found so far.
typedef struct ob_impact_payer {
	bool (*is_over)(void *with, uint64_t work);
	void *with;
} ob_impact_payer;

typedef struct ob_impact_change {
	ob_vec3 v, w; // m/s, rad/s
} ob_impact_change;

// Joints between the bodies of a set. share: adds the joints' share to changes of velocities, one for each body, that
// impulses at points alone would make: a projection, linear, self-adjoint in the metric of the masses.
typedef struct ob_impact_links {
	void (*share)(void *with, ob_impact_change *change);
	void *with;
} ob_impact_links;

// Changes the velocities of the bodies by one impact at all points that approach. Plastic points (e = 0) take part,
// too, if the impact would close them. Others may approach afterwards. Momentum and angular momentum are conserved to
// rounding, energy does not grow. links: NULL: no joints. payer: NULL: no budget.
void ob_impact_solve(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		     const ob_impact_links *links, const ob_impact_payer *payer);

// Repeats ob_impact_solve until no point approaches, for few points. approach: m/s, from ob_impact_approach. Returns
// false if some still do: the contact solver must separate them.
bool ob_impact_part(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		    double approach);

// m: points nearer than this when the first one hits, hit with it
#define OB_IMPACT_SIMULTANEOUS 1e-7

// ---- prediction of an impact from the rows of a batch

typedef struct ob_impact {
	double h; // s, partial substep
	double slack; // m: error of the rows within the partial substep
	double threshold; // m/s: slower approaches are left to the contact solver
	double settling; // s: so are approaches that build up within this time
	double gain; // m/s: upper bound on a point's gain of speed in the partial substep
	unsigned points; // bit per point that may hit
} ob_impact;

// State of all bodies at the partial substep's start.
typedef struct ob_impact_rows {
	const ob_body_row *v; // velocities
	const ob_body_row *dv; // change of velocity in the partial substep without the impact: acceleration times h
	const ob_body_row *d; // displacements since the gaps were measured
} ob_impact_rows;

// Time (s) at which the first point of lane l hits; infinity: not within the partial substep.
double ob_impact_time(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at);

#endif
