#include "cli/frame_clock.h"

#include <math.h>

ob_frame_clock ob_frame_clock_make(double duration, double fps, double step)
{
	// 1e-9 of a frame: products like .1 s * 30 / s may fall short of the whole number that is meant
	return (ob_frame_clock){ .fps = fps, .step = step, .frames = (uint64_t)floor(duration * fps + 1e-9) };
}

double ob_frame_clock_time(const ob_frame_clock *c)
{
	return (double)c->next / c->fps;
}

uint64_t ob_frame_clock_step(const ob_frame_clock *c, bool *between)
{
	*between = false;
	if (c->next >= c->frames)
		return UINT64_MAX;
	double steps = ob_frame_clock_time(c) / c->step, nearest = round(steps);
	// on the step, but for the rounding of the quotient
	if (fabs(steps - nearest) <= 1e-9 * fmax(1, steps * 1e-3))
		return (uint64_t)nearest;
	*between = true;
	return (uint64_t)ceil(steps);
}

uint64_t ob_frame_clock_need(const ob_frame_clock *c, uint64_t now)
{
	bool between;
	uint64_t step = ob_frame_clock_step(c, &between);
	if (step == UINT64_MAX)
		return UINT64_MAX;
	return between && step - 1 > now ? step - 1 : step;
}
