#include "step/late_contacts.h"

#include <string.h>

#include "contact/manifold.h"
#include "exchange/results.h"
#include "motion/flight.h"
#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/flight.h"
#include "step/publish.h"
#include "step/pairs.h"
#include "step/prefetch.h"
#include "step/terrain.h"

static const double contact_gap = 2e-4; // m: a forecast takes bodies this near to be touching,
static const double contact_gap_share = .05; // but no nearer than this share of the thinner one's thickness
static const double tunnel_share = .4; // share of the thickness: bodies that move farther may have passed through each
	// other

// Common data for the checks of a batch of pairs.
typedef struct pair_check {
	ob_sim *s;
	const ob_universe *u;
	ob_step_data *data;
	double h; // s, length of a step
	uint64_t steps; // number complete, or solved
	bool solved; // a step has been solved and is not committed
	bool contained; // changes are handed over
} pair_check;

typedef struct moving_pair {
	ob_placed at[2];
	double path, reach; // m, sum over both
	double thin; // m, thickness of the thinner one
	double h; // s
} moving_pair;

// Returns shape, pose and velocity in the coming step, if nothing new touches the object.
static ob_placed shape_of(const pair_check *c, uint32_t id, uint32_t part, const ob_motion *m, uint64_t steps)
{
	const ob_passport *p = ob_passport_of(c->u, id);
	const double h = c->h;
	ob_state now = ob_ballistic_state(c->s, id, m, (double)steps * h);
	const ob_vec3 a = ob_acceleration_at(m, (double)steps * h);
	ob_placed out = { .shape = p->shape,
			  .size = p->size,
			  .p = now.pose.p,
			  .r = ob_quat_matrix(now.pose.q),
			  .v = ob_madd(now.v, .5 * h, a),
			  .w = now.w,
			  .inertia = p->inertia,
			  .a = a,
			  .rest_depth = ob_narrowphase_rest_depth(&c->s->solver, ob_shape_thickness(p->shape, p->size),
								  ob_norm2(c->s->settings->gravity) > 0),
			  .far_future = ob_narrowphase_far_future(&c->s->solver),
			  .hull = ob_part_of(c->u, p, part) };
	return out;
}

// Puts the region of a terrain, or the plane that it is for the other object, in its place.
static void see_terrain(const pair_check *c, const ob_pair_key *k, ob_placed at[2])
{
	ob_placed *x = &at[!ob_terrain_is_first(c->u, k)];
	ob_terrain_view view;
	if (!ob_terrain_see(c->u, k, &view))
		return;
	if (view.flat) {
		x->shape = OB_SHAPE_PLANE;
		x->p = view.plane.p, x->r = ob_quat_matrix(view.plane.q);
		return;
	}
	ob_terrain_take(view.terrain, view.region, &c->s->checked);
	x->hull = &c->s->checked.hull;
}

static moving_pair moving_pair_of(const pair_check *c, const ob_pair_key *k)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	moving_pair p = { .h = c->h, .thin = INFINITY };
	p.path = ob_schedule_path(a, c->steps) + ob_schedule_path(b, c->steps);
	p.reach = a->reach + b->reach;
	for (int i = 0; i < 2; i++) {
		uint32_t id = i ? k->b : k->a;
		p.at[i] = shape_of(c, id, i ? k->part_b : k->part_a, ob_result_of(c->u, id), c->steps);
		p.thin = ob_min(p.thin, ob_shape_thickness(p.at[i].shape, p.at[i].size));
	}
	if (k->region)
		see_terrain(c, k, p.at);
	return p;
}

// Bounds the speed (m/s) at which any two points of them part or approach within h (s).
static double relative_speed(const ob_placed *a, const ob_placed *b, double h)
{
	return ob_relative_speed(a->shape, &a->r, b->shape, &b->r, ob_sub(a->v, b->v)) +
	       ob_turning_speed(a->shape, a->size, a->inertia, ob_rotate_back(&a->r, a->w), h) +
	       ob_turning_speed(b->shape, b->size, b->inertia, ob_rotate_back(&b->r, b->w), h);
}

// Returns the first time (s) at which the two touch within h (s) as they go on; if they do not, a time beyond the step.
// apart: m, their present distance.
static double time_of_contact(const pair_check *c, const moving_pair *p, double h, double *apart)
{
	const ob_placed *a = &p->at[0], *b = &p->at[1];
	double speed = relative_speed(a, b, h);
	double gap = ob_min(contact_gap * c->s->solver.island.unit.length, contact_gap_share * p->thin);
	return ob_time_of_nearing(a, b, ob_max(speed, 1e-9), h, p->h, gap, ob_narrowphase_follower(&c->s->solver),
				  apart);
}

// True if the two have passed through each other since the step began.
static bool passed_through(const pair_check *c, const ob_pair_key *k, const moving_pair *end)
{
	const uint32_t id[2] = { k->a, k->b };
	const uint64_t step = ob_step_count(c->u);
	moving_pair start = *end;
	double apart;
	for (int i = 0; i < 2; i++) {
		start.at[i] = shape_of(c, id[i], i ? k->part_b : k->part_a, ob_newest_motion(c->u, id[i]), step);
		start.at[i].v = ob_scale(ob_sub(end->at[i].p, start.at[i].p), 1 / end->h);
	}
	if (k->region) {
		start.at[!ob_terrain_is_first(c->u, k)].v = ob_v3(0, 0, 0);
		see_terrain(c, k, start.at);
	}
	if (relative_speed(&start.at[0], &start.at[1], end->h) * end->h < tunnel_share * end->thin)
		return false;
	return !isinf(time_of_contact(c, &start, end->h, &apart));
}

static bool touched_in_step(const pair_check *c, ob_pair_key *k, const moving_pair *end)
{
	ob_manifold m;
	ob_manifold_finder finder = ob_narrowphase_finder(&c->s->solver);
	finder.find(finder.with, &end->at[0], &end->at[1],
		    ob_max(contact_gap * c->s->solver.island.unit.length, end->reach), &m);
	if (m.separation <= 0 || passed_through(c, k, end))
		return true;
	k->limit = end->path + m.separation;
	return false;
}

// True if their relative velocity is constant.
static bool fall_alike(const ob_motion *a, const ob_motion *b)
{
	return !((a->flags | b->flags) & OB_MOTION_SWINGS) && ob_equal(a->a, b->a);
}

// Positions and velocities of the bounding spheres of two bodies, which need no attitudes.
typedef struct bounding_spheres {
	ob_vec3 apart, v; // m, m/s, of the first relative to the second
	double gap; // m
	bool straight; // their relative velocity is constant
} bounding_spheres;

// Returns the spheres on the motions ma and mb, when so many steps are complete.
static bounding_spheres bounding_spheres_of(const pair_check *c, const ob_pair_key *k, const ob_motion *ma,
					    const ob_motion *mb, uint64_t steps)
{
	const ob_passport *pa = ob_passport_of(c->u, k->a), *pb = ob_passport_of(c->u, k->b);
	const double time = (double)steps * c->h;
	bounding_spheres out = { .straight = fall_alike(ma, mb) };
	out.apart = ob_sub(ob_centre_now(c->u, k->a, ma, steps), ob_centre_now(c->u, k->b, mb, steps));
	out.v = ob_sub(ob_velocity_at(ma, time), ob_velocity_at(mb, time));
	out.gap = ob_norm(out.apart) - ob_shape_radius(pa->shape, pa->size) - ob_shape_radius(pb->shape, pb->size);
	return out;
}

// Returns the time for which they stay apart at constant relative velocity (s). contact: m, distance of a contact.
static double time_apart(const bounding_spheres *s, double contact)
{
	double far = s->gap - contact, radii = ob_norm(s->apart) - far, closing = -ob_dot(s->apart, s->v);
	double square = far * (far + 2 * radii), d = closing * closing - ob_norm2(s->v) * square;
	if (far <= 0)
		return 0;
	return closing > 0 && d > 0 ? square / (closing + sqrt(d)) : INFINITY;
}

// Steps until one of the two is due, if both are in flight; 0: one is not.
static double steps_in_flight(const pair_check *c, const ob_pair_key *k)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	const double until = ob_min(a->due, b->due);
	return a->state == OB_SCHEDULE_AWAKE && b->state == OB_SCHEDULE_AWAKE && until > (double)c->steps
		       ? until - (double)c->steps
		       : 0;
}

// Sets the step until which two bodies in flight stay clear of each other. apart: s, for which their flights do. false:
// not beyond the coming step.
static bool set_clear_until(const pair_check *c, ob_pair_key *k, double apart)
{
	const double steps = steps_in_flight(c, k);
	if (steps <= 1)
		return false;
	k->clear_until = (uint32_t)((double)c->steps + ob_min(steps, floor(apart / c->h)));
	k->clear_as_of = (uint32_t)c->steps;
	return k->clear_until > c->steps;
}

static bool is_clear(const ob_step_data *data, const ob_pair_key *k, uint64_t steps)
{
	return k->clear_until > steps && data->schedule[k->a].since <= k->clear_as_of &&
	       data->schedule[k->b].since <= k->clear_as_of;
}

// True if the two touch in the coming step. For two in flight it looks ahead until one is due, or for some steps: so a
// pair that passes closely is tested once.
static bool touches_next(const pair_check *c, ob_pair_key *k, const moving_pair *now)
{
	enum { MOST_STEPS = 8 };
	const bool straight = fall_alike(ob_result_of(c->u, k->a), ob_result_of(c->u, k->b));
	const double steps = straight ? ob_max(1, ob_min(MOST_STEPS, steps_in_flight(c, k))) : 1;
	double apart;
	const double when = time_of_contact(c, now, steps * now->h, &apart);
	if (when <= now->h)
		return true;
	k->limit = ob_max(k->limit, now->path + apart);
	if (steps > 1)
		set_clear_until(c, k, ob_min(when, steps * now->h));
	return false;
}

// True for a body in flight and a plane: it hits none before it is due.
static bool impact_is_computed(const ob_schedule *a, const ob_schedule *b, uint64_t steps)
{
	return (a->state == OB_SCHEDULE_PLANE && b->due > steps) || (b->state == OB_SCHEDULE_PLANE && a->due > steps);
}

// True if the flight began before this step: the body touches no plane until it ends.
static bool flies_above_plane(const pair_check *c, uint32_t id)
{
	const ob_motion *m = ob_result_of(c->u, id);
	const double time = (double)c->steps * c->h;
	return m->t0 < time && m->valid_until >= time;
}

// Path of both together in the solved step (m); 0 if none was solved.
static double path_in_step(const pair_check *c, const ob_pair_key *k, double paths, bool solved)
{
	const uint64_t step = ob_step_count(c->u);
	return solved ? paths - ob_path_now(ob_newest_motion(c->u, k->a), step) -
				ob_path_now(ob_newest_motion(c->u, k->b), step)
		      : 0;
}

// True if the spheres may have met in the solved step: their path is as long as their distances before and now
// together.
static bool may_have_met(const pair_check *c, const ob_pair_key *k, const bounding_spheres *now, double paths,
			 bool solved)
{
	const double path = path_in_step(c, k, paths, solved);
	if (path < now->gap)
		return false;
	const bounding_spheres before = bounding_spheres_of(c, k, ob_newest_motion(c->u, k->a),
							    ob_newest_motion(c->u, k->b), ob_step_count(c->u));
	return path >= now->gap + ob_max(0, before.gap);
}

// True if the bounding spheres are too far apart for a contact in the solved step, and in the coming one.
static bool spheres_exclude_contact(const pair_check *c, ob_pair_key *k, double paths, double reach, bool solved)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	if (a->state == OB_SCHEDULE_PLANE || b->state == OB_SCHEDULE_PLANE)
		return flies_above_plane(c, a->state == OB_SCHEDULE_PLANE ? k->b : k->a);
	if (c->s->solver.methods.boxes)
		return false;
	const bounding_spheres round =
		bounding_spheres_of(c, k, ob_result_of(c->u, k->a), ob_result_of(c->u, k->b), c->steps);
	const double contact = contact_gap * c->s->solver.island.unit.length;
	if (round.gap <= contact || (paths >= k->limit && may_have_met(c, k, &round, paths, solved)))
		return false;
	const double apart = round.straight ? time_apart(&round, contact) : 0;
	k->limit = ob_max(k->limit, paths + round.gap);
	return set_clear_until(c, k, apart) || apart > c->h || k->limit - paths > reach;
}

static bool was_solved(const pair_check *c, uint32_t id)
{
	return c->data->schedule[id].since > ob_step_count(c->u);
}

// True if a check without a solved step, as after a resume, would not test the shapes. They may be tested now only
// because the spheres might have met in the step. So a second check finds the same as the first.
static bool is_excluded(const pair_check *c, ob_pair_key *k, const moving_pair *p)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	const double reach = (double)a->reach + (double)b->reach;
	return k->limit - p->path > reach || spheres_exclude_contact(c, k, p->path, reach, false);
}

// Sets late if the two touched in the solved step, and expected if they will in the coming one. left: m, remainder of
// the known distance.
static void check_shapes(const pair_check *c, ob_pair_key *k, double left, bool solved)
{
	moving_pair p = moving_pair_of(c, k);
	k->late = solved && !k->in_island && left <= 0 && touched_in_step(c, k, &p);
	if (!k->late && solved && is_excluded(c, k, &p))
		return;
	bool on_plane = c->data->schedule[k->a].state == OB_SCHEDULE_PLANE ||
			c->data->schedule[k->b].state == OB_SCHEDULE_PLANE;
	if (!k->late && !on_plane && k->limit - p.path <= p.reach)
		k->expected = touches_next(c, k, &p);
}

// True if the schedule records alone exclude any contact of the two in the coming step.
static bool is_idle(const ob_step_data *data, const ob_pair_key *k, uint64_t steps)
{
	const ob_schedule *a = &data->schedule[k->a], *b = &data->schedule[k->b];
	return (!ob_schedule_moves(a) && !ob_schedule_moves(b)) || impact_is_computed(a, b, steps);
}

// Checks a pair by the schedule records alone. false: they do not suffice.
static bool check_by_schedule(const pair_check *c, ob_pair_key *k)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	if (k->late |
	    k->expected) // most pairs need no change: their memory stays in the cache of every worker that has read it
		k->late = k->expected = 0;
	if (is_idle(c->data, k, c->steps) || k->active || is_clear(c->data, k, c->steps))
		return true;
	const double paths = ob_schedule_path(a, c->steps) + ob_schedule_path(b, c->steps);
	return k->limit - paths > (double)a->reach + (double)b->reach;
}

// Checks it by the motions of both. false: their shapes must be tested; left: m, remainder of the known distance.
static bool check_by_motions(const pair_check *c, ob_pair_key *k, double *left, bool *solved)
{
	const ob_schedule *a = &c->data->schedule[k->a], *b = &c->data->schedule[k->b];
	// A clear pair cannot have touched in it, nor one of which neither was solved: it went as was forecast.
	*solved = c->solved && (was_solved(c, k->a) || was_solved(c, k->b)) &&
		  (c->steps == 0 || !is_clear(c->data, k, c->steps - 1));
	const double paths = ob_schedule_path(a, c->steps) + ob_schedule_path(b, c->steps),
		     reach = (double)a->reach + (double)b->reach;
	*left = k->limit - paths;
	return spheres_exclude_contact(c, k, paths, reach, *solved);
}

// ---- pairs that are checked, and the next check

// First step that begins with so little left of the known distance that the two might use it up; the one before if
// rounding might hide it.
static double step_of_limit(const ob_pair_key *k, double paths, double reach, uint64_t steps)
{
	const double left = k->limit - paths, rounding = 1e-9 * left + 1e-14 * (fabs(k->limit) + paths);
	return reach > 0 ? (double)steps + ob_max(1, ceil((left - rounding) / reach) - 1) : INFINITY;
}

// The step (from 0) at which a checked pair must be checked again, if neither object publishes another motion before.
// Until then a check would change nothing.
static double next_check(const ob_step_data *data, const ob_pair_key *k, uint64_t steps)
{
	const ob_schedule *a = &data->schedule[k->a], *b = &data->schedule[k->b];
	if (is_idle(data, k, steps))
		return INFINITY;
	if (k->active || k->expected)
		return (double)steps;
	const double paths = ob_schedule_path(a, steps) + ob_schedule_path(b, steps),
		     reach = (double)a->reach + (double)b->reach, limit = step_of_limit(k, paths, reach, steps);
	return is_clear(data, k, steps) ? ob_max(k->clear_until, limit) : limit;
}

// Prefetches a pair's record and those of its objects, which lie anywhere, some checks ahead.
static void prefetch_check(const ob_universe *u, uint32_t i, uint32_t end)
{
	enum { PAIR_AHEAD = 16, OBJECTS_AHEAD = 8 };
	const ob_step_data *data = ob_universe_step_data(u);
	if (i + PAIR_AHEAD < end)
		__builtin_prefetch(&data->pair[data->check[i + PAIR_AHEAD]]);
	if (i + OBJECTS_AHEAD < end)
		ob_prefetch_schedule(u, &data->pair[data->check[i + OBJECTS_AHEAD]]);
}

void ob_late_contacts_leave_to_others(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t listed = data->count->checks;
	uint32_t n = 0;
	for (uint32_t i = 0; i < listed; i++) {
		ob_prefetch_checks(data, i, listed);
		if (ob_pair_is_checked_here(u, &data->pair[data->check[i]]))
			data->check[n++] = data->check[i];
	}
	data->count->checks = n;
}

// Removes all listed entries, as checked pairs get new ones. So no block of the calendar is urgent by an old entry, and
// the ranks exchange the next step of the other pairs (peers.h).
void ob_late_contacts_begin(ob_universe *u, bool solved)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	const uint64_t steps = ob_step_count(u) + solved;
	ob_late_contacts_reset(u);
	data->count->checked = (uint32_t)steps;
	data->count->checks = ob_calendar_take(&look, steps, data->check, data->pairs_max);
}

// ---- the check

static bool is_due(const ob_step_data *data, uint32_t id, uint64_t step)
{
	return ob_schedule_is_dynamic(&data->schedule[id]) && data->schedule[id].due <= step;
}

// The step of a checked pair's entry in the calendar; UINT32_MAX: it needs none. A pair of an object due in the coming
// step needs none: it is checked after the solve.
static uint32_t entry_of(const ob_step_data *data, const ob_pair_key *k, uint64_t steps)
{
	if (is_due(data, k->a, steps) || is_due(data, k->b, steps))
		return UINT32_MAX;
	const double next = next_check(data, k, steps);
	return next < UINT32_MAX ? (uint32_t)next : UINT32_MAX;
}

static void enter_next_check(const ob_universe *u, uint32_t pair, uint64_t steps)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	ob_calendar_set(&look, pair, entry_of(data, &data->pair[pair], steps));
}

// Enters the next checks for contained simulators, which cannot write the calendar.
static void enter_next_checks(const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t end = ob_checks_count(data);
	for (uint32_t i = 0; i < end; i++) {
		ob_prefetch_checks(data, i, end);
		if (ob_pair_is_checked_here(u, &data->pair[data->check[i]]))
			enter_next_check(u, data->check[i], data->count->checked);
	}
}

void ob_late_contacts_end(ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (ob_universe_contains(u))
		enter_next_checks(u);
	data->count->visits += data->count->checks;
}

void ob_late_contacts_take(ob_universe *u, uint32_t pair)
{
	ob_step_data *data = ob_universe_step_data(u);
	if (data->pair[pair].late && data->count->checks < data->pairs_max)
		data->check[data->count->checks++] = pair;
}

// Returns the pair to be changed: for a contained simulator a copy.
static ob_pair_key *begin_change(const pair_check *c, uint32_t i, ob_pair_key *copy)
{
	ob_pair_key *k = &c->data->pair[c->data->check[i]];
	if (c->contained) {
		*copy = *k;
		return copy;
	}
	if (isnan(k->limit)) // it is new
		k->limit = ob_pair_first_limit(c->u, k, c->steps);
	return k;
}

// True if the other ranks need this pair, even if it did not change: it links objects in the coming step, or the worker
// that listed it has voided its limit (island_builder.c), which no other rank has. The next entry is noted here, and
// sent for all pairs together.
static bool must_be_told(const pair_check *c, const ob_pair_key *k)
{
	ob_outbox_end *end = ob_outbox_end_of(c->u);
	const uint32_t next = entry_of(c->data, k, c->steps);
	if (next < UINT32_MAX && (!end->next_check || next < end->next_check - 1))
		end->next_check = 1 + next;
	return next <= c->steps || (c->data->count->merged && isinf(k->limit));
}

static void end_change(const pair_check *c, uint32_t i, const ob_pair_key *k)
{
	if (!c->contained)
		enter_next_check(c->u, c->data->check[i], c->steps);
	else if ((ob_universe_ranks(c->u) > 1 && must_be_told(c, k)) ||
		 memcmp(k, &c->data->pair[c->data->check[i]], sizeof *k) != 0)
		ob_commit_check(c->s->u, i, k);
}

static bool moves(const pair_check *c, uint32_t id)
{
	return ob_schedule_is_dynamic(&c->data->schedule[id]);
}

// Pairs whose shapes must be tested: their bodies' rotations are computed side by side.
typedef struct shapes_ahead {
	uint32_t n, check[OB_COURSES / 2];
	ob_pair_key copy[OB_COURSES / 2]; // for contained simulators
	double left[OB_COURSES / 2];
	bool solved[OB_COURSES / 2];
} shapes_ahead;

static ob_pair_key *pair_ahead(const pair_check *c, shapes_ahead *x, uint32_t k)
{
	return c->contained ? &x->copy[k] : &c->data->pair[c->data->check[x->check[k]]];
}

static void prepare_shapes(const pair_check *c, shapes_ahead *x)
{
	uint32_t id[OB_COURSES];
	const ob_motion *m[OB_COURSES];
	for (uint32_t k = 0; k < x->n; k++) {
		const ob_pair_key *pair = pair_ahead(c, x, k);
		id[2 * k] = pair->a, id[2 * k + 1] = pair->b;
	}
	for (uint32_t k = 0; k < 2 * x->n; k++)
		m[k] = ob_result_of(c->u, id[k]);
	ob_ballistic_prepare(c->s, id, m, (double)c->steps * c->h, 2 * x->n);
}

static void check_shapes_ahead(const pair_check *c, shapes_ahead *x, bool *late)
{
	prepare_shapes(c, x);
	for (uint32_t k = 0; k < x->n && !ob_budget_spent(&c->s->solver); k++) {
		ob_pair_key *pair = pair_ahead(c, x, k);
		check_shapes(c, pair, x->left[k], x->solved[k]);
		*late |= pair->late;
		end_change(c, x->check[k], pair);
	}
	x->n = 0;
}

// Checks pairs by their motions; prefetches those of the next ones.
static void check_all_by_motions(const pair_check *c, const uint32_t *checks, uint32_t n, bool *late)
{
	enum { AHEAD = 4 };
	const ob_step_data *data = c->data;
	shapes_ahead x;
	x.n = 0;
	for (uint32_t i = 0; i < n + AHEAD; i++) {
		if (i < n)
			ob_prefetch_pair(c->s, &data->pair[data->check[checks[i]]]);
		if (i < AHEAD)
			continue;
		ob_pair_key *k = begin_change(c, checks[i - AHEAD], &x.copy[x.n]);
		if (i == AHEAD)
			ob_budget_begin_share(c->s, moves(c, k->a) ? k->a : k->b);
		if (ob_budget_spent(&c->s->solver))
			return;
		if (c->contained)
			k->late = k->expected = 0; // state after check_by_schedule
		if (check_by_motions(c, k, &x.left[x.n], &x.solved[x.n]))
			end_change(c, checks[i - AHEAD], k);
		else
			x.check[x.n++] = checks[i - AHEAD];
		if (x.n == OB_COURSES / 2)
			check_shapes_ahead(c, &x, late);
	}
	check_shapes_ahead(c, &x, late);
}

void ob_late_contacts_check(ob_sim *s, uint32_t first, uint32_t end, bool solved)
{
	const pair_check c = { s,
			       s->u,
			       s->data,
			       s->settings->step_length,
			       ob_step_count(s->u) + solved,
			       solved,
			       ob_universe_contained(s->u) };
	bool late = false;
	while (first < end) {
		uint32_t left[OB_LATE_CONTACTS_BATCH], n = 0;
		for (uint32_t i = 0; i < OB_LATE_CONTACTS_BATCH && first < end; i++, first++) {
			prefetch_check(c.u, first, end);
			ob_pair_key copy, *k = begin_change(&c, first, &copy);
			if (check_by_schedule(&c, k))
				end_change(&c, first, k);
			else
				left[n++] = first;
		}
		check_all_by_motions(&c, left, n, &late);
	}
	if (late)
		ob_late_contacts_note(s->u);
}

// Puts a motion back to staged, if the step that is complete has published it.
static bool unpublish(ob_universe *u, uint32_t id, uint64_t steps)
{
	const bool solved = ob_schedule_is_dynamic(&ob_universe_step_data(u)->schedule[id]) &&
			    ob_universe_step_data(u)->schedule[id].since == steps;
	if (solved)
		ob_uncommit_motion(u, id);
	return solved;
}

// Begins the pairs of two objects as at the end of the step that is complete: it measures and checks them once more.
static void meet(ob_sim *s, uint32_t a, uint32_t b)
{
	ob_universe *u = s->u;
	const uint64_t steps = ob_step_count(u);
	ob_step_set(u, steps - 1);
	const bool of_a = unpublish(u, a, steps), of_b = unpublish(u, b, steps);
	ob_pairs_begin(u, a, b, steps);
	ob_pairs_measure(u, steps);
	ob_late_contacts_check(s, 0, ob_checks_count(s->data), true);
	s->data->count->checks = 0;
	if (of_a)
		ob_commit_motion(u, a);
	if (of_b)
		ob_commit_motion(u, b);
	ob_step_set(u, steps);
}

// A body's query counts those whose boxes were there already.
static void count_met(const ob_step_data *data, uint32_t id, uint32_t other, const uint32_t *queried)
{
	data->neighbours[id].count += queried[id] >= queried[other];
	data->neighbours[other].count += queried[other] >= queried[id];
}

void ob_sim_meet(ob_sim *s, uint32_t id, const uint32_t *queried)
{
	const ob_step_data *data = s->data;
	const uint32_t ids = ob_universe_ids(s->u);
	uint32_t *found = data->scratch;
	if (ob_broadphase_query_pending(s->u, id) || ob_step_count(s->u) == 0)
		return;
	const uint32_t n = ob_index_query(s->u, id, found, ids, &s->solver.counters.box_tests);
	for (uint32_t i = 0; i < n && i < ids; i++)
		if (!ob_broadphase_query_pending(s->u, found[i]) && ob_may_touch(s->u, id, found[i]) &&
		    !ob_pairs_have(data, id, found[i])) {
			count_met(data, id, found[i], queried);
			meet(s, id, found[i]);
		}
}
