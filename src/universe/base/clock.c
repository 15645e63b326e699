#include "base/clock.h"

#include <time.h>

static double seconds(clockid_t id)
{
	struct timespec t;
	clock_gettime(id, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t nanoseconds(clockid_t id)
{
	struct timespec t;
	if (clock_gettime(id, &t) != 0)
		return 0;
	return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

double ob_clock_wall(void)
{
	return seconds(CLOCK_MONOTONIC);
}
uint64_t ob_clock_ns(void)
{
	return nanoseconds(CLOCK_MONOTONIC);
}
double ob_clock_thread_cpu(void)
{
	return seconds(CLOCK_THREAD_CPUTIME_ID);
}
double ob_clock_process_cpu(void)
{
	return seconds(CLOCK_PROCESS_CPUTIME_ID);
}

// The kernel's encoding of a CPU clock of another task (include/linux/posix-timers.h):
// bits 0-1 = 2 (scheduler clock), bit 2 = per thread, the rest = ~id.
uint64_t ob_clock_cpu_of_thread(pid_t tid)
{
	return nanoseconds((clockid_t)((~(unsigned)tid << 3) | 6));
}
uint64_t ob_clock_cpu_of_process(pid_t pid)
{
	return nanoseconds((clockid_t)((~(unsigned)pid << 3) | 2));
}

ob_hang_clock ob_hang_clock_start(void)
{
	return (ob_hang_clock){ .seen = ob_clock_wall() };
}

double ob_hang_clock_tick(ob_hang_clock *c)
{
	static const double most = .2; // s between two calls
	double now = ob_clock_wall(), past = now - c->seen;
	c->seen = now;
	c->waited += past < most ? past : most;
	return c->waited;
}

ob_hang_count ob_hang_count_start(uint64_t cpu_ns)
{
	return (ob_hang_count){ .clock = ob_hang_clock_start(), .cpu_ns = cpu_ns };
}

bool ob_hang_count_is_over(ob_hang_count *c, uint64_t cpu_ns, bool denied, double patience)
{
	enum { MOST_FACTOR = 10 };
	static const double busy = .02; // of a core: below that nothing computes
	const double waited = ob_hang_clock_tick(&c->clock), past = waited - c->looked;
	const double computed = c->cpu_ns && cpu_ns > c->cpu_ns ? 1e-9 * (double)(cpu_ns - c->cpu_ns) : 0;
	if (computed > busy * past)
		c->counted += computed < past ? computed : past;
	else if (!denied)
		c->counted += past;
	c->looked = waited;
	c->cpu_ns = cpu_ns;
	return c->counted > patience || waited > MOST_FACTOR * patience;
}
