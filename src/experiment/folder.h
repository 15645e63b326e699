// The folder in which an experiment keeps what it measures, what is written there, and where results come from.
#ifndef OB_EXPERIMENT_FOLDER_H
#define OB_EXPERIMENT_FOLDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <ob/error.h>

// Makes the folder of --out, with all above it: like mkdir -p.
bool ob_folder_make(const char *folder, ob_error *e);
// The path of a file in the folder, malloc'd; ends the program when there is no memory for it.
char *ob_folder_path(const char *folder, const char *name);

// Writes a file beside the one of this name, which it then replaces: whoever looks sees the old one or the new one.
bool ob_file_replace(const char *path, void (*write)(FILE *f, const void *with), const void *with, ob_error *e);
bool ob_folder_write(const char *folder, const char *name, void (*write)(FILE *f, const void *with), const void *with,
		     ob_error *e);

// Processor, cores that may be used, kernel
void ob_provenance_machine(char *to, size_t room);
// The commit of the program. Where that does not tell what was built ("unknown", or files differed from it: "..+"), the
// hash of the program's file stands behind it.
void ob_provenance_commit(const char *commit, char *to, size_t room);

#endif
