// Depths with boxes: box and box, capsule (or sphere) and box.
#include "measure/depth.h"

enum { BREAKS = 8 }; // both ends of a segment, and where it crosses the 6 planes of a box's faces

static void order(double *low, double *high)
{
	if (*low > *high) {
		double x = *low;
		*low = *high;
		*high = x;
	}
}

double ob_depth_boxes(const ob_solid *a, const ob_solid *b)
{
	ob_vec3 d = ob_sub(b->p, a->p);
	double least = INFINITY;
	for (int k = 0; k < 15; k++) {
		ob_vec3 n = k < 3   ? ob_column(&a->r, k)
			    : k < 6 ? ob_column(&b->r, k - 3)
				    : ob_cross(ob_column(&a->r, (k - 6) / 3), ob_column(&b->r, (k - 6) % 3));
		double length = ob_norm(n);
		if (length < 1e-6) // parallel edges: the faces' normals say the same
			continue;
		double overlap = (ob_solid_extent(a, n) + ob_solid_extent(b, n) - fabs(ob_dot(d, n))) / length;
		if (overlap < least)
			least = overlap;
		if (least <= 0)
			break;
	}
	return least;
}

// Half the slope in s of the squared distance of the point c + s u (box frame) from the box. Grows with s.
static double slope(const double c[3], const double u[3], const double h[3], double s)
{
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		double x = c[i] + s * u[i];
		sum += u[i] * (x - fmin(fmax(x, -h[i]), h[i]));
	}
	return sum;
}

// Distance of the segment c + s u, |s| <= half, from the box. The slope is linear between neighbouring breaks, so
// the interval in which it changes its sign gives the nearest point exactly.
static double segment_from_box(const double c[3], const double u[3], double half, const double h[3])
{
	double breaks[BREAKS] = { -half, half };
	for (int i = 0; i < 3; i++) {
		double inverse = fabs(u[i]) > 1e-300 ? 1 / u[i] : 0;
		breaks[2 + 2 * i] = fmin(fmax((-h[i] - c[i]) * inverse, -half), half);
		breaks[3 + 2 * i] = fmin(fmax((h[i] - c[i]) * inverse, -half), half);
	}
	for (int i = 1; i < BREAKS; i++)
		for (int j = i; j > 0; j--)
			order(&breaks[j - 1], &breaks[j]);
	double s = -half;
	for (int i = 0; i + 1 < BREAKS; i++) {
		double left = slope(c, u, h, breaks[i]), right = slope(c, u, h, breaks[i + 1]);
		s = breaks[i + 1];
		if (left >= 0 || right >= 0) {
			s = left >= 0 ? breaks[i]
				      : breaks[i] + (breaks[i + 1] - breaks[i]) * fmin(left / (left - right), 1);
			break;
		}
	}
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		double out = fabs(c[i] + s * u[i]) - h[i];
		sum += out > 0 ? out * out : 0;
	}
	return sqrt(sum);
}

// How deep the segment itself is in the box: the faces of box minus segment lie across the box's axes, and across the
// products of its edges with the segment.
static double segment_in_box(const double c[3], const double u[3], double half, const double h[3])
{
	double least = INFINITY;
	for (int k = 0; k < 6; k++) {
		double n[3] = { 0, 0, 0 };
		int i = k % 3, j = (k + 1) % 3, l = (k + 2) % 3;
		n[i] = k < 3;
		if (k >= 3) {
			double length = hypot(u[j], u[l]);
			if (length < 1e-6)
				continue;
			n[j] = -u[l] / length;
			n[l] = u[j] / length;
		}
		double reach = 0, along = 0, middle = 0;
		for (int m = 0; m < 3; m++) {
			reach += fabs(n[m]) * h[m];
			along += n[m] * u[m];
			middle += n[m] * c[m];
		}
		least = fmin(least, reach + fabs(along) * half - fabs(middle));
	}
	return least;
}

double ob_depth_capsule_box(const ob_solid *capsule, const ob_solid *box)
{
	ob_vec3 centre = ob_rotate_back(&box->r, ob_sub(capsule->p, box->p));
	ob_vec3 axis = ob_rotate_back(&box->r, ob_column(&capsule->r, 2));
	double c[3] = { centre.x, centre.y, centre.z }, u[3] = { axis.x, axis.y, axis.z };
	double h[3] = { box->size.x, box->size.y, box->size.z };
	double half = ob_solid_core(capsule);
	double distance = segment_from_box(c, u, half, h);
	if (distance > 1e-12 * (h[0] + h[1] + h[2])) // else rounding: the nearest point found may be where it enters
		return capsule->size.x - distance;
	return capsule->size.x + fmax(segment_in_box(c, u, half, h), 0);
}
