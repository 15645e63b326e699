#include "sim/peers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"
#include "sim/broadphase.h"
#include "sim/late_contacts.h"

// What each message begins with.
typedef struct message_head {
	uint64_t step, phase, digest; // phase: or LEAVING
} message_head;

static const uint64_t LEAVING = UINT64_MAX;

static uint64_t mixed(uint64_t sum, uint64_t word)
{
	sum = (sum ^ word) * 0x9e3779b97f4a7c15u;
	return sum ^ sum >> 29;
}

// Of whole words
static uint64_t digest_words(const void *words, size_t bytes)
{
	uint64_t word, sum = 0;
	for (size_t at = 0; at + sizeof word <= bytes; at += sizeof word) {
		memcpy(&word, (const char *)words + at, sizeof word);
		sum = mixed(sum, word);
	}
	return sum;
}

static uint64_t motion_digest(const ob_motion *m)
{
	return digest_words(m, sizeof *m);
}

// A damaged universe is read here, too: nothing in it is followed unchecked.

static uint32_t islands_of(const ob_step_data *data)
{
	const uint32_t chunks = data->count->chunks, islands = chunks < data->objects_max ? data->chunk[chunks] : 0;
	return islands < data->objects_max ? islands : data->objects_max;
}

// The k-th of an island's pairs, and how it touches before the step; NULL: damaged.
static const ob_pair_key *pair_of(const ob_universe *u, const ob_island *is, uint32_t k, uint64_t *digest)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t at = is->first_pair + k, pair = at < data->pairs_max ? data->island_pair[at] : UINT32_MAX;
	if (pair >= ob_pairs_end(data))
		return NULL;
	const ob_pair_key *key = &data->pair[pair];
	const bool kept = key->record < data->count->records_used && key->record < data->pairs_max;
	const ob_pair_state *before = kept ? ob_pair_before(&data->record[key->record], ob_step_count(u)) : NULL;
	*digest = before ? digest_words(before, sizeof *before) : 0;
	return ob_object_in_range(data, key->a) && ob_object_in_range(data, key->b) ? key : NULL;
}

static uint64_t digest_island(const ob_universe *u, const ob_island *is, uint64_t sum)
{
	const ob_step_data *data = ob_universe_step_data(u);
	sum = mixed(sum, (uint64_t)is->members << 32 | is->pairs);
	for (uint32_t k = 0; k < is->members && is->first_member + k < data->objects_max; k++) {
		const uint32_t id = data->member[is->first_member + k];
		sum = mixed(sum, id);
		if (ob_object_in_range(data, id))
			sum = mixed(sum, motion_digest(ob_newest_motion(u, id)));
	}
	for (uint32_t k = 0; k < is->pairs; k++) {
		uint64_t touch;
		const ob_pair_key *key = pair_of(u, is, k, &touch);
		if (!key)
			break;
		sum = mixed(mixed(sum, (uint64_t)key->a << 32 | key->b), touch);
	}
	return sum;
}

uint64_t ob_peers_digest(const ob_universe *u, ob_phase phase)
{
	const ob_step_data *data = ob_universe_step_data(u);
	uint32_t queries;
	const uint32_t *list = ob_requery_list(u, &queries);
	uint64_t sum = mixed(mixed(queries, data->count->pairs), ob_checks_count(data));
	for (uint32_t i = 0; i < queries; i++)
		sum = mixed(sum, list[i]);
	for (uint32_t i = 0; phase == OB_PHASE_ISLANDS && i < islands_of(data); i++)
		sum = digest_island(u, &data->island[i], sum);
	return sum;
}

// ---- where ranks differ

// The first object that moves otherwise on that rank than on rank 0; OB_NO_OBJECT: none does.
static uint32_t find_object(const char *all, const size_t *at, uint32_t rank)
{
	uint64_t first, other;
	for (size_t i = 0; at[0] + i < at[1] && at[rank] + i < at[rank + 1]; i += sizeof first) {
		memcpy(&first, all + at[0] + i, sizeof first);
		memcpy(&other, all + at[rank] + i, sizeof other);
		if (first != other)
			return (uint32_t)(i / sizeof first);
	}
	return OB_NO_OBJECT;
}

// Of each object how it moves, and how it touches others where it is about to be solved.
static void digest_each(const ob_universe *u, uint64_t *of, uint32_t ids)
{
	const ob_step_data *data = ob_universe_step_data(u);
	const uint32_t islands = ob_gate_phase(u) == OB_PHASE_ISLANDS ? islands_of(data) : 0;
	uint64_t touch;
	for (uint32_t id = 0; id < ids; id++)
		of[id] = motion_digest(ob_newest_motion(u, id));
	for (uint32_t i = 0; i < islands; i++)
		for (uint32_t k = 0; k < data->island[i].pairs; k++) {
			const ob_pair_key *key = pair_of(u, &data->island[i], k, &touch);
			if (!key)
				return;
			of[key->a] += touch;
			of[key->b] += touch;
		}
}

// All ranks come here together, for all have seen the same messages: each tells the others about every object.
static void blame_rank(const ob_peers *p, ob_universe *u, uint32_t rank)
{
	const uint32_t ids = ob_universe_ids(u), culprit = rank * (ob_universe_simulators(u) / p->ranks);
	const unsigned long long step = ob_step_count(u) + 1;
	const size_t *at;
	char text[OB_STEP_BLAME_MAX];
	uint32_t id = OB_NO_OBJECT;
	uint64_t *mine = calloc(ids + 1, sizeof *mine);
	if (mine)
		digest_each(u, mine, ids);
	const char *all = p->gather(p->wire, mine, mine ? ids * sizeof *mine : 0, &at);
	free(mine);
	if (all)
		id = find_object(all, at, rank);
	if (id < ids)
		snprintf(text, sizeof text,
			 "is of rank %u, which has other bits than rank 0 in step %llu, first of object \"%s\"", rank,
			 step, ob_passport_of(u, id)->name);
	else
		snprintf(text, sizeof text, "is of rank %u, which has arranged step %llu otherwise than rank 0", rank,
			 step);
	ob_step_blame(u, culprit, text);
}

static message_head head_of(const char *all, const size_t *at, uint32_t rank)
{
	message_head head;
	memcpy(&head, all + at[rank], sizeof head);
	return head;
}

// Whether all stand where rank 0 does; else the step has failed.
static bool stand_together(ob_peers *p, ob_universe *u, const char *all, const size_t *at)
{
	const message_head first = head_of(all, at, 0);
	for (uint32_t r = 0; r < p->ranks; r++)
		p->parted |= head_of(all, at, r).phase == LEAVING;
	if (p->parted) {
		ob_step_fail(u, OB_STEP_LEFT, 0);
		return false;
	}
	for (uint32_t r = 1; r < p->ranks; r++) {
		const message_head other = head_of(all, at, r);
		if (memcmp(&first, &other, sizeof first) != 0) {
			blame_rank(p, u, r);
			return false;
		}
	}
	return true;
}

// ---- an exchange

static bool replace_mail(const ob_peers *p, const char *all, const size_t *at, ob_mail *mail)
{
	bool fits = true;
	mail->used = 0;
	for (uint32_t r = 0; r < p->ranks && fits; r++)
		fits = ob_mail_append(mail, all + at[r] + sizeof(message_head),
				      at[r + 1] - at[r] - sizeof(message_head));
	return fits;
}

bool ob_peers_exchange(ob_peers *p, ob_universe *u, ob_phase phase, uint64_t digest, ob_mail *mail)
{
	const message_head head = { ob_step_count(u), phase, digest };
	const size_t *at;
	const char *all =
		ob_mail_put_before(mail, &head, sizeof head) ? p->gather(p->wire, mail->bytes, mail->used, &at) : NULL;
	if (all && !stand_together(p, u, all, at))
		return false;
	if (all && replace_mail(p, all, at, mail))
		return true;
	ob_step_fail(u, OB_STEP_MEMORY_FULL, 0);
	return false;
}

void ob_peers_leave(ob_peers *p)
{
	const message_head head = { 0, LEAVING, 0 };
	const size_t *at;
	if (p->ranks > 1 && !p->parted)
		p->gather(p->wire, &head, sizeof head, &at);
	p->parted = true;
}

// ---- at the start

// What must be the same on all ranks.
typedef struct introduction {
	uint64_t version, workers, settings, objects, arithmetic;
} introduction;

static uint64_t digest_bytes(const void *bytes, size_t n)
{
	const unsigned char *byte = bytes;
	uint64_t sum = n;
	for (size_t i = 0; i < n; i++)
		sum = mixed(sum, byte[i]);
	return sum;
}

// Passports and first motions.
static uint64_t digest_objects(const ob_universe *u)
{
	uint64_t sum = ob_universe_capacity(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		sum = mixed(sum, digest_bytes(ob_passport_of(u, id), sizeof(ob_passport)));
		sum = mixed(sum, motion_digest(ob_newest_motion(u, id)));
	}
	return sum;
}

// Of operations in which processors and compilers have been seen to differ.
static uint64_t digest_arithmetic(void)
{
	uint64_t sum = 0;
	for (int i = 1; i < 1000; i++) {
		double x = .37 * i, y, found[4] = { ob_sin(x), ob_atan2(x, 3), ob_exp(-x), 0 };
		y = x * x;
		found[3] = fma(x, x, -y) + sqrt(x) / 3;
		sum = mixed(sum, digest_bytes(found, sizeof found));
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
	const introduction own = { ob_universe_version(), ob_universe_simulators(u), digest_bytes(&run, sizeof run),
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
