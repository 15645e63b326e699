// Forces that vary in time: the mean of each step against the integral, and the time of the next change.
#include "motion/force.h"

#include <stdlib.h>

#include "check.h"

static double value(const ob_force *f, double t)
{
	if (f->kind == OB_FORCE_SINE)
		return f->force.x * sin(f->frequency * t + f->phase);
	if (f->kind == OB_FORCE_PULSE)
		return t >= f->from && t < f->until ? f->force.x : 0;
	for (uint32_t i = 1; i < f->points; i++)
		if (t < f->point[i].t)
			return f->point[i - 1].p.x + (f->point[i].p.x - f->point[i - 1].p.x) * (t - f->point[i - 1].t) /
							     (f->point[i].t - f->point[i - 1].t);
	return f->point[f->points - 1].p.x;
}

// Each step's mean is that of a thousand samples, and skipped steps have that of the one before.
static void check_means(const ob_force *f, double h, uint64_t steps)
{
	enum { SAMPLES = 1000 };
	uint64_t next = 0;
	double told = 0;
	for (uint64_t step = 0; step < steps; step++) {
		if (step >= next) {
			told = ob_force_mean(f, h, step).x;
			next = ob_force_next(f, h, step);
			CHECK(next > step);
		}
		double sum = 0;
		for (int k = 0; k < SAMPLES; k++)
			sum += value(f, ((double)step + (k + .5) / SAMPLES) * h) / SAMPLES;
		CHECK_NEAR(told, sum, 2e-3 * ob_norm(f->force) + 1e-5);
	}
}

int main(void)
{
	ob_path_point point[] = { { .t = 0, .p = { 1, 0, 0 } },
				  { .t = .31, .p = { 3, 0, 0 } },
				  { .t = .32, .p = { -2, 0, 0 } },
				  { .t = 1.2, .p = { 0, 0, 0 } } };
	const ob_force sine = { .kind = OB_FORCE_SINE, .force = { 2, 0, 0 }, .frequency = 9, .phase = .4 };
	const ob_force pulse = { .kind = OB_FORCE_PULSE, .force = { 2, 0, 0 }, .from = .503, .until = .71 };
	const ob_force linear = { .kind = OB_FORCE_LINEAR, .points = 4, .point = point };
	static const double h[] = { 1. / 60, .01, .3 };
	for (int i = 0; i < 3; i++) {
		check_means(&sine, h[i], 200);
		check_means(&pulse, h[i], 200);
		check_means(&linear, h[i], 200);
	}
	CHECK(ob_force_next(&pulse, .01, 0) == 50 && ob_force_next(&pulse, .01, 72) == UINT64_MAX);
	ob_force *copy = ob_force_copy(&linear);
	CHECK(copy && copy->point[2].p.x == -2 && copy->point != linear.point);
	free(copy);
	return check_end();
}
