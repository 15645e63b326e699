// Values of a scene arrive in its definitions: units, masses, attitudes, colours, defaults.
#include <stdlib.h>

#include "check.h"
#include "text.h"

static void check_vec(ob_vec3 a, double x, double y, double z)
{
	CHECK_NEAR(a.x, x, 1e-15);
	CHECK_NEAR(a.y, y, 1e-15);
	CHECK_NEAR(a.z, z, 1e-15);
}

static void check_defaults(void)
{
	ob_scene *s = load_good("sphere { radius = 1 }");
	CHECK(s);
	if (!s)
		return;
	check_vec(s->run.gravity, 0, 0, -9.81);
	CHECK(s->run.step_length == 1. / 60 && s->duration == 10 && s->run.substeps == 8 && s->run.iterations == 16);
	CHECK(s->run.solver == OB_SOLVER_COLOURED && s->run.integrator == OB_INTEGRATOR_EXACT);
	CHECK(s->run.sleeping && s->seed == 1 && s->record_every == 1);
	CHECK(s->objects == 1 && s->cameras == 1 && strcmp(s->camera[0].name, "main") == 0);
	const ob_object_def *o = &s->object[0];
	CHECK(strcmp(o->passport.name, "sphere#0") == 0 && o->passport.id == 0);
	CHECK(o->passport.flags == OB_OBJECT_PRESENT);
	CHECK(o->passport.friction == .5 && o->passport.restitution == 0 && o->passport.colour[3] == 1);
	CHECK(o->born == 0 && o->dies == INFINITY);
	CHECK(o->state.pose.q.w == 1);
	ob_scene_free(s);
}

static void check_settings(void)
{
	ob_scene *s = load_good(
		"scene { title = 'T', tour = true, gravity = { 1, 2, 3 }, step = .01, duration = 5, substeps = 4,\n"
		"iterations = 3, solver = 'jacobi', integrator = 'ode', sleeping = false, seed = 12 }\n"
		"record { every = 7 } sun { towards = { 0, 0, 4 } } sky { top = '#ffffff' }\n"
		"ground { height = 2, grid = false, colour = { 1, 0, 0 } }");
	CHECK(s);
	if (!s)
		return;
	CHECK(strcmp(s->title, "T") == 0 && s->tour && s->run.step_length == .01 && s->duration == 5 &&
	      s->run.substeps == 4 && s->run.iterations == 3);
	check_vec(s->run.gravity, 1, 2, 3);
	CHECK(s->run.solver == OB_SOLVER_JACOBI && s->run.integrator == OB_INTEGRATOR_ODE);
	CHECK(!s->run.sleeping && s->seed == 12 && s->record_every == 7 && !s->look.grid);
	check_vec(s->look.sun, 0, 0, 1);
	CHECK(s->look.sky_top[0] == 1 && s->look.sky_top[2] == 1);
	CHECK(s->look.ground_colour[0] == 1 && s->look.ground_colour[1] == 0);
	const ob_object_def *g = &s->object[0];
	CHECK(strcmp(g->passport.name, "ground") == 0 && g->passport.shape == OB_SHAPE_PLANE);
	CHECK(g->passport.flags == (OB_OBJECT_PRESENT | OB_OBJECT_STATIC) && g->passport.mass == 0);
	check_vec(g->state.pose.p, 0, 0, 2);
	ob_scene_free(s);
}

static void check_joints(void)
{
	ob_scene *s = load_good("box { name = 'door', size = { 1, .1, 2 }, at = { .5, 0, 1 },\n"
				"rotation = { axis = { 0, 0, 1 }, degrees = 90 } }\n"
				"sphere { name = 'bob', radius = .1, at = { 3, 0, 1 } }\n"
				"hinge { 'door', 'bob', at = { 0, 2, 1 }, axis = vector(0, 0, 5), collide = true }\n"
				"universal { 'bob', at = { 3, 0, 1 }, axis = { 0, 1, 0 }, across = { 0, .1, 1 } }\n"
				"distance { 'bob', to = { 3, 4, 1 } } fixed { 'door' }");
	CHECK(s);
	if (!s)
		return;
	const ob_joint_passport *j = s->joint;
	CHECK(s->joints == 4 && j[0].kind == OB_JOINT_HINGE && j[0].flags == OB_JOINT_COLLIDES);
	CHECK(isinf(j[0].second.low) && isinf(j[0].second.high) && j[0].second.stiffness == 0);
	CHECK(j[0].object[0] == 0 && j[0].object[1] == 1 && j[0].generation[0] == 1 && j[0].generation[1] == 1);
	check_vec(j[0].frame[0].p, 2, .5, 0);
	check_vec(j[0].frame[1].p, -3, 2, 0);
	const ob_mat3 cross = ob_quat_matrix(j[1].frame[1].q);
	check_vec(ob_column(&cross, 0), 0, 1, 0);
	check_vec(ob_column(&cross, 1), 0, 0, 1);
	CHECK(j[1].object[1] == OB_JOINT_WORLD && j[1].flags == 0);
	CHECK(j[2].kind == OB_JOINT_DISTANCE && j[2].length == 4);
	check_vec(j[2].frame[1].p, 3, 4, 1);
	check_vec(j[3].frame[1].p, .5, 0, 1);
	ob_scene_free(s);
}

static void check_groups(void)
{
	ob_scene *s = load_good("sphere { radius = 1, group = 3, hits = { 0, 15 } }\nground { hits = {} }\n"
				"box { size = { 1, 1, 1 }, sensor = true, at = { 0, 0, 9 } }\n"
				"sphere { radius = 1, visible = false, at = { 9, 0, 9 } }");
	CHECK(s);
	if (!s)
		return;
	const ob_object_def *o = s->object;
	CHECK(ob_passport_group(&o[0].passport) == 3 && o[0].passport.flags >> OB_OBJECT_PASSES == 0x7ffe);
	CHECK(ob_passport_group(&o[1].passport) == 0 && o[1].passport.flags >> OB_OBJECT_PASSES == 0xffff);
	CHECK(o[2].passport.flags >> OB_OBJECT_PASSES == 0 && o[2].passport.flags & OB_OBJECT_SENSOR);
	CHECK(!(o[2].passport.flags & OB_OBJECT_HIDDEN) && o[3].passport.flags & OB_OBJECT_HIDDEN);
	CHECK(!ob_passport_hits(&o[0].passport, &o[1].passport) && ob_passport_hits(&o[0].passport, &o[2].passport));
	CHECK(!ob_passport_collides(&o[0].passport, &o[2].passport));
	ob_scene_free(s);
}

static void check_patterns(void)
{
	static const ob_pattern expected[] = { OB_PATTERN_BRICKS, OB_PATTERN_PLAIN, OB_PATTERN_TILES,
					       OB_PATTERN_PLAIN };
	ob_scene *s = load_good("material 'brick' { pattern = 'bricks' }\n"
				"box { size = { 1, 1, 1 }, material = 'brick' }\n"
				"box { size = { 1, 1, 1 }, material = 'brick', pattern = 'plain' }\n"
				"ground { pattern = 'tiles' }\n"
				"sphere { radius = 1, material = 'brick', at = { 0, 0, 9 } }");
	CHECK(s);
	for (uint32_t i = 0; s && i < s->objects; i++)
		CHECK(ob_passport_pattern(&s->object[i].passport) == expected[i]);
	CHECK(s && !s->look.grid);
	ob_scene_free(s);
}

// With moments of its own an object turns about the origin and the axes that it is given in; else about its shape's.
static void check_inertia(void)
{
	ob_scene *s = load_good("box { size = { 1, 2, 3 }, mass = 2, inertia = { 1, 2, 2.5 } }\n"
				"local corners = { { -1, -1, -1 }, { 2, -1, -1 }, { -1, 3, -1 }, { -1, -1, 4 } }\n"
				"hull { points = corners, mass = 2, inertia = { 3, 4, 5 }, at = { 5, 0, 0 } }\n"
				"hull { points = corners, at = { 9, 0, 0 } } apart { 'box#0', 'hull#1' }");
	CHECK(s);
	if (!s)
		return;
	const ob_hull *own = &s->hull[s->object[1].passport.hull], *usual = &s->hull[s->object[2].passport.hull];
	check_vec(s->object[0].passport.inertia, 1, 2, 2.5);
	check_vec(s->object[1].passport.inertia, 3, 4, 5);
	check_vec(s->object[1].state.pose.p, 5, 0, 0);
	CHECK(s->object[2].passport.inertia.x == 0 && fabs(s->object[2].state.pose.p.x - 8.75) < 1e-12);
	CHECK(own != usual && own->volume == usual->volume && own->frame.w == 1 && s->object[1].state.pose.q.w == 1);
	CHECK_NEAR(own->inner, 13 / sqrt(769), 1e-12);
	CHECK(s->joints == 1 && s->joint[0].kind == OB_JOINT_APART && !(s->joint[0].flags & OB_JOINT_COLLIDES));
	ob_scene_free(s);
}

// A compound: a hull, followed by those of its parts; equal ones are made once, and mass follows densities.
static void check_compounds(void)
{
	ob_scene *s =
		load_good("local two = { { size = { 2, 2, 2 }, at = { -1, 0, 0 }, density = 1 },\n"
			  "\t{ points = { { 0, -1, -1 }, { 2, -1, -1 }, { 0, 1, -1 }, { 2, 1, -1 }, { 0, -1, 1 },\n"
			  "\t\t{ 2, -1, 1 }, { 0, 1, 1 }, { 2, 1, 1 } }, density = 3 } }\n"
			  "compound { parts = two, at = { 5, 0, 0 } }\n"
			  "compound { parts = two, at = { 15, 0, 0 }, mass = 2, name = 'twin' }\n"
			  "compound { parts = { { size = { 1, 1, 1 }, at = { 0, 0, .2 } } }, at = { 0, 0, 3 },\n"
			  "\tmass = 2, inertia = { 1, 2, 2.5 } }");
	CHECK(s);
	if (!s)
		return;
	const ob_object_def *o = s->object;
	const ob_hull *h = &s->hull[o[0].passport.hull];
	CHECK(s->objects == 3 && s->hulls == 5 && o[0].passport.hull == o[1].passport.hull);
	CHECK(h->parts == 2 && h[1].is_part && h[2].is_part && !h->is_part && h[3].parts == 1);
	CHECK(strcmp(o[0].passport.name, "compound#0") == 0 && o[0].passport.shape == OB_SHAPE_HULL);
	CHECK_NEAR(h->volume, 16, 1e-12);
	CHECK_NEAR(o[0].passport.mass, 8 * 1 + 8 * 3, 1e-12);
	CHECK(o[1].passport.mass == 2);
	CHECK_NEAR(o[0].state.pose.p.x, 5.5, 1e-12);
	CHECK_NEAR(h[1].centre.x, -1.5, 1e-12);
	CHECK_NEAR(h[2].centre.x, .5, 1e-12);
	CHECK_NEAR(h->inertia.x, 2. / 3, 1e-12);
	CHECK_NEAR(h->inertia.y, 2. / 3 + .25 * 2.25 + .75 * .25, 1e-12);
	check_vec(o[2].passport.inertia, 1, 2, 2.5);
	check_vec(o[2].state.pose.p, 0, 0, 3);
	ob_scene_free(s);
}

// Round parts: masses and moments of the exact shapes, by the parallel axes.
static void check_round_parts(void)
{
	ob_scene *s = load_good(
		"compound { at = { 1, 2, 3 }, density = 7, parts = {\n"
		"\t{ shape = 'cylinder', radius = .5, length = 2, rotation = { axis = { 0, 1, 0 }, degrees = 90 } },\n"
		"\t{ radius = 1, at = { 3, 0, 0 } }, { size = { 1, 1, 1 }, at = { 0, 2, 0 } } } }");
	CHECK(s);
	if (!s)
		return;
	const ob_hull *h = &s->hull[s->object[0].passport.hull];
	const double drum = M_PI * .25 * 2, ball = 4. / 3 * M_PI, all = drum + ball + 1;
	const ob_vec3 p = s->object[0].state.pose.p;
	CHECK(h->parts == 3 && h->round == 2 && h[1].round == OB_SHAPE_CYLINDER && h[2].round == OB_SHAPE_SPHERE &&
	      !h[3].round);
	CHECK_NEAR(s->object[0].passport.mass, 7 * all, 1e-9);
	check_vec(h[1].size, .5, 1, 0);
	CHECK_NEAR(p.x, 1 + 3 * ball / all, 1e-12);
	CHECK_NEAR(p.y, 2 + 2 / all, 1e-12);
	CHECK_NEAR(p.z, 3, 1e-12);
	const double x = 3 * ball / all, y = 2 / all;
	const double zz = drum * (.25 / 4 + 4. / 12 + x * x + y * y) + ball * (.4 + (3 - x) * (3 - x) + y * y) +
			  1. / 6 + x * x + (2 - y) * (2 - y);
	const ob_vec3 i = h->inertia;
	CHECK_NEAR(fmax(i.x, fmax(i.y, i.z)), zz / all, 1e-12); // flat in z: the largest
	CHECK_NEAR(h->radius, hypot(hypot(x + .5, 2.5 - y), .5), 1e-12); // a corner of the box
	CHECK_NEAR(h[1].radius, hypot(x + 1, y + .5), 1e-12); // the far rim
	ob_scene_free(s);
}

// A heightfield: its terrain, and a mesh that shows it.
static void check_heightfields(void)
{
	ob_scene *s = load_good("heightfield { size = { 4, 2 }, cells = { 4, 1 }, at = { 1, 2, 3 }, friction = .7,\n"
				"\theight = function(x, y) return x > .5 and x - y or 0 end }\n"
				"heightfield { name = 'flat', size = { 1, 1 }, cells = { 3, 3 },\n"
				"\theight = function() return -2 end, static = true }");
	CHECK(s);
	if (!s)
		return;
	const ob_passport *p = &s->object[0].passport, *q = &s->object[1].passport;
	const ob_terrain *t = ob_terrain_at(s->terrains, p->hull), *flat = ob_terrain_at(s->terrains, q->hull);
	CHECK(s->objects == 2 && s->terrains->count == 2 && s->meshes == 2 && p->mesh == 1 && q->mesh == 2);
	CHECK(p->shape == OB_SHAPE_TERRAIN && p->flags & OB_OBJECT_STATIC && p->mass == 0 && p->friction == .7);
	CHECK(strcmp(p->name, "heightfield#0") == 0 && strcmp(q->name, "flat") == 0);
	CHECK(t && t->vertices == 10 && t->triangles == 8 && t->solid && flat && flat->regions == 1);
	check_vec(s->object[0].state.pose.p, 1, 2, 3);
	if (t) {
		check_vec(ob_terrain_vertices(t)[0], -2, -1, 0);
		check_vec(ob_terrain_vertices(t)[9], 2, 1, 1);
		CHECK(s->mesh[0].vertices == 10 && s->mesh[0].indices == 24 && s->mesh[0].vertex[9].position[2] == 1);
	}
	ob_scene_free(s);
}

static void check_free(void)
{
	ob_scene *s = load_good("scene { sync = 'free', update_rate = 500, max_lag = .01 }\nground {}");
	CHECK(s && s->asked.sync && s->asked.free.update_rate == 500 && s->asked.free.max_lag == .01 &&
	      !ob_setting_is_set(&s->asked, OB_SETTING_COUPLING));
	ob_scene_free(s);
	s = load_good("material 'slow' { update_rate = 30 }\nbox { size = {1, 1, 1}, material = 'slow' }\n"
		      "sphere { radius = 1, at = {3, 0, 0}, material = 'slow', update_rate = 2000 }\n"
		      "sphere { radius = 1, at = {6, 0, 0} }\nbox { size = {1, 1, 1}, at = {9, 0, 0}, static = true, "
		      "material = 'slow' }");
	CHECK(s && s->object[0].update_rate == 30 && s->object[1].update_rate == 2000);
	CHECK(s && s->object[2].update_rate == 0 && s->object[3].update_rate == 0);
	ob_scene_free(s);
	s = load_good("scene { sync = 'free' }\nground {}");
	CHECK(s && s->asked.sync && !ob_setting_is_set(&s->asked, OB_SETTING_UPDATE_RATE) &&
	      !ob_setting_is_set(&s->asked, OB_SETTING_MAX_LAG));
	ob_scene_free(s);
	s = load_good("scene { sync = 'lockstep' }\nground {}");
	CHECK(s && !s->asked.sync && ob_setting_is_set(&s->asked, OB_SETTING_SYNC));
	ob_scene_free(s);
}

static void check_exactness(void)
{
	ob_scene *s = load_good("scene { tolerance = .0005, solver = 'lagged', lag = 0 }\nground {}");
	CHECK(s && s->run.tolerance == .0005 && s->run.substeps == 8 && s->run.iterations == 64 && s->run.lag == 0 &&
	      s->run.solver == OB_SOLVER_LAGGED);
	ob_scene_free(s);
	s = load_good("scene { tolerance = .0005, iterations = 9 }\nground {}");
	CHECK(s && s->run.iterations == 9 && s->run.lag == 1);
	ob_scene_free(s);
	s = load_good("ground {}");
	CHECK(s && s->run.tolerance == 1e-3 && s->run.substeps == 8 && s->run.iterations == 16);
	ob_scene_free(s);
	s = load_good("scene { substeps = 8 }\nground {}");
	CHECK(s && s->run.tolerance == 0 && s->run.substeps == 8 && s->run.iterations == 16);
	ob_scene_free(s);
}

// A share of the thinnest object that moves, wherever it stands in the file
static void check_share(void)
{
	ob_scene *s =
		load_good("scene { tolerance = '.5%', iterations = 9 }\nground {}\n"
			  "box { size = { 1, 2, .3 }, at = { 0, 0, 1 } }\nsphere { radius = .1, at = { 3, 0, 1 } }\n"
			  "box { size = { .01, 1, 1 }, static = true, at = { 5, 0, 1 } }");
	CHECK(s && s->run.substeps == 8 && s->run.iterations == 9);
	CHECK_NEAR(s->run.tolerance, .001, 1e-12);
	ob_scene_free(s);
	s = load_good("scene { tolerance = '100%' }\nsphere { radius = .05, at = { 0, 0, 1 } }");
	CHECK(s && s->run.substeps == 1);
	CHECK_NEAR(s->run.tolerance, .1, 1e-12);
	ob_scene_free(s);
	s = load_good("scene { tolerance = '.5mm' }\nground {}");
	CHECK(s && s->run.tolerance == .5e-3);
	ob_scene_free(s);
	s = load_good("scene { tolerance = '.002' }\nground {}");
	CHECK(s && s->run.tolerance == .002);
	ob_scene_free(s);
	s = load_good("scene { tolerance = '.1%' }\nground {}");
	CHECK(s && s->run.tolerance == 1e-3);
	ob_scene_free(s);
}

// Words of earlier versions
static void check_former_names(void)
{
	ob_scene *s = load_good("scene { passes = 7, exchange = 'jacobi' }\nground {}");
	CHECK(s && s->run.iterations == 7 && s->run.solver == OB_SOLVER_JACOBI);
	ob_scene_free(s);
}

static void check_shapes(void)
{
	ob_scene *s = load_good("box { size = { 1, 2, 3 }, density = 10 }\n"
				"sphere { radius = 2, density = 10 }\n"
				"capsule { radius = 2, length = 3, density = 10 }\n"
				"cylinder { radius = 2, length = 3, density = 10 }\n"
				"box { size = { 1, 1, 1 }, mass = 7 }\n"
				"box { size = { 1, 1, 1 } }\n"
				"box { size = { 1, 1, 1 }, static = true }");
	CHECK(s && s->objects == 7);
	if (!s)
		return;
	check_vec(s->object[0].passport.size, .5, 1, 1.5);
	check_vec(s->object[1].passport.size, 2, 0, 0);
	check_vec(s->object[2].passport.size, 2, 1.5, 0);
	check_vec(s->object[3].passport.size, 2, 1.5, 0);
	const double mass[7] = { 60, 320 * M_PI / 3, 120 * M_PI + 320 * M_PI / 3, 120 * M_PI, 7, 1000, 0 };
	const ob_shape shape[7] = { OB_SHAPE_BOX, OB_SHAPE_SPHERE, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER,
				    OB_SHAPE_BOX, OB_SHAPE_BOX,    OB_SHAPE_BOX };
	for (int i = 0; i < 7; i++) {
		CHECK_NEAR(s->object[i].passport.mass, mass[i], 1e-12 * mass[i]);
		CHECK(s->object[i].passport.shape == shape[i] && s->object[i].passport.id == (uint32_t)i);
	}
	CHECK(s->object[6].passport.flags & OB_OBJECT_STATIC);
	ob_scene_free(s);
}

// Direction of the body's axis (1, 0, 0) or (0, 0, 1) in the world.
static ob_vec3 axis(const ob_object_def *o, int i)
{
	ob_mat3 r = ob_quat_matrix(o->state.pose.q);
	return ob_column(&r, i);
}

static void check_vec_near(ob_vec3 a, double x, double y, double z)
{
	CHECK(ob_norm(ob_sub(a, ob_v3(x, y, z))) < 1e-14);
}

static void check_states(void)
{
	ob_scene *s = load_good(
		"local function b(f) f.size = { 1, 1, 1 } box(f) end\n"
		"b { rotation = { axis = vector(0, 0, 2), degrees = 90 }, at = { 1, 2, 3 }, velocity = { 4, 5, 6 },\n"
		"    spin = { 7, 8, 9 }, force = { 10, 11, 12 }, born = 1, dies = 2 }\n"
		"b { q = { 3, 0, 0, 3 } }\n"
		"plane { normal = vector(0, 3, 4) }\n"
		"plane { normal = { 0, 0, -1 } }\n"
		"b { q = { 1e-300, 0, 0, 1e-300 } }");
	CHECK(s && s->objects == 5);
	if (!s)
		return;
	const ob_object_def *o = s->object;
	check_vec_near(axis(&o[0], 0), 0, 1, 0);
	check_vec(o[0].state.pose.p, 1, 2, 3);
	check_vec(o[0].state.v, 4, 5, 6);
	check_vec(o[0].state.w, 7, 8, 9);
	check_vec(o[0].passport.force, 10, 11, 12);
	CHECK(o[0].born == 1 && o[0].dies == 2);
	check_vec_near(axis(&o[1], 0), 0, 1, 0);
	check_vec_near(axis(&o[2], 2), 0, .6, .8);
	check_vec_near(axis(&o[3], 2), 0, 0, -1);
	check_vec_near(axis(&o[4], 0), 0, 1, 0);
	ob_scene_free(s);
}

static void check_materials(void)
{
	ob_scene *s = load_good(
		"material 'wood' { friction = .25, density = 600, colour = '#ff8000' }\n"
		"box { size = { 1, 1, 1 }, material = 'wood' }\n"
		"box { size = { 1, 1, 1 }, material = 'wood', density = 1, friction = .75, restitution = .5,\n"
		"      colour = { 0, 0, 1, 1 } }\n"
		"box { size = { 1, 1, 1 }, material = 'wood', mass = 3 }");
	CHECK(s && s->objects == 3);
	if (!s)
		return;
	const ob_passport *a = &s->object[0].passport, *b = &s->object[1].passport;
	CHECK(a->friction == .25 && a->restitution == 0 && a->mass == 600);
	CHECK(a->colour[0] == 1 && a->colour[2] == 0 && a->colour[3] == 1);
	CHECK_NEAR(a->colour[1], .215861, 1e-6); // 128/255 in sRGB, linear (IEC 61966-2-1)
	CHECK(b->friction == .75 && b->restitution == .5 && b->mass == 1);
	CHECK(b->colour[2] == 1 && b->colour[3] == 1);
	CHECK(s->object[2].passport.mass == 3);
	ob_scene_free(s);
}

int main(void)
{
	check_defaults();
	check_settings();
	check_joints();
	check_groups();
	check_patterns();
	check_inertia();
	check_compounds();
	check_round_parts();
	check_heightfields();
	check_free();
	check_exactness();
	check_share();
	check_former_names();
	check_shapes();
	check_states();
	check_materials();
	return check_end();
}
