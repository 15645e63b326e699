// Frames of a run: draws the frames due between two snapshots, and passes them to the sinks.
#ifndef OB_CLI_CAPTURE_H
#define OB_CLI_CAPTURE_H

#include "cli/request.h"
#include "render/render.h"

// Clock of frames: frame f is due at f / fps, whatever the step. Pure.
typedef struct ob_frame_clock {
	double fps, step; // 1/s, s
	uint64_t frames; // in the whole run
	uint64_t next; // the frame that is due next; == frames: all done
	const double *still; // [frames], s: times of single frames; NULL = at fps
} ob_frame_clock;

// A duration has floor(duration * fps) frames: 600 for 10 s at 60, the first at 0, none at the end itself. A duration
// shorter than a frame has one, at 0. first: step at which the run begins, and its frames.
ob_frame_clock ob_frame_clock_make(double duration, double fps, double step, uint64_t first);
// The same for n single frames at ascending times (s), which must outlive it.
ob_frame_clock ob_frame_clock_of_stills(const double *still, uint32_t n, double step, uint64_t first);
double ob_frame_clock_time(const ob_frame_clock *c); // s, of the next frame
// The step at or after the next frame; its time lies in (step - 1, step]. UINT64_MAX when all frames are done.
// *between: the frame falls between two steps, so that the step before is needed, too.
uint64_t ob_frame_clock_step(const ob_frame_clock *c, bool *between);
// First step after "now" that a frame needs, whether or not the current ones have been drawn; UINT64_MAX = none.
uint64_t ob_frame_clock_need(const ob_frame_clock *c, uint64_t now);

typedef struct ob_capture ob_capture;

// Call after the host has started: processes must be forked before there is a renderer.
// first: step at which the run begins. u: where simulators run; it must outlive it; NULL: a record.
ob_capture *ob_capture_open(const ob_frames_request *f, const ob_scene *scene, double duration, double step,
			    uint64_t first, const ob_universe *u, ob_error *e);
// Adds spans of drawing and output to this host's trace.
void ob_capture_trace(ob_capture *c, ob_host *host);
// First step after "now" to show; UINT64_MAX = none
uint64_t ob_capture_need(const ob_capture *c, uint64_t now);
// Draws all frames up to now->time. prev: one step earlier, or older (then no frame is due between); NULL at the start.
bool ob_capture_show(ob_capture *c, const ob_snapshot *prev, const ob_snapshot *now, ob_error *e);
uint64_t ob_capture_frames(const ob_capture *c); // drawn so far
// Waits for the encoders, closes all files. false and e if a frame is missing. Frees c; NULL is allowed.
bool ob_capture_close(ob_capture *c, ob_error *e);

#endif
