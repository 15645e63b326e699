#include "cluster/peers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"
#include "schedule/calendar.h"
#include "table/home.h"
#include "table/trace.h"

static const uint64_t LEAVING = UINT64_MAX; // in place of a phase

static uint64_t motion_digest(const ob_motion *m)
{
	return ob_digest_words(m, sizeof *m);
}

uint64_t ob_peers_digest(const ob_universe *u)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t queries;
	const uint32_t *list = ob_requery_list(u, &queries);
	uint64_t sum = ob_digest_word(queries, data->count->pairs);
	for (uint32_t i = 0; i < queries; i++)
		sum = ob_digest_word(sum, list[i]);
	return sum;
}

// ---- ranks that differ

// State of an object on a rank: digest of its motion, published at step "since". Motions that the rank does not need
// may be old.
typedef struct motion_seen {
	uint64_t since, digest;
} motion_seen;

// Returns a rank with another motion of the object, published at the same step; its own number: there is none.
static uint32_t find_other(const ob_peers *p, const char *all, const size_t *at, uint32_t rank, size_t object)
{
	motion_seen own, other;
	memcpy(&own, all + at[rank] + object * sizeof own, sizeof own);
	for (uint32_t r = 0; r < p->ranks; r++) {
		memcpy(&other, all + at[r] + object * sizeof other, sizeof other);
		if (other.since == own.since && other.digest != own.digest)
			return r;
	}
	return rank;
}

static void blame(const ob_peers *p, ob_universe *u, uint32_t rank, const char *text)
{
	ob_step_blame(u, rank * (ob_universe_simulators(u) / p->ranks), text);
}

// Exchanges all ranks' digests of every object and names the first that differs. All ranks call it together, as all
// have seen the same messages.
static void blame_rank(const ob_peers *p, ob_universe *u, uint32_t rank)
{
	const uint32_t ids = ob_universe_ids(u);
	const unsigned long long step = ob_step_count(u) + 1;
	const size_t *at;
	char text[OB_STEP_BLAME_MAX];
	uint32_t id = 0, other = rank;
	motion_seen *mine = calloc(ids + 1, sizeof *mine);
	for (uint32_t i = 0; mine && i < ids; i++)
		mine[i] = (motion_seen){ ob_newest_motion(u, i)->step, motion_digest(ob_newest_motion(u, i)) };
	const char *all = p->gather(p->wire, mine, mine ? ids * sizeof *mine : 0, &at);
	free(mine);
	for (uint32_t r = 0; all && r < p->ranks; r++)
		if (at[r + 1] - at[r] != ids * sizeof *mine)
			all = NULL;
	while (all && id < ids && (other = find_other(p, all, at, rank, id)) == rank)
		id++;
	if (other != rank)
		snprintf(text, sizeof text,
			 "is of rank %u, which has other bits than rank %u in step %llu, first of object \"%s\"", rank,
			 other, step, ob_passport_of(u, id)->name);
	else
		snprintf(text, sizeof text, "is of rank %u, which has arranged step %llu otherwise than rank 0", rank,
			 step);
	blame(p, u, rank, text);
}

// Reports a contact's contents, or a motion, that no longer fits its digest.
static void blame_memory(const ob_peers *p, ob_universe *u, uint32_t rank, uint64_t damaged)
{
	const uint64_t object = (damaged & ~OB_PEERS_MOTION) - 1;
	char text[OB_STEP_BLAME_MAX];
	snprintf(text, sizeof text,
		 "is of rank %u, which in step %llu has other bits than it had found of %s object \"%s\"", rank,
		 (unsigned long long)ob_step_count(u) + 1, damaged & OB_PEERS_MOTION ? "the motion of" : "a contact of",
		 object < ob_universe_ids(u) ? ob_passport_of(u, (uint32_t)object)->name : "");
	blame(p, u, rank, text);
}

static ob_peers_head head_of(const char *all, const size_t *at, uint32_t rank)
{
	ob_peers_head head;
	memcpy(&head, all + at[rank], sizeof head);
	return head;
}

// True if all ranks are at the same point as rank 0; else the step has failed.
static bool stand_together(ob_peers *p, ob_universe *u, const char *all, const size_t *at)
{
	const ob_peers_head first = head_of(all, at, 0);
	for (uint32_t r = 0; r < p->ranks; r++)
		p->parted |= head_of(all, at, r).phase == LEAVING;
	if (p->parted) {
		ob_step_fail(u, OB_STEP_LEFT, 0);
		return false;
	}
	for (uint32_t r = 0; r < p->ranks; r++) {
		const ob_peers_head other = head_of(all, at, r);
		if (other.damaged) {
			blame_memory(p, u, r, other.damaged);
			return false;
		}
	}
	for (uint32_t r = 0; r < p->ranks; r++) {
		ob_peers_head other = head_of(all, at, r);
		other.move = first.move; // requests go to rank 0 alone
		other.next_due = first.next_due; // differs between ranks, as the next three
		other.look = first.look;
		other.islands = first.islands;
		other.woken = first.woken;
		if (other.differs || memcmp(&first, &other, sizeof first) != 0) {
			blame_rank(p, u, r);
			return false;
		}
	}
	return true;
}

// ---- an exchange

// Notes the first step that some rank waits for, and the sums over all ranks.
static void note_steps(ob_peers *p, ob_universe *u, const char *all, const size_t *at)
{
	uint64_t due = UINT32_MAX, look = UINT64_MAX;
	p->islands = 0;
	for (uint32_t r = 0; r < p->ranks; r++) {
		const ob_peers_head of = head_of(all, at, r);
		due = of.next_due < due ? of.next_due : due;
		look = of.look < look ? of.look : look;
		p->islands += (uint32_t)of.islands;
		if (r != p->rank)
			ob_step_woken(u, (int32_t)of.woken);
	}
	ob_universe_step_data(u)->count->next_due = (uint32_t)due;
	p->look = look;
}

// Returns the step of the next pause, as far as it is known; 0: scripts, readers or the trace may read at each step.
static uint64_t own_look(const ob_universe *u)
{
	const bool always = ob_universe_step_data(u)->script_counts || ob_universe_traced(u) ||
			    ob_universe_shares_contacts(u) || ob_universe_is_read(u);
	return always ? 0 : ob_gate_pause_step(u);
}

void ob_peers_begin(ob_mail *mail)
{
	const ob_peers_head empty = { 0 };
	ob_mail_clear(mail);
	ob_mail_append(mail, &empty, sizeof empty);
}

static void complete_head(const ob_peers *p, ob_universe *u, ob_peers_head *head)
{
	const ob_calendar solve = ob_calendar_of_objects(u), look = ob_calendar_of_pairs(u);
	const uint32_t objects = ob_calendar_first(&solve), pairs = ob_calendar_first(&look);
	head->step = ob_step_count(u);
	head->move = p->rank == 0 && !p->move ? ob_move_take(u) : 0;
	head->next_due = objects < pairs ? objects : pairs;
	head->islands = ob_universe_step_data(u)->count->islands;
	head->look = own_look(u);
}

// Returns all, the mail of all ranks, if it is sound.
static const char *take(ob_peers *p, ob_universe *u, const char *all, const size_t *at)
{
	if (!all) {
		ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
		return NULL;
	}
	if (!stand_together(p, u, all, at))
		return NULL;
	if (head_of(all, at, 0).move)
		p->move = head_of(all, at, 0).move;
	note_steps(p, u, all, at);
	return all;
}

const char *ob_peers_exchange(ob_peers *p, ob_universe *u, ob_peers_head head, ob_mail *mail, bool each,
			      const size_t **at)
{
	const uint32_t mails = each ? p->ranks : 1;
	const void **mine = calloc(mails, sizeof *mine);
	size_t *bytes = calloc(mails, sizeof *bytes);
	const char *all = NULL;
	bool fits = mine && bytes;
	complete_head(p, u, &head);
	for (uint32_t r = 0; r < mails && (fits = fits && !mail[r].lost); r++) {
		memcpy(mail[r].bytes, &head, sizeof head);
		mine[r] = mail[r].bytes;
		bytes[r] = mail[r].used;
	}
	if (fits)
		all = each ? p->deal(p->wire, mine, bytes, at) : p->gather(p->wire, *mine, *bytes, at);
	free(mine);
	free(bytes);
	return take(p, u, all, all ? *at : NULL);
}

void ob_peers_blame(const ob_peers *p, ob_universe *u, uint32_t rank)
{
	blame(p, u, rank, "is of a rank that has sent what makes no sense");
}

bool ob_parcels_exchange(ob_peers *p, ob_universe *u, uint64_t phase, ob_mail *mail, bool each, ob_parcel_take take_it,
			 void *with)
{
	const ob_peers_head head = { .phase = phase };
	const size_t *at;
	const char *all = ob_peers_exchange(p, u, head, mail, each, &at);
	ob_parcel of;
	bool sound = true;
	for (uint32_t r = 0; all && sound && r < p->ranks; r++) {
		const char *from = all + at[r] + sizeof head, *end = all + at[r + 1];
		for (; r != p->rank && sound && from < end; from += of.bytes) {
			const size_t left = (size_t)(end - from);
			if ((sound = left >= sizeof of))
				memcpy(&of, from, sizeof of);
			sound = sound && of.bytes >= sizeof of && of.bytes <= left && take_it(with, u, from, &of, r);
		}
		if (!sound)
			ob_peers_blame(p, u, r);
	}
	return all && sound;
}

void ob_peers_leave(ob_peers *p)
{
	const ob_peers_head head = { .phase = LEAVING };
	const size_t *at;
	if (p->ranks > 1 && !p->parted)
		p->gather(p->wire, &head, sizeof head, &at);
	p->parted = true;
}

// ---- at the start

// Facts that must be the same on all ranks.
typedef struct introduction {
	uint64_t version, workers, settings, objects, arithmetic;
} introduction;

static uint64_t digest_bytes(const void *bytes, size_t n)
{
	const unsigned char *byte = bytes;
	uint64_t sum = n;
	for (size_t i = 0; i < n; i++)
		sum = ob_digest_word(sum, byte[i]);
	return sum;
}

// Digest of passports and first motions.
static uint64_t digest_objects(const ob_universe *u)
{
	uint64_t sum = ob_universe_capacity(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		sum = ob_digest_word(sum, digest_bytes(ob_passport_of(u, id), sizeof(ob_passport)));
		sum = ob_digest_word(sum, motion_digest(ob_newest_motion(u, id)));
	}
	return sum;
}

// Digest of results in which processors and compilers are known to differ.
static uint64_t digest_arithmetic(void)
{
	uint64_t sum = 0;
	for (int i = 1; i < 1000; i++) {
		double x = .37 * i, y, found[4] = { ob_sin(x), ob_atan2(x, 3), ob_exp(-x), 0 };
		y = x * x;
		found[3] = fma(x, x, -y) + sqrt(x) / 3;
		sum = ob_digest_word(sum, digest_bytes(found, sizeof found));
	}
	return sum;
}

static const char *difference(const introduction *a, const introduction *b)
{
	if (a->version != b->version)
		return "is another version of obsim";
	if (a->workers != b->workers)
		return "has another number of workers (say it with --workers)";
	if (a->arithmetic != b->arithmetic)
		return "computes other bits: its processor or program rounds otherwise";
	if (a->settings != b->settings)
		return "runs with other settings";
	return a->objects != b->objects ? "runs another scene" : NULL;
}

bool ob_peers_join(ob_peers *p, const ob_universe *u, ob_error *e)
{
	ob_run_settings run = *ob_universe_settings(u);
	const size_t *at;
	run.timed = run.freezes = 0;
	run.fault = (ob_fault_plan){ 0 };
	const introduction own = { ob_universe_version(), ob_universe_simulators(u),
				   ob_digest_word(digest_bytes(&run, sizeof run), ob_universe_shares_contacts(u)),
				   digest_objects(u), digest_arithmetic() };
	const char *all = p->gather(p->wire, &own, sizeof own, &at);
	if (!all)
		return ob_fail(e, "out of memory");
	for (uint32_t r = 1; r < p->ranks; r++) {
		introduction first, other;
		memcpy(&first, all, sizeof first);
		memcpy(&other, all + at[r], sizeof other);
		const char *wrong = difference(&first, &other);
		if (wrong) {
			p->parted = true;
			return ob_fail(e, "rank %u %s than rank 0", r, wrong);
		}
	}
	return true;
}
