// Contents of the picture: sky above, the body in the middle, its shadow, overlays; the same bytes again.
#include <math.h>
#include <string.h>

#include "canvas.h"

static const float red[3] = { .7f, .05f, .04f };

static void one_box(ob_snapshot *s, ob_shape shape, double lift)
{
	test_scene_start(s, 1);
	test_scene_add(s, shape, ob_v3(1, 1, 1), ob_v3(0, 0, 1 + lift), ob_quat_identity(), red);
}

// From the south: the sun of test_scene_look is to the right of and in front of the box, so the shadow falls left,
// behind.
static ob_camera_def south(void)
{
	return test_scene_camera(ob_v3(0, -9, 3), ob_v3(0, 0, 1));
}

static void sky_body_and_shadow(void)
{
	canvas c = canvas_open(false, false);
	ob_snapshot s;
	ob_camera_def camera = south();
	camera.eye.z = 2.5; // the horizon is in the picture
	one_box(&s, OB_SHAPE_BOX, 0);
	canvas_draw(&c, NULL, &s, 0, &camera);
	CHECK(canvas_mean(&c, 160, 4, 3, 2) > canvas_mean(&c, 160, 4, 3, 0) + 15); // blue above
	CHECK(canvas_mean(&c, 160, 4, 3, 2) > canvas_mean(&c, 160, 170, 3, 2));
	CHECK(canvas_mean(&c, 160, 90, 8, 0) > canvas_mean(&c, 160, 90, 8, 1) + 60); // red in the middle
	double shadow = canvas_mean(&c, 120, 113, 2, 1), lit = canvas_mean(&c, 230, 113, 2, 1);
	CHECK(shadow < .75 * lit);
	CHECK(canvas_mean(&c, 60, 120, 2, 1) > shadow * 1.3); // and elsewhere none
	for (int i = 3; i < 4 * CANVAS_WIDTH * CANVAS_HEIGHT; i += 4)
		if (c.rgba[i] != 255) {
			CHECK(c.rgba[i] == 255);
			break;
		}
	test_scene_finish(&s);
	canvas_close(&c);
}

static void every_shape_is_drawn(void)
{
	static const ob_shape shapes[] = { OB_SHAPE_BOX, OB_SHAPE_SPHERE, OB_SHAPE_CYLINDER, OB_SHAPE_CAPSULE };
	canvas c = canvas_open(false, false);
	ob_camera_def camera = south();
	int area[4];
	for (int i = 0; i < 4; i++) {
		ob_snapshot s;
		double x, y;
		one_box(&s, shapes[i], 1);
		canvas_draw(&c, NULL, &s, 0, &camera);
		area[i] = canvas_find_red(&c, &x, &y);
		CHECK_NEAR(x, 160, 6);
		test_scene_finish(&s);
	}
	CHECK(area[1] < area[0] && area[0] < area[3]); // the sphere is inside the box, the capsule is longer
	CHECK(area[1] < area[2] && area[2] < area[0] + 200);
	CHECK(area[1] > 1000);
	canvas_close(&c);
}

static void no_acne(void)
{
	canvas c = canvas_open(false, false);
	ob_snapshot s;
	ob_camera_def camera = test_scene_camera(ob_v3(1, -5, 5), ob_v3(0, 0, 2));
	one_box(&s, OB_SHAPE_BOX, 0);
	canvas_draw(&c, NULL, &s, 0, &camera);
	// On the lit top, neighbouring pixels differ by no more than shading can cause.
	int worst = 0;
	for (int y = 84; y < 96; y++)
		for (int x = 130; x < 180; x++) {
			const uint8_t *p = c.rgba + 4 * (y * CANVAS_WIDTH + x);
			int step = abs(p[0] - p[4]);
			worst = step > worst ? step : worst;
		}
	CHECK(worst <= 6);
	test_scene_finish(&s);
	canvas_close(&c);
}

enum { BYTES = 4 * CANVAS_WIDTH * CANVAS_HEIGHT };

// Least ratio of two pictures' greens in a rectangle, relative to the greatest: 1 if they differ by a factor alone.
static double evenness(const canvas *c, const uint8_t *plain, int from_x, int from_y, int to_x, int to_y)
{
	double low = INFINITY, high = 0;
	for (int y = from_y; y < to_y; y++)
		for (int x = from_x; x < to_x; x++) {
			const int at = 4 * (y * CANVAS_WIDTH + x) + 1;
			low = fmin(low, (double)c->rgba[at] / plain[at]);
			high = fmax(high, (double)c->rgba[at] / plain[at]);
		}
	return low / high;
}

static void draw_patterned(canvas *c, ob_pattern ground, ob_pattern box, const ob_camera_def *camera)
{
	static const float grey[3] = { .5f, .5f, .5f };
	ob_snapshot s;
	test_scene_start(&s, 1);
	test_scene_add(&s, OB_SHAPE_BOX, ob_v3(1, 1, 1), ob_v3(0, 0, 1), ob_quat_identity(), grey);
	s.passport[0].flags |= (uint32_t)ground << OB_OBJECT_PATTERN;
	s.passport[1].flags |= (uint32_t)box << OB_OBJECT_PATTERN;
	canvas_draw(c, NULL, &s, 0, camera);
	test_scene_finish(&s);
}

// A pattern shows within a face and on the ground, and there alone; from afar it is as even as a plain one.
static void patterns_show(void)
{
	canvas c = canvas_open(false, false);
	const ob_camera_def camera = south(), far = test_scene_camera(ob_v3(0, -900, 700), ob_v3(0, 0, 0));
	uint8_t *plain = malloc(BYTES), *plain_far = malloc(BYTES), *first = malloc(BYTES);
	draw_patterned(&c, OB_PATTERN_PLAIN, OB_PATTERN_PLAIN, &camera);
	memcpy(plain, c.rgba, BYTES);
	draw_patterned(&c, OB_PATTERN_PLAIN, OB_PATTERN_PLAIN, &far);
	memcpy(plain_far, c.rgba, BYTES);
	for (ob_pattern p = OB_PATTERN_TILES; p < OB_PATTERNS; p++) {
		draw_patterned(&c, OB_PATTERN_PLAIN, p, &camera);
		CHECK(evenness(&c, plain, 140, 85, 180, 105) < (p == OB_PATTERN_SLABS ? .97 : .9)); // larger than it
		CHECK(memcmp(c.rgba, plain, BYTES / 4) == 0); // above the box
		draw_patterned(&c, p, OB_PATTERN_PLAIN, &camera);
		CHECK(evenness(&c, plain, 100, 150, 220, 175) < .9);
		memcpy(first, c.rgba, BYTES);
		draw_patterned(&c, p, OB_PATTERN_PLAIN, &camera);
		CHECK(memcmp(c.rgba, first, BYTES) == 0);
		draw_patterned(&c, p, OB_PATTERN_PLAIN, &far);
		CHECK(evenness(&c, plain_far, 20, 140, 300, 175) > .97);
	}
	free(plain);
	free(plain_far);
	free(first);
	canvas_close(&c);
}

static void overlays_show(void)
{
	canvas plain = canvas_open(false, false), boxes = canvas_open(true, false), points = canvas_open(false, true);
	ob_contact_point contact = { 0, 1, { 0, -1, .5 }, { 0, 0, 1 }, 1 };
	ob_camera_def camera = south();
	ob_snapshot s;
	one_box(&s, OB_SHAPE_SPHERE, 0);
	s.contact = &contact;
	s.contacts = 1;
	canvas_draw(&plain, NULL, &s, 0, &camera);
	canvas_draw(&boxes, NULL, &s, 0, &camera);
	canvas_draw(&points, NULL, &s, 0, &camera);
	int by_boxes = 0, by_points = 0;
	for (int i = 0; i < 4 * CANVAS_WIDTH * CANVAS_HEIGHT; i += 4) {
		by_boxes += abs(plain.rgba[i + 2] - boxes.rgba[i + 2]) > 20; // yellow on grey
		by_points += abs(plain.rgba[i + 1] - points.rgba[i + 1]) > 20;
	}
	CHECK(by_boxes > 150 && by_boxes < 1500);
	CHECK(by_points > 20 && by_points < 300);
	test_scene_finish(&s);
	canvas_close(&plain);
	canvas_close(&boxes);
	canvas_close(&points);
}

static void same_bytes(void)
{
	canvas a = canvas_open(true, false), b = canvas_open(true, false);
	ob_camera_def camera = test_scene_camera(ob_v3(-8, -9, 5), ob_v3(0, 0, .5));
	ob_snapshot s;
	test_scene_boxes(&s, 150, 10, 3);
	canvas_draw(&a, NULL, &s, 0, &camera);
	canvas_draw(&b, NULL, &s, 5, &camera); // another frame between: no state is carried over
	canvas_draw(&b, NULL, &s, 0, &camera);
	CHECK(memcmp(a.rgba, b.rgba, 4 * CANVAS_WIDTH * CANVAS_HEIGHT) == 0);
	test_scene_finish(&s);
	canvas_close(&a);
	canvas_close(&b);
}

static void errors_are_clear(void)
{
	ob_look_def look = test_scene_look();
	ob_error e = { "" };
	ob_render_setup none = { .width = 0, .height = 10, .samples = 1 };
	CHECK(!ob_renderer_create(&none, &look, &e) && strstr(e.text, "0x10"));
	ob_render_setup gpu = { .width = 8, .height = 8, .samples = 1, .device = "31" };
	CHECK(!ob_renderer_create(&gpu, &look, &e) && strstr(e.text, "tried") && strstr(e.text, "device"));
	gpu.device = "first";
	CHECK(!ob_renderer_create(&gpu, &look, &e) && strstr(e.text, "\"first\""));
	ob_render_setup vast = { .width = 1 << 20, .height = 8, .samples = 1 };
	CHECK(!ob_renderer_create(&vast, &look, &e) && strstr(e.text, "1048576x8"));
}

int main(void)
{
	sky_body_and_shadow();
	every_shape_is_drawn();
	no_acne();
	patterns_show();
	overlays_show();
	same_bytes();
	errors_are_clear();
	return check_end();
}
