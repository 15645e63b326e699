#include "free/boxes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	LOWEST = -20,
	LEVELS = 40,
	LARGE = 63
}; // cells of 2^-20 m .. 2^20 m; LARGE: boxes beyond, which each query tests

static uint32_t groups(uint32_t ids)
{
	return (ids + OB_FREE_GROUP - 1) / OB_FREE_GROUP;
}

static uint32_t buckets(uint32_t ids)
{
	uint32_t n = 64;
	while (n < 2 * ids)
		n *= 2;
	return n;
}

bool ob_free_boxes_begin(ob_free_boxes *b, const ob_universe *u, bool grid)
{
	const uint32_t ids = ob_universe_capacity(u);
	*b = (ob_free_boxes){ .ids = ids, .looked = calloc(groups(ids) + 1, sizeof *b->looked) };
	if (!grid)
		return b->looked;
	b->box = calloc(ids + 1, sizeof *b->box);
	b->place = calloc(ids + 1, sizeof *b->place);
	b->next = calloc(ids + 1, sizeof *b->next);
	b->found = calloc(ids + 1, sizeof *b->found);
	b->head = calloc(buckets(ids), sizeof *b->head);
	return b->looked && b->box && b->place && b->next && b->found && b->head;
}

void ob_free_boxes_finish(ob_free_boxes *b)
{
	free(b->looked);
	free(b->box);
	free(b->place);
	free(b->next);
	free(b->found);
	free(b->head);
}

bool ob_free_boxes_are_current(const ob_free_boxes *b, const ob_universe *u)
{
	for (uint32_t g = 0; g < groups(ob_universe_ids(u)); g++)
		if (ob_free_moved(u, g) != b->looked[g])
			return false;
	return true;
}

// ---- the grid

static bool overlap(const float *a, const float *b)
{
	return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] && b[2] <= a[5];
}

static uint32_t *bucket_of(const ob_free_boxes *b, const int32_t *place)
{
	uint64_t h = 0;
	for (int c = 0; c < 4; c++)
		h = (h ^ (uint32_t)place[c]) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
	return &b->head[h & (buckets(b->ids) - 1)];
}

// Cell coordinate of x, in cells; the same for all that is farther away than the grid reaches.
static int32_t coordinate(double x)
{
	const double most = 1e9;
	return (int32_t)floor(ob_max(-most, ob_min(most, x)));
}

// Each object lies in one cell, which holds the centre of its box, and is at least as large.
static void find_place(const float *box, int32_t *place)
{
	const float most = fmaxf(box[3] - box[0], fmaxf(box[4] - box[1], box[5] - box[2]));
	int level = LOWEST;
	if (most > 0 && isfinite(most))
		frexpf(most, &level);
	level = level < LOWEST ? LOWEST : level;
	if (!isfinite(most) || level >= LOWEST + LEVELS) {
		memcpy(place, (int32_t[4]){ LARGE }, 4 * sizeof *place);
		return;
	}
	place[0] = level - LOWEST + 1;
	for (int c = 0; c < 3; c++)
		place[1 + c] = coordinate(ldexp(.5 * ((double)box[c] + (double)box[3 + c]), -level));
}

static void remove_from_grid(ob_free_boxes *b, uint32_t id)
{
	int32_t *place = b->place[id];
	uint32_t *link = bucket_of(b, place);
	while (*link && *link != id + 1)
		link = &b->next[*link - 1];
	*link = b->next[id];
	b->in_level[place[0]]--;
	place[0] = 0;
}

static void put(ob_free_boxes *b, const ob_universe *u, uint32_t id)
{
	int32_t place[4] = { 0 };
	const bool there = ob_free_kind_of(u, id, NULL) != OB_FREE_ABSENT;
	ob_free_get_bounds(u, id, b->box[id]);
	if (there)
		find_place(b->box[id], place);
	if (memcmp(place, b->place[id], sizeof place) == 0)
		return;
	if (b->place[id][0])
		remove_from_grid(b, id);
	if (!there)
		return;
	memcpy(b->place[id], place, sizeof place);
	uint32_t *head = bucket_of(b, place);
	b->next[id] = *head;
	*head = id + 1;
	b->in_level[place[0]]++;
}

uint32_t ob_free_boxes_look(ob_free_boxes *b, const ob_universe *u, uint32_t group, uint32_t *id)
{
	const uint32_t moved = ob_free_moved(u, group), first = group * OB_FREE_GROUP, ids = ob_universe_ids(u);
	bool all = moved - b->looked[group] > OB_FREE_CHANGES;
	uint32_t n = 0;
	for (uint32_t k = b->looked[group]; !all && k != moved; k++)
		all = (id[n++] = ob_free_changed(u, group, k)) == OB_NO_OBJECT;
	if (all)
		for (n = 0; n < OB_FREE_GROUP && first + n < ids; n++)
			id[n] = first + n;
	b->looked[group] = moved;
	for (uint32_t i = 0; b->box && i < n; i++)
		put(b, u, id[i]);
	return n;
}

// Appends the objects of a cell that overlap the box.
static uint32_t query_cell(ob_free_boxes *b, const int32_t *place, const float *box, uint32_t n)
{
	for (uint32_t link = *bucket_of(b, place); link; link = b->next[link - 1])
		if (memcmp(b->place[link - 1], place, 4 * sizeof *place) == 0 && overlap(b->box[link - 1], box))
			b->found[n++] = link - 1;
	return n;
}

static uint32_t query_level(ob_free_boxes *b, int32_t level, const float *box, uint32_t n)
{
	int32_t low[3], high[3], place[4] = { level };
	double cells = 1;
	for (int c = 0; c < 3; c++) {
		const int e = LOWEST + level - 1;
		low[c] = coordinate(ldexp((double)box[c], -e) - .5);
		high[c] = coordinate(ldexp((double)box[3 + c], -e) + .5);
		cells *= high[c] - low[c] + 1.;
	}
	if (!(cells <= b->ids)) {
		for (uint32_t id = 0; id < b->ids; id++)
			if (b->place[id][0] == level && overlap(b->box[id], box))
				b->found[n++] = id;
		return n;
	}
	for (place[1] = low[0]; place[1] <= high[0]; place[1]++)
		for (place[2] = low[1]; place[2] <= high[1]; place[2]++)
			for (place[3] = low[2]; place[3] <= high[2]; place[3]++)
				n = query_cell(b, place, box, n);
	return n;
}

uint32_t ob_free_boxes_query(ob_free_boxes *b, const float box[6])
{
	uint32_t n = b->in_level[LARGE] ? query_cell(b, (int32_t[4]){ LARGE }, box, 0) : 0;
	for (int32_t level = 1; level <= LEVELS; level++)
		if (b->in_level[level])
			n = query_level(b, level, box, n);
	return n;
}
