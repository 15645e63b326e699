// Cameras: angles become radians, and a camera without an eye sees every object, from near by.
#include "check.h"
#include "project.h"
#include "text.h"

static void check_fields(void)
{
	ob_scene *s = load_good("ground {} camera 'a' { eye = { 1, 2, 3 }, target = { 4, 5, 6 }, fov = 90, pan = 180,\n"
				"tilt = -90, velocity = { 7, 8, 9 } }\ncamera 'b' {}");
	CHECK(s && s->cameras == 2);
	if (!s)
		return;
	const ob_camera_def *c = &s->camera[0];
	CHECK(strcmp(c->name, "a") == 0 && strcmp(s->camera[1].name, "b") == 0);
	CHECK(c->eye.y == 2 && c->target.z == 6 && c->velocity.x == 7);
	CHECK_NEAR(c->fov, M_PI / 2, 1e-15);
	CHECK_NEAR(c->pan, M_PI, 1e-15);
	CHECK_NEAR(c->tilt, -M_PI / 2, 1e-15);
	ob_scene_free(s);
}

static void check_frames(const char *text)
{
	ob_scene *s = load_good(text);
	CHECK(s);
	if (!s)
		return;
	double r = reach(s, &s->camera[0]);
	CHECK(r < 1 && r > .5);
	if (!(r < 1 && r > .5))
		fprintf(stderr, "  reach %g: %s\n", r, text);
	ob_scene_free(s);
}

int main(void)
{
	check_fields();
	check_frames("sphere { radius = 1 }");
	check_frames("sphere { radius = 1, at = { 1000, -2000, 500 } }");
	check_frames("sphere { radius = .001 }");
	check_frames("for i = 0, 40 do sphere { radius = .5, at = { i, 0, 0 } } end");
	check_frames("for i = 0, 40 do sphere { radius = .5, at = { 0, i, 0 } } end");
	check_frames("for i = 0, 40 do sphere { radius = .5, at = { 0, 0, i } } end");
	check_frames("camera 'm' { from = { 1, 0, 0 }, fov = 100 } for i = 0, 40 do sphere { radius = .5, at = { i, 0, "
		     "i } } end");
	check_frames("camera 'm' { from = { 1, 1, -2 }, fov = 5 } for i = 0, 40 do sphere { radius = .5, at = { i, 9, "
		     "i } } end");
	return check_end();
}
