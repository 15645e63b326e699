#include "step/pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "exchange/results.h"
#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "shape/shape.h"
#include "step/broadphase.h"
#include "step/publish.h"
#include "step/prefetch.h"
#include "step/sort_ids.h"
#include "step/terrain.h"

// ---- lists

// Writes a link where it belongs: into the place before it, or at the start of the list.
static void put_link(ob_step_data *data, uint32_t id, uint32_t before, uint32_t link)
{
	ob_pair_place at;
	if (ob_pair_at(data, before, &at))
		data->pair_links[at.pair].next[at.side] = link;
	else
		data->first_pair[id] = link;
}

static void link_side(ob_step_data *data, uint32_t pair, uint32_t side, uint32_t id)
{
	const uint32_t first = data->first_pair[id], link = 1 + 2 * pair + side;
	ob_pair_place at;
	data->pair_links[pair].next[side] = first;
	data->pair_links[pair].before[side] = 0;
	if (ob_pair_at(data, first, &at))
		data->pair_links[at.pair].before[at.side] = link;
	data->first_pair[id] = link;
}

static void unlink_side(ob_step_data *data, uint32_t pair, uint32_t side, uint32_t id)
{
	const uint32_t next = data->pair_links[pair].next[side], before = data->pair_links[pair].before[side];
	ob_pair_place at;
	if (ob_pair_at(data, next, &at))
		data->pair_links[at.pair].before[at.side] = before;
	put_link(data, id, before, next);
}

static void link_pair(ob_universe *u, uint32_t pair)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_pair_key *k = &data->pair[pair];
	for (uint32_t side = 0; side < 2; side++)
		if (ob_has_pairs(data, side ? k->b : k->a))
			link_side(data, pair, side, side ? k->b : k->a);
}

static void put_aside(ob_step_data *data, uint32_t pair)
{
	data->pair[pair] = (ob_pair_key){ .record = OB_NO_RECORD };
	data->pair_links[pair] = (ob_pair_links){ .next = { data->count->first_idle } };
	data->count->first_idle = 1 + pair;
	data->count->pairs_idle++;
}

static void drop_pair(ob_universe *u, uint32_t pair)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	const ob_pair_key *k = &data->pair[pair];
	for (uint32_t side = 0; side < 2; side++)
		if (ob_has_pairs(data, side ? k->b : k->a))
			unlink_side(data, pair, side, side ? k->b : k->a);
	ob_calendar_set(&look, pair, UINT32_MAX);
	put_aside(data, pair);
}

// Takes a pair that is not in use. false: there is none, and the step has failed.
static bool take_pair(ob_universe *u, uint32_t *pair)
{
	ob_step_data *data = ob_universe_step_data(u);
	if (data->count->first_idle) {
		*pair = data->count->first_idle - 1;
		if (*pair < data->pairs_max) {
			data->count->first_idle = data->pair_links[*pair].next[0];
			data->count->pairs_idle--;
			return true;
		}
		data->count->failure = OB_STEP_DAMAGED;
		return false;
	}
	*pair = data->count->pairs;
	if (*pair >= data->pairs_max)
		ob_step_fail(u, OB_STEP_PAIRS_FULL, 0);
	else if (!ob_reserve_pairs(u, *pair, 1))
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
	else
		return data->count->pairs++, true;
	return false;
}

void ob_pairs_link(ob_universe *u)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint64_t step = ob_step_count(u);
	const uint32_t ids = ob_universe_ids(u);
	const ob_calendar solve = ob_calendar_of_objects(u), look = ob_calendar_of_pairs(u);
	ob_calendar_clear(&solve);
	ob_calendar_clear(&look);
	data->count->first_idle = data->count->pairs_idle = data->count->island_pairs = data->count->checks = 0;
	memset(data->first_pair, 0, ids * sizeof *data->first_pair);
	for (uint32_t id = 0; id < ids; id++)
		ob_calendar_enter_due(u, id);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->a == k->b) {
			put_aside(data, i);
			continue;
		}
		link_pair(u, i);
		ob_pair_enter_check(u, i, step);
		if (k->in_island || k->record != OB_NO_RECORD)
			data->island_pair[data->count->island_pairs++] = i;
	}
}

// Drops all pairs of an object. The host calls it, too, and for static objects: so it searches all pairs.
void ob_pairs_drop(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		ob_pair_key *k = &data->pair[i];
		if (k->a == k->b || (k->a != id && k->b != id) || !ob_object_in_range(data, k->a) ||
		    !ob_object_in_range(data, k->b))
			continue;
		ob_pair_release_record(u, k);
		drop_pair(u, i);
	}
}

void ob_pairs_drop_listed(ob_universe *u, uint32_t id)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_pair_place at;
	while (ob_pair_at(data, data->first_pair[id], &at)) {
		ob_pair_release_record(u, &data->pair[at.pair]);
		drop_pair(u, at.pair);
	}
}

void ob_pairs_take_in(ob_universe *u, const ob_pair_key *key, const ob_pair_state *before, const double *impulse_b,
		      uint32_t stamp, uint32_t check)
{
	ob_step_data *data = ob_universe_step_data(u);
	const ob_calendar look = ob_calendar_of_pairs(u);
	uint32_t pair;
	if (!take_pair(u, &pair))
		return;
	ob_pair_key *k = &data->pair[pair];
	*k = *key;
	k->record = before ? ob_record_take(u) : OB_NO_RECORD;
	k->late = k->in_island = 0;
	if (k->record != OB_NO_RECORD) {
		ob_pair_record *r = &data->record[k->record];
		r->version[0] = *before;
		r->stamp[0] = stamp;
		if (data->impulse_b && impulse_b)
			memcpy(data->impulse_b[k->record][0], impulse_b, sizeof data->impulse_b[k->record][0]);
	}
	link_pair(u, pair);
	ob_calendar_set(&look, pair, check);
}

uint32_t ob_pairs_next_check(const ob_step_data *data, uint32_t pair)
{
	return UINT32_MAX - data->look.one[pair]; // calendar.c
}

// ---- new pairs

static double plane_distance(const ob_universe *u, uint32_t plane, ob_vec3 at, double sphere)
{
	const ob_motion *m = ob_newest_motion(u, plane);
	ob_mat3 r = ob_quat_matrix(m->q);
	return ob_dot(ob_column(&r, 2), ob_sub(at, m->p)) - sphere;
}

// Lower bound of the distance between two objects (m): from their boxes and bounding spheres, or a sphere and a plane.
static double pair_distance(const ob_universe *u, const ob_pair_key *k, uint64_t steps)
{
	const uint32_t a = k->a, b = k->b;
	const ob_passport *pa = ob_passport_of(u, a), *pb = ob_passport_of(u, b);
	const ob_motion *ma = ob_result_of(u, a), *mb = ob_result_of(u, b);
	// Axis-aligned boxes reach beyond the bounding sphere.
	const double reach = ob_universe_settings(u)->narrow_phase == OB_NARROW_AABB ? sqrt(3) : 1;
	double ra = reach * ob_shape_radius(pa->shape, pa->size), rb = reach * ob_shape_radius(pb->shape, pb->size);
	ob_vec3 centre_a = ob_centre_now(u, a, ma, steps), centre_b = ob_centre_now(u, b, mb, steps);
	if (ob_shape_is(pa->shape, OB_UNBOUNDED))
		return plane_distance(u, a, centre_b, rb);
	if (ob_shape_is(pb->shape, OB_UNBOUNDED))
		return plane_distance(u, b, centre_a, ra);
	double spheres = ob_norm(ob_sub(centre_a, centre_b)) - ra - rb;
	if (spheres > ob_max(ra, rb)) // boxes would not add much, and cost more
		return spheres;
	double box_a[6], box_b[6], distance = 0;
	ob_tight_aabb(u, pa, ob_state_now(u, a, ma, steps).pose, box_a);
	ob_tight_aabb(u, pb, ob_state_now(u, b, mb, steps).pose, box_b);
	if (k->region)
		ob_terrain_region_bounds(u, k, ob_terrain_is_first(u, k) ? box_a : box_b);
	for (int c = 0; c < 3; c++)
		distance = ob_max(distance, ob_max(box_a[c] - box_b[3 + c], box_b[c] - box_a[3 + c]));
	return ob_max(distance, spheres);
}

// Path of both together in the solved step, if there is one (m).
static double path_in_step(const ob_universe *u, uint32_t a, uint32_t b, double paths, uint64_t steps)
{
	const uint64_t step = ob_step_count(u);
	return steps > step
		       ? paths - ob_path_now(ob_newest_motion(u, a), step) - ob_path_now(ob_newest_motion(u, b), step)
		       : 0;
}

double ob_pair_first_limit(const ob_universe *u, const ob_pair_key *k, uint64_t steps)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t a = k->a, b = k->b;
	double distance = pair_distance(u, k, steps);
	double paths = ob_schedule_path(&data->schedule[a], steps) + ob_schedule_path(&data->schedule[b], steps);
	// They may have touched in the solved step if they moved farther in it than their distance.
	return distance > path_in_step(u, a, b, paths, steps) ? paths + distance : -1;
}

static void add_pair(ob_universe *u, const ob_pair_key *key, uint64_t steps)
{
	ob_step_data *data = ob_universe_step_data(u);
	uint32_t pair;
	if (!take_pair(u, &pair))
		return;
	data->pair[pair] = *key;
	link_pair(u, pair);
	ob_pair_enter_check(u, pair, steps); // check at once
	if (data->count->checks < data->pairs_max)
		data->check[data->count->checks++] = pair;
}

// Returns the index of "wanted" in id[], which ascends; n: it is not there.
static uint32_t place_of(const uint32_t *id, uint32_t n, uint32_t wanted)
{
	uint32_t first = 0, end = n;
	while (first < end) {
		const uint32_t middle = first + (end - first) / 2;
		if (id[middle] < wanted)
			first = middle + 1;
		else
			end = middle;
	}
	return first < n && id[first] == wanted ? first : n;
}

// Adds a pair for each part of a compound, or one if it is none. k: the rest of their key.
static void add_part_pairs(ob_universe *u, ob_pair_key k, uint32_t of_a, uint32_t of_b, uint64_t steps)
{
	for (uint32_t i = of_a > 0; i <= of_a; i++)
		for (uint32_t j = of_b > 0; j <= of_b; j++) {
			k.part_a = i & OB_HULL_PARTS_MAX, k.part_b = j & OB_HULL_PARTS_MAX;
			add_pair(u, &k, steps);
		}
}

// Marks the regions, of n that ascend, with which the object has a pair already; ends other pairs with that terrain, but
// for those with a record.
static void keep_regions(ob_universe *u, uint32_t terrain, uint32_t id, const uint32_t *region, uint32_t n, bool *had)
{
	ob_step_data *data = ob_universe_step_data(u);
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id], next; ob_pair_at(data, link, &at); link = next) {
		const ob_pair_key *k = &data->pair[at.pair];
		next = ob_pair_next(data, at);
		if ((at.side ? k->a : k->b) != terrain)
			continue;
		const uint32_t place = place_of(region, n, k->region - 1u);
		if (place < n)
			had[place] = true;
		else if (k->record == OB_NO_RECORD && !data->count->merged)
			drop_pair(u, at.pair);
	}
}

// Renews the pairs of an object with a terrain: one for each region near its fat AABB.
static void renew_regions(ob_universe *u, uint32_t terrain, uint32_t id, uint64_t steps)
{
	enum { USUALLY = 256 };
	uint32_t few[USUALLY], *region = few, n = ob_terrain_near(u, terrain, id, few, USUALLY);
	if (n > USUALLY) {
		region = ob_allocate(n * sizeof *region);
		n = ob_terrain_near(u, terrain, id, region, n);
	}
	bool *had = ob_allocate_zeroed(n + 1);
	const bool first = terrain < id;
	const uint32_t parts = ob_parts_of(u, ob_passport_of(u, id));
	ob_pair_key k = { .a = first ? terrain : id, .b = first ? id : terrain, .record = OB_NO_RECORD, .limit = NAN };
	keep_regions(u, terrain, id, region, n, had);
	for (uint32_t i = 0; i < n; i++) {
		k.region = (region[i] + 1) & OB_TERRAIN_REGIONS_MAX;
		if (!had[i])
			add_part_pairs(u, k, first ? 0 : parts, first ? parts : 0, steps);
	}
	free(had);
	if (region != few)
		free(region);
}

// Number of parts that each have a pair with a plane: if any of them is round. 0: the hull of all parts has one.
static uint32_t parts_on_plane(const ob_universe *u, const ob_passport *p)
{
	const ob_hull *h = ob_hull_of(u, p);
	return h && h->round ? ob_parts_of(u, p) : 0;
}

// Adds a pair of the two, or one for each part of a compound.
static void add_pairs(ob_universe *u, uint32_t id, uint32_t other, uint64_t steps)
{
	ob_pair_key k = {
		.a = id < other ? id : other, .b = id < other ? other : id, .record = OB_NO_RECORD, .limit = NAN
	};
	const ob_passport *a = ob_passport_of(u, k.a), *b = ob_passport_of(u, k.b);
	if (ob_terrain_of(u, a) || ob_terrain_of(u, b)) {
		renew_regions(u, ob_terrain_of(u, a) ? k.a : k.b, ob_terrain_of(u, a) ? k.b : k.a, steps);
		return;
	}
	const bool plane = ob_shape_is(a->shape, OB_UNBOUNDED) || ob_shape_is(b->shape, OB_UNBOUNDED);
	uint32_t (*const parts_of)(const ob_universe *u, const ob_passport *p) = plane ? parts_on_plane : ob_parts_of;
	add_part_pairs(u, k, parts_of(u, a), parts_of(u, b), steps);
}

void ob_pairs_begin(ob_universe *u, uint32_t a, uint32_t b, uint64_t steps)
{
	ob_universe_step_data(u)->count->checks = 0;
	add_pairs(u, a, b, steps);
}

bool ob_pairs_have(const ob_step_data *data, uint32_t id, uint32_t other)
{
	ob_pair_place at;
	bool found = false;
	for (uint32_t link = data->first_pair[id]; !found && ob_pair_at(data, link, &at); link = ob_pair_next(data, at))
		found = (at.side ? data->pair[at.pair].a : data->pair[at.pair].b) == other;
	return found;
}

void ob_pairs_measure(ob_universe *u, uint64_t steps)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t fresh = ob_checks_count(data);
	for (uint32_t i = 0; i < fresh; i++) {
		ob_pair_key *k = &data->pair[data->check[i]];
		if (k->a != k->b)
			k->limit = ob_pair_is_known_here(u, k) ? ob_pair_first_limit(u, k, steps) : -INFINITY;
	}
}

// ---- queries

static bool is_immobile(const ob_step_data *data, uint32_t id)
{
	return !ob_schedule_is_dynamic(&data->schedule[id]);
}

// True if this object decides about the pair. If both were queried and found each other, the lower id does.
static bool decides(const ob_universe *u, uint32_t id, uint32_t other)
{
	return id < other || !ob_requery_lists(u, other);
}

// Changes of an object's pairs: n of them, of which the first max are listed.
typedef struct changes {
	uint32_t n, max, *list;
} changes;

static void add_change(changes *c, uint32_t change)
{
	if (c->n < c->max)
		c->list[c->n] = change;
	c->n++;
}

// True if the pair may end: a pair with a record stays until the step is over, as it may have to be solved again, and so
// do all pairs of its two objects. No pair ends once islands have been merged: each merge then adds one to those that are
// solved, so a step ends.
static bool may_end(const ob_step_data *data, uint32_t id, const ob_pair_key *k)
{
	ob_pair_place at;
	bool kept = k->record != OB_NO_RECORD || data->count->merged;
	for (uint32_t link = ob_pair_parts(k) ? data->first_pair[id] : 0; !kept && ob_pair_at(data, link, &at);
	     link = ob_pair_next(data, at)) {
		const ob_pair_key *x = &data->pair[at.pair];
		kept = x->a == k->a && x->b == k->b && x->record != OB_NO_RECORD;
	}
	return !kept;
}

// Ends pairs that the query has not found again, and begins new ones. found: n neighbours, ascending; had: [n] scratch.
// Static objects keep no list of their pairs, and are queried when they are created: then they have none.
static void compare_pairs(const ob_universe *u, uint32_t id, const uint32_t *found, uint32_t n, uint32_t *had,
			  changes *to)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_pair_place at;
	memset(had, 0, n * sizeof *had);
	for (uint32_t link = ob_has_pairs(data, id) ? data->first_pair[id] : 0; ob_pair_at(data, link, &at);
	     link = ob_pair_next(data, at)) {
		const ob_pair_key *k = &data->pair[at.pair];
		ob_prefetch_link(u, ob_pair_next(data, at));
		const uint32_t other = at.side ? k->a : k->b, place = place_of(found, n, other);
		if (place < n)
			had[place] = !k->region; // regions are looked for anew
		else if (may_end(data, id, k) && decides(u, id, other))
			add_change(to, OB_PAIR_ENDS | at.pair);
	}
	for (uint32_t i = 0; i < n; i++)
		if (!had[i] && decides(u, id, found[i]) && (!is_immobile(data, id) || !is_immobile(data, found[i])) &&
		    ob_may_touch(u, id, found[i]))
			add_change(to, found[i]);
}

// Number of regions near an object, of the terrains among its n neighbours: as many neighbours as there are objects at
// most, all together.
static uint32_t count_regions(const ob_universe *u, uint32_t id, const uint32_t *found, uint32_t n)
{
	uint32_t regions = 0;
	const bool looks = ob_universe_has_terrains(u) && !is_immobile(ob_universe_step_data(u), id);
	for (uint32_t i = 0; i < n && looks; i++)
		if (ob_terrain_of(u, ob_passport_of(u, found[i])))
			regions += ob_terrain_near(u, found[i], id, NULL, 0);
	const uint32_t most = ob_universe_ids(u) - n;
	return regions < most ? regions : most;
}

void ob_pairs_query(ob_universe *u, uint32_t id, uint64_t *box_tests)
{
	enum { USUALLY = 256 };
	uint32_t few[3 * USUALLY], *found = few, room = USUALLY, n = ob_index_query(u, id, few, USUALLY, box_tests);
	if (n > USUALLY) {
		room = n;
		found = ob_allocate(3 * (size_t)n * sizeof *found);
		n = ob_index_query(u, id, found, n, box_tests);
	}
	uint32_t *had = found + room;
	changes c = { .max = room, .list = had + room };
	ob_sort_ids(found, n, ob_universe_ids(u), had);
	compare_pairs(u, id, found, n, had, &c);
	uint32_t *more = c.n > c.max ? ob_allocate(c.n * sizeof *more) : NULL;
	if (more) {
		c = (changes){ .max = c.n, .list = more };
		compare_pairs(u, id, found, n, had, &c);
	}
	ob_commit_neighbours(u, id, n + count_regions(u, id, found, n), c.list, c.n);
	free(more);
	if (found != few)
		free(found);
}

// ---- results of queries

static void change_pairs(ob_universe *u, uint32_t id, uint64_t steps)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	const uint32_t at = data->neighbours[id].offset, n = at < data->neighbours_max ? data->neighbour_id[at] : 0;
	if (n >= data->neighbours_max - at) {
		data->count->failure = OB_STEP_DAMAGED;
		return;
	}
	data->count->visits += 1 + n;
	for (const uint32_t *change = data->neighbour_id + at + 1, *end = change + n; change < end; change++)
		if (!ob_is_pair_change(data, id, *change, ids))
			data->count->failure = OB_STEP_DAMAGED;
		else if (*change & OB_PAIR_ENDS)
			drop_pair(u, *change & ~OB_PAIR_ENDS);
		else
			add_pairs(u, id, *change, steps);
}

static void prefetch_changes(const ob_step_data *data, const uint32_t *queried, uint32_t i, uint32_t n)
{
	enum { PLACE_AHEAD = 8, CHANGES_AHEAD = 4 };
	if (i + PLACE_AHEAD < n)
		__builtin_prefetch(&data->neighbours[queried[i + PLACE_AHEAD]]);
	if (i + CHANGES_AHEAD < n && data->neighbours[queried[i + CHANGES_AHEAD]].offset < data->neighbours_max)
		__builtin_prefetch(&data->neighbour_id[data->neighbours[queried[i + CHANGES_AHEAD]].offset]);
}

// Merges in the order of ids, not in that of the list or of the workers: so pairs have the same indices in every run.
void ob_pairs_merge(ob_universe *u, uint64_t steps)
{
	ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	uint32_t count, n = 0, *queried = data->scratch, *other = data->scratch + ids;
	const uint32_t *list = ob_requery_list(u, &count);
	data->count->checks = 0;
	if (!count)
		return;
	for (uint32_t i = 0; i < count && n < ids; i++)
		if (list[i] < ids)
			queried[n++] = list[i];
	ob_sort_ids(queried, n, ids, other);
	for (uint32_t i = 0; i < n && ob_step_failed(u, NULL) == OB_STEP_OK; i++) {
		prefetch_changes(data, queried, i, n);
		change_pairs(u, queried[i], steps);
	}
	ob_requery_reset(u);
	ob_neighbours_reset(u);
}

// ---- state of contacts

// A first solution has overwritten the pair's key. So where islands are solved again, the record alone decides.
const ob_pair_state *ob_pair_state_before(const ob_universe *u, const ob_pair_key *k)
{
	const ob_step_data *data = ob_universe_step_data(u);
	if (k->record == OB_NO_RECORD || (!k->active && !data->count->merged))
		return NULL;
	const ob_pair_state *p = ob_pair_before(&data->record[k->record], ob_step_count(u));
	return p && p->points ? p : NULL;
}
