// The processes that mpirun or srun has started together, its ranks, and the wire between them: for one universe on
// several machines, and for the trials of an experiment (courier.h).
//
//   rank 0                                rank 1                                rank 2
//   host, its simulators                  host, its simulators                  host, its simulators
//   universe  <- arranger ------ wire ------ arranger -> universe ------ wire ------ arranger -> universe
//
// Only mpi.c uses MPI. It is a module of its own, obsim-mpi.so, loaded if a run has more than one rank. So the program
// runs without MPI, and needs it nowhere else.
//
// Thread-safety: a wire belongs to one thread.
#ifndef OB_RANKS_RANKS_H
#define OB_RANKS_RANKS_H

#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

typedef struct ob_ranks {
	uint32_t rank, ranks; // number of this rank, from 0; number of ranks
} ob_ranks;

// Reads the variables of Open MPI's mpirun, or Slurm's srun --mpi=pmix. One rank: no launcher.
ob_ranks ob_ranks_started(void);
// Makes this process, and programs that it starts, a single rank.
void ob_ranks_forget(void);

// Limits the start of MPI, which waits for ever for a rank that runs another program: after "seconds", and 5 more for
// each rank before this one, the process ends with a line, exit 1. So one rank writes it, and the launcher ends the
// others. seconds = 0: all have started.
void ob_ranks_limit_start(unsigned seconds, uint32_t rank);

typedef struct ob_wire ob_wire;

// Joins the others; returns when all have joined. The program must not have loaded MPI. Returns NULL and e if the
// module cannot be loaded, or a launcher's figures differ from MPI's.
ob_wire *ob_wire_open(const ob_ranks *ranks, ob_error *e);
// Gathers a share from each rank, n bytes of this one: all shares in the order of ranks, valid until the next call. at:
// start of each, and the end. Each rank must call it. NULL: out of memory. If a rank has died, MPI ends this one.
const char *ob_wire_gather(ob_wire *w, const void *mine, size_t n, const size_t **at);
// Same with separate data for each destination: this rank sends mine[r], bytes[r] long, to rank r, including itself; it
// receives the shares addressed to it.
const char *ob_wire_deal(ob_wire *w, const void *const *mine, const size_t *bytes, const size_t **at);
// Sends n bytes, at most 2 GB, to another rank; returns when they are buffered or sent.
void ob_wire_send(ob_wire *w, uint32_t to, const void *bytes, size_t n);
// Receives the next message from another rank, n bytes, valid until the next call; messages of one rank stay in order.
// NULL: no message yet, or out of memory.
const void *ob_wire_receive(ob_wire *w, uint32_t *from, size_t *n);
// Waits until all ranks call it. NULL is allowed.
void ob_wire_close(ob_wire *w);

#endif
