// Segments by name: files /dev/shm/obsim.<name>, and who owns them.
//
//   create     a file without a name  ->  lock it  ->  header, memory  ->  link it under its name
//   own        the host and its fork server share the open file, and with it the lock
//   remove     who holds the lock of a file may unlink it, and only while the name is still that file's
//
//   lock held     somebody owns it: the host runs, or its fork server is about to clean up
//   lock free     nobody does, and nobody will: the segment is stale, and may be removed by whoever takes the lock
//
// The lock is one of the open file (F_OFD_SETLK): the kernel drops it when the last process that shares the open file
// has ended, however that came. It says nothing of process ids, so it holds across pid namespaces; and to look whether
// it is held does not take it, so lookers hinder nobody. A segment gets its name when it is locked and whole, and only
// its owner takes the name away: between looking at a name and acting on it nobody else can come.
//
// Any local user can put anything under such a name. Files are opened without waiting and without following links, and
// what is no regular file, or has another magic number, is left alone.
#ifndef OB_TABLE_SEGMENT_H
#define OB_TABLE_SEGMENT_H

#include "table/layout.h"

enum { OB_SEGMENT_PATH_MAX = OB_NAME_MAX + 16 };

// false: not a name (empty, too long, or with other characters than A-Z a-z 0-9 . _ -).
bool ob_segment_path(char path[OB_SEGMENT_PATH_MAX], const char *name);
// A new file in shared memory, without a name and locked. -1 and e on failure.
int ob_segment_create(ob_error *e);
// Links it under its name, after it has cleared away a stale segment of that name. false and e: the name is taken.
bool ob_segment_publish(int fd, const char *name, ob_error *e);
// The owner: removes the name, if it is still this file's. Async-signal-safe.
void ob_segment_unlink(int fd, const char *name);
// Opens a segment for reading; -1: there is no regular file of this name that may be read.
int ob_segment_open(const char *name);
// Reads the header; false: too short to have one. bytes = the file's length.
bool ob_segment_peek(int fd, ob_header *out, uint64_t *bytes);
// Whether somebody holds the lock, as of now.
bool ob_segment_is_owned(int fd);
// A reader says so as long as it has the file open; the owner asks whether anybody does. A lock of its own, likewise: it
// hinders nobody.
void ob_segment_read(int fd);
bool ob_segment_is_read(int fd);
// Removes every stale segment of this user.
void ob_segment_remove_stale(void);

#endif
