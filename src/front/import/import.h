// Robots and other models that others have drawn, MJCF or URDF, as scenes.
//
// MuJoCo parses the file, in a child process with limits of CPU, memory and files: a file from outside may hold anything.
// Each body becomes an object with its exact mass, centre of mass and moments; joints hold them together. Things without
// a counterpart in obsim are listed, line by line. Thread-safety: it forks; one thread at a time.
#ifndef OB_IMPORT_IMPORT_H
#define OB_IMPORT_IMPORT_H

#include <stdbool.h>
#include <stdio.h>

#include <ob/error.h>

#include "base/part.h"

typedef struct ob_imported {
	char *scene; // Lua
	char *omitted; // one line for each thing that was not carried over, or was changed
} ob_imported;

// folder: NULL, or where the looks of the bodies are written as glTF, beside the scene. Returns false and e, in one line:
// the file cannot be read, is no model, or needs more than the limits.
bool ob_import(const char *path, const char *folder, ob_imported *out, ob_error *e);
void ob_imported_finish(ob_imported *i);

// ---- part

// The part of obsim that calls MuJoCo's parser: obsim-import.so (base/part.h).

typedef struct ob_import_part {
	ob_part_head head;
	// Writes the scene, and a line for each thing that is left out. A fault of the parser's ends the process.
	bool (*convert)(const char *path, const char *folder, FILE *scene, FILE *omitted, ob_error *e);
} ob_import_part;

#endif
