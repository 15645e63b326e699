#include "table/outbox.h"

#include <sys/mman.h>

#include "table/futex.h"
#include "table/layout.h"
#include "table/outbox_page.h"

bool ob_outbox_enter(ob_universe *u, uint32_t worker)
{
	static ob_outbox own; // a process is one simulator
	const size_t each = u->header.sizes.outbox_bytes;
	own = (ob_outbox){ .page = ob_outbox_page_of(u, worker), .worker = worker };
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
		__atomic_store_n(&ob_outbox_page_of(u, w)->signal, 0, __ATOMIC_RELAXED);
		__atomic_store_n(&ob_outbox_page_of(u, w)->working_on, 0, __ATOMIC_RELAXED);
	}
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
	o->sum = ob_checksum_start(o->worker, u->gate_cell[o->worker].turn);
}

static void hand_over(ob_universe *u, bool last)
{
	ob_outbox *o = u->outbox;
	ob_outbox_page *page = o->page;
	page->last = last;
	page->turn = u->gate_cell[o->worker].turn;
	page->bytes = (uint32_t)o->used;
	page->sum = ob_checksum_end(&o->sum);
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
		ob_futex_wait_ms(taken, seen, OB_OUTBOX_LOOK_AGAIN_MS);
	empty(u);
}

static void put_part(ob_outbox *o, const void *part, size_t bytes)
{
	if (o->summed)
		ob_checksum_add(&o->sum, part, bytes);
	memcpy(o->page->record + o->used, part, bytes);
	o->used += bytes;
}

void ob_outbox_put(ob_universe *u, uint32_t kind, const void *record, size_t bytes, const void *more, size_t more_bytes)
{
	ob_outbox *o = u->outbox;
	const ob_record_head head = { kind, (uint32_t)(bytes + more_bytes) };
	if (o->used + sizeof head + bytes + more_bytes > ob_outbox_room(u)) {
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

uint32_t ob_outbox_next_task(const ob_universe *u, uint32_t *worker)
{
	*worker = u->outbox->worker;
	return u->outbox->next_task++;
}
