#include "host/cameras.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "render/render.h"

struct ob_cameras {
	const ob_scene *scene;
	ob_universe *u;
	ob_renderer **renderer; // [scene->sensors]: NULL: no camera, or it shares that of an earlier one
	double *value; // one sample, as large as any
	ob_snapshot now;
	ob_motion *before; // [now.count_max]: motions of the step before
	uint32_t before_max;
};

bool ob_cameras_check(const ob_scene *scene, ob_error *e)
{
	for (uint32_t i = 0; i < scene->sensors; i++)
		if (scene->sensor[i].kind == OB_SENSOR_CAMERA) {
			ob_error why;
			return ob_render_check(&why) ||
			       ob_fail(e, "camera \"%s\": %s", scene->sensor[i].name, why.text);
		}
	return true;
}

// First camera with pictures of this one's size.
static uint32_t drawn_by(const ob_scene *s, uint32_t camera)
{
	const ob_sensor_passport *c = &s->sensor[camera];
	uint32_t i = 0;
	while (s->sensor[i].kind != OB_SENSOR_CAMERA || s->sensor[i].beams != c->beams || s->sensor[i].rows != c->rows)
		i++;
	return i;
}

static bool create_renderer(ob_cameras *c, uint32_t camera, ob_error *e)
{
	const ob_sensor_passport *s = &c->scene->sensor[camera];
	const ob_render_setup setup = {
		.width = (int)s->beams, .height = (int)s->rows, .mesh = c->scene->mesh, .meshes = c->scene->meshes
	};
	ob_error why;
	c->renderer[camera] = ob_renderer_create(&setup, &c->scene->look, &why);
	return c->renderer[camera] || ob_fail(e, "camera \"%s\": %s", s->name, why.text);
}

ob_cameras *ob_cameras_create(const ob_scene *scene, ob_universe *u, ob_error *e)
{
	ob_cameras *c = calloc(1, sizeof *c);
	uint32_t width = 0;
	bool fine = c && (c->renderer = calloc(scene->sensors + 1, sizeof *c->renderer));
	if (c)
		c->scene = scene, c->u = u;
	for (uint32_t i = 0; i < scene->sensors; i++)
		if (scene->sensor[i].kind == OB_SENSOR_CAMERA && scene->sensor[i].width > width)
			width = scene->sensor[i].width;
	fine = (fine && (c->value = calloc(width + 1, sizeof *c->value))) || ob_fail(e, "out of memory");
	for (uint32_t i = 0; fine && i < scene->sensors; i++)
		if (scene->sensor[i].kind == OB_SENSOR_CAMERA && drawn_by(scene, i) == i)
			fine = create_renderer(c, i, e);
	if (fine)
		return c;
	ob_cameras_destroy(c);
	return NULL;
}

// Copies the motions before those that are newer than t.
static bool look_back(ob_cameras *c, double t, ob_snapshot *prev)
{
	const ob_snapshot *now = &c->now;
	if (now->count_max > c->before_max) {
		if (!OB_GROW(c->before, now->count_max))
			return false;
		c->before_max = now->count_max;
	}
	for (uint32_t i = 0; i < now->count; i++)
		c->before[i] = now->motion[i].t0 > t ? *ob_previous_motion(c->u, i) : now->motion[i];
	*prev = *now;
	prev->motion = c->before;
	prev->time = (double)(now->step - 1) * ob_universe_settings(c->u)->step_length;
	return true;
}

static bool draw(ob_cameras *c, uint32_t camera, uint64_t picture, ob_error *e)
{
	const ob_sensor_passport *s = &ob_universe_step_data(c->u)->sensor[camera];
	ob_snapshot prev;
	const double t = fmin((double)picture / s->rate, c->now.time);
	if (!look_back(c, t, &prev))
		return ob_fail(e, "out of memory");
	if (!ob_renderer_sense(c->renderer[drawn_by(c->scene, camera)], &prev, &c->now, t, &c->scene->sensor[camera],
			       (ob_pixel *)c->value, e))
		return false;
	ob_sensor_publish(c->u, camera, t, c->value);
	return true;
}

// Number of the last picture that is due when n steps are complete; 0: the camera takes none.
static uint64_t due(const ob_cameras *c, uint32_t camera, uint64_t n)
{
	const ob_sensor_passport *s = &ob_universe_step_data(c->u)->sensor[camera];
	const ob_passport *object = ob_passport_of(c->u, s->object);
	const bool there =
		s->kind == OB_SENSOR_CAMERA && object->flags & OB_OBJECT_PRESENT && object->generation == s->generation;
	return there ? ob_sensor_due(s, ob_universe_settings(c->u)->step_length, n, 0) : 0;
}

static uint64_t taken(const ob_cameras *c, uint32_t camera)
{
	return ob_universe_step_data(c->u)->sensor_cell[camera].taken;
}

bool ob_cameras_draw(ob_cameras *c, ob_error *e)
{
	const uint64_t step = ob_step_count(c->u);
	bool fine = true, seen = false;
	for (uint32_t i = 0; i < c->scene->sensors && fine; i++)
		for (uint64_t last = due(c, i, step); taken(c, i) < last && fine; seen = true)
			fine = (seen || ob_snapshot_take(&c->now, c->u, 0, e)) && draw(c, i, taken(c, i) + 1, e);
	return fine;
}

uint64_t ob_cameras_next_step(const ob_cameras *c)
{
	const double h = ob_universe_settings(c->u)->step_length;
	const uint64_t step = ob_step_count(c->u);
	uint64_t first = UINT64_MAX;
	for (uint32_t i = 0; i < c->scene->sensors; i++) {
		const ob_sensor_passport *s = &ob_universe_step_data(c->u)->sensor[i];
		if (!due(c, i, UINT32_MAX))
			continue;
		uint64_t n = (uint64_t)((double)(taken(c, i) + 1) / s->rate / h);
		n = n > step + 1 ? n : step + 1;
		while (due(c, i, n) <= taken(c, i))
			n++;
		first = n < first ? n : first;
	}
	return first;
}

void ob_cameras_destroy(ob_cameras *c)
{
	if (!c)
		return;
	for (uint32_t i = 0; c->renderer && i < c->scene->sensors; i++)
		ob_renderer_destroy(c->renderer[i]);
	ob_snapshot_finish(&c->now);
	free(c->renderer);
	free(c->value);
	free(c->before);
	free(c);
}
