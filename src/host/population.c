#include "host/population.h"

#include <stdlib.h>
#include <string.h>
#include <urcu/wfcqueue.h>

#include "base/log.h"
#include "host/rcu_tsan.h"
#include "ode/ode_body.h"
#include "sim/sim.h"

// An entry of the timetable.
typedef struct event {
	uint64_t step;
	uint32_t id;
	bool add; // else remove
} event;

// Reserved: the slot is empty, but the timetable has another event for it.
typedef enum slot_use { SLOT_FREE, SLOT_RESERVED, SLOT_PRESENT } slot_use; // saved as these numbers

typedef struct slot {
	uint32_t generation; // of its latest object
	unsigned char use; // slot_use
	bool removal_scheduled; // the timetable will remove its object
} slot;

struct ob_population {
	ob_universe *u;
	ob_roster *roster;
	const ob_scene *scene;
	slot *slots; // [capacity]
	event *events; // the timetable: ascending by step; at one step removals first
	size_t event_count, next;
	bool changed;
};

// ---- requests

typedef struct queued_request {
	struct cds_wfcq_node node;
	ob_request request;
} queued_request;

struct ob_requests {
	struct cds_wfcq_head head;
	struct cds_wfcq_tail tail;
};

ob_requests *ob_requests_create(void)
{
	ob_requests *q = calloc(1, sizeof *q);
	if (q)
		cds_wfcq_init(&q->head, &q->tail);
	return q;
}

void ob_requests_destroy(ob_requests *q)
{
	ob_request dropped;
	if (!q)
		return;
	while (ob_requests_take(q, &dropped))
		;
	cds_wfcq_destroy(&q->head, &q->tail);
	free(q);
}

bool ob_requests_push(ob_requests *q, const ob_request *r)
{
	queued_request *e = malloc(sizeof *e);
	if (!e)
		return false;
	e->request = *r;
	cds_wfcq_node_init(&e->node);
	OB_ORDER_BEFORE(e);
	cds_wfcq_enqueue(&q->head, &q->tail, &e->node);
	return true;
}

bool ob_requests_take(ob_requests *q, ob_request *out)
{
	// there is one consumer only, so the queue's lock is not needed
	struct cds_wfcq_node *node = __cds_wfcq_dequeue_blocking(&q->head, &q->tail);
	if (!node)
		return false;
	queued_request *e = caa_container_of(node, queued_request, node);
	OB_ORDER_AFTER(e);
	*out = e->request;
	free(e);
	return true;
}

bool ob_requests_waiting(ob_requests *q)
{
	return !cds_wfcq_empty(&q->head, &q->tail);
}

// ---- checks

static bool finite3(ob_vec3 v)
{
	return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool check_shape(const ob_passport *p, ob_error *e)
{
	bool needs_y = p->shape != OB_SHAPE_SPHERE, needs_z = p->shape == OB_SHAPE_BOX;
	if (p->shape <= OB_SHAPE_NONE || p->shape > OB_SHAPE_CYLINDER)
		return ob_fail(e, "object \"%.*s\": unknown shape %u", OB_NAME_MAX, p->name, p->shape);
	if (p->shape == OB_SHAPE_PLANE)
		return p->flags & OB_OBJECT_STATIC ||
		       ob_fail(e, "object \"%.*s\": a plane must be static", OB_NAME_MAX, p->name);
	if (!finite3(p->size) || !(p->size.x > 0) || (needs_y && !(p->size.y > 0)) || (needs_z && !(p->size.z > 0)))
		return ob_fail(e, "object \"%.*s\": size must be positive", OB_NAME_MAX, p->name);
	return true;
}

bool ob_object_check(const ob_object_def *def, ob_error *e)
{
	const ob_passport *p = &def->passport;
	const ob_state *s = &def->state;
	ob_quat q = s->pose.q;
	double norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
	if (!memchr(p->name, 0, OB_NAME_MAX))
		return ob_fail(e, "object %u: its name is longer than %d characters", p->id, OB_NAME_MAX - 1);
	if (!check_shape(p, e))
		return false;
	if (!(p->flags & OB_OBJECT_STATIC) && !(p->mass > 0 && isfinite(p->mass)))
		return ob_fail(e, "object \"%s\": mass must be positive (or the object static)", p->name);
	if (!finite3(s->pose.p) || !finite3(s->v) || !finite3(s->w) || !(fabs(norm2 - 1) < 1e-6))
		return ob_fail(e, "object \"%s\": position, attitude and velocities must be finite", p->name);
	if (!(p->friction >= 0 && isfinite(p->friction)) || !(p->restitution >= 0 && p->restitution <= 1))
		return ob_fail(e, "object \"%s\": friction must be >= 0, restitution in 0..1", p->name);
	return true;
}

// ---- changes

static void add_object(ob_population *p, uint32_t id, const ob_object_def *def)
{
	ob_passport pass = def->passport;
	pass.id = id;
	pass.generation = ++p->slots[id].generation;
	pass.flags |= OB_OBJECT_PRESENT;
	if (pass.flags & OB_OBJECT_STATIC) {
		pass.mass = 0;
		pass.inertia = ob_v3(0, 0, 0);
	} else {
		pass.inertia = ob_ode_inertia((ob_shape)pass.shape, pass.size, pass.mass);
	}
	ob_write_passport(p->u, id, &pass);
	ob_sim_place(p->u, id, &def->state);
	p->slots[id].use = SLOT_PRESENT;
	p->changed = true;
}

static void remove_object(ob_population *p, uint32_t id)
{
	slot *s = &p->slots[id];
	if (s->use != SLOT_PRESENT)
		return;
	ob_sim_remove(p->u, id);
	s->use = s->removal_scheduled ? SLOT_RESERVED
				      : SLOT_FREE; // else the timetable would remove the slot's next object
	p->changed = true;
}

static void remove_scheduled(ob_population *p, uint32_t id)
{
	p->slots[id].removal_scheduled = false;
	remove_object(p, id);
	p->slots[id].use = SLOT_FREE;
}

static void add_on_request(ob_population *p, const ob_object_def *def)
{
	uint32_t capacity = ob_universe_capacity(p->u);
	for (uint32_t id = 0; id < capacity; id++) {
		if (p->slots[id].use == SLOT_FREE) {
			ob_error e;
			if (ob_universe_reserve(p->u, id + 1, &e))
				add_object(p, id, def);
			else
				ob_log_warn("object \"%s\" was not added: %s", def->passport.name, e.text);
			return;
		}
	}
	ob_log_warn("object \"%s\" was not added: all %u slots are taken", def->passport.name, capacity);
}

static void publish_roster(ob_population *p)
{
	bool one_per_object = ob_universe_settings(p->u)->one_per_object;
	uint32_t n = 0, ids = ob_universe_capacity(p->u);
	ob_roster_entry *entries = malloc(ids * sizeof *entries);
	for (uint32_t id = 0; entries && id < ids; id++) {
		if (p->slots[id].use != SLOT_PRESENT)
			continue;
		const ob_passport *pass = ob_passport_of(p->u, id);
		ob_roster_entry *entry = &entries[n++];
		entry->id = id;
		entry->generation = pass->generation;
		entry->worker = one_per_object ? id : OB_ROSTER_ANY_WORKER;
		memcpy(entry->name, pass->name, sizeof entry->name);
	}
	if (!entries || !ob_roster_publish(p->roster, entries, n))
		ob_log_warn("out of memory: the roster of objects is out of date");
	free(entries);
	p->changed = false;
}

bool ob_population_update(ob_population *p, uint64_t step, ob_requests *q)
{
	ob_request r;
	for (; p->next < p->event_count && p->events[p->next].step <= step; p->next++) {
		event *due = &p->events[p->next];
		if (due->add)
			add_object(p, due->id, &p->scene->object[due->id]);
		else
			remove_scheduled(p, due->id);
	}
	while (ob_requests_take(q, &r)) {
		if (r.add)
			add_on_request(p, &r.def);
		else if (r.id < ob_universe_capacity(p->u) && p->slots[r.id].generation == r.generation)
			remove_object(p, r.id);
	}
	bool changed = p->changed;
	if (changed)
		publish_roster(p);
	return changed;
}

uint64_t ob_population_next_step(const ob_population *p)
{
	return p->next < p->event_count ? p->events[p->next].step : UINT64_MAX;
}

// ---- saved

void ob_population_count_saved(const ob_population *p, ob_saved_population *out)
{
	uint32_t ids = ob_universe_ids(p->u);
	*out = (ob_saved_population){ .events = p->next, .count = ids > p->scene->objects ? ids : p->scene->objects };
}

void ob_population_save(const ob_population *p, ob_saved_population *out)
{
	for (uint32_t id = 0; id < out->count; id++) {
		const slot *s = &p->slots[id];
		out->slot[id] = (ob_saved_slot){ s->generation, s->use, s->removal_scheduled, { 0 } };
	}
}

static bool check_slot(const ob_population *p, uint32_t id, const ob_saved_slot *s)
{
	const ob_passport *pass = ob_passport_of(p->u, id);
	const bool present = id < ob_universe_ids(p->u) && pass->flags & OB_OBJECT_PRESENT;
	return s->use <= SLOT_PRESENT && s->removal_scheduled <= 1 && present == (s->use == SLOT_PRESENT) &&
	       (!present || pass->generation == s->generation);
}

// What the saved objects are made of is checked as if they were added now.
static bool check_objects(const ob_population *p, ob_error *e)
{
	for (uint32_t id = 0; id < ob_universe_ids(p->u); id++) {
		const ob_motion *m = ob_newest_motion(p->u, id);
		ob_object_def def = { .passport = *ob_passport_of(p->u, id), .state = { { m->p, m->q }, m->v, m->w } };
		if (def.passport.flags & OB_OBJECT_PRESENT && !ob_object_check(&def, e))
			return false;
	}
	return true;
}

bool ob_population_load(ob_population *p, const ob_saved_population *s, ob_error *e)
{
	if (s->count > ob_universe_capacity(p->u) || s->count < p->scene->objects || s->events > p->event_count)
		return ob_fail(e, "its objects are not those of its scene");
	if (!check_objects(p, e))
		return false;
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_saved_slot *from = &s->slot[id];
		if (!check_slot(p, id, from))
			return ob_fail(e, "slot %u makes no sense", id);
		p->slots[id] = (slot){ from->generation, from->use, from->removal_scheduled };
	}
	p->next = s->events;
	publish_roster(p);
	return true;
}

// ---- the scene's timetable

// The first step boundary at or after t (s), round-off aside
static uint64_t step_at(double t, double step_length)
{
	double k = ceil(t / step_length - 1e-6);
	return k <= 0 ? 0 : k < 1e18 ? (uint64_t)k : UINT64_MAX;
}

static int by_step(const void *pa, const void *pb)
{
	const event *a = pa, *b = pb;
	if (a->step != b->step)
		return a->step < b->step ? -1 : 1;
	if (a->add != b->add)
		return a->add - b->add;
	return (a->id > b->id) - (a->id < b->id);
}

static void plan_object(ob_population *p, uint32_t id, double step_length)
{
	const ob_object_def *def = &p->scene->object[id];
	uint64_t born = step_at(def->born, step_length), dies = step_at(def->dies, step_length);
	if (born >= dies)
		return;
	p->slots[id] = (slot){ .use = SLOT_RESERVED, .removal_scheduled = dies < UINT64_MAX };
	p->events[p->event_count++] = (event){ .step = born, .id = id, .add = true };
	if (dies < UINT64_MAX)
		p->events[p->event_count++] = (event){ .step = dies, .id = id };
}

ob_population *ob_population_create(const ob_scene *scene, ob_universe *u, ob_roster *r)
{
	double step_length = ob_universe_settings(u)->step_length;
	ob_population *p = calloc(1, sizeof *p);
	if (!p)
		return NULL;
	p->u = u;
	p->roster = r;
	p->scene = scene;
	p->slots = calloc(ob_universe_capacity(u), sizeof *p->slots);
	p->events = calloc(2 * (size_t)scene->objects + 1, sizeof *p->events);
	if (!p->slots || !p->events) {
		ob_population_destroy(p);
		return NULL;
	}
	for (uint32_t i = 0; i < scene->objects; i++)
		plan_object(p, i, step_length);
	qsort(p->events, p->event_count, sizeof *p->events, by_step);
	return p;
}

void ob_population_destroy(ob_population *p)
{
	if (!p)
		return;
	free(p->events);
	free(p->slots);
	free(p);
}
