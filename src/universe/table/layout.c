#include "table/layout.h"

#include <string.h>

enum {
	CAPACITY_LIMIT = 1 << 24,
	WORKERS_LIMIT = 1 << 20,
	HULLS_LIMIT = UINT16_MAX,
	SCRIPT_BYTES_LIMIT = 1 << 28,
	VERSIONS_LIMIT = 1 << 16,
	JOINTS_LIMIT = 1 << 24,
	TERRAIN_BYTES_LIMIT = 1 << 30,
	TERRAIN_PAIRS = 1 << 20 // with a terrain: an object has many
};

static uint32_t power_of_two_from(uint32_t least)
{
	uint32_t n = 64;
	while (n < least)
		n *= 2;
	return n;
}

static uint64_t groups(uint32_t n, uint32_t size)
{
	return ((uint64_t)n + size - 1) / size;
}

static uint64_t count_of(const ob_layout_sizes *s, ob_area area)
{
	const bool traced = s->trace_events > 0, free = s->history > 0;
#define COUNT(name, pointer, count) [OB_AREA_##name] = count,
	const uint64_t count[OB_AREAS] = { OB_LAYOUT_AREAS(COUNT) };
	return count[area];
}

static uint64_t area_bytes(const ob_layout_sizes *s, ob_area area)
{
	return ob_layout_element(area) * count_of(s, area);
}

uint64_t ob_layout_element(ob_area area)
{
#define BYTES(name, pointer, count) [OB_AREA_##name] = sizeof *((ob_universe *)NULL)->pointer,
	static const size_t bytes[OB_AREAS] = { OB_LAYOUT_AREAS(BYTES) };
	return area == OB_AREA_SCRIPT_TEXT || area == OB_AREA_TERRAIN ? 1 : bytes[area];
}

uint64_t ob_layout_elements_of(const ob_layout_sizes *s, ob_area area, uint32_t ids)
{
	ob_layout_sizes few = *s;
	few.capacity = ids < s->capacity ? ids : s->capacity;
	few.pairs_max = few.neighbours_max = few.hulls = 0;
	return count_of(&few, area);
}

// All rings together hold half a million events, 16 MiB, unless so many workers get the minimum each.
static uint32_t ring_events(uint32_t workers)
{
	enum { ALL = 1 << 19, LEAST = 256, MOST = 1 << 16 };
	uint32_t n = MOST;
	while (n > LEAST && (uint64_t)n * workers > ALL)
		n /= 2;
	return n;
}

// All possible pairs of some hundred objects; 128 for each of more.
static uint32_t most_pairs(uint32_t capacity)
{
	enum { LEAST = 8192, ALL = 1 << 18, EACH = 128, MOST = 1 << 30 };
	const uint64_t all = (uint64_t)capacity * capacity / 2, each = (uint64_t)EACH * capacity;
	uint64_t n = all < ALL ? all : ALL;
	n = n < LEAST ? LEAST : n < each && n < all ? each : n;
	return n < MOST ? (uint32_t)n : MOST;
}

// Usually enough for a phase's results of a pool's worker; for a worker per object, those of its object.
static uint32_t outbox_bytes(uint32_t workers)
{
	enum { FEW = 64, LARGE = 1 << 18, SMALL = 1 << 14 };
	return workers <= FEW ? LARGE : SMALL;
}

void ob_layout_plan(ob_header *h, const ob_layout_plan_of *p)
{
	const uint32_t capacity = p->capacity, workers = p->workers;
	h->sizes = (ob_layout_sizes){ .capacity = capacity,
				      .workers = workers,
				      .hulls = p->hulls,
				      .script_cells = p->script_cells,
				      .script_bytes = p->script_bytes,
				      .history = p->history,
				      .grouped = p->grouped,
				      .joints = p->joints,
				      .terrain_bytes = p->terrain_bytes,
				      .sensors = p->sensors,
				      .sensor_values = p->sensor_values };
	h->sizes.pairs_max = most_pairs(capacity);
	if (p->terrain_bytes && h->sizes.pairs_max < TERRAIN_PAIRS)
		h->sizes.pairs_max = TERRAIN_PAIRS;
	h->sizes.buckets = power_of_two_from(2 * capacity);
	h->sizes.neighbours_max = 2 * h->sizes.pairs_max + capacity; // either object of a pair may find the other
	h->sizes.trace_events = p->traced ? ring_events(workers) : 0;
	h->sizes.outbox_bytes = p->contained ? outbox_bytes(workers) : 0;
	uint64_t at = OB_LAYOUT_PAGE;
	for (int i = 0; i < OB_AREAS; i++) {
		h->area[i] = at;
		at += (area_bytes(&h->sizes, (ob_area)i) + OB_LAYOUT_PAGE - 1) / OB_LAYOUT_PAGE * OB_LAYOUT_PAGE;
	}
	h->bytes = at;
}

uint64_t ob_layout_likely_bytes(const ob_header *h)
{
	enum { PAIRS_PER_OBJECT = 4 };
	ob_layout_sizes likely = h->sizes;
	likely.pairs_max = PAIRS_PER_OBJECT * likely.capacity;
	likely.neighbours_max = likely.pairs_max;
	likely.grouped = likely.grouped < OB_GROUP_USUALLY ? likely.grouped : OB_GROUP_USUALLY;
	likely.hulls = 0; // existing ones have their pages before the run
	uint64_t sum = OB_LAYOUT_PAGE;
	for (int i = 0; i < OB_AREAS; i++)
		sum += area_bytes(&likely, (ob_area)i);
	return sum;
}

bool ob_layout_valid(const ob_header *h, uint64_t file_bytes)
{
	const ob_layout_sizes *s = &h->sizes;
	if (h->magic != OB_LAYOUT_MAGIC || h->version != OB_LAYOUT_VERSION)
		return false;
	if (s->capacity < 1 || s->capacity > CAPACITY_LIMIT || s->workers < 1 || s->workers > WORKERS_LIMIT ||
	    s->hulls > HULLS_LIMIT)
		return false;
	if (s->script_cells > s->capacity || s->script_bytes > SCRIPT_BYTES_LIMIT ||
	    (s->script_cells > 0) != (s->script_bytes >= sizeof(ob_script_directory)))
		return false;
	if (s->joints > JOINTS_LIMIT || s->terrain_bytes > TERRAIN_BYTES_LIMIT || s->sensors > OB_SENSORS_MAX ||
	    s->sensor_values > OB_SENSOR_NUMBERS_MAX)
		return false;
	if (s->history == 1 || s->history > VERSIONS_LIMIT || (s->grouped && s->grouped != OB_GROUP_CONTACTS))
		return false;
	ob_header expected;
	ob_layout_plan(&expected,
		       &(ob_layout_plan_of){ s->capacity, s->workers, s->hulls, s->trace_events > 0,
					     s->outbox_bytes > 0, s->script_cells, s->script_bytes, s->history,
					     s->grouped, s->joints, s->terrain_bytes, s->sensors, s->sensor_values });
	return !memcmp(&expected.sizes, s, sizeof *s) && !memcmp(expected.area, h->area, sizeof h->area) &&
	       (h->harden & 1 << OB_HARDEN_OUTBOX) == (s->outbox_bytes ? 1 << OB_HARDEN_OUTBOX : 0) &&
	       expected.bytes == h->bytes && h->bytes <= file_bytes && memchr(h->name, 0, sizeof h->name) &&
	       memchr(h->isolation, 0, sizeof h->isolation);
}

// Pointers to what a universe without scripts, room for joints, sensors or terrains does not have are NULL.
static bool is_bound(const ob_layout_sizes *s, ob_area area)
{
	const bool optional = (area >= OB_AREA_SCRIPT_COUNTS && area <= OB_AREA_SENSOR_VALUE) ||
			      area == OB_AREA_SCRIPT_TEXT || area == OB_AREA_TERRAIN;
	return !optional || count_of(s, area) > 0;
}

void ob_layout_bind(ob_universe *u, void *base)
{
	const ob_layout_sizes *s = &u->header.sizes;
	u->base = base;
	u->step_data = (ob_step_data){ .objects_max = s->capacity,
				       .pairs_max = s->pairs_max,
				       .buckets = s->buckets,
				       .neighbours_max = s->neighbours_max,
				       .joints_max = s->joints,
				       .sensors = s->sensors,
				       .script_cells = s->script_cells };
#define BIND(name, pointer, count) \
	u->pointer = is_bound(s, OB_AREA_##name) ? (void *)(u->base + u->header.area[OB_AREA_##name]) : NULL;
	OB_LAYOUT_AREAS(BIND)
#undef BIND
}
