// Data of scripts in the universe: each scripted object has a cell, numbered apart from ids, so that objects without a
// script cost nothing.
//
//   script_of[object] ──> 1 + cell ──> script_turn[cell]   when it runs: 24 bytes, read before each step
//                                      script_cell[cell]   state, mail, contacts, requests
//   script_text                        the texts of all scripts, written once by the host
//
// Ordered by the gate, like all data of the step: while scripts run, a worker writes the cells of the objects that it
// runs, and no others. The solver of an object's island notes its contacts there. In between, the scheduling worker.
#ifndef OB_TABLE_SCRIPT_DATA_H
#define OB_TABLE_SCRIPT_DATA_H

#include <stdint.h>

#include <ob/universe.h>

#include "table/request_kind.h"

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

#endif
