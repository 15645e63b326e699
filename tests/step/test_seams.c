// Seams: a body that slides or rolls over exactly coplanar tiles goes as far as on one plane, and keeps its height, in
// any direction and over tiles that may move, too. A step higher than the depth allowed at rest still stops it.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

// A floor of tiles, whose axes are rotated about the vertical, and a body that starts in the middle of one of them.
typedef struct course {
	double turn, heading; // rad: the tiles'; the velocity's against them
	double attitude; // rad: the sliding body's against the tiles
	double speed, friction; // m/s
	double tile; // m, side
	int along, across; // tiles
	double tile_mass; // kg; 0: static
	double step; // m, by which every tile but the first row is higher
	ob_vec3 size; // the sliding body's; a sphere's radius in x
	ob_shape shape;
	double scale; // of all lengths; speeds go with its root
} course;

typedef struct passage {
	double way, hop, aside, speed; // m: along the heading, up or down, across it; m/s at the end
} passage;

static ob_quat about_z(double angle)
{
	return ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, angle));
}

static ob_vec3 horizontal(double angle)
{
	return ob_v3(cos(angle), sin(angle), 0);
}

static passage pass(const course *c, double time)
{
	const double l = c->scale > 0 ? c->scale : 1, side = c->tile * l, thick = .5 * side;
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3 * l;
	ob_world_body o;
	if (c->tile_mass > 0) {
		o = ob_world_ground(&s->world);
		o.state->pose.p.z = -thick;
	}
	for (int i = -1; i < c->along; i++)
		for (int j = -c->across; j <= c->across; j++) {
			ob_vec3 p = ob_add(ob_scale(horizontal(c->turn), i * side),
					   ob_scale(horizontal(c->turn + M_PI / 2), j * side));
			p.z = -.5 * thick + (i > 0 ? c->step * l : 0);
			o = ob_world_box(&s->world, c->tile_mass, ob_v3(.5 * side, .5 * side, .5 * thick), p);
			o.state->pose.q = about_z(c->turn);
		}
	const bool ball = c->shape == OB_SHAPE_SPHERE;
	const double height = (ball ? c->size.x : c->size.z) * l;
	const ob_vec3 dir = horizontal(c->turn + c->heading);
	o = ob_world_add(&s->world, c->shape, ob_scale(c->size, l), 100, ob_v3(0, 0, height));
	const uint32_t id = o.passport->id;
	o.state->pose.q = about_z(c->turn + c->attitude);
	o.state->v = ob_scale(dir, c->speed * sqrt(l));
	if (ball)
		o.state->w = ob_scale(ob_v3(-dir.y, dir.x, 0), c->speed * sqrt(l) / height);
	ob_world_material(&s->world, c->friction, 0);
	little_universe u;
	little_open(&u, s);
	passage out = { 0 };
	for (double t = 0; t < time * sqrt(l); t += s->run.step_length) {
		little_run(&u, 1);
		out.hop = fmax(out.hop, fabs(little_state(&u, id).pose.p.z - height));
	}
	ob_state end = little_state(&u, id);
	out.way = ob_dot(end.pose.p, dir);
	out.aside = fabs(ob_dot(end.pose.p, ob_v3(-dir.y, dir.x, 0)));
	out.speed = ob_norm(end.v);
	little_close(&u);
	free(s);
	return out;
}

// way_error: relative, of the way and of its sideways deviation; highest: m, hop.
static void check_slide(const char *what, const course *c, double way_error, double highest)
{
	const double l = c->scale > 0 ? c->scale : 1, time = c->speed / (c->friction * g) + .5;
	const double way = c->speed * c->speed / (2 * c->friction * g) * l;
	passage p = pass(c, time);
	printf("%s, %g m/s: way off by %.1e, hop %.1e, aside %.1e m\n", what, c->speed, p.way / way - 1, p.hop,
	       p.aside);
	CHECK_NEAR(p.way / way, 1, way_error);
	CHECK(p.hop <= highest * l);
	CHECK(p.aside <= 2 * way_error * way);
}

// Without friction, or rolling: no energy is lost.
static void check_free(const char *what, const course *c, double time, double speed_error)
{
	const double l = c->scale > 0 ? c->scale : 1;
	passage p = pass(c, time);
	printf("%s, %g m/s: speed off by %.1e, hop %.1e, aside %.1e m\n", what, c->speed,
	       p.speed / (c->speed * sqrt(l)) - 1, p.hop, p.aside);
	CHECK_NEAR(p.speed / (c->speed * sqrt(l)), 1, speed_error);
	CHECK(p.way >= c->speed * time * l * (1 - speed_error));
	CHECK(p.hop <= 2e-5 * l);
	CHECK(p.aside <= 1e-3 * p.way);
}

static const course box = {
	.friction = .5, .tile = .2, .along = 12, .across = 2, .size = { .1, .1, .05 }, .shape = OB_SHAPE_BOX
};
static const course ball = {
	.friction = .5, .tile = .2, .along = 14, .across = 2, .size = { .1, 0, 0 }, .shape = OB_SHAPE_SPHERE
};

static void test_boxes_slide(void)
{
	course c;
	for (double v = 1; v <= 4; v *= 2) {
		c = box;
		c.speed = v;
		check_slide("box", &c, 1e-4, 1e-5);
		c.turn = .6;
		check_slide("box on turned tiles", &c, 3e-2, 2e-5);
		c.attitude = .4;
		check_slide("box askew", &c, 3e-2, 2e-5);
		c.heading = .3;
		c.across = 4;
		check_slide("box aslant", &c, 3e-2, 2e-5);
	}
	c = box;
	c.speed = 2;
	c.size = ob_v3(.3, .25, .2);
	c.across = 4;
	check_slide("box on many tiles", &c, 1e-4, 1e-5);
	c = box;
	c.speed = 2;
	c.friction = .2;
	c.size = ob_v3(.03, .02, .01);
	c.along = 14;
	check_slide("little box", &c, 1e-4, 1e-5);
}

// Boxes gain or lose by sinking micrometres while the load goes over from one tile to the next.
static void test_boxes_without_friction(void)
{
	for (double v = .5; v <= 8; v *= 4) {
		course c = box;
		c.friction = 0;
		c.speed = v;
		check_free("smooth box", &c, fmin(2, 2 / v), 1e-3);
		c.turn = .6, c.attitude = .4;
		check_free("smooth box askew", &c, fmin(2, 2 / v), 1e-3);
		c.heading = .7, c.along = c.across = 10;
		check_free("smooth box aslant", &c, fmin(2, 1.6 / v), 1e-3);
	}
}

static void test_balls_roll(void)
{
	for (double v = .1; v <= 12; v *= 3) {
		course c = ball;
		c.speed = v;
		check_free("ball", &c, fmin(2, 2 / v), 1e-7);
		c.friction = 0;
		check_free("smooth ball", &c, fmin(2, 2 / v), 1e-7);
		c.friction = .5, c.turn = .6, c.heading = .7, c.along = c.across = 10;
		check_free("ball aslant", &c, fmin(2, 1.6 / v), 1e-7);
		c.heading = M_PI / 4;
		check_free("ball over corners", &c, fmin(2, 1.6 / v), 1e-7);
	}
}

// A hundred times as large or as small, with the tolerance, and times that go with the root.
static void test_scales(void)
{
	static const double scale[] = { .01, 100 };
	for (int i = 0; i < 2; i++) {
		course c = box;
		c.scale = scale[i];
		c.speed = 2;
		check_slide(i ? "huge box" : "tiny box", &c, 1e-3, 1e-5);
		c = ball;
		c.scale = scale[i];
		c.speed = 2;
		check_free(i ? "huge ball" : "tiny ball", &c, .8, 1e-6);
	}
}

// Tiles of 50 kg on a plane, which the box of 100 kg slides over.
static void test_tiles_that_move(void)
{
	course c = box;
	c.tile_mass = 50;
	c.speed = 2;
	check_slide("box on loose tiles", &c, 1e-2, 1e-4);
}

// A millimetre is a step, at any speed; for a ball, too, which it throws up.
static void test_steps(void)
{
	for (double v = 1; v <= 2; v *= 2) {
		course c = box;
		c.friction = 0;
		c.step = 1e-3;
		c.speed = v;
		passage p = pass(&c, .5);
		printf("step of 1 mm at %g m/s: box at %.3f m\n", v, p.way);
		CHECK(p.way < .01 && p.speed < .5 * v);
		c.step = 4e-4;
		CHECK(pass(&c, .5).way < .01);
		c = ball;
		c.step = 5e-3;
		c.speed = v;
		p = pass(&c, .3);
		printf("step of 5 mm at %g m/s: ball %.4f m up\n", v, p.hop);
		CHECK(p.hop > 4.9e-3 || p.way < .1);
	}
}

int main(void)
{
	test_boxes_slide();
	test_boxes_without_friction();
	test_balls_roll();
	test_scales();
	test_tiles_that_move();
	test_steps();
	return check_end();
}
