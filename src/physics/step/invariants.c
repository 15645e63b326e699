#include "step/invariants.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/sanitizer.h"
#include "schedule/calendar.h"
#include "shape/shape.h"
#include "step/broadphase.h"
#include "step/pairs.h"
#include "table/home.h"

// Marks of the places in which a pair was found.
enum { LISTED_BY_A = 1, LISTED_BY_B = 2, IDLE = 4 };

typedef struct check {
	const ob_universe *u;
	const ob_step_data *data;
	ob_invariant_moment when;
	uint32_t ids, pairs;
	unsigned char *found; // [pairs]: LISTED_BY_A ..
	uint32_t *met; // [ids]: 1 + the object whose pair with this one was found last
	uint32_t *near; // [ids]: neighbours of one object
	ob_error *e;
} check;

// ---- messages

enum { NAMED = 120 }; // bytes of "object 4294967295 (" and a name

static const char *name_of(const check *c, uint32_t id, char text[NAMED])
{
	const char *name = id < c->ids ? ob_passport_of(c->u, id)->name : "";
	snprintf(text, NAMED, "object %u%s%.*s%s", id, *name ? " (" : "", OB_NAME_MAX, name, *name ? ")" : "");
	return text;
}

static bool wrong(const check *c, uint32_t id, const char *list, const char *what)
{
	char name[NAMED];
	return ob_fail(c->e, "%s: %s %s", name_of(c, id, name), list, what);
}

static bool wrong_pair(const check *c, uint32_t pair, const char *what)
{
	const ob_pair_key *k = &c->data->pair[pair];
	char a[NAMED], b[NAMED];
	return ob_fail(c->e, "pair %u of %s and %s: %s", pair, name_of(c, k->a, a), name_of(c, k->b, b), what);
}

// ---- objects

static bool is_there(const check *c, uint32_t id)
{
	return id < c->ids && c->data->schedule[id].state != OB_SCHEDULE_ABSENT;
}

static uint32_t kind_of(const ob_passport *p)
{
	return !(p->flags & OB_OBJECT_PRESENT)       ? OB_SCHEDULE_ABSENT
	       : p->flags & OB_OBJECT_KINEMATIC      ? OB_SCHEDULE_KINEMATIC
	       : !(p->flags & OB_OBJECT_STATIC)      ? OB_SCHEDULE_AWAKE
	       : ob_shape_is(p->shape, OB_UNBOUNDED) ? OB_SCHEDULE_PLANE
						     : OB_SCHEDULE_STATIC;
}

static bool check_object(const check *c, uint32_t id)
{
	const ob_schedule *s = &c->data->schedule[id];
	const uint32_t kind = ob_schedule_is_dynamic(s) ? OB_SCHEDULE_AWAKE : s->state;
	const bool elsewhere = s->state == OB_SCHEDULE_ABSENT && ob_universe_unshared(c->u);
	if (s->state > OB_SCHEDULE_EQUILIBRIUM || (kind != kind_of(ob_passport_of(c->u, id)) && !elsewhere))
		return wrong(c, id, "its schedule record", "is not that of its passport");
	if (c->data->pin[id] && !is_there(c, id))
		return wrong(c, id, "the list of moved simulators", "has it, and it is absent");
	if (c->when == OB_INVARIANTS_AFTER_STEP && c->data->result_island[id] != UINT32_MAX && is_there(c, id))
		return wrong(c, id, "an island", "still has it after the step");
	return true;
}

static bool check_objects(const check *c)
{
	uint32_t awake = 0, kinematic = 0;
	for (uint32_t id = 0; id < c->ids; id++) {
		const uint32_t state = c->data->schedule[id].state;
		if (!check_object(c, id))
			return false;
		awake += state == OB_SCHEDULE_AWAKE || state == OB_SCHEDULE_EQUILIBRIUM;
		kinematic += state == OB_SCHEDULE_KINEMATIC;
	}
	// Ranks receive with the next message that other ranks' bodies have woken.
	if (c->when == OB_INVARIANTS_AFTER_STEP && ob_universe_ranks(c->u) < 2 &&
	    (awake != c->data->count->awake || kinematic != c->data->count->kinematic))
		return ob_fail(c->e, "%u objects are awake and %u kinematic: %u and %u are counted", awake, kinematic,
			       c->data->count->awake, c->data->count->kinematic);
	return true;
}

// ---- requery list

static bool is_pending(const check *c, uint32_t id)
{
	return ob_broadphase_query_pending(c->u, id);
}

static bool check_requery_list(const check *c)
{
	uint32_t n, pending = 0;
	const uint32_t *list = ob_requery_list(c->u, &n);
	if (n && c->when != OB_INVARIANTS_AT_RESUME)
		return ob_fail(c->e, "%u objects are still on the requery list", n);
	for (uint32_t i = 0; i < n; i++) {
		if (!is_there(c, list[i]))
			return wrong(c, list[i], "the requery list", "has it, and it is absent");
		if (!is_pending(c, list[i]) || !ob_requery_lists(c->u, list[i]))
			return wrong(c, list[i], "the requery list", "has it without a query pending");
	}
	for (uint32_t id = 0; id < c->ids; id++) {
		pending += is_pending(c, id);
		if (is_pending(c, id) != ob_requery_lists(c->u, id))
			return wrong(c, id, "the requery list", "and its pending query do not agree");
	}
	return pending == n || ob_fail(c->e, "%u queries are pending, and the requery list has %u objects", pending, n);
}

// ---- spatial index

static bool check_place(const check *c, uint32_t id, uint32_t *planes)
{
	const bool plane = c->data->schedule[id].state == OB_SCHEDULE_PLANE;
	const ob_index_place place = ob_index_find(c->u, id);
	*planes += place == OB_INDEX_PLANE;
	if (place == OB_INDEX_BROKEN)
		return wrong(c, id, "the spatial index", "does not find it where it lies");
	if (!is_there(c, id))
		return place == OB_INDEX_NOWHERE || wrong(c, id, "the spatial index", "has it, and it is absent");
	if (is_pending(c, id))
		return true;
	return place == (plane ? OB_INDEX_PLANE : OB_INDEX_CELL) ||
	       wrong(c, id, "the spatial index", "has it elsewhere than its fat AABB is");
}

static bool check_level(const check *c, uint32_t level, const uint32_t *in_level)
{
	const struct ob_step_counts *count = c->data->count;
	uint32_t n = 0, before = 0;
	for (uint32_t link = count->level_first[level]; link; link = c->data->cell[link - 1].after, n++) {
		if (link > c->ids || n == c->ids)
			return ob_fail(c->e, "the spatial index's list of class %u leads nowhere", level);
		if (c->data->cell[link - 1].level != (int32_t)level || c->data->cell[link - 1].before != before)
			return wrong(c, link - 1, "the spatial index's list of its class", "is broken at it");
		before = link;
	}
	return (n == in_level[level] && n == count->levels[level] && !n == !(count->levels_used >> level & 1)) ||
	       ob_fail(c->e, "the spatial index has %u objects of class %u: %u are listed, %u counted", in_level[level],
		       level, n, count->levels[level]);
}

static bool check_index(const check *c)
{
	enum { LEVELS = sizeof c->data->count->levels / sizeof *c->data->count->levels };
	uint32_t planes = 0, in_level[LEVELS] = { 0 };
	for (uint32_t id = 0; id < c->ids; id++) {
		const int32_t level = c->data->cell[id].level;
		if (!check_place(c, id, &planes))
			return false;
		if (level > 0)
			in_level[level]++;
	}
	for (uint32_t level = 0; level < LEVELS; level++)
		if (!check_level(c, level, in_level))
			return false;
	return planes == c->data->count->planes ||
	       ob_fail(c->e, "%u planes exist, and the list of planes has %u", planes, c->data->count->planes);
}

// ---- pairs

// Checks each pair in the object's list: it is the object's, in use, linked back, and there once.
static bool check_list(const check *c, uint32_t id)
{
	const ob_step_data *data = c->data;
	uint32_t before = 0, n = 0;
	for (uint32_t link = data->first_pair[id]; link; n++) {
		const ob_pair_place at = { (link - 1) / 2, (link - 1) % 2 };
		if (at.pair >= c->pairs || n > c->pairs)
			return wrong(c, id, "its list of pairs", "leads nowhere");
		const ob_pair_key *k = &data->pair[at.pair];
		const unsigned char side = at.side ? LISTED_BY_B : LISTED_BY_A;
		const uint32_t other = at.side ? k->a : k->b;
		if (k->a == k->b || (at.side ? k->b : k->a) != id || other >= c->ids)
			return wrong(c, id, "its list of pairs", "has a pair that is not its own");
		if (c->found[at.pair] & side || data->pair_links[at.pair].before[at.side] != before)
			return wrong(c, id, "its list of pairs", "is not linked both ways");
		if (c->met[other] == id + 1 && !ob_pair_parts(k)) // compounds have several
			return wrong(c, id, "its list of pairs", "has two with the same object");
		c->found[at.pair] |= side;
		c->met[other] = id + 1;
		before = link;
		link = data->pair_links[at.pair].next[at.side];
	}
	return true;
}

// True if a joint of the object broke in the last step.
static bool lost_a_joint(const check *c, uint32_t id)
{
	for (uint32_t j = ob_joint_first(c->data, id); j; j = ob_joint_next(c->data, j, id))
		if (ob_joint_broke_now(c->u, j - 1))
			return true;
	return false;
}

// Checks that each object with an overlapping fat AABB has a pair with this one, which check_list has just found.
static bool check_neighbours(const check *c, uint32_t id)
{
	uint64_t tests = 0;
	if (!ob_schedule_is_dynamic(&c->data->schedule[id]) || c->when == OB_INVARIANTS_AT_RESUME ||
	    lost_a_joint(c, id)) // it looks for neighbours before the next step
		return true;
	const uint32_t n = ob_index_query(c->u, id, c->near, c->ids, &tests);
	for (uint32_t i = 0; i < n && i < c->ids; i++)
		if (c->met[c->near[i]] != id + 1 && ob_may_touch(c->u, id, c->near[i]) &&
		    !ob_terrain_of(c->u, ob_passport_of(c->u, c->near[i]))) { // whose regions may all be far
			char other[NAMED];
			return ob_fail(c->e, "object %u: its list of pairs lacks %s, whose fat AABB overlaps its own",
				       id, name_of(c, c->near[i], other));
		}
	return true;
}

static bool check_idle_pairs(const check *c)
{
	uint32_t n = 0;
	for (uint32_t link = c->data->count->first_idle; link; link = c->data->pair_links[link - 1].next[0], n++) {
		const ob_pair_key *k = &c->data->pair[link - 1];
		if (link > c->pairs || k->a != k->b || c->found[link - 1])
			return ob_fail(c->e, "the list of unused pairs is broken at pair %u", link - 1);
		c->found[link - 1] = IDLE;
	}
	return n == c->data->count->pairs_idle ||
	       ob_fail(c->e, "%u pairs are unused, %u are counted", n, c->data->count->pairs_idle);
}

static bool check_pair(const check *c, uint32_t pair)
{
	const ob_step_data *data = c->data;
	const ob_pair_key *k = &data->pair[pair];
	if (k->a == k->b)
		return c->found[pair] == IDLE || ob_fail(c->e, "the list of unused pairs lacks pair %u", pair);
	if (k->a > k->b || !is_there(c, k->a) || !is_there(c, k->b))
		return wrong_pair(c, pair, "one of them is absent");
	if (!ob_schedule_is_dynamic(&data->schedule[k->a]) && !ob_schedule_is_dynamic(&data->schedule[k->b]))
		return wrong_pair(c, pair, "neither is simulated");
	const unsigned char lists = (unsigned char)((ob_has_pairs(data, k->a) ? LISTED_BY_A : 0) |
						    (ob_has_pairs(data, k->b) ? LISTED_BY_B : 0));
	if (c->found[pair] != lists)
		return wrong_pair(c, pair, "it is not in the lists of both");
	return true;
}

static bool check_pairs(const check *c)
{
	if (c->data->count->pairs > c->data->pairs_max)
		return ob_fail(c->e, "there are more pairs than there is room for");
	for (uint32_t id = 0; id < c->ids; id++) {
		if (c->data->first_pair[id] && !ob_has_pairs(c->data, id))
			return wrong(c, id, "its list of pairs", "is not empty, and it is static or absent");
		if (!check_list(c, id) || !check_neighbours(c, id))
			return false;
	}
	if (!check_idle_pairs(c))
		return false;
	for (uint32_t pair = 0; pair < c->pairs; pair++)
		if (!check_pair(c, pair))
			return false;
	return true;
}

// ---- contacts: each record is one pair's, or free

static bool check_records(const check *c, unsigned char *used)
{
	const struct ob_step_counts *count = c->data->count;
	const uint32_t records = count->records_used;
	const int32_t free_ones = count->records_free > 0 ? count->records_free : 0;
	uint32_t taken = 0;
	for (uint32_t pair = 0; pair < c->pairs; pair++) {
		const ob_pair_key *k = &c->data->pair[pair];
		if (k->active && k->record == OB_NO_RECORD)
			return wrong_pair(c, pair, "they touch, and it has no contact");
		if (k->record == OB_NO_RECORD)
			continue;
		if (k->record >= records || used[k->record]++)
			return wrong_pair(c, pair, "its contact is another pair's, or none");
		taken++;
	}
	for (int32_t i = 0; i < free_ones; i++)
		if (c->data->record_free[i] >= records || used[c->data->record_free[i]]++)
			return ob_fail(c->e, "the list of free contacts has contact %u, which is in use",
				       c->data->record_free[i]);
	return taken + (uint32_t)free_ones == records ||
	       ob_fail(c->e, "of %u contacts %u are in use and %d free", records, taken, free_ones);
}

static bool check_contacts(const check *c)
{
	const uint32_t records = c->data->count->records_used;
	if (records > c->data->pairs_max || c->data->count->records_free > (int32_t)records)
		return ob_fail(c->e, "there are more contacts than there is room for");
	unsigned char *used = calloc((size_t)records + 1, sizeof *used);
	const bool fine = !used || check_records(c, used);
	free(used);
	return fine;
}

// ---- islands

static bool check_island(const check *c, uint32_t island)
{
	const ob_step_data *data = c->data;
	const ob_island *is = &data->island[island];
	if (is->members > c->ids || is->first_member > c->ids - is->members || is->pairs > data->pairs_max ||
	    is->first_pair > data->pairs_max - is->pairs)
		return ob_fail(c->e, "the lists of island %u make no sense", island);
	for (uint32_t i = 0; i < is->members; i++) {
		const uint32_t id = data->member[is->first_member + i];
		if (!is_there(c, id) || data->result_island[id] != island ||
		    !ob_schedule_is_dynamic(&data->schedule[id]))
			return wrong(c, id, "an island's list of bodies", "has it, and it is in another or in none");
	}
	for (uint32_t i = 0; i < is->pairs; i++)
		if (data->island_pair[is->first_pair + i] >= c->pairs)
			return ob_fail(c->e, "the list of pairs of island %u leads nowhere", island);
	return true;
}

static bool check_islands(const check *c)
{
	const uint32_t islands = c->data->count->islands;
	if (c->when != OB_INVARIANTS_AFTER_MERGE || ob_gate_phase(c->u) != OB_PHASE_BROADPHASE)
		return true;
	if (islands > c->ids)
		return ob_fail(c->e, "there are more islands than objects");
	for (uint32_t i = 0; i < islands; i++)
		if (!check_island(c, i))
			return false;
	return true;
}

// ---- calendars

// Checks that the steps of upper levels are no later than those of the levels below.
static bool check_levels(const check *c, const ob_calendar *of, const char *list)
{
	for (uint32_t i = 0; i < of->end; i++)
		if (of->level.of_64[i / 64] < of->level.one[i] || of->level.of_4096[i / 4096] < of->level.of_64[i / 64])
			return ob_fail(c->e, "%s hides what is due at entry %u", list, i);
	return true;
}

static bool check_calendars(const check *c)
{
	const ob_calendar solve = ob_calendar_of_objects(c->u), look = ob_calendar_of_pairs(c->u);
	const bool alone = ob_universe_ranks(c->u) < 2;
	for (uint32_t id = 0; id < c->ids; id++) {
		const ob_schedule *s = &c->data->schedule[id];
		const uint32_t due = ob_schedule_is_dynamic(s) ? s->due : UINT32_MAX,
			       entry = UINT32_MAX - solve.level.one[id];
		if (entry != due && (alone || entry != UINT32_MAX))
			return wrong(c, id, "the calendar of objects", "has another step than it is due in");
	}
	for (uint32_t pair = 0; pair < c->pairs; pair++)
		if (c->data->pair[pair].a == c->data->pair[pair].b && look.level.one[pair])
			return ob_fail(c->e, "the calendar of pairs has pair %u, which is not in use", pair);
	return check_levels(c, &solve, "the calendar of objects") && check_levels(c, &look, "the calendar of pairs");
}

// ---- scripts

static bool check_scripts(const check *c)
{
	const ob_step_data *data = c->data;
	for (uint32_t cell = 0; cell < data->script_cells; cell++) {
		const ob_script_turn *t = &data->script_turn[cell];
		if (!t->script)
			continue;
		if (cell >= data->script_counts->cells || !is_there(c, t->object) ||
		    ob_passport_of(c->u, t->object)->generation != t->generation ||
		    data->script_of[t->object] != cell + 1)
			return wrong(c, t->object, "the list of scripts", "has it, and it is absent or another's");
	}
	for (uint32_t id = 0; data->script_cells && id < c->ids; id++) {
		const uint32_t cell = data->script_of[id];
		if (cell && (cell > data->script_cells || !data->script_turn[cell - 1].script ||
			     data->script_turn[cell - 1].object != id))
			return wrong(c, id, "its script's cell", "is another's");
	}
	return true;
}

// ---- all of them

static bool check_all(const check *c)
{
	const bool ode = ob_universe_settings(c->u)->monolith; // its world finds pairs and contacts by itself
	return check_objects(c) && check_scripts(c) &&
	       (ode || (check_requery_list(c) && check_index(c) && check_pairs(c) && check_contacts(c) &&
			check_islands(c) && check_calendars(c)));
}

bool ob_invariants_hold(const ob_universe *u, ob_invariant_moment when, ob_error *e)
{
	const ob_step_data *data = ob_universe_step_data(u);
	check c = {
		.u = u, .data = data, .when = when, .ids = ob_universe_ids(u), .pairs = ob_pairs_end(data), .e = e
	};
	c.found = calloc((size_t)c.pairs + 1, sizeof *c.found);
	c.met = calloc((size_t)c.ids + 1, sizeof *c.met);
	c.near = calloc((size_t)c.ids + 1, sizeof *c.near);
	const bool fine = !c.found || !c.met || !c.near || check_all(&c);
	free(c.found);
	free(c.met);
	free(c.near);
	return fine;
}

// True if the universe is checked now. With a sanitizer, large universes are not checked at each step, so that tests
// end.
static bool is_checked(const ob_universe *u)
{
	enum { EACH_STEP = 1024 }; // objects and pairs that are checked per step, on average
	const uint64_t size = ob_universe_ids(u) + (uint64_t)ob_pairs_end(ob_universe_step_data(u));
	return ob_universe_checked(u) || (OB_SANITIZED && ob_step_count(u) % (1 + size / EACH_STEP) == 0);
}

bool ob_invariants_check(ob_universe *u, ob_invariant_moment when)
{
	ob_error e;
	if (!is_checked(u) || ob_step_failed(u, NULL) != OB_STEP_OK || ob_invariants_hold(u, when, &e))
		return true;
	ob_step_break(u, e.text);
	return false;
}
