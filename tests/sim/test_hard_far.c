// Hard case: ten kilometres from the origin everything is as it is there.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const ob_vec3 near = { 0, 0, 0 }, far = { 7071, -7071, 0 }; // m

static void move_all(little_scene *s, ob_vec3 by)
{
	for (uint32_t i = 0; i < s->objects; i++)
		s->object[i].state.pose.p = ob_add(s->object[i].state.pose.p, by);
}

// ---- a stack of ten for 20 s

typedef struct standing {
	double deepest, drift, sunk; // m
} standing;

static standing stand(ob_vec3 at)
{
	standing out = { 0, 0, 0 };
	little_scene *s = little_scene_new();
	little_stack(s, 10, 7);
	move_all(s, at);
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		out.deepest = fmax(out.deepest, little_penetration(&l).max_m);
	}
	for (uint32_t i = 1; i <= 10; i++) {
		ob_vec3 moved = ob_sub(little_state(&l, i).pose.p, s->object[i].state.pose.p);
		out.drift = fmax(out.drift, hypot(moved.x, moved.y));
		out.sunk = fmax(out.sunk, fabs(moved.z));
	}
	little_close(&l);
	free(s);
	return out;
}

static void test_stack(void)
{
	standing a = stand(near), b = stand(far);
	printf("stack: deepest %.4f and %.4f mm, drift %.4f and %.4f mm\n", 1e3 * a.deepest, 1e3 * b.deepest,
	       1e3 * a.drift, 1e3 * b.drift);
	CHECK(b.deepest <= .5e-3);
	CHECK_NEAR(b.deepest, a.deepest, 1e-6);
	CHECK_NEAR(b.drift, a.drift, 1e-6);
	CHECK_NEAR(b.sunk, a.sunk, 1e-6);
}

// ---- head-on pairs, without gravity

static void collide(ob_vec3 at, ob_shape shape, double ratio, double e, ob_state out[2])
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	little_add(s, shape, ob_v3(.5, .5, .5), 1, ob_v3(0, 0, 0))->state.v.x = 1;
	little_add(s, shape, ob_v3(.5, .5, .5), ratio, ob_v3(1.537, 0, 0));
	s->object[0].passport.restitution = s->object[1].passport.restitution = e;
	move_all(s, at);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 2);
	for (uint32_t i = 0; i < 2; i++) {
		out[i] = little_state(&l, i);
		out[i].pose.p = ob_sub(out[i].pose.p, at);
	}
	little_close(&l);
	free(s);
}

static void test_pairs(void)
{
	const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX };
	const double ratio[] = { 1, 1000 }, e[] = { 0, .5, 1 };
	double way = 0, speed = 0;
	for (int k = 0; k < 12; k++) {
		ob_state a[2], b[2];
		collide(near, shape[k % 2], ratio[k / 2 % 2], e[k / 4], a);
		collide(far, shape[k % 2], ratio[k / 2 % 2], e[k / 4], b);
		for (int i = 0; i < 2; i++) {
			way = fmax(way, ob_norm(ob_sub(b[i].pose.p, a[i].pose.p)));
			speed = fmax(speed, ob_norm(ob_sub(b[i].v, a[i].v)));
		}
	}
	printf("pairs: apart by %.1e m, %.1e m/s\n", way, speed);
	CHECK_NEAR(way, 0, 1e-6);
	CHECK_NEAR(speed, 0, 1e-6);
}

int main(void)
{
	test_stack();
	test_pairs();
	return check_end();
}
