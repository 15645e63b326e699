// Time of impact of two moving shapes: never too late, at any speed and spin; and exact to rounding, where requested.
#include "contact/manifold.h"

#include "check.h"
#include "motion/spin.h"
#include "placed.h"

static void find(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	CHECK(ob_manifold_find(a, b, margin, out));
}
static const ob_manifold_finder shapes = { find, NULL, false };

static ob_placed moved(const ob_placed *x, double t)
{
	ob_quat turn;
	ob_vec3 rate;
	ob_rotate_free(ob_quat_identity(), ob_rotate_back(&x->r, x->w), x->inertia, t, &turn, &rate);
	ob_mat3 m = ob_quat_matrix(turn);
	ob_placed y = *x;
	y.p = ob_madd(x->p, t, x->v);
	for (int c = 0; c < 3; c++) {
		ob_vec3 axis = ob_rotate(&x->r, ob_column(&m, c));
		y.r.m[0][c] = axis.x, y.r.m[1][c] = axis.y, y.r.m[2][c] = axis.z;
	}
	return y;
}

// m; negative if they overlap
static double separation(const ob_placed *a, const ob_placed *b, double t)
{
	ob_placed at = moved(a, t), bt = moved(b, t);
	ob_manifold m;
	ob_manifold_find(&at, &bt, 0, &m);
	return m.separation;
}

static double radius(const ob_placed *x)
{
	return ob_shape_radius(x->shape, x->size);
}

// rad/s, at any time
static double fastest(const ob_placed *x)
{
	return ob_spin_bound(ob_quat_identity(), ob_rotate_back(&x->r, x->w), x->inertia);
}

static double closing_speed(const ob_placed *a, const ob_placed *b)
{
	double spin = radius(a) * fastest(a) + (b->shape == OB_SHAPE_PLANE ? 0 : radius(b) * fastest(b));
	return ob_norm(ob_sub(a->v, b->v)) + spin;
}

// A ball at a thin wall: it would be far behind it at the end of the step.
static void test_bullet(void)
{
	static const double speed[] = { 10, 100, 1000, 10000 };
	ob_placed wall = place(OB_SHAPE_BOX, ob_v3(.01, 2, 2), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed ball = place(OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), ob_v3(-.5, .3, .2), ob_quat_identity());
	for (int i = 0; i < 4; i++) {
		double v = speed[i], tolerance = 1e-3, exact = (.5 - .1 - .01) / v;
		ob_manifold m;
		ball.v = ob_v3(v, 0, 0);
		double t = ob_time_of_impact(&ball, &wall, v, .1, tolerance, .5, shapes, &m);
		CHECK(t <= exact && t >= exact - tolerance / v);
		CHECK(m.points == 1);
		CHECK_NEAR(m.normal.x, -1, 1e-12);
		CHECK_NEAR(m.gap[0], v * (exact - t), 1e-12); // at the impact
		t = ob_time_of_impact(&ball, &wall, v, .9 * exact, tolerance, .5, shapes, &m);
		CHECK(isinf(t));
		CHECK(m.points == 0);
		CHECK_NEAR(m.separation, .5 - .1 - .01, 1e-12); // now
		ball.v = ob_v3(-v, 0, 0);
		CHECK(isinf(ob_time_of_impact(&ball, &wall, v, .1, tolerance, .5, shapes, &m)));
	}
}

// A square plate lands with one edge first: the manifold includes other points up to the margin.
static void test_margin(void)
{
	ob_quat tilted = ob_quat_turn(ob_quat_identity(), ob_v3(0, .05, 0));
	ob_placed floor = place(OB_SHAPE_PLANE, ob_v3(0, 0, 0), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed plate = place(OB_SHAPE_BOX, ob_v3(1, 1, .1), ob_v3(0, 0, 2), tilted);
	plate.v = ob_v3(0, 0, -300);
	for (int wide = 0; wide < 2; wide++) {
		ob_manifold m;
		double t = ob_time_of_impact(&plate, &floor, 300, .016, 1e-3, wide ? .15 : .01, shapes, &m);
		CHECK_NEAR(t, (2 - half_width(&plate, ob_v3(0, 0, 1))) / 300, 1e-3 / 300);
		CHECK(m.points == (wide ? 4 : 2));
	}
}

static void test_touching_now(void)
{
	uint64_t seed = 1;
	for (int i = 0; i < 200; i++) {
		ob_placed a = random_placed(&seed, OB_SHAPE_BOX, .05), b = random_placed(&seed, OB_SHAPE_SPHERE, .05);
		ob_manifold m;
		a.v = random_vector(&seed, 10);
		CHECK(ob_time_of_impact(&a, &b, 20, .01, 1e-3, .1, shapes, &m) == 0);
		CHECK(m.points > 0);
	}
}

// A cube that has hit a thin wall with one corner rotates so fast, just off it, that one search cannot follow its path
// to the end: the next impact must not be missed.
static void test_turning_fast(void)
{
	const ob_placed wall = place(OB_SHAPE_BOX, ob_v3(.01, 4, 4), ob_v3(0, 0, 0), ob_quat_identity());
	uint64_t seed = 3;
	for (int i = 0; i < 2000; i++) {
		const double tolerance = pow(10, within(&seed, -6, -3)), h = 2e-3;
		ob_placed cube = place(OB_SHAPE_BOX, ob_v3(.1, .1, .1), ob_v3(0, 0, 0), random_attitude(&seed));
		ob_manifold m;
		cube.p.x = -.01 - 2e-5 - half_width(&cube, ob_v3(1, 0, 0));
		cube.v = ob_v3(183, -26, 9);
		cube.w = ob_scale(random_direction(&seed), 1500);
		double t = ob_time_of_impact(&cube, &wall, closing_speed(&cube, &wall), h, tolerance, tolerance, shapes,
					     &m);
		CHECK(t >= 0 && t < h); // by then it would be far behind the wall
		for (int k = 0; k <= 100; k++)
			CHECK(separation(&cube, &wall, fmin(t, h) * k / 100) > 0);
	}
}

// Up to the forecast nothing comes this near; soon after it, something does, except for a grazing pass.
static void check_forecast(const ob_placed *a, const ob_placed *b, double h, double near)
{
	const double soon = .3 * h, speed = closing_speed(a, b);
	double apart, free = ob_time_of_nearing(a, b, speed, h, h, near, shapes, &apart),
		      early = ob_time_of_nearing(a, b, speed, h, soon, near, shapes, &apart);
	for (int k = 0; k <= 300; k++)
		CHECK(separation(a, b, fmin(free, h) * k / 300) > .4 * near);
	for (int k = 0; k <= 300; k++)
		CHECK(separation(a, b, fmin(early, h) * k / 300) > .4 * near);
	CHECK(apart <= separation(a, b, 0) + 1e-12);
	CHECK(free <= soon ? early == free : early > soon);
	if (free <= h)
		CHECK(separation(a, b, free) <= near + 1e-9 || separation(a, b, free) < .02);
}

// Random shapes, speeds and spins: up to the time of impact they do not overlap, and then they are near.
static void check_meeting(const ob_placed *a, const ob_placed *b, double h, int *met)
{
	ob_manifold m;
	double tolerance = 1e-3;
	double t = ob_time_of_impact(a, b, closing_speed(a, b), h, tolerance, .05, shapes, &m);
	double end = isinf(t) ? h : t;
	for (int k = 0; k <= 300; k++)
		CHECK(separation(a, b, end * k / 300) > 0);
	ob_manifold first;
	double free = ob_time_of_impact(a, b, closing_speed(a, b), h, tolerance, tolerance, shapes, &first);
	for (int k = 0; k <= 300; k++)
		CHECK(separation(a, b, fmin(free, h) * k / 300) > 0);
	check_forecast(a, b, h, tolerance);
	if (isinf(t)) {
		ob_manifold now; // at the same margin, on which the lower bound of larger separations depends
		ob_manifold_find(a, b, tolerance, &now);
		CHECK(m.points == 0);
		CHECK_NEAR(m.separation, now.separation, 1e-12);
		return;
	}
	(*met)++;
	CHECK(t >= 0 && t <= h);
	CHECK(m.points > 0);
	double near = separation(a, b, t);
	CHECK(near <= .05);
	// Mostly they are within the tolerance; a grazing pass may stop slightly before it.
	CHECK(near <= tolerance + 1e-9 || near < .02);
}

static void test_random(void)
{
	static const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	enum { SHAPES = sizeof shape / sizeof *shape };
	uint64_t seed = 2;
	int met = 0, tried = 0;
	for (int i = 0; i < 4000; i++) {
		ob_placed a = random_placed(&seed, shape[i % SHAPES], 3);
		ob_placed b = random_placed(&seed, shape[i / SHAPES % SHAPES], 3);
		double h = within(&seed, .001, .02), speed = pow(10, within(&seed, 0, 3));
		a.v = ob_scale(ob_add(ob_sub(b.p, a.p), random_vector(&seed, 1)), speed / 4);
		b.v = random_vector(&seed, speed / 8);
		a.w = random_vector(&seed, 60);
		b.w = random_vector(&seed, 60);
		if (i % 2) {
			a.inertia = random_inertia(&seed);
			b.inertia = random_inertia(&seed);
		}
		if (separation(&a, &b, 0) <= 2e-3)
			continue;
		tried++;
		check_meeting(&a, &b, h, &met);
	}
	CHECK(tried > 2000 && met > 500 && met < tried - 500);
}

static ob_quat attitude_of(const ob_placed *x)
{
	const double(*m)[3] = x->r.m;
	const ob_quat q[4] = {
		{ 1 + m[0][0] + m[1][1] + m[2][2], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1] },
		{ m[2][1] - m[1][2], 1 + m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0] },
		{ m[0][2] - m[2][0], m[0][1] + m[1][0], 1 - m[0][0] + m[1][1] - m[2][2], m[1][2] + m[2][1] },
		{ m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1 - m[0][0] - m[1][1] + m[2][2] }
	};
	const double size[4] = { q[0].w, q[1].x, q[2].y, q[3].z };
	int best = 0;
	for (int k = 1; k < 4; k++)
		best = size[k] > size[best] ? k : best;
	const double scale = 1 / (2 * sqrt(size[best]));
	return (ob_quat){ scale * q[best].w, scale * q[best].x, scale * q[best].y, scale * q[best].z };
}

// With free rotation.
static bool touch(const ob_placed *a, const ob_placed *b, double h, double *when, ob_manifold *m)
{
	const ob_placed *x[2] = { a, b };
	ob_turning turning[2] = { { 0 } };
	ob_spin spin[2];
	for (int i = 0; i < 2; i++)
		if (x[i]->shape != OB_SHAPE_SPHERE && ob_norm2(x[i]->w) > 0) {
			ob_spin_plan(&spin[i], attitude_of(x[i]), x[i]->w, x[i]->inertia);
			turning[i].spin = &spin[i];
		}
	return ob_time_of_touch(a, b, turning, h, 1e-6, shapes, when, m);
}

// Until the contact they are apart, then they are not, to rounding. In reversed time they separate from there, and have
// no other contact on the way back.
static void check_touch(const ob_placed *a, const ob_placed *b, double h, int *met, int *lost)
{
	ob_manifold m;
	double when, again;
	if (!touch(a, b, h, &when, &m)) {
		++*lost;
		return;
	}
	for (int k = 0; k < 300; k++)
		CHECK(separation(a, b, fmin(when, h) * k / 300) > 0);
	if (isinf(when))
		return;
	++*met;
	CHECK(when >= 0 && when <= h);
	CHECK(m.points > 0);
	CHECK_NEAR(separation(a, b, when), 0, 3e-13);
	ob_placed back[2] = { moved(a, when), moved(b, when) };
	for (int i = 0; i < 2; i++) {
		ob_quat turn;
		ob_vec3 rate;
		const ob_placed *x = i ? b : a;
		ob_rotate_free(ob_quat_identity(), ob_rotate_back(&x->r, x->w), x->inertia, when, &turn, &rate);
		back[i].v = ob_scale(x->v, -1);
		back[i].w = ob_scale(ob_rotate(&x->r, rate), -1);
	}
	if (touch(&back[0], &back[1], when, &again, &m))
		CHECK(isinf(again));
	else
		++*lost;
}

static void test_touch(void)
{
	static const ob_shape shape[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX };
	uint64_t seed = 4;
	int met = 0, lost = 0, tried = 0;
	for (int i = 0; i < 4000; i++) {
		ob_placed a = random_placed(&seed, shape[i % 4 != 0], 3), b = random_placed(&seed, shape[i % 4 > 1], 3);
		const double h = within(&seed, .001, .02), speed = pow(10, within(&seed, 0, 3));
		if (a.shape == OB_SHAPE_SPHERE)
			a.size.y = a.size.z = 0;
		if (b.shape == OB_SHAPE_SPHERE)
			b.size.y = b.size.z = 0;
		a.v = ob_scale(ob_add(ob_sub(b.p, a.p), random_vector(&seed, 1)), speed / 4);
		b.v = random_vector(&seed, speed / 8);
		a.w = random_vector(&seed, 20);
		b.w = random_vector(&seed, 20);
		a.inertia = random_inertia(&seed);
		b.inertia = random_inertia(&seed);
		if (separation(&a, &b, 0) <= 0)
			continue;
		tried++;
		check_touch(&a, &b, h, &met, &lost);
	}
	printf("%d of %d touch, %d were not found\n", met, tried, lost);
	CHECK(met > 500 && met < tried - 500);
	CHECK(lost * 50 < tried);
}

// A body that lies on a rotating plate and moves with it, or leaves it, separates from it; if pressed on it, it is in
// contact.
static void test_parting(void)
{
	ob_placed plate = place(OB_SHAPE_BOX, ob_v3(1, 1, .1), ob_v3(0, 0, 0), ob_quat_identity());
	ob_placed cube = place(OB_SHAPE_BOX, ob_v3(.1, .1, .1), ob_v3(.5, 0, .1),
			       ob_quat_turn(ob_quat_identity(), ob_v3(.6, .5, .1)));
	cube.p.z += half_width(&cube, ob_v3(0, 0, 1));
	plate.w = ob_v3(0, 2, 0); // its upper side goes down where the cube is, at 1 m/s or more
	for (int k = 0; k < 5; k++) {
		static const double v[5] = { 0, -.5, -.9, -1.3, -5 };
		double when;
		ob_manifold m;
		cube.v.z = v[k];
		CHECK(touch(&cube, &plate, .01, &when, &m));
		CHECK(k < 3 ? isinf(when) : when == 0 && m.points == 1);
	}
}

int main(void)
{
	test_touch();
	test_parting();
	test_bullet();
	test_margin();
	test_touching_now();
	test_turning_fast();
	test_random();
	return check_end();
}
