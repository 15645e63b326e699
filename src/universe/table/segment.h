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

// Returns false for an invalid name (empty, too long, or with other characters than A-Z a-z 0-9 . _ -).
bool ob_segment_path(char path[OB_SEGMENT_PATH_MAX], const char *name);
// Creates a file in shared memory, without a name and locked. Returns -1 and e on failure.
int ob_segment_create(ob_error *e);
// Links it under its name, after removing a stale segment of that name. Returns false and e if the name is taken.
bool ob_segment_publish(int fd, const char *name, ob_error *e);
// For the owner: removes the name, if it is still this file's. Async-signal-safe.
void ob_segment_unlink(int fd, const char *name);
// Opens a segment for reading; -1: no readable regular file of this name.
int ob_segment_open(const char *name);
// Reads the header; returns false if the file is too short. bytes = the file's length.
bool ob_segment_peek(int fd, ob_header *out, uint64_t *bytes);
// True if another process holds the lock, as of now.
bool ob_segment_is_owned(int fd);
// A reader holds this lock as long as it has the file open; the owner checks if there are any. A lock of its own; it
// hinders no process.
void ob_segment_read(int fd);
bool ob_segment_is_read(int fd);
// Removes every stale segment of this user.
void ob_segment_remove_stale(void);

#endif
