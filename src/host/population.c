#include "host/population.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "ode/ode_body.h"
#include "sim/sim.h"

typedef struct event {
	uint64_t step;
	uint32_t id;
	bool birth; // else it dies
} event;

// Kept: empty, but an event of the timetable is still to come for it.
typedef enum slot_use { SLOT_FREE, SLOT_KEPT, SLOT_PRESENT } slot_use;

typedef struct slot {
	uint32_t generation; // of its latest object
	unsigned char use; // slot_use
	bool mortal; // the timetable holds the death of its object
} slot;

struct ob_population {
	ob_universe *u;
	ob_roster *roster;
	const ob_scene *scene;
	slot *slots; // [capacity]
	event *events; // ascending by step; at one step deaths first
	size_t event_count, next;
	bool changed;
};

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

static void put(ob_population *p, uint32_t id, const ob_object_def *def)
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

static void take_away(ob_population *p, uint32_t id)
{
	slot *s = &p->slots[id];
	if (s->use != SLOT_PRESENT)
		return;
	ob_sim_remove(p->u, id);
	s->use = s->mortal ? SLOT_KEPT : SLOT_FREE; // or its death would strike the slot's next object
	p->changed = true;
}

static void die(ob_population *p, uint32_t id)
{
	p->slots[id].mortal = false;
	take_away(p, id);
	p->slots[id].use = SLOT_FREE;
}

static void add_on_request(ob_population *p, const ob_object_def *def)
{
	uint32_t capacity = ob_universe_capacity(p->u);
	for (uint32_t id = 0; id < capacity; id++) {
		if (p->slots[id].use == SLOT_FREE) {
			put(p, id, def);
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
		if (due->birth)
			put(p, due->id, &p->scene->object[due->id]);
		else
			die(p, due->id);
	}
	while (ob_requests_take(q, &r)) {
		if (r.add)
			add_on_request(p, &r.def);
		else if (r.id < ob_universe_capacity(p->u))
			take_away(p, r.id);
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

// ---- the scene's timetable

// The first step boundary that is not before t (s), but for round-off
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
	if (a->birth != b->birth)
		return a->birth - b->birth;
	return (a->id > b->id) - (a->id < b->id);
}

static void schedule(ob_population *p, uint32_t id, double step_length)
{
	const ob_object_def *def = &p->scene->object[id];
	uint64_t born = step_at(def->born, step_length), dies = step_at(def->dies, step_length);
	if (born >= dies)
		return;
	p->slots[id] = (slot){ .use = SLOT_KEPT, .mortal = dies < UINT64_MAX };
	p->events[p->event_count++] = (event){ .step = born, .id = id, .birth = true };
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
		schedule(p, i, step_length);
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
