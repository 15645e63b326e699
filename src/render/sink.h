// What the kinds of sink share: a queue of frames that worker threads empty.
#ifndef OB_RENDER_SINK_H
#define OB_RENDER_SINK_H

#include "render/render.h"

typedef struct ob_sink_frame {
	uint64_t number;
	double time; // s, simulated
	const uint8_t *rgba; // top row first
} ob_sink_frame;

// What one kind of sink does. state belongs to the kind.
typedef struct ob_sink_kind {
	// Writes one frame whole, or removes what it wrote. Called from worker threads: from one only, in the order of
	// put, when the sink was made with one worker.
	bool (*write)(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e);
	// After the last frame, when the workers have ended; frees state. good: no frame has failed.
	bool (*finish)(void *state, bool good, ob_error *e);
} ob_sink_kind;

// Takes over state; on failure it is finished and NULL returned.
ob_sink *ob_sink_start(const ob_sink_kind *kind, void *state, int w, int h, int workers, ob_error *e);

// Writes a frame as rgb24 to fd, in blocks; what = the name of the reader for errors. SIGPIPE must be blocked.
bool ob_pipe_write(int fd, int w, int h, const uint8_t *rgba, const char *what, ob_error *e);

#endif
