// Simulators two boundaries apart, as where threads drift that have no clock. Those ahead are read as they were.
#include "hand.h"

#include <math.h>

#include "../check.h"

#include "base/random.h"

static const ob_vec3 none = { 0, 0, 0 };
enum { OTHERS = 8 };
static const double radius = .05, speed = 10; // m, m/s

// A ball without friction.
static uint32_t add_ball(hand *h, double r, double mass, ob_vec3 at, ob_vec3 velocity)
{
	ob_passport p;
	const uint32_t id = hand_add(h, OB_SHAPE_SPHERE, ob_v3(r, 0, 0), mass, at, velocity, 1);
	CHECK(ob_universe_get_passport(h->u, id, &p));
	p.friction = 0;
	ob_write_passport(h->u, id, &p);
	return id;
}

static ob_motion newest(const hand *h, uint32_t id)
{
	ob_motion m, next;
	CHECK(ob_free_read(h->u, id, INFINITY, &m, &next));
	return m;
}

// A ball bounces off a post and goes to the left, while the simulators of others stand. On the right of the post, where the new
// motion would come from, lie these. It has never been there: all keep their velocities, and none gains energy: in two rings of
// heavy ones, none of which knows of the others' hits, that was .035 of all. first: the ball has the lowest id.
static void test_bounce(bool first)
{
	const ob_free_settings f = { .update_rate = 1000, .max_lag = .002, .end = INFINITY, .seed = 1 };
	const double mass = 100, post = .02, away = (post + radius) * sqrt(.5);
	uint32_t ball = 0, other[OTHERS];
	hand *h = hand_create(f, none);
	if (first)
		ball = add_ball(h, radius, 1, ob_v3(0, -.31, 0), ob_v3(0, speed, 0));
	for (int i = 0; i < OTHERS; i++)
		other[i] = add_ball(
			h, radius, mass,
			ob_v3(i < 4 ? .14 : .24, .075 * cos(M_PI / 2 * i + .5), .075 * sin(M_PI / 2 * i + .5)), none);
	if (!first)
		ball = add_ball(h, radius, 1, ob_v3(0, -.31, 0), ob_v3(0, speed, 0));
	add_ball(h, post, 0, ob_v3(away, away, 0), none);
	hand_until(h, 2);
	for (int i = 0; i < OTHERS; i++)
		CHECK(hand_step(h, other[i]));
	while (hand_step(h, ball))
		;
	const ob_vec3 bounced = newest(h, ball).v;
	CHECK(h->sim[ball].time > .02 && bounced.x < -.9 * speed);
	CHECK_NEAR(ob_norm(bounced), speed, .01 * speed);
	uint64_t random = 1;
	CHECK(hand_run(h, &random, 0));
	double energy = .5 * ob_norm2(newest(h, ball).v);
	for (int i = 0; i < OTHERS; i++) {
		const ob_vec3 v = newest(h, other[i]).v;
		CHECK_NEAR(ob_norm(v), 0, 1e-12);
		energy += .5 * mass * ob_norm2(v);
	}
	CHECK(energy <= .5 * speed * speed * (1 + 1e-9));
	CHECK_NEAR(ob_norm(ob_sub(newest(h, ball).v, bounced)), 0, 1e-12);
	hand_destroy(h);
}

int main(void)
{
	test_bounce(true);
	test_bounce(false);
	return check_end();
}
