#include "solver/bodies.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "elementary/elementary.h"
#include "motion/drift.h"
#include "shape/shape.h"
#include "solver/equilibrium.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"

// Updates the inverse inertia (world frame) to the body's attitude.
static void update_inertia(ob_body *body)
{
	if (body->inv_mass > 0)
		ob_inverse_inertia(body->inertia, &body->r, body->inv_inertia);
}

// Bounds the speed (m/s) of any point of the body while it turns freely through a partial substep.
static void set_speed_bound(ob_island_work *w, uint32_t row)
{
	ob_body *body = &w->body[row];
	const ob_vec3 rate = ob_rotate_back(&body->r, ob_row_angular(w->v[row]));
	body->turning = ob_turning_speed(body->shape, body->size, body->inertia, rate, w->h);
	body->speed = ob_norm(ob_row_linear(w->v[row])) + body->turning;
	if (ob_shape_is(body->shape, OB_AXIAL))
		body->speed += body->radius * fabs(rate.z);
	else if (ob_shape_is(body->shape, OB_ISOTROPIC))
		body->speed += body->radius * ob_norm(rate);
}

// Returns a bound of the speed (m/s) of the body's surface as a set: points of a spinning round body may be faster.
static double surface_speed(const ob_island_work *w, uint32_t row)
{
	return ob_norm(ob_row_linear(w->v[row])) + w->body[row].turning;
}

static void load_body(ob_solver *s, uint32_t row, const ob_island_object *object, bool moves)
{
	ob_island_work *w = &s->island;
	const ob_passport *pass = object->passport;
	const ob_state now = object->now;
	ob_body *body = &w->body[row];
	*body = (ob_body){ .id = object->id,
			   .shape = pass->shape,
			   .hull = object->hull,
			   .size = pass->size,
			   .p = now.pose.p,
			   .q = now.pose.q,
			   .r = ob_quat_matrix(now.pose.q),
			   .mass = moves ? pass->mass : 0,
			   .inertia = pass->inertia,
			   .friction = pass->friction,
			   .restitution = pass->restitution,
			   .path = object->path,
			   .rest_time = object->motion->rest_time,
			   .moved_freely = true };
	body->inv_mass = moves ? 1 / pass->mass : 0;
	body->isotropic = pass->inertia.x == pass->inertia.y && pass->inertia.y == pass->inertia.z;
	body->radius = ob_shape_radius(pass->shape, pass->size);
	body->thickness = ob_shape_thickness(pass->shape, pass->size);
	body->rest_depth = ob_narrowphase_rest_depth(s, body->thickness, true);
	update_inertia(body);
	if (!moves)
		return;
	ob_row_add(w->v[row], now.v, now.w);
	w->mass += pass->mass;
	body->acceleration = ob_external_acceleration(s->settings, pass);
	body->torque = object->torque;
	if (ob_norm2(body->torque) > 0) {
		w->torques = true;
		body->moved_freely = false; // no closed form describes its motion
	}
	set_speed_bound(w, row);
}

static void reserve_rows(ob_island_work *w, uint32_t rows)
{
	if (rows > w->rows_max) {
		w->rows_max = rows + rows / 2 + 16;
		w->body = ob_reallocate(w->body, w->rows_max * sizeof *w->body);
		w->by_height = ob_reallocate(w->by_height, w->rows_max * sizeof *w->by_height);
		ob_body_row **all[] = { &w->v, &w->dv, &w->u, &w->d, &w->delta, &w->drift };
		for (int i = 0; i < 6; i++)
			free(*all[i]), *all[i] = ob_allocate_aligned(64, w->rows_max * sizeof **all[i]);
	}
}

static void clear_rows(ob_island_work *w, uint32_t first, uint32_t end)
{
	ob_body_row *all[] = { w->v, w->dv, w->u, w->d, w->delta, w->drift };
	for (int i = 0; i < 6; i++)
		memset(all[i] + first, 0, (end - first) * sizeof *all[i]);
}

uint32_t ob_bodies_add_row(ob_island_work *w)
{
	clear_rows(w, w->rows, w->rows + 1);
	return w->rows++;
}

static void load_fixed_body(ob_solver *s, uint32_t object)
{
	const uint32_t row = s->island.row_of[object] = ob_bodies_add_row(&s->island);
	load_body(s, row, &s->in->object[object], false);
}

void ob_bodies_load(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	w->h = w->substep = run->step_length / w->substeps;
	w->mass = w->recovered = w->residual = w->last_residual = 0;
	w->projected = w->torques = false;
	w->unpaced = w->time = 0;
	w->surfaces.count = 0;
	w->surfaces.step_begin = (double)in->step * run->step_length;
	w->error = w->new_error = w->depth = w->creep = w->bounce = 0;
	w->bodies = in->members;
	// Fixed bodies: at most one for each side of a pair.
	reserve_rows(w, 1 + in->members + s->methods.sides * in->pairs);
	clear_rows(w, 0, 1 + in->members);
	memset(&w->body[0], 0, sizeof w->body[0]);
	w->rows = 1;
	if (in->objects > w->row_of_max) {
		w->row_of_max = in->objects + in->objects / 2;
		w->row_of = ob_reallocate(w->row_of, w->row_of_max * sizeof *w->row_of);
	}
	memset(w->row_of, 0, in->objects * sizeof *w->row_of);
	for (uint32_t i = 0; i < in->members; i++) {
		w->row_of[i] = w->rows;
		load_body(s, w->rows++, &in->object[i], true);
	}
	for (uint32_t i = 0; i < in->pairs; i++) {
		const uint32_t fixed = in->pair[i].fixed;
		if (fixed == OB_NO_FIXED)
			continue;
		if (ob_surface_moves(in->object[fixed].passport)) {
			load_fixed_body(s, fixed);
			ob_surface_add(s, w->rows - 1, i, &in->object[fixed]);
		} else if (!w->row_of[fixed]) {
			load_fixed_body(s, fixed);
		}
	}
	w->first_ghost = w->rows;
}

// ---- attitudes

// Turn (rad) of a body in contact in a partial substep, below which Euler's equations are not solved for it.
static const double unnoticed_turn = 1e-5;
static const double deferred_turn = 1e-4; // accumulated turn (rad) at which the attitude is updated
static const double deferred_turn_isotropic = .02;
static const double same_axis = 1e-13; // product of two turns (rad): with less across each other they add up

// Updates the gaps of the row's contacts by its displacement, to first order.
static void update_gaps(ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	const double *d = w->d[row];
	for (uint32_t k = 0; k < body->adjacent; k++) {
		const ob_contact *contact = &w->contact[w->adjacency[body->first_adjacent + k]];
		if (contact->lane == OB_NO_LANE)
			continue;
		ob_batch *b = &w->batch[contact->lane / OB_LANES];
		int l = contact->lane % OB_LANES;
		double sign = contact->a == row ? 1 : -1;
		for (uint32_t j = 0; j < contact->points; j++) {
			const lanes *arm = contact->a == row ? b->ja[j] : b->jb[j];
			double opened = 0;
			for (int c = 0; c < 3; c++)
				opened += b->n[c][l] * d[c] + arm[c][l] * d[3 + c];
			lanes_put(&b->gap[j], l, b->gap[j][l] + sign * opened);
		}
	}
}

static void set_rate(double *row, ob_vec3 rate)
{
	row[3] = rate.x, row[4] = rate.y, row[5] = rate.z;
}

static void set_attitude(ob_body *body, ob_quat q)
{
	body->q = q;
	body->r = ob_quat_matrix(q);
	update_inertia(body);
}

void ob_body_place(ob_body *body, ob_vec3 p, ob_quat q)
{
	body->p = p;
	set_attitude(body, q);
}

// Applies the displacement row to the pose. The angular velocity of an anisotropic body turns with its attitude: so its
// energy stays.
static void update_row_pose(ob_island_work *w, uint32_t row)
{
	ob_body *body = &w->body[row];
	double *d = w->d[row];
	if (d[0] == 0 && d[1] == 0 && d[2] == 0 && d[3] == 0 && d[4] == 0 && d[5] == 0)
		return;
	update_gaps(w, row);
	body->p = ob_add(body->p, ob_row_linear(d));
	ob_vec3 th = ob_row_angular(d);
	if (ob_norm2(th) > 0) {
		ob_vec3 rate = ob_rotate_back(&body->r, ob_row_angular(w->v[row]));
		set_attitude(body, ob_quat_turn(body->q, th));
		if (!body->isotropic)
			set_rate(w->v[row], ob_rotate(&body->r, rate));
	}
	memset(d, 0, sizeof(ob_body_row));
}

ob_vec3 ob_turn_between(ob_quat a, ob_quat b)
{
	ob_quat turn = ob_quat_mul(b, ob_quat_conjugate(a));
	double sin_half = sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
	double angle = 2 * ob_atan2(sin_half, fabs(turn.w)), scale = sin_half > 1e-12 ? angle / sin_half : 2;
	return ob_scale(ob_v3(turn.x, turn.y, turn.z), turn.w < 0 ? -scale : scale);
}

// Ghosts move with the body that they stand for, by the same displacement.
void ob_body_update_pose(ob_island_work *w, uint32_t row)
{
	if (row >= w->first_ghost)
		row = w->body[row].ghost_of;
	for (uint32_t g = w->body[row].next_ghost; g; g = w->body[g].next_ghost) {
		memcpy(w->d[g], w->d[row], sizeof *w->d);
		update_row_pose(w, g);
	}
	update_row_pose(w, row);
}

// Applies the displacement row to the pose, and turns the body freely for h (s). held: contacts have changed its
// angular velocity.
static void drift_row(ob_island_work *w, uint32_t row, double h, bool held)
{
	ob_body *body = &w->body[row];
	double *d = w->d[row];
	ob_quat q;
	ob_vec3 rate;
	if (ob_norm2(ob_row_angular(d)) > 0)
		update_row_pose(w, row);
	(held ? ob_drift_held : ob_drift)(body->q, ob_row_angular(w->v[row]), body->inertia, h, &q, &rate);
	ob_row_add(d, ob_v3(0, 0, 0), ob_small_turn(body->q, q));
	update_gaps(w, row);
	ob_body_place(body, ob_add(body->p, ob_row_linear(d)), q);
	set_rate(w->v[row], rate);
	memset(d, 0, sizeof *w->d);
}

static void drift_body(ob_island_work *w, uint32_t row, double h, bool held)
{
	for (uint32_t g = w->body[row].next_ghost; g; g = w->body[g].next_ghost) {
		memcpy(w->d[g], w->d[row], sizeof *w->d);
		drift_row(w, g, h, held);
	}
	drift_row(w, row, h, held);
}

// True if a point carries load that may have come down within the partial substep: any but a rim's that was held already.
static bool may_have_landed(const ob_island_work *w, uint32_t row)
{
	const ob_body *body = &w->body[row];
	for (uint32_t k = 0; k < body->adjacent; k++) {
		const ob_contact *c = &w->contact[w->adjacency[body->first_adjacent + k]];
		for (uint32_t j = 0; c->lane != OB_NO_LANE && j < c->points; j++) {
			const bool held = ob_contact_leans(c) && c->held >> j & 1;
			if (!held && w->batch[c->lane / OB_LANES].impulse[j][c->lane % OB_LANES] > 0)
				return true;
		}
	}
	return false;
}

void ob_body_count_turn(ob_solver *s, uint32_t row)
{
	const ob_island_work *w = &s->island;
	s->counters.gyroscopic_steps += !w->body[row].isotropic && ob_norm2(ob_row_angular(w->v[row])) > 0;
}

// Integrates from the midpoint (solver/midpoint.h) to the end of the partial substep. A jump of velocity counts as if it
// had happened at the start.
static void finish_halved(ob_solver *s, uint32_t row, double smooth)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	double *v = w->v[row], *d = w->d[row];
	const double *u = w->u[row], h = .5 * w->h;
	ob_vec3 jump = ob_sub(ob_row_linear(u), ob_row_linear(v)),
		jump_turn = ob_sub(ob_row_angular(u), ob_row_angular(v)), rate;
	const bool held = body->joints && !body->contacts; // joints alone change it, and smoothly
	const bool large = ob_norm2(jump) >= smooth || body->radius * body->radius * ob_norm2(jump_turn) >= 9 * smooth,
		   jumped = large && !held && may_have_landed(w, row);
	ob_vec3 way = ob_scale(ob_row_linear(u), h);
	ob_quat q;
	if (jumped)
		way = ob_madd(way, h, jump);
	ob_drift_held(body->q, ob_row_angular(u), body->inertia, h, &q, &rate);
	if (jumped) {
		ob_quat turned = ob_quat_turn(q, ob_scale(jump_turn, h));
		ob_mat3 from = ob_quat_matrix(q), to = ob_quat_matrix(turned);
		rate = ob_rotate(&to, ob_rotate_back(&from, rate));
		q = turned;
	}
	memcpy(v, u, sizeof *w->v);
	set_rate(v, rate);
	ob_body_count_turn(s, row);
	memset(d, 0, sizeof *w->d);
	ob_row_add(d, ob_add(way, ob_row_linear(body->first_half)), ob_small_turn(body->start_q, q));
	update_gaps(w, row);
	memset(d, 0, sizeof *w->d);
	ob_body_place(body, ob_add(body->p, way), q);
}

// Angular momentum (N m s, world) of the body at this rate.
static ob_vec3 momentum_of(const ob_body *body, ob_vec3 rate)
{
	const ob_vec3 b = ob_rotate_back(&body->r, rate), j = body->inertia;
	return ob_rotate(&body->r, ob_v3(j.x * b.x, j.y * b.y, j.z * b.z));
}

// Advances a body's attitude to the end of the partial substep. Turns at once, as in free flight, if the turn is
// noticeable or no contact holds the body; else adds to the displacement row. held: contacts have changed its angular
// velocity.
static void turn_body(ob_solver *s, uint32_t row, bool held)
{
	ob_island_work *w = &s->island;
	const ob_body *body = &w->body[row];
	double *d = w->d[row];
	const ob_vec3 turn = ob_scale(ob_row_angular(w->v[row]), w->h);
	const double turned = ob_norm2(turn);
	if (body->isotropic || turned == 0 || (held && turned < unnoticed_turn * unnoticed_turn)) {
		ob_row_add(d, ob_v3(0, 0, 0), turn);
		const double most = body->isotropic ? deferred_turn_isotropic : deferred_turn;
		if (ob_norm2(ob_row_angular(d)) > most * most)
			ob_body_update_pose(w, row);
		return;
	}
	ob_body_count_turn(s, row);
	drift_body(w, row, w->h, held && w->max_acceleration > 0);
}

// True if the body spins upright on all its contacts: its turn changes no gap.
static bool spins_upright(const ob_island_work *w, uint32_t row, ob_vec3 spin)
{
	const double leaning = 1e-6; // sine
	const ob_body *body = &w->body[row];
	if (!(ob_norm2(spin) * w->h * w->h > unnoticed_turn * unnoticed_turn))
		return false;
	for (uint32_t k = 0; k < body->adjacent; k++) {
		const uint32_t lane = w->contact[w->adjacency[body->first_adjacent + k]].lane;
		if (lane == OB_NO_LANE)
			continue;
		const ob_batch *b = &w->batch[lane / OB_LANES];
		const uint32_t l = lane % OB_LANES;
		const ob_vec3 across = ob_cross(spin, ob_batch_vector(b->n, l));
		if (!(ob_norm2(across) <= leaning * leaning * ob_norm2(spin)))
			return false;
	}
	return body->contacts > 0;
}

// Turns a body on which an external torque acts, or that spins upright on its contacts. Half of its change of angular
// momentum in the partial substep comes before the turn, half after it, so the error is of second order (Strang 1968). A
// jump that contacts have made comes before.
static void turn_by_halves(ob_solver *s, uint32_t row, ob_vec3 before, double smooth)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	const ob_vec3 change = ob_sub(ob_row_angular(w->v[row]), before),
		      external = ob_scale(ob_body_turned_by(body, body->torque), w->h);
	const bool held = !ob_equal(ob_add(before, external), ob_row_angular(w->v[row]));
	if (held && !(body->radius * body->radius * ob_norm2(change) < smooth)) {
		turn_body(s, row, held);
		return;
	}
	const ob_vec3 half = ob_scale(change, .5), momentum = momentum_of(body, half), rate = ob_add(before, half);
	if (ob_norm2(ob_cross(ob_row_angular(w->d[row]), rate)) * w->h * w->h > same_axis * same_axis)
		ob_body_update_pose(w, row); // turns about two axes are no sum
	set_rate(w->v[row], rate);
	turn_body(s, row, held);
	set_rate(w->v[row], ob_add(ob_row_angular(w->v[row]), ob_body_turned_by(body, momentum)));
}

// ---- velocities

void ob_body_set_velocity(ob_island_work *w, uint32_t row, ob_vec3 linear, ob_vec3 angular)
{
	memset(w->v[row], 0, sizeof *w->v);
	ob_row_add(w->v[row], linear, angular);
	set_speed_bound(w, row);
}

void ob_bodies_update_speed_bounds(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++)
		if (w->body[i].hit > 0)
			set_speed_bound(w, i);
}

void ob_bodies_warm_start(ob_solver *s)
{
	ob_island_work *w = &s->island;
	memset(w->dv, 0, w->rows * sizeof *w->dv);
	for (uint32_t i = 1; i <= w->bodies; i++)
		ob_row_add(w->dv[i], ob_scale(w->body[i].acceleration, w->h),
			   w->torques ? ob_scale(ob_body_turned_by(&w->body[i], w->body[i].torque), w->h)
				      : ob_v3(0, 0, 0));
	for (uint32_t k = 0; k < w->batches; k++) {
		const ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			ob_batch_apply_impulses(b, b->impulse, w->dv);
	}
	ob_surfaces_warm_start(s);
}

void ob_bodies_predict_velocities(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++)
		for (int c = 0; c < 6; c++)
			w->u[i][c] = w->v[i][c] + w->dv[i][c];
	ob_surfaces_predict_velocities(s);
}

// Integrates the position: by the trapezoidal rule after a smooth change of velocity (exact in free flight), by the new
// velocity after a jump.
static void integrate_exactly(ob_island_work *w, uint32_t row, double smooth)
{
	const double *v = w->v[row], *u = w->u[row];
	double *d = w->d[row], change = 0;
	for (int c = 0; c < 3; c++)
		change += (u[c] - v[c]) * (u[c] - v[c]);
	double old = change < smooth ? .5 * w->h : 0;
	for (int c = 0; c < 3; c++)
		d[c] += (w->h - old) * u[c] + old * v[c];
}

void ob_body_move(ob_solver *s, uint32_t row, double smooth)
{
	ob_island_work *w = &s->island;
	if (w->body[row].halved) {
		finish_halved(s, row, smooth);
		return;
	}
	const ob_vec3 before = ob_row_angular(w->v[row]);
	const bool held = !ob_equal(ob_row_angular(w->u[row]), before);
	integrate_exactly(w, row, smooth);
	memcpy(w->v[row], w->u[row], sizeof *w->v);
	if (ob_norm2(w->body[row].torque) > 0 || (held && spins_upright(w, row, before)))
		turn_by_halves(s, row, before, smooth);
	else
		turn_body(s, row, held);
}

static void advance_surface(ob_solver *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	ob_pose end;
	if (!ob_surface_advance(s, row, &end))
		return;
	update_gaps(w, row);
	memset(w->d[row], 0, sizeof(ob_body_row));
	ob_body_place(&w->body[row], end.p, end.q);
}

void ob_bodies_integrate_positions(ob_solver *s)
{
	ob_island_work *w = &s->island;
	w->unpaced += w->h;
	double smooth = 2 * w->max_acceleration * w->max_acceleration * w->h * w->h;
	ob_surfaces_carry(s);
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const double before = surface_speed(w, i);
		s->methods.move(s, i, smooth);
		set_speed_bound(w, i);
		w->body[i].path += w->h * ob_max(before, surface_speed(w, i)); // it may slow down
	}
	for (uint32_t row = w->bodies + 1; w->surfaces.count && row < w->rows; row++)
		advance_surface(s, row);
	w->time += w->h;
}

double ob_bodies_update_rest(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double rest_speed = .03 * w->unit.speed; // m/s, of any point
	double since = INFINITY;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		body->rest_time = body->speed < rest_speed ? body->rest_time + (float)s->settings->step_length : 0;
		since = ob_min(since, body->contacts > 0 || body->joints > 0 ? body->rest_time : 0);
	}
	return since;
}

void ob_bodies_report(ob_solver *s, uint32_t rest)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	const uint64_t step = s->in->step + 1;
	const bool expected = ob_equilibrium_expected(w);
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		ob_motion mo = { .t0 = step * run->step_length,
				 .valid_until = rest ? INFINITY : (step + 1) * run->step_length,
				 .p = body->p,
				 .q = body->q,
				 .v = ob_row_linear(w->v[i]),
				 .w = ob_row_angular(w->v[i]),
				 .path = body->path,
				 .step = (uint32_t)step,
				 .rest_time = body->rest_time,
				 .island = w->body[1].id,
				 .substeps = (uint16_t)body->next_substeps,
				 .flags = (body->moved_freely ? OB_MOTION_FREE : 0) | rest | body->refinement |
					  (expected && ob_equilibrium_body_steady(w, i) ? OB_MOTION_STEADY : 0) };
		if (!body->contacts && !body->joints)
			mo.a = body->acceleration;
		if (rest)
			mo.v = mo.w = ob_v3(0, 0, 0), body->deviation.rate = 0;
		ob_deviation_put(&mo, body->deviation);
		s->calls.motion(s->calls.with, &s->in->object[i - 1], &mo, body->moved_freely);
	}
}
