// Lidar: the distance along each beam to the nearest surface. It goes through the objects one by one. Beams that may meet an object's
// bounding ball are those within an angle of azimuth, and they alone are tested. The least distance is the same in any
// order.
#include "elementary/elementary.h"
#include "motion/flight.h"
#include "sensor/sensor.h"
#include "shape/part.h"
#include "shape/shape.h"

typedef struct scan {
	const ob_universe *u;
	const ob_sensor_passport *sensor;
	ob_vec3 p; // m, world
	ob_mat3 r; // its frame to the world
	double first, step; // rad: azimuth of the first beam, and from each to the next
	double *range;
} scan;

// Angle of beam i of n over an opening about 0; a whole turn begins at -pi.
static double angle_of(uint32_t i, uint32_t n, double opening)
{
	const double whole = 2 * M_PI;
	if (opening >= whole)
		return i * (whole / n) - M_PI;
	return n > 1 ? opening * (i / (n - 1.) - .5) : 0;
}

static double enter_faces(const ob_hull *h, ob_vec3 p, ob_vec3 d)
{
	double first = -INFINITY, last = INFINITY;
	for (uint32_t f = 0; f < h->faces; f++) {
		const double out = ob_dot(h->normal[f], d), way = h->offset[f] - ob_dot(h->normal[f], p);
		if (out < 0)
			first = ob_max(first, way / out);
		else if (out > 0)
			last = ob_min(last, way / out);
		else if (way < 0)
			return INFINITY;
	}
	return first > 0 && first <= last ? first : INFINITY;
}

static double enter_part(const ob_hull *h, ob_vec3 p, ob_vec3 d)
{
	if (!ob_part_is_round(h))
		return enter_faces(h, p, d);
	ob_vec3 n;
	const ob_mat3 r = ob_quat_matrix(h->frame);
	return ob_shape_kind_of((ob_shape)h->round)
		->enter(h->size, ob_rotate_back(&r, ob_sub(p, h->centre)), ob_rotate_back(&r, d), &n);
}

// Distance from p along d, in the object's frame; infinity: the ray does not enter it, or begins inside.
static double enter(const ob_universe *u, const ob_passport *o, ob_vec3 p, ob_vec3 d, double reach)
{
	ob_vec3 n;
	uint32_t tests;
	const ob_terrain *terrain = ob_terrain_of(u, o);
	const ob_shape_kind *kind = ob_shape_kind_of((ob_shape)o->shape);
	if (terrain)
		return ob_terrain_enter(terrain, p, d, reach, &n, &tests);
	if (kind->enter)
		return kind->enter(o->size, p, d, &n);
	const uint32_t parts = ob_parts_of(u, o);
	double nearest = INFINITY;
	for (uint32_t k = parts > 0; k <= parts; k++)
		nearest = ob_min(nearest, enter_part(ob_part_of(u, o, k), p, d));
	return nearest;
}

// Tests the beams from azimuth low to high in all rows; they may lie beyond a whole turn.
static void meet(const scan *s, const ob_passport *o, const ob_pose *at, double radius, double low, double high)
{
	const uint32_t beams = s->sensor->beams;
	const double begin = ceil(ob_max((low - s->first) / s->step, 0)),
		     end = floor(ob_min((high - s->first) / s->step, beams - 1));
	const ob_mat3 own = ob_quat_matrix(at->q);
	const ob_vec3 p = ob_rotate_back(&own, ob_sub(s->p, at->p)),
		      centre = ob_rotate_back(&s->r, ob_sub(at->p, s->p));
	for (uint32_t row = 0; row < s->sensor->rows; row++) {
		double side, ahead, up, level;
		ob_sincos(angle_of(row, s->sensor->rows, s->sensor->rise), &up, &level);
		for (double i = begin; i <= end; i++) {
			const uint32_t k = row * beams + (uint32_t)i;
			ob_sincos(angle_of((uint32_t)i, beams, s->sensor->fan), &side, &ahead);
			const ob_vec3 d = ob_v3(level * ahead, level * side, up);
			const double along = ob_dot(centre, d);
			if (ob_norm2(centre) - along * along > radius * radius || along - radius > s->range[k])
				continue;
			const double t = enter(s->u, o, p, ob_rotate_back(&own, ob_rotate(&s->r, d)), s->range[k]);
			s->range[k] = ob_min(s->range[k], t);
		}
	}
}

// Tests the beams that may meet the object's bounding ball.
static void look_at(const scan *s, const ob_passport *o, const ob_pose *at)
{
	const double radius = ob_shape_radius((ob_shape)o->shape, o->size) * (1 + 1e-9), whole = 2 * M_PI;
	const ob_vec3 c = ob_rotate_back(&s->r, ob_sub(at->p, s->p));
	const double across = sqrt(c.x * c.x + c.y * c.y);
	if (ob_norm(c) - radius > s->sensor->reach)
		return;
	if (!(across > radius)) {
		meet(s, o, at, radius, -whole, whole);
		return;
	}
	const double half = ob_asin(radius / across) + 1e-9, azimuth = ob_atan2(c.y, c.x);
	for (int turn = -1; turn <= 1; turn++)
		meet(s, o, at, radius, azimuth - half + turn * whole, azimuth + half + turn * whole);
}

bool ob_sample_lidar(const ob_sampled *x, double *value)
{
	const ob_sensor_passport *own = x->sensor;
	const ob_step_data *data = ob_universe_step_data(x->u);
	const ob_pose on = ob_moment_at(x->u, own->object, x->past, x->known, x->t).state.pose;
	const ob_mat3 body = ob_quat_matrix(on.q);
	scan s = { .u = x->u,
		   .sensor = own,
		   .p = ob_add(on.p, ob_rotate(&body, own->pose.p)),
		   .r = ob_quat_matrix(ob_quat_mul(on.q, own->pose.q)),
		   .first = angle_of(0, own->beams, own->fan),
		   .range = value };
	s.step = own->beams > 1 ? angle_of(1, own->beams, own->fan) - s.first : 2 * M_PI;
	for (uint32_t k = 0; k < own->width; k++)
		value[k] = own->reach;
	for (uint32_t id = 0; id < ob_universe_ids(x->u); id++) {
		const ob_passport *o = ob_passport_of(x->u, id);
		if (id == own->object || data->schedule[id].state == OB_SCHEDULE_ABSENT || o->flags & OB_OBJECT_SENSOR)
			continue;
		const ob_pose at = ob_moment_at(x->u, id, x->past, 0, x->t).state.pose;
		look_at(&s, o, &at);
	}
	for (uint32_t k = 0; k < own->width; k++)
		value[k] = value[k] < own->reach ? value[k] : INFINITY;
	return true;
}
