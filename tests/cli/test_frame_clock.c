// Frames fall due exactly once, at their time, however frames and steps lie to each other.
#include "check.h"
#include "cli/capture.h"

// Runs as the run loop does, and counts. Every frame must lie within the step that shows it.
static uint64_t count_frames(double duration, double fps, double step, uint64_t steps, uint64_t *seen_steps)
{
	ob_frame_clock c = ob_frame_clock_make(duration, fps, step, 0);
	uint64_t now = 0, before = 0, shown = 0;
	*seen_steps = 1;
	for (;;) {
		const uint64_t need =
			ob_frame_clock_need(&c, now); // before those of now are drawn, as the run loop asks
		bool between;
		while (ob_frame_clock_step(&c, &between) <= now) {
			double t = ob_frame_clock_time(&c), end = (double)now * step;
			CHECK(t <= end + 1e-9 * step + 1e-12 * end);
			CHECK(between ? before + 1 == now && t > (double)before * step : fabs(t - end) <= 1e-6 * step);
			c.next++;
			shown++;
		}
		if (now >= steps)
			break;
		CHECK(need > now && need == ob_frame_clock_need(&c, now));
		before = now;
		now = need < steps ? need : steps;
		(*seen_steps)++;
	}
	CHECK(c.next == c.frames);
	return shown;
}

static void test_counts(void)
{
	uint64_t seen;
	CHECK(count_frames(10, 60, 1. / 60, 600, &seen) == 600 && seen == 601);
	CHECK(count_frames(10, 30, 1. / 60, 600, &seen) == 300 && seen == 301); // the last, at the end, is no frame's
	CHECK(count_frames(10, 25, 1. / 60, 600, &seen) == 250 && seen == 451);
	CHECK(count_frames(10, 24, 1. / 60, 600, &seen) == 240);
	CHECK(count_frames(10, 29.97, 1. / 60, 600, &seen) == 299);
	CHECK(count_frames(10, 144, 1. / 60, 600, &seen) == 1440 && seen == 601);
	CHECK(count_frames(10, 1000, 1. / 60, 600, &seen) == 10000);
	CHECK(count_frames(1, 60, .01, 100, &seen) == 60);
	CHECK(count_frames(.1, 30, .1, 1, &seen) == 3);
	CHECK(count_frames(100000, 1. / 3, 1, 100000, &seen) == 33333);
	CHECK(count_frames(.01, 60, 1. / 60, 1, &seen) == 1); // a picture of the start, at least
	CHECK(count_frames(1e-6, 1e-6, 1. / 60, 1, &seen) == 1);
}

// If one is a multiple of the other, frames need no interpolation.
static void test_on_steps(void)
{
	ob_frame_clock c = ob_frame_clock_make(36000, 60, 1. / 60, 0);
	for (; c.next < c.frames; c.next += 977) {
		bool between;
		CHECK(ob_frame_clock_step(&c, &between) == c.next);
		CHECK(!between);
	}
	CHECK(c.frames == 2160000);
}

// A run that begins at a step later has the frames from its time on, under their numbers.
static void test_later(void)
{
	static const struct {
		double fps, step;
		uint64_t first, frame;
	} cases[] = { { 60, 1. / 60, 1, 1 },  { 60, 1. / 60, 599, 599 }, { 30, 1. / 60, 7, 4 },
		      { 25, .01, 32, 8 },     { 25, .01, 33, 9 },        { 1000, .1, 3, 300 },
		      { 1. / 3, 1, 100, 34 }, { 144, 1. / 60, 1, 3 },    { 60, .1, 6000000, 36000000 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		bool between;
		ob_frame_clock c = ob_frame_clock_make(1e6, cases[i].fps, cases[i].step, cases[i].first);
		CHECK(c.next == cases[i].frame);
		CHECK(ob_frame_clock_step(&c, &between) >= cases[i].first);
		CHECK(!between || ob_frame_clock_need(&c, cases[i].first) >= cases[i].first);
	}
}

// Single frames at times of their own; a run that begins later has those from its time on.
static void test_stills(void)
{
	static const double times[] = { 0, .5, .505, 2 };
	bool between;
	ob_frame_clock c = ob_frame_clock_of_stills(times, 4, .01, 0);
	CHECK(ob_frame_clock_step(&c, &between) == 0 && !between);
	CHECK(ob_frame_clock_need(&c, 0) == 50);
	c.next = 2;
	CHECK(ob_frame_clock_step(&c, &between) == 51 && between && ob_frame_clock_time(&c) == .505);
	c.next = 4;
	CHECK(ob_frame_clock_step(&c, &between) == UINT64_MAX);
	c = ob_frame_clock_of_stills(times, 4, .01, 50);
	CHECK(c.next == 1);
}

int main(void)
{
	test_stills();
	test_later();
	test_counts();
	test_on_steps();
	return check_end();
}
