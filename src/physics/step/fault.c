#include "step/fault.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "base/random.h"
#include "table/outbox.h"

enum { EXIT_CODE = 99, RANGES_MAX = 64, PAGE = 4096 };

// ---- scribbling on memory that this process can write

typedef struct shared_range {
	char *begin;
	size_t pages, in_use;
	unsigned char *resident; // [pages], bit 0; NULL: all are in use
} shared_range;

// Finds shared memory that this process may write, and its pages in use. A process with a read-only universe may not
// ask the system: it has its own outbox alone.
static size_t find_shared(const ob_universe *u, shared_range *out, size_t *in_use)
{
	if (ob_universe_contained(u) && ob_universe_harden(u) & 1 << OB_HARDEN_PAGES) {
		size_t bytes;
		*out = (shared_range){ .begin = ob_outbox_own(u, &bytes) };
		*in_use = out->pages = out->in_use = bytes / PAGE;
		return 1;
	}
	char line[512];
	size_t n = 0;
	FILE *maps = fopen("/proc/self/maps", "re");
	*in_use = 0;
	while (maps && n < RANGES_MAX && fgets(line, sizeof line, maps)) {
		uintptr_t begin, end;
		char mode[5];
		if (sscanf(line, "%" SCNxPTR "-%" SCNxPTR " %4s", &begin, &end, mode) != 3 || mode[1] != 'w' ||
		    mode[3] != 's')
			continue;
		shared_range *r = &out[n];
		*r = (shared_range){ .begin = (char *)begin, .pages = (end - begin) / PAGE };
		r->resident = malloc(r->pages);
		if (!r->resident || mincore(r->begin, end - begin, r->resident) != 0) {
			free(r->resident);
			continue;
		}
		for (size_t i = 0; i < r->pages; i++)
			r->in_use += r->resident[i] & 1;
		*in_use += r->in_use;
		n++;
	}
	if (maps)
		fclose(maps);
	return n;
}

static char *nth_page(const shared_range *r, size_t n)
{
	size_t i = 0;
	if (!r->resident)
		return r->begin + n * PAGE;
	while (!(r->resident[i] & 1) || n-- > 0)
		i++;
	return r->begin + i * PAGE;
}

// Returns a word as bugs store it: with a flipped bit, or an index, a special number, or random bits.
static uint64_t spoilt(uint64_t word, uint64_t *random)
{
	static const double numbers[] = { 0, -1, 1e300, 1e-300, INFINITY, NAN };
	switch (ob_splitmix(random) % 4) {
	case 0:
		return word ^ UINT64_C(1) << ob_splitmix(random) % 64;
	case 1:
		return ob_splitmix(random) % 1000;
	case 2:
		memcpy(&word, &numbers[ob_splitmix(random) % 6], sizeof word);
		return word;
	default:
		return ob_splitmix(random);
	}
}

static void scribble(const ob_universe *u, uint32_t words, uint64_t random)
{
	shared_range range[RANGES_MAX];
	size_t in_use, ranges = find_shared(u, range, &in_use);
	for (uint32_t i = 0; i < words && in_use > 0; i++) {
		size_t page = ob_splitmix(&random) % in_use;
		const shared_range *r = range;
		while (page >= r->in_use)
			page -= r++->in_use;
		volatile uint64_t *to =
			(volatile uint64_t *)nth_page(r, page) + ob_splitmix(&random) % (PAGE / sizeof *to);
		*to = spoilt(*to, &random);
	}
	for (size_t i = 0; i < ranges; i++)
		free(range[i].resident);
}

// ---- all faults

_Noreturn static void say_and_abort(void)
{
	static const char words[] = "an assertion failed, as it was to (--fault abort)\n";
	ssize_t ignored = write(STDERR_FILENO, words, sizeof words - 1);
	(void)ignored;
	abort();
}

static void fail(const ob_universe *u, ob_fault_kind kind, const ob_fault_plan *plan, uint64_t random)
{
	switch (kind) {
	case OB_FAULT_KILL:
		kill(getpid(), SIGKILL);
		break;
	case OB_FAULT_SEGV:
		signal(SIGSEGV, SIG_DFL);
		raise(SIGSEGV);
		break;
	case OB_FAULT_EXIT:
		_exit(EXIT_CODE);
	case OB_FAULT_STOP:
		raise(SIGSTOP);
		break;
	case OB_FAULT_SLOW:
		nanosleep(&(struct timespec){ plan->sleep_ms / 1000, plan->sleep_ms % 1000 * 1000000L }, NULL);
		break;
	case OB_FAULT_SCRIBBLE:
		scribble(u, plan->words, random);
		break;
	case OB_FAULT_ABORT:
		say_and_abort();
	case OB_FAULT_NOSPACE: // these two do not concern simulators
	case OB_FAULT_NOPAGES:
	case OB_FAULT_KINDS:
		break;
	}
}

// Draws a chance to fail. Lives take part in the draw: otherwise a simulator restarted from a checkpoint would fail at
// the same place for ever.
void ob_fault_chance_of(ob_universe *u, uint32_t worker, uint64_t *chances)
{
	enum { SIMULATORS = ~(1 << OB_FAULT_NOSPACE | 1 << OB_FAULT_NOPAGES) };
	const ob_fault_plan *plan = &ob_universe_settings(u)->fault;
	uint64_t random = 0;
	if (!(plan->probability > 0))
		return;
	const uint64_t chance = (uint64_t)ob_universe_lives(u) << 40 | (*chances)++;
	ob_fault_kind kind = ob_fault_draw(plan, SIMULATORS, worker, chance, &random);
	if (kind == OB_FAULT_KINDS)
		return;
	ob_fault_note(u, worker, kind);
	fail(u, kind, plan, random);
}

void ob_fault_chance(ob_sim *s)
{
	if (!(s->settings->fault.probability > 0) || s->committer) // the arranger is no simulator
		return;
	ob_fault_chance_of(s->u, s->worker, &s->fault_chances);
}
