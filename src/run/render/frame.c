#include "render/frame.h"

// ---- orthographic projections of the maps

enum { MARGIN = 4 }; // texels kept free at each side, for the filter
static const double reach_ranges = 3.5; // camera ranges: limit of shadows

typedef struct rect {
	double low_x, low_y, high_x, high_y;
} rect;

static const rect nothing = { INFINITY, INFINITY, -INFINITY, -INFINITY };

static void include_square(rect *r, double x, double y, double reach)
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

// Frustum down to depth (m), in the map's plane.
static rect visible_rect(const ob_ortho *m, const ob_view *v, double depth)
{
	rect r = nothing;
	include_square(&r, ob_dot(v->eye, m->x), ob_dot(v->eye, m->y), 0);
	for (int corner = 0; corner < 4; corner++) {
		ob_vec3 p = ob_madd(v->eye, depth, v->forward);
		p = ob_madd(p, (corner & 1 ? depth : -depth) * v->tan_x, v->right);
		p = ob_madd(p, (corner & 2 ? depth : -depth) * v->tan_y, v->up);
		include_square(&r, ob_dot(p, m->x), ob_dot(p, m->y), 0);
	}
	return r;
}

// Depth (m) of the farthest visible body, within the limit of shadows.
static double depth_in_sight(const ob_draw_list *b, const ob_view *v)
{
	double depth = v->range, most = reach_ranges * v->range;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_draw_item *body = &b->body[i];
		double d = ob_dot(ob_sub(body->pose.p, v->eye), v->forward) + body->radius;
		if (d > depth && body->drawn == OB_DRAWN_SOLID && ob_view_in_frustum(v, body->pose.p, body->radius))
			depth = d;
	}
	return fmin(1.5 * depth, most);
}

// Smallest of the sizes 2^(k/6) that holds need (m) and the margin.
static double stepped_size(double need, int texels)
{
	double half = fmax(need, .05) * texels / (texels - 2 * MARGIN - 2);
	return exp2(ceil(6 * log2(half)) / 6);
}

static double whole_texels(double centre, double half, int texels)
{
	double texel = 2 * half / texels;
	return texel * round(centre / texel);
}

ob_ortho ob_ortho_fit(ob_vec3 z, const ob_draw_list *b, const ob_view *v, int texels)
{
	ob_ortho m = { .z = z, .z_low = INFINITY, .z_high = -INFINITY };
	m.x = fabs(z.z) > .999 ? ob_v3(1, 0, 0) : ob_cross(ob_v3(0, 0, 1), z);
	m.x = ob_scale(m.x, 1 / ob_norm(m.x));
	m.y = ob_cross(z, m.x);
	double depth = depth_in_sight(b, v);
	rect frustum = visible_rect(&m, v, depth), cast = nothing;
	for (uint32_t i = 0; i < b->count; i++) {
		const ob_draw_item *body = &b->body[i];
		double x = ob_dot(body->pose.p, m.x), y = ob_dot(body->pose.p, m.y), up = ob_dot(body->pose.p, z);
		if (body->drawn != OB_DRAWN_SOLID || !overlaps(&frustum, x, y, body->radius))
			continue;
		include_square(&cast, x, y, body->radius);
		m.z_low = fmin(m.z_low, up - body->radius);
		m.z_high = fmax(m.z_high, up + body->radius);
	}
	if (m.z_low > m.z_high) { // no casters
		cast = frustum;
		m.z_low = -1;
		m.z_high = 1;
	}
	double low_x = fmax(cast.low_x, frustum.low_x), high_x = fmin(cast.high_x, frustum.high_x);
	double low_y = fmax(cast.low_y, frustum.low_y), high_y = fmin(cast.high_y, frustum.high_y);
	m.half_x = stepped_size(.5 * (high_x - low_x), texels);
	m.half_y = stepped_size(.5 * (high_y - low_y), texels);
	m.centre_x = whole_texels(.5 * (low_x + high_x), m.half_x, texels);
	m.centre_y = whole_texels(.5 * (low_y + high_y), m.half_y, texels);
	return m;
}

bool ob_ortho_contains(const ob_ortho *m, const ob_draw_item *body)
{
	return fabs(ob_dot(body->pose.p, m->x) - m->centre_x) <= m->half_x + body->radius &&
	       fabs(ob_dot(body->pose.p, m->y) - m->centre_y) <= m->half_y + body->radius;
}

void ob_ortho_matrix(const ob_ortho *m, ob_vec3 eye, float out[16])
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

// ---- the frame

static const double fog_ranges = 9, fog_least = 150; // camera ranges; m: distance of the fog
static const float sunshine[3] = { 1.95f, 1.82f, 1.60f }; // irradiance / pi, relative to a white of 1
static const float from_sky = .52f, from_ground = .45f; // same, of a sky of 1 and a ground of 1
// rad: half the angle of the sun's disc; wider than the real one, as through thin haze
static const double sun_radius = .025;
static const double golden = 2.39996322972865332; // rad, the golden angle

static void set_vec4(float to[4], ob_vec3 v, double w)
{
	to[0] = (float)v.x;
	to[1] = (float)v.y;
	to[2] = (float)v.z;
	to[3] = (float)w;
}

static ob_vec3 vec_of_colour(const float c[3])
{
	return ob_v3(c[0], c[1], c[2]);
}

static int find_ground(const ob_draw_list *b)
{
	for (int i = 0; i < b->planes; i++) {
		ob_mat3 r = ob_quat_matrix(b->plane[i].q);
		if (r.m[2][2] > .999)
			return i;
	}
	return -1;
}

static void set_lighting(ob_frame_block *k, const ob_look_def *look, ob_vec3 sun, const ob_ortho *m, double fog,
			 bool ground)
{
	ob_vec3 top = vec_of_colour(look->sky_top), horizon = vec_of_colour(look->sky_horizon);
	ob_vec3 sky = ob_add(ob_scale(top, .35), ob_scale(horizon, .65));
	ob_vec3 below = ground ? vec_of_colour(look->ground_colour) : horizon;
	set_vec4(k->sun, sun, 2 * fmax(m->half_x, m->half_y) / OB_SHADOW_TEXELS);
	set_vec4(k->sun_colour, vec_of_colour(sunshine), 0);
	set_vec4(k->sky_top, top, 1 / (fog * fog));
	set_vec4(k->sky_horizon, horizon, ground);
	set_vec4(k->ambient_up, ob_scale(sky, from_sky), 0);
	set_vec4(k->ambient_down, ob_scale(ob_add(ob_scale(below, .8), ob_scale(sky, .2)), from_ground), 0);
	double shines = ground ? sunshine[1] * fmax(sun.z, 0) + from_sky : .6;
	set_vec4(k->ground_shine, ob_scale(below, .75 * shines), 0);
	double deep = sun_radius * (m->z_high - m->z_low);
	k->shadow_texel[0] = k->shadow_texel[1] = 1.f / OB_SHADOW_TEXELS;
	k->shadow_texel[2] = (float)(.5 * deep / m->half_x);
	k->shadow_texel[3] = (float)(.5 * deep / m->half_y);
}

// Third row of the occlusion map's matrix: the height over the ground, in m.
static void set_occlusion(ob_frame *f, const ob_draw_list *b)
{
	ob_vec3 up = ob_v3(0, 0, 1), foot = ob_v3(0, 0, 0);
	if (f->ground >= 0) {
		ob_mat3 r = ob_quat_matrix(b->plane[f->ground].q);
		up = ob_column(&r, 2);
		foot = b->plane[f->ground].p;
	}
	f->level = ob_dot(foot, up);
	f->occlusion = ob_ortho_fit(up, b, &f->view, OB_OCCLUSION_TEXELS);
	float *m = f->block.occlusion_map;
	ob_ortho_matrix(&f->occlusion, f->view.eye, m);
	m[2] = (float)up.x;
	m[6] = (float)up.y;
	m[10] = (float)up.z;
	m[14] = (float)(ob_dot(f->view.eye, up) - f->level);
}

// Point of the sun's disc: Vogel's spiral, the middle for a single picture.
static ob_vec3 sun_of_share(const ob_look_def *look, const ob_frame_share *s)
{
	double length = ob_norm(look->sun);
	ob_vec3 sun = length > 0 ? ob_scale(look->sun, 1 / length) : ob_v3(0, 0, 1);
	if (s->count == 1)
		return sun;
	ob_vec3 x = ob_cross(fabs(sun.z) > .9 ? ob_v3(1, 0, 0) : ob_v3(0, 0, 1), sun), y;
	x = ob_scale(x, 1 / ob_norm(x));
	y = ob_cross(sun, x);
	double r = sun_radius * sqrt((s->number + .5) / s->count), turn = golden * s->number;
	sun = ob_madd(ob_madd(sun, r * cos(turn), x), r * sin(turn), y);
	return ob_scale(sun, 1 / ob_norm(sun));
}

// Directions spread evenly over the sky: a height in each band, azimuths by the golden angle.
static void set_sky(ob_frame *f, const ob_draw_list *b, const ob_frame_share *s, int texels)
{
	f->sky_maps = s->sky_maps;
	for (int i = 0; i < f->sky_maps; i++) {
		double part = (i + fmod(.5 + s->number * .61803398874989485, 1)) / f->sky_maps;
		double up = .06 + .92 * part, turn = golden * (i * s->count + s->number), out = sqrt(1 - up * up);
		ob_vec3 ray = ob_v3(out * cos(turn), out * sin(turn), up);
		ob_ortho *m = &f->sky[i];
		*m = ob_ortho_fit(ray, b, &f->view, texels);
		ob_ortho_matrix(m, f->view.eye, f->block.sky_map[i]);
		set_vec4(f->block.sky_ray[i], ray, 2 * fmax(m->half_x, m->half_y) / texels);
	}
}

// Moves the picture within its pixels: additive recurrence by the plastic number (Roberts 2018).
static void shift_in_pixel(float projection[16], const ob_frame_share *s, int width, int height)
{
	if (s->count == 1)
		return;
	double x = fmod(.5 + s->number * .75487766624669276, 1) - .5,
	       y = fmod(.5 + s->number * .56984029099805327, 1) - .5;
	for (int i = 0; i < 4; i++) {
		projection[4 * i] += (float)(2 * x / width) * projection[4 * i + 3];
		projection[4 * i + 1] += (float)(2 * y / height) * projection[4 * i + 3];
	}
}

void ob_frame_set(ob_frame *f, const ob_draw_list *b, const ob_look_def *look, const ob_view *v, int width, int height,
		  const ob_frame_share *share, int sky_texels)
{
	ob_frame_block *k = &f->block;
	ob_vec3 sun = sun_of_share(look, share);
	f->view = *v;
	f->shadow = ob_ortho_fit(sun, b, &f->view, OB_SHADOW_TEXELS);
	f->ground = find_ground(b);
	ob_view_projection(&f->view, k->view_projection);
	shift_in_pixel(k->view_projection, share, width, height);
	ob_ortho_matrix(&f->shadow, f->view.eye, k->shadow_map);
	set_occlusion(f, b);
	set_vec4(k->ray_right, ob_scale(f->view.right, f->view.tan_x), 0);
	set_vec4(k->ray_up, ob_scale(f->view.up, -f->view.tan_y), 0); // rows run down
	set_vec4(k->ray_forward, f->view.forward, 0);
	set_lighting(k, look, sun, &f->shadow, fmax(fog_least, fog_ranges * f->view.range), f->ground >= 0);
	set_sky(f, b, share, sky_texels);
	set_vec4(k->viewport, ob_v3(width, height, 1. / width), 1. / height);
}
