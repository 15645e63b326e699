// State of the arranger for the commit of simulators' records (commit.h): the tasks that each was given, and the
// exchange among several ranks. Used by commit.c, which checks and writes, and commit_ranks.c, which exchanges.
#ifndef OB_EXCHANGE_COMMITTER_H
#define OB_EXCHANGE_COMMITTER_H

#include "exchange/commit.h"
#include "exchange/records.h"

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
