// The part of obsim that calls MuJoCo's parser: obsim-import.so (base/part.h).
#ifndef OB_IMPORT_PART_H
#define OB_IMPORT_PART_H

#include <stdio.h>

#include "base/part.h"

typedef struct ob_import_part {
	ob_part_head head;
	// Writes the scene, and a line for each thing that is left out. A fault of the parser's ends the process.
	bool (*convert)(const char *path, const char *folder, FILE *scene, FILE *omitted, ob_error *e);
} ob_import_part;

#endif
