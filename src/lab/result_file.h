// The columns of the file of results, for those who write and who read it.
#ifndef OB_LAB_RESULT_FILE_H
#define OB_LAB_RESULT_FILE_H

#include "lab/result.h"

// A unit stands behind the name. Column by column; a figure has four, "figure1_name" to "figure8_target".
typedef enum ob_result_column {
	OB_COLUMN_CASE,
	OB_COLUMN_ROW,
	OB_COLUMN_ENGINE,
	OB_COLUMN_ENGINE_VERSION,
	OB_COLUMN_STEP,
	OB_COLUMN_SUBSTEPS,
	OB_COLUMN_ITERATIONS,
	OB_COLUMN_TOLERANCE,
	OB_COLUMN_LAG,
	OB_COLUMN_SLEEPING,
	OB_COLUMN_FAILED,
	OB_COLUMN_COST,
	OB_COLUMN_CPU,
	OB_COLUMN_WALL,
	OB_COLUMN_BODY_SECONDS,
	OB_COLUMN_REPEATS,
	OB_COLUMN_CPU_EACH,
	OB_COLUMN_WALL_EACH,
	OB_COLUMN_FIGURE,
	OB_COLUMN_MACHINE = OB_COLUMN_FIGURE + 4 * OB_FIGURES,
	OB_COLUMN_COMMIT,
	OB_COLUMNS,
} ob_result_column;

// The name at the head of a column; "to" is where one is made up.
const char *ob_result_column_name(int column, char to[32]);

#endif
