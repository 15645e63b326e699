// Compares what is said of a second's motion with the same second of many substeps, in random scenes. A body's second is
// bounded if its estimates add up to the tolerance at most. Prints for each kind of scene how many are bounded, and how many
// of these are off by more.
//
//   truth [--seeds A..B] [--kind NAME] [--shapes 1|2|3] [--second N] [--substeps N] [--share S] [--bounded S] [--list 1]
//
// --shapes: 1 spheres and boxes, 2 with capsules and cylinders, 3 with hulls. --share: the permitted share of bounded
// seconds that are off, asserted; --bounded: the least share that is bounded. --list: prints each body's second.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "play.h"

typedef struct tally {
	unsigned moving, bounded, exceeded;
	double worst; // largest error of a bounded second, by the tolerance
	uint64_t seed;
} tally;

static bool moves(const scene_body *b)
{
	return b->mass > 0 && !b->driven;
}

static bool list; // prints each body's second

static void try_scene(scene_kind kind, uint64_t seed, unsigned shapes, uint64_t step, uint32_t substeps, tally *t)
{
	const random_scene s = scene_draw(kind, seed, shapes);
	played_second second;
	if (!play_beside(&s, step, substeps, &second))
		return;
	for (uint32_t i = 0; i < s.bodies; i++) {
		const double off = second.off[i] / s.run.tolerance;
		if (!moves(&s.body[i]))
			continue;
		t->moving++;
		if (list)
			printf("  %s %lu body %u: said %.3g, off %.3g of the tolerance\n", scene_kind_name[kind],
			       (unsigned long)seed, i, second.said[i] / s.run.tolerance, off);
		if (second.said[i] > s.run.tolerance)
			continue;
		t->bounded++;
		t->exceeded += off > 1;
		if (off > t->worst)
			t->worst = off, t->seed = seed;
	}
}

int main(int argc, char **argv)
{
	static const unsigned shapes[] = { 1u << OB_SHAPE_SPHERE | 1u << OB_SHAPE_BOX,
					   1u << OB_SHAPE_CAPSULE | 1u << OB_SHAPE_CYLINDER, 1u << OB_SHAPE_HULL };
	unsigned long first = 1, last = 20, second = 0, substeps = 512, kinds = 1;
	const char *only = NULL;
	double share = 1, bounded = 0;
	for (int i = 1; i + 1 < argc; i += 2) {
		if (!strcmp(argv[i], "--seeds"))
			sscanf(argv[i + 1], "%lu..%lu", &first, &last);
		else if (!strcmp(argv[i], "--kind"))
			only = argv[i + 1];
		else if (!strcmp(argv[i], "--shapes"))
			kinds = strtoul(argv[i + 1], NULL, 10);
		else if (!strcmp(argv[i], "--second"))
			second = strtoul(argv[i + 1], NULL, 10);
		else if (!strcmp(argv[i], "--substeps"))
			substeps = strtoul(argv[i + 1], NULL, 10);
		else if (!strcmp(argv[i], "--share"))
			share = strtod(argv[i + 1], NULL);
		else if (!strcmp(argv[i], "--bounded"))
			bounded = strtod(argv[i + 1], NULL);
		else if (!strcmp(argv[i], "--list"))
			list = strtoul(argv[i + 1], NULL, 10);
	}
	const unsigned drawn = shapes[0] | (kinds > 1 ? shapes[1] : 0) | (kinds > 2 ? shapes[2] : 0);
	tally all = { 0 };
	printf("%-10s %8s %8s %8s %9s  %s\n", "kind", "seconds", "bounded", "exceeded", "worst", "seed");
	for (int kind = 0; kind < SCENE_KINDS; kind++) {
		tally t = { 0 };
		if (only && strcmp(only, scene_kind_name[kind]) != 0)
			continue;
		for (uint64_t seed = first; seed <= last; seed++)
			try_scene((scene_kind)kind, seed, drawn, second * PLAY_STEPS, (uint32_t)substeps, &t);
		printf("%-10s %8u %8u %8u %9.2g  %lu\n", scene_kind_name[kind], t.moving, t.bounded, t.exceeded,
		       t.worst, (unsigned long)t.seed);
		fflush(stdout);
		all.moving += t.moving, all.bounded += t.bounded, all.exceeded += t.exceeded;
	}
	printf("%-10s %8u %8u %8u\n", "all", all.moving, all.bounded, all.exceeded);
	CHECK(all.bounded > 0 && all.exceeded <= share * all.bounded);
	CHECK(all.bounded >= bounded * all.moving);
	return check_end();
}
