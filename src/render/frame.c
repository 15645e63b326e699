#include "render/frame.h"

static const double haze_ranges = 9, haze_least = 150; // camera ranges; m: distance of the haze
static const float sunshine[3] = { 1.72f, 1.60f, 1.36f }; // irradiance / pi, relative to a white of 1
static const float from_sky = .50f, from_ground = .40f; // the same, of a sky of 1 and a ground of 1

static void set(float to[4], ob_vec3 v, double w)
{
	to[0] = (float)v.x;
	to[1] = (float)v.y;
	to[2] = (float)v.z;
	to[3] = (float)w;
}

static ob_vec3 colour(const float c[3])
{
	return ob_v3(c[0], c[1], c[2]);
}

static int find_ground(const ob_bodies *b)
{
	for (int i = 0; i < b->planes; i++) {
		ob_mat3 r = ob_quat_matrix(b->plane[i].q);
		if (r.m[2][2] > .999)
			return i;
	}
	return -1;
}

static void set_light(ob_frame_block *k, const ob_look_def *look, ob_vec3 sun, const ob_map *m, double haze,
		      bool ground)
{
	ob_vec3 top = colour(look->sky_top), horizon = colour(look->sky_horizon);
	ob_vec3 sky = ob_add(ob_scale(top, .35), ob_scale(horizon, .65));
	ob_vec3 below = ground ? colour(look->ground_colour) : horizon;
	set(k->sun, sun, 2 * fmax(m->half_x, m->half_y) / OB_SUN_TEXELS);
	set(k->sun_colour, colour(sunshine), 0);
	set(k->sky_top, top, 1 / (haze * haze));
	set(k->sky_horizon, horizon, ground);
	set(k->ambient_up, ob_scale(sky, from_sky), 0);
	set(k->ambient_down, ob_scale(ob_add(ob_scale(below, .8), ob_scale(sky, .2)), from_ground), 0);
}

// The third row of the contact map's matrix is the height over the ground, in m.
static void set_contact(ob_frame *f, const ob_bodies *b)
{
	ob_vec3 up = ob_v3(0, 0, 1), foot = ob_v3(0, 0, 0);
	if (f->ground >= 0) {
		ob_mat3 r = ob_quat_matrix(b->plane[f->ground].q);
		up = ob_column(&r, 2);
		foot = b->plane[f->ground].p;
	}
	f->level = ob_dot(foot, up);
	f->contact = ob_map_fit(up, b, &f->view, OB_CONTACT_TEXELS);
	float *m = f->block.contact_map;
	ob_map_matrix(&f->contact, f->view.eye, m);
	m[2] = (float)up.x;
	m[6] = (float)up.y;
	m[10] = (float)up.z;
	m[14] = (float)(ob_dot(f->view.eye, up) - f->level);
}

void ob_frame_set(ob_frame *f, const ob_bodies *b, const ob_look_def *look, const ob_camera_def *c, double t, int width,
		  int height)
{
	ob_frame_block *k = &f->block;
	double length = ob_norm(look->sun);
	ob_vec3 sun = length > 0 ? ob_scale(look->sun, 1 / length) : ob_v3(0, 0, 1);
	f->view = ob_view_of_camera(c, t, width, height);
	f->sun = ob_map_fit(sun, b, &f->view, OB_SUN_TEXELS);
	f->ground = find_ground(b);
	ob_view_projection(&f->view, k->view_projection);
	ob_map_matrix(&f->sun, f->view.eye, k->sun_map);
	set_contact(f, b);
	set(k->ray_right, ob_scale(f->view.right, f->view.tan_x), 0);
	set(k->ray_up, ob_scale(f->view.up, -f->view.tan_y), 0); // rows run down
	set(k->ray_forward, f->view.forward, 0);
	set_light(k, look, sun, &f->sun, fmax(haze_least, haze_ranges * f->view.range), f->ground >= 0);
	k->sun_map_texel[0] = k->sun_map_texel[1] = 1.f / OB_SUN_TEXELS;
	set(k->viewport, ob_v3(width, height, 1. / width), 1. / height);
}
