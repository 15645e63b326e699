// Limits, springs, dampers, rotors, friction, motors, and breaks along hinges and slides, beside closed forms.
#include "mechanism.h"

#include "check.h"

// A ball of 2 kg on a slide along x.
static mechanism *create_slide(void)
{
	mechanism *m = mechanism_create(gravity);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2, ob_v3(0, 0, 0));
	mechanism_join(m, OB_JOINT_SLIDER, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), (ob_quat){ M_SQRT1_2, 0, M_SQRT1_2, 0 });
	return m;
}

// A pendulum falls on its limit: each hit takes 1 - e^2 of the energy above that of the limit, and in the end it rests.
static void test_limit(void)
{
	const double at = 1.2, e = .5, rest = -gravity * cos(M_PI / 2 - at);
	mechanism *m = mechanism_pendulum(M_PI / 2);
	ob_joint_axis *a = mechanism_drive(m);
	a->high = at, a->restitution = e;
	double energy = mechanism_energy(m);
	for (int hits = 0; hits < 4;) {
		mechanism_step(m);
		const double now = mechanism_energy(m);
		if (fabs(now - energy) < 1e-3 * (energy - rest))
			continue;
		CHECK_NEAR(now - rest, e * e * (energy - rest), 1e-7 * (energy - rest));
		energy = now;
		hits++;
	}
	mechanism_steps(m, 300);
	CHECK_NEAR(atan2(m->motion[0].p.x, -m->motion[0].p.z), M_PI / 2 - at, 1e-10);
	CHECK(ob_norm(m->motion[0].w) < 1e-10);
	mechanism_destroy(m);
}

// A link between two limits that hits them while its neighbour rests on another one: nothing passes a limit.
static void test_limits_of_links(void)
{
	mechanism *m = mechanism_create(gravity);
	for (uint32_t i = 0; i < 3; i++) {
		mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(i + 1, 0, 0));
		mechanism_join(m, OB_JOINT_HINGE, i, i ? i - 1 : OB_JOINT_WORLD, ob_v3(i, 0, 0), y_axis);
		ob_joint_axis *a = mechanism_drive(m);
		a->low = -.2, a->high = .3, a->restitution = .3;
	}
	const double begin = mechanism_energy(m);
	double last = begin;
	for (int i = 0; i < 600; i++) {
		mechanism_step(m);
		CHECK(mechanism_energy(m) < last + 1e-7 * begin + 1e-6);
		last = mechanism_energy(m);
	}
	for (int i = 0; i < 3; i++)
		CHECK_NEAR(2 * asin(m->motion[i].q.y), .3 * (i + 1), 1e-9);
	mechanism_destroy(m);
}

static void test_spring(void)
{
	const double k = 50, stretch = .3, rate = sqrt(k / 2);
	mechanism *m = create_slide();
	ob_joint_axis *a = mechanism_drive(m);
	a->stiffness = k, a->rest = stretch;
	for (int i = 1; i <= 600; i++) {
		mechanism_step(m);
		CHECK_NEAR(m->motion[0].p.x, stretch * (1 - cos(rate * i * step_length)), 1e-7);
	}
	mechanism_destroy(m);
}

// Steps a slide that was let go at rest .3 m from where its spring is, beside the closed form.
static void check_damped(mechanism *m, double decay, double rate)
{
	for (int i = 1; i <= 300; i++) {
		const double t = i * step_length;
		mechanism_step(m);
		CHECK_NEAR(m->motion[0].p.x, .3 - .3 * exp(-decay * t) * (cos(rate * t) + decay / rate * sin(rate * t)),
			   1e-7);
	}
}

static void test_damped_spring(void)
{
	const double k = 50, c = 3, decay = c / 4, rate = sqrt(k / 2 - decay * decay);
	mechanism *m = create_slide();
	ob_joint_axis *a = mechanism_drive(m);
	a->stiffness = k, a->damping = c, a->rest = .3;
	check_damped(m, decay, rate);
	mechanism_destroy(m);
}

// A rotor adds its inertia to that along the axis, with springs and dampers, and where a limit is hit.
static void test_armature(void)
{
	const double k = 50, c = 3, all = 2 + 5, decay = c / (2 * all), rate = sqrt(k / all - decay * decay);
	mechanism *m = create_slide();
	ob_joint_axis *a = mechanism_drive(m);
	a->stiffness = k, a->damping = c, a->rest = .3, a->armature = 5;
	check_damped(m, decay, rate);
	mechanism_destroy(m);
	m = create_slide();
	a = mechanism_drive(m);
	a->high = 1, a->restitution = .5, a->armature = 5, a->stiffness = 7, a->rest = 2;
	double most = 0;
	for (int i = 1; i <= 600; i++) {
		const double t = i * step_length, hit = M_PI / 3;
		mechanism_step(m);
		if (t < hit) // then its rate is sin(hit) * 2
			CHECK_NEAR(m->motion[0].p.x, 2 - 2 * cos(t), 1e-7);
		else if (t < hit + .5)
			CHECK_NEAR(m->motion[0].p.x, 2 - cos(t - hit) - sin(hit) * sin(t - hit), 1e-6);
		most = ob_max(most, m->motion[0].p.x);
	}
	CHECK(most < 1 + 1e-9);
	mechanism_destroy(m);
}

// A pendulum with a rotor swings as one with a greater moment, which its period tells.
static void test_armature_of_hinge(void)
{
	const double rotor = .7, amplitude = .5;
	mechanism *m = mechanism_pendulum(amplitude), *heavy = mechanism_pendulum(amplitude);
	mechanism_drive(m)->armature = rotor;
	heavy->passport[0].inertia.y += rotor;
	mechanism_steps(m, 300), mechanism_steps(heavy, 300);
	CHECK(ob_norm(ob_sub(m->motion[0].p, heavy->motion[0].p)) < 1e-7);
	CHECK(ob_norm(ob_sub(m->motion[0].v, heavy->motion[0].v)) < 1e-7);
	mechanism_destroy(m), mechanism_destroy(heavy);
}

// Two slides with dampers on one body that is free, alike: they move alike, and as the closed form says.
static void test_dampers(void)
{
	const double c = 20, rate = c * (1 + 2. / 3);
	mechanism *m = mechanism_create(0);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 3, ob_v3(0, 0, 0));
	for (uint32_t i = 1; i < 3; i++) {
		mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, i == 1 ? -1 : 1, 0));
		mechanism_join(m, OB_JOINT_SLIDER, i, 0, ob_v3(0, i == 1 ? -1 : 1, 0),
			       (ob_quat){ M_SQRT1_2, 0, M_SQRT1_2, 0 });
		mechanism_drive(m)->damping = c;
		m->motion[i].v = ob_v3(1, 0, 0);
	}
	for (int i = 1; i <= 60; i++) {
		mechanism_step(m);
		CHECK_NEAR(m->motion[1].p.x, m->motion[2].p.x, 1e-11);
		CHECK_NEAR(m->motion[1].p.x - m->motion[0].p.x, (1 - exp(-rate * i * step_length)) / rate, 1e-7);
	}
	mechanism_destroy(m);
}

// Two dampers with next to no mass between them are as one of half their strength.
static void test_dampers_in_line(void)
{
	const double c = 30, rate = c / 2 / 2;
	const ob_quat along_x = { M_SQRT1_2, 0, M_SQRT1_2, 0 };
	mechanism *m = mechanism_create(0);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2, ob_v3(0, 0, 0));
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2e-6, ob_v3(0, 0, 0));
	mechanism_join(m, OB_JOINT_SLIDER, 1, OB_JOINT_WORLD, ob_v3(0, 0, 0), along_x);
	mechanism_drive(m)->damping = c;
	mechanism_join(m, OB_JOINT_SLIDER, 0, 1, ob_v3(0, 0, 0), along_x);
	mechanism_drive(m)->damping = c;
	m->motion[0].v = ob_v3(1, 0, 0), m->motion[1].v = ob_v3(.5, 0, 0);
	for (int i = 1; i <= 60; i++) {
		mechanism_step(m);
		CHECK_NEAR(m->motion[0].p.x, (1 - exp(-rate * i * step_length)) / rate, 1e-4);
	}
	mechanism_destroy(m);
}

// A spring between two free bodies, along their distance.
static void test_spring_between(void)
{
	mechanism *m = mechanism_create(0);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 1, ob_v3(0, 0, 0));
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 3, ob_v3(1.2, 0, 0));
	ob_joint_passport *j = mechanism_join(m, OB_JOINT_DISTANCE, 0, 1, ob_v3(0, 0, 0), ob_quat_identity());
	j->frame[1].p = ob_v3(0, 0, 0), j->length = 1.2;
	ob_joint_axis *a = mechanism_drive(m);
	a->stiffness = 30, a->rest = 1;
	const double rate = sqrt(30 / .75);
	for (int i = 1; i <= 300; i++) {
		mechanism_step(m);
		CHECK_NEAR(m->motion[1].p.x - m->motion[0].p.x, 1 + .2 * cos(rate * i * step_length), 1e-7);
	}
	mechanism_destroy(m);
}

// Dry friction stops a slide where it must, and then holds it.
static void test_friction(void)
{
	mechanism *m = create_slide();
	ob_joint_axis *a = mechanism_drive(m);
	a->friction = 3;
	m->motion[0].v = ob_v3(2, 0, 0);
	mechanism_steps(m, 120);
	CHECK_NEAR(m->motion[0].p.x, 2. * 2 / (2 * 3. / 2), 1e-9);
	CHECK(ob_norm(m->motion[0].v) < 1e-12);
	m->passport[0].force = ob_v3(2.9, 0, 0);
	mechanism_steps(m, 60);
	CHECK_NEAR(m->motion[0].p.x, 4. / 3, 1e-9);
	m->passport[0].force = ob_v3(-3.5, 0, 0);
	mechanism_steps(m, 60);
	CHECK_NEAR(m->motion[0].p.x, 4. / 3 - .5 * .5 / 2, 1e-8);
	mechanism_destroy(m);
}

// The work of a motor is the energy gained: while its torque is all that it has, and while it holds a rate.
static void test_motor(void)
{
	mechanism *m = mechanism_pendulum(0);
	ob_joint_axis *a = mechanism_drive(m);
	const double most = 12, begin = mechanism_energy(m);
	a->motor = OB_MOTOR_RATE, a->target = -20, a->most = most;
	double turned = 0, last = 0;
	for (int i = 0; i < 120; i++) {
		mechanism_step(m);
		const double angle = atan2(m->motion[0].p.x, -m->motion[0].p.z);
		turned += remainder(angle - last, 2 * M_PI);
		last = angle;
		if (m->motion[0].w.y > -20 + 1e-6)
			CHECK_NEAR(mechanism_energy(m) - begin, most * turned, 1e-6 * most * fabs(turned) + 1e-9);
	}
	CHECK(turned > 4 * M_PI);
	mechanism_steps(m, 300);
	CHECK_NEAR(m->motion[0].w.y, -20, 1e-9); // it holds the rate
	mechanism_destroy(m);
}

// A motor pulls to a value against the weight; one that is too weak hangs where its force allows.
static void test_servo(void)
{
	mechanism *m = mechanism_pendulum(0);
	ob_joint_axis *a = mechanism_drive(m);
	a->motor = OB_MOTOR_VALUE, a->target = -1, a->motor_stiffness = 1000, a->motor_damping = 60, a->most = INFINITY;
	mechanism_steps(m, 300);
	const double angle = atan2(m->motion[0].p.x, -m->motion[0].p.z);
	CHECK_NEAR(1000 * (1 - angle), gravity * sin(angle), 1e-6);
	a->most = 5;
	mechanism_steps(m, 3000);
	CHECK(fabs(atan2(m->motion[0].p.x, -m->motion[0].p.z)) < 1.2);
	mechanism_destroy(m);
}

// A motor that holds a rate against a weight: its mean torque is published, and the energy gained is its work.
static void test_work(void)
{
	mechanism *m = mechanism_pendulum(0);
	ob_joint_axis *a = mechanism_drive(m);
	a->motor = OB_MOTOR_RATE, a->target = -2, a->most = INFINITY;
	mechanism_steps(m, 2);
	const double begin = mechanism_energy(m);
	double work = 0, most = 0;
	for (int i = 0; i < 300; i++) {
		mechanism_step(m);
		work += m->load[0].along * a->target * step_length;
		most = ob_max(most, fabs(work));
		CHECK_NEAR(mechanism_energy(m) - begin, work, 1e-6 * most);
		CHECK_NEAR(m->load[0].torque.y, m->load[0].along, 1e-9 * most);
	}
	CHECK(most > 10);
	mechanism_destroy(m);
}

// A beam that the world holds at one end: its weight, and the moment of it.
static void test_load(void)
{
	mechanism *m = mechanism_create(gravity);
	const uint32_t beam = mechanism_add(m, OB_SHAPE_BOX, ob_v3(2, .2, .2), 3, ob_v3(1, 0, 0));
	mechanism_join(m, OB_JOINT_FIXED, beam, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	mechanism_steps(m, 10);
	CHECK(ob_norm(ob_sub(m->load[0].force, ob_v3(0, 0, 3 * gravity))) < 1e-8);
	CHECK(ob_norm(ob_sub(m->load[0].torque, ob_v3(0, -3 * gravity, 0))) < 1e-8);
	CHECK(m->load[0].along == 0 && !m->load[0].broke);
	m->joint[0].breaks_torque = 3 * gravity * (1 + 1e-6);
	mechanism_steps(m, 10);
	CHECK(!m->load[0].broke);
	m->joint[0].breaks_torque = 3 * gravity * (1 - 1e-6);
	mechanism_step(m);
	CHECK(m->load[0].broke);
	CHECK_NEAR(m->motion[beam].v.z, -gravity * step_length, 1e-9); // from the step's begin it falls
	CHECK(ob_norm(m->motion[beam].w) < 1e-9);
	mechanism_destroy(m);
}

// Swing of a bob on a ball joint, let go level: angle below the level, its rate, and the joint's force.
typedef struct swing {
	double angle, rate;
} swing;

static swing swung(swing s, double k, double h)
{
	const double a1 = k * cos(s.angle), r2 = s.rate + .5 * h * a1, a2 = k * cos(s.angle + .5 * h * s.rate),
		     r3 = s.rate + .5 * h * a2, a3 = k * cos(s.angle + .5 * h * r2), r4 = s.rate + h * a3,
		     a4 = k * cos(s.angle + h * r3);
	return (swing){ s.angle + h / 6 * (s.rate + 2 * r2 + 2 * r3 + r4),
			s.rate + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4) };
}

// The joint breaks within a substep of the instant at which its force is reached.
static void test_break(void)
{
	enum { FINE = 1000 };
	const double mass = 2, radius = .1, inertia = .4 * mass * radius * radius + mass, k = mass * gravity / inertia;
	mechanism *m = mechanism_create(gravity);
	const uint32_t bob = mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(radius, radius, radius), mass, ob_v3(1, 0, 0));
	ob_joint_passport *j =
		mechanism_join(m, OB_JOINT_BALL, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	const double sub = step_length / m->run.substeps, fine = sub / FINE;
	j->breaks_force = 2 * mass * gravity;
	swing now = { 0, 0 };
	double reached = 0, broke = 0;
	for (double force = 0; force < j->breaks_force;) {
		now = swung(now, k, fine);
		reached += fine;
		const double pull = mass * now.rate * now.rate + mass * gravity * sin(now.angle),
			     across = mass * (k - gravity) * cos(now.angle);
		force = sqrt(pull * pull + across * across);
	}
	for (int i = 0; i < 100 && !m->load[0].broke; i++)
		mechanism_step(m);
	CHECK(m->load[0].broke && ob_norm(m->load[0].force) > j->breaks_force);
	CHECK(ob_norm(m->load[0].force) < 1.1 * j->breaks_force);
	for (now = (swing){ 0, 0 }; now.rate < m->motion[bob].w.y;
	     now = swung(now, k, fine)) // it keeps its spin from then on
		broke += fine;
	CHECK(fabs(broke - reached) < sub);
	mechanism_destroy(m);
}

// The weakest of three links breaks, and the others hold what is left.
static void test_weakest(void)
{
	mechanism *m = mechanism_create(gravity);
	for (uint32_t i = 0; i < 3; i++) {
		const uint32_t link = mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, .1, .1), 1, ob_v3(0, 0, -1. - i));
		ob_joint_passport *j = mechanism_join(m, OB_JOINT_BALL, link, i ? link - 1 : OB_JOINT_WORLD,
						      ob_v3(0, 0, -.0 - i), ob_quat_identity());
		j->breaks_force = (i == 1 ? 1.9 : 2.5) * gravity; // they bear 3, 2 and 1 weights
	}
	m->joint[0].breaks_force = 3.5 * gravity;
	mechanism_step(m);
	CHECK(!m->load[0].broke && m->load[1].broke && !m->load[2].broke);
	CHECK_NEAR(m->motion[0].p.z, -1, 1e-12);
	CHECK_NEAR(m->load[0].force.z, gravity, 1e-8);
	CHECK_NEAR(ob_norm(m->load[2].force), 0, 1e-8); // they fall together
	mechanism_destroy(m);
}

// A ball that friction holds on an upright slide stays there, also in steps that begin beside the slide.
static void test_put_aside(void)
{
	mechanism *m = mechanism_create(gravity);
	mechanism_add(m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), 2, ob_v3(0, 0, 0));
	mechanism_join(m, OB_JOINT_SLIDER, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	mechanism_drive(m)->friction = 30;
	for (int i = 0; i < 60; i++) {
		m->motion[0].p.y = i % 2 ? .01 : 0;
		mechanism_step(m);
		CHECK_NEAR(m->motion[0].p.z, 0, 1e-9);
		CHECK_NEAR(m->motion[0].p.y, 0, 1e-9);
	}
	mechanism_destroy(m);
}

// A pendulum that no number of substeps can follow asks for no more than there may be.
static void test_too_fast(void)
{
	mechanism *m = mechanism_pendulum(M_PI / 2);
	m->motion[0].w.y = 1e5, m->motion[0].v = ob_cross(m->motion[0].w, m->motion[0].p);
	for (int i = 0; i < 3; i++) {
		mechanism_step(m);
		CHECK(m->motion[0].substeps <= OB_MAX_SUBSTEPS);
	}
	CHECK(m->motion[0].substeps == OB_MAX_SUBSTEPS);
	mechanism_destroy(m);
}

int main(void)
{
	test_too_fast();
	test_put_aside();
	test_armature();
	test_armature_of_hinge();
	test_dampers();
	test_dampers_in_line();
	test_limit();
	test_limits_of_links();
	test_spring();
	test_damped_spring();
	test_spring_between();
	test_friction();
	test_motor();
	test_servo();
	test_work();
	test_load();
	test_break();
	test_weakest();
	return check_end();
}
