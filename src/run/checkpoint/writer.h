// Writes a run's checkpoints to one file, while the run goes on.
//
//   run     | steps | fill | steps         | wait | fill | steps ..
//   thread          | checksums, disk ............|      | ..
//
// The run stands still while a checkpoint is filled in, which takes as long as copying it. There is one checkpoint in
// memory: when the next is due before the last is on the disk, the run waits.
//
// A checkpoint that cannot be written (a full disk) leaves the file as it was and does not end the run: one warning
// says so, and the next is tried again. The last one counts: close fails if it could not be written.
//
// Thread-safety: one thread at a time per writer.
#ifndef OB_CHECKPOINT_WRITER_H
#define OB_CHECKPOINT_WRITER_H

#include "checkpoint/file.h"
#include "settings/settings.h"

typedef struct ob_checkpoint_writer ob_checkpoint_writer;

typedef struct ob_checkpoint_sums {
	uint64_t written;
	uint64_t bytes; // of the last
	uint64_t faults; // injected ones: checkpoints that were not written
	double held_s; // duration for which the run stood still, waiting or filling in: from file to write
} ob_checkpoint_sums;

// path is not copied, and must stay valid; fault: NOSPACE, at each checkpoint. Returns NULL if memory runs out.
ob_checkpoint_writer *ob_checkpoint_writer_create(const char *path, const ob_fault_plan *fault);
// File to fill in; waits until the last is written.
ob_checkpoint_file *ob_checkpoint_writer_file(ob_checkpoint_writer *w);
// Writes it. time: s, simulated, for messages.
void ob_checkpoint_writer_write(ob_checkpoint_writer *w, double time);
// Waits, and frees w; NULL is allowed. Returns false and e if the last checkpoint could not be written.
bool ob_checkpoint_writer_close(ob_checkpoint_writer *w, ob_checkpoint_sums *sums, ob_error *e);

#endif
