#include "lab/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "shape/shape.h"

// ---- a scene's objects as a world

static bool lacks(const ob_scene *s, const char *name, const char *what, ob_error *e)
{
	return ob_fail(e, "%s: object \"%s\": the engines of the lab have no %s: leave it away", s->path, name, what);
}

// False and e: an engine of the lab could not hold the object.
static bool check(const ob_scene *s, const ob_object_def *o, ob_error *e)
{
	const ob_passport *p = &o->passport;
	if (o->script)
		return lacks(s, p->name, "scripts or FMUs", e);
	if (o->force)
		return lacks(s, p->name, "varying_force", e);
	if (o->born > 0 || isfinite(o->dies))
		return lacks(s, p->name, "births or deaths", e);
	if (o->path && o->path->points)
		return lacks(s, p->name, "paths of kind \"spline\"", e);
	if (p->flags & OB_OBJECT_SENSOR || ob_passport_group(p) || p->flags >> OB_OBJECT_PASSES)
		return lacks(s, p->name, "groups or sensors", e);
	return !ob_shape_is((ob_shape)p->shape, OB_SURFACED) || lacks(s, p->name, "heightfields or meshes", e);
}

static void *copy_of(const void *from, size_t count, size_t size)
{
	void *to = calloc(count + 1, size);
	if (to && count)
		memcpy(to, from, count * size);
	return to;
}

static void put(ob_world *w, const ob_object_def *o)
{
	const uint32_t id = w->objects++;
	ob_passport *p = &w->passport[id];
	*p = o->passport;
	p->generation = 1;
	if (p->flags & OB_OBJECT_PRESCRIBED)
		p->inertia = ob_v3(0, 0, 0);
	else if (!(p->inertia.x > 0))
		p->inertia = ob_shape_inertia((ob_shape)p->shape, p->size,
					      ob_shape_is((ob_shape)p->shape, OB_HULLED) ? &w->hull[p->hull] : NULL,
					      p->mass);
	w->state[id] = o->state;
	if (o->path)
		w->path[w->paths++] = (struct ob_world_path){ id, *o->path };
}

static bool make_world(const ob_scene *s, ob_world *w, ob_error *e)
{
	*w = (ob_world){ .gravity = s->run.gravity, .objects_max = s->objects, .hulls = s->hulls, .joints = s->joints };
	w->passport = calloc(s->objects + 1, sizeof *w->passport);
	w->state = calloc(s->objects + 1, sizeof *w->state);
	w->path = calloc(s->objects + 1, sizeof *w->path);
	w->hull = copy_of(s->hull, s->hulls, sizeof *s->hull);
	w->joint = copy_of(s->joint, s->joints, sizeof *s->joint);
	if (!w->passport || !w->state || !w->path || !w->hull || !w->joint)
		return ob_fail(e, "%s: no memory for a world of %u objects", s->path, s->objects);
	for (uint32_t i = 0; i < s->objects; i++) {
		if (!check(s, &s->object[i], e))
			return false;
		put(w, &s->object[i]);
	}
	return true;
}

static ob_scene *load(const char *path, const char *text, size_t size, const char *variant, uint32_t run, ob_error *e)
{
	char words[2][OB_CASE_NAME + 16];
	const char *defines[2] = { words[0], words[1] };
	ob_scene_options o = { .defines = defines };
	if (run)
		snprintf(words[o.define_count++], sizeof words[0], "run=%u", run);
	if (variant)
		snprintf(words[o.define_count++], sizeof words[0], "variant=%s", variant);
	return ob_scene_load_text(path, text, size, &o, e);
}

ob_scene *ob_lab_scene_load(const ob_case *c, uint32_t run, ob_world *w, ob_error *e)
{
	const ob_case_text *t = c->text;
	ob_scene *s = load(t->path, t->text, t->size, t->variant, run, e);
	*w = (ob_world){ 0 };
	if (s && make_world(s, w, e))
		return s;
	ob_world_finish(w);
	ob_scene_free(s);
	return NULL;
}

bool ob_lab_snapshot_begin(ob_snapshot *now, const ob_world *w)
{
	*now = (ob_snapshot){ .count = w->objects, .passport = w->passport, .joint = w->joint, .joints = w->joints };
	now->motion = calloc(w->objects + 1, sizeof *now->motion);
	now->hull = calloc(w->hulls + 1, sizeof *now->hull);
	for (uint32_t i = 0; i < w->hulls && now->hull; i++)
		now->hull[i] = &w->hull[i];
	now->hulls = now->hull ? w->hulls : 0;
	return now->motion && now->hull;
}

void ob_lab_snapshot_take(ob_snapshot *now, double time, ob_state *state)
{
	now->time = time;
	now->state = state;
	for (uint32_t id = 0; id < now->count; id++) {
		const ob_state *s = &state[id];
		now->motion[id] = (ob_motion){ .t0 = time, .valid_until = INFINITY, .p = s->pose.p, .q = s->pose.q };
		now->motion[id].v = s->v;
		now->motion[id].w = s->w;
	}
}

void ob_lab_snapshot_end(ob_snapshot *now)
{
	free(now->motion);
	free(now->hull);
}

// ---- a scene as a case

// A case with all that it points to.
typedef struct own_case {
	ob_case of;
	ob_case_text text;
	char title[sizeof((ob_scene *)0)->title];
	ob_case_def def;
	ob_expectation expectation[OB_EXPECTATIONS_MAX];
} own_case;

static const ob_case *make_case(const ob_case_text *text, const ob_scene *s, ob_error *e)
{
	own_case *own = calloc(1, sizeof *own);
	const ob_expected *x = s->expected;
	if (!own)
		return ob_fail(e, "%s: no memory", text->path), NULL;
	own->text = *text;
	own->def = x->of;
	memcpy(own->title, s->title, sizeof own->title);
	memcpy(own->expectation, x->expectation, sizeof own->expectation);
	if (!*own->def.name) {
		const char *slash = strrchr(s->path, '/'), *file = slash ? slash + 1 : s->path;
		snprintf(own->def.name, sizeof own->def.name, "%.*s", (int)strcspn(file, "."), file);
	}
	own->of = (ob_case){ .text = &own->text,
			     .row = (int)own->def.row,
			     .name = own->def.name,
			     .title = own->title,
			     .setup = own->def.setup,
			     .others = *own->def.others ? own->def.others : NULL,
			     .slow = own->def.slow,
			     .compared = own->def.compared,
			     .sleeps = own->def.sleeps,
			     .duration = s->duration,
			     .runs = own->def.runs,
			     .figures = x->count };
	for (uint32_t i = 0; i < x->count; i++) {
		const ob_expectation *one = &own->expectation[i];
		own->of.figure[i] = (ob_figure_def){ one->name, one->unit, one->limit, one->source };
		own->of.averaged |= (unsigned)one->mean << i;
	}
	return &own->of;
}

// False and e: an engine could not run it, or its functions fail at its start.
static bool try_start(ob_scene *s, ob_error *e)
{
	ob_world w = { 0 };
	ob_snapshot now = { 0 };
	bool fine = make_world(s, &w, e) && (ob_lab_snapshot_begin(&now, &w) || ob_fail(e, "%s: no memory", s->path));
	if (fine) {
		ob_lab_snapshot_take(&now, 0, w.state);
		fine = ob_expected_look(s->expected, &now, &s->run, e);
	}
	ob_lab_snapshot_end(&now);
	ob_world_finish(&w);
	return fine;
}

static bool read_variant(const ob_case_text *text, bool own, ob_case_def *def,
			 bool (*add)(const ob_case *c, ob_error *e), ob_error *e)
{
	ob_scene *s = load(text->path, text->text, text->size, text->variant, 0, e);
	bool fine =
		s &&
		((s->expected && s->expected->count) ||
		 ob_fail(e,
			 "%s:1: expected what must come of it: expect { \"name\", below = .01, function(run) ... end }",
			 text->path));
	if (fine)
		*def = s->expected->of;
	const ob_case *c = fine ? make_case(text, s, e) : NULL;
	fine = c && (!own || try_start(s, e)) && add(c, e);
	ob_scene_free(s);
	return fine;
}

bool ob_lab_scene_read(const char *path, const char *text, bool (*add)(const ob_case *c, ob_error *e), ob_error *e)
{
	enum { FILE_MOST = 4 << 20 };
	ob_error why;
	ob_case_text one = { .path = strdup(path), .size = text ? strlen(text) : 0 };
	one.text = text ? strdup(text) : ob_file_load(path, FILE_MOST, &one.size, &why);
	if (!one.path || !one.text)
		return ob_fail(e, "%s: cannot read the scene: %s", path, text ? "no memory" : why.text);
	ob_case_def *def = calloc(1, sizeof *def);
	bool fine = def && read_variant(&one, !text, def, add, e);
	const uint32_t variants = def ? def->variants : 0;
	for (uint32_t i = 1; i < variants && fine; i++) {
		one.variant = strdup(def->variant[i]);
		fine = one.variant && read_variant(&one, !text, &(ob_case_def){ 0 }, add, e);
	}
	free(def);
	return fine;
}
