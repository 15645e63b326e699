// Prisms that slide and spin on a face of 3 to 12 corners: each surface element has a cone of friction of its own. Their
// way and their turn are compared with their equations of motion, integrated over a fine grid of elements.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "little_universe.h"

static const double g = 9.81, mu = .3, size = .3; // m/s^2, 1, m

enum { CORNERS = 12, ELEMENTS = 10000 };

// ---- the reference

typedef struct prism {
	int corners;
	ob_vec3 corner[CORNERS]; // m, counterclockwise, from the centroid
	int elements;
	double x[ELEMENTS], y[ELEMENTS], area[ELEMENTS]; // m, m, share
	double square, own; // m^2: mean of x^2 + y^2, of all and of one element about itself
} prism;

// Divides the triangle from the centroid to an edge into grid^2 of its kind.
static void add_triangle(prism *p, int grid, ob_vec3 a, ob_vec3 b)
{
	const double whole = .5 * (a.x * b.y - a.y * b.x);
	for (int i = 0; i < grid; i++)
		for (int j = 0; j < 2 * i + 1; j++) {
			const double s = (j / 2 + (j % 2 ? 2. / 3 : 1. / 3)) / grid,
				     r = (i + (j % 2 ? 1. / 3 : 2. / 3)) / grid;
			const int k = p->elements++;
			p->x[k] = r * a.x + s * (b.x - a.x), p->y[k] = r * a.y + s * (b.y - a.y);
			p->area[k] = whole / (grid * grid);
		}
}

static void set_elements(prism *p)
{
	const int grid = (int)(98 / sqrt(p->corners));
	double twice = 0, cx = 0, cy = 0, sum = 0, inner = 0;
	for (int k = 0; k < p->corners; k++) {
		const ob_vec3 a = p->corner[k], b = p->corner[(k + 1) % p->corners];
		const double c = a.x * b.y - a.y * b.x;
		twice += c, cx += c * (a.x + b.x) / 3, cy += c * (a.y + b.y) / 3;
	}
	for (int k = 0; k < p->corners; k++)
		p->corner[k].x -= cx / twice, p->corner[k].y -= cy / twice;
	p->elements = 0;
	for (int k = 0; k < p->corners; k++) {
		const ob_vec3 a = p->corner[k], b = p->corner[(k + 1) % p->corners];
		const double c = a.x * b.y - a.y * b.x;
		add_triangle(p, grid, a, b);
		inner += c * (ob_dot(a, a) + ob_dot(a, b) + ob_dot(b, b)) / 6;
	}
	for (int k = 0; k < p->elements; k++)
		sum += p->area[k];
	for (int k = 0; k < p->elements; k++)
		p->area[k] /= sum;
	p->square = inner / twice;
	p->own = .1 * twice / p->elements;
}

// Accelerations of the centre and of the angle. u: velocity (m/s, prism's axes) and spin (rad/s).
static void friction_of(const prism *p, const double *u, double *a)
{
	double sum[3] = { 0, 0, 0 };
	for (int k = 0; k < p->elements; k++) {
		const double ux = u[0] - u[2] * p->y[k], uy = u[1] + u[2] * p->x[k];
		// An element's own extent matters where the prism turns about it.
		const double f = p->area[k] / sqrt(ux * ux + uy * uy + u[2] * u[2] * p->own);
		sum[0] += f * ux, sum[1] += f * uy, sum[2] += f * (p->x[k] * uy - p->y[k] * ux);
	}
	a[0] = -mu * g * sum[0], a[1] = -mu * g * sum[1], a[2] = -mu * g * sum[2] / p->square;
}

// x, y, angle, and their rates
static void rate_of(const prism *p, const double *s, double *r)
{
	const double c = cos(s[2]), d = sin(s[2]), own[3] = { c * s[3] + d * s[4], c * s[4] - d * s[3], s[5] };
	double a[3];
	friction_of(p, own, a);
	r[0] = s[3], r[1] = s[4], r[2] = s[5];
	r[3] = c * a[0] - d * a[1], r[4] = d * a[0] + c * a[1], r[5] = a[2];
}

// Until it is at rest, from the origin, by Runge and Kutta's method; steps in proportion to what is left of the speed.
static void slide_to_rest(const prism *p, const double *start, double *s)
{
	const double whole = hypot(start[0], start[1]) + size * fabs(start[2]);
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
	memcpy(s, s0, 3 * sizeof *s);
}

// ---- obsim

typedef enum support { PLANE, BOX, HULL, FREE, SUPPORTS } support; // FREE: a heavy body that floats

static double angle_between(ob_quat from, ob_quat to)
{
	const ob_quat turn = ob_quat_mul(to, (ob_quat){ from.w, -from.x, -from.y, -from.z });
	return 2 * atan2(turn.z, turn.w);
}

static void add_support(little_scene *s, support on)
{
	ob_vec3 corner[8];
	if (on == PLANE)
		ob_world_ground(&s->world);
	else if (on == BOX)
		ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? 5 : -5, k & 2 ? 4 : -4, k & 4 ? 0 : -1);
	if (on == HULL || on == FREE)
		ob_world_hull(&s->world, on == FREE ? 1e9 : 0, corner, 8, ob_v3(0, 0, 0));
	if (on == FREE)
		s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
}

// Errors of the way and of the turn, in shares of them.
static void compare(const prism *p, support on, const double *start, double *way, double *turn)
{
	const double thickness = .001 * size;
	double exact[3], turned = 0;
	ob_vec3 corner[2 * CORNERS];
	slide_to_rest(p, start, exact);
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3;
	add_support(s, on);
	for (int k = 0; k < p->corners; k++) {
		corner[2 * k] = corner[2 * k + 1] = p->corner[k];
		corner[2 * k].z = -thickness, corner[2 * k + 1].z = thickness;
	}
	ob_world_body b = ob_world_hull(&s->world, 2, corner, 2 * (uint32_t)p->corners, ob_v3(0, 0, thickness));
	if (on == FREE)
		b.passport->force = ob_v3(0, 0, -2 * g);
	b.state->v = ob_v3(start[0], start[1], 0);
	b.state->w = ob_v3(0, 0, start[2]);
	ob_state last = *b.state;
	const ob_vec3 from = last.pose.p;
	ob_world_material(&s->world, mu, 0);
	little_universe l;
	little_open(&l, s);
	for (int i = 0; i < 72; i++) {
		little_run(&l, 1);
		const ob_state now = little_state(&l, 1);
		turned += remainder(angle_between(last.pose.q, now.pose.q), 2 * M_PI);
		last = now;
	}
	const ob_vec3 off = ob_sub(ob_sub(last.pose.p, from), ob_v3(exact[0], exact[1], 0));
	*way = ob_norm(off) / hypot(exact[0], exact[1]);
	*turn = fabs(turned / exact[2] - 1);
	CHECK(ob_norm(ob_sub(last.v, little_state(&l, 0).v)) < 1e-9 &&
	      ob_norm(ob_sub(last.w, little_state(&l, 0).w)) < 1e-9);
	little_close(&l);
	free(s->world.hull);
	free(s);
}

// Corners on an ellipse at random places, or at regular ones on a circle.
static void make_prism(prism *p, int corners, bool regular, uint64_t *seed)
{
	p->corners = corners;
	for (int k = 0; k < corners; k++) {
		const double angle = 2 * M_PI * (k + (regular ? 0 : ob_splitmix_within(seed, -.35, .35))) / corners;
		p->corner[k] = ob_v3(size * cos(angle), (regular ? 1 : .7) * size * sin(angle), 0);
	}
	set_elements(p);
}

int main(void)
{
	static const double ratio[] = { .2, 1, 5 };
	uint64_t seed = 1;
	prism p;
	for (int corners = 3; corners <= 12; corners++)
		for (int regular = 0; regular < 2; regular++) {
			double worst_way = 0, worst_turn = 0;
			make_prism(&p, corners, regular, &seed);
			for (int i = 0; i < 3; i++) {
				const double v = 1.5 * ratio[i] / (1 + ratio[i]), direction = .4 + .3 * corners;
				const double start[3] = { v * cos(direction), v * sin(direction),
							  1.5 / (1 + ratio[i]) / sqrt(p.square) };
				double way, turn;
				compare(&p, (support)((corners + i) % SUPPORTS), start, &way, &turn);
				worst_way = fmax(worst_way, way), worst_turn = fmax(worst_turn, turn);
			}
			printf("%d %s corners: way off by %.1e, turn by %.1e\n", corners,
			       regular ? "regular" : "scattered", worst_way, worst_turn);
			CHECK(worst_way <= 1e-3);
			CHECK(worst_turn <= 1e-3);
		}
	return check_end();
}
