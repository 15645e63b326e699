// State of the arranger for the commit of simulators' records (commit.h): the tasks that each was given, and the
// exchange among several ranks. Used by commit.c, which checks and writes, and commit_ranks.c, which exchanges.
#ifndef OB_EXCHANGE_COMMITTER_H
#define OB_EXCHANGE_COMMITTER_H

#include <stddef.h>

#include "exchange/commit.h"
#include "exchange/results.h"

// ---- records

// Records in which contained simulators hand over their results, and the writing of these into the universe.

typedef enum ob_record_kind {
	OB_RECORD_END = OB_OUTBOX_END,
	OB_RECORD_RESULT,
	OB_RECORD_BOUNDS,
	OB_RECORD_EFFORT,
	OB_RECORD_CONTACT,
	OB_RECORD_JOINT,
	OB_RECORD_CHECK,
	OB_RECORD_NEIGHBOURS,
	OB_RECORD_TOUCH,
	OB_RECORD_SCRIPT,
	OB_RECORD_POSTS,
	// Sent by arrangers alone, in place of an OB_RECORD_RESULT: a whole ob_found_result, for ranks that may lack
	// the motion before it.
	OB_RECORD_RESTORED,
} ob_record_kind;

typedef struct ob_check_record {
	uint32_t pair; // index
	uint32_t check; // index in check[] of the rank that checks it
	uint8_t expected, late, reserved[6];
	uint32_t clear_until, clear_as_of;
	double limit;
} ob_check_record;

// Record of a result whose acceleration is unchanged, as it mostly is: the motion without it.
enum {
	OB_MOTION_ACCELERATION = offsetof(ob_motion, a),
	OB_MOTION_BEHIND_IT = OB_MOTION_ACCELERATION + sizeof(ob_vec3)
};
typedef struct ob_steady_record {
	uint32_t id, state, due, reserved; // as in ob_found_result
	unsigned char motion[sizeof(ob_motion) - sizeof(ob_vec3)];
} ob_steady_record;

typedef struct ob_bounds_record {
	uint32_t id, reserved;
	float box[6];
} ob_bounds_record;

typedef struct ob_effort_record {
	uint32_t island, share;
} ob_effort_record;

// Number of neighbours of an object, and a part of the changes to its pairs (ob_step_data.neighbour_id): "count" of
// "total", from "first" on.
typedef struct ob_neighbours_record {
	uint32_t id, neighbours, total, first, count, reserved;
	uint32_t change[];
} ob_neighbours_record;

typedef struct ob_touch_record {
	uint32_t id, other; // as in ob_commit_touch
	double impulse;
	ob_vec3 point;
} ob_touch_record;

// Result of a script's run without its outbox, which follows in parts. state: padded to whole words.
typedef struct ob_script_record {
	uint32_t cell, flags, wake, asks, state_bytes, outbox_bytes, failed_step, reserved;
	uint64_t random[4];
	ob_vec3 force, next_torque, push, twist;
	float colour[4];
	char error[OB_SCRIPT_ERROR_BYTES];
	unsigned char state[];
} ob_script_record;

// Part of a cell's outbox: "bytes" of it, whole words, from "first" on.
typedef struct ob_posts_record {
	uint32_t cell, first, bytes, reserved;
	unsigned char part[];
} ob_posts_record;

enum { OB_CHANGES_AT_ONCE = 512, OB_POSTS_AT_ONCE = 2048 };

// Write a result into the universe: by a worker that can, and by the arranger once it has checked the record.
void ob_write_result(ob_universe *u, const ob_found_result *r);
void ob_write_bounds(ob_universe *u, uint32_t id, const float box[6]);
void ob_write_effort(ob_universe *u, uint32_t island, uint32_t share);
// A contact without its warm-start state; returns the record for that. OB_NO_RECORD: it needs none.
uint32_t ob_write_contact_key(ob_universe *u, const ob_found_contact *c);
// Its warm-start state; returns the version to which it was written.
int ob_write_contact_state(ob_universe *u, const ob_found_contact *c, uint32_t record);
void ob_write_joint(ob_universe *u, const ob_found_joint *j);
void ob_write_touch(ob_universe *u, const ob_touch_record *r);
void ob_write_script(ob_universe *u, const ob_script_record *r);
void ob_write_check(ob_universe *u, const ob_check_record *c);
// Reserves space for so many changes in the arena. Returns NULL if it is full; then the step has failed.
uint32_t *ob_reserve_changes(ob_universe *u, uint32_t id, uint32_t neighbours, uint32_t total);

// Number of a contact's bytes that are handed over.
size_t ob_contact_bytes(const ob_found_contact *c);
// Bytes of whole words that hold so many.
static inline size_t ob_in_words(size_t bytes)
{
	return (bytes + 7) / 8 * 8;
}

// ---- committer

// Reader of a mail's records. It reads some ahead, to prefetch the scattered memory that they will be compared with or
// written to.
enum { OB_RECORDS_AHEAD = 16 };
typedef struct ob_record_reader {
	ob_mail mail;
	uint32_t read, taken; // numbers of records so far
	ob_mail_record ahead[OB_RECORDS_AHEAD];
	bool commits; // the records will be written
} ob_record_reader;

struct ob_committer {
	ob_mail mail; // from the local simulators
	// With several ranks; else NULL, or 0.
	ob_cluster *cluster;
	uint32_t rank, ranks;
	ob_mail out, *dealt; // mails to the other ranks: the same to all, or [ranks] one for each
	bool *to; // [ranks]: true for ranks that receive a motion
	uint64_t *sent, *received; // [ranks]: digests of motions before the step, of results sent and received
	uint64_t damaged; // as in ob_peers_head
	bool differs; // as in ob_peers_head
	int32_t woken; // as in ob_peers_head
	const char *all; // mails of all ranks: rank r's begins at at[r], its records "ahead" bytes later
	const size_t *at;
	size_t ahead;
	bool dealt_to_each; // each rank gets a mail of its own
	uint32_t *island_owner; // [island]: worker that was given it
	uint32_t *query_owner; // [object], or for scripts [cell]: worker that was given it; NONE: not given away
	uint32_t *had; // [object]: results, or neighbours, received; [cell]: 0, or 1 + bytes of posts received
	uint32_t solved; // islands below this index are solved in this phase
	uint32_t due; // results, queries or scripts still missing
};

// True if the record is the result of an existing object.
bool ob_committer_is_result(const ob_universe *u, const ob_mail_record *r);
// Returns the result of an existing object, whole, or NULL. whole: memory for a result that comes without acceleration.
const ob_found_result *ob_committer_result_of(const ob_universe *u, const ob_mail_record *from, ob_found_result *whole);
// Returns a rank's mail for reading. ob_committer_next reads its next record; false: none left.
ob_mail ob_committer_mail_of(const ob_committer *c, uint32_t rank);
bool ob_committer_next(const ob_committer *c, ob_universe *u, ob_record_reader *from, ob_mail_record *out);

static inline bool ob_is_sound_state(uint32_t state)
{
	return state >= OB_SCHEDULE_AWAKE && state <= OB_SCHEDULE_EQUILIBRIUM;
}

// ---- for several ranks

// Creates the parts that several ranks need. Returns false if there is no memory.
bool ob_committer_share(ob_committer *c);
void ob_committer_finish_shared(ob_committer *c);
// Adds the records of the other ranks' simulators to those collected here. digest: ob_peers_digest. false: the step has
// failed.
bool ob_committer_exchange(ob_committer *c, ob_universe *u, ob_phase phase, uint64_t digest);
// Extends the digest "sum" by the motion from which the body was solved: other ranks compare it with their own. *whole:
// false if that motion has been damaged.
uint64_t ob_committer_digest_before(const ob_committer *c, const ob_universe *u, uint32_t id, uint64_t sum,
				    bool *whole);

#endif
