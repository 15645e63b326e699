#include "table/layout.h"

#include <string.h>

enum {
	CAPACITY_LIMIT = 1 << 24,
	WORKERS_LIMIT = 1 << 20,
	HULLS_LIMIT = UINT16_MAX,
	SCRIPT_BYTES_LIMIT = 1 << 28,
	VERSIONS_LIMIT = 1 << 16,
	JOINTS_LIMIT = 1 << 24
};

static uint32_t power_of_two_from(uint32_t least)
{
	uint32_t n = 64;
	while (n < least)
		n *= 2;
	return n;
}

// Number of elements of an area: a multiple of one of the sizes, and some more.
typedef struct area_rule {
	size_t element; // bytes
	enum {
		FIXED,
		PER_OBJECT,
		PER_64_OBJECTS,
		PER_4096_OBJECTS,
		PER_WORKER,
		PER_64_WORKERS,
		PER_PAIR,
		PER_64_PAIRS,
		PER_4096_PAIRS,
		PER_BUCKET,
		PER_8_BUCKETS,
		PER_NEIGHBOUR,
		PER_OUTBOX_BYTE,
		PER_HULL,
		PER_RING,
		PER_TRACE_EVENT,
		PER_TRACED_OBJECT,
		PER_SCRIPTED_UNIVERSE,
		PER_SCRIPTED_OBJECT,
		PER_SCRIPT_CELL,
		PER_SCRIPT_BYTE,
		PER_FREE_UNIVERSE,
		PER_FREE_OBJECT,
		PER_FREE_GROUP,
		PER_VERSION,
		PER_LEDGER,
		PER_JOINTED_UNIVERSE,
		PER_JOINT,
		PER_JOINED_OBJECT,
	} per;
	unsigned times, more;
} area_rule;

#define ELEMENT(field) sizeof(*((ob_step_data *)0)->field)
static const area_rule rules[OB_AREAS] = {
	[OB_AREA_CONTROL] = { sizeof(ob_control), FIXED, 0, 1 },
	[OB_AREA_GATE] = { sizeof(ob_gate), FIXED, 0, 1 },
	[OB_AREA_GATE_GROUP] = { sizeof(ob_gate_group), PER_64_WORKERS, 1, 0 },
	[OB_AREA_GATE_CELL] = { sizeof(ob_gate_cell), PER_WORKER, 1, 0 },
	[OB_AREA_WORKER] = { sizeof(ob_worker_cell), PER_WORKER, 1, 0 },
	[OB_AREA_SLOT] = { sizeof(ob_slot), PER_OBJECT, 1, 0 },
	[OB_AREA_PASSPORT] = { sizeof(ob_passport_slot), PER_OBJECT, 1, 0 },
	[OB_AREA_PASSPORT_EVEN] = { sizeof(ob_passport), PER_OBJECT, 1, 0 },
	[OB_AREA_HULL] = { sizeof(ob_hull), PER_HULL, 1, 0 },
	[OB_AREA_STEP_CLOCK] = { sizeof(ob_step_clock), FIXED, 0, 1 },
	[OB_AREA_PIN] = { ELEMENT(pin), PER_OBJECT, 1, 0 },
	[OB_AREA_REQUERY] = { sizeof(uint32_t), PER_OBJECT, 1, 0 },
	[OB_AREA_REQUERY_BIT] = { sizeof(uint64_t), PER_64_OBJECTS, 1, 0 },
	[OB_AREA_COUNTS] = { ELEMENT(count), FIXED, 0, 1 },
	[OB_AREA_SCHEDULE] = { ELEMENT(schedule), PER_OBJECT, 1, 0 },
	[OB_AREA_BOUNDS] = { ELEMENT(bounds), PER_OBJECT, 1, 0 },
	[OB_AREA_RESULT] = { ELEMENT(result), PER_OBJECT, 1, 0 },
	[OB_AREA_EFFORT] = { ELEMENT(effort), PER_OBJECT, 1, 0 },
	[OB_AREA_HOME] = { ELEMENT(home), PER_OBJECT, 1, 0 },
	[OB_AREA_RESULT_ISLAND] = { ELEMENT(result_island), PER_OBJECT, 1, 0 },
	[OB_AREA_NEIGHBOURS] = { ELEMENT(neighbours), PER_OBJECT, 1, 0 },
	[OB_AREA_NEIGHBOUR_ID] = { ELEMENT(neighbour_id), PER_NEIGHBOUR, 1, 0 },
	[OB_AREA_CELL] = { ELEMENT(cell), PER_OBJECT, 1, 0 },
	[OB_AREA_BUCKET] = { ELEMENT(bucket), PER_BUCKET, 1, 0 },
	[OB_AREA_OCCUPIED] = { ELEMENT(occupied), PER_8_BUCKETS, 1, 0 },
	[OB_AREA_PLANE] = { ELEMENT(plane), PER_OBJECT, 1, 0 },
	[OB_AREA_PAIR] = { ELEMENT(pair), PER_PAIR, 1, 0 },
	[OB_AREA_PAIR_LINKS] = { ELEMENT(pair_links), PER_PAIR, 1, 0 },
	[OB_AREA_FIRST_PAIR] = { ELEMENT(first_pair), PER_OBJECT, 1, 0 },
	[OB_AREA_SOLVE] = { sizeof(uint32_t), PER_OBJECT, 1, 0 },
	[OB_AREA_SOLVE_64] = { sizeof(uint32_t), PER_64_OBJECTS, 1, 0 },
	[OB_AREA_SOLVE_4096] = { sizeof(uint32_t), PER_4096_OBJECTS, 1, 0 },
	[OB_AREA_LOOK] = { sizeof(uint32_t), PER_PAIR, 1, 0 },
	[OB_AREA_LOOK_64] = { sizeof(uint32_t), PER_64_PAIRS, 1, 0 },
	[OB_AREA_LOOK_4096] = { sizeof(uint32_t), PER_4096_PAIRS, 1, 0 },
	[OB_AREA_CHECK] = { ELEMENT(check), PER_PAIR, 1, 0 },
	[OB_AREA_RECORD] = { ELEMENT(record), PER_PAIR, 1, 0 },
	[OB_AREA_IMPULSE_B] = { ELEMENT(impulse_b), PER_PAIR, 1, 0 },
	[OB_AREA_RECORD_FREE] = { ELEMENT(record_free), PER_PAIR, 1, 0 },
	[OB_AREA_ISLAND] = { ELEMENT(island), PER_OBJECT, 1, 0 },
	[OB_AREA_MEMBER] = { ELEMENT(member), PER_OBJECT, 1, 0 },
	[OB_AREA_ISLAND_PAIR] = { ELEMENT(island_pair), PER_PAIR, 1, 0 },
	[OB_AREA_CHUNK] = { ELEMENT(chunk), PER_OBJECT, 1, 1 },
	[OB_AREA_SCRIPT_COUNTS] = { ELEMENT(script_counts), PER_SCRIPTED_UNIVERSE, 1, 0 },
	[OB_AREA_SCRIPT_OF] = { ELEMENT(script_of), PER_SCRIPTED_OBJECT, 1, 0 },
	[OB_AREA_SCRIPT_TURN] = { ELEMENT(script_turn), PER_SCRIPT_CELL, 1, 0 },
	[OB_AREA_SCRIPT_CELL] = { ELEMENT(script_cell), PER_SCRIPT_CELL, 1, 0 },
	[OB_AREA_SCRIPT_DUE] = { ELEMENT(script_due), PER_SCRIPT_CELL, 1, 0 },
	[OB_AREA_JOINT_COUNTS] = { ELEMENT(joint_counts), PER_JOINTED_UNIVERSE, 1, 0 },
	[OB_AREA_JOINT] = { ELEMENT(joint), PER_JOINT, 1, 0 },
	[OB_AREA_JOINT_STATE] = { ELEMENT(joint_state), PER_JOINT, 1, 0 },
	[OB_AREA_NEXT_JOINT] = { ELEMENT(next_joint), PER_JOINT, 1, 0 },
	[OB_AREA_FIRST_JOINT] = { ELEMENT(first_joint), PER_JOINED_OBJECT, 1, 0 },
	[OB_AREA_SCRATCH] = { ELEMENT(scratch), PER_OBJECT, 4, 0 },
	[OB_AREA_TASK_NS] = { ELEMENT(task_ns), PER_OBJECT, 1, 0 },
	[OB_AREA_SCRIPT_TEXT] = { 1, PER_SCRIPT_BYTE, 1, 0 },
	[OB_AREA_OUTBOX] = { 1, PER_OUTBOX_BYTE, 1, 0 },
	[OB_AREA_FREE_CONTROL] = { sizeof(ob_free_control), PER_FREE_UNIVERSE, 1, 0 },
	[OB_AREA_FREE_CELL] = { sizeof(ob_free_cell), PER_FREE_OBJECT, 1, 0 },
	[OB_AREA_FREE_GROUP] = { sizeof(ob_free_group), PER_FREE_GROUP, 1, 0 },
	[OB_AREA_FREE_RING] = { sizeof(ob_motion), PER_VERSION, 1, 0 },
	[OB_AREA_FREE_LEDGER] = { sizeof(ob_ledger), PER_LEDGER, 1, 0 },
	[OB_AREA_TRACE_RING] = { sizeof(ob_trace_ring), PER_RING, 1, 0 },
	[OB_AREA_TRACE_EVENT] = { sizeof(ob_trace_event), PER_TRACE_EVENT, 1, 0 },
	[OB_AREA_TRACE_SINCE] = { sizeof(uint64_t), PER_TRACED_OBJECT, 1, 0 },
};

static uint64_t area_bytes(const ob_layout_sizes *s, ob_area area)
{
	const bool traced = s->trace_events > 0, free = s->history > 0;
	const uint64_t count[] = {
		[FIXED] = 0,
		[PER_OBJECT] = s->capacity,
		[PER_64_OBJECTS] = ((uint64_t)s->capacity + 63) / 64,
		[PER_4096_OBJECTS] = ((uint64_t)s->capacity + 4095) / 4096,
		[PER_WORKER] = s->workers,
		[PER_64_WORKERS] = ((uint64_t)s->workers + 63) / 64,
		[PER_PAIR] = s->pairs_max,
		[PER_64_PAIRS] = ((uint64_t)s->pairs_max + 63) / 64,
		[PER_4096_PAIRS] = ((uint64_t)s->pairs_max + 4095) / 4096,
		[PER_BUCKET] = s->buckets,
		[PER_8_BUCKETS] = s->buckets / 8,
		[PER_NEIGHBOUR] = s->neighbours_max,
		[PER_OUTBOX_BYTE] = (uint64_t)s->workers * s->outbox_bytes,
		[PER_HULL] = s->hulls,
		[PER_RING] = traced ? s->workers + OB_TRACE_HOST_RINGS : 0,
		[PER_TRACE_EVENT] =
			traced ? (uint64_t)s->workers * s->trace_events + OB_TRACE_HOST_RINGS * OB_TRACE_HOST_EVENTS
			       : 0,
		[PER_TRACED_OBJECT] = traced ? s->capacity : 0,
		[PER_SCRIPTED_UNIVERSE] = s->script_cells > 0,
		[PER_SCRIPTED_OBJECT] = s->script_cells > 0 ? s->capacity : 0,
		[PER_SCRIPT_CELL] = s->script_cells,
		[PER_SCRIPT_BYTE] = s->script_bytes,
		[PER_FREE_UNIVERSE] = free,
		[PER_FREE_OBJECT] = free ? s->capacity : 0,
		[PER_FREE_GROUP] = free ? ((uint64_t)s->capacity + OB_FREE_GROUP - 1) / OB_FREE_GROUP : 0,
		[PER_VERSION] = (uint64_t)s->capacity * s->history,
		[PER_LEDGER] = (uint64_t)s->capacity * s->ledgers,
		[PER_JOINTED_UNIVERSE] = s->joints > 0,
		[PER_JOINT] = s->joints,
		[PER_JOINED_OBJECT] = s->joints > 0 ? s->capacity : 0,
	};
	const area_rule *r = &rules[area];
	return r->element * (count[r->per] * r->times + r->more);
}

uint64_t ob_layout_element(ob_area area)
{
	return rules[area].element;
}

uint64_t ob_layout_elements_of(const ob_layout_sizes *s, ob_area area, uint32_t ids)
{
	ob_layout_sizes few = *s;
	few.capacity = ids < s->capacity ? ids : s->capacity;
	few.pairs_max = few.neighbours_max = few.hulls = 0;
	return area_bytes(&few, area) / rules[area].element;
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
				      .ledgers = p->ledgers,
				      .joints = p->joints };
	h->sizes.pairs_max = most_pairs(capacity);
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
	if (s->joints > JOINTS_LIMIT)
		return false;
	if (s->history == 1 || s->history > VERSIONS_LIMIT || s->ledgers == 1 || s->ledgers > s->history)
		return false;
	ob_header expected;
	ob_layout_plan(&expected, &(ob_layout_plan_of){ s->capacity, s->workers, s->hulls, s->trace_events > 0,
							s->outbox_bytes > 0, s->script_cells, s->script_bytes,
							s->history, s->ledgers, s->joints });
	return !memcmp(&expected.sizes, s, sizeof *s) && !memcmp(expected.area, h->area, sizeof h->area) &&
	       (h->harden & 1 << OB_HARDEN_OUTBOX) == (s->outbox_bytes ? 1 << OB_HARDEN_OUTBOX : 0) &&
	       expected.bytes == h->bytes && h->bytes <= file_bytes && memchr(h->name, 0, sizeof h->name) &&
	       memchr(h->isolation, 0, sizeof h->isolation);
}

static void bind_step_data(ob_universe *u)
{
	const uint64_t *area = u->header.area;
	char *base = u->base;
	u->step_data = (ob_step_data){
		.objects_max = u->header.sizes.capacity,
		.pairs_max = u->header.sizes.pairs_max,
		.buckets = u->header.sizes.buckets,
		.neighbours_max = u->header.sizes.neighbours_max,
		.count = (void *)(base + area[OB_AREA_COUNTS]),
		.schedule = (void *)(base + area[OB_AREA_SCHEDULE]),
		.bounds = (void *)(base + area[OB_AREA_BOUNDS]),
		.result = (void *)(base + area[OB_AREA_RESULT]),
		.effort = (void *)(base + area[OB_AREA_EFFORT]),
		.home = (void *)(base + area[OB_AREA_HOME]),
		.pin = (void *)(base + area[OB_AREA_PIN]),
		.result_island = (void *)(base + area[OB_AREA_RESULT_ISLAND]),
		.neighbours = (void *)(base + area[OB_AREA_NEIGHBOURS]),
		.neighbour_id = (void *)(base + area[OB_AREA_NEIGHBOUR_ID]),
		.cell = (void *)(base + area[OB_AREA_CELL]),
		.bucket = (void *)(base + area[OB_AREA_BUCKET]),
		.occupied = (void *)(base + area[OB_AREA_OCCUPIED]),
		.plane = (void *)(base + area[OB_AREA_PLANE]),
		.pair = (void *)(base + area[OB_AREA_PAIR]),
		.pair_links = (void *)(base + area[OB_AREA_PAIR_LINKS]),
		.first_pair = (void *)(base + area[OB_AREA_FIRST_PAIR]),
		.solve = { (void *)(base + area[OB_AREA_SOLVE]), (void *)(base + area[OB_AREA_SOLVE_64]),
			   (void *)(base + area[OB_AREA_SOLVE_4096]) },
		.look = { (void *)(base + area[OB_AREA_LOOK]), (void *)(base + area[OB_AREA_LOOK_64]),
			  (void *)(base + area[OB_AREA_LOOK_4096]) },
		.check = (void *)(base + area[OB_AREA_CHECK]),
		.record = (void *)(base + area[OB_AREA_RECORD]),
		.impulse_b = (void *)(base + area[OB_AREA_IMPULSE_B]),
		.record_free = (void *)(base + area[OB_AREA_RECORD_FREE]),
		.island = (void *)(base + area[OB_AREA_ISLAND]),
		.member = (void *)(base + area[OB_AREA_MEMBER]),
		.island_pair = (void *)(base + area[OB_AREA_ISLAND_PAIR]),
		.chunk = (void *)(base + area[OB_AREA_CHUNK]),
		.scratch = (void *)(base + area[OB_AREA_SCRATCH]),
		.task_ns = (void *)(base + area[OB_AREA_TASK_NS]),
	};
	ob_step_data *data = &u->step_data;
	if (u->header.sizes.joints) {
		data->joints_max = u->header.sizes.joints;
		data->joint_counts = (void *)(base + area[OB_AREA_JOINT_COUNTS]);
		data->joint = (void *)(base + area[OB_AREA_JOINT]);
		data->joint_state = (void *)(base + area[OB_AREA_JOINT_STATE]);
		data->next_joint = (void *)(base + area[OB_AREA_NEXT_JOINT]);
		data->first_joint = (void *)(base + area[OB_AREA_FIRST_JOINT]);
	}
	if (!u->header.sizes.script_cells)
		return;
	data->script_cells = u->header.sizes.script_cells;
	data->script_counts = (void *)(base + area[OB_AREA_SCRIPT_COUNTS]);
	data->script_of = (void *)(base + area[OB_AREA_SCRIPT_OF]);
	data->script_turn = (void *)(base + area[OB_AREA_SCRIPT_TURN]);
	data->script_cell = (void *)(base + area[OB_AREA_SCRIPT_CELL]);
	data->script_due = (void *)(base + area[OB_AREA_SCRIPT_DUE]);
	data->script_text = (void *)(base + area[OB_AREA_SCRIPT_TEXT]);
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
	u->step_clock = (void *)(u->base + area[OB_AREA_STEP_CLOCK]);
	u->slot = (void *)(u->base + area[OB_AREA_SLOT]);
	u->passport = (void *)(u->base + area[OB_AREA_PASSPORT]);
	u->passport_even = (void *)(u->base + area[OB_AREA_PASSPORT_EVEN]);
	u->hull = (void *)(u->base + area[OB_AREA_HULL]);
	u->requery = (void *)(u->base + area[OB_AREA_REQUERY]);
	u->requery_bit = (void *)(u->base + area[OB_AREA_REQUERY_BIT]);
	u->free.control = (void *)(u->base + area[OB_AREA_FREE_CONTROL]);
	u->free.cell = (void *)(u->base + area[OB_AREA_FREE_CELL]);
	u->free.group = (void *)(u->base + area[OB_AREA_FREE_GROUP]);
	u->free.ring = (void *)(u->base + area[OB_AREA_FREE_RING]);
	u->free.ledger = (void *)(u->base + area[OB_AREA_FREE_LEDGER]);
	u->outbox_area = u->base + area[OB_AREA_OUTBOX];
	u->trace_ring = (void *)(u->base + area[OB_AREA_TRACE_RING]);
	u->trace_event = (void *)(u->base + area[OB_AREA_TRACE_EVENT]);
	u->trace_since = (void *)(u->base + area[OB_AREA_TRACE_SINCE]);
	bind_step_data(u);
}
