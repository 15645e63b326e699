// Checkpoints that somebody has made up, with checksums that are right: each is refused, or is a run that begins, steps
// or fails with a line of text. None crashes its reader, and none hangs it.
#include <string.h>
#include <unistd.h>

#include "base/random.h"
#include "check.h"
#include "checkpoint/saved_run.h"
#include "little_scene.h"

enum { BALLS = 20, MUTANTS = 20000, RUNS = 60, STEPS = 8 };

static uint64_t state = 1;

static uint32_t draw(uint64_t below)
{
	return (uint32_t)(ob_splitmix(&state) % below);
}

static ob_scene scene(void)
{
	ob_scene s = little_scene(BALLS);
	for (int i = 1; i <= BALLS; i++) {
		s.object[i].state.pose.p = ob_v3(.15 * (i % 3), .15 * (i / 3 % 3), .12 + .2 * (i / 9));
		s.object[i].born = i > 15 ? .01 * i : 0;
	}
	return s;
}

// A run of some steps, as a file.
static void make(const ob_scene *s, ob_checkpoint_file *f)
{
	ob_host_config c = little_config(s, OB_ISOLATION_THREAD, 1);
	ob_error e = { "" };
	ob_host *h = ob_host_start(s, &c, &e);
	CHECK(h);
	ob_host_go(h, 17);
	CHECK(ob_host_wait(h, &e));
	ob_saved_run r = { .scene = "little.lua", .text = "-- none", .text_size = 7, .duration = 1, .settings = c.run };
	CHECK(ob_saved_run_make(&r, f, h, "test", &e));
	ob_checkpoint_seal(f);
	ob_host_stop(h);
}

// One number of one area becomes one that could hurt.
static void spoil(ob_checkpoint_file *f)
{
	static const double numbers[] = { 0, -1, 1e300, -1e300, 1e-300, INFINITY, -INFINITY, NAN, .5, 3 };
	static const uint64_t words[] = { 0, 1, 2, 21, 22, 255, 0x7fffffff, 0xffffffff, 1ull << 32, ~0ull };
	uint32_t area = draw(f->areas);
	const uint64_t bytes = (uint64_t)((area + 1 < f->areas ? (char *)f->area[area + 1].at : f->bytes + f->size) -
					  (char *)f->area[area].at);
	char *at = f->area[area].at;
	switch (bytes < 8 || !f->area[area].count ? 4 : draw(4)) {
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
	default: // the start of the file: lengths, counts
		memcpy(f->bytes + 4 * draw((uint64_t)((char *)f->area[0].at - f->bytes) / 4), &words[draw(10)], 4);
	}
}

// Begins the run that the file tells of, with its own settings, and lets it step. It may fail, but must end.
static bool step(const ob_scene *s, const ob_saved_run *r)
{
	ob_error e = { "" };
	ob_host_config c = { .isolation = OB_ISOLATION_THREAD, .workers = 1, .run = r->settings, .from = &r->host };
	ob_host *h = ob_host_start(s, &c, &e);
	if (!h)
		return false;
	ob_host_go(h, r->host.universe.step + STEPS);
	bool went = ob_host_wait(h, &e);
	CHECK(went || e.text[0]);
	ob_host_stop(h);
	return went;
}

int main(void)
{
	ob_scene s = scene();
	ob_checkpoint_file good = { 0 }, bad = { 0 };
	ob_saved_run r;
	unsigned parsed = 0, started = 0, went = 0;
	make(&s, &good);
	char *kept = malloc(good.size);
	memcpy(kept, good.bytes, good.size);
	CHECK(ob_saved_run_parse(&r, &bad, kept, good.size, "good", NULL) && step(&s, &r));
	ob_saved_run_close(&r, &bad);
	for (int i = 0; i < MUTANTS; i++) {
		ob_error e = { "" };
		memcpy(good.bytes, kept, good.size);
		for (uint32_t n = 1 + draw(3); n > 0; n--)
			spoil(&good);
		if (memcmp(good.bytes, kept, (size_t)((char *)good.area[0].at - good.bytes)) ==
		    0) // else that is what was spoilt
			ob_checkpoint_seal(&good);
		bool fine = ob_saved_run_parse(&r, &bad, good.bytes, good.size, "bad", &e);
		CHECK(fine || strncmp(e.text, "bad: ", 5) == 0);
		parsed += fine;
		if (fine && started < RUNS && ++started)
			went += step(&s, &r);
		ob_saved_run_close(&r, &bad);
	}
	printf("%d made up, %u made sense, of %u runs %u went on\n", MUTANTS, parsed, started, went);
	CHECK(parsed > RUNS && went > 0);
	ob_checkpoint_finish(&good);
	free(kept);
	free(s.object);
	return check_end();
}
