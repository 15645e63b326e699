// Time: bodies between steps, cameras that travel, pan and tilt.
#include <string.h>

#include "canvas.h"
#include "render/draw_list.h"

static const float red[3] = { .7f, .05f, .04f };

static void box_at(ob_snapshot *s, double t, double x, double v)
{
	test_scene_start(s, 1);
	ob_motion *m = test_scene_add(s, OB_SHAPE_BOX, ob_v3(.5, .5, .5), ob_v3(x, 0, 1), ob_quat_identity(), red);
	m->t0 = t;
	m->v = ob_v3(v, 0, 0);
	s->time = t;
}

static double column(canvas *c, const ob_snapshot *prev, const ob_snapshot *now, double t)
{
	double x, y;
	ob_camera_def camera = test_scene_camera(ob_v3(0, -9, 1), ob_v3(0, 0, 1));
	canvas_draw(c, prev, now, t, &camera);
	CHECK(canvas_find_red(c, &x, &y) > 100);
	return x;
}

// Frames between steps: a step of 1/4 s, drawn in between.
static void between_steps(void)
{
	canvas c = canvas_open(false, false);
	ob_snapshot before, after;
	box_at(&before, 1, -2, 0);
	box_at(&after, 1.25, 2, 0);
	double start = column(&c, &before, &after, 1), quarter = column(&c, &before, &after, 1.0625);
	double end = column(&c, &before, &after, 1.25);
	CHECK(end > start + 100);
	CHECK_NEAR((quarter - start) / (end - start), .25, .03);
	CHECK_NEAR(column(&c, NULL, &after, 1.1), end, .01); // without the earlier one: at the start of the newer
	before.passport[1].generation = 7; // another object had the slot
	CHECK_NEAR(column(&c, &before, &after, 1.1), end, .01);
	test_scene_finish(&before);
	test_scene_finish(&after);
	// A motion that has begun follows its closed form.
	box_at(&after, 1, -2, 4);
	CHECK_NEAR(column(&c, NULL, &after, 2), end, 1);
	test_scene_finish(&after);
	canvas_close(&c);
}

static void seen_from(canvas *c, const ob_snapshot *s, ob_camera_def camera, double t, double *x, double *y)
{
	canvas_draw(c, NULL, s, t, &camera);
	CHECK(canvas_find_red(c, x, y) > 20);
}

static void cameras_move(void)
{
	canvas c = canvas_open(false, false);
	ob_snapshot s;
	double x, y, moved_x, moved_y;
	box_at(&s, 0, 0, 0);
	ob_camera_def still = test_scene_camera(ob_v3(0, -9, 1), ob_v3(0, 0, 1)), moving = still;
	seen_from(&c, &s, still, 5, &x, &y);
	moving.velocity = ob_v3(1, 0, 0);
	seen_from(&c, &s, moving, 1, &moved_x, &moved_y);
	CHECK(moved_x < x - 10); // to the right, so the box goes left
	CHECK_NEAR(moved_y, y, 2);
	moving = still;
	moving.pan = .1; // about the vertical, anticlockwise from above: to the left, so the box goes right
	seen_from(&c, &s, moving, 1, &moved_x, &moved_y);
	CHECK(moved_x > x + 10);
	moving = still;
	moving.tilt = .1; // up, so the box goes down
	seen_from(&c, &s, moving, 1, &moved_x, &moved_y);
	CHECK(moved_y > y + 10);
	CHECK_NEAR(moved_x, x, 2);
	test_scene_finish(&s);
	canvas_close(&c);
}

// Far from the origin floats hold centimetres only; the picture must not change.
static void far_from_the_origin(void)
{
	canvas c = canvas_open(false, false);
	uint8_t *near_origin = malloc(4 * CANVAS_WIDTH * CANVAS_HEIGHT);
	for (int round = 0; round < 2; round++) {
		ob_snapshot s;
		ob_vec3 shift = ob_v3(round ? 1e6 : 0, 0, 0); // whole cells of the grid
		ob_camera_def camera = test_scene_camera(ob_add(shift, ob_v3(2, -5, 3)), ob_add(shift, ob_v3(0, 0, 1)));
		box_at(&s, 0, shift.x, 0);
		canvas_draw(&c, NULL, &s, 0, &camera);
		if (!round)
			memcpy(near_origin, c.rgba, 4 * CANVAS_WIDTH * CANVAS_HEIGHT);
		test_scene_finish(&s);
	}
	int different = 0;
	for (int i = 0; i < 4 * CANVAS_WIDTH * CANVAS_HEIGHT; i++)
		different += abs(near_origin[i] - c.rgba[i]) > 24;
	CHECK(different < 4 * CANVAS_WIDTH * CANVAS_HEIGHT / 200); // shadow texels may round otherwise
	free(near_origin);
	canvas_close(&c);
}

// Extent of the bodies upwards (or along another axis) in the picture: least and most, -1 and 1 at its edges.
static void find_extent(const ob_draw_list *list, const ob_view *v, ob_vec3 axis, double tangent, double *least,
			double *most)
{
	*least = INFINITY, *most = -INFINITY;
	for (uint32_t i = 0; i < list->count; i++) {
		ob_vec3 d = ob_sub(list->body[i].pose.p, v->eye);
		double at = ob_dot(d, axis) / (ob_dot(d, v->forward) * tangent);
		*least = fmin(*least, at), *most = fmax(*most, at);
	}
}

// Flat scenes leave as much room above as below, though the near edge looks larger than the far one; tall ones the same
// at their sides.
static void automatic_cameras_centre(void)
{
	for (int tall = 0; tall < 2; tall++) {
		ob_draw_list list = { 0 };
		ob_snapshot s;
		test_scene_start(&s, 100);
		for (int i = 0; i < 100; i++) {
			double a = i % 10 - 4.5, b = i / 10;
			test_scene_add(&s, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0),
				       tall ? ob_v3(.3 * a, .8 * a, 2 * b) : ob_v3(a, b, .2), ob_quat_identity(), red);
		}
		ob_camera_def camera = test_scene_camera(ob_v3(0, -9, 2.5), ob_v3(0, 4.5, 0));
		camera.automatic = true;
		CHECK(ob_draw_list_fill(&list, NULL, &s, 0));
		camera = ob_camera_follow(&camera, &list, 320, 180);
		ob_view v = ob_view_of_camera(&camera, 0, 320, 180);
		double low, high, left, right;
		find_extent(&list, &v, v.up, v.tan_y, &low, &high);
		find_extent(&list, &v, v.right, v.tan_x, &left, &right);
		CHECK_NEAR(high + low, 0, .2); // a tenth of the picture, as the far edge counts like the near one
		CHECK_NEAR(right + left, 0, .05);
		CHECK(low > -1 && high < 1 && left > -1 && right < 1);
		CHECK(tall ? high - low > 1.3 && right - left < 1 : high - low < 1.2 && right - left > 1.3);
		ob_draw_list_finish(&list);
		test_scene_finish(&s);
	}
}

// An automatic camera sees the whole of what moves: a square and a cube of bodies, seen cornerwise.
static void automatic_cameras_see_all(void)
{
	for (int layers = 1; layers <= 8; layers += 7) {
		ob_draw_list list = { 0 };
		ob_snapshot s;
		test_scene_start(&s, 64 * (uint32_t)layers);
		for (int i = 0; i < 64 * layers; i++)
			test_scene_add(&s, OB_SHAPE_SPHERE, ob_v3(.3, 0, 0), ob_v3(i % 8, i / 8 % 8, 1. + i / 64),
				       ob_quat_identity(), red);
		ob_camera_def camera = test_scene_camera(ob_v3(-10, -10, 9), ob_v3(3.5, 3.5, 1));
		camera.automatic = true;
		CHECK(ob_draw_list_fill(&list, NULL, &s, 0));
		camera = ob_camera_follow(&camera, &list, 320, 180);
		const ob_view v = ob_view_of_camera(&camera, 0, 320, 180);
		for (uint32_t i = 0; i < list.count; i++)
			CHECK(ob_view_in_frustum(&v, list.body[i].pose.p, -.3));
		ob_draw_list_finish(&list);
		test_scene_finish(&s);
	}
}

// An automatic camera keeps the one body that moves beside six that rest, and no eye is below the ground.
static void automatic_cameras_attend(void)
{
	ob_draw_list list = { 0 };
	ob_snapshot s;
	test_scene_start(&s, 7);
	for (int i = 0; i < 6; i++)
		test_scene_add(&s, OB_SHAPE_BOX, ob_v3(.3, .3, .3), ob_v3(-4 + .7 * i, 0, .3), ob_quat_identity(), red)
			->flags = OB_MOTION_ASLEEP;
	ob_motion *ball =
		test_scene_add(&s, OB_SHAPE_SPHERE, ob_v3(.3, 0, 0), ob_v3(0, 0, .3), ob_quat_identity(), red);
	ball->v = ob_v3(2, 0, 0);
	ob_camera_def camera = test_scene_camera(ob_v3(0, -9, 3), ob_v3(0, 0, .3)), to = camera;
	camera.automatic = true;
	for (double t = 0; t <= 7; t += .125) {
		CHECK(ob_draw_list_fill(&list, NULL, &s, t));
		to = ob_camera_follow(&camera, &list, 320, 180);
		ob_view v = ob_view_of_camera(&to, 0, 320, 180);
		CHECK(ob_view_in_frustum(&v, ob_motion_at(ball, ob_v3(1, 1, 1), t).pose.p, -.3));
	}
	ob_draw_list late = { 0 };
	CHECK(ob_draw_list_fill(&late, NULL, &s, 7)); // the same without what came before
	CHECK_NEAR(ob_norm(ob_sub(ob_camera_follow(&camera, &late, 320, 180).eye, to.eye)), 0, 1e-4);
	camera = test_scene_camera(ob_v3(0, -9, .05), ob_v3(0, 0, 2)); // looks up
	camera.automatic = true;
	CHECK(ob_camera_follow(&camera, &list, 320, 180).eye.z > .1);
	ob_draw_list_finish(&late);
	ob_draw_list_finish(&list);
	test_scene_finish(&s);
}

static double range_of(const ob_camera_def *c)
{
	return ob_norm(ob_sub(c->target, c->eye));
}

// Adds bodies that rest in a row, and one that moves along x at this speed; returns its motion.
static ob_motion *row_and_ball(ob_snapshot *s, int resting, double speed)
{
	test_scene_start(s, (uint32_t)resting + 2);
	for (int i = 0; i < resting; i++)
		test_scene_add(s, OB_SHAPE_BOX, ob_v3(.3, .3, .3), ob_v3(-4 + 4. * i / resting, 0, .3),
			       ob_quat_identity(), red)
			->flags = OB_MOTION_ASLEEP;
	ob_motion *ball = test_scene_add(s, OB_SHAPE_SPHERE, ob_v3(.3, 0, 0), ob_v3(0, 0, .3), ob_quat_identity(), red);
	ball->v = ob_v3(speed, 0, 0);
	return ball;
}

// An automatic camera goes with the only body that moves, however many rest, and nearer than the way it has gone; without
// a jump. It turns back to those that rest when the body has stopped, or has left for good.
static void automatic_cameras_go_on(void)
{
	for (int resting = 0; resting <= 50; resting += 25) {
		ob_draw_list list = { 0 };
		ob_snapshot s;
		ob_motion *ball = row_and_ball(&s, resting, 2);
		ob_camera_def camera = test_scene_camera(ob_v3(0, -9, 3), ob_v3(0, 0, .3)), to = camera;
		const double range = range_of(&camera);
		ob_vec3 before = { NAN, 0, 0 };
		camera.automatic = true;
		for (double t = 0; t <= 40; t += .125) { // up to eight camera ranges away
			CHECK(ob_draw_list_fill(&list, NULL, &s, t));
			to = ob_camera_follow(&camera, &list, 320, 180);
			const ob_view v = ob_view_of_camera(&to, 0, 320, 180);
			CHECK(ob_view_in_frustum(&v, ob_motion_at(ball, ob_v3(1, 1, 1), t).pose.p, -.3));
			CHECK(!(ob_norm(ob_sub(to.eye, before)) > .3 * range)); // in an eighth of a second
			before = to.eye;
		}
		CHECK(range_of(&to) < 2 * range);
		ball->p = ob_v3(1e6, 0, 0);
		CHECK(ob_draw_list_fill(&list, NULL, &s, 40.1));
		to = ob_camera_follow(&camera, &list, 320, 180);
		CHECK(ob_norm(ob_sub(to.target, camera.target)) < range);
		ob_draw_list_finish(&list);
		test_scene_finish(&s);
	}
}

// One that leaves others that move is left behind.
static void automatic_cameras_stay(void)
{
	ob_draw_list list = { 0 };
	ob_snapshot s;
	ob_motion *ball = row_and_ball(&s, 0, 2);
	ob_camera_def camera = test_scene_camera(ob_v3(0, -9, 3), ob_v3(0, 0, .3)), to = camera;
	test_scene_add(&s, OB_SHAPE_SPHERE, ob_v3(.3, 0, 0), ob_v3(1, 0, .3), ob_quat_identity(), red)->w =
		ob_v3(0, 0, 1);
	camera.automatic = true;
	for (double t = 0; t <= 40; t += .125) {
		CHECK(ob_draw_list_fill(&list, NULL, &s, t));
		to = ob_camera_follow(&camera, &list, 320, 180);
		const ob_view v = ob_view_of_camera(&to, 0, 320, 180);
		CHECK(ob_view_in_frustum(&v, ob_v3(1, 0, .3), -.3));
	}
	CHECK(ball->v.x > 0 && range_of(&to) < 2 * range_of(&camera));
	ob_draw_list_finish(&list);
	test_scene_finish(&s);
}

// Cameras that follow an object keep their offset from it; cameras on it turn with it, too.
static void cameras_go_along(void)
{
	ob_draw_list list = { 0 };
	ob_snapshot s;
	test_scene_start(&s, 1);
	ob_quat left = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, M_PI / 2));
	test_scene_add(&s, OB_SHAPE_SPHERE, ob_v3(.3, 0, 0), ob_v3(5, 6, 7), left, red);
	strcpy(s.passport[1].name, "ball");
	CHECK(ob_draw_list_fill(&list, NULL, &s, 0));
	ob_camera_def camera = test_scene_camera(ob_v3(-3, 0, 1), ob_v3(0, 0, 0));
	strcpy(camera.follow, "ball");
	ob_camera_def to = ob_camera_follow(&camera, &list, 320, 180);
	CHECK_NEAR(ob_norm(ob_sub(to.eye, ob_v3(2, 6, 8))), 0, 1e-12);
	CHECK_NEAR(ob_norm(ob_sub(to.target, ob_v3(5, 6, 7))), 0, 1e-12);
	camera.aboard = true;
	to = ob_camera_follow(&camera, &list, 320, 180);
	CHECK_NEAR(ob_norm(ob_sub(to.eye, ob_v3(5, 3, 8))), 0, 1e-12);
	strcpy(camera.follow, "none");
	CHECK(ob_norm(ob_sub(ob_camera_follow(&camera, &list, 320, 180).eye, camera.eye)) == 0);
	ob_draw_list_finish(&list);
	test_scene_finish(&s);
}

int main(void)
{
	between_steps();
	cameras_move();
	automatic_cameras_centre();
	automatic_cameras_see_all();
	automatic_cameras_attend();
	automatic_cameras_go_on();
	automatic_cameras_stay();
	cameras_go_along();
	far_from_the_origin();
	return check_end();
}
