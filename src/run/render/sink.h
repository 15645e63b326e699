// Shared part of all sinks: a queue of frames, emptied by worker threads.
#ifndef OB_RENDER_SINK_H
#define OB_RENDER_SINK_H

#include "render/render.h"

typedef struct ob_sink_frame {
	uint64_t number;
	double time; // s, simulated
	const uint8_t *rgba; // top row first
} ob_sink_frame;

// Operations of one kind of sink. state belongs to the kind.
typedef struct ob_sink_kind {
	// Writes one frame whole, or removes its output. Called from worker threads; with one worker, in the order of
	// put.
	bool (*write)(void *state, int w, int h, const ob_sink_frame *frame, ob_error *e);
	// Called after the last frame, once the workers have ended; frees state. good: no frame has failed.
	bool (*finish)(void *state, bool good, ob_error *e);
} ob_sink_kind;

// Takes over state; on failure it finishes it and returns NULL.
ob_sink *ob_sink_start(const ob_sink_kind *kind, void *state, int w, int h, int workers, ob_error *e);

// Writes a frame as rgb24 to fd, in blocks. Errors refer to the reader as `what`. SIGPIPE must be blocked.
bool ob_pipe_write(int fd, int w, int h, const uint8_t *rgba, const char *what, ob_error *e);

#endif
