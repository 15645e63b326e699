#include "table/checkpoint.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "table/home.h"
#include "table/layout.h"
#include "table/pages.h"

// Part of ob_control that a step leaves for the next. The rest goes on after a restart, or others write it at any time
// (a death, the state).
typedef struct step_control {
	uint64_t step, claim_next, requery_count, neighbours_used;
	uint32_t claim_total, awake, pairs, islands;
} step_control;

struct ob_checkpoint {
	step_control control;
	ob_motion *motion; // [ids]
	ob_passport *passport; // [ids]
	size_t passports_max;
	uint32_t ids, ids_max;
	ob_page_range *kept; // ascending
	size_t ranges, ranges_max;
	char *bytes; // contents of all ranges, one after the other
	size_t bytes_max;
};

ob_checkpoint *ob_checkpoint_create(void)
{
	return calloc(1, sizeof(ob_checkpoint));
}

void ob_checkpoint_destroy(ob_checkpoint *c)
{
	if (!c)
		return;
	free(c->motion);
	free(c->passport);
	free(c->kept);
	free(c->bytes);
	free(c);
}

uint64_t ob_checkpoint_step(const ob_checkpoint *c)
{
	return c->control.step;
}

static const char blank[OB_LAYOUT_PAGE];

static bool is_blank(const char *page)
{
	return memcmp(page, blank, sizeof blank) == 0;
}

static bool keep(ob_checkpoint *c, const ob_universe *u, ob_page_range r, size_t *bytes)
{
	size_t more = r.end - r.begin;
	if (!OB_MAKE_ROOM(c->kept, c->ranges, c->ranges_max) || !OB_RESERVE(c->bytes, *bytes + more, c->bytes_max))
		return false;
	memcpy(c->bytes + *bytes, u->base + r.begin, more);
	c->kept[c->ranges++] = r;
	*bytes += more;
	return true;
}

// Skips reserved pages without contents: pages in use that were not copied are put back as zeros.
static bool take_areas(ob_checkpoint *c, const ob_universe *u)
{
	ob_page_range r = { 0, 0 };
	size_t bytes = 0;
	c->ranges = 0;
	ob_pages_list_used(u);
	for (size_t i = 0; ob_pages_next_used(u, i, r.end, &r); i++) {
		for (uint64_t page = r.begin, begin = r.begin; page < r.end;) {
			for (begin = page; page < r.end && !is_blank(u->base + page); page += OB_LAYOUT_PAGE)
				;
			if (page > begin && !keep(c, u, (ob_page_range){ begin, page }, &bytes))
				return false;
			for (; page < r.end && is_blank(u->base + page); page += OB_LAYOUT_PAGE)
				;
		}
	}
	return true;
}

static bool take_motions(ob_checkpoint *c, const ob_universe *u)
{
	size_t max = c->ids_max;
	const uint32_t ids = ob_universe_ids(u);
	if (!OB_RESERVE(c->motion, ids, max))
		return false;
	c->ids_max = (uint32_t)max;
	c->ids = ids;
	for (uint32_t id = 0; id < c->ids; id++)
		c->motion[id] = *ob_newest_motion(u, id);
	return true;
}

// One that was never written is all 0.
static bool take_passports(ob_checkpoint *c, const ob_universe *u)
{
	if (!OB_RESERVE(c->passport, c->ids, c->passports_max))
		return false;
	for (uint32_t id = 0; id < c->ids; id++)
		if (!ob_passport_read(u, id, &c->passport[id]))
			c->passport[id] = (ob_passport){ 0 };
	return true;
}

static void take_control(ob_checkpoint *c, const ob_control *from)
{
	c->control = (step_control){ .step = from->step,
				     .claim_next = from->claim_next,
				     .claim_total = from->claim_total,
				     .requery_count = from->requery_count,
				     .neighbours_used = from->neighbours_used,
				     .awake = from->awake,
				     .pairs = from->pairs,
				     .islands = from->islands };
}

bool ob_checkpoint_take(ob_checkpoint *c, const ob_universe *u)
{
	take_control(c, u->control);
	return take_motions(c, u) && take_passports(c, u) && take_areas(c, u);
}

// Writes pages that differ, word by word, for readers in other threads or processes may read at the same time. from NULL =
// zeros.
static void put_pages(char *to, const char *from, size_t bytes)
{
	for (size_t page = 0; page < bytes; page += OB_LAYOUT_PAGE) {
		const char *then = from ? from + page : blank;
		if (memcmp(to + page, then, OB_LAYOUT_PAGE) == 0)
			continue;
		for (size_t i = 0; i < OB_LAYOUT_PAGE; i += sizeof(uint64_t)) {
			uint64_t word;
			memcpy(&word, then + i, sizeof word);
			__atomic_store_n((uint64_t *)(to + page + i), word, __ATOMIC_RELAXED);
		}
	}
}

// Pages do not go out of use, so what was kept lies within what is in use now.
static void put_areas_back(const ob_checkpoint *c, const ob_universe *u)
{
	ob_page_range r = { 0, 0 };
	const char *from = c->bytes;
	size_t k = 0;
	ob_pages_list_used(u);
	for (size_t i = 0; ob_pages_next_used(u, i, r.end, &r); i++) {
		for (; k < c->ranges && c->kept[k].begin < r.end; k++) {
			const ob_page_range *kept = &c->kept[k];
			put_pages(u->base + r.begin, NULL, kept->begin - r.begin);
			put_pages(u->base + kept->begin, from, kept->end - kept->begin);
			from += kept->end - kept->begin;
			r.begin = kept->end;
		}
		put_pages(u->base + r.begin, NULL, r.end - r.begin);
	}
}

static void put_motions_back(const ob_checkpoint *c, ob_universe *u)
{
	for (uint32_t id = 0; id < c->ids; id++) {
		if (!u->slot[id].version)
			continue;
		if (ob_universe_traced(u))
			ob_trace_moves(u, ob_trace_host(u), id, ob_newest_motion(u, id)->flags, c->motion[id].flags);
		ob_publish_motion(u, id, &c->motion[id]);
	}
}

// Hides objects that were not there then, before their motions go: readers find a motion of whatever is present. Their
// simulators' moves are forgotten.
static void hide_later_objects(const ob_checkpoint *c, ob_universe *u)
{
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_passport now;
		if (!ob_passport_read(u, id, &now) || !(now.flags & OB_OBJECT_PRESENT) ||
		    (id < c->ids && c->passport[id].flags & OB_OBJECT_PRESENT &&
		     c->passport[id].generation == now.generation))
			continue;
		ob_pin_drop(u, id);
		now.flags &= ~(uint32_t)OB_OBJECT_PRESENT;
		ob_write_passport(u, id, &now);
	}
}

static void put_passports_back(const ob_checkpoint *c, ob_universe *u)
{
	static const ob_passport none = { 0 };
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		ob_passport now;
		const ob_passport *then = id < c->ids ? &c->passport[id] : &none;
		if (ob_passport_read(u, id, &now) && memcmp(&now, then, sizeof now) != 0)
			ob_write_passport(u, id, then);
	}
}

// Ends the spans that dead workers had begun, on their own tracks, which their successors continue.
static void end_traces(ob_universe *u)
{
	for (uint32_t w = 0; ob_universe_traced(u) && w < u->header.sizes.workers; w++) {
		ob_trace_event doing = ob_trace_unfinished(u, w);
		if (doing.kind == OB_TRACE_NONE)
			continue;
		ob_trace_span(u, w, (ob_trace_kind)doing.kind, doing.begin, 0, 0);
		ob_trace_doing(u, w, OB_TRACE_NONE, 0);
	}
}

static void put_control_back(const step_control *from, ob_control *to)
{
	to->claim_next = from->claim_next;
	to->claim_total = from->claim_total;
	to->requery_count = from->requery_count;
	to->neighbours_used = from->neighbours_used;
	__atomic_store_n(&to->awake, from->awake, __ATOMIC_RELAXED);
	__atomic_store_n(&to->pairs, from->pairs, __ATOMIC_RELAXED);
	__atomic_store_n(&to->islands, from->islands, __ATOMIC_RELAXED);
	__atomic_store_n(&to->step, from->step, __ATOMIC_RELEASE);
}

static void reset_gate(ob_universe *u)
{
	uint32_t workers = u->header.sizes.workers;
	memset(u->gate, 0, sizeof *u->gate);
	memset(u->gate_group, 0, (workers + 63) / 64 * sizeof *u->gate_group);
	memset(u->gate_cell, 0, workers * sizeof *u->gate_cell);
	ob_gate_prepare(u->gate, workers);
	ob_outboxes_reset(u);
}

void ob_checkpoint_put_back(const ob_checkpoint *c, ob_universe *u)
{
	put_areas_back(c, u);
	hide_later_objects(c, u);
	put_motions_back(c, u);
	put_passports_back(c, u);
	put_control_back(&c->control, u->control);
	__atomic_store_n(&u->control->ids, c->ids, __ATOMIC_RELEASE); // bounds of work and of neighbours follow it
}

void ob_checkpoint_forget_workers(ob_universe *u)
{
	end_traces(u);
	u->control->lives++;
	reset_gate(u);
	for (uint32_t w = 0; w < u->header.sizes.workers; w++) {
		__atomic_store_n(&u->worker[w].working_on, 0, __ATOMIC_RELAXED);
		__atomic_store_n(&u->worker[w].pid, 0, __ATOMIC_RELEASE);
	}
}
