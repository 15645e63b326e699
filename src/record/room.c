#include "record/room.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

enum { LUMP = 4 << 20 }; // bytes asked for at once

bool ob_room_open(ob_room *r, const char *path)
{
	*r = (ob_room){ .fd = open(path, O_RDWR | O_CLOEXEC) };
	return r->fd >= 0;
}

bool ob_room_ensure(ob_room *r, const char *path, uint64_t used, uint64_t more, ob_error *e)
{
	if (used + more <= r->bytes)
		return true;
	uint64_t want = used + more + LUMP;
	int error = posix_fallocate(r->fd, 0, (off_t)want);
	if (error) { // the last of a nearly full disk
		want = used + more;
		error = posix_fallocate(r->fd, 0, (off_t)want);
	}
	if (error && error != EINVAL && error != EOPNOTSUPP) // pipes and odd file systems: HDF5 will see
		return ob_fail(e, "%s: cannot append to the record: %s", path, strerror(error));
	r->bytes = want;
	return true;
}

bool ob_room_close(ob_room *r, uint64_t used)
{
	if (r->fd < 0)
		return true;
	bool ok = used == 0 || used >= r->bytes || ftruncate(r->fd, (off_t)used) == 0;
	ok &= close(r->fd) == 0;
	r->fd = -1;
	return ok;
}
