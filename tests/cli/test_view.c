// The screen of top: it fits, it scrolls, and nothing that stands in a universe can reach the terminal as a command.
#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cli/top.h"

enum { OBJECTS = 50, WORKERS = 30 };

static ob_top_worker workers[WORKERS];
static ob_top_object objects[OBJECTS];

static ob_top_sample make_sample(void)
{
	ob_top_sample s = {
		.info = { .name = "test",
			  .isolation = "process",
			  .arch = "obs",
			  .capacity = 64,
			  .objects = OBJECTS,
			  .workers = WORKERS,
			  .step = 12,
			  .time = .2,
			  .state = OB_UNIVERSE_RUNNING,
			  .host_pid = 4242 },
		.alive = true,
		.at = 1,
		.steps_per_second = 59.96,
		.pace = .999,
		.workers = WORKERS,
		.worker = workers,
		.objects = OBJECTS,
		.object = objects,
	};
	for (uint32_t i = 0; i < WORKERS; i++)
		workers[i] = (ob_top_worker){ .share = .01 * i, .info = { .pid = 100 + (int)i, .cpu = -1 } };
	for (uint32_t i = 0; i < OBJECTS; i++) {
		objects[i] = (ob_top_object){ .id = i, .moving = true, .speed = (i * 7) % OBJECTS };
		objects[i].passport.shape = OB_SHAPE_BOX;
		snprintf(objects[i].passport.name, OB_NAME_MAX, "box %u", i);
	}
	return s;
}

// Not inlined: gcc 12 would mistake the returned text for the variable that holds it.
__attribute__((noinline)) static char *show(ob_top_view *view, ob_top_sample *s)
{
	char *text = NULL;
	size_t length;
	FILE *f = open_memstream(&text, &length);
	ob_top_view_write(view, s, f);
	fclose(f);
	return text;
}

static void check_fits(const char *text, int columns, int lines)
{
	int count = 0;
	for (const char *line = text; *line; count++) {
		size_t n = strcspn(line, "\n");
		CHECK(columns == 0 || (int)n <= columns);
		line += n + (line[n] == '\n');
	}
	CHECK(lines == 0 || count <= lines);
}

static void test_sizes(void)
{
	ob_top_sample s = make_sample();
	for (int columns = 1; columns < 150; columns += 13) {
		for (int lines = 1; lines < 100; lines += lines < 20 ? 1 : 7) {
			ob_top_view view = {
				.columns = columns, .lines = lines, .workers = lines % 2, .scroll = 10000
			};
			char *text = show(&view, &s);
			check_fits(text, columns, lines);
			free(text);
			CHECK(view.scroll <= (view.workers ? WORKERS : OBJECTS));
		}
	}
}

static void test_all(void)
{
	ob_top_sample s = make_sample();
	ob_top_view view = { 0 };
	char *text = show(&view, &s);
	CHECK(strstr(text, "test") && strstr(text, "running") && strstr(text, "60.0 steps/s"));
	CHECK(strstr(text, "box 0 ") && strstr(text, "box 49 "));
	CHECK(strstr(text, "\n    29 ")); // the last worker
	CHECK(strstr(text, "box 0 ") < strstr(text, "box 1 "));
	free(text);
	view.by_speed = true;
	text = show(&view, &s);
	CHECK(strstr(text, "box 0 ") > strstr(text, "box 7 ")); // 0 is the slowest, 7 the second fastest
	CHECK(strstr(text, "box 43 ") > strstr(text, "box 7 "));
	free(text);
}

static void test_sensors(void)
{
	ob_top_sensor sensors[3] = {
		{ .passport = { .kind = OB_SENSOR_IMU, .object = 4, .width = 6, .name = "imu#0" },
		  .number = 7,
		  .time = .25,
		  .value = { 1.5, 0, -2, 0, 0, .125 } },
		{ .passport = { .kind = OB_SENSOR_LIDAR, .width = 360, .name = "a\033[2J" },
		  .number = 1,
		  .value = { 2.25 } },
		{ .passport = { .kind = OB_SENSOR_CAMERA, .beams = 64, .rows = 36, .name = "eye" } },
	};
	ob_top_sample s = make_sample();
	ob_top_view view = { 0 };
	s.sensor = sensors, s.sensors = 3;
	char *text = show(&view, &s);
	CHECK(strstr(text, "imu#0") && strstr(text, "0.2500") && strstr(text, "0.125"));
	CHECK(strstr(text, "nearest 2.25 of 360") && strstr(text, "64 x 36") && !strchr(text, '\033'));
	free(text);
	view = (ob_top_view){ .columns = 80, .lines = 6, .sensors = true };
	text = show(&view, &s);
	CHECK(strstr(text, "SENSOR") && !strstr(text, "box 0 "));
	free(text);
}

static void test_harmless(void)
{
	ob_top_sample s = make_sample();
	ob_top_view view = { .columns = 100, .lines = 60 };
	memset(objects[3].passport.name, 0x1b, OB_NAME_MAX); // no final 0, either
	strcpy(objects[4].passport.name, "a\033[2Jb\nc\td\x7f");
	strcpy(objects[5].passport.name, "\xc2\x9b"
					 "31m\xff\xfe");
	strcpy(objects[7].passport.name, "up\xe2\x80\xaenwod"); // turns the direction of what follows
	strcpy(s.info.name, "\033]0;title\a");
	objects[6].passport.shape = 77;
	s.info.state = (ob_universe_state)99;
	char *text = show(&view, &s);
	for (const unsigned char *c = (const unsigned char *)text; *c; c++)
		CHECK((*c >= 0x20 && *c != 0x7f && *c != 0xff) || *c == '\n');
	CHECK(!strstr(text, "\xc2\x9b") && !strstr(text, "\xe2\x80\xae"));
	CHECK(strstr(text, "a?[2Jb?c?d?"));
	free(text);
}

int main(void)
{
	setlocale(LC_CTYPE, "C.UTF-8");
	test_sizes();
	test_all();
	test_sensors();
	test_harmless();
	return check_end();
}
