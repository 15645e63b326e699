// controls { key = "w", sends = "walk", values = { 1, 0 } }: keys, buttons and sliders of viewers.
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/spelling.h"
#include "scene/builder.h"
#include "scene/sandbox.h"

typedef struct control {
	const char *key, *label, *sends, *to;
	uint32_t gamepad; // OB_CONTROL_BUTTONS: none
	bool values;
	double min, max, value; // NaN: not set
} control;

#define F(member, ...) OB_FIELD(control, member, .name = #member, __VA_ARGS__)
#define NUMBER(member) F(member, .kind = OB_FIELD_NUMBER, .low = -1e9, .high = 1e9)
static const ob_field fields[] = {
	F(key, .kind = OB_FIELD_TEXT, .high = OB_CONTROL_KEY - 1),
	F(gamepad, .kind = OB_FIELD_COUNT, .high = OB_CONTROL_BUTTONS - 1),
	F(label, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
	F(sends, .kind = OB_FIELD_TEXT, .high = 15, .required = true),
	F(to, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
	F(values, .kind = OB_FIELD_TABLE),
	NUMBER(min),
	NUMBER(max),
	NUMBER(value),
};
#undef F
#undef NUMBER

static void read_values(lua_State *L, ob_control_def *c)
{
	lua_getfield(L, 1, "values");
	const size_t n = lua_rawlen(L, -1);
	bool fine = n > 0 && n <= OB_CONTROL_VALUES;
	for (size_t i = 0; fine && i < n; i++) {
		fine = lua_rawgeti(L, -1, (lua_Integer)i + 1) == LUA_TNUMBER;
		c->value[i] = lua_tonumber(L, -1);
		fine = fine && fabs(c->value[i]) <= 1e9;
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
	if (!fine)
		ob_sandbox_fail(L, "controls.values: expected 1 to %d numbers from -1e9 to 1e9, as { 1, 0 }",
				OB_CONTROL_VALUES);
	c->values = (uint32_t)n;
}

static void check(lua_State *L, const control *c)
{
	const bool low = !isnan(c->min), high = !isnan(c->max);
	const bool pressed = c->key || c->gamepad < OB_CONTROL_BUTTONS;
	if (!pressed && !c->label)
		ob_sandbox_fail(L, "controls: expected a key, a gamepad's button, or a label of a button or slider");
	if (strpbrk(c->sends, " \t"))
		ob_sandbox_fail(L, "controls.sends: expected one word, got \"%s\"", c->sends);
	if (low != high || (low && c->min >= c->max))
		ob_sandbox_fail(L, "controls.max: expected min and max of a slider, the smaller one first");
	if (low && (pressed || c->values || !c->label))
		ob_sandbox_fail(L, "controls.min: expected a label, and neither key, gamepad nor values, for a slider");
	if (!isnan(c->value) && (!low || c->value < c->min || c->value > c->max))
		ob_sandbox_fail(L, "controls.value: expected a number from min to max of a slider");
}

int ob_scene_call_controls(lua_State *L)
{
	ob_scene *s = ((ob_builder *)ob_sandbox_user(L))->scene;
	control c = { .gamepad = OB_CONTROL_BUTTONS, .min = NAN, .max = NAN, .value = NAN };
	ob_fields_read(L, 1, "controls", fields, sizeof fields / sizeof *fields, &c);
	check(L, &c);
	if (s->controls == OB_SCENE_CONTROLS_MAX || !OB_GROW(s->control, s->controls + 1))
		ob_sandbox_fail(L, "controls: expected at most %d controls in a scene", OB_SCENE_CONTROLS_MAX);
	ob_control_def *d = &s->control[s->controls++];
	*d = (ob_control_def){ .gamepad = c.gamepad, .slider = !isnan(c.min), .min = c.min, .max = c.max };
	snprintf(d->key, sizeof d->key, "%s", c.key ? c.key : "");
	for (char *at = d->key; d->key[0] && !d->key[1] && *at; at++)
		*at = (char)tolower((unsigned char)*at);
	snprintf(d->label, sizeof d->label, "%s", c.label ? c.label : "");
	snprintf(d->sends, sizeof d->sends, "%s", c.sends);
	snprintf(d->to, sizeof d->to, "%s", c.to ? c.to : "");
	if (c.values)
		read_values(L, d);
	if (d->slider)
		d->value[0] = isnan(c.value) ? c.min : c.value;
	return 0;
}

static bool receives(const ob_scene *s, const char *name, ob_spelling *spelling)
{
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].script && strcmp(s->object[i].passport.name, name) == 0)
			return true;
		if (s->object[i].script)
			ob_spelling_offer(spelling, s->object[i].passport.name);
	}
	return false;
}

bool ob_builder_check_controls(const ob_builder *b, const char *path, ob_error *e)
{
	const ob_scene *s = b->scene;
	for (uint32_t i = 0; i < s->controls; i++) {
		const char *to = s->control[i].to;
		ob_spelling spelling = ob_spelling_start(to);
		if (!*to && !s->avatar)
			return ob_fail(
				e,
				"%s:1: controls \"%s\": expected an object with avatar = true, or to = \"NAME\" of an "
				"object with a script",
				path, s->control[i].sends);
		if (*to && !receives(s, to, &spelling))
			return ob_fail(
				e, "%s:1: controls.to: expected the name of an object with a script, got \"%s\"%s%s%s",
				path, to, spelling.best ? ", did you mean \"" : "", spelling.best ? spelling.best : "",
				spelling.best ? "\"?" : "");
	}
	return true;
}
