#include "table/layout.h"

#include <string.h>

enum { CAPACITY_LIMIT = 1 << 24, WORKERS_LIMIT = 1 << 20 };

static uint32_t power_of_two_from(uint32_t least)
{
	uint32_t n = 64;
	while (n < least)
		n *= 2;
	return n;
}

static uint64_t area_bytes(const ob_layout_sizes *s, ob_area area)
{
	uint64_t objects = s->capacity, workers = s->workers, pairs = s->pairs_max;
	const ob_exchange *x = NULL; // only for the sizes of what it points to
	switch (area) {
	case OB_AREA_CONTROL:
		return sizeof(ob_control);
	case OB_AREA_GATE:
		return sizeof(ob_gate);
	case OB_AREA_GATE_GROUP:
		return (workers + 63) / 64 * sizeof(ob_gate_group);
	case OB_AREA_GATE_CELL:
		return workers * sizeof(ob_gate_cell);
	case OB_AREA_WORKER:
		return workers * sizeof(ob_worker_cell);
	case OB_AREA_SLOT:
		return objects * sizeof(ob_slot);
	case OB_AREA_PASSPORT:
		return objects * sizeof(ob_passport_slot);
	case OB_AREA_REBOUND:
		return objects * sizeof(uint32_t);
	case OB_AREA_REBOUND_BIT:
		return (objects + 63) / 64 * sizeof(uint64_t);
	case OB_AREA_COUNTS:
		return sizeof *x->count;
	case OB_AREA_BRIEF:
		return objects * sizeof *x->brief;
	case OB_AREA_BOUNDS:
		return objects * sizeof *x->bounds;
	case OB_AREA_RESULT:
		return objects * sizeof *x->result;
	case OB_AREA_RESULT_ISLAND:
		return objects * sizeof *x->result_island;
	case OB_AREA_PERCEIVED:
		return objects * sizeof *x->perceived;
	case OB_AREA_PERCEIVED_ID:
		return s->perceived_max * sizeof *x->perceived_id;
	case OB_AREA_CELL:
		return objects * sizeof *x->cell;
	case OB_AREA_BUCKET:
		return s->buckets * sizeof *x->bucket;
	case OB_AREA_PLANE:
		return objects * sizeof *x->plane;
	case OB_AREA_PAIR:
	case OB_AREA_PAIR_NEXT:
		return pairs * sizeof *x->pair;
	case OB_AREA_RECORD:
		return pairs * sizeof *x->record;
	case OB_AREA_RECORD_FREE:
		return pairs * sizeof *x->record_free;
	case OB_AREA_ISLAND:
		return objects * sizeof *x->island;
	case OB_AREA_MEMBER:
		return objects * sizeof *x->member;
	case OB_AREA_ISLAND_PAIR:
		return pairs * sizeof *x->island_pair;
	case OB_AREA_CHUNK:
		return (objects + 1) * sizeof *x->chunk;
	case OB_AREA_SCRATCH:
		return 4 * objects * sizeof *x->scratch;
	case OB_AREA_ISLAND_REACH:
		return objects * sizeof *x->island_reach;
	case OB_AREAS:
		break;
	}
	return 0;
}

void ob_layout_plan(ob_header *h, uint32_t capacity, uint32_t workers)
{
	h->sizes = (ob_layout_sizes){ .capacity = capacity, .workers = workers };
	h->sizes.pairs_max = capacity > 128 ? 32 * capacity : 4096;
	h->sizes.buckets = power_of_two_from(2 * capacity);
	h->sizes.perceived_max = 64 * capacity + 65536;
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
	likely.perceived_max = likely.pairs_max;
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
	if (s->capacity < 1 || s->capacity > CAPACITY_LIMIT || s->workers < 1 || s->workers > WORKERS_LIMIT)
		return false;
	ob_header expected;
	ob_layout_plan(&expected, s->capacity, s->workers);
	return !memcmp(&expected.sizes, s, sizeof *s) && !memcmp(expected.area, h->area, sizeof h->area) &&
	       expected.bytes == h->bytes && h->bytes <= file_bytes && memchr(h->name, 0, sizeof h->name) &&
	       memchr(h->isolation, 0, sizeof h->isolation);
}

static void bind_exchange(ob_universe *u)
{
	const uint64_t *area = u->header.area;
	char *base = u->base;
	u->exchange = (ob_exchange){
		.objects_max = u->header.sizes.capacity,
		.pairs_max = u->header.sizes.pairs_max,
		.buckets = u->header.sizes.buckets,
		.perceived_max = u->header.sizes.perceived_max,
		.count = (void *)(base + area[OB_AREA_COUNTS]),
		.brief = (void *)(base + area[OB_AREA_BRIEF]),
		.bounds = (void *)(base + area[OB_AREA_BOUNDS]),
		.result = (void *)(base + area[OB_AREA_RESULT]),
		.result_island = (void *)(base + area[OB_AREA_RESULT_ISLAND]),
		.perceived = (void *)(base + area[OB_AREA_PERCEIVED]),
		.perceived_id = (void *)(base + area[OB_AREA_PERCEIVED_ID]),
		.cell = (void *)(base + area[OB_AREA_CELL]),
		.bucket = (void *)(base + area[OB_AREA_BUCKET]),
		.plane = (void *)(base + area[OB_AREA_PLANE]),
		.pair = (void *)(base + area[OB_AREA_PAIR]),
		.pair_next = (void *)(base + area[OB_AREA_PAIR_NEXT]),
		.record = (void *)(base + area[OB_AREA_RECORD]),
		.record_free = (void *)(base + area[OB_AREA_RECORD_FREE]),
		.island = (void *)(base + area[OB_AREA_ISLAND]),
		.member = (void *)(base + area[OB_AREA_MEMBER]),
		.island_pair = (void *)(base + area[OB_AREA_ISLAND_PAIR]),
		.chunk = (void *)(base + area[OB_AREA_CHUNK]),
		.scratch = (void *)(base + area[OB_AREA_SCRATCH]),
		.island_reach = (void *)(base + area[OB_AREA_ISLAND_REACH]),
	};
}

void ob_layout_bind(ob_universe *u, void *base)
{
	const uint64_t *area = u->header.area;
	u->base = base;
	u->control = (void *)(u->base + area[OB_AREA_CONTROL]);
	u->gate = (void *)(u->base + area[OB_AREA_GATE]);
	u->gate_group = (void *)(u->base + area[OB_AREA_GATE_GROUP]);
	u->gate_cell = (void *)(u->base + area[OB_AREA_GATE_CELL]);
	u->worker = (void *)(u->base + area[OB_AREA_WORKER]);
	u->slot = (void *)(u->base + area[OB_AREA_SLOT]);
	u->passport = (void *)(u->base + area[OB_AREA_PASSPORT]);
	u->rebound = (void *)(u->base + area[OB_AREA_REBOUND]);
	u->rebound_bit = (void *)(u->base + area[OB_AREA_REBOUND_BIT]);
	bind_exchange(u);
}
