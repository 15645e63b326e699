// The folder of an experiment's results, file output in it, and the provenance of results.
#ifndef OB_EXPERIMENT_FOLDER_H
#define OB_EXPERIMENT_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <ob/error.h>

// Makes the folder of --out, with its parents, like mkdir -p.
bool ob_folder_make(const char *folder, ob_error *e);
// Path of a file in the folder, malloc'd; ends the program if memory runs out.
char *ob_folder_path(const char *folder, const char *name);

// Replaces a file atomically, through a temporary file beside it: readers see the old one or the new one.
bool ob_file_replace(const char *path, void (*write)(FILE *f, const void *with), const void *with, ob_error *e);
bool ob_folder_write(const char *folder, const char *name, void (*write)(FILE *f, const void *with), const void *with,
		     ob_error *e);

// Processor, usable cores, kernel.
void ob_provenance_machine(char *to, size_t room);
// Commit of the program. If that does not identify the build ("unknown", or modified files: "..+"), the hash of the
// program's file follows it.
void ob_provenance_commit(const char *commit, char *to, size_t room);

#endif
