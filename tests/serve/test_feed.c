// The feed: a viewer's prediction is never far off, and a late viewer has the same state.
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "host/little_scene.h"
#include "serve/feed.h"

enum { IDS = 64 };

// A viewer's copy, as src/front/serve/page/universe.js keeps it
typedef struct told {
	bool there, moves;
	uint32_t generation;
	ob_feed_kind kind;
	double t0, frequency;
	ob_vec3 p, v, w, a, inertia;
	ob_quat q;
	ob_vec3 colour;
} told;

typedef struct copy {
	told object[IDS];
	double time;
	size_t bytes;
	uint32_t motions;
} copy;

typedef struct reader {
	const unsigned char *at, *end;
} reader;

static void take(reader *r, void *to, size_t n)
{
	CHECK(r->at + n <= r->end);
	memset(to, 0, n);
	if (r->at + n <= r->end)
		memcpy(to, r->at, n);
	r->at += n;
}
#define TAKE(type) \
	({ \
		type taken; \
		take(r, &taken, sizeof taken); \
		taken; \
	})

static ob_vec3 take_vec3(reader *r)
{
	float v[3];
	take(r, v, sizeof v);
	return ob_v3(v[0], v[1], v[2]);
}

static ob_vec3 take_short3(reader *r, double one)
{
	int16_t v[3];
	take(r, v, sizeof v);
	return ob_v3(one * v[0], one * v[1], one * v[2]);
}

static void hear_object(reader *r, copy *c)
{
	uint32_t id = TAKE(uint32_t), generation = TAKE(uint32_t);
	uint8_t head[5]; // shape; flags[2]; bytes of the name; surface
	char name[256];
	take(r, head, sizeof head);
	CHECK(id < IDS && head[0] >= OB_SHAPE_SPHERE && head[0] <= OB_SHAPE_CYLINDER && head[3] < OB_NAME_MAX);
	told *o = &c->object[id % IDS];
	if (!o->there || o->generation != generation)
		*o = (told){ .there = true, .generation = generation };
	take_vec3(r);
	o->inertia = take_vec3(r);
	o->colour = take_vec3(r);
	take(r, name, head[3]);
}

static void hear_motion(reader *r, copy *c, uint32_t *before)
{
	uint32_t further = 0;
	uint8_t byte;
	int shift = 0;
	do {
		byte = TAKE(uint8_t);
		further |= (uint32_t)(byte & 127) << shift;
		shift += 7;
	} while (byte & 128 && shift < 35);
	uint32_t id = *before += further;
	CHECK(id < IDS && c->object[id % IDS].there);
	told *o = &c->object[id % IDS];
	uint8_t flags = TAKE(uint8_t);
	int16_t q[4];
	o->moves = true;
	o->kind = flags & 3;
	o->p = take_vec3(r);
	take(r, q, sizeof q);
	o->q = ob_quat_normalize((ob_quat){ q[0], q[1], q[2], q[3] });
	o->t0 = c->time - (flags & OB_FEED_BEGUN ? TAKE(float) : 0);
	o->a = flags & OB_FEED_ACCELERATED ? take_vec3(r) : ob_v3(0, 0, 0);
	o->frequency = o->kind == OB_FEED_SWINGS ? TAKE(double) : 0;
	o->v = o->w = ob_v3(0, 0, 0);
	if (flags & OB_FEED_WIDE) {
		o->v = take_vec3(r);
		o->w = take_vec3(r);
	} else if (o->kind != OB_FEED_STANDS) {
		o->v = take_short3(r, 1e-3);
		o->w = take_short3(r, 2e-3);
	}
}

// Applies m, and releases it.
static void hear(copy *c, ob_message *m)
{
	if (!m)
		return;
	reader whole = { m->bytes, m->bytes + m->size }, *r = &whole;
	uint8_t kind = TAKE(uint8_t), flags = TAKE(uint8_t);
	CHECK(kind == OB_FEED_MOTIONS && TAKE(uint16_t) == 0 && TAKE(float) > 0);
	if (flags & OB_FEED_VOID)
		memset(c->object, 0, sizeof c->object);
	c->time = TAKE(double);
	uint32_t removed = TAKE(uint32_t), created = TAKE(uint32_t), motions = TAKE(uint32_t), before = UINT32_MAX;
	for (uint32_t i = 0; i < removed; i++) {
		uint32_t id = TAKE(uint32_t);
		CHECK(id < IDS && c->object[id % IDS].there);
		c->object[id % IDS].there = false;
	}
	for (uint32_t i = 0; i < created; i++)
		hear_object(r, c);
	for (uint32_t i = 0; i < motions; i++)
		hear_motion(r, c, &before);
	CHECK(r->at == r->end);
	c->bytes += m->size;
	c->motions += motions;
	ob_message_release(m);
}

static ob_pace_state at_rate_1 = { 1, false };

static ob_vec3 shown_at(const told *o, double t)
{
	double s = o->kind == OB_FEED_STANDS ? 0 : t - o->t0, f = o->frequency;
	if (o->kind == OB_FEED_SWINGS)
		return ob_madd(ob_madd(o->p, sin(f * s) / f, o->v), (1 - cos(f * s)) / (f * f), o->a);
	return ob_madd(ob_madd(o->p, s, o->v), .5 * s * s, o->a);
}

static bool advance(ob_host *h, uint64_t step)
{
	ob_error e = { "" };
	ob_host_go(h, step);
	bool fine = ob_host_wait(h, &e);
	if (!fine)
		fprintf(stderr, "%s\n", e.text);
	return fine;
}

// Checks each step's deviation (m) between a viewer's poses and the real ones, against the tolerance for the balls' .1
// m.
static void check_shown(const copy *c, const ob_host *h)
{
	for (uint32_t id = 0; id < IDS; id++) {
		ob_motion m;
		ob_passport p;
		if (!ob_universe_get_motion(ob_host_universe(h), id, &m) ||
		    !ob_universe_get_passport(ob_host_universe(h), id, &p)) {
			CHECK(!c->object[id].there);
			continue;
		}
		CHECK(c->object[id].there && c->object[id].moves && c->object[id].generation == p.generation);
		ob_vec3 exact = p.flags & OB_OBJECT_STATIC ? m.p : ob_motion_at(&m, p.inertia, c->time).pose.p;
		double speed = ob_norm(m.v);
		CHECK(ob_norm(ob_sub(shown_at(&c->object[id], c->time), exact)) < .1 / 256 + speed * (.25 / 60) + 1e-5);
	}
}

static bool same(ob_vec3 a, ob_vec3 b)
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

int main(void)
{
	ob_scene s = little_scene(40);
	for (uint32_t i = 1; i <= 40; i++) { // a heap that falls and rolls apart
		s.object[i].state.pose.p = ob_v3(.15 * (i % 3), .14 * (i / 3 % 3), .3 + .22 * (i / 9));
		s.object[i].passport.restitution = .5;
	}
	ob_object_def *swing = &s.object[40];
	swing->state.pose.p = ob_v3(3, 0, 1);
	swing->passport.flags = OB_OBJECT_KINEMATIC;
	swing->passport.mass = 0;
	ob_path path = ob_path_circle(&swing->state, ob_v3(3, .2, 1), ob_v3(0, 0, 1), 5);
	swing->path = &path;
	ob_host_config config = little_config(&s, OB_ISOLATION_THREAD, 2);
	ob_error e = { "" };
	config.spare = 8;
	config.run.sleeping = true;
	ob_host *h = ob_host_start(&s, &config, &e);
	CHECK(h != NULL);
	if (!h)
		return check_end();
	ob_feed *feed = ob_feed_create(ob_host_universe(h), ob_host_roster(h));
	static copy early, late;
	CHECK(advance(h, 0));
	hear(&early, ob_feed_next(feed, &at_rate_1));
	CHECK(ob_feed_next(feed, &at_rate_1) == NULL); // nothing is new
	for (uint64_t step = 1; step <= 400; step++) {
		ob_object_def newcomer = ball("newcomer", .1, .1, 2.5);
		if (step == 100)
			CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = newcomer }, &e));
		if (step == 150)
			CHECK(ob_host_request_remove(h, 5, 1) &&
			      ob_host_request_remove(h, 6, 7)); // no object of generation 7 exists
		if (step == 350)
			for (uint32_t id = 20; id < 22; id++) {
				const ob_request red = {
					.kind = OB_REQUEST_COLOUR, .id = id, .generation = 1, .colour = { 1, .25, 0, 1 }
				};
				CHECK(ob_host_request(h, &red, &e));
			}
		CHECK(advance(h, step));
		hear(&early, ob_feed_next(feed, &at_rate_1));
		check_shown(&early, h);
		if (step % 100 == 50) {
			memset(&late, 0, sizeof late);
			hear(&late, ob_feed_whole(feed, &at_rate_1));
			CHECK(late.time == early.time);
			for (int i = 0; i < IDS; i++) {
				const told *a = &early.object[i], *b = &late.object[i];
				CHECK(a->there == b->there && same(a->colour, b->colour));
				if (a->there)
					CHECK(same(a->colour, ob_v3(1, .25, 0)) ==
					      (step >= 350 && (i == 20 || i == 21)));
				CHECK(!a->there ||
				      ob_norm(ob_sub(shown_at(a, early.time), shown_at(b, late.time))) < 1e-5);
			}
		}
	}
	CHECK(!early.object[5].there && early.object[6].there && early.object[41].there);
	at_rate_1.paused = true;
	ob_message *paused = ob_feed_next(feed, &at_rate_1);
	CHECK(paused && paused->bytes[1] == OB_FEED_PAUSED);
	ob_message_release(paused);
	printf("%u motions, %.0f bytes a body and second\n", early.motions, (double)early.bytes / 40 / 4);
	ob_feed_destroy(feed);
	ob_host_stop(h);
	free(s.object);
	return check_end();
}
