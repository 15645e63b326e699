#include "random_scene.h"

#include "motion/random.h"
#include "scene/scene.h"

const char *const scene_kind_name[SCENE_KINDS] = { "hits",    "spins", "bounce", "heap",
						   "statics", "stack", "slide",  "roll" };

static const double gravity = 9.81; // m/s^2

typedef struct dice {
	uint64_t seed;
	unsigned shapes;
	double size; // m, of the scene's bodies
	double density, friction, restitution;
} dice;

static double decades(dice *d, double low, double high)
{
	return pow(10, within(&d->seed, low, high));
}

static int pick(dice *d, int most)
{
	return (int)(most * uniform(&d->seed));
}

static ob_shape draw_shape(dice *d, unsigned of)
{
	static const ob_shape all[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	unsigned set = d->shapes & of;
	for (int i = 0; set && i < 64; i++) {
		ob_shape s = all[pick(d, 4)];
		if (set & 1u << s)
			return s;
	}
	return OB_SHAPE_SPHERE;
}

static double volume(ob_shape shape, ob_vec3 size)
{
	const double pi = 3.14159265358979323846, r2 = size.x * size.x;
	switch (shape) {
	case OB_SHAPE_BOX:
		return 8 * size.x * size.y * size.z;
	case OB_SHAPE_CYLINDER:
		return 2 * pi * r2 * size.y;
	case OB_SHAPE_CAPSULE:
		return 2 * pi * r2 * size.y + 4. / 3 * pi * r2 * size.x;
	default:
		return 4. / 3 * pi * r2 * size.x;
	}
}

static scene_body *add(random_scene *s, dice *d, ob_shape shape, ob_vec3 size, ob_vec3 p)
{
	scene_body *b = &s->body[s->bodies++];
	*b = (scene_body){ shape,       size,           d->density * volume(shape, size),
			   d->friction, d->restitution, { .pose = { p, ob_quat_identity() } } };
	return b;
}

// Extents of a third to the whole of the scene's size.
static scene_body *add_any(random_scene *s, dice *d, unsigned shapes, ob_vec3 p)
{
	double x = d->size * within(&d->seed, .33, 1), y = d->size * within(&d->seed, .33, 1);
	ob_vec3 size = ob_v3(x, y, d->size * within(&d->seed, .33, 1));
	scene_body *b = add(s, d, draw_shape(d, shapes), size, p);
	b->state.pose.q = random_attitude(&d->seed);
	return b;
}

static void add_ground(random_scene *s, dice *d)
{
	scene_body *b = add(s, d, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0));
	b->mass = 0;
	if (uniform(&d->seed) < .3)
		b->friction = 0;
}

// The i-th cell of a grid of two by two by as many layers as it takes, about the vertical axis.
static ob_vec3 cell(int i)
{
	return ob_v3(i % 2 - .5, i / 2 % 2 - .5, i / 4);
}

// ---- kinds

static void draw_hits(random_scene *s, dice *d)
{
	int n = 2 + pick(d, 5);
	double speed = decades(d, -1, 1) * sqrt(gravity * d->size);
	for (int i = 0; i < n; i++) {
		ob_vec3 at = ob_scale(ob_sub(cell(i), ob_v3(0, 0, .5)), 5 * d->size);
		scene_body *b = add_any(s, d, ~0u, ob_add(at, random_vector(&d->seed, .5 * d->size)));
		ob_vec3 in = ob_scale(at, -within(&d->seed, .3, 1) * speed / (3 * d->size));
		b->state.v = ob_add(in, random_vector(&d->seed, .2 * speed));
		b->state.w = random_vector(&d->seed, within(&d->seed, 0, 2) * speed / d->size);
	}
}

static void draw_spins(random_scene *s, dice *d)
{
	int n = 2 + pick(d, 3);
	for (int i = 0; i < n; i++) {
		ob_vec3 at = ob_scale(cell(i), (2.2 + within(&d->seed, 0, 1.6)) * d->size);
		scene_body *b = add_any(s, d, ~0u, at);
		b->state.v = random_vector(&d->seed, within(&d->seed, 0, 1) * d->size);
		b->state.w = random_vector(&d->seed, 57 * uniform(&d->seed));
	}
}

static void draw_bounce(random_scene *s, dice *d)
{
	int n = 1 + pick(d, 3);
	double speed = sqrt(gravity * d->size);
	add_ground(s, d);
	for (int i = 0; i < n; i++) {
		ob_vec3 at = ob_scale(cell(i), 3.7 * d->size);
		scene_body *b = add_any(s, d, ~0u, ob_add(at, ob_v3(0, 0, within(&d->seed, 2, 6) * d->size)));
		b->state.v = random_vector(&d->seed, within(&d->seed, 0, 2) * speed);
		b->state.w = random_vector(&d->seed, within(&d->seed, 0, 2) * speed / d->size);
		if (uniform(&d->seed) < .2)
			b->state.pose.q = ob_quat_identity(), b->state.w = ob_v3(0, 0, 0);
	}
}

static void drop_heap(random_scene *s, dice *d, int n, double height)
{
	for (int i = 0; i < n; i++) {
		ob_vec3 at = ob_scale(ob_add(cell(i), random_vector(&d->seed, .05)), 3.6 * d->size);
		scene_body *b = add_any(s, d, ~0u, ob_add(at, ob_v3(0, 0, height)));
		b->state.v = ob_scale(ob_v3(-at.x, -at.y, 0), within(&d->seed, 0, 2));
	}
}

static void draw_heap(random_scene *s, dice *d)
{
	add_ground(s, d);
	drop_heap(s, d, 2 + pick(d, 6), 2.2 * d->size);
}

static void draw_statics(random_scene *s, dice *d)
{
	int n = 1 + pick(d, 3);
	for (int i = 0; i < n; i++) {
		ob_vec3 half = ob_scale(ob_v3(within(&d->seed, 1, 4), within(&d->seed, 1, 4), .5), d->size);
		ob_vec3 p = ob_add(random_vector(&d->seed, d->size), ob_v3(0, 0, -2 * d->size));
		scene_body *b = add(s, d, OB_SHAPE_BOX, half, p);
		b->mass = 0;
		if (uniform(&d->seed) < .5)
			b->state.pose.q = ob_quat_turn(ob_quat_identity(), random_vector(&d->seed, .3));
	}
	drop_heap(s, d, 2 + pick(d, 5), 2.2 * d->size);
}

static void draw_stack(random_scene *s, dice *d)
{
	int n = 2 + pick(d, 5);
	double top = 0;
	add_ground(s, d);
	for (int i = 0; i < n; i++) {
		ob_vec3 half = ob_v3(within(&d->seed, .6, 1), within(&d->seed, .6, 1), within(&d->seed, .2, 1));
		half = ob_scale(half, d->size);
		ob_vec3 off = random_vector(&d->seed, .2 * d->size);
		scene_body *b = add(s, d, OB_SHAPE_BOX, half, ob_v3(off.x, off.y, top + half.z));
		b->state.pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, within(&d->seed, -3, 3)));
		top += 2 * half.z;
	}
}

static void draw_slide(random_scene *s, dice *d)
{
	int n = 1 + pick(d, 2);
	double speed = decades(d, -1, .7) * sqrt(gravity * d->size);
	if (uniform(&d->seed) < .6)
		add_ground(s, d);
	else
		add(s, d, OB_SHAPE_BOX, ob_scale(ob_v3(30, 30, 1), d->size), ob_v3(0, 0, -d->size))->mass = 0;
	for (int i = 0; i < n; i++) {
		ob_vec3 half = ob_v3(within(&d->seed, .6, 1), within(&d->seed, .6, 1), within(&d->seed, .1, .5));
		half = ob_scale(half, d->size);
		scene_body *b = add(s, d, OB_SHAPE_BOX, half, ob_v3(0, 4 * i * d->size, half.z));
		b->state.pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, within(&d->seed, -3, 3)));
		double angle = within(&d->seed, -3, 3);
		b->state.v = ob_scale(ob_v3(cos(angle), .3 * sin(angle), 0), speed);
		b->state.w = ob_v3(0, 0, within(&d->seed, -2, 2) * speed / d->size);
		b->restitution = 0;
	}
	s->body[0].restitution = 0;
}

static void draw_roll(random_scene *s, dice *d)
{
	const unsigned round = 1u << OB_SHAPE_SPHERE | 1u << OB_SHAPE_CYLINDER | 1u << OB_SHAPE_CAPSULE;
	int n = 1 + pick(d, 3);
	double speed = decades(d, -1, .7) * sqrt(gravity * d->size);
	add_ground(s, d);
	for (int i = 0; i < n; i++) {
		scene_body *b = add_any(s, d, round, ob_v3(0, 5 * i * d->size, 0));
		b->state.pose.p.z = b->size.x;
		b->state.pose.q = ob_quat_turn(ob_quat_turn(ob_quat_identity(), ob_v3(1.5707963267948966, 0, 0)),
					       ob_v3(0, 0, within(&d->seed, -.5, .5)));
		b->state.v = ob_v3(speed, within(&d->seed, -.3, .3) * speed, 0);
		b->state.w = random_vector(&d->seed, within(&d->seed, 0, 2) * speed / d->size);
		b->restitution = 0;
	}
	s->body[0].restitution = 0;
}

// ---- a scene

random_scene scene_draw(scene_kind kind, uint64_t seed, unsigned shapes)
{
	static void (*const draw[SCENE_KINDS])(random_scene *, dice *) = { draw_hits,  draw_spins,   draw_bounce,
									   draw_heap,  draw_statics, draw_stack,
									   draw_slide, draw_roll };
	random_scene s = { .run = ob_run_settings_default() };
	dice d = { .seed = seed * SCENE_KINDS + kind, .shapes = shapes };
	double e = uniform(&d.seed), which = uniform(&d.seed);
	d.size = decades(&d, -1.7, .3);
	d.density = decades(&d, 2, 4);
	d.restitution = which < .25 && kind != SCENE_BOUNCE ? 0 : which < .4 ? 1 : e;
	d.friction = uniform(&d.seed) < .15 ? 0 : uniform(&d.seed);
	s.run.sleeping = 0;
	s.run.gravity = ob_v3(0, 0, kind == SCENE_HITS || kind == SCENE_SPINS ? 0 : -gravity);
	draw[kind](&s, &d);
	if (uniform(&d.seed) < .5)
		return s;
	for (uint32_t i = 0; i < s.bodies; i++) { // materials of their own
		s.body[i].friction = s.body[i].mass > 0 ? uniform(&d.seed) : s.body[i].friction;
		s.body[i].mass *= decades(&d, -.5, .5);
	}
	return s;
}

bool scene_is_closed(const random_scene *s)
{
	for (uint32_t i = 0; i < s->bodies; i++)
		if (s->body[i].mass == 0)
			return false;
	return ob_norm(s->run.gravity) == 0;
}

// ---- files

static void print_vector(FILE *out, const char *field, ob_vec3 v)
{
	if (ob_norm2(v) > 0)
		fprintf(out, ", %s = { %.17g, %.17g, %.17g }", field, v.x, v.y, v.z);
}

static void print_body(FILE *out, const scene_body *b)
{
	static const char *const call[] = { "", "sphere", "box", "plane", "capsule", "cylinder" };
	fprintf(out, "%s { friction = %.17g, restitution = %.17g", call[b->shape], b->friction, b->restitution);
	print_vector(out, "at", b->state.pose.p);
	if (b->shape == OB_SHAPE_PLANE) {
		ob_mat3 r = ob_quat_matrix(b->state.pose.q);
		print_vector(out, "normal", ob_column(&r, 2));
	} else {
		ob_quat q = b->state.pose.q;
		if (b->shape == OB_SHAPE_BOX)
			print_vector(out, "size", ob_scale(b->size, 2));
		else
			fprintf(out, ", radius = %.17g", b->size.x);
		if (b->shape == OB_SHAPE_CAPSULE || b->shape == OB_SHAPE_CYLINDER)
			fprintf(out, ", length = %.17g", 2 * b->size.y);
		if (q.w != 1)
			fprintf(out, ", q = { %.17g, %.17g, %.17g, %.17g }", q.w, q.x, q.y, q.z);
		if (b->mass > 0)
			fprintf(out, ", mass = %.17g", b->mass);
		else
			fprintf(out, ", static = true");
	}
	print_vector(out, "velocity", b->state.v);
	print_vector(out, "spin", b->state.w);
	fprintf(out, " }\n");
}

void scene_print(FILE *out, const random_scene *s)
{
	fprintf(out, "scene { gravity = { %.17g, %.17g, %.17g }, step = %.17g, sleeping = %s, duration = 1 }\n",
		s->run.gravity.x, s->run.gravity.y, s->run.gravity.z, s->run.step_length,
		s->run.sleeping ? "true" : "false");
	for (uint32_t i = 0; i < s->bodies; i++)
		print_body(out, &s->body[i]);
}

bool scene_read(const char *path, random_scene *s, ob_error *e)
{
	ob_scene *from = ob_scene_load(path, NULL, e);
	if (!from)
		return false;
	*s = (random_scene){ .run = ob_run_settings_default() };
	s->run.gravity = from->run.gravity;
	ob_run_settings_overlay(&s->run, &from->run);
	bool fits = from->objects <= SCENE_BODIES || ob_fail(e, "%s: %u bodies are too many", path, from->objects);
	for (uint32_t i = 0; fits && i < from->objects; i++) {
		const ob_object_def *o = &from->object[i];
		s->body[s->bodies++] = (scene_body){ o->passport.shape,    o->passport.size,        o->passport.mass,
						     o->passport.friction, o->passport.restitution, o->state };
	}
	ob_scene_free(from);
	return fits;
}
