#include "record/record.h"

#include <stdlib.h>
#include <string.h>

#include "record/file.h"
#include "record/objects.h"
#include "record/room.h"

enum { TIME, STEP, POSITION, ATTITUDE, VELOCITY, ANGULAR_VELOCITY, ASLEEP, COLUMNS };
enum { CHUNK_BYTES = 1 << 16, ABSENT = 255 };
enum { INDEX_BYTES = 1 << 18 }; // more than HDF5 adds to its indices of chunks with one append

// A dataset that grows by one row with each append.
static const struct column {
	ob_file_label label;
	int width; // numbers an object; 0: one number a row, of no object
} columns[COLUMNS] = {
	[TIME] = { { "time", "s", NULL, "simulated time of each recorded state" }, 0 },
	[STEP] = { { "step", "1", NULL, "steps completed at each recorded state" }, 0 },
	[POSITION] = { { "position", "m", "world, right-handed, z up", "centre of mass; NaN: no such object then" },
		       3 },
	[ATTITUDE] = { { "attitude", "1", "body to world", "unit quaternion w x y z; NaN: no such object then" }, 4 },
	[VELOCITY] = { { "velocity", "m/s", "world, right-handed, z up",
			 "of the centre of mass; NaN: no such object then" },
		       3 },
	[ANGULAR_VELOCITY] = { { "angular_velocity", "rad/s", "world, right-handed, z up", "NaN: no such object then" },
			       3 },
	[ASLEEP] = { { "asleep", "1", NULL, "1: at rest by consent of its island; 255: no such object then" }, 1 },
};

struct ob_recorder {
	char *path;
	hid_t file, set[COLUMNS]; // negative: not there
	ob_record_objects objects;
	ob_room room;
	uint64_t append_bytes; // at most, of one append
	uint32_t count; // objects
	hsize_t rows;
	double *numbers; // [count * 4], one row of one dataset
	uint8_t *asleep; // [count]
};

static hid_t type_of(int column)
{
	return column == STEP ? H5T_NATIVE_UINT64 : column == ASLEEP ? H5T_NATIVE_UINT8 : H5T_NATIVE_DOUBLE;
}

// Chunks of about 64 kB, at least one row and at most as many as one looks at in an instant: a file of few objects
// does not become one of many chunks. Not compressed: a chunk grows with each append, and packed anew each time it
// would leave holes behind.
static bool create_column(ob_recorder *r, int i)
{
	int width = columns[i].width, rank = !width ? 1 : width == 1 ? 2 : 3;
	hsize_t dims[3] = { 0, r->count, (hsize_t)width };
	hsize_t row = H5Tget_size(type_of(i)) * (width ? dims[1] * dims[2] : 1);
	hsize_t chunk = row < CHUNK_BYTES ? CHUNK_BYTES / row : 1;
	if (chunk > 1024)
		chunk = 1024;
	r->append_bytes += chunk * row;
	const double none = NAN;
	const uint8_t absent = ABSENT;
	const void *fill = i == ASLEEP ? (const void *)&absent : width ? &none : NULL;
	r->set[i] = ob_file_dataset(r->file, &columns[i].label, type_of(i), rank, dims, chunk, fill);
	return r->set[i] >= 0;
}

static bool describe(hid_t file, const ob_universe_info *info, const char *title)
{
	double gravity[3] = { info->gravity.x, info->gravity.y, info->gravity.z }, workers = info->workers;
	return ob_file_attribute_text(file, "obsim_version", OB_VERSION) &&
	       ob_file_attribute_text(file, "title", title) && ob_file_attribute_text(file, "universe", info->name) &&
	       ob_file_attribute_text(file, "arch", info->arch) &&
	       ob_file_attribute_text(file, "isolation", info->isolation) &&
	       ob_file_attribute_numbers(file, "gravity", gravity, 3) &&
	       ob_file_attribute_text(file, "gravity_units", "m/s^2") &&
	       ob_file_attribute_numbers(file, "step_length", &info->step_length, 1) &&
	       ob_file_attribute_text(file, "step_length_units", "s") &&
	       ob_file_attribute_numbers(file, "workers", &workers, 1);
}

static bool fill(ob_recorder *r, const ob_universe_info *info, const char *title)
{
	r->file = H5Fcreate(r->path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	if (r->file < 0 || !describe(r->file, info, title) || !ob_record_objects_create(&r->objects, r->file, r->count))
		return false;
	for (int i = 0; i < COLUMNS; i++)
		if (!create_column(r, i))
			return false;
	r->append_bytes += INDEX_BYTES + (uint64_t)r->count * sizeof(ob_passport);
	return H5Fflush(r->file, H5F_SCOPE_GLOBAL) >= 0 && ob_room_open(&r->room, r->path);
}

ob_recorder *ob_recorder_create(const char *path, const ob_universe_info *info, const char *scene_title, ob_error *e)
{
	ob_file_silence();
	ob_recorder *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "%s: no memory for a recorder", path);
		return NULL;
	}
	r->file = H5I_INVALID_HID;
	r->room.fd = -1;
	for (int i = 0; i < COLUMNS; i++)
		r->set[i] = H5I_INVALID_HID;
	r->count = info->capacity ? info->capacity : 1;
	r->path = strdup(path);
	r->numbers = calloc(r->count, 4 * sizeof *r->numbers);
	r->asleep = calloc(r->count, 1);
	if (!r->path || !r->numbers || !r->asleep)
		ob_fail(e, "%s: no memory to record %u objects", path, r->count);
	else if (fill(r, info, scene_title))
		return r;
	else
		ob_file_fail(e, path, "create the record");
	ob_recorder_close(r, NULL);
	return NULL;
}

static bool is_present(const ob_snapshot *s, uint32_t id)
{
	return id < s->count && s->passport[id].flags & OB_OBJECT_PRESENT;
}

// One object's numbers of one column.
static void extract(int column, const ob_state *s, double *to)
{
	ob_vec3 v = column == POSITION ? s->pose.p : column == VELOCITY ? s->v : s->w;
	ob_quat q = s->pose.q;
	if (column == ATTITUDE)
		memcpy(to, (double[]){ q.w, q.x, q.y, q.z }, 4 * sizeof *to);
	else
		memcpy(to, (double[]){ v.x, v.y, v.z }, 3 * sizeof *to);
}

// The row of one column, in memory of the snapshot or the recorder.
static const void *row_of(ob_recorder *r, int column, const ob_snapshot *s)
{
	int width = columns[column].width;
	if (column == TIME)
		return &s->time;
	if (column == STEP)
		return &s->step;
	for (uint32_t id = 0; id < r->count; id++) {
		bool there = is_present(s, id);
		if (column == ASLEEP) {
			r->asleep[id] = there ? (s->motion[id].flags & OB_MOTION_ASLEEP) != 0 : ABSENT;
			continue;
		}
		double *to = r->numbers + (size_t)width * id;
		for (int k = 0; !there && k < width; k++)
			to[k] = NAN;
		if (there) {
			ob_state state = ob_snapshot_state(s, id);
			extract(column, &state, to);
		}
	}
	return column == ASLEEP ? (const void *)r->asleep : r->numbers;
}

static bool append(ob_recorder *r, int column, const void *row)
{
	hsize_t width = (hsize_t)columns[column].width;
	hsize_t size[3] = { r->rows + 1, r->count, width }, from[3] = { r->rows, 0, 0 },
		one[3] = { 1, r->count, width };
	int rank = !width ? 1 : width == 1 ? 2 : 3;
	if (H5Dset_extent(r->set[column], size) < 0)
		return false;
	hid_t in_file = H5Dget_space(r->set[column]), in_memory = H5Screate_simple(rank, one, NULL);
	bool ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, from, NULL, one, NULL) >= 0 &&
		  H5Dwrite(r->set[column], type_of(column), in_memory, in_file, H5P_DEFAULT, row) >= 0;
	H5Sclose(in_memory);
	H5Sclose(in_file);
	return ok;
}

bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e)
{
	for (uint32_t id = r->count; id < s->count; id++)
		if (is_present(s, id))
			return ob_fail(e, "%s: object %u came up, but only %u were to be recorded", r->path, id, r->count);
	haddr_t used = 0;
	if (H5Fget_eoa(r->file, &used) >= 0 && !ob_room_ensure(&r->room, r->path, used, r->append_bytes, e))
		return false;
	bool ok = ob_record_objects_update(&r->objects, s);
	for (int i = 0; i < COLUMNS && ok; i++)
		ok = append(r, i, row_of(r, i, s));
	if (!ok || H5Fflush(r->file, H5F_SCOPE_GLOBAL) < 0)
		return ob_file_fail(e, r->path, "append to the record");
	r->rows++;
	return true;
}

bool ob_recorder_close(ob_recorder *r, ob_error *e)
{
	if (!r)
		return true;
	bool ok = true;
	for (int i = 0; i < COLUMNS; i++)
		if (r->set[i] >= 0)
			ok &= H5Dclose(r->set[i]) >= 0;
	if (r->objects.count)
		ok &= ob_record_objects_finish(&r->objects);
	if (r->file >= 0)
		ok &= H5Fclose(r->file) >= 0;
	ok &= ob_room_close(&r->room, ob_file_length(r->path));
	if (!ok)
		ob_file_fail(e, r->path, "close the record");
	free(r->path);
	free(r->numbers);
	free(r->asleep);
	free(r);
	return ok;
}
