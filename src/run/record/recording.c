#include "base/allocate.h"
#include "record/part.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/budget.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/utf8.h"
#include "record/recorded.h"
#include "scene/object_limits.h"
#include "shape/shape.h"
#include "table/layout.h"

enum {
	OBJECTS_MAX = 1 << 20,
	JOINTS_MAX = 1 << 21,
	CAMERAS_MAX = 1000,
	HULLS_MAX = UINT16_MAX + 1,
	EVERY_MAX = 1 << 30
};
// Limits of the first reading, whatever the size of the file: the budget's bytes of memory, and half of its seconds of CPU for
// each of the advances, the first of which opens the record; the other half is for the second reading. An advance ends
// with the first state after PAUSE seconds of CPU. The limit of wall time is WALL_PER_CPU times as long. A healthy record takes about 2 s of CPU for each 2^30 bytes.
enum { SECONDS = OB_BUDGET_SECONDS / 2, PAUSE = 2, WALL_PER_CPU = 30 };
static const double number_max = 1e15; // largest of any number in SI units

// ---- attributes

static bool read_attribute_text(hid_t at, const char *name, char *text, size_t room)
{
	char long_text[4096];
	hid_t id = H5Aexists(at, name) > 0 ? H5Aopen(at, name, H5P_DEFAULT) : H5I_INVALID_HID;
	hid_t type = id >= 0 ? H5Aget_type(id) : H5I_INVALID_HID, space = id >= 0 ? H5Aget_space(id) : H5I_INVALID_HID;
	bool fits = type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
		    H5Tget_size(type) < sizeof long_text && H5Sget_simple_extent_npoints(space) == 1;
	memset(long_text, 0, sizeof long_text);
	bool ok = fits && H5Aread(id, type, long_text) >= 0;
	if (space >= 0)
		H5Sclose(space);
	if (type >= 0)
		H5Tclose(type);
	if (id >= 0)
		H5Aclose(id);
	long_text[strnlen(long_text, room - 1)] = 0;
	strcpy(text, long_text);
	ob_utf8_make_plain(text);
	return ok;
}

static bool read_attribute(hid_t at, const char *name, hid_t type, void *numbers, hssize_t count)
{
	hid_t id = H5Aexists(at, name) > 0 ? H5Aopen(at, name, H5P_DEFAULT) : H5I_INVALID_HID;
	if (id < 0)
		return false;
	hid_t in_file = H5Aget_type(id), space = H5Aget_space(id);
	H5T_class_t kind = H5Tget_class(in_file);
	bool ok = (kind == H5T_INTEGER || kind == H5T_FLOAT) && H5Sget_simple_extent_npoints(space) == count &&
		  H5Aread(id, type, numbers) >= 0;
	H5Sclose(space);
	H5Tclose(in_file);
	H5Aclose(id);
	return ok;
}

// ---- datasets of numbers

// Reads a dataset of numbers as a whole; limits *rows to its length.
static void *read_numbers(ob_recording *r, const char *name, H5T_class_t kind, hid_t type, uint64_t *rows, ob_error *e)
{
	uint64_t count;
	hid_t set = ob_recorded_set_open(r, name, kind, 1, &count, e);
	if (set < 0)
		return NULL;
	void *numbers = count <= OB_RECORD_STATES_MAX ? calloc(count + 1, 8) : NULL;
	bool ok = numbers && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0;
	H5Dclose(set);
	if (!ok) {
		free(numbers);
		ob_recording_damaged(r, "the times of its states cannot be read", e);
		return NULL;
	}
	*rows = count < *rows ? count
			      : *rows; // a writer that was killed may have left one dataset longer than the next
	return numbers;
}

// ---- opening

static bool check_states(const ob_recording *r, ob_error *e)
{
	const ob_recording_info *i = &r->info;
	const uint64_t every = i->scene.record_every;
	for (uint64_t k = 0; k < i->states; k++) {
		double expected = (double)r->step[k] * i->scene.run.step_length;
		if (r->step[k] > UINT32_MAX || r->step[k] % every != 0 ||
		    (k > 0 && r->step[k] != r->step[k - 1] + every))
			return ob_recording_damaged(r, "its states are not in order", e);
		if (!(fabs(r->time[k] - expected) <= 1e-6 * (i->scene.run.step_length + expected)))
			return ob_recording_damaged(r, "the times of its states are not those of its steps", e);
		if (r->motions_until[k] > r->motions.total || (k > 0 && r->motions_until[k] < r->motions_until[k - 1]))
			return ob_recording_damaged(r, "it lacks motions", e);
	}
	return true;
}

static bool open_states(ob_recording *r, ob_error *e)
{
	ob_recording_info *i = &r->info;
	i->states = UINT64_MAX;
	r->time = read_numbers(r, "time", H5T_FLOAT, H5T_NATIVE_DOUBLE, &i->states, e);
	r->step = r->time ? read_numbers(r, "step", H5T_INTEGER, H5T_NATIVE_UINT64, &i->states, e) : NULL;
	r->motions_until =
		r->step ? read_numbers(r, "motions_until", H5T_INTEGER, H5T_NATIVE_UINT64, &i->states, e) : NULL;
	bool jointed = false;
	if (!r->motions_until || !ob_recorded_list_open(r, &r->events, e) ||
	    !ob_recorded_list_open(r, &r->motions, e) ||
	    !ob_recording_find(r, r->joints.table->label.name, &jointed, e) ||
	    (jointed && !ob_recorded_list_open(r, &r->joints, e)))
		return false;
	if (i->states == 0)
		return ob_fail(e, "%s: this record is empty: its run ended before the first state", r->path);
	if (!check_states(r, e))
		return false;
	i->interval = i->scene.record_every * i->scene.run.step_length;
	i->first = r->step[0] / i->scene.record_every;
	i->begin = r->time[0];
	i->end = r->time[i->states - 1];
	return true;
}

static bool finite3(ob_vec3 v)
{
	return fabs(v.x) <= number_max && fabs(v.y) <= number_max && fabs(v.z) <= number_max;
}

static bool is_colour(const float *c, int n)
{
	bool ok = true;
	for (int i = 0; i < n; i++)
		ok &= c[i] >= 0 && c[i] <= 1000;
	return ok;
}

static bool camera_makes_sense(ob_camera_def *c)
{
	uint8_t automatic, aboard; // bytes that may be an invalid bool
	memcpy(&automatic, &c->automatic, sizeof automatic);
	memcpy(&aboard, &c->aboard, sizeof aboard);
	c->automatic = automatic != 0;
	c->aboard = aboard != 0;
	c->name[OB_NAME_MAX - 1] = c->follow[OB_NAME_MAX - 1] = 0;
	ob_utf8_make_plain(c->name);
	ob_utf8_make_plain(c->follow);
	return finite3(c->eye) && finite3(c->target) && finite3(c->velocity) && fabs(c->pan) <= number_max &&
	       fabs(c->tilt) <= number_max && c->fov > 0 && c->fov < M_PI;
}

static bool open_cameras(ob_recording *r, ob_error *e)
{
	ob_scene *scene = &r->info.scene;
	ob_recorded_list cameras = ob_recorded_list_of(&ob_record_cameras);
	bool ok = ob_recorded_list_open(r, &cameras, e);
	if (ok && (cameras.total < 1 || cameras.total > CAMERAS_MAX))
		ok = ob_recording_damaged(r, "it has no cameras, or too many", e);
	if (ok && !(scene->camera = calloc(cameras.total, sizeof *scene->camera)))
		ok = ob_fail(e, "%s: no memory", r->path);
	for (uint64_t i = 0; ok && i < cameras.total; i++) {
		const ob_camera_def *c = ob_recorded_item(&cameras, i);
		if (c)
			scene->camera[i] = *c;
		scene->cameras++;
		if (!c || !camera_makes_sense(&scene->camera[i]))
			ok = ob_recording_damaged(r, "its cameras make no sense", e);
	}
	ob_recorded_list_close(&cameras);
	return ok;
}

static bool open_look(ob_recording *r, ob_error *e)
{
	ob_recorded_list l = ob_recorded_list_of(&ob_record_look);
	ob_look_def *look = &r->info.scene.look;
	bool ok = ob_recorded_list_open(r, &l, e);
	const char *item = ok && l.total == 1 ? ob_recorded_item(&l, 0) : NULL;
	if (item) {
		uint8_t grid = (uint8_t)item[offsetof(ob_look_def, grid)];
		memcpy(look, item, sizeof *look);
		memcpy(&look->grid, &(bool){ grid != 0 }, sizeof look->grid); // the byte may be an invalid bool
	}
	if (ok && !(item && is_colour(look->sky_top, 3) && is_colour(look->sky_horizon, 3) &&
		    is_colour(look->ground_colour, 3) && finite3(look->sun)))
		ok = ob_recording_damaged(r, "/look makes no sense", e);
	ob_recorded_list_close(&l);
	return ok;
}

static bool take_recorded_hull(ob_recording *r, const ob_record_hull *h, ob_error *e)
{
	ob_snapshot *s = &r->now;
	if (!h || h->number >= s->hulls || s->hull[h->number] || !ob_hull_makes_sense(&h->hull))
		return ob_recording_damaged(r, "its hulls make no sense", e);
	s->hull[h->number] = malloc(sizeof h->hull);
	if (!s->hull[h->number])
		return ob_fail(e, "%s: no memory for its hulls", r->path);
	*s->hull[h->number] = h->hull;
	return true;
}

// Opens the hulls. Records older than hulls lack them.
static bool open_hulls(ob_recording *r, ob_error *e)
{
	ob_recorded_list hulls = ob_recorded_list_of(&ob_record_hulls);
	ob_snapshot *s = &r->now;
	bool there = false, ok = ob_recording_find(r, hulls.table->label.name, &there, e);
	if (!there)
		return ok;
	ok = ok && ob_recorded_list_open(r, &hulls, e);
	if (ok && hulls.total > HULLS_MAX)
		ok = ob_recording_damaged(r, "it has too many hulls", e);
	if (ok && hulls.total > 0 && !(s->hull = calloc(HULLS_MAX, sizeof *s->hull)))
		ok = ob_fail(e, "%s: no memory for its hulls", r->path);
	s->hulls = s->hull ? HULLS_MAX : 0;
	for (uint64_t i = 0; ok && i < hulls.total; i++)
		ok = take_recorded_hull(r, ob_recorded_item(&hulls, i), e);
	while (s->hulls > 0 && !s->hull[s->hulls - 1])
		s->hulls--;
	ob_recorded_list_close(&hulls);
	return ok;
}

// Reads all items of a mesh's table into new memory; NULL: it cannot be read, or has too many.
static void *read_mesh_table(ob_recording *r, uint32_t number, const ob_record_table *table, uint64_t most,
			     uint64_t *count, ob_error *e)
{
	char name[32];
	snprintf(name, sizeof name, "meshes/%u/%s", number, table->label.name);
	hid_t set = ob_recorded_set_open(r, name, H5T_COMPOUND, 1, count, e);
	if (set < 0)
		return NULL;
	hid_t type = ob_record_type_in_memory(table);
	const bool fits = *count > 0 && *count <= most;
	void *items = fits ? calloc(*count, table->size) : NULL;
	const bool read = items && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, items) >= 0;
	if (fits && !items)
		ob_fail(e, "%s: no memory for its meshes", r->path);
	else if (!read)
		ob_recording_damaged(r, "its meshes make no sense", e);
	H5Tclose(type);
	H5Dclose(set);
	if (read)
		return items;
	free(items);
	return NULL;
}

// Reads the size of an image: height, width and 4. false: not an image, too large, or more than this number of pixels.
static bool take_image_size(hid_t set, uint64_t pixels, ob_mesh_image *image)
{
	hsize_t size[3] = { 0 };
	hid_t space = H5Dget_space(set);
	const bool fits = H5Sget_simple_extent_dims(space, size, NULL) == 3 && size[0] >= 1 &&
			  size[0] <= OB_MESH_IMAGE_SIDE_MAX && size[1] >= 1 && size[1] <= OB_MESH_IMAGE_SIDE_MAX &&
			  size[2] == 4 && size[0] * size[1] <= pixels;
	image->height = (uint32_t)size[0];
	image->width = (uint32_t)size[1];
	H5Sclose(space);
	return fits;
}

// pixels: how many more pixels the images of its mesh may have.
static bool open_image(ob_recording *r, const char *name, uint64_t *pixels, ob_mesh_image *image, ob_error *e)
{
	uint64_t numbers = 0;
	hid_t set = ob_recorded_set_open(r, name, H5T_INTEGER, 3, &numbers, e);
	if (set < 0)
		return false;
	const bool fits = take_image_size(set, *pixels, image);
	*pixels -= fits ? (uint64_t)image->width * image->height : 0;
	if (fits)
		image->rgba = malloc(4 * (size_t)image->width * image->height);
	const bool read =
		image->rgba && H5Dread(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, image->rgba) >= 0;
	H5Dclose(set);
	if (fits && !image->rgba)
		return ob_fail(e, "%s: no memory for its meshes", r->path);
	return read || ob_recording_damaged(r, "its meshes make no sense", e);
}

// Opens parts and images of a mesh; meshes without images lack both.
static bool open_parts(ob_recording *r, uint32_t number, ob_mesh *m, ob_error *e)
{
	char name[48];
	uint64_t parts = 0, pixels = OB_MESH_PIXELS_MAX;
	snprintf(name, sizeof name, "meshes/%u/parts", number);
	bool there = false, ok = ob_recording_find(r, name, &there, e);
	if (!ok || !there)
		return ok;
	m->part = read_mesh_table(r, number, &ob_record_mesh_parts, OB_MESH_PARTS_MAX, &parts, e);
	m->image = calloc(OB_MESH_IMAGES_MAX, sizeof *m->image);
	if (!m->part)
		return false;
	if (!m->image)
		return ob_fail(e, "%s: no memory for its meshes", r->path);
	m->parts = (uint32_t)parts;
	while (ok && there && m->images < OB_MESH_IMAGES_MAX) {
		snprintf(name, sizeof name, "meshes/%u/images/%u", number, m->images + 1);
		ok = ob_recording_find(r, name, &there, e) &&
		     (!there || open_image(r, name, &pixels, &m->image[m->images++], e));
	}
	return ok;
}

static bool open_mesh(ob_recording *r, uint32_t number, ob_mesh *m, ob_error *e)
{
	uint64_t vertices = 0, triangles = 0;
	m->vertex = read_mesh_table(r, number, &ob_record_mesh_vertices, OB_MESH_VERTICES_MAX, &vertices, e);
	if (!m->vertex)
		return false;
	m->index = read_mesh_table(r, number, &ob_record_mesh_triangles, OB_MESH_TRIANGLES_MAX, &triangles, e);
	if (!m->index)
		return false;
	m->vertices = (uint32_t)vertices;
	m->indices = 3 * (uint32_t)triangles;
	if (!open_parts(r, number, m, e))
		return false;
	return ob_mesh_makes_sense(m) || ob_recording_damaged(r, "its meshes make no sense", e);
}

// Opens the meshes. Records of scenes without meshes lack the group.
static bool open_meshes(ob_recording *r, ob_error *e)
{
	ob_scene *s = &r->info.scene;
	char name[32] = "meshes";
	size_t bytes = 0;
	bool there = false, ok = ob_recording_find(r, name, &there, e);
	if (!ok || !there)
		return ok;
	s->mesh = calloc(OB_SCENE_MESHES_MAX, sizeof *s->mesh);
	if (!s->mesh)
		return ob_fail(e, "%s: no memory for its meshes", r->path);
	while (ok && there && s->meshes < OB_SCENE_MESHES_MAX) {
		snprintf(name, sizeof name, "meshes/%u", s->meshes + 1);
		ok = ob_recording_find(r, name, &there, e);
		if (!ok || !there)
			break;
		s->meshes++;
		ok = open_mesh(r, s->meshes, &s->mesh[s->meshes - 1], e);
		bytes += ob_mesh_bytes(&s->mesh[s->meshes - 1]);
		if (bytes > OB_SCENE_MESH_BYTES)
			ok = ob_recording_damaged(r, "its meshes are too large together", e);
	}
	return ok;
}

static bool open_facts(ob_recording *r, ob_error *e)
{
	ob_recording_info *i = &r->info;
	ob_scene *scene = &i->scene;
	double workers = 0, every = 0;
	bool there = read_attribute_text(r->file, "title", scene->title, sizeof scene->title) &&
		     read_attribute_text(r->file, "universe", i->universe, sizeof i->universe) &&
		     read_attribute_text(r->file, "isolation", i->isolation, sizeof i->isolation) &&
		     read_attribute_text(r->file, "obsim_version", i->version, sizeof i->version) &&
		     read_attribute_text(r->file, "obsim_commit", i->commit, sizeof i->commit) &&
		     read_attribute_text(r->file, "created", i->created, sizeof i->created) &&
		     read_attribute(r->file, "workers", H5T_NATIVE_DOUBLE, &workers, 1) &&
		     read_attribute(r->file, "gravity", H5T_NATIVE_DOUBLE, &scene->run.gravity, 3) &&
		     read_attribute(r->file, "step_length", H5T_NATIVE_DOUBLE, &scene->run.step_length, 1) &&
		     read_attribute(r->file, "duration", H5T_NATIVE_DOUBLE, &scene->duration, 1) &&
		     read_attribute(r->file, "record_every", H5T_NATIVE_DOUBLE, &every, 1) &&
		     read_attribute(r->file, "seed", H5T_NATIVE_UINT64, &scene->seed, 1);
	if (!there)
		return ob_recording_damaged(r, "it does not say what was run", e);
	if (!(workers >= 0 && workers <= UINT32_MAX) || !finite3(scene->run.gravity) ||
	    !(scene->run.step_length >= 1e-9 && scene->run.step_length <= 1e6) ||
	    !(scene->duration > 0 && scene->duration <= 1e9) || !(every >= 1 && every <= EVERY_MAX))
		return ob_recording_damaged(r, "its steps or its duration make no sense", e);
	i->workers = (uint32_t)workers;
	scene->record_every = (uint32_t)every;
	return true;
}

static bool check_format(const ob_recording *r, ob_error *e)
{
	char format[32], version[32];
	double number = 0;
	if (!read_attribute_text(r->file, "format", format, sizeof format)) {
		if (!read_attribute_text(r->file, "obsim_version", version, sizeof version))
			return ob_fail(e, "%s: this is an HDF5 file, but no record of obsim", r->path);
		number = 1;
	} else if (strcmp(format, OB_RECORD_FORMAT) != 0) {
		return ob_fail(e, "%s: this is an HDF5 file, but no record of obsim", r->path);
	}
	if (number == 0 && !read_attribute(r->file, "format_version", H5T_NATIVE_DOUBLE, &number, 1))
		return ob_recording_damaged(r, "it does not say of which version it is", e);
	if (number == OB_RECORD_VERSION)
		return true;
	return ob_fail(e,
		       "%s: this record is of version %g, and this obsim reads version %d: record the run again, or "
		       "use the obsim that wrote it",
		       r->path, number, OB_RECORD_VERSION);
}

// Opens the file by its descriptor, so that the checked file is the one that is read, even if its name now belongs to
// another.
static bool open_file(ob_recording *r, int fd, ob_error *e)
{
	char file[32];
	snprintf(file, sizeof file, "/proc/self/fd/%d", fd);
	if (H5Fis_hdf5(file) <= 0)
		return ob_fail(e, "%s: this is no record of obsim: it is no HDF5 file", r->path);
	r->file = H5Fopen(file, H5F_ACC_RDONLY, H5P_DEFAULT);
	if (r->file < 0)
		return ob_fail(e, "%s: this record cannot be opened: it is being written, cut short, or damaged",
			       r->path);
	return check_format(r, e) && open_facts(r, e) && open_cameras(r, e) && open_look(r, e) && open_hulls(r, e) &&
	       open_meshes(r, e) && open_states(r, e) && ob_recorded_samples_open(r, e);
}

// ---- the first reading, by a child

// Ends it, and returns its status as waitpid gives it.
static int end_reader(ob_recording_reader *first)
{
	int status = 0;
	if (first->pid) {
		close(first->link); // it waits for this, or has ended
		while (waitpid(first->pid, &status, 0) < 0 && errno == EINTR)
			;
	}
	first->pid = 0;
	return status;
}

// Takes over first.
static ob_recording *open_here(const char *path, int fd, uint64_t bytes, ob_recording_reader first, ob_error *e)
{
	ob_hdf5_silence();
	H5PLset_loading_state(0); // filters unknown to this HDF5 would be loaded as libraries from a folder
	ob_recording *r = calloc(1, sizeof *r);
	if (!r || !(r->path = strdup(path))) {
		ob_fail(e, "%s: no memory", path);
		end_reader(&first);
		free(r);
		return NULL;
	}
	r->first = first;
	r->file = H5I_INVALID_HID;
	r->file_bytes = bytes;
	r->events = ob_recorded_list_of(&ob_record_events);
	r->motions = ob_recorded_list_of(&ob_record_motions);
	r->joints = ob_recorded_list_of(&ob_record_joints);
	r->samples = ob_recorded_list_of(&ob_record_samples);
	r->pixels = ob_recorded_list_of(&ob_record_pixels);
	r->state = UINT64_MAX;
	if (open_file(r, fd, e))
		return r;
	ob_hdf5_recording_close(r);
	return NULL;
}

static uint64_t address_space(void) // bytes; 0: it cannot be read
{
	char text[32] = "";
	const int fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
	const ssize_t n = fd < 0 ? -1 : read(fd, text, sizeof text - 1);
	if (fd >= 0)
		close(fd);
	return n > 0 ? strtoull(text, NULL, 10) * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

// Limits the damage that a corrupt file can do to a process: memory, files. One descriptor remains, with which HDF5
// opens the file itself. Signals to all processes of a terminal leave the decision to the program.
static void limit_child(int fd)
{
	const int last = dup(fd);
	close(last);
	const rlim_t memory = address_space() + OB_BUDGET_BYTES;
	setrlimit(RLIMIT_AS, &(struct rlimit){ memory, memory });
	setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
	setrlimit(RLIMIT_FSIZE, &(struct rlimit){ 0, 0 });
	setrlimit(RLIMIT_NOFILE, &(struct rlimit){ (rlim_t)last + 1, (rlim_t)last + 1 });
	signal(SIGALRM, SIG_DFL);
	signal(SIGXCPU, SIG_DFL);
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	signal(SIGHUP, SIG_IGN);
}

// Allows SECONDS of CPU from now on. Returns the CPU time at which an advance pauses.
static double begin_advance(void)
{
	struct rlimit cpu;
	const double now = ob_clock_process_cpu();
	const rlim_t until = (rlim_t)now + SECONDS;
	getrlimit(RLIMIT_CPU, &cpu);
	cpu.rlim_cur = until < cpu.rlim_max ? until : cpu.rlim_max;
	setrlimit(RLIMIT_CPU, &cpu);
	alarm(WALL_PER_CPU * SECONDS); // it should never wait, except for the disk
	return now + PAUSE;
}

// Report of the first reader after each advance.
typedef struct report {
	uint64_t states; // read so far; UINT64_MAX: all
	ob_error e; // empty: none
} report;

static _Noreturn void be_child(const char *path, int fd, uint64_t bytes, int link, pid_t parent)
{
	report said = { .states = 0 };
	char go;
	bool ended = false;
	int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
	dup2(nowhere, STDERR_FILENO); // messages of a library that dies
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent)
		_exit(1); // the parent died before that
	limit_child(fd);
	double until = begin_advance();
	ob_recording *r = open_here(path, fd, bytes, (ob_recording_reader){ .states = UINT64_MAX }, &said.e);
	for (bool good = r; good; until = begin_advance()) {
		do
			said.states += good = ob_hdf5_recording_next(r, &ended, &said.e);
		while (good && ob_clock_process_cpu() < until);
		if (!good)
			break;
		alarm(0);
		if (write(link, &said, sizeof said) != sizeof said || read(link, &go, 1) != 1)
			_exit(1);
	}
	if (ended)
		said = (report){ .states = UINT64_MAX };
	_exit(write(link, &said, sizeof said) == sizeof said ? 0 : 1);
}

static bool fail_child(const char *path, int status, ob_error *e)
{
	const int death = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	if (death == SIGXCPU || death == SIGALRM)
		return ob_fail(e,
			       "%s: this record is damaged: it takes more than %d s of CPU, or %d s by the clock, to "
			       "open it or to read a state; record the run again",
			       path, SECONDS, WALL_PER_CPU * SECONDS);
	return ob_fail(e, "%s: this record is damaged: HDF5 cannot read it (%s)", path,
		       death ? strsignal(death) : "and gives no reason");
}

// Waits until the first reader pauses or ends. false and e: it found damage, or died.
static bool take_report(ob_recording_reader *first, const char *path, ob_error *e)
{
	report said = { .states = 0 };
	ssize_t n;
	while ((n = read(first->link, &said, sizeof said)) < 0 && errno == EINTR)
		;
	if (n != sizeof said)
		return fail_child(path, end_reader(first), e);
	said.e.text[sizeof said.e.text - 1] = 0;
	first->states = said.states;
	if (said.states == UINT64_MAX || said.e.text[0])
		end_reader(first);
	return !said.e.text[0] || ob_fail(e, "%s", said.e.text);
}

// Starts the first reader, which opens the record and reads some of it, or all.
static bool start_reader(ob_recording_reader *first, const char *path, int fd, uint64_t bytes, ob_error *e)
{
	int ends[2];
	const pid_t parent = getpid();
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
		return ob_fail(e, "%s: no socket: %s", path, strerror(errno));
	const pid_t child = fork();
	if (child == 0) {
		close(ends[0]);
		be_child(path, fd, bytes, ends[1], parent);
	}
	const int why = errno;
	close(ends[1]);
	if (child < 0) {
		close(ends[0]);
		return ob_fail(e, "%s: no process to read it: %s", path, strerror(why));
	}
	*first = (ob_recording_reader){ .pid = child, .link = ends[0] };
	return take_report(first, path, e);
}

// True if the first reader has read the next state. Waits for its next advance if needed.
static bool is_read(ob_recording *r, ob_error *e)
{
	const uint64_t next = r->state + 1;
	if (next == r->first.states && r->first.pid) {
		send(r->first.link, "", 1, MSG_NOSIGNAL); // if it is dead, there is no report
		if (!take_report(&r->first, r->path, e))
			return false;
	}
	return next < r->first.states || ob_recording_damaged(r, "it cannot be read any further", e);
}

ob_recording *ob_hdf5_recording_open(const char *path, ob_error *e)
{
	uint64_t bytes = 0;
	ob_recording_reader first;
	ob_error why;
	const int fd = ob_file_open(path, UINT64_MAX, &bytes, &why);
	if (fd < 0)
		return ob_fail(e, "%s: cannot read the record: %s", path, why.text), NULL;
	ob_recording *r = start_reader(&first, path, fd, bytes, e) ? open_here(path, fd, bytes, first, e) : NULL;
	close(fd);
	return r;
}

const ob_recording_info *ob_hdf5_recording_get_info(const ob_recording *r)
{
	return &r->info;
}

void ob_hdf5_recording_close(ob_recording *r)
{
	if (!r)
		return;
	end_reader(&r->first);
	ob_recorded_list_close(&r->events);
	ob_recorded_list_close(&r->motions);
	ob_recorded_list_close(&r->joints);
	ob_recorded_samples_close(r);
	if (r->file >= 0)
		H5Fclose(r->file);
	ob_snapshot_finish(&r->now);
	free(r->info.scene.camera);
	for (uint32_t i = 0; i < r->info.scene.meshes; i++)
		ob_mesh_finish(&r->info.scene.mesh[i]);
	free(r->info.scene.mesh);
	free(r->time);
	free(r->step);
	free(r->motions_until);
	free(r->path);
	free(r);
}

// ---- from state to state

static bool make_room(ob_snapshot *s, uint32_t count)
{
	if (count > s->count_max) {
		const uint32_t room = count > 2 * s->count_max ? count : 2 * s->count_max;
		if (!OB_GROW(s->passport, room) || !OB_GROW(s->motion, room))
			return false;
		s->count_max = room;
	}
	for (; s->count < count; s->count++) {
		memset(&s->passport[s->count], 0, sizeof *s->passport);
		memset(&s->motion[s->count], 0, sizeof *s->motion);
	}
	return true;
}

static bool passport_makes_sense(const ob_passport *p)
{
	ob_error e;
	return ob_passport_makes_sense(p, p->id) && p->flags & OB_OBJECT_PRESENT && ob_passport_check(p, &e) &&
	       p->inertia.x >= 0 && p->inertia.y >= 0 && p->inertia.z >= 0;
}

static bool has_its_hull(const ob_snapshot *s, const ob_passport *p)
{
	return !ob_shape_is(p->shape, OB_HULLED) || (p->hull < s->hulls && s->hull[p->hull]);
}

static bool is_present(const ob_snapshot *s, uint32_t id)
{
	return id < s->count && s->passport[id].flags & OB_OBJECT_PRESENT;
}

static bool take_event(ob_recording *r, const ob_record_event *event, ob_error *e)
{
	ob_snapshot *s = &r->now;
	ob_record_event now = *event;
	const uint32_t id = now.passport.id;
	now.passport.name[OB_NAME_MAX - 1] = 0;
	if (now.step != r->step[r->state] || id >= OBJECTS_MAX || now.kind < OB_RECORD_CREATED ||
	    now.kind > OB_RECORD_REMOVED)
		return ob_recording_damaged(r, "its events make no sense", e);
	bool there = is_present(s, id), same = there && s->passport[id].generation == now.passport.generation;
	if (now.kind == OB_RECORD_CREATED ? there : !same)
		return ob_recording_damaged(r, "an object goes that is not there, or comes twice", e);
	if (now.kind == OB_RECORD_REMOVED) {
		memset(&s->passport[id], 0, sizeof *s->passport);
		memset(&s->motion[id], 0, sizeof *s->motion);
		return true;
	}
	if (!passport_makes_sense(&now.passport) || !has_its_hull(s, &now.passport) ||
	    now.passport.mesh > r->info.scene.meshes)
		return ob_recording_damaged(r, "an object makes no sense", e);
	if (!make_room(s, id + 1))
		return ob_fail(e, "%s: no memory for %u objects", r->path, id + 1);
	s->passport[id] = now.passport;
	ob_utf8_make_plain(s->passport[id].name);
	return true;
}

static bool make_room_for_joints(ob_snapshot *s, uint32_t joints)
{
	if (!OB_RESERVE(s->joint, joints, s->joints_max))
		return false;
	for (; s->joints < joints; s->joints++)
		memset(&s->joint[s->joints], 0, sizeof *s->joint);
	return true;
}

static bool joint_makes_sense(const ob_snapshot *s, ob_joint_passport *j)
{
	j->axis = j->second = (ob_joint_axis){ .low = 0 };
	j->breaks_force = j->breaks_torque = INFINITY;
	j->name[OB_NAME_MAX - 1] = 0;
	ob_utf8_make_plain(j->name);
	bool sense = ob_joint_makes_sense(j);
	for (int side = 0; side < 2; side++)
		sense = sense && finite3(j->frame[side].p) &&
			(is_present(s, j->object[side]) || j->object[side] == OB_JOINT_WORLD);
	return sense;
}

static bool take_joint(ob_recording *r, const ob_record_joint *event, ob_error *e)
{
	ob_snapshot *s = &r->now;
	ob_record_joint now = *event;
	if (now.step != r->step[r->state] || now.number >= JOINTS_MAX || now.kind < OB_RECORD_CREATED ||
	    now.kind > OB_RECORD_REMOVED || ob_snapshot_has_joint(s, now.number) != (now.kind != OB_RECORD_CREATED))
		return ob_recording_damaged(r, "its joints make no sense", e);
	if (now.kind == OB_RECORD_REMOVED) {
		memset(&s->joint[now.number], 0, sizeof *s->joint);
		return true;
	}
	if (!joint_makes_sense(s, &now.passport))
		return ob_recording_damaged(r, "a joint makes no sense", e);
	if (!make_room_for_joints(s, now.number + 1))
		return ob_fail(e, "%s: no memory for %u joints", r->path, now.number + 1);
	s->joint[now.number] = now.passport;
	return true;
}

static bool take_joints(ob_recording *r, ob_error *e)
{
	for (; r->joint < r->joints.total; r->joint++) {
		const ob_record_joint *event = ob_recorded_item(&r->joints, r->joint);
		if (!event)
			return ob_recording_damaged(r, "/joints cannot be read", e);
		if (event->step > r->step[r->state])
			break;
		if (!take_joint(r, event, e))
			return false;
	}
	return true;
}

static bool take_motion(ob_recording *r, const ob_record_motion *m, ob_error *e)
{
	const ob_motion *now = &m->motion;
	if (!is_present(&r->now, m->id) || !ob_motion_makes_sense(now) || !finite3(now->p) || !finite3(now->v) ||
	    !finite3(now->w) || !finite3(now->a) || now->t0 > r->now.time + r->info.interval || now->t0 < -number_max)
		return ob_recording_damaged(r, "a motion makes no sense", e);
	r->now.motion[m->id] = *now;
	r->now.motion[m->id].step = (uint32_t)r->step[r->state];
	if (!(now->flags & OB_MOTION_SWINGS)) {
		r->now.motion[m->id].rest_time = 0;
		r->now.motion[m->id].island = m->island;
	}
	return true;
}

// Checks that each object added in this state has a motion, or stands somewhere.
static bool check_new(const ob_recording *r, uint64_t first, ob_recorded_list *events, ob_error *e)
{
	for (uint64_t i = first; i < r->event; i++) {
		const ob_record_event *event = ob_recorded_item(events, i);
		if (!event)
			return ob_recording_damaged(r, "/events cannot be read", e);
		if (is_present(&r->now, event->passport.id) &&
		    !ob_motion_makes_sense(&r->now.motion[event->passport.id]))
			return ob_recording_damaged(r, "an object is nowhere", e);
	}
	return true;
}

bool ob_hdf5_recording_next(ob_recording *r, bool *ended, ob_error *e)
{
	*ended = r->state + 1 == r->info.states;
	if (*ended || !is_read(r, e))
		return false;
	r->state++;
	r->now.time = r->time[r->state];
	r->now.step = r->info.first + r->state;
	const uint64_t first = r->event;
	for (; r->event < r->events.total; r->event++) {
		const ob_record_event *event = ob_recorded_item(&r->events, r->event);
		if (!event)
			return ob_recording_damaged(r, "/events cannot be read", e);
		if (event->step > r->step[r->state])
			break;
		if (!take_event(r, event, e))
			return false;
	}
	r->population += r->event > first;
	if (!take_joints(r, e))
		return false;
	for (; r->motion < r->motions_until[r->state]; r->motion++) {
		const ob_record_motion *m = ob_recorded_item(&r->motions, r->motion);
		if (!m)
			return ob_recording_damaged(r, "/motions cannot be read", e);
		if (!take_motion(r, m, e))
			return false;
	}
	return check_new(r, first, &r->events, e) && ob_recorded_samples_take(r, e);
}

const ob_snapshot *ob_hdf5_recording_state(const ob_recording *r)
{
	return &r->now;
}

uint64_t ob_hdf5_recording_population(const ob_recording *r)
{
	return r->population;
}

const ob_recorded_sample *ob_hdf5_recording_samples(const ob_recording *r, size_t *n)
{
	*n = r->recents;
	return r->recent;
}
