// scene, record, sky, sun: settings of the whole run and its look.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "settings/settings.h"

typedef struct scene_fields {
	const char *title;
	bool tour;
	double duration;
	uint64_t seed;
	uint32_t room;
	ob_vec3 gravity;
	ob_length tolerance;
	ob_settings asked;
} scene_fields;

#define F(member, ...) OB_FIELD(scene_fields, member, .name = #member, __VA_ARGS__)
static const ob_field own_fields[] = {
	F(title, .kind = OB_FIELD_TEXT, .high = sizeof((ob_scene *)0)->title - 1),
	F(tour, .kind = OB_FIELD_BOOLEAN),
	F(gravity, .kind = OB_FIELD_VECTOR, .low = -OB_GRAVITY_MOST, .high = OB_GRAVITY_MOST),
	F(duration, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9),
	F(room, .kind = OB_FIELD_COUNT, .low = 0, .high = OB_SCENE_ROOM_MAX),
	F(seed, .kind = OB_FIELD_WHOLE, .low = 0, .high = 0x1p53),
};
#undef F

enum { OWN_FIELDS = sizeof own_fields / sizeof *own_fields, FIELDS_MOST = OWN_FIELDS + 2 * OB_SETTINGS };

// Lists the fields, some by two names, and the setting of each; returns their number.
static size_t list_fields(ob_field field[FIELDS_MOST], ob_setting_id id[FIELDS_MOST])
{
	static const ob_field_kind kind[] = {
		[OB_SETTING_REAL] = OB_FIELD_NUMBER,
		[OB_SETTING_COUNT] = OB_FIELD_COUNT,
		[OB_SETTING_CHOICE] = OB_FIELD_CHOICE,
		[OB_SETTING_SWITCH] = OB_FIELD_SWITCH,
	};
	size_t n = OWN_FIELDS;
	memcpy(field, own_fields, sizeof own_fields);
	for (int i = 0; i < 2 * OB_SETTINGS; i++) {
		const ob_setting_id at = (ob_setting_id)(i / 2);
		const ob_setting *s = &ob_setting_table[at];
		const char *name = i % 2 ? ob_setting_former(s->name) : s->name;
		if (!(s->flags & OB_SETTING_SCENE) || !name)
			continue;
		id[n] = at;
		field[n++] = (ob_field){
			.name = name,
			.kind = at == OB_SETTING_TOLERANCE ? OB_FIELD_LENGTH : kind[s->kind],
			.offset = at == OB_SETTING_TOLERANCE ? offsetof(scene_fields, tolerance)
							     : offsetof(scene_fields, asked) + s->offset,
			// object simulators need an iteration; 0 is the monolith's exact solver
			.low = at == OB_SETTING_ITERATIONS ? 1 : s->least,
			.high = s->most,
			.above = s->flags & OB_SETTING_ABOVE,
			.choices = s->form,
		};
	}
	return n;
}

// Sets the seed, but not after random numbers were drawn: they came from another seed.
static void set_seed(lua_State *L, ob_builder *b, uint64_t seed)
{
	if (seed == b->scene->seed || b->options->has_seed)
		return;
	if (b->random_used)
		ob_sandbox_fail(L, "scene.seed: expected before the first random number");
	b->scene->seed = seed;
	ob_random_seed(&b->random, seed);
}

static void check_settings(lua_State *L, const scene_fields *f, const ob_scene *s)
{
	static const ob_setting_id of_free[] = { OB_SETTING_UPDATE_RATE, OB_SETTING_MAX_LAG };
	const ob_settings *asked = &s->asked;
	if (f->duration / s->run.step_length > UINT32_MAX)
		ob_sandbox_fail(L, "scene.duration: expected at most %.0f steps, got %.10g", (double)UINT32_MAX,
				f->duration / s->run.step_length);
	if (ob_setting_is_set(asked, OB_SETTING_TOLERANCE) && ob_setting_is_set(asked, OB_SETTING_SUBSTEPS))
		ob_sandbox_fail(L, "scene.substeps: expected either tolerance or substeps, got both");
	for (size_t i = 0; !asked->sync && i < sizeof of_free / sizeof *of_free; i++)
		if (ob_setting_is_set(asked, of_free[i]))
			ob_sandbox_fail(L, "scene.%s: expected with sync = \"free\" only",
					ob_setting_table[of_free[i]].name);
	if (ob_setting_is_set(asked, OB_SETTING_LAG) && s->run.solver != OB_SOLVER_LAGGED)
		ob_sandbox_fail(L, "scene.lag: expected with solver = \"lagged\" only, got \"%s\"",
				ob_setting_print(&s->run, OB_SETTING_SOLVER).text);
}

// Sets the tolerance: a share counts when all objects are known (ob_builder_resolve_tolerance).
static void set_tolerance(lua_State *L, ob_builder *b, scene_fields *f)
{
	lua_Debug at;
	f->asked.tolerance_share = f->tolerance.share;
	f->asked.run.tolerance = f->tolerance.share > 0 ? OB_DEFAULT_TOLERANCE : f->tolerance.m;
	b->settings_line = lua_getstack(L, 1, &at) && lua_getinfo(L, "l", &at) ? at.currentline : 1;
}

bool ob_builder_resolve_tolerance(ob_builder *b, const char *path, ob_error *e)
{
	const ob_setting *t = &ob_setting_table[OB_SETTING_TOLERANCE];
	ob_settings *asked = &b->scene->asked;
	const double thin = ob_scene_thinnest(b->scene), tolerance = asked->tolerance_share * thin;
	if (!(asked->tolerance_share > 0) || isinf(thin))
		return true;
	if (tolerance < t->least || tolerance > t->most)
		return ob_fail(
			e, "%s:%d: scene.tolerance: %g%% of the thinnest object's %g m is %g m; expected %g to %g m",
			path, b->settings_line, 100 * asked->tolerance_share, thin, tolerance, t->least, t->most);
	asked->run.tolerance = tolerance;
	ob_run_settings_overlay(&b->scene->run, asked);
	return true;
}

// Notes the settings that are given (bits of fields).
static void note_given(lua_State *L, ob_settings *asked, uint64_t given, const ob_field *field, const ob_setting_id *id,
		       size_t count)
{
	for (size_t i = OWN_FIELDS; i < count; i++) {
		const char *name = field[i].name, *now = ob_setting_table[id[i]].name;
		if (!(given >> i & 1))
			continue;
		if (ob_setting_is_set(asked, id[i]))
			ob_sandbox_fail(L, "scene.%s is now called scene.%s: expected one of them, got both", name,
					now);
		if (strcmp(name, now) != 0)
			ob_log_note("scene.%s is now called scene.%s", name, now);
		asked->given |= 1ull << id[i];
	}
}

int ob_scene_call_scene(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_scene *s = b->scene;
	if (b->has_scene)
		ob_sandbox_fail(L, "scene: expected once, got a second time");
	b->has_scene = true;
	ob_field fields[FIELDS_MOST];
	ob_setting_id id[FIELDS_MOST];
	const size_t count = list_fields(fields, id);
	scene_fields f = {
		.title = s->title, .duration = s->duration, .seed = s->seed, .room = s->room, .gravity = s->run.gravity
	};
	const uint64_t given = ob_fields_read(L, 1, "scene", fields, count, &f);
	note_given(L, &f.asked, given, fields, id, count);
	if (f.title != s->title)
		snprintf(s->title, sizeof s->title, "%s", f.title);
	s->tour = f.tour;
	s->duration = f.duration;
	s->room = f.room;
	s->run.gravity = f.gravity;
	set_tolerance(L, b, &f);
	s->asked = f.asked;
	ob_run_settings_overlay(&s->run, &s->asked);
	check_settings(L, &f, s);
	set_seed(L, b, f.seed);
	return 0;
}

int ob_scene_call_record(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	struct {
		uint64_t every;
	} f = { b->scene->record_every };
	static const ob_field every = { .name = "every", .kind = OB_FIELD_WHOLE, .low = 1, .high = 1e6 };
	ob_fields_read(L, 1, "record", &every, 1, &f);
	b->scene->record_every = (uint32_t)f.every;
	return 0;
}

typedef struct sky_fields {
	float top[4], horizon[4];
} sky_fields;

static const ob_field sky[] = {
	OB_FIELD(sky_fields, top, .name = "top", .kind = OB_FIELD_COLOUR),
	OB_FIELD(sky_fields, horizon, .name = "horizon", .kind = OB_FIELD_COLOUR),
};

int ob_scene_call_sky(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_look_def *look = &b->scene->look;
	sky_fields f;
	memcpy(f.top, look->sky_top, sizeof look->sky_top);
	memcpy(f.horizon, look->sky_horizon, sizeof look->sky_horizon);
	ob_fields_read(L, 1, "sky", sky, 2, &f);
	memcpy(look->sky_top, f.top, sizeof look->sky_top);
	memcpy(look->sky_horizon, f.horizon, sizeof look->sky_horizon);
	return 0;
}

int ob_scene_call_sun(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	static const ob_field towards = { .name = "towards", .kind = OB_FIELD_DIRECTION };
	ob_fields_read(L, 1, "sun", &towards, 1, &b->scene->look.sun);
	return 0;
}
