// Working state of one island through one step, private to the worker that solves it. Plain data: the files that solve
// an island (island_solver.c is their table of contents) share it, and say which part of it they write.
//
// Velocities lie in rows (contact/batch.h). v: at the start of the partial substep. dv: change by external acceleration
// and by the impulses of the last partial substep at the present contacts (the warm start). u = v + dv, solved to the
// partial substep's end. d: displacement since the poses were last updated. Row 0 stands for all that does not move.
#ifndef OB_SOLVER_ISLAND_H
#define OB_SOLVER_ISLAND_H

#include <assert.h>

#include <ob/joint.h>

#include "contact/batch.h"
#include "contact/impact.h"
#include "motion/deviation.h"
#include "solver/sparse_solver.h"
#include "settings/settings.h"
#include "table/pair_state.h"

static_assert((int)OB_POINTS == (int)OB_PAIR_POINTS && (int)OB_ROWS == (int)OB_PAIR_ROWS,
	      "a pair is stored as it is solved");

enum { OB_COLOURS = 64, OB_NO_LANE = UINT32_MAX, OB_WATCHED_BODIES = 2 };

typedef struct ob_body {
	uint32_t id;
	ob_shape shape;
	const ob_hull *hull; // shape of a hull, in the universe
	ob_vec3 size, p;
	ob_quat q;
	ob_mat3 r;
	double mass, inv_mass;
	ob_vec3 inertia; // principal
	ob_vec3 acceleration; // m/s^2, external, in the island's frame
	ob_vec3 torque; // N m, world, external
	double inv_inertia[6]; // world
	double friction, restitution, radius, thickness;
	double rest_depth; // m, as ob_placed.rest_depth
	double path, speed; // m, as ob_motion.path; m/s bound of any point
	double turning; // m/s, part of the surface's speed that turning adds
	float rest_time; // s, as ob_motion.rest_time
	bool isotropic; // inertia is the same about all axes
	bool moved_freely; // it touched nothing at any time in this step
	uint32_t contacts; // number of those that touch
	uint32_t height; // least number of contacts that lead to it from a row that stands (solver/direct_solver.h)
	uint32_t in_reach; // number that may carry load in the running partial substep: 0, 1 or more
	bool loaded; // its free motion within the partial substep includes the last one's contact forces
	double hit; // s into the partial substep: its last impact; 0: none
	uint64_t colours; // bit per colour in use
	uint32_t next_substeps; // its request for the next step (solver/error_control.h)
	ob_deviation deviation; // at the step's end (solver/estimate.h)
	uint32_t refinement; // one of OB_MOTION_REFINEMENT, or none (solver/refinement.h)
	uint32_t active_iteration; // last iteration that changed its velocity by more than the wake threshold
	uint32_t first_adjacent, adjacent; // range in adjacency
	uint32_t next_ghost; // chain of its ghosts' rows (solver/ghost.h); 0 ends
	uint32_t ghost_of; // of a ghost: the row that it stands for
	bool holds; // fixed or driven row that holds the island: accelerations are felt relative to it (solver/frame.h)
	bool rolls; // its contact does not go along with its spin, which moves no surface (solver/surfaces.h)
	uint32_t surface; // 1 + index into the kinematic surfaces (solver/surfaces.h); 0: none
	double carried; // N s, sum over all surfaces that carry it
	double load; // N s, sum over its contacts when the partial substep began
	bool among_others; // it touches moving bodies, or a joint holds it
	uint32_t joints; // that hold it
	bool turns; // it has a contact whose geometry turns
	double sinking; // m (solver/error_control.c): what the step adds to the depths of what carries it
	bool halved; // it is at the midpoint of the partial substep (solver/midpoint.h)
	ob_body_row first_half; // m, rad: displacement to the midpoint
	ob_vec3 start_p, start_w; // state before that
	ob_quat start_q;
} ob_body;

// A body and its height (m) against its external acceleration.
typedef struct ob_height {
	double height;
	uint32_t row;
} ob_height;

// A pair that touches, or may touch in this step.
typedef struct ob_contact {
	uint32_t key; // index of its pair in the input
	uint32_t a, b; // rows
	const ob_hull *part[2]; // as ob_island_pair.part
	uint32_t lane; // batch * OB_LANES + lane; OB_NO_LANE = in no batch
	uint32_t colour;
	uint32_t points;
	ob_vec3 arm_a[OB_PAIR_POINTS], arm_b[OB_PAIR_POINTS];
	ob_vec3 friction_a, friction_b; // m: where friction acts
	int8_t was[OB_PAIR_POINTS]; // for each point: its index in the previous geometry; -1: none
	double disc_radius; // m, as ob_manifold.disc_radius
	bool area_due; // its area is to be found if it touches alone (contact/area.h)
	double spin_lever_a, spin_lever_b; // m, of its points (solver/relative_speed.h); 0 while separated
	double path,
		limit; // m: relative path in this step; bound up to which the geometry holds
	double since; // s, from the time of the geometry to the partial substep's start; infinity: unknown
	double found_for; // s: length of the partial substep for which the geometry was found
	bool turns; // its geometry turns noticeably within the partial substep (solver/midpoint.h)
	unsigned held; // bits: points that are held at the surface in the partial substep
	double mu, e; // coefficients of friction and of restitution
	double initial_depth,
		depth_growth; // m (solver/error_control.h): at the step's start; growth within the step
	double slip, creep; // m: within this step; within the last second
	uint32_t rebounds; // in the partial substep
	bool left_to_solver; // its hits in the partial substep have too many points: the contact solver takes them
	// its bodies approach fast, but it does not close in the partial substep, as following them has shown
	bool misses;
	bool as_of_instant; // its geometry is that of an instant in the running partial substep
	bool began; // its bodies did not touch at the step's start
	bool hit; // its bodies rebounded within the step
	double next_point; // m: least gap, at such an instant, of a point that was about to hit; infinity: none
	bool mirror; // second contact of a pair that is solved for each side apart: its own body is b
} ob_contact;

// A contact in a direct solve. parent: row of a fixed body if it is an anchor.
typedef struct ob_direct_contact {
	uint32_t contact, child, parent;
	uint8_t row[OB_JOINT_ROWS]; // row of the batch, for each row of the joint
	unsigned push, anew; // bits: normals that push; rows whose impulses are found anew
	double aim[OB_JOINT_ROWS]; // impulses of the batch's rows at which the solution aims
	ob_joint joint;
} ob_direct_contact;

// Working state of solver/direct_solver.c; memory grown as needed, never shrunk.
typedef struct ob_direct_solver {
	enum {
		OB_DIRECT_UNKNOWN,
		OB_DIRECT_UNFIT,
		OB_DIRECT_TREES,
		OB_DIRECT_CYCLIC,
		OB_DIRECT_HIGH
	} shape; // class of the running partial substep's contacts: too fast, trees, with cycles at rest, and stacked high
	bool used_last; // the last partial substep was solved directly
	bool gave_up; // a solve in this step did not reduce the residual
	int solves; // in the running partial substep
	uint32_t contacts_max, batches_max;
	uint32_t contacts;
	ob_direct_contact *contact;
	ob_sparse_solver sparse;
	lanes (*velocity)[OB_ROWS], (*impulse_change)[OB_ROWS]; // [batch], per row
	lanes (*unloaded)[OB_ROWS]; // [batch]: the velocity without any impulse
} ob_direct_solver;

// Working state of solver/conjugate.c; memory grown as needed, never shrunk.
typedef struct ob_conjugate {
	uint32_t batches_max;
	lanes (*direction)[OB_ROWS], (*change)[OB_ROWS]; // [batch]: of the impulses; by the last iteration
	double last; // J, squared change in the previous iteration
} ob_conjugate;

// A contact that hits within the partial substep.
typedef struct ob_impact_instant {
	uint32_t contact;
	double time, approach; // s into the partial substep; m/s
	bool joined; // part of the impact that is solved
	uint32_t first_point, set_points; // first point and number of points of its set
	ob_manifold m; // geometry at that time
} ob_impact_instant;

// A body at an instant within the partial substep: m, m/s, rad/s.
typedef struct ob_body_at {
	ob_vec3 p, v, w;
	ob_quat q;
	ob_mat3 r;
} ob_body_at;

// Working state of solver/impacts.c; memory grown as needed, never shrunk.
typedef struct ob_impacts {
	uint32_t count; // number of pending impacts
	uint32_t contacts_max, rows_max;
	ob_impact_instant *pending; // [2 contacts]: with the contacts that touch a hit
	uint32_t *next; // [contacts]: chains of pending impacts of one set
	uint32_t *seen; // [contacts]: last round that has checked it
	uint32_t *set; // [contacts]: roots of the sets of a round
	uint32_t *machine; // [rows]: the body that stands for all that joints link, where hits may rebound
	uint32_t *root, *head; // [rows]: union-find over bodies that stand for machines; first pending impact of a set
	double *first; // [rows], s: earliest of the pending impacts of the machine
	uint32_t changes, *changed; // [rows]: bodies that were hit in a round
	uint32_t *slot; // [rows]: index in the set that is solved
	uint32_t bodies, points; // of that set
	double instant; // s, from the partial substep's start: of that set
	bool linked, found; // joints link bodies of it; their rows at the instant have been found
	uint32_t *row; // [bodies]
	ob_body_at *at; // [bodies]
	ob_impact_body *body, *before; // [bodies]
	ob_impact_point *point;
} ob_impacts;

// A kinematic or running surface (solver/surfaces.h).
typedef struct ob_surface {
	uint32_t row, pair, contact; // own row; index into the island's pairs; into its contacts
	ob_motion motion;
	ob_vec3 running; // m/s, frame of the body: as ob_passport.surface_velocity
	ob_state begin, end; // states at the ends of the running partial substep
	ob_vec3 now; // m/s, world: the running surface at the contact
} ob_surface;

// Memory grown as needed, never shrunk.
typedef struct ob_surfaces {
	uint32_t count, max;
	ob_surface *surface; // ascending by pair
	double step_begin; // s, time of the step's start
} ob_surfaces;

// A joint's end in an island.
typedef struct ob_joint_end {
	uint32_t row; // 0: it does not move by forces
	const ob_motion *motion; // of such an object; NULL: the world
	ob_pose frame; // of the joint in the body
	ob_vec3 arm; // m, world: from the body's centre to the joint's origin
	ob_vec3 at, axis[3]; // m, world: origin; axes of the frame
	ob_quat attitude; // of the frame
	ob_body_row given; // m/s, rad/s: velocity of one that does not move by forces
} ob_joint_end;

// Action of a joint on its first object: N s, N m s.
typedef struct ob_joint_action {
	ob_vec3 force, torque;
	double along;
} ob_joint_action;

// A joint of an island (solver/joints.c).
typedef struct ob_held_joint {
	uint32_t kind; // ob_joint_kind
	double breaks_force, breaks_torque; // N, N m
	bool broken; // in this step: it has no rows any more
	struct { // solver/joint_load.h
		ob_joint_action now, kept; // since the begin of a part of the step; when states were kept
		ob_joint_action whole; // of the parts before
		double time; // s: for which "whole" acted, if not for the step: it broke
	} action;
	double length; // m, of a distance
	ob_joint_end end[2];
	uint32_t number; // in the island's input
	uint32_t part; // 0: holds; else one of the axes of a universal or a ball, which follow it (joint_rows.c)
	const ob_joint_axis *axis; // what acts along its free axis; NULL: nothing
	ob_joint_axis own; // that of a part of a ball
	uint32_t base; // number of equality rows; the axis' row follows
	struct { // of the axis (solver/joint_axis.h)
		double value; // m, rad
		double response; // change of its rate by a unit impulse, as the step begins
		int limit; // -1: rests on the lower limit; 1: on the upper
		uint32_t place; // of its rate among the rates that friction and motor hold
		bool engaged; // its row is an equality
		double goal, goal_rate, since; // of that row: value at a time (s), and rate
		double softness; // compliance of a second row, of its rotor, and of spring and damper; 0: none
		double applied; // N s, among contacts: impulse of forces that do not depend on the rate
		double flight; // s, of the flight that is aimed; 0: none
		double rotor, rotor_rate; // value and rate of its rotor as the flight begins, or its rate at the end
		ob_quat rotor_attitude; // of a ball's rotor, relative to the second end, as the flight begins
	} along;
	uint32_t child, parent; // rows of the elimination: the first end that moves, the other; OB_SPARSE_FIXED: none
	ob_joint rows; // J at the present poses, and the last impulses
	double response[2][OB_JOINT_ROWS][6]; // change of velocity of child and parent by an impulse of each row
	double error[OB_JOINT_ROWS]; // m, or sine: violation of each row
	double sum[OB_JOINT_ROWS]; // N s, N m s: impulse of the flight, of its first or second half
	double guess[OB_JOINT_ROWS]; // the same of the flight that comes
	double share[OB_JOINT_ROWS]; // N s, N m s: impulses that go with a change by contacts (ob_joints_follow)
	double target[OB_JOINT_ROWS]; // m/s, rad/s: velocity of each row that the contact solver aims at
} ob_held_joint;

// State of a body at the start of a flight.
typedef struct ob_joint_kept {
	ob_vec3 p;
	ob_quat q;
	ob_body_row v;
} ob_joint_kept;

// Memory grown as needed, never shrunk.
typedef struct ob_joint_set {
	uint32_t count, max;
	ob_held_joint *joint;
	ob_sparse_solver sparse; // bodies: rows less 1
	double step_begin; // s, time of the step's start
	double stiffness; // 1/s: largest rate, by their forces, at which bodies may swing, in this step so far
	double swing; // 1/s: the same, and of bodies that no joint pulls
	bool failed; // a stage of this step was too long to be solved
	uint32_t axes; // number of axes along which something acts
	bool damped, soft; // one of them has a damper; or a spring
	double now; // s: time of the poses at which the ends were found
	// Share of its part, and s, length of the part, of the last flight; 0: none whose impulses are a guess for the next.
	double last_share, last_length;
	bool breakable; // some of them may break
	ob_joint_kept *kept; // [2 bodies]: states to return to: of an event, of the begin of a part of the step
	uint32_t kept_max;
} ob_joint_set;

// Scratch memory of an island's solve, grown as needed, never shrunk.
typedef struct ob_island_work {
	ob_units unit; // the run's units, for thresholds
	double tolerance, run_coarseness; // m, of the run, or the default; ob_run_settings_coarseness()
	double coarseness; // for the island's step: less with more substeps, else its error would not fall
	double stretch; // factor on limits of motion within a partial substep: more than 1 in a coarser solution to compare with
	double jolt; // m/s: largest difference between the changes of a body's velocity in both halves of the step; 0: unknown
	uint32_t rows, rows_max; // bodies + fixed bodies + row 0
	uint32_t bodies; // rows 1 .. bodies
	uint32_t first_ghost; // first row of the ghosts
	ob_body_row *history; // velocities after the last iterations, for ghosts
	uint32_t history_max;
	ob_body *body; // [rows]
	ob_height *by_height; // [bodies]
	ob_body_row *v, *dv, *u, *d, *delta;
	ob_body_row
		*drift; // change of velocity in the partial substep as impacts use it: dv without the echo of an impact
	uint32_t contacts, contacts_max;
	ob_contact *contact;
	uint32_t *contact_lane; // [contacts]: copy of each contact's lane, contiguous for readers of nothing else
	uint64_t *contact_key; // keys of solver/contact_order.c
	uint32_t *contact_order; // indices of the island's pairs, in the order of loading
	uint32_t *adjacency; // contacts of each body, touching or not
	uint32_t batches, batches_max;
	ob_batch *batch;
	uint32_t *batch_colour; // [batches]
	uint32_t open_batch[OB_COLOURS][OB_KINDS]; // tops of the stacks of batches with a free lane; UINT32_MAX = none
	uint32_t *next_open_batch; // [batches]: next in the stack of its colour
	uint32_t *batch_due; // [batches]: last iteration in which it is to be solved
	uint32_t *batch_order; // [batches]: sorted by colour
	bool order_stale, counts_stale, areas_due;
	bool elastic, plastic; // hits with restitution, and without, are solved at their instants (solver/impacts.h)
	uint32_t iteration; // number of the running iteration, ever growing
	double mass; // kg, sum of all bodies
	double max_acceleration; // m/s^2, the largest external acceleration of a body
	ob_vec3 frame; // m/s^2: acceleration of the frame of reference in which the island is solved
	// bodies that fall together feel external acceleration: a solution in a frame that falls with them missed the
	// tolerance
	bool in_field;
	bool torques; // a body has an external torque
	bool balanced; // equilibrium is confirmed: one substep was enough
	uint32_t substeps; // of this step
	uint32_t partial; // partial substeps in it
	double error, new_error; // m (solver/error_control.h): of the step; caused by the step itself
	double depth, creep, bounce; // m: by its causes
	double substep; // s, length of a whole substep
	double time; // s, from the step's start to the running partial substep's
	// s (solver/adaptive_substep.h): length of the running partial substep; the least one, but for the last of a
	// substep
	double h, h_min;
	double unpaced; // s: time not yet counted in the contacts' paths
	double last_impact; // s into the partial substep: instant of its last impact
	// m/s: largest change of a velocity in a first iteration, in this step so far; in the last one
	double residual, last_residual;
	bool projected; // position projection was applied in this step
	double recovered; // J, energy that position projection has added in this step
	uint32_t *row_of, row_of_max; // [object of the input]: its row; 0: none yet
	ob_direct_solver direct;
	ob_conjugate conjugate;
	ob_impacts impacts;
	ob_surfaces surfaces;
	ob_joint_set joints;
} ob_island_work;

// Returns the largest speed (m/s) of any point of a body, as of its bound.
static inline double ob_largest_speed(const ob_island_work *w)
{
	double most = 0;
	for (uint32_t i = 1; i <= w->bodies; i++)
		most = ob_max(most, w->body[i].speed);
	return most;
}

// Raises a threshold in a coarse run: `usual` times the coarseness, at most `bound`, which follows from the tolerance,
// and at least `usual`. At the default tolerance and below it is `usual`.
static inline double ob_coarser(const ob_island_work *w, double usual, double bound)
{
	return ob_max(usual, ob_min(w->coarseness * usual, bound));
}

// Returns the s that stand for one second of the default: a coarse run's unit of time is longer, its steps are not.
static inline double ob_coarse_time(const ob_island_work *w)
{
	return w->unit.time / w->run_coarseness;
}

// Returns the largest change of velocity (m/s) in so many seconds that counts as none: forces balance.
static inline double ob_balanced_change(const ob_island_work *w, double time)
{
	const double unbalanced_share = 1e-5; // share of the largest external acceleration
	return unbalanced_share * w->max_acceleration * time;
}

static inline ob_vec3 ob_row_linear(const double *row)
{
	return ob_v3(row[0], row[1], row[2]);
}

static inline ob_vec3 ob_row_angular(const double *row)
{
	return ob_v3(row[3], row[4], row[5]);
}

// Angular acceleration, rad/s^2, by a torque (N m, world).
static inline ob_vec3 ob_body_turned_by(const ob_body *body, ob_vec3 torque)
{
	const double *i = body->inv_inertia; // xx xy xz yy yz zz
	return ob_v3(i[0] * torque.x + i[1] * torque.y + i[2] * torque.z,
		     i[1] * torque.x + i[3] * torque.y + i[4] * torque.z,
		     i[2] * torque.x + i[4] * torque.y + i[5] * torque.z);
}

// Returns the load (N s) of a contact: 0 without a lane.
static inline double ob_contact_load_of(const ob_island_work *w, const ob_contact *c)
{
	return c->lane == OB_NO_LANE ? 0 : ob_batch_load(&w->batch[c->lane / OB_LANES], c->lane % OB_LANES);
}

// True if one of the two leans on its rim: it touches with its first point alone.
static inline bool ob_contact_leans(const ob_contact *c)
{
	return c->disc_radius < 0;
}

// True if a contact has begun or ended in the step, or rebounded.
static inline bool ob_contacts_changed(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *c = &w->contact[i];
		if ((c->lane == OB_NO_LANE) != c->began || c->rebounds)
			return true;
	}
	return false;
}

// True if a body of the contact was hit in the running partial substep.
static inline bool ob_contact_was_hit(const ob_island_work *w, const ob_contact *c)
{
	return w->body[c->a].hit > 0 || w->body[c->b].hit > 0;
}

#endif
