#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "table/futex.h"
#include "table/layout.h"
#include "table/outbox.h"
#include "table/outbox_page.h"

// Head of a simulator's records of one outbox in a mail.
typedef struct part_head {
	uint64_t worker, bytes; // size of the records behind this
} part_head;

// Sleeps until the simulator has signalled. Returns false on STOP.
static bool wait_for_signal(ob_universe *u, uint32_t worker, uint32_t taken)
{
	uint32_t *signal = &ob_outbox_page_of(u, worker)->signal;
	while (__atomic_load_n(signal, __ATOMIC_ACQUIRE) == taken) {
		__atomic_store_n(&u->gate->awaited, worker + 1, __ATOMIC_SEQ_CST);
		ob_futex_wait_ms(signal, taken, OB_OUTBOX_LOOK_AGAIN_MS);
		__atomic_store_n(&u->gate->awaited, 0, __ATOMIC_RELAXED);
		if (ob_gate_stopped(u))
			return false;
	}
	return !ob_gate_stopped(u);
}

// Makes room for so many more bytes. Once that fails, it goes on to.
static bool grow(ob_mail *m, size_t more)
{
	m->lost = m->lost || !OB_RESERVE(m->bytes, m->used + more, m->max);
	return !m->lost;
}

// Copies the simulator's outbox. Returns NULL, or a description of the error.
static const char *take(ob_universe *u, ob_mail *m, uint32_t worker, bool *last)
{
	const ob_outbox_page *page = ob_outbox_page_of(u, worker);
	ob_gate_cell *cell = u->gate_cell + worker;
	const uint32_t bytes = page->bytes, taken = cell->taken + 1;
	const part_head part = { worker, bytes };
	*last = page->last;
	if (__atomic_load_n(&page->signal, __ATOMIC_ACQUIRE) != taken || page->turn != cell->turn || page->last > 1)
		return "has lost its turn";
	if (bytes > ob_outbox_room(u) || bytes % 8)
		return "has handed over more than fits in";
	if (!grow(m, sizeof part + bytes))
		return "has handed over more than there is memory for";
	memcpy(m->bytes + m->used, &part, sizeof part);
	memcpy(m->bytes + m->used + sizeof part, page->record, bytes);
	ob_checksum sum = ob_checksum_start(worker, cell->turn);
	if (u->header.harden & 1 << OB_HARDEN_CHECKSUM)
		ob_checksum_add(&sum, m->bytes + m->used + sizeof part, bytes);
	if (ob_checksum_end(&sum) != page->sum)
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
	m->lost = false;
}

void ob_mail_append(ob_mail *m, const void *bytes, size_t n)
{
	if (!grow(m, n))
		return;
	if (n)
		memcpy(m->bytes + m->used, bytes, n);
	m->used += n;
}

void ob_mail_append_record(ob_mail *m, const ob_mail_record *r)
{
	const ob_record_head head = { r->kind, r->bytes };
	part_head part = { r->worker, 0 };
	if (m->part)
		memcpy(&part, m->bytes + m->part - 1, sizeof part);
	if (!grow(m, sizeof part + sizeof head + r->bytes))
		return;
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
	ob_record_head head;
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
	enum { BYTES = sizeof(ob_record_head) + sizeof(ob_outbox_end) };
	part_head part;
	ob_record_head head;
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
