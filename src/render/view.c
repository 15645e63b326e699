#include "render/view.h"

// Farther than this nothing is drawn: the haze has hidden it (see HAZE_RANGES in frame.c).
static const double far_ranges = 60, far_least = 2000; // camera ranges; m
static const double steepest = 89 * M_PI / 180; // rad: a level horizon needs a direction that is not vertical

// Azimuth and elevation, turned and limited, as a direction.
static ob_vec3 turned(ob_vec3 direction, double pan, double tilt)
{
	double azimuth = atan2(direction.y, direction.x) + pan;
	double elevation = atan2(direction.z, hypot(direction.x, direction.y)) + tilt;
	elevation = fmax(-steepest, fmin(steepest, elevation));
	return ob_v3(cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation));
}

ob_view ob_view_of_camera(const ob_camera_def *c, double t, int width, int height)
{
	ob_view v = { .eye = ob_madd(c->eye, t, c->velocity), .range = ob_norm(ob_sub(c->target, c->eye)) };
	ob_vec3 look = v.range > 0 ? ob_sub(c->target, c->eye) : ob_v3(0, 1, 0);
	v.forward = turned(look, c->pan * t, c->tilt * t);
	v.right = ob_cross(v.forward, ob_v3(0, 0, 1));
	v.right = ob_scale(v.right, 1 / ob_norm(v.right));
	v.up = ob_cross(v.right, v.forward);
	v.tan_y = tan(.5 * c->fov);
	v.tan_x = v.tan_y * width / height;
	v.near_plane = fmax(.01, fmin(.5, .01 * v.range));
	v.far_plane = fmax(far_least, far_ranges * v.range);
	return v;
}

bool ob_view_sees(const ob_view *v, ob_vec3 centre, double radius)
{
	ob_vec3 d = ob_sub(centre, v->eye);
	double x = ob_dot(d, v->right), y = ob_dot(d, v->up), z = ob_dot(d, v->forward);
	if (z < -radius || z > v->far_plane + radius)
		return false;
	return (fabs(x) - z * v->tan_x) <= radius * hypot(1, v->tan_x) &&
	       (fabs(y) - z * v->tan_y) <= radius * hypot(1, v->tan_y);
}

void ob_view_projection(const ob_view *v, float m[16])
{
	double n = v->near_plane, f = v->far_plane;
	double row[4][3] = {
		{ v->right.x / v->tan_x, v->right.y / v->tan_x, v->right.z / v->tan_x },
		{ -v->up.x / v->tan_y, -v->up.y / v->tan_y, -v->up.z / v->tan_y },
		{ v->forward.x, v->forward.y, v->forward.z },
		{ v->forward.x, v->forward.y, v->forward.z },
	};
	for (int i = 0; i < 3; i++) {
		m[4 * i + 0] = (float)row[0][i];
		m[4 * i + 1] = (float)row[1][i];
		m[4 * i + 2] = (float)(row[2][i] * (f + n) / (f - n));
		m[4 * i + 3] = (float)row[3][i];
	}
	m[12] = m[13] = m[15] = 0;
	m[14] = (float)(-2 * f * n / (f - n));
}
