#include "cluster/regions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "schedule/calendar.h"
#include "schedule/pair_checks.h"
#include "table/forest.h"
#include "table/home.h"

// Work (island_builder.h), per body, that justifies a new cut: some hundred times its cost on each rank.
enum { WORTH_A_CUT = 256 };
static const double longer = 1.25; // a cut changes its axis if bodies extend this much farther along another one
static const double beyond = .25; // share of its fat AABB by which a body must be beyond a cut

// Bodies that touch.
typedef struct group {
	double at[3]; // m
	double weight;
	uint32_t root; // lowest of their ids
} group;

// Separates the simulators before one from those from it on; a node of the tree of cuts.
typedef struct cut {
	uint32_t axis;
	double at; // m
} cut;

struct ob_regions {
	uint32_t simulators, each; // number on all ranks, on each
	uint32_t used; // number that have a region: no more than there are objects
	bool is_cut;
	uint32_t *home; // [object]: 1 + the simulator whose region it is in; 0 = not a body
	uint64_t *spent; // [object]: recent work
	cut *cut; // [simulator], from 1 on
	double *room; // [simulator]: its share of all work, less that of bodies pinned to it
	ob_regions_work work;
	ob_mail out;
	uint32_t *mover; // bodies whose region has changed since they were last listed
	uint32_t movers;
	uint8_t *moves; // [object]: 1 = it is in mover
	uint32_t *parent; // [object]: groups (table/forest.h)
	uint32_t *place; // [object]: index of a root's group
	group *group;
};

ob_regions *ob_regions_create(const ob_universe *u)
{
	const uint32_t objects = ob_universe_capacity(u);
	ob_regions *r = calloc(1, sizeof *r);
	if (!r)
		return NULL;
	r->simulators = ob_universe_simulators(u);
	r->each = r->simulators / ob_universe_ranks(u);
	r->used = r->simulators < objects ? r->simulators : objects;
	r->home = calloc(objects, sizeof *r->home);
	r->spent = calloc(objects, sizeof *r->spent);
	r->mover = calloc(objects, sizeof *r->mover);
	r->moves = calloc(objects, sizeof *r->moves);
	r->cut = calloc(r->simulators, sizeof *r->cut);
	r->room = calloc(r->simulators, sizeof *r->room);
	r->parent = calloc(objects, sizeof *r->parent);
	r->place = calloc(objects, sizeof *r->place);
	r->group = calloc(objects, sizeof *r->group);
	if (r->home && r->spent && r->mover && r->moves && r->cut && r->room && r->parent && r->place && r->group)
		return r;
	ob_regions_destroy(r);
	return NULL;
}

void ob_regions_destroy(ob_regions *r)
{
	if (!r)
		return;
	free(r->home);
	free(r->spent);
	free(r->mover);
	free(r->moves);
	free(r->cut);
	free(r->room);
	free(r->parent);
	free(r->place);
	free(r->group);
	ob_mail_finish(&r->out);
	free(r);
}

// Returns the simulator where first .. first + count - 1 are halved: a rank's first, if they are several ranks'.
static uint32_t middle_of(const ob_regions *r, uint32_t first, uint32_t count)
{
	return first + (count > r->each ? count / r->each / 2 * r->each : count / 2);
}

// ---- groups

static void find_groups(ob_regions *r, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	for (uint32_t id = 0; id < ids; id++)
		r->parent[id] = id;
	for (uint32_t i = 0; i < ob_pairs_end(data); i++) {
		const ob_pair_key *k = &data->pair[i];
		if (k->active && ob_object_in_range(data, k->a) && ob_object_in_range(data, k->b) &&
		    ob_schedule_is_dynamic(&data->schedule[k->a]) && ob_schedule_is_dynamic(&data->schedule[k->b]))
			ob_forest_join(r->parent, k->a, k->b);
	}
}

// Returns the simulator to which the body's group is pinned, the first of several; UINT32_MAX: none is.
static uint32_t pin_of(const ob_regions *r, const ob_step_data *data, uint32_t id)
{
	const uint32_t pin = data->pin[id] - 1;
	return pin < r->simulators ? pin : UINT32_MAX;
}

static void add_body(group *g, const float *box, double weight)
{
	for (int c = 0; c < 3; c++)
		g->at[c] += weight * ((double)box[c] + box[3 + c]) / 2;
	g->weight += weight;
}

// Lists the groups, and the work left for each simulator; returns the number of groups. Groups with a pinned body are
// not listed: they are at its simulator.
static uint32_t list_groups(ob_regions *r, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	uint32_t n = 0, left = 0;
	double all = 0;
	memset(r->room, 0, r->simulators * sizeof *r->room);
	for (uint32_t id = 0; id < ids; id++) {
		if (!ob_schedule_is_dynamic(&data->schedule[id]))
			continue;
		const uint32_t root = ob_forest_root(r->parent, id);
		if (root == id) {
			r->place[id] = n;
			r->home[id] = 0;
			r->group[n++] = (group){ .root = id };
		}
		if (!r->home[root])
			r->home[root] = 1 + pin_of(r, data, id);
		add_body(&r->group[r->place[root]], data->bounds[id], 1 + (double)r->spent[id]);
	}
	for (uint32_t i = 0; i < n; i++) {
		group g = r->group[i];
		const uint32_t pinned = r->home[g.root];
		all += g.weight;
		if (pinned) {
			r->room[pinned - 1] -= g.weight;
			continue;
		}
		for (int c = 0; c < 3; c++)
			g.at[c] /= g.weight;
		r->group[left++] = g;
	}
	for (uint32_t s = 0; s < r->simulators; s++)
		r->room[s] = fmax(r->room[s] + all / r->simulators, 0);
	return left;
}

// ---- cuts

static bool is_before(const group *a, const group *b, uint32_t axis)
{
	return a->at[axis] != b->at[axis] ? a->at[axis] < b->at[axis] : a->root < b->root;
}

static const group *median_of(const group *a, const group *b, const group *c, uint32_t axis)
{
	if (is_before(b, a, axis)) {
		const group *low = b;
		b = a, a = low;
	}
	return is_before(b, c, axis) ? b : is_before(a, c, axis) ? c : a;
}

// Moves the groups before the pivot to the front; returns their number, and their weight.
static uint32_t part(group *g, uint32_t n, uint32_t axis, double *weight)
{
	const group pivot = *median_of(&g[0], &g[n / 2], &g[n - 1], axis);
	uint32_t before = 0;
	*weight = 0;
	for (uint32_t i = 0; i < n; i++) {
		if (!is_before(&g[i], &pivot, axis))
			continue;
		const group moved = g[i];
		g[i] = g[before];
		g[before++] = moved;
		*weight += moved.weight;
	}
	return before;
}

// Moves the first groups along the axis, of about this weight, to the front; returns their number. A selection, as by
// Hoare, Algorithm 65: Find, 1961.
static uint32_t halve(group *g, uint32_t n, uint32_t axis, double weight)
{
	uint32_t first = 0, end = n;
	while (end - first > 1) {
		double found;
		const uint32_t before = part(g + first, end - first, axis, &found);
		if (!before) { // the pivot is the first of all
			uint32_t least = first;
			for (uint32_t i = first; i < end; i++)
				least = is_before(&g[i], &g[least], axis) ? i : least;
			const group moved = g[least];
			g[least] = g[first];
			g[first] = moved;
			if (weight < moved.weight)
				end = first + 1;
			else
				first++, weight -= moved.weight;
		} else if (weight < found) {
			end = first + before;
		} else {
			first += before, weight -= found;
		}
	}
	return first < end && weight > g[first].weight / 2 ? first + 1 : first;
}

// Returns the axis with the largest mean extent of bodies: a single distant body changes no cut.
static uint32_t longest_axis(const group *g, uint32_t n, uint32_t before)
{
	double weight = 0, middle[3] = { 0 }, distance[3] = { 0 };
	for (uint32_t i = 0; i < n; i++)
		weight += g[i].weight;
	for (uint32_t i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			middle[c] += g[i].at[c] * (g[i].weight / weight);
	for (uint32_t i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			distance[c] += fabs(g[i].at[c] - middle[c]) * (g[i].weight / weight);
	uint32_t axis = before;
	distance[before] *= longer;
	for (uint32_t c = 0; c < 3; c++)
		if (distance[c] > distance[axis])
			axis = c;
	return axis;
}

// Returns the position between the first m groups and the others.
static double middle_between(const group *g, uint32_t n, uint32_t m, uint32_t axis)
{
	double low = -INFINITY, high = INFINITY;
	for (uint32_t i = 0; i < m; i++)
		low = fmax(low, g[i].at[axis]);
	for (uint32_t i = m; i < n; i++)
		high = fmin(high, g[i].at[axis]);
	return low + (high - low) / 2;
}

static void share_out(ob_regions *r, group *g, uint32_t n, uint32_t first, uint32_t count)
{
	if (count == 1) {
		for (uint32_t i = 0; i < n; i++)
			r->home[g[i].root] = 1 + first % r->used;
		return;
	}
	const uint32_t middle = middle_of(r, first, count);
	cut *c = &r->cut[middle];
	double weight = 0, room = 0, left = 0;
	for (uint32_t i = 0; i < n; i++)
		weight += g[i].weight;
	for (uint32_t s = first; s < first + count; s++)
		room += r->room[s], left += s < middle ? r->room[s] : 0;
	c->axis = n ? longest_axis(g, n, c->axis) : c->axis;
	const uint32_t m = halve(g, n, c->axis, room > 0 ? weight * (left / room) : weight / 2);
	if (m && m < n)
		c->at = middle_between(g, n, m, c->axis);
	share_out(r, g, m, first, middle - first);
	share_out(r, g + m, n - m, middle, first + count - middle);
}

static void cut_anew(ob_regions *r, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	find_groups(r, u);
	share_out(r, r->group, list_groups(r, u), 0, r->simulators);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++)
		r->home[id] = ob_schedule_is_dynamic(&data->schedule[id]) ? r->home[ob_forest_root(r->parent, id)] : 0;
	r->is_cut = true;
}

// ---- homes of bodies

// Returns the simulator whose region has the box; home: 1 + the former one; 0: none.
static uint32_t find_home(const ob_regions *r, const float *box, uint32_t home)
{
	uint32_t first = 0, count = r->simulators;
	while (count > 1) {
		const uint32_t middle = middle_of(r, first, count);
		const cut *c = &r->cut[middle];
		const double low = box[c->axis], high = box[3 + c->axis], margin = beyond * (high - low);
		const double after = (low + high) / 2 - c->at;
		const bool was_there = home > first && home <= first + count, second = !was_there      ? after > 0
										       : home > middle ? after > -margin
												       : after > margin;
		count = second ? first + count - middle : middle - first;
		first = second ? middle : first;
	}
	return first % r->used;
}

bool ob_regions_settle(ob_regions *r, ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t ids = ob_universe_ids(u);
	uint32_t fresh = 0;
	for (uint32_t id = 0; id < ids; id++) {
		r->home[id] = ob_schedule_is_dynamic(&data->schedule[id]) ? r->home[id] : 0;
		fresh += ob_schedule_is_dynamic(&data->schedule[id]) && !r->home[id];
	}
	if (!fresh)
		return false;
	const bool first = !r->is_cut;
	if (first) {
		for (uint32_t id = 0; id < ids; id++)
			r->spent[id] = data->effort[id];
		cut_anew(r, u);
	}
	for (uint32_t id = 0; id < ids; id++) {
		if (!ob_schedule_is_dynamic(&data->schedule[id]) || (r->home[id] && !first))
			continue;
		if (!r->home[id])
			r->home[id] = 1 + find_home(r, data->bounds[id], 0);
		ob_home_set(u, id, r->home[id] - 1);
		ob_calendar_enter_due(u, id);
		ob_pairs_look(u, id); // another rank may check them now
	}
	return first;
}

void ob_regions_follow(ob_regions *r, const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t n;
	const uint32_t *list = ob_requery_list(u, &n);
	for (uint32_t i = 0; i < n; i++) {
		const uint32_t id = list[i];
		if (!ob_object_in_range(data, id) || !r->home[id] || !ob_worker_is_here(u, ob_home_of(u, id)))
			continue;
		const uint32_t home = 1 + find_home(r, data->bounds[id], r->home[id]);
		if (home != r->home[id] && !r->moves[id])
			r->moves[id] = 1, r->mover[r->movers++] = id;
		r->home[id] = home;
	}
}

static bool touches(const ob_step_data *data, uint32_t id)
{
	ob_pair_place at;
	for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at); link = ob_pair_next(data, at))
		if (data->pair[at.pair].active)
			return true;
	return false;
}

// Bodies that touch have contents (holdings.h), and move when their island is solved.
const uint32_t *ob_regions_find_fliers(ob_regions *r, const ob_universe *u, uint32_t *count)
{
	const ob_step_data *data = ob_universe_step_data(u);
	*count = 0;
	for (uint32_t i = 0; i < r->movers; i++) {
		const uint32_t id = r->mover[i];
		r->moves[id] = 0;
		if (!r->home[id] || data->pin[id] || data->result_island[id] != UINT32_MAX || touches(data, id) ||
		    !ob_worker_is_here(u, ob_home_of(u, id)) || ob_worker_is_here(u, r->home[id] - 1))
			continue;
		r->mover[(*count)++] = id;
	}
	r->movers = 0;
	return r->mover;
}

void ob_regions_spill(ob_regions *r, uint64_t work)
{
	r->work.spilled += work;
}

void ob_regions_take(ob_regions *r, uint32_t id, uint32_t simulator)
{
	r->home[id] = 1 + simulator;
}

// ---- a new cut

ob_regions_work ob_regions_work_of(const ob_regions *r)
{
	return r->work;
}

typedef struct cost_parcel {
	ob_parcel head;
	uint64_t id, spent;
} cost_parcel;

static bool take_cost(void *regions, ob_universe *u, const char *parcel, const ob_parcel *head, uint32_t from)
{
	ob_regions *r = regions;
	cost_parcel c;
	if (head->kind != OB_PARCEL_COST || head->bytes != sizeof c)
		return false;
	memcpy(&c, parcel, sizeof c);
	if (c.id >= ob_universe_ids(u))
		return false;
	r->spent[c.id] = c.spent;
	return true;
}

// Exchanges the costs of all ranks' bodies. false: the step has failed.
static bool share_costs(ob_regions *r, ob_universe *u, ob_peers *p)
{
	ob_peers_begin(&r->out);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		const cost_parcel c = { { OB_PARCEL_COST, sizeof c }, id, r->spent[id] };
		if (r->home[id] && ob_worker_is_here(u, ob_home_of(u, id)))
			ob_mail_append(&r->out, &c, sizeof c);
	}
	return ob_parcels_exchange(p, u, OB_PEERS_CUT, &r->out, false, take_cost, r);
}

bool ob_regions_renew(ob_regions *r, ob_universe *u, ob_peers *p, const ob_regions_work *sum)
{
	const uint32_t ids = ob_universe_ids(u);
	if (sum->all / WORTH_A_CUT < (uint64_t)ids * ob_universe_ranks(u))
		return true;
	if (sum->spilled) {
		if (!share_costs(r, u, p))
			return false;
		cut_anew(r, u);
	}
	for (uint32_t id = 0; id < ids; id++)
		r->spent[id] /= 2;
	r->work = (ob_regions_work){ 0 };
	return true;
}

uint32_t ob_regions_at(const ob_regions *r, uint32_t id)
{
	return r->home[id] ? r->home[id] - 1 : 0;
}

void ob_regions_note(ob_regions *r, uint32_t id, uint32_t simulator, uint32_t work, bool spilled)
{
	if (!r)
		return;
	r->home[id] = 1 + simulator;
	r->spent[id] += work;
	r->work.all += work;
	r->work.spilled += spilled ? work : 0;
}
