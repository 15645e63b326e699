// Impacts: what goes in comes out. Momentum to rounding, Newton's law at the points that hit, energy never more.
#include "contact/impact.h"

#include "check.h"
#include "pair.h"

static const double substep = 1e-3; // s

typedef struct collision {
	pair p;
	ob_body_row before[3], dv[3], d[3], after[3], shift[3]; // rows 1 and 2 are a and b
	bool hit;
} collision;

static void collide(collision *c)
{
	ob_batch b;
	ob_batch_init(&b, OB_KIND_FULL);
	put_pair(&b, 1, &c->p, 1, c->p.b.inv_mass > 0 ? 2 : 0);
	ob_batch_prepare(&b);
	ob_impact in = { substep, substep, c->p.e, 1e-6, 1, 1 };
	ob_impact_rows at = { c->before, c->dv, c->d };
	memcpy(c->after, c->before, sizeof c->after);
	memcpy(c->shift, c->d, sizeof c->shift);
	bool pending = ob_impact_time(&b, 1, &in, &at) <= substep;
	c->hit = ob_impact_solve(&b, 1, &in, &at, c->after, c->shift) >= 0;
	CHECK(c->hit == pending);
	CHECK(isinf(ob_impact_time(&b, 0, &in, &at))); // an empty lane
}

static collision random_collision(uint64_t *seed, double mass_ratio)
{
	collision c = { .p = random_pair(seed, mass_ratio) };
	c.p.e = within(seed, 0, 1);
	random_row(seed, &c.p.a, c.before[1]);
	random_row(seed, &c.p.b, c.before[2]);
	return c;
}

static void check_conserved(const collision *c)
{
	const body *a = &c->p.a, *b = &c->p.b;
	ob_vec3 change_a = ob_sub(momentum(a, c->after[1]), momentum(a, c->before[1]));
	ob_vec3 change_b = ob_sub(momentum(b, c->after[2]), momentum(b, c->before[2]));
	double scale = ob_norm(momentum(a, c->before[1])) + ob_norm(momentum(b, c->before[2])) + ob_norm(change_a);
	CHECK_NEAR(ob_norm(ob_add(change_a, change_b)) / scale, 0, 1e-15);
	change_a = ob_sub(angular_momentum(a, c->after[1]), angular_momentum(a, c->before[1]));
	change_b = ob_sub(angular_momentum(b, c->after[2]), angular_momentum(b, c->before[2]));
	scale = ob_norm(angular_momentum(a, c->before[1])) + ob_norm(angular_momentum(b, c->before[2])) +
		ob_norm(change_a);
	CHECK_NEAR(ob_norm(ob_add(change_a, change_b)) / scale, 0, 1e-14);
}

static double total_energy(const collision *c, const ob_body_row *rows)
{
	return energy(&c->p.a, rows[1]) + (c->p.b.inv_mass > 0 ? energy(&c->p.b, rows[2]) : 0);
}

// Without friction no point leaves slower than Newton's law says: by how much it does (m/s).
static double newton_missing(const collision *c)
{
	double missing = 0;
	for (int j = 0; j < c->p.points && c->p.mu == 0; j++) {
		double in = opening(&c->p, j, c->before[1], c->before[2]);
		double out = opening(&c->p, j, c->after[1], c->after[2]);
		if (in < -1e-6)
			missing = fmax(missing, -c->p.e * in - out);
	}
	return missing;
}

// Any masses, inertias and points, with and without friction.
static void test_random(void)
{
	uint64_t seed = 1;
	int hits = 0;
	for (int i = 0; i < 20000; i++) {
		double ratio = i % 4 == 3 ? INFINITY : pow(10, within(&seed, -3, 3));
		collision c = random_collision(&seed, ratio);
		if (i % 3 == 0)
			c.p.mu = 0;
		collide(&c);
		double before = total_energy(&c, c.before), after = total_energy(&c, c.after);
		if (!c.hit) {
			CHECK(after == before);
			continue;
		}
		hits++;
		CHECK(after <= before * (1 + 1e-12));
		if (!isinf(ratio))
			check_conserved(&c);
		CHECK(newton_missing(&c) < 1e-8);
	}
	CHECK(hits > 5000);
}

// One point without friction: exactly -e times the approach, and the energy that goes with it.
static void test_newton(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 5000; i++) {
		collision c = random_collision(&seed, pow(10, within(&seed, -3, 3)));
		c.p.points = 1;
		c.p.mu = 0;
		collide(&c);
		double in = opening(&c.p, 0, c.before[1], c.before[2]), out = opening(&c.p, 0, c.after[1], c.after[2]);
		CHECK(c.hit == (in < -1e-6));
		CHECK_NEAR(out, c.hit ? -c.p.e * in : in, 1e-12);
	}
}

// Balls on one line, 1:1 to 1:1000, with the textbook's answer.
static void test_central(void)
{
	static const double ratio[] = { 1, 2, 1000, 1e-3 }, restitution[] = { 0, .5, .8, 1 };
	for (int i = 0; i < 16; i++) {
		double r = ratio[i % 4], e = restitution[i / 4], k = .4;
		collision c = { .p = { .normal = { 1, 0, 0 }, .points = 1, .mu = .5, .e = e } };
		c.p.a = (body){ .mass = 1, .inv_mass = 1, .inv_inertia = { 1 / k, 0, 0, 1 / k, 0, 1 / k } };
		c.p.b = (body){ .mass = r, .inv_mass = 1 / r };
		memcpy(c.p.b.inv_inertia, (double[6]){ 1 / k / r, 0, 0, 1 / k / r, 0, 1 / k / r },
		       sizeof c.p.b.inv_inertia);
		c.p.arm_a[0] = ob_v3(-1, 0, 0);
		c.p.arm_b[0] = ob_v3(1, 0, 0);
		c.before[1][0] = -3;
		collide(&c);
		CHECK(c.hit);
		CHECK_NEAR(c.after[1][0], -3 * (1 - e * r) / (1 + r), 1e-12);
		CHECK_NEAR(c.after[2][0], -3 * (1 + e) / (1 + r), 1e-12);
		for (int x = 1; x < 6; x++)
			CHECK(c.after[1][x] == 0 && c.after[2][x] == 0);
	}
}

// A ball that falls on the ground within the substep: it bounces at its instant, so velocity and place at the end are
// those of the two parabolas.
static void test_instant(void)
{
	uint64_t seed = 3;
	for (int i = 0; i < 1000; i++) {
		double g = -9.81, v = -within(&seed, .1, 20), e = uniform(&seed), t = uniform(&seed) * substep;
		double gap = -(v * t + .5 * g * t * t), h = substep;
		collision c = { .p = { .normal = { 0, 0, 1 }, .points = 1, .e = e, .gap = { gap } } };
		c.p.a = (body){ .mass = 1, .inv_mass = 1, .inv_inertia = { 1, 0, 0, 1, 0, 1 } };
		c.p.arm_a[0] = ob_v3(0, 0, -.5);
		c.before[1][2] = v;
		c.dv[1][2] = g * h;
		collide(&c);
		CHECK(c.hit);
		double up = -e * (v + g * t), rest = h - t;
		CHECK_NEAR(c.after[1][2] + g * h, up + g * rest, 1e-12);
		double fallen = c.shift[1][2] + c.after[1][2] * h + .5 * g * h * h;
		CHECK_NEAR(gap + fallen, up * rest + .5 * g * rest * rest, 1e-13);
	}
}

// Out of reach, too slow, opening, or already on its way by a displacement: nothing, or the right instant.
static void test_pending(void)
{
	collision c = { .p = { .normal = { 0, 0, 1 }, .points = 1, .e = 1, .gap = { .01 } } };
	c.p.a = (body){ .mass = 1, .inv_mass = 1, .inv_inertia = { 1, 0, 0, 1, 0, 1 } };
	c.p.arm_a[0] = ob_v3(0, 0, -.5);
	c.before[1][2] = -9;
	collide(&c);
	CHECK(!c.hit);
	CHECK(memcmp(c.after, c.before, sizeof c.after) == 0 && memcmp(c.shift, c.d, sizeof c.d) == 0);
	c.d[1][2] = -.005; // half of the gap is gone
	collide(&c);
	CHECK(c.hit);
	CHECK_NEAR(c.shift[1][2] - c.d[1][2], -18 * .005 / 9, 1e-15);
	c.p.gap[0] = c.d[1][2] = 0;
	c.before[1][2] = -5e-7;
	collide(&c);
	CHECK(!c.hit);
	c.before[1][2] = 1;
	collide(&c);
	CHECK(!c.hit);
}

// A rod that falls aslant: its lower end hits, and the other is left until what happens to it is known. Ends that come
// down together hit together.
static void test_one_after_another(void)
{
	collision c = { .p = { .normal = { 0, 0, 1 }, .points = 2, .e = 1, .gap = { .002, .004 } } };
	c.p.a = (body){ .mass = 1, .inv_mass = 1, .inv_inertia = { 1, 0, 0, 1, 0, 1 } };
	c.p.arm_a[0] = ob_v3(-1, 0, 0);
	c.p.arm_a[1] = ob_v3(1, 0, 0);
	c.before[1][2] = -8;
	collide(&c);
	CHECK(c.hit);
	CHECK_NEAR(opening(&c.p, 0, c.after[1], c.after[2]), 8, 1e-12);
	CHECK(c.after[1][4] != 0);
	CHECK_NEAR(c.shift[1][2], -(c.after[1][2] + 8) * .002 / 8, 1e-15);
	c.p.gap[1] = .002;
	collide(&c);
	CHECK_NEAR(c.after[1][2], 8, 1e-12);
	CHECK_NEAR(c.after[1][4], 0, 1e-12);
}

// A body that takes part in k impacts at once has a k-th of its mass in each.
static void test_split(void)
{
	uint64_t seed = 4;
	for (int i = 0; i < 500; i++) {
		collision c = random_collision(&seed, 1);
		c.p.points = 1;
		c.p.mu = 0;
		c.p.e = 1;
		ob_batch b;
		ob_batch_init(&b, OB_KIND_FULL);
		put_pair(&b, 0, &c.p, 1, 2);
		ob_batch_prepare(&b);
		ob_body_row whole[3] = { 0 }, half[3] = { 0 }, d[3] = { 0 };
		ob_impact_rows at = { c.before, c.dv, c.d };
		ob_impact once = { substep, substep, 1, 1e-6, 1, 1 }, twice = { substep, substep, 1, 1e-6, 2, 2 };
		bool hit = ob_impact_solve(&b, 0, &once, &at, whole, d) >= 0;
		CHECK(hit == (ob_impact_solve(&b, 0, &twice, &at, half, d) >= 0));
		for (int x = 0; x < 6; x++)
			CHECK_NEAR(half[1][x], .5 * whole[1][x], 1e-12);
	}
}

int main(void)
{
	test_random();
	test_newton();
	test_central();
	test_instant();
	test_pending();
	test_split();
	test_one_after_another();
	return check_end();
}
