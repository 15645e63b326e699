#include "step/flight.h"

#include "contact/facets.h"
#include "contact/impact.h"
#include "contact/pairs.h"
#include "exchange/results.h"
#include "motion/deviation.h"
#include "motion/flight.h"
#include "shape/shape.h"
#include "solver/estimate.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/publish.h"
#include "step/terrain.h"

// ---- impacts on planes

static const double contact_approach = 1e-4; // m/s: the contact solver treats slower approaches
static const double on_plane_gap = 1e-9; // m, and more if coordinates are rounded: a point this near is on the plane

static ob_half_space half_space(const ob_universe *u, uint32_t plane)
{
	const ob_motion *m = ob_newest_motion(u, plane); // it never moves
	ob_mat3 r = ob_quat_matrix(m->q);
	ob_vec3 n = ob_column(&r, 2);
	return (ob_half_space){ n, ob_dot(n, m->p) };
}

// Returns the flight in the form of motion/flight.h. Objects that touch as axis-aligned boxes reach beyond their
// bounding sphere.
static ob_flier landing_body(const ob_sim *s, const ob_course *c)
{
	const ob_passport *body = ob_passport_of(s->u, c->id);
	const ob_motion *f = &c->m;
	ob_flier out = { body->shape, body->size, body->inertia, f->p,    f->v,
			 f->a,        f->q,       f->w,          c->spin, ob_hull_of(s->u, body) };
	if (s->solver.methods.boxes) {
		double reach = sqrt(3) * ob_shape_radius(body->shape, body->size);
		out.shape = OB_SHAPE_NONE;
		out.size = ob_v3(reach, 0, 0);
	}
	return out;
}

enum { SUPPORT_POINTS = 8 };

// Finds the points by which a body can stand on a plane with this normal: arms (m, world) from its centre. Returns
// their number.
static int support_points(const ob_passport *body, ob_vec3 n, const ob_mat3 *r, ob_vec3 *arm)
{
	const ob_vec3 z = ob_column(r, 2);
	ob_outline o;
	if (!ob_shape_outline(body->shape, body->size, &o))
		return 0;
	if (ob_shape_is(body->shape, OB_ISOTROPIC)) {
		arm[0] = ob_scale(n, -o.ball);
		return 1;
	}
	if (ob_shape_is(body->shape, OB_CORNERED)) {
		for (uint32_t k = 0; k < 8; k++)
			arm[k] = ob_rotate(r, ob_box_corner(o.half, k));
		return 8;
	}
	if (!(o.rim > 0)) {
		for (int k = 0; k < 2; k++)
			arm[k] = ob_madd(ob_scale(n, -o.ball), k ? o.half.z : -o.half.z, z);
		return 2;
	}
	const ob_placed cylinder = { .shape = body->shape, .size = body->size, .r = *r }, plane = { 0 };
	ob_vec3 rim[4];
	ob_rim_directions(&cylinder, &plane, ob_scale(n, -1), rim);
	for (int k = 0; k < 8; k++)
		arm[k] = ob_madd(ob_scale(rim[k & 3], o.rim), k & 4 ? o.half.z : -o.half.z, z);
	return 8;
}

// Finds the points of a hull on the plane: at most four, however many there are.
static uint32_t corners_on_plane(ob_units unit, const ob_hull *hull, const ob_half_space *ground, const ob_state *s,
				 double rounding, ob_impact_point *point)
{
	const double margin = OB_IMPACT_SIMULTANEOUS * unit.length;
	const ob_vec3 n = ground->normal, z = fabs(n.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0);
	const ob_vec3 u = ob_scale(ob_cross(z, n), 1 / ob_norm(ob_cross(z, n))), w = ob_cross(n, u);
	const ob_placed body = {
		.p = s->pose.p, .r = ob_quat_matrix(s->pose.q), .rest_depth = .5 * margin, .hull = hull
	};
	const ob_placed plane = { .p = ob_scale(n, ground->offset),
				  .r = { { { u.x, w.x, n.x }, { u.y, w.y, n.y }, { u.z, w.z, n.z } } } };
	ob_manifold m = { .points = 0 };
	ob_manifold_hull_plane(&body, &plane, margin, &m);
	for (int k = 0; k < m.points; k++)
		point[k] = (ob_impact_point){ .normal = n,
					      .arm_a = ob_sub(ob_madd(m.at[k], .5 * m.gap[k], n), s->pose.p),
					      .b = 1 };
	return m.separation <= rounding ? (uint32_t)m.points : 0;
}

// Finds the points on the plane: those within rounding of it, and those that touch at the same time. Returns their
// number.
static uint32_t points_on_plane(ob_units unit, const ob_passport *body, const ob_hull *hull,
				const ob_half_space *ground, const ob_state *s, ob_impact_point *point)
{
	const ob_vec3 n = ground->normal;
	const ob_mat3 r = ob_quat_matrix(s->pose.q);
	const double rounding = on_plane_gap * unit.length + 1e-14 * (ob_norm(s->pose.p) + fabs(ground->offset));
	const double height = ob_dot(n, s->pose.p) - ground->offset;
	if (hull)
		return corners_on_plane(unit, hull, ground, s, rounding, point);
	ob_vec3 arm[SUPPORT_POINTS];
	const int points = support_points(body, n, &r, arm);
	uint32_t found = 0;
	double lowest = INFINITY;
	for (int k = 0; k < points; k++) {
		const double gap = height + ob_dot(n, arm[k]);
		lowest = ob_min(lowest, gap);
		if (gap <= OB_IMPACT_SIMULTANEOUS * unit.length)
			point[found++] = (ob_impact_point){ .normal = n, .arm_a = arm[k], .b = 1 };
	}
	return lowest <= rounding ? found : 0;
}

// Returns the velocity (m/s) of the plane's surface, in the plane.
static ob_vec3 running_velocity(const ob_universe *u, uint32_t plane, const ob_half_space *ground)
{
	const ob_vec3 own = ob_passport_of(u, plane)->surface_velocity;
	if (ob_norm2(own) == 0)
		return ob_v3(0, 0, 0);
	const ob_mat3 r = ob_quat_matrix(ob_newest_motion(u, plane)->q);
	const ob_vec3 v = ob_rotate(&r, own);
	return ob_madd(v, -ob_dot(v, ground->normal), ground->normal);
}

// Applies the impact of all points on the plane to the velocities. Returns false if the object does not rebound here.
static bool apply_plane_impact(ob_sim *s, const ob_course *c, ob_state *state)
{
	const uint32_t id = c->id, plane = c->plane;
	if (plane == UINT32_MAX)
		return false;
	const ob_passport *passport = ob_passport_of(s->u, id), *other = ob_passport_of(s->u, plane);
	const ob_half_space ground = c->ground;
	const double mu = ob_pair_friction(passport->friction, other->friction),
		     e = ob_pair_restitution(passport->restitution, other->restitution);
	ob_impact_point point[SUPPORT_POINTS];
	ob_impact_body body[2] = { { .inv_mass = 1 / passport->mass, .v = state->v, .w = state->w } };
	body[1].v = running_velocity(s->u, plane, &ground);
	if (!(e > 0) || s->solver.methods.boxes)
		return false;
	const ob_mat3 r = ob_quat_matrix(state->pose.q);
	ob_inverse_inertia(passport->inertia, &r, body[0].inv_inertia);
	const uint32_t points =
		points_on_plane(s->solver.island.unit, passport, ob_hull_of(s->u, passport), &ground, state, point);
	for (uint32_t k = 0; k < points; k++)
		point[k].mu = mu, point[k].e = e;
	const double approach = ob_impact_approach(body, point, points);
	if (!(approach > contact_approach * s->solver.island.unit.speed))
		return false;
	const bool parted = ob_impact_part(body, 2, point, points, approach);
	if (points > 0)
		ob_touches_note(s->u, id, plane, passport->mass * ob_dot(ob_sub(body[0].v, state->v), ground.normal),
				ob_add(state->pose.p, point[0].arm_a));
	state->v = body[0].v, state->w = body[0].w;
	return parted;
}

// ---- flight

enum { IMPACTS_PER_STEP = 5 }; // at most; the contact solver treats bodies that hit planes more often

static const double max_horizon = 2; // s: bound of the time for which impacts are computed ahead
static const double least_sweep = 8; // radii: length of a flight's fat AABB that is always allowed
static const double most_neighbours = 32; // neighbours that a longer one is expected to bring, at most

ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	uint64_t step = ob_step_count(s->u);
	ob_motion m = *ob_newest_motion(s->u, id);
	ob_vec3 a = ob_external_acceleration(run, ob_passport_of(s->u, id));
	double now = (double)step * run->step_length;
	if (!ob_equal(m.a, a)) {
		ob_state begin = ob_state_now(s->u, id, &m, step);
		m.p = begin.pose.p, m.q = begin.pose.q, m.v = begin.v, m.w = begin.w, m.a = a;
		m.t0 = m.valid_until = now;
	} else if (!(m.flags & OB_MOTION_FREE)) {
		m.valid_until = m.t0;
	}
	m.flags = 0;
	return m;
}

// Returns the rotation from the worker's cache; NULL if the object does not rotate, or is kinematic.
static ob_spin *cached_rotation(ob_sim *s, uint32_t id, const ob_motion *f, double time)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	if (ob_published_stands(f, body, time) || body->flags & OB_OBJECT_KINEMATIC || !(ob_norm2(f->w) > 0))
		return NULL;
	return ob_rotation_cache_get(&s->rotations, id, f->q, f->w, body->inertia);
}

ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *f, double time)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	if (ob_published_stands(f, body, time))
		return (ob_state){ { f->p, f->q }, f->v, f->w };
	if (body->flags & OB_OBJECT_KINEMATIC)
		return ob_motion_at(f, body->inertia, time);
	ob_motion m = { .t0 = f->t0, .p = f->p, .q = f->q, .v = f->v, .a = f->a };
	ob_state now = ob_motion_at(&m, body->inertia, time);
	ob_spin *spin = cached_rotation(s, id, f, time);
	if (spin)
		ob_spin_at(spin, time - f->t0, &now.pose.q, &now.w);
	return now;
}

void ob_ballistic_prepare(ob_sim *s, const uint32_t *id, const ob_motion *const *f, double time, uint32_t n)
{
	ob_spin *spin[OB_COURSES];
	double at[OB_COURSES];
	int spins = 0;
	for (uint32_t k = 0; k < n; k++) {
		bool listed = false;
		ob_spin *x = cached_rotation(s, id[k], f[k], time);
		for (int i = 0; i < spins;
		     i++) // a body may be in several pairs; two bodies may share a place, which the later has
			listed |= spin[i] == x;
		if (x && !listed)
			at[spins] = time - f[k]->t0, spin[spins++] = x;
	}
	ob_spin_prepare(spin, at, spins);
}

// Bounds the speed (m/s) of any point of the object between two instants (s) of the flight.
static double flight_speed_bound(ob_sim *s, uint32_t id, const ob_motion *f, const ob_spin *spin, double from,
				 double until)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	double begin = ob_norm(ob_madd(f->v, from - f->t0, f->a)), end = ob_norm(ob_madd(f->v, until - f->t0, f->a));
	return ob_max(begin, end) + (spin ? spin->fastest * ob_shape_radius(body->shape, body->size) : 0);
}

// Publishes the flight m, valid after the running step; m->path: at the step's end. straight: it was valid from the
// step's start. Then its fat AABB only has to hold the path from that start to the end of the next step that visits it:
// a body thrown off its path gets a new one. After an impact the box holds all places where the body was.
static void publish_flight(ob_sim *s, uint32_t id, ob_motion *m, const ob_spin *spin, bool straight)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	const uint64_t step = ob_step_count(s->u) + 1;
	const double h = run->step_length, end = (double)step * h;
	uint64_t due = m->flags & OB_MOTION_FREE ? (uint64_t)(m->valid_until / h) : step;
	due -= (double)due * h > m->valid_until && due > step; // the quotient may have been rounded up
	double last = (double)(due + 1) * h, reach = flight_speed_bound(s, id, m, spin, end, last) * h;
	const double from = straight ? end - h : end;
	// The box of a rotating object is that of its bounding sphere, so its attitude is not needed.
	ob_motion rest = { .p = ob_centre_at(m, from), .q = m->q, .v = ob_velocity_at(m, from), .w = m->w, .a = m->a };
	const ob_state now = { { ob_centre_at(m, end), m->q }, ob_velocity_at(m, end), m->w };
	double box[6];
	ob_motion_swept_bounds(&rest, body->shape, body->size, last - from, box);
	const double speed = ob_surface_speed(now.v, now.w, ob_shape_radius(body->shape, body->size));
	const ob_deviant before = { ob_deviation_published(m, step, h), speed },
			 after = { ob_deviation_at(m, step, h), speed };
	ob_deviation_put(m, ob_estimate_count(&s->solver, step, before, after, true));
	m->step = (uint32_t)step;
	m->reach = (float)reach;
	m->island = id;
	m->substeps = 0;
	m->rest_time = 0;
	if (!ob_state_is_sane(&now))
		ob_step_fail(s->u, OB_STEP_DIVERGED, id);
	ob_fat_aabb_sweep(s->u, id, box, straight ? ob_fat_aabb_margin(run, body->shape, body->size) : reach);
	ob_result_stage(s, id, m, OB_SCHEDULE_AWAKE, (uint32_t)due);
}

void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	uint32_t state = m->flags & OB_MOTION_ASLEEP        ? OB_SCHEDULE_ASLEEP
			 : m->flags & OB_MOTION_EQUILIBRIUM ? OB_SCHEDULE_EQUILIBRIUM
							    : OB_SCHEDULE_AWAKE;
	double reach = state == OB_SCHEDULE_AWAKE ? ob_step_reach(run, body, end->pose.q, end->v, end->w) : 0;
	const double path = m->path - ob_path_now(ob_newest_motion(s->u, id), ob_step_count(s->u));
	ob_fat_aabb_update(s->u, id, end, reach, path);
	m->reach = (float)reach;
	ob_result_stage(s, id, m, state, state == OB_SCHEDULE_AWAKE ? m->step : UINT32_MAX);
}

// Returns the time (s) for which a flight is computed from this velocity on. Its fat AABB holds all of the flight, and
// overlaps those of all objects in its column. So its length is bounded by the expected number of neighbours, judged by
// those of the present box. A lone object's flight is computed far ahead.
static double flight_horizon(const ob_sim *s, uint32_t id, ob_vec3 v, ob_vec3 a)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	const float *box = s->data->bounds[id];
	const uint32_t neighbours = s->data->neighbours[id].count;
	const double side = ob_max(box[3] - box[0], ob_max(box[4] - box[1], box[5] - box[2]));
	double length = least_sweep * ob_shape_radius(body->shape, body->size);
	if (neighbours != UINT32_MAX)
		length = ob_max(length, side * most_neighbours / ob_max(1, neighbours));
	double speed = ob_norm(v), fall = sqrt(speed * speed + 2 * ob_norm(a) * length);
	return ob_min(max_horizon * s->solver.island.unit.time, 2 * length / (speed + fall)); // time to move so far
}

// Takes the rotation of a visibly rotating object from the cache, or computes it anew.
static void take_rotation(ob_sim *s, ob_course *c)
{
	const ob_passport *body = ob_passport_of(s->u, c->id);
	const ob_motion *m = &c->m;
	c->spin = !ob_shape_is(body->shape, OB_ISOTROPIC) && ob_norm2(m->w) > 0 ? &c->own : NULL;
	if (c->spin && !ob_rotation_cache_find(&s->rotations, c->id, m->q, m->w, body->inertia, c->spin))
		ob_spin_plan(c->spin, m->q, m->w, body->inertia);
}

static void begin(ob_sim *s, uint32_t id, ob_course *c)
{
	const double h = s->settings->step_length;
	const uint64_t step = ob_step_count(s->u);
	c->id = id;
	c->impacts = c->plane = 0;
	c->work = 0;
	c->m = ob_ballistic_flight(s, id);
	c->since = (double)step * h;
	c->horizon = (double)(step + 1) * h + flight_horizon(s, id, ob_velocity_at(&c->m, c->since), c->m.a);
	c->m.path = ob_path_now(&c->m, step);
	take_rotation(s, c);
}

// True if the object's fat AABB holds its bounding sphere about this centre.
static bool is_in_bounds(const ob_sim *s, uint32_t id, ob_vec3 centre)
{
	const ob_passport *body = ob_passport_of(s->u, id);
	const float *b = s->data->bounds[id];
	const double at[3] = { centre.x, centre.y, centre.z }, r = ob_shape_radius(body->shape, body->size);
	bool in = true;
	for (int i = 0; i < 3; i++)
		in &= at[i] - r >= (double)b[i] && at[i] + r <= (double)b[i + 3];
	return in;
}

// Finds an earlier landing of a course on terrain that is a plane as far as its fat AABB reaches. A landing beyond is found
// when the object comes near, and by the contact solver if that is within the step. first: s, of its first landing so far.
static void land_on_terrain(ob_sim *s, ob_course *c, const ob_flier *flier, double *first)
{
	const ob_step_data *data = s->data;
	const double end = (double)(ob_step_count(s->u) + 1) * s->settings->step_length;
	ob_pair_place at;
	for (uint32_t link = data->first_pair[c->id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		const ob_pair_key *k = &data->pair[at.pair];
		ob_terrain_view view;
		if (!k->region || k->part_a || k->part_b || !ob_terrain_see(s->u, k, &view) || !view.flat)
			continue;
		const ob_mat3 r = ob_quat_matrix(view.plane.q);
		const ob_vec3 n = ob_column(&r, 2);
		const ob_half_space ground = { n, ob_dot(n, view.plane.p) };
		const double time = c->m.t0 + ob_landing_time(flier, &ground, c->since - c->m.t0,
							      ob_min(c->horizon, *first) - c->m.t0);
		const bool known = (time <= end && !c->impacts) || is_in_bounds(s, c->id, ob_centre_at(&c->m, time));
		if (!(time < *first) || (!known && time > end))
			continue;
		*first = time;
		c->ground = ground;
		c->plane = !known ? UINT32_MAX : at.side ? k->a : k->b;
	}
}

void ob_courses_find_landings(ob_sim *s, ob_course *const *c, uint32_t n)
{
	enum { WORK_OF_LANDING = 32 };
	const ob_step_data *data = s->data;
	ob_flier flier[OB_COURSES];
	ob_landing of[OB_COURSES];
	double from[OB_COURSES], first[OB_COURSES];
	for (uint32_t k = 0; k < n; k++) {
		flier[k] = landing_body(s, c[k]);
		from[k] = ob_max(c[k]->m.valid_until, c[k]->since);
		first[k] = INFINITY;
	}
	for (uint32_t i = 0; i < data->count->planes && !ob_budget_spent(&s->solver); i++) {
		const ob_half_space ground = half_space(s->u, data->plane[i]);
		for (uint32_t k = 0; k < n; k++) {
			c[k]->work += WORK_OF_LANDING;
			of[k] = (ob_landing){ .flier = &flier[k],
					      .plane = &ground,
					      .from = from[k] - c[k]->m.t0,
					      .until = ob_min(c[k]->horizon, first[k]) - c[k]->m.t0 };
		}
		ob_landing_times(of, (int)n);
		for (uint32_t k = 0; k < n; k++)
			if (c[k]->m.t0 + of[k].time < first[k] &&
			    ob_passport_collides(ob_passport_of(s->u, c[k]->id), ob_passport_of(s->u, data->plane[i])))
				first[k] = c[k]->m.t0 + of[k].time, c[k]->plane = data->plane[i], c[k]->ground = ground;
	}
	for (uint32_t k = 0; k < n && ob_universe_has_terrains(s->u); k++)
		land_on_terrain(s, c[k], &flier[k], &first[k]);
	for (uint32_t k = 0; k < n; k++)
		c[k]->m.valid_until = ob_min(c[k]->horizon, ob_max(first[k], c[k]->since));
}

void ob_courses_begin(ob_sim *s, const uint32_t *id, ob_course *c, uint32_t n)
{
	ob_course *of[OB_COURSES];
	for (uint32_t k = 0; k < n; k++) {
		begin(s, id[k], &c[k]);
		of[k] = &c[k];
	}
	ob_courses_find_landings(s, of, n);
}

void ob_course_follow(ob_sim *s, ob_course *c, double until)
{
	c->m.path += flight_speed_bound(s, c->id, &c->m, c->spin, c->since, until) * (until - c->since);
	c->since = until;
}

ob_state ob_course_state(ob_sim *s, const ob_course *c)
{
	const ob_motion *m = &c->m;
	ob_state now = { { ob_centre_at(m, c->since), m->q }, ob_velocity_at(m, c->since), m->w };
	ob_spin *spin = c->spin;
	if (!spin && ob_norm2(m->w) > 0) // a sphere's rotation
		spin = ob_rotation_cache_get(&s->rotations, c->id, m->q, m->w, ob_passport_of(s->u, c->id)->inertia);
	if (spin)
		ob_spin_at(spin, c->since - m->t0, &now.pose.q, &now.w);
	return now;
}

ob_deviation ob_course_deviation(const ob_sim *s, const ob_course *c)
{
	return ob_deviation_at(&c->m, ob_step_count(s->u) + 1, s->settings->step_length);
}

// Counts and publishes its deviation after a hit, where either of both bodies is off by "most" at most.
static void deviate(ob_sim *s, ob_course *c, const ob_state *at, ob_deviation most)
{
	const ob_passport *body = ob_passport_of(s->u, c->id);
	const ob_vec3 v = ob_velocity_at(&c->m, c->since);
	const double radius = ob_shape_radius(body->shape, body->size),
		     change = ob_norm(ob_sub(at->v, v)) + radius * ob_norm(ob_sub(at->w, c->m.w));
	const uint64_t step = ob_step_count(s->u) + 1;
	const ob_deviant before = { ob_deviation_published(&c->m, step, s->settings->step_length),
				    ob_surface_speed(v, c->m.w, radius) },
			 after = { ob_deviation_after_hit(most, change, radius),
				   ob_surface_speed(at->v, at->w, radius) };
	ob_deviation_put(&c->m, ob_estimate_count(&s->solver, step, before, after, true));
	c->m.step = (uint32_t)step;
}

bool ob_course_set_off(ob_sim *s, ob_course *c, const ob_state *at, ob_deviation most)
{
	if (c->impacts++ == IMPACTS_PER_STEP)
		return false;
	if (most.place > 0)
		deviate(s, c, at, most);
	c->m.t0 = c->since;
	c->m.p = at->pose.p, c->m.q = at->pose.q, c->m.v = at->v, c->m.w = at->w;
	c->m.valid_until = c->since;
	take_rotation(s, c);
	return true;
}

bool ob_course_rebound(ob_sim *s, ob_course *c)
{
	ob_state at = ob_course_state(s, c);
	return apply_plane_impact(s, c, &at) && ob_course_set_off(s, c, &at, ob_course_deviation(s, c));
}

void ob_course_publish(ob_sim *s, ob_course *c)
{
	// After one impact, the motion published before is valid up to it; after several it is not valid up to the
	// last.
	c->m.flags = c->impacts < 2 ? OB_MOTION_FREE : 0;
	publish_flight(s, c->id, &c->m, c->spin, c->impacts == 0);
	if (c->spin)
		ob_rotation_cache_put(&s->rotations, c->id, c->spin);
}

// Prepares the rotations for the present states of n courses.
static void prepare_states(ob_course *const *c, uint32_t n)
{
	ob_spin *spin[OB_COURSES];
	double s[OB_COURSES];
	int spins = 0;
	for (uint32_t k = 0; k < n; k++)
		if (c[k]->spin)
			s[spins] = c[k]->since - c[k]->m.t0, spin[spins++] = c[k]->spin;
	ob_spin_prepare(spin, s, spins);
}

void ob_ballistic_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done)
{
	const double end = (double)(ob_step_count(s->u) + 1) * s->settings->step_length;
	ob_course c[OB_COURSES], *on[OB_COURSES];
	uint32_t left = n;
	for (uint32_t k = 0; k < n; k++) {
		done[k] = true;
		on[k] = &c[k];
	}
	ob_courses_begin(s, id, c, n);
	while (left) { // from impact to impact of each
		uint32_t hit = 0, off = 0;
		for (uint32_t k = 0; k < left; k++) {
			ob_course_follow(s, on[k], ob_min(on[k]->m.valid_until, end));
			if (on[k]->m.valid_until < end)
				on[hit++] = on[k];
		}
		prepare_states(on, hit);
		for (uint32_t k = 0; k < hit; k++)
			if (ob_course_rebound(s, on[k]))
				on[off++] = on[k];
			else
				done[on[k] - c] = false;
		ob_courses_find_landings(s, on, off);
		left = off;
	}
	for (uint32_t k = 0; k < n; k++) {
		ob_budget_begin_share(s, id[k]); // own share: the sum does not depend on the objects beside it
		ob_budget_note(&s->solver, c[k].work);
		ob_budget_spent(&s->solver);
		if (done[k]) {
			s->solver.counters.impacts += c[k].impacts;
			ob_course_publish(s, &c[k]);
		}
	}
}
