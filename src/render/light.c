#include "render/light.h"

enum { MARGIN = 4 }; // texels kept free at each side, for the filter
static const double reach_ranges = 6; // camera ranges: shadows are drawn so far

typedef struct rect {
	double low_x, low_y, high_x, high_y;
} rect;

static const rect nothing = { INFINITY, INFINITY, -INFINITY, -INFINITY };

static void include(rect *r, double x, double y, double reach)
{
	r->low_x = fmin(r->low_x, x - reach);
	r->low_y = fmin(r->low_y, y - reach);
	r->high_x = fmax(r->high_x, x + reach);
	r->high_y = fmax(r->high_y, y + reach);
}

static bool overlaps(const rect *r, double x, double y, double reach)
{
	return x + reach >= r->low_x && x - reach <= r->high_x && y + reach >= r->low_y && y - reach <= r->high_y;
}

// The frustum down to depth (m), in the map's plane.
static rect seen(const ob_map *m, const ob_view *v, double depth)
{
	rect r = nothing;
	include(&r, ob_dot(v->eye, m->x), ob_dot(v->eye, m->y), 0);
	for (int corner = 0; corner < 4; corner++) {
		ob_vec3 p = ob_madd(v->eye, depth, v->forward);
		p = ob_madd(p, (corner & 1 ? depth : -depth) * v->tan_x, v->right);
		p = ob_madd(p, (corner & 2 ? depth : -depth) * v->tan_y, v->up);
		include(&r, ob_dot(p, m->x), ob_dot(p, m->y), 0);
	}
	return r;
}

// Depth (m) of the farthest body in sight, as far as shadows are drawn.
static double depth_in_sight(const ob_bodies *b, const ob_view *v)
{
	double depth = v->range, most = reach_ranges * v->range;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_render_body *body = &b->body[i];
		double d = ob_dot(ob_sub(body->pose.p, v->eye), v->forward) + body->radius;
		if (d > depth && ob_view_sees(v, body->pose.p, body->radius))
			depth = d;
	}
	return fmin(1.5 * depth, most);
}

// The least size of the ladder 2^(k/4) that holds need (m) and the margin.
static double ladder(double need, int texels)
{
	double half = fmax(need, .05) * texels / (texels - 2 * MARGIN - 2);
	return exp2(ceil(4 * log2(half)) / 4);
}

static double snapped(double centre, double half, int texels)
{
	double texel = 2 * half / texels;
	return texel * round(centre / texel);
}

ob_map ob_map_fit(ob_vec3 z, const ob_bodies *b, const ob_view *v, int texels)
{
	ob_map m = { .z = z, .z_low = INFINITY, .z_high = -INFINITY };
	m.x = fabs(z.z) > .999 ? ob_v3(1, 0, 0) : ob_cross(ob_v3(0, 0, 1), z);
	m.x = ob_scale(m.x, 1 / ob_norm(m.x));
	m.y = ob_cross(z, m.x);
	double depth = depth_in_sight(b, v);
	rect frustum = seen(&m, v, depth), cast = nothing;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_render_body *body = &b->body[i];
		double x = ob_dot(body->pose.p, m.x), y = ob_dot(body->pose.p, m.y), up = ob_dot(body->pose.p, z);
		if (!overlaps(&frustum, x, y, body->radius))
			continue;
		include(&cast, x, y, body->radius);
		m.z_low = fmin(m.z_low, up - body->radius);
		m.z_high = fmax(m.z_high, up + body->radius);
	}
	if (m.z_low > m.z_high) { // nothing casts
		cast = frustum;
		m.z_low = -1;
		m.z_high = 1;
	}
	double low_x = fmax(cast.low_x, frustum.low_x), high_x = fmin(cast.high_x, frustum.high_x);
	double low_y = fmax(cast.low_y, frustum.low_y), high_y = fmin(cast.high_y, frustum.high_y);
	m.half_x = ladder(.5 * (high_x - low_x), texels);
	m.half_y = ladder(.5 * (high_y - low_y), texels);
	m.centre_x = snapped(.5 * (low_x + high_x), m.half_x, texels);
	m.centre_y = snapped(.5 * (low_y + high_y), m.half_y, texels);
	return m;
}

bool ob_map_holds(const ob_map *m, const ob_render_body *body)
{
	return fabs(ob_dot(body->pose.p, m->x) - m->centre_x) <= m->half_x + body->radius &&
	       fabs(ob_dot(body->pose.p, m->y) - m->centre_y) <= m->half_y + body->radius;
}

void ob_map_matrix(const ob_map *m, ob_vec3 eye, float out[16])
{
	double deep = m->z_high - m->z_low;
	ob_vec3 x = ob_scale(m->x, .5 / m->half_x), y = ob_scale(m->y, .5 / m->half_y), z = ob_scale(m->z, -1 / deep);
	double column[4][3] = {
		{ x.x, y.x, z.x },
		{ x.y, y.y, z.y },
		{ x.z, y.z, z.z },
		{ (ob_dot(eye, m->x) - m->centre_x) * .5 / m->half_x + .5,
		  (ob_dot(eye, m->y) - m->centre_y) * .5 / m->half_y + .5, (m->z_high - ob_dot(eye, m->z)) / deep },
	};
	for (int i = 0; i < 4; i++) {
		for (int k = 0; k < 3; k++)
			out[4 * i + k] = (float)column[i][k];
		out[4 * i + 3] = i == 3;
	}
}
