// Hostile segments: a reader that is attached to a universe, or attaches to it, reads arbitrary bytes. It may refuse;
// it may never crash, hang, or return implausible data. A million in a minute or so:
//
//   segments [COUNT [SEED]]
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <ob/motion.h>

#include "base/random.h"
#include "base/utf8.h"
#include "check.h"
#include "hull/hull.h"
#include "measure/measure.h"
#include "table/layout.h"

enum { OBJECTS = 12, HULLS = 2, WORKERS = 3, CHANGES = 24, CONTACTS = 64 };

// Original bytes of a change, to undo it: copying the whole segment back would take most of the time.
typedef struct change {
	uint64_t at, was;
} change;

static char name[OB_NAME_MAX];

static void fill_hulls(ob_universe *u)
{
	static const ob_vec3 point[] = { { -.5, -.4, 0 }, { .5, -.4, 0 }, { 0, .6, 0 },
					 { 0, 0, .7 },    { .3, .3, .5 }, { -.4, .1, .6 } };
	for (uint32_t i = 0; i < HULLS; i++) {
		ob_hull h;
		ob_error e = { "" };
		CHECK(ob_hull_build(point, 4 + 2 * i, &h, &e) && ob_write_hull(u, i, &h));
	}
}

static void fill(ob_universe *u)
{
	fill_hulls(u);
	for (uint32_t i = 0; i < OBJECTS; i++) {
		ob_passport p = { .id = i,
				  .flags = OB_OBJECT_PRESENT | (i ? 0 : OB_OBJECT_STATIC),
				  .shape = 1 + i % OB_SHAPE_HULL,
				  .hull = i / OB_SHAPE_HULL % HULLS,
				  .size = { .5, .5, .5 },
				  .mass = i ? 1 : 0,
				  .inertia = { .1, .2, .3 } };
		ob_motion m = { .q = { 1, 0, 0, 0 },
				.p = { 1.2 * i, 0, 1 }, // apart: the cost of penetrations is not tested here
				.v = { 1, 0, 0 },
				.w = { 1, 2, 3 },
				.valid_until = INFINITY };
		snprintf(p.name, sizeof p.name, "object %u", i);
		ob_write_passport(u, i, &p);
		ob_publish_motion(u, i, &m);
	}
	ob_step_data *x = ob_universe_step_data(u);
	for (uint32_t i = 0; i + 1 < OBJECTS; i++) {
		x->pair[i] = (ob_pair_key){ .a = i, .b = i + 1, .record = i, .active = 1 };
		x->record[i].version[1] = (ob_pair_state){ .normal = { 0, 0, 1 }, .points = 2 };
		x->record[i].stamp[1] = 1;
	}
	x->count->pairs = OBJECTS - 1;
}

static bool is_finite(ob_vec3 v)
{
	return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static bool is_plain(const char *text, size_t room)
{
	char plain[OB_DEATH_MAX];
	memcpy(plain, text, room);
	CHECK(memchr(plain, 0, room));
	plain[room - 1] = 0;
	ob_utf8_make_plain(plain);
	return strcmp(plain, text) == 0;
}

static void check_passport(const ob_passport *p, uint32_t id)
{
	CHECK(p->id == id && p->shape <= OB_SHAPE_TERRAIN && is_finite(p->size) && p->mass >= 0 &&
	      is_plain(p->name, sizeof p->name));
}

static bool holds(const ob_hull *h, const double bounds[6])
{
	bool finite = true;
	for (int i = 0; i < 6; i++)
		finite &= isfinite(bounds[i]);
	return finite && h->corners <= OB_HULL_CORNERS_MAX && h->faces <= OB_HULL_FACES_MAX &&
	       h->edges <= OB_HULL_EDGES_MAX;
}

static void read_hulls(const ob_universe *u)
{
	for (uint32_t i = 0; i <= HULLS; i++) {
		ob_hull h;
		double bounds[6];
		if (!ob_universe_get_hull(u, i, &h))
			continue;
		ob_hull_bounds(&h, (ob_pose){ .p = { 1, 2, 3 }, .q = { .5, .5, -.5, .5 } }, bounds);
		CHECK(i < HULLS && holds(&h, bounds));
	}
}

// Measures a snapshot as an observer does.
static void measure(const ob_snapshot *s, ob_vec3 gravity)
{
	ob_penetration depth;
	ob_separation apart;
	for (uint32_t i = 0; i < s->count; i++) {
		bool there = s->passport[i].flags & OB_OBJECT_PRESENT;
		CHECK(!ob_snapshot_hull(s, i) || (there && s->passport[i].shape == OB_SHAPE_HULL));
		if (there)
			ob_snapshot_state(s, i);
	}
	ob_measure_hash(s);
	ob_measure_energy(s, gravity);
	ob_measure_momentum(s);
	ob_measure_angular_momentum(s);
	ob_measure_penetration(s, &depth);
	ob_measure_separation(s, &apart, NULL, NULL);
}

// Reads all data that a viewer reads, and computes with it.
static void read_all(const ob_universe *u, ob_snapshot *s)
{
	ob_universe_info info;
	ob_contact_point contact[CONTACTS];
	ob_worker_info w;
	ob_passport p;
	ob_motion m;
	float bounds[6];
	ob_universe_get_info(u, &info);
	CHECK(info.capacity == OBJECTS && info.objects <= OBJECTS && info.hulls <= HULLS &&
	      info.state <= OB_UNIVERSE_FAILED);
	CHECK(is_plain(info.name, sizeof info.name) && is_plain(info.isolation, sizeof info.isolation) &&
	      is_plain(info.last_death, sizeof info.last_death));
	read_hulls(u);
	for (uint32_t i = 0; i <= WORKERS; i++)
		ob_universe_get_worker(u, i, &w);
	for (uint32_t i = 0; i <= OBJECTS; i++) {
		const ob_passport none = { 0 };
		p = none;
		if (ob_universe_get_passport(u, i, &p))
			check_passport(&p, i);
		else
			CHECK(memcmp(&p, &none, sizeof p) == 0);
		if (ob_universe_get_motion(u, i, &m)) {
			ob_motion_at(&m, ob_v3(.1, .2, .3), info.time);
			CHECK(is_finite(m.p) && is_finite(m.v) && isfinite(m.t0));
		}
		if (ob_universe_get_bounds(u, i, bounds))
			CHECK(bounds[0] <= bounds[3]);
	}
	size_t n = ob_universe_get_contacts(u, contact, CONTACTS);
	for (size_t i = 0; i < n && i < CONTACTS; i++)
		CHECK(contact[i].a < contact[i].b && contact[i].b < OBJECTS && is_finite(contact[i].position));
	if (ob_snapshot_take(s, u, OB_SNAPSHOT_CONTACTS, NULL))
		measure(s, info.gravity);
}

// Mostly places in use; edge values as often as random ones.
static uint64_t random_value(uint64_t *r)
{
	static const uint64_t edges[] = { 0,
					  1,
					  UINT64_MAX,
					  INT64_MAX,
					  UINT32_MAX,
					  UINT64_C(0x7ff0000000000000),
					  UINT64_C(0x7ff8000000000000),
					  UINT64_C(0x7fefffffffffffff),
					  UINT64_C(0xffffffff00000000),
					  OBJECTS,
					  UINT64_C(0x0000000100000001),
					  UINT64_C(0x8000000080000000) };
	uint64_t x = ob_splitmix(r);
	switch (x % 4) {
	case 0:
		return edges[(x >> 8) % (sizeof edges / sizeof *edges)];
	case 1:
		return x >> (x >> 8) % 64;
	case 2:
		return UINT64_C(1) << (x >> 8) % 64;
	default:
		return ob_splitmix(r);
	}
}

static uint64_t random_place(const ob_universe *u, uint64_t *r)
{
	const uint64_t *area = u->header.area;
	uint64_t x = ob_splitmix(r), i = (x >> 32) % (OB_AREAS + 1);
	uint64_t from = i == OB_AREAS ? 0 : area[i], to = i + 1 < OB_AREAS ? area[i + 1] : u->header.bytes;
	uint64_t used = i == OB_AREA_HULL ? HULLS * sizeof(ob_hull) : 4096; // only a small part of an area is in use
	used = to - from < used ? to - from : used;
	return used < 8 ? 0 : from + x % (used / 8) * 8; // an area may be empty
}

static void scribble(ob_universe *u, uint64_t *r, change *undo, int n)
{
	for (int i = 0; i < n; i++) {
		undo[i].at = random_place(u, r);
		memcpy(&undo[i].was, u->base + undo[i].at, 8);
		uint64_t now = ob_splitmix(r) % 3 ? random_value(r) : undo[i].was ^ UINT64_C(1) << ob_splitmix(r) % 64;
		memcpy(u->base + undo[i].at, &now, 8);
	}
}

int main(int argc, char **argv)
{
	const long count = argc > 1 ? atol(argv[1]) : 20000;
	uint64_t r = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	ob_error e = { "" };
	snprintf(name, sizeof name, "fuzz-segments-%d", (int)getpid());
	ob_universe_setup setup = { .name = name,
				    .capacity = OBJECTS,
				    .workers = WORKERS,
				    .hulls = HULLS,
				    .isolation = "thread",
				    .traced = true };
	setup.run = ob_run_settings_default();
	ob_universe *u = ob_universe_create(&setup, &e);
	ob_universe *before = u ? ob_universe_attach(name, &e) : NULL;
	CHECK(u && before);
	if (!u || !before)
		return fprintf(stderr, "%s\n", e.text), 1;
	fill(u);
	ob_snapshot s = { 0 };
	long refused = 0;
	for (long i = 0; i < count; i++) {
		change undo[CHANGES];
		int n = 1 + (int)(ob_splitmix(&r) % CHANGES);
		scribble(u, &r, undo, n);
		read_all(before, &s);
		if (i % 8 == 0) { // mapping it takes longer than all the rest
			ob_universe *after = ob_universe_attach(name, &e);
			refused += !after;
			if (after)
				read_all(after, &s);
			ob_universe_detach(after);
		}
		while (n-- > 0)
			memcpy(u->base + undo[n].at, &undo[n].was, 8);
	}
	ob_snapshot_finish(&s);
	ob_universe_detach(before);
	ob_universe_destroy(u, true);
	printf("%ld segments, %ld refused\n", count, refused);
	return check_end();
}
