// Hits of bodies that joints link: with the restitution of the contact, whatever they are made of.
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.joint);
	free(s);
}

static ob_pose at(double x, double z)
{
	return (ob_pose){ { x, 0, z }, ob_quat_identity() };
}

// A bar of 8 kg and 2 m in n pieces that are fixed together, turned about y, falls at 3 m/s on the ground, without gravity.
// Returns its state after the hit, of the piece at its lower end.
static ob_state fall(int n, double tilt, double e, double mu, double *energy)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = OB_DEFAULT_TOLERANCE;
	ob_world_ground(&s->world);
	const ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, tilt, 0));
	const ob_mat3 r = ob_quat_matrix(q);
	for (int i = 0; i < n; i++) {
		const ob_vec3 p = ob_madd(ob_v3(0, 0, 2), (i + .5) / n * 2 - 1, ob_column(&r, 0));
		ob_world_body b = ob_world_box(&s->world, 8. / n, ob_v3(1. / n, .5, .5), p);
		b.state->pose.q = q;
		b.state->v.z = -3;
	}
	for (uint32_t i = 1; i < (uint32_t)n; i++)
		ob_world_join(&s->world, OB_JOINT_FIXED, 1 + i, i, at(0, 2));
	ob_world_material(&s->world, mu, e);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 40);
	const ob_state end = little_state(&l, (uint32_t)n);
	*energy = little_energy(&l);
	finish(&l, s);
	return end;
}

static void test_bar(void)
{
	static const struct {
		double tilt, e, mu, within; // rad; share of the energy
	} hit[] = { { 0, .5, 0, 1e-12 },
		    { M_PI / 2, .5, .4, 1e-12 },
		    { .5, .5, .4, 1e-6 },
		    { 1.2, .8, .2, 1e-6 },
		    { .5, 1, 0, .01 } }; // the last one hits with both ends in one partial substep
	for (int k = 0; k < 5; k++) {
		double whole, energy;
		const ob_state one = fall(1, hit[k].tilt, hit[k].e, hit[k].mu, &whole);
		for (int n = 2; n <= 5; n++) {
			const ob_state last = fall(n, hit[k].tilt, hit[k].e, hit[k].mu, &energy);
			CHECK_NEAR(energy / whole, 1, hit[k].within);
			CHECK_NEAR(ob_norm(ob_sub(last.w, one.w)), 0, 2 * hit[k].within);
		}
	}
}

// A ball hits a rod that hangs on a hinge, at so much of its length: the pair parts at e times the speed at which it met.
static void test_pendulum(void)
{
	const double e = .6, speed = 4, length = 1.6, mass = 3, ball = .7;
	for (double share = .25; share <= 1; share += .25) {
		little_scene *s = little_scene_new();
		s->run.gravity = ob_v3(0, 0, 0);
		s->run.tolerance = OB_DEFAULT_TOLERANCE;
		ob_world_body rod =
			ob_world_box(&s->world, mass, ob_v3(.05, .05, .5 * length), ob_v3(0, 0, -.5 * length));
		const double height = -share * (length - .2);
		ob_world_sphere(&s->world, ball, .1, ob_v3(-.5, 0, height)).state->v.x = speed;
		ob_world_join(&s->world, OB_JOINT_HINGE, 0, OB_JOINT_WORLD,
			      (ob_pose){ { 0, 0, 0 }, { M_SQRT1_2, -M_SQRT1_2, 0, 0 } });
		ob_world_material(&s->world, 0, e);
		const double inertia = rod.passport->inertia.y + .25 * mass * length * length;
		little_universe l;
		little_open(&l, s);
		little_run(&l, 12);
		const double arm = -height, effective = 1 / (1 / ball + arm * arm / inertia),
			     impulse = (1 + e) * speed * effective;
		CHECK_NEAR(little_state(&l, 1).v.x, speed - impulse / ball, 1e-9);
		CHECK_NEAR(ob_norm(little_state(&l, 0).w), impulse * arm / inertia, 1e-7);
		finish(&l, s);
	}
}

// A chain of bars flies against a ball: all of its links are hit, momentum and angular momentum stay, and so does energy with e = 1.
static void test_chain(void)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = OB_DEFAULT_TOLERANCE;
	enum { LINKS = 6 };
	for (uint32_t i = 0; i < LINKS; i++) {
		ob_world_box(&s->world, 1 + i % 2, ob_v3(.2, .05, .05), ob_v3(.4 * i, 0, 0)).state->v.y = 2;
		if (i)
			ob_world_join(&s->world, OB_JOINT_BALL, i, i - 1, at(.4 * i - .2, 0));
	}
	ob_world_sphere(&s->world, 2, .2, ob_v3(.9, 1, .03));
	ob_world_material(&s->world, 0, 1);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 0);
	const ob_vec3 momentum = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	const double energy = little_energy(&l);
	little_run(&l, 60);
	CHECK(little_state(&l, LINKS).v.y > 1);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_momentum(&l.now), momentum)), 0, 1e-11);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), spin)), 0, 1e-5);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-4);
	printf("chain: %.3g of its energy lost\n", 1 - little_energy(&l) / energy);
	finish(&l, s);
}

int main(void)
{
	test_bar();
	test_pendulum();
	test_chain();
	return check_end();
}
