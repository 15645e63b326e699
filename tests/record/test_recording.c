// Reading a record gives the recorded snapshots; a damaged record, or another file, gives one line.
#include <fcntl.h>
#include <hdf5.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/budget.h"
#include "hull/hull.h"
#include "record/record.h"
#include "record/recording.h"

#include "../check.h"

enum { OBJECTS = 40, STATES = 300, EVERY = 3, HULLS = 7 };
static const double step_length = .01;
static char path[64], fifo[80];

static ob_hull tetrahedron, prism;

static void build_hulls(void)
{
	static const ob_vec3 point[6] = {
		{ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 2 }, { 1, 0, 2 }, { 0, 1, 2 }
	};
	ob_error e;
	CHECK(ob_hull_build(point, 4, &tetrahedron, &e) && ob_hull_build(point, 6, &prism, &e));
}

// Joints at each state: 0 of the objects 1 and 2, which breaks at 30; 1 of 3 and the world, from 20 to 60; the same at 90, of the
// other object of that id.
static uint32_t join(uint64_t state, ob_joint_passport joint[2])
{
	const bool third = (state >= 20 && state < 60) || state >= 90;
	memset(joint, 0, 2 * sizeof *joint);
	joint[0] = (ob_joint_passport){ .object = { 1, 2 },
					.generation = { 1, 1 },
					.kind = OB_JOINT_HINGE,
					.flags = OB_JOINT_DRIVEN | (state >= 30 ? OB_JOINT_BROKEN : 0),
					.frame = { { { 1, 2, 3 }, { .5, -.5, .5, .5 } }, { .q = { 1, 0, 0, 0 } } },
					.length = .25,
					.name = "hinge#0" };
	if (third)
		joint[1] = (ob_joint_passport){ .object = { 3, OB_JOINT_WORLD },
						.generation = { 1 + (state >= 90), 0 },
						.frame = { { .q = { 1, 0, 0, 0 } }, { .q = { 1, 0, 0, 0 } } },
						.name = "eye" };
	return 1 + third;
}

// Objects at each state: 0 a plane, 1 a ball in flight that rebounds every 50 states, 2 moves each step, 3 comes at
// state 20, changes colour at 40 and goes at 60, from 80 on another has its id; 39 comes at the end. 2 is a hull, and 3 is one,
// of another number, from 80 on.
static ob_snapshot at(uint64_t state)
{
	static ob_passport passport[OBJECTS];
	static ob_motion motion[OBJECTS];
	static ob_hull *hull[HULLS];
	static ob_joint_passport joint[2];
	const double t = step_length * EVERY * (double)state;
	memset(passport, 0, sizeof passport);
	memset(motion, 0, sizeof motion);
	memset(hull, 0, sizeof hull);
	for (uint32_t id = 0; id < OBJECTS; id++) {
		bool there = id < 3 || (id == 3 && state >= 20 && state < 60) || (id == 3 && state >= 80) ||
			     (id == OBJECTS - 1 && state == STATES - 1);
		if (!there)
			continue;
		passport[id] = (ob_passport){ .id = id,
					      .generation = 1 + (id == 3 && state >= 80),
					      .flags = OB_OBJECT_PRESENT,
					      .shape = OB_SHAPE_BOX,
					      .size = { .1, .2, .3 },
					      .mass = 2,
					      .inertia = { 1, 2, 3 },
					      .friction = .5,
					      .colour = { .2f, state >= 40 ? .9f : .1f, .3f, 1 } };
		snprintf(passport[id].name, OB_NAME_MAX, "object %u", id);
		motion[id] = (ob_motion){ .t0 = id == 1   ? .5 * step_length * EVERY * (double)(state / 50 * 50)
						: id == 2 ? t
							  : 0,
					  .valid_until = id == 1 ? INFINITY : t + 1,
					  .q = { .5, -.5, .5, .5 },
					  .p = { id, (double)(id == 2 ? state : 0), .1 },
					  .v = { 1, 0, 3 },
					  .w = { .1, .2, .3 },
					  .a = { 0, 0, -9.81 },
					  .flags = id == 1 ? OB_MOTION_FREE : 0 };
		if (id != 1)
			motion[id].valid_until = 1;
	}
	passport[2].shape = OB_SHAPE_HULL;
	passport[2].size = ob_v3(.3, .2, .1);
	passport[2].hull = 5;
	hull[5] = &tetrahedron;
	if (state >= 80) {
		passport[3].shape = OB_SHAPE_HULL;
		passport[3].size = passport[2].size;
		passport[3].hull = 1;
		hull[1] = &prism;
	}
	passport[0].shape = OB_SHAPE_PLANE;
	passport[0].flags |= OB_OBJECT_STATIC;
	return (ob_snapshot){ .step = EVERY * (state + 2),
			      .time = step_length * (double)(EVERY * (state + 2)),
			      .count = OBJECTS,
			      .passport = passport,
			      .motion = motion,
			      .joints = join(state, joint),
			      .joint = joint,
			      .hulls = HULLS,
			      .hull = hull };
}

// One of a single colour, and one whose two triangles have pictures of their own.
static ob_mesh_vertex vertex[4] = {
	{ .position = { 1, 0, 0 }, .normal = { 0, 0, 1 }, .colour = { -1, -1, -1 }, .surface = -1 },
	{ .position = { 0, 1, 0 },
	  .normal = { 0, 0, 1 },
	  .colour = { .1f, .2f, .3f },
	  .surface = 15.5f,
	  .texture = { 1, -.5f } },
	{ .position = { 0, 0, 0 }, .normal = { 0, 0, 1 }, .colour = { .1f, .2f, .3f }, .texture = { .25f, 3 } },
	{ .position = { 1, 1, 0 }, .normal = { 0, 0, 1 }, .colour = { 1, 1, 1 } },
};
static uint32_t triangle[6] = { 0, 1, 2, 0, 3, 1 };
static uint8_t wide[4 * 3 * 2] = { 1, 2, 3, 4, 250 }, single[4] = { 9, 8, 7, 255 };
static ob_mesh_image image[2] = { { 3, 2, wide }, { 1, 1, single } };
static ob_mesh_part part[2] = {
	{ .indices = 3, .colour = 1, .surface = 2, .wrap = { OB_MESH_CLAMP, OB_MESH_MIRROR } },
	{ .indices = 3, .colour = 2 },
};
static ob_mesh mesh[2] = {
	{ .vertices = 3, .vertex = vertex, .indices = 3, .index = triangle },
	{ .vertices = 4,
	  .vertex = vertex,
	  .indices = 6,
	  .index = triangle,
	  .parts = 2,
	  .part = part,
	  .images = 2,
	  .image = image },
};

static void check_mesh(const ob_mesh *was, const ob_mesh *now)
{
	CHECK(now->vertices == was->vertices &&
	      memcmp(now->vertex, was->vertex, was->vertices * sizeof *was->vertex) == 0);
	CHECK(now->indices == was->indices && memcmp(now->index, was->index, was->indices * sizeof *was->index) == 0);
	CHECK(now->parts == was->parts && now->images == was->images);
	for (uint32_t i = 0; i < was->parts && i < now->parts; i++)
		CHECK(memcmp(&now->part[i], &was->part[i], sizeof *was->part) == 0);
	for (uint32_t i = 0; i < was->images && i < now->images; i++)
		CHECK(now->image[i].width == was->image[i].width && now->image[i].height == was->image[i].height &&
		      memcmp(now->image[i].rgba, was->image[i].rgba, 4 * was->image[i].width * was->image[i].height) ==
			      0);
}

static void record(uint64_t states)
{
	static ob_camera_def camera[2] = {
		{ .name = "main", .eye = { 1, 2, 3 }, .velocity = { .1, 0, 0 }, .fov = .7 },
		{ .name = "other", .eye = { 3, 2, 1 }, .target = { 0, 0, 1 }, .pan = .2, .tilt = -.1, .fov = .9 },
	};
	static ob_scene scene = { .title = "A title",
				  .text = (char *)"box {}",
				  .text_size = 6,
				  .seed = 5,
				  .record_every = EVERY,
				  .cameras = 2,
				  .camera = camera,
				  .meshes = 2,
				  .mesh = mesh,
				  .look = { .sky_top = { .1f, .2f, .3f }, .grid = true, .sun = { 0, 1, 2 } } };
	static const ob_scene_options options;
	ob_run_settings settings = ob_run_settings_default();
	ob_error e = { "" };
	ob_record_facts facts = { .universe = { .name = "test",
						.arch = "obs",
						.isolation = "thread",
						.capacity = 4,
						.workers = 2,
						.gravity = { 0, 0, -9.81 },
						.step_length = step_length },
				  .scene = &scene,
				  .path = "scene.lua",
				  .options = &options,
				  .settings = &settings,
				  .duration = 10,
				  .commit = "abc" };
	ob_recorder *r = ob_recorder_create(path, &facts, &e);
	CHECK(r);
	for (uint64_t i = 0; r && i < states; i++) {
		ob_snapshot s = at(i);
		CHECK(ob_recorder_append(r, &s, &e));
	}
	CHECK(ob_recorder_close(r, &e));
}

// Compares the drawn part of a motion: the rest is the simulators' own.
static bool same_motion(const ob_motion *a, const ob_motion *b)
{
	return a->t0 == b->t0 && a->valid_until == b->valid_until && memcmp(&a->p, &b->p, sizeof a->p) == 0 &&
	       memcmp(&a->q, &b->q, sizeof a->q) == 0 && memcmp(&a->v, &b->v, sizeof a->v) == 0 &&
	       memcmp(&a->w, &b->w, sizeof a->w) == 0 && memcmp(&a->a, &b->a, sizeof a->a) == 0 && a->flags == b->flags;
}

// Compares the recorded part of joints: neither strength nor what acts along axes.
static void check_joints(const ob_snapshot *was, const ob_snapshot *now)
{
	for (uint32_t i = 0; i < was->joints || i < now->joints; i++) {
		const ob_joint_passport *a = &was->joint[i], *b = &now->joint[i];
		CHECK(ob_snapshot_has_joint(was, i) == ob_snapshot_has_joint(now, i));
		if (ob_snapshot_has_joint(was, i))
			CHECK(memcmp(a, b, offsetof(ob_joint_passport, length)) == 0 && a->length == b->length &&
			      strcmp(a->name, b->name) == 0);
	}
}

static void test_same_snapshots(void)
{
	ob_error e = { "" };
	bool ended = false;
	uint64_t states = 0;
	record(STATES);
	ob_recording *r = ob_recording_open(path, &e);
	CHECK(r);
	while (r && ob_recording_next(r, &ended, &e)) {
		ob_snapshot was = at(states);
		const ob_snapshot *now = ob_recording_state(r);
		CHECK(now->step == states + 2 && now->time == was.time);
		check_joints(&was, now);
		for (uint32_t id = 0; id < OBJECTS; id++) {
			bool there = id < now->count && now->passport[id].flags & OB_OBJECT_PRESENT;
			CHECK(there == (was.passport[id].flags & OB_OBJECT_PRESENT));
			if (there)
				CHECK(memcmp(&now->passport[id], &was.passport[id], sizeof *was.passport) == 0 &&
				      same_motion(&now->motion[id], &was.motion[id]));
			const ob_hull *hull = there ? ob_snapshot_hull(&was, id) : NULL;
			if (hull)
				CHECK(memcmp(ob_snapshot_hull(now, id), hull, sizeof *hull) == 0);
		}
		CHECK(ob_recording_population(r) ==
		      1u + (states >= 20) + (states >= 40) + (states >= 60) + (states >= 80) + (states == STATES - 1));
		states++;
	}
	CHECK(ended && states == STATES);
	const ob_recording_info *i = r ? ob_recording_get_info(r) : NULL;
	CHECK(i && i->states == STATES && i->first == 2 && i->interval == EVERY * step_length && i->workers == 2);
	CHECK(i && strcmp(i->scene.title, "A title") == 0 && i->scene.cameras == 2 && i->scene.seed == 5 &&
	      i->scene.look.grid);
	CHECK(i && i->scene.camera[1].pan == .2 && i->scene.camera[0].velocity.x == .1 && i->scene.look.sun.z == 2);
	CHECK(i && i->scene.meshes == 2);
	for (uint32_t k = 0; i && k < i->scene.meshes; k++)
		check_mesh(&mesh[k], &i->scene.mesh[k]);
	CHECK(i && strcmp(i->commit, "abc") == 0 && i->scene.duration == 10 && i->scene.run.gravity.z == -9.81);
	ob_recording_close(r);
}

static void refuse(const char *file, const char *saying)
{
	ob_error e = { "" };
	ob_recording *r = ob_recording_open(file, &e);
	if (r || !strstr(e.text, saying) || !strstr(e.text, file))
		fprintf(stderr, "said: %s\n", e.text);
	CHECK(!r && strstr(e.text, saying) && strstr(e.text, file));
	ob_recording_close(r);
}

// Opens the file, as any program may, and changes it.
static void change(void (*how)(hid_t file))
{
	record(10);
	hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
	how(file);
	H5Fclose(file);
}

static void write_number(hid_t file, const char *set, hsize_t at, const void *number, hid_t type)
{
	hid_t id = H5Dopen2(file, set, H5P_DEFAULT), space = H5Dget_space(id), one = H5Screate(H5S_SCALAR);
	H5Sselect_elements(space, H5S_SELECT_SET, 1, &at);
	CHECK(H5Dwrite(id, type, one, space, H5P_DEFAULT, number) >= 0);
	H5Sclose(one);
	H5Sclose(space);
	H5Dclose(id);
}

static void set_member(hid_t file, const char *set, const char *member, hid_t type, hsize_t at, const void *value)
{
	hid_t compound = H5Tcreate(H5T_COMPOUND, H5Tget_size(type));
	H5Tinsert(compound, member, 0, type);
	write_number(file, set, at, value, compound);
	H5Tclose(compound);
}

static void newer(hid_t file)
{
	hid_t a = H5Aopen(file, "format_version", H5P_DEFAULT);
	H5Awrite(a, H5T_NATIVE_UINT64, &(uint64_t){ 99 });
	H5Aclose(a);
}

static void old(hid_t file)
{
	H5Adelete(file, "format");
	H5Adelete(file, "format_version");
}

static void foreign(hid_t file)
{
	old(file);
	H5Adelete(file, "obsim_version");
}

static void no_motions(hid_t file)
{
	H5Ldelete(file, "motions", H5P_DEFAULT);
}

static void elsewhere(hid_t file)
{
	no_motions(file);
	H5Lcreate_external("/etc/passwd", "/motions", file, "motions", H5P_DEFAULT, H5P_DEFAULT);
}

static void huge(hid_t file)
{
	hid_t set = H5Dopen2(file, "time", H5P_DEFAULT);
	H5Dset_extent(set, (hsize_t[]){ (hsize_t)1 << 50 });
	H5Dclose(set);
}

static void nowhen(hid_t file)
{
	write_number(file, "time", 3, &(double){ NAN }, H5T_NATIVE_DOUBLE);
}

static void too_many(hid_t file)
{
	write_number(file, "motions_until", 9, &(uint64_t){ UINT64_MAX }, H5T_NATIVE_UINT64);
}

static void nan_motion(hid_t file)
{
	set_member(file, "motions", "valid_until", H5T_NATIVE_DOUBLE, 2, &(double){ NAN });
}

static void stranger(hid_t file)
{
	set_member(file, "motions", "id", H5T_NATIVE_UINT32, 2, &(uint32_t){ 1000000 });
}

static void huge_id(hid_t file)
{
	set_member(file, "events", "id", H5T_NATIVE_UINT32, 2, &(uint32_t){ UINT32_MAX });
}

// The highest that there can be, of a plane which nothing else is said of.
static void highest_id(hid_t file)
{
	const uint32_t id = (1 << 20) - 1;
	set_member(file, "events", "id", H5T_NATIVE_UINT32, 0, &id);
	set_member(file, "motions", "id", H5T_NATIVE_UINT32, 0, &id);
}

static void no_shape(hid_t file)
{
	set_member(file, "events", "shape", H5T_NATIVE_UINT32, 2, &(uint32_t){ 1000 });
}

static void heavy(hid_t file)
{
	set_member(file, "events", "mass", H5T_NATIVE_DOUBLE, 2, &(double){ 1e300 });
}

static void tiny(hid_t file)
{
	hid_t vector = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, (hsize_t[]){ 3 });
	set_member(file, "events", "size", vector, 2, (double[]){ 1e-160, 1, 1 });
	H5Tclose(vector);
}

static void twice(hid_t file)
{
	set_member(file, "events", "id", H5T_NATIVE_UINT32, 2, &(uint32_t){ 1 });
}

static void no_hulls(hid_t file)
{
	H5Ldelete(file, "hulls", H5P_DEFAULT);
}

static void another_hull(hid_t file)
{
	set_member(file, "hulls", "number", H5T_NATIVE_UINT32, 0, &(uint32_t){ 4 });
}

static void huge_hull(hid_t file)
{
	set_member(file, "hulls", "number", H5T_NATIVE_UINT32, 0, &(uint32_t){ 1 << 16 });
}

static void many_corners(hid_t file)
{
	set_member(file, "hulls", "corners", H5T_NATIVE_UINT32, 0, &(uint32_t){ 100 });
}

static void no_image(hid_t file)
{
	H5Ldelete(file, "meshes/2/images/2", H5P_DEFAULT);
}

static void flat_image(hid_t file)
{
	H5Ldelete(file, "meshes/2/images/1", H5P_DEFAULT);
	H5Lcreate_hard(file, "meshes/2/parts", file, "meshes/2/images/1", H5P_DEFAULT, H5P_DEFAULT);
}

// In place of one that it could be: as many bytes, of another size.
static void put_image(hid_t file, hsize_t height, hsize_t width, hsize_t depth)
{
	const hsize_t size[3] = { height, width, depth };
	uint8_t *bytes = calloc(height * width * depth, 1);
	H5Ldelete(file, "meshes/2/images/1", H5P_DEFAULT);
	hid_t space = H5Screate_simple(3, size, NULL);
	hid_t set =
		H5Dcreate2(file, "meshes/2/images/1", H5T_NATIVE_UINT8, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	CHECK(bytes && H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >= 0);
	H5Dclose(set);
	H5Sclose(space);
	free(bytes);
}

static void wide_image(hid_t file)
{
	put_image(file, 1, OB_MESH_IMAGE_SIDE_MAX + 1, 4);
}

static void deep_image(hid_t file)
{
	put_image(file, 2, 3, 5);
}

static void long_part(hid_t file)
{
	set_member(file, "meshes/2/parts", "indices", H5T_NATIVE_UINT32, 1, &(uint32_t){ 6 });
}

static void no_wrap(hid_t file)
{
	hid_t pair = H5Tarray_create2(H5T_NATIVE_UINT8, 1, (hsize_t[]){ 2 });
	set_member(file, "meshes/2/parts", "wrap", pair, 0, (uint8_t[]){ 0, 3 });
	H5Tclose(pair);
}

static void nan_texture(hid_t file)
{
	hid_t pair = H5Tarray_create2(H5T_NATIVE_FLOAT, 1, (hsize_t[]){ 2 });
	set_member(file, "meshes/1/vertices", "texture", pair, 2, (float[]){ 0, NAN });
	H5Tclose(pair);
}

static void joint_of_nobody(hid_t file)
{
	hid_t pair = H5Tarray_create2(H5T_NATIVE_UINT32, 1, (hsize_t[]){ 2 });
	set_member(file, "joints", "object", pair, 0, (uint32_t[]){ 1, 3 });
	H5Tclose(pair);
}

static void joint_of_no_kind(hid_t file)
{
	set_member(file, "joints", "joint", H5T_NATIVE_UINT32, 0, &(uint32_t){ OB_JOINT_KINDS });
}

static void huge_joint(hid_t file)
{
	set_member(file, "joints", "number", H5T_NATIVE_UINT32, 0, &(uint32_t){ UINT32_MAX });
}

static void joint_that_goes_first(hid_t file)
{
	set_member(file, "joints", "kind", H5T_NATIVE_UINT32, 0, &(uint32_t){ 3 });
}

static void nan_joint(hid_t file)
{
	hid_t pose = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, (hsize_t[]){ 7 });
	hid_t two = H5Tarray_create2(pose, 1, (hsize_t[]){ 2 });
	set_member(file, "joints", "frame", two, 0, (double[14]){ NAN, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1 });
	H5Tclose(two);
	H5Tclose(pose);
}

static void flat(hid_t file)
{
	set_member(file, "cameras", "fov", H5T_NATIVE_DOUBLE, 0, &(double){ 0 });
}

static void test_damaged(void)
{
	static const struct {
		void (*how)(hid_t file);
		const char *saying;
	} damages[] = {
		{ newer, "of version 99" },
		{ old, "of version 1" },
		{ foreign, "no record of obsim" },
		{ no_motions, "/motions is not as it should be" },
		{ elsewhere, "/motions is a link to something else" },
		{ huge, "/time is not as it should be" },
		{ nowhen, "times" },
		{ too_many, "it lacks motions" },
		{ nan_motion, "a motion makes no sense" },
		{ stranger, "a motion makes no sense" },
		{ huge_id, "its events make no sense" },
		{ no_shape, "an object makes no sense" },
		{ heavy, "an object makes no sense" },
		{ tiny, "an object makes no sense" },
		{ twice, "comes twice" },
		{ joint_of_nobody, "a joint makes no sense" },
		{ joint_of_no_kind, "a joint makes no sense" },
		{ nan_joint, "a joint makes no sense" },
		{ huge_joint, "its joints make no sense" },
		{ joint_that_goes_first, "its joints make no sense" },
		{ flat, "its cameras make no sense" },
		{ no_hulls, "an object makes no sense" },
		{ another_hull, "an object makes no sense" },
		{ huge_hull, "its hulls make no sense" },
		{ many_corners, "its hulls make no sense" },
		{ no_image, "its meshes make no sense" },
		{ flat_image, "/meshes/2/images/1 is not as it should be" },
		{ wide_image, "its meshes make no sense" },
		{ deep_image, "its meshes make no sense" },
		{ long_part, "its meshes make no sense" },
		{ no_wrap, "its meshes make no sense" },
		{ nan_texture, "its meshes make no sense" },
	};
	for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
		change(damages[i].how);
		refuse(path, damages[i].saying);
	}
	record(0);
	refuse(path, "this record is empty");
}

// Whatever a file names, what reads it stays small.
static void test_little_memory(void)
{
	ob_error e = { "" };
	struct rusage used;
	bool ended = false;
	change(highest_id);
	ob_recording *r = ob_recording_open(path, &e);
	while (r && ob_recording_next(r, &ended, &e))
		;
	CHECK(ended);
	ob_recording_close(r);
	CHECK(getrusage(RUSAGE_CHILDREN, &used) == 0 && used.ru_maxrss < 1000000); // kB
}

// In place of the C library's: while a record is read by a child, it goes no further than here.
static int stuck = -1;
static struct {
	unsigned alarms; // set by children
	rlim_t cpu; // s, last limit of a child
} * seen; // in shared memory

__attribute__((visibility("default"))) unsigned alarm(unsigned seconds)
{
	seen->alarms += seconds > 0;
	if (stuck >= 0 && write(stuck, "", 1) == 1)
		for (;;)
			pause();
	return 0;
}

// The child that reads has the pipe open as long as it lives: it does not outlive the program, however this ends.
static void test_child_dies_with_the_program(void)
{
	int ends[2];
	char byte;
	ob_error e;
	record(10);
	CHECK(pipe(ends) == 0);
	const pid_t program = fork();
	if (program == 0) {
		stuck = ends[1];
		ob_recording_open(path, &e);
		_exit(0);
	}
	close(ends[1]);
	CHECK(read(ends[0], &byte, 1) == 1);
	CHECK(kill(program, SIGKILL) == 0 && waitpid(program, NULL, 0) == program);
	CHECK(read(ends[0], &byte, 1) == 0);
	close(ends[0]);
}

__attribute__((visibility("default"))) int setrlimit(__rlimit_resource_t resource, const struct rlimit *limit)
{
	if (resource == RLIMIT_CPU)
		seen->cpu = limit->rlim_cur;
	return (int)syscall(SYS_prlimit64, 0, resource, limit, NULL);
}

// In place of the C library's: a clock of CPU time by which each look at it takes so long.
static time_t slowness, slow_time; // s
static time_t last_time = INT32_MAX; // a process dies then, as at its limit of CPU time

__attribute__((visibility("default"))) int clock_gettime(clockid_t id, struct timespec *t)
{
	if (!slowness || id != CLOCK_PROCESS_CPUTIME_ID)
		return (int)syscall(SYS_clock_gettime, id, t);
	slow_time += slowness;
	if (slow_time >= last_time)
		raise(SIGXCPU);
	*t = (struct timespec){ .tv_sec = slow_time };
	return 0;
}

enum { SECONDS = OB_BUDGET_SECONDS / 2 };

// The limit of CPU time does not grow with the file.
static void test_flat_limit(void)
{
	ob_error e;
	rlim_t limit[2];
	record(10);
	for (int i = 0; i < 2; i++) {
		seen->cpu = 0;
		ob_recording_close(ob_recording_open(path, &e));
		limit[i] = seen->cpu;
		const int fd = open(path, O_WRONLY | O_CLOEXEC);
		CHECK(posix_fallocate(fd, 0, 192 << 20) == 0);
		close(fd);
	}
	CHECK(limit[0] > 0 && limit[0] <= SECONDS && limit[1] == limit[0]);
}

static uint64_t play(ob_recording *r, bool *ended, ob_error *e)
{
	uint64_t states = 0;
	*ended = false;
	while (r && ob_recording_next(r, ended, e))
		states++;
	ob_recording_close(r);
	return states;
}

static void late_nan_motion(hid_t file)
{
	hid_t set = H5Dopen2(file, "motions", H5P_DEFAULT), space = H5Dget_space(set);
	const hsize_t count = (hsize_t)H5Sget_simple_extent_npoints(space);
	H5Sclose(space);
	H5Dclose(set);
	set_member(file, "motions", "valid_until", H5T_NATIVE_DOUBLE, count - 1, &(double){ NAN });
}

// A record whose reading takes long is opened after a part of it, and then read as it is played: never states that the
// child has not read.
static void test_long_record(void)
{
	ob_error e = { "" };
	bool ended;
	char too_long[32];
	snprintf(too_long, sizeof too_long, "more than %d s of CPU", SECONDS);
	record(STATES);
	slowness = 1;
	seen->alarms = 0;
	ob_recording *r = ob_recording_open(path, &e);
	CHECK(r && seen->alarms == 1);
	CHECK(play(r, &ended, &e) == STATES && ended && seen->alarms >= STATES / 3);
	slowness = 1000; // no advance leaves time for a second state
	CHECK(play(ob_recording_open(path, &e), &ended, &e) == STATES && ended);
	slowness = 1;
	last_time = 20;
	CHECK(play(ob_recording_open(path, &e), &ended, &e) > 0 && !ended && strstr(e.text, too_long));
	last_time = 1;
	CHECK(!ob_recording_open(path, &e) && strstr(e.text, too_long));
	last_time = INT32_MAX;
	change(late_nan_motion);
	CHECK(play(ob_recording_open(path, &e), &ended, &e) > 0 && !ended && strstr(e.text, "a motion makes no sense"));
	r = ob_recording_open(path, &e);
	CHECK(r);
	ob_recording_close(r); // and its child ends, too
	slowness = 0;
	CHECK(waitpid(-1, NULL, 0) < 0);
}

static void test_no_record(void)
{
	record(10);
	CHECK(truncate(path, 20000) == 0);
	refuse(path, "cut short");
	CHECK(truncate(path, 0) == 0);
	refuse(path, "no HDF5 file");
	refuse("/nonexistent/record.h5", "No such file or directory");
	refuse("/tmp", "no file");
	snprintf(fifo, sizeof fifo, "%s.fifo", path);
	CHECK(mkfifo(fifo, 0600) == 0);
	refuse(fifo, "no file"); // and nobody waits for who would write it
	unlink(fifo);
}

int main(void)
{
	snprintf(path, sizeof path, "/tmp/obsim-test-recording-%d.h5", (int)getpid());
	H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
	seen = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	CHECK(seen != MAP_FAILED);
	build_hulls();
	test_same_snapshots();
	test_damaged();
	test_little_memory();
	test_child_dies_with_the_program();
	test_flat_limit();
	test_long_record();
	test_no_record();
	unlink(path);
	return check_end();
}
