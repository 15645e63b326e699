#include "free/world.h"

#include <stdlib.h>
#include <string.h>

#include "schedule/pair_checks.h"
#include "step/fault.h"
#include "step/pairs.h"

bool ob_group_world_begin(ob_group_world *w, ob_universe *shared, uint32_t worker, ob_error *e)
{
	const uint32_t capacity = ob_universe_capacity(shared);
	ob_universe_setup setup = { .unshared = true,
				    .capacity = capacity,
				    .workers = 1,
				    .hulls = ob_universe_hulls(shared),
				    .isolation = "thread",
				    .run = *ob_universe_settings(shared),
				    .terrains = ob_universe_terrains(shared) };
	setup.run.one_per_object = setup.run.timed = 0;
	setup.run.fault = (ob_fault_plan){ .probability = 0 };
	uint64_t faults[OB_FAULT_KINDS] = { 0 };
	ob_universe_faults(shared, faults);
	*w = (ob_group_world){ .shared = shared, .worker = worker };
	for (int kind = 0; kind < OB_FAULT_KINDS; kind++) // a successor does not fail at the same place for ever
		w->fault_chances += faults[kind] << 24;
	w->passport = calloc(capacity, sizeof *w->passport);
	w->held = calloc(capacity, sizeof *w->held);
	w->place = calloc(capacity, sizeof *w->place);
	w->contact = calloc(OB_GROUP_CONTACTS, sizeof *w->contact);
	w->changed = calloc(capacity, sizeof *w->changed);
	w->told = calloc(capacity, sizeof *w->told);
	w->box = calloc(capacity, sizeof *w->box);
	w->queried = calloc(capacity, sizeof *w->queried);
	w->counted = calloc(capacity, sizeof *w->counted);
	w->u = ob_universe_create(&setup, e);
	w->known = w->u ? calloc(ob_universe_step_data(w->u)->pairs_max, sizeof *w->known) : NULL;
	if (!w->passport || !w->held || !w->place || !w->contact || !w->changed || !w->told || !w->box || !w->queried ||
	    !w->counted || !w->known)
		return ob_fail(e, "worker %u: no memory", worker);
	w->sim = ob_sim_create(w->u, 0, e);
	return w->sim;
}

void ob_group_world_finish(ob_group_world *w)
{
	ob_sim_destroy(w->sim);
	ob_universe_destroy(w->u, false);
	free(w->passport);
	free(w->held);
	free(w->place);
	free(w->contact);
	free(w->changed);
	free(w->told);
	free(w->box);
	free(w->queried);
	free(w->counted);
	free(w->known);
}

void ob_group_world_chance(ob_group_world *w)
{
	ob_fault_chance_of(w->shared, w->worker, &w->fault_chances);
}

// ---- objects

static void forget(ob_group_world *w, uint32_t id)
{
	const uint32_t at = w->place[id] - 1, last = w->held[--w->n];
	w->held[at] = last;
	w->place[last] = at + 1;
	w->place[id] = 0;
}

static void remember(ob_group_world *w, uint32_t id)
{
	w->held[w->n++] = id;
	w->place[id] = w->n;
}

static bool moves_here(const ob_passport *p)
{
	return p->flags & OB_OBJECT_PRESENT && !(p->flags & OB_OBJECT_PRESCRIBED);
}

bool ob_group_world_knows(const ob_group_world *w, uint32_t id)
{
	ob_passport p;
	return w->passport[id] && ob_universe_get_passport(w->shared, id, &p) &&
	       p.generation == ob_passport_of(w->u, id)->generation;
}

static bool is_here(const ob_group_world *w, uint32_t id)
{
	return ob_universe_step_data(w->u)->schedule[id].state != OB_SCHEDULE_ABSENT;
}

// Takes over a static or kinematic object as the host has placed it, with its motion. It looks for neighbours if bodies are here: those
// that come later bring their pairs with it.
static void adopt_prescribed(ob_group_world *w, uint32_t id)
{
	const ob_step_data *from = ob_universe_step_data(w->shared), *to = ob_universe_step_data(w->u);
	const ob_motion *m = ob_newest_motion(w->shared, id);
	const bool here = is_here(w, id),
		   looks = w->n && (!here || memcmp(to->bounds[id], from->bounds[id], sizeof *to->bounds));
	ob_taken_object o = { .id = id, .neighbours = looks ? UINT32_MAX : 0, .before = *m, .motion = *m };
	if (!here)
		ob_sim_place(w->u, id, &(ob_state){ { m->p, m->q }, m->v, m->w });
	ob_requery_drop(w->u, id);
	to->neighbours[id].count = 0;
	o.schedule = from->schedule[id];
	memcpy(o.bounds, from->bounds[id], sizeof o.bounds);
	ob_sim_take_in(w->u, &o);
	ob_pairs_look(w->u, id);
}

static void adopt(ob_group_world *w, uint32_t id)
{
	ob_passport p;
	const uint64_t version = ob_universe_get_passport_version(w->shared, id);
	const bool changed = version != w->passport[id];
	if (!version)
		return;
	if (!ob_universe_get_passport(w->shared, id, &p))
		p = (ob_passport){ .id = id };
	if (changed) {
		const ob_passport *was = w->passport[id] ? ob_passport_of(w->u, id) : NULL;
		const bool gone = was && was->flags & OB_OBJECT_PRESENT &&
				  (!(p.flags & OB_OBJECT_PRESENT) || was->generation != p.generation ||
				   moves_here(was) != moves_here(&p));
		if (gone && ob_universe_step_data(w->u)->schedule[id].state != OB_SCHEDULE_ABSENT)
			ob_sim_remove(w->u, id);
		if (gone && ob_group_world_has(w, id))
			forget(w, id);
		const ob_hull *hull = p.flags & OB_OBJECT_PRESENT ? ob_hull_of(w->shared, &p) : NULL;
		for (uint32_t part = 0; hull && part <= ob_parts_of(w->shared, &p); part++)
			ob_write_hull(w->u, p.hull + part, ob_hull_at(w->shared, p.hull + part));
		ob_write_passport(w->u, id, &p);
		if (ob_group_world_has(w, id))
			ob_sim_push(w->u, id, p.force, true);
		w->passport[id] = version;
	}
	const bool fixed = p.flags & OB_OBJECT_PRESENT && !moves_here(&p);
	if (fixed && (changed || p.flags & OB_OBJECT_KINEMATIC))
		adopt_prescribed(w, id);
}

static void take(ob_group_world *w, uint32_t id)
{
	ob_taken_object o = { .id = id };
	ob_group_state s;
	ob_group_take_back(w->shared, id, w->step);
	ob_group_get(w->shared, id, &o.motion, &s, w->contact);
	if (!w->step || !ob_group_read(w->shared, id, w->step - 1, &o.before, NULL))
		o.before = o.motion;
	o.schedule = s.schedule;
	o.neighbours = s.neighbours;
	memcpy(o.bounds, s.bounds, sizeof o.bounds);
	memcpy(w->box[id], s.bounds, sizeof s.bounds);
	w->queried[id] = s.queried;
	w->counted[id] = s.neighbours;
	ob_sim_take_in(w->u, &o);
	remember(w, id);
}

// Takes in the pairs of a body with bodies that are here: each with the lower one of two that move.
static void take_pairs(ob_group_world *w, uint32_t id)
{
	ob_motion m;
	ob_group_state s;
	ob_group_get(w->shared, id, &m, &s, w->contact);
	for (uint32_t i = 0; i < s.contacts; i++) {
		const ob_group_contact *c = &w->contact[i];
		if (is_here(w, c->key.a) && is_here(w, c->key.b))
			ob_pairs_take_in(w->u, &c->key, c->key.record == OB_NO_RECORD ? NULL : &c->state, c->impulse_b,
					 c->stamp, c->check);
	}
}

void ob_group_world_take(ob_group_world *w, const uint32_t *id, uint32_t n)
{
	if (w->n == 0 && n > 0) {
		w->step = ob_group_place_of(w->shared, id[0]).step;
		ob_step_set(w->u, w->step);
		ob_group_make(w->shared, w->worker, w->step, 0);
	}
	for (uint32_t i = 0; i < n; i++)
		take(w, id[i]);
	for (uint32_t i = 0; i < n; i++)
		take_pairs(w, id[i]);
	for (uint32_t i = 0; i < n; i++)
		ob_sim_meet(w->sim, id[i], w->queried);
	for (uint32_t i = 0; i < n; i++) {
		ob_group_world_chance(w);
		ob_group_hold(w->shared, id[i], (ob_group_place){ .worker = w->worker, .step = w->step });
	}
}

void ob_group_world_park(ob_group_world *w, const uint32_t *id, uint32_t n, uint32_t worker)
{
	for (uint32_t i = 0; i < n; i++) {
		ob_sim_hand_out(w->u, id[i]);
		forget(w, id[i]);
	}
	for (uint32_t i = 0; i < n; i++) {
		ob_group_world_chance(w);
		ob_group_park(w->shared, id[i], (ob_group_place){ .worker = w->worker, .held = true }, worker, w->step);
	}
	if (!w->n)
		ob_group_make(w->shared, w->worker, OB_GROUP_EMPTY, 0);
}

// ---- the step

const uint32_t *ob_group_world_neighbours(ob_group_world *w, uint32_t id, uint32_t *n)
{
	const ob_step_data *data = ob_universe_step_data(w->u);
	ob_pair_place at;
	*n = 0;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		const uint32_t other = at.side ? data->pair[at.pair].a : data->pair[at.pair].b;
		if (ob_schedule_is_dynamic(&data->schedule[other]) && *n < data->objects_max)
			w->changed[(*n)++] = other; // parts have several pairs
	}
	return w->changed;
}

// Body with which a pair is published: the lower one of two that move.
static uint32_t listed_with(const ob_step_data *data, const ob_pair_key *k)
{
	return ob_schedule_is_dynamic(&data->schedule[k->a]) ? k->a : k->b;
}

// Lists the pairs that are published with the body. Returns false if there are too many.
static bool list_contacts(const ob_group_world *w, uint32_t id, uint32_t *contacts)
{
	const ob_step_data *data = ob_universe_step_data(w->u);
	ob_pair_place at;
	*contacts = 0;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at)) {
		const ob_pair_key *k = &data->pair[at.pair];
		if (listed_with(data, k) != id)
			continue;
		if (*contacts == OB_GROUP_CONTACTS)
			return false;
		ob_group_contact *c = &w->contact[(*contacts)++];
		c->key = *k;
		c->key.record = OB_NO_RECORD;
		c->check = ob_pairs_next_check(data, at.pair);
		c->stamp = 0;
		if (!k->active) // the next step would release a record
			continue;
		const ob_pair_record *r = &data->record[k->record];
		const int newest = r->stamp[1] > r->stamp[0];
		c->key.record = 0;
		c->state = r->version[newest];
		c->stamp = r->stamp[newest];
		if (data->impulse_b)
			memcpy(c->impulse_b, data->impulse_b[k->record][newest], sizeof c->impulse_b);
	}
	return true;
}

static bool publish(ob_group_world *w, uint32_t id, uint32_t step)
{
	const ob_step_data *data = ob_universe_step_data(w->u);
	if (memcmp(w->box[id], data->bounds[id], sizeof *w->box) != 0) { // it has looked for neighbours since
		memcpy(w->box[id], data->bounds[id], sizeof *w->box);
		w->queried[id] = step;
	}
	ob_group_state s = { .schedule = data->schedule[id],
			     .neighbours = data->neighbours[id].count,
			     .step = step,
			     .queried = w->queried[id] };
	w->counted[id] = s.neighbours;
	memcpy(s.bounds, data->bounds[id], sizeof s.bounds);
	if (!list_contacts(w, id, &s.contacts)) {
		ob_step_fail(w->shared, OB_STEP_PAIRS_FULL, id);
		return false;
	}
	ob_group_world_chance(w);
	return ob_group_put(w->shared, id, ob_newest_motion(w->u, id), &s, w->contact);
}

void ob_group_world_adopt(ob_group_world *w)
{
	ob_error e;
	const uint32_t ids = ob_universe_ids(w->shared);
	if (!ob_universe_reserve(w->u, ids, &e)) {
		ob_step_fail(w->shared, OB_STEP_MEMORY_FULL, 0);
		return;
	}
	if (w->n == 0) // what stands still is placed at the present step
		ob_step_set(w->u, w->step = (uint32_t)ob_step_count(w->shared));
	for (uint32_t id = 0; id < ids; id++)
		adopt(w, id);
	for (uint32_t i = 0; i < w->n; i++) // some have been woken
		publish(w, w->held[i], w->step);
}

static void note_changed(ob_group_world *w, uint32_t id, uint32_t *n)
{
	if (!w->place[id] || w->told[id] == w->step + 1)
		return;
	w->told[id] = w->step + 1;
	w->changed[(*n)++] = id;
}

// Lists the bodies that the step has solved, those of which a pair has begun, ended or been checked, and those that have met others.
static uint32_t list_changed(ob_group_world *w)
{
	const ob_step_data *data = ob_universe_step_data(w->u);
	uint32_t n = 0;
	for (uint32_t i = 0; i < data->count->islands; i++)
		for (uint32_t k = 0; k < data->island[i].members; k++)
			note_changed(w, data->member[data->island[i].first_member + k], &n);
	for (uint32_t i = 0; i < w->n; i++)
		if (data->neighbours[w->held[i]].count != w->counted[w->held[i]])
			note_changed(w, w->held[i], &n);
	const uint32_t end = ob_pairs_end(data);
	w->pairs = end > w->pairs ? end : w->pairs;
	for (uint32_t i = 0; i < w->pairs; i++) {
		const ob_pair_key *k = &data->pair[i];
		ob_group_pair *known = &w->known[i];
		const uint32_t check = ob_pairs_next_check(data, i);
		if (check == known->check && memcmp(k, &known->key, sizeof *k) == 0)
			continue;
		if (known->key.a != known->key.b)
			note_changed(w, listed_with(data, &known->key), &n);
		if (k->a != k->b)
			note_changed(w, listed_with(data, k), &n);
		*known = (ob_group_pair){ *k, check };
	}
	return n;
}

bool ob_group_world_step(ob_group_world *w)
{
	uint32_t object;
	ob_gate_set_pause_step(w->u, w->step + 1);
	ob_sim_resume(w->u);
	while (!ob_gate_host_wait(w->u, 0) && ob_step(w->sim))
		;
	const ob_step_failure why = ob_step_failed(w->u, &object);
	if (why != OB_STEP_OK) {
		ob_step_fail(w->shared, why, object);
		return false;
	}
	const uint32_t n = list_changed(w);
	for (uint32_t i = 0; i < n; i++)
		if (!publish(w, w->changed[i], w->step + 1))
			return false;
	ob_group_world_chance(w);
	ob_group_make(w->shared, w->worker, ++w->step, n);
	ob_counters_copy(ob_worker_counters(w->shared, w->worker), ob_worker_counters(w->u, 0));
	return true;
}
