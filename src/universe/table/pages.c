#include "table/pages.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/allocate.h"

// ---- reservation

// True if an injected fault makes /dev/shm full at this page.
static bool fails(ob_universe *u, uint64_t page)
{
	uint64_t random;
	const ob_fault_plan *plan = &u->header.run.fault;
	if (ob_fault_draw(plan, 1u << OB_FAULT_NOPAGES, UINT32_MAX, page, &random) == OB_FAULT_KINDS)
		return false;
	ob_fault_note(u, 0, OB_FAULT_NOPAGES);
	return true;
}

static bool take_page(ob_universe *u, uint64_t page)
{
	uint64_t bit = UINT64_C(1) << page % 64, at = page * OB_LAYOUT_PAGE;
	uint64_t *word = &u->taken[page / 64];
	if (__atomic_load_n(word, __ATOMIC_RELAXED) & bit)
		return true;
	if (fails(u, page))
		return false;
	// EINVAL: kernels before 5.14 lack it, and pages come when they are touched
	if (madvise(u->base + at, OB_LAYOUT_PAGE, MADV_POPULATE_WRITE) != 0 && errno != EINVAL)
		return false;
	__atomic_fetch_or(word, bit, __ATOMIC_RELAXED);
	return true;
}

static bool take_bytes(ob_universe *u, uint64_t begin, uint64_t end)
{
	for (uint64_t page = begin / OB_LAYOUT_PAGE; begin < end && page <= (end - 1) / OB_LAYOUT_PAGE; page++)
		if (!take_page(u, page))
			return false;
	return true;
}

bool ob_pages_take(ob_universe *u, ob_area area, uint64_t first, uint64_t count)
{
	const uint64_t element = ob_layout_element(area), at = u->header.area[area];
	const uint64_t next = area + 1 < OB_AREAS ? u->header.area[area + 1] : u->header.bytes;
	const uint64_t end = at + (first + count) * element;
	return take_bytes(u, at + first * element, end < next ? end : next);
}

bool ob_pages_take_first(ob_universe *u)
{
	return take_bytes(u, 0, u->header.area[OB_AREA_SLOT]);
}

bool ob_universe_reserve(ob_universe *u, uint32_t ids, ob_error *e)
{
	bool fine = true;
	for (int i = OB_AREA_SLOT; i < OB_AREAS && fine; i++) {
		const ob_area area = (ob_area)i;
		// most objects never have a second version of their body properties, and outboxes are seldom full;
		// cells, joints and contacts of groups are taken one by one
		if (area != OB_AREA_PASSPORT_EVEN && area != OB_AREA_FREE_CONTACT_MORE && area != OB_AREA_OUTBOX &&
		    area != OB_AREA_SCRIPT_CELL && area != OB_AREA_JOINT && area != OB_AREA_JOINT_STATE &&
		    area != OB_AREA_NEXT_JOINT)
			fine = ob_pages_take(u, area, 0, ob_layout_elements_of(&u->header.sizes, area, ids));
	}
	struct statvfs s = { 0 };
	return fine || (fstatvfs(u->fd, &s),
			ob_fail(e,
				"/dev/shm is full (%" PRIu64 " MiB): enlarge it (mount -o remount,size=..., docker run "
				"--shm-size=...) or take fewer objects",
				(uint64_t)s.f_blocks * s.f_frsize >> 20));
}

bool ob_reserve_pairs(ob_universe *u, uint32_t first, uint32_t count)
{
	static const ob_area each[] = { OB_AREA_PAIR, OB_AREA_PAIR_LINKS, OB_AREA_LOOK, OB_AREA_CHECK,
					OB_AREA_ISLAND_PAIR };
	bool fine = ob_pages_take(u, OB_AREA_LOOK_64, first / 64, 1 + count / 64) &&
		    ob_pages_take(u, OB_AREA_LOOK_4096, first / 4096, 1 + count / 4096);
	for (size_t i = 0; i < sizeof each / sizeof *each && fine; i++)
		fine = ob_pages_take(u, each[i], first, count);
	return fine;
}

bool ob_reserve_record(ob_universe *u, uint32_t record)
{
	const bool two = ob_solver_is_two_sided(u->header.run.solver);
	return ob_pages_take(u, OB_AREA_RECORD, record, 1) && (!two || ob_pages_take(u, OB_AREA_IMPULSE_B, record, 1));
}

// ---- pages in use

struct ob_used_pages {
	int64_t blocks; // of the whole file when these were listed: pages do not go out of use, so the same number means the same pages
	ob_page_range *at; // [count], ascending
	size_t count, max;
};

struct ob_used_pages *ob_pages_create_used(void)
{
	return calloc(1, sizeof(struct ob_used_pages));
}

void ob_pages_destroy_used(struct ob_used_pages *p)
{
	if (p)
		free(p->at);
	free(p);
}

static bool find_used(const ob_universe *u, uint64_t from, ob_page_range *found)
{
	const uint64_t first = u->header.area[OB_AREA_REQUERY], end = u->header.area[OB_AREA_SCRATCH];
	const off_t begin = lseek(u->fd, (off_t)(from > first ? from : first), SEEK_DATA);
	if (begin < 0 || (uint64_t)begin >= end)
		return false;
	const off_t hole = lseek(u->fd, begin, SEEK_HOLE);
	found->begin = (uint64_t)begin;
	found->end = hole < 0 || (uint64_t)hole > end ? end : (uint64_t)hole;
	return true;
}

// Without memory for it there is no list.
void ob_pages_list_used(const ob_universe *u)
{
	struct ob_used_pages *p = u->used;
	struct stat s;
	ob_page_range r = { 0, 0 };
	if (fstat(u->fd, &s) != 0 || p->blocks == s.st_blocks)
		return;
	p->blocks = 0;
	for (p->count = 0; find_used(u, r.end, &r); p->count++) {
		if (!OB_MAKE_ROOM(p->at, p->count, p->max))
			return;
		p->at[p->count] = r;
	}
	p->blocks = s.st_blocks;
}

bool ob_pages_next_used(const ob_universe *u, size_t i, uint64_t from, ob_page_range *found)
{
	const struct ob_used_pages *p = u->used;
	if (!p->blocks)
		return find_used(u, from, found);
	if (i < p->count)
		*found = p->at[i];
	return i < p->count;
}

// ---- missing pages

enum { TRACKED = 16 };
static const ob_universe *tracked[TRACKED];
static void (*before_end)(void);

bool ob_pages_track(const ob_universe *u)
{
	for (int i = 0; i < TRACKED; i++) {
		const ob_universe *none = NULL;
		if (__atomic_compare_exchange_n(&tracked[i], &none, u, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
			return true;
	}
	return false;
}

void ob_pages_forget(const ob_universe *u)
{
	for (int i = 0; i < TRACKED; i++) {
		const ob_universe *same = u;
		if (__atomic_compare_exchange_n(&tracked[i], &same, NULL, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST))
			return;
	}
}

const char *ob_universe_lost(const ob_universe *u)
{
	struct stat s;
	struct statvfs room;
	if (fstat(u->fd, &s) == 0 && (uint64_t)s.st_size < u->header.bytes)
		return "another program has cut it short";
	if (fstatvfs(u->fd, &room) == 0 && room.f_blocks != 0 && room.f_bavail == 0)
		return "/dev/shm is full: enlarge it (mount -o remount,size=..., docker run --shm-size=...)";
	return NULL;
}

static const ob_universe *find(const char *address)
{
	for (int i = 0; i < TRACKED; i++) {
		const ob_universe *u = __atomic_load_n(&tracked[i], __ATOMIC_SEQ_CST);
		if (u && address >= u->base && address < u->base + u->header.bytes)
			return u;
	}
	return NULL;
}

// Uses only functions allowed in a signal handler; writes in one piece, as others may be writing.
static void say_missing(const ob_universe *u)
{
	char line[512];
	const char *why = ob_universe_lost(u);
	char *end = stpcpy(line, "obsim: the memory of universe \"");
	end = stpncpy(end, u->header.name, OB_NAME_MAX);
	end = stpcpy(stpcpy(end, "\" is not all there: "), why ? why : "a page of it cannot be read");
	*end++ = '\n';
	ssize_t ignored = write(STDERR_FILENO, line, (size_t)(end - line));
	(void)ignored;
}

// Several threads may come here at once: the first reports it and ends them all.
static void on_missing_page(int number, siginfo_t *info, void *context)
{
	static int ending;
	(void)context;
	const ob_universe *u = find(info->si_addr);
	if (!u) {
		signal(number, SIG_DFL); // the instruction is retried, and ends the process
		return;
	}
	while (__atomic_exchange_n(&ending, 1, __ATOMIC_SEQ_CST))
		pause();
	if (before_end)
		before_end();
	say_missing(u);
	_exit(1);
}

void ob_pages_guard(void (*on_end)(void))
{
	struct sigaction action = { .sa_sigaction = on_missing_page, .sa_flags = SA_SIGINFO };
	before_end = on_end;
	sigaction(SIGBUS, &action, NULL);
}
