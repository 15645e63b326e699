#include "sim/bodies.h"

#include <stdlib.h>
#include <string.h>

#include "sim/broadphase.h"
#include "sim/equilibrium.h"
#include "sim/flight.h"
#include "sim/publish.h"

static void add_row(double *r, ob_vec3 linear, ob_vec3 angular)
{
	r[0] += linear.x, r[1] += linear.y, r[2] += linear.z;
	r[3] += angular.x, r[4] += angular.y, r[5] += angular.z;
}

static ob_vec3 linear_of(const double *r)
{
	return ob_v3(r[0], r[1], r[2]);
}
static ob_vec3 angular_of(const double *r)
{
	return ob_v3(r[3], r[4], r[5]);
}

// The inverse inertia in world axes, for the pose that the body has.
static void update_inertia(ob_body *body)
{
	if (body->inv_mass == 0)
		return;
	ob_vec3 k = ob_v3(1 / body->inertia.x, 1 / body->inertia.y, 1 / body->inertia.z);
	if (body->isotropic) {
		memcpy(body->inv_inertia, (double[6]){ k.x, 0, 0, k.x, 0, k.x }, sizeof body->inv_inertia);
		return;
	}
	int c = 0;
	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			body->inv_inertia[c++] = body->r.m[i][0] * body->r.m[j][0] * k.x +
						 body->r.m[i][1] * body->r.m[j][1] * k.y +
						 body->r.m[i][2] * body->r.m[j][2] * k.z;
}

static void load_body(ob_sim *s, uint32_t row, uint32_t id, bool moves)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	const ob_passport *pass = ob_passport_of(s->u, id);
	const ob_motion *mo = ob_newest_motion(s->u, id);
	const uint64_t step = ob_step_count(s->u);
	ob_state now = ob_ballistic_state(s, id, mo, (double)step * run->step_length);
	ob_body *body = &w->body[row];
	*body = (ob_body){ .id = id,
			   .shape = pass->shape,
			   .size = pass->size,
			   .p = now.pose.p,
			   .q = now.pose.q,
			   .r = ob_quat_matrix(now.pose.q),
			   .mass = moves ? pass->mass : 0,
			   .inertia = pass->inertia,
			   .friction = pass->friction,
			   .restitution = pass->restitution,
			   .path = ob_path_now(mo, step),
			   .rest_time = mo->rest_time,
			   .moved_freely = true };
	body->inv_mass = moves ? 1 / pass->mass : 0;
	body->isotropic = pass->inertia.x == pass->inertia.y && pass->inertia.y == pass->inertia.z;
	body->radius = ob_shape_radius(pass->shape, pass->size);
	body->thickness = ob_shape_thickness(pass->shape, pass->size);
	update_inertia(body);
	if (!moves)
		return;
	add_row(w->v[row], now.v, now.w);
	w->mass += pass->mass;
	body->acceleration = ob_external_acceleration(run, pass);
	w->max_acceleration = fmax(w->max_acceleration, ob_norm(body->acceleration));
	body->speed = ob_surface_speed(now.v, now.w, body->shape, body->size);
}

static void reserve_rows(ob_island_work *w, uint32_t rows)
{
	if (rows > w->rows_max) {
		w->rows_max = rows + rows / 2 + 16;
		w->body = realloc(w->body, w->rows_max * sizeof *w->body);
		ob_body_row **all[] = { &w->v, &w->dv, &w->u, &w->d, &w->delta, &w->drift };
		for (int i = 0; i < 6; i++)
			free(*all[i]), *all[i] = aligned_alloc(64, w->rows_max * sizeof **all[i]);
	}
}

void ob_bodies_load(ob_sim *s, const ob_island *is)
{
	ob_step_data *data = s->data;
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	w->h = w->substep = run->step_length / w->substeps;
	w->mass = w->max_acceleration = w->recovered = w->residual = 0;
	w->projected = false;
	w->error = w->new_error = 0;
	w->bodies = is->members;
	// Fixed bodies, once per pair at most, and two ghosts for each of the other pairs.
	uint32_t most = 1 + is->members + 2 * is->pairs;
	reserve_rows(w, most);
	ob_body_row *all[] = { w->v, w->dv, w->u, w->d, w->delta, w->drift };
	for (int i = 0; i < 6; i++)
		memset(all[i], 0, most * sizeof *all[i]);
	memset(&w->body[0], 0, sizeof w->body[0]);
	w->rows = 1;
	for (uint32_t i = 0; i < is->members; i++) {
		uint32_t id = data->member[is->first_member + i];
		w->row_of[id] = w->rows;
		load_body(s, w->rows++, id, true);
	}
	for (uint32_t i = 0; i < is->pairs; i++) {
		const ob_pair_key *k = &data->pair[data->island_pair[is->first_pair + i]];
		uint32_t fixed = data->schedule[k->a].state < OB_SCHEDULE_AWAKE   ? k->a
				 : data->schedule[k->b].state < OB_SCHEDULE_AWAKE ? k->b
										  : UINT32_MAX;
		if (fixed == UINT32_MAX || (w->row_of[fixed] < w->rows && w->row_of[fixed] > w->bodies &&
					    w->body[w->row_of[fixed]].id == fixed))
			continue;
		w->row_of[fixed] = w->rows;
		load_body(s, w->rows++, fixed, false);
	}
	w->first_ghost = w->rows;
}

static void update_row_pose(ob_island_work *w, uint32_t row)
{
	ob_body *body = &w->body[row];
	double *d = w->d[row];
	if (d[0] == 0 && d[1] == 0 && d[2] == 0 && d[3] == 0 && d[4] == 0 && d[5] == 0)
		return;
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
			b->gap[j][l] += sign * opened;
		}
	}
	body->p = ob_add(body->p, linear_of(d));
	ob_vec3 th = angular_of(d);
	if (ob_norm2(th) > 0) {
		body->q = ob_quat_turn(body->q, th);
		body->r = ob_quat_matrix(body->q);
		update_inertia(body);
	}
	memset(d, 0, sizeof(ob_body_row));
}

// A ghost moves with the body that it stands for, and by as much.
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

// Euler's equations over h by the midpoint rule, in the body frame. ODE's integrator does its own gyroscopic step.
void ob_bodies_gyroscopic_step(ob_sim *s)
{
	ob_island_work *w = &s->island;
	if (s->settings->integrator == OB_INTEGRATOR_ODE)
		return;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		ob_vec3 now = angular_of(w->v[i]), j = body->inertia;
		if (body->isotropic || ob_norm2(now) < 1e-12)
			continue;
		s->counters.gyroscopic_steps++;
		ob_vec3 b = ob_rotate_back(&body->r, now), mid = b;
		for (int stage = 0; stage < 2; stage++) {
			double h = stage ? w->h : .5 * w->h;
			ob_vec3 rate = ob_v3((j.y - j.z) / j.x * mid.y * mid.z, (j.z - j.x) / j.y * mid.z * mid.x,
					     (j.x - j.y) / j.z * mid.x * mid.y);
			mid = ob_madd(b, h, rate);
		}
		// The rule's error in energy is small; scaling the angular velocity takes it out.
		double energy = j.x * b.x * b.x + j.y * b.y * b.y + j.z * b.z * b.z;
		double found = j.x * mid.x * mid.x + j.y * mid.y * mid.y + j.z * mid.z * mid.z;
		ob_vec3 next = ob_scale(ob_rotate(&body->r, mid), sqrt(energy / found));
		w->v[i][3] = next.x, w->v[i][4] = next.y, w->v[i][5] = next.z;
	}
}

void ob_bodies_update_speed_bounds(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		body->speed = ob_surface_speed(linear_of(w->v[i]), angular_of(w->v[i]), body->shape, body->size);
	}
}

void ob_bodies_warm_start(ob_sim *s)
{
	ob_island_work *w = &s->island;
	memset(w->dv, 0, w->rows * sizeof *w->dv);
	for (uint32_t i = 1; i <= w->bodies; i++)
		add_row(w->dv[i], ob_scale(w->body[i].acceleration, w->h), ob_v3(0, 0, 0));
	for (uint32_t k = 0; k < w->batches; k++) {
		const ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			ob_batch_apply_impulses(b, b->impulse, w->dv);
	}
}

void ob_bodies_predict_velocities(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++)
		for (int c = 0; c < 6; c++)
			w->u[i][c] = w->v[i][c] + w->dv[i][c];
}

// ODE's integrator instead of ours: the impulses of the partial substep go in as a force.
static void integrate_by_ode(ob_sim *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	ob_vec3 g = ob_scale(s->settings->gravity, w->h);
	double change[6];
	for (int c = 0; c < 6; c++)
		change[c] = w->u[row][c] - w->v[row][c];
	ob_vec3 j = ob_scale(ob_sub(linear_of(change), g), body->mass),
		wl = ob_rotate_back(&body->r, angular_of(change));
	ob_vec3 l = ob_rotate(&body->r, ob_v3(wl.x * body->inertia.x, wl.y * body->inertia.y, wl.z * body->inertia.z));
	ob_state state = { { body->p, body->q }, linear_of(w->v[row]), angular_of(w->v[row]) };
	ob_pose before = state.pose;
	ob_ode_body_step(ob_ode_bodies_get(&s->ode_bodies, s->u, body->id), &state, j, l, w->h);
	// The displacement row takes the step, so that the gaps follow; the turn is what ODE made of it.
	ob_quat turn = ob_quat_mul(state.pose.q, (ob_quat){ before.q.w, -before.q.x, -before.q.y, -before.q.z });
	double sin_half = sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
	double angle = 2 * atan2(sin_half, turn.w), scale = sin_half > 1e-12 ? angle / sin_half : 2;
	add_row(w->d[row], ob_sub(state.pose.p, before.p), ob_scale(ob_v3(turn.x, turn.y, turn.z), scale));
	memset(w->u[row], 0, sizeof(ob_body_row));
	add_row(w->u[row], state.v, state.w);
}

// By the trapezoidal rule where the velocity changed smoothly (exact in free flight), by the new velocity where it
// jumped.
static void integrate_exactly(ob_island_work *w, uint32_t row, double smooth)
{
	const double *v = w->v[row], *u = w->u[row];
	double *d = w->d[row], change = 0;
	for (int c = 0; c < 3; c++)
		change += (u[c] - v[c]) * (u[c] - v[c]);
	double old = change < smooth ? .5 * w->h : 0;
	for (int c = 0; c < 3; c++)
		d[c] += (w->h - old) * u[c] + old * v[c];
	for (int c = 3; c < 6; c++)
		d[c] += w->h * u[c];
}

void ob_bodies_integrate_positions(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	double smooth = 2 * w->max_acceleration * w->max_acceleration * w->h * w->h;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		if (run->integrator == OB_INTEGRATOR_ODE)
			integrate_by_ode(s, i);
		else
			integrate_exactly(w, i, smooth);
		memcpy(w->v[i], w->u[i], sizeof *w->v);
		body->speed = ob_surface_speed(linear_of(w->u[i]), angular_of(w->u[i]), body->shape, body->size);
		body->path += w->h * body->speed;
		if (ob_norm2(angular_of(w->d[i])) > 4e-4 || ob_norm2(linear_of(w->d[i])) > .01 ||
		    run->integrator == OB_INTEGRATOR_ODE)
			ob_body_update_pose(w, i);
	}
}

bool ob_bodies_update_rest(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	const double sleep_speed = .03, sleep_delay = .5; // m/s, s
	bool asleep = run->sleeping;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		double vv = ob_norm2(linear_of(w->v[i])), ww = ob_norm2(angular_of(w->v[i]));
		body->rest_time = vv < sleep_speed * sleep_speed && ww < 4 * sleep_speed * sleep_speed
					  ? body->rest_time + (float)run->step_length
					  : 0;
		asleep &= body->rest_time >= sleep_delay && body->contacts > 0;
	}
	return asleep;
}

static bool finite_row(const double *r)
{
	double sum = 0;
	for (int c = 0; c < 6; c++)
		sum += r[c] * 0;
	return sum == 0;
}

void ob_bodies_publish(ob_sim *s, uint32_t rest)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	uint64_t step = ob_step_count(s->u) + 1;
	const bool confirmed = ob_equilibrium_confirmed(w);
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		ob_motion mo = { .t0 = step * run->step_length,
				 .valid_until = rest ? INFINITY : (step + 1) * run->step_length,
				 .p = body->p,
				 .q = body->q,
				 .v = linear_of(w->v[i]),
				 .w = angular_of(w->v[i]),
				 .path = body->path,
				 .step = (uint32_t)step,
				 .rest_time = body->rest_time,
				 .island = w->body[1].id,
				 .substeps = body->next_substeps,
				 .flags = (body->moved_freely ? OB_MOTION_FREE : 0) | rest |
					  (confirmed && ob_equilibrium_body_steady(w, i) ? OB_MOTION_STEADY : 0) };
		if (!body->contacts)
			mo.a = body->acceleration;
		if (rest)
			mo.v = mo.w = ob_v3(0, 0, 0);
		ob_state end = { { mo.p, mo.q }, mo.v, mo.w };
		if (body->moved_freely &&
		    run->integrator == OB_INTEGRATOR_EXACT) { // substeps only searched for impacts
			ob_motion flight = ob_ballistic_flight(s, body->id);
			end = ob_ballistic_state(s, body->id, &flight, mo.t0);
			mo.t0 = flight.t0, mo.valid_until = flight.valid_until;
			mo.p = flight.p, mo.q = flight.q, mo.v = flight.v, mo.w = flight.w;
		}
		if (!finite_row(w->v[i]) || !isfinite(body->p.x + body->p.y + body->p.z))
			s->data->count->failure = OB_STEP_DIVERGED;
		ob_body_publish(s, body->id, &mo, &end);
	}
}
