#include "ranks/ranks.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/allocate.h"
#include "ranks/module.h"

enum {
	JOIN_S = 60, // s, in which all ranks must have started MPI
	BETWEEN_S = 5, // s, in which a launcher ends the other ranks
};

struct ob_wire {
	const ob_wire_module *module;
	uint32_t ranks;
	ob_wire_first *mine, *first; // [ranks]: headers to each rank, or to all in the first; headers received
	size_t *at; // [ranks + 1]
	size_t *rest_at, *rest; // [ranks]: offset and length of each rank's bytes after the first ones
	size_t *mine_at, *mine_rest; // [ranks]: the same for bytes to each rank
	char *all, *dealt; // received data; the rest of the bytes to each rank
	size_t max, dealt_max;
};

// Environment variables of launchers: rank, number of ranks. srun requires PMIx: without it, tasks cannot find each
// other. The script of a batch job, which also has a number of tasks, is not a rank.
static const char *const words[][2] = {
	{ "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE" }, // mpirun; in a Slurm job it sets other variables, too
	{ "PMIX_RANK", "SLURM_STEP_NUM_TASKS" }, // srun --mpi=pmix
};
enum { LAUNCHERS = sizeof words / sizeof *words };

ob_ranks ob_ranks_started(void)
{
	for (int i = 0; i < LAUNCHERS; i++) {
		const char *rank = getenv(words[i][0]), *ranks = getenv(words[i][1]);
		if (!rank || !ranks)
			continue;
		const ob_ranks said = { (uint32_t)strtoul(rank, NULL, 10), (uint32_t)strtoul(ranks, NULL, 10) };
		if (said.rank < said.ranks)
			return said;
	}
	return (ob_ranks){ 0, 1 };
}

void ob_ranks_forget(void)
{
	for (int i = 0; i < LAUNCHERS; i++)
		for (int k = 0; k < 2; k++)
			unsetenv(words[i][k]);
}

static ob_wire *create(uint32_t ranks)
{
	ob_wire *w = calloc(1, sizeof *w);
	if (!w)
		return NULL;
	w->ranks = ranks;
	w->mine = calloc(ranks, sizeof *w->mine);
	w->first = calloc(ranks, sizeof *w->first);
	w->at = calloc(ranks + 1, sizeof *w->at);
	w->rest_at = calloc(ranks, sizeof *w->rest_at);
	w->rest = calloc(ranks, sizeof *w->rest);
	w->mine_at = calloc(ranks, sizeof *w->mine_at);
	w->mine_rest = calloc(ranks, sizeof *w->mine_rest);
	return w;
}

static void destroy(ob_wire *w)
{
	free(w->mine);
	free(w->first);
	free(w->at);
	free(w->rest_at);
	free(w->rest);
	free(w->mine_at);
	free(w->mine_rest);
	free(w->all);
	free(w->dealt);
	free(w);
}

static char late_line[160];

static void end_late_start(int number)
{
	(void)number;
	const ssize_t ignored = write(STDERR_FILENO, late_line, strlen(late_line));
	(void)ignored;
	_exit(1);
}

void ob_ranks_limit_start(unsigned seconds, uint32_t rank)
{
	const unsigned wait = seconds ? seconds + BETWEEN_S * rank : 0;
	snprintf(late_line, sizeof late_line,
		 "obsim: rank %u has waited %u s for the others: does each rank of the launcher start obsim run?\n",
		 rank, wait);
	signal(SIGALRM, end_late_start);
	alarm(wait);
}

static bool join(ob_wire *w, const ob_ranks *ranks, ob_error *e)
{
	uint32_t rank, all;
	if (!w->mine || !w->first || !w->at || !w->rest_at || !w->rest || !w->mine_at || !w->mine_rest)
		return ob_fail(e, "out of memory");
	// global: MPI loads parts of itself, which look for its symbols
	w->module = ob_part_load("mpi", sizeof *w->module, OB_PART_OPEN, "libopenmpi3", e);
	if (!w->module)
		return false;
	ob_ranks_limit_start(JOIN_S, ranks->rank);
	const bool opened = w->module->open(&rank, &all);
	ob_ranks_limit_start(0, ranks->rank);
	if (!opened)
		return ob_fail(e, "MPI does not start");
	if (rank == ranks->rank && all == ranks->ranks)
		return true;
	w->module->close();
	return ob_fail(e, "the launcher has said rank %u of %u, MPI says %u of %u", ranks->rank, ranks->ranks, rank,
		       all);
}

ob_wire *ob_wire_open(const ob_ranks *ranks, ob_error *e)
{
	ob_wire *w = create(ranks->ranks);
	if (!w) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	if (join(w, ranks, e))
		return w;
	destroy(w);
	return NULL;
}

static size_t in_first(size_t bytes)
{
	return bytes < OB_WIRE_FIRST ? bytes : OB_WIRE_FIRST;
}

static void put_first(ob_wire_first *to, const void *mine, size_t n)
{
	to->bytes = n;
	if (n)
		memcpy(to->text, mine, in_first(n));
}

// Places the shares of all ranks after their headers have arrived, and copies their first bytes. Returns false if
// memory runs out.
static bool place_all(ob_wire *w)
{
	for (uint32_t r = 0; r < w->ranks; r++) {
		const size_t bytes = w->first[r].bytes, first = in_first(bytes);
		w->at[r + 1] = w->at[r] + bytes;
		w->rest_at[r] = w->at[r] + first;
		w->rest[r] = bytes - first;
	}
	if (!OB_RESERVE(w->all, w->at[w->ranks], w->max))
		return false;
	for (uint32_t r = 0; r < w->ranks; r++)
		if (w->first[r].bytes)
			memcpy(w->all + w->at[r], w->first[r].text, in_first(w->first[r].bytes));
	return true;
}

const char *ob_wire_gather(ob_wire *w, const void *mine, size_t n, const size_t **at)
{
	bool more = false;
	put_first(w->mine, mine, n);
	w->module->first(w->mine, w->first);
	if (!place_all(w))
		return NULL;
	for (uint32_t r = 0; r < w->ranks; r++)
		more |= w->rest[r] > 0;
	if (more)
		w->module->rest((const char *)mine + in_first(n), w->all, w->rest_at, w->rest);
	*at = w->at;
	return w->all;
}

// Collects the bytes to each rank after the first ones. Returns false if memory runs out.
static bool place_mine(ob_wire *w, const void *const *mine, const size_t *bytes)
{
	size_t n = 0;
	for (uint32_t r = 0; r < w->ranks; n += w->mine_rest[r++]) {
		w->mine_at[r] = n;
		w->mine_rest[r] = bytes[r] - in_first(bytes[r]);
	}
	if (!OB_RESERVE(w->dealt, n, w->dealt_max))
		return false;
	for (uint32_t r = 0; r < w->ranks; r++)
		if (w->mine_rest[r])
			memcpy(w->dealt + w->mine_at[r], (const char *)mine[r] + OB_WIRE_FIRST, w->mine_rest[r]);
	return true;
}

// No rank alone knows if any rank sends more than the first bytes, so each header states it for its sender.
const char *ob_wire_deal(ob_wire *w, const void *const *mine, const size_t *bytes, const size_t **at)
{
	bool more = false;
	for (uint32_t r = 0; r < w->ranks; r++)
		more |= bytes[r] > OB_WIRE_FIRST;
	for (uint32_t r = 0; r < w->ranks; r++) {
		put_first(&w->mine[r], mine[r], bytes[r]);
		w->mine[r].more = more;
	}
	w->module->deal_first(w->mine, w->first);
	for (uint32_t r = 0; r < w->ranks; r++)
		more |= w->first[r].more != 0;
	if (!place_all(w) || !place_mine(w, mine, bytes))
		return NULL;
	if (more)
		w->module->deal_rest(w->dealt, w->mine_at, w->mine_rest, w->all, w->rest_at, w->rest);
	*at = w->at;
	return w->all;
}

void ob_wire_send(ob_wire *w, uint32_t to, const void *bytes, size_t n)
{
	w->module->send(to, bytes, n);
}

const void *ob_wire_receive(ob_wire *w, uint32_t *from, size_t *n)
{
	if (!w->module->probe(from, n) || !OB_RESERVE(w->all, *n, w->max))
		return NULL;
	w->module->receive(*from, w->all, *n);
	return w->all;
}

void ob_wire_close(ob_wire *w)
{
	if (!w)
		return;
	w->module->close();
	destroy(w);
}
