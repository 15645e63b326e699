// All engines with joints join the same: each kind, each force along an axis, and each way round. Bounds as in test_engine.c.
//
// test_joints NAME    77 (skipped): not built in
#include <stdlib.h>
#include <string.h>

#include "little_world.h"

#include "../check.h"

static const ob_engine_kind *kind;
static const double g = OB_WORLD_GRAVITY;
static const ob_quat along_x = { M_SQRT1_2, 0, M_SQRT1_2, 0 }, along_y = { M_SQRT1_2, -M_SQRT1_2, 0, 0 };

static ob_joint_passport *join(little_world *l, ob_joint_kind what, uint32_t a, uint32_t b, ob_vec3 at, ob_quat q)
{
	return ob_world_join(&l->world, what, a, b, (ob_pose){ at, q });
}

// Runs, with many iterations, if the engine has such joints; else it must name the last one.
static bool run(little_world *l, double seconds)
{
	ob_error e = { "" };
	ob_run_settings s = kind->usual;
	s.substeps = 32, s.iterations = s.iterations ? 100 : 0;
	const bool can = kind->takes_joints(&l->world, &e);
	CHECK(can || strstr(e.text, l->world.joint[l->world.joints - 1].name));
	ob_engine *p = can ? kind->create(&l->world, &s, &e) : NULL;
	CHECK(!can || p);
	if (p)
		little_step(kind, p, l, seconds);
	kind->destroy(p);
	return p;
}

// ---- kinds

// Time between two passages of the lowest point is half the period: 4 K(sin 45 degrees) sqrt(moment / (m g)).
static void pendulum(void)
{
	const double moment = 1 + .4 * .01, exact = 4 * 1.8540746773013719 * sqrt(moment / g);
	little_world *l = little_world_new();
	const uint32_t bob = little_sphere(l, 1, .1, ob_v3(1, 0, 0));
	join(l, OB_JOINT_HINGE, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), along_y);
	ob_engine *p = little_make(kind, l, 16);
	double before = 1, passed[2] = { 0 };
	for (int frame = 1, n = 0; n < 2 && frame < 200; frame++) {
		little_step(kind, p, l, 1. / 60);
		const double now = l->now[bob].pose.p.x;
		if (now * before < 0)
			passed[n++] = (frame - now / (now - before)) / 60;
		before = now;
	}
	CHECK_NEAR(2 * (passed[1] - passed[0]), exact, .003 * exact);
	CHECK_NEAR(l->now[bob].pose.p.y, 0, 1e-4);
	kind->destroy(p);
	little_world_free(l);
}

// A cone of 60 degrees: the bob goes round at one height.
static void cone(ob_joint_kind what)
{
	little_world *l = little_world_new();
	const double angle = M_PI / 3, rate = sqrt(g / cos(angle));
	const uint32_t bob = little_sphere(l, 1, .01, ob_v3(sin(angle), 0, -cos(angle)));
	l->world.state[bob].v = ob_v3(0, rate * sin(angle), 0);
	l->world.state[bob].w = ob_v3(0, 0, rate);
	ob_joint_passport *j = join(l, what, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	if (what == OB_JOINT_DISTANCE) {
		j->frame[0].p = ob_v3(0, 0, 0);
		j->length = 1;
	}
	if (run(l, 1)) {
		CHECK_NEAR(l->now[bob].pose.p.z, -cos(angle), .03);
		CHECK_NEAR(l->now[bob].pose.p.x, sin(angle) * cos(rate), .1);
		CHECK_NEAR(l->now[bob].pose.p.y, sin(angle) * sin(rate), .1);
	}
	little_world_free(l);
}

// Two cubes in a row stick out of a wall.
static void fixed(void)
{
	little_world *l = little_world_new();
	little_cube(l, 1, .1, ob_v3(.1, 0, 0));
	little_cube(l, 1, .1, ob_v3(.3, 0, 0));
	join(l, OB_JOINT_FIXED, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), along_x);
	join(l, OB_JOINT_FIXED, 0, 1, ob_v3(.2, 0, 0), along_y);
	if (run(l, 1))
		for (uint32_t id = 0; id < 2; id++)
			CHECK(ob_norm(ob_sub(l->now[id].pose.p, l->world.state[id].pose.p)) < .005);
	little_world_free(l);
}

// A cross swings both ways, and does not twist: the arm of the body stays across that of the world.
static void universal(void)
{
	little_world *l = little_world_new();
	const uint32_t bob = little_cube(l, 1, .1, ob_v3(0, 0, -1));
	l->world.state[bob].w = ob_v3(1, -2, 0);
	l->world.state[bob].v = ob_cross(l->world.state[bob].w, ob_v3(0, 0, -1));
	join(l, OB_JOINT_UNIVERSAL, bob, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity());
	if (run(l, .5)) {
		const ob_mat3 r = ob_quat_matrix(l->now[bob].pose.q);
		CHECK_NEAR(ob_column(&r, 0).y, 0, .01);
		CHECK(ob_norm(ob_add(l->now[bob].pose.p, ob_column(&r, 2))) < .01);
		CHECK_NEAR(l->now[bob].pose.p.x, 2 / sqrt(g) * sin(.5 * sqrt(g)), .1);
		CHECK_NEAR(l->now[bob].pose.p.y, 1 / sqrt(g) * sin(.5 * sqrt(g)), .1);
	}
	little_world_free(l);
}

// ---- loops, and motors that hold a rate

static void hold_rate(ob_joint_passport *j, double rate, double most)
{
	j->flags |= OB_JOINT_DRIVEN;
	j->axis.motor = OB_MOTOR_RATE, j->axis.target = rate, j->axis.most = most;
}

static ob_vec3 between(ob_vec3 a, ob_vec3 b)
{
	return ob_scale(ob_add(a, b), .5);
}

// Point at distances of 3 m from b and 2.5 m from (3, 0, 0).
static ob_vec3 coupled(ob_vec3 b)
{
	const ob_vec3 to = ob_sub(ob_v3(3, 0, 0), b);
	const double far = ob_norm(to), along = (9 - 6.25 + far * far) / (2 * far), above = sqrt(9 - along * along);
	return ob_madd(ob_madd(b, along / far, to), above / far, ob_v3(-to.z, 0, to.x));
}

// A crank of 1 m at 5 rad/s: all hinges are parallel, and the last closes a loop.
static void four_bar(void)
{
	const ob_vec3 a = ob_v3(0, 0, 0), b = ob_v3(0, 0, 1), c = coupled(b), d = ob_v3(3, 0, 0);
	little_world *l = little_world_new();
	little_sphere(l, 1, .1, between(a, b));
	little_sphere(l, 1, .1, between(b, c));
	little_sphere(l, 1, .1, between(c, d));
	hold_rate(join(l, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, a, along_y), 5, INFINITY);
	join(l, OB_JOINT_HINGE, 0, 1, b, along_y);
	join(l, OB_JOINT_HINGE, 1, 2, c, along_y);
	join(l, OB_JOINT_HINGE, 2, OB_JOINT_WORLD, d, along_y);
	if (run(l, .5)) {
		const ob_vec3 end = ob_v3(sin(2.5), 0, cos(2.5)), rocker = between(coupled(end), d);
		CHECK(ob_norm(ob_sub(l->now[0].pose.p, between(a, end))) < .02);
		CHECK(ob_norm(ob_sub(l->now[2].pose.p, rocker)) < .04);
	}
	little_world_free(l);
}

static void slider_crank(void)
{
	const double crank = .5, rod = 1.3, rate = 5;
	const ob_vec3 a = ob_v3(0, 0, 0), b = ob_v3(crank, 0, 0), c = ob_v3(crank + rod, 0, 0);
	little_world *l = little_world_new();
	little_sphere(l, 1, .1, between(a, b));
	little_sphere(l, 1, .1, between(b, c));
	little_cube(l, 2, .1, c);
	hold_rate(join(l, OB_JOINT_HINGE, 0, OB_JOINT_WORLD, a, along_y), -rate, INFINITY);
	join(l, OB_JOINT_HINGE, 0, 1, b, along_y);
	join(l, OB_JOINT_BALL, 1, 2, c, ob_quat_identity());
	join(l, OB_JOINT_SLIDER, 2, OB_JOINT_WORLD, c, along_x);
	if (run(l, .5)) {
		const double up = crank * sin(rate * .5);
		CHECK_NEAR(l->now[2].pose.p.x, crank * cos(rate * .5) + sqrt(rod * rod - up * up), .04);
		CHECK_NEAR(l->now[2].pose.p.z, 0, .001);
	}
	little_world_free(l);
}

// ---- along an axis: a cube of 2 kg that slides along x without weight, relative to a static one, either way round

typedef struct slide {
	little_world *l;
	ob_joint_axis *axis;
	double sign; // of the value, along x
} slide;

static slide begin_slide(bool first, double speed)
{
	slide s = { little_world_new(), NULL, first ? 1 : -1 };
	s.l->world.gravity = ob_v3(0, 0, 0);
	little_cube(s.l, 2, .1, ob_v3(0, 0, 0));
	little_cube(s.l, 0, .1, ob_v3(0, 5, 0));
	s.l->world.state[0].v.x = s.sign * speed;
	ob_joint_passport *j = join(s.l, OB_JOINT_SLIDER, !first, first, ob_v3(0, 0, 0), along_x);
	j->flags |= OB_JOINT_DRIVEN;
	s.axis = &j->axis;
	return s;
}

static void end_slide(slide s, double seconds, double value, double rate, double bound)
{
	if (run(s.l, seconds)) {
		CHECK_NEAR(s.sign * s.l->now[0].pose.p.x, value, bound);
		CHECK_NEAR(s.sign * s.l->now[0].v.x, rate, 5 * bound);
		CHECK(fabs(s.l->now[0].pose.p.y) + fabs(s.l->now[0].pose.p.z) + ob_norm(s.l->now[0].w) < 1e-4);
	}
	little_world_free(s.l);
}

static void along(bool first)
{
	slide s = begin_slide(first, 0);
	s.axis->stiffness = 50, s.axis->rest = .3;
	end_slide(s, 1, .3 * (1 - cos(5)), 1.5 * sin(5), .01);
	s = begin_slide(first, 2);
	s.axis->damping = 4;
	end_slide(s, 1, 1 - exp(-2), 2 * exp(-2), .01);
	s = begin_slide(first, 0);
	s.axis->motor = OB_MOTOR_RATE, s.axis->target = 1.5, s.axis->most = 3;
	end_slide(s, 2, 2.25, 1.5, .02);
	s = begin_slide(first, 0);
	s.axis->motor = OB_MOTOR_VALUE, s.axis->target = .3, s.axis->most = 100;
	s.axis->motor_stiffness = 50, s.axis->motor_damping = 100;
	end_slide(s, 5, .3 * (1 - exp(-2.5)), .15 * exp(-2.5), .02);
	s = begin_slide(first, 2);
	s.axis->friction = 4;
	end_slide(s, 2, 1, 0, .01);
	s = begin_slide(first, 1);
	s.axis->high = .5;
	end_slide(s, .6, .5, 0, .03);
	s = begin_slide(first, -1);
	s.axis->low = -.5, s.axis->high = 2, s.axis->restitution = 1;
	end_slide(s, 1, 0, 1, .05);
	s = begin_slide(first, 1);
	s.axis->armature = 2, s.axis->stiffness = 100;
	end_slide(s, .5, .2 * sin(2.5), cos(2.5), .02);
}

// The same of a hinge, for its sign: about z, either way round.
static void about(bool first)
{
	little_world *l = little_world_new();
	l->world.gravity = ob_v3(0, 0, 0);
	little_cube(l, 2, .1, ob_v3(0, 0, 0));
	little_cube(l, 0, .1, ob_v3(0, 5, 0));
	ob_joint_passport *j = join(l, OB_JOINT_HINGE, !first, first, ob_v3(0, 0, 0), ob_quat_identity());
	hold_rate(j, 2, 1);
	j->axis.low = -1, j->axis.high = 2.5;
	const double sign = first ? 1 : -1;
	if (run(l, 1)) {
		CHECK_NEAR(2 * atan2(l->now[0].pose.q.z, l->now[0].pose.q.w), sign * 2, .05);
		CHECK_NEAR(l->now[0].w.z, sign * 2, .05);
		run(l, 2);
		CHECK_NEAR(sin(2 * atan2(l->now[0].pose.q.z, l->now[0].pose.q.w)), sign * sin(2.5), .05);
	}
	little_world_free(l);
}

// ---- contacts of joined bodies, and what only obsim has

static void overlap(void)
{
	little_world *l = little_world_new();
	l->world.gravity = ob_v3(0, 0, 0);
	little_cube(l, 1, .5, ob_v3(0, 0, 0));
	little_cube(l, 1, .5, ob_v3(.7, 0, 0));
	join(l, OB_JOINT_HINGE, 0, 1, ob_v3(.35, 0, 0), ob_quat_identity());
	if (run(l, 1))
		CHECK(ob_norm(l->now[0].v) + ob_norm(l->now[1].v) < 1e-6);
	little_world_free(l);
}

static void breaks(void)
{
	little_world *l = little_world_new();
	l->world.gravity = ob_v3(0, 0, 0);
	little_sphere(l, 1, .1, ob_v3(1, 0, 0));
	join(l, OB_JOINT_BALL, 0, OB_JOINT_WORLD, ob_v3(0, 0, 0), ob_quat_identity())->breaks_force = 1;
	ob_error e;
	CHECK(run(l, .1) == (kind == ob_engine_find("obsim")));
	CHECK(kind == ob_engine_find("obsim") || !kind->takes_joints(&l->world, &e));
	little_world_free(l);
}

int main(int argc, char **argv)
{
	kind = ob_engine_find(argv[1]);
	if (!kind)
		return 77;
	pendulum();
	cone(OB_JOINT_BALL);
	cone(OB_JOINT_DISTANCE);
	fixed();
	universal();
	four_bar();
	slider_crank();
	for (int first = 0; first < 2; first++) {
		along(first);
		about(first);
	}
	overlap();
	breaks();
	return check_end();
}
