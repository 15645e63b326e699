// Data at a desk of an FMU: one question of the worker, and its answer.
#ifndef OB_SCRIPT_FOREIGN_DATA_H
#define OB_SCRIPT_FOREIGN_DATA_H

#include "fmu/instance.h"
#include "script/script.h"
#include "table/desk.h"

typedef struct ob_foreign_data {
	uint32_t turns; // by the worker
	uint32_t loaded; // by the process: its number, once it has loaded the library
	char why[OB_SCRIPT_ERROR_BYTES]; // by the process: failure of the turn after those that are done
	ob_fmu_turn turn[OB_SCRIPT_BATCH];
} ob_foreign_data;

_Static_assert(sizeof(ob_foreign_data) <= OB_DESK_BYTES, "it lies at a desk");
_Static_assert(OB_FMU_STATE_BYTES == (int)OB_SCRIPT_STATE_BYTES, "an object's state is its FMU's");

#endif
