// When frames are due: frame f at f / fps, whatever the step. Pure.
#ifndef OB_CLI_FRAME_CLOCK_H
#define OB_CLI_FRAME_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

typedef struct ob_frame_clock {
	double fps, step; // 1/s, s
	uint64_t frames; // in the whole run
	uint64_t next; // the frame that is due next; == frames: all done
} ob_frame_clock;

// A duration has floor(duration * fps) frames: 600 for 10 s at 60, the first at 0, none at the end itself.
ob_frame_clock ob_frame_clock_make(double duration, double fps, double step);
double ob_frame_clock_time(const ob_frame_clock *c); // s, of the next frame
// The step at or after the next frame; its time lies in (step - 1, step]. UINT64_MAX when all frames are done.
// *between: it does not fall on that step, so that the step before is needed, too.
uint64_t ob_frame_clock_step(const ob_frame_clock *c, bool *between);
// The first step after "now" that a frame needs to see; UINT64_MAX = none.
uint64_t ob_frame_clock_need(const ob_frame_clock *c, uint64_t now);

#endif
