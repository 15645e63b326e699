// Pressure and friction over polygons: against closed forms, and against sums over a fine grid.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "contact/area.h"

enum { GRID = 800 };

static ob_contact_area regular(int corners, double radius)
{
	ob_contact_area a = { .corners = corners };
	for (int k = 0; k < corners; k++)
		a.x[k] = radius * cos(2 * M_PI * k / corners), a.y[k] = radius * sin(2 * M_PI * k / corners);
	return a;
}

// Mean distance from the middle of a regular polygon with this inner radius: a sum over right-angled triangles.
static double mean_distance(int corners, double inner)
{
	const double half = M_PI / corners, secant = 1 / cos(half), tangent = tan(half);
	return inner * (secant * tangent + log(secant + tangent)) / (3 * tangent);
}

static void test_twist(void)
{
	for (int corners = 3; corners <= 12; corners++) {
		const double radius = .3, exact = mean_distance(corners, radius * cos(M_PI / corners));
		const ob_contact_area area = regular(corners, radius);
		const double middle[2] = { 0, 0 }, slip[3] = { 0, 0, 2 };
		double power, bound[6];
		ob_area_load load;
		ob_area_load_set(&area, middle, &load);
		ob_area_slip(&load, slip, middle, &power, bound);
		CHECK_NEAR(power, 2 * exact, 1e-12);
		CHECK_NEAR(bound[5], .5 * exact, 1e-12); // grad D = bound slip
	}
}

static bool inside(const ob_contact_area *a, double x, double y)
{
	for (int k = 0; k < a->corners; k++) {
		const int j = (k + 1) % a->corners;
		if ((a->x[j] - a->x[k]) * (y - a->y[k]) < (a->y[j] - a->y[k]) * (x - a->x[k]))
			return false;
	}
	return true;
}

// Resultant, centre, power at a slip, friction against it: sums over the area.
typedef struct sums {
	double one, x, y, power, force[2], twist;
} sums;

static sums sum_up(const ob_contact_area *a, const ob_area_load *p, const double *slip)
{
	const double half = .4, cell = 2 * half / GRID;
	sums s = { 0 };
	for (int i = 0; i < GRID; i++)
		for (int j = 0; j < GRID; j++) {
			const double x = (i + .5) * cell - half, y = (j + .5) * cell - half;
			const double at =
				p->at +
				(p->slope[0] * (x - p->middle[0]) + p->slope[1] * (y - p->middle[1])) / p->length;
			if (!(at > 0) || !inside(a, x, y))
				continue;
			const double load = at * cell * cell / (p->length * p->length);
			const double ux = slip[0] - slip[2] * y, uy = slip[1] + slip[2] * x,
				     speed = hypot(ux, uy) + 1e-300;
			s.one += load, s.x += load * x, s.y += load * y, s.power += load * speed;
			s.force[0] += load * ux / speed, s.force[1] += load * uy / speed;
			s.twist += load * (x * uy - y * ux) / speed;
		}
	return s;
}

// Scattered corners, and centres of pressure from the middle to near the border.
static void test_pressure(void)
{
	uint64_t seed = 3;
	double pressure = 0, power = 0, friction = 0;
	for (int trial = 0; trial < 40; trial++) {
		ob_contact_area a = { .corners = 3 + trial % 10 };
		for (int k = 0; k < a.corners; k++) {
			const double angle = 2 * M_PI * (k + ob_splitmix_within(&seed, -.35, .35)) / a.corners;
			a.x[k] = .3 * cos(angle), a.y[k] = .2 * sin(angle);
		}
		const int k = trial % a.corners, j = (k + 1) % a.corners;
		const double share = ob_splitmix_real(&seed), out = .8 * ob_splitmix_real(&seed);
		const double slip[3] = { ob_splitmix_within(&seed, -1, 1), ob_splitmix_within(&seed, -1, 1),
					 (trial % 4 ? 5 : .05) * ob_splitmix_within(&seed, -1, 1) };
		const double centre[2] = { out * (a.x[k] + share * (a.x[j] - a.x[k])),
					   out * (a.y[k] + share * (a.y[j] - a.y[k])) };
		double d, bound[6];
		ob_area_load p;
		ob_area_load_set(&a, centre, &p);
		ob_area_slip(&p, slip, (double[2]){ 0, 0 }, &d, bound);
		const sums s = sum_up(&a, &p, slip);
		pressure = fmax(pressure, fabs(s.one - 1) + hypot(s.x - centre[0], s.y - centre[1]) / .3);
		power = fmax(power, fabs(d / s.power - 1));
		const double grad[3] = { bound[0] * slip[0] + bound[1] * slip[1] + bound[2] * slip[2],
					 bound[1] * slip[0] + bound[3] * slip[1] + bound[4] * slip[2],
					 bound[2] * slip[0] + bound[4] * slip[1] + bound[5] * slip[2] };
		friction = fmax(friction,
				hypot(grad[0] - s.force[0], grad[1] - s.force[1]) + fabs(grad[2] - s.twist) / .3);
	}
	printf("sums over the area: pressure off by %.1e, power by %.1e, friction by %.1e\n", pressure, power,
	       friction);
	CHECK(pressure < 3e-3);
	CHECK(power < 3e-3);
	CHECK(friction < 5e-3);
}

int main(void)
{
	test_twist();
	test_pressure();
	return check_end();
}
