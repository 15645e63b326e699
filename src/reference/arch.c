#include "reference/arch.h"

#include <math.h>

// Joints of half an arch, from the crown down: the part between the crown and each joint, and the joint's place.
enum { JOINTS_MAX = 512 };
typedef struct half_arch {
	int joints;
	double inner, outer; // m, radii
	double sine[JOINTS_MAX], cosine[JOINTS_MAX];
	// of that part, with a unit of weight per area: m^2, m^3 about the centre
	double weight[JOINTS_MAX], moment[JOINTS_MAX];
} half_arch;

// Voussoirs are quadrilaterals: computes their areas, and moments about the vertical through the centre, by triangles.
static half_arch cut(int voussoirs, double radius, double thickness)
{
	half_arch h = { .joints = voussoirs / 2, .inner = radius - .5 * thickness, .outer = radius + .5 * thickness };
	double weight = 0, moment = 0;
	for (int j = 0; j < h.joints; j++) {
		const double from = M_PI * (h.joints - j) / voussoirs, to = M_PI * (h.joints - j - 1) / voussoirs;
		const double x[4] = { h.inner * cos(to), h.outer * cos(to), h.outer * cos(from), h.inner * cos(from) };
		const double z[4] = { h.inner * sin(to), h.outer * sin(to), h.outer * sin(from), h.inner * sin(from) };
		for (int k = 0; k < 4; k++) {
			const int next = (k + 1) % 4;
			const double area = .5 * (x[k] * z[next] - x[next] * z[k]);
			weight += area;
			moment += area * (x[k] + x[next]) / 3;
		}
		h.cosine[j] = cos(to), h.sine[j] = sin(to);
		h.weight[j] = weight, h.moment[j] = moment;
	}
	return h;
}

// The thrust crosses the crown at a moment Q about the centre, and each joint at (Q + moment) / (weight cosine + thrust
// sine) from it. Returns, for a horizontal thrust, the largest lower bound of Q minus the smallest upper bound over all
// joints.
static double excess(const half_arch *h, double thrust)
{
	double least = h->inner * thrust, greatest = h->outer * thrust;
	for (int j = 0; j < h->joints; j++) {
		const double normal = h->weight[j] * h->cosine[j] + thrust * h->sine[j];
		least = fmax(least, h->inner * normal - h->moment[j]);
		greatest = fmin(greatest, h->outer * normal - h->moment[j]);
	}
	return least - greatest;
}

// The excess is convex in the thrust.
static int stands(const half_arch *h)
{
	double low = 0, high = 3 * h->weight[h->joints - 1];
	for (int i = 0; i < 200; i++) {
		const double a = low + (high - low) / 3, b = high - (high - low) / 3;
		if (excess(h, a) < excess(h, b))
			high = b;
		else
			low = a;
	}
	return excess(h, .5 * (low + high)) <= 0;
}

double ob_reference_arch_thickness(int voussoirs, double radius)
{
	double falls = 0, holds = radius;
	for (int i = 0; i < 60; i++) {
		const double thickness = .5 * (falls + holds);
		const half_arch h = cut(voussoirs, radius, thickness);
		if (stands(&h))
			holds = thickness;
		else
			falls = thickness;
	}
	return holds;
}
