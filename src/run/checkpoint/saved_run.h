// Contents of a checkpoint of a run: all that it needs to go on, and to end in the same bits and the same figures as
// without an interruption. Resuming needs neither the scene's file nor the command line of the first run.
//
//   the scene     its text, the -D and the seed that it was read with: read again, it gives objects to come,
//                 cameras, look
//   settings      as resolved for the run; they cannot be changed on the way
//   the universe  at a step boundary (table/saved.h); free slots, and progress of the timetable (host/population.h)
//   figures       of the report, as far as they gather along the run; times are those of one process and begin anew
//
// A file from outside may hold anything: all numbers of an opened one have been checked.
//
// Thread-safety: one thread at a time per run and file; ob_saved_run_make is the host's thread's.
#ifndef OB_CHECKPOINT_SAVED_RUN_H
#define OB_CHECKPOINT_SAVED_RUN_H

#include "checkpoint/file.h"
#include "host/host.h"

// Measurements of the snapshots before the step of the checkpoint.
typedef struct ob_saved_figures {
	uint32_t started; // 1 = there was a first snapshot, and the rest is set
	uint32_t each_step; // 1 = every step so far was measured
	double energy_start, energy_top; // J
	ob_vec3 momentum_start; // kg m/s
	double momentum_scale; // kg m/s
	double momentum_error; // relative; NaN = not measured
	double worst, worst_time; // m, s
} ob_saved_figures;

typedef struct ob_saved_run {
	const char *scene; // path of its file when it was read, for titles and messages
	const char *text; // text of the scene
	size_t text_size;
	ob_scene_options options;
	double duration; // s, from the start of the first run
	ob_run_settings settings;
	ob_saved_figures figures;
	uint64_t created; // ns since 1970
	ob_saved_host host;
	const char **defines; // target of options.defines, if the run was opened
} ob_saved_run;

// Saves a run that stands at a step boundary into f (zeroed, or from an earlier checkpoint): r has all but host and
// created, which this fills in. program: version of this obsim. Returns false and e if memory runs out, or the run
// cannot be saved now.
bool ob_saved_run_make(ob_saved_run *r, ob_checkpoint_file *f, ob_host *h, const char *program, ob_error *e);

// Opens a file; f owns the memory that r points into. Returns false and e, which begins with the path.
bool ob_saved_run_open(ob_saved_run *r, ob_checkpoint_file *f, const char *path, ob_error *e);
// Same for bytes in memory; name is for messages.
bool ob_saved_run_parse(ob_saved_run *r, ob_checkpoint_file *f, const void *bytes, size_t size, const char *name,
			ob_error *e);
// Opens a file, and reads its scene, within one budget of memory (base/budget.h). NULL and e on failure; r and f are to be closed
// even then.
ob_scene *ob_saved_run_open_with_scene(ob_saved_run *r, ob_checkpoint_file *f, const char *path, ob_error *e);
void ob_saved_run_close(ob_saved_run *r, ob_checkpoint_file *f);

#endif
