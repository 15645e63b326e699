#include "reference/plate.h"

#include <math.h>

#include "reference/integrator.h"

// Means over the surface: direction u / |u| from the instantaneous centre, and distance |u|.
typedef struct means {
	double x, y, distance;
} means;

// ---- a rectangle, in closed form: primitives of x / r, and of r, in both coordinates

static double primitive_direction(double x, double y)
{
	double r = hypot(x, y);
	return x == 0 ? .5 * y * r : .5 * (y * r + x * x * asinh(y / fabs(x)));
}

static double primitive_distance(double x, double y)
{
	double sum = 2 * x * y * hypot(x, y);
	sum += x == 0 ? 0 : x * x * x * asinh(y / fabs(x));
	sum += y == 0 ? 0 : y * y * y * asinh(x / fabs(y));
	return sum / 6;
}

static means rectangle_means(const ob_reference_plate *p, double cx, double cy)
{
	means m = { 0, 0, 0 };
	double area = 4 * p->half_x * p->half_y;
	for (int i = -1; i <= 1; i += 2) {
		for (int j = -1; j <= 1; j += 2) {
			double x = i * p->half_x - cx, y = j * p->half_y - cy;
			m.x += i * j * primitive_direction(x, y) / area;
			m.y += i * j * primitive_direction(y, x) / area;
			m.distance += i * j * primitive_distance(x, y) / area;
		}
	}
	return m;
}

// Far from the instantaneous centre, the closed form cancels and the integrand is smooth.
static void rectangle_from_afar(const ob_reference_plate *p, double vx, double vy, double w, double *x, double *y,
				double *turn)
{
	*x = *y = *turn = 0;
	for (int i = 0; i < OB_REFERENCE_GAUSS; i++) {
		for (int j = 0; j < OB_REFERENCE_GAUSS; j++) {
			double rx = p->half_x * ob_reference_gauss_node[i], ry = p->half_y * ob_reference_gauss_node[j];
			double sx = vx - w * ry, sy = vy + w * rx, s = hypot(sx, sy);
			double weight = .25 * ob_reference_gauss_weight[i] * ob_reference_gauss_weight[j] / s;
			*x += weight * sx;
			*y += weight * sy;
			*turn += weight * (rx * sy - ry * sx);
		}
	}
}

// ---- a disc: polar coordinates about the instantaneous centre, at distance d from the disc's centre along -x

static means disc_means(double radius, double d)
{
	enum { POINTS = 1024 };
	means m = { 0, 0, 0 };
	double area = M_PI * radius * radius;
	for (int i = 0; i < POINTS; i++) {
		if (d < radius) {
			// the ray at angle f ends at r
			double f = 2 * M_PI * i / POINTS, s = d * sin(f);
			double r = d * cos(f) + sqrt(radius * radius - s * s), weight = 2 * M_PI / POINTS / area;
			m.x += weight * .5 * r * r * cos(f);
			m.distance += weight * r * r * r / 3;
		} else {
			// with sin f = radius / d sin e the ray at f runs from a - b to a + b
			double e = M_PI * (i + .5) / POINTS - M_PI_2, b = radius * cos(e), s = radius / d * sin(e);
			double cosine = sqrt(1 - s * s), a = d * cosine, weight = M_PI / POINTS / area;
			m.x += weight * 2 * b * b * cosine;
			m.distance += weight * b / a * (2 * a * a * b + 2. / 3 * b * b * b);
		}
	}
	return m;
}

// ---- friction

void ob_reference_plate_friction(const ob_reference_plate *p, double vx, double vy, double w, double *ax, double *ay,
				 double *turn)
{
	double size = p->disc ? p->half_x : hypot(p->half_x, p->half_y), speed = hypot(vx, vy);
	double x = 0, y = 0, torque = 0; // means of direction of motion and of its moment
	double inertia = p->disc ? .5 * size * size : size * size / 3;
	if (p->disc && speed > 1e6 * size * fabs(w)) {
		x = speed > 0 ? vx / speed : 0;
		y = speed > 0 ? vy / speed : 0;
	} else if (!p->disc && speed > 4 * size * fabs(w)) {
		rectangle_from_afar(p, vx, vy, w, &x, &y, &torque);
	} else if (w != 0) {
		double cx = -vy / w, cy = vx / w, d = hypot(cx, cy), sign = w > 0 ? 1 : -1;
		means m = p->disc ? disc_means(size, d) : rectangle_means(p, cx, cy);
		if (p->disc) { // from the centre of rotation towards the disc's centre
			double along = m.x;
			m.x = d > 0 ? -along * cx / d : 0;
			m.y = d > 0 ? -along * cy / d : 0;
		}
		x = -sign * m.y;
		y = sign * m.x;
		torque = sign * (m.distance + cx * m.x + cy * m.y);
	}
	*ax = -p->mu * p->g * x;
	*ay = -p->mu * p->g * y;
	*turn = -p->mu * p->g * torque / inertia;
}

typedef struct slide {
	ob_reference_plate plate;
	double stopped; // m/s: below this, it has stopped
} slide;

enum { X, Y, ANGLE, VX, VY, W, STATES };

static void rate(const double *y, double *to, const void *with)
{
	const slide *s = with;
	double c = cos(y[ANGLE]), n = sin(y[ANGLE]), ax, ay;
	ob_reference_plate_friction(&s->plate, c * y[VX] + n * y[VY], c * y[VY] - n * y[VX], y[W], &ax, &ay, &to[W]);
	to[X] = y[VX];
	to[Y] = y[VY];
	to[ANGLE] = y[W];
	to[VX] = c * ax - n * ay;
	to[VY] = c * ay + n * ax;
}

static bool is_at_rest(const double *y, const void *with)
{
	const slide *s = with;
	return hypot(y[VX], y[VY]) + fabs(y[W]) * hypot(s->plate.half_x, s->plate.half_y) < s->stopped;
}

ob_reference_plate_state ob_reference_plate_slide(const ob_reference_plate *p, ob_reference_plate_state start, double t)
{
	double y[STATES] = { start.x, start.y, start.angle, start.vx, start.vy, start.w };
	slide s = { *p, 1e-5 * (hypot(start.vx, start.vy) + fabs(start.w) * hypot(p->half_x, p->half_y)) };
	ob_reference_system system = {
		.states = STATES, .rate = rate, .ends = is_at_rest, .with = &s, .tolerance = 1e-9
	};
	bool ended = ob_reference_integrate(&system, t, y) < t;
	return (ob_reference_plate_state){
		y[X], y[Y], y[ANGLE], ended ? 0 : y[VX], ended ? 0 : y[VY], ended ? 0 : y[W]
	};
}
