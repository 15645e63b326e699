// Hulls: a box made as a hull of its corners moves like the box; heaps of hulls rest with the penetration of boxes;
// momentum and energy; slopes, hits, stacks, rolling over edges and spinning, by closed forms.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "hull/solids.h"
#include "little_universe.h"

// A cuboid, as a box or as a hull of its corners.
static ob_world_body cuboid(little_scene *s, bool hull, double mass, ob_vec3 half, ob_vec3 p)
{
	ob_vec3 corner[8];
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
	return hull ? ob_world_hull(&s->world, mass, corner, 8, p) : ob_world_box(&s->world, mass, half, p);
}

typedef void build(little_scene *s, bool hull);

static void throw_one(little_scene *s, bool hull)
{
	ob_world_ground(&s->world);
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .4), ob_v3(0, 0, 2));
	b.state->v = ob_v3(2, .5, 0);
	b.state->w = ob_v3(3, -2, 1);
	b.passport->restitution = .3;
}

// On a table, and on bodies that stand there: no planes.
static void tumble_on_boxes(little_scene *s, bool hull)
{
	cuboid(s, hull, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	cuboid(s, hull, 0, ob_v3(.5, .5, .2), ob_v3(.9, .1, .2));
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .4), ob_v3(0, 0, 2));
	b.state->v = ob_v3(1.2, .1, 0);
	b.state->w = ob_v3(1, -2, .5);
}

static void push_one(little_scene *s, bool hull)
{
	ob_world_ground(&s->world);
	cuboid(s, false, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.4)); // a table of its own: a face, not a plane
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .1), ob_v3(-2, 0, .2));
	b.state->v = ob_v3(4, .3, 0);
	b.state->w = ob_v3(0, 0, 2);
}

static void push_over_hull(little_scene *s, bool hull)
{
	cuboid(s, hull, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .1), ob_v3(-2, 0, .1));
	b.state->v = ob_v3(4, .3, 0);
}

static void stack_ten(little_scene *s, bool hull)
{
	uint64_t seed = 5;
	ob_world_ground(&s->world);
	for (int i = 0; i < 10; i++) {
		const double x = ob_splitmix_within(&seed, -.01, .01), y = ob_splitmix_within(&seed, -.01, .01);
		cuboid(s, hull, 1000, ob_v3(.5, .5, .5), ob_v3(x, y, .5 + i));
	}
}

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.hull);
	free(s);
}

static double difference(build *scene, double time, int *objects)
{
	double most = 0;
	little_scene *s[2];
	little_universe u[2];
	for (int k = 0; k < 2; k++) {
		s[k] = little_scene_new();
		s[k]->run.tolerance = .001;
		scene(s[k], k);
		little_open(&u[k], s[k]);
	}
	*objects = (int)s[0]->world.objects;
	for (double t = .1; t <= time; t += .1) {
		double now = 0;
		for (int k = 0; k < 2; k++)
			little_run_to(&u[k], t);
		for (int id = 0; id < *objects; id++) {
			const ob_state a = little_state(&u[0], (uint32_t)id), b = little_state(&u[1], (uint32_t)id);
			const ob_mat3 ra = ob_quat_matrix(a.pose.q), rb = ob_quat_matrix(b.pose.q);
			now = fmax(now, ob_norm(ob_sub(a.pose.p, b.pose.p)));
			for (int i = 0; i < 3; i++) // points a metre from the centre
				now = fmax(now, ob_norm(ob_sub(ob_column(&ra, i), ob_column(&rb, i))));
		}
		most = fmax(most, now);
	}
	for (int k = 0; k < 2; k++)
		finish(&u[k], s[k]);
	return most;
}

static void boxes_as_hulls(void)
{
	int n;
	const struct {
		const char *name;
		build *scene;
		double time;
	} each[] = { { "tumble", throw_one, 3 },
		     { "tumble on boxes", tumble_on_boxes, 3 },
		     { "slide", push_one, 3 },
		     { "slide on a hull", push_over_hull, 3 },
		     { "stack of 10", stack_ten, 5 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
		const double d = difference(each[i].scene, each[i].time, &n);
		printf("%s: %.3g m\n", each[i].name, d);
		CHECK(d <= 1e-9);
	}
}

// The hull of this number of points on an ellipsoid.
static ob_world_body pebble(little_scene *s, uint64_t *seed, int points, ob_vec3 p)
{
	ob_vec3 point[16];
	const ob_vec3 half = ob_add(ob_v3(.4, .4, .4), ob_splitmix_vector(seed, .2));
	for (int k = 0; k < points; k++) {
		ob_vec3 d = ob_splitmix_vector(seed, 1);
		d = ob_scale(d, 1 / ob_norm(d));
		point[k] = ob_v3(half.x * d.x, half.y * d.y, half.z * d.z);
	}
	ob_world_body b = ob_world_hull(&s->world, 500, point, (uint32_t)points, p);
	b.state->pose.q = ob_world_random_attitude(seed);
	return b;
}

// Penetration stays below the tolerance, energy does not rise, and in the end all lie still.
static void heap(void)
{
	enum { PEBBLES = 48 };
	uint64_t seed = 11;
	little_scene *s = little_scene_new();
	little_universe l;
	s->run.tolerance = .001;
	ob_world_ground(&s->world);
	for (int i = 0; i < PEBBLES; i++)
		pebble(s, &seed, 8 + i % 9, ob_v3(1.25 * (i % 4), 1.25 * (i / 4 % 4), 1 + 1.3 * (i / 16)));
	little_open(&l, s);
	double deepest = 0, energy = little_energy(&l), fastest = 0;
	for (int step = 0; step < 300; step += 10) {
		little_run(&l, 10);
		const double now = little_energy(&l);
		deepest = fmax(deepest, little_penetration(&l).max_m);
		CHECK(now <= energy + 1e-6 * fabs(energy));
		energy = now;
	}
	for (uint32_t id = 1; id <= PEBBLES; id++)
		fastest = fmax(fastest, ob_norm(little_state(&l, id).v));
	printf("heap: %.3g mm deep, %.3g m/s in the end\n", 1e3 * deepest, fastest);
	CHECK(deepest > 0 && deepest <= 1e-3);
	CHECK(fastest < .05);
	finish(&l, s);
}

// Elastic hulls without friction that fly through the same space: momentum, angular momentum and energy are conserved.
static void swarm(void)
{
	enum { BODIES = 10 };
	uint64_t seed = 4;
	little_scene *s = little_scene_new();
	little_universe l;
	s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = .001;
	for (int i = 0; i < BODIES; i++) {
		const ob_vec3 from = ob_scale(ob_v3(cos(2.4 * i), sin(2.4 * i), .6 * (i % 3 - 1)), 1.6 + .35 * i);
		ob_world_body b = pebble(s, &seed, 10, from);
		b.state->v = ob_scale(from, -1. / ob_norm(from));
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(&s->world, 0, 1);
	little_open(&l, s);
	const double energy = little_energy(&l);
	const ob_vec3 p = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	ob_state before[BODIES];
	int turned = 0;
	for (uint32_t i = 0; i < BODIES; i++)
		before[i] = little_state(&l, i);
	little_run(&l, 240);
	for (uint32_t i = 0; i < BODIES; i++)
		turned += ob_norm(ob_sub(little_state(&l, i).v, before[i].v)) > .1;
	CHECK(turned >= BODIES / 2);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-9);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_momentum(&l.now), p)), 0, 1e-9 * 500 * BODIES);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), spin)), 0, 1e-9 * 500 * 5 * BODIES);
	CHECK(little_penetration(&l).max_m <= 1e-3);
	finish(&l, s);
}

// ---- closed forms

static const double g = 9.81; // m/s^2

static little_scene *usual_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = .001;
	s->run.iterations = 64;
	return s;
}

// A frame in which one face of the hull looks down
static ob_quat face_down(const ob_hull *h, int face)
{
	const ob_vec3 n = h->normal[face], axis = ob_cross(n, ob_v3(0, 0, -1));
	const double s = ob_norm(axis), angle = atan2(s, -n.z);
	if (s > 1e-9)
		return ob_quat_turn(ob_quat_identity(), ob_scale(axis, angle / s));
	return n.z < 0 ? ob_quat_identity() : ob_quat_turn(ob_quat_identity(), ob_v3(M_PI, 0, 0));
}

static ob_vec3 lowest(const ob_hull *h, ob_quat q)
{
	const ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 low = { 0, 0, INFINITY };
	for (uint32_t i = 0; i < h->corners; i++) {
		const ob_vec3 x = ob_rotate(&r, h->corner[i]);
		low = x.z < low.z ? x : low;
	}
	return low;
}

// On a slope, on its first face: g (sin - mu cos).
static void slides(const ob_vec3 *corner, uint32_t corners)
{
	const double angle = .3, mu = .2;
	little_scene *s = usual_scene();
	ob_world_slope(&s->world, angle);
	ob_world_body b = ob_world_hull(&s->world, 2, corner, corners, ob_v3(0, 0, 0));
	const ob_hull *h = &s->world.hull[b.passport->hull];
	const ob_quat flat = face_down(h, 0), tilt = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	const ob_mat3 r = ob_quat_matrix(tilt);
	b.state->pose.q = ob_quat_mul(tilt, flat);
	b.state->pose.p = ob_rotate(&r, ob_v3(0, 0, -lowest(h, flat).z));
	const ob_vec3 from = b.state->pose.p;
	ob_world_material(&s->world, mu, 0);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 120);
	const double way = ob_dot(ob_column(&r, 0), ob_sub(little_state(&l, 1).pose.p, from));
	CHECK_NEAR(way, .5 * g * (sin(angle) - mu * cos(angle)) * 4, 1e-9);
	finish(&l, s);
}

// Dropped onto a face: it rebounds to e^2 of the height. Onto a corner: Newton's law holds there.
static void rebounds(const solid *x, double e, bool flat)
{
	const double t = .449, v = g * t, height = .5 * v * t; // just before a step ends: no other corner follows
	uint64_t seed = 7;
	little_scene *s = usual_scene();
	ob_world_ground(&s->world);
	ob_world_body b = ob_world_hull(&s->world, 2, x->corner, (uint32_t)x->corners, ob_v3(0, 0, 0));
	const ob_hull *h = &s->world.hull[b.passport->hull];
	b.state->pose.q = flat ? face_down(h, 0) : ob_world_random_attitude(&seed);
	const ob_vec3 arm = lowest(h, b.state->pose.q);
	b.state->pose.p.z = height - arm.z;
	ob_world_material(&s->world, 0, e);
	little_universe l;
	little_open(&l, s);
	little_run(&l, (uint64_t)ceil(60 * t));
	const ob_state now = little_state(&l, 1);
	const double up = now.v.z + g * (l.now.time - t); // at the hit; constant spin: all moments are equal
	CHECK_NEAR(up + ob_cross(now.w, arm).z, e * v, 1e-9);
	if (flat) {
		CHECK_NEAR(now.pose.p.z + arm.z + .5 * now.v.z * now.v.z / g, e * e * height, 1e-9);
		CHECK_NEAR(ob_norm(now.w), 0, 1e-9);
	} else {
		const ob_vec3 spin = ob_scale(now.w, x->inertia), blow = ob_cross(arm, ob_v3(0, 0, up + v));
		CHECK_NEAR(ob_norm(ob_sub(spin, blow)), 0, 1e-9);
	}
	finish(&l, s);
}

static void closed_forms(void)
{
	solid all[5];
	solids_make(all);
	for (int k = 0; k < 5; k++) {
		slides(all[k].corner, (uint32_t)all[k].corners);
		for (double e = .2; e < 1.1; e += .4)
			for (int flat = 0; flat < 2; flat++)
				rebounds(&all[k], e, flat);
	}
	const ob_vec3 wedge[] = {
		{ -1, -1, 0 }, { 1, -1, 0 }, { -1, 1, 0 }, { 1, 1, 0 }, { -1, -1, .5 }, { -1, 1, .5 }
	};
	const ob_vec3 plate[] = { { -1, -1, 0 }, { 1, -1, 0 }, { -1, 1, 0 }, { 1, 1, .01 }, { -1, -1, .01 } };
	slides(wedge, 6);
	slides(plate, 5);
}

// Two faces of a regular prism one above the other, radius and half length in m, its axis along z.
static uint32_t prism(ob_vec3 *corner, int sides, double radius, double half, double first)
{
	for (int i = 0; i < 2 * sides; i++) {
		const double a = first + 2 * M_PI * (i / 2) / sides;
		corner[i] = ob_v3(radius * cos(a), radius * sin(a), i % 2 ? half : -half);
	}
	return 2 * (uint32_t)sides;
}

static void stack_of_prisms(int sides)
{
	enum { HIGH = 10 };
	ob_vec3 corner[64];
	little_scene *s = usual_scene();
	ob_world_ground(&s->world);
	for (int i = 0; i < HIGH; i++)
		ob_world_hull(&s->world, 100, corner, prism(corner, sides, .5, .25, .3 * i), ob_v3(0, 0, .25 + .5 * i));
	little_universe l;
	little_open(&l, s);
	double off = 0;
	for (int k = 0; k < 30; k++) {
		little_run(&l, 10);
		for (uint32_t i = 0; i < HIGH; i++)
			off = fmax(off, ob_norm(ob_sub(little_state(&l, i + 1).pose.p, ob_v3(0, 0, .25 + .5 * i))));
	}
	printf("stack of %d-sided prisms: off by %.2g m\n", sides, off);
	CHECK(off < 1e-7);
	finish(&l, s);
}

// A prism of many sides rolls down a slope over its edges: a pendulum on each. At the next edge it keeps a share of its
// rate by Housner's law, (I + R^2 cos 2 alpha) / (I + R^2). Its mass is a kilogram.
typedef struct rolling {
	int sides, edges; // has; has gone over
	double radius, moment, slope;
	double angle, rate; // since the last edge came down
} rolling;

static double swing(const rolling *x, double angle)
{
	const double r = x->radius;
	return g * r * sin(x->slope + angle - M_PI / x->sides) / (x->moment + r * r);
}

static void roll_on(rolling *x, double h)
{
	const double middle = x->rate + .5 * h * swing(x, x->angle), r2 = x->radius * x->radius;
	x->angle += h * middle;
	x->rate = middle + .5 * h * swing(x, x->angle);
	if (x->angle < 2 * M_PI / x->sides)
		return;
	x->angle -= 2 * M_PI / x->sides;
	x->rate *= (x->moment + r2 * cos(2 * M_PI / x->sides)) / (x->moment + r2);
	x->edges++;
}

static double way_of(const rolling *x)
{
	const double half = M_PI / x->sides;
	return x->radius * ((2 * x->edges + 1) * sin(half) + sin(x->angle - half));
}

static void rolls(int sides, double slope)
{
	rolling x = { .sides = sides, .radius = .2, .slope = slope, .rate = 3 };
	ob_vec3 corner[64];
	little_scene *s = usual_scene();
	ob_world_slope(&s->world, slope);
	const uint32_t corners = prism(corner, sides, x.radius, .3, M_PI / sides - M_PI / 2);
	for (uint32_t i = 0; i < corners; i++)
		corner[i] = ob_v3(corner[i].x, -corner[i].z, corner[i].y);
	ob_world_body b = ob_world_hull(&s->world, 3, corner, corners, ob_v3(0, 0, 0));
	const ob_quat tilt = ob_quat_turn(ob_quat_identity(), ob_v3(0, slope, 0));
	const ob_mat3 r = ob_quat_matrix(tilt), own = ob_quat_matrix(b.state->pose.q);
	const ob_vec3 y = ob_rotate_back(&own, ob_v3(0, 1, 0)), moments = s->world.hull[0].inertia;
	x.moment = y.x * y.x * moments.x + y.y * y.y * moments.y + y.z * y.z * moments.z;
	const ob_vec3 edge = ob_scale(ob_v3(sin(M_PI / sides), 0, -cos(M_PI / sides)), x.radius);
	b.state->pose.q = ob_quat_mul(tilt, b.state->pose.q);
	b.state->pose.p = ob_rotate(&r, ob_v3(0, 0, -edge.z));
	b.state->w = ob_v3(0, x.rate, 0);
	b.state->v = ob_rotate(&r, ob_cross(ob_v3(0, x.rate, 0), ob_scale(edge, -1)));
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	double worst = 0, way = 0;
	for (int i = 0; i < 60; i++) {
		little_run(&l, 1);
		for (int k = 0; k < 1000; k++)
			roll_on(&x, 1. / 60000);
		way = way_of(&x);
		worst = fmax(worst, fabs(ob_dot(ob_column(&r, 0), little_state(&l, 1).pose.p) - way));
	}
	printf("a prism of %d sides rolls over %d edges: off by %.2g of %.2g m\n", sides, x.edges, worst, way);
	CHECK(worst < .005 * way);
	finish(&l, s);
}

// A cone on its tip precesses like a heavy symmetric top, at the slower of the two steady rates.
static void top(int sides, double rate, double tilt)
{
	ob_vec3 corner[32];
	little_scene *s = usual_scene();
	ob_world_ground(&s->world);
	for (int i = 0; i < sides; i++)
		corner[i] = ob_v3(.3 * cos(2 * M_PI * i / sides), .3 * sin(2 * M_PI * i / sides), .5);
	corner[sides] = ob_v3(0, 0, 0);
	ob_world_body b = ob_world_hull(&s->world, 1, corner, (uint32_t)sides + 1, ob_v3(0, 0, 0));
	const double c = b.state->pose.p.z;
	const ob_mat3 own = ob_quat_matrix(b.state->pose.q);
	const ob_vec3 moments = s->world.hull[0].inertia, z = ob_rotate_back(&own, ob_v3(0, 0, 1));
	const double along = z.x * z.x * moments.x + z.y * z.y * moments.y + z.z * z.z * moments.z;
	const double across = .5 * (moments.x + moments.y + moments.z - along) + c * c;
	const double half = .5 * along * rate,
		     goes_round = (half - sqrt(half * half - across * cos(tilt) * g * c)) / (across * cos(tilt));
	const ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_v3(0, tilt, 0));
	const ob_vec3 axis = ob_v3(sin(tilt), 0, cos(tilt)), at = ob_scale(axis, c);
	b.state->w = ob_madd(ob_v3(0, 0, goes_round), rate - goes_round * cos(tilt), axis);
	b.state->v = ob_cross(b.state->w, at);
	b.state->pose.q = ob_quat_mul(turn, b.state->pose.q);
	b.state->pose.p = at;
	ob_world_material(&s->world, 5, 0);
	little_universe l;
	little_open(&l, s);
	const double energy = little_energy(&l);
	for (int i = 1; i <= 4; i++) {
		little_run(&l, 30);
		const ob_vec3 p = little_state(&l, 1).pose.p;
		CHECK_NEAR(remainder(atan2(p.y, p.x) - .5 * goes_round * i, 2 * M_PI), 0, 1e-3);
		CHECK_NEAR(p.z, c * cos(tilt), 1e-5);
	}
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-6);
	finish(&l, s);
}

int main(void)
{
	boxes_as_hulls();
	heap();
	swarm();
	closed_forms();
	stack_of_prisms(3);
	stack_of_prisms(6);
	stack_of_prisms(20);
	rolls(20, .1);
	rolls(8, .15);
	top(3, 150, .3);
	top(20, 110, .5);
	return check_end();
}
