// Impacts: momentum is conserved to rounding, Newton's and Coulomb's laws hold at the points that hit, energy never
// grows, and the order of points is irrelevant.
#include "contact/impact.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "pair.h"

static const double substep = 1e-3; // s

enum { MOST_BODIES = 32, MOST_POINTS = 96 };

// Bodies about the places p, and the points at which they hit.
typedef struct hit {
	uint32_t bodies, points;
	body of[MOST_BODIES];
	ob_impact_body before[MOST_BODIES], after[MOST_BODIES];
	ob_impact_point point[MOST_POINTS];
} hit;

static uint32_t add_body(hit *h, body b, ob_vec3 v, ob_vec3 w)
{
	ob_impact_body *x = &h->before[h->bodies];
	*x = (ob_impact_body){ .inv_mass = b.inv_mass };
	memcpy(x->inv_inertia, b.inv_inertia, sizeof x->inv_inertia);
	if (b.inv_mass > 0)
		x->v = v, x->w = w;
	h->of[h->bodies] = b;
	return h->bodies++;
}

static void add_point(hit *h, uint32_t a, uint32_t b, ob_vec3 at, ob_vec3 normal, double mu, double e)
{
	h->point[h->points++] =
		(ob_impact_point){ a, b, normal, ob_sub(at, h->of[a].p), ob_sub(at, h->of[b].p), mu, e };
}

static void solve(hit *h)
{
	memcpy(h->after, h->before, sizeof h->after);
	ob_impact_solve(h->after, h->bodies, h->point, h->points, NULL, NULL);
}

static double energy_of(const hit *h, const ob_impact_body *x)
{
	double sum = 0;
	for (uint32_t i = 0; i < h->bodies; i++)
		if (x[i].inv_mass > 0)
			sum += .5 * ob_norm2(x[i].v) / x[i].inv_mass +
			       .5 * ob_dot(x[i].w, ob_rotate(&h->of[i].inertia, x[i].w));
	return sum;
}

static void check_conserved(const hit *h)
{
	ob_vec3 p = { 0, 0, 0 }, l = p;
	double scale_p = 0, scale_l = 0;
	for (uint32_t i = 0; i < h->bodies; i++) {
		if (!(h->before[i].inv_mass > 0))
			return;
		ob_vec3 dp = ob_scale(ob_sub(h->after[i].v, h->before[i].v), h->of[i].mass);
		ob_vec3 dl = ob_add(ob_cross(h->of[i].p, dp),
				    ob_rotate(&h->of[i].inertia, ob_sub(h->after[i].w, h->before[i].w)));
		p = ob_add(p, dp), l = ob_add(l, dl);
		const double size = h->of[i].mass * ob_norm(h->before[i].v),
			     spin = ob_norm(ob_rotate(&h->of[i].inertia, h->before[i].w));
		scale_p += ob_norm(dp) + size, scale_l += ob_norm(dl) + ob_norm(dp) + size + spin;
	}
	CHECK(ob_norm(p) <= 1e-14 * scale_p);
	CHECK(ob_norm(l) <= 1e-13 * scale_l);
}

static ob_vec3 sliding(const ob_impact_body *x, const ob_impact_point *p)
{
	const ob_impact_body *a = &x[p->a], *b = &x[p->b];
	ob_vec3 u = ob_sub(ob_add(a->v, ob_cross(a->w, p->arm_a)), ob_add(b->v, ob_cross(b->w, p->arm_b)));
	return ob_madd(u, -ob_dot(u, p->normal), p->normal);
}

static hit random_hit(uint64_t *seed, double mass_ratio)
{
	pair p = random_pair(seed, mass_ratio);
	hit h = { .bodies = 0 };
	double e = within(seed, 0, 1);
	add_body(&h, p.a, random_vector(seed, 1), random_vector(seed, 1));
	add_body(&h, p.b, random_vector(seed, 1), random_vector(seed, 1));
	for (int j = 0; j < p.points; j++)
		add_point(&h, 0, 1, ob_add(p.a.p, p.arm_a[j]), p.normal, p.mu, e);
	return h;
}

// Impact at one point: the change of velocity gives the impulse. It obeys Newton's law to the last digits, or energy
// would grow; and Coulomb's.
static bool check_one_point(const hit *h)
{
	const ob_impact_point *p = &h->point[0];
	double in = ob_impact_opening(h->before, p), out = ob_impact_opening(h->after, p);
	if (in >= 0)
		return true;
	ob_vec3 push = ob_scale(ob_sub(h->after[0].v, h->before[0].v), h->of[0].mass), slip = sliding(h->after, p);
	double normal = ob_dot(push, p->normal), scale = fabs(normal) * h->before[0].inv_mass;
	ob_vec3 friction = ob_madd(push, -normal, p->normal);
	CHECK(ob_norm(friction) <= p->mu * normal * (1 + 1e-12) + 1e-11 * normal + 1e-14 * h->of[0].mass);
	bool newton = fabs(out + p->e * in) <= 1e-10 * (scale + fabs(in));
	if (!newton) {
		CHECK(out < -p->e * in); // less than by the law, which would add energy
		CHECK_NEAR(energy_of(h, h->after) / energy_of(h, h->before), 1, 1e-12);
		return false;
	}
	if (p->mu > 0 && ob_norm(slip) > 1e-9) {
		CHECK_NEAR(ob_norm(friction), p->mu * normal, 1e-9 * normal);
		CHECK(ob_dot(friction, slip) <= -(1 - 1e-9) * ob_norm(friction) * ob_norm(slip));
	}
	return true;
}

// Random masses, inertias and points, with and without friction.
static void test_random(void)
{
	uint64_t seed = 1;
	int hits = 0, single = 0, limited = 0;
	int missed = 0; // violations of the law for a set of points that Newton's method has not solved to the end
	for (int i = 0; i < 20000; i++) {
		double ratio = i % 4 == 3 ? INFINITY : pow(10, within(&seed, -3, 3));
		hit h = random_hit(&seed, ratio);
		for (uint32_t j = 0; j < h.points && i % 3 == 0; j++)
			h.point[j].mu = 0;
		solve(&h);
		double before = energy_of(&h, h.before), after = energy_of(&h, h.after);
		CHECK(after <= before * (1 + 1e-13));
		check_conserved(&h);
		bool any = false;
		for (uint32_t j = 0; j < h.points; j++) {
			double in = ob_impact_opening(h.before, &h.point[j]);
			any |= in < 0;
			if (in < 0 && h.point[j].mu == 0)
				missed += !(ob_impact_opening(h.after, &h.point[j]) >= -h.point[j].e * in - 1e-9);
		}
		hits += any;
		CHECK(any || after == before);
		if (h.points == 1 && any) {
			single++;
			limited += !check_one_point(&h);
		}
	}
	printf("%d hits; %d at one point, %d of them would bring energy\n", hits, single, limited);
	printf("%d points did not leave as fast as they must\n", missed);
	CHECK(missed <= hits / 5000);
	CHECK(hits > 10000);
	CHECK(limited < single / 4);
}

// Crowds of up to so many bodies that hit each other at up to so many points, elastic or not.
static void test_crowds(void)
{
	uint64_t seed = 2;
	static hit h;
	for (int i = 0; i < 200; i++) {
		h.bodies = h.points = 0;
		const double most = pow(MOST_POINTS, within(&seed, 0, 1));
		while (h.bodies < MOST_BODIES)
			add_body(&h, random_body(&seed, within(&seed, .1, 10)), random_vector(&seed, 1),
				 random_vector(&seed, 1));
		while (h.points < most) {
			const uint32_t a = (uint32_t)within(&seed, 0, MOST_BODIES),
				       b = (a + 1 + h.points % (MOST_BODIES - 1)) % MOST_BODIES;
			add_point(&h, a, b, random_vector(&seed, 1), random_direction(&seed),
				  i % 3 ? within(&seed, 0, 1) : 0, i % 2 ? within(&seed, 0, 1) : 0);
		}
		solve(&h);
		CHECK(energy_of(&h, h.after) <= energy_of(&h, h.before) * (1 + 1e-12));
		check_conserved(&h);
	}
}

// Balls on one line, 1:1 to 1:1000, against the textbook's solution.
static void test_central(void)
{
	static const double ratio[] = { 1, 2, 1000, 1e-3 }, restitution[] = { 0, .5, .8, 1 };
	for (int i = 0; i < 16; i++) {
		double r = ratio[i % 4], e = restitution[i / 4], k = .4;
		hit h = { .bodies = 0 };
		body a = {
			.mass = 1, .inv_mass = 1, .p = { 1, 0, 0 }, .inv_inertia = { 1 / k, 0, 0, 1 / k, 0, 1 / k }
		};
		body b = { .mass = r, .inv_mass = 1 / r, .p = { -1, 0, 0 } };
		memcpy(b.inv_inertia, (double[6]){ 1 / k / r, 0, 0, 1 / k / r, 0, 1 / k / r }, sizeof b.inv_inertia);
		add_body(&h, a, ob_v3(-3, 0, 0), ob_v3(0, 0, 0));
		add_body(&h, b, ob_v3(0, 0, 0), ob_v3(0, 0, 0));
		add_point(&h, 0, 1, ob_v3(0, 0, 0), ob_v3(1, 0, 0), .5, e);
		solve(&h);
		CHECK_NEAR(h.after[0].v.x, -3 * (1 - e * r) / (1 + r), 1e-12);
		CHECK_NEAR(h.after[1].v.x, -3 * (1 + e) / (1 + r), 1e-12);
		CHECK(h.after[0].v.y == 0 && h.after[0].v.z == 0 && ob_norm(h.after[0].w) == 0);
		CHECK(h.after[1].v.y == 0 && h.after[1].v.z == 0 && ob_norm(h.after[1].w) == 0);
	}
}

// A box of any proportions that lands flat on a face or an edge, with any friction: it rebounds at e times its speed,
// without sideways motion or spin.
static void test_flat(void)
{
	uint64_t seed = 5;
	for (int i = 0; i < 2000; i++) {
		ob_vec3 half = ob_v3(pow(10, within(&seed, -1, 1)), pow(10, within(&seed, -1, 1)),
				     pow(10, within(&seed, -1, 1)));
		double e = within(&seed, .2, 1), mu = within(&seed, 0, 1), speed = within(&seed, .1, 10);
		ob_vec3 k = ob_v3(3 / (half.y * half.y + half.z * half.z), 3 / (half.z * half.z + half.x * half.x),
				  3 / (half.x * half.x + half.y * half.y));
		hit h = { .bodies = 0 };
		body box = { .mass = 1, .inv_mass = 1, .inv_inertia = { k.x, 0, 0, k.y, 0, k.z } };
		add_body(&h, box, ob_v3(0, 0, -speed), ob_v3(0, 0, 0));
		add_body(&h, fixed_body(), ob_v3(0, 0, 0), ob_v3(0, 0, 0));
		for (int j = 0; j < 4; j++)
			add_point(&h, 0, 1, ob_v3(j & 1 ? half.x : -half.x, j & 2 ? half.y : -half.y, -half.z),
				  ob_v3(0, 0, 1), mu, e);
		solve(&h);
		CHECK_NEAR(h.after[0].v.z, e * speed, 1e-12 * speed);
		CHECK(hypot(h.after[0].v.x, h.after[0].v.y) <= 1e-12 * speed);
		CHECK(ob_norm(h.after[0].w) * ob_norm(half) <= 1e-11 * speed);
	}
}

// The same points in any order, and rotated by any angle, give the same velocities.
static void test_order_and_turn(void)
{
	uint64_t seed = 6;
	for (int i = 0; i < 2000; i++) {
		hit h = random_hit(&seed, i % 2 ? INFINITY : within(&seed, .2, 5)), other = h;
		solve(&h);
		for (uint32_t j = 0; j < h.points; j++)
			other.point[j] = h.point[h.points - 1 - j];
		solve(&other);
		for (uint32_t j = 0; j < 2; j++) {
			CHECK(ob_norm(ob_sub(h.after[j].v, other.after[j].v)) <= 1e-11);
			CHECK(ob_norm(ob_sub(h.after[j].w, other.after[j].w)) <= 1e-10);
		}
		ob_mat3 r = ob_quat_matrix(random_attitude(&seed));
		for (uint32_t j = 0; j < 2; j++) {
			ob_impact_body *x = &other.before[j];
			double s[3][3] = { { 0 } }, t[3][3] = { { 0 } };
			const double *w = h.before[j].inv_inertia;
			const double full[3][3] = { { w[0], w[1], w[2] }, { w[1], w[3], w[4] }, { w[2], w[4], w[5] } };
			for (int a = 0; a < 3; a++)
				for (int b = 0; b < 3; b++)
					for (int c = 0; c < 3; c++)
						s[a][b] += r.m[a][c] * full[c][b];
			for (int a = 0; a < 3; a++)
				for (int b = 0; b < 3; b++)
					for (int c = 0; c < 3; c++)
						t[a][b] += s[a][c] * r.m[b][c];
			memcpy(x->inv_inertia, (double[6]){ t[0][0], t[0][1], t[0][2], t[1][1], t[1][2], t[2][2] },
			       sizeof x->inv_inertia);
			x->v = ob_rotate(&r, h.before[j].v), x->w = ob_rotate(&r, h.before[j].w);
		}
		for (uint32_t j = 0; j < h.points; j++) {
			ob_impact_point *p = &other.point[j];
			*p = h.point[j];
			p->normal = ob_rotate(&r, p->normal);
			p->arm_a = ob_rotate(&r, p->arm_a), p->arm_b = ob_rotate(&r, p->arm_b);
		}
		solve(&other);
		for (uint32_t j = 0; j < 2; j++) {
			CHECK(ob_norm(ob_sub(ob_rotate(&r, h.after[j].v), other.after[j].v)) <= 1e-10);
			CHECK(ob_norm(ob_sub(ob_rotate(&r, h.after[j].w), other.after[j].w)) <= 1e-9);
		}
	}
}

// ---- time of impact, from the rows of a batch

typedef struct approach {
	pair p;
	ob_body_row v[3], dv[3], d[3]; // rows 1 and 2 are a and b
} approach;

static double time_of(approach *x, double threshold)
{
	ob_batch b;
	ob_batch_init(&b, OB_KIND_FULL);
	put_pair(&b, 1, &x->p, 1, x->p.b.inv_mass > 0 ? 2 : 0);
	ob_batch_prepare(&b);
	ob_impact in = { .h = substep, .threshold = threshold, .gain = INFINITY, .points = ~0u };
	ob_impact_rows at = { x->v, x->dv, x->d };
	CHECK(isinf(ob_impact_time(&b, 0, &in, &at))); // an empty lane
	return ob_impact_time(&b, 1, &in, &at);
}

static approach falling_point(double gap, double speed)
{
	approach x = { .p = { .normal = { 0, 0, 1 }, .points = 1, .e = 1, .gap = { gap } } };
	x.p.a = (body){ .mass = 1, .inv_mass = 1, .inv_inertia = { 1, 0, 0, 1, 0, 1 } };
	x.p.arm_a[0] = ob_v3(0, 0, -.5);
	x.v[1][2] = -speed;
	return x;
}

// Time of impact of a falling ball's parabola.
static void test_instant(void)
{
	uint64_t seed = 3;
	for (int i = 0; i < 1000; i++) {
		double g = -9.81, v = -within(&seed, .1, 20), t = uniform(&seed) * substep;
		approach x = falling_point(-(v * t + .5 * g * t * t), -v);
		x.dv[1][2] = g * substep;
		CHECK_NEAR(time_of(&x, 1e-6), t, 1e-15);
	}
}

// Out of reach, too slow, opening, or already displaced: none, or the right time.
static void test_pending(void)
{
	approach x = falling_point(.01, 9);
	CHECK(isinf(time_of(&x, 1e-6)));
	x.d[1][2] = -.005; // half of the gap is gone
	CHECK_NEAR(time_of(&x, 1e-6), .005 / 9, 1e-15);
	x = falling_point(0, 5e-7);
	CHECK(isinf(time_of(&x, 1e-6)));
	x = falling_point(0, -1);
	CHECK(isinf(time_of(&x, 1e-6)));
}

typedef struct purse {
	uint64_t work, left;
	int calls;
} purse;

static bool pay(void *with, uint64_t work)
{
	purse *p = with;
	p->work += work;
	p->calls++;
	return p->work > p->left;
}

// A plate that lands on its many points: the work is reported to the callback, which can stop the impact at once.
static void test_payer(void)
{
	enum { SIDE = 8 };
	ob_impact_point point[SIDE * SIDE];
	const ob_impact_body plate = {
		.inv_mass = 1, .inv_inertia = { 3, 0, 0, 3, 0, 1.5 }, .v = { 1, .3, -2 }, .w = { .2, .1, 3 }
	};
	ob_impact_body unpaid[2] = { plate }, paid[2] = { plate }, cut[2] = { plate };
	for (int i = 0; i < SIDE * SIDE; i++) {
		const ob_vec3 at = ob_v3((i % SIDE) / 7. - .5, (i / SIDE) / 7. - .5, -.1);
		point[i] =
			(ob_impact_point){ .b = 1, .normal = { 0, 0, 1 }, .arm_a = at, .arm_b = at, .mu = .3, .e = .5 };
	}
	purse rich = { .left = UINT64_MAX }, poor = { .left = 0 };
	ob_impact_solve(unpaid, 2, point, SIDE * SIDE, NULL, NULL);
	ob_impact_solve(paid, 2, point, SIDE * SIDE, NULL, &(ob_impact_payer){ pay, &rich });
	ob_impact_solve(cut, 2, point, SIDE * SIDE, NULL, &(ob_impact_payer){ pay, &poor });
	CHECK(memcmp(unpaid, paid, sizeof paid) == 0);
	CHECK(rich.work >= (uint64_t)rich.calls * SIDE * SIDE && rich.calls > 100);
	CHECK(poor.calls < 10);
}

static void share_nothing(void *with, ob_impact_change *change)
{
	(void)change;
	++*(int *)with;
}

// A plate over more points than Newton's method takes. Those that open make no difference, however many; nor does a
// joint that carries nothing, which is asked once in an iteration and not for each row.
static void test_many(void)
{
	enum { SIDE = 8, POINTS = SIDE * SIDE };
	ob_impact_point all[POINTS], closing[POINTS];
	const ob_impact_body turns = { .inv_mass = 1, .inv_inertia = { 3, 0, 0, 3, 0, 1.5 }, .w = { 2, 0, 0 } },
			     lands = { .inv_mass = 1, .inv_inertia = { 3, 0, 0, 3, 0, 1.5 }, .v = { 1, .3, -2 } };
	uint32_t n = 0;
	for (int i = 0; i < POINTS; i++) {
		const ob_vec3 at = ob_v3((i % SIDE) / 7. - .5, (i / SIDE) / 7. - .5, -.1);
		all[i] =
			(ob_impact_point){ .b = 1, .normal = { 0, 0, 1 }, .arm_a = at, .arm_b = at, .mu = .3, .e = .5 };
		if (at.y < 0)
			closing[n++] = all[i];
	}
	ob_impact_body some[2] = { turns }, whole[2] = { turns }, held[2] = { lands }, loose[2] = { lands };
	int asked = 0;
	ob_impact_solve(some, 2, closing, n, NULL, NULL);
	ob_impact_solve(whole, 2, all, POINTS, NULL, NULL);
	CHECK(n < POINTS && memcmp(some, whole, sizeof whole) == 0);
	ob_impact_solve(loose, 2, all, POINTS, NULL, NULL);
	ob_impact_solve(held, 2, all, POINTS, &(ob_impact_links){ share_nothing, &asked }, NULL);
	CHECK(memcmp(loose, held, sizeof held) == 0);
	CHECK(loose[0].v.z > 0);
	CHECK(asked > 0);
}

int main(void)
{
	test_payer();
	test_many();
	test_crowds();
	test_random();
	test_central();
	test_flat();
	test_order_and_turn();
	test_instant();
	test_pending();
	return check_end();
}
