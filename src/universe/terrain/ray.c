#include <math.h>

#include "terrain/terrain.h"

static const double rounding = 1e-9; // share of a column, or of a triangle: so a ray passes between no two of them

typedef struct ray {
	const ob_terrain *t;
	double p[3], d[3];
	ob_vec3 from, direction;
	double nearest; // m
	uint32_t triangle, tests; // met there; tested so far
} ray;

// Tests a triangle (Moeller and Trumbore 1997).
static void meet(ray *x, uint32_t triangle)
{
	const uint32_t *corner = ob_terrain_triangles(x->t)[triangle].corner;
	const ob_vec3 *v = ob_terrain_vertices(x->t), a = v[corner[0]], ab = ob_sub(v[corner[1]], a),
		      ac = ob_sub(v[corner[2]], a), across = ob_cross(x->direction, ac), to = ob_sub(x->from, a),
		      side = ob_cross(to, ab);
	const double det = ob_dot(ab, across);
	x->tests++;
	if (!(det > 0)) // from below, or along it
		return;
	const double u = ob_dot(to, across) / det, w = ob_dot(x->direction, side) / det, at = ob_dot(ac, side) / det;
	if (u >= -rounding && w >= -rounding && u + w <= 1 + rounding && at > 0 && at < x->nearest)
		x->nearest = at, x->triangle = triangle;
}

// Shortens the part of the ray, m from its beginning, to that within these bounds of an axis.
static void clip(const ray *x, int axis, double low, double high, double *begin, double *end)
{
	if (x->d[axis] == 0) {
		if (x->p[axis] < low || x->p[axis] > high)
			*end = -INFINITY;
		return;
	}
	const double a = (low - x->p[axis]) / x->d[axis], b = (high - x->p[axis]) / x->d[axis];
	*begin = fmax(*begin, fmin(a, b));
	*end = fmin(*end, fmax(a, b));
}

static uint32_t column_of(const ray *x, int axis, double way, double more)
{
	const ob_terrain *t = x->t;
	const double c = (x->p[axis] + way * x->d[axis] - t->low[axis]) * t->per_metre[axis] + more;
	return c > 0 ? (uint32_t)fmin(c, t->columns[axis] - 1) : 0;
}

// Tests the triangles of the columns of a row, or of a line of them across that, which a part of the ray may pass.
static void pass(ray *x, int along, uint32_t number, double begin, double end)
{
	const uint32_t *first = ob_terrain_first(x->t), *columns = x->t->columns,
		       *entry = first + columns[0] * columns[1] + 1;
	const int across = 1 - along;
	const double one = x->d[across] > 0 ? begin : end, other = x->d[across] > 0 ? end : begin;
	for (uint32_t k = column_of(x, across, one, -rounding), last = column_of(x, across, other, rounding); k <= last;
	     k++) {
		const uint32_t column = along ? number * columns[0] + k : k * columns[0] + number;
		for (uint32_t i = first[column]; i < first[column + 1]; i++)
			meet(x, entry[i]);
	}
}

double ob_terrain_enter(const ob_terrain *t, ob_vec3 p, ob_vec3 d, double length, ob_vec3 *n, uint32_t *tests)
{
	ray x = { t, { p.x, p.y, p.z }, { d.x, d.y, d.z }, p, d, length, UINT32_MAX, 0 };
	double begin = 0, end = length;
	for (int i = 0; i < 3; i++)
		clip(&x, i, t->low[i], t->high[i], &begin, &end);
	const int along = fabs(d.y) * t->per_metre[1] > fabs(d.x) * t->per_metre[0];
	const double width = t->per_metre[along] > 0 ? 1 / t->per_metre[along] : t->high[along] - t->low[along];
	const int step = x.d[along] > 0 ? 1 : -1;
	for (uint32_t k = column_of(&x, along, begin, -step * rounding),
		      last = column_of(&x, along, end, step * rounding);
	     begin <= end; k += (uint32_t)step) {
		const double low = t->low[along] + (k - rounding) * width,
			     high = t->low[along] + (k + 1 + rounding) * width;
		double from = begin, to = end;
		clip(&x, along, low, high, &from, &to);
		if (from > x.nearest)
			break;
		if (from <= to)
			pass(&x, along, k, from, to);
		if (k == last)
			break;
	}
	*tests = x.tests;
	if (x.triangle == UINT32_MAX)
		return INFINITY;
	*n = ob_terrain_regions(t)[ob_terrain_triangles(t)[x.triangle].region].normal;
	return x.nearest;
}
