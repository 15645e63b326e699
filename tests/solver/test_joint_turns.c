// Springs, dampers, rotors, and limits of the turns of balls and universals, beside closed forms.
#include "mechanism.h"

#include "motion/joint_value.h"
#include "check.h"

// ---- axes of balls and universals

// A ball of 3 kg, whose moment is "moment", that turns about its centre.
static const double moment = .4 * 3 * .2 * .2;

static mechanism *create_gimbal(ob_joint_kind kind)
{
	mechanism *m = mechanism_create(gravity);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.2, 0, 0), 3, ob_v3(0, 0, 0));
	mechanism_join(m, kind, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	return m;
}

// Value at t (s) of what was at "from", with this rate, on a spring (N m) with a damper (N m s) and so much inertia (kg m^2).
static double swinging(double t, double from, double speed, double spring, double damper, double inertia)
{
	const double decay = damper / (2 * inertia), rate = sqrt(spring / inertia - decay * decay);
	return exp(-decay * t) * (from * cos(rate * t) + (speed + decay * from) / rate * sin(rate * t));
}

static double value_of(const mechanism *m, uint32_t joint)
{
	const ob_joint_passport *j = &m->joint[joint];
	ob_state state[2] = { { .pose.q = ob_quat_identity() }, { .pose.q = ob_quat_identity() } };
	double value = NAN, rate;
	for (int side = 0; side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD) {
			const ob_motion *x = &m->motion[j->object[side]];
			state[side] = (ob_state){ { x->p, x->q }, x->v, x->w };
		}
	CHECK(ob_joint_value(j, state, &value, &rate));
	return value;
}

// About one axis a ball on a spring is a hinge, also by more than a right angle.
static void test_spring_of_ball(void)
{
	static const struct {
		double damper, rotor;
	} each[] = { { 0, 0 }, { .02, 0 }, { 0, .1 }, { .05, .1 } };
	const double spring = .8, from = 2.2;
	for (size_t k = 0; k < sizeof each / sizeof *each; k++) {
		const double damper = each[k].damper, inertia = moment + each[k].rotor;
		mechanism *m = create_gimbal(OB_JOINT_BALL);
		ob_joint_axis *a = mechanism_drive(m);
		a->stiffness = spring, a->damping = damper, a->armature = each[k].rotor;
		m->motion[0].q =
			(ob_quat){ cos(from / 2), .48 * sin(from / 2), .64 * sin(from / 2), .6 * sin(from / 2) };
		double most = 0;
		for (int i = 1; i <= 240; i++) {
			mechanism_step(m);
			const double at = swinging(i * step_length, from, 0, spring, damper, inertia);
			most = fmax(most, fabs(value_of(m, 0) - fabs(at)));
		}
		printf("ball on a spring, damper %g, rotor %g: %.3g rad off\n", damper, each[k].rotor, most);
		CHECK(most < 1e-6);
		mechanism_destroy(m);
	}
}

// The torque of a ball's spring has a potential, whatever its turns, and its damper takes energy alone.
static void test_energy_of_ball(void)
{
	for (int damped = 0; damped < 2; damped++) {
		mechanism *m = mechanism_create(gravity);
		const uint32_t arm = mechanism_add(m, OB_SHAPE_BOX, ob_v3(.1, .2, .6), 2, ob_v3(0, 0, .6)),
			       hand = mechanism_add(m, OB_SHAPE_BOX, ob_v3(.1, .05, .3), 1, ob_v3(0, 0, 1.5));
		mechanism_join(m, OB_JOINT_BALL, arm, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
		mechanism_drive(m)->stiffness = 30;
		mechanism_join(m, OB_JOINT_BALL, hand, arm, ob_v3(0, 0, 1.2), ob_quat_identity());
		ob_joint_axis *a = mechanism_drive(m);
		a->stiffness = 5, a->armature = .2, a->damping = damped ? .3 : 0;
		m->motion[arm].w = ob_v3(1.5, .5, 2), m->motion[hand].w = ob_v3(-1, 3, 1);
		mechanism_step(m);
		double begin = NAN, last = INFINITY, most = 0;
		for (int i = 0; i < 600; i++) {
			const ob_vec3 relative = ob_sub(m->motion[hand].w, m->motion[arm].w);
			const double now = mechanism_energy(m) + .5 * 30 * value_of(m, 0) * value_of(m, 0) +
					   .5 * 5 * value_of(m, 1) * value_of(m, 1) + .5 * .2 * ob_norm2(relative);
			begin = isnan(begin) ? now : begin;
			most = fmax(most, fabs(now - begin));
			CHECK(!damped || now < last + 1e-7);
			last = now;
			mechanism_step(m);
		}
		printf("two balls on springs%s: energy within %.3g of %.3g J\n", damped ? " and a damper" : "", most,
		       begin);
		CHECK(damped ? last < begin - .1 : most < 1e-5 * begin);
		CHECK(mechanism_parted(m) < 1e-12);
		mechanism_destroy(m);
	}
}

// A rotor that turns with a top adds to each of its moments.
static void test_rotor_of_ball(void)
{
	const double rotor = .05;
	mechanism *m[2];
	for (int k = 0; k < 2; k++) {
		m[k] = mechanism_create(gravity);
		mechanism_add(m[k], OB_SHAPE_BOX, ob_v3(.3, .2, .05), 1, ob_v3(0, 0, .4));
		mechanism_join(m[k], OB_JOINT_BALL, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
		if (k)
			m[k]->passport[0].inertia = ob_add(m[k]->passport[0].inertia, ob_v3(rotor, rotor, rotor));
		else
			mechanism_drive(m[k])->armature = rotor;
		m[k]->motion[0].w = ob_v3(.3, .2, 12);
		mechanism_steps(m[k], 200);
	}
	const double apart = ob_norm(ob_sub(m[0]->motion[0].p, m[1]->motion[0].p));
	printf("top with a rotor: %.3g m from one with its moments\n", apart);
	CHECK(apart < 1e-6);
	mechanism_destroy(m[0]), mechanism_destroy(m[1]);
}

// Springs, dampers and rotors of joints of bodies in free space change no momentum.
static void test_momentum_of_balls(void)
{
	for (int universal = 0; universal < 2; universal++) {
		mechanism *m = mechanism_create(0);
		for (uint32_t i = 0; i < 2; i++)
			mechanism_add(m, OB_SHAPE_BOX, ob_v3(.1, .2, .4), 1 + i, ob_v3(0, .1 * i, 1. * i));
		mechanism_join(m, universal ? OB_JOINT_UNIVERSAL : OB_JOINT_BALL, 0, 1, ob_v3(0, .05, .5),
			       ob_quat_identity());
		ob_joint_axis *a = mechanism_drive(m);
		a->stiffness = 4, a->damping = .2, a->armature = .1, m->joint[0].second = *a;
		m->motion[0].w = ob_v3(1, 2, .3), m->motion[1].w = ob_v3(.3, -1, .2);
		mechanism_step(m);
		const ob_vec3 first = ob_add(mechanism_spin(m, 0), mechanism_spin(m, 1));
		const ob_vec3 orbit = ob_add(ob_cross(m->motion[0].p, m->motion[0].v),
					     ob_scale(ob_cross(m->motion[1].p, m->motion[1].v), 2));
		const ob_vec3 p = ob_add(m->motion[0].v, ob_scale(m->motion[1].v, 2));
		mechanism_steps(m, 300);
		const ob_vec3 spin = ob_add(mechanism_spin(m, 0), mechanism_spin(m, 1));
		const ob_vec3 orbits = ob_add(ob_cross(m->motion[0].p, m->motion[0].v),
					      ob_scale(ob_cross(m->motion[1].p, m->motion[1].v), 2));
		CHECK(ob_norm(ob_sub(ob_add(m->motion[0].v, ob_scale(m->motion[1].v, 2)), p)) < 1e-11);
		CHECK(ob_norm(ob_sub(ob_add(spin, orbits), ob_add(first, orbit))) < 1e-11);
		mechanism_destroy(m);
	}
}

// A pendulum in a ball joint falls on the cone of its greatest turn: hits as those of a hinge, then it rests there.
static void test_limit_of_ball(void)
{
	const double at = .7, e = .5;
	mechanism *m = mechanism_create(gravity);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 1)); // upside down
	mechanism_join(m, OB_JOINT_BALL, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	ob_joint_axis *a = mechanism_drive(m);
	a->high = at, a->restitution = e;
	m->motion[0].w = ob_v3(.3, .4, 0), m->motion[0].v = ob_v3(.4, -.3, 0);
	const double rest = gravity * cos(at);
	double energy = mechanism_energy(m);
	for (int hits = 0; hits < 4;) {
		mechanism_step(m);
		const double now = mechanism_energy(m);
		CHECK(value_of(m, 0) < at + 1e-9);
		if (fabs(now - energy) < 1e-3 * (energy - rest))
			continue;
		CHECK_NEAR(now - rest, e * e * (energy - rest), 1e-6 * (energy - rest));
		energy = now;
		hits++;
	}
	mechanism_steps(m, 300);
	CHECK_NEAR(value_of(m, 0), at, 1e-9);
	printf("w %g %g %g v %g\n", m->motion[0].w.x, m->motion[0].w.y, m->motion[0].w.z, value_of(m, 0) - at);
	mechanism_destroy(m);
}

// Turn of the second arm of a universal in the world, y.
static double second_value(const mechanism *m)
{
	const ob_mat3 r = ob_quat_matrix(m->motion[0].q);
	return atan2(-r.m[2][0], r.m[0][0]);
}

// The turns of a ball about the arms of a cross are those of two hinges, which know nothing of each other.
static void test_axes_of_universal(void)
{
	mechanism *m = create_gimbal(OB_JOINT_UNIVERSAL);
	ob_joint_axis *a = mechanism_drive(m), *b = &m->joint[0].second;
	a->stiffness = .6, a->damping = .01, a->armature = .02;
	b->low = -INFINITY, b->high = INFINITY;
	b->stiffness = .9, b->damping = .03;
	m->motion[0].w = ob_v3(5, 4, 0);
	double most = 0;
	for (int i = 1; i <= 300; i++) {
		const double t = i * step_length;
		mechanism_step(m);
		most = fmax(most, fabs(value_of(m, 0) - swinging(t, 0, 5, .6, .01, moment + .02)));
		most = fmax(most, fabs(second_value(m) - swinging(t, 0, 4, .9, .03, moment)));
	}
	printf("universal on springs: %.3g rad off\n", most);
	CHECK(most < 1e-6);
	mechanism_destroy(m);
	m = create_gimbal(OB_JOINT_UNIVERSAL);
	a = mechanism_drive(m), b = &m->joint[0].second;
	a->high = .9, a->restitution = 1, a->low = -.5;
	*b = *a, b->high = .4, b->low = -INFINITY;
	m->motion[0].w = ob_v3(2, 1, 0);
	mechanism_steps(m, 60); // s: the first turns by 2 rad, to .9 and back to -.2; the second by 1, to .4 and back
	CHECK_NEAR(value_of(m, 0), .9 - (2 - .9), 1e-9);
	CHECK_NEAR(second_value(m), -.2, 1e-9);
	mechanism_destroy(m);
}

// The action of a universal and a ball has the torques of their springs, and they break by them.
static void test_loads_of_balls(void)
{
	for (int universal = 0; universal < 2; universal++) {
		mechanism *m = create_gimbal(universal ? OB_JOINT_UNIVERSAL : OB_JOINT_BALL);
		ob_joint_axis *a = mechanism_drive(m);
		a->stiffness = 2;
		m->joint[0].second = (ob_joint_axis){ .low = -INFINITY, .high = INFINITY };
		m->motion[0].q = (ob_quat){ cos(.05), sin(.05), 0, 0 };
		m->run.step_length = 1e-4; // little of a swing
		mechanism_step(m);
		CHECK_NEAR(m->load[0].torque.x, -.2, 1e-5);
		CHECK_NEAR(m->load[0].along, universal ? -.2 : 0, 1e-5);
		CHECK_NEAR(m->load[0].force.z, 3 * gravity, 1e-6);
		m->joint[0].breaks_torque = .1;
		mechanism_step(m);
		CHECK(m->load[0].broke);
		mechanism_destroy(m);
	}
}

int main(void)
{
	test_spring_of_ball();
	test_energy_of_ball();
	test_rotor_of_ball();
	test_momentum_of_balls();
	test_limit_of_ball();
	test_axes_of_universal();
	test_loads_of_balls();
	return check_end();
}
