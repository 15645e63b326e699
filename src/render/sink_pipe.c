// Raw frames to a file descriptor, for any program that reads rgb24.
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/sink.h"

enum { BLOCK_PIXELS = 16384 };

typedef struct raw {
	int fd; // the caller's: not closed
	const char *name;
} raw;

static bool write_all(int fd, const uint8_t *data, size_t size)
{
	while (size > 0) {
		ssize_t n = write(fd, data, size);
		if (n > 0) {
			data += n;
			size -= (size_t)n;
		} else if (n < 0 && errno == EAGAIN) {
			struct pollfd room = { fd, POLLOUT, 0 };
			poll(&room, 1, -1);
		} else if (n < 0 && errno != EINTR) {
			return false;
		}
	}
	return true;
}

bool ob_pipe_write(int fd, int w, int h, const uint8_t *rgba, const char *what, ob_error *e)
{
	uint8_t rgb[3 * BLOCK_PIXELS];
	for (size_t left = (size_t)w * (size_t)h; left > 0;) {
		size_t n = left < BLOCK_PIXELS ? left : BLOCK_PIXELS;
		for (size_t i = 0; i < n; i++)
			memcpy(rgb + 3 * i, rgba + 4 * i, 3);
		if (!write_all(fd, rgb, 3 * n))
			return ob_fail(e, "%s: %s", what,
				       errno == EPIPE ? "the reader of the frames has gone" : strerror(errno));
		rgba += 4 * n;
		left -= n;
	}
	return true;
}

static bool write_raw(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e)
{
	const raw *r = state;
	return ob_pipe_write(r->fd, w, h, frame->rgba, r->name, e);
}

static bool finish_raw(void *state, bool good, ob_error *e)
{
	free(state);
	return true;
}

ob_sink *ob_sink_raw(int fd, const char *name, int w, int h, ob_error *e)
{
	static const ob_sink_kind kind = { write_raw, finish_raw };
	raw *r = malloc(sizeof *r);
	if (!r) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	*r = (raw){ fd, name };
	return ob_sink_start(&kind, r, w, h, 1, e);
}
