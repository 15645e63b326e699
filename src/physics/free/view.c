#include "free/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "free/lag.h"
#include "motion/flight.h"
#include "shape/shape.h"

static const double heavy = 1e8; // times its mass, of a neighbour that counts as infinitely heavy

// ---- reports of the solver

static bool spend(void *with, uint64_t work)
{
	return ob_gate_stopped(((ob_free_scratch *)with)->u);
}

static void begin_attempt(void *with) {}

static void touch(void *with, uint32_t a, uint32_t b, double impulse, ob_vec3 point) {}

static void fail(void *with, uint32_t object)
{
	((ob_free_scratch *)with)->failed = true;
}

static void keep_contact(void *with, const ob_found_contact *c)
{
	ob_free_scratch *x = with;
	x->sim->neighbour[c->pair].contact = *c;
}

static void keep_motion(void *with, const ob_island_object *object, ob_motion *m, bool free)
{
	ob_free_scratch *x = with;
	if (object->id != x->sim->id)
		return;
	x->end = *m;
	x->flew = free;
}

bool ob_free_scratch_begin(ob_free_scratch *x, ob_universe *u)
{
	enum { ODE_BODIES = 64 };
	x->u = u;
	x->free = ob_free_settings_of(u);
	x->run = *ob_universe_settings(u);
	x->boundary = x->run.step_length;
	x->substeps = x->run.substeps;
	x->run.sleeping = 0;
	x->run.solver = OB_SOLVER_COLOURED;
	const ob_island_calls calls = { .with = x,
					.spend = spend,
					.attempt = begin_attempt,
					.touch = touch,
					.fail = fail,
					.contact = keep_contact,
					.motion = keep_motion };
	return ob_solver_create(&x->solver, &x->run, &calls, ODE_BODIES);
}

void ob_free_scratch_finish(ob_free_scratch *x)
{
	ob_solver_finish(&x->solver);
	free(x->object);
	free(x->passport);
	free(x->motion);
	free(x->pair);
	free(x->seen);
}

static void reserve(ob_free_scratch *x, uint32_t objects)
{
	if (objects <= x->max)
		return;
	x->max = 2 * objects;
	x->object = ob_reallocate(x->object, x->max * sizeof *x->object);
	x->passport = ob_reallocate(x->passport, x->max * sizeof *x->passport);
	x->motion = ob_reallocate(x->motion, x->max * sizeof *x->motion);
	x->pair = ob_reallocate(x->pair, x->max * sizeof *x->pair);
	x->seen = ob_reallocate(x->seen, x->max * sizeof *x->seen);
}

// ---- reading

ob_state ob_free_state_at(const ob_motion *m, const ob_motion *next, ob_vec3 inertia, double t)
{
	if (isnan(next->t0) || next->t0 <= m->t0 || t <= m->t0 || next->flags & OB_MOTION_FREE)
		return ob_motion_at(m, inertia, t);
	const double share = ob_min(1, (t - m->t0) / (next->t0 - m->t0));
	return (ob_state){ ob_motion_between(m, next, inertia, t), ob_madd(m->v, share, ob_sub(next->v, m->v)),
			   ob_madd(m->w, share, ob_sub(next->w, m->w)) };
}

// Counts a reading of a version, for the report.
static void count_reading(ob_free_sim *s, double asked, double read)
{
	const uint64_t lag_ns = s->time > read ? (uint64_t)(1e9 * (s->time - read)) : 0;
	s->counts.readings++;
	s->counts.late += read > asked;
	s->counts.lag_ns += lag_ns;
	s->counts.lag_most_ns = lag_ns > s->counts.lag_most_ns ? lag_ns : s->counts.lag_most_ns;
}

static bool read_neighbour(ob_free_sim *s, ob_free_scratch *x, const ob_free_neighbour *n, ob_free_seen *out)
{
	ob_motion next = { .t0 = NAN };
	if (n->kind == OB_FREE_PRESCRIBED) {
		out->version = 0;
		if (!ob_universe_get_motion(x->u, n->id, &out->motion))
			return false;
		out->now = ob_motion_at(&out->motion, n->passport.inertia, s->time);
		return true;
	}
	const double asked = s->time - x->free->delay;
	out->version =
		ob_free_schedule_read(x->schedule, x->u, n->id, asked, &out->motion, x->free->delay > 0 ? NULL : &next);
	if (!out->version)
		return false;
	out->now = ob_free_state_at(&out->motion, &next, n->passport.inertia, s->time);
	// a flight is as new as the time that its simulator has reached
	const bool flies = out->motion.flags & OB_MOTION_FREE;
	count_reading(s, asked, ob_max(out->motion.t0, flies ? ob_min(asked, ob_free_time(x->u, n->id)) : 0));
	return true;
}

static void box_of(const ob_passport *p, const ob_state *now, double reach, double box[6])
{
	ob_shape_bounds((ob_shape)p->shape, p->size, now->pose, box);
	for (int c = 0; c < 3; c++)
		box[c] -= reach, box[3 + c] += reach;
}

// Bounds the way, m, of a body's points in a step: contacts within it are the solver's.
static double reach_of(const ob_free_scratch *x, const ob_passport *p, const ob_state *now, double h)
{
	const double turning = ob_shape_is(p->shape, OB_UNBOUNDED)
				       ? 0
				       : ob_norm(now->w) * ob_shape_radius((ob_shape)p->shape, p->size);
	return 2 * h * (ob_norm(now->v) + turning + ob_norm(x->run.gravity) * h) + x->solver.island.tolerance;
}

static bool may_touch(const ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n, const ob_state *own,
		      const ob_state *other, double h)
{
	const double reach = reach_of(x, &s->passport, own, h) + reach_of(x, &n->passport, other, h);
	double a[6], b[6];
	bool near = true;
	if (ob_shape_is(n->passport.shape, OB_UNBOUNDED)) {
		const ob_mat3 r = ob_quat_matrix(other->pose.q);
		return ob_dot(ob_column(&r, 2), ob_sub(own->pose.p, other->pose.p)) <=
		       reach + ob_shape_radius((ob_shape)s->passport.shape, s->passport.size);
	}
	box_of(&s->passport, own, reach, a);
	box_of(&n->passport, other, 0, b);
	for (int c = 0; c < 3; c++)
		near &= a[c] <= b[3 + c] && b[c] <= a[3 + c];
	return near;
}

static double thickness_of(const ob_passport *p)
{
	return ob_shape_thickness((ob_shape)p->shape, p->size);
}

static const double way = .002; // of the thickness: relative motion in a step

// Overlap, m, that the last step left.
static double overlap_of(const ob_free_neighbour *n)
{
	double gap = 0;
	for (uint32_t i = 0; n->contact.kept && i < n->contact.state.points; i++)
		gap = ob_min(gap, n->contact.state.gap[i]);
	return -gap;
}

// Longest step, s, in which two bodies move by little relative to each other, at a speed (m/s). What they overlap counts.
static double little_way(const ob_free_sim *s, const ob_free_neighbour *n, double speed)
{
	const double most = way * ob_min(thickness_of(&s->passport), thickness_of(&n->passport));
	return ob_max(0, most - overlap_of(n)) / speed;
}

// s, the longest that a step may be
static double usual(const ob_free_sim *s, const ob_free_scratch *x)
{
	return (1 + x->free->jitter) / s->rate;
}

// Bounding balls may touch two such steps later.
double ob_free_approach(const ob_free_sim *s, const ob_free_scratch *x, const ob_free_neighbour *n)
{
	return n->apart - 2 * usual(s, x);
}

// Has a neighbour's flight end in time.
static void lower(const ob_free_sim *s, ob_free_scratch *x, const ob_free_neighbour *n)
{
	const double holds = ob_free_holds(x->u, n->id);
	if (holds > 0 && n->kind == OB_FREE_SIMULATED && ob_free_approach(s, x, n) < holds)
		ob_free_lower(x->u, n->id, ob_max(s->time, ob_free_approach(s, x, n)));
}

// Shortens the next step if the two may touch in a step of the usual length, so that those that a body touches have short
// steps, too, when it is hit. theirs: flags of the neighbour's motion.
static void approach(const ob_free_sim *s, ob_free_scratch *x, const ob_free_neighbour *n, const ob_state *own,
		     const ob_state *other, uint32_t theirs)
{
	const bool fly = s->motion.flags & theirs & OB_MOTION_FREE;
	if (!(fly && n->apart > s->time + usual(s, x)) && may_touch(s, x, n, own, other, usual(s, x)))
		x->closing = ob_min(x->closing, little_way(s, n, ob_norm(ob_sub(own->v, other->v))));
}

// ---- the island

// Puts an object at a place of the island. Its motion begins at time 0 there.
static void put_object(ob_free_scratch *x, uint32_t at, uint32_t id, const ob_passport *p, const ob_hull *hull,
		       const ob_motion *m, const ob_state *now)
{
	x->passport[at] = *p;
	x->motion[at] = *m;
	x->motion[at].flags &= OB_MOTION_SWINGS;
	x->motion[at].rest_time = 0;
	x->motion[at].substeps = 0;
	x->object[at] = (ob_island_object){
		.id = id, .passport = &x->passport[at], .hull = hull, .motion = &x->motion[at], .now = *now
	};
}

// Makes a neighbour go on as published, unless the contact changes that: by its mass, or hardly.
static void make_partner(ob_free_scratch *x, uint32_t at, const ob_free_seen *seen)
{
	ob_passport *p = &x->passport[at];
	if (x->free->heavy)
		p->mass *= heavy, p->inertia = ob_scale(p->inertia, heavy);
	p->force = ob_scale(ob_sub(x->motion[at].a, x->run.gravity), p->mass);
}

static void put_pair(ob_free_scratch *x, uint32_t pair, uint32_t neighbour, uint32_t own, uint32_t other, bool fixed)
{
	const ob_free_neighbour *n = &x->sim->neighbour[neighbour];
	const bool first = x->sim->id < n->id;
	x->pair[pair] = (ob_island_pair){ .pair = neighbour,
					  .a = first ? own : other,
					  .b = first ? other : own,
					  .fixed = fixed ? other : OB_NO_FIXED,
					  .limit = -INFINITY,
					  .kept = n->contact.kept,
					  .newest = n->contact.kept,
					  .before = n->contact.kept ? &n->contact.state : NULL };
}

// Builds the island of the object and its near neighbours.
static ob_island_input build(ob_free_sim *s, ob_free_scratch *x, const ob_state *own)
{
	uint32_t members = 0, own_at = 0;
	bool placed = false;
	for (uint32_t i = 0; i <= x->near; i++) {
		const ob_free_neighbour *n = i < x->near ? &s->neighbour[x->seen[i].neighbour] : NULL;
		if (!placed && (!n || n->id > s->id)) {
			put_object(x, members, s->id, &s->passport, s->hull, &s->motion, own);
			own_at = members++;
			placed = true;
		}
		if (n && n->kind == OB_FREE_SIMULATED) {
			put_object(x, members, n->id, &n->passport, n->hull, &x->seen[i].motion, &x->seen[i].now);
			make_partner(x, members++, &x->seen[i]);
		}
	}
	uint32_t objects = members;
	for (uint32_t i = 0; i < x->near; i++) {
		const ob_free_seen *seen = &x->seen[i];
		const ob_free_neighbour *n = &s->neighbour[seen->neighbour];
		const bool partner = n->kind == OB_FREE_SIMULATED;
		uint32_t other = partner ? 0 : objects++;
		while (partner && x->object[other].id != n->id)
			other++;
		if (!partner) {
			put_object(x, other, n->id, &n->passport, n->hull, &seen->motion, &seen->now);
			x->motion[other].t0 -= s->time;
		}
		put_pair(x, i, seen->neighbour, own_at, other, !partner);
	}
	return (ob_island_input){
		.members = members, .objects = objects, .pairs = x->near, .object = x->object, .pair = x->pair
	};
}

// Flies freely.
static void fly(const ob_free_sim *s, const ob_free_scratch *x, double h, ob_motion *out)
{
	*out = s->motion;
	out->a = ob_external_acceleration(&x->run, &s->passport);
	const ob_state end = ob_motion_at(out, s->passport.inertia, out->t0 + h);
	out->p = end.pose.p, out->q = end.pose.q, out->v = end.v, out->w = end.w;
	out->flags = OB_MOTION_FREE;
	out->path += ob_norm(end.v) * h;
}

// Reads all neighbours, and lists those that the object may touch in a step of length h (s). The list is empty
// if none can touch it because all fly or stand.
static void look(ob_free_sim *s, ob_free_scratch *x, const ob_state *own, double h)
{
	const ob_vec3 outer = ob_external_acceleration(&x->run, &s->passport);
	bool touches = false;
	x->near = 0;
	for (uint32_t i = 0; i < s->neighbours; i++) {
		ob_free_neighbour *n = &s->neighbour[i];
		ob_free_seen *seen = &x->seen[x->near];
		seen->neighbour = i;
		n->bound = n->apart = 0;
		const bool seen_now = read_neighbour(s, x, n, seen), fixed = n->passport.flags & OB_OBJECT_STATIC;
		n->version = seen_now ? seen->version : 0;
		if (seen_now && (n->kind == OB_FREE_SIMULATED || fixed))
			n->apart = ob_free_apart(s, n, &seen->now, outer, seen->motion.a);
		if (seen_now && may_touch(s, x, n, own, &seen->now, h)) {
			touches |= !(n->apart > s->time + h && (fixed || seen->motion.flags & OB_MOTION_FREE));
			x->near++;
			continue;
		}
		n->contact.kept = 0;
		n->bound = ob_free_lag_apart(s, n, &seen->now);
		if (!seen_now || n->kind != OB_FREE_SIMULATED)
			continue;
		lower(s, x, n);
		if (ob_free_approach(s, x, n) < s->time)
			approach(s, x, n, own, &seen->now, seen->motion.flags);
	}
	for (uint32_t i = 0; i < x->near; i++) {
		ob_free_neighbour *n = &s->neighbour[x->seen[i].neighbour];
		n->contact.kept = touches ? n->contact.kept : 0;
		if (n->kind == OB_FREE_SIMULATED && touches)
			ob_free_lower(x->u, n->id, s->time);
		else if (n->kind == OB_FREE_SIMULATED)
			lower(s, x, n), approach(s, x, n, own, &x->seen[i].now, x->seen[i].motion.flags);
		n->apart = touches ? 0 : n->apart;
	}
	x->near = touches ? x->near : 0;
}

// Longest that the next step should be, s. Bodies that hit each other learn of it a step late, a light one between two
// heavy ones passes on little in each step, and a load goes through a pile at one body a step: shorter steps keep them
// apart, the shorter the more they overlap. own: state at the step's begin; out: at its end.
static double step_for(const ob_free_sim *s, const ob_free_scratch *x, const ob_state *own, double h,
		       const ob_motion *out)
{
	const ob_vec3 outer = ob_external_acceleration(&x->run, &s->passport);
	double step = way * thickness_of(&s->passport) / ob_norm(ob_sub(out->v, ob_madd(own->v, h, outer)));
	for (uint32_t i = 0; i < x->near; i++) {
		const ob_free_seen *seen = &x->seen[i];
		const ob_free_neighbour *n = &s->neighbour[seen->neighbour];
		if (n->kind == OB_FREE_SIMULATED)
			step = ob_min(step, little_way(s, n, ob_norm(ob_sub(out->v, seen->now.v))));
	}
	return step;
}

void ob_free_view_step(ob_free_sim *s, ob_free_scratch *x, double h, ob_motion *out)
{
	const ob_state own = { { s->motion.p, s->motion.q }, s->motion.v, s->motion.w };
	reserve(x, s->neighbours + 2);
	x->closing = INFINITY;
	look(s, x, &own, h);
	x->flew = true;
	if (x->near > 0) {
		const ob_island_input in = build(s, x, &own);
		s->counts.solved++;
		ob_island_solve(&x->solver, &in);
	}
	if (x->flew)
		fly(s, x, h, out);
	else
		*out = x->end;
	s->step = ob_min(x->closing, step_for(s, x, &own, h, out));
}
