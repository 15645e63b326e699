#include "solver/joints.h"

#include <string.h>

#include "motion/drift.h"
#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/contacts.h"
#include "solver/joint_rows.h"
#include "solver/midpoint.h"

static const double exact = 1e-14; // m, sine: violation that counts as none, beside rounding
static const double rounding = 4e-16; // share of the coordinates
static const double most_violation = 1e-6; // m, sine: a flight that ends with more was too long
static const double misplaced = 1e-9; // m, sine: more at a step's start is not of a flight: bodies were put there
static const double block_rate = 1; // rad: largest swing in a block
static const double flight_rate = .5; // rad: largest swing in a flight of a step without blocks

enum { MOST_BLOCKS = 4 }; // for the run's substeps; beyond that single flights

// ---- flights

// Largest violation of a row, and what counts as none beside these coordinates.
static double largest_error(const ob_island_work *w, double *none)
{
	double most = 0, far = 0;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		for (uint32_t r = 0; r < j->rows.rows; r++)
			most = ob_max(most, fabs(j->error[r]));
		far = ob_max(far, ob_norm(j->end[0].at));
	}
	*none = exact + rounding * far;
	return most;
}

static void clear_sums(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		memset(w->joints.joint[i].sum, 0, sizeof w->joints.joint[i].sum);
}

static void clear_targets(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		memset(w->joints.joint[i].target, 0, sizeof w->joints.joint[i].target);
}

// Half of the change by external torques, before or after a flight of h (s).
static void twist(ob_island_work *w, double h)
{
	for (uint32_t row = 1; w->torques && row <= w->bodies; row++)
		ob_row_add(w->v[row], ob_v3(0, 0, 0),
			   ob_scale(ob_body_turned_by(&w->body[row], w->body[row].torque), .5 * h));
}

// Flies from the start of the flight for h (s) with the velocities u, which are of the start.
static void fly_freely(ob_island_work *w, double h)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		ob_body *body = &w->body[row];
		const ob_vec3 v = ob_row_linear(w->u[row]);
		ob_vec3 rate;
		ob_quat q;
		ob_drift(body->start_q, ob_row_angular(w->u[row]), body->inertia, h, &q, &rate);
		ob_body_place(body, ob_madd(ob_madd(body->start_p, h, v), .5 * h * h, body->acceleration), q);
		memset(w->v[row], 0, sizeof *w->v);
		ob_row_add(w->v[row], ob_madd(v, h, body->acceleration), rate);
	}
}

// Finds the impulses at the flight's start after which no row is violated at its end: a Newton iteration with the
// equations of the start. Their sums hold the first guess.
static void aim(ob_island_work *w, double h, double end)
{
	enum { MOST_ROUNDS = 32 };
	double before = INFINITY, none;
	for (int round = 0; round < MOST_ROUNDS; round++) {
		for (uint32_t row = 1; row <= w->bodies; row++)
			memcpy(w->u[row], w->dv[row], sizeof *w->u);
		for (uint32_t i = 0; i < w->joints.count; i++)
			ob_joint_respond(&w->joints.joint[i], w->joints.joint[i].sum, w->u);
		fly_freely(w, h);
		ob_joints_find(w, end);
		const double error = largest_error(w, &none);
		if (error <= none || (round > 2 && !(error < .5 * before))) {
			w->joints.failed |= !(error < most_violation);
			return;
		}
		before = error;
		for (uint32_t i = 0; i < w->joints.count; i++) {
			ob_held_joint *j = &w->joints.joint[i];
			for (uint32_t r = 0; r < j->rows.rows; r++)
				j->rows.y[r] = -j->error[r] / h;
		}
		ob_joints_find_impulses(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			for (uint32_t r = 0; r < w->joints.joint[i].rows.rows; r++)
				w->joints.joint[i].sum[r] += w->joints.joint[i].rows.x[r];
	}
	w->joints.failed = true;
}

// Moment of inertia (kg m^2) against turning the arm, as a mean over the axes across it.
static double inertia_across(const ob_body *b, ob_vec3 arm)
{
	const double *i = b->inv_inertia, length2 = ob_norm2(arm);
	return 2 / (i[0] + i[3] + i[5] - ob_dot(arm, ob_body_turned_by(b, arm)) / length2);
}

// Squared rate (1/s^2) at which the body may swing about the arm of a joint that pulls with a force (N), or turns it.
static double swing_rate2(const ob_island_work *w, const ob_joint_end *e, double force)
{
	const ob_body *b = &w->body[e->row];
	const double length2 = e->row ? ob_norm2(e->arm) : 0;
	if (!(length2 > 0))
		return 0;
	const bool alone = b->joints == 1;
	const double inertia = inertia_across(b, e->arm) + (alone ? b->mass * length2 : 0);
	const double pulled = (alone ? 1 : 2) * force * sqrt(length2) / inertia;
	return ob_max(pulled, ob_norm2(ob_cross(ob_row_angular(w->v[e->row]), e->arm)) / length2);
}

// Notes the stiffness of the joints, whose impulses at the end of a flight of h (s) have been found.
static void note_stiffness(ob_island_work *w, double h)
{
	double most = 0;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		ob_vec3 pull = { 0, 0, 0 };
		for (uint32_t r = 0; r < j->rows.rows; r++)
			pull = ob_madd(pull, j->sum[r], ob_row_linear(j->rows.child[r]));
		const double force = 2 * ob_norm(pull) / fabs(h);
		for (int side = 0; side < 2; side++)
			most = ob_max(most, swing_rate2(w, &j->end[side], force));
	}
	w->joints.stiffness = ob_max(w->joints.stiffness, sqrt(most));
}

// Flies for h (s), of any sign, to this time. The rows of its start have been factored, and so are those of its end.
static void fly(ob_island_work *w, double h, double end)
{
	twist(w, h);
	for (uint32_t row = 1; row <= w->bodies; row++) {
		ob_body *body = &w->body[row];
		body->start_p = body->p;
		body->start_q = body->q;
		memcpy(w->dv[row], w->v[row], sizeof *w->dv);
	}
	aim(w, h, end);
	ob_joints_factor(w);
	twist(w, h);
	clear_sums(w);
	ob_joints_solve(w, w->v);
	note_stiffness(w, h);
}

// Scales the impulses of the last flight's end as a first guess for a flight of another length.
static void guess(ob_island_work *w, double ratio)
{
	for (uint32_t i = 0; i < w->joints.count; i++)
		for (uint32_t r = 0; r < w->joints.joint[i].rows.rows; r++)
			w->joints.joint[i].sum[r] *= ratio;
}

// Adds what the bodies have moved at most in h (s) to their paths.
static void note_paths(ob_island_work *w, double h)
{
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const double before = w->body[row].speed;
		ob_body_set_velocity(w, row, ob_row_linear(w->v[row]), ob_row_angular(w->v[row]));
		w->body[row].path += h * ob_max(before, w->body[row].speed);
	}
}

static void update_poses(ob_island_work *w)
{
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (w->body[row].joints)
			ob_body_update_pose(w, row);
}

void ob_joints_project(ob_solver *s)
{
	enum { ROUNDS = 16 };
	ob_island_work *w = &s->island;
	double before = INFINITY, none;
	for (int round = 0; w->joints.count && round < ROUNDS; round++) {
		update_poses(w);
		ob_joints_find(w, w->joints.step_begin + w->time);
		const double error = largest_error(w, &none);
		if (error <= none || !(error < .5 * before))
			return;
		before = error;
		ob_joints_factor(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			for (uint32_t r = 0; r < w->joints.joint[i].rows.rows; r++)
				w->joints.joint[i].rows.y[r] = -w->joints.joint[i].error[r];
		ob_joints_find_impulses(w);
		for (uint32_t i = 0; i < w->joints.count; i++)
			ob_joint_respond(&w->joints.joint[i], w->joints.joint[i].rows.x, w->d);
	}
	update_poses(w);
}

// Lengths of the flights of a block, as shares (Kahan and Li, "Composition constants for raising the orders of
// unconventional schemes for ordinary differential equations", 1997: s9odr6a).
static const double shares[] = { .39216144400731413928,  .33259913678935943860, -.70624617255763935981,
				 .082213596293550800230, .79854399093482996340, .082213596293550800230,
				 -.70624617255763935981, .33259913678935943860, .39216144400731413928 };
static const double single[] = { 1 };

bool ob_joints_fly(ob_solver *s)
{
	enum { WORK_OF_FLIGHT = 64 }; // for a joint
	ob_island_work *w = &s->island;
	const uint32_t usual = s->settings->substeps, n = w->substeps;
	const bool blocks = n >= usual && n <= MOST_BLOCKS * usual;
	const uint32_t parts = blocks ? n / usual : n, flights = blocks ? sizeof shares / sizeof *shares : 1;
	const double *share = blocks ? shares : single, step = s->settings->step_length, h = step / parts;
	double last = 0, none;
	ob_joints_find(w, w->joints.step_begin);
	if (largest_error(w, &none) > misplaced) {
		ob_joints_project(s);
		ob_joints_find(w, w->joints.step_begin);
	}
	ob_joints_factor(w);
	clear_targets(w);
	clear_sums(w);
	ob_joints_solve(w, w->v);
	clear_sums(w);
	for (uint32_t k = 0; k < parts && !w->joints.failed && !ob_budget_spent(s); k++) {
		double done = 0;
		for (uint32_t i = 0; i < flights && !w->joints.failed; i++) {
			done += share[i];
			if (last != 0)
				guess(w, share[i] / last);
			last = share[i];
			ob_budget_note(s, WORK_OF_FLIGHT * w->joints.count);
			const double part = i + 1 < flights ? done : 1;
			fly(w, share[i] * h, w->joints.step_begin + ((double)k + part) * h);
		}
		note_paths(w, h);
	}
	w->time = step;
	return ob_joints_substeps(s) <= n && !w->joints.failed;
}

uint32_t ob_joints_substeps(const ob_solver *s)
{
	const ob_joint_set *set = &s->island.joints;
	const uint32_t usual = s->settings->substeps;
	const double swing = set->stiffness * s->settings->step_length;
	uint32_t n = usual;
	if (set->failed)
		return 2 * s->island.substeps;
	while (n < MOST_BLOCKS * usual && block_rate * n < swing * usual)
		n *= 2;
	if (block_rate * n < swing * usual)
		for (n *= 2; n < OB_MAX_SUBSTEPS && flight_rate * n < swing;)
			n *= 2;
	return n;
}

// ---- among contacts

void ob_joints_begin(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double begin = w->joints.step_begin + w->time;
	if (!w->joints.count)
		return;
	update_poses(w);
	ob_joints_find(w, begin);
	ob_joints_factor(w);
	clear_targets(w);
	ob_joints_solve(w, w->v); // impacts know no joints
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (w->body[row].joints)
			ob_midpoint_halve(s, row);
	ob_joints_find(w, begin + .5 * w->h);
	ob_joints_factor(w);
	clear_sums(w);
	for (uint32_t i = 0; i < w->joints.count; i++) {
		ob_held_joint *j = &w->joints.joint[i];
		for (uint32_t r = 0; r < j->rows.rows; r++)
			j->target[r] = -ob_joint_row_velocity(j, r, w->v);
	}
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
}
