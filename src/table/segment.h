// Segments by name: files /dev/shm/obsim.<name>, whose hosts may be alive or dead.
#ifndef OB_TABLE_SEGMENT_H
#define OB_TABLE_SEGMENT_H

#include "table/layout.h"

enum { OB_SEGMENT_PATH_MAX = OB_NAME_MAX + 8 };

// The name for shm_open. false: not a name (empty, too long, or with other characters than A-Z a-z 0-9 . _ -).
bool ob_segment_path(char path[OB_SEGMENT_PATH_MAX], const char *name);
// Start time of a process in ticks since boot; 0 = there is no such process.
uint64_t ob_segment_process_start(int32_t pid);
// Reads the header; false: no such segment, or too short to have one. bytes = its length.
bool ob_segment_peek(const char *path, ob_header *out, uint64_t *bytes);
// Whether the segment's host is gone (or died before it had written a header).
bool ob_segment_stale(const char *path);
// Removes every stale segment of this machine that this user may remove.
void ob_segment_remove_stale(void);

#endif
