// The pair kernel: what passes between two touching objects, for four pairs at a time.
//
// A pair is one block of seven rows: the four contact points' normal velocities, two of friction at their centroid,
// and the twist about the normal. Its 7x7 Delassus matrix A = J M^-1 J^T is kept, scaled, and the block is solved by a few
// Gauss-Seidel sweeps (Moreau's projected form: Jourdan, Alart and Jean 1998) with a true friction cone: the friction
// vector is projected onto a disc of radius mu * (sum of normal impulses), the twist onto mu * radius * that sum.
//
// Both members of a pair get the same impulse from the same function, with opposite signs: momentum is exact to
// rounding, and no member needs to know who computed it.
//
// Units: SI; impulses in N s, the twist in N m s. Velocity arrays: [body][8], linear 0..2, angular 3..5, world frame.
// Body 0 stands for everything that does not move.
#ifndef OB_CONTACT_BATCH_H
#define OB_CONTACT_BATCH_H

#include "contact/lanes.h"
#include "contact/manifold.h"

enum { OB_POINTS = 4, OB_ROWS = 7 }; // contact points; rows: their normals, two of friction, one of twist

// What a pair has rows for; all pairs of a batch are of one kind.
typedef enum ob_kind {
	OB_KIND_FULL = 0,
	OB_KIND_POINT = 1, // one point at most, so no twist: a sphere against a sphere, a box or a plane
	OB_KIND_SLICK = 2, // no friction
	OB_KIND_SLICK_POINT = OB_KIND_POINT | OB_KIND_SLICK,
	OB_KINDS
} ob_kind;

typedef double ob_body_row[8];

typedef struct ob_batch {
	uint32_t body_a[OB_LANES], body_b[OB_LANES]; // rows of the velocity arrays; 0 in an empty lane
	ob_kind kind;
	unsigned live; // bit per lane in use
	unsigned dirty; // the Delassus matrices must be made anew
	unsigned impact; // lanes whose impulses jumped in this substep: not to be extrapolated
	unsigned elastic; // lanes with restitution
	unsigned alone; // lanes whose bodies touch nothing else
	unsigned hot; // lanes that changed a velocity noticeably in the last pass
	lanes n[3], t1[3], t2[3]; // normal (b to a), tangents
	lanes ja[4][3], jb[4][3]; // r x n of each point
	lanes fa1[3], fb1[3], fa2[3], fb2[3]; // r x t at the centroid
	lanes ia[6], ib[6], ima, imb; // inverse inertia (world: xx xy xz yy yz zz), inverse masses
	lanes ka, kb; // mass splitting: contacts of each body (1 when coloured)
	lanes gap[4]; // m, as of the displacement rows' last reset
	lanes mu, radius;
	lanes impulse[7], impulse_start[7]; // now; when the substep began
	lanes bias[4]; // m/s
	lanes moved; // m/s: the largest change of a velocity in the last pass
	lanes diag[7], inv_diag[7]; // of A; the inverse is 0 for a row that is not in use
	lanes spread[7][7]; // [i][j] = A_ij / A_jj: impulse i does to row j what so much of impulse j does
} ob_batch;

// How a pass treats the pairs, the same for all batches.
typedef struct ob_pass {
	double h; // s, substep
	int sweeps; // inside a block, at most
	double fine; // m/s: a block need not be solved finer in this round
	double wake; // m/s: a change above it makes both bodies hot
	double jump; // m/s: an approach or change above it is an impact
	bool first; // of the substep: sets the bias from the gaps
	bool jacobi; // adds the changes to delta instead of the velocities
} ob_pass;

void ob_batch_init(ob_batch *b, ob_kind kind);
// Fills lane l. ra, rb: arms of the points; centroid arms ca, cb; empty points get gap = OB_NO_CONTACT.
typedef struct ob_lane {
	uint32_t body_a, body_b;
	ob_vec3 normal;
	int points;
	const ob_vec3 *arm_a, *arm_b;
	const double *gap;
	double mu, e;
	double inv_mass_a, inv_mass_b;
	const double *inv_inertia_a, *inv_inertia_b; // [6]
} ob_lane;
void ob_batch_set(ob_batch *b, int l, const ob_lane *in);
void ob_batch_clear(ob_batch *b, int l);
// The tangents that ob_batch_set uses, so that a friction force can be carried over from older ones.
void ob_tangents(ob_vec3 n, ob_vec3 *t1, ob_vec3 *t2);
// Delassus matrices, for the mass splitting in ka, kb.
void ob_batch_prepare(ob_batch *b);

// One exchange: solves all lanes on the published velocities u and displacements d, publishes the changes.
// v: velocities at the substep's start.
void ob_batch_solve(ob_batch *b, const ob_pass *pass, ob_body_row *u, const ob_body_row *v, const ob_body_row *d,
		    ob_body_row *delta);
// Pushes penetrations beyond slop (m) apart by the share beta, in the displacements only: velocities never see it.
// false: there were none.
bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta);
// After an impact the predicted impulses are the impact's: takes back what exceeds the cap.
// cap (m/s per unit of A): per lane, the largest plausible growth of an impulse (N s).
void ob_batch_cap(ob_batch *b, const double *cap_impulse, double cap_velocity);

// How fast each of the seven rows opens or slides at the given rows' velocities.
void ob_batch_rates(const ob_batch *b, const ob_body_row *rows, lanes *r);
// Adds what the impulses x of all lanes do to the rows.
void ob_batch_push(const ob_batch *b, const lanes *x, ob_body_row *rows);

#endif
