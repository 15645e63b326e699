#include "ranks/module.h"

#include <limits.h>
#include <mpi.h>
#include <stdlib.h>
#include <time.h>

static int ranks;
static int *counts, *offsets;

static bool open_mpi(uint32_t *rank, uint32_t *all)
{
	int own;
	if (MPI_Init(NULL, NULL) != MPI_SUCCESS)
		return false;
	MPI_Comm_rank(MPI_COMM_WORLD, &own);
	MPI_Comm_size(MPI_COMM_WORLD, &ranks);
	counts = calloc((size_t)ranks, sizeof *counts);
	offsets = calloc((size_t)ranks, sizeof *offsets);
	*rank = (uint32_t)own;
	*all = (uint32_t)ranks;
	return counts && offsets;
}

// MPI polls while it waits; here only for a moment, for the core may be a simulator's.
static void wait_for(MPI_Request *r)
{
	enum { POLLS = 200, NAP_NS = 20000 };
	int done = 0;
	for (int i = 0; !done; i++) {
		MPI_Test(r, &done, MPI_STATUS_IGNORE);
		if (!done && i >= POLLS)
			nanosleep(&(struct timespec){ .tv_nsec = NAP_NS }, NULL);
	}
}

static void gather_sizes(size_t mine, size_t *size)
{
	MPI_Request r;
	const uint64_t bytes = mine;
	MPI_Iallgather(&bytes, 1, MPI_UINT64_T, size, 1, MPI_UINT64_T, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

// In words of 8 bytes, of which a message has a whole number: so an int counts 16 GB.
static void gather_bytes(const void *mine, char *all, const size_t *at)
{
	MPI_Request r;
	int own;
	MPI_Comm_rank(MPI_COMM_WORLD, &own);
	for (int i = 0; i < ranks; i++) {
		counts[i] = (int)((at[i + 1] - at[i]) / 8);
		offsets[i] = (int)(at[i] / 8);
	}
	MPI_Iallgatherv(mine, counts[own], MPI_UINT64_T, all, counts, offsets, MPI_UINT64_T, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

static void close_mpi(void)
{
	MPI_Finalize();
	free(counts);
	free(offsets);
}

_Static_assert(sizeof(size_t) == sizeof(uint64_t), "sizes go over the wire as they are");

extern const ob_wire_module ob_wire_mpi;
__attribute__((visibility("default")))
const ob_wire_module ob_wire_mpi = { open_mpi, gather_sizes, gather_bytes, close_mpi };
