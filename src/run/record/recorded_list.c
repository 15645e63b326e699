#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/utf8.h"
#include "record/recorded.h"
#include "table/table.h"

enum { BYTES_AT_ONCE = 1 << 18 };

bool ob_recording_damaged(const ob_recording *r, const char *what, ob_error *e)
{
	return ob_fail(e, "%s: this record is damaged: %s", r->path, what);
}

// ---- links

// Nothing in a record may name another file, or load code: links lead to objects in the file itself, datasets lie
// there, too, and no filter has to be loaded.

bool ob_recording_find(const ob_recording *r, const char *name, bool *there, ob_error *e)
{
	char what[96], part[64];
	H5L_info_t link;
	*there = true;
	for (size_t n = 1; *there && n <= strlen(name); n++) {
		if (name[n] && name[n] != '/')
			continue;
		snprintf(part, sizeof part, "%.*s", (int)n, name);
		*there = H5Lexists(r->file, part, H5P_DEFAULT) > 0;
		if (*there && (H5Lget_info(r->file, part, &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD)) {
			snprintf(what, sizeof what, "/%s is a link to something else", part);
			return ob_recording_damaged(r, what, e);
		}
	}
	return true;
}

// ---- datasets

// True if the dataset's elements are stored unfiltered in the file. Checked before all else: for a virtual dataset,
// even a query of its size opens the files that it names.
static bool lies_in_file(hid_t set)
{
	hid_t how = H5Dget_create_plist(set);
	const H5D_layout_t layout = H5Pget_layout(how);
	const bool here = (layout == H5D_CHUNKED || layout == H5D_CONTIGUOUS) && H5Pget_external_count(how) == 0 &&
			  H5Pget_nfilters(how) == 0;
	H5Pclose(how);
	return here;
}

hid_t ob_recorded_set_open(const ob_recording *r, const char *name, H5T_class_t kind, int rank, uint64_t *count,
			   ob_error *e)
{
	char what[80];
	bool there = false;
	if (!ob_recording_find(r, name, &there, e))
		return H5I_INVALID_HID;
	hid_t set = there ? H5Dopen2(r->file, name, H5P_DEFAULT) : H5I_INVALID_HID;
	if (set >= 0 && !lies_in_file(set)) {
		H5Dclose(set);
		set = H5I_INVALID_HID;
	}
	if (set >= 0) {
		hid_t type = H5Dget_type(set), space = H5Dget_space(set);
		hssize_t points = H5Sget_simple_extent_npoints(space);
		uint64_t bytes = 0, stored = H5Dget_storage_size(set);
		bool fits = H5Tget_class(type) == kind && H5Sget_simple_extent_ndims(space) == rank && points >= 0 &&
			    !__builtin_mul_overflow((uint64_t)points, (uint64_t)H5Tget_size(type), &bytes) &&
			    bytes <= stored && stored <= r->file_bytes;
		*count = (uint64_t)points;
		H5Sclose(space);
		H5Tclose(type);
		if (fits)
			return set;
		H5Dclose(set);
	}
	snprintf(what, sizeof what, "/%s is not as it should be", name);
	ob_recording_damaged(r, what, e);
	return H5I_INVALID_HID;
}

ob_recorded_list ob_recorded_list_of(const ob_record_table *table)
{
	return (ob_recorded_list){ .table = table, .set = H5I_INVALID_HID, .type = H5I_INVALID_HID };
}

bool ob_recorded_list_open(ob_recording *r, ob_recorded_list *l, ob_error *e)
{
	l->set = ob_recorded_set_open(r, l->table->label.name, H5T_COMPOUND, 1, &l->total, e);
	if (l->set < 0)
		return false;
	l->type = ob_record_type_in_memory(l->table);
	l->room = BYTES_AT_ONCE / l->table->size;
	l->item = calloc(l->room, l->table->size);
	return l->item ? true : ob_fail(e, "%s: no memory", r->path);
}

void ob_recorded_list_close(ob_recorded_list *l)
{
	if (l->set >= 0)
		H5Dclose(l->set);
	if (l->type >= 0)
		H5Tclose(l->type);
	free(l->item);
}

const void *ob_recorded_item(ob_recorded_list *l, uint64_t i)
{
	if (i < l->first || i >= l->first + l->held) {
		hsize_t from = i, count = l->total - i < l->room ? l->total - i : l->room;
		hid_t in_file = H5Dget_space(l->set), in_memory = H5Screate_simple(1, &count, NULL);
		memset(l->item, 0, l->room * l->table->size);
		bool ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, &from, NULL, &count, NULL) >= 0 &&
			  H5Dread(l->set, l->type, in_memory, in_file, H5P_DEFAULT, l->item) >= 0;
		H5Sclose(in_memory);
		H5Sclose(in_file);
		l->first = i;
		l->held = ok ? count : 0;
		if (!ok)
			return NULL;
	}
	return l->item + (i - l->first) * l->table->size;
}

// ---- recorded samples

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
	return OB_MAKE_ROOM(r->recent, r->recents, r->recents_max) && r->values + width <= OB_SENSOR_NUMBERS_MAX &&
	       OB_RESERVE(r->value, r->values + width, r->values_max);
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
