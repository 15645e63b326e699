// Plates that slide and spin: each surface element has a cone of friction of its own. Their way and their angle are
// compared with the plate's equations of motion, integrated by small steps over a fine grid of elements.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81, mu = .3; // m/s^2

// ---- the reference

typedef struct plate {
	bool disc;
	double half[2]; // m; of a disc: its radius, twice
} plate;

enum { ELEMENTS = 64 };

// Accelerations of the plate's centre and of its angle. u: its velocity (m/s, plate's axes) and spin (rad/s).
static void friction_of(const plate *p, const double *u, double *a)
{
	const int across = p->disc ? ELEMENTS : (int)fmax(8, ELEMENTS * p->half[1] / p->half[0]);
	double sum[3] = { 0, 0, 0 }, weight = 0, square = 0;
	for (int i = 0; i < ELEMENTS; i++)
		for (int j = 0; j < across; j++) {
			double s = (2 * i + 1.) / ELEMENTS - 1, t = (2 * j + 1.) / across - 1, w = 1;
			double x = p->half[0] * s, y = p->half[1] * t;
			if (p->disc) {
				double r = p->half[0] * (i + .5) / ELEMENTS, angle = M_PI * t;
				w = r, x = r * cos(angle), y = r * sin(angle);
			}
			// An element's own extent matters where the plate turns about it.
			double dx = p->half[0] / ELEMENTS, dy = p->half[1] / across, own2 = (dx * dx + dy * dy) / 6;
			double ux = u[0] - u[2] * y, uy = u[1] + u[2] * x;
			double k = w / sqrt(ux * ux + uy * uy + u[2] * u[2] * own2);
			sum[0] += k * ux;
			sum[1] += k * uy;
			sum[2] += k * (x * uy - y * ux);
			weight += w;
			square += w * (x * x + y * y);
		}
	a[0] = -mu * g * sum[0] / weight;
	a[1] = -mu * g * sum[1] / weight;
	a[2] = -mu * g * sum[2] / square;
}

// x, y, angle, and their rates
static void rate_of(const plate *p, const double *s, double *r)
{
	double c = cos(s[2]), d = sin(s[2]), own[3] = { c * s[3] + d * s[4], c * s[4] - d * s[3], s[5] }, a[3];
	friction_of(p, own, a);
	r[0] = s[3], r[1] = s[4], r[2] = s[5];
	r[3] = c * a[0] - d * a[1], r[4] = d * a[0] + c * a[1], r[5] = a[2];
}

// Until it is at rest, from the origin, by Runge and Kutta's method; steps in proportion to what is left of the speed.
static void slide_to_rest(const plate *p, const double *start, double *s)
{
	const double size = hypot(p->half[0], p->half[1]), whole = hypot(start[0], start[1]) + size * fabs(start[2]);
	double s0[6] = { 0, 0, 0, start[0], start[1], start[2] };
	for (double left = whole; left > 2e-4 * whole; left = hypot(s0[3], s0[4]) + size * fabs(s0[5])) {
		double h = .06 * left / (mu * g), at[6], k[4][6];
		for (int i = 0; i < 4; i++) {
			for (int c = 0; c < 6; c++)
				at[c] = s0[c] + (i ? (i < 3 ? .5 : 1) * h * k[i - 1][c] : 0);
			rate_of(p, at, k[i]);
		}
		for (int c = 0; c < 6; c++)
			s0[c] += h / 6 * (k[0][c] + 2 * k[1][c] + 2 * k[2][c] + k[3][c]);
	}
	for (int c = 0; c < 3; c++)
		s[c] = s0[c];
}

// ---- obsim

typedef struct slide {
	plate p;
	double ratio, direction; // v/(w R), R: radius of gyration; the velocity's, from the plate's longer side
	bool on_box;
	uint32_t substeps;
} slide;

static double angle_of(ob_quat q)
{
	return 2 * atan2(q.z, q.w);
}

// Errors of the way and of the angle, in shares of them.
static void compare(const slide *x, double *way, double *angle)
{
	const plate *p = &x->p;
	const double thickness = .004 * p->half[0], speed = 1.5, h = 1. / 60;
	double gyration = p->disc ? p->half[0] / sqrt(2) : hypot(p->half[0], p->half[1]) / sqrt(3);
	double v = speed * x->ratio / (1 + x->ratio), w = speed / (1 + x->ratio) / gyration, exact[3];
	double start[3] = { v * cos(x->direction), v * sin(x->direction), w };
	slide_to_rest(p, start, exact);
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3;
	s->run.substeps = x->substeps;
	if (x->on_box)
		ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	else
		ob_world_ground(&s->world);
	ob_vec3 size = p->disc ? ob_v3(p->half[0], thickness, 0) : ob_v3(p->half[0], p->half[1], thickness);
	ob_world_body b =
		ob_world_add(&s->world, p->disc ? OB_SHAPE_CYLINDER : OB_SHAPE_BOX, size, 2, ob_v3(0, 0, thickness));
	b.state->v = ob_v3(start[0], start[1], 0);
	b.state->w = ob_v3(0, 0, w);
	ob_world_material(&s->world, mu, 0);
	little_universe l;
	little_open(&l, s);
	double turned = 0, last = 0;
	for (int i = 0; i < (int)(1.2 / h); i++) {
		little_run(&l, 1);
		double now = angle_of(little_state(&l, 1).pose.q);
		turned += remainder(now - last, 2 * M_PI);
		last = now;
	}
	ob_state end = little_state(&l, 1);
	*way = hypot(end.pose.p.x, end.pose.p.y) / hypot(exact[0], exact[1]) - 1;
	*angle = turned / exact[2] - 1;
	CHECK(ob_norm(end.v) < 1e-9 && ob_norm(end.w) < 1e-9);
	little_close(&l);
	free(s);
}

// The length of path that a motion carries is no shorter than the way: pairs are not looked at before it has grown so far.
static void check_path(uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 2, ob_v3(.3, .3, .1), ob_v3(0, 0, .1)).state->v = ob_v3(2, 1, 0);
	ob_world_material(&s->world, mu, 0);
	little_universe l;
	little_open(&l, s);
	ob_state last = little_state(&l, 1);
	double path = 0;
	for (int step = 0; step < 30; step++) {
		little_run(&l, 1);
		const ob_state now = little_state(&l, 1);
		const double length = ob_newest_motion(l.u, 1)->path;
		CHECK(length - path >= ob_norm(ob_sub(now.pose.p, last.pose.p)) - 1e-12);
		last = now, path = length;
	}
	little_close(&l);
	free(s);
}

// Squares, plates and bars from fast spins with little way to fast slides with little spin; on the ground at one end of
// the range and on a box at the other.
int main(void)
{
	static const plate plates[] = { { false, { .3, .3 } }, { false, { .4, .2 } }, { false, { .5, .05 } } };
	static const double ratio[] = { .05, .2, .5, 1, 2, 5, 20 };
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 7; i++) {
			double way, angle;
			slide x = { plates[k], ratio[i], .4 + .3 * k, i % 2, 8 };
			compare(&x, &way, &angle);
			printf("%g x %g m on %s, v/wR %.2f: way off by %+.1e, angle by %+.1e\n", 2 * plates[k].half[0],
			       2 * plates[k].half[1], x.on_box ? "box" : "plane", ratio[i], way, angle);
			CHECK_NEAR(way, 0, .01);
			CHECK_NEAR(angle, 0, .01);
		}
	for (uint32_t substeps = 1; substeps <= 8; substeps *= 8)
		check_path(substeps);
	return check_end();
}
