// FMUs as simulators of objects. A worker runs none: each FMU has a process of its own for each worker (table/desk.h), which
// may crash, exit or hang.
//
//   worker: ob_script_run_foreign ── turns of objects ──> process: ob_script_serve_foreign ──> ob_fmu_run
//           results, or the failure of one object <──────
//
// A failure belongs to the object whose turn it was, if the turn fails in a new process, too: an older one has run other
// objects and other steps, which may have left it damaged. So the result does not depend on the worker, on kills or on
// resumes. SIGKILL comes from elsewhere: then the turn is tried again, some times.
#ifndef OB_SCRIPT_FOREIGN_H
#define OB_SCRIPT_FOREIGN_H

#include "fmu/instance.h"
#include "script/script.h"
#include "table/desk.h"

// The process at a desk, for good. model: its FMU in the universe's form, of "size" bytes. confine: called once the library is
// loaded; false and e: then the FMU does not run.
typedef bool ob_foreign_confine(void *with, ob_error *e);
_Noreturn void ob_script_serve_foreign(const ob_desk *d, uint32_t number, const void *model, size_t size,
				       ob_foreign_confine *confine, void *with);

// ---- foreign data

// Data at a desk of an FMU: one question of the worker, and its answer.

typedef struct ob_foreign_data {
	uint32_t turns; // by the worker
	uint32_t loaded; // by the process: its number, once it has loaded the library
	char why[OB_SCRIPT_ERROR_BYTES]; // by the process: failure of the turn after those that are done
	ob_fmu_turn turn[OB_SCRIPT_BATCH];
} ob_foreign_data;

_Static_assert(sizeof(ob_foreign_data) <= OB_DESK_BYTES, "it lies at a desk");
_Static_assert(OB_FMU_STATE_BYTES == (int)OB_SCRIPT_STATE_BYTES, "an object's state is its FMU's");

#endif
