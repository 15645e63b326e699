// What the arranger keeps to commit what simulators hand over (commit.h): of what each was given, and, of several
// ranks, of what they tell each other. For commit.c, which checks and writes, and commit_ranks.c, which tells.
#ifndef OB_SIM_COMMITTER_H
#define OB_SIM_COMMITTER_H

#include "sim/commit.h"
#include "sim/holdings.h"

// Records of a mail, read some before they are wanted: what they will be compared with, or written to, lies anywhere.
enum { OB_RECORDS_AHEAD = 16 };
typedef struct ob_record_reader {
	ob_mail mail;
	uint32_t read, taken; // records, so far
	ob_mail_record ahead[OB_RECORDS_AHEAD];
	bool commits; // they will be written
} ob_record_reader;

typedef enum ob_record_kind {
	OB_RECORD_END = OB_OUTBOX_END,
	OB_RECORD_RESULT,
	OB_RECORD_BOUNDS,
	OB_RECORD_EFFORT,
	OB_RECORD_CONTACT,
	OB_RECORD_CHECK,
	OB_RECORD_NEIGHBOURS,
	OB_RECORD_TOUCH,
	OB_RECORD_SCRIPT,
	OB_RECORD_POSTS,
	OB_RECORD_SOLVED, // from here on by arrangers alone, in place of an OB_RECORD_RESULT
	OB_RECORD_RESTORED,
} ob_record_kind;

typedef struct ob_check_record {
	uint32_t pair; // index
	uint32_t check; // its place in check[] of the rank that has it there
	uint8_t expected, late, reserved[6];
	uint32_t clear_until, clear_as_of;
	double limit;
} ob_check_record;

// What a rank hears of bodies that none of its own is near: OB_RECORD_SOLVED, of several at a time. Who may lack the
// motion before, but is to have this one, gets an OB_RECORD_RESTORED, a whole ob_found_result.
enum { OB_SOLVED_AT_ONCE = 64, OB_SOLVED_ID_BITS = 30 };
typedef struct ob_solved_record {
	struct {
		uint32_t id; // the state above it, from OB_SCHEDULE_AWAKE on
		uint32_t due;
	} body[OB_SOLVED_AT_ONCE];
} ob_solved_record;
typedef struct ob_solved_bodies {
	uint32_t n;
	ob_solved_record record; // of the simulator whose records are put
} ob_solved_bodies;

struct ob_committer {
	ob_mail mail; // of the simulators that are here
	// Of several ranks, else NULL, or 0
	ob_holdings *holdings;
	ob_halo *halo;
	struct ob_regions *regions;
	uint32_t rank, ranks;
	ob_mail out, *dealt; // what the others get: all the same, or [ranks] each its own ..
	ob_solved_bodies *solved_for; // .. and is still to get
	bool *to; // [ranks]: who is told a motion
	uint64_t *told, *heard; // [ranks]: digests of what the motions that each is told, has told, began with
	uint64_t damaged; // as ob_peers_head has it
	bool differs; // likewise
	// Pairs, by their index, that simulators of other ranks have had: that touched and do no longer; that were
	// checked
	ob_mail parted, checked;
	const char *all; // what all have said; that of rank r begins at at[r], its records so many bytes on
	const size_t *at;
	size_t ahead;
	bool dealt_to_each; // not the same to all
	uint32_t *island_owner; // [island]
	uint32_t *query_owner; // [object], or of scripts [cell]; NONE = none was given away
	uint32_t *had; // [object]: results, or neighbours, that have come; [cell]: of what its script brings, 1 + bytes
		       // of posts
	uint32_t solved; // islands before this one are solved in this phase
	uint32_t due; // results, queries, or scripts, that are still missing
};

// Whether it is the result of an object that there is.
bool ob_committer_is_result(const ob_universe *u, const ob_mail_record *r);
// The whole result, of an object that there is; NULL: it is none.
const ob_found_result *ob_committer_result_of(const ob_universe *u, const ob_mail_record *from, ob_found_result *whole);
// The mail of a rank, to be read; and its next record; false: there is none.
ob_mail ob_committer_mail_of(const ob_committer *c, uint32_t rank);
bool ob_committer_next(const ob_committer *c, ob_universe *u, ob_record_reader *from, ob_mail_record *out);

static inline bool ob_is_sound_state(uint32_t state)
{
	return state >= OB_SCHEDULE_AWAKE && state <= OB_SCHEDULE_EQUILIBRIUM;
}

// ---- of several ranks

// false: no memory.
bool ob_committer_share(ob_committer *c, const ob_universe *u);
void ob_committer_finish_shared(ob_committer *c);
// From which motion the body was solved: the others compare it with their own. sum: of those before; whole: it is what
// it was.
uint64_t ob_committer_digest_before(const ob_committer *c, const ob_universe *u, uint32_t id, uint64_t sum,
				    bool *whole);
// When all results are committed: what each rank has told this one, and what it has found.
void ob_committer_compare_before(ob_committer *c);

#endif
