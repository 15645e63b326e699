// The processes that mpirun or srun has started together, its ranks, and the wire between them: for one universe on
// several machines, and for the trials of an experiment (courier.h).
//
//   rank 0                                rank 1                                rank 2
//   host, its simulators                  host, its simulators                  host, its simulators
//   universe  <- arranger ------ wire ------ arranger -> universe ------ wire ------ arranger -> universe
//
// Only mpi.c knows MPI. It is a module of its own, obsim-mpi.so, which is loaded when a run has more than one rank: so
// the program runs where there is no MPI, and needs it nowhere else.
//
// Thread-safety: a wire belongs to one thread.
#ifndef OB_RANKS_RANKS_H
#define OB_RANKS_RANKS_H

#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

typedef struct ob_ranks {
	uint32_t rank, ranks; // this one's number, from 0; how many there are
} ob_ranks;

// As Open MPI's mpirun has it, or Slurm's srun --mpi=pmix. One rank: there is no launcher.
ob_ranks ob_ranks_started(void);
// For a process of this rank that is to do something alone, and so are the programs that it starts.
void ob_ranks_forget(void);

typedef struct ob_wire ob_wire;

// Joins the others; returns when all have. The program must not have loaded MPI. NULL and e: it cannot be loaded, or a
// launcher's figures are not MPI's.
ob_wire *ob_wire_open(const ob_ranks *ranks, ob_error *e);
// Gathers what each rank has to say, n bytes of it here: all of it, in the order of ranks, which holds until the next
// call. at: where each begins, and the end. Each rank must call it. NULL: no memory. Where a rank has gone, MPI ends
// this one.
const char *ob_wire_gather(ob_wire *w, const void *mine, size_t n, const size_t **at);
// Likewise, of what each rank has to say to this one: this one has mine[r], bytes[r] of it, to say to rank r, itself
// among them.
const char *ob_wire_deal(ob_wire *w, const void *const *mine, const size_t *bytes, const size_t **at);
// Says n bytes, at most 2 GB, to another rank; returns when the wire has taken them.
void ob_wire_send(ob_wire *w, uint32_t to, const void *bytes, size_t n);
// The next that another rank has said to this one, n bytes, which hold until the next call; of the same rank in its
// order. NULL: nothing has come, or there is no memory for it.
const void *ob_wire_receive(ob_wire *w, uint32_t *from, size_t *n);
// Waits until all have come here. NULL is allowed.
void ob_wire_close(ob_wire *w);

#endif
