// Layout of the shared segment. Offsets only, as each process maps it elsewhere.
//
//   0        header: written once by the creator, the magic last
//   area[]   one run of equal elements each, on page borders, in the order of ob_area
//
// Capacities are generous, as untouched pages cost nothing. A change of any struct here or in the public headers needs
// a new OB_LAYOUT_VERSION.
#ifndef OB_TABLE_LAYOUT_H
#define OB_TABLE_LAYOUT_H

#include "table/free.h"
#include "table/gate.h"
#include "table/group.h"
#include "table/slot.h"
#include "table/table.h"
#include "table/trace.h"

#define OB_LAYOUT_MAGIC 0x32304d495342554fu // "OUBSIM02" in memory, little-endian byte order
enum { OB_LAYOUT_VERSION = 53, OB_LAYOUT_PAGE = 4096 };

// Areas in their order: the name, the pointer of ob_universe to the first element, and the number of elements by the sizes s
// (layout.c).
// clang-format off
#define OB_LAYOUT_AREAS(X) \
	X(CONTROL, control, 1) \
	X(GATE, gate, 1) \
	X(GATE_GROUP, gate_group, groups(s->workers, 64)) \
	X(GATE_CELL, gate_cell, s->workers) \
	X(WORKER, worker, s->workers) \
	X(SLOT, slot, s->capacity) \
	X(PASSPORT, passport, s->capacity) \
	X(PASSPORT_EVEN, passport_even, s->capacity) \
	X(HULL, hull, s->hulls) \
	X(TERRAIN, terrains, s->terrain_bytes) /* bytes: an ob_terrain_set; empty unless the scene has terrains */ \
	X(STEP_CLOCK, step_clock, 1) \
	X(PIN, step_data.pin, s->capacity) \
	X(REQUERY, requery, s->capacity) /* ids */ \
	X(REQUERY_BIT, requery_bit, groups(s->capacity, 64)) /* ids that are on the list */ \
	X(COUNTS, step_data.count, 1) \
	X(SCHEDULE, step_data.schedule, s->capacity) \
	X(BOUNDS, step_data.bounds, s->capacity) \
	X(RESULT, step_data.result, s->capacity) \
	X(EFFORT, step_data.effort, s->capacity) \
	X(HOME, step_data.home, s->capacity) \
	X(RESULT_ISLAND, step_data.result_island, s->capacity) \
	X(NEIGHBOURS, step_data.neighbours, s->capacity) \
	X(NEIGHBOUR_ID, step_data.neighbour_id, s->neighbours_max) \
	X(CELL, step_data.cell, s->capacity) \
	X(BUCKET, step_data.bucket, s->buckets) \
	X(OCCUPIED, step_data.occupied, s->buckets / 8) \
	X(PLANE, step_data.plane, s->capacity) \
	X(PAIR, step_data.pair, s->pairs_max) \
	X(PAIR_LINKS, step_data.pair_links, s->pairs_max) \
	X(FIRST_PAIR, step_data.first_pair, s->capacity) \
	X(SOLVE, step_data.solve.one, s->capacity) \
	X(SOLVE_64, step_data.solve.of_64, groups(s->capacity, 64)) \
	X(SOLVE_4096, step_data.solve.of_4096, groups(s->capacity, 4096)) \
	X(LOOK, step_data.look.one, s->pairs_max) \
	X(LOOK_64, step_data.look.of_64, groups(s->pairs_max, 64)) \
	X(LOOK_4096, step_data.look.of_4096, groups(s->pairs_max, 4096)) \
	X(CHECK, step_data.check, s->pairs_max) \
	X(RECORD, step_data.record, s->pairs_max) \
	X(IMPULSE_B, step_data.impulse_b, s->pairs_max) \
	X(RECORD_FREE, step_data.record_free, s->pairs_max) \
	X(ISLAND, step_data.island, s->capacity) \
	X(MEMBER, step_data.member, s->capacity) \
	X(ISLAND_PAIR, step_data.island_pair, s->pairs_max) \
	X(CHUNK, step_data.chunk, s->capacity + 1) \
	X(SCRIPT_COUNTS, step_data.script_counts, s->script_cells > 0) /* these five empty unless the scene has scripts */ \
	X(SCRIPT_OF, step_data.script_of, s->script_cells > 0 ? s->capacity : 0) \
	X(SCRIPT_TURN, step_data.script_turn, s->script_cells) \
	X(SCRIPT_CELL, step_data.script_cell, s->script_cells) \
	X(SCRIPT_DUE, step_data.script_due, s->script_cells) \
	X(JOINT_COUNTS, step_data.joint_counts, s->joints > 0) /* these five empty unless the universe has room for joints */ \
	X(JOINT, step_data.joint, s->joints) \
	X(JOINT_STATE, step_data.joint_state, s->joints) \
	X(NEXT_JOINT, step_data.next_joint, s->joints) \
	X(FIRST_JOINT, step_data.first_joint, s->joints > 0 ? s->capacity : 0) \
	X(SENSOR, step_data.sensor, s->sensors) /* these three empty unless the scene has sensors */ \
	X(SENSOR_CELL, step_data.sensor_cell, s->sensors) \
	X(SENSOR_VALUE, step_data.sensor_value, s->sensor_values) \
	X(SCRATCH, step_data.scratch, 4 * (uint64_t)s->capacity) \
	X(TASK_NS, step_data.task_ns, s->capacity) \
	X(SCRIPT_TEXT, step_data.script_text, s->script_bytes) \
	X(OUTBOX, outbox_area, (uint64_t)s->workers * s->outbox_bytes) /* per worker; empty unless simulators are contained */ \
	X(FREE_CONTROL, free.control, free) /* these empty unless the run is free (free.h) */ \
	X(FREE_CELL, free.cell, free ? s->capacity : 0) \
	X(FREE_GROUP, free.group, free ? groups(s->capacity, OB_FREE_GROUP) : 0) \
	X(FREE_BED, free.bed, free ? s->workers : 0) \
	X(FREE_RING, free.ring, (uint64_t)s->capacity * s->history) \
	X(FREE_PLACE, free.place, s->grouped ? s->capacity : 0) /* these four empty unless bodies are solved in groups (group.h) */ \
	X(FREE_STATE, free.state, s->grouped ? OB_GROUP_VERSIONS * (uint64_t)s->capacity : 0) \
	X(FREE_CONTACT, free.contact, s->grouped ? 2 * (uint64_t)s->capacity * OB_GROUP_USUALLY : 0) \
	X(FREE_CONTACT_MORE, free.more_contact, s->grouped ? 2 * (uint64_t)s->capacity * (s->grouped - OB_GROUP_USUALLY) : 0) \
	X(TRACE_RING, trace_ring, traced ? s->workers + OB_TRACE_HOST_RINGS : 0) /* from here on empty unless traced */ \
	X(TRACE_EVENT, trace_event, traced ? (uint64_t)s->workers * s->trace_events + OB_TRACE_HOST_RINGS * OB_TRACE_HOST_EVENTS : 0) /* rings of the workers, then of the host */ \
	X(TRACE_SINCE, trace_since, traced ? s->capacity : 0) /* ns */
// clang-format on

#define OB_AREA_NAME(name, pointer, count) OB_AREA_##name,
typedef enum ob_area { OB_LAYOUT_AREAS(OB_AREA_NAME) OB_AREAS } ob_area;

typedef struct ob_layout_sizes {
	uint32_t capacity, workers, pairs_max, buckets, neighbours_max;
	uint32_t trace_events; // size of each worker's ring, a power of two; 0 = not traced
	uint32_t outbox_bytes; // size per worker, whole pages; 0 = simulators are not contained (outbox.h)
	uint32_t hulls;
	uint32_t script_cells; // objects that can have a script at the same time; 0 = the scene has none
	uint32_t script_bytes; // size of their texts, with the directory
	uint32_t history; // versions of each motion that a free run keeps; 0 = the run is in lockstep
	uint32_t grouped; // contacts of each body that a free run solved in groups has room for; 0 = it has no groups
	uint32_t joints;
	uint32_t terrain_bytes;
	uint32_t sensors, sensor_values; // sensors; numbers that their samples take
} ob_layout_sizes;

// The first two fields have the same place in all versions. A file with the same magic is owned through its lock
// (segment.h).
typedef struct ob_header {
	uint64_t magic;
	uint32_t version;
	int32_t host_pid;
	uint64_t bytes; // size of the whole segment
	uint64_t created; // ns, CLOCK_REALTIME
	uint64_t area[OB_AREAS]; // offsets
	ob_layout_sizes sizes;
	char name[OB_NAME_MAX];
	char isolation[16];
	ob_run_settings run;
	uint32_t harden; // bits, 1 << ob_harden_measure
	uint32_t checked; // 1 = as ob_universe_setup.checked
} ob_header;

// State that changes as the run goes on. Counters that several workers update have a cache line each.
typedef struct ob_control {
	_Alignas(64) uint64_t step;
	uint64_t pause_step;
	uint64_t contacts_step; // as ob_contacts_want
	uint32_t state; // ob_universe_state
	uint32_t ids, objects;
	uint32_t awake, pairs, islands;
	uint32_t lives; // number of restarts of all simulators
	uint32_t hulls; // one past the highest number ever written
	_Alignas(64) uint64_t claim_next;
	uint32_t claim_total, claim_first, claim_workers;
	_Alignas(64) uint64_t requery_count;
	_Alignas(64) uint64_t neighbours_used;
	_Alignas(64) uint32_t deaths; // number of deaths of simulators so far
	uint32_t frozen; // objects frozen by them
	char last_death[OB_DEATH_MAX]; // as ob_universe_info
	_Alignas(64) uint64_t move; // requested move (home.h); 0 = none
	uint32_t pins; // objects with a pin
	uint32_t is_read; // 1 = another program has attached the universe, when the host checked last
} ob_control;

// Durations of steps. The gate orders its writers, but any worker may raise longest_ns and beside_ns, and the sums grow
// after the gate has opened: all but begun_ns are atomic.
typedef struct ob_step_clock {
	_Alignas(64) uint64_t begun_ns; // start of the running step, ob_clock_ns
	uint64_t longest_ns; // CPU time of the busiest worker in the running phase; see above
	uint64_t beside_ns; // same for work outside the phase's tasks
	uint64_t critical_ns; // sum of these over all phases, and of scheduling; see above
	uint64_t simulated_ns; // same for OB_SIMULATED_WORKERS
	uint64_t alone_ns; // share of scheduling in these
	ob_latency latency;
} ob_step_clock;

typedef struct ob_worker_cell {
	_Alignas(64) uint64_t cpu_ns;
	int32_t pid, tid, cpu;
	uint32_t objects;
	uint32_t working_on; // 1 + the object that the worker is processing; 0 = none, or it is contained (outbox.c)
	_Alignas(64) ob_counters counters;
	uint64_t faults[OB_FAULT_KINDS]; // injected faults
} ob_worker_cell;

// The writer's words, the reader's word; trace.h has the drawing. A page each, so that the writer alone can have write
// access to its own.
typedef struct ob_trace_ring {
	_Alignas(OB_LAYOUT_PAGE) uint64_t written;
	uint64_t taken_seen, lost, doing;
	_Alignas(64) uint64_t taken;
} ob_trace_ring;

// The rings of the host are large, as objects may be added by the thousand.
enum { OB_TRACE_HOST_RINGS = 2, OB_TRACE_HOST_EVENTS = 1 << 16 };

static_assert(sizeof(ob_trace_event) == 32 && sizeof(ob_trace_ring) == OB_LAYOUT_PAGE, "trace");
static_assert(sizeof(ob_run_settings) == 128, "run settings");
static_assert(sizeof(ob_header) == 96 + 8 * OB_AREAS + OB_NAME_MAX + 16 + sizeof(ob_run_settings) + 8, "header");
static_assert(sizeof(ob_header) <= OB_LAYOUT_PAGE, "the header has the first page");
static_assert(sizeof(ob_control) == 576, "control");
static_assert(sizeof(ob_worker_cell) == 960, "worker cell");
static_assert(sizeof(ob_pair_state) == 256, "pair state");
static_assert(sizeof(ob_pair_record) == 520, "pair record");
static_assert(sizeof(ob_pair_key) == 32 && sizeof(ob_schedule) == 24, "step data");

// A process's view of a mapped segment. Immutable once made; forked children continue to use it.
struct ob_universe {
	char *base;
	int fd; // of the segment; its owner's, and all that forked from it, share the lock
	uint32_t rank, ranks; // its owner's (table.h)
	bool shares_contacts; // likewise
	bool unshared;
	bool lost; // a reader's: its file was found truncated (reader.c)
	uint64_t *taken; // bit per page that this process has reserved (pages.h); NULL: a reader
	struct ob_used_pages *used; // of the step's areas (pages.h); NULL: a reader
	ob_header header; // private copy, validated: later changes to the shared one have no effect
	ob_control *control;
	ob_gate *gate;
	ob_gate_group *gate_group;
	ob_gate_cell *gate_cell;
	ob_worker_cell *worker;
	ob_step_clock *step_clock;
	ob_slot *slot;
	ob_passport_slot *passport;
	ob_passport *passport_even;
	ob_hull *hull;
	const ob_terrain_set *terrains;
	uint32_t *requery;
	uint64_t *requery_bit;
	ob_step_data step_data;
	struct {
		ob_free_control *control;
		ob_free_cell *cell;
		ob_free_group *group;
		ob_free_bed *bed;
		ob_motion *ring;
		uint64_t *place;
		ob_group_state *state;
		ob_group_contact *contact, *more_contact;
	} free; // only if the run is free
	char *outbox_area;
	struct ob_outbox *outbox; // if this process is a contained simulator; NULL: it writes in place
	ob_trace_ring *trace_ring; // these three only if traced
	ob_trace_event *trace_event;
	uint64_t *trace_since;
	struct { // table/desk.h; base NULL: none
		char *base;
		uint32_t foreign;
		int bell;
	} desks;
};

// Input of a layout.
typedef struct ob_layout_plan_of {
	uint32_t capacity, workers, hulls;
	bool traced, contained;
	uint32_t script_cells, script_bytes;
	uint32_t history, grouped, joints;
	uint32_t terrain_bytes;
	uint32_t sensors, sensor_values;
} ob_layout_plan_of;

// Fills sizes (from the input), offsets and bytes.
void ob_layout_plan(ob_header *h, const ob_layout_plan_of *p);
// Makes this process's own trace ring writable; the rest of its mapping stays read-only. Returns false, and errno.
bool ob_trace_unprotect(ob_universe *u, uint32_t ring);
// Sleeps until the gate gives the worker a turn other than "done", the last at which it arrived; returns its phase. marks:
// the worker can write the gate, and marks there that it sleeps. A contained simulator cannot.
ob_phase ob_gate_wait(ob_universe *u, uint32_t worker, uint32_t done, bool marks);
// Counts the worker off; returns true if it is the last.
bool ob_gate_arrive(ob_universe *u, uint32_t worker);
// Called by the host after a restart, together with the gate: outboxes are empty, and no simulator is busy. Simulators
// may come to the gate when the arranger already waits there; it would otherwise take data left by their predecessors
// for theirs.
void ob_outboxes_reset(ob_universe *u);
// True if a header from outside is one that this program would have planned, in a file of file_bytes.
bool ob_layout_valid(const ob_header *h, uint64_t file_bytes);
// Bytes that a full universe with a few contacts per object will touch: minimum of free space in the memory file
// system.
uint64_t ob_layout_likely_bytes(const ob_header *h);
// Bytes of an element of an area. Number of elements for the first ids objects: proportional if it grows with the
// objects; all if it has a fixed size; none if it grows with pairs or neighbours.
uint64_t ob_layout_element(ob_area area);
uint64_t ob_layout_elements_of(const ob_layout_sizes *s, ob_area area, uint32_t ids);
// Copies the newest body properties; returns false if there have never been any. Any reader.
bool ob_passport_read(const ob_universe *u, uint32_t id, ob_passport *out);
// Likewise up to the moments of inertia; the rest of *out stays as it was.
bool ob_passport_read_body(const ob_universe *u, uint32_t id, ob_passport *out);
// True if the numbers of a record from outside are plausible for an object.
bool ob_passport_makes_sense(const ob_passport *p, uint32_t id);
bool ob_motion_makes_sense(const ob_motion *m);
// Points the view at a mapping of u->header's layout.
void ob_layout_bind(ob_universe *u, void *base);

#endif
