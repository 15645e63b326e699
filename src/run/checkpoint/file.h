// The file of a checkpoint: areas of equal elements, each with its length and its checksum.
//
//   0       header, 128 bytes   magic, version, length of the file, which program wrote it
//   128     table, 32 a line    of each area: bytes of an element, how many, where, checksum
//   ..      areas               in the order of their table, each on a border of 64 bytes, zeros between them
//
// Numbers are written as they lie in memory, of fixed widths: on a machine of the other byte order the magic reads
// backwards, and the file is refused. There are no pointers. A checksum is CRC-64/XZ (ECMA-182, reflected); the
// header's is of itself and the table. Nothing that is read is believed before it has been compared with the length of
// the file.
//
// A file is replaced as a whole: new contents are written beside it, to FILE.part, which takes its name when it is on
// the disk. A reader finds either the old one or the new one, also after a power failure.
//
// Thread-safety: one thread at a time per file.
#ifndef OB_CHECKPOINT_FILE_H
#define OB_CHECKPOINT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

#include "base/budget.h"

// Limit for writing and reading: a file is read into memory as a whole, within the budget of files, with room for its scene.
#define OB_CHECKPOINT_BYTES_MAX (OB_BUDGET_BYTES - ((uint64_t)128 << 20))

// A change of an area's contents needs a new version.
enum { OB_CHECKPOINT_VERSION = 19, OB_CHECKPOINT_AREAS_MAX = 32 };

typedef struct ob_checkpoint_rule {
	const char *name; // for messages
	uint32_t element; // bytes
	uint64_t least, most; // elements
} ob_checkpoint_rule;

typedef struct ob_checkpoint_area {
	void *at; // in the file's memory
	uint64_t count;
} ob_checkpoint_area;

// The file in memory, with the layout on disk. Starts zeroed.
typedef struct ob_checkpoint_file {
	char *bytes; // as allocated
	size_t size, room;
	uint32_t areas;
	ob_checkpoint_area area[OB_CHECKPOINT_AREAS_MAX];
	char program[64]; // that wrote it
} ob_checkpoint_file;

// Makes room for areas of so many elements (area[].count), and sets area[].at. Memory is reused from one plan to the
// next, and preserves its contents. Returns false and e if memory runs out, or it is larger than
// OB_CHECKPOINT_BYTES_MAX.
bool ob_checkpoint_plan(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const uint64_t *count,
			const char *program, ob_error *e);
// Computes the checksums, once the areas are filled in.
void ob_checkpoint_seal(ob_checkpoint_file *f);
// Replaces the file at path by the sealed contents. Returns false and e on failure; the old file is unchanged.
bool ob_checkpoint_write(const ob_checkpoint_file *f, const char *path, ob_error *e);
// Reads and checks the file at path. Returns false and e, which begins with the path: unreadable, not a checkpoint,
// another version, truncated, or damaged.
bool ob_checkpoint_read(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const char *path,
			ob_error *e);
// Same for bytes in memory, which are copied; name is for messages.
bool ob_checkpoint_parse(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const void *bytes,
			 size_t size, const char *name, ob_error *e);
void ob_checkpoint_finish(ob_checkpoint_file *f);

#endif
