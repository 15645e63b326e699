// Impacts with restitution of any number of bodies at any number of points at one instant. Pure functions, thread-safe.
//
// The law, for all points of a set at once: a point that approaches at u leaves at -e u or faster (Newton), and pushes
// only where it leaves at just that; friction has a cone of its own at each point, stops the point's sliding where it
// can, and opposes what sliding is left afterwards where it cannot (Coulomb; as one law: Moreau 1988). Without friction
// and with one e this is a generalised reflection (Smith, Kaufman, Vouga, Tamstorf and Grinspun 2012): bodies break
// away, and what is symmetric stays so, as no point has a turn before another. Repeated while points approach, it
// passes an impact through touching spheres as Newton's cradle does.
//
// Newton's restitution with friction may gain energy (Kane and Levinson 1985), and so may points of different e that
// hit at once. Then as much of the set's plastic impact (e = 0, which only takes energy) is mixed in as brings the gain
// to zero.
//
// Velocities after an impact are unique wherever Coulomb's law has one solution. Where points share a load in more than
// one way (four corners of a face), the solution is that of the least change from equal shares: symmetric in what is
// symmetric.
#ifndef OB_CONTACT_IMPACT_H
#define OB_CONTACT_IMPACT_H

#include "contact/batch.h"

// What moves, at the instant; what does not has no inverse mass and inertia.
typedef struct ob_impact_body {
	double inv_mass; // 1/kg
	double inv_inertia[6]; // world: xx xy xz yy yz zz
	ob_vec3 v, w; // m/s, rad/s
} ob_impact_body;

typedef struct ob_impact_point {
	uint32_t a, b; // bodies
	ob_vec3 normal; // unit, from b to a
	ob_vec3 arm_a, arm_b; // m, from each centre to one and the same point: angular momentum is kept to rounding
	double mu, e; // coefficients of friction and of restitution
} ob_impact_point;

// Inverse inertia in world axes (xx xy xz yy yz zz) of a body with these principal moments (kg m^2) at the attitude r.
void ob_inverse_inertia(ob_vec3 inertia, const ob_mat3 *r, double *out);

// m/s, at which a point opens
double ob_impact_opening(const ob_impact_body *body, const ob_impact_point *point);

// Sets of more points take far longer.
enum { OB_IMPACT_MOST_POINTS = 36 };

// m/s, at which the points approach at most; 0: none does
double ob_impact_approach(const ob_impact_body *body, const ob_impact_point *point, uint32_t points);

// Who pays: told of work as it is done, in units of some 30 ns, again and again. true: it is to end at once, with
// whatever velocities it has found.
typedef struct ob_impact_payer {
	bool (*is_over)(void *with, uint64_t work);
	void *with;
} ob_impact_payer;

// Changes the velocities of the bodies by one impact at all those of the points that approach. Others may approach
// afterwards. Momentum and angular momentum are kept to rounding, energy does not grow.
// payer: NULL = nobody.
void ob_impact_solve(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		     const ob_impact_payer *payer);

// The same again and again until no point approaches, for few points. approach: m/s, of ob_impact_approach. false: some
// still do, and the contact solver must part them.
bool ob_impact_part(ob_impact_body *body, uint32_t bodies, const ob_impact_point *point, uint32_t points,
		    double approach);

// m: points that come within this when the first one hits, hit with it
#define OB_IMPACT_SIMULTANEOUS 1e-7

// ---- whether a contact of a batch will hit, by its rows alone

typedef struct ob_impact {
	double h; // s, partial substep
	double slack; // m: by so much the rows may be off within the partial substep
	double threshold; // m/s: slower approaches are left to the contact solver ..
	double settling; // s: .. and so are those that build up in this time
	double gain; // m/s: no point gains more in the partial substep
	unsigned points; // bit per point that may hit
} ob_impact;

// The state of all bodies at the partial substep's start.
typedef struct ob_impact_rows {
	const ob_body_row *v; // velocities
	const ob_body_row *dv; // change of velocity in the partial substep without the impact: acceleration times h
	const ob_body_row *d; // displacements since the gaps were measured
} ob_impact_rows;

// When will the first point of lane l of the batch hit (s)? Infinity: not within the partial substep.
double ob_impact_time(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at);

#endif
