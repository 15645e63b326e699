// Hostile requests, as any program of the same user may send to a running universe (host/ask.h). Each is rejected with a
// message, or carried out; the run goes on, or ends with a line that gives the reason, and never crashes. Some thousand
// in a minute:
//
//   requests [COUNT [SEED]]
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "check.h"
#include "host/ask.h"

enum { TOGETHER = 8, A_RUN = 200, SPARE = 100 }; // requests between two steps, and of a run

static const char text[] =
	"scene { step = .01, substeps = 2, iterations = 4 }\n"
	"script('hears', 'function on_message(from, ...) self.state.heard = ... send(self, ...) end')\n"
	"ground {}\n"
	"for i = 1, 6 do sphere { radius = .1, at = { .5 * i, 0, .1 }, script = 'hears' } end\n";

static uint64_t state = 1;

static uint32_t draw(uint64_t below)
{
	return (uint32_t)(ob_splitmix(&state) % below);
}

// One that makes sense.
static ob_request good(void)
{
	static const uint8_t shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER,
					  OB_SHAPE_HULL };
	ob_request r = { .kind = draw(4), .id = 1 + draw(6), .generation = 1, .colour = { 1, .5, 0, 1 } };
	ob_object_def *d = &r.def;
	*d = (ob_object_def){ .dies = INFINITY };
	d->passport = (ob_passport){ .shape = shapes[draw(5)],
				     .size = { .2, .2, .2 },
				     .mass = 1,
				     .friction = .5,
				     .colour = { 1, 1, 1, 1 },
				     .name = "new#" };
	d->state.pose = (ob_pose){ .p = { draw(5), draw(5), .5 }, .q = ob_quat_identity() };
	r.corners.count = 4;
	for (int i = 1; i < 4; i++)
		r.corners.at[i] = ob_v3(i == 1, i == 2, i == 3);
	r.bytes = 0;
	if (r.kind == OB_REQUEST_MESSAGE)
		CHECK(ob_scene_put_value("1.5", r.values, &r.bytes, sizeof r.values) &&
		      ob_scene_put_value("hello", r.values, &r.bytes, sizeof r.values));
	return r;
}

static void spoil(ob_request *r)
{
	static const double numbers[] = { 0, -1, 1e-300, 1e300, -1e300, INFINITY, -INFINITY, NAN, .5, 3 };
	static const uint32_t words[] = { 0, 1, 2, 5, 64, 255, 4096, 0x7fffffff, 0x80000000, 0xffffffff };
	static const struct {
		size_t from, bytes;
	} parts[] = { { 0, offsetof(ob_request, def) },
		      { offsetof(ob_request, def), sizeof r->def },
		      { offsetof(ob_request, def.state), sizeof r->def.state },
		      { offsetof(ob_request, corners), 128 },
		      { offsetof(ob_request, colour), sizeof r->colour + sizeof r->bytes + 64 } };
	const uint32_t part = draw(sizeof parts / sizeof *parts);
	char *at = (char *)r + parts[part].from;
	const size_t bytes = parts[part].bytes;
	switch (draw(3)) {
	case 0:
		memcpy(at + 8 * draw(bytes / 8), &numbers[draw(10)], 8);
		break;
	case 1:
		memcpy(at + 4 * draw(bytes / 4), &words[draw(10)], 4);
		break;
	default:
		at[draw(bytes)] ^= (char)(1 << draw(8));
	}
}

static ob_request good_object(void)
{
	ob_request r;
	do
		r = good();
	while (r.kind != OB_REQUEST_ADD);
	return r;
}

// What no scene could hold never comes into the run, where it would end it.
static void test_no_numbers(const ob_universe *u)
{
	const double bad[] = { NAN, INFINITY, -INFINITY };
	for (int i = 0; i < 3; i++) {
		ob_request force = good_object(), place = good_object(), colour = good_object();
		ob_error e = { "" };
		force.def.passport.force.y = bad[i];
		place.def.state.pose.p.x = bad[i];
		colour.def.passport.colour[2] = (float)bad[i];
		CHECK(!ob_ask(u, &force, &e) && strstr(e.text, "force"));
		CHECK(!ob_ask(u, &place, &e) && strstr(e.text, "at: expected"));
		CHECK(!ob_ask(u, &colour, &e) && strstr(e.text, "colour"));
	}
}

// Sizes and masses that leave no inertia that could be inverted, or one beyond all numbers.
static void test_sizes(const ob_universe *u)
{
	const double bad[] = { 5e-324, 1e-160, 1e-40, 1e-7, 1e7, 1e160, 1e300 };
	for (int i = 0; i < 7; i++) {
		ob_error e = { "" };
		for (uint32_t shape = OB_SHAPE_SPHERE; shape <= OB_SHAPE_HULL; shape++) {
			ob_request size = good_object(), mass = good_object();
			size.def.passport.shape = mass.def.passport.shape = shape;
			size.def.passport.size = ob_v3(bad[i], bad[i], bad[i]);
			for (uint32_t k = 0; k < size.corners.count; k++)
				size.corners.at[k] = ob_scale(size.corners.at[k], bad[i]);
			mass.def.passport.mass = bad[i] * bad[i] * bad[i];
			CHECK(!ob_ask(u, &size, &e));
			CHECK(!ob_ask(u, &mass, &e));
		}
	}
}

static ob_host *start(const ob_scene *s, const char *name)
{
	const ob_host_config c = {
		.name = name, .isolation = OB_ISOLATION_THREAD, .workers = 1, .spare = SPARE, .run = s->run
	};
	ob_error e = { "" };
	ob_host *h = ob_host_start(s, &c, &e);
	CHECK(h);
	if (!h)
		fprintf(stderr, "%s\n", e.text);
	return h;
}

// True if the run went on.
static bool step(ob_host *h)
{
	ob_universe_info info;
	ob_error e = { "" };
	ob_universe_get_info(ob_host_universe(h), &info);
	ob_host_go(h, info.step + 2);
	const bool went = ob_host_wait(h, &e);
	CHECK(went || (e.text[0] && !strstr(e.text, "diverged")));
	return went;
}

int main(int argc, char **argv)
{
	const long count = argc > 1 ? atol(argv[1]) : 1000;
	char name[OB_NAME_MAX];
	ob_error e = { "" };
	long taken = 0, ended = 0;
	state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	snprintf(name, sizeof name, "fuzz-requests-%d", (int)getpid());
	ob_scene *s = ob_scene_load_text("hears.lua", text, sizeof text - 1, NULL, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, NULL, &e));
	ob_host *h = start(s, name);
	bool goes = step(h);
	CHECK(goes);
	test_no_numbers(ob_host_universe(h));
	test_sizes(ob_host_universe(h));
	CHECK(step(h));
	for (long i = 0; i < count && h; i++) {
		ob_request r = good();
		for (uint32_t n = draw(4); n > 0; n--)
			spoil(&r);
		const bool fine = ob_ask(ob_host_universe(h), &r, &e);
		CHECK(fine || e.text[0]);
		taken += fine;
		if (i % TOGETHER == 0)
			goes = step(h);
		ended += !goes;
		if (goes && i % A_RUN != A_RUN - 1)
			continue;
		ob_host_stop(h);
		h = start(s, name);
		goes = h && step(h);
	}
	ob_host_stop(h);
	ob_scene_free(s);
	printf("%ld requests, %ld carried out, %ld runs ended\n", count, taken, ended);
	CHECK(taken > 0 && taken < count);
	return check_end();
}
