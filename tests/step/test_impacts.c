// Impacts beyond the cases of the lab: one that runs through a row of spheres, flat boxes that bounce on their edges,
// boxes that hit each other at high speed.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

// Balls with a centimetre between them: the impact of the first runs through all of them within a step.
static void test_spaced_row(double speed)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 8; i++) {
		ob_world_body o = ob_world_sphere(&s->world, 1, .1, ob_v3(.21 * i, 0, 0));
		o.passport->restitution = 1;
		o.state->v.x = i ? 0 : speed;
	}
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 60; step++) {
		little_run(&l, 1);
		CHECK_NEAR(little_penetration(&l).max_m, 0, 1e-9);
	}
	for (uint32_t i = 0; i < 8; i++)
		CHECK_NEAR(little_state(&l, i).v.x, i == 7 ? speed : 0, 1e-9);
	little_close(&l);
	free(s);
}

// A flat box that bounces on its edges and corners rotates from each to the next and keeps its energy, or loses some to
// friction and final rest.
static void test_flat_box(double friction, double tilt)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_body o = ob_world_box(&s->world, 1, ob_v3(.5, .5, .05), ob_v3(0, 0, 1.05));
	o.passport->restitution = 1;
	o.passport->friction = friction;
	o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(tilt, .02, 0));
	little_universe l;
	little_open(&l, s);
	double before = little_energy(&l), most = 0, deepest = 0;
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		most = fmax(most, little_energy(&l) / before - 1);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	CHECK(most <= 1e-9);
	CHECK(deepest <= 1e-3);
	if (friction == 0)
		CHECK(little_energy(&l) >= .9 * before);
	little_close(&l);
	free(s);
}

typedef struct collision {
	bool slower; // than they hit
	bool sides; // they have changed sides
	double parting; // share of the speed at which they met
	double gained; // energy, relative
} collision;

// Two boxes, up to 5 cm off the line on which they meet.
static collision collide(uint64_t *seed, double speed, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.substeps = substeps;
	for (int i = 0; i < 2; i++) {
		double side = i ? 1 : -1, x = within(seed, 3, 4), y = within(seed, -.025, .025);
		ob_world_body o =
			ob_world_box(&s->world, 1, ob_v3(.1, .1, .1), ob_v3(side * x, y, within(seed, -.025, .025)));
		o.passport->friction = .3;
		o.state->pose.q = random_attitude(seed);
		o.state->w = random_vector(seed, 1);
		o.state->v.x = -side * speed;
	}
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	little_run(&l, 3 + (uint64_t)(60 * 5 / speed));
	ob_state a = little_state(&l, 0), b = little_state(&l, 1);
	collision out = { a.v.x - b.v.x<speed, a.pose.p.x> b.pose.p.x, fabs(a.v.x - b.v.x) / (2 * speed),
			  little_energy(&l) / energy - 1 };
	little_close(&l);
	free(s);
	return out;
}

// Some corners slip past each other, and the two fly on as they turn round each other; runs in a
// hundred times as many substeps say if they do. If they hardly part along their line, either is right.
static void test_collisions(double speed, int aims)
{
	uint64_t seed = 19;
	int hit = 0, passed = 0, slipped = 0;
	for (int k = 0; k < aims; k++) {
		uint64_t same = seed;
		collision x = collide(&seed, speed, 8), fine = collide(&same, speed, 4000);
		hit += x.slower;
		slipped += fine.sides;
		passed += x.sides && !fine.sides && fine.parting > .05;
		CHECK(x.gained <= 1e-9);
	}
	printf("+-%g m/s: %d of %d hit, %d passed, %d slipped past each other as they should\n", speed, hit, aims,
	       passed, slipped);
	CHECK(hit == aims);
	CHECK(passed == 0);
	CHECK(slipped <= aims / 5);
}

// ---- flat landings

typedef enum ground_kind { GROUND_PLANE, GROUND_STATIC_BOX, GROUND_FREE_BOX } ground_kind;

// A box of any proportions that lands flat on a face or an edge leaves straight up at e times its speed, with any
// friction, and does not rotate. "turn": about the vertical.
static void test_flat_landing(ground_kind ground, bool edge, double turn, uint64_t seed)
{
	little_scene *s = little_scene_new();
	ob_vec3 half = ob_v3(within(&seed, .1, 1), within(&seed, .1, 1), within(&seed, .1, 1));
	const double e = within(&seed, .2, 1), height = within(&seed, .2, 1), mu = within(&seed, 0, 1);
	const double tip = edge ? atan2(half.x, half.z) : 0, low = edge ? hypot(half.x, half.z) : half.z;
	if (ground == GROUND_PLANE)
		ob_world_ground(&s->world);
	else
		ob_world_box(&s->world, ground == GROUND_FREE_BOX ? 3 : 0, ob_v3(2, 3, .5), ob_v3(0, 0, -.5));
	ob_world_body o = ob_world_box(&s->world, 1, half, ob_v3(0, 0, low + height));
	o.state->pose.q = ob_quat_mul(ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, turn)),
				      ob_quat_turn(ob_quat_identity(), ob_v3(0, tip, 0)));
	ob_world_material(&s->world, mu, e);
	if (ground == GROUND_FREE_BOX) {
		s->run.gravity = ob_v3(0, 0, 0);
		o.state->v.z = -4;
	}
	little_universe l;
	little_open(&l, s);
	double apex = 0, sideways = 0, spin = 0;
	const double until = ground == GROUND_FREE_BOX ? 1 : sqrt(2 * height / 9.81) * (1 + 1.9 * e);
	for (int step = 0; step < 60 * until; step++) {
		little_run(&l, 1);
		ob_state x = little_state(&l, 1);
		if (x.v.z > 0 && apex == 0) // the parabola's
			apex = x.pose.p.z + x.v.z * x.v.z / 2 / 9.81 - low;
		sideways = fmax(sideways, hypot(x.v.x, x.v.y));
		spin = fmax(spin, ob_norm(x.w));
	}
	if (ground == GROUND_FREE_BOX)
		CHECK_NEAR(little_state(&l, 1).v.z - little_state(&l, 0).v.z, e * 4, 1e-9);
	else
		CHECK_NEAR(apex, e * e * height, 1e-6);
	CHECK(sideways <= 1e-9);
	CHECK(spin <= 1e-9);
	little_close(&l);
	free(s);
}

// ---- random oblique hits

static ob_vec3 random_direction(uint64_t *seed)
{
	ob_vec3 v = random_vector(seed, 1);
	return ob_scale(v, 1 / ob_norm(v));
}

// Two bodies that fly towards each other, one of them a sphere.
static little_scene *oblique(uint64_t *seed, ob_shape other, double *e, double *mu)
{
	little_scene *s = little_scene_new();
	const double radius = within(seed, .05, .3), speed = within(seed, 1, 10);
	*e = within(seed, 0, 1) < .2 ? 1 : within(seed, .01, 1);
	*mu = within(seed, 0, 1) < .2 ? 0 : within(seed, 0, 1);
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.step_length = 1. / 60;
	ob_world_body a = ob_world_sphere(&s->world, within(seed, .1, 10), radius, ob_v3(0, 0, 0)), b;
	ob_vec3 to = random_direction(seed);
	double far = 0;
	if (other == OB_SHAPE_SPHERE) {
		double r = within(seed, .05, .3);
		b = ob_world_sphere(&s->world, within(seed, .1, 10), r, ob_v3(0, 0, 0));
		far = radius + r;
	} else if (other == OB_SHAPE_BOX) {
		const double w = within(seed, .1, .5);
		ob_vec3 half = ob_v3(w, w, w); // turns uniformly
		b = ob_world_box(&s->world, within(seed, 0, 1) < .3 ? 0 : within(seed, .1, 10), half, ob_v3(0, 0, 0));
		far = radius + ob_norm(half);
	} else {
		b = ob_world_ground(&s->world);
		far = radius;
		to = ob_v3(0, 0, 1);
	}
	a = (ob_world_body){ &s->world.passport[0], &s->world.state[0] };
	ob_world_material(&s->world, *mu, *e);
	ob_vec3 across = ob_cross(to, random_direction(seed));
	ob_vec3 aim = ob_scale(across, within(seed, 0, .8) * far), v = random_vector(seed, .5);
	if (other == OB_SHAPE_PLANE)
		aim = ob_v3(0, 0, 0), v = random_vector(seed, speed), v.z = 0;
	a.state->pose.p = ob_add(ob_scale(to, far + within(seed, .05, .3)), aim);
	a.state->v = ob_sub(v, ob_scale(to, speed));
	a.state->w = random_vector(seed, 20);
	if (b.passport->mass > 0) {
		b.state->pose.q = random_attitude(seed);
		b.state->w = random_vector(seed, 3);
		b.state->v = v;
	}
	return s;
}

static ob_vec3 spin_momentum(const ob_passport *p, const ob_state *x)
{
	ob_mat3 r = ob_quat_matrix(x->pose.q);
	ob_vec3 w = ob_rotate_back(&r, x->w);
	return ob_rotate(&r, ob_v3(p->inertia.x * w.x, p->inertia.y * w.y, p->inertia.z * w.z));
}

// Checks the law from the states before and after the hit's step: impulse and point follow from the sphere's change of
// momentum and the time of the hit. Returns the worst violation, relative to the approach; < 0: no hit.
static double oblique_error(uint64_t *seed, ob_shape other)
{
	double e, mu, worst = -1;
	little_scene *s = oblique(seed, other, &e, &mu);
	const ob_passport *pa = &s->world.passport[0], *pb = &s->world.passport[1];
	const double radius = pa->size.x;
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 90 && worst < 0; step++) {
		ob_state a0 = step ? little_state(&l, 0) : s->state[0], b0 = step ? little_state(&l, 1) : s->state[1];
		ob_counters before, after;
		ob_universe_count(l.u, &before);
		const double energy = little_energy(&l);
		little_run(&l, 1);
		ob_universe_count(l.u, &after);
		ob_state a1 = little_state(&l, 0), b1 = little_state(&l, 1);
		ob_vec3 push = ob_scale(ob_sub(a1.v, a0.v), pa->mass);
		if (ob_norm(push) == 0)
			continue;
		if (after.impacts - before.impacts != 1)
			break; // they collided again before the step's end
		// Time of the hit: both parabolas of the sphere intersect then (straight lines without gravity).
		ob_vec3 dv = ob_sub(a1.v, a0.v), gone = ob_sub(a1.pose.p, a0.pose.p);
		double h = s->run.step_length, rest = ob_dot(ob_sub(gone, ob_scale(a0.v, h)), dv) / ob_norm2(dv),
		       t = h - rest;
		ob_vec3 centre = ob_madd(a0.pose.p, t, a0.v), pb0 = ob_madd(b0.pose.p, t, b0.v), n;
		ob_quat qb = b0.pose.q;
		ob_vec3 wb = b0.w, wb1 = b1.w;
		ob_quat dummy;
		if (pb->mass > 0) {
			ob_rotate_free(b0.pose.q, b0.w, pb->inertia, t, &qb, &wb);
			ob_rotate_free(b1.pose.q, b1.w, pb->inertia, -rest, &dummy, &wb1);
		}
		if (other == OB_SHAPE_SPHERE) {
			n = ob_sub(centre, pb0);
			n = ob_scale(n, 1 / ob_norm(n));
		} else if (other == OB_SHAPE_PLANE) {
			n = ob_v3(0, 0, 1);
		} else {
			ob_mat3 r = ob_quat_matrix(qb);
			ob_vec3 x = ob_rotate_back(&r, ob_sub(centre, pb0)), c = x;
			c.x = fmax(-pb->size.x, fmin(pb->size.x, c.x));
			c.y = fmax(-pb->size.y, fmin(pb->size.y, c.y));
			c.z = fmax(-pb->size.z, fmin(pb->size.z, c.z));
			n = ob_rotate(&r, ob_sub(x, c));
			n = ob_scale(n, 1 / ob_norm(n));
		}
		ob_vec3 arm_a = ob_scale(n, -radius), arm_b = ob_sub(ob_add(centre, arm_a), pb0);
		ob_vec3 u0 = ob_sub(ob_add(a0.v, ob_cross(a0.w, arm_a)), ob_add(b0.v, ob_cross(wb, arm_b)));
		ob_vec3 u1 = ob_sub(ob_add(a1.v, ob_cross(a1.w, arm_a)), ob_add(b1.v, ob_cross(wb1, arm_b)));
		double in = ob_dot(u0, n), out = ob_dot(u1, n), normal = ob_dot(push, n), scale = ob_norm(u0);
		ob_vec3 friction = ob_madd(push, -normal, n), slip = ob_madd(u1, -out, n);
		worst = fabs(out + e * in) / scale;
		if (out < -e * in && little_energy(&l) >= energy * (1 - 1e-12))
			worst = 0; // Newton's law would add energy
		worst = fmax(worst, (ob_norm(friction) - mu * normal) / pa->mass / scale);
		if (ob_norm(slip) > 1e-6 * scale) { // slides on: friction at its bound, against it
			worst = fmax(worst, fabs(ob_norm(friction) - mu * normal) / pa->mass / scale);
			ob_vec3 want = ob_scale(slip, -mu * normal / ob_norm(slip));
			worst = fmax(worst, ob_norm(ob_sub(want, friction)) / pa->mass / scale);
		}
		if (pb->mass > 0) { // momenta
			ob_vec3 db = ob_scale(ob_sub(b1.v, b0.v), pb->mass);
			worst = fmax(worst, ob_norm(ob_add(db, push)) / (pa->mass * scale));
			ob_vec3 l0 = ob_add(ob_add(spin_momentum(pa, &a0), spin_momentum(pb, &b0)),
					    ob_add(ob_scale(ob_cross(a0.pose.p, a0.v), pa->mass),
						   ob_scale(ob_cross(b0.pose.p, b0.v), pb->mass)));
			ob_vec3 l1 = ob_add(ob_add(spin_momentum(pa, &a1), spin_momentum(pb, &b1)),
					    ob_add(ob_scale(ob_cross(a1.pose.p, a1.v), pa->mass),
						   ob_scale(ob_cross(b1.pose.p, b1.v), pb->mass)));
			worst = fmax(worst, ob_norm(ob_sub(l1, l0)) / (pa->mass * scale * radius));
		}
	}
	little_close(&l);
	free(s);
	return worst;
}

static void test_oblique(ob_shape other, int hits)
{
	uint64_t seed = 31;
	int done = 0, wrong = 0;
	double worst = 0;
	for (int k = 0; k < 4 * hits && done < hits; k++) {
		double x = oblique_error(&seed, other);
		done += x >= 0;
		wrong += x > 1e-9;
		worst = fmax(worst, x);
	}
	printf("%d oblique hits of a sphere on shape %d: worst %.1e, %d wrong\n", done, (int)other, worst, wrong);
	CHECK(wrong == 0);
}

// ---- a break

// Fifteen balls in a triangle, touching, hit by a sixteenth along its axis: the result keeps the symmetry.
static void test_break(double e, double mu, double gravity, double turn)
{
	little_scene *s = little_scene_new();
	const double r = .0286, c = cos(turn), d = sin(turn);
	s->run.gravity = ob_v3(0, 0, -gravity);
	ob_world_ground(&s->world);
	for (int row = 0; row < 5; row++)
		for (int k = 0; k <= row; k++) {
			double x = row * r * sqrt(3), y = (2 * k - row) * r;
			ob_world_sphere(&s->world, .17, r, ob_v3(c * x - d * y, d * x + c * y, r));
		}
	ob_world_sphere(&s->world, .17, r, ob_v3(-.3 * c, -.3 * d, r)).state->v = ob_v3(8 * c, 8 * d, 0);
	ob_world_material(&s->world, mu, e);
	little_universe l;
	little_open(&l, s);
	const double before = little_energy(&l);
	for (int step = 0; step < 12; step++) {
		little_run(&l, 1);
		double off = 0;
		for (int row = 0, first = 1; row < 5; first += ++row)
			for (int k = 0; k <= row; k++) {
				ob_vec3 v = little_state(&l, (uint32_t)(first + k)).v,
					w = little_state(&l, (uint32_t)(first + row - k)).v;
				double along = c * v.x + d * v.y, across = c * v.y - d * v.x;
				off = fmax(off, fabs(along - (c * w.x + d * w.y)));
				off = fmax(off, fabs(across + (c * w.y - d * w.x)));
			}
		CHECK(off <= 1e-9);
		CHECK(little_energy(&l) <= before * (1 + 1e-9));
	}
	if (e == 1 && mu == 0 && gravity == 0)
		CHECK_NEAR(little_energy(&l) / before, 1, 1e-12);
	little_close(&l);
	free(s);
}

// A heavy ball knocks a light one, which floats, onto the ground within the step: neither was forecast to come near it.
static void test_knocked_onto_ground(void)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, .4));
	ob_world_sphere(&s->world, 100, .1, ob_v3(0, 0, .65)).state->v = ob_v3(0, 0, -30);
	ob_world_material(&s->world, 0, 1);
	little_universe l;
	little_open(&l, s);
	const double energy = little_energy(&l);
	for (int step = 0; step < 10; step++) {
		little_run(&l, 1);
		CHECK_NEAR(little_energy(&l) / energy, 1, 1e-12);
		CHECK(little_penetration(&l).max_m <= 1e-9);
	}
	little_close(&l);
	free(s);
}

int main(void)
{
	test_knocked_onto_ground();
	for (uint64_t k = 0; k < 20; k++)
		for (int edge = 0; edge < 2; edge++) {
			test_flat_landing(GROUND_PLANE, edge, k % 2 ? .1 * (double)k : 0, k);
			test_flat_landing(GROUND_STATIC_BOX, edge, k % 2 ? .1 * (double)k : 0, k);
			test_flat_landing(GROUND_FREE_BOX, edge, k % 2 ? .1 * (double)k : 0, k);
		}
	test_oblique(OB_SHAPE_PLANE, 500);
	test_oblique(OB_SHAPE_SPHERE, 500);
	test_oblique(OB_SHAPE_BOX, 500);
	test_break(1, 0, 0, 0);
	test_break(1, 0, 9.81, .3);
	test_break(.95, 0, 0, 0);
	test_break(.9, .2, 9.81, .3);
	test_break(0, 0, 0, 0);
	test_break(0, .2, 0, .3);
	test_spaced_row(4);
	test_spaced_row(10);
	test_spaced_row(40);
	test_flat_box(0, .2);
	test_flat_box(.5, .2);
	test_flat_box(.5, .001);
	test_collisions(200, 100);
	test_collisions(500, 100);
	test_collisions(1000, 100);
	return check_end();
}
