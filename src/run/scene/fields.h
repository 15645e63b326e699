// Reads a Lua table by a list of its possible fields. An invalid value raises one error with the place, the field, and
// the expected and actual values; an unknown name, with the most similar field.
//
// The target holds the defaults beforehand; a missing field leaves its default. NaN is never accepted from a scene, so
// a NaN default marks a number, vector or colour that was not set.
#ifndef OB_SCENE_FIELDS_H
#define OB_SCENE_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lua.h>
#include <ob/vec.h>

typedef enum ob_field_kind {
	OB_FIELD_NUMBER, // double, within low..high
	OB_FIELD_WHOLE, // uint64_t, within low..high
	OB_FIELD_COUNT, // uint32_t, within low..high
	OB_FIELD_BOOLEAN, // bool
	OB_FIELD_SWITCH, // uint32_t, 1 for true
	OB_FIELD_TEXT, // const char *, valid as long as the table: at most high bytes
	OB_FIELD_CHOICE, // uint32_t, index in choices
	OB_FIELD_VECTOR, // ob_vec3, each within low..high
	OB_FIELD_DIRECTION, // ob_vec3 of any length but 0, made a unit vector
	OB_FIELD_QUATERNION, // ob_quat {w, x, y, z} of any norm but 0, made a unit quaternion
	OB_FIELD_ROTATION, // ob_quat from { axis = {x, y, z}, degrees = a }
	OB_FIELD_FLAT, // ob_flat: a table of flat values (scene/flat.h)
	OB_FIELD_SOURCE, // const char *, valid as long as the table: text of any characters, at most high bytes
	OB_FIELD_SET, // uint32_t from a list of whole numbers within low..high, each below 32: bit n, for n
	OB_FIELD_TABLE, // bool: it is present; the caller reads its contents
	OB_FIELD_FUNCTION, // bool: it is present; the caller calls it
	OB_FIELD_POINTS, // ob_points from {{x, y, z}, ..}, each within low..high
	OB_FIELD_LENGTH, // ob_length: a number within low..high (m), or text (settings/settings.h)
	OB_FIELD_COLOUR, // float[4], linear and opaque, from {r, g, b [, 1]} or "#rrggbb[ff]" (sRGB)
} ob_field_kind;

// Valid until the next list of points is read.
typedef struct ob_points {
	const ob_vec3 *at;
	uint32_t count;
} ob_points;

enum { OB_FIELD_POINTS_MAX = 4096 };

typedef struct ob_field {
	const char *name;
	ob_field_kind kind;
	size_t offset; // in the target
	double low, high; // high may be INFINITY; infinite values are still refused
	bool above; // low itself is excluded
	bool required;
	const char *choices; // "a|b|c"
} ob_field;

#define OB_FIELD(type, member, ...) \
	{ \
		.offset = offsetof(type, member), __VA_ARGS__ \
	}

// Returns a bit for each of the first 64 fields: given. where: the name of the call, for messages ("box"). index: the
// table's, in the stack of L.
uint64_t ob_fields_read(lua_State *L, int index, const char *where, const ob_field *field, size_t count, void *to);

// Raises "where.field: expected ..., got <the value at index>".
_Noreturn void ob_fields_fail(lua_State *L, const char *where, const char *field, const char *expected, int index);

// Converts sRGB components (0..1), as people write colours, to the linear RGB used inside; alpha stays.
void ob_colour_from_srgb(const double rgba[4], float linear[4]);
// "#rrggbb", or "#rrggbbff"; false: another format, or not opaque.
bool ob_colour_from_hex(const char *text, float linear[4]);

#endif
