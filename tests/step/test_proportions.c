// Boxes of any size and shape on one of a hundred metres: they stand, and slide as far as by Coulomb's law.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

static void on_the_huge(ob_vec3 half, double turn, double mass)
{
	const double thin = fmin(half.x, fmin(half.y, half.z)), speed = sqrt(g * 20 * thin), mu = .5;
	const double way = speed * speed / (2 * mu * g);
	const bool slides = half.z <= .2 * fmin(half.x, half.y) || half.x == half.z; // the others would fall over
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3;
	ob_world_box(&s->world, 0, ob_v3(50, 50, 50), ob_v3(0, 0, -50));
	ob_vec3 at[2] = { { 13.3, -21.7, half.z }, { -13.3, 7.1, half.z } }, dir = ob_v3(cos(turn), sin(turn), 0);
	for (int i = 0; i < 2; i++) {
		ob_world_body o = ob_world_box(&s->world, mass, half, at[i]);
		o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, turn));
		if (i == 1 && slides)
			o.state->v = ob_scale(dir, speed);
	}
	ob_world_material(&s->world, mu, 0);
	little_universe u;
	little_open(&u, s);
	double deepest = 0;
	for (double t = 0; t < fmax(2, 2 * way / speed + .2); t += s->run.step_length) {
		little_run(&u, 1);
		deepest = fmax(deepest, little_penetration(&u).max_m);
	}
	ob_vec3 rest = ob_sub(little_state(&u, 1).pose.p, at[0]), slid = ob_sub(little_state(&u, 2).pose.p, at[1]);
	printf("%g x %g x %g m: drift %.1e m, %.1e m deep, way off by %.1e\n", 2 * half.x, 2 * half.y, 2 * half.z,
	       ob_norm(rest), deepest, slides ? ob_dot(slid, dir) / way - 1 : 0);
	CHECK(ob_norm(rest) <= 1e-3 * thin && ob_norm(rest) <= 1e-5);
	CHECK(deepest <= 1e-2 * thin);
	if (slides)
		CHECK_NEAR(ob_dot(slid, dir) / way, 1, 1e-3);
	little_close(&u);
	free(s);
}

int main(void)
{
	for (double turn = 0; turn < 1; turn += .6) {
		on_the_huge(ob_v3(.0005, .0005, .0005), turn, 1e-6);
		on_the_huge(ob_v3(.005, .005, .005), turn, 1e-3);
		on_the_huge(ob_v3(1, 1, .001), turn, 8);
		on_the_huge(ob_v3(2, .005, .005), turn, 1);
		on_the_huge(ob_v3(.25, .005, 1), turn, 10);
		on_the_huge(ob_v3(2, 2, 2), turn, 6e4);
	}
	return check_end();
}
