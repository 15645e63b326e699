// Time (ns) per call of the closed forms: the best of many short batches of CPU time, so that other load hardly counts.
#include <stdio.h>

#include <ob/motion.h>

#include "base/clock.h"
#include "motion/spin.h"

enum { BODIES = 64, CALLS = 4096, BATCHES = 200 };

typedef struct subject {
	ob_motion motion;
	ob_vec3 inertia;
	ob_spin spin;
} subject;

static subject subjects[BODIES];

typedef double call(subject *s, double t);

static double rotate(subject *s, double t)
{
	ob_quat q;
	ob_vec3 w;
	ob_rotate_free(s->motion.q, s->motion.w, s->inertia, t, &q, &w);
	return q.w;
}

static double rotate_top(subject *s, double t)
{
	ob_quat q;
	ob_vec3 w;
	ob_rotate_free(s->motion.q, s->motion.w, ob_v3(1, 1, 2), t, &q, &w);
	return q.w;
}

static double rotate_planned(subject *s, double t)
{
	ob_quat q;
	ob_vec3 w;
	ob_spin_at(&s->spin, t, &q, &w);
	return q.w;
}

static double at(subject *s, double t)
{
	return ob_motion_at(&s->motion, s->inertia, t).pose.p.z;
}

static double at_rest(subject *s, double t)
{
	ob_motion m = s->motion;
	m.w = ob_v3(0, 0, 0);
	return ob_motion_at(&m, s->inertia, t).pose.p.z;
}

static double bounds(subject *s, double t)
{
	double b[6];
	ob_shape_bounds(OB_SHAPE_BOX, s->inertia, (ob_pose){ s->motion.p, s->motion.q }, b);
	return b[0] + t;
}

static double swept(subject *s, double t)
{
	double b[6];
	ob_motion_swept_bounds(&s->motion, OB_SHAPE_BOX, s->inertia, t, b);
	return b[0];
}

static double closing(subject *s, double t)
{
	return ob_time_of_closing(s->inertia.x, -t, -9.81, 10);
}

static void measure(const char *what, call *f)
{
	double best = 1e9, sum = 0;
	for (int b = 0; b < BATCHES; b++) {
		double start = ob_clock_thread_cpu();
		for (int k = 0; k < CALLS; k++)
			sum += f(&subjects[k % BODIES], .01 + 1e-4 * k);
		best = fmin(best, ob_clock_thread_cpu() - start);
	}
	printf("%-44s %7.1f ns\n", what, best / CALLS * 1e9);
	if (sum == 1.5) // keeps the calls from being optimised away
		puts("");
}

int main(void)
{
	for (int k = 0; k < BODIES; k++) {
		subject *s = &subjects[k];
		s->inertia = ob_v3(1 + .01 * k, 2, 3 - .02 * k);
		s->motion = (ob_motion){ .q = ob_quat_identity(), .p = ob_v3(k, 0, 5), .v = ob_v3(1, 0, k) };
		s->motion.w = ob_v3(.1 * k - 3, 2, .07 * k);
		s->motion.a = ob_v3(0, 0, -9.81);
		ob_spin_plan(&s->spin, s->motion.q, s->motion.w, s->inertia);
	}
	measure("ob_rotate_free, three moments", rotate);
	measure("ob_rotate_free, symmetric top", rotate_top);
	measure("ob_spin_at, planned", rotate_planned);
	measure("ob_motion_at", at);
	measure("ob_motion_at, no rotation", at_rest);
	measure("ob_shape_bounds, box", bounds);
	measure("ob_motion_swept_bounds", swept);
	measure("ob_time_of_closing", closing);
	return 0;
}
