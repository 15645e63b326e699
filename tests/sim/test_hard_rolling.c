// Hard case: spheres that roll on a box that is pushed (SimBenchmark's rolling test, Kang and Hwangbo 2018). The box
// is a hub: every round passes all 25 of them, and what is left over of the box's velocity is left over of theirs.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/mechanics.h"

enum { BOX = 1, BALL = 2, BALLS = 25 };
static const double push = 150; // N

// Velocities as the closed form says, along the push.
static double squared_error(const little_universe *l, uint32_t id, ob_vec3 direction, double a)
{
	double t = l->scene->run.step_length * (double)ob_step_count(l->u);
	return ob_norm2(ob_sub(little_state(l, id).v, ob_scale(direction, a * t)));
}

static little_scene *pushed_box(ob_vec3 direction, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	little_ground(s)->passport.friction = .2; // with the box's .8: .4
	little_object *box = little_box(s, 10, ob_v3(10, 10, .5), ob_v3(0, 0, .5 - 2e-5));
	box->passport.friction = .8;
	box->passport.force = ob_scale(direction, push);
	for (int i = 0; i < BALLS; i++)
		little_sphere(s, 1, .5, ob_v3(2 * (i / 5) - 4, 2 * (i % 5) - 4, 1.5 - 6e-5))->passport.friction = .8;
	return s;
}

static void test_push(ob_vec3 direction, uint32_t substeps)
{
	const int steps = 240; // 4 s
	ob_reference_rolling exact = ob_reference_push(push, .4, 10, 1, BALLS, 9.81);
	little_scene *s = pushed_box(direction, substeps);
	little_universe l;
	little_open(&l, s);
	double error = 0, apart = 0;
	for (int step = 0; step < steps; step++) {
		little_run(&l, 1);
		error += squared_error(&l, BOX, direction, exact.box_a) / steps;
		error += squared_error(&l, BALL, direction, exact.ball_a) / steps;
	}
	for (uint32_t i = BALL; i < BALL + BALLS; i++)
		apart = fmax(apart, ob_norm(ob_sub(little_state(&l, i).v, little_state(&l, BALL).v)));
	printf("along (%.2f, %.2f), %u substeps: mean squared error %.1e m^2/s^2, spheres differ by %.1e m/s\n",
	       direction.x, direction.y, substeps, error, apart);
	CHECK(error <= 1e-6);
	CHECK(apart <= 1e-3);
	little_close(&l);
	free(s);
}

int main(void)
{
	for (uint32_t substeps = 1; substeps <= 8; substeps *= 8) {
		test_push(ob_v3(.5, sqrt(.75), 0), substeps);
		test_push(ob_v3(0, 1, 0), substeps);
	}
	return check_end();
}
