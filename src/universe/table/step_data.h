// Shared data of one universe's object simulators within a step. Plain data in shared memory; the gate orders every
// access: the phase determines each worker's access rights (the table above step/step.c).
#ifndef OB_TABLE_STEP_DATA_H
#define OB_TABLE_STEP_DATA_H

#include <stddef.h>
#include <stdint.h>

#include <ob/joint.h>
#include <ob/sensor.h>
#include <ob/universe.h>

#include "table/pair_state.h"
#include "table/request_kind.h"

// ---- script data

// Data of scripts in the universe: each scripted object has a cell, numbered apart from ids, so that objects without a
// script cost nothing.
//
//   script_of[object] ──> 1 + cell ──> script_turn[cell]   when it runs: 24 bytes, read before each step
//                                      script_cell[cell]   state, mail, contacts, requests
//   script_text                        the texts of all scripts, written once by the host
//
// Ordered by the gate, like all data of the step: while scripts run, a worker writes the cells of the objects that it
// runs, and no others. The solver of an object's island notes its contacts there. In between, the scheduling worker.

enum {
	OB_SCRIPTS_MAX = 64, // texts of a universe
	OB_SCRIPT_STATE_BYTES = 1024, // maximum of an object's state
	OB_SCRIPT_INBOX_BYTES = 1536, // maximum of pending messages of an object
	OB_SCRIPT_OUTBOX_BYTES =
		4096, // maximum of an object's requests in a step: messages, creations, paths and others
	OB_SCRIPT_TOUCHES = 16, // contacts of an object that begin in a step and are reported to it
	OB_SCRIPT_ERROR_BYTES = 192,
	OB_SCRIPT_BATCH = 32, // objects with the same foreign code that run in one exchange, at most
};

enum { // ob_script_turn.flags
	OB_SCRIPT_STARTED = 1 << 0, // on_start is over
	OB_SCRIPT_STOPPED = 1 << 1, // by an error, which the cell holds: it never runs again
	OB_SCRIPT_EACH_STEP = 1 << 2, // it has an on_step
	OB_SCRIPT_TOUCHED = 1 << 3, // the cell has new contacts
	OB_SCRIPT_MAIL = 1 << 4, // the cell has messages
	OB_SCRIPT_LEAVING = 1 << 5, // another script removes its object: on_stop is due
	OB_SCRIPT_FEELS = 1 << 6, // it has an on_contact
	OB_SCRIPT_WARNED = 1 << 7, // what it does is of no effect, as the cell's error says
	OB_SCRIPT_BROKE = 1 << 8, // a joint of its object may have broken in the last step
};

typedef struct ob_script_turn {
	uint32_t object, generation;
	uint32_t script; // 1 + number of its text; 0: the cell is free
	uint32_t flags; // OB_SCRIPT_*
	uint32_t wake; // the step (from 0) before which on_wake is due; UINT32_MAX: none is
	uint32_t zero;
} ob_script_turn;

typedef struct ob_script_touch {
	uint32_t other, generation;
	double impulse; // N s, normal, in the step in which they began to touch
	ob_vec3 point; // m
} ob_script_touch;

enum { // ob_script_cell.asks: requests of a script for its own object in the running step
	OB_SCRIPT_ASKS_FORCE = 1 << 0,
	OB_SCRIPT_ASKS_TORQUE = 1 << 1,
	OB_SCRIPT_ASKS_PUSH = 1 << 2, // push and twist hold
	OB_SCRIPT_ASKS_COLOUR = 1 << 3,
	OB_SCRIPT_ASKS_POST = 1 << 4, // the outbox is not empty
	OB_SCRIPT_ASKS_ERROR = 1 << 5, // the script has failed just now, or is warned of
};

typedef struct ob_script_cell {
	uint64_t random[4]; // state of its random numbers
	ob_vec3 torque; // N m, world frame, acts until the script sets another
	ob_vec3 force, next_torque, push, twist; // requested: N, N m, N s, N m s
	float colour[4];
	uint32_t asks;
	uint32_t state_bytes, inbox_bytes, outbox_bytes, touches, failed_step;
	ob_script_touch touch[OB_SCRIPT_TOUCHES];
	char error[OB_SCRIPT_ERROR_BYTES];
	unsigned char state[OB_SCRIPT_STATE_BYTES], inbox[OB_SCRIPT_INBOX_BYTES], outbox[OB_SCRIPT_OUTBOX_BYTES];
} ob_script_cell;

// Record of an outbox, one after the other; in an inbox, the same with the sender in place of the addressee. Contents by kind:
//
//   MESSAGE                values (scene/flat.h)
//   ADD                    an ob_object_def, the state of its script, and the corners of a hull
//   MOTOR                  an ob_script_motor
//   JOIN, UNJOIN           an ob_joint_passport, of the joint that is to come or to go
//   STATE, SURFACE, PATH   of the script's own object: the numbers of the request's fields (host/request_table.h), or an ob_script_path
//   REMOVE                 nothing
typedef struct ob_script_post {
	uint32_t kind; // ob_request_kind
	uint32_t bytes; // length of the contents, in whole words of 8: `used` of them are valid
	uint32_t used, line; // line: place of the request in the script
	uint32_t object, generation; // addressee, or object to be removed
} ob_script_post;

// Request of a script: the new target of a joint's motor.
typedef struct ob_script_motor {
	uint32_t joint, zero;
	double target; // m/s, rad/s, or m, rad
} ob_script_motor;

// Request of a script: a path from where its object is, through these points.
typedef struct ob_script_path {
	uint32_t loop, turns; // 0 or 1
	ob_path_point point[]; // to the end of the post
} ob_script_path;

// At the start of the area of texts.
typedef struct ob_script_directory {
	uint32_t scripts, zero;
	struct {
		char name[OB_NAME_MAX]; // for messages: of its file
		uint32_t offset, size; // from the start of the area
	} text[OB_SCRIPTS_MAX];
} ob_script_directory;

#define OB_SCRIPT_FOREIGN 0x7f // first byte of a text that is no Lua but an FMU (fmu/instance.h)

// True if the script of this number, from 1, is foreign code.
static inline bool ob_script_is_foreign(const ob_script_directory *d, uint32_t script)
{
	return script >= 1 && script <= OB_SCRIPTS_MAX && d->text[script - 1].size > 0 &&
	       ((const char *)d)[d->text[script - 1].offset] == OB_SCRIPT_FOREIGN;
}

// Number of texts below this one, from 1, that are foreign code.
static inline uint32_t ob_script_count_foreign(const ob_script_directory *d, uint32_t script)
{
	uint32_t n = 0;
	for (uint32_t i = 1; i < script && i <= d->scripts; i++)
		n += ob_script_is_foreign(d, i);
	return n;
}

// Counts of the run so far, and of the phase in which scripts run.
typedef struct ob_script_counts {
	uint32_t cells; // one past the highest that was ever used
	uint32_t due; // length of the list of cells that run in this step
	uint32_t ran_for; // 1 + the step (from 0) before which scripts have run
	uint32_t requests; // in the outboxes of that list, which the host carries out now
	uint32_t failed; // objects whose script was stopped by an error, and those whose script is warned of
	uint32_t lost; // messages that found their addressee's inbox full
	uint32_t pause_for; // 1 + the step (from 0) before which the run pauses once scripts have run; 0: none
	uint32_t stopped; // objects whose script an error has stopped so far
	uint64_t calls; // of objects' scripts
} ob_script_counts;

// Step, as ob_script_counts.ran_for. The host looks while workers run, and again when they pause.
static inline uint32_t ob_scripts_ran_for(const ob_script_counts *c)
{
	return __atomic_load_n(&c->ran_for, __ATOMIC_RELAXED);
}

static inline void ob_scripts_set_ran_for(ob_script_counts *c, uint32_t step)
{
	__atomic_store_n(&c->ran_for, step, __ATOMIC_RELAXED);
}

static inline bool ob_script_is_due(const ob_script_turn *t, uint64_t step)
{
	enum { NOW = OB_SCRIPT_EACH_STEP | OB_SCRIPT_TOUCHED | OB_SCRIPT_MAIL | OB_SCRIPT_LEAVING | OB_SCRIPT_BROKE };
	return t->script && !(t->flags & OB_SCRIPT_STOPPED) &&
	       (!(t->flags & OB_SCRIPT_STARTED) || t->flags & NOW || t->wake <= step);
}

// ---- step data

typedef struct ob_pair_record {
	ob_pair_state version[2];
	uint32_t stamp[2]; // 1 + steps that are complete when the version holds; 0 = never written
} ob_pair_record;

// Index of the newest version that held when so many steps were complete; -1: none. A version written in a step that is
// being solved again is newer.
static inline int ob_pair_newest(const ob_pair_record *r, uint64_t steps)
{
	int newest = -1;
	for (int k = 0; k < 2; k++)
		if (r->stamp[k] && r->stamp[k] <= steps + 1 && (newest < 0 || r->stamp[k] > r->stamp[newest]))
			newest = k;
	return newest;
}

// State of a pair when so many steps were complete; NULL if it had never touched until then. A step's solver reads
// that, and writes the other version, which holds when one more step is complete; so a step can be solved again.
static inline const ob_pair_state *ob_pair_before(const ob_pair_record *r, uint64_t steps)
{
	int k = ob_pair_newest(r, steps);
	return k < 0 ? NULL : &r->version[k];
}

static inline ob_pair_state *ob_pair_write(ob_pair_record *r, uint64_t steps)
{
	int k = ob_pair_newest(r, steps) == 0;
	r->stamp[k] = (uint32_t)(steps + 2);
	return &r->version[k];
}

#define OB_NO_RECORD UINT32_MAX
#define OB_PAIR_ENDS UINT32_C(0x80000000) // there are fewer pairs, and fewer objects

// A pair of objects whose fat AABBs overlap. An unused one has a == b.
typedef struct ob_pair_key {
	uint32_t a, b; // ids, a < b
	uint32_t record; // index of its ob_pair_record; OB_NO_RECORD = none: it did not touch when the step began
	uint32_t active : 1; // 1 = touching: its record has points
	uint32_t expected : 1; // 1 = apart, and expected to touch in the coming step
	// 1 = a late contact: it touched in this step unexpectedly; both islands are merged and solved again
	uint32_t late : 1;
	uint32_t in_island : 1; // 1 = its island's solver handles it in this step
	// Parts of compounds, from 1: each part that may touch has a pair. 0: the object as a whole.
	uint32_t part_a : 4, part_b : 4;
	uint32_t region : 20; // of a terrain, if one of the two is, from 1: each region that is near has a pair
	double limit; // m: the pair cannot touch before path_a + path_b exceeds this
	uint32_t
		clear_until; // the pair cannot touch before this step (from 0) either, provided that neither object has
	uint32_t clear_as_of; // published another motion since so many steps were complete
} ob_pair_key;

static inline uint32_t ob_pair_parts(const ob_pair_key *k)
{
	return (uint32_t)k->part_a << 28 | (uint32_t)k->part_b << 24 | k->region;
}

// For qsort: by ids, then by parts, ascending. Places in pair[] depend on the run, so code that needs an order sorts.
static inline int ob_pairs_by_ids(const void *x, const void *y)
{
	const ob_pair_key *a = x, *b = y;
	if (a->a != b->a || a->b != b->b)
		return a->a != b->a ? (a->a < b->a ? -1 : 1) : a->b < b->b ? -1 : 1;
	return ob_pair_parts(a) < ob_pair_parts(b) ? -1 : ob_pair_parts(a) > ob_pair_parts(b);
}

// A pair's place in the lists of pairs of its two objects (step/pairs.h): [0] in that of a, [1] in that of b. Links are
// 1 + 2 times the next pair's index, plus 1 if the list is that of its b; 0 ends. next[0] of an unused pair is 1 + the
// next unused one.
typedef struct ob_pair_links {
	uint32_t next[2], before[2];
} ob_pair_links;

// A calendar (schedule/calendar.h), of objects or of pairs: urgency of each, and the maximum of 64 and of 4096.
typedef struct ob_calendar_levels {
	uint32_t *one, *of_64, *of_4096;
} ob_calendar_levels;

// Raises a word to an urgency; with several workers the maximum stays, in any order. Returns false if it was as urgent
// already. The gate orders it with readers of raised words, so relaxed is enough.
static inline bool ob_calendar_level_raise(uint32_t *level, uint32_t urgency)
{
	uint32_t seen = __atomic_load_n(level, __ATOMIC_RELAXED);
	if (seen >= urgency)
		return false;
	while (seen < urgency &&
	       !__atomic_compare_exchange_n(level, &seen, urgency, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
		;
	return true;
}

// Schedule record: the scheduler's data of an object, 24 bytes, so that it need not read the slots.
typedef struct ob_schedule {
	double path; // m, when "since" steps were complete
	float reach; // m, bound on the displacement of its points per step, until it is solved again
	uint32_t state; // OB_SCHEDULE_*
	uint32_t since;
	uint32_t due; // step (from 0) that must solve it, unless another body comes near before
} ob_schedule;

enum {
	OB_SCHEDULE_ABSENT,
	OB_SCHEDULE_PLANE, // static; a ballistic advance ends before contact with the plane
	OB_SCHEDULE_STATIC,
	OB_SCHEDULE_KINEMATIC, // no simulator solves it; the host publishes its motions
	OB_SCHEDULE_AWAKE,
	OB_SCHEDULE_ASLEEP, // this state and the next: skipped until another body comes near
	OB_SCHEDULE_EQUILIBRIUM,
};

// True for an object that a simulator solves.
static inline bool ob_schedule_is_dynamic(const ob_schedule *s)
{
	return s->state >= OB_SCHEDULE_AWAKE;
}

// True if it may move in a step without being woken.
static inline bool ob_schedule_moves(const ob_schedule *s)
{
	return s->state == OB_SCHEDULE_AWAKE || s->state == OB_SCHEDULE_KINEMATIC;
}

// Upper bound of an object's path (m) when "steps" steps are complete: it grows by its reach in each step that does not
// solve it.
static inline double ob_schedule_path(const ob_schedule *s, uint64_t steps)
{
	return s->path + ((double)steps - s->since) * (double)s->reach;
}

typedef struct ob_island {
	uint32_t first_member, members; // range in member[]; sorted by id, the first leads
	uint32_t first_pair, pairs; // range in island_pair[]; sorted by (a, b)
	uint32_t work; // estimated cost of solving it, in solver iterations of one pair
	uint32_t solved; // 1 = its solution of this step is valid, unless a late contact involves one of its bodies
} ob_island;

typedef struct ob_index_cell {
	uint32_t next; // 1 + next object in the same bucket; 0 ends
	int32_t level; // size class of its bounds, from 1; 0 = not in the index
	int32_t x, y, z; // cell at that level
	uint32_t before, after; // 1 + its neighbours in the list of all objects of that class; 0 = none
} ob_index_cell;

enum { OB_STEP_BLAME_MAX = 200 }; // bytes of a blame's text

// State of a joint that changes by steps. A step writes the version that the step before has not written.
typedef struct ob_joint_state {
	uint32_t broke; // number of complete steps when it had broken, so from then on it holds nothing; 0: it holds
	uint32_t zero;
	uint32_t stamp[2]; // number of complete steps after which each version was the newest
	struct {
		ob_vec3 force, torque; // as ob_joint_load
		double along;
	} version[2];
} ob_joint_state;

typedef struct ob_joint_counts {
	uint32_t used; // one past the highest number of a joint
	uint32_t writes; // twice the passports written; odd: one is being written, so readers try again
} ob_joint_counts;

// A body when earlier steps began.
enum { OB_PAST_STEPS = 5 };
typedef struct ob_past {
	ob_state before; // one step ago
	ob_vec3 older[OB_PAST_STEPS][2]; // velocities and rates, two steps ago and more
} ob_past;

// Data of a sensor that change, beside the samples. Written by its object's simulator.
typedef struct ob_sensor_cell {
	uint64_t taken; // samples so far: the number of the last one
	uint64_t step; // number of complete steps when `past` holds
	uint64_t known; // steps in a row that past knows
	ob_past past[2]; // of its object, or of both ends of its joint
} ob_sensor_cell;

enum { OB_SENSOR_NUMBERS_MAX = 1 << 25 }; // 256 MiB of samples

// The areas, as pointers into this process's mapping (made once per process by the table module).
typedef struct ob_step_data {
	uint32_t objects_max, pairs_max, buckets, neighbours_max;
	struct ob_step_counts {
		uint32_t pairs; // maximum ever used at the same time: used ones lie before this index, with gaps
		uint32_t pairs_idle; // unused ones among these
		uint32_t first_idle; // 1 + one of them, the head of a list
		uint32_t islands, chunks, records_used; // several ranks: of this one
		uint32_t unsolved; // islands to be solved: they come first, and so do their bodies
		uint32_t shared; // 1 = chunk w is worker w's; 0 = chunks are claimed
		int32_t records_free; // on the stack; below 0: requests made when it was empty
		uint32_t scheduler; // the worker that scheduled last
		uint32_t merged; // 1 = islands that late contacts merged are being solved again
		uint32_t awake; // objects
		uint32_t kinematic; // objects
		uint32_t checked; // steps that were complete, or solved, at the last check of all pairs
		uint32_t late; // 1 = that check found a late contact; any worker may write it
		uint32_t checks; // pairs in check[]
		uint32_t next_due; // several ranks: no calendar has an entry before this step
		uint32_t island_pairs; // in island_pair[]
		uint32_t involved; // bodies in islands of the coming step, found so far
		uint32_t due; // those of them that were found first, as they are due
		// 1 = each object is the root of a tree before islands are built, so that several workers can build
		// them
		uint32_t rooted;
		uint64_t visits; // objects and pairs visited by scheduling so far
		uint32_t levels[64]; // objects per size class
		uint64_t levels_used; // a bit for each class in use
		uint32_t level_first[64]; // 1 + one of them, the head of a list
		int32_t level_low[64][3], level_high[64][3]; // bounds of all their cells
		uint32_t planes;
		uint64_t failure; // object << 32 | ob_step_failure, from ob_step_fail; 0 = none
		uint64_t work; // in the step so far (step/budget.h)
		uint32_t culprit; // 1 + the worker to blame for damage; 0 = unknown
		char blamed_for[OB_STEP_BLAME_MAX];
	} * count;
	ob_schedule *schedule; // [object]: written by its island's solver
	float (*bounds)[6]; // [object]: fat AABB, valid until it requests another
	ob_motion *result; // [object]: result of its island's solver
	uint32_t *effort; // [object]: its share of its island's cost at the last solution, as ob_island.work
	uint32_t *home; // [object]: 1 + the worker that had it last (home.h); 0 = none
	// [object]: 1 + the worker that it was moved to; 0 = none. Not part of the run's state: a checkpoint in memory
	// does not restore it
	uint32_t *pin;
	uint32_t *result_island; // [object]: index of its island in the running step; UINT32_MAX = none
	struct ob_neighbours {
		uint32_t offset, count; // place in neighbour_id; their number, UINT32_MAX = a query is pending
	} * neighbours; // [object]
	// arena: for each query its number of changes, then these: pairs that end, as OB_PAIR_ENDS | index, and ids of
	// new neighbours, ascending
	uint32_t *neighbour_id;
	ob_index_cell *cell; // [object]
	uint32_t *bucket; // [buckets]: 1 + first object; 0 = empty
	uint64_t *occupied; // [buckets / 8]: a bit for each eighth of a bucket: one of its cells has an object
	uint32_t *plane; // ids of planes: neighbours of every object
	ob_pair_key *pair; // unordered
	ob_pair_links *pair_links; // [pair]
	uint32_t *first_pair; // [object]: the first of its list of pairs, as ob_pair_links.next; none for static ones
	ob_calendar_levels solve; // [object]: when it is due
	ob_calendar_levels look; // [pair]: when it must be checked, unless no check could change anything
	uint32_t *check; // pairs to be checked in this phase
	ob_pair_record *record; // taken when a pair begins to touch
	// [record], for each version: impulse on body b, if the two do not agree on one (solver/ghost.h)
	double (*impulse_b)[2][OB_PAIR_ROWS];
	uint32_t *record_free; // stack of free records
	ob_island *island;
	uint32_t *member; // [object]
	uint32_t *island_pair; // indices into pair[]
	uint32_t *chunk; // first island of each claimable chunk; chunk[chunks] ends
	uint32_t *scratch; // [4 * objects]: the scheduler's
	uint32_t *task_ns; // [object]: CPU time of each task of the running phase, in turns; see ob_task_took
	// All NULL unless the scene has scripts.
	ob_script_counts *script_counts;
	uint32_t *script_of; // [object]: 1 + its cell; 0 = it has no script
	ob_script_turn *script_turn; // [script_cells]
	ob_script_cell *script_cell; // [script_cells]
	uint32_t *script_due; // [script_cells]: those that run before this step, ascending
	const ob_script_directory *script_text;
	uint32_t script_cells;
	// 0 and NULL unless the universe has room for joints (joint.c).
	uint32_t joints_max;
	ob_joint_counts *joint_counts;
	ob_joint_passport *joint; // [joints_max]; those that exist
	ob_joint_state *joint_state; // [joints_max]
	uint32_t (*next_joint)[2]; // [joints_max]: 1 + the next one of either object; 0 ends
	uint32_t *first_joint; // [object]: 1 + the first of its joints, ascending; 0: it has none
	uint32_t sensors; // 0, and these NULL, unless the scene has sensors (sensor.c)
	ob_sensor_passport *sensor; // [sensors]; constant
	ob_sensor_cell *sensor_cell; // [sensors]
	double *sensor_value; // of each its samples, in turns: the time (s) and the values of each
} ob_step_data;

// Bounds of ob_step_data.effort, so that sums stay within theirs. GIVEN_UP: the island is more than a step may take.
enum { OB_EFFORT_MOST = 1 << 16, OB_EFFORT_GIVEN_UP };

typedef enum ob_step_failure {
	OB_STEP_OK,
	OB_STEP_PAIRS_FULL,
	OB_STEP_NEIGHBOURS_FULL,
	OB_STEP_DIVERGED, // a state became NaN, or implausibly large
	OB_STEP_ENGINE, // the solver gave up
	OB_STEP_OVERWORKED, // the step's budget of work is spent
	OB_STEP_SURFACES_FULL, // an island is near too many regions of terrain
	OB_STEP_LEFT, // the run was stopped meanwhile
	OB_STEP_MEMORY_FULL, // the memory file system has no more pages
	OB_STEP_UNPLANNED, // the schedule that a free run replays does not fit it
	OB_STEP_BROKEN, // shared data breaks an invariant (step/invariants.h)
	OB_STEP_DAMAGED, // this and beyond: an id or index is out of its range, a stray write
} ob_step_failure;

// True if an id read from the shared memory is valid; false: a stray write.
static inline bool ob_object_in_range(const ob_step_data *data, uint32_t id)
{
	if (id < data->objects_max)
		return true;
	data->count->failure = OB_STEP_DAMAGED;
	return false;
}

// True if the object is in an island to be solved, or solved last; if late contacts have merged islands, these count.
static inline bool ob_is_to_be_solved(const ob_step_data *data, uint32_t id)
{
	return data->result_island[id] < data->count->unsolved;
}

// End of the used part of pair[]: within its capacity, even if overwritten.
static inline uint32_t ob_pairs_end(const ob_step_data *data)
{
	return data->count->pairs < data->pairs_max ? data->count->pairs : data->pairs_max;
}

// True if the object's query may return such a change (neighbour_id). ids: number of all objects
static inline bool ob_is_pair_change(const ob_step_data *data, uint32_t id, uint32_t change, uint32_t ids)
{
	const uint32_t pair = change & ~OB_PAIR_ENDS;
	if (!(change & OB_PAIR_ENDS))
		return change != id && change < ids;
	return pair < ob_pairs_end(data) && data->pair[pair].a != data->pair[pair].b &&
	       (data->pair[pair].a == id || data->pair[pair].b == id);
}

// End of the used part of joint[]: within its capacity, even if overwritten.
static inline uint32_t ob_joints_end(const ob_step_data *data)
{
	const uint32_t n = data->joints_max ? __atomic_load_n(&data->joint_counts->used, __ATOMIC_RELAXED) : 0;
	return n < data->joints_max ? n : data->joints_max;
}

static inline uint32_t ob_checks_count(const ob_step_data *data)
{
	return data->count->checks < data->pairs_max ? data->count->checks : data->pairs_max;
}

// Place of a pair in the list of its a (side 0) or b.
typedef struct ob_pair_place {
	uint32_t pair, side;
} ob_pair_place;

// Iterates over the pairs in the list of id: for (uint32_t link = data->first_pair[id]; ob_pair_at(data, link, &at);
// link = ob_pair_next(data, at)). Returns false at the end of the list, or if the link leads out of pair[], which is
// damage.
static inline bool ob_pair_at(const ob_step_data *data, uint32_t link, ob_pair_place *at)
{
	if (!link)
		return false;
	*at = (ob_pair_place){ (link - 1) / 2, (link - 1) % 2 };
	if (at->pair < data->pairs_max)
		return true;
	data->count->failure = OB_STEP_DAMAGED;
	return false;
}

static inline uint32_t ob_pair_next(const ob_step_data *data, ob_pair_place at)
{
	return data->pair_links[at.pair].next[at.side];
}

// Torque (N m, world frame) set by the object's script; 0 without a script.
static inline ob_vec3 ob_script_torque(const ob_step_data *data, uint32_t id)
{
	const uint32_t cell = data->script_of ? data->script_of[id] : 0;
	return cell ? data->script_cell[cell - 1].torque : ob_v3(0, 0, 0);
}

#endif
