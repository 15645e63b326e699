// Optional parts of the program: shared modules that are loaded when they are first needed, so that a library which a run
// does not use is neither mapped nor required.
//
//   program: ob_part_load("cairo")  ---->  obsim-cairo.so: the code that calls the library, and one table of functions,
//            part->strip(...)        ---->  exported as OB_PART_ENTRY
//
// A module lies beside the program, in lib/obsim below the prefix where the program is installed, or at the root of the
// build tree that holds the program. A library finds its modules likewise. It holds copies of the static functions that it needs, so these keep no state.
#ifndef OB_BASE_PART_H
#define OB_BASE_PART_H

#include <stdbool.h>
#include <stddef.h>

#include <ob/error.h>

#define OB_PART_ENTRY ob_part

// First member of each table: the program's version and the table's size, which program and module must have alike.
typedef struct ob_part_head {
	const char *version;
	size_t bytes;
} ob_part_head;

// Defines the table of a module: OB_PART(ob_caption_part) = { OB_PART_HEAD(ob_caption_part), .strip = paint_strip };
#define OB_PART(type) \
	extern __attribute__((visibility("default"))) const type OB_PART_ENTRY; \
	const type OB_PART_ENTRY
#define OB_PART_HEAD(type) .head = { OB_VERSION, sizeof(type) }

// A module and its libraries take functions of a name from the program; likewise, and later libraries take the module's; from
// the module first.
typedef enum ob_part_scope { OB_PART_PROGRAM, OB_PART_OPEN, OB_PART_OWN } ob_part_scope;

// Loads obsim-NAME.so; returns its table of "bytes" bytes, which begins with ob_part_head. A module stays loaded. NULL and e: it is missing, lacks a library, or belongs to
// another obsim; the line ends with the remedy, "package" (Debian). Any thread.
const void *ob_part_load(const char *name, size_t bytes, ob_part_scope scope, const char *package, ob_error *e);
// True if a child process could load it: commands ask before they begin, and workers that are forked later do not
// inherit the library. Same errors.
bool ob_part_check(const char *name, const char *package, ob_error *e);

#endif
