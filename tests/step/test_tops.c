// Tops on a pinned foot, released as they spin: they nod. Any number of substeps finds the same motion, and a finer tolerance a
// better one.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

enum { STEPS = 90 };
static const double length = .2; // m, from the foot to the centre

// Returns the largest distance (m) of the centre from a path; compare false: writes the path.
static double follow(double tilt, double rate, uint32_t substeps, double tolerance, ob_vec3 *path, bool compare)
{
	little_scene *s = little_scene_new();
	little_universe l;
	const ob_vec3 up = ob_v3(sin(tilt), 0, cos(tilt));
	s->run.substeps = substeps;
	s->run.tolerance = tolerance;
	const ob_world_body top = ob_world_cylinder(&s->world, 1.5, .1, .025, ob_scale(up, length));
	top.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, tilt, 0));
	top.state->w = ob_scale(up, rate);
	ob_world_join(&s->world, OB_JOINT_BALL, 0, OB_JOINT_WORLD, (ob_pose){ { 0, 0, 0 }, ob_quat_identity() });
	little_open(&l, s);
	double off = 0;
	for (int i = 0; i < STEPS; i++) {
		little_run(&l, 1);
		const ob_vec3 p = little_state(&l, 0).pose.p;
		if (compare)
			off = fmax(off, ob_norm(ob_sub(p, path[i])));
		else
			path[i] = p;
	}
	little_close(&l);
	free(s->world.joint);
	free(s);
	return off;
}

static void test_top(double degrees, double rate)
{
	enum { FINE = 200 }; // its steps have blocks of the sixth order, or more flights than any below
	const uint32_t numbers[] = { 1, 8, 100, 500, 513, 700, 1000 };
	const double tilt = degrees * M_PI / 180, tolerances[] = { 1e-3, 1e-4, 1e-5 };
	ob_vec3 path[STEPS];
	(void)follow(tilt, rate, FINE, 0, path, false);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		CHECK(follow(tilt, rate, numbers[i], 0, path, true) < (numbers[i] < 8 ? 1e-3 : 1e-4));
	double last = INFINITY;
	for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
		const double off = follow(tilt, rate, 8, tolerances[i], path, true);
		CHECK(off <= tolerances[i]);
		CHECK(off <= fmax(last, 1e-6));
		last = off;
	}
}

int main(void)
{
	for (double degrees = 5; degrees <= 80; degrees += 25)
		for (double rate = 60; rate <= 240; rate += 90)
			test_top(degrees, rate);
	return check_end();
}
