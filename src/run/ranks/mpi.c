#include "ranks/module.h"

#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static int ranks;
static int *counts, *offsets, *own_counts, *own_offsets;

static bool open_mpi(uint32_t *rank, uint32_t *all)
{
	int own;
	if (MPI_Init(NULL, NULL) != MPI_SUCCESS)
		return false;
	MPI_Comm_rank(MPI_COMM_WORLD, &own);
	MPI_Comm_size(MPI_COMM_WORLD, &ranks);
	counts = calloc((size_t)ranks, sizeof *counts);
	offsets = calloc((size_t)ranks, sizeof *offsets);
	own_counts = calloc((size_t)ranks, sizeof *own_counts);
	own_offsets = calloc((size_t)ranks, sizeof *own_offsets);
	*rank = (uint32_t)own;
	*all = (uint32_t)ranks;
	return counts && offsets && own_counts && own_offsets;
}

static double seconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// MPI polls while it waits. Here polling is short, as the core may be a simulator's; then come naps, each a share of
// the time waited. So a wait is prolonged by at most that share, with few wakings for any duration.
static void wait_for(MPI_Request *r)
{
	static const double poll = 30e-6, shortest = 20e-6, longest = 2e-3, share = .25; // s
	const double begun = seconds();
	int done = 0;
	for (;;) {
		MPI_Test(r, &done, MPI_STATUS_IGNORE);
		if (done)
			return;
		const double waited = seconds() - begun, nap = share * waited;
		if (waited > poll)
			nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * (nap < shortest  ? shortest
									       : nap > longest ? longest
											       : nap)) },
				  NULL);
	}
}

static void gather_first(const ob_wire_first *mine, ob_wire_first *all)
{
	MPI_Request r;
	MPI_Iallgather(mine, sizeof *mine / 8, MPI_UINT64_T, all, sizeof *all / 8, MPI_UINT64_T, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

// Lengths in units of 8 bytes, so that an int counts 16 GB.
static void in_words(const size_t *at, const size_t *bytes, int *offset, int *count)
{
	for (int i = 0; i < ranks; i++) {
		count[i] = (int)(bytes[i] / 8);
		offset[i] = (int)(at[i] / 8);
	}
}

static void gather_rest(const void *mine, char *all, const size_t *at, const size_t *bytes)
{
	MPI_Request r;
	int own;
	MPI_Comm_rank(MPI_COMM_WORLD, &own);
	in_words(at, bytes, offsets, counts);
	MPI_Iallgatherv(mine, counts[own], MPI_UINT64_T, all, counts, offsets, MPI_UINT64_T, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

static void deal_first(const ob_wire_first *mine, ob_wire_first *all)
{
	MPI_Request r;
	MPI_Ialltoall(mine, sizeof *mine / 8, MPI_UINT64_T, all, sizeof *all / 8, MPI_UINT64_T, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

static void deal_rest(const char *mine, const size_t *mine_at, const size_t *mine_bytes, char *all, const size_t *at,
		      const size_t *bytes)
{
	MPI_Request r;
	in_words(mine_at, mine_bytes, own_offsets, own_counts);
	in_words(at, bytes, offsets, counts);
	MPI_Ialltoallv(mine, own_counts, own_offsets, MPI_UINT64_T, all, counts, offsets, MPI_UINT64_T, MPI_COMM_WORLD,
		       &r);
	wait_for(&r);
}

static void send_bytes(uint32_t to, const void *bytes, size_t n)
{
	MPI_Request r;
	MPI_Isend(bytes, (int)n, MPI_BYTE, (int)to, 0, MPI_COMM_WORLD, &r);
	wait_for(&r);
}

static bool probe(uint32_t *from, size_t *n)
{
	int there, size;
	MPI_Status of;
	MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &of);
	if (!there)
		return false;
	MPI_Get_count(&of, MPI_BYTE, &size);
	*from = (uint32_t)of.MPI_SOURCE;
	*n = (size_t)size;
	return true;
}

static void receive_bytes(uint32_t from, void *to, size_t n)
{
	MPI_Recv(to, (int)n, MPI_BYTE, (int)from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

static void close_mpi(void)
{
	MPI_Finalize();
	free(counts);
	free(offsets);
	free(own_counts);
	free(own_offsets);
}

_Static_assert(sizeof(ob_wire_first) % 8 == 0, "it goes over the wire in words");

OB_PART(ob_wire_module) = {
	OB_PART_HEAD(ob_wire_module), .open = open_mpi,       .first = gather_first, .rest = gather_rest,
	.deal_first = deal_first,     .deal_rest = deal_rest, .send = send_bytes,    .probe = probe,
	.receive = receive_bytes,     .close = close_mpi,
};
