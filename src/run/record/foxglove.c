#include "record/foxglove.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "shape/shape.h"

static const double plane_size = 200; // m, of a plane as it is shown

// ---- bytes of protocol buffers

void ob_bytes_put(ob_bytes *b, const void *bytes, size_t n)
{
	if (!OB_RESERVE(b->bytes, b->size + n, b->room)) {
		b->failed = true;
		return;
	}
	memcpy(b->bytes + b->size, bytes, n);
	b->size += n;
}

enum { VARINT = 0, WORD = 1, BYTES = 2, HALF = 5 }; // wire types
enum { VARINT_MAX = 10 };

static size_t varint(uint64_t v, char to[VARINT_MAX])
{
	size_t n = 0;
	for (; v >= 128; v >>= 7)
		to[n++] = (char)(v | 128);
	to[n++] = (char)v;
	return n;
}

static void put_varint(ob_bytes *b, uint64_t v)
{
	char bytes[VARINT_MAX];
	ob_bytes_put(b, bytes, varint(v, bytes));
}

static void put_tag(ob_bytes *b, uint32_t field, uint32_t wire)
{
	put_varint(b, field << 3 | wire);
}

static void put_count(ob_bytes *b, uint32_t field, uint64_t v)
{
	put_tag(b, field, VARINT);
	put_varint(b, v);
}

// Numbers are little-endian, as this machine's.
static void put_double(ob_bytes *b, uint32_t field, double v)
{
	put_tag(b, field, WORD);
	ob_bytes_put(b, &v, sizeof v);
}

static void put_fixed(ob_bytes *b, uint32_t field, uint32_t v)
{
	put_tag(b, field, HALF);
	ob_bytes_put(b, &v, sizeof v);
}

static void put_bytes(ob_bytes *b, uint32_t field, const void *bytes, size_t n)
{
	put_tag(b, field, BYTES);
	put_varint(b, n);
	ob_bytes_put(b, bytes, n);
}

static void put_text(ob_bytes *b, uint32_t field, const char *text)
{
	put_bytes(b, field, text, strlen(text));
}

// Begins a message within another; close it by the result.
static size_t open_message(ob_bytes *b, uint32_t field)
{
	put_tag(b, field, BYTES);
	return b->size;
}

static void close_message(ob_bytes *b, size_t begin)
{
	char length[VARINT_MAX] = { 0 };
	if (b->failed)
		return;
	const size_t size = b->size - begin, n = varint(size, length);
	ob_bytes_put(b, length, n);
	if (b->failed)
		return;
	memmove(b->bytes + begin + n, b->bytes + begin, size);
	memcpy(b->bytes + begin, length, n);
}

// ---- schemas

// A message a line: its name, then type, name and number of each field, * for repeated ones. A line with + is an enumeration within the
// message before, from 0 on. Types with a capital letter are of the same package.
static const char *const timestamp[] = { "Timestamp int64 seconds 1 int32 nanos 2", NULL };
static const char *const duration[] = { "Duration int64 seconds 1 int32 nanos 2", NULL };
static const char *const obsim[] = { "Sample .google.protobuf.Timestamp timestamp 1 double* value 2", NULL };
#define TIME " .google.protobuf.Timestamp timestamp 1 "
static const char *const foxglove[] = {
	"Vector3 double x 1 double y 2 double z 3",
	"Point3 double x 1 double y 2 double z 3",
	"Quaternion double x 1 double y 2 double z 3 double w 4",
	"Pose Vector3 position 1 Quaternion orientation 2",
	"Color double r 1 double g 2 double b 3 double a 4",
	"KeyValuePair string key 1 string value 2",
	"CubePrimitive Pose pose 1 Vector3 size 2 Color color 3",
	"SpherePrimitive Pose pose 1 Vector3 size 2 Color color 3",
	"CylinderPrimitive Pose pose 1 Vector3 size 2 double bottom_scale 3 double top_scale 4 Color color 5",
	"TriangleListPrimitive Pose pose 1 Point3* points 2 Color color 3 Color* colors 4 fixed32* indices 5",
	"SceneEntity" TIME "string frame_id 2 string id 3 .google.protobuf.Duration lifetime 4 bool frame_locked 5 "
	"KeyValuePair* metadata 6 CubePrimitive* cubes 8 SpherePrimitive* spheres 9 CylinderPrimitive* cylinders 10 "
	"TriangleListPrimitive* triangles 12",
	"SceneEntityDeletion" TIME "+SceneEntityDeletion.Type type 2 string id 3",
	"+Type MATCHING_ID ALL",
	"SceneUpdate SceneEntityDeletion* deletions 1 SceneEntity* entities 2",
	"FrameTransform" TIME
	"string parent_frame_id 2 string child_frame_id 3 Vector3 translation 4 Quaternion rotation 5",
	"FrameTransforms FrameTransform* transforms 1",
	"LaserScan" TIME "string frame_id 2 Pose pose 3 double start_angle 4 double end_angle 5 double* ranges 6 "
	"double* intensities 7",
	"PackedElementField string name 1 fixed32 offset 2 +PackedElementField.NumericType type 3",
	"+NumericType UNKNOWN UINT8 INT8 UINT16 INT16 UINT32 INT32 FLOAT32 FLOAT64",
	"PointCloud" TIME
	"string frame_id 2 Pose pose 3 fixed32 point_stride 4 PackedElementField* fields 5 bytes data 6",
	"RawImage" TIME
	"string frame_id 7 fixed32 width 2 fixed32 height 3 string encoding 4 fixed32 step 5 bytes data 6",
	"CameraCalibration" TIME
	"string frame_id 9 fixed32 width 2 fixed32 height 3 string distortion_model 4 double* D 5 "
	"double* K 6 double* R 7 double* P 8",
	NULL,
};
#undef TIME
enum { FLOAT32 = 7 }; // of PackedElementField.NumericType
enum { WORD_MAX = 64 };

// Copies the next word of a line, which has one; returns what is behind it.
static const char *next_word(const char *line, char word[WORD_MAX])
{
	const size_t n = strcspn(line, " ");
	snprintf(word, WORD_MAX, "%.*s", (int)n, line);
	return line + n + strspn(line + n, " ");
}

// Writes type and type name of a FieldDescriptorProto.
static void describe_type(ob_bytes *b, const char *type)
{
	static const char *const names[] = { [1] = "double", [3] = "int64",  [5] = "int32", [7] = "fixed32",
					     [8] = "bool",   [9] = "string", [12] = "bytes" };
	enum { MESSAGE_TYPE = 11, ENUM_TYPE = 14 };
	char full[WORD_MAX + 16];
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (names[i] && strcmp(names[i], type) == 0) {
			put_count(b, 5, i);
			return;
		}
	put_count(b, 5, *type == '+' ? ENUM_TYPE : MESSAGE_TYPE);
	snprintf(full, sizeof full, "%s%s", *type == '.' ? "" : ".foxglove.", type + (*type == '+'));
	put_text(b, 6, full);
}

// Writes the fields of a DescriptorProto.
static void describe_fields(ob_bytes *b, const char *line)
{
	char type[WORD_MAX], name[WORD_MAX], number[WORD_MAX];
	while (*line) {
		line = next_word(next_word(next_word(line, type), name), number);
		char *star = strchr(type, '*');
		const size_t one = open_message(b, 2);
		put_text(b, 1, name);
		put_count(b, 3, strtoull(number, NULL, 10));
		put_count(b, 4, star ? 3 : 1);
		if (star)
			*star = 0;
		describe_type(b, type);
		close_message(b, one);
	}
}

// Writes the values of an EnumDescriptorProto.
static void describe_values(ob_bytes *b, const char *line)
{
	char name[WORD_MAX];
	for (uint32_t i = 0; *line; i++) {
		line = next_word(line, name);
		const size_t one = open_message(b, 2);
		put_text(b, 1, name);
		put_count(b, 2, i);
		close_message(b, one);
	}
}

// Writes a FileDescriptorProto. dependency: other files, ended by NULL.
static void describe_file(ob_bytes *b, const char *file, const char *package, const char *const *dependency,
			  const char *const *line)
{
	char name[WORD_MAX];
	const size_t all = open_message(b, 1);
	put_text(b, 1, file);
	put_text(b, 2, package);
	for (; *dependency; dependency++)
		put_text(b, 3, *dependency);
	while (*line) {
		const size_t message = open_message(b, 4);
		const char *rest = next_word(*line++, name);
		put_text(b, 1, name);
		describe_fields(b, rest);
		for (; *line && **line == '+'; line++) {
			const size_t values = open_message(b, 4);
			rest = next_word(*line + 1, name);
			put_text(b, 1, name);
			describe_values(b, rest);
			close_message(b, values);
		}
		close_message(b, message);
	}
	put_text(b, 12, "proto3");
	close_message(b, all);
}

void ob_foxglove_describe(ob_bytes *to)
{
	static const char *const times[] = { "google/protobuf/timestamp.proto", "google/protobuf/duration.proto",
					     NULL };
	describe_file(to, times[0], "google.protobuf", times + 2, timestamp);
	describe_file(to, times[1], "google.protobuf", times + 2, duration);
	describe_file(to, "foxglove.proto", "foxglove", times, foxglove);
	describe_file(to, "obsim.proto", "obsim", times, obsim);
}

// ---- channels

bool ob_channel_get(const ob_sensor_passport *sensor, uint32_t sensors, uint32_t i, ob_channel *out)
{
	static const struct {
		const char *schema, *suffix;
	} kinds[] = {
		[OB_CHANNEL_SCENE] = { "foxglove.SceneUpdate", "/scene" },
		[OB_CHANNEL_POSES] = { "foxglove.FrameTransforms", "/poses" },
		[OB_CHANNEL_VALUES] = { "obsim.Sample", "" },
		[OB_CHANNEL_SCAN] = { "foxglove.LaserScan", "" },
		[OB_CHANNEL_CLOUD] = { "foxglove.PointCloud", "" },
		[OB_CHANNEL_COLOUR] = { "foxglove.RawImage", "/colour" },
		[OB_CHANNEL_DEPTH] = { "foxglove.RawImage", "/depth" },
		[OB_CHANNEL_OBJECTS] = { "foxglove.RawImage", "/objects" },
		[OB_CHANNEL_CALIBRATION] = { "foxglove.CameraCalibration", "/calibration" },
	};
	ob_channel c = { .kind = i ? OB_CHANNEL_POSES : OB_CHANNEL_SCENE };
	for (uint32_t at = 2; i >= 2; c.sensor++) {
		if (c.sensor == sensors)
			return false;
		const ob_sensor_passport *s = &sensor[c.sensor];
		const uint32_t several = s->kind == OB_SENSOR_CAMERA ? 4 : 1;
		c.kind = s->kind == OB_SENSOR_CAMERA  ? OB_CHANNEL_COLOUR + i - at
			 : s->kind != OB_SENSOR_LIDAR ? OB_CHANNEL_VALUES
			 : s->rows > 1                ? OB_CHANNEL_CLOUD
						      : OB_CHANNEL_SCAN;
		at += several;
		if (i < at)
			break;
	}
	c.schema = kinds[c.kind].schema;
	snprintf(c.topic, sizeof c.topic, "%s%s%s", i < 2 ? "" : "/", i < 2 ? "" : sensor[c.sensor].name,
		 kinds[c.kind].suffix);
	*out = c;
	return true;
}

// ---- parts of messages

static void put_time(ob_bytes *b, uint32_t field, uint64_t ns)
{
	const size_t m = open_message(b, field);
	put_count(b, 1, ns / 1000000000);
	put_count(b, 2, ns % 1000000000);
	close_message(b, m);
}

static void put_vector(ob_bytes *b, uint32_t field, ob_vec3 v)
{
	const size_t m = open_message(b, field);
	put_double(b, 1, v.x);
	put_double(b, 2, v.y);
	put_double(b, 3, v.z);
	close_message(b, m);
}

static void put_quaternion(ob_bytes *b, uint32_t field, ob_quat q)
{
	const size_t m = open_message(b, field);
	put_double(b, 1, q.x);
	put_double(b, 2, q.y);
	put_double(b, 3, q.z);
	put_double(b, 4, q.w);
	close_message(b, m);
}

static void put_pose(ob_bytes *b, uint32_t field, ob_pose p)
{
	const size_t m = open_message(b, field);
	put_vector(b, 1, p.p);
	put_quaternion(b, 2, p.q);
	close_message(b, m);
}

static void put_height(ob_bytes *b, double z)
{
	put_pose(b, 1, (ob_pose){ { 0, 0, z }, ob_quat_identity() });
}

// sRGB of a linear value (IEC 61966-2-1)
static double displayed(double c)
{
	return c <= .0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - .055;
}

static void put_colour(ob_bytes *b, uint32_t field, const float c[4])
{
	const size_t m = open_message(b, field);
	for (uint32_t i = 0; i < 3; i++)
		put_double(b, 1 + i, displayed((double)c[i]));
	put_double(b, 4, (double)c[3]);
	close_message(b, m);
}

static void put_doubles(ob_bytes *b, uint32_t field, const double *v, size_t n)
{
	put_bytes(b, field, v, n * sizeof *v);
}

// ---- shapes

enum { CUBES = 8, SPHERES = 9, CYLINDERS = 10, TRIANGLES = 12 }; // fields of SceneEntity

static void put_cube(ob_bytes *b, ob_vec3 half, double z, const float c[4])
{
	const size_t m = open_message(b, CUBES);
	put_height(b, z);
	put_vector(b, 2, ob_scale(half, 2));
	put_colour(b, 3, c);
	close_message(b, m);
}

// A ball, a cylinder, or both along z: the sum of a segment, a disc and a ball.
static void put_round(ob_bytes *b, const ob_outline *o, const float c[4])
{
	const double radius = o->rim + o->ball;
	for (int end = -1; end <= (o->half.z > 0 ? 1 : -1) && o->ball > 0; end += 2) {
		const size_t m = open_message(b, SPHERES);
		put_height(b, end * o->half.z);
		put_vector(b, 2, ob_v3(2 * o->ball, 2 * o->ball, 2 * o->ball));
		put_colour(b, 3, c);
		close_message(b, m);
	}
	if (!(o->half.z > 0))
		return;
	const size_t m = open_message(b, CYLINDERS);
	put_height(b, 0);
	put_vector(b, 2, ob_v3(2 * radius, 2 * radius, 2 * o->half.z));
	put_double(b, 3, 1);
	put_double(b, 4, 1);
	put_colour(b, 5, c);
	close_message(b, m);
}

static void put_hull(ob_bytes *b, const ob_hull *h, const float c[4])
{
	const size_t m = open_message(b, TRIANGLES);
	put_height(b, 0);
	for (uint32_t i = 0; i < h->corners; i++)
		put_vector(b, 2, h->corner[i]);
	put_colour(b, 3, c);
	const size_t indices = open_message(b, 5);
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f] + 2u; k < h->first[f + 1]; k++)
			ob_bytes_put(b, (uint32_t[]){ h->loop[h->first[f]], h->loop[k - 1], h->loop[k] },
				     3 * sizeof(uint32_t));
	close_message(b, indices);
	close_message(b, m);
}

// Terrain, by its look: a record has no other triangles of it.
static void put_mesh(ob_bytes *b, const ob_mesh *mesh, const float c[4])
{
	const size_t m = open_message(b, TRIANGLES);
	put_height(b, 0);
	for (uint32_t i = 0; i < mesh->vertices; i++) {
		const float *p = mesh->vertex[i].position;
		put_vector(b, 2, ob_v3((double)p[0], (double)p[1], (double)p[2]));
	}
	put_colour(b, 3, c);
	put_bytes(b, 5, mesh->index, mesh->indices * sizeof *mesh->index);
	close_message(b, m);
}

static void put_body(ob_bytes *b, const ob_scene *scene, const ob_snapshot *s, uint32_t id)
{
	const ob_passport *p = &s->passport[id];
	ob_outline o;
	if (ob_snapshot_hull(s, id)) {
		const uint32_t parts = ob_snapshot_parts(s, id);
		for (uint32_t i = parts > 0; i <= parts; i++)
			put_hull(b, ob_snapshot_part(s, id, i), p->colour);
	} else if (ob_shape_is(p->shape, OB_SURFACED) && p->mesh && p->mesh <= scene->meshes) {
		put_mesh(b, &scene->mesh[p->mesh - 1], p->colour);
	} else if (ob_shape_outline(p->shape, p->size, &o)) {
		if (o.rim == 0 && o.ball == 0)
			put_cube(b, o.half, 0, p->colour);
		else
			put_round(b, &o, p->colour);
	} else {
		const double thin = .005;
		put_cube(b, ob_v3(.5 * plane_size, .5 * plane_size, thin), -thin, p->colour);
	}
}

// ---- states

static void print_frame(char to[32], uint32_t id)
{
	snprintf(to, 32, "object/%u", id);
}

static void put_entity(ob_bytes *b, const ob_scene *scene, const ob_snapshot *s, uint32_t id, uint64_t ns)
{
	char frame[32];
	const size_t entity = open_message(b, 2);
	print_frame(frame, id);
	put_time(b, 1, ns);
	put_text(b, 2, frame);
	put_text(b, 3, strchr(frame, '/') + 1);
	put_count(b, 5, true);
	const size_t pair = open_message(b, 6);
	put_text(b, 1, "name");
	put_bytes(b, 2, s->passport[id].name, strnlen(s->passport[id].name, OB_NAME_MAX));
	close_message(b, pair);
	put_body(b, scene, s, id);
	close_message(b, entity);
}

bool ob_foxglove_view_fit(ob_foxglove_view *v, const ob_snapshot *s)
{
	if (s->count <= v->ids)
		return true;
	if (!OB_GROW_CLEARED(v->shown, v->ids, s->count) || !OB_GROW_CLEARED(v->placed, v->ids, s->count))
		return false;
	v->ids = s->count;
	return true;
}

void ob_foxglove_view_finish(ob_foxglove_view *v)
{
	free(v->shown);
	free(v->placed);
}

static bool is_present(const ob_passport *p)
{
	return p->flags & OB_OBJECT_PRESENT;
}

bool ob_foxglove_scene(ob_bytes *to, ob_foxglove_view *v, const ob_scene *scene, const ob_snapshot *s, uint64_t ns)
{
	static const ob_passport none;
	const size_t before = to->size;
	char frame[32];
	for (uint32_t id = 0; id < v->ids; id++) {
		const ob_passport *now = id < s->count ? &s->passport[id] : &none;
		if (!is_present(&v->shown[id]) || (is_present(now) && now->generation == v->shown[id].generation))
			continue;
		const size_t deletion = open_message(to, 1);
		print_frame(frame, id);
		put_time(to, 1, ns);
		put_text(to, 3, strchr(frame, '/') + 1);
		close_message(to, deletion);
		v->shown[id] = none;
	}
	for (uint32_t id = 0; id < s->count; id++) {
		const ob_passport *now = &s->passport[id];
		if (!is_present(now) || memcmp(now, &v->shown[id], sizeof *now) == 0)
			continue;
		put_entity(to, scene, s, id, ns);
		v->shown[id] = *now;
		v->placed[id] = (ob_pose){ .q = { 0 } }; // its place is written, too
	}
	return to->size > before;
}

static void put_transform(ob_bytes *b, uint64_t ns, const char *parent, const char *child, ob_pose at)
{
	const size_t m = open_message(b, 1);
	put_time(b, 1, ns);
	put_text(b, 2, parent);
	put_text(b, 3, child);
	put_vector(b, 4, at.p);
	put_quaternion(b, 5, at.q);
	close_message(b, m);
}

static void print_camera(char to[OB_NAME_MAX + 8], const ob_sensor_passport *p)
{
	snprintf(to, OB_NAME_MAX + 8, "camera/%s", p->name);
}

// Frames of the cameras on an object: x to the right, y down, z ahead.
static void put_camera_frames(ob_bytes *b, const ob_scene *scene, uint32_t id, uint64_t ns)
{
	static const ob_quat turn = { .5, -.5, .5, -.5 };
	char parent[32], child[OB_NAME_MAX + 8];
	print_frame(parent, id);
	for (uint32_t i = 0; i < scene->sensors; i++) {
		const ob_sensor_passport *p = &scene->sensor[i];
		if (p->kind != OB_SENSOR_CAMERA || p->object != id)
			continue;
		print_camera(child, p);
		put_transform(b, ns, parent, child, (ob_pose){ p->pose.p, ob_quat_mul(p->pose.q, turn) });
	}
}

bool ob_foxglove_poses(ob_bytes *to, ob_foxglove_view *v, const ob_scene *scene, const ob_snapshot *s, uint64_t ns)
{
	static const ob_quat none;
	const size_t before = to->size;
	char frame[32];
	for (uint32_t id = 0; id < s->count; id++) {
		if (!is_present(&s->passport[id]))
			continue;
		const ob_pose at = ob_snapshot_state(s, id).pose;
		if (memcmp(&at, &v->placed[id], sizeof at) == 0)
			continue;
		print_frame(frame, id);
		put_transform(to, ns, "world", frame, at);
		if (memcmp(&v->placed[id].q, &none, sizeof none) == 0)
			put_camera_frames(to, scene, id, ns);
		v->placed[id] = at;
	}
	return to->size > before;
}

// ---- samples

static void put_scan(ob_bytes *b, const ob_sensor_passport *p, const double *value)
{
	const bool whole = p->fan >= 2 * M_PI;
	put_double(b, 4, whole ? -M_PI : -.5 * p->fan);
	put_double(b, 5, whole ? M_PI - p->fan / p->beams : .5 * p->fan);
	put_doubles(b, 6, value, p->width);
}

// Points of the beams that meet something, in the lidar's frame.
static void put_cloud(ob_bytes *b, const ob_sensor_passport *p, const double *value)
{
	static const char *const axis[] = { "x", "y", "z" };
	const bool whole = p->fan >= 2 * M_PI;
	put_fixed(b, 4, 3 * sizeof(float));
	for (uint32_t i = 0; i < 3; i++) {
		const size_t field = open_message(b, 5);
		put_text(b, 1, axis[i]);
		put_fixed(b, 2, i * (uint32_t)sizeof(float));
		put_count(b, 3, FLOAT32);
		close_message(b, field);
	}
	const size_t data = open_message(b, 6);
	for (uint32_t k = 0; k < p->width; k++) {
		const uint32_t row = k / p->beams, i = k % p->beams;
		const double up = p->rows > 1 ? p->rise * (row / (p->rows - 1.) - .5) : 0;
		const double side = whole          ? i * (2 * M_PI / p->beams) - M_PI
				    : p->beams > 1 ? p->fan * (i / (p->beams - 1.) - .5)
						   : 0;
		const float at[] = { (float)(value[k] * cos(up) * cos(side)), (float)(value[k] * cos(up) * sin(side)),
				     (float)(value[k] * sin(up)) };
		if (isfinite(value[k]))
			ob_bytes_put(b, at, sizeof at);
	}
	close_message(b, data);
}

static void put_image(ob_bytes *b, ob_channel_kind kind, const ob_sensor_passport *p, const double *value)
{
	const ob_pixel *pixel = ob_picture_of(value);
	const uint32_t each = kind == OB_CHANNEL_COLOUR ? 3 : kind == OB_CHANNEL_DEPTH ? 4 : 2;
	put_fixed(b, 2, p->beams);
	put_fixed(b, 3, p->rows);
	put_text(b, 4, kind == OB_CHANNEL_COLOUR ? "rgb8" : kind == OB_CHANNEL_DEPTH ? "32FC1" : "16UC1");
	put_fixed(b, 5, each * p->beams);
	const size_t data = open_message(b, 6);
	for (size_t i = 0; i < (size_t)p->beams * p->rows; i++) {
		const uint16_t id = (uint16_t)pixel[i].id;
		ob_bytes_put(b,
			     kind == OB_CHANNEL_COLOUR  ? (const void *)pixel[i].rgba
			     : kind == OB_CHANNEL_DEPTH ? (const void *)&pixel[i].depth
							: &id,
			     each);
	}
	close_message(b, data);
}

static void put_calibration(ob_bytes *b, const ob_sensor_passport *p)
{
	const double f = .5 * p->rows / tan(.5 * p->rise), x = .5 * p->beams, y = .5 * p->rows; // px
	put_fixed(b, 2, p->beams);
	put_fixed(b, 3, p->rows);
	put_doubles(b, 6, (const double[]){ f, 0, x, 0, f, y, 0, 0, 1 }, 9);
	put_doubles(b, 7, (const double[]){ 1, 0, 0, 0, 1, 0, 0, 0, 1 }, 9);
	put_doubles(b, 8, (const double[]){ f, 0, x, 0, 0, f, y, 0, 0, 0, 1, 0 }, 12);
}

void ob_foxglove_sample(ob_bytes *to, const ob_channel *c, const ob_sensor_passport *p, uint64_t ns,
			const double *value)
{
	char frame[OB_NAME_MAX + 8];
	put_time(to, 1, ns);
	if (c->kind == OB_CHANNEL_VALUES) {
		put_doubles(to, 2, value, p->width);
	} else if (c->kind == OB_CHANNEL_SCAN || c->kind == OB_CHANNEL_CLOUD) {
		print_frame(frame, p->object);
		put_text(to, 2, frame);
		put_pose(to, 3, p->pose);
		(c->kind == OB_CHANNEL_SCAN ? put_scan : put_cloud)(to, p, value);
	} else {
		print_camera(frame, p);
		put_text(to, c->kind == OB_CHANNEL_CALIBRATION ? 9 : 7, frame);
		if (c->kind == OB_CHANNEL_CALIBRATION)
			put_calibration(to, p);
		else
			put_image(to, c->kind, p, value);
	}
}
