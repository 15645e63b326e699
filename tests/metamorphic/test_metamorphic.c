// Random scenes run twice, the second time transformed; and quantities conserved in a run. Prints a table of relations
// and kinds of scenes: tried, counted (a twin stayed near), failed, the worst.
//
//   metamorphic [--seeds A..B] [--relation NAME] [--kind NAME] [--shapes sphere,box,capsule,cylinder,hull] [--steps N]
//               [--shrink] [--scene FILE.lua] [--kept FILE.lua ...]
//
// Without --relation: all. With --suite, relations are asserted except those that "faults" lists as violated, and
// failures are printed. --kept: files of scenes whose first line names the relation and its seed, as --shrink prints
// them.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "shrink.h"

typedef struct request {
	uint64_t first, last, steps;
	int relation, kind; // -1: all
	unsigned shapes;
	bool shrink, suite;
} request;

typedef struct tally {
	unsigned tried, counted, failed;
	double worst;
	uint64_t worst_seed;
} tally;

static tally sum[RELATIONS][SCENE_KINDS];

enum {
	HITS = 1 << SCENE_HITS,
	SPINS = 1 << SCENE_SPINS,
	BOUNCE = 1 << SCENE_BOUNCE,
	HEAP = 1 << SCENE_HEAP,
	STATICS = 1 << SCENE_STATICS,
	STACK = 1 << SCENE_STACK,
	SLIDE = 1 << SCENE_SLIDE,
	ROLL = 1 << SCENE_ROLL,
	TABLES = 1 << SCENE_TABLES,
	PADDLES = 1 << SCENE_PADDLES,
	PUSHED = 1 << SCENE_PUSHED,
	ALL = (1 << SCENE_KINDS) - 1
};

// Relations that do not hold yet: measured, but not asserted.
static const unsigned faults[RELATIONS] = {
	[RELATION_MIRRORED] = HEAP | STATICS | TABLES,
	[RELATION_TURNED] = HEAP | STATICS | TABLES | PUSHED,
	[RELATION_TILTED] = HEAP | STATICS | TABLES,
	[RELATION_MOVED] = HEAP | TABLES | PADDLES | PUSHED,
	[RELATION_BOOSTED] = HEAP | STATICS | PADDLES,
	[RELATION_LIFTED] = HEAP,
	[RELATION_REFINED] = ALL & ~(SPINS | ROLL),
	[RELATION_ENERGY] = HEAP,
	[RELATION_PEBBLE] = ALL & ~(SPINS | BOUNCE | STACK),
	[RELATION_NEIGHBOUR] = ALL & ~(SPINS | BOUNCE | STACK),
	[RELATION_IDLE] = ALL & ~(SPINS | STACK),
	[RELATION_CUT] = ALL & ~STACK,
};
// Same, with boxes and spheres alone.
static const unsigned plain_faults[RELATIONS] = {
	[RELATION_BOOSTED] = TABLES,
};
// Same, with capsules and cylinders.
static const unsigned round_faults[RELATIONS] = {
	[RELATION_TURNED] = ROLL,
	[RELATION_MOVED] = STATICS,
	[RELATION_ENERGY] = STATICS,
};
// Same, with hulls.
static const unsigned hull_faults[RELATIONS] = {
	[RELATION_TILTED] = STACK | PADDLES,
	[RELATION_BOOSTED] = STACK | TABLES,
	[RELATION_LIFTED] = STACK,
	[RELATION_REORDERED] = TABLES,
	[RELATION_REFRAMED] = STACK | STATICS | TABLES,
	[RELATION_NEIGHBOUR] = BOUNCE,
	[RELATION_ENERGY] = STATICS,
};

static bool is_asserted(const request *q, relation_id r, scene_kind k)
{
	const bool round = q->shapes & (1u << OB_SHAPE_CAPSULE | 1u << OB_SHAPE_CYLINDER);
	const bool hull = q->shapes & 1u << OB_SHAPE_HULL;
	const unsigned plain = round || hull ? 0 : plain_faults[r];
	return !((faults[r] | plain | (round ? round_faults[r] : 0) | (hull ? hull_faults[r] : 0)) & 1u << k);
}

static void show(relation_id r, uint64_t seed, const random_scene *s, const judged *j)
{
	printf("-- relation %s seed %lu: off by %.2g, limit %.1g, at %g s %s\n", relation_name[r], (unsigned long)seed,
	       j->error, j->limit, j->when, j->why);
	scene_print(stdout, s);
	fflush(stdout);
}

static void show_failure(const request *q, relation_id r, scene_kind kind, uint64_t seed, const original *o, judged j)
{
	printf("-- %s, seed %lu of %s:\n", relation_name[r], (unsigned long)seed, scene_kind_name[kind]);
	if (!q->shrink) {
		show(r, seed, o->scene, &j);
		return;
	}
	random_scene small = shrink_scene(o->scene, r, seed, q->steps);
	original again = relation_original(&small, q->steps);
	j = relation_judge(r, &again, seed, q->steps);
	show(r, seed, &small, &j);
}

static void add_up(tally *t, const judged *j, uint64_t seed)
{
	t->tried++;
	t->counted += j->counted;
	t->failed += relation_fails(j);
	if (!(j->error <= t->worst)) {
		t->worst = j->error;
		t->worst_seed = seed;
	}
}

static void try_scene(const request *q, scene_kind kind, uint64_t seed)
{
	const random_scene s = scene_draw(kind, seed, q->shapes);
	const original o = relation_original(&s, q->steps);
	if (!o.valid) {
		if (o.base.failed)
			printf("-- seed %lu of %s cannot be run: %s\n", (unsigned long)seed, scene_kind_name[kind],
			       o.base.why);
		CHECK(!o.base.failed);
		return;
	}
	for (int r = 0; r < RELATIONS; r++) {
		if (q->relation >= 0 && r != q->relation)
			continue;
		judged j = relation_judge(r, &o, seed, q->steps);
		if (!j.applies)
			continue;
		add_up(&sum[r][kind], &j, seed);
		bool asserted = !q->suite || is_asserted(q, r, kind);
		if (relation_fails(&j) && asserted && (q->shrink || q->suite))
			show_failure(q, r, kind, seed, &o, j);
		if (asserted)
			CHECK(!relation_fails(&j));
	}
}

static void print_table(void)
{
	printf("%-10s %-8s %6s %8s %7s %9s %6s\n", "relation", "kind", "tried", "counted", "failed", "worst", "seed");
	for (int r = 0; r < RELATIONS; r++)
		for (int k = 0; k < SCENE_KINDS; k++)
			if (sum[r][k].tried)
				printf("%-10s %-8s %6u %8u %7u %9.2g %6lu\n", relation_name[r], scene_kind_name[k],
				       sum[r][k].tried, sum[r][k].counted, sum[r][k].failed, sum[r][k].worst,
				       (unsigned long)sum[r][k].worst_seed);
}

// A relation that counts few scenes proves little.
static void check_shares(void)
{
	for (int r = 0; r < RELATIONS; r++) {
		unsigned tried = 0, counted = 0;
		for (int k = 0; k < SCENE_KINDS; k++)
			tried += sum[r][k].tried, counted += sum[r][k].counted;
		CHECK(counted >= .75 * tried);
	}
}

static void try_all(const request *q)
{
	for (int kind = 0; kind < SCENE_KINDS; kind++)
		for (uint64_t seed = q->first; seed <= q->last && (q->kind < 0 || kind == q->kind); seed++)
			try_scene(q, kind, seed);
	print_table();
}

// Runs a scene that once failed.
static void try_kept(const request *q, const char *path)
{
	char name[32];
	unsigned long seed;
	random_scene s;
	ob_error e;
	FILE *f = fopen(path, "r");
	bool read = f && fscanf(f, "-- relation %31s seed %lu", name, &seed) == 2;
	if (f)
		fclose(f);
	if (!read || !scene_read(path, &s, &e)) {
		fprintf(stderr, "%s: %s\n", path, read ? e.text : "no relation in the first line");
		exit(1);
	}
	const original o = relation_original(&s, q->steps);
	CHECK(o.valid);
	for (int r = 0; r < RELATIONS; r++) {
		if (strcmp(name, relation_name[r]) != 0 && q->relation != r)
			continue;
		judged j = relation_judge(r, &o, seed, q->steps);
		printf("%s: %s: %s by %.2g (limit %.1g)\n", path, relation_name[r],
		       relation_fails(&j) ? "off" : "holds", j.error, j.limit);
		CHECK(!relation_fails(&j));
	}
}

static int find(const char *const *names, int count, const char *name)
{
	for (int i = 0; i < count; i++)
		if (strcmp(names[i], name) == 0)
			return i;
	fprintf(stderr, "no such name: %s\n", name);
	exit(2);
}

static unsigned find_shapes(const char *text)
{
	unsigned set = 0;
	set |= strstr(text, "sphere") ? 1u << OB_SHAPE_SPHERE : 0;
	set |= strstr(text, "box") ? 1u << OB_SHAPE_BOX : 0;
	set |= strstr(text, "capsule") ? 1u << OB_SHAPE_CAPSULE : 0;
	set |= strstr(text, "cylinder") ? 1u << OB_SHAPE_CYLINDER : 0;
	set |= strstr(text, "hull") ? 1u << OB_SHAPE_HULL : 0;
	return set;
}

static void read_seeds(const char *text, request *q)
{
	if (sscanf(text, "%lu..%lu", &q->first, &q->last) != 2) {
		fprintf(stderr, "seeds are A..B, not %s\n", text);
		exit(2);
	}
}

int main(int argc, char **argv)
{
	request q = { 1, 10, PLAY_STEPS, -1, -1, find_shapes("sphere box"), false, false };
	bool kept = false;
	for (int i = 1; i < argc; i++) {
		const char *value = i + 1 < argc ? argv[i + 1] : "";
		if (strcmp(argv[i], "--shrink") == 0)
			q.shrink = true;
		else if (strcmp(argv[i], "--suite") == 0)
			q.suite = true;
		else if (strcmp(argv[i], "--kept") == 0)
			kept = true;
		else if (strcmp(argv[i], "--seeds") == 0 && ++i < argc)
			read_seeds(value, &q);
		else if (strcmp(argv[i], "--relation") == 0 && ++i < argc)
			q.relation = find(relation_name, RELATIONS, value);
		else if (strcmp(argv[i], "--kind") == 0 && ++i < argc)
			q.kind = find(scene_kind_name, SCENE_KINDS, value);
		else if (strcmp(argv[i], "--shapes") == 0 && ++i < argc)
			q.shapes = find_shapes(value);
		else if (strcmp(argv[i], "--steps") == 0 && ++i < argc)
			q.steps = strtoull(value, NULL, 10);
		else if (kept)
			try_kept(&q, argv[i]);
		else
			find(NULL, 0, argv[i]);
	}
	if (!kept)
		try_all(&q);
	if (q.suite)
		check_shares();
	return check_end();
}
