// scene, record, sky, sun: what holds for the whole run and its look.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/builder.h"
#include "scene/sandbox.h"

typedef struct scene_fields {
	const char *title, *exchange, *integrator;
	ob_vec3 gravity;
	double step, duration, tolerance;
	uint64_t substeps, passes, lag, seed; // substeps and passes 0, lag NOT_SAID: not said
	bool sleeping;
} scene_fields;

enum { NOT_SAID = 1000 };
static const char *const exchanges[] = { "coloured", "jacobi", "ghost", "lagged", NULL };
static const char *const integrators[] = { "exact", "ode", NULL };

#define F(member, ...) OB_FIELD(scene_fields, member, .name = #member, __VA_ARGS__)
static const ob_field fields[] = {
	F(title, .kind = OB_FIELD_TEXT, .high = sizeof((ob_scene *)0)->title - 1),
	F(gravity, .kind = OB_FIELD_VECTOR, .low = -1e4, .high = 1e4),
	F(step, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1),
	F(duration, .kind = OB_FIELD_NUMBER, .low = 0, .above = true, .high = 1e9),
	F(substeps, .kind = OB_FIELD_WHOLE, .low = 1, .high = 256),
	F(passes, .kind = OB_FIELD_WHOLE, .low = 1, .high = 256),
	F(tolerance, .kind = OB_FIELD_NUMBER, .low = OB_SCENE_TOLERANCE_LEAST, .high = OB_SCENE_TOLERANCE_MOST),
	F(lag, .kind = OB_FIELD_WHOLE, .low = 0, .high = 256),
	F(exchange, .kind = OB_FIELD_TEXT, .choices = exchanges),
	F(integrator, .kind = OB_FIELD_TEXT, .choices = integrators),
	F(sleeping, .kind = OB_FIELD_BOOLEAN),
	F(seed, .kind = OB_FIELD_WHOLE, .low = 0, .high = 0x1p53),
};
#undef F

// Random numbers drawn before the seed is set would come from another seed.
static void set_seed(lua_State *L, ob_builder *b, uint64_t seed)
{
	if (seed == b->scene->seed || b->options->has_seed)
		return;
	if (b->random_used)
		ob_sandbox_fail(L, "scene.seed: expected before the first random number");
	b->scene->seed = seed;
	ob_random_seed(&b->random, seed);
}

// How exactly contacts are solved: by a tolerance, or by numbers.
static void set_exactness(lua_State *L, ob_scene *s, const scene_fields *f)
{
	if (f->tolerance > 0 && f->substeps)
		ob_sandbox_fail(L, "scene.substeps: expected either tolerance or substeps, got both");
	if (f->lag != NOT_SAID && strcmp(s->exchange, "lagged") != 0)
		ob_sandbox_fail(L, "scene.lag: expected with exchange = \"lagged\" only, got \"%s\"", s->exchange);
	if (f->tolerance > 0) {
		s->tolerance = f->tolerance;
		s->substeps = 1;
		s->passes = OB_SCENE_TOLERANT_PASSES;
	} else if (f->substeps) {
		s->tolerance = 0;
		s->substeps = (uint32_t)f->substeps;
	}
	if (f->passes)
		s->passes = (uint32_t)f->passes;
	if (f->lag != NOT_SAID)
		s->lag = (uint32_t)f->lag;
}

int ob_scene_call_scene(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_scene *s = b->scene;
	if (b->has_scene)
		ob_sandbox_fail(L, "scene: expected once, got a second time");
	b->has_scene = true;
	scene_fields f = {
		.title = s->title,
		.exchange = s->exchange,
		.integrator = s->integrator,
		.gravity = s->gravity,
		.step = s->step,
		.duration = s->duration,
		.lag = NOT_SAID,
		.seed = s->seed,
		.sleeping = s->sleeping,
	};
	ob_fields_read(L, 1, "scene", fields, sizeof fields / sizeof *fields, &f);
	if (f.duration / f.step > UINT32_MAX)
		ob_sandbox_fail(L, "scene.duration: expected at most %.0f steps, got %.10g", (double)UINT32_MAX,
				f.duration / f.step);
	if (f.title != s->title)
		snprintf(s->title, sizeof s->title, "%s", f.title);
	if (f.exchange != s->exchange)
		snprintf(s->exchange, sizeof s->exchange, "%s", f.exchange);
	if (f.integrator != s->integrator)
		snprintf(s->integrator, sizeof s->integrator, "%s", f.integrator);
	s->gravity = f.gravity;
	s->step = f.step;
	s->duration = f.duration;
	set_exactness(L, s, &f);
	s->sleeping = f.sleeping;
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
