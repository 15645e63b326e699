#include "random_scene.h"

#include "hull/hull.h"
#include "hull/solids.h"
#include "motion/random.h"
#include "scene/scene.h"

const char *const scene_kind_name[SCENE_KINDS] = { "hits",  "spins", "bounce", "heap",    "statics", "stack",
						   "slide", "roll",  "tables", "paddles", "pushed" };

static const double gravity = 9.81; // m/s^2
static const double pi = 3.14159265358979323846;

typedef struct dice {
	uint64_t seed;
	unsigned shapes;
	double size; // m, scale of the scene's bodies
	double density, friction, restitution;
} dice;

static double decades(dice *d, double low, double high)
{
	return pow(10, within(&d->seed, low, high));
}

// Draws x and y in separate statements: the order in which a compiler evaluates arguments is unspecified.
static ob_vec3 level_within(dice *d, double low, double high, double z)
{
	double x = within(&d->seed, low, high), y = within(&d->seed, low, high);
	return ob_v3(x, y, z);
}

static int pick(dice *d, int most)
{
	return (int)(most * uniform(&d->seed));
}

static ob_shape draw_shape(dice *d, unsigned of)
{
	static const ob_shape all[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER,
					OB_SHAPE_HULL };
	unsigned set = d->shapes & of;
	for (int i = 0; set && i < 64; i++) {
		ob_shape s = all[pick(d, d->shapes & 1u << OB_SHAPE_HULL ? 5 : 4)];
		if (set & 1u << s)
			return s;
	}
	return OB_SHAPE_SPHERE;
}

static double volume(ob_shape shape, ob_vec3 size)
{
	const double r2 = size.x * size.x;
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
	*b = (scene_body){ .shape = shape,
			   .size = shape == OB_SHAPE_SPHERE ? ob_v3(size.x, 0, 0) : size,
			   .mass = d->density * volume(shape, size),
			   .friction = d->friction,
			   .restitution = d->restitution,
			   .state.pose = { p, ob_quat_identity() } };
	return b;
}

// ---- hulls

bool scene_make_hull(scene_body *b)
{
	ob_hull h;
	ob_error e;
	if (!ob_hull_build(b->point, b->points, &h, &e))
		return false;
	for (uint32_t i = 0; i < b->points; i++)
		b->point[i] = ob_sub(b->point[i], h.centre);
	b->size = ob_hull_size(&h);
	return true;
}

static void put_point(scene_body *b, double x, double y, double z)
{
	b->point[b->points++] = ob_v3(x, y, z);
}

// Puts the corners of a regular polygon, the first at a random angle, or at the axis.
static void put_polygon(scene_body *b, dice *d, int corners, double radius, double z)
{
	double first = within(&d->seed, -3, 3);
	for (int i = 0; i < corners; i++)
		put_point(b, radius * cos(first + 2 * pi * i / corners), radius * sin(first + 2 * pi * i / corners), z);
}

static void put_prism(scene_body *b, dice *d)
{
	uint64_t seed = d->seed;
	int corners = 3 + pick(d, 6);
	for (int side = -1; side <= 1; side += 2) {
		dice same = { .seed = seed };
		put_polygon(b, &same, corners, 1, side);
	}
}

static void put_pebble(scene_body *b, dice *d)
{
	int corners = 5 + pick(d, 10);
	while (b->points < (uint32_t)corners) {
		ob_vec3 x = random_vector(&d->seed, 1);
		double r = ob_norm(x);
		put_point(b, x.x / r, x.y / r, x.z / r);
	}
}

static void put_solid(scene_body *b, dice *d)
{
	solid all[5];
	solids_make(all);
	const solid *s = &all[pick(d, 5)];
	for (int i = 0; i < s->corners; i++)
		b->point[b->points++] = ob_scale(s->corner[i], 1 / s->radius);
}

static void put_cuboid(scene_body *b)
{
	for (int k = 0; k < 8; k++)
		put_point(b, k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
}

static void put_wedge(scene_body *b)
{
	for (int k = 0; k < 8; k++)
		if ((k & 5) != 5)
			put_point(b, k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
}

static void put_cone(scene_body *b, dice *d)
{
	put_polygon(b, d, 3 + pick(d, 10), 1, -1);
	put_point(b, 0, 0, 1);
}

static double hull_volume(const scene_body *b)
{
	ob_hull h;
	ob_error e;
	return ob_hull_build(b->point, b->points, &h, &e) ? h.volume : 0;
}

// Draws a hull of half extents "half", about its centre of mass.
static void draw_hull(scene_body *b, dice *d, ob_vec3 half, bool prism)
{
	do {
		int form = prism ? 0 : pick(d, 6);
		b->points = 0;
		if (form == 0)
			put_prism(b, d);
		else if (form == 1)
			put_pebble(b, d);
		else if (form == 2)
			put_solid(b, d);
		else if (form == 3)
			put_cuboid(b);
		else if (form == 4)
			put_wedge(b);
		else
			put_cone(b, d);
		double y = form == 2 ? half.x : half.y, z = form == 2 ? half.x : half.z;
		for (uint32_t i = 0; i < b->points; i++)
			b->point[i] = ob_v3(half.x * b->point[i].x, y * b->point[i].y, z * b->point[i].z);
	} while (!scene_make_hull(b));
	b->mass = d->density * hull_volume(b);
}

// ---- bodies

// Adds a body with extents of a third to the whole of the scene's size.
static scene_body *add_any(random_scene *s, dice *d, unsigned shapes, ob_vec3 p)
{
	double x = d->size * within(&d->seed, .33, 1), y = d->size * within(&d->seed, .33, 1);
	ob_vec3 size = ob_v3(x, y, d->size * within(&d->seed, .33, 1));
	scene_body *b = add(s, d, draw_shape(d, shapes), size, p);
	if (b->shape == OB_SHAPE_HULL)
		draw_hull(b, d, size, false);
	b->state.pose.q = random_attitude(&d->seed);
	return b;
}

// Adds a box with level faces, or a prism if hulls are drawn.
static scene_body *add_level(random_scene *s, dice *d, ob_vec3 half, ob_vec3 p)
{
	scene_body *b = add(s, d, OB_SHAPE_BOX, half, p);
	if (d->shapes & 1u << OB_SHAPE_HULL && uniform(&d->seed) < .7) {
		b->shape = OB_SHAPE_HULL;
		draw_hull(b, d, half, true);
	}
	return b;
}

static void add_ground(random_scene *s, dice *d)
{
	scene_body *b = add(s, d, OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0));
	b->mass = 0;
	if (uniform(&d->seed) < .3)
		b->friction = 0;
}

// The i-th cell of a grid of two by two by as many layers as needed, about the vertical axis.
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
		ob_vec3 half = ob_scale(level_within(d, 1, 4, .5), d->size);
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
		ob_vec3 half = level_within(d, .6, 1, 0);
		half.z = within(&d->seed, .2, 1);
		half = ob_scale(half, d->size);
		ob_vec3 off = random_vector(&d->seed, .2 * d->size);
		scene_body *b = add_level(s, d, half, ob_v3(off.x, off.y, top + half.z));
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
		ob_vec3 half = level_within(d, .6, 1, 0);
		half.z = within(&d->seed, .1, .5);
		half = ob_scale(half, d->size);
		scene_body *b = add_level(s, d, half, ob_v3(0, 4 * i * d->size, half.z));
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

static void swing_it(scene_body *b, dice *d, bool level)
{
	double frequency = decades(d, -.3, .7) * sqrt(gravity / d->size);
	double reach = within(&d->seed, .1, 3) * gravity / (frequency * frequency);
	ob_vec3 way = random_vector(&d->seed, 1);
	if (level)
		way.z = 0;
	way = ob_scale(way, fmin(reach, d->size) / ob_norm(way));
	b->path = ob_path_sine(&b->state, way, frequency, within(&d->seed, -3, 3));
}

static void turn_about_a_centre(scene_body *b, dice *d)
{
	ob_vec3 off = random_vector(&d->seed, d->size), axis = random_vector(&d->seed, 1);
	if (uniform(&d->seed) < .5)
		axis = ob_v3(0, 0, 1);
	b->path = ob_path_circle(&b->state, ob_add(b->state.pose.p, off), ob_scale(axis, 1 / ob_norm(axis)),
				 within(&d->seed, .2, 1) * sqrt(gravity / d->size));
}

static void draw_tables(random_scene *s, dice *d)
{
	double speed = sqrt(gravity * d->size), rate = sqrt(gravity / d->size);
	ob_vec3 half = ob_scale(level_within(d, 3, 6, .5), d->size);
	scene_body *b = add_level(s, d, half, ob_v3(0, 0, -.5 * d->size));
	int how = pick(d, 6), n = 1 + pick(d, 3);
	b->mass = 0;
	b->driven = how != 0;
	if (how == 0)
		b->running = ob_scale(level_within(d, -1, 1, 0), speed);
	else if (how == 1)
		b->state.v = random_vector(&d->seed, within(&d->seed, 0, 1) * speed);
	else if (how == 2 || how == 3)
		swing_it(b, d, how == 2);
	else if (how == 4)
		turn_about_a_centre(b, d);
	if (how == 5 || (how == 4 && uniform(&d->seed) < .5))
		b->state.w = ob_v3(0, 0, within(&d->seed, -1, 1) * rate);
	if (uniform(&d->seed) < .6)
		return drop_heap(s, d, n, 2.2 * d->size);
	for (int i = 0; i < n; i++) {
		half = level_within(d, .6, 1, 0);
		half.z = within(&d->seed, .1, .5);
		half = ob_scale(half, d->size);
		b = add_level(s, d, half, ob_v3(0, 2.6 * (i - .5 * (n - 1)) * d->size, half.z));
		b->state.pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, within(&d->seed, -3, 3)));
		b->restitution = 0;
	}
	s->body[0].restitution = 0;
}

static void draw_paddles(random_scene *s, dice *d)
{
	draw_hits(s, d);
	double speed = decades(d, -1, 1) * sqrt(gravity * d->size);
	scene_body *b = add_any(s, d, ~(1u << OB_SHAPE_SPHERE), ob_v3(0, 0, 0));
	b->mass = 0;
	b->driven = true;
	if (uniform(&d->seed) < .5)
		b->state.v = random_vector(&d->seed, .3 * speed);
	else if (uniform(&d->seed) < .5)
		swing_it(b, d, false);
	if (uniform(&d->seed) < .7)
		b->state.w = random_vector(&d->seed, within(&d->seed, 0, 2) * speed / d->size);
}

static void draw_pushed(random_scene *s, dice *d)
{
	double rate = sqrt(gravity / d->size);
	if (uniform(&d->seed) < .5) {
		add_ground(s, d);
		drop_heap(s, d, 1 + pick(d, 3), 2.2 * d->size);
	} else {
		s->run.gravity = ob_v3(0, 0, 0);
		draw_hits(s, d);
	}
	for (uint32_t i = 0; i < s->bodies; i++) {
		scene_body *b = &s->body[i];
		if (b->mass == 0 || uniform(&d->seed) < .3)
			continue;
		b->pushed = true;
		b->push = (ob_force){ .kind = uniform(&d->seed) < .5 ? OB_FORCE_SINE : OB_FORCE_PULSE,
				      .force = random_vector(&d->seed, 2 * gravity * b->mass),
				      .frequency = decades(d, -.5, .7) * rate,
				      .phase = within(&d->seed, -3, 3) };
		b->push.from = within(&d->seed, 0, .3);
		b->push.until = b->push.from + within(&d->seed, .05, .5);
	}
}

// ---- a scene

random_scene scene_draw(scene_kind kind, uint64_t seed, unsigned shapes)
{
	static void (*const draw[SCENE_KINDS])(
		random_scene *, dice *) = { draw_hits,  draw_spins, draw_bounce, draw_heap,    draw_statics, draw_stack,
					    draw_slide, draw_roll,  draw_tables, draw_paddles, draw_pushed };
	random_scene s = { .run = ob_run_settings_default() };
	enum { FIRST_KINDS = 8 }; // further kinds do not change the scenes of these
	dice d = { .seed = seed * FIRST_KINDS + kind % FIRST_KINDS + ((uint64_t)(kind / FIRST_KINDS) << 32),
		   .shapes = shapes };
	double e = uniform(&d.seed), which = uniform(&d.seed);
	d.size = decades(&d, -1.7, .3);
	d.density = decades(&d, 2, 4);
	d.restitution = which < .25 && kind != SCENE_BOUNCE ? 0 : which < .4 ? 1 : e;
	d.friction = uniform(&d.seed) < .15 ? 0 : uniform(&d.seed);
	s.run.sleeping = 0;
	s.run.gravity = ob_v3(0, 0, kind == SCENE_HITS || kind == SCENE_SPINS || kind == SCENE_PADDLES ? 0 : -gravity);
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
		if (s->body[i].mass == 0 || s->body[i].pushed)
			return false;
	return ob_norm(s->run.gravity) == 0;
}

// ---- files

static void print_vector(FILE *out, const char *field, ob_vec3 v)
{
	if (ob_norm2(v) > 0)
		fprintf(out, ", %s = { %.17g, %.17g, %.17g }", field, v.x, v.y, v.z);
}

// Prints sines and circles, the only paths that are drawn.
static void print_path(FILE *out, const scene_body *b)
{
	const double f = b->path.frequency;
	const ob_vec3 v = ob_scale(b->state.v, 1 / f), a = ob_scale(b->path.a, 1 / (f * f)), across = ob_cross(v, a);
	if (ob_norm(across) > 1e-9 * (ob_norm2(v) + ob_norm2(a))) {
		print_vector(out, "at", b->state.pose.p);
		fprintf(out, ", path = { kind = \"circle\", frequency = %.17g", f / (2 * pi));
		print_vector(out, "centre", ob_add(b->state.pose.p, a));
		print_vector(out, "axis", ob_scale(across, 1 / ob_norm(across)));
	} else {
		const bool along = ob_norm2(v) > ob_norm2(a);
		const ob_vec3 d = ob_scale(along ? v : a, 1 / ob_norm(along ? v : a));
		const double phase = atan2(-ob_dot(a, d), ob_dot(v, d)), reach = hypot(ob_dot(a, d), ob_dot(v, d));
		print_vector(out, "at", ob_add(b->state.pose.p, a));
		fprintf(out, ", path = { kind = \"sine\", frequency = %.17g, phase = %.17g", f / (2 * pi), phase);
		print_vector(out, "amplitude", ob_scale(d, reach));
	}
	fprintf(out, " }");
}

static void print_push(FILE *out, const ob_force *f)
{
	fprintf(out, ", varying_force = { kind = \"%s\"", f->kind == OB_FORCE_SINE ? "sine" : "pulse");
	print_vector(out, "force", f->force);
	if (f->kind == OB_FORCE_SINE)
		fprintf(out, ", frequency = %.17g, phase = %.17g }", f->frequency / (2 * pi), f->phase);
	else
		fprintf(out, ", from = %.17g, to = %.17g }", f->from, f->until);
}

static void print_points(FILE *out, const scene_body *b)
{
	fprintf(out, ", points = {");
	for (uint32_t i = 0; i < b->points; i++)
		fprintf(out, "%s { %.17g, %.17g, %.17g }", i ? "," : "", b->point[i].x, b->point[i].y, b->point[i].z);
	fprintf(out, " }");
}

static void print_body(FILE *out, const scene_body *b)
{
	static const char *const call[] = { "", "sphere", "box", "plane", "capsule", "cylinder", "hull" };
	fprintf(out, "%s { friction = %.17g, restitution = %.17g", call[b->shape], b->friction, b->restitution);
	if (b->path.frequency > 0)
		print_path(out, b);
	else
		print_vector(out, "at", b->state.pose.p);
	print_vector(out, "surface_velocity", b->running);
	if (b->pushed)
		print_push(out, &b->push);
	if (b->shape == OB_SHAPE_PLANE) {
		ob_mat3 r = ob_quat_matrix(b->state.pose.q);
		print_vector(out, "normal", ob_column(&r, 2));
	} else {
		ob_quat q = b->state.pose.q;
		if (b->shape == OB_SHAPE_BOX)
			print_vector(out, "size", ob_scale(b->size, 2));
		else if (b->shape == OB_SHAPE_HULL)
			print_points(out, b);
		else
			fprintf(out, ", radius = %.17g", b->size.x);
		if (b->shape == OB_SHAPE_CAPSULE || b->shape == OB_SHAPE_CYLINDER)
			fprintf(out, ", length = %.17g", 2 * b->size.y);
		if (q.w != 1)
			fprintf(out, ", q = { %.17g, %.17g, %.17g, %.17g }", q.w, q.x, q.y, q.z);
		if (b->mass > 0)
			fprintf(out, ", mass = %.17g", b->mass);
		else
			fprintf(out, b->driven ? ", kind = \"kinematic\"" : ", static = true");
	}
	if (!(b->path.frequency > 0))
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

static bool read_hull(scene_body *b, const ob_hull *h)
{
	b->points = h->corners;
	for (uint32_t i = 0; i < h->corners && h->corners <= SCENE_POINTS; i++)
		b->point[i] = h->corner[i];
	return h->corners <= SCENE_POINTS && scene_make_hull(b);
}

bool scene_read(const char *path, random_scene *s, ob_error *e)
{
	ob_scene *from = ob_scene_load(path, NULL, e);
	if (!from)
		return false;
	*s = (random_scene){ .run = ob_run_settings_default() };
	s->run.gravity = from->run.gravity;
	const ob_settings all = { .run = from->run, .given = (1ull << OB_RUN_SETTINGS) - 1 };
	ob_run_settings_overlay(&s->run, &all);
	bool fits = from->objects <= SCENE_BODIES || ob_fail(e, "%s: %u bodies are too many", path, from->objects);
	for (uint32_t i = 0; fits && i < from->objects; i++) {
		const ob_object_def *o = &from->object[i];
		scene_body *b = &s->body[s->bodies++];
		*b = (scene_body){ .shape = o->passport.shape,
				   .size = o->passport.size,
				   .mass = o->passport.mass,
				   .friction = o->passport.friction,
				   .restitution = o->passport.restitution,
				   .state = o->state,
				   .driven = o->passport.flags & OB_OBJECT_KINEMATIC,
				   .running = o->passport.surface_velocity,
				   .pushed = o->force != NULL };
		b->path = o->path ? *o->path : b->path;
		b->push = o->force ? *o->force : b->push;
		fits = (!b->path.points && !b->push.points) || ob_fail(e, "%s: a path or force of points", path);
		if (b->shape == OB_SHAPE_HULL && fits)
			fits = read_hull(b, &from->hull[o->passport.hull]) ||
			       ob_fail(e, "%s: a hull of too many corners", path);
	}
	ob_scene_free(from);
	return fits;
}
