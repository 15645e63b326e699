// Files that may come from anybody: a regular file of a bounded size, or an error. Opening never waits, as it would for
// a pipe without a writer, and starts nothing, as it may at a device. Errors are "it is no file", "it is larger than ..",
// or the system's reason: the caller puts the path before them. Thread-safe.
#ifndef OB_BASE_FILE_H
#define OB_BASE_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

// Opens for reading a regular file of at most so many bytes: the caller closes the descriptor. *size: bytes. -1 and e.
int ob_file_open(const char *path, uint64_t most, uint64_t *size, ob_error *e);
// Reads exactly so many bytes from where the descriptor stands. 0 and e: it cannot be read, or became shorter.
int ob_file_read(int fd, void *to, size_t size, ob_error *e);
// The whole of a regular file of at most so many bytes, and a 0 behind it: the caller frees it. NULL and e.
char *ob_file_load(const char *path, size_t most, size_t *size, ob_error *e);

// ---- own file

// Files of the program itself, found from where the program lies: parts, scenes.

// Finds a file beside the program, in the folder "installed" (relative to the program's), or in the folder "built"
// (relative to the root of the build tree that holds the program). False if there is none. Any thread.
bool ob_own_file_find(char path[PATH_MAX], const char *installed, const char *built, const char *name);

#endif
