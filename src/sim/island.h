// One island through one step: the working state of its members and pairs, private to the worker that solves it.
//
// Velocities live in rows (contact/batch.h): v at the stride's start, dv the change that the pull and the impulses of the
// last stride would bring where the touches are now, u = v + dv solved to the stride's end, d the displacement since the
// poses were last brought up to date. Row 0 is everything that does not move.
#ifndef OB_SIM_ISLAND_H
#define OB_SIM_ISLAND_H

#include <assert.h>

#include "contact/batch.h"
#include "contact/impact.h"
#include "sim/forest.h"
#include "table/table.h"

static_assert((int)OB_POINTS == (int)OB_PAIR_POINTS && (int)OB_ROWS == (int)OB_PAIR_ROWS,
	      "a pair is stored as it is solved");

enum { OB_COLOURS = 64, OB_NO_LANE = UINT32_MAX };

typedef struct ob_body {
	uint32_t id;
	ob_shape shape;
	ob_vec3 size, p;
	ob_quat q;
	ob_mat3 r;
	double mass, inv_mass;
	ob_vec3 inertia; // principal
	ob_vec3 pull; // m/s^2: what moves it where nothing touches it
	double inv_inertia[6]; // world
	double friction, restitution, radius, thickness;
	double path, speed; // m; m/s bound of any point
	float rest_time;
	bool round; // inertia is the same about all axes
	bool loaded; // some touch of it carries an impulse
	bool moved_freely; // it touched nothing in this step, not for a moment
	uint32_t contacts; // pairs that touch it
	uint32_t waiting; // impacts that it takes part in at once
	uint64_t colours; // bit per colour in use
	uint32_t substeps; // that it asks for in the next step (sim/tolerance.h)
	uint32_t hot; // last pass in which a velocity changed noticeably
	uint32_t first_adjacent, adjacent; // range in adjacency
	uint32_t next_ghost; // chain of the rows that stand for it (sim/ghost.h); 0 ends
	uint32_t ghost_of; // of a ghost: the row that it stands for
} ob_body;

typedef struct ob_contact {
	uint32_t key; // index into the universe's pairs
	uint32_t a, b; // rows
	uint32_t lane; // batch * OB_LANES + lane; OB_NO_LANE = apart
	uint32_t colour;
	uint32_t points;
	ob_vec3 arm_a[OB_PAIR_POINTS], arm_b[OB_PAIR_POINTS];
	double limit, mu, e;
	double depth_given, growth; // m (sim/tolerance.h): when the step began; that it went deeper in the step
	double slip, creep; // m, in this step; in the last second
	bool mirror; // the second touch of a pair that is solved for each side apart: its own member is b
} ob_contact;

// Grown as needed, never shrunk.
typedef struct ob_island_work {
	uint32_t rows, rows_max; // members + fixed bodies + row 0
	uint32_t members; // rows 1 .. members
	uint32_t first_ghost; // rows from here on are ghosts
	ob_body_row *history; // what members published in the last exchanges, for ghosts
	uint32_t history_max;
	ob_body *member; // [rows]
	ob_body_row *v, *dv, *u, *d, *delta;
	ob_body_row *drift; // change of velocity in the stride as impacts see it: dv where that is not an impact's echo
	uint32_t touches, touches_max;
	ob_contact *touch;
	uint32_t *adjacency; // touches of each member
	uint32_t batches, batches_max;
	ob_batch *batch;
	uint32_t *batch_colour; // [batches]
	uint32_t *batch_open; // [batches]: next in the stack of its colour
	uint32_t open[OB_COLOURS][OB_KINDS]; // tops of the stacks of batches with a free lane; UINT32_MAX = none
	uint32_t *batch_due; // [batches]: last pass in which it is to be solved (ob_solver_activate)
	uint32_t *batch_order; // [batches]: sorted by colour
	bool order_stale, counts_stale, elastic;
	uint32_t pass; // number of the running pass, ever growing
	double mass; // of all members, kg
	double pull; // m/s^2, the largest of any member
	uint32_t substeps; // of this step
	double error, error_new; // m (sim/tolerance.h): of the step; of its own doing
	double h, t0; // s; h of the stride that is made now: a substep, or a part of one (sim/pace.h)
	double substep; // s, the whole
	double last_impact; // s into the stride: the last one's instant
	double stirred; // m/s: the most that a first round of exchanges has changed in this step
	bool pushed; // penetrations were pushed apart
	double recovered; // J, what pushing penetrations apart has added in this step (ob_solver_project_positions adds it)
	uint32_t *row_of; // [object]: row in this island
	uint32_t row_of_max;
	ob_direct_solver forest;
} ob_island_work;

struct ob_sim;
// Solves island i of the universe through the coming step and publishes what it found.
void ob_island_solve(struct ob_sim *s, uint32_t i);
void ob_island_work_finish(ob_island_work *w);

#endif
