#include "checkpoint/writer.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/log.h"

struct ob_checkpoint_writer {
	const char *path;
	ob_fault_plan fault;
	uint64_t chances; // for a fault
	ob_checkpoint_file file;
	pthread_t thread;
	bool writing; // the thread has to be joined; the following fields belong to it until then
	bool failed; // the last one
	ob_error error;
	double time; // s, simulated, of the current checkpoint
	double asked; // s, wall: time of the run's request for the file
	ob_checkpoint_sums sums;
};

ob_checkpoint_writer *ob_checkpoint_writer_create(const char *path, const ob_fault_plan *fault)
{
	ob_checkpoint_writer *w = calloc(1, sizeof *w);
	if (!w)
		return NULL;
	w->path = path;
	w->fault = *fault;
	return w;
}

// Emulates a full disk.
static bool fails_on_request(ob_checkpoint_writer *w)
{
	uint64_t random;
	if (ob_fault_draw(&w->fault, 1u << OB_FAULT_NOSPACE, 0, w->chances++, &random) == OB_FAULT_KINDS)
		return false;
	w->sums.faults++;
	return !ob_fail(&w->error, "%s: cannot write the checkpoint: %s (a fault that was asked for)", w->path,
			strerror(ENOSPC));
}

static void *write_file(void *context)
{
	ob_checkpoint_writer *w = context;
	const bool failed_before = w->failed;
	ob_checkpoint_seal(&w->file);
	w->failed = fails_on_request(w) || !ob_checkpoint_write(&w->file, w->path, &w->error);
	w->sums.written += !w->failed;
	w->sums.bytes = w->failed ? w->sums.bytes : w->file.size;
	if (w->failed && !failed_before)
		ob_log_warn("--checkpoint %s: the run goes on without the checkpoint of %.6g s", w->error.text,
			    w->time);
	return NULL;
}

static void wait_until_written(ob_checkpoint_writer *w)
{
	if (w->writing)
		pthread_join(w->thread, NULL);
	w->writing = false;
}

ob_checkpoint_file *ob_checkpoint_writer_file(ob_checkpoint_writer *w)
{
	w->asked = ob_clock_wall();
	wait_until_written(w);
	return &w->file;
}

void ob_checkpoint_writer_write(ob_checkpoint_writer *w, double time)
{
	sigset_t before;
	w->time = time;
	ob_interrupt_leave_to_main(&before);
	w->writing = pthread_create(&w->thread, NULL, write_file, w) == 0;
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (!w->writing)
		write_file(w);
	w->sums.held_s += ob_clock_wall() - w->asked;
}

bool ob_checkpoint_writer_close(ob_checkpoint_writer *w, ob_checkpoint_sums *sums, ob_error *e)
{
	*sums = (ob_checkpoint_sums){ 0 };
	if (!w)
		return true;
	wait_until_written(w);
	const bool fine = !w->failed;
	*sums = w->sums;
	if (!fine)
		ob_fail(e, "--checkpoint %s", w->error.text);
	ob_checkpoint_finish(&w->file);
	free(w);
	return fine;
}
