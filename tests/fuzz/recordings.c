// Hostile records, made with HDF5 itself: each feature that refers outside a file, in place of each of its objects.
// Each record is rejected with a line, or read; neither may open another file or search for a library to load. A bait
// lies at each target, and inotify reports accesses to it. Thousands in some minutes:
//
//   recordings [COUNT [SEED]]    each way at each place, and then COUNT records with several of them
#include <errno.h>
#include <hdf5.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/random.h"
#include "check.h"
#include "record/record.h"
#include "record/recording.h"

enum { PLACES_MAX = 100, NAME_MAX_HERE = 80 };

static char folder[64], path[80], good[80], bait[80], plugins[80];
static char place[PLACES_MAX][NAME_MAX_HERE]; // names of all groups and datasets of a good record
static uint32_t places;
static int watcher;
static uint64_t state = 1;

static uint32_t below(uint32_t n)
{
	return (uint32_t)(ob_splitmix(&state) % n);
}

// ---- a good record

static void write_record(const char *to)
{
	static ob_mesh_vertex vertex[3] = { { .position = { 1, 0, 0 }, .normal = { 0, 0, 1 } },
					    { .position = { 0, 1, 0 }, .normal = { 0, 0, 1 } },
					    { .normal = { 0, 0, 1 } } };
	static uint32_t triangle[3] = { 0, 1, 2 };
	static uint8_t pixel[4] = { 1, 2, 3, 4 };
	static ob_mesh_image image = { 1, 1, pixel };
	static ob_mesh_part part = { .indices = 3, .colour = 1 };
	static ob_mesh mesh = { .vertices = 3,
				.vertex = vertex,
				.indices = 3,
				.index = triangle,
				.parts = 1,
				.part = &part,
				.images = 1,
				.image = &image };
	static ob_camera_def camera = { .name = "main", .eye = { 1, 2, 3 }, .fov = .7 };
	static ob_scene scene = { .title = "A title",
				  .text = (char *)"box {}",
				  .text_size = 6,
				  .record_every = 1,
				  .cameras = 1,
				  .camera = &camera,
				  .meshes = 1,
				  .mesh = &mesh,
				  .look = { .sun = { 0, 1, 2 } } };
	static const ob_scene_options options;
	ob_passport passport = { .generation = 1,
				 .flags = OB_OBJECT_PRESENT,
				 .shape = OB_SHAPE_SPHERE,
				 .size = { 1, 1, 1 },
				 .mass = 1,
				 .inertia = { 1, 1, 1 },
				 .mesh = 1 };
	ob_motion motion = { .valid_until = 1, .q = { 1, 0, 0, 0 } };
	ob_run_settings settings = ob_run_settings_default();
	ob_error e = { "" };
	ob_record_facts facts = { .universe = { .name = "test",
						.arch = "obs",
						.isolation = "thread",
						.capacity = 1,
						.workers = 1,
						.step_length = .01 },
				  .scene = &scene,
				  .path = "scene.lua",
				  .options = &options,
				  .settings = &settings,
				  .duration = 1,
				  .commit = "abc" };
	ob_recorder *r = ob_recorder_create(to, &facts, &e);
	CHECK(r);
	for (uint64_t i = 0; r && i < 3; i++) {
		ob_snapshot s = {
			.step = i, .time = .01 * (double)i, .count = 1, .passport = &passport, .motion = &motion
		};
		CHECK(ob_recorder_append(r, &s, &e));
	}
	CHECK(ob_recorder_close(r, &e));
}

static herr_t note_place(hid_t file, const char *name, const H5O_info_t *info, void *context)
{
	(void)file, (void)info, (void)context;
	if (strcmp(name, ".") != 0 && places < PLACES_MAX)
		snprintf(place[places++], sizeof *place, "%s", name);
	return 0;
}

static void copy_file(const char *from, const char *to)
{
	static char bytes[1 << 20];
	FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
	const size_t n = in ? fread(bytes, 1, sizeof bytes, in) : 0;
	CHECK(n > 0 && n < sizeof bytes && out && fwrite(bytes, 1, n, out) == n);
	if (in)
		fclose(in);
	if (out)
		fclose(out);
}

// ---- ways out of it

static void remove_place(hid_t file, const char *name)
{
	H5Ldelete(file, name, H5P_DEFAULT);
}

static void to_bait(hid_t file, const char *name)
{
	remove_place(file, name);
	H5Lcreate_external(bait, name, file, name, H5P_DEFAULT, H5P_DEFAULT);
}

static void to_bait_by_link(hid_t file, const char *name)
{
	char far[NAME_MAX_HERE];
	snprintf(far, sizeof far, "to%u", below(1000));
	remove_place(file, name);
	H5Lcreate_external(bait, name, file, far, H5P_DEFAULT, H5P_DEFAULT);
	H5Lcreate_soft(far, file, name, H5P_DEFAULT, H5P_DEFAULT);
}

static void to_itself(hid_t file, const char *name)
{
	remove_place(file, name);
	H5Lcreate_soft(name, file, name, H5P_DEFAULT, H5P_DEFAULT);
}

static void to_another(hid_t file, const char *name)
{
	remove_place(file, name);
	H5Lcreate_hard(file, place[below(places)], file, name, H5P_DEFAULT, H5P_DEFAULT);
}

// True if it stands for parts of others: HDF5 itself would read one of itself until the stack is full.
static bool is_virtual(hid_t set)
{
	const hid_t how = H5Dget_create_plist(set);
	const bool is = H5Pget_layout(how) == H5D_VIRTUAL;
	H5Pclose(how);
	return is;
}

// Puts another dataset of the same type and space, made in this way; or one of doubles in place of a group.
static void put_dataset(hid_t file, const char *name, hid_t how, bool fill)
{
	const hsize_t one = 4;
	hid_t old = H5Dopen2(file, name, H5P_DEFAULT);
	hid_t type = old >= 0 ? H5Dget_type(old) : H5Tcopy(H5T_NATIVE_DOUBLE);
	hid_t space = old >= 0 ? H5Dget_space(old) : H5Screate_simple(1, &one, NULL);
	void *bytes = calloc((size_t)H5Sget_simple_extent_npoints(space) + 1, H5Tget_size(type));
	if (old >= 0 && !is_virtual(old))
		H5Dread(old, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
	if (old >= 0)
		H5Dclose(old);
	hsize_t size[4], most[4];
	H5Sget_simple_extent_dims(space, size, most);
	if (H5Sget_simple_extent_ndims(space) > 0)
		H5Sset_extent_simple(space, H5Sget_simple_extent_ndims(space), size, size);
	if (H5Pget_layout(how) == H5D_CHUNKED && H5Sget_simple_extent_ndims(space) > 0)
		H5Pset_chunk(how, H5Sget_simple_extent_ndims(space), size);
	if (H5Pget_layout(how) == H5D_VIRTUAL)
		H5Pset_virtual(how, space, bait, name, space);
	remove_place(file, name);
	hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
	if (set >= 0 && fill)
		H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
	if (set >= 0)
		H5Dclose(set);
	free(bytes);
	H5Sclose(space);
	H5Tclose(type);
	H5Pclose(how);
}

static void stored_in_bait(hid_t file, const char *name)
{
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_external(how, bait, 0, H5F_UNLIMITED);
	put_dataset(file, name, how, false);
}

static void made_of_bait(hid_t file, const char *name)
{
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_layout(how, H5D_VIRTUAL);
	put_dataset(file, name, how, false);
}

// Stands for a filter that HDF5 does not have: it would search a folder of libraries for it.
static size_t pass(unsigned flags, size_t n, const unsigned *value, size_t bytes, size_t *room, void **buffer)
{
	(void)flags, (void)n, (void)value, (void)room, (void)buffer;
	return bytes;
}

static void through_a_library(hid_t file, const char *name)
{
	const H5Z_class2_t filter = { .version = H5Z_CLASS_T_VERS,
				      .id = 4321,
				      .encoder_present = 1,
				      .decoder_present = 1,
				      .name = "none",
				      .filter = pass };
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	H5Zregister(&filter);
	H5Pset_layout(how, H5D_CHUNKED);
	H5Pset_filter(how, filter.id, 0, 0, NULL);
	put_dataset(file, name, how, true);
	H5Zunregister(filter.id);
}

static void packed(hid_t file, const char *name)
{
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	H5Pset_layout(how, H5D_CHUNKED);
	H5Pset_deflate(how, 9);
	put_dataset(file, name, how, true);
}

static void (*const ways[])(hid_t file, const char *name) = {
	to_bait,      to_bait_by_link,   to_itself, to_another,   stored_in_bait,
	made_of_bait, through_a_library, packed,    remove_place,
};
enum { WAYS = sizeof ways / sizeof *ways };

// ---- reading it

static bool bait_was_taken(void)
{
	char events[4096];
	bool taken = false;
	for (struct pollfd p = { watcher, POLLIN, 0 }; poll(&p, 1, 0) > 0; taken = true)
		if (read(watcher, events, sizeof events) <= 0)
			break;
	return taken;
}

static bool read_it(const char *what, const char *where)
{
	ob_error e = { "" };
	bool ended = false;
	bait_was_taken(); // by HDF5 as it made the file
	ob_recording *r = ob_recording_open(path, &e);
	while (r && ob_recording_next(r, &ended, &e))
		;
	CHECK(r ? ended : strstr(e.text, path) == e.text);
	ob_recording_close(r);
	const bool taken = bait_was_taken();
	if (taken)
		fprintf(stderr, "another file is opened: %s %s: %s\n", what, where, e.text);
	CHECK(!taken);
	return r;
}

static hid_t begin(void)
{
	copy_file(good, path);
	return H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
}

static void try_each(void)
{
	for (uint32_t i = 0; i < places; i++)
		for (uint32_t k = 0; k < WAYS; k++) {
			char way[32];
			hid_t file = begin();
			ways[k](file, place[i]);
			H5Fclose(file);
			snprintf(way, sizeof way, "way %u at", k);
			read_it(way, place[i]);
		}
}

static long try_some(long count)
{
	long read = 0;
	for (long i = 0; i < count; i++) {
		hid_t file = begin();
		for (uint32_t k = 1 + below(4); k > 0; k--)
			ways[below(WAYS)](file, place[below(places)]);
		H5Fclose(file);
		read += read_it("some", "together");
	}
	return read;
}

int main(int argc, char **argv)
{
	const long count = argc > 1 ? strtol(argv[1], NULL, 10) : 300;
	state = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
	snprintf(folder, sizeof folder, "/tmp/obsim-fuzz-recordings-XXXXXX");
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/record.h5", folder);
	snprintf(good, sizeof good, "%s/good.h5", folder);
	snprintf(bait, sizeof bait, "%s/bait.h5", folder);
	snprintf(plugins, sizeof plugins, "%s/plugins", folder);
	CHECK(mkdir(plugins, 0700) == 0 && setenv("HDF5_PLUGIN_PATH", plugins, 1) == 0);
	write_record(good);
	copy_file(good, bait);
	hid_t file = H5Fopen(good, H5F_ACC_RDONLY, H5P_DEFAULT);
	H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, note_place, NULL);
	H5Fclose(file);
	watcher = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
	CHECK(inotify_add_watch(watcher, bait, IN_OPEN) >= 0 && inotify_add_watch(watcher, plugins, IN_OPEN) >= 0);
	CHECK(places > 20);
	try_each();
	const long read = try_some(count);
	printf("%u places, %d ways, and %ld records, of which %ld were read\n", places, WAYS, count, read);
	unlink(path), unlink(good), unlink(bait), rmdir(plugins), rmdir(folder);
	return check_end();
}
