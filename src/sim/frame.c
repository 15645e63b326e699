#include "sim/frame.h"

#include "sim/bodies.h"
#include "sim/narrowphase.h"
#include "sim/pairs.h"
#include "sim/relative_speed.h"
#include "sim/surfaces.h"

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
		same &= ob_equal(w->body[i].acceleration, w->body[1].acceleration);
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
				       holds[-1].holds && ob_equal(holds->acceleration, holds[-1].acceleration);
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
		if (i > 1 && !w->torques && ob_equal(body->acceleration, body[-1].acceleration))
			continue;
		double felt = ob_norm(ob_sub(body->acceleration, mean));
		felt = ob_max(felt, felt_on_any(w, body));
		if (w->torques)
			felt += body->radius * ob_norm(ob_body_turned_by(body, body->torque));
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
		mean = ob_madd(mean, w->body[i].mass / w->mass, ob_row_linear(w->v[i]));
	for (uint32_t i = 1; i <= w->bodies; i++) {
		const ob_body *body = &w->body[i];
		const ob_vec3 rate = ob_rotate_back(&body->r, ob_row_angular(w->v[i])), k = body->inertia;
		sum += .5 * body->mass * ob_norm2(ob_sub(ob_row_linear(w->v[i]), mean)) +
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

void ob_frame_enter(ob_sim *s, const ob_island *is)
{
	ob_island_work *w = &s->island;
	const bool ode = s->settings->integrator == OB_INTEGRATOR_ODE;
	find_what_holds(s, is);
	w->frame = ode ? ob_v3(0, 0, 0) : find_frame(w);
	for (uint32_t row = 1; row < w->rows && ob_norm2(w->frame) > 0; row++)
		w->body[row].acceleration =
			is_slippery(&w->body[row]) ? ob_v3(0, 0, 0) : ob_sub(w->body[row].acceleration, w->frame);
	w->max_acceleration = felt_acceleration(w);
	for (uint32_t row = 1; row < w->rows && w->max_acceleration == 0; row++)
		w->body[row].rest_depth = ob_narrowphase_rest_depth(s, w->body[row].thickness, false);
}

void ob_frame_leave(ob_sim *s)
{
	ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	for (uint32_t row = 1; row < w->rows && ob_norm2(w->frame) > 0; row++) {
		ob_body *body = &w->body[row];
		if (row > w->bodies && !body->surface)
			continue;
		body->acceleration = ob_add(body->acceleration, w->frame);
		body->p = ob_madd(body->p, .5 * h * h, w->frame);
		ob_body_set_velocity(w, row, ob_add(ob_row_linear(w->v[row]), ob_scale(w->frame, h)),
				     ob_row_angular(w->v[row]));
		if (row <= w->bodies)
			body->path += .5 * h * h * ob_norm(w->frame);
	}
}
