// Contact constraints of four pairs of bodies at a time, one per lane, and the contact solver's operations on them.
//
// A pair is one block of seven rows: normal velocities of four contact points, two rows of friction at their centroid,
// and the twist about the normal. Its 7x7 Delassus matrix A = J M^-1 J^T is stored, scaled. A few Gauss-Seidel sweeps
// solve the block (Moreau's projected form: Jourdan, Alart and Jean 1998). If the bodies have no other contact, a sweep
// solves friction and twist together: they hold, or slip within the limit surface of the patch (contact/patch.h).
// Otherwise the friction vector is projected onto a disc of radius mu * (sum of normal impulses), the twist onto mu *
// radius * that sum; or both follow the load, in the lanes "follows".
//
// Both bodies of a pair receive the same impulse from the same function, with opposite signs: momentum is conserved to
// rounding, whichever worker computes it.
//
// Units: SI; impulses in N s, the twist in N m s. Velocity arrays: [body][8], linear 0..2, angular 3..5, world frame.
// Body 0 stands for everything that does not move.
//
// A row's part of J is defined once, by ob_batch_row: kernels, the direct solver and Newton steps on few contacts take it
// from there. The laws of its impulse: x >= 0 for a normal, those of contact/friction.h for friction and twist.
//
// Functions use their arguments alone: threads may call them at once on different batches and arrays.
#ifndef OB_CONTACT_BATCH_H
#define OB_CONTACT_BATCH_H

#include "elementary/lanes.h"
#include "contact/area.h"

enum { OB_POINTS = 4, OB_ROWS = 7 }; // contact points; rows: normals, two of friction, one of twist
enum { OB_ROW_FRICTION = OB_POINTS, OB_ROW_TWIST = OB_ROWS - 1 }; // first row of friction; the row of twist

// Rows of a pair; all pairs of a batch are of one kind.
typedef enum ob_batch_kind {
	OB_KIND_FULL = 0,
	OB_KIND_POINT = 1, // one point at most, so no twist: a sphere against a sphere, a box or a plane
	OB_KIND_FRICTIONLESS = 2,
	OB_KIND_FRICTIONLESS_POINT = OB_KIND_POINT | OB_KIND_FRICTIONLESS,
	OB_KINDS
} ob_batch_kind;

typedef double ob_body_row[8];

// Ellipsoid in place of the limit surface of unit load (contact/patch.h): wrenches x with x inverse x <= 1. It touches
// the limit surface where "slip" is normal to both. Symmetric matrices: 11 12 13 22 23 33.
typedef struct ob_patch_model {
	lanes surface[6], inverse[6], slip[3];
	lanes pressure[2]; // centre of pressure for which it holds, in half edges
	lanes stretch; // slip over impulse, as of the last time the patch slid
	unsigned known; // lanes with a valid ellipsoid
} ob_patch_model;

typedef struct ob_batch {
	uint32_t body_a[OB_LANES], body_b[OB_LANES]; // rows of the velocity arrays; 0 in an empty lane
	ob_batch_kind kind;
	unsigned live; // bit per lane in use
	unsigned dirty; // the Delassus matrices are out of date
	unsigned impact; // lanes whose impulses jumped in this substep: they must not be extrapolated
	unsigned elastic; // lanes with restitution
	unsigned isolated; // lanes whose bodies are in no other contact
	unsigned areas; // lanes whose contact area is a polygon (contact/area.h), not the parallelogram
	unsigned hit; // lanes with a body that was hit within the substep: the rows differ from those of its start
	unsigned turning; // lanes whose geometry turns within the substep
	unsigned slides; // lanes whose friction was at its limit in the last iteration
	unsigned
		follows; // lanes whose friction follows the load: patches of known pressure that slide throughout the substep
	unsigned unloaded; // lanes without a load when the substep began
	unsigned sweeps; // number in the last iteration
	unsigned solved; // isolated lanes that the last iteration has solved to the end: they need no other
	unsigned active; // other lanes whose velocities changed by more than the wake threshold in the last iteration
	lanes n[3], t1[3], t2[3]; // normal (b to a), tangents
	lanes ja[4][3], jb[4][3]; // angular Jacobian of each normal: r x n
	lanes fa1[3], fb1[3], fa2[3], fb2[3]; // angular Jacobian of friction: r x t, r from ob_friction_arms
	lanes ia[6], ib[6], ima, imb; // inverse inertia (world: xx xy xz yy yz zz), inverse masses
	lanes ka, kb; // mass splitting: contacts of each body (1 when coloured)
	lanes gap[4]; // m, as of the displacement rows' last reset
	lanes mu, radius;
	// Patch (contact/patch.h), from the centroid along the tangents: half edges of the parallelogram, points in
	// half edges, radius of a disc (0: a parallelogram).
	lanes patch_e1[2], patch_e2[2], patch_s[4], patch_t[4], disc;
	ob_patch_model model;
	lanes follow[2], follow_twist[4]; // in "follows": friction for a unit of load; twist for a unit of each point's
	lanes friction_mass[6]; // inverse of A's block of friction and twist: 44 45 46 55 56 66
	// Block of friction alone. hold: matrix from the impulses that stop each row by itself to those that stop both.
	// slide_mass: inverse of the largest eigenvalue; slide: slide_mass times the diagonal; slide_rate2: eigenvalue
	// squared.
	lanes hold[4], slide_mass, slide[2], slide_rate2;
	lanes impulse[7], impulse_start[7]; // now; when the substep began
	lanes bias[4]; // m/s: speed at which each gap may close
	lanes turn[7]; // m/s, rad/s: change of each row by the rest of the substep, in lanes whose geometry turns
	// (m/s)^2: square of the largest change of a velocity in the last iteration, in all lanes and in those not solved
	double changed, residual;
	lanes diag[7], inv_diag[7]; // diagonal of A; the inverse is 0 for an unused row
	// [i][j] = A_ij / A_jj: the amount of impulse j that changes row j as a unit of impulse i does
	lanes coupling[7][7];
	ob_contact_area area[OB_LANES]; // of the lanes in "areas"
} ob_batch;

// Row of a pair. An impulse of it acts on body a along "along" and about "about_a", on body b against "along" and
// "about_b"; its velocity is along (va - vb) + about_a wa - about_b wb.
typedef struct ob_row {
	const lanes *along; // [3]; NULL: a torque
	const lanes *about_a, *about_b; // [3], m: arm x along; unit for a torque
} ob_row;

static inline ob_row ob_batch_row(const ob_batch *b, int row)
{
	if (row < OB_POINTS)
		return (ob_row){ b->n, b->ja[row], b->jb[row] };
	if (row == OB_ROW_TWIST)
		return (ob_row){ NULL, b->n, b->n };
	return row == OB_ROW_FRICTION ? (ob_row){ b->t1, b->fa1, b->fb1 } : (ob_row){ b->t2, b->fa2, b->fb2 };
}

// Parameters of an iteration of the contact solver, the same for all batches.
typedef struct ob_solver_iteration {
	double h; // s, substep
	int block_sweeps; // maximum of Gauss-Seidel sweeps inside a block
	double block_tolerance; // m/s: sweeps over a block end below this change, except in isolated lanes
	double converged; // m/s: a block is solved to the end if a sweep changes less
	double wake_threshold; // m/s: a change above it makes both bodies active
	double impact_threshold; // m/s: an approach or change above it is an impact
	bool first; // first iteration of the substep: sets the bias from the gaps
	bool jacobi; // adds the changes to delta instead of the velocities
	bool ghosts; // velocities change between iterations, even in isolated lanes
	double resting_gap; // m: a loaded point keeps a gap below this
	const ob_body_row *dv; // expected change of v in the substep
} ob_solver_iteration;

// Coefficients of friction and of restitution of a pair, from those of its bodies.
static inline double ob_pair_friction(double a, double b)
{
	return sqrt(a * b);
}
static inline double ob_pair_restitution(double a, double b)
{
	return ob_max(a, b);
}

void ob_batch_init(ob_batch *b, ob_batch_kind kind);
// Input of a lane. Absent points get no row.
typedef struct ob_batch_lane {
	uint32_t body_a, body_b;
	ob_vec3 normal;
	int points;
	const ob_vec3 *arm_a, *arm_b; // m, from each centre to the points
	const double *gap; // m
	double disc_radius; // m, see ob_manifold
	double mu, e;
	double inv_mass_a, inv_mass_b;
	const double *inv_inertia_a, *inv_inertia_b; // [6]
} ob_batch_lane;
// Fills lane l. friction_a, friction_b: m, from each centre to where friction acts (ob_friction_arms), 0 without
// points.
void ob_batch_set(ob_batch *b, int l, const ob_batch_lane *in, ob_vec3 *friction_a, ob_vec3 *friction_b);
void ob_batch_clear(ob_batch *b, int l);
// Tangents of ob_batch_set: a friction force is carried over from older ones with them.
static inline void ob_tangents(ob_vec3 n, ob_vec3 *t1, ob_vec3 *t2)
{
	if (fabs(n.z) > .7) {
		double k = 1 / sqrt(n.y * n.y + n.z * n.z);
		*t1 = ob_v3(0, -n.z * k, n.y * k);
	} else {
		double k = 1 / sqrt(n.x * n.x + n.y * n.y);
		*t1 = ob_v3(-n.y * k, n.x * k, 0);
	}
	*t2 = ob_cross(n, *t1);
}
// Finds the point where friction acts: at the mean of the points, at the height of the nearest ones, since the bodies
// touch there. A corner a millimetre above the ground would raise the mean, and a body rolling over an edge would slip.
// arm_a, arm_b, gap: m, of the points, at least one; n: their normal; a, b: m, from each centre.
void ob_friction_arms(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n, ob_vec3 *a,
		      ob_vec3 *b);
// Computes the Delassus matrices for the mass splitting in ka, kb, unless they are up to date. The functions below call
// it if they need them. Lanes that are solved by themselves do not.
void ob_batch_prepare(ob_batch *b);

// Finds which of the patches in "follows" slide throughout the substep, and in which direction: before the first iteration,
// when all impulses are those expected. v, u: velocities when the substep began, and as these impulses leave them.
void ob_batch_find_follows(ob_batch *b, const ob_body_row *v, const ob_body_row *u);
// One iteration: solves all lanes for the present velocities u and displacements d, and applies the changes. v:
// velocities at the substep's start. A lane is solved by itself (contact/lone.h) if it is isolated, has no disc, and
// impulses move only one of its bodies.
void ob_batch_solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		    const ob_body_row *d, ob_body_row *delta);
// Position projection: moves penetrations beyond slop (m) apart by the fraction beta, in the displacements only;
// velocities stay. Returns false if there were none.
bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta);
// Keeps the next substep's warm start from repeating an impact: limits the growth of impulses in this substep, in lanes
// with an impact. The limit is cap_impulse (N s, per lane) or the impulse that changes the row by cap_velocity (m/s),
// whichever is more.
void ob_batch_limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity);

// Finds a row of J for lane l: the parts of both bodies, m and rad.
void ob_batch_row_of_lane(const ob_batch *b, int l, int row, double *of_a, double *of_b);
// Velocity of normal row j of lane l (m/s) by the motions of its bodies; of displacements: the way by which it opens (m).
static inline double ob_batch_opening(const ob_batch *b, uint32_t l, uint32_t j, const double *xa, const double *xb)
{
	double sum = 0;
	for (int c = 0; c < 3; c++)
		sum += b->n[c][l] * (xa[c] - xb[c]) + b->ja[j][c][l] * xa[3 + c] - b->jb[j][c][l] * xb[3 + c];
	return sum;
}
// Load of lane l: the sum of its normal impulses (N s).
static inline double ob_batch_load(const ob_batch *b, uint32_t l)
{
	return b->impulse[0][l] + b->impulse[1][l] + b->impulse[2][l] + b->impulse[3][l];
}
static inline ob_vec3 ob_batch_vector(const lanes *x, uint32_t l)
{
	return ob_v3(x[0][l], x[1][l], x[2][l]);
}
// J v: opening, sliding and spinning rates (m/s, rad/s) of the seven rows at these velocities.
void ob_batch_row_velocities(const ob_batch *b, const ob_body_row *rows, lanes *r);
// Adds M^-1 J^T x to the rows: velocity changes by the impulses x of all lanes.
void ob_batch_apply_impulses(const ob_batch *b, const lanes *x, ob_body_row *rows);
static const double ob_no_contact = 1e3; // m: gap of an absent point

// True if the lane has this point.
static inline bool ob_batch_has_point(const ob_batch *b, int l, int point)
{
	return b->gap[point][l] < .5 * ob_no_contact;
}

#endif
