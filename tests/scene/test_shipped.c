// The scenes that obsim ships: they load, hold what their header says, start without contact where they should, fit
// the picture of their first camera, and are the same each time for the same seed. argv[2]: their folder.
#include <dirent.h>
#include <stdlib.h>

#include "check.h"
#include "project.h"
#include "text.h"

static const char *folder;

static ob_scene *load(const char *name, const char *define, uint64_t seed)
{
	char path[1024];
	ob_error e = { "" };
	const ob_scene_options o = {
		.defines = &define, .define_count = define ? 1 : 0, .has_seed = seed > 0, .seed = seed
	};
	snprintf(path, sizeof path, "%s/%s.lua", folder, name);
	ob_scene *s = ob_scene_load(path, &o, &e);
	CHECK(s);
	if (!s)
		fprintf(stderr, "  %s\n", e.text);
	return s;
}

static bool same(const ob_scene *a, const ob_scene *b)
{
	bool equal = a->objects == b->objects && a->seed == b->seed;
	for (uint32_t i = 0; i < a->objects && equal; i++)
		equal = memcmp(&a->object[i].passport, &b->object[i].passport, sizeof(ob_passport)) == 0 &&
			memcmp(&a->object[i].state, &b->object[i].state, sizeof(ob_state)) == 0;
	return equal;
}

// Distance between bounding spheres, smallest over all pairs, and of the lowest point above z = 0.
static double clearance(const ob_scene *s)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < s->objects; i++) {
		const ob_object_def *a = &s->object[i];
		double r = ob_shape_radius((ob_shape)a->passport.shape, a->passport.size);
		if (a->passport.flags & OB_OBJECT_STATIC)
			continue;
		least = fmin(least, a->state.pose.p.z - r);
		for (uint32_t j = i + 1; j < s->objects; j++) {
			const ob_object_def *b = &s->object[j];
			double d = ob_norm(ob_sub(a->state.pose.p, b->state.pose.p));
			least = fmin(least, d - r - ob_shape_radius((ob_shape)b->passport.shape, b->passport.size));
		}
	}
	return least;
}

// Degrees above the horizontal from which a scene's first camera looks: from lower, objects hide each other.
static void check_angle(const char *name, const ob_scene *s)
{
	const ob_vec3 d = ob_sub(s->camera[0].eye, s->camera[0].target);
	const double angle = atan2(d.z, hypot(d.x, d.y)) * 180 / M_PI;
	CHECK(angle >= 25 && angle <= 35);
	if (!(angle >= 25 && angle <= 35))
		fprintf(stderr, "  %s: camera %s looks down by %g degrees\n", name, s->camera[0].name, angle);
}

static void check_count(const char *name, const char *define, uint32_t objects, bool apart)
{
	ob_scene *s = load(name, define, 0);
	if (!s)
		return;
	CHECK(s->objects == objects);
	check_angle(name, s);
	double r = reach(s, &s->camera[0]);
	CHECK(r < 1);
	if (!(r < 1))
		fprintf(stderr, "  %s: camera %s: reach %g\n", name, s->camera[0].name, r);
	if (apart)
		CHECK(clearance(s) > 0);
	ob_scene_free(s);
}

static void check_objects(const char *name, uint32_t objects)
{
	ob_scene *s = load(name, NULL, 0);
	CHECK(s && s->objects == objects);
	if (s)
		check_angle(name, s);
	ob_scene_free(s);
}

static void check_seeds(const char *name, bool random)
{
	ob_scene *a = load(name, NULL, 5), *b = load(name, NULL, 5), *c = load(name, NULL, 6);
	if (a && b && c) {
		CHECK(a->seed == 5 && c->seed == 6);
		CHECK(same(a, b));
		c->seed = a->seed;
		CHECK(same(a, c) == !random);
	}
	ob_scene_free(a);
	ob_scene_free(b);
	ob_scene_free(c);
}

static void check_hard_cases(void)
{
	ob_scene *s = load("stack", NULL, 0);
	for (uint32_t i = 1; s && i < s->objects; i++) {
		const ob_object_def *o = &s->object[i];
		CHECK(o->passport.mass == 1000 && o->passport.size.x == .5 && o->passport.friction == .5);
		CHECK(fabs(o->state.pose.p.x) <= .01 && o->state.pose.p.z == i - .5);
	}
	CHECK(s && !s->run.sleeping && s->duration == 20);
	ob_scene_free(s);
	s = load("cradle", "incoming=2", 0);
	for (uint32_t i = 0; s && i < 5; i++) {
		CHECK(s->object[i].passport.restitution == 1 && s->object[i].passport.size.x == .5);
		CHECK(s->object[i].state.v.x == (i < 2) && s->object[i].state.pose.p.x == i + (i < 2 ? 0 : .7));
	}
	CHECK(s && s->run.gravity.z == 0);
	ob_scene_free(s);
	s = load("head_on", "ratio=1000", 0);
	CHECK(s && s->object[1].passport.mass == 1000 * s->object[0].passport.mass);
	ob_scene_free(s);
	s = load("thin_wall", "speed=250", 0);
	CHECK(s && s->object[0].passport.size.x == .01);
	if (s)
		CHECK_NEAR(ob_norm(s->object[1].state.v), 250, 1e-12 * 250);
	ob_scene_free(s);
}

// Every file of the folder is one of those checked here.
static int files(void)
{
	int n = 0;
	DIR *d = opendir(folder);
	for (struct dirent *entry; d && (entry = readdir(d));)
		n += strstr(entry->d_name, ".lua") != NULL;
	if (d)
		closedir(d);
	return n;
}

int main(int argc, char **argv)
{
	folder = argc > 2 ? argv[2] : "scenes";
	CHECK(files() == 27);
	check_count("falling_boxes", NULL, 101, true);
	check_count("falling_boxes", "n=1", 2, true);
	check_count("falling_boxes", "n=1000", 1001, true);
	check_count("tour", NULL, 61, false);
	check_count("gas", NULL, 206, false);
	check_count("gas", "n=1000", 1006, false);
	check_count("stack", NULL, 11, false);
	check_count("arch", NULL, 21, false);
	check_count("arch", "n=40", 41, false);
	check_count("pyramid", NULL, 56, false);
	check_count("pyramid", "rows=15", 121, false);
	check_count("pile", NULL, 217, false);
	check_count("cradle", NULL, 5, false);
	check_count("head_on", "shape=box", 2, false);
	check_count("thin_wall", NULL, 2, false);
	check_count("sparse", NULL, 201, true);
	check_count("shapes", NULL, 52, false);
	check_count("dominoes", NULL, 402, false);
	check_count("dominoes", "n=50", 52, false);
	check_objects("tower", 227); // shots come from beyond the picture
	check_count("warehouse", NULL, 77, false);
	check_objects("plaza", 138);
	check_count("avalanche", "n=500", 756, false);
	check_seeds("dominoes", false);
	check_seeds("plaza", true);
	check_seeds("avalanche", true);
	check_count("wrecking_ball", NULL, 47, false);
	check_count("bridge", NULL, 29, false);
	check_objects("crane", 14);
	check_objects("hills", 30);
	check_objects("strings", 23); // the bounding spheres of strings and rails reach far beyond them
	check_count("fall", NULL, 29, false);
	check_objects("flock", 67); // birds come from behind the viewpoint, too
#ifdef MESHES
	check_count("bowling", NULL, 23, false);
	check_seeds("bowling", false);
#endif
	check_seeds("flock", true);
	check_count("machines", NULL, 42, false);
	check_seeds("machines", true);
	check_count("solids", NULL, 16, false);
	check_seeds("falling_boxes", true);
	check_seeds("stack", true);
	check_seeds("pile", true);
	check_seeds("sparse", true);
	check_seeds("thin_wall", true);
	check_seeds("cradle", false);
	check_hard_cases();
	return check_end();
}
