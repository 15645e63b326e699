// A recording as a page plays it: every message whole, whole states now and then, and the page that holds it.
#include "check.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "record/record.h"
#include "serve/feed.h"
#include "serve/film.h"

enum { OBJECTS = 30, STATES = 400, BREAKS = 100 };
static const double step_length = .01;
static char path[64];

// Object 0 stands; the last is added in the middle; the rest circle, so that their motions are sent again and again. A joint of
// two of them breaks.
static void record(void)
{
	static ob_passport passport[OBJECTS];
	static ob_motion motion[OBJECTS];
	static ob_joint_passport joint = { .object = { 1, 2 },
					   .frame = { { .q = { 1, 0, 0, 0 } }, { .q = { 1, 0, 0, 0 } } },
					   .name = "eye" };
	static ob_camera_def camera = { .name = "a \"camera\"", .eye = { 1, 2, 3 }, .fov = .7 };
	static ob_scene scene = { .title = "</script><b>",
				  .text = (char *)"",
				  .record_every = 1,
				  .cameras = 1,
				  .camera = &camera,
				  .duration = 10 };
	static const ob_scene_options options;
	ob_run_settings settings = ob_run_settings_default();
	ob_error e = { "" };
	ob_record_facts facts = {
		.universe = { .name = "test", .arch = "obs", .isolation = "thread", .step_length = step_length },
		.scene = &scene,
		.path = "x",
		.options = &options,
		.settings = &settings,
		.duration = 10,
		.commit = "abc"
	};
	ob_recorder *r = ob_recorder_create(path, &facts, &e);
	CHECK(r);
	for (uint32_t k = 0; r && k < STATES; k++) {
		for (uint32_t id = 0; id < OBJECTS; id++) {
			double t = k * step_length;
			passport[id] = (ob_passport){ .id = id,
						      .flags = OB_OBJECT_PRESENT,
						      .shape = OB_SHAPE_BOX,
						      .size = { .1, .1, .1 },
						      .mass = 1,
						      .inertia = { 1, 1, 1 },
						      .name = "a \"box\"" };
			motion[id] = (ob_motion){ .t0 = id ? t : 0,
						  .valid_until = t + step_length,
						  .q = { 1, 0, 0, 0 },
						  .p = { id ? cos(9 * t) : 0, id ? sin(9 * t) : 0, id },
						  .v = { -9 * sin(9 * t), 9 * cos(9 * t), 0 } };
		}
		passport[0].flags |= OB_OBJECT_STATIC;
		if (k < STATES / 2)
			passport[OBJECTS - 1].flags = 0;
		ob_snapshot s = {
			.step = k,
			.time = k * step_length,
			.count = OBJECTS,
			.passport = passport,
			.motion = motion,
			.joints = 1,
			.joint = &joint,
		};
		joint.flags = k < BREAKS ? 0 : OB_JOINT_BROKEN;
		CHECK(ob_recorder_append(r, &s, &e));
	}
	CHECK(ob_recorder_close(r, &e));
}

static unsigned char *unpack(const ob_message *film, size_t *size)
{
	z_stream z = { .next_in = film->bytes, .avail_in = (unsigned)film->size };
	size_t room = 1 << 22;
	unsigned char *out = malloc(room);
	z.next_out = out;
	z.avail_out = (unsigned)room;
	CHECK(inflateInit2(&z, MAX_WBITS + 16) == Z_OK && inflate(&z, Z_FINISH) == Z_STREAM_END);
	*size = room - z.avail_out;
	inflateEnd(&z);
	return out;
}

static uint32_t u32_at(const unsigned char *at)
{
	uint32_t value;
	memcpy(&value, at, sizeof value);
	return value;
}

static bool has(const unsigned char *bytes, size_t size, const char *text)
{
	return memmem(bytes, size, text, strlen(text)) != NULL;
}

static void check_messages(const unsigned char *bytes, size_t size)
{
	double time = -1;
	uint32_t number = 0, told = 0, anew = 0, simulators = 0, joints = 0;
	size_t at = 0, whole = 0;
	for (; at + 4 <= size; number++) {
		uint32_t n = u32_at(bytes + at);
		const unsigned char *m = bytes + at + 4;
		CHECK(n <= size - at - 4);
		at += 4 + (size_t)n;
		if (number == 0)
			CHECK(has(m, n, "{\"welcome\":") && has(m, n, "\"name\":\"a \\u0022camera\\u0022\""));
		if (number == 1) {
			CHECK(has(m, n, "{\"film\":{\"begin\":0,\"end\":3.99") && has(m, n, "\"interval\":0.01"));
			CHECK(has(m, n, "\"events\":[[1,0,1,\"eye\"],[2,1,29,\"a \\u0022box\\u0022\"]]") &&
			      has(m, n, "[1,0,1,0,0]"));
		}
		if (number < 2)
			continue;
		double now;
		memcpy(&now, m + 8, sizeof now);
		if (m[0] == OB_FEED_SIMULATORS) {
			CHECK(now == time && u32_at(m + 4) == (now < 2 ? OBJECTS - 2 : OBJECTS - 1));
			simulators++;
			continue;
		}
		if (m[0] == OB_FEED_JOINTS) {
			CHECK(now == time && u32_at(m + 4) == (now < BREAKS * step_length));
			CHECK(n == (now < BREAKS * step_length ? 16 + 57 : 16));
			joints++;
			continue;
		}
		CHECK(m[0] == OB_FEED_MOTIONS && now >= time);
		if (m[1] & OB_FEED_VOID) {
			CHECK(now == time || number == 2);
			CHECK(u32_at(m + 20) == (now < 2 ? OBJECTS - 1 : OBJECTS));
			anew++;
			whole += n;
		} else {
			CHECK(now > time);
			told++;
		}
		time = now;
	}
	CHECK(at == size && told == STATES - 1);
	CHECK(joints >= anew && joints <= anew + 2);
	CHECK(simulators >= anew && simulators <= anew + 2); // with each whole state, and once they have changed
	CHECK(anew > 1 && whole < size / 3);
}

static void test_film(void)
{
	ob_error e = { "" };
	size_t size = 0;
	ob_recording *r = ob_recording_open(path, &e);
	ob_message *film = r ? ob_film_make(r, path, OB_FILM_SECONDS, &e) : NULL;
	CHECK(film);
	if (film) {
		unsigned char *bytes = unpack(film, &size);
		check_messages(bytes, size);
		free(bytes);
	}
	ob_message *page = film ? ob_film_page_whole(film) : NULL, *served = ob_film_page_served();
	CHECK(page && has(page->bytes, page->size, "\"body.frag\": ") &&
	      has(page->bytes, page->size, "module_main = "));
	CHECK(page && !has(page->bytes, page->size, "src=\"main.js\"") &&
	      !has(page->bytes, page->size, "href=\"style.css\""));
	CHECK(page && !has(page->bytes, page->size, "</script><b>"));
	CHECK(served && has(served->bytes, served->size, "content=\"recording\"") &&
	      has(served->bytes, served->size, "src=\"main.js\""));
	ob_message_release(page);
	ob_message_release(served);
	ob_message_release(film);
	ob_recording_close(r);
}

static void test_out_of_time(void)
{
	ob_error e = { "" };
	ob_recording *r = ob_recording_open(path, &e);
	CHECK(r && !ob_film_make(r, path, 1e-6, &e));
	CHECK(has((unsigned char *)e.text, strlen(e.text), "takes more than 1e-06 s of CPU"));
	ob_recording_close(r);
}

int main(void)
{
	snprintf(path, sizeof path, "/tmp/obsim-test-film-%d.h5", (int)getpid());
	record();
	test_film();
	test_out_of_time();
	unlink(path);
	return check_end();
}
