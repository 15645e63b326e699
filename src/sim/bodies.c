#include "sim/bodies.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "motion/drift.h"
#include "sim/broadphase.h"
#include "sim/equilibrium.h"
#include "sim/flight.h"
#include "sim/narrowphase.h"
#include "sim/pairs.h"
#include "sim/publish.h"
#include "sim/relative_speed.h"
#include "sim/surfaces.h"

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
static bool same_vector(ob_vec3 a, ob_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

// For the pose that the body has.
static void update_inertia(ob_body *body)
{
	if (body->inv_mass > 0)
		ob_inverse_inertia(body->inertia, &body->r, body->inv_inertia);
}

// Of any point of the body, while it turns freely through a partial substep.
static void set_speed_bound(ob_island_work *w, uint32_t row)
{
	ob_body *body = &w->body[row];
	const ob_vec3 rate = ob_rotate_back(&body->r, angular_of(w->v[row]));
	body->turning = ob_turning_speed(body->shape, body->size, body->inertia, rate, w->h);
	body->speed = ob_norm(linear_of(w->v[row])) + body->turning;
	if (ob_has_axis(body->shape))
		body->speed += body->radius * fabs(rate.z);
}

// m/s, bound of how fast the body's surface moves: its points may do so faster, where a round body spins.
static double surface_speed(const ob_island_work *w, uint32_t row)
{
	return ob_norm(linear_of(w->v[row])) + w->body[row].turning;
}

// rad/s^2, by a torque (N m, world)
static ob_vec3 turned_by(const ob_body *body, ob_vec3 torque)
{
	const double *i = body->inv_inertia; // xx xy xz yy yz zz
	return ob_v3(i[0] * torque.x + i[1] * torque.y + i[2] * torque.z,
		     i[1] * torque.x + i[3] * torque.y + i[4] * torque.z,
		     i[2] * torque.x + i[4] * torque.y + i[5] * torque.z);
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
			   .hull = ob_hull_of(s->u, pass),
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
	body->rest_depth = ob_narrowphase_rest_depth(s, body->thickness, true);
	update_inertia(body);
	if (!moves)
		return;
	add_row(w->v[row], now.v, now.w);
	w->mass += pass->mass;
	body->acceleration = ob_external_acceleration(run, pass);
	body->torque = ob_script_torque(s->data, id);
	if (ob_norm2(body->torque) > 0) {
		w->torques = true;
		body->moved_freely = false; // no closed form holds it
	}
	set_speed_bound(w, row);
}

static void reserve_rows(ob_island_work *w, uint32_t rows)
{
	if (rows > w->rows_max) {
		w->rows_max = rows + rows / 2 + 16;
		w->body = ob_reallocate(w->body, w->rows_max * sizeof *w->body);
		ob_body_row **all[] = { &w->v, &w->dv, &w->u, &w->d, &w->delta, &w->drift };
		for (int i = 0; i < 6; i++)
			free(*all[i]), *all[i] = ob_allocate_aligned(64, w->rows_max * sizeof **all[i]);
	}
}

// ---- the frame of reference

static const double same_share = 1e-9; // of an acceleration: another that differs by less is the same

static bool is_slippery(const ob_body *body)
{
	return body->shape == OB_SHAPE_PLANE && body->friction == 0;
}

// m/s^2, of a against b, as it is felt on the body that has b: what goes along a plane without friction is not.
static double felt_on(const ob_body *body, ob_vec3 a, ob_vec3 b)
{
	const ob_vec3 felt = ob_sub(a, b);
	return is_slippery(body) ? fabs(ob_dot(felt, ob_column(&body->r, 2))) : ob_norm(felt);
}

// Of what moves itself: exactly that of each where all have the same.
static ob_vec3 mean_acceleration(const ob_island_work *w)
{
	ob_vec3 sum = { 0, 0, 0 };
	bool same = true;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		sum = ob_madd(sum, w->body[i].mass / w->mass, w->body[i].acceleration);
		same &= same_vector(w->body[i].acceleration, w->body[1].acceleration);
	}
	return same ? w->body[1].acceleration : sum;
}

// The acceleration of what holds the bodies, which is one as long as all of it goes with it; of bodies that nothing
// holds, their mean. 0: there is no such frame.
static ob_vec3 find_frame(const ob_island_work *w)
{
	const ob_vec3 none = { 0, 0, 0 };
	const ob_body *holds = NULL, *slippery = NULL;
	for (uint32_t row = 1 + w->bodies; row < w->rows; row++)
		if (w->body[row].holds)
			*(is_slippery(&w->body[row]) ? &slippery : &holds) = &w->body[row];
	if (w->in_field && !holds && !slippery)
		return none;
	ob_vec3 a = holds ? holds->acceleration : mean_acceleration(w);
	if (slippery && !holds) {
		const ob_vec3 n = ob_column(&slippery->r, 2);
		const ob_vec3 along = ob_madd(a, -ob_dot(a, n), n);
		a = ob_norm(along) > same_share * ob_norm(a) ? along : none;
	}
	for (uint32_t row = 1 + w->bodies; row < w->rows; row++)
		if (w->body[row].holds &&
		    (felt_on(&w->body[row], w->body[row].acceleration, a) > same_share * ob_norm(a) ||
		     ob_surface_swings(w, row)))
			return none;
	return a;
}

// m/s^2, by a body, the largest on any of what holds it. What a surface that swings takes away when the step begins it
// may give again before the end.
static double felt_on_any(const ob_island_work *w, const ob_body *body)
{
	const ob_vec3 none = { 0, 0, 0 };
	double most = w->rows == 1 + w->bodies && w->in_field ? ob_norm(body->acceleration) : 0;
	for (uint32_t row = 1 + w->bodies; row < w->rows; row++) {
		const ob_body *holds = &w->body[row];
		const bool as_before = row > 1 + w->bodies && !is_slippery(holds) && !is_slippery(holds - 1) &&
				       holds[-1].holds && same_vector(holds->acceleration, holds[-1].acceleration);
		if (!holds->holds)
			continue;
		if (!as_before)
			most = ob_max(most, felt_on(holds, body->acceleration, holds->acceleration));
		if (ob_surface_swings(w, row))
			most = ob_max(most, felt_on(holds, body->acceleration, none));
	}
	return most;
}

// m/s^2: the largest that is felt on what holds the bodies, and by one of them against the others.
static double felt_acceleration(const ob_island_work *w)
{
	const ob_vec3 mean = mean_acceleration(w);
	double most = 0;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		if (i > 1 && !w->torques && same_vector(body->acceleration, body[-1].acceleration))
			continue;
		double felt = ob_norm(ob_sub(body->acceleration, mean));
		felt = ob_max(felt, felt_on_any(w, body));
		if (w->torques)
			felt += body->radius * ob_norm(turned_by(body, body->torque));
		most = ob_max(most, felt);
	}
	return most;
}

// The row of the pair that is fixed or moves as it is told; 0: both move themselves.
static uint32_t holding_row(const ob_sim *s, const ob_island *is, uint32_t pair)
{
	const ob_island_work *w = &s->island;
	const ob_pair_key *k = &s->data->pair[s->data->island_pair[is->first_pair + pair]];
	const uint32_t own = w->surfaces.count ? ob_surface_row(w, pair) : 0;
	const uint32_t a = w->row_of[k->a], b = w->row_of[k->b];
	return own ? own : a > w->bodies ? a : b > w->bodies ? b : 0;
}

// J, of the bodies' motion against their centre of mass
static double inner_energy(const ob_island_work *w)
{
	ob_vec3 mean = { 0, 0, 0 };
	double sum = 0;
	for (uint32_t i = 1; i <= w->bodies; i++)
		mean = ob_madd(mean, w->body[i].mass / w->mass, linear_of(w->v[i]));
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		const ob_vec3 rate = ob_rotate_back(&body->r, angular_of(w->v[i])), k = body->inertia;
		sum += .5 * body->mass * ob_norm2(ob_sub(linear_of(w->v[i]), mean)) +
		       .5 * (k.x * rate.x * rate.x + k.y * rate.y * rate.y + k.z * rate.z * rate.z);
	}
	return sum;
}

// m/s, of any point of a body against the centre of mass: hits among the bodies give it no more.
static double most_inner_speed(const ob_body *body, double energy)
{
	const ob_vec3 k = body->inertia;
	const double least = ob_min(k.x, ob_min(k.y, k.z));
	return sqrt(2 * energy / body->mass) + (least > 0 ? body->radius * sqrt(2 * energy / least) : 0);
}

// True where the pair may touch within the step, whatever hits before that do to b: the same however fast all of it
// goes. energy: J, inner
static bool comes_near(ob_sim *s, uint32_t a, uint32_t b, double energy)
{
	const ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	const ob_contact pair = { .a = a, .b = b };
	const double gained = h * ob_norm(ob_sub(w->body[a].acceleration, w->body[b].acceleration));
	const double way = h * (ob_contact_speed(w, &pair) + gained + 2 * most_inner_speed(&w->body[b], energy));
	return ob_narrowphase_distance(s, a, b, way) <= way;
}

// Bodies that touch each other in the air, unless they are solved as in a field, are held by what they come near in the
// step. Of a single one it does not matter, and what carries a load is held.
static void find_what_holds(ob_sim *s, const ob_island *is)
{
	ob_island_work *w = &s->island;
	bool held = is->members == 1 || w->in_field;
	for (uint32_t i = 0; i < is->pairs && !held; i++)
		held = holding_row(s, is, i) &&
		       ob_pair_carried_load(s->u, &s->data->pair[s->data->island_pair[is->first_pair + i]]);
	for (uint32_t row = 1 + w->bodies; row < w->rows; row++)
		w->body[row].holds = held;
	const double energy = held ? 0 : inner_energy(w);
	for (uint32_t i = 0; i < is->pairs && !held; i++) {
		const ob_pair_key *k = &s->data->pair[s->data->island_pair[is->first_pair + i]];
		const uint32_t row = holding_row(s, is, i);
		const uint32_t other = row && w->body[row].id == k->a ? w->row_of[k->b] : w->row_of[k->a];
		if (row && !w->body[row].holds)
			w->body[row].holds = comes_near(s, row, other, energy);
	}
}

// What falls together feels nothing of it, and what stands on a lift feels it as weight: an island is solved as seen by
// who speeds up with what holds it, and how far that has come is added in the end.
static void enter_frame(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const bool ode = s->settings->integrator == OB_INTEGRATOR_ODE;
	w->frame = ode ? ob_v3(0, 0, 0) : find_frame(w);
	for (uint32_t row = 1; row < w->rows && ob_norm2(w->frame) > 0; row++)
		w->body[row].acceleration =
			is_slippery(&w->body[row]) ? ob_v3(0, 0, 0) : ob_sub(w->body[row].acceleration, w->frame);
	w->max_acceleration = felt_acceleration(w);
	for (uint32_t row = 1; row < w->rows && w->max_acceleration == 0; row++)
		w->body[row].rest_depth = ob_narrowphase_rest_depth(s, w->body[row].thickness, false);
}

void ob_bodies_leave_frame(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	for (uint32_t row = 1; row < w->rows && ob_norm2(w->frame) > 0; row++) {
		ob_body *body = &w->body[row];
		if (row > w->bodies && !body->surface)
			continue;
		body->acceleration = ob_add(body->acceleration, w->frame);
		body->p = ob_madd(body->p, .5 * h * h, w->frame);
		add_row(w->v[row], ob_scale(w->frame, h), ob_v3(0, 0, 0));
		if (row > w->bodies)
			continue;
		body->path += .5 * h * h * ob_norm(w->frame);
		set_speed_bound(w, row);
	}
}

void ob_bodies_load(ob_sim *s, const ob_island *is)
{
	ob_step_data *data = s->data;
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	w->h = w->substep = run->step_length / w->substeps;
	w->mass = w->recovered = w->residual = 0;
	w->projected = w->torques = false;
	w->unpaced = w->time = 0;
	w->surfaces.count = 0;
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
		if (fixed != UINT32_MAX && ob_surface_moves(ob_passport_of(s->u, fixed))) {
			w->row_of[fixed] = w->rows;
			load_body(s, w->rows, fixed, false);
			ob_surface_add(s, w->rows++, i);
			continue;
		}
		if (fixed == UINT32_MAX || (w->row_of[fixed] < w->rows && w->row_of[fixed] > w->bodies &&
					    w->body[w->row_of[fixed]].id == fixed))
			continue;
		w->row_of[fixed] = w->rows;
		load_body(s, w->rows++, fixed, false);
	}
	w->first_ghost = w->rows;
	find_what_holds(s, is);
	enter_frame(s);
}

// ---- attitudes

// A body that contacts hold may turn this little (rad) in a partial substep before Euler's equations are solved for it
// ..
static const double unnoticed_turn = 1e-5;
static const double deferred_turn = 1e-4; // .. and so much in all before its attitude is brought up to date
static const double deferred_turn_isotropic = .02;

// The gaps of the row's contacts follow its displacement, to first order.
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

// The pose takes the displacement row. Where that turns a body whose rate is not free of its attitude, the rate turns
// with it: so the energy stays.
static void update_row_pose(ob_island_work *w, uint32_t row)
{
	ob_body *body = &w->body[row];
	double *d = w->d[row];
	if (d[0] == 0 && d[1] == 0 && d[2] == 0 && d[3] == 0 && d[4] == 0 && d[5] == 0)
		return;
	update_gaps(w, row);
	body->p = ob_add(body->p, linear_of(d));
	ob_vec3 th = angular_of(d);
	if (ob_norm2(th) > 0) {
		ob_vec3 rate = ob_rotate_back(&body->r, angular_of(w->v[row]));
		set_attitude(body, ob_quat_turn(body->q, th));
		if (!body->isotropic)
			set_rate(w->v[row], ob_rotate(&body->r, rate));
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

// The row's pose takes its displacement, and turns freely for h (s). held: contacts have changed its rate.
static void drift_row(ob_island_work *w, uint32_t row, double h, bool held)
{
	ob_body *body = &w->body[row];
	double *d = w->d[row];
	ob_quat q;
	ob_vec3 rate;
	if (ob_norm2(angular_of(d)) > 0)
		update_row_pose(w, row);
	(held ? ob_drift_held : ob_drift)(body->q, angular_of(w->v[row]), body->inertia, h, &q, &rate);
	add_row(d, ob_v3(0, 0, 0), ob_small_turn(body->q, q));
	update_gaps(w, row);
	ob_body_place(body, ob_add(body->p, linear_of(d)), q);
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

// From the midpoint (sim/midpoint.h) to the partial substep's end. Where the velocity jumped, as if it had jumped at
// the start.
static void finish_halved(ob_island_work *w, uint32_t row, double smooth)
{
	ob_body *body = &w->body[row];
	double *v = w->v[row], *d = w->d[row];
	const double *u = w->u[row], h = .5 * w->h;
	ob_vec3 jump = ob_sub(linear_of(u), linear_of(v)), jump_turn = ob_sub(angular_of(u), angular_of(v)), rate;
	const bool jumped = ob_norm2(jump) >= smooth || body->radius * body->radius * ob_norm2(jump_turn) >= 9 * smooth;
	ob_vec3 way = ob_scale(linear_of(u), h);
	ob_quat q;
	if (jumped)
		way = ob_madd(way, h, jump);
	ob_drift_held(body->q, angular_of(u), body->inertia, h, &q, &rate);
	if (jumped) {
		ob_quat turned = ob_quat_turn(q, ob_scale(jump_turn, h));
		ob_mat3 from = ob_quat_matrix(q), to = ob_quat_matrix(turned);
		rate = ob_rotate(&to, ob_rotate_back(&from, rate));
		q = turned;
	}
	memcpy(v, u, sizeof *w->v);
	set_rate(v, rate);
	memset(d, 0, sizeof *w->d);
	add_row(d, ob_add(way, linear_of(body->first_half)), ob_small_turn(body->start_q, q));
	update_gaps(w, row);
	memset(d, 0, sizeof *w->d);
	ob_body_place(body, ob_add(body->p, way), q);
}

// Brings a body's attitude to the partial substep's end: at once where it turns noticeably or nothing holds it, so that
// it turns as it would in free flight; else by the displacement row. held: contacts have changed its rate.
static void turn_body(ob_sim *s, uint32_t row, bool held)
{
	ob_island_work *w = &s->island;
	const ob_body *body = &w->body[row];
	double *d = w->d[row];
	const ob_vec3 turn = ob_scale(angular_of(w->v[row]), w->h);
	const double turned = ob_norm2(turn);
	if (body->isotropic || turned == 0 || (held && turned < unnoticed_turn * unnoticed_turn)) {
		add_row(d, ob_v3(0, 0, 0), turn);
		const double most = body->isotropic ? deferred_turn_isotropic : deferred_turn;
		if (ob_norm2(angular_of(d)) > most * most)
			ob_body_update_pose(w, row);
		return;
	}
	s->counters.gyroscopic_steps++;
	drift_body(w, row, w->h, held && w->max_acceleration > 0);
}

// ---- velocities

void ob_body_set_velocity(ob_island_work *w, uint32_t row, ob_vec3 linear, ob_vec3 angular)
{
	memset(w->v[row], 0, sizeof *w->v);
	add_row(w->v[row], linear, angular);
	set_speed_bound(w, row);
}

void ob_bodies_update_speed_bounds(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++)
		if (w->body[i].hit > 0)
			set_speed_bound(w, i);
}

void ob_bodies_warm_start(ob_sim *s)
{
	ob_island_work *w = &s->island;
	memset(w->dv, 0, w->rows * sizeof *w->dv);
	for (uint32_t i = 1; i <= w->bodies; i++)
		add_row(w->dv[i], ob_scale(w->body[i].acceleration, w->h),
			w->torques ? ob_scale(turned_by(&w->body[i], w->body[i].torque), w->h) : ob_v3(0, 0, 0));
	for (uint32_t k = 0; k < w->batches; k++) {
		const ob_batch *b = &w->batch[w->batch_order[k]];
		if (b->live)
			ob_batch_apply_impulses(b, b->impulse, w->dv);
	}
	ob_surfaces_warm_start(s);
}

void ob_bodies_predict_velocities(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++)
		for (int c = 0; c < 6; c++)
			w->u[i][c] = w->v[i][c] + w->dv[i][c];
	ob_surfaces_predict_velocities(s);
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
	if (!ob_ode_body_step(ob_ode_bodies_get(&s->ode_bodies, s->u, body->id), &state, j, l, w->h))
		ob_step_fail(s->u, OB_STEP_ENGINE, body->id);
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
}

static void advance_surface(ob_sim *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	ob_pose end;
	if (!ob_surface_advance(s, row, &end))
		return;
	update_gaps(w, row);
	memset(w->d[row], 0, sizeof(ob_body_row));
	ob_body_place(&w->body[row], end.p, end.q);
}

void ob_bodies_integrate_positions(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	w->unpaced += w->h;
	double smooth = 2 * w->max_acceleration * w->max_acceleration * w->h * w->h;
	ob_surfaces_carry(s);
	for (uint32_t i = 1; i <= w->bodies; i++) {
		if (run->integrator == OB_INTEGRATOR_ODE) {
			integrate_by_ode(s, i);
			ob_body_update_pose(w, i);
			memcpy(w->v[i], w->u[i], sizeof *w->v);
		} else if (w->body[i].halved) {
			finish_halved(w, i, smooth);
		} else {
			bool held = !same_vector(angular_of(w->u[i]), angular_of(w->v[i]));
			integrate_exactly(w, i, smooth);
			memcpy(w->v[i], w->u[i], sizeof *w->v);
			turn_body(s, i, held);
		}
		set_speed_bound(w, i);
		w->body[i].path += w->h * surface_speed(w, i);
	}
	for (uint32_t row = w->bodies + 1; w->surfaces.count && row < w->rows; row++)
		advance_surface(s, row);
	w->time += w->h;
}

double ob_bodies_update_rest(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double rest_speed = .03 * w->unit.speed; // m/s, of any point
	double since = INFINITY;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		body->rest_time = body->speed < rest_speed ? body->rest_time + (float)s->settings->step_length : 0;
		since = ob_min(since, body->contacts > 0 ? body->rest_time : 0);
	}
	return since;
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
		ob_body_publish(s, body->id, &mo, &end);
	}
}
