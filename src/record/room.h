// Inside the module record only: room on the disk before HDF5 needs it. HDF5 writes in place and in no order that
// would survive a disk that fills up half way: the file would be lost. So blocks are asked for first, and what is
// refused is refused while the file is whole.
#ifndef OB_RECORD_ROOM_H
#define OB_RECORD_ROOM_H

#include <ob/error.h>

#include <stdbool.h>
#include <stdint.h>

typedef struct ob_room {
	int fd; // of our own, for the room only; < 0: closed
	uint64_t bytes; // what the file has room for
} ob_room;

bool ob_room_open(ob_room *r, const char *path);
// Room for "more" bytes beyond what HDF5 uses now; false and e with the system's reason.
bool ob_room_ensure(ob_room *r, const char *path, uint64_t used, uint64_t more, ob_error *e);
// Gives back what lies beyond "used" bytes.
bool ob_room_close(ob_room *r, uint64_t used);

#endif
