// Records can be read back through HDF5, by this program or by another, also if the writer was killed.
#include <hdf5.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "record/record.h"

#include "../check.h"

enum { OBJECTS = 3, ROWS = 700 }; // more rows than a chunk of "asleep" is filled with at once

static ob_passport passport[OBJECTS];
static ob_motion motion[OBJECTS];
static char path[64], missing[96];

static ob_camera_def camera[2] = {
	{ .name = "main", .eye = { 1, 2, 3 }, .velocity = { .1, 0, 0 }, .fov = .7 },
	{ .name = "other", .eye = { 3, 2, 1 }, .target = { 0, 0, 1 }, .pan = .2, .fov = .9 },
};
static ob_scene scene = { .title = "A title",
			  .text = (char *)"box {}",
			  .text_size = 6,
			  .seed = 5,
			  .record_every = 1,
			  .cameras = 2,
			  .camera = camera,
			  .look = { .sky_top = { .1f, .2f, .3f }, .grid = true } };
static const char *const defines[] = { "n=3" };
static const ob_scene_options options = { .defines = defines, .define_count = 1 };
static ob_run_settings settings;

static ob_record_facts facts(uint32_t capacity)
{
	settings = ob_run_settings_default();
	return (ob_record_facts){ .universe = { .name = "test",
						.arch = "obs",
						.isolation = "thread",
						.capacity = capacity,
						.workers = 2,
						.gravity = { 0, 0, -9.81 },
						.step_length = .01 },
				  .scene = &scene,
				  .path = "scene.lua",
				  .options = &options,
				  .settings = &settings,
				  .duration = 10,
				  .commit = "abc" };
}

// Object 0 is a plane, 1 a box that moves, 2 comes at step 5.
static ob_snapshot at(uint64_t step)
{
	passport[0] = (ob_passport){
		.id = 0, .flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC, .shape = OB_SHAPE_PLANE, .name = "ground"
	};
	passport[1] = (ob_passport){ .id = 1,
				     .flags = OB_OBJECT_PRESENT,
				     .shape = OB_SHAPE_BOX,
				     .size = { .1, .2, .3 },
				     .mass = 4,
				     .inertia = { 5, 6, 7 },
				     .friction = .5,
				     .name = "box" };
	passport[2] = passport[1];
	passport[2].id = 2;
	passport[2].flags = step >= 5 ? OB_OBJECT_PRESENT : 0;
	for (int i = 0; i < OBJECTS; i++)
		motion[i] = (ob_motion){ .t0 = .01 * (double)step, .q = { .5, -.5, .5, .5 } };
	motion[1].p = ob_v3(1, 2, (double)step);
	motion[1].v = ob_v3(3, 4, 5);
	motion[1].w = ob_v3(6, 7, 8);
	motion[2].flags = OB_MOTION_ASLEEP;
	return (ob_snapshot){
		.step = step, .time = .01 * (double)step, .count = OBJECTS, .passport = passport, .motion = motion
	};
}

static bool record(uint64_t rows, bool close_it, ob_error *e)
{
	ob_record_facts about = facts(OBJECTS);
	ob_recorder *r = ob_recorder_create(path, &about, e);
	bool ok = r != NULL;
	for (uint64_t step = 0; step < rows && ok; step++) {
		ob_snapshot s = at(step);
		ok = ob_recorder_append(r, &s, e);
	}
	if (!close_it)
		return ok;
	bool closed = ob_recorder_close(r, ok ? e : NULL);
	return ok && closed;
}

// All of a dataset; its dimensions must be as given.
static bool read_all(hid_t file, const char *name, hid_t type, int rank, const hsize_t *dims, void *out)
{
	hsize_t found[4] = { 0 };
	hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
	bool ok = H5Sget_simple_extent_ndims(space) == rank && H5Sget_simple_extent_dims(space, found, NULL) == rank &&
		  memcmp(found, dims, (size_t)rank * sizeof *dims) == 0 &&
		  H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0;
	H5Sclose(space);
	H5Dclose(set);
	return ok;
}

static hsize_t rows_of(hid_t file)
{
	hsize_t rows = 0;
	hid_t set = H5Dopen2(file, "time", H5P_DEFAULT), space = H5Dget_space(set);
	H5Sget_simple_extent_dims(space, &rows, NULL);
	H5Sclose(space);
	H5Dclose(set);
	return rows;
}

static bool has_text(hid_t file, const char *object, const char *name, const char *text)
{
	char found[256] = "";
	hid_t a = H5Aopen_by_name(file, object, name, H5P_DEFAULT, H5P_DEFAULT), type = H5Aget_type(a);
	bool ok = H5Tget_size(type) < sizeof found && H5Aread(a, type, found) >= 0 && strcmp(found, text) == 0;
	H5Tclose(type);
	H5Aclose(a);
	return ok;
}

static void test_numbers(void)
{
	static double time[ROWS], p[ROWS][OBJECTS][3], q[ROWS][OBJECTS][4], v[ROWS][OBJECTS][3], w[ROWS][OBJECTS][3];
	static uint64_t step[ROWS];
	static uint8_t asleep[ROWS][OBJECTS];
	ob_error e = { "" };
	CHECK(record(ROWS, true, &e));
	hid_t f = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	CHECK(f >= 0);
	const hsize_t row[] = { ROWS }, three[] = { ROWS, OBJECTS, 3 }, four[] = { ROWS, OBJECTS, 4 };
	CHECK(read_all(f, "time", H5T_NATIVE_DOUBLE, 1, row, time));
	CHECK(read_all(f, "step", H5T_NATIVE_UINT64, 1, row, step));
	CHECK(read_all(f, "position", H5T_NATIVE_DOUBLE, 3, three, p));
	CHECK(read_all(f, "attitude", H5T_NATIVE_DOUBLE, 3, four, q));
	CHECK(read_all(f, "velocity", H5T_NATIVE_DOUBLE, 3, three, v));
	CHECK(read_all(f, "angular_velocity", H5T_NATIVE_DOUBLE, 3, three, w));
	CHECK(read_all(f, "asleep", H5T_NATIVE_UINT8, 2, three, asleep));
	for (int i = 0; i < ROWS; i++) {
		CHECK(time[i] == .01 * i && step[i] == (uint64_t)i);
		CHECK(p[i][1][0] == 1 && p[i][1][1] == 2 && p[i][1][2] == i);
		CHECK(q[i][1][0] == .5 && q[i][1][1] == -.5);
		CHECK(v[i][1][2] == 5 && w[i][1][0] == 6);
		CHECK(i < 5 ? isnan(p[i][2][0]) && isnan(q[i][2][3]) && asleep[i][2] == 255 : asleep[i][2] == 1);
	}
	H5Fclose(f);
}

static void test_facts(void)
{
	char name[OBJECTS][OB_NAME_MAX], shape[OBJECTS][12];
	double size[OBJECTS][3], mass[OBJECTS], gravity[3];
	uint8_t is_static[OBJECTS];
	const hsize_t n[] = { OBJECTS, 3 };
	hid_t f = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), text = H5Tcopy(H5T_C_S1);
	H5Tset_strpad(text, H5T_STR_NULLPAD);
	H5Tset_size(text, OB_NAME_MAX);
	CHECK(read_all(f, "objects/name", text, 1, n, name));
	H5Tset_size(text, 12);
	CHECK(read_all(f, "objects/shape", text, 1, n, shape));
	H5Tclose(text);
	CHECK(read_all(f, "objects/size", H5T_NATIVE_DOUBLE, 2, n, size));
	CHECK(read_all(f, "objects/mass", H5T_NATIVE_DOUBLE, 1, n, mass));
	CHECK(read_all(f, "objects/static", H5T_NATIVE_UINT8, 1, n, is_static));
	CHECK(strcmp(name[0], "ground") == 0 && strcmp(name[2], "box") == 0);
	CHECK(strcmp(shape[0], "plane") == 0 && strcmp(shape[1], "box") == 0);
	CHECK(size[1][2] == .3 && mass[1] == 4 && mass[2] == 4 && is_static[0] == 1 && is_static[1] == 0);
	hid_t g = H5Aopen(f, "gravity", H5P_DEFAULT);
	CHECK(H5Aread(g, H5T_NATIVE_DOUBLE, gravity) >= 0 && gravity[2] == -9.81);
	H5Aclose(g);
	CHECK(has_text(f, ".", "title", "A title"));
	CHECK(has_text(f, ".", "arch", "obs"));
	CHECK(has_text(f, "position", "units", "m"));
	CHECK(has_text(f, "angular_velocity", "units", "rad/s"));
	CHECK(has_text(f, "attitude", "frame", "body to world"));
	CHECK(has_text(f, "objects/inertia", "units", "kg m^2"));
	H5Fclose(f);
}

// The writer ends at once after its last append, as a crash does: all that was appended is there.
static void test_killed(void)
{
	enum { KILLED_ROWS = 37 };
	static double time[KILLED_ROWS];
	unlink(path);
	pid_t child = fork();
	if (child == 0) {
		ob_error e;
		if (record(KILLED_ROWS, false, &e))
			kill(getpid(), SIGKILL);
		_exit(1);
	}
	int status = 0;
	waitpid(child, &status, 0);
	CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
	const hsize_t row[] = { KILLED_ROWS };
	hid_t f = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	CHECK(f >= 0);
	CHECK(read_all(f, "time", H5T_NATIVE_DOUBLE, 1, row, time));
	CHECK(time[KILLED_ROWS - 1] == .01 * (KILLED_ROWS - 1));
	H5Fclose(f);
}

// A disk that is full, as a limit on the size of files: one line with the reason, and what fitted is there.
static void test_full(void)
{
	pid_t child = fork();
	if (child == 0) {
		ob_error e = { "" };
		signal(SIGXFSZ, SIG_IGN);
		setrlimit(RLIMIT_FSIZE, &(struct rlimit){ 3000000, 3000000 });
		bool ok = record(1000000, true, &e);
		bool said = strstr(e.text, path) && strstr(e.text, "append") && strstr(e.text, "File too large");
		if (!said)
			fprintf(stderr, "said: %s\n", e.text);
		exit(ok || !said ? 1 : 0);
	}
	int status = 0;
	waitpid(child, &status, 0);
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
	hid_t f = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	CHECK(f >= 0);
	hsize_t rows = rows_of(f);
	CHECK(rows > 1000);
	double *time = calloc(rows, sizeof *time);
	CHECK(read_all(f, "time", H5T_NATIVE_DOUBLE, 1, &rows, time));
	CHECK(time[rows - 1] == .01 * (double)(rows - 1));
	free(time);
	H5Fclose(f);
}

static void test_errors(void)
{
	ob_error e = { "" };
	ob_record_facts about = facts(OBJECTS);
	snprintf(missing, sizeof missing, "%s.dir/file.h5", path);
	CHECK(!ob_recorder_create(missing, &about, &e));
	CHECK(strstr(e.text, missing) && strstr(e.text, "No such file or directory"));
	CHECK(ob_recorder_close(NULL, &e));
}

// Objects whose ids there were no columns for get some, which say that they were not there before.
static void test_growth(void)
{
	enum { MANY = 40 };
	static ob_passport all[MANY];
	static ob_motion moves[MANY];
	double p[2][MANY][3];
	ob_error e = { "" };
	ob_record_facts about = facts(1);
	ob_recorder *r = ob_recorder_create(path, &about, &e);
	CHECK(r);
	for (uint32_t i = 0; i < MANY; i++) {
		all[i] = (ob_passport){
			.id = i, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_SPHERE, .size = { 1, 0, 0 }
		};
		moves[i] = (ob_motion){ .q = { 1, 0, 0, 0 }, .p = { i, 0, 0 } };
	}
	ob_snapshot s = { .count = MANY, .passport = all, .motion = moves };
	for (uint32_t i = 1; i < MANY; i++)
		all[i].flags = 0;
	CHECK(r && ob_recorder_append(r, &s, &e));
	all[MANY - 1].flags = OB_OBJECT_PRESENT;
	s.step = 1;
	s.time = .01;
	CHECK(r && ob_recorder_append(r, &s, &e));
	CHECK(ob_recorder_close(r, &e));
	hid_t f = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	CHECK(read_all(f, "position", H5T_NATIVE_DOUBLE, 3, (hsize_t[]){ 2, MANY, 3 }, p));
	CHECK(p[0][0][0] == 0 && isnan(p[0][MANY - 1][0]) && p[1][MANY - 1][0] == MANY - 1 && isnan(p[1][1][0]));
	H5Fclose(f);
}

// With a path: leaves the record of test_read.py there.
int main(int argc, char **argv)
{
	if (argc > 1) {
		ob_error e = { "" };
		snprintf(path, sizeof path, "%s", argv[1]);
		CHECK(record(ROWS, true, &e));
		return check_end();
	}
	snprintf(path, sizeof path, "/tmp/obsim-test-record-%d.h5", (int)getpid());
	test_numbers();
	test_facts();
	test_killed();
	test_full();
	test_errors();
	test_growth();
	unlink(path);
	return check_end();
}
