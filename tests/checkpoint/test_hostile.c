// Invented checkpoints, with valid checksums: each is rejected, or is a run that begins, steps or fails with a line of
// text. None crashes its reader, and none hangs it. A million in some minutes:
//
//   test_checkpoint_hostile [COUNT [SEED]]
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "check.h"
#include "checkpoint/saved_run.h"
#include "scene/scene.h"

enum { MUTANTS = 20000, EACH_RUNS = 40, STEPS = 8 }; // one run for so many valid ones

// Something of each kind: all shapes, contacts, scripts with state, mail, contacts and created objects, driven bodies,
// objects added and removed.
static const char text[] =
	"local n = param('n', 6)\n"
	"scene { step = .01, substeps = 2, iterations = 4, room = 4 }\n"
	"script('hop', [[\n"
	"function on_start() self.state.n = 1 self.state.text = 'some' send(self, 'one', 2) self:wake(.05) end\n"
	"function on_step(dt) self.state.n = self.state.n + dt self:torque(0, 0, .01) end\n"
	"function on_message(from, ...) self.state.from = from send(self, ...) end\n"
	"function on_contact(other, impulse, point) self.state.other = other end\n"
	"function on_wake() self:push(0, 0, .1) sphere { radius = .05, at = { 3, random(), 1 }, script = 'fade' }\n"
	"hull { points = { { 0, 0, 0 }, { .2, 0, 0 }, { 0, .2, 0 }, { 0, 0, .3 } }, at = { 4, 0, 1 } } end]])\n"
	"script('fade', [[function on_wake() self:remove() end function on_stop() self:colour('#ff0000') end]])\n"
	"ground {}\n"
	"plane { normal = { 1, 0, .2 }, at = { -2, 0, 0 }, surface_velocity = { 0, 1, 0 } }\n"
	"for i = 1, n do sphere { radius = .1, at = { .15 * (i % 3), .15 * (i // 3), .12 + .03 * i }, born = i > 4 and "
	".01 * i or 0 } end\n"
	"for i = 1, 2 do sphere { radius = .1, at = { .6 * i, 1, .1 }, script = 'hop', state = { a = i } } end\n"
	"box { size = { .4, .4, .2 }, at = { 1, 0, .1 } }\n"
	"capsule { radius = .1, length = .3, at = { 1, 0, .4 }, rotation = { axis = { 0, 1, 0 }, degrees = 90 } }\n"
	"cylinder { radius = .1, length = .3, at = { 1.2, .1, .7 }, force = { 1, 0, 0 }, dies = .2 }\n"
	"hull { points = { { 0, 0, 0 }, { .3, 0, 0 }, { 0, .3, 0 }, { 0, 0, .3 }, { .2, .2, .3 } }, at = { 0, 1, .01 } "
	"}\n"
	"hull { points = { { 0, 0, 0 }, { .3, 0, 0 }, { 0, .3, 0 }, { 0, 0, .3 } }, at = { .1, 1, .4 }, velocity = { "
	"0, 0, -1 } }\n"
	"box { size = { 1, 1, .1 }, at = { 0, -2, .3 }, kind = 'kinematic', path = { kind = 'sine', amplitude = { 0, "
	"0, .1 }, frequency = 2 } }\n"
	"sphere { radius = .2, at = { 0, -2, .6 }, varying_force = { kind = 'sine', force = { 1, 0, 0 }, frequency = 1 "
	"} }\n"
	"box { size = { .5, .5, .5 }, at = { 5, 5, 5 }, static = true }\n";

static uint64_t state = 1;

static uint32_t draw(uint64_t below)
{
	return (uint32_t)(ob_splitmix(&state) % below);
}

static ob_host *start(const ob_scene *s, const ob_run_settings *run, const ob_saved_host *from, ob_error *e)
{
	const ob_host_config c = { .isolation = OB_ISOLATION_THREAD, .workers = 1, .run = *run, .from = from };
	return ob_host_start(s, &c, e);
}

// A run of some steps, as a file.
static void make(ob_checkpoint_file *f)
{
	static const char *const defines[] = { "n=8" };
	ob_error e = { "" };
	ob_saved_run r = { .scene = "all.lua",
			   .text = text,
			   .text_size = sizeof text - 1,
			   .options = { .defines = defines, .define_count = 1 },
			   .duration = 1 };
	ob_scene *s = ob_scene_load_text(r.scene, text, sizeof text - 1, &r.options, &e);
	CHECK(s && ob_run_settings_resolve(&s->run, NULL, &e));
	r.settings = s->run;
	ob_host *h = start(s, &r.settings, NULL, &e);
	CHECK(h);
	ob_request drag = { .kind = OB_REQUEST_DRAG, .id = 3, .generation = 1, .target = { 0, 0, 3 }, .frequency = 3 };
	CHECK(ob_host_ask(h, &drag, &e));
	ob_host_go(h, 17);
	CHECK(ob_host_wait(h, &e));
	CHECK(ob_saved_run_make(&r, f, h, "test", &e));
	ob_checkpoint_seal(f);
	ob_host_stop(h);
	ob_scene_free(s);
	if (e.text[0])
		fprintf(stderr, "%s\n", e.text);
}

// Changes a digit of a text, so that the text stays valid.
static void spoil_text(char *at, uint64_t bytes)
{
	for (uint64_t i = draw(bytes), n = 0; n < bytes; n++, i = (i + 1) % bytes)
		if (isdigit((unsigned char)at[i])) {
			at[i] = (char)('0' + draw(10));
			return;
		}
}

// Changes one number of one area to a harmful one.
static void spoil(ob_checkpoint_file *f)
{
	static const double numbers[] = { 0, -1, 1e300, -1e300, 1e-300, INFINITY, -INFINITY, NAN, .5, 3 };
	static const uint64_t words[] = { 0, 1, 2, 21, 22, 255, 0x7fffffff, 0xffffffff, 1ull << 32, ~0ull };
	uint32_t area = draw(f->areas);
	const uint64_t bytes = (uint64_t)((area + 1 < f->areas ? (char *)f->area[area + 1].at : f->bytes + f->size) -
					  (char *)f->area[area].at);
	char *at = f->area[area].at;
	switch (bytes < 8 || !f->area[area].count ? 5 : draw(5)) {
	case 0:
		memcpy(at + 8 * draw(bytes / 8), &numbers[draw(10)], 8);
		break;
	case 1:
		memcpy(at + 4 * draw(bytes / 4), &words[draw(10)], 4);
		break;
	case 2:
		memcpy(at + 4 * draw(bytes / 4), &(float){ (float)numbers[draw(10)] }, 4);
		break;
	case 3:
		at[draw(bytes)] ^= (char)(1 << draw(8));
		break;
	case 4:
		spoil_text(at, f->area[area].count);
		break;
	default: // the start of the file: lengths, counts
		memcpy(f->bytes + 4 * draw((uint64_t)((char *)f->area[0].at - f->bytes) / 4), &words[draw(10)], 4);
	}
}

// Begins the run of the file, with its own scene and settings, and lets it step. It may fail, but must end.
static bool step(const ob_saved_run *r)
{
	ob_error e = { "" };
	ob_scene *s = ob_scene_load_text(r->scene, r->text, r->text_size, &r->options, &e);
	ob_host *h = s ? start(s, &r->settings, &r->host, &e) : NULL;
	bool went = false;
	if (h) {
		ob_host_go(h, r->host.universe.step + STEPS);
		went = ob_host_wait(h, &e);
	}
	CHECK(went || e.text[0]);
	ob_host_stop(h);
	ob_scene_free(s);
	return went;
}

// The next event of the timetable would add an object that exists, or has been removed.
static void test_timetable(ob_saved_run *r)
{
	const uint64_t events = r->host.population.events;
	CHECK(events > 1);
	for (uint64_t i = 0; i < events; i++) {
		r->host.population.events = i;
		CHECK(!step(r));
	}
	r->host.population.events = events;
}

// Bodies that no scene could have: too small, too heavy, with another inertia than their shape's.
static void test_bodies(ob_saved_run *r)
{
	static const double numbers[] = { 1e-320, 1e-160, 1e-20, 1e20, 1e160 };
	uint32_t id = 0;
	while (id < r->host.universe.ids && !(r->host.universe.passport[id].mass > 0))
		id++;
	CHECK(id < r->host.universe.ids);
	ob_passport *p = &r->host.universe.passport[id];
	const ob_passport kept = *p;
	for (int i = 0; i < 5; i++) {
		p->size = ob_scale(kept.size, numbers[i]);
		CHECK(!step(r));
		*p = kept;
		p->mass *= numbers[i];
		CHECK(!step(r));
		p->inertia = ob_scale(kept.inertia, numbers[i]);
		CHECK(!step(r));
		p->mass = kept.mass;
		CHECK(!step(r));
		*p = kept;
	}
	CHECK(step(r));
}

int main(int argc, char **argv)
{
	const long mutants = argc > 1 ? atol(argv[1]) : MUTANTS;
	ob_checkpoint_file good = { 0 }, bad = { 0 };
	ob_saved_run r;
	long parsed = 0, started = 0, went = 0;
	state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	make(&good);
	char *kept = malloc(good.size);
	memcpy(kept, good.bytes, good.size);
	CHECK(ob_saved_run_parse(&r, &bad, kept, good.size, "good", NULL) && step(&r));
	test_timetable(&r);
	test_bodies(&r);
	ob_saved_run_close(&r, &bad);
	for (long i = 0; i < mutants; i++) {
		ob_error e = { "" };
		memcpy(good.bytes, kept, good.size);
		for (uint32_t n = 1 + draw(3); n > 0; n--)
			spoil(&good);
		if (memcmp(good.bytes, kept, (size_t)((char *)good.area[0].at - good.bytes)) ==
		    0) // otherwise the damage is there
			ob_checkpoint_seal(&good);
		bool fine = ob_saved_run_parse(&r, &bad, good.bytes, good.size, "bad", &e);
		CHECK(fine || strncmp(e.text, "bad: ", 5) == 0);
		if (fine && parsed++ % EACH_RUNS == 0) {
			started++;
			went += step(&r);
		}
		ob_saved_run_close(&r, &bad);
	}
	printf("%ld made up of %zu bytes, %ld made sense, of %ld runs %ld went on\n", mutants, good.size, parsed,
	       started, went);
	CHECK(parsed > 0 && parsed < mutants && went > 0);
	ob_checkpoint_finish(&good);
	free(kept);
	return check_end();
}
