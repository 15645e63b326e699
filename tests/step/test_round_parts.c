// Compounds of spheres, capsules and cylinders: beside the same shapes alone, and by closed forms.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "elementary/elementary.h"
#include "little_universe.h"
#include "shape/shape.h"

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.hull);
	free(s);
}

static little_scene *usual_scene(bool gravity)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = .001;
	s->checked = true;
	if (!gravity)
		s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
	return s;
}

static ob_hull_part round_part(ob_shape shape, double radius, double half, ob_vec3 at, ob_quat q)
{
	return (ob_hull_part){ .density = 1, .round = shape, .size = { radius, half, 0 }, .pose = { at, q } };
}

static ob_quat turn(double angle, ob_vec3 axis)
{
	const double s = sin(.5 * angle);
	return (ob_quat){ cos(.5 * angle), s * axis.x, s * axis.y, s * axis.z };
}

// ---- a shape alone

// Shape that is built as itself, or as the only part of a compound, off the origin of that.
typedef struct lone_shape {
	ob_shape shape;
	double radius, half;
	ob_pose pose;
} lone_shape;

static ob_world_body build(little_scene *s, bool as_part, double mass, const lone_shape *x)
{
	if (!as_part) {
		ob_world_body b = ob_world_add(&s->world, x->shape, ob_v3(x->radius, x->half, 0), mass, x->pose.p);
		b.state->pose.q = x->pose.q;
		return b;
	}
	const ob_vec3 at = ob_v3(.7, -.4, .2);
	const ob_hull_part part = round_part(x->shape, x->radius, x->half, at, x->pose.q);
	return ob_world_compound(&s->world, mass, &part, 1, ob_sub(x->pose.p, at));
}

typedef void scenery(little_scene *s, ob_shape shape, bool as_part);

static lone_shape upright(ob_shape shape, ob_vec3 p)
{
	return (lone_shape){ shape, .2, shape == OB_SHAPE_SPHERE ? 0 : .3, { p, ob_quat_identity() } };
}

static lone_shape lying(ob_shape shape, ob_vec3 p)
{
	lone_shape out = upright(shape, p);
	out.pose.q = turn(.5 * M_PI, ob_v3(1, 0, 0)); // along y
	return out;
}

static void fly(little_scene *s, ob_shape shape, bool as_part)
{
	const lone_shape x = upright(shape, ob_v3(0, 0, 2));
	ob_world_body b = build(s, as_part, 3, &x);
	b.state->v = ob_v3(2, .5, 0);
	b.state->w = ob_v3(3, -2, 1);
}

static void roll_on_ground(little_scene *s, ob_shape shape, bool as_part)
{
	const lone_shape x = lying(shape, ob_v3(0, 0, .2));
	build(s, as_part, 3, &x).state->v = ob_v3(2, 0, 0);
	ob_world_ground(&s->world);
}

static void roll_down(little_scene *s, ob_shape shape, bool as_part)
{
	ob_world_slope(&s->world, .3);
	const lone_shape x = lying(shape, ob_scale(ob_v3(sin(.3), 0, cos(.3)), .2));
	build(s, as_part, 3, &x);
}

static void roll_on_box(little_scene *s, ob_shape shape, bool as_part)
{
	const lone_shape x = lying(shape, ob_v3(-2, 0, .2));
	build(s, as_part, 3, &x).state->v = ob_v3(2, 0, 0);
	ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
}

static void rebound(little_scene *s, ob_shape shape, bool as_part)
{
	lone_shape x = upright(shape, ob_v3(0, 0, 1));
	x.pose.q = turn(.4, ob_v3(1, 0, 0));
	ob_world_body b = build(s, as_part, 3, &x);
	b.state->v = ob_v3(1, .5, 0);
	b.state->w = ob_v3(1, 0, 2);
	ob_world_ground(&s->world);
	ob_world_material(&s->world, .3, .5);
}

static void hit_by_ball(little_scene *s, ob_shape shape, bool as_part)
{
	const lone_shape x = upright(shape, ob_v3(0, 0, 0));
	build(s, as_part, 3, &x);
	ob_world_sphere(&s->world, 1, .1, ob_v3(-1, .07, .11)).state->v = ob_v3(5, 0, 0);
	ob_world_material(&s->world, .2, 1);
	s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
}

static void rebound_on_box(little_scene *s, ob_shape shape, bool as_part)
{
	rebound(s, shape, as_part);
	ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.499));
	ob_world_material(&s->world, .3, .5);
}

// Axis of an axial shape since the start, of which z was "axis".
static ob_vec3 axis_of(ob_quat start, ob_quat now, ob_vec3 axis)
{
	const ob_mat3 r = ob_quat_matrix(ob_quat_mul(now, ob_quat_conjugate(start)));
	return ob_rotate(&r, axis);
}

// Largest difference of object "id" between the two ways of building: of its place (m), rates (m/s, rad/s), and axis. The
// turn about its axis is none of its motion.
static double difference(scenery *scene, ob_shape shape, uint32_t id, double time)
{
	double most = 0;
	little_scene *s[2];
	little_universe u[2];
	ob_quat start[2];
	for (int k = 0; k < 2; k++) {
		s[k] = usual_scene(true);
		scene(s[k], shape, k);
		start[k] = s[k]->state[id].pose.q;
		little_open(&u[k], s[k]);
	}
	const ob_mat3 first = ob_quat_matrix(start[0]);
	for (double t = .1; t <= time; t += .1) {
		ob_state x[2];
		ob_vec3 axis[2] = { { 0, 0, 0 }, { 0, 0, 0 } };
		for (int k = 0; k < 2; k++) {
			little_run_to(&u[k], t);
			x[k] = little_state(&u[k], id);
			if (ob_shape_is(shape, OB_AXIAL))
				axis[k] = axis_of(start[k], x[k].pose.q, ob_column(&first, 2));
		}
		most = fmax(most, ob_norm(ob_sub(x[0].pose.p, x[1].pose.p)));
		most = fmax(most, fmax(ob_norm(ob_sub(x[0].v, x[1].v)), ob_norm(ob_sub(x[0].w, x[1].w))));
		most = fmax(most, ob_norm(ob_sub(axis[0], axis[1])));
	}
	for (int k = 0; k < 2; k++)
		finish(&u[k], s[k]);
	return most;
}

static void lone_parts(void)
{
	const struct {
		const char *name;
		scenery *scene;
		uint32_t id;
		double time, most;
	} each[] = { { "flight", fly, 0, 1, 1e-10 },
		     { "roll on the ground", roll_on_ground, 0, 2, 1e-10 },
		     { "roll down", roll_down, 1, 2, 1e-10 },
		     { "roll on a box", roll_on_box, 0, 2, 1e-10 },
		     { "rebound", rebound, 0, .7, 1e-10 },
		     { "rebound on a box", rebound_on_box, 0, .7, 1e-10 },
		     { "hit by a ball", hit_by_ball, 0, 1, 1e-10 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++)
		for (int k = 0; k < 3; k++) {
			static const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
			const double d = difference(each[i].scene, shape[k], each[i].id, each[i].time);
			printf("%s, %s: %.3g m\n", ob_shape_name(shape[k]), each[i].name, d);
			CHECK(d <= each[i].most);
		}
}

// ---- dumbbells

enum { BALLS = 2 };

static const double ball_radius = .1, ball_mass = 2, arm = .4;

// Two balls at -arm and arm along x, in the frame of p, turned.
static ob_world_body dumbbell(little_scene *s, ob_vec3 p, ob_quat q)
{
	const ob_quat same = ob_quat_identity();
	const ob_hull_part part[BALLS] = {
		round_part(OB_SHAPE_SPHERE, ball_radius, 0, ob_v3(-arm, 0, 0), same),
		round_part(OB_SHAPE_SPHERE, ball_radius, 0, ob_v3(arm, 0, 0), same),
	};
	ob_world_body b = ob_world_compound(&s->world, BALLS * ball_mass, part, BALLS, p);
	b.state->pose.q = ob_quat_mul(q, b.state->pose.q);
	return b;
}

// About its rod, and across it (kg m^2).
static const double along = BALLS * .4 * ball_mass * ball_radius * ball_radius;
static double across(void)
{
	return along + BALLS * ball_mass * arm * arm;
}

static void moments_of_dumbbell(void)
{
	little_scene *s = usual_scene(false);
	const ob_world_body b = dumbbell(s, ob_v3(1, 2, 3), ob_quat_identity());
	const ob_vec3 i = b.passport->inertia;
	const double least = fmin(i.x, fmin(i.y, i.z)), most = fmax(i.x, fmax(i.y, i.z));
	CHECK_NEAR(least, along, 1e-15);
	CHECK_NEAR(most, across(), 1e-15);
	CHECK_NEAR(i.x + i.y + i.z - least - most, across(), 1e-15);
	CHECK_NEAR(ob_norm(ob_sub(b.state->pose.p, ob_v3(1, 2, 3))), 0, 1e-15);
	free(s->world.hull);
	free(s);
}

// One ball of a level dumbbell hits a stop without friction: the impulse of a rigid body.
static void hit_by_one_ball(bool plane, double e)
{
	const double v = 3, mass = BALLS * ball_mass;
	little_scene *s = usual_scene(false);
	little_universe l;
	dumbbell(s, ob_v3(0, 0, .5), ob_quat_identity()).state->v = ob_v3(0, 0, -v);
	if (plane) {
		ob_world_ground(&s->world);
		s->state[0].pose.q = ob_quat_mul(turn(.3, ob_v3(0, 1, 0)), s->state[0].pose.q); // lowers the ball at +x
	} else {
		ob_world_box(&s->world, 0, ob_v3(.2, .2, .2), ob_v3(arm, 0, -.2));
	}
	ob_world_material(&s->world, 0, e);
	little_open(&l, s);
	little_run_to(&l, plane ? .11 : .15);
	const double lever = arm * (plane ? cos(.3) : 1), impulse = (1 + e) * v / (1 / mass + lever * lever / across());
	const ob_state now = little_state(&l, 0);
	printf("one ball on a %s, e = %g: %.3g m/s, %.3g rad/s off\n", plane ? "plane" : "box", e,
	       now.v.z + v - impulse / mass, ob_norm(now.w) - lever * impulse / across());
	CHECK_NEAR(now.v.z, impulse / mass - v, 1e-9);
	CHECK_NEAR(ob_norm(now.w), lever * impulse / across(), 1e-9);
	CHECK_NEAR(now.w.y, -lever * impulse / across(), 1e-9);
	finish(&l, s);
}

// Both balls roll down a slope: the wheels of an axle.
static void rolls_as_an_axle(bool box)
{
	const double angle = .2, time = 1, down = 9.81 * sin(angle);
	const ob_vec3 n = ob_v3(sin(angle), 0, cos(angle)), ahead = ob_v3(cos(angle), 0, -sin(angle));
	little_scene *s = usual_scene(true);
	little_universe l;
	if (box) {
		ob_world_body b = ob_world_box(&s->world, 0, ob_v3(9, 2, .5), ob_scale(n, -.5));
		b.state->pose.q = turn(angle, ob_v3(0, 1, 0));
	} else {
		ob_world_slope(&s->world, angle);
	}
	dumbbell(s, ob_scale(n, ball_radius), turn(.5 * M_PI, ob_v3(0, 0, 1))); // along y
	little_open(&l, s);
	little_run_to(&l, time);
	const double a = down / (1 + along / (BALLS * ball_mass * ball_radius * ball_radius));
	const ob_state now = little_state(&l, 1);
	printf("axle on a %s: %.3g m/s, %.3g m off\n", box ? "box" : "plane", ob_dot(now.v, ahead) - a * time,
	       ob_dot(now.pose.p, ahead) - .5 * a * time * time);
	CHECK_NEAR(ob_dot(now.v, ahead), a * time, 1e-9);
	CHECK_NEAR(ob_dot(now.pose.p, ahead), .5 * a * time * time, 1e-9);
	CHECK_NEAR(now.w.y, a * time / ball_radius, 1e-8);
	CHECK(fabs(ob_dot(now.pose.p, n) - ball_radius) < 1e-6);
	finish(&l, s);
}

// ---- jacks: three bars across each other

enum { BARS = 3 };

static ob_world_body jack(little_scene *s, double mass, ob_vec3 p)
{
	static const ob_shape shape[BARS] = { OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER, OB_SHAPE_CAPSULE };
	ob_hull_part part[BARS + 1];
	for (int i = 0; i < BARS; i++) {
		const ob_vec3 axis = ob_v3(i == 0, i == 1, i == 2);
		part[i] = round_part(shape[i], .06, .25 + .02 * i, ob_v3(0, 0, 0), turn(.5 * M_PI, axis));
	}
	part[BARS] = round_part(OB_SHAPE_SPHERE, .12, 0, ob_v3(0, 0, .2), ob_quat_identity());
	return ob_world_compound(&s->world, mass, part, BARS + 1, p);
}

// Elastic jacks without friction fly through the same space.
static void swarm(void)
{
	enum { BODIES = 8 };
	const double mass = 5;
	uint64_t seed = 4;
	little_scene *s = usual_scene(false);
	little_universe l;
	for (int i = 0; i < BODIES; i++) {
		const ob_vec3 from = ob_scale(ob_v3(cos(2.4 * i), sin(2.4 * i), .6 * (i % 3 - 1)), 1.2 + .3 * i);
		ob_world_body b = jack(s, mass, from);
		b.state->pose.q = ob_world_random_attitude(&seed);
		b.state->v = ob_scale(from, -1. / ob_norm(from));
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(&s->world, 0, 1);
	little_open(&l, s);
	const double energy = little_energy(&l);
	const ob_vec3 p = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	double deepest = 0;
	int turned = 0;
	for (int k = 0; k < 24; k++) {
		little_run(&l, 10);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	for (uint32_t i = 0; i < BODIES; i++)
		turned += ob_norm(ob_sub(little_state(&l, i).v, s->state[i].v)) > .1;
	printf("swarm: %d turned, energy %.3g, %.3g mm deep\n", turned, little_energy(&l) / energy - 1, 1e3 * deepest);
	CHECK(turned >= BODIES / 2);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-9);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_momentum(&l.now), p)), 0, 1e-9 * mass * BODIES);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), spin)), 0, 1e-9 * mass * 5 * BODIES);
	CHECK(deepest <= 1e-3);
	finish(&l, s);
}

// Jacks fall on the ground and on each other, and come to rest.
static void heap(bool plane)
{
	enum { BODIES = 6 };
	uint64_t seed = 7;
	little_scene *s = usual_scene(true);
	little_universe l;
	for (int i = 0; i < BODIES; i++)
		jack(s, 2, ob_v3(.1 * (i % 3), .1 * (i % 2), .6 + .7 * i)).state->pose.q =
			ob_world_random_attitude(&seed);
	if (plane)
		ob_world_ground(&s->world);
	else
		ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	little_open(&l, s);
	double deepest = 0, fastest = 0, lowest = INFINITY;
	for (int k = 0; k < 60; k++) {
		little_run(&l, 10);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	for (uint32_t i = 0; i < BODIES; i++) {
		const ob_state x = little_state(&l, i);
		fastest = fmax(fastest, ob_norm(x.v) + .3 * ob_norm(x.w));
		lowest = fmin(lowest, x.pose.p.z);
	}
	printf("heap on a %s: %.3g mm deep, %.3g m/s, lowest at %.3g m\n", plane ? "plane" : "box", 1e3 * deepest,
	       fastest, lowest);
	CHECK(deepest <= 1e-3);
	CHECK(fastest < .05);
	CHECK(lowest > .05);
	finish(&l, s);
}

// ---- symmetry

// Two jacks that hit each other with friction, turned, mirrored in y = 0, or seen from a frame that moves.
typedef struct view {
	ob_quat q;
	bool mirrored;
	ob_vec3 v;
} view;

static ob_vec3 seen(const view *x, ob_vec3 v)
{
	const ob_mat3 r = ob_quat_matrix(x->q);
	return ob_rotate(&r, x->mirrored ? ob_v3(v.x, -v.y, v.z) : v);
}

static ob_vec3 seen_turning(const view *x, ob_vec3 w)
{
	return ob_scale(seen(x, w), x->mirrored ? -1 : 1);
}

static ob_quat seen_attitude(const view *x, ob_quat q)
{
	return ob_quat_mul(x->q, x->mirrored ? (ob_quat){ q.w, -q.x, q.y, -q.z } : q);
}

static void place(const view *x, ob_world_body b, ob_vec3 p, ob_quat q, ob_vec3 v, ob_vec3 w)
{
	b.state->pose.p = seen(x, p);
	b.state->pose.q = ob_quat_mul(seen_attitude(x, q), b.state->pose.q);
	b.state->v = ob_add(seen(x, v), x->v);
	b.state->w = seen_turning(x, w);
}

static void symmetry(const char *name, const view *x)
{
	enum { BODIES = 2 };
	static const view plain = { .q = { .w = 1 } };
	little_scene *s[2];
	little_universe l[2];
	const double time = .6;
	double most = 0;
	for (int k = 0; k < 2; k++) {
		s[k] = usual_scene(false);
		const view *as = k ? x : &plain;
		place(as, jack(s[k], 2, ob_v3(0, 0, 0)), ob_v3(-.5, 0, 0), turn(.5, ob_v3(0, .6, .8)), ob_v3(1, 0, 0),
		      ob_v3(1, 2, 0));
		place(as, jack(s[k], 3, ob_v3(0, 0, 0)), ob_v3(.5, .1, .05), turn(1.2, ob_v3(.8, .6, 0)),
		      ob_v3(-1, 0, 0), ob_v3(0, -1, 1));
		ob_world_material(&s[k]->world, .4, .6);
		little_open(&l[k], s[k]);
		little_run_to(&l[k], time);
	}
	for (uint32_t i = 0; i < BODIES; i++) {
		const ob_state a = little_state(&l[0], i), b = little_state(&l[1], i);
		most = fmax(most, ob_norm(ob_sub(ob_madd(seen(x, a.pose.p), time, x->v), b.pose.p)));
		most = fmax(most, ob_norm(ob_sub(ob_add(seen(x, a.v), x->v), b.v)));
		most = fmax(most, ob_norm(ob_sub(seen_turning(x, a.w), b.w)));
		CHECK(ob_norm(ob_sub(a.v, s[0]->state[i].v)) > .1); // they hit
	}
	printf("%s: %.3g off\n", name, most);
	CHECK(most < 1e-9);
	for (int k = 0; k < 2; k++)
		finish(&l[k], s[k]);
}

int main(void)
{
	lone_parts();
	moments_of_dumbbell();
	for (int plane = 0; plane < 2; plane++) {
		hit_by_one_ball(plane, 1);
		hit_by_one_ball(plane, .4);
		rolls_as_an_axle(plane);
		heap(plane);
	}
	swarm();
	symmetry("turned", &(view){ .q = turn(.7, ob_v3(.6, 0, .8)) });
	symmetry("mirrored", &(view){ .q = ob_quat_identity(), .mirrored = true });
	symmetry("boosted", &(view){ .q = ob_quat_identity(), .v = ob_v3(3, -2, 1) });
	return check_end();
}
