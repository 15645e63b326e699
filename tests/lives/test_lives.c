// Random lives: objects are created and removed by the timetable, by scripts and on request, messages are sent, objects
// freeze, runs stand still, are put down and resumed, and simulators are killed. All ways to run a life end in the same
// bits, and what simulators share keeps its invariants (step/invariants.h).
//   lives [--seeds A..B] [--way N] [--verbose 1] [--kept FILE] [--folder DIR] [--print SEED]
// A life that fails is shrunk and printed: as a line for kept/lives.txt, and as its scene. Exits with 1 if any failed.
// --print: the scene alone, for ranks.py, with its files in DIR. --verbose names lives whose scene asks for too much, which end early, alike
// in all ways.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"
#include "check.h"
#include "free_way.h"
#include "things.h"
#include "way.h"

static const char *const way_name[] = { WAY_NAMES };
static const char *const event_name[] = {
	"create", "remove", "create and remove", "replace", "message", "colour", "freeze", "pause", "kill",
	"resume", "visit",  "create any",        "avatar",  "leave",   "return", "move"
};

static const life_parts everything = { UINT64_MAX, UINT64_MAX };

static bool verbose; // lives that end early are named, too

typedef struct sums {
	uint64_t lives, failed, ended, deaths, objects;
} sums;

// Runs the life as all ways must end. No objects: there is nothing to compare with, as the way has its own bits.
static outcome expect(const life *l, way w)
{
	return w == WAY_FREE && !free_way_repeats(l) ? (outcome){ .failed = false } : way_run(l, WAY_THREADS);
}

// True if the life does not end alike in the way, or breaks an invariant in it.
static bool fails(uint64_t seed, life_parts left, way w, outcome *expected, outcome *found)
{
	static life l;
	life_make(&l, seed, left, w == WAY_FREE);
	*expected = expect(&l, w);
	*found = w == WAY_THREADS ? *expected : way_run(&l, w);
	return !outcomes_agree(w, expected, found);
}

// Leaves out one part after the other, as long as it fails. A failure that does not come each time is asked for twice.
static life_parts shrink(uint64_t seed, way w)
{
	static life before, after; // too large for the stack
	life_parts left = everything;
	outcome a, b;
	for (uint32_t i = 0; i < 2 * LIFE_PARTS; i++) {
		life_parts fewer = left;
		const uint64_t part = UINT64_C(1) << (LIFE_PARTS - 1 - i % LIFE_PARTS);
		*(i < LIFE_PARTS ? &fewer.events : &fewer.objects) &= ~part;
		life_make(&before, seed, left, w == WAY_FREE);
		life_make(&after, seed, fewer, w == WAY_FREE);
		if (memcmp(&before, &after, sizeof before) == 0 || fails(seed, fewer, w, &a, &b) ||
		    fails(seed, fewer, w, &a, &b))
			left = fewer;
	}
	return left;
}

static void print_outcome(const char *name, const outcome *o)
{
	if (o->failed)
		printf("  %s: %s\n", name, o->text);
	else
		printf("  %s: %016" PRIx64 ", %u objects, %u deaths\n", name, o->hash, o->objects, o->deaths);
}

static void print(uint64_t seed, life_parts left, way w, const outcome *expected, const outcome *found)
{
	static life l;
	life_make(&l, seed, left, w == WAY_FREE);
	printf("%" PRIu64 " %" PRIx64 " %" PRIx64 " %d\n", seed, left.objects, left.events, w);
	print_outcome(way_name[WAY_THREADS], expected);
	print_outcome(way_name[w], found);
	for (uint32_t i = 0; i < l.events; i++)
		printf("  step %u: %s\n", l.event[i].step, event_name[l.event[i].kind]);
	printf("%s\n", l.text);
	fflush(stdout);
}

static void run_life(uint64_t seed, way first, way last, sums *s)
{
	static life l;
	outcome expected, found;
	life_make(&l, seed, everything, first == WAY_FREE);
	expected = expect(&l, first);
	s->lives++;
	s->ended += expected.failed;
	if (expected.failed && verbose)
		printf("%" PRIu64 ": %s\n", seed, expected.text);
	s->objects += expected.objects;
	for (way w = first; w <= last; w++) {
		found = w == WAY_THREADS ? expected : way_run(&l, w);
		s->deaths += found.deaths;
		CHECK(outcomes_agree(w, &expected, &found));
		if (outcomes_agree(w, &expected, &found))
			continue;
		s->failed++;
		print(seed, everything, w, &expected, &found);
		const life_parts left = shrink(seed, w);
		printf("shrunk: ");
		fails(seed, left, w, &expected, &found);
		print(seed, left, w, &expected, &found);
		return;
	}
}

// Each line: seed, objects and events that are left, way, as they are printed.
static void run_kept(const char *path)
{
	FILE *f = fopen(path, "r");
	char line[200];
	CHECK(f);
	while (f && fgets(line, sizeof line, f)) {
		uint64_t seed;
		life_parts left;
		unsigned w;
		outcome expected, found;
		if (sscanf(line, "%" SCNu64 " %" SCNx64 " %" SCNx64 " %u", &seed, &left.objects, &left.events, &w) !=
			    4 ||
		    w >= WAYS)
			continue;
		const bool failed = fails(seed, left, (way)w, &expected, &found);
		CHECK(!failed);
		if (failed)
			print(seed, left, (way)w, &expected, &found);
	}
	if (f)
		fclose(f);
}

static void print_scene(uint64_t seed)
{
	static life l;
	life_make(&l, seed, everything, false);
	fputs(l.text, stdout);
	exit(0);
}

int main(int argc, char **argv)
{
	uint64_t first = 1, last = 0;
	way from = WAY_THREADS, to = WAY_HARDENED; // free runs do not repeat: --way 4 asks for them
	sums s = { 0 };
	for (int i = 1; i + 1 < argc; i += 2) {
		if (!strcmp(argv[i], "--seeds") && sscanf(argv[i + 1], "%" SCNu64 "..%" SCNu64, &first, &last) == 2)
			continue;
		if (!strcmp(argv[i], "--way"))
			from = to = (way)(atoi(argv[i + 1]) % WAYS);
		else if (!strcmp(argv[i], "--print"))
			print_scene(strtoull(argv[i + 1], NULL, 10));
		else if (!strcmp(argv[i], "--verbose"))
			verbose = atoi(argv[i + 1]);
		else if (!strcmp(argv[i], "--folder"))
			things_use_folder(argv[i + 1]);
		else if (!strcmp(argv[i], "--kept"))
			run_kept(argv[i + 1]);
	}
	for (uint64_t seed = first; seed <= last; seed++)
		run_life(seed, from, to, &s);
	printf("%" PRIu64 " lives, %" PRIu64 " objects at their ends, %" PRIu64 " deaths of simulators, %" PRIu64
	       " ended by their own work, %" PRIu64 " failed\n",
	       s.lives, s.objects, s.deaths, s.ended, s.failed);
	return check_failed > 0;
}
