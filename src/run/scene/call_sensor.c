// imu, encoder, force_torque, touch, lidar, camera: sensors on objects and joints that have been declared.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/allocate.h"
#include "base/spelling.h"
#include "elementary/elementary.h"
#include "scene/builder.h"
#include "scene/object_limits.h"
#include "scene/sandbox.h"
#include "shape/shape.h"

#define RADIANS (M_PI / 180)
#define RATE_LEAST 1e-3 // Hz
#define RATE_MOST 1e5 // Hz
#define DELAY_MOST 10 // s
#define KEEP_MOST 1000000
#define PIXELS_ACROSS_MOST 4096

// Fields of a call.
typedef struct sensor {
	const char *on, *joint, *name;
	ob_vec3 at;
	ob_quat q, rotation;
	double rate, delay, fan, rise, reach, fov; // degrees
	uint32_t keep, beams, rows, width, height;
	ob_sensor_noise noise[2];
} sensor;

#define F(member, ...) OB_FIELD(sensor, member, .name = #member, __VA_ARGS__)
#define NOISE(title, member) OB_FIELD(sensor, member, .name = title, .kind = OB_FIELD_NUMBER, .high = OB_JOINT_MOST)
#define NOISES(before, part) \
	NOISE(before "noise", noise[part].white), NOISE(before "bias", noise[part].bias), \
		NOISE(before "walk", noise[part].walk)
#define TIMES \
	F(name, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1), \
		F(rate, .kind = OB_FIELD_NUMBER, .low = RATE_LEAST, .high = RATE_MOST), \
		F(delay, .kind = OB_FIELD_NUMBER, .high = DELAY_MOST), \
		F(keep, .kind = OB_FIELD_COUNT, .high = KEEP_MOST)
#define COMMON TIMES, NOISES("", 0)
#define ON F(on, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1, .required = true)
#define JOINT F(joint, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1, .required = true)
#define POSE \
	F(at, .kind = OB_FIELD_VECTOR, .low = -OB_LENGTH_MOST, .high = OB_LENGTH_MOST), \
		F(q, .kind = OB_FIELD_QUATERNION), F(rotation, .kind = OB_FIELD_ROTATION)

static const ob_field imu_fields[] = { ON, POSE, COMMON, NOISES("gyro_", 1) };
static const ob_field encoder_fields[] = { JOINT, COMMON, NOISES("rate_", 1) };
static const ob_field force_torque_fields[] = { JOINT, COMMON, NOISES("torque_", 1) };
static const ob_field touch_fields[] = { ON, COMMON };
static const ob_field lidar_fields[] = { ON,
					 POSE,
					 COMMON,
					 F(beams, .kind = OB_FIELD_COUNT, .low = 1, .high = OB_SENSOR_VALUES_MAX),
					 F(rows, .kind = OB_FIELD_COUNT, .low = 1, .high = OB_SENSOR_VALUES_MAX),
					 F(fan, .kind = OB_FIELD_NUMBER, .high = 360),
					 F(rise, .kind = OB_FIELD_NUMBER, .high = 180),
					 F(reach, .kind = OB_FIELD_NUMBER, .low = OB_LENGTH_LEAST,
					   .high = OB_LENGTH_MOST) };
static const ob_field camera_fields[] = { ON,
					  POSE,
					  TIMES,
					  F(width, .kind = OB_FIELD_COUNT, .low = 1, .high = PIXELS_ACROSS_MOST),
					  F(height, .kind = OB_FIELD_COUNT, .low = 1, .high = PIXELS_ACROSS_MOST),
					  F(fov, .kind = OB_FIELD_NUMBER, .low = 1, .high = 170) };

static const struct {
	const ob_field *field;
	size_t fields;
	uint32_t width; // 0: of its beams or pixels
} calls[OB_SENSOR_KINDS] = {
	[OB_SENSOR_IMU] = { imu_fields, sizeof imu_fields / sizeof *imu_fields, 6 },
	[OB_SENSOR_ENCODER] = { encoder_fields, sizeof encoder_fields / sizeof *encoder_fields, 2 },
	[OB_SENSOR_FORCE_TORQUE] = { force_torque_fields, sizeof force_torque_fields / sizeof *force_torque_fields, 6 },
	[OB_SENSOR_TOUCH] = { touch_fields, sizeof touch_fields / sizeof *touch_fields, 1 },
	[OB_SENSOR_LIDAR] = { lidar_fields, sizeof lidar_fields / sizeof *lidar_fields, 0 },
	[OB_SENSOR_CAMERA] = { camera_fields, sizeof camera_fields / sizeof *camera_fields, 0 },
};

static uint32_t find_joint(lua_State *L, const ob_scene *s, const char *kind, const char *name)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	ob_spelling spelling = ob_spelling_start(name);
	ob_sandbox_spend(L, s->joints / NAMES_PER_INSTRUCTION);
	for (uint32_t i = 0; i < s->joints; i++) {
		if (strcmp(s->joint[i].name, name) == 0)
			return i;
		ob_spelling_offer(&spelling, s->joint[i].name);
	}
	if (spelling.best)
		ob_sandbox_fail(L, "%s.joint: unknown joint \"%s\", did you mean \"%s\"?", kind, name, spelling.best);
	ob_sandbox_fail(L, "%s.joint: expected the name of a joint declared before, got \"%s\"", kind, name);
}

// Pose in the frame of a body: a hull's axes are the principal ones, its origin the centre of mass.
static ob_pose in_body(const ob_scene *s, const ob_passport *o, ob_pose pose)
{
	if (!ob_shape_is((ob_shape)o->shape, OB_HULLED))
		return pose;
	const ob_hull *h = &s->hull[o->hull];
	const ob_mat3 r = ob_quat_matrix(h->frame);
	return (ob_pose){ ob_rotate_back(&r, ob_sub(pose.p, h->centre)),
			  ob_quat_normalize(ob_quat_mul(ob_quat_conjugate(h->frame), pose.q)) };
}

// Places it on its object, or on the first object of its joint.
static void place(lua_State *L, const ob_scene *s, const char *kind, const sensor *d, ob_sensor_passport *p)
{
	ob_joined on;
	p->generation = 1;
	if (d->on) {
		ob_builder_find_object(L, s, kind, d->on, &on);
		p->object = on.id;
		if (!isnan(d->q.w) && !isnan(d->rotation.w))
			ob_sandbox_fail(L, "%s.q: expected either q or rotation, got both", kind);
		p->pose = in_body(s, &s->object[on.id].passport,
				  (ob_pose){ d->at, !isnan(d->q.w)          ? d->q
						    : !isnan(d->rotation.w) ? d->rotation
									    : ob_quat_identity() });
		return;
	}
	p->joint = find_joint(L, s, kind, d->joint);
	const ob_joint_passport *j = &s->joint[p->joint];
	p->object = j->object[0];
	p->pose = j->frame[0];
	if (p->kind == OB_SENSOR_ENCODER && (j->kind == OB_JOINT_FIXED || j->kind == OB_JOINT_APART))
		ob_sandbox_fail(L, "%s.joint: expected a joint with a free axis, got \"%s\"", kind, d->joint);
}

static void set_name(lua_State *L, const ob_scene *s, const char *kind, const char *name, ob_sensor_passport *p)
{
	enum { NAMES_PER_INSTRUCTION = 4 };
	if (name)
		snprintf(p->name, sizeof p->name, "%s", name);
	else
		snprintf(p->name, sizeof p->name, "%s#%u", kind, s->sensors);
	ob_sandbox_spend(L, s->sensors / NAMES_PER_INSTRUCTION);
	for (uint32_t i = 0; i < s->sensors; i++)
		if (strcmp(s->sensor[i].name, p->name) == 0)
			ob_sandbox_fail(L, "%s.name: \"%s\" is already the name of another sensor", kind, p->name);
}

static void add(lua_State *L, ob_builder *b, const char *kind, const ob_sensor_passport *p)
{
	ob_scene *s = b->scene;
	if (s->sensors == OB_SENSORS_MAX)
		ob_sandbox_fail(L, "%s: expected at most %d sensors in a scene", kind, OB_SENSORS_MAX);
	OB_BUILDER_MAKE_ROOM(L, kind, s->sensor, s->sensors, b->sensors_room);
	s->sensor[s->sensors++] = *p;
	ob_sandbox_extend(L, OB_SCENE_OBJECT_INSTRUCTIONS);
}

// Sets beams or pixels, and the angles that they cover.
static void spread(lua_State *L, const sensor *d, ob_sensor_passport *p)
{
	if (p->kind == OB_SENSOR_CAMERA) {
		if ((uint64_t)d->width * d->height > OB_PIXELS_MAX)
			ob_sandbox_fail(L, "camera.height: expected at most %d pixels, got %llu", OB_PIXELS_MAX,
					(unsigned long long)d->width * d->height);
		p->beams = d->width, p->rows = d->height, p->rise = d->fov * RADIANS;
		p->fan = 2 * ob_atan2(ob_tan(.5 * p->rise) * d->width, d->height);
		p->width = ob_picture_values(d->width, d->height);
		return;
	}
	if ((uint64_t)d->beams * d->rows > OB_SENSOR_VALUES_MAX)
		ob_sandbox_fail(L, "lidar.rows: expected at most %d beams in all rows, got %llu", OB_SENSOR_VALUES_MAX,
				(unsigned long long)d->beams * d->rows);
	p->beams = d->beams, p->rows = d->rows, p->fan = d->fan * RADIANS, p->rise = d->rise * RADIANS,
	p->reach = d->reach;
	p->width = calls[p->kind].width ? calls[p->kind].width : d->beams * d->rows;
}

int ob_scene_call_sensor(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_sensor_passport p = { .kind = (uint32_t)lua_tointeger(L, lua_upvalueindex(1)) };
	if (p.kind == OB_SENSOR_CAMERA && lua_type(L, 1) != LUA_TTABLE) // one that looks at the scene
		return ob_scene_call_camera(L);
	sensor d = { .q = { .w = NAN },
		     .rotation = { .w = NAN },
		     .beams = 360,
		     .rows = 1,
		     .fan = 360,
		     .rise = 30,
		     .reach = 30,
		     .fov = 60,
		     .width = 320,
		     .height = 240 };
	const char *kind = ob_sensor_kind_name(p.kind);
	lua_settop(L, 1);
	ob_fields_read(L, 1, kind, calls[p.kind].field, calls[p.kind].fields, &d);
	spread(L, &d, &p);
	place(L, b->scene, kind, &d, &p);
	set_name(L, b->scene, kind, d.name, &p);
	p.rate = d.rate, p.delay = d.delay, p.kept = d.keep;
	memcpy(p.noise, d.noise, sizeof p.noise);
	add(L, b, kind, &p);
	lua_pushstring(L, p.name);
	return 1;
}
