#include "solver/frame.h"

#include "shape/shape.h"
#include "solver/bodies.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"

static const double same_share = 1e-9; // share of an acceleration: smaller differences do not count

static bool is_slippery(const ob_body *body)
{
	return ob_shape_is(body->shape, OB_UNBOUNDED) && body->friction == 0;
}

// Returns the magnitude of a - b (m/s^2) as it acts on the body, whose acceleration is b. Its component along a plane
// without friction does not count.
static double felt_on(const ob_body *body, ob_vec3 a, ob_vec3 b)
{
	const ob_vec3 felt = ob_sub(a, b);
	return is_slippery(body) ? fabs(ob_dot(felt, ob_column(&body->r, 2))) : ob_norm(felt);
}

// Returns the mean acceleration of the moving bodies (m/s^2): exactly the common one if they share it.
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

// Returns the acceleration (m/s^2) of the bodies that hold the island, if they all share it; if nothing holds it, the
// mean of its bodies. 0: no such frame exists.
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

// Returns the largest acceleration (m/s^2) that a body feels relative to those that hold it. A swinging surface may
// take its acceleration away at the step's start and return it before the end: both cases count.
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

// Returns the largest acceleration (m/s^2) felt by a body relative to those that hold it, or to the other bodies.
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

// Returns the row of the pair's body that is fixed or driven (solver/surfaces.h); 0: both bodies are dynamic.
static uint32_t holding_row(const ob_solver *s, const ob_island_input *in, uint32_t pair)
{
	const ob_island_work *w = &s->island;
	const ob_island_pair *k = &in->pair[pair];
	const uint32_t own = w->surfaces.count ? ob_surface_row(w, pair) : 0;
	const uint32_t a = w->row_of[k->a], b = w->row_of[k->b];
	return own ? own : a > w->bodies ? a : b > w->bodies ? b : 0;
}

// Returns the energy (J) of the bodies' motion relative to their centre of mass.
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

// Bounds the speed (m/s) of any point of a body relative to the centre of mass: impacts among the bodies cannot exceed
// it. energy: J, inner.
static double most_inner_speed(const ob_body *body, double energy)
{
	const ob_vec3 k = body->inertia;
	const double least = ob_min(k.x, ob_min(k.y, k.z));
	return sqrt(2 * energy / body->mass) + (least > 0 ? body->radius * sqrt(2 * energy / least) : 0);
}

// True if the pair may touch within the step, whatever impacts before that do to b. Does not depend on the common
// velocity. energy: J, inner.
static bool comes_near(ob_solver *s, uint32_t a, uint32_t b, double energy)
{
	const ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	const ob_contact pair = { .a = a, .b = b };
	const double gained = h * ob_norm(ob_sub(w->body[a].acceleration, w->body[b].acceleration));
	const double way = h * (ob_contact_speed(w, &pair) + gained + 2 * most_inner_speed(&w->body[b], energy));
	return ob_narrowphase_distance(s, a, b, way) <= way;
}

// Marks the bodies that hold the island. Bodies that touch each other in the air are held by those that they come near
// in the step. Bodies solved in the field are held by all. So are a single body, and an island whose fixed contacts
// carry load.
static void find_what_holds(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	bool held = in->members == 1 || w->in_field;
	for (uint32_t i = 0; i < in->pairs && !held; i++)
		held = holding_row(s, in, i) && ob_pair_carried_load(in->pair[i].before);
	for (uint32_t row = 1 + w->bodies; row < w->rows; row++)
		w->body[row].holds = held;
	const double energy = held ? 0 : inner_energy(w);
	for (uint32_t i = 0; i < in->pairs && !held; i++) {
		const ob_island_pair *k = &in->pair[i];
		const uint32_t row = holding_row(s, in, i);
		const uint32_t other =
			row && w->body[row].id == in->object[k->a].id ? w->row_of[k->b] : w->row_of[k->a];
		if (row && !w->body[row].holds)
			w->body[row].holds = comes_near(s, row, other, energy);
	}
}

void ob_frame_enter(ob_solver *s, const ob_island_input *in)
{
	ob_island_work *w = &s->island;
	find_what_holds(s, in);
	w->frame = s->methods.exact && !in->joints ? find_frame(w) : ob_v3(0, 0, 0);
	for (uint32_t row = 1; row < w->rows && ob_norm2(w->frame) > 0; row++)
		w->body[row].acceleration =
			is_slippery(&w->body[row]) ? ob_v3(0, 0, 0) : ob_sub(w->body[row].acceleration, w->frame);
	w->max_acceleration = felt_acceleration(w);
	for (uint32_t row = 1; row < w->rows && w->max_acceleration == 0; row++)
		w->body[row].rest_depth = ob_narrowphase_rest_depth(s, w->body[row].thickness, false);
}

void ob_frame_leave(ob_solver *s)
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
