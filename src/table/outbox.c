#include "table/outbox.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "table/futex.h"
#include "table/layout.h"

enum { LANES = 4, LOOK_AGAIN_MS = 100 };

// FNV's operations (xor, multiply) on words, in independent lanes. Any single differing word changes the sum; several
// do with all but one chance in 2^64.
typedef struct checksum {
	uint64_t lane[LANES];
	size_t words;
} checksum;

static const uint64_t prime = 0x9E3779B97F4A7C15u;

typedef struct outbox_page {
	_Alignas(64) uint32_t signal; // completed outboxes so far
	uint32_t last; // 1 = this one is the arrival
	uint32_t turn; // of the gate
	uint32_t bytes; // of records
	uint64_t sum;
	uint64_t faults[OB_FAULT_KINDS]; // injected into its simulator
	uint32_t working_on; // as ob_worker_cell
	_Alignas(64) char record[];
} outbox_page;

typedef struct record_head {
	uint32_t kind, bytes;
} record_head;

// Head of a simulator's records of one outbox in a mail.
typedef struct part_head {
	uint64_t worker, bytes; // size of the records behind this
} part_head;

// State of this process between two phases; it is not in the universe.
typedef struct ob_outbox {
	outbox_page *page;
	uint32_t worker, signal, done; // done: the last turn at which it arrived
	uint32_t next_task;
	bool stopped; // the arranger has stopped
	bool summed; // the checksum covers the records, not the turn alone
	size_t used;
	checksum sum;
	ob_outbox_end end;
} ob_outbox;

static outbox_page *page_of(const ob_universe *u, uint32_t worker)
{
	return (outbox_page *)(u->outbox_area + (size_t)worker * u->header.sizes.outbox_bytes);
}

static size_t room_of(const ob_universe *u)
{
	return u->header.sizes.outbox_bytes - sizeof(outbox_page);
}

static checksum start_sum(uint32_t worker, uint32_t turn)
{
	checksum c = { .words = 0 };
	for (uint64_t i = 0; i < LANES; i++)
		c.lane[i] = prime * (i + 1) ^ (uint64_t)worker << 32 ^ turn;
	return c;
}

static void add_words(checksum *c, const void *words, size_t bytes)
{
	for (size_t i = 0; i < bytes / 8; i++, c->words++) {
		uint64_t word;
		memcpy(&word, (const char *)words + 8 * i, sizeof word);
		uint64_t *lane = &c->lane[c->words % LANES];
		*lane = (*lane ^ word) * prime;
	}
}

static uint64_t final_sum(const checksum *c)
{
	uint64_t sum = c->words;
	for (int i = 0; i < LANES; i++)
		sum = (sum ^ c->lane[i] ^ c->lane[i] >> 29) * prime;
	return sum;
}

// ---- the simulator's side

bool ob_outbox_enter(ob_universe *u, uint32_t worker)
{
	static ob_outbox own; // a process is one simulator
	const size_t each = u->header.sizes.outbox_bytes;
	own = (ob_outbox){ .page = page_of(u, worker), .worker = worker };
	own.summed = u->header.harden & 1 << OB_HARDEN_CHECKSUM;
	if (u->header.harden & 1 << OB_HARDEN_PAGES &&
	    (mprotect(u->base, u->header.bytes, PROT_READ) != 0 ||
	     mprotect(own.page, each, PROT_READ | PROT_WRITE) != 0 || !ob_trace_unprotect(u, worker)))
		return false;
	u->outbox = &own;
	return true;
}

void ob_outboxes_reset(ob_universe *u)
{
	for (uint32_t w = 0; w < u->header.sizes.workers && u->header.sizes.outbox_bytes; w++) {
		__atomic_store_n(&page_of(u, w)->signal, 0, __ATOMIC_RELAXED);
		__atomic_store_n(&page_of(u, w)->working_on, 0, __ATOMIC_RELAXED);
	}
}

// A counter of faults lies in memory that they may overwrite: its upper half verifies the lower one. 0 is 0.
static uint64_t sealed(uint32_t count)
{
	return (uint64_t)(count * UINT32_C(0x9E3779B1)) << 32 | count;
}

void ob_fault_note(ob_universe *u, uint32_t worker, ob_fault_kind kind)
{
	uint64_t *at = u->outbox ? &u->outbox->page->faults[kind] : &u->worker[worker].faults[kind];
	const uint64_t seen = __atomic_load_n(at, __ATOMIC_RELAXED);
	if (seen == sealed((uint32_t)seen)) // otherwise it stays as it is: overwritten
		__atomic_store_n(at, sealed((uint32_t)seen + 1), __ATOMIC_RELAXED);
}

static uint32_t add_faults(const uint64_t from[OB_FAULT_KINDS], uint64_t sum[OB_FAULT_KINDS])
{
	uint32_t overwritten = 0;
	for (int kind = 0; kind < OB_FAULT_KINDS; kind++) {
		const bool whole = from[kind] == sealed((uint32_t)from[kind]);
		sum[kind] += whole ? (uint32_t)from[kind] : 0;
		overwritten += !whole;
	}
	return overwritten;
}

uint32_t ob_universe_faults(const ob_universe *u, uint64_t sum[OB_FAULT_KINDS])
{
	uint32_t overwritten = 0;
	memset(sum, 0, OB_FAULT_KINDS * sizeof *sum);
	for (uint32_t w = 0; w < u->header.sizes.workers; w++) {
		overwritten += add_faults(u->worker[w].faults, sum);
		if (u->header.sizes.outbox_bytes)
			overwritten += add_faults(page_of(u, w)->faults, sum);
	}
	return overwritten;
}

void ob_worker_set_object(ob_universe *u, uint32_t worker, uint32_t object)
{
	uint32_t *to = u->outbox ? &u->outbox->page->working_on : &u->worker[worker].working_on;
	__atomic_store_n(to, object + 1, __ATOMIC_RELAXED);
}

uint32_t ob_worker_object(const ob_universe *u, uint32_t worker)
{
	if (worker >= u->header.sizes.workers)
		return OB_NO_OBJECT;
	const uint32_t *from =
		u->header.sizes.outbox_bytes ? &page_of(u, worker)->working_on : &u->worker[worker].working_on;
	const uint32_t object = __atomic_load_n(from, __ATOMIC_RELAXED) - 1;
	return object < u->header.sizes.capacity ? object : OB_NO_OBJECT;
}

uint32_t ob_universe_lives(const ob_universe *u)
{
	return u->control->lives;
}

bool ob_universe_contained(const ob_universe *u)
{
	return u->outbox;
}

void *ob_outbox_own(const ob_universe *u, size_t *bytes)
{
	*bytes = u->header.sizes.outbox_bytes;
	return u->outbox->page;
}

ob_outbox_end *ob_outbox_end_of(const ob_universe *u)
{
	return &u->outbox->end;
}

static void empty(ob_universe *u)
{
	ob_outbox *o = u->outbox;
	o->used = 0;
	o->sum = start_sum(o->worker, u->gate_cell[o->worker].turn);
}

static void hand_over(ob_universe *u, bool last)
{
	ob_outbox *o = u->outbox;
	outbox_page *page = o->page;
	page->last = last;
	page->turn = u->gate_cell[o->worker].turn;
	page->bytes = (uint32_t)o->used;
	page->sum = final_sum(&o->sum);
	__atomic_store_n(&page->signal, ++o->signal, __ATOMIC_SEQ_CST);
	if (__atomic_load_n(&u->gate->awaited, __ATOMIC_SEQ_CST) == o->worker + 1)
		ob_futex_wake(&page->signal, ~UINT32_C(0));
}

// Waits until the arranger has copied the full outbox.
static void wait_until_taken(ob_universe *u)
{
	ob_outbox *o = u->outbox;
	const uint32_t *taken = &u->gate_cell[o->worker].taken;
	for (uint32_t seen; (seen = __atomic_load_n(taken, __ATOMIC_ACQUIRE)) != o->signal && !o->stopped;
	     o->stopped = ob_gate_stopped(u))
		ob_futex_wait_ms(taken, seen, LOOK_AGAIN_MS);
	empty(u);
}

static void put_part(ob_outbox *o, const void *part, size_t bytes)
{
	if (o->summed)
		add_words(&o->sum, part, bytes);
	memcpy(o->page->record + o->used, part, bytes);
	o->used += bytes;
}

void ob_outbox_put(ob_universe *u, uint32_t kind, const void *record, size_t bytes, const void *more, size_t more_bytes)
{
	ob_outbox *o = u->outbox;
	const record_head head = { kind, (uint32_t)(bytes + more_bytes) };
	if (o->used + sizeof head + bytes + more_bytes > room_of(u)) {
		hand_over(u, false);
		wait_until_taken(u);
	}
	put_part(o, &head, sizeof head);
	put_part(o, record, bytes);
	if (more_bytes)
		put_part(o, more, more_bytes);
}

void ob_outbox_begin(ob_universe *u)
{
	ob_outbox *o = u->outbox;
	o->next_task = 0;
	o->end = (ob_outbox_end){ 0 };
	empty(u);
}

void ob_outbox_arrive(ob_universe *u)
{
	ob_outbox *o = u->outbox;
	ob_outbox_put(u, OB_OUTBOX_END, &o->end, sizeof o->end, NULL, 0);
	o->done = u->gate_cell[o->worker].turn;
	hand_over(u, true);
}

uint32_t ob_outbox_turns_done(const ob_universe *u)
{
	return u->outbox->done;
}

uint32_t ob_task_owner(uint32_t index, uint32_t workers)
{
	const uint32_t round = index / workers, place = index % workers;
	return round % 2 ? workers - 1 - place : place;
}

uint32_t ob_task_workers(const ob_universe *u)
{
	return u->control->claim_workers;
}

uint32_t ob_task_first(const ob_universe *u)
{
	return u->control->claim_first;
}

bool ob_outbox_claim(ob_universe *u, uint32_t *index)
{
	ob_outbox *o = u->outbox;
	const uint64_t total = u->control->claim_total, workers = u->control->claim_workers, round = o->next_task++,
		       place = o->worker - u->control->claim_first;
	if (!workers)
		return false;
	const uint64_t i = round * workers + (round % 2 ? workers - 1 - place : place);
	*index = (uint32_t)i;
	return i < total;
}

// ---- the arranger's side

// Sleeps until the simulator has signalled. Returns false on STOP.
static bool wait_for_signal(ob_universe *u, uint32_t worker, uint32_t taken)
{
	uint32_t *signal = &page_of(u, worker)->signal;
	while (__atomic_load_n(signal, __ATOMIC_ACQUIRE) == taken) {
		__atomic_store_n(&u->gate->awaited, worker + 1, __ATOMIC_SEQ_CST);
		ob_futex_wait_ms(signal, taken, LOOK_AGAIN_MS);
		__atomic_store_n(&u->gate->awaited, 0, __ATOMIC_RELAXED);
		if (ob_gate_stopped(u))
			return false;
	}
	return !ob_gate_stopped(u);
}

// Makes room for so many more bytes.
static bool grow(ob_mail *m, size_t more)
{
	if (m->used + more <= m->max)
		return true;
	const size_t max = 2 * (m->used + more);
	char *larger = realloc(m->bytes, max);
	if (!larger)
		return false;
	m->bytes = larger;
	m->max = max;
	return true;
}

// Copies the simulator's outbox. Returns NULL, or a description of the error.
static const char *take(ob_universe *u, ob_mail *m, uint32_t worker, bool *last)
{
	const outbox_page *page = page_of(u, worker);
	ob_gate_cell *cell = u->gate_cell + worker;
	const uint32_t bytes = page->bytes, taken = cell->taken + 1;
	const part_head part = { worker, bytes };
	*last = page->last;
	if (__atomic_load_n(&page->signal, __ATOMIC_ACQUIRE) != taken || page->turn != cell->turn || page->last > 1)
		return "has lost its turn";
	if (bytes > room_of(u) || bytes % 8)
		return "has handed over more than fits in";
	if (!grow(m, sizeof part + bytes))
		return "has handed over more than there is memory for";
	memcpy(m->bytes + m->used, &part, sizeof part);
	memcpy(m->bytes + m->used + sizeof part, page->record, bytes);
	checksum sum = start_sum(worker, cell->turn);
	if (u->header.harden & 1 << OB_HARDEN_CHECKSUM)
		add_words(&sum, m->bytes + m->used + sizeof part, bytes);
	if (final_sum(&sum) != page->sum)
		return "has handed over what does not bear its checksum";
	m->used += sizeof part + bytes;
	__atomic_store_n(&cell->taken, taken, __ATOMIC_RELEASE);
	if (!*last)
		ob_futex_wake(&cell->taken, ~UINT32_C(0));
	return NULL;
}

static bool collect_from(ob_universe *u, ob_mail *m, uint32_t worker)
{
	for (bool last = false; !last;) {
		if (!wait_for_signal(u, worker, u->gate_cell[worker].taken))
			return false;
		const char *wrong = take(u, m, worker, &last);
		if (wrong) {
			ob_step_blame(u, worker, wrong);
			return true;
		}
	}
	ob_gate_group *group = u->gate_group + worker / 64; // for ob_gate_waits_for
	__atomic_fetch_or(&group->arrived, UINT64_C(1) << worker % 64, __ATOMIC_RELAXED);
	return true;
}

bool ob_mail_collect(ob_universe *u, ob_mail *m)
{
	ob_mail_clear(m);
	for (uint32_t w = 0; w < ob_universe_simulators(u); w++)
		if (u->gate_group[w / 64].expected >> w % 64 & 1 && ob_worker_is_here(u, w) && !collect_from(u, m, w))
			return false;
	return true;
}

void ob_mail_clear(ob_mail *m)
{
	m->used = m->at = m->end = m->part = 0;
}

bool ob_mail_append(ob_mail *m, const void *bytes, size_t n)
{
	if (!grow(m, n))
		return false;
	if (n)
		memcpy(m->bytes + m->used, bytes, n);
	m->used += n;
	return true;
}

bool ob_mail_append_record(ob_mail *m, const ob_mail_record *r)
{
	const record_head head = { r->kind, r->bytes };
	part_head part = { r->worker, 0 };
	if (m->part)
		memcpy(&part, m->bytes + m->part - 1, sizeof part);
	if (!grow(m, sizeof part + sizeof head + r->bytes))
		return false;
	if (!m->part || part.worker != r->worker) {
		part = (part_head){ r->worker, 0 };
		m->part = 1 + m->used;
		m->used += sizeof part;
	}
	part.bytes += sizeof head + r->bytes;
	memcpy(m->bytes + m->part - 1, &part, sizeof part);
	memcpy(m->bytes + m->used, &head, sizeof head);
	memcpy(m->bytes + m->used + sizeof head, r->data, r->bytes);
	m->used += sizeof head + r->bytes;
	return true;
}

// Prefetches as many bytes as were just read: mails are long, and read once.
static void prefetch_behind(const ob_mail *m, size_t bytes)
{
	enum { AHEAD = 1024, LINE = 64 };
	const char *from = m->bytes + m->at;
	for (size_t i = 0; i < bytes; i += LINE)
		if (m->at + AHEAD + i < m->used)
			__builtin_prefetch(from + AHEAD + i);
}

bool ob_mail_next(ob_universe *u, ob_mail *m, ob_mail_record *out)
{
	part_head part;
	record_head head;
	while (m->at == m->end) {
		if (m->at == m->used)
			return false;
		memcpy(&part, m->bytes + m->at, sizeof part);
		m->worker = (uint32_t)part.worker;
		m->at += sizeof part;
		m->end = m->at + part.bytes;
	}
	memcpy(&head, m->bytes + m->at, sizeof head);
	m->at += sizeof head;
	if (head.bytes > m->end - m->at) {
		ob_step_blame(u, m->worker, "has handed over a record that does not end");
		return false;
	}
	*out = (ob_mail_record){ m->worker, head.kind, head.bytes, m->bytes + m->at };
	m->at += head.bytes;
	prefetch_behind(m, sizeof head + head.bytes);
	return true;
}

bool ob_mail_next_end(ob_mail *m, ob_mail_record *out)
{
	enum { BYTES = sizeof(record_head) + sizeof(ob_outbox_end) };
	part_head part;
	record_head head;
	while (m->at < m->used) {
		memcpy(&part, m->bytes + m->at, sizeof part);
		m->at += sizeof part + part.bytes;
		if (part.bytes < BYTES) // more follows from the same simulator
			continue;
		memcpy(&head, m->bytes + m->at - BYTES, sizeof head);
		if (head.kind != OB_OUTBOX_END || head.bytes != sizeof(ob_outbox_end))
			continue;
		*out = (ob_mail_record){ (uint32_t)part.worker, head.kind, head.bytes,
					 m->bytes + m->at - sizeof(ob_outbox_end) };
		return true;
	}
	return false;
}

void ob_mail_finish(ob_mail *m)
{
	free(m->bytes);
}
