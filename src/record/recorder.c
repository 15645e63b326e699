#include "record/record.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "record/hdf5_file.h"

// ---- preallocation

// HDF5 writes in place and in no order that would survive a disk that fills up half way: the file would be lost. So
// blocks are allocated before HDF5 needs them, and what is refused is refused while the file is whole.
typedef struct preallocation {
	int fd; // of our own, for this only; < 0: closed
	uint64_t bytes; // allocated to the file
} preallocation;

enum { PREALLOCATED_AT_ONCE = 4 << 20 }; // bytes

static bool open_preallocation(preallocation *p, const char *path)
{
	*p = (preallocation){ .fd = open(path, O_RDWR | O_CLOEXEC) };
	return p->fd >= 0;
}

// Allocates "more" bytes beyond the "used" ones; false and e with the system's reason.
static bool preallocate(preallocation *p, const char *path, uint64_t used, uint64_t more, ob_error *e)
{
	if (used + more <= p->bytes)
		return true;
	uint64_t want = used + more + PREALLOCATED_AT_ONCE;
	int error = posix_fallocate(p->fd, 0, (off_t)want);
	if (error) { // the last of a nearly full disk
		want = used + more;
		error = posix_fallocate(p->fd, 0, (off_t)want);
	}
	if (error && error != EINVAL && error != EOPNOTSUPP) // pipes and odd file systems: HDF5 will see
		return ob_fail(e, "%s: cannot append to the record: %s", path, strerror(error));
	p->bytes = want;
	return true;
}

// Gives back what lies beyond "used" bytes.
static bool close_preallocation(preallocation *p, uint64_t used)
{
	if (p->fd < 0)
		return true;
	bool ok = used == 0 || used >= p->bytes || ftruncate(p->fd, (off_t)used) == 0;
	ok &= close(p->fd) == 0;
	p->fd = -1;
	return ok;
}

// ---- /objects: what the recorded objects are

enum kind { INTEGER, NUMBER, VECTOR, NAME, SHAPE, FLAG };
enum { SHAPE_MAX = 12, FACTS = 10 };

// A fact of a passport and where it lies in it.
static const struct fact {
	ob_hdf5_label label;
	enum kind kind;
	size_t offset;
} facts[FACTS] = {
	{ { "id", "1", NULL, "index of the object in all datasets" }, INTEGER, offsetof(ob_passport, id) },
	{ { "generation", "1", NULL, "grows each time the id is given to another object" },
	  INTEGER,
	  offsetof(ob_passport, generation) },
	{ { "name", "1", NULL, "name given by the scene" }, NAME, offsetof(ob_passport, name) },
	{ { "shape", "1", NULL, "sphere, box, plane, capsule, cylinder; empty: no object" },
	  SHAPE,
	  offsetof(ob_passport, shape) },
	{ { "size", "m", "body",
	    "sphere: radius; box: half extents; capsule and cylinder: radius, half length along body z" },
	  VECTOR,
	  offsetof(ob_passport, size) },
	{ { "mass", "kg", NULL, "0: static" }, NUMBER, offsetof(ob_passport, mass) },
	{ { "inertia", "kg m^2", "body", "principal moments; 0: static" }, VECTOR, offsetof(ob_passport, inertia) },
	{ { "friction", "1", NULL, "Coulomb's coefficient; a pair uses the geometric mean" },
	  NUMBER,
	  offsetof(ob_passport, friction) },
	{ { "restitution", "1", NULL, "a pair uses the larger of the two" },
	  NUMBER,
	  offsetof(ob_passport, restitution) },
	{ { "static", "1", NULL, "1: never moves" }, FLAG, offsetof(ob_passport, flags) },
};

typedef struct objects {
	uint32_t count;
	hid_t group, set[FACTS]; // negative: not there
	ob_passport *written; // [count]
} objects;

static hid_t fact_type(enum kind kind)
{
	switch (kind) {
	case NAME:
		return ob_hdf5_string_type(OB_NAME_MAX);
	case SHAPE:
		return ob_hdf5_string_type(SHAPE_MAX);
	case NUMBER:
	case VECTOR:
		return H5Tcopy(H5T_NATIVE_DOUBLE);
	case INTEGER:
		return H5Tcopy(H5T_NATIVE_UINT32);
	case FLAG:
		break;
	}
	return H5Tcopy(H5T_NATIVE_UINT8);
}

static size_t fact_bytes(enum kind kind)
{
	static const size_t bytes[] = { 4, 8, 24, OB_NAME_MAX, SHAPE_MAX, 1 };
	return bytes[kind];
}

// o starts zeroed. false on failure; finish_objects is due either way.
static bool create_objects(objects *o, hid_t file, uint32_t count)
{
	o->count = count;
	for (int i = 0; i < FACTS; i++)
		o->set[i] = H5I_INVALID_HID;
	o->group = H5Gcreate2(file, "objects", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	o->written = calloc(count, sizeof *o->written);
	if (o->group < 0 || !o->written)
		return false;
	for (int i = 0; i < FACTS; i++) {
		hsize_t dims[2] = { count, 3 };
		hid_t type = fact_type(facts[i].kind);
		o->set[i] = ob_hdf5_dataset(o->group, &facts[i].label, type, facts[i].kind == VECTOR ? 2 : 1, dims, 0,
					    NULL);
		H5Tclose(type);
		if (o->set[i] < 0)
			return false;
	}
	return true;
}

static void copy_fact(const struct fact *f, const ob_passport *p, char *to)
{
	static const char shapes[][SHAPE_MAX] = { "", "sphere", "box", "plane", "capsule", "cylinder" };
	if (f->kind == SHAPE)
		memcpy(to, shapes[p->shape <= OB_SHAPE_CYLINDER ? p->shape : 0], SHAPE_MAX);
	else if (f->kind == FLAG)
		*to = (p->flags & OB_OBJECT_STATIC) != 0;
	else
		memcpy(to, (const char *)p + f->offset, fact_bytes(f->kind));
}

static bool write_fact(const objects *o, int i, char *buffer)
{
	hid_t type = fact_type(facts[i].kind);
	for (uint32_t id = 0; id < o->count; id++)
		copy_fact(&facts[i], &o->written[id], buffer + id * fact_bytes(facts[i].kind));
	bool ok = H5Dwrite(o->set[i], type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) >= 0;
	H5Tclose(type);
	return ok;
}

// Enters passports that are new or have changed.
static bool update_objects(objects *o, const ob_snapshot *s)
{
	bool changed = false, ok = true;
	for (uint32_t id = 0; id < o->count; id++) {
		// an object that has gone stays entered: its past is in the file
		if (id >= s->count || !(s->passport[id].flags & OB_OBJECT_PRESENT) ||
		    memcmp(&o->written[id], &s->passport[id], sizeof *o->written) == 0)
			continue;
		o->written[id] = s->passport[id];
		changed = true;
	}
	if (!changed)
		return true;
	char *buffer = malloc((size_t)o->count * OB_NAME_MAX);
	for (int i = 0; i < FACTS && ok; i++)
		ok = buffer && write_fact(o, i, buffer);
	free(buffer);
	return ok;
}

static bool finish_objects(objects *o)
{
	bool ok = true;
	for (int i = 0; i < FACTS; i++)
		if (o->set[i] > 0)
			ok &= H5Dclose(o->set[i]) >= 0;
	if (o->group > 0)
		ok &= H5Gclose(o->group) >= 0;
	free(o->written);
	return ok;
}

// ---- the recorder

enum { TIME, STEP, POSITION, ATTITUDE, VELOCITY, ANGULAR_VELOCITY, ASLEEP, COLUMNS };
enum { CHUNK_BYTES = 1 << 16, ABSENT = 255 };
enum { INDEX_BYTES = 1 << 18 }; // more than HDF5 adds to its indices of chunks with one append

// A dataset that grows by one row with each append.
static const struct column {
	ob_hdf5_label label;
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
	objects objects;
	preallocation allocated;
	uint64_t append_bytes; // at most, of one append
	uint32_t count; // objects
	hsize_t rows;
	double *numbers; // [count * 4], one row of one dataset
	uint8_t *asleep; // [count]
};

static hid_t column_type(int column)
{
	return column == STEP ? H5T_NATIVE_UINT64 : column == ASLEEP ? H5T_NATIVE_UINT8 : H5T_NATIVE_DOUBLE;
}

// Chunks of about 64 kB, of at least one row and at most 1024: a file of few objects does not become one of many chunks. Not compressed: a chunk grows with each append, and packed anew each time it
// would leave holes behind.
static bool create_column(ob_recorder *r, int i)
{
	int width = columns[i].width, rank = !width ? 1 : width == 1 ? 2 : 3;
	hsize_t dims[3] = { 0, r->count, (hsize_t)width };
	hsize_t row = H5Tget_size(column_type(i)) * (width ? dims[1] * dims[2] : 1);
	hsize_t chunk = row < CHUNK_BYTES ? CHUNK_BYTES / row : 1;
	if (chunk > 1024)
		chunk = 1024;
	r->append_bytes += chunk * row;
	const double none = NAN;
	const uint8_t absent = ABSENT;
	const void *fill = i == ASLEEP ? (const void *)&absent : width ? &none : NULL;
	r->set[i] = ob_hdf5_dataset(r->file, &columns[i].label, column_type(i), rank, dims, chunk, fill);
	return r->set[i] >= 0;
}

static bool write_attributes(hid_t file, const ob_universe_info *info, const char *title)
{
	double gravity[3] = { info->gravity.x, info->gravity.y, info->gravity.z }, workers = info->workers;
	return ob_hdf5_attribute_text(file, "obsim_version", OB_VERSION) &&
	       ob_hdf5_attribute_text(file, "title", title) && ob_hdf5_attribute_text(file, "universe", info->name) &&
	       ob_hdf5_attribute_text(file, "arch", info->arch) &&
	       ob_hdf5_attribute_text(file, "isolation", info->isolation) &&
	       ob_hdf5_attribute_numbers(file, "gravity", gravity, 3) &&
	       ob_hdf5_attribute_text(file, "gravity_units", "m/s^2") &&
	       ob_hdf5_attribute_numbers(file, "step_length", &info->step_length, 1) &&
	       ob_hdf5_attribute_text(file, "step_length_units", "s") &&
	       ob_hdf5_attribute_numbers(file, "workers", &workers, 1);
}

static bool create_file(ob_recorder *r, const ob_universe_info *info, const char *title)
{
	r->file = H5Fcreate(r->path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	if (r->file < 0 || !write_attributes(r->file, info, title) || !create_objects(&r->objects, r->file, r->count))
		return false;
	for (int i = 0; i < COLUMNS; i++)
		if (!create_column(r, i))
			return false;
	r->append_bytes += INDEX_BYTES + (uint64_t)r->count * sizeof(ob_passport);
	return H5Fflush(r->file, H5F_SCOPE_GLOBAL) >= 0 && open_preallocation(&r->allocated, r->path);
}

ob_recorder *ob_recorder_create(const char *path, const ob_universe_info *info, const char *scene_title, ob_error *e)
{
	ob_hdf5_silence();
	ob_recorder *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "%s: no memory for a recorder", path);
		return NULL;
	}
	r->file = H5I_INVALID_HID;
	r->allocated.fd = -1;
	for (int i = 0; i < COLUMNS; i++)
		r->set[i] = H5I_INVALID_HID;
	r->count = info->capacity ? info->capacity : 1;
	r->path = strdup(path);
	r->numbers = calloc(r->count, 4 * sizeof *r->numbers);
	r->asleep = calloc(r->count, 1);
	if (!r->path || !r->numbers || !r->asleep)
		ob_fail(e, "%s: no memory to record %u objects", path, r->count);
	else if (create_file(r, info, scene_title))
		return r;
	else
		ob_hdf5_fail(e, path, "create the record");
	ob_recorder_close(r, NULL);
	return NULL;
}

static bool is_present(const ob_snapshot *s, uint32_t id)
{
	return id < s->count && s->passport[id].flags & OB_OBJECT_PRESENT;
}

// One object's numbers of one column.
static void copy_vector(int column, const ob_state *s, double *to)
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
			copy_vector(column, &state, to);
		}
	}
	return column == ASLEEP ? (const void *)r->asleep : r->numbers;
}

static bool append_row(ob_recorder *r, int column, const void *row)
{
	hsize_t width = (hsize_t)columns[column].width;
	hsize_t size[3] = { r->rows + 1, r->count, width }, from[3] = { r->rows, 0, 0 },
		one[3] = { 1, r->count, width };
	int rank = !width ? 1 : width == 1 ? 2 : 3;
	if (H5Dset_extent(r->set[column], size) < 0)
		return false;
	hid_t in_file = H5Dget_space(r->set[column]), in_memory = H5Screate_simple(rank, one, NULL);
	bool ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, from, NULL, one, NULL) >= 0 &&
		  H5Dwrite(r->set[column], column_type(column), in_memory, in_file, H5P_DEFAULT, row) >= 0;
	H5Sclose(in_memory);
	H5Sclose(in_file);
	return ok;
}

bool ob_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e)
{
	for (uint32_t id = r->count; id < s->count; id++)
		if (is_present(s, id))
			return ob_fail(e, "%s: object %u came up, but only %u were to be recorded", r->path, id,
				       r->count);
	haddr_t used = 0;
	if (H5Fget_eoa(r->file, &used) >= 0 && !preallocate(&r->allocated, r->path, used, r->append_bytes, e))
		return false;
	bool ok = update_objects(&r->objects, s);
	for (int i = 0; i < COLUMNS && ok; i++)
		ok = append_row(r, i, row_of(r, i, s));
	if (!ok || H5Fflush(r->file, H5F_SCOPE_GLOBAL) < 0)
		return ob_hdf5_fail(e, r->path, "append to the record");
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
		ok &= finish_objects(&r->objects);
	if (r->file >= 0)
		ok &= H5Fclose(r->file) >= 0;
	ok &= close_preallocation(&r->allocated, ob_hdf5_length(r->path));
	if (!ok)
		ob_hdf5_fail(e, r->path, "close the record");
	free(r->path);
	free(r->numbers);
	free(r->asleep);
	free(r);
	return ok;
}
