// Surfaces with prescribed motion, against closed forms: hits on a table that swings.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

static void done(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.path);
	free(s);
}

static little_scene *usual_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.iterations = 64;
	s->run.tolerance = 1e-3;
	return s;
}

// ---- a ball that bounces on a table

typedef struct table {
	double amplitude, frequency, phase; // m, rad/s, rad
} table;

static double height_of(const table *x, double t)
{
	return x->amplitude * sin(x->frequency * t + x->phase);
}

static double speed_of(const table *x, double t)
{
	return x->amplitude * x->frequency * cos(x->frequency * t + x->phase);
}

// Flight of the ball's lowest point from an instant on.
typedef struct flight {
	double since, z, v;
} flight;

static double above(const table *x, const flight *f, double t)
{
	const double s = t - f->since;
	return f->z + f->v * s - .5 * g * s * s - height_of(x, t);
}

// Goes on to the flight after the next hit.
static flight after_hit(const table *x, const flight *f, double e)
{
	const double scan = 1e-4;
	double low = f->since + scan;
	while (above(x, f, low + scan) > 0)
		low += scan;
	double high = low + scan;
	for (int i = 0; i < 60; i++) {
		const double middle = .5 * (low + high);
		*(above(x, f, middle) > 0 ? &low : &high) = middle;
	}
	const double u = speed_of(x, high), v = f->v - g * (high - f->since);
	return (flight){ high, height_of(x, high), -e * v + (1 + e) * u };
}

// Largest error (m) of a ball's height until the third hit.
static double bounce_error(const table *x, double e, double drop)
{
	little_scene *s = usual_scene();
	ob_world_swing(&s->world, ob_world_box(&s->world, 0, ob_v3(1, 1, .1), ob_v3(0, 0, -.1)),
		       ob_v3(0, 0, x->amplitude), x->frequency, x->phase);
	ob_world_sphere(&s->world, 1, .1, ob_v3(.2, .1, drop + .1));
	ob_world_material(&s->world, 0, e);
	flight f = { 0, drop, 0 }, next = after_hit(x, &f, e);
	little_universe l;
	little_open(&l, s);
	double worst = 0;
	for (int hits = 0, step = 1; hits < 3; step++) {
		const double t = step / 60.;
		little_run(&l, 1);
		for (; hits < 3 && t > next.since; hits++)
			f = next, next = after_hit(x, &f, e);
		if (hits < 3)
			worst = fmax(worst,
				     fabs(little_state(&l, 1).pose.p.z - .1 - height_of(x, t) - above(x, &f, t)));
	}
	done(&l, s);
	return worst;
}

static void test_hits_on_swinging_table(void)
{
	static const table each[] = { { .1, 8, .3 }, { .02, 40, 1 }, { .004, 90, 2 } };
	static const double e[] = { 1, .7 };
	for (int i = 0; i < 6; i++) {
		const double off = bounce_error(&each[i / 2], e[i % 2], .9);
		printf("two hits on a table, %g m at %g rad/s, restitution %g: off by %.1e m\n", each[i / 2].amplitude,
		       each[i / 2].frequency, e[i % 2], off);
		CHECK(off < 1e-9);
	}
}

int main(void)
{
	test_hits_on_swinging_table();
	return check_end();
}
