#include "contact/area.h"

#include <string.h>

#include "contact/border.h"
#include "shape/shape.h"

static const double facing = 1 - 1e-6; // cosine: a face that leans more, by 1.4 mrad, stands on a corner or an edge
static const double same = 1e-9; // relative to the size: corners that are one; a parallelogram
static const double most_off = .98; // share of the way to the border: most of a centre of pressure
static const double far_share = .02; // share of rotation in the slip below which nodes take the place of the border

// ---- the common area

enum { CORNERS_MAX = 2 * OB_HULL_CORNERS_MAX };

typedef struct outline {
	int n;
	double x[CORNERS_MAX], y[CORNERS_MAX];
} outline;

static double cross_at(const outline *p, int i, int j, int k)
{
	return (p->x[j] - p->x[i]) * (p->y[k] - p->y[i]) - (p->y[j] - p->y[i]) * (p->x[k] - p->x[i]);
}

static void put(outline *p, double x, double y)
{
	if (p->n < CORNERS_MAX)
		p->x[p->n] = x, p->y[p->n++] = y;
}

static void drop(outline *p, int k)
{
	p->n--;
	memmove(p->x + k, p->x + k + 1, (size_t)(p->n - k) * sizeof *p->x);
	memmove(p->y + k, p->y + k + 1, (size_t)(p->n - k) * sizeof *p->y);
}

// Sets "out" to the part with value >= 0 of a function that is linear: f at each corner.
static void take_part(const outline *p, const double *f, outline *out)
{
	out->n = 0;
	for (int k = 0; k < p->n; k++) {
		const int next = k + 1 < p->n ? k + 1 : 0;
		if (f[k] >= 0)
			put(out, p->x[k], p->y[k]);
		if (f[k] * f[next] < 0) {
			const double s = f[k] / (f[k] - f[next]);
			put(out, p->x[k] + s * (p->x[next] - p->x[k]), p->y[k] + s * (p->y[next] - p->y[k]));
		}
	}
}

static void copy(const outline *from, outline *to)
{
	to->n = from->n;
	memcpy(to->x, from->x, (size_t)from->n * sizeof *from->x);
	memcpy(to->y, from->y, (size_t)from->n * sizeof *from->y);
}

// Keeps the part of p within the convex outline q; both counterclockwise.
static void clip(outline *p, const outline *q)
{
	double f[CORNERS_MAX];
	outline out;
	for (int i = 0; i < q->n; i++) {
		const int j = i + 1 < q->n ? i + 1 : 0;
		const double ex = q->x[j] - q->x[i], ey = q->y[j] - q->y[i];
		bool outside = false;
		for (int k = 0; k < p->n; k++) {
			f[k] = ex * (p->y[k] - q->y[i]) - ey * (p->x[k] - q->x[i]);
			outside |= f[k] < 0;
		}
		if (!outside)
			continue;
		take_part(p, f, &out);
		copy(&out, p);
	}
}

// Removes corners that are one, or in line with their neighbours, and further ones that span least.
static void tidy(outline *p, double size)
{
	for (int k = 0; k < p->n && p->n > 2;) {
		const int last = k ? k - 1 : p->n - 1, next = k + 1 < p->n ? k + 1 : 0;
		if (cross_at(p, last, k, next) > same * size * size)
			k++;
		else
			drop(p, k), k = 0;
	}
	while (p->n > OB_AREA_CORNERS) {
		double least = INFINITY;
		int at = 0;
		for (int k = 0; k < p->n; k++) {
			const double spans = cross_at(p, k ? k - 1 : p->n - 1, k, k + 1 < p->n ? k + 1 : 0);
			if (spans < least)
				least = spans, at = k;
		}
		drop(p, at);
	}
}

// Projects a corner, from "from", into the tangents' plane.
static void put_corner(outline *p, ob_vec3 at, ob_vec3 from, ob_vec3 t1, ob_vec3 t2)
{
	const ob_vec3 r = ob_sub(at, from);
	put(p, ob_dot(r, t1), ob_dot(r, t2));
}

static void reverse(outline *p)
{
	for (int i = 0, j = p->n - 1; i < j; i++, j--) {
		const double x = p->x[i], y = p->y[i];
		p->x[i] = p->x[j], p->y[i] = p->y[j];
		p->x[j] = x, p->y[j] = y;
	}
}

// Outline of the face that looks along "towards". Returns false if none does.
static bool outline_of_box(const ob_placed *s, ob_vec3 towards, ob_vec3 from, ob_vec3 t1, ob_vec3 t2, outline *o)
{
	static const int s1[4] = { 1, -1, -1, 1 }, s2[4] = { 1, 1, -1, -1 };
	const double h[3] = { s->size.x, s->size.y, s->size.z };
	for (int i = 0; i < 3; i++) {
		const ob_vec3 axis = ob_column(&s->r, i);
		const double c = ob_dot(axis, towards);
		if (fabs(c) < facing)
			continue;
		const ob_vec3 centre = ob_madd(s->p, c < 0 ? -h[i] : h[i], axis);
		const ob_vec3 u = ob_scale(ob_column(&s->r, (i + 1) % 3), h[(i + 1) % 3]),
			      w = ob_scale(ob_column(&s->r, (i + 2) % 3), h[(i + 2) % 3]);
		for (int k = 0; k < 4; k++)
			put_corner(o, ob_madd(ob_madd(centre, s1[k], u), s2[k], w), from, t1, t2);
		return true;
	}
	return false;
}

static bool outline_of_hull(const ob_placed *s, ob_vec3 towards, ob_vec3 from, ob_vec3 t1, ob_vec3 t2, outline *o)
{
	const ob_hull *h = s->hull;
	const ob_vec3 l = ob_rotate_back(&s->r, towards);
	double best = facing;
	uint32_t face = UINT32_MAX;
	for (uint32_t f = 0; f < h->faces; f++)
		if (ob_dot(l, h->normal[f]) > best)
			best = ob_dot(l, h->normal[f]), face = f;
	if (face == UINT32_MAX)
		return false;
	for (uint32_t k = h->first[face]; k < h->first[face + 1]; k++)
		put_corner(o, ob_add(s->p, ob_rotate(&s->r, h->corner[h->loop[k]])), from, t1, t2);
	return true;
}

static bool outline_of(const ob_placed *s, ob_vec3 towards, ob_vec3 from, ob_vec3 t1, ob_vec3 t2, outline *o)
{
	o->n = 0;
	if (!(s->hull ? outline_of_hull : outline_of_box)(s, towards, from, t1, t2, o))
		return false;
	if (cross_at(o, 0, 1, 2) < 0)
		reverse(o);
	return true;
}

static bool is_parallelogram(const outline *p, double size)
{
	return p->n == 4 &&
	       fabs(p->x[0] + p->x[2] - p->x[1] - p->x[3]) + fabs(p->y[0] + p->y[2] - p->y[1] - p->y[3]) < same * size;
}

bool ob_area_find(const ob_placed *a, const ob_placed *b, ob_vec3 n, ob_vec3 from_a, ob_vec3 from_b, ob_vec3 t1,
		  ob_vec3 t2, ob_contact_area *out)
{
	outline p, q;
	const bool plane_a = ob_shape_is(a->shape, OB_UNBOUNDED), plane_b = ob_shape_is(b->shape, OB_UNBOUNDED);
	if (!plane_a && !outline_of(a, ob_scale(n, -1), from_a, t1, t2, &p))
		return false;
	if (!plane_b && !outline_of(b, n, from_b, t1, t2, plane_a ? &p : &q))
		return false;
	if (!plane_a && !plane_b)
		clip(&p, &q);
	double size = 0;
	for (int k = 0; k < p.n; k++)
		size = ob_max(size, fabs(p.x[k]) + fabs(p.y[k]));
	tidy(&p, size);
	if (p.n < 3 || is_parallelogram(&p, size))
		return false;
	out->corners = p.n;
	memcpy(out->x, p.x, (size_t)p.n * sizeof *out->x);
	memcpy(out->y, p.y, (size_t)p.n * sizeof *out->y);
	return true;
}

// ---- the pressure

// Integrals over an outline: of 1, x, y, x^2, x y, y^2.
typedef struct moments {
	double one, x, y, xx, xy, yy;
} moments;

static moments moments_of(const outline *p)
{
	moments m = { 0, 0, 0, 0, 0, 0 };
	for (int k = 0; k < p->n; k++) {
		const int j = k + 1 < p->n ? k + 1 : 0;
		const double x = p->x[k], y = p->y[k], u = p->x[j], v = p->y[j], c = x * v - y * u;
		m.one += c * .5;
		m.x += c * (x + u) / 6, m.y += c * (y + v) / 6;
		m.xx += c * (x * x + x * u + u * u) / 12, m.yy += c * (y * y + y * v + v * v) / 12;
		m.xy += c * (2 * x * y + x * v + u * y + 2 * u * v) / 24;
	}
	return m;
}

// Solves s x = b for a symmetric matrix: 11 12 13 22 23 33.
static void solve3(const double *s, const double *b, double *x)
{
	const double c0 = s[3] * s[5] - s[4] * s[4], c1 = s[2] * s[4] - s[1] * s[5], c2 = s[1] * s[4] - s[2] * s[3];
	const double inverse = 1 / (s[0] * c0 + s[1] * c1 + s[2] * c2);
	const double c3 = s[0] * s[5] - s[2] * s[2], c4 = s[1] * s[2] - s[0] * s[4], c5 = s[0] * s[3] - s[1] * s[1];
	x[0] = inverse * (c0 * b[0] + c1 * b[1] + c2 * b[2]);
	x[1] = inverse * (c1 * b[0] + c3 * b[1] + c4 * b[2]);
	x[2] = inverse * (c2 * b[0] + c4 * b[1] + c5 * b[2]);
}

// Sets "part" to the part of the outline under a pressure p[0] + p[1] x + p[2] y.
static void take_loaded(const outline *whole, const double *p, outline *part)
{
	double f[CORNERS_MAX];
	for (int k = 0; k < whole->n; k++)
		f[k] = p[0] + p[1] * whole->x[k] + p[2] * whole->y[k];
	take_part(whole, f, part);
}

// Half of the integral of the squared pressure, less p . (1, centre): its least has the resultant 1 and this centre.
static double potential(const outline *part, const double *p, const double *centre)
{
	const moments m = moments_of(part);
	const double square = p[0] * p[0] * m.one + 2 * p[0] * (p[1] * m.x + p[2] * m.y) + p[1] * p[1] * m.xx +
			      2 * p[1] * p[2] * m.xy + p[2] * p[2] * m.yy;
	return .5 * square - p[0] - p[1] * centre[0] - p[2] * centre[1];
}

// Share of the way from one place to another at which it leaves the outline; 1 if it does not.
static double way_within(const outline *p, const double *from, const double *to)
{
	double share = INFINITY;
	for (int k = 0; k < p->n; k++) {
		const int j = k + 1 < p->n ? k + 1 : 0;
		const double ex = p->x[j] - p->x[k], ey = p->y[j] - p->y[k];
		const double f = ex * (from[1] - p->y[k]) - ey * (from[0] - p->x[k]),
			     g = ex * (to[1] - p->y[k]) - ey * (to[0] - p->x[k]);
		if (g < f)
			share = ob_min(share, f / (f - g));
	}
	return share;
}

// Finds the pressure over an outline about its centroid, of size 1, and the part that it loads. centre: its centre.
static void find_pressure(const outline *whole, const double *centre, double *p, outline *part)
{
	enum { STEPS = 40, HALVINGS = 30 };
	const double close = 1e-10, rounding = 1e-14; // relative to the pressure; to the function
	double value = INFINITY;
	copy(whole, part);
	p[0] = p[1] = p[2] = 0;
	for (int i = 0; i < STEPS; i++) {
		const moments m = moments_of(part);
		const double s[6] = { m.one, m.x, m.y, m.xx, m.xy, m.yy }, b[3] = { 1, centre[0], centre[1] };
		double next[3], change = 0, size = 0, share = 1;
		solve3(s, b, next);
		for (int c = 0; c < 3; c++)
			change += fabs(next[c] - p[c]), size += fabs(next[c]);
		if (i > 0 && !(change > close * size))
			return;
		bool nearer = false;
		for (int k = 0; k < HALVINGS && !nearer; k++, share *= .5) {
			double tried[3];
			outline there;
			for (int c = 0; c < 3; c++)
				tried[c] = p[c] + share * (next[c] - p[c]);
			take_loaded(whole, tried, &there);
			const double now = potential(&there, tried, centre);
			nearer = there.n > 2 && !(now > value + rounding * fabs(value));
			if (!nearer)
				continue;
			memcpy(p, tried, sizeof tried);
			copy(&there, part);
			value = now;
		}
		if (!nearer)
			return;
	}
}

void ob_area_load_set(const ob_contact_area *area, const double centre[2], ob_area_load *o)
{
	outline whole = { .n = area->corners };
	memcpy(whole.x, area->x, (size_t)area->corners * sizeof *area->x);
	memcpy(whole.y, area->y, (size_t)area->corners * sizeof *area->y);
	const moments m = moments_of(&whole);
	const double middle[2] = { m.x / m.one, m.y / m.one }, length = sqrt(m.one);
	const double share = ob_min(1, most_off * way_within(&whole, middle, centre));
	double at[2], p[3];
	for (int k = 0; k < whole.n; k++)
		whole.x[k] = (whole.x[k] - middle[0]) / length, whole.y[k] = (whole.y[k] - middle[1]) / length;
	for (int c = 0; c < 2; c++)
		at[c] = share * (centre[c] - middle[c]) / length;
	outline part;
	find_pressure(&whole, at, p, &part);
	const moments k = moments_of(&part);
	const double x = k.x / k.one, y = k.y / k.one;
	*o = (ob_area_load){ .corners = part.n,
			     .at = p[0],
			     .slope = { p[1], p[2] },
			     .length = length,
			     .middle = { middle[0], middle[1] },
			     .spread = ((k.xx + k.yy) / k.one - x * x - y * y) * m.one };
	memcpy(o->x, part.x, (size_t)part.n * sizeof *o->x);
	memcpy(o->y, part.y, (size_t)part.n * sizeof *o->y);
}

// ---- the power

static double sum_of(lanes x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

// Computes D and its matrix about the middle for a centre of rotation nearby, as integrals along the border
// (contact/patch.h). v, w: slip of the middle.
static void slip_near(const ob_area_load *p, const double *v, double w, double *power, double *bound)
{
	const double iw = 1 / w, scale = iw * iw, slope[2] = { -p->slope[1] * iw, p->slope[0] * iw };
	const double at = p->at - slope[0] * v[0] - slope[1] * v[1];
	const lanes wide[2] = { lanes_of(slope[0]), lanes_of(slope[1]) };
	border_sums sums = { { { 0 } }, { 0 }, { 0 } };
	for (int i = 0; i < p->corners; i += OB_LANES) {
		lanes u[2], next[2];
		for (int l = 0; l < OB_LANES; l++) {
			const int j = i + l < p->corners ? i + l : 0, k = i + l < p->corners ? (j + 1) % p->corners : 0;
			u[0][l] = v[0] - w * p->y[j], u[1][l] = v[1] + w * p->x[j];
			next[0][l] = v[0] - w * p->y[k], next[1][l] = v[1] + w * p->x[k];
		}
		border_add_edge(u, lanes_sqrt(u[0] * u[0] + u[1] * u[1]), next,
				lanes_sqrt(next[0] * next[0] + next[1] * next[1]), lanes_of(at), wide, &sums);
	}
	double grad[3];
	for (int c = 0; c < 2; c++)
		grad[c] = scale * sum_of(sums.force[c]);
	*power = scale * sum_of(sums.power);
	grad[2] = (*power - grad[0] * v[0] - grad[1] * v[1]) * iw;
	const double weight = scale * sum_of(sums.weight), kx = (grad[0] - weight * v[0]) * iw,
		     ky = (grad[1] - weight * v[1]) * iw;
	const double all[6] = { weight, 0, kx, weight, ky, (grad[2] - kx * v[0] - ky * v[1]) * iw };
	memcpy(bound, all, sizeof all);
}

// Computes them for a distant centre of rotation, by six nodes in each triangle (Dunavant 1985): exact to degree 4.
static void slip_far(const ob_area_load *p, const double *v, double w, double *power, double *bound)
{
	static const double node[2] = { .44594849091596489, .091576213509770743 },
			    weight[2] = { .22338158967801147, .10995174365532187 };
	*power = 0;
	memset(bound, 0, 6 * sizeof *bound);
	for (int k = 1; k + 1 < p->corners; k++) {
		const double ax = p->x[k] - p->x[0], ay = p->y[k] - p->y[0], bx = p->x[k + 1] - p->x[0],
			     by = p->y[k + 1] - p->y[0], area = .5 * (ax * by - ay * bx);
		for (int i = 0; i < 6; i++) {
			const double near = node[i / 3], far = 1 - 2 * near;
			const double s = i % 3 == 0 ? far : near, t = i % 3 == 1 ? far : near;
			const double x = p->x[0] + s * ax + t * bx, y = p->y[0] + s * ay + t * by;
			const double ux = v[0] - w * y, uy = v[1] + w * x, speed = sqrt(ux * ux + uy * uy);
			const double load = weight[i / 3] * area * (p->at + p->slope[0] * x + p->slope[1] * y),
				     c = load / (speed + 1e-300);
			*power += load * speed;
			bound[0] += c, bound[2] -= c * y, bound[4] += c * x, bound[5] += c * (x * x + y * y);
		}
	}
	bound[3] = bound[0];
}

void ob_area_slip(const ob_area_load *p, const double slip[3], const double about[2], double *power, double bound[6])
{
	const double w = slip[2] * p->length,
		     v[2] = { slip[0] - slip[2] * p->middle[1], slip[1] + slip[2] * p->middle[0] };
	if (fabs(w) < far_share * (fabs(v[0]) + fabs(v[1])))
		slip_far(p, v, w, power, bound);
	else
		slip_near(p, v, w, power, bound);
	const double x = (about[1] - p->middle[1]) / p->length, y = (p->middle[0] - about[0]) / p->length;
	bound[5] += 2 * (x * bound[2] + y * bound[4]) + x * x * bound[0] + 2 * x * y * bound[1] + y * y * bound[3];
	bound[2] += x * bound[0] + y * bound[1];
	bound[4] += x * bound[1] + y * bound[3];
	bound[2] *= p->length, bound[4] *= p->length, bound[5] *= p->length * p->length;
}
