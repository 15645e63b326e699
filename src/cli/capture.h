// Frames of a run: draws those that fall due between two snapshots, and hands them to the sinks.
#ifndef OB_CLI_CAPTURE_H
#define OB_CLI_CAPTURE_H

#include "cli/frame_clock.h"
#include "cli/request.h"
#include "render/render.h"

typedef struct ob_capture ob_capture;

// Call after the host has started: processes must be forked before there is a renderer.
ob_capture *ob_capture_open(const ob_frames_request *f, const ob_scene *scene, double duration, double step,
			    ob_error *e);
// Spans of drawing and handing over go into this host's trace.
void ob_capture_trace(ob_capture *c, ob_host *host);
// The first step after "now" that is to be shown; UINT64_MAX = none
uint64_t ob_capture_need(const ob_capture *c, uint64_t now);
// Draws all frames up to now->time. prev: one step earlier, or older (then no frame is due between); NULL at the start.
bool ob_capture_show(ob_capture *c, const ob_snapshot *prev, const ob_snapshot *now, ob_error *e);
uint64_t ob_capture_frames(const ob_capture *c); // drawn so far
// Waits for the encoders, closes all files. false and e if a frame is missing. Frees c; NULL is allowed.
bool ob_capture_close(ob_capture *c, ob_error *e);

#endif
