#include "record/layout.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "shape/shape.h"

// A new member of one of these structures may be needed to draw a record again: decide here.
static_assert(sizeof(ob_passport) == 184 && sizeof(ob_motion) == 176, "members of /events and /motions");
static_assert(sizeof(ob_hull) == 7040, "members of /hulls");
static_assert(sizeof(ob_joint_passport) == 416, "members of /joints");
static_assert(sizeof(ob_camera_def) == 200 && sizeof(ob_look_def) == 64, "members of /cameras and /look");

// A brace that clang-format would spread over lines
#define MEMBER(...) \
	{ \
		__VA_ARGS__ \
	}
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

#define EVENT(name, type) MEMBER(#name, type, offsetof(ob_record_event, name), 0)
#define PASSPORT(name, type) MEMBER(#name, type, offsetof(ob_record_event, passport.name), 0)
static const ob_record_member event_members[] = {
	EVENT(step, OB_RECORD_U64),           EVENT(time, OB_RECORD_F64),          EVENT(kind, OB_RECORD_U32),
	PASSPORT(id, OB_RECORD_U32),          PASSPORT(generation, OB_RECORD_U32), PASSPORT(flags, OB_RECORD_U32),
	PASSPORT(shape, OB_RECORD_U8),        PASSPORT(hull, OB_RECORD_U16),       PASSPORT(size, OB_RECORD_VEC3),
	PASSPORT(mass, OB_RECORD_F64),        PASSPORT(inertia, OB_RECORD_VEC3),   PASSPORT(friction, OB_RECORD_F64),
	PASSPORT(restitution, OB_RECORD_F64), PASSPORT(colour, OB_RECORD_RGBA),    PASSPORT(name, OB_RECORD_NAME),
	PASSPORT(force, OB_RECORD_VEC3),      PASSPORT(roughness, OB_RECORD_F32),  PASSPORT(metal, OB_RECORD_F32),
	PASSPORT(mesh, OB_RECORD_U8),
};
const ob_record_table ob_record_events = {
	{ "events", "SI; colour: linear RGB, alpha", "size, inertia: body; force: world",
	  "objects that come (kind 1), change (2) and go (3), in the order of steps; shape: from 1," OB_SHAPE_NAMES
	  "; flags: 1 present, 2 static, 8 kinematic, 64 a sensor, 128 not drawn" },
	sizeof(ob_record_event),
	COUNT(event_members),
	event_members,
};

#define JOINT(name, type) MEMBER(#name, type, offsetof(ob_record_joint, name), 0)
#define JOINT_PASSPORT(name, member, type, length) \
	MEMBER(name, type, offsetof(ob_record_joint, passport.member), length)
static const ob_record_member joint_members[] = {
	JOINT(step, OB_RECORD_U64),
	JOINT(time, OB_RECORD_F64),
	JOINT(kind, OB_RECORD_U32),
	JOINT(number, OB_RECORD_U32),
	JOINT_PASSPORT("object", object, OB_RECORD_U32, 2),
	JOINT_PASSPORT("generation", generation, OB_RECORD_U32, 2),
	JOINT_PASSPORT("joint", kind, OB_RECORD_U32, 0),
	JOINT_PASSPORT("flags", flags, OB_RECORD_U32, 0),
	JOINT_PASSPORT("frame", frame, OB_RECORD_POSE, 2),
	JOINT_PASSPORT("length", length, OB_RECORD_F64, 0),
	JOINT_PASSPORT("name", name, OB_RECORD_NAME, 0),
};
const ob_record_table ob_record_joints = {
	{ "joints", "SI", "frame: of each object's body, the world's for object 4294967295: place, attitude w x y z",
	  "joints that come (kind 1), break (2) and go (3), in the order of steps; joint: from 0, ball, hinge, slider, "
	  "fixed, universal, distance, apart; flags: 1 its objects collide, 2 something acts along its axis, 4 "
	  "broken" },
	sizeof(ob_record_joint),
	COUNT(joint_members),
	joint_members,
};

#define MOTION(name, type) MEMBER(#name, type, offsetof(ob_record_motion, motion.name), 0)
static const ob_record_member motion_members[] = {
	{ "id", OB_RECORD_U32, offsetof(ob_record_motion, id), 0 },
	{ "island", OB_RECORD_U32, offsetof(ob_record_motion, island), 0 },
	MOTION(substeps, OB_RECORD_U16),
	MOTION(flags, OB_RECORD_U32),
	MOTION(t0, OB_RECORD_F64),
	MOTION(valid_until, OB_RECORD_F64),
	MOTION(p, OB_RECORD_VEC3),
	MOTION(q, OB_RECORD_QUAT),
	MOTION(v, OB_RECORD_VEC3),
	MOTION(w, OB_RECORD_VEC3),
	MOTION(a, OB_RECORD_VEC3),
	MOTION(frequency, OB_RECORD_F64),
};
const ob_record_table ob_record_motions = {
	{ "motions", "SI", "world, right-handed, z up; q: body to world, w x y z",
	  "how an object moves from t0 on: p, v on a parabola with a; q, w as a free rigid body; flags: 1 in free "
	  "flight, "
	  "2 asleep, 8 in equilibrium, 16 on an ellipse with a frequency; island: lowest id of the bodies solved with "
	  "it; "
	  "substeps: those that it needs" },
	sizeof(ob_record_motion),
	COUNT(motion_members),
	motion_members,
};

#define HULL(name, type) MEMBER(#name, type, offsetof(ob_record_hull, hull.name), 0)
#define HULL_ARRAY(name, type) MEMBER(#name, type, offsetof(ob_record_hull, hull.name), COUNT(((ob_hull *)NULL)->name))
static const ob_record_member hull_members[] = {
	{ "number", OB_RECORD_U32, offsetof(ob_record_hull, number), 0 },
	HULL(corners, OB_RECORD_U32),
	HULL(faces, OB_RECORD_U32),
	HULL(edges, OB_RECORD_U32),
	HULL(parts, OB_RECORD_U16),
	HULL(is_part, OB_RECORD_U16),
	HULL(radius, OB_RECORD_F64),
	HULL(inner, OB_RECORD_F64),
	HULL(thickness, OB_RECORD_F64),
	HULL(volume, OB_RECORD_F64),
	HULL(inertia, OB_RECORD_VEC3),
	HULL(centre, OB_RECORD_VEC3),
	HULL(frame, OB_RECORD_QUAT),
	HULL(round, OB_RECORD_U32),
	HULL(size, OB_RECORD_VEC3),
	HULL_ARRAY(corner, OB_RECORD_VEC3),
	HULL_ARRAY(normal, OB_RECORD_VEC3),
	HULL_ARRAY(offset, OB_RECORD_F64),
	HULL_ARRAY(first, OB_RECORD_U16),
	HULL_ARRAY(loop, OB_RECORD_U8),
	HULL_ARRAY(edge, OB_RECORD_EDGE),
};
const ob_record_table ob_record_hulls = {
	{ "hulls", "SI", "body: the centre of mass, the principal axes",
	  "convex hulls, by the number that events have as hull: the first so many of corner, normal and offset (of "
	  "faces), "
	  "edge; face f has the corners loop[first[f]] .. loop[first[f + 1] - 1], counterclockwise seen from outside" },
	sizeof(ob_record_hull),
	COUNT(hull_members),
	hull_members,
};

#define SENSOR(name, type) MEMBER(#name, type, offsetof(ob_sensor_passport, name), 0)
static const ob_record_member sensor_members[] = {
	SENSOR(name, OB_RECORD_NAME), SENSOR(kind, OB_RECORD_U32),  SENSOR(object, OB_RECORD_U32),
	SENSOR(joint, OB_RECORD_U32), SENSOR(width, OB_RECORD_U32), SENSOR(pose, OB_RECORD_POSE),
	SENSOR(rate, OB_RECORD_F64),  SENSOR(delay, OB_RECORD_F64), SENSOR(beams, OB_RECORD_U32),
	SENSOR(rows, OB_RECORD_U32),  SENSOR(fan, OB_RECORD_F64),   SENSOR(rise, OB_RECORD_F64),
	SENSOR(reach, OB_RECORD_F64),
};
const ob_record_table ob_record_sensors = {
	{ "sensors", "SI, Hz, rad", "pose: in the object's frame",
	  "kind: from 0, imu, encoder, force_torque, touch, lidar, camera; rate 0: a sample in each step" },
	sizeof(ob_sensor_passport),
	COUNT(sensor_members),
	sensor_members,
};

#define SAMPLE(name, type, length) MEMBER(#name, type, offsetof(ob_record_sample, name), length)
static const ob_record_member sample_members[] = {
	SAMPLE(sensor, OB_RECORD_U32, 0),
	SAMPLE(first, OB_RECORD_U32, 0),
	SAMPLE(number, OB_RECORD_U64, 0),
	SAMPLE(time, OB_RECORD_F64, 0),
	SAMPLE(value, OB_RECORD_F64, OB_RECORD_VALUES),
};
const ob_record_table ob_record_samples = {
	{ "samples", "SI", "the sensor's",
	  "samples that could be read at recorded states, six values a row, from the index `first` on; NaN: no value. "
	  "Of a camera the first value is the row of its first pixel in "
	  "/pixels" },
	sizeof(ob_record_sample),
	COUNT(sample_members),
	sample_members,
};

static const ob_record_member pixel_members[] = {
	MEMBER("depth", OB_RECORD_F32, offsetof(ob_pixel, depth), 0),
	MEMBER("id", OB_RECORD_U32, offsetof(ob_pixel, id), 0),
	MEMBER("colour", OB_RECORD_U8, offsetof(ob_pixel, rgba), 4),
};
const ob_record_table ob_record_pixels = {
	{ "pixels", "m, 1, sRGB", "the camera's",
	  "pictures of cameras, row after row, from the upper left: depth along the view, id of the object "
	  "(4294967295: none), colour" },
	sizeof(ob_pixel),
	COUNT(pixel_members),
	pixel_members,
};

#define CAMERA(name, type) MEMBER(#name, type, offsetof(ob_camera_def, name), 0)
static const ob_record_member camera_members[] = {
	CAMERA(name, OB_RECORD_NAME),     CAMERA(eye, OB_RECORD_VEC3),       CAMERA(target, OB_RECORD_VEC3),
	CAMERA(velocity, OB_RECORD_VEC3), CAMERA(pan, OB_RECORD_F64),        CAMERA(tilt, OB_RECORD_F64),
	CAMERA(fov, OB_RECORD_F64),       CAMERA(automatic, OB_RECORD_FLAG), CAMERA(aboard, OB_RECORD_FLAG),
	CAMERA(follow, OB_RECORD_NAME),
};
const ob_record_table ob_record_cameras = {
	{ "cameras", "m, m/s, rad, rad/s", "world, right-handed, z up",
	  "the scene's: the eye and its target travel with a velocity, it turns by pan and tilt; fov: vertical; "
	  "automatic: it goes along with what moves; follow: with the object of this name, aboard: and turns with it" },
	sizeof(ob_camera_def),
	COUNT(camera_members),
	camera_members,
};

#define LOOK(name, type) MEMBER(#name, type, offsetof(ob_look_def, name), 0)
static const ob_record_member look_members[] = {
	LOOK(sky_top, OB_RECORD_RGB), LOOK(sky_horizon, OB_RECORD_RGB), LOOK(ground_colour, OB_RECORD_RGB),
	LOOK(grid, OB_RECORD_FLAG),   LOOK(sun, OB_RECORD_VEC3),
};
const ob_record_table ob_record_look = {
	{ "look", "linear RGB", "world", "sky, ground, whether it has a grid, and the direction towards the sun" },
	sizeof(ob_look_def),
	COUNT(look_members),
	look_members,
};

#define VERTEX(name, type) MEMBER(#name, type, offsetof(ob_mesh_vertex, name), 0)
static const ob_record_member vertex_members[] = {
	VERTEX(position, OB_RECORD_RGB), VERTEX(normal, OB_RECORD_RGB),   VERTEX(colour, OB_RECORD_RGB),
	VERTEX(surface, OB_RECORD_F32),  VERTEX(texture, OB_RECORD_PAIR),
};
const ob_record_table ob_record_mesh_vertices = {
	{ "vertices", "m; colour: linear RGB", "body",
	  "of the mesh that events name by its number; colour, surface: below 0: the object's; surface: 15 times the "
	  "metal, whole, and then the roughness, below 1; texture: place in the images of its part, whose upper left "
	  "corner is 0, 0 and whose lower right one 1, 1" },
	sizeof(ob_mesh_vertex),
	COUNT(vertex_members),
	vertex_members,
};

static const ob_record_member triangle_members[] = { { "corner", OB_RECORD_U32, 0, 3 } };
const ob_record_table ob_record_mesh_triangles = {
	{ "triangles", "1", NULL, "the vertices of each, counterclockwise seen from outside" },
	3 * sizeof(uint32_t),
	COUNT(triangle_members),
	triangle_members,
};

#define PART(name, type, length) MEMBER(#name, type, offsetof(ob_mesh_part, name), length)
static const ob_record_member part_members[] = {
	PART(indices, OB_RECORD_U32, 0),
	PART(colour, OB_RECORD_U8, 0),
	PART(surface, OB_RECORD_U8, 0),
	PART(wrap, OB_RECORD_U8, 2),
};
const ob_record_table ob_record_mesh_parts = {
	{ "parts", "1", NULL,
	  "triangles that have the same images: indices: three times their number, after those of the parts before; "
	  "colour, surface: numbers of images, 0: none; wrap: along an image's sides: 0 repeated, 1 mirrored, 2 held" },
	sizeof(ob_mesh_part),
	COUNT(part_members),
	part_members,
};

static hid_t array_of(hid_t element, hsize_t count)
{
	return H5Tarray_create2(element, 1, &count);
}

static hid_t type_of(ob_record_type type)
{
	switch (type) {
	case OB_RECORD_U8:
	case OB_RECORD_FLAG:
		return H5Tcopy(H5T_NATIVE_UINT8);
	case OB_RECORD_U16:
		return H5Tcopy(H5T_NATIVE_UINT16);
	case OB_RECORD_U32:
		return H5Tcopy(H5T_NATIVE_UINT32);
	case OB_RECORD_U64:
		return H5Tcopy(H5T_NATIVE_UINT64);
	case OB_RECORD_F32:
		return H5Tcopy(H5T_NATIVE_FLOAT);
	case OB_RECORD_F64:
		return H5Tcopy(H5T_NATIVE_DOUBLE);
	case OB_RECORD_VEC3:
		return array_of(H5T_NATIVE_DOUBLE, 3);
	case OB_RECORD_QUAT:
		return array_of(H5T_NATIVE_DOUBLE, 4);
	case OB_RECORD_PAIR:
		return array_of(H5T_NATIVE_FLOAT, 2);
	case OB_RECORD_RGB:
		return array_of(H5T_NATIVE_FLOAT, 3);
	case OB_RECORD_RGBA:
		return array_of(H5T_NATIVE_FLOAT, 4);
	case OB_RECORD_NAME:
		return ob_hdf5_string_type(OB_NAME_MAX);
	case OB_RECORD_EDGE:
		return array_of(H5T_NATIVE_UINT8, sizeof(ob_hull_edge));
	case OB_RECORD_POSE:
		return array_of(H5T_NATIVE_DOUBLE, sizeof(ob_pose) / sizeof(double));
	}
	return H5I_INVALID_HID;
}

static hid_t type_of_member(const ob_record_member *m)
{
	hid_t one = type_of(m->type);
	if (m->length == 0)
		return one;
	hid_t all = array_of(one, m->length);
	H5Tclose(one);
	return all;
}

hid_t ob_record_type_in_memory(const ob_record_table *t)
{
	hid_t type = H5Tcreate(H5T_COMPOUND, t->size);
	for (int i = 0; i < t->members; i++) {
		hid_t member = type_of_member(&t->member[i]);
		H5Tinsert(type, t->member[i].name, t->member[i].offset, member);
		H5Tclose(member);
	}
	return type;
}

hid_t ob_record_type_in_file(const ob_record_table *t)
{
	hid_t type = ob_record_type_in_memory(t);
	H5Tpack(type);
	return type;
}

// ---- hdf5 file

static _Thread_local char reason[128]; // the system's, of the last call that failed for one

// Finds the system's reason in HDF5's error: "..., errno = 28, error message = 'No space left on device', ..."
static herr_t find_reason(unsigned depth, const H5E_error2_t *error, void *data)
{
	(void)depth, (void)data;
	const char *mark = "error message = '";
	const char *from = error->desc ? strstr(error->desc, mark) : NULL;
	if (!from)
		return 0;
	from += strlen(mark);
	snprintf(reason, sizeof reason, "%.*s", (int)strcspn(from, "'"), from);
	return 0;
}

// HDF5 calls this when a call fails. Later calls, those that close what is open included, forget its errors.
static herr_t keep_reason(hid_t errors, void *data)
{
	return H5Ewalk2(errors, H5E_WALK_DOWNWARD, find_reason, data);
}

// Disables HDF5's own cleanup when the process exits, too: after a failed write it crashes (1.10.8). We close all that
// we open.
void ob_hdf5_silence(void)
{
	H5dont_atexit();
	H5Eset_auto2(H5E_DEFAULT, keep_reason, NULL);
	reason[0] = '\0';
}

bool ob_hdf5_fail(ob_error *e, const char *path, const char *doing)
{
	return ob_fail(e, "%s: cannot %s: %s", path, doing, reason[0] ? reason : "HDF5 gives no reason");
}

uint64_t ob_hdf5_length(const char *path)
{
	haddr_t end = 0;
	hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
	if (file < 0 || H5Fget_eoa(file, &end) < 0)
		end = 0;
	if (file >= 0)
		H5Fclose(file);
	return end;
}

hid_t ob_hdf5_string_type(size_t length)
{
	hid_t type = H5Tcopy(H5T_C_S1);
	H5Tset_size(type, length);
	H5Tset_strpad(type, H5T_STR_NULLPAD);
	return type;
}

static bool write_attribute(hid_t at, const char *name, hid_t type, hid_t space, const void *data)
{
	hid_t id = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
	bool ok = id >= 0 && H5Awrite(id, type, data) >= 0;
	return (id < 0 || H5Aclose(id) >= 0) && ok;
}

bool ob_hdf5_attribute_text(hid_t at, const char *name, const char *text)
{
	hid_t type = ob_hdf5_string_type(text[0] ? strlen(text) : 1), space = H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, type, space, text);
	H5Sclose(space);
	H5Tclose(type);
	return ok;
}

bool ob_hdf5_attribute_numbers(hid_t at, const char *name, const double *number, size_t numbers)
{
	hsize_t n = numbers;
	hid_t space = numbers > 1 ? H5Screate_simple(1, &n, NULL) : H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, H5T_NATIVE_DOUBLE, space, number);
	H5Sclose(space);
	return ok;
}

bool ob_hdf5_attribute_count(hid_t at, const char *name, uint64_t count)
{
	hid_t space = H5Screate(H5S_SCALAR);
	bool ok = write_attribute(at, name, H5T_NATIVE_UINT64, space, &count);
	H5Sclose(space);
	return ok;
}

static bool add_label(hid_t set, const ob_hdf5_label *label)
{
	return ob_hdf5_attribute_text(set, "units", label->units) &&
	       (!label->frame || ob_hdf5_attribute_text(set, "frame", label->frame)) &&
	       ob_hdf5_attribute_text(set, "description", label->description);
}

enum { CACHE_SLOTS = 4001, CACHE_BYTES = 1 << 24 };

hid_t ob_hdf5_dataset(hid_t in, const ob_hdf5_label *label, hid_t type, int rank, const hsize_t *dims,
		      hsize_t chunk_rows, hsize_t chunk_ids, const void *fill)
{
	hsize_t most[4], chunk[4];
	memcpy(most, dims, (size_t)rank * sizeof *dims);
	memcpy(chunk, dims, (size_t)rank * sizeof *dims);
	hid_t how = H5Pcreate(H5P_DATASET_CREATE);
	if (fill)
		H5Pset_fill_value(how, type, fill);
	if (chunk_rows) {
		most[0] = H5S_UNLIMITED;
		chunk[0] = chunk_rows;
		if (rank > 1 && chunk_ids) {
			most[1] = H5S_UNLIMITED;
			chunk[1] = chunk_ids;
		}
		H5Pset_chunk(how, rank, chunk);
	}
	hid_t space = H5Screate_simple(rank, dims, most);
	// an append writes one chunk for each chunk_ids ids, and all of these should stay in memory
	hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
	H5Pset_chunk_cache(access, CACHE_SLOTS, CACHE_BYTES, 1);
	hid_t set = H5Dcreate2(in, label->name, type, space, H5P_DEFAULT, how, access);
	H5Pclose(access);
	H5Sclose(space);
	H5Pclose(how);
	if (set >= 0 && !add_label(set, label)) {
		H5Dclose(set);
		return H5I_INVALID_HID;
	}
	return set;
}
