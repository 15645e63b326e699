// Contact constraints of four pairs of bodies at a time, and what the contact solver does with them.
//
// A pair is one block of seven rows: the four contact points' normal velocities, two of friction at their centroid,
// and the twist about the normal. Its 7x7 Delassus matrix A = J M^-1 J^T is kept, scaled, and the block is solved by a
// few Gauss-Seidel sweeps (Moreau's projected form: Jourdan, Alart and Jean 1998). Where the
// bodies touch nothing else, friction and twist are one row of the sweep: they hold, or slip within the limit surface
// of the patch (contact/patch.h). Elsewhere the friction vector is projected onto a disc of radius mu * (sum of normal
// impulses), the twist onto mu * radius * that sum.
//
// Both bodies of a pair get the same impulse from the same function, with opposite signs: momentum is exact to
// rounding, and neither needs to know who computed it.
//
// Units: SI; impulses in N s, the twist in N m s. Velocity arrays: [body][8], linear 0..2, angular 3..5, world frame.
// Body 0 stands for everything that does not move.
//
// All functions work on what they are given alone: threads may call them at once on different batches and arrays.
#ifndef OB_CONTACT_BATCH_H
#define OB_CONTACT_BATCH_H

#include "elementary/lanes.h"
#include "contact/manifold.h"

enum { OB_POINTS = 4, OB_ROWS = 7 }; // contact points; rows: their normals, two of friction, one of twist

// What a pair has rows for; all pairs of a batch are of one kind.
typedef enum ob_batch_kind {
	OB_KIND_FULL = 0,
	OB_KIND_POINT = 1, // one point at most, so no twist: a sphere against a sphere, a box or a plane
	OB_KIND_FRICTIONLESS = 2,
	OB_KIND_FRICTIONLESS_POINT = OB_KIND_POINT | OB_KIND_FRICTIONLESS,
	OB_KINDS
} ob_batch_kind;

typedef double ob_body_row[8];

// An ellipsoid in place of the limit surface of unit load (contact/patch.h): wrenches x with x inverse x <= 1, where
// "slip" is normal to it. Symmetric: 11 12 13 22 23 33.
typedef struct ob_patch_model {
	lanes surface[6], inverse[6], slip[3];
	lanes pressure[2]; // its centre, in terms of the half edges
	lanes stretch; // slip over impulse, when the patch slid last
	unsigned known; // lanes
} ob_patch_model;

typedef struct ob_batch {
	uint32_t body_a[OB_LANES], body_b[OB_LANES]; // rows of the velocity arrays; 0 in an empty lane
	ob_batch_kind kind;
	unsigned live; // bit per lane in use
	unsigned dirty; // the Delassus matrices are not those of the lanes
	unsigned impact; // lanes whose impulses jumped in this substep: not to be extrapolated
	unsigned elastic; // lanes with restitution
	unsigned isolated; // lanes whose bodies are in no other contact
	unsigned hit; // lanes with a body that was hit within the substep: at its start it was not as its rows say
	unsigned turning; // lanes whose geometry turns within the substep
	unsigned slides; // lanes whose friction was at its limit in the last iteration
	unsigned sweeps; // in the last iteration
	unsigned solved; // isolated lanes that it has solved to the end: it takes no other one
	unsigned active; // other lanes that changed a velocity by more than the wake threshold in the last iteration
	lanes n[3], t1[3], t2[3]; // normal (b to a), tangents
	lanes ja[4][3], jb[4][3]; // angular Jacobian of each normal: r x n
	lanes fa1[3], fb1[3], fa2[3], fb2[3]; // angular Jacobian of friction: r x t, r as of ob_friction_arms
	lanes ia[6], ib[6], ima, imb; // inverse inertia (world: xx xy xz yy yz zz), inverse masses
	lanes ka, kb; // mass splitting: contacts of each body (1 when coloured)
	lanes gap[4]; // m, as of the displacement rows' last reset
	lanes mu, radius;
	// The patch (contact/patch.h), from the centroid along the tangents: half edges of the parallelogram, the
	// points in terms of them, radius of a disc (0: it is the parallelogram).
	lanes patch_e1[2], patch_e2[2], patch_s[4], patch_t[4], disc;
	ob_patch_model model;
	lanes friction_mass[6]; // inverse of A's block of friction and twist: 44 45 46 55 56 66
	// Of friction alone: changes of its impulses that stop the slip, for those that stop each row by itself; the
	// inverse of the largest eigenvalue; times the rows' own; the eigenvalue's square.
	lanes hold[4], slide_mass, slide[2], slide_rate2;
	lanes impulse[7], impulse_start[7]; // now; when the substep began
	lanes bias[4]; // m/s, at which each gap may close
	lanes turn[7]; // m/s, rad/s: in lanes whose geometry turns, what the rest of the substep will add to each row
	double changed,
		residual; // (m/s)^2: of the largest change of a velocity in the last iteration; .. of lanes not solved
	lanes diag[7], inv_diag[7]; // of A; the inverse is 0 for a row that is not in use
	lanes coupling[7][7]; // [i][j] = A_ij / A_jj: impulse i does to row j what so much of impulse j does
} ob_batch;

// How an iteration of the contact solver treats the pairs, the same for all batches.
typedef struct ob_solver_iteration {
	double h; // s, substep
	int block_sweeps; // Gauss-Seidel sweeps inside a block, at most
	double block_tolerance; // m/s: a block need not be solved more finely in this iteration
	double converged; // m/s: a block whose sweep changes less is solved to the end
	double wake_threshold; // m/s: a change above it makes both bodies active
	double impact_threshold; // m/s: an approach or change above it is an impact
	bool first; // of the substep: sets the bias from the gaps
	bool jacobi; // adds the changes to delta instead of the velocities
	bool ghosts; // velocities change between iterations, also those of isolated lanes
	double resting_gap, turning_gap; // m: a point that presses keeps a smaller gap; where the geometry turns
	const ob_body_row *dv; // change of v that is expected in the substep
} ob_solver_iteration;

// A pair's coefficients of friction and of restitution, from those of its bodies.
static inline double ob_pair_friction(double a, double b)
{
	return sqrt(a * b);
}
static inline double ob_pair_restitution(double a, double b)
{
	return ob_max(a, b);
}

void ob_batch_init(ob_batch *b, ob_batch_kind kind);
// What fills a lane. Empty points get no row.
typedef struct ob_batch_lane {
	uint32_t body_a, body_b;
	ob_vec3 normal;
	int points;
	const ob_vec3 *arm_a, *arm_b; // m, from each centre to the points
	const double *gap; // m
	double disc_radius; // m, of ob_manifold
	double mu, e;
	double inv_mass_a, inv_mass_b;
	const double *inv_inertia_a, *inv_inertia_b; // [6]
} ob_batch_lane;
// friction_a, friction_b: m, from each centre to where friction acts (ob_friction_arms), 0 where there are no points.
void ob_batch_set(ob_batch *b, int l, const ob_batch_lane *in, ob_vec3 *friction_a, ob_vec3 *friction_b);
void ob_batch_clear(ob_batch *b, int l);
// The tangents that ob_batch_set uses, so that a friction force can be carried over from older ones.
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
// Where friction acts: in the middle of the points, at the height of the nearest ones, for there the bodies touch. A
// corner that is a millimetre above the ground would lift the middle of all points, and what rolls over an edge would
// slip there. arm_a, arm_b, gap: m, of the points, at least one; n: their normal; a, b: m, from each centre.
void ob_friction_arms(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n, ob_vec3 *a,
		      ob_vec3 *b);
// Delassus matrices, for the mass splitting in ka, kb, unless they are those of the lanes already. The functions below
// do so where they need them, which lanes that are solved by themselves do not.
void ob_batch_prepare(ob_batch *b);

// One iteration: solves all lanes on the velocities u and displacements d as they are, and writes the changes back.
// v: velocities at the substep's start. Lanes that are isolated, with one body that does not answer to impulses, are
// each solved by themselves (contact/lone.h).
void ob_batch_solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		    const ob_body_row *d, ob_body_row *delta);
// Position projection: pushes penetrations beyond slop (m) apart by the share beta, in the displacements only:
// velocities never see it. false: there were none.
bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta);
// The next substep's warm start must not repeat an impact: in lanes with one, impulses keep of what they have grown by
// in this substep no more than cap_impulse (N s, per lane) or cap_velocity (m/s), whichever is more.
void ob_batch_limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity);

// J v: how fast each of the seven rows opens or slides at these velocities.
void ob_batch_row_velocities(const ob_batch *b, const ob_body_row *rows, lanes *r);
// M^-1 J^T x: adds what the impulses x of all lanes do to the velocities.
void ob_batch_apply_impulses(const ob_batch *b, const lanes *x, ob_body_row *rows);
static const double ob_no_contact = 1e3; // m: the gap of a point that is not there

// Is there such a point?
static inline bool ob_batch_has_point(const ob_batch *b, int l, int point)
{
	return b->gap[point][l] < .5 * ob_no_contact;
}

#endif
