// Depth of two convex solids as the least overlap of their shadows over all directions n:
//
//     overlap(n) = extent_a(n) + extent_b(n) - |n . d|,   d from one centre to the other (all solids are symmetric)
//
// The function is smooth but for kinks where n lies along an axis of a solid, or in the plane across one (a box's edges
// and a cylinder's rims and mantle cast their shadows there), and its least value often lies in a kink. So the search
// takes the axes and their products as they are, walks each plane of kinks in one dimension, and looks for smooth
// minima in two, from an even scatter of starts.
#include "measure/depth.h"

enum { AXES_MAX = 6, PLANE_STARTS = 16, SPHERE_STARTS = 48, TURNS = 8 };

struct search {
	const ob_solid *a, *b;
	ob_vec3 d;
	ob_vec3 axis[AXES_MAX];
	int axes;
	double least;
	ob_vec3 best; // direction of the least overlap so far
};

static double overlap(const struct search *s, ob_vec3 n)
{
	return ob_solid_extent(s->a, n) + ob_solid_extent(s->b, n) - fabs(ob_dot(n, s->d));
}

static ob_vec3 unit(ob_vec3 n)
{
	return ob_scale(n, 1 / ob_norm(n));
}

static void offer(struct search *s, ob_vec3 n)
{
	double x = overlap(s, n);
	if (x < s->least) {
		s->least = x;
		s->best = n;
	}
}

static void add_axes(struct search *s, const ob_solid *solid)
{
	if (solid->shape == OB_SHAPE_BOX)
		for (int i = 0; i < 3; i++)
			s->axis[s->axes++] = ob_column(&solid->r, i);
	if (solid->shape == OB_SHAPE_CAPSULE || solid->shape == OB_SHAPE_CYLINDER)
		s->axis[s->axes++] = ob_column(&solid->r, 2);
}

static void across(ob_vec3 n, ob_vec3 *u, ob_vec3 *v)
{
	*u = unit(ob_cross(n, fabs(n.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0)));
	*v = ob_cross(n, *u);
}

// Golden section (Kiefer 1953) over the angle (rad) in the plane of u and v.
static void narrow(struct search *s, ob_vec3 u, ob_vec3 v, double low, double high)
{
	const double golden = .6180339887498949;
	for (int i = 0; i < 45; i++) { // the angle to 4e-10 of the first bracket
		double left = high - golden * (high - low), right = low + golden * (high - low);
		double at_left = overlap(s, ob_madd(ob_scale(u, cos(left)), sin(left), v));
		double at_right = overlap(s, ob_madd(ob_scale(u, cos(right)), sin(right), v));
		if (at_left < at_right)
			high = right;
		else
			low = left;
	}
	double middle = .5 * (low + high);
	offer(s, unit(ob_madd(ob_scale(u, cos(middle)), sin(middle), v)));
}

// The directions across one axis: half a circle, since n and -n are one shadow.
static void walk_plane(struct search *s, ob_vec3 axis)
{
	const double angle = M_PI / PLANE_STARTS;
	double at[PLANE_STARTS];
	ob_vec3 u, v;
	across(axis, &u, &v);
	for (int i = 0; i < PLANE_STARTS; i++)
		at[i] = overlap(s, ob_madd(ob_scale(u, cos(i * angle)), sin(i * angle), v));
	for (int i = 0; i < PLANE_STARTS; i++)
		if (at[i] <= at[(i + 1) % PLANE_STARTS] && at[i] <= at[(i + PLANE_STARTS - 1) % PLANE_STARTS])
			narrow(s, u, v, (i - 1) * angle, (i + 1) * angle);
}

// Pattern search (Hooke and Jeeves 1961): TURNS steps round n, turned a little each time so that no descent is missed
// for good; the step halves when none helps.
static void descend(struct search *s, ob_vec3 n, double step)
{
	double least = overlap(s, n), phase = 0;
	while (step > 1e-5) { // smooth: the overlap is within the square of that
		ob_vec3 u, v, from = n;
		across(n, &u, &v);
		bool better = false;
		for (int i = 0; i < TURNS; i++) {
			double angle = phase + i * (2 * M_PI / TURNS);
			ob_vec3 side = ob_madd(ob_scale(u, cos(angle)), sin(angle), v);
			ob_vec3 m = unit(ob_madd(from, step, side));
			double x = overlap(s, m);
			if (x < least) {
				least = x;
				n = m;
				better = true;
			}
		}
		phase += 2.399963229728653; // the golden angle
		if (!better)
			step *= .5;
	}
	offer(s, n);
}

// The three best of an even scatter over half the sphere (Fibonacci lattice), and the best so far.
static void search_sphere(struct search *s)
{
	ob_vec3 start[3];
	double value[3] = { INFINITY, INFINITY, INFINITY };
	for (int i = 0; i < SPHERE_STARTS; i++) {
		double z = (i + .5) / SPHERE_STARTS, r = sqrt(1 - z * z), angle = i * 2.399963229728653;
		ob_vec3 n = ob_v3(r * cos(angle), r * sin(angle), z);
		double x = overlap(s, n);
		for (int k = 0; k < 3; k++) {
			if (x >= value[k])
				continue;
			for (int l = 2; l > k; l--) {
				value[l] = value[l - 1];
				start[l] = start[l - 1];
			}
			value[k] = x;
			start[k] = n;
			break;
		}
	}
	descend(s, s->best, .1);
	for (int k = 0; k < 3; k++)
		descend(s, start[k], .2);
}

double ob_depth_search(const ob_solid *a, const ob_solid *b)
{
	struct search s = { .a = a, .b = b, .d = ob_sub(b->p, a->p), .least = INFINITY };
	add_axes(&s, a);
	add_axes(&s, b);
	double distance = ob_norm(s.d);
	offer(&s, distance > 0 ? ob_scale(s.d, 1 / distance) : ob_v3(0, 0, 1));
	for (int i = 0; i < s.axes; i++)
		offer(&s, s.axis[i]);
	for (int i = 0; i < s.axes; i++) {
		for (int j = i + 1; j < s.axes; j++) {
			ob_vec3 n = ob_cross(s.axis[i], s.axis[j]);
			if (ob_norm(n) > 1e-6)
				offer(&s, unit(n));
		}
	}
	if (s.least <= 0) // one shadow apart is enough
		return s.least;
	for (int i = 0; i < s.axes; i++)
		walk_plane(&s, s.axis[i]);
	if (s.least > 0)
		search_sphere(&s);
	return s.least;
}
