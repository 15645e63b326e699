// Compounds: mass properties, free rotation, hits, and rest, beside single bodies of the same mass and shape.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "little_universe.h"

enum { CORNERS = 8 };

static void corners_of(ob_vec3 half, ob_vec3 at, ob_vec3 corner[CORNERS])
{
	for (int k = 0; k < CORNERS; k++)
		corner[k] =
			ob_add(at, ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z));
}

typedef struct block {
	ob_vec3 half, at;
	double density;
} block;

static ob_world_body compound(little_scene *s, double mass, const block *each, uint32_t blocks, ob_vec3 p)
{
	ob_vec3 corner[OB_HULL_PARTS_MAX][CORNERS];
	ob_hull_part part[OB_HULL_PARTS_MAX];
	for (uint32_t i = 0; i < blocks; i++) {
		corners_of(each[i].half, each[i].at, corner[i]);
		part[i] = (ob_hull_part){ .point = corner[i], .points = CORNERS, .density = each[i].density };
	}
	return ob_world_compound(&s->world, mass, part, blocks, p);
}

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

// ---- a box of two halves, or of unequal slices

static const ob_vec3 whole = { .3, .2, .4 };

enum { AS_BOX, AS_HALVES, AS_REORDERED, AS_SLICES, AS_PARTS };

static ob_world_body box_as(little_scene *s, int as, double mass, ob_vec3 p)
{
	const block low = { { .3, .2, .2 }, { 0, 0, -.2 }, 1 }, high = { { .3, .2, .2 }, { 0, 0, .2 }, 1 };
	const block halves[] = { low, high }, reordered[] = { high, low };
	const block slices[] = { { { .05, .2, .4 }, { -.25, 0, 0 }, 1 },
				 { { .15, .2, .4 }, { -.05, 0, 0 }, 1 },
				 { { .1, .2, .4 }, { .2, 0, 0 }, 1 } };
	switch (as) {
	case AS_HALVES:
		return compound(s, mass, halves, 2, p);
	case AS_REORDERED:
		return compound(s, mass, reordered, 2, p);
	case AS_SLICES:
		return compound(s, mass, slices, 3, p);
	default:
		return ob_world_box(&s->world, mass, whole, p);
	}
}

typedef void scenery(little_scene *s, int as);

static void fly(little_scene *s, int as)
{
	ob_world_body b = box_as(s, as, 12, ob_v3(0, 0, 2));
	b.state->v = ob_v3(2, .5, 0);
	b.state->w = ob_v3(3, -2, 1);
}

static void throw_on_ground(little_scene *s, int as)
{
	ob_world_body b = box_as(s, as, 12, ob_v3(0, 0, 1));
	b.state->v = ob_v3(2, .5, 0);
	b.state->w = ob_v3(3, -2, 1);
	b.passport->restitution = .3;
	ob_world_ground(&s->world);
}

static void slide_on_table(little_scene *s, int as)
{
	ob_world_body b = box_as(s, as, 12, ob_v3(-2, 0, .4));
	b.state->v = ob_v3(3, .3, 0);
	ob_world_box(&s->world, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
}

static void hit_by_ball(little_scene *s, int as)
{
	ob_world_body b = box_as(s, as, 12, ob_v3(0, 0, 0));
	b.passport->restitution = 1;
	b = ob_world_sphere(&s->world, 3, .1, ob_v3(-1, .07, .21));
	b.state->v = ob_v3(5, 0, 0);
	ob_world_material(&s->world, 0, 1);
	s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
}

static void stack(little_scene *s, int as)
{
	for (int i = 0; i < 3; i++)
		box_as(s, as, 12, ob_v3(.01 * i, 0, .4 + .8 * i));
	ob_world_ground(&s->world);
}

// Largest distance of the first objects' points, a metre from their centres, between the two ways of building.
static double difference(scenery *scene, int as, double time)
{
	double most = 0;
	little_scene *s[2];
	little_universe u[2];
	for (int k = 0; k < 2; k++) {
		s[k] = usual_scene(true);
		scene(s[k], k ? as : AS_BOX);
		little_open(&u[k], s[k]);
	}
	for (double t = .1; t <= time; t += .1) {
		for (int k = 0; k < 2; k++)
			little_run_to(&u[k], t);
		const ob_state a = little_state(&u[0], 0), b = little_state(&u[1], 0);
		const ob_mat3 ra = ob_quat_matrix(a.pose.q), rb = ob_quat_matrix(b.pose.q);
		most = fmax(most, ob_norm(ob_sub(a.pose.p, b.pose.p)));
		for (int i = 0; i < 3; i++)
			most = fmax(most, ob_norm(ob_sub(ob_column(&ra, i), ob_column(&rb, i))));
	}
	for (int k = 0; k < 2; k++)
		finish(&u[k], s[k]);
	return most;
}

static void boxes_of_parts(void)
{
	const struct {
		const char *name;
		scenery *scene;
		double time, most;
	} each[] = { { "flight", fly, 1, 1e-9 },
		     { "fall on the ground", throw_on_ground, 2, 1e-9 },
		     { "slide on a box", slide_on_table, 2, 1e-5 },
		     { "hit by a ball", hit_by_ball, 1, 1e-9 },
		     { "stack", stack, 2, 1e-8 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++)
		for (int as = AS_HALVES; as < AS_PARTS; as++) {
			const double d = difference(each[i].scene, as, each[i].time);
			printf("%s, %d: %.3g m\n", each[i].name, as, d);
			CHECK(d <= each[i].most);
		}
}

// ---- mass

// An L of two boxes of unlike density, turned and moved: moments by the parallel axes in any frame.
static void moments(void)
{
	const block l[] = { { { 1, .1, .2 }, { 1, .1, 0 }, 3 }, { { .1, .5, .2 }, { .1, .7, 0 }, 5 } };
	const double m1 = 3 * 8 * 1 * .1 * .2, m2 = 5 * 8 * .1 * .5 * .2, mass = m1 + m2;
	const double cx = (m1 * 1 + m2 * .1) / mass, cy = (m1 * .1 + m2 * .7) / mass;
	const double x1 = 1 - cx, y1 = .1 - cy, x2 = .1 - cx, y2 = .7 - cy;
	const double xx = m1 * ((.01 + .04) / 3 + y1 * y1) + m2 * ((.25 + .04) / 3 + y2 * y2),
		     yy = m1 * ((1 + .04) / 3 + x1 * x1) + m2 * ((.01 + .04) / 3 + x2 * x2),
		     zz = m1 * ((1 + .01) / 3 + x1 * x1 + y1 * y1) + m2 * ((.01 + .25) / 3 + x2 * x2 + y2 * y2),
		     xy = -(m1 * x1 * y1 + m2 * x2 * y2);
	const double mean = .5 * (xx + yy), half = sqrt(.25 * (xx - yy) * (xx - yy) + xy * xy);
	little_scene *s = usual_scene(false);
	ob_world_body b = compound(s, mass, l, 2, ob_v3(7, 8, 9));
	const ob_vec3 i = b.passport->inertia;
	const double least = fmin(i.x, fmin(i.y, i.z)), most = fmax(i.x, fmax(i.y, i.z));
	CHECK_NEAR(ob_norm(ob_sub(b.state->pose.p, ob_v3(7 + cx, 8 + cy, 9))), 0, 1e-14);
	CHECK_NEAR(least, mean - half, 1e-13);
	CHECK_NEAR(i.x + i.y + i.z - least - most, mean + half, 1e-13);
	CHECK_NEAR(most, zz, 1e-13);
	const ob_mat3 r = ob_quat_matrix(b.state->pose.q); // the tensor in the axes of its author
	double off = 0;
	for (int k = 0; k < 3; k++)
		off += r.m[0][k] * (k == 0 ? i.x : k == 1 ? i.y : i.z) * r.m[1][k];
	CHECK_NEAR(off, xy, 1e-13);
	free(s->world.hull);
	free(s);
}

// A dumbbell turns like the rigid body of its moments, in closed form.
static void dumbbell(void)
{
	const block part[] = { { { .1, .1, .1 }, { -.5, 0, 0 }, 1 },
			       { { .4, .02, .02 }, { 0, 0, 0 }, 1 },
			       { { .1, .15, .1 }, { .5, 0, 0 }, 2 } };
	little_scene *s = usual_scene(false);
	ob_world_body b = compound(s, 4, part, 3, ob_v3(0, 0, 0));
	b.state->w = ob_v3(3, .2, .5);
	const ob_state from = *b.state;
	const ob_vec3 inertia = b.passport->inertia;
	little_universe l;
	ob_quat q;
	ob_vec3 w;
	little_open(&l, s);
	little_run(&l, 300);
	ob_rotate_free(from.pose.q, from.w, inertia, 5, &q, &w);
	const ob_state now = little_state(&l, 0);
	CHECK_NEAR(ob_norm(ob_sub(now.w, w)), 0, 1e-9);
	CHECK_NEAR(fabs(q.w * now.pose.q.w + q.x * now.pose.q.x + q.y * now.pose.q.y + q.z * now.pose.q.z), 1, 1e-12);
	finish(&l, s);
}

// ---- hits

// Elastic channels without friction that fly through the same space.
static void swarm(void)
{
	enum { BODIES = 8 };
	const block channel[] = { { { .4, .3, .05 }, { 0, 0, -.25 }, 1 },
				  { { .4, .05, .25 }, { 0, -.25, 0 }, 1 },
				  { { .4, .05, .25 }, { 0, .25, 0 }, 1 } };
	uint64_t seed = 4;
	little_scene *s = usual_scene(false);
	little_universe l;
	for (int i = 0; i < BODIES; i++) {
		const ob_vec3 from = ob_scale(ob_v3(cos(2.4 * i), sin(2.4 * i), .6 * (i % 3 - 1)), 1.6 + .35 * i);
		ob_world_body b = compound(s, 10, channel, 3, from);
		b.state->pose.q = ob_world_random_attitude(&seed);
		b.state->v = ob_scale(from, -1. / ob_norm(from));
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(&s->world, 0, 1);
	little_open(&l, s);
	const double energy = little_energy(&l);
	const ob_vec3 p = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	ob_state before[BODIES];
	int turned = 0;
	double deepest = 0;
	for (uint32_t i = 0; i < BODIES; i++)
		before[i] = little_state(&l, i);
	for (int k = 0; k < 24; k++) {
		little_run(&l, 10);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	for (uint32_t i = 0; i < BODIES; i++)
		turned += ob_norm(ob_sub(little_state(&l, i).v, before[i].v)) > .1;
	printf("swarm: %d turned, energy %.3g, %.3g mm deep\n", turned, little_energy(&l) / energy - 1, 1e3 * deepest);
	CHECK(turned >= BODIES / 2);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-9);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_momentum(&l.now), p)), 0, 1e-9 * 10 * BODIES);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), spin)), 0, 1e-9 * 10 * 5 * BODIES);
	CHECK(deepest <= 1e-3);
	finish(&l, s);
}

// ---- a channel holds a peg

// A channel that stands on the ground, open above, and a peg in it, between its sides, pushed along and aside.
static void holds_a_peg(bool fixed)
{
	const block channel[] = { { { 1, .3, .05 }, { 0, 0, .05 }, 1 },
				  { { 1, .05, .3 }, { 0, -.25, .4 }, 1 },
				  { { 1, .05, .3 }, { 0, .25, .4 }, 1 } };
	little_scene *s = usual_scene(true);
	little_universe l;
	ob_world_ground(&s->world);
	compound(s, fixed ? 0 : 40, channel, 3, ob_v3(0, 0, 0));
	ob_world_body peg = ob_world_box(&s->world, 2, ob_v3(.15, .19, .1), ob_v3(0, 0, .6));
	peg.state->v = ob_v3(.4, 2, 0);
	peg.passport->friction = .1;
	little_open(&l, s);
	double deepest = 0, aside = 0;
	for (int k = 0; k < 30; k++) {
		little_run(&l, 10);
		deepest = fmax(deepest, little_penetration(&l).max_m);
		aside = fmax(aside, fabs(little_state(&l, 2).pose.p.y - little_state(&l, 1).pose.p.y));
	}
	const ob_state at = little_state(&l, 2);
	printf("peg in a %s channel: %.3g mm deep, %.3g m aside, at rest at %.4g\n", fixed ? "fixed" : "loose",
	       1e3 * deepest, aside, at.pose.p.z);
	CHECK(deepest <= 1e-3);
	CHECK(aside < .012);
	CHECK_NEAR(at.pose.p.z, .2, 1e-3);
	CHECK(ob_norm(at.v) < 1e-3);
	finish(&l, s);
}

int main(void)
{
	moments();
	dumbbell();
	boxes_of_parts();
	swarm();
	holds_a_peg(true);
	holds_a_peg(false);
	return check_end();
}
