#include "record/recorded.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/utf8.h"
#include "table/table.h"

static bool sensor_makes_sense(const ob_sensor_passport *s)
{
	const double numbers[] = { s->pose.p.x, s->pose.p.y, s->pose.p.z, s->pose.q.w, s->pose.q.x, s->pose.q.y,
				   s->pose.q.z, s->rate,     s->delay,    s->fan,      s->rise,     s->reach };
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		if (!isfinite(numbers[i]))
			return false;
	return s->kind < OB_SENSOR_KINDS && ob_sensor_has_width(s) && s->beams >= (s->kind >= OB_SENSOR_LIDAR) &&
	       memchr(s->name, 0, sizeof s->name);
}

static bool open_sensors(ob_recording *r, ob_recorded_list *l, ob_error *e)
{
	ob_scene *scene = &r->info.scene;
	if (l->total > OB_SENSORS_MAX || !(scene->sensor = calloc(l->total + 1, sizeof *scene->sensor)))
		return ob_recording_damaged(r, "it has too many sensors", e);
	for (; scene->sensors < l->total; scene->sensors++) {
		const ob_sensor_passport *s = ob_recorded_item(l, scene->sensors);
		if (!s || !sensor_makes_sense(s))
			return ob_recording_damaged(r, "a sensor makes no sense", e);
		scene->sensor[scene->sensors] = *s;
		ob_utf8_make_plain(scene->sensor[scene->sensors].name);
	}
	return true;
}

bool ob_recorded_samples_open(ob_recording *r, ob_error *e)
{
	ob_recorded_list sensors = ob_recorded_list_of(&ob_record_sensors);
	bool there = false, pictured = false;
	if (!ob_recording_find(r, sensors.table->label.name, &there, e) ||
	    !ob_recording_find(r, r->pixels.table->label.name, &pictured, e))
		return false;
	const bool good = !there || (ob_recorded_list_open(r, &sensors, e) && open_sensors(r, &sensors, e) &&
				     ob_recorded_list_open(r, &r->samples, e) &&
				     (!pictured || ob_recorded_list_open(r, &r->pixels, e)));
	ob_recorded_list_close(&sensors);
	return good;
}

// Copies a picture, whose first pixel is in this row.
static bool take_pixels(ob_recording *r, uint64_t pixels, double row, ob_pixel *to)
{
	if (!(row >= 0 && row <= (double)r->pixels.total) || r->pixels.total - (uint64_t)row < pixels)
		return false;
	for (uint64_t i = 0; i < pixels; i++) {
		const ob_pixel *from = ob_recorded_item(&r->pixels, (uint64_t)row + i);
		if (!from)
			return false;
		to[i] = *from;
	}
	return true;
}

// Copies the values of the sample that begins in the current row, and goes beyond its rows.
static bool take_values(ob_recording *r, const ob_recorded_sample *s, double *to)
{
	const ob_sensor_passport *p = &r->info.scene.sensor[s->sensor];
	const bool is_camera = p->kind == OB_SENSOR_CAMERA;
	const uint32_t width = is_camera ? 1 : p->width;
	for (uint32_t first = 0; first < width; first += OB_RECORD_VALUES, r->sample++) {
		const ob_record_sample *row =
			r->sample < r->samples.total ? ob_recorded_item(&r->samples, r->sample) : NULL;
		if (!row || row->sensor != s->sensor || row->number != s->number || row->first != first)
			return false;
		if (is_camera && !take_pixels(r, (uint64_t)p->beams * p->rows, row->value[0], (ob_pixel *)to))
			return false;
		for (uint32_t k = first; !is_camera && k < width && k < first + OB_RECORD_VALUES; k++)
			to[k] = row->value[k - first];
	}
	return true;
}

static bool make_room(ob_recording *r, uint32_t width)
{
	if (r->recents == r->recents_max) {
		if (!OB_GROW(r->recent, 2 * r->recents_max + 16))
			return false;
		r->recents_max = 2 * r->recents_max + 16;
	}
	if (r->values + width > r->values_max) {
		const size_t room = 2 * (r->values + width);
		if (r->values + width > OB_SENSOR_NUMBERS_MAX || !OB_GROW(r->value, room))
			return false;
		r->values_max = room;
	}
	return true;
}

static bool take_sample(ob_recording *r, const ob_record_sample *row, ob_error *e)
{
	if (row->sensor >= r->info.scene.sensors || row->first)
		return ob_recording_damaged(r, "its samples make no sense", e);
	const uint32_t width = r->info.scene.sensor[row->sensor].width;
	if (!make_room(r, width))
		return ob_recording_damaged(r, "a state has too many samples", e);
	ob_recorded_sample *s = &r->recent[r->recents++];
	*s = (ob_recorded_sample){ row->sensor, row->number, row->time, NULL };
	memset(r->value + r->values, 0, width * sizeof *r->value);
	if (!take_values(r, s, r->value + r->values))
		return ob_recording_damaged(r, "its samples make no sense", e);
	r->values += width;
	return true;
}

bool ob_recorded_samples_take(ob_recording *r, ob_error *e)
{
	r->recents = r->values = 0;
	while (r->sample < r->samples.total) {
		const ob_record_sample *row = ob_recorded_item(&r->samples, r->sample);
		if (!row || !(row->time >= 0))
			return ob_recording_damaged(r, "/samples cannot be read", e);
		if (row->sensor < r->info.scene.sensors &&
		    row->time + r->info.scene.sensor[row->sensor].delay > r->now.time + 1e-9)
			break;
		if (!take_sample(r, row, e))
			return false;
	}
	const double *at = r->value; // now it stays
	for (size_t i = 0; i < r->recents; i++) {
		r->recent[i].value = at;
		at += r->info.scene.sensor[r->recent[i].sensor].width;
	}
	return true;
}

void ob_recorded_samples_close(ob_recording *r)
{
	ob_recorded_list_close(&r->samples);
	ob_recorded_list_close(&r->pixels);
	free(r->info.scene.sensor);
	free(r->recent);
	free(r->value);
}
