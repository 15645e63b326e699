#include "baseline/ode_baseline.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include <ob/motion.h>

#include "base/allocate.h"
#include "ode/ode_body.h"
#include "ode/ode_world.h"
#include "exchange/results.h"
#include "table/trace.h"

struct held_object { // the object that the world holds for a slot, if any
	bool there;
	uint32_t generation;
};

struct touching {
	uint32_t a, b;
};

struct touching_list { // ascending, each once
	struct touching *pair;
	size_t count, max;
};

struct ob_ode_baseline {
	ob_universe *u;
	const ob_run_settings *run;
	ob_ode_world *world;
	struct held_object *held; // [capacity]
	ob_contact_point *point;
	double *depth;
	size_t points_max;
	struct touching_list pressed, presses; // with scripts: pairs that press before the step, and in it
	ob_found_joint *joint; // [joints_max]: loads of this step
	bool *joined; // [joints_max]: the world has it
	uint32_t awake, pairs;
	bool traced;
};

static bool may_touch(const void *universe, uint32_t a, uint32_t b)
{
	return ob_may_touch(universe, a, b);
}

ob_ode_baseline *ob_ode_baseline_create(ob_universe *u)
{
	const ob_run_settings *run = ob_universe_settings(u);
	uint32_t capacity = ob_universe_capacity(u);
	ob_ode_world_setup setup = {
		.gravity = run->gravity,
		.iterations = run->iterations,
		.objects = capacity,
		.sleeping = run->sleeping,
		.boxed = run->narrow_phase == OB_NARROW_AABB,
		.pairs_max = ob_universe_step_data(u)->pairs_max,
		.load = run->load,
		.joints = ob_universe_step_data(u)->joints_max,
		.may_touch = ob_universe_step_data(u)->joints_max ? may_touch : NULL,
		.of = u,
	};
	ob_ode_thread_init();
	ob_ode_baseline *m = calloc(1, sizeof *m);
	if (!m)
		return NULL;
	m->u = u;
	m->run = run;
	m->traced = ob_universe_traced(u);
	m->held = calloc(capacity, sizeof *m->held);
	m->joint = calloc(setup.joints + 1, sizeof *m->joint);
	m->joined = calloc(setup.joints + 1, sizeof *m->joined);
	m->world = ob_ode_world_create(&setup);
	if (!m->held || !m->joint || !m->joined || !m->world) {
		ob_ode_baseline_destroy(m);
		return NULL;
	}
	return m;
}

void ob_ode_baseline_destroy(ob_ode_baseline *m)
{
	if (!m)
		return;
	ob_ode_world_destroy(m->world);
	free(m->held);
	free(m->joint);
	free(m->joined);
	free(m->point);
	free(m->depth);
	free(m->pressed.pair);
	free(m->presses.pair);
	free(m);
	ob_ode_thread_finish();
}

// Forgets the object's touches: the next object with its id has touched nothing.
static void forget_touches(ob_ode_baseline *m, uint32_t id)
{
	struct touching_list *l = &m->pressed;
	size_t kept = 0;
	for (size_t i = 0; i < l->count; i++)
		if (l->pair[i].a != id && l->pair[i].b != id)
			l->pair[kept++] = l->pair[i];
	l->count = kept;
}

static void add_object(ob_ode_baseline *m, const ob_passport *p, const ob_state *s)
{
	const ob_terrain *t = ob_terrain_of(m->u, p);
	if (!t) {
		ob_ode_world_add(m->world, p, s);
		return;
	}
	const ob_ode_triangles triangles = { ob_terrain_vertices(t), ob_terrain_triangles(t)->corner, t->vertices,
					     t->triangles, sizeof(ob_terrain_triangle) };
	if (!ob_ode_world_add_triangles(m->world, p, s, &triangles))
		ob_step_fail(m->u, OB_STEP_ENGINE, p->id);
}

// Takes in and drops objects as the passports say, which the host changes between steps.
static void follow_passports(ob_ode_baseline *m)
{
	uint32_t ids = ob_universe_ids(m->u);
	for (uint32_t id = 0; id < ids; id++) {
		const ob_passport *p = ob_passport_of(m->u, id);
		struct held_object *h = &m->held[id];
		bool present = p->flags & OB_OBJECT_PRESENT;
		if (h->there && (!present || h->generation != p->generation)) {
			ob_ode_world_remove(m->world, id);
			forget_touches(m, id);
			h->there = false;
		}
		if (present && h->there)
			ob_ode_world_push(m->world, id, p->force, ob_script_torque(ob_universe_step_data(m->u), id));
		if (!present || h->there)
			continue;
		const ob_motion *first = ob_newest_motion(m->u, id);
		ob_state s = { { first->p, first->q }, first->v, first->w };
		add_object(m, p, &s);
		*h = (struct held_object){ true, p->generation };
	}
}

static bool holds(const ob_ode_baseline *m, uint32_t joint)
{
	const ob_joint_passport *j = &ob_universe_step_data(m->u)->joint[joint];
	return j->kind != OB_JOINT_APART && ob_joint_holds(m->u, j);
}

// Joins objects, or parts them, as the universe's joints say. Call after follow_passports.
static void follow_joints(ob_ode_baseline *m)
{
	const ob_step_data *data = ob_universe_step_data(m->u);
	for (uint32_t i = 0; i < ob_joints_end(data); i++) {
		const bool was = m->joined[i], is = holds(m, i);
		m->joint[i] = (ob_found_joint){ .joint = i };
		if (was && !is)
			ob_ode_world_unjoin(m->world, i);
		if (is && !was && !ob_ode_world_join(m->world, i, &data->joint[i]))
			ob_step_fail(m->u, OB_STEP_ENGINE, data->joint[i].object[0]);
		m->joined[i] = is;
	}
}

static void drive_joints(ob_ode_baseline *m, double h)
{
	const ob_step_data *data = ob_universe_step_data(m->u);
	for (uint32_t i = 0; i < ob_joints_end(data); i++)
		ob_ode_world_drive_joint(m->world, i, &data->joint[i].axis, h);
}

// Adds loads of a substep. A joint that has more than its strength ends with it: its load is that by which it broke.
static void load_joints(ob_ode_baseline *m)
{
	const ob_step_data *data = ob_universe_step_data(m->u);
	const double share = 1. / m->run->substeps;
	for (uint32_t i = 0; i < ob_joints_end(data); i++) {
		const ob_joint_passport *j = &data->joint[i];
		ob_found_joint *f = &m->joint[i];
		ob_joint_load now;
		if (!ob_ode_world_joint_load(m->world, i, &now))
			continue;
		f->broke = ob_norm(now.force) > j->breaks_force || ob_norm(now.torque) > j->breaks_torque;
		f->force = f->broke ? now.force : ob_madd(f->force, share, now.force);
		f->torque = f->broke ? now.torque : ob_madd(f->torque, share, now.torque);
		f->along = f->broke ? now.along : f->along + share * now.along;
		if (f->broke)
			ob_ode_world_unjoin(m->world, i);
	}
}

static void publish_joints(ob_ode_baseline *m)
{
	const ob_step_data *data = ob_universe_step_data(m->u);
	for (uint32_t i = 0; i < ob_joints_end(data); i++) {
		if (m->joined[i])
			ob_commit_joint(m->u, &m->joint[i]);
		m->joined[i] &= !m->joint[i].broke;
	}
}

// Rounds outwards, so that the narrower numbers still hold the object.
static void round_outwards(const double from[6], double by, float to[6])
{
	for (int i = 0; i < 3; i++) {
		to[i] = nextafterf((float)(from[i] - by), -FLT_MAX);
		to[i + 3] = nextafterf((float)(from[i + 3] + by), FLT_MAX);
	}
}

static void publish_object(ob_ode_baseline *m, uint32_t id, const ob_state *s, bool asleep, bool touching)
{
	const ob_passport *p = ob_passport_of(m->u, id);
	const ob_motion *last = ob_newest_motion(m->u, id);
	double h = m->run->step_length;
	uint64_t step = ob_step_count(m->u) + 1;
	double speed = ob_norm(s->v) + ob_norm(s->w) * ob_shape_radius(p->shape, p->size);
	ob_motion next = {
		.t0 = (double)step * h,
		.valid_until = asleep ? INFINITY : (double)(step + 1) * h,
		.p = s->pose.p,
		.q = s->pose.q,
		.v = s->v,
		.w = s->w,
		.a = touching || asleep ? ob_v3(0, 0, 0) : ob_external_acceleration(m->run, p),
		.path = last->path + speed * h,
		.step = (uint32_t)step,
		.flags = asleep ? OB_MOTION_ASLEEP : 0,
		.rest_time = asleep ? last->rest_time + (float)h : 0,
	};
	double bounds[6];
	ob_shape_bounds(p->shape, p->size, s->pose, bounds);
	round_outwards(bounds, asleep ? 0 : speed * h + .5 * h * h * ob_norm(ob_external_acceleration(m->run, p)),
		       ob_universe_step_data(m->u)->bounds[id]);
	if (m->traced)
		ob_trace_moves(m->u, 0, id, last->flags & OB_MOTION_ASLEEP, next.flags);
	ob_publish_motion(m->u, id, &next);
	ob_universe_step_data(m->u)->schedule[id].state = asleep ? OB_SCHEDULE_ASLEEP : OB_SCHEDULE_AWAKE;
}

static bool moves(const ob_ode_baseline *m, uint32_t id)
{
	return m->held[id].there && !(ob_passport_of(m->u, id)->flags & OB_OBJECT_PRESCRIBED);
}

// Publishes all states, or none.
static void publish_all(ob_ode_baseline *m)
{
	uint32_t ids = ob_universe_ids(m->u);
	ob_state s;
	bool asleep, touching;
	m->awake = 0;
	for (uint32_t id = 0; id < ids; id++) {
		if (!moves(m, id))
			continue;
		ob_ode_world_get(m->world, id, &s, &asleep, &touching);
		if (!ob_state_is_sane(&s))
			ob_step_fail(m->u, OB_STEP_DIVERGED, id);
	}
	for (uint32_t id = 0; id < ids && ob_step_failed(m->u, NULL) == OB_STEP_OK; id++) {
		if (!moves(m, id))
			continue; // static objects keep their first motion
		ob_ode_world_get(m->world, id, &s, &asleep, &touching);
		m->awake += !asleep;
		publish_object(m, id, &s, asleep, touching);
	}
}

static bool read_contacts(ob_ode_baseline *m, size_t *points)
{
	*points = ob_ode_world_contacts(m->world, m->point, m->depth, m->points_max);
	if (*points <= m->points_max)
		return true;
	size_t more = *points + *points / 2;
	free(m->point);
	free(m->depth);
	m->point = ob_allocate(more * sizeof *m->point);
	m->depth = ob_allocate(more * sizeof *m->depth);
	m->points_max = more;
	return ob_ode_world_contacts(m->world, m->point, m->depth, m->points_max) == *points;
}

// Writes the points of one pair as a record of the complete step. A record holds the first 4 of them.
static void write_pair(ob_ode_baseline *m, uint32_t index, size_t from, size_t to)
{
	ob_step_data *data = ob_universe_step_data(m->u);
	uint64_t step = ob_step_count(m->u) + 1;
	const ob_contact_point *c = &m->point[from];
	ob_vec3 a = ob_newest_motion(m->u, c->a)->p;
	ob_pair_state s = { .normal = c->normal, .substep = m->run->step_length / m->run->substeps };
	for (size_t i = from; i < to && s.points < OB_PAIR_POINTS; i++, s.points++) {
		s.arm_a[s.points] = ob_sub(m->point[i].position, a);
		s.gap[s.points] = -m->depth[i];
		s.impulse[s.points] = m->point[i].impulse;
	}
	data->record[index].version[step & 1] = s;
	data->record[index].stamp[step & 1] = (uint32_t)(step + 1);
	data->pair[index] = (ob_pair_key){ .a = c->a, .b = c->b, .record = index, .active = 1 };
}

// Publishes pairs for overlays only; pairs beyond the step data's size are left out. ODE's world lists points by pair.
static void publish_pairs(ob_ode_baseline *m)
{
	ob_step_data *data = ob_universe_step_data(m->u);
	size_t points, to;
	uint32_t pairs = 0;
	if (!read_contacts(m, &points))
		points = 0;
	for (size_t from = 0; from < points; from = to, pairs++) {
		for (to = from + 1; to < points; to++)
			if (m->point[to].a != m->point[from].a || m->point[to].b != m->point[from].b)
				break;
		if (pairs < data->pairs_max && ob_reserve_pairs(m->u, pairs, 1) && ob_reserve_record(m->u, pairs))
			write_pair(m, pairs, from, to);
	}
	m->pairs = pairs;
	data->count->pairs = pairs < data->pairs_max ? pairs : data->pairs_max;
	data->count->records_used = data->count->pairs;
}

// ---- touches for scripts

static int by_pair(const void *x, const void *y)
{
	const struct touching *p = x, *q = y;
	if (p->a != q->a)
		return p->a < q->a ? -1 : 1;
	return (p->b > q->b) - (p->b < q->b);
}

static void add_touching(struct touching_list *l, uint32_t a, uint32_t b)
{
	if (l->count == l->max) {
		l->max = l->max ? 2 * l->max : 64;
		l->pair = ob_reallocate(l->pair, l->max * sizeof *l->pair);
	}
	l->pair[l->count++] = (struct touching){ a, b };
}

// Notes touches, after each substep: pairs that press now and did not before the step.
static void note_touches(ob_ode_baseline *m)
{
	size_t points, to;
	if (!read_contacts(m, &points))
		return;
	for (size_t from = 0; from < points; from = to) {
		const ob_contact_point *c = &m->point[from];
		double impulse = 0;
		ob_vec3 sum = { 0 };
		for (to = from; to < points && m->point[to].a == c->a && m->point[to].b == c->b; to++) {
			impulse += m->point[to].impulse;
			sum = ob_add(sum, m->point[to].position);
		}
		const struct touching pair = { c->a, c->b };
		const bool before =
			m->pressed.count && bsearch(&pair, m->pressed.pair, m->pressed.count, sizeof pair, by_pair);
		if (!before && impulse > 0)
			ob_touches_note(m->u, pair.a, pair.b, impulse, ob_scale(sum, 1. / (double)(to - from)));
		if (before || impulse > 0)
			add_touching(&m->presses, pair.a, pair.b);
	}
}

static bool is_awake(const ob_ode_baseline *m, uint32_t id)
{
	ob_state s;
	bool asleep, touching;
	if (!moves(m, id))
		return false;
	ob_ode_world_get(m->world, id, &s, &asleep, &touching);
	return !asleep;
}

// Ends the step's touches. Keeps those of sleeping objects, which ODE does not collide.
static void end_touches(ob_ode_baseline *m)
{
	struct touching_list *l = &m->presses;
	size_t kept = 0;
	for (size_t i = 0; i < m->pressed.count; i++) {
		const struct touching p = m->pressed.pair[i];
		if (!is_awake(m, p.a) && !is_awake(m, p.b))
			add_touching(l, p.a, p.b);
	}
	if (l->count)
		qsort(l->pair, l->count, sizeof *l->pair, by_pair);
	for (size_t i = 0; i < l->count; i++)
		if (!kept || by_pair(&l->pair[kept - 1], &l->pair[i]) != 0)
			l->pair[kept++] = l->pair[i];
	l->count = kept;
	const struct touching_list old = m->pressed;
	m->pressed = *l;
	*l = old;
	l->count = 0;
}

// Moves kinematic objects to their poses at an instant (s).
static void drive(ob_ode_baseline *m, double time)
{
	const uint32_t ids = ob_universe_step_data(m->u)->count->kinematic ? ob_universe_ids(m->u) : 0;
	for (uint32_t id = 0; id < ids; id++) {
		const ob_passport *p = ob_passport_of(m->u, id);
		if (!m->held[id].there || !(p->flags & OB_OBJECT_KINEMATIC))
			continue;
		const ob_state now = ob_motion_at(ob_newest_motion(m->u, id), p->inertia, time);
		ob_ode_world_drive(m->world, id, &now);
	}
}

void ob_ode_baseline_kick(ob_ode_baseline *m, uint32_t id, ob_vec3 impulse, ob_vec3 twist)
{
	follow_passports(m); // the object may be new
	ob_ode_world_kick(m->world, id, impulse, twist);
}

void ob_ode_baseline_step(ob_ode_baseline *m)
{
	const bool scripts = ob_universe_step_data(m->u)->script_of;
	const double h = m->run->step_length / m->run->substeps;
	follow_passports(m);
	follow_joints(m);
	for (uint32_t i = 0; i < m->run->substeps; i++) {
		drive(m, (double)ob_step_count(m->u) * m->run->step_length + i * h);
		drive_joints(m, h);
		if (!ob_ode_world_step(m->world, h)) {
			bool full;
			uint32_t culprit = ob_ode_world_culprit(m->world, &full);
			ob_step_fail(m->u, full ? OB_STEP_PAIRS_FULL : OB_STEP_ENGINE, culprit);
			return;
		}
		load_joints(m);
		if (scripts)
			note_touches(m);
	}
	if (scripts)
		end_touches(m);
	publish_all(m);
	publish_joints(m);
	publish_pairs(m);
}

uint32_t ob_ode_baseline_awake(const ob_ode_baseline *m)
{
	return m->awake;
}
uint32_t ob_ode_baseline_pairs(const ob_ode_baseline *m)
{
	return m->pairs;
}
uint64_t ob_ode_baseline_box_tests(const ob_ode_baseline *m)
{
	return ob_ode_world_box_tests(m->world);
}
