#include "base/allocate.h"
#include "record/part.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "record/layout.h"
#include "shape/shape.h"

// ---- preallocation

// HDF5 writes in place, in an order that does not survive a full disk: the file would be lost. So blocks are allocated
// before HDF5 needs them, and a failed allocation leaves the file whole.
typedef struct preallocation {
	int fd; // opened for this only; < 0: closed
	uint64_t bytes; // allocated to the file
} preallocation;

enum { PREALLOCATED_AT_ONCE = 4 << 20 }; // bytes

static bool open_preallocation(preallocation *p, const char *path)
{
	*p = (preallocation){ .fd = open(path, O_RDWR | O_CLOEXEC) };
	return p->fd >= 0;
}

// Allocates "more" bytes beyond "used"; false and e with the system's reason.
static bool preallocate(preallocation *p, const char *path, uint64_t used, uint64_t more, ob_error *e)
{
	if (used + more <= p->bytes)
		return true;
	uint64_t want = used + more + PREALLOCATED_AT_ONCE;
	int error = posix_fallocate(p->fd, 0, (off_t)want);
	if (error) { // the last bytes of a nearly full disk
		want = used + more;
		error = posix_fallocate(p->fd, 0, (off_t)want);
	}
	if (error && error != EINVAL && error != EOPNOTSUPP) // pipes and unusual file systems: HDF5 will report errors
		return ob_fail(e, "%s: cannot append to the record: %s", path, strerror(error));
	p->bytes = want;
	return true;
}

// Frees the bytes beyond "used".
static bool close_preallocation(preallocation *p, uint64_t used)
{
	if (p->fd < 0)
		return true;
	bool ok = used == 0 || used >= p->bytes || ftruncate(p->fd, (off_t)used) == 0;
	ok &= close(p->fd) == 0;
	p->fd = -1;
	return ok;
}

// ---- /objects: properties of the recorded objects

enum kind { INTEGER, NUMBER, VECTOR, NAME, SHAPE, FLAG };
enum { SHAPE_MAX = 12, FACTS = 10 };
enum { IDS_AT_ONCE = 8 }; // at least, in a chunk of a dataset that may grow by ids

// A fact of a passport, and its offset there.
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
	{ { "shape", "1", NULL, "one of" OB_SHAPE_NAMES "; empty: no object" }, SHAPE, offsetof(ob_passport, shape) },
	{ { "size", "m", "body",
	    "sphere: radius; box: half extents; capsule and cylinder: radius, half length along body z; "
	    "hull: radius of the ball that holds it, half its least width, radius of the ball in it" },
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
	hid_t group, set[FACTS]; // negative: missing
	ob_passport *written; // [count]: the latest object of each id, even after its removal
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
	for (int i = 0; i < FACTS; i++)
		o->set[i] = H5I_INVALID_HID;
	o->group = H5Gcreate2(file, "objects", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	o->written = calloc(count, sizeof *o->written);
	if (o->group < 0 || !o->written)
		return false;
	o->count = count;
	for (int i = 0; i < FACTS; i++) {
		hsize_t dims[2] = { count, 3 };
		hid_t type = fact_type(facts[i].kind);
		o->set[i] = ob_hdf5_dataset(o->group, &facts[i].label, type, facts[i].kind == VECTOR ? 2 : 1, dims,
					    count < IDS_AT_ONCE ? IDS_AT_ONCE : count, 0, NULL);
		H5Tclose(type);
		if (o->set[i] < 0)
			return false;
	}
	return true;
}

static void copy_fact(const struct fact *f, const ob_passport *p, char *to)
{
	if (f->kind == SHAPE)
		strncpy(to, ob_shape_name((ob_shape)p->shape), SHAPE_MAX);
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

// Adds columns without objects.
static bool grow_objects(objects *o, uint32_t count)
{
	if (!OB_GROW_CLEARED(o->written, o->count, count))
		return false;
	o->count = count;
	bool ok = true;
	for (int i = 0; i < FACTS && ok; i++)
		ok = H5Dset_extent(o->set[i], (hsize_t[2]){ count, 3 }) >= 0;
	return ok;
}

static bool write_objects(const objects *o)
{
	bool ok = true;
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

// ---- lists of compounds: events and motions

enum { LIST_CHUNK = 1 << 16 }; // bytes

typedef struct list {
	const ob_record_table *table;
	hid_t set, type; // negative: missing; type: in memory
	size_t bytes; // of one element, in the file
	hsize_t rows;
	hsize_t chunk; // rows
} list;

// A list that is not created yet, but may be finished.
static list list_of(const ob_record_table *table)
{
	return (list){ .table = table, .set = H5I_INVALID_HID, .type = H5I_INVALID_HID };
}

static bool create_list(list *l, hid_t file)
{
	hid_t packed = ob_record_type_in_file(l->table);
	l->type = ob_record_type_in_memory(l->table);
	l->bytes = H5Tget_size(packed);
	l->chunk = LIST_CHUNK / l->bytes;
	l->set = ob_hdf5_dataset(file, &l->table->label, packed, 1, (hsize_t[1]){ 0 }, l->chunk, 0, NULL);
	H5Tclose(packed);
	return l->set >= 0;
}

static bool append_list(list *l, const void *items, hsize_t count)
{
	if (count == 0)
		return true;
	hsize_t size = l->rows + count;
	if (H5Dset_extent(l->set, &size) < 0)
		return false;
	hid_t in_file = H5Dget_space(l->set), in_memory = H5Screate_simple(1, &count, NULL);
	bool ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, &l->rows, NULL, &count, NULL) >= 0 &&
		  H5Dwrite(l->set, l->type, in_memory, in_file, H5P_DEFAULT, items) >= 0;
	H5Sclose(in_memory);
	H5Sclose(in_file);
	l->rows += count;
	return ok;
}

static uint64_t chunks(uint64_t count, uint64_t in_chunk)
{
	return (count + in_chunk - 1) / in_chunk;
}

// Bytes of the chunks that count more elements begin.
static uint64_t list_bytes(const list *l, uint64_t count)
{
	return (chunks(l->rows + count, l->chunk) - chunks(l->rows, l->chunk)) * l->chunk * l->bytes;
}

static bool finish_list(list *l)
{
	bool ok = l->set < 0 || H5Dclose(l->set) >= 0;
	if (l->type >= 0)
		H5Tclose(l->type);
	return ok;
}

// ---- the recorder

enum { TIME, STEP, MOTIONS_UNTIL, POSITION, ATTITUDE, VELOCITY, ANGULAR_VELOCITY, ASLEEP, COLUMNS };
enum { CHUNK_BYTES = 1 << 16, ABSENT = 255 };
enum { INDEX_BYTES = 1 << 18 }; // upper bound of the growth of HDF5's chunk indices in one append

// A dataset that grows by one row with each append.
static const struct column {
	ob_hdf5_label label;
	int width; // numbers an object; 0: one number a row, of no object
} columns[COLUMNS] = {
	[TIME] = { { "time", "s", NULL, "simulated time of each recorded state" }, 0 },
	[STEP] = { { "step", "1", NULL, "steps completed at each recorded state" }, 0 },
	[MOTIONS_UNTIL] = { { "motions_until", "1", NULL, "how many of /motions are known at each recorded state" },
			    0 },
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
	ob_record_base base;
	char *path;
	hid_t file, set[COLUMNS]; // negative: missing
	objects objects;
	list events, motions, hulls, joints, samples, pixels;
	preallocation allocated;
	hsize_t chunk_ids, chunk_rows[COLUMNS]; // in a chunk of the columns
	uint32_t written_count; // ids in the previous row, 0: there is none
	uint32_t count; // ids that have columns
	hsize_t rows;
	bool failed;
	double *numbers; // [count * 4], one row of one dataset
	uint8_t *asleep; // [count]
	ob_record_motion *known; // [count]: last written motion of each id, zeroed where unused
	ob_record_motion *fresh; // [count]: new motions of a row
	ob_record_event *event; // [count * 2]
	uint32_t known_hulls;
	bool *knows_hull; // [known_hulls]: true if it is in the file
	uint32_t known_joints;
	ob_joint_passport *joint; // [known_joints]: as in the file now, by number; zeroed where unused
	ob_record_joint *fresh_joint; // [known_joints * 2]
	uint32_t sensors;
	uint64_t *sensed; // [sensors]: number of the last sample in the file
	uint64_t *sample_number; // these three hold samples of a sensor while they are written
	double *sample_time, *sample_value;
	ob_record_sample *fresh_sample;
};

static hid_t column_type(int column)
{
	return column == STEP || column == MOTIONS_UNTIL ? H5T_NATIVE_UINT64
	       : column == ASLEEP                        ? H5T_NATIVE_UINT8
							 : H5T_NATIVE_DOUBLE;
}

// Creates a column in chunks of about 64 kB, with at least one row and at most 1024, so that a file of few objects has
// few chunks. Not compressed: a chunk grows with each append, and repacking it each time would leave holes.
static bool create_column(ob_recorder *r, int i)
{
	int width = columns[i].width, rank = !width ? 1 : width == 1 ? 2 : 3;
	hsize_t dims[3] = { 0, r->count, (hsize_t)width };
	hsize_t ids = r->chunk_ids;
	hsize_t row = H5Tget_size(column_type(i)) * (width ? ids * dims[2] : 1);
	hsize_t chunk = row < CHUNK_BYTES ? CHUNK_BYTES / row : 1;
	if (chunk > 1024)
		chunk = 1024;
	r->chunk_rows[i] = chunk;
	const double none = NAN;
	const uint8_t absent = ABSENT;
	const void *fill = i == ASLEEP ? (const void *)&absent : width ? &none : NULL;
	r->set[i] =
		ob_hdf5_dataset(r->file, &columns[i].label, column_type(i), rank, dims, chunk, width ? ids : 0, fill);
	return r->set[i] >= 0;
}

static bool write_text(hid_t file, const char *name, const char *description, const char *text, size_t size)
{
	hid_t type = ob_hdf5_string_type(size ? size : 1), space = H5Screate(H5S_SCALAR);
	hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, size ? text : "") >= 0 &&
		  ob_hdf5_attribute_text(set, "units", "1") && ob_hdf5_attribute_text(set, "description", description);
	if (set >= 0)
		ok &= H5Dclose(set) >= 0;
	H5Sclose(space);
	H5Tclose(type);
	return ok;
}

// Writes the scene's parameters, a line each.
static bool write_parameters(hid_t file, const ob_scene_options *o)
{
	size_t size = 0, at = 0;
	for (uint32_t i = 0; i < o->define_count; i++)
		size += strlen(o->defines[i]) + 1;
	char *text = malloc(size + 1);
	for (uint32_t i = 0; text && i < o->define_count; i++)
		at += (size_t)sprintf(text + at, "%s\n", o->defines[i]);
	bool ok = text &&
		  write_text(file, "parameters", "of the scene, as given by -D: NAME=VALUE, a line each", text, size);
	free(text);
	return ok;
}

// Writes a dataset of a table as a whole.
static bool write_table(hid_t file, const ob_record_table *table, const void *items, hsize_t count)
{
	hid_t packed = ob_record_type_in_file(table), type = ob_record_type_in_memory(table);
	hid_t set = ob_hdf5_dataset(file, &table->label, packed, 1, &count, 0, 0, NULL);
	bool ok = set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, items) >= 0;
	if (set >= 0)
		ok &= H5Dclose(set) >= 0;
	H5Tclose(type);
	H5Tclose(packed);
	return ok;
}

static bool write_image(hid_t images, uint32_t number, const ob_mesh_image *image)
{
	char name[16];
	const hsize_t size[3] = { image->height, image->width, 4 };
	snprintf(name, sizeof name, "%u", number);
	const ob_hdf5_label label = { name, "1", NULL, "red, green, blue, alpha, the top row first" };
	hid_t set = ob_hdf5_dataset(images, &label, H5T_NATIVE_UINT8, 3, size, 0, 0, NULL);
	bool ok = set >= 0 && H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, image->rgba) >= 0;
	return set >= 0 && H5Dclose(set) >= 0 && ok;
}

static bool write_images(hid_t group, const ob_mesh *m)
{
	if (m->images == 0)
		return true;
	hid_t images = H5Gcreate2(group, "images", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = images >= 0 && write_table(group, &ob_record_mesh_parts, m->part, m->parts);
	for (uint32_t i = 0; i < m->images && ok; i++)
		ok = write_image(images, i + 1, &m->image[i]);
	return images >= 0 && H5Gclose(images) >= 0 && ok;
}

static bool write_mesh(hid_t meshes, uint32_t number, const ob_mesh *m)
{
	char name[16];
	snprintf(name, sizeof name, "%u", number);
	hid_t group = H5Gcreate2(meshes, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = group >= 0 && write_table(group, &ob_record_mesh_vertices, m->vertex, m->vertices) &&
		  write_table(group, &ob_record_mesh_triangles, m->index, m->indices / 3) && write_images(group, m);
	return group >= 0 && H5Gclose(group) >= 0 && ok;
}

static bool write_meshes(hid_t file, const ob_scene *s)
{
	if (s->meshes == 0)
		return true;
	hid_t meshes = H5Gcreate2(file, "meshes", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = meshes >= 0;
	for (uint32_t i = 0; i < s->meshes && ok; i++)
		ok = write_mesh(meshes, i + 1, &s->mesh[i]);
	return meshes >= 0 && H5Gclose(meshes) >= 0 && ok;
}

static bool write_settings(hid_t file, const ob_run_settings *s)
{
	hid_t group = H5Gcreate2(file, "settings", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = group >= 0;
	for (int i = 0; i < OB_RUN_SETTINGS && ok; i++) {
		const ob_setting *one = &ob_setting_table[i];
		const void *at = (const char *)s + one->offset;
		uint32_t count = 0;
		if (one->kind == OB_SETTING_REAL) {
			ok = ob_hdf5_attribute_numbers(group, one->name, at, 1);
		} else if (one->kind == OB_SETTING_COUNT) {
			memcpy(&count, at, sizeof count);
			ok = ob_hdf5_attribute_count(group, one->name, count);
		} else {
			ok = ob_hdf5_attribute_text(group, one->name, ob_setting_print(s, (ob_setting_id)i).text);
		}
	}
	return group >= 0 && H5Gclose(group) >= 0 && ok;
}

static bool write_attributes(hid_t file, const ob_record_facts *f)
{
	const ob_universe_info *info = &f->universe;
	double gravity[3] = { info->gravity.x, info->gravity.y, info->gravity.z }, workers = info->workers;
	char now[32];
	time_t seconds = time(NULL);
	struct tm utc;
	strftime(now, sizeof now, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &utc));
	return ob_hdf5_attribute_text(file, "format", OB_RECORD_FORMAT) &&
	       ob_hdf5_attribute_count(file, "format_version", OB_RECORD_VERSION) &&
	       ob_hdf5_attribute_text(file, "obsim_version", OB_VERSION) &&
	       ob_hdf5_attribute_text(file, "obsim_commit", f->commit) &&
	       ob_hdf5_attribute_text(file, "created", now) && ob_hdf5_attribute_text(file, "title", f->scene->title) &&
	       ob_hdf5_attribute_text(file, "scene_file", f->path) &&
	       ob_hdf5_attribute_count(file, "seed", f->options->has_seed ? f->options->seed : f->scene->seed) &&
	       ob_hdf5_attribute_numbers(file, "duration", &f->duration, 1) &&
	       ob_hdf5_attribute_text(file, "duration_units", "s") &&
	       ob_hdf5_attribute_count(file, "record_every", f->scene->record_every) &&
	       ob_hdf5_attribute_text(file, "universe", info->name) &&
	       ob_hdf5_attribute_text(file, "arch", info->arch) &&
	       ob_hdf5_attribute_text(file, "isolation", info->isolation) &&
	       ob_hdf5_attribute_numbers(file, "gravity", gravity, 3) &&
	       ob_hdf5_attribute_text(file, "gravity_units", "m/s^2") &&
	       ob_hdf5_attribute_numbers(file, "step_length", &info->step_length, 1) &&
	       ob_hdf5_attribute_text(file, "step_length_units", "s") &&
	       ob_hdf5_attribute_numbers(file, "workers", &workers, 1);
}

static bool write_facts(hid_t file, const ob_record_facts *f)
{
	return write_attributes(file, f) && write_settings(file, f->settings) &&
	       write_text(file, "scene", "the scene's file (Lua)", f->scene->text, f->scene->text_size) &&
	       write_parameters(file, f->options) &&
	       write_table(file, &ob_record_cameras, f->scene->camera, f->scene->cameras) &&
	       write_table(file, &ob_record_look, &f->scene->look, 1) && write_meshes(file, f->scene);
}

static bool create_file(ob_recorder *r, const ob_record_facts *about)
{
	r->file = H5Fcreate(r->path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	if (r->file < 0 || !write_facts(r->file, about) || !create_objects(&r->objects, r->file, r->count) ||
	    !create_list(&r->events, r->file) || !create_list(&r->motions, r->file) ||
	    !create_list(&r->hulls, r->file) || !create_list(&r->joints, r->file))
		return false;
	if (r->sensors && (!create_list(&r->samples, r->file) || !create_list(&r->pixels, r->file) ||
			   !write_table(r->file, &ob_record_sensors, about->scene->sensor, r->sensors)))
		return false;
	r->chunk_ids = r->count < IDS_AT_ONCE ? IDS_AT_ONCE : r->count;
	for (int i = 0; i < COLUMNS; i++)
		if (!create_column(r, i))
			return false;
	return H5Fflush(r->file, H5F_SCOPE_GLOBAL) >= 0 && open_preallocation(&r->allocated, r->path);
}

// Grows the arrays in memory to this number of ids.
static bool make_room(ob_recorder *r, uint32_t count)
{
	if (!OB_GROW(r->numbers, 4 * (size_t)count) || !OB_GROW(r->asleep, count) || !OB_GROW(r->fresh, count) ||
	    !OB_GROW(r->event, 2 * (size_t)count) || !OB_GROW_CLEARED(r->known, r->count, count))
		return false;
	r->count = count;
	return true;
}

ob_recorder *ob_hdf5_recorder_create(const char *path, const ob_record_facts *about, ob_error *e)
{
	ob_hdf5_silence();
	ob_recorder *r = calloc(1, sizeof *r);
	if (!r) {
		ob_fail(e, "%s: no memory for a recorder", path);
		return NULL;
	}
	r->file = H5I_INVALID_HID;
	r->allocated.fd = -1;
	r->events = list_of(&ob_record_events);
	r->motions = list_of(&ob_record_motions);
	r->hulls = list_of(&ob_record_hulls);
	r->joints = list_of(&ob_record_joints);
	r->samples = list_of(&ob_record_samples);
	r->pixels = list_of(&ob_record_pixels);
	r->sensors = about->scene->sensors;
	r->sensed = calloc(r->sensors + 1, sizeof *r->sensed);
	for (int i = 0; i < COLUMNS; i++)
		r->set[i] = H5I_INVALID_HID;
	uint32_t count = about->universe.capacity ? about->universe.capacity : 1;
	r->path = strdup(path);
	if (!r->path || !r->sensed || !make_room(r, count))
		ob_fail(e, "%s: no memory to record %u objects", path, count);
	else if (create_file(r, about))
		return r;
	else
		ob_hdf5_fail(e, path, "create the record");
	r->failed = true;
	ob_hdf5_recorder_close(r, NULL);
	return NULL;
}

// ---- new entries

static bool is_present(const ob_snapshot *s, uint32_t id)
{
	return id < s->count && s->passport[id].flags & OB_OBJECT_PRESENT;
}

static bool is_same_object(const ob_passport *a, const ob_passport *b)
{
	return a->flags & b->flags & OB_OBJECT_PRESENT && a->generation == b->generation;
}

static void note_event(ob_recorder *r, const ob_snapshot *s, ob_record_event_kind kind, const ob_passport *p,
		       hsize_t *events)
{
	r->event[(*events)++] = (ob_record_event){ .step = s->step, .time = s->time, .kind = kind, .passport = *p };
}

// Appends new, changed and removed passports.
static bool append_events(ob_recorder *r, const ob_snapshot *s)
{
	hsize_t events = 0;
	bool changed = false;
	for (uint32_t id = 0; id < r->count; id++) {
		ob_passport *known = &r->objects.written[id];
		const ob_passport *now = is_present(s, id) ? &s->passport[id] : NULL;
		bool same = now && is_same_object(known, now), was = known->flags & OB_OBJECT_PRESENT;
		if (was && !same) {
			note_event(r, s, OB_RECORD_REMOVED, known, &events);
			known->flags &= ~(uint32_t)OB_OBJECT_PRESENT; // the old passport stays: its past is in the file
		}
		if (now && !same)
			memset(&r->known[id], 0, sizeof r->known[id]);
		if (!now || memcmp(known, now, sizeof *known) == 0)
			continue;
		note_event(r, s, same ? OB_RECORD_CHANGED : OB_RECORD_CREATED, now, &events);
		*known = *now;
		changed = true;
	}
	return append_list(&r->events, r->event, events) && (!changed || write_objects(&r->objects));
}

static bool is_new_hull(const ob_recorder *r, const ob_snapshot *s, uint32_t hull)
{
	return s->hull[hull] && !(hull < r->known_hulls && r->knows_hull[hull]);
}

static uint32_t count_new_hulls(const ob_recorder *r, const ob_snapshot *s)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->hulls; i++)
		count += is_new_hull(r, s, i);
	return count;
}

// Appends hulls when objects have them for the first time.
static bool append_hulls(ob_recorder *r, const ob_snapshot *s)
{
	bool ok = true;
	if (s->hulls > r->known_hulls) {
		if (!OB_GROW_CLEARED(r->knows_hull, r->known_hulls, s->hulls))
			return false;
		r->known_hulls = s->hulls;
	}
	for (uint32_t i = 0; i < s->hulls && ok; i++) {
		if (!is_new_hull(r, s, i))
			continue;
		ob_record_hull now = { .number = i, .hull = *s->hull[i] };
		ok = append_list(&r->hulls, &now, 1);
		r->knows_hull[i] = true;
	}
	return ok;
}

// Grows the arrays in memory to the snapshot's joints.
static bool make_room_for_joints(ob_recorder *r, uint32_t joints)
{
	if (joints <= r->known_joints)
		return true;
	if (!OB_GROW_CLEARED(r->joint, r->known_joints, joints) || !OB_GROW(r->fresh_joint, 2 * (size_t)joints))
		return false;
	r->known_joints = joints;
	return true;
}

// The recorded members of a joint's passport; all zero: there is none of this number.
static ob_joint_passport recorded_joint(const ob_snapshot *s, uint32_t joint)
{
	ob_joint_passport p = { .kind = 0 };
	if (!ob_snapshot_has_joint(s, joint))
		return p;
	p = s->joint[joint];
	p.axis = p.second = (ob_joint_axis){ .low = 0 };
	p.breaks_force = p.breaks_torque = 0;
	return p;
}

static bool is_same_joint(const ob_joint_passport *a, ob_joint_passport b)
{
	b.flags = (b.flags & ~(uint32_t)OB_JOINT_BROKEN) | (a->flags & OB_JOINT_BROKEN);
	return ob_joint_exists(a) && memcmp(a, &b, sizeof b) == 0;
}

static void note_joint(ob_recorder *r, const ob_snapshot *s, ob_record_event_kind kind, uint32_t number,
		       const ob_joint_passport *p, hsize_t *joints)
{
	r->fresh_joint[(*joints)++] = (ob_record_joint){ s->step, s->time, kind, number, *p };
}

// Appends joints that have come, broken or gone.
static bool append_joints(ob_recorder *r, const ob_snapshot *s)
{
	hsize_t joints = 0;
	for (uint32_t i = 0; i < r->known_joints; i++) {
		ob_joint_passport *known = &r->joint[i], now = recorded_joint(s, i);
		if (memcmp(known, &now, sizeof now) == 0)
			continue;
		const bool same = is_same_joint(known, now);
		if (!same && ob_joint_exists(known))
			note_joint(r, s, OB_RECORD_REMOVED, i, known, &joints);
		if (ob_joint_exists(&now))
			note_joint(r, s, same ? OB_RECORD_CHANGED : OB_RECORD_CREATED, i, &now, &joints);
		*known = now;
	}
	return append_list(&r->joints, r->fresh_joint, joints);
}

// The recorded members of a motion.
static ob_record_motion recorded(uint32_t id, const ob_motion *m)
{
	const bool swings = m->flags & OB_MOTION_SWINGS;
	return (ob_record_motion){ .id = id,
				   .island = swings ? id : m->island,
				   .motion = { .t0 = m->t0,
					       .valid_until = m->valid_until,
					       .p = m->p,
					       .q = m->q,
					       .v = m->v,
					       .w = m->w,
					       .a = m->a,
					       .frequency = swings ? m->frequency : 0,
					       .substeps = m->substeps,
					       .flags = m->flags } };
}

static bool append_motions(ob_recorder *r, const ob_snapshot *s)
{
	hsize_t motions = 0;
	for (uint32_t id = 0; id < r->count; id++) {
		if (!is_present(s, id))
			continue;
		ob_record_motion now = recorded(id, &s->motion[id]);
		if (memcmp(&now, &r->known[id], sizeof now) == 0)
			continue;
		r->known[id] = now;
		r->fresh[motions++] = now;
	}
	return append_list(&r->motions, r->fresh, motions);
}

// ---- columns

// Copies one object's numbers for one column.
static void copy_vector(int column, const ob_state *s, double *to)
{
	ob_vec3 v = column == POSITION ? s->pose.p : column == VELOCITY ? s->v : s->w;
	ob_quat q = s->pose.q;
	if (column == ATTITUDE)
		memcpy(to, (double[]){ q.w, q.x, q.y, q.z }, 4 * sizeof *to);
	else
		memcpy(to, (double[]){ v.x, v.y, v.z }, 3 * sizeof *to);
}

// Returns the row of one column, in memory of the snapshot or the recorder.
static const void *row_of(ob_recorder *r, int column, const ob_snapshot *s)
{
	int width = columns[column].width;
	if (column == TIME)
		return &s->time;
	if (column == STEP)
		return &s->step;
	if (column == MOTIONS_UNTIL)
		return &r->motions.rows;
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

// Bytes of the chunks that one more row begins.
static uint64_t row_bytes(const ob_recorder *r)
{
	uint64_t bytes = 0;
	for (int i = 0; i < COLUMNS; i++) {
		const uint64_t width = (uint64_t)columns[i].width, ids = width ? r->chunk_ids : 1;
		const uint64_t all = width ? chunks(r->count, ids) : 1,
			       before = width ? chunks(r->written_count, ids) : 1;
		const uint64_t begun = r->rows % r->chunk_rows[i] == 0 ? all : all - before;
		bytes += begun * r->chunk_rows[i] * ids * (width ? width : 1) * H5Tget_size(column_type(i));
	}
	return bytes;
}

// Grows the columns to the number of objects.
static bool grow(ob_recorder *r, const ob_snapshot *s)
{
	uint32_t count = s->count;
	while (count > r->count && !is_present(s, count - 1))
		count--;
	return make_room_for_joints(r, s->joints) &&
	       (count <= r->count || (grow_objects(&r->objects, count) && make_room(r, count)));
}

static bool append(ob_recorder *r, const ob_snapshot *s, ob_error *e)
{
	haddr_t used = 0;
	if (!grow(r, s))
		return ob_fail(e, "%s: no memory to record %u objects", r->path, s->count);
	if (r->rows == OB_RECORD_STATES_MAX)
		return ob_fail(e, "%s: a record has room for %d states: record { every = N } records fewer", r->path,
			       OB_RECORD_STATES_MAX);
	uint64_t more = row_bytes(r) + list_bytes(&r->events, 2 * r->count) + list_bytes(&r->motions, r->count) +
			list_bytes(&r->hulls, count_new_hulls(r, s)) + list_bytes(&r->joints, 2 * r->known_joints) +
			INDEX_BYTES + r->count * sizeof(ob_passport);
	if (H5Fget_eoa(r->file, &used) >= 0 && !preallocate(&r->allocated, r->path, used, more, e))
		return false;
	bool ok = append_hulls(r, s) && append_events(r, s) && append_joints(r, s) && append_motions(r, s);
	for (int i = 0; i < COLUMNS && ok; i++)
		ok = append_row(r, i, row_of(r, i, s));
	if (!ok || H5Fflush(r->file, H5F_SCOPE_GLOBAL) < 0)
		return ob_hdf5_fail(e, r->path, "append to the record");
	r->rows++;
	r->written_count = r->count;
	return true;
}

// ---- samples of sensors

// Appends what a sensor has taken since.
static bool append_samples(ob_recorder *r, const ob_universe *u, uint32_t sensor, ob_error *e)
{
	ob_sensor_passport p;
	haddr_t used = 0;
	if (!ob_universe_get_sensor(u, sensor, &p))
		return true;
	const bool is_camera = p.kind == OB_SENSOR_CAMERA;
	const uint32_t width = is_camera ? 1 : p.width, parts = (width + OB_RECORD_VALUES - 1) / OB_RECORD_VALUES;
	const hsize_t pixels = is_camera ? (hsize_t)p.beams * p.rows : 0, first = r->pixels.rows;
	if (!OB_GROW(r->sample_number, p.kept) || !OB_GROW(r->sample_time, p.kept) ||
	    !OB_GROW(r->sample_value, (size_t)p.kept * p.width) || !OB_GROW(r->fresh_sample, (size_t)p.kept * parts))
		return ob_fail(e, "%s: no memory to record sensor \"%s\"", r->path, p.name);
	const size_t n = ob_universe_get_samples(u, sensor, r->sensed[sensor], r->sample_number, r->sample_time,
						 r->sample_value, p.kept);
	if (n)
		r->sensed[sensor] = r->sample_number[n - 1];
	for (size_t i = 0; i < n * parts; i++) {
		const size_t of = i / parts;
		ob_record_sample *to = &r->fresh_sample[i];
		*to = (ob_record_sample){ sensor,
					  (uint32_t)(i % parts) * OB_RECORD_VALUES,
					  r->sample_number[of],
					  r->sample_time[of],
					  { 0 } };
		for (uint32_t k = 0; k < OB_RECORD_VALUES; k++)
			to->value[k] = to->first + k < width ? r->sample_value[of * p.width + to->first + k] : NAN;
		if (is_camera)
			to->value[0] = (double)(first + of * pixels);
	}
	if (H5Fget_eoa(r->file, &used) >= 0 &&
	    !preallocate(&r->allocated, r->path, used,
			 list_bytes(&r->samples, n * parts) + list_bytes(&r->pixels, n * pixels) + INDEX_BYTES, e))
		return false;
	bool good = true;
	for (size_t i = 0; i < n && good; i++)
		good = append_list(&r->pixels, r->sample_value + i * p.width, pixels);
	return (good && append_list(&r->samples, r->fresh_sample, n * parts)) ||
	       ob_hdf5_fail(e, r->path, "append to the record");
}

bool ob_hdf5_recorder_sense(ob_recorder *r, const ob_universe *u, ob_error *e)
{
	bool good = true;
	for (uint32_t i = 0; i < r->sensors && good; i++)
		good = append_samples(r, u, i, e);
	r->failed |= !good;
	return good;
}

bool ob_hdf5_recorder_append(ob_recorder *r, const ob_snapshot *s, ob_error *e)
{
	const bool good = append(r, s, e);
	r->failed |= !good;
	return good;
}

// Removes a file without a state, for which there was no room.
static void remove_useless(const ob_recorder *r)
{
	struct stat st;
	if (r->failed && r->rows == 0 && r->path && lstat(r->path, &st) == 0 && S_ISREG(st.st_mode))
		unlink(r->path);
}

bool ob_hdf5_recorder_close(ob_recorder *r, ob_error *e)
{
	if (!r)
		return true;
	bool ok = true;
	for (int i = 0; i < COLUMNS; i++)
		if (r->set[i] >= 0)
			ok &= H5Dclose(r->set[i]) >= 0;
	if (r->objects.count)
		ok &= finish_objects(&r->objects);
	ok &= finish_list(&r->events);
	ok &= finish_list(&r->motions);
	ok &= finish_list(&r->hulls);
	ok &= finish_list(&r->joints);
	ok &= finish_list(&r->samples);
	ok &= finish_list(&r->pixels);
	if (r->file >= 0)
		ok &= H5Fclose(r->file) >= 0;
	ok &= close_preallocation(&r->allocated, ob_hdf5_length(r->path));
	if (!ok)
		ob_hdf5_fail(e, r->path, "close the record");
	remove_useless(r);
	free(r->path);
	free(r->numbers);
	free(r->asleep);
	free(r->known);
	free(r->fresh);
	free(r->event);
	free(r->knows_hull);
	free(r->joint);
	free(r->fresh_joint);
	free(r->sensed);
	free(r->sample_number);
	free(r->sample_time);
	free(r->sample_value);
	free(r->fresh_sample);
	free(r);
	return ok;
}
