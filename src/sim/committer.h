// What the arranger keeps to commit what simulators hand over (commit.h): of what each was given, and, of several
// ranks, of what they tell each other. For commit.c, which checks and writes, and commit_ranks.c, which tells.
#ifndef OB_SIM_COMMITTER_H
#define OB_SIM_COMMITTER_H

#include "sim/commit.h"
#include "sim/rank_islands.h"

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
	// By arrangers alone, in place of an OB_RECORD_RESULT: a whole ob_found_result, for who is to have this motion
	// and may lack the one before.
	OB_RECORD_RESTORED,
} ob_record_kind;

typedef struct ob_check_record {
	uint32_t pair; // index
	uint32_t check; // its place in check[] of the rank that has it there
	uint8_t expected, late, reserved[6];
	uint32_t clear_until, clear_as_of;
	double limit;
} ob_check_record;

struct ob_committer {
	ob_mail mail; // of the simulators that are here
	// Of several ranks, else NULL, or 0
	ob_holdings *holdings;
	ob_halo *halo;
	ob_regions *regions;
	ob_rank_islands *rank_islands;
	uint32_t rank, ranks;
	ob_mail out, *dealt; // what the others get: all the same, or [ranks] each its own ..
	bool *to; // [ranks]: who is told a motion
	uint64_t *told, *heard; // [ranks]: digests of what the motions that each is told, has told, began with
	uint64_t damaged; // as ob_peers_head has it
	bool differs; // likewise
	int32_t woken; // likewise
	// Pairs, by their index: that simulators of other ranks have found to touch no longer; that they have checked;
	// that have linked two ranks' bodies since islands were built, and of those the ones that do; the last two are
	// the same on all ranks.
	ob_mail parted, checked, links_across, linked;
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
