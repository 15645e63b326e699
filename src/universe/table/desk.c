#include "table/desk.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "table/futex.h"
#include "table/layout.h"

typedef struct ob_desk_slip {
	uint32_t lives; // by the owner: number of the newest process
	uint32_t ended; // by the owner: number of the last that has ended
	ob_desk_end end; // by the owner
	uint32_t question, shares; // by the worker; shares: 0 = it does not wait
} ob_desk_slip;

typedef struct ob_desk_page {
	uint32_t asked; // by the worker
	uint32_t answered; // by the process; by the owner at its end
	uint32_t done; // by the process
	uint32_t zero[13];
	unsigned char data[OB_DESK_BYTES];
} ob_desk_page;

enum { PAGE = 4096, DESK = (sizeof(ob_desk_page) + PAGE - 1) / PAGE * PAGE };

static size_t slips_bytes(uint32_t foreign)
{
	return (foreign * sizeof(ob_desk_slip) + PAGE - 1) / PAGE * PAGE;
}

static size_t block_bytes(uint32_t foreign)
{
	return slips_bytes(foreign) + (size_t)foreign * DESK;
}

static size_t all_bytes(const ob_universe *u)
{
	return u->header.sizes.workers * block_bytes(u->desks.foreign);
}

bool ob_desks_create(ob_universe *u, uint32_t foreign, ob_error *e)
{
	u->desks.foreign = foreign;
	u->desks.bell = -1;
	if (!foreign)
		return true;
	void *at = mmap(NULL, all_bytes(u), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	if (at == MAP_FAILED)
		return ob_fail(e, "no memory for the exchange with FMUs: %s", strerror(errno));
	u->desks.base = at;
	return true;
}

void ob_desks_destroy(ob_universe *u)
{
	if (u->desks.base)
		munmap(u->desks.base, all_bytes(u));
	u->desks.base = NULL;
}

void ob_desks_set_bell(ob_universe *u, int bell)
{
	u->desks.bell = bell;
}

uint32_t ob_desks_count(const ob_universe *u)
{
	return u->desks.base ? u->header.sizes.workers * u->desks.foreign : 0;
}

ob_desk ob_desk_of(const ob_universe *u, uint32_t worker, uint32_t foreign)
{
	const uint32_t each = u->desks.foreign;
	if (!u->desks.base || worker >= u->header.sizes.workers || foreign >= each)
		return (ob_desk){ .slip = NULL };
	char *block = u->desks.base + worker * block_bytes(each);
	return (ob_desk){ .slip = (ob_desk_slip *)(void *)block + foreign,
			  .page = (ob_desk_page *)(void *)(block + slips_bytes(each) + (size_t)foreign * DESK),
			  .index = worker * each + foreign,
			  .bell = u->desks.bell };
}

ob_desk ob_desk_at(const ob_universe *u, uint32_t index)
{
	return u->desks.foreign ? ob_desk_of(u, index / u->desks.foreign, index % u->desks.foreign)
				: (ob_desk){ .slip = NULL };
}

uint32_t ob_desk_foreign(const ob_universe *u, const ob_desk *d)
{
	return d->index % u->desks.foreign;
}

void *ob_desk_data(const ob_desk *d)
{
	return d->page->data;
}

// Unmaps all but these bytes of the desks.
static bool keep(const ob_universe *u, char *from, size_t bytes)
{
	char *base = u->desks.base, *end = base + all_bytes(u);
	return (from == base || munmap(base, (size_t)(from - base)) == 0) &&
	       (from + bytes == end || munmap(from + bytes, (size_t)(end - from) - bytes) == 0);
}

bool ob_desks_keep_own(const ob_universe *u, uint32_t worker)
{
	const size_t each = block_bytes(u->desks.foreign);
	return !u->desks.base || keep(u, u->desks.base + worker * each, each);
}

bool ob_desk_keep_alone(const ob_universe *u, const ob_desk *d)
{
	return keep(u, (char *)d->page, DESK) && munmap(u->base, u->header.bytes) == 0;
}

// ---- words

static uint32_t load(const uint32_t *word)
{
	return __atomic_load_n(word, __ATOMIC_ACQUIRE);
}

static void store(uint32_t *word, uint32_t value)
{
	__atomic_store_n(word, value, __ATOMIC_RELEASE);
}

// ---- the worker

bool ob_desk_is_ready(const ob_desk *d)
{
	return load(&d->slip->lives) != load(&d->slip->ended) && load(&d->slip->shares) == 0;
}

uint32_t ob_desk_number(const ob_desk *d)
{
	return load(&d->slip->lives);
}

uint32_t ob_desk_call(const ob_desk *d)
{
	const uint32_t number = load(&d->slip->lives) + 1;
	store(&d->slip->shares, 0);
	const uint32_t call[] = { d->index, number };
	while (write(d->bell, call, sizeof call) < 0 && errno == EINTR)
		;
	return number;
}

bool ob_desk_is_here(const ob_desk *d, uint32_t number, int ms)
{
	const uint32_t seen = load(&d->slip->lives);
	if (seen != number)
		ob_futex_wait_ms(&d->slip->lives, seen, ms);
	return load(&d->slip->lives) == number;
}

void ob_desk_ask(const ob_desk *d, uint32_t shares)
{
	const uint32_t question = d->slip->question + 1 ? d->slip->question + 1 : 1;
	store(&d->page->done, 0);
	store(&d->slip->question, question);
	store(&d->slip->shares, shares);
	store(&d->page->asked, question);
	ob_futex_wake(&d->page->asked, ~UINT32_C(0));
}

ob_desk_state ob_desk_wait(const ob_desk *d, uint32_t number, int ms, ob_desk_end *end)
{
	ob_desk_slip *s = d->slip;
	const uint32_t answered = load(&d->page->answered);
	if (answered != s->question && load(&s->ended) != number)
		ob_futex_wait_ms(&d->page->answered, answered, ms);
	if (load(&s->ended) == number) {
		*end = s->end;
		store(&s->shares, 0);
		return OB_DESK_ENDED;
	}
	if (load(&d->page->answered) != s->question)
		return OB_DESK_WAITS;
	store(&s->shares, 0);
	return OB_DESK_ANSWERED;
}

uint32_t ob_desk_done(const ob_desk *d)
{
	return load(&d->page->done);
}

// ---- the process at the desk

uint32_t ob_desk_seen(const ob_desk *d)
{
	return load(&d->page->answered);
}

uint32_t ob_desk_next(const ob_desk *d, uint32_t seen)
{
	uint32_t asked;
	while ((asked = load(&d->page->asked)) == seen)
		ob_futex_wait(&d->page->asked, seen, ~UINT32_C(0), NULL);
	return asked;
}

void ob_desk_set_done(const ob_desk *d, uint32_t done)
{
	store(&d->page->done, done);
}

void ob_desk_answer(const ob_desk *d, uint32_t question)
{
	store(&d->page->answered, question);
	ob_futex_wake(&d->page->answered, ~UINT32_C(0));
}

// ---- the owner

uint32_t ob_desk_open(const ob_desk *d)
{
	const uint32_t number = d->slip->lives + 1;
	store(&d->page->answered, load(&d->page->asked));
	store(&d->slip->lives, number);
	ob_futex_wake(&d->slip->lives, ~UINT32_C(0));
	return number;
}

void ob_desk_close(const ob_desk *d, uint32_t number, const ob_desk_end *end)
{
	d->slip->end = *end;
	store(&d->slip->ended, number);
	__atomic_fetch_add(&d->page->answered, UINT32_C(1) << 31, __ATOMIC_RELEASE); // no answer: wakes a worker
	ob_futex_wake(&d->page->answered, ~UINT32_C(0));
}

uint32_t ob_desk_question(const ob_desk *d, uint32_t *shares)
{
	*shares = load(&d->slip->shares);
	return *shares ? load(&d->slip->question) : 0;
}

bool ob_desks_await_answers(const ob_universe *u)
{
	bool found = false;
	for (uint32_t i = 0; i < ob_desks_count(u) && !found; i++) {
		const ob_desk d = ob_desk_at(u, i);
		uint32_t shares;
		const uint32_t question = ob_desk_question(&d, &shares);
		found = question && load(&d.page->answered) != question && load(&d.slip->ended) != load(&d.slip->lives);
	}
	return found;
}
