// Kinematic bodies and belts: bodies that they carry, throw, drag and hit, against closed forms, and against the same
// in another frame of reference.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/mechanics.h"

static const double g = 9.81; // m/s^2
static const ob_vec3 up = { 0, 0, 1 };

static void done(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.path);
	free(s->world.hull);
	free(s);
}

// Settings with the program's default tolerance
static little_scene *usual_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.iterations = 64;
	s->run.tolerance = 1e-3;
	return s;
}

// ---- a shaking table

// Error (m) of a block's position after "time" on a table that shakes; way: its largest displacement.
static double shaken_error(double mu, double amplitude, double frequency, uint32_t substeps, double time, double *way)
{
	little_scene *s = usual_scene();
	if (substeps)
		s->run.tolerance = 0, s->run.substeps = substeps;
	ob_world_swing(&s->world, ob_world_box(&s->world, 0, ob_v3(3, 3, .1), ob_v3(0, 0, -.1)), ob_v3(amplitude, 0, 0),
		       frequency, 0);
	ob_world_box(&s->world, 10, ob_v3(.2, .2, .1), ob_v3(0, 0, .1));
	ob_world_material(&s->world, mu, 0);
	little_universe l;
	little_open(&l, s);
	double worst = 0;
	*way = 0;
	for (int i = 1; i <= (int)(time * 60); i++) {
		little_run(&l, 1);
		const ob_reference_shaken exact = ob_reference_shaken_block(amplitude, frequency, mu, g, 0, i / 60.);
		worst = fmax(worst, fabs(little_state(&l, 1).pose.p.x - exact.x));
		*way = fmax(*way, fabs(exact.x));
	}
	done(&l, s);
	return worst;
}

static void test_shaking_table(void)
{
	static const double mu[] = { .1, .3, .35, .8 };
	for (int i = 0; i < 4; i++) { // slides all the time, slides and sticks, nearly sticks, sticks: the limit is .4
		double way, error = shaken_error(mu[i], .1, sqrt(.4 * g / .1), 0, 5, &way);
		printf("shaken with mu = %g: off by %.2g of %.3g m\n", mu[i], error, way);
		CHECK(error < .01 * way);
	}
}

// A body without friction stays in place over a moving surface, and a reversal of slip reverses no force: no partial
// substep ends there, though rounding has the box a little above the table or in it.
static void test_smooth_table(void)
{
	uint64_t most = 0;
	for (int i = 0; i < 8; i++) {
		little_scene *s = usual_scene();
		little_universe l;
		ob_counters count;
		ob_world_body table = ob_world_box(&s->world, 0, ob_v3(.7, .8, .1), ob_v3(0, 0, -.1));
		ob_world_kinematic(table);
		const ob_path path = ob_path_circle(table.state, ob_v3(-.044, -.134, -.1), ob_v3(0, 0, 1), .484);
		ob_world_box(&s->world, 10, ob_v3(.2, .2, .04), ob_v3(0, .5, .04 + 3e-13 * (i - 4)));
		ob_world_material(&s->world, 0, 0);
		little_open(&l, s);
		for (int step = 0; step < 60; step++) {
			ob_sim_prescribe(l.u, 0, &path, 0);
			little_run(&l, 1);
		}
		ob_universe_count(l.u, &count);
		most = count.pair_solves > most ? count.pair_solves : most;
		done(&l, s);
	}
	printf("without friction on a table that circles: %lu pairs solved\n", (unsigned long)most);
	CHECK(most <= 4 * 60 * 8);
}

static void test_convergence(void)
{
	double way, few = shaken_error(.2, .1, 6, 2, 3, &way), more = shaken_error(.2, .1, 6, 8, 3, &way),
		    many = shaken_error(.2, .1, 6, 32, 3, &way);
	printf("shaken, 2, 8, 32 substeps: off by %.2g, %.2g, %.2g m\n", few, more, many);
	CHECK(more < .5 * few);
	CHECK(many < .5 * more);
}

// ---- a belt

static void test_belt(void)
{
	const double mu = .3, speed = 1.5, h = 1. / 60;
	for (int plane = 0; plane < 2; plane++) {
		little_scene *s = usual_scene();
		if (plane)
			ob_world_ground(&s->world);
		else
			ob_world_box(&s->world, 0, ob_v3(5, 1, .1), ob_v3(3, 0, -.1));
		s->passport[0].surface_velocity = ob_v3(speed, 0, 0);
		ob_world_box(&s->world, 5, ob_v3(.1, .1, .1), ob_v3(0, 0, .1));
		ob_world_material(&s->world, mu, 0);
		little_universe l;
		little_open(&l, s);
		double before = 0, reached = NAN;
		for (int i = 1; i <= 90; i++) {
			little_run(&l, 1);
			const double v = little_state(&l, 1).v.x;
			if (i == 15)
				CHECK_NEAR(v, mu * g * i * h, 1e-6);
			if (v > speed - 1e-6 && isnan(reached))
				reached = (i - 1) * h + (speed - before) / (mu * g);
			before = v;
		}
		printf("belt: %.4f m/s after %.5f s, %.5f s expected\n", before, reached, speed / (mu * g));
		CHECK_NEAR(before, speed, 1e-9);
		CHECK_NEAR(reached, speed / (mu * g), 1e-4);
		CHECK_NEAR(little_state(&l, 1).pose.p.x, speed * 1.5 - .5 * speed * speed / (mu * g), 1e-3);
		done(&l, s);
	}
}

// A belt of finite length: a body that comes to its end falls off it.
static void test_end_of_belt(void)
{
	little_scene *s = usual_scene();
	ob_world_box(&s->world, 0, ob_v3(1, 1, .1), ob_v3(0, 0, -.1)).passport->surface_velocity = ob_v3(2, 0, 0);
	ob_world_box(&s->world, 5, ob_v3(.1, .1, .1), ob_v3(-.8, 0, .1));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 180);
	CHECK(little_state(&l, 1).pose.p.x > 1.5);
	CHECK(little_state(&l, 1).pose.p.z < -1);
	done(&l, s);
}

// ---- a turntable

static ob_world_body on_turntable(little_scene *s, double rate, double radius, double mu)
{
	ob_world_body table = ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(2, .1, 0), 0, ob_v3(0, 0, -.1));
	ob_world_kinematic(table);
	table.state->w = ob_v3(0, 0, rate);
	ob_world_body b = ob_world_box(&s->world, 5, ob_v3(.1, .1, .03), ob_v3(radius, 0, .03));
	b.state->v = ob_v3(0, rate * radius, 0);
	b.state->w = ob_v3(0, 0, rate);
	ob_world_material(&s->world, mu, 0);
	return b;
}

// Displacement (m) of a box in the frame of the turntable, after so many turns.
static double gone(double rate, double radius, double mu, double turns)
{
	little_scene *s = usual_scene();
	on_turntable(s, rate, radius, mu);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, turns * 2 * M_PI / rate);
	const ob_state b = little_state(&l, 1);
	const double angle = rate * l.now.time;
	const double off = hypot(b.pose.p.x - radius * cos(angle), b.pose.p.y - radius * sin(angle));
	done(&l, s);
	return off;
}

static void test_turntable(void)
{
	const double rate = 3, mu = .6, limit = ob_reference_turntable_radius(rate, mu, g);
	const double inside = gone(rate, .99 * limit, mu, 2), outside = gone(rate, 1.01 * limit, mu, 2);
	printf("turntable: %.2g m at .99 of the limit, %.2g m at 1.01\n", inside, outside);
	CHECK(inside < 1e-3);
	CHECK(outside > .1);
	const double long_after = gone(rate, .7 * limit, mu, 30);
	printf("turntable: %.2g m after 30 turns\n", long_after);
	CHECK(long_after < 1e-5);
}

// A ball rolls on a turntable along a circle.
static void test_ball_on_turntable(void)
{
	const double rate = 2, r = .1;
	little_scene *s = usual_scene();
	ob_world_body table = ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(4, .1, 0), 0, ob_v3(0, 0, -.1));
	ob_world_kinematic(table);
	table.state->w = ob_v3(0, 0, rate);
	ob_world_body ball = ob_world_sphere(&s->world, 1, r, ob_v3(1, 0, r));
	const ob_vec3 v = ob_v3(.5, 0, 0), below = ob_v3(0, rate * 1, 0), roll = ob_sub(v, below);
	ball.state->v = v;
	ball.state->w = ob_scale(ob_cross(up, roll), 1 / r); // the lowest point moves with the table
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	double worst = 0;
	for (int i = 1; i <= 600; i++) {
		little_run(&l, 1);
		const ob_vec3 exact = ob_reference_turntable_ball(rate, ob_v3(1, 0, r), v, i / 60.);
		worst = fmax(worst, ob_norm(ob_sub(little_state(&l, 1).pose.p, exact)));
	}
	printf("ball on a turntable: off by %.2g m in 10 s\n", worst);
	CHECK(worst < .02);
	done(&l, s);
}

// ---- frames of reference

// A box tumbles onto a table and slides. "along": velocity of the whole scene; lift: m/s^2, upward acceleration of the
// table, from below, instead of that much more gravity.
static ob_state tumble(ob_vec3 along, bool moving, int steps, ob_vec3 *table_p)
{
	little_scene *s = usual_scene();
	ob_world_body table = ob_world_box(&s->world, 0, ob_v3(3, 3, .2), ob_v3(0, 0, -.2));
	if (moving)
		ob_world_kinematic(table);
	ob_world_body b = ob_world_box(&s->world, 10, ob_v3(.2, .3, .1), ob_v3(0, 0, .6));
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(.3, .2, .1));
	b.state->v = ob_v3(1, .5, 0);
	table.state->v = moving ? along : ob_v3(0, 0, 0);
	b.state->v = ob_add(b.state->v, along);
	ob_world_material(&s->world, .4, .3);
	little_universe l;
	little_open(&l, s);
	little_run(&l, (uint64_t)steps);
	ob_state out = little_state(&l, 1);
	*table_p = ob_sub(little_state(&l, 0).pose.p, ob_v3(0, 0, -.2));
	done(&l, s);
	return out;
}

static void test_boost(void)
{
	static const ob_vec3 along[] = { { 1, 0, 0 }, { -.5, 2, .75 }, { 0, 0, -1 } };
	ob_vec3 at;
	const ob_state still = tumble(ob_v3(0, 0, 0), false, 120, &at);
	for (int i = 0; i < 3; i++) {
		const ob_state b = tumble(along[i], true, 120, &at);
		const double p = ob_norm(ob_sub(ob_sub(b.pose.p, at), still.pose.p)),
			     v = ob_norm(ob_sub(ob_sub(b.v, along[i]), still.v));
		printf("boosted by %g %g %g: %.2g m, %.2g m/s\n", along[i].x, along[i].y, along[i].z, p, v);
		CHECK(p < 1e-3);
		CHECK(v < 1e-3);
	}
}

// A stack on an accelerating lift is like one under more gravity: a top box hit from the side slides as far.
static ob_vec3 slid_on_lift(double gravity, const ob_path *path, double *height)
{
	little_scene *s = usual_scene();
	s->run.gravity = s->world.gravity = ob_v3(0, 0, -gravity);
	ob_world_body table = ob_world_box(&s->world, 0, ob_v3(5, 5, .2), ob_v3(0, 0, -.2));
	if (path)
		ob_world_kinematic(table);
	ob_world_box(&s->world, 10, ob_v3(.2, .2, .1), ob_v3(0, 0, .1)).state->v = ob_v3(2, 0, 0);
	ob_world_material(&s->world, .3, 0);
	little_universe l;
	little_open(&l, s);
	if (path)
		ob_sim_prescribe(l.u, 0, path, 0);
	for (int i = 0; i < 60; i++) {
		if (path)
			ob_sim_prescribe(l.u, 0, path, 0);
		ob_gate_set_pause_step(l.u, ob_step_count(l.u) + 1);
		ob_sim_resume(l.u);
		while (!ob_gate_host_wait(l.u, 0))
			ob_step(l.sim);
	}
	ob_error e;
	CHECK(ob_snapshot_take(&l.now, l.u, 0, &e));
	ob_vec3 p = little_state(&l, 1).pose.p;
	*height = little_state(&l, 0).pose.p.z + .2;
	done(&l, s);
	return p;
}

static void test_lift(void)
{
	const double a = 4, time = 4; // m/s^2, s: it speeds up through the first half
	ob_path_point point[2] = { { .t = 0, .p = { 0, 0, -.2 } },
				   { .t = time, .p = { 0, 0, -.2 + a * time * time / 4 } } };
	const ob_path path = { .points = 2, .point = point };
	double height, ground;
	const ob_vec3 lifted = slid_on_lift(g, &path, &height), heavy = slid_on_lift(g + a, NULL, &ground);
	printf("lift: %.2g m along, %.2g m up, from what more gravity does\n", lifted.x - heavy.x,
	       lifted.z - height - heavy.z);
	CHECK_NEAR(height, .5 * a, 1e-9);
	CHECK_NEAR(lifted.x, heavy.x, 1e-6);
	CHECK_NEAR(lifted.z - height, heavy.z, 1e-6);
}

// ---- bodies that leave a lift falling faster than g, and come down on it again

typedef struct carried {
	double amplitude, frequency;
	bool rides;
	double since, z, v; // s, m, m/s: it flies since then, and began so
} carried;

static double table_height(const carried *c, double t)
{
	return c->amplitude * sin(c->frequency * t);
}

static double table_speed(const carried *c, double t)
{
	return c->amplitude * c->frequency * cos(c->frequency * t);
}

static double flight_height(const carried *c, double t)
{
	return c->z + c->v * (t - c->since) - .5 * g * (t - c->since) * (t - c->since);
}

// Time between these two at which a flying body lands on the table
static double landing(const carried *c, double from, double to)
{
	for (int i = 0; i < 60; i++) {
		const double middle = .5 * (from + to);
		*(flight_height(c, middle) > table_height(c, middle) ? &from : &to) = middle;
	}
	return to;
}

// Lowest point of a body on the table at t; call it in small steps.
static double carried_height(carried *c, double before, double t)
{
	const double share = g / (c->amplitude * c->frequency * c->frequency);
	if (!c->rides && flight_height(c, t) <= table_height(c, t)) {
		before = landing(c, before, t);
		c->rides = true;
	}
	const double turn = fmod(c->frequency * t, 2 * M_PI), leaves = asin(fmin(1, share));
	if (c->rides && share < 1 && turn > leaves && turn < M_PI - leaves) {
		c->since = fmax(before, t - (turn - leaves) / c->frequency);
		c->z = table_height(c, c->since), c->v = table_speed(c, c->since);
		c->rides = false;
	}
	return c->rides ? table_height(c, t) : flight_height(c, t);
}

static void put_on_lift(little_scene *s, int shape)
{
	ob_vec3 corner[12];
	for (int i = 0; i < 12; i++)
		corner[i] = ob_v3(.1 * cos(M_PI * (i / 2) / 3), .1 * sin(M_PI * (i / 2) / 3), i % 2 ? .1 : -.1);
	if (shape == 0)
		ob_world_box(&s->world, 2, ob_v3(.1, .1, .1), ob_v3(0, 0, .1));
	else if (shape == 1)
		ob_world_hull(&s->world, 2, corner, 12, ob_v3(0, 0, .1));
	else
		ob_world_sphere(&s->world, 2, .1, ob_v3(0, 0, .1));
}

static void test_leaves_lift(void)
{
	enum { PARTS = 1000 }; // of a frame
	static const double frequency[] = { 8, 12, 18 }; // 0.65, 1.47 and 3.3 g at the top
	for (int i = 0; i < 9; i++) {
		carried c = { .amplitude = .1, .frequency = frequency[i / 3], .rides = true };
		little_scene *s = usual_scene();
		ob_world_swing(&s->world, ob_world_box(&s->world, 0, ob_v3(1, 1, .1), ob_v3(0, 0, -.1)),
			       ob_v3(0, 0, c.amplitude), c.frequency, 0);
		put_on_lift(s, i % 3);
		s->state[1].v.z = table_speed(&c, 0);
		ob_world_material(&s->world, .5, 0);
		little_universe l;
		little_open(&l, s);
		double worst = 0, highest = 0;
		for (int k = 1; k <= 120 * PARTS; k++) {
			const double low = carried_height(&c, (k - 1) / (60. * PARTS), k / (60. * PARTS));
			if (k % PARTS)
				continue;
			little_run(&l, 1);
			worst = fmax(worst, fabs(little_state(&l, 1).pose.p.z - .1 - low));
			highest = fmax(highest, low - table_height(&c, k / (60. * PARTS)));
		}
		printf("lift, %.2g g at the top: off by %.2g m, %.2g m above it\n",
		       c.amplitude * c.frequency * c.frequency / g, worst, highest);
		CHECK(worst < 1e-4);
		CHECK((highest > 1e-3) == (i >= 3));
		done(&l, s);
	}
}

// ---- a block on a table that shakes begins to rock where its weight no longer holds its edge down

static double tilt_on_table(double share)
{
	const double half = .1, height = .4, frequency = M_PI;
	const double amplitude = share * g * half / height / (frequency * frequency);
	little_scene *s = usual_scene();
	ob_world_swing(&s->world, ob_world_box(&s->world, 0, ob_v3(5, 5, .1), ob_v3(0, 0, -.1)), ob_v3(amplitude, 0, 0),
		       frequency, 0);
	ob_world_box(&s->world, 5, ob_v3(half, .2, height), ob_v3(0, 0, height)).state->v.x = amplitude * frequency;
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	double tilt = 0;
	for (int i = 0; i < 240; i++) {
		little_run(&l, 1);
		const ob_mat3 r = ob_quat_matrix(little_state(&l, 1).pose.q);
		tilt = fmax(tilt, hypot(r.m[0][2], r.m[1][2]));
	}
	done(&l, s);
	return tilt;
}

static void test_rocks(void)
{
	const double below = tilt_on_table(.99), above = tilt_on_table(1.01);
	printf("on a shaking table: tilts by %.2g at .99 of the limit, %.2g at 1.01\n", below, above);
	CHECK(below < 1e-7);
	CHECK(above > 1e-4);
}

// ---- a ball that is set on a belt slides, and then rolls with 2/7 of its speed

static void test_ball_on_belt(void)
{
	const double speed = 2, mu = .3, until = speed / (3.5 * mu * g), rolls = 2 * speed / 7;
	for (int kinematic = 0; kinematic < 2; kinematic++) {
		little_scene *s = usual_scene();
		ob_world_body belt = ob_world_box(&s->world, 0, ob_v3(20, 1, .1), ob_v3(0, 0, -.1));
		if (kinematic) {
			ob_world_kinematic(belt);
			belt.state->v.x = speed;
		} else {
			belt.passport->surface_velocity = ob_v3(speed, 0, 0);
		}
		ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, .1));
		ob_world_material(&s->world, mu, 0);
		little_universe l;
		little_open(&l, s);
		little_run(&l, 120);
		CHECK_NEAR(little_state(&l, 1).v.x, rolls, 1e-9);
		CHECK_NEAR(little_state(&l, 1).pose.p.x, rolls * (2 - .5 * until), 1e-5);
		done(&l, s);
	}
}

// ---- a row of blocks is pushed along

static void test_pushed_row(void)
{
	enum { ROW = 5 };
	for (int hull = 0; hull < 2; hull++) {
		little_scene *s = usual_scene();
		ob_world_ground(&s->world);
		ob_world_body pusher = ob_world_box(&s->world, 0, ob_v3(.1, .5, .3), ob_v3(-1, 0, .35));
		ob_world_kinematic(pusher);
		pusher.state->v.x = .5;
		for (int i = 0; i < ROW; i++) {
			ob_vec3 corner[8];
			for (int k = 0; k < 8; k++)
				corner[k] = ob_v3(k & 1 ? .1 : -.1, k & 2 ? .1 : -.1, k & 4 ? .1 : -.1);
			if (hull)
				ob_world_hull(&s->world, 1, corner, 8, ob_v3(.3 * i, 0, .1));
			else
				ob_world_box(&s->world, 1, ob_v3(.1, .1, .1), ob_v3(.3 * i, 0, .1));
		}
		ob_world_material(&s->world, .4, 0);
		little_universe l;
		little_open(&l, s);
		double deepest = 0;
		for (int i = 0; i < 48; i++) {
			little_run(&l, 10);
			deepest = fmax(deepest, little_penetration(&l).max_m);
		}
		CHECK(deepest < 1e-3);
		for (uint32_t i = 0; i < ROW; i++) {
			CHECK_NEAR(little_state(&l, 2 + i).v.x, .5, 1e-3);
			CHECK_NEAR(little_state(&l, 2 + i).pose.p.x, -1 + .5 * 8 + .2 + .2 * i, 1e-3);
		}
		done(&l, s);
	}
}

// ---- hits

// v' = -e v + (1 + e) u of a ball that meets a paddle
static void test_paddle(void)
{
	static const double e[] = { .3, 1, 0 }, u[] = { 1, -.5, 3 };
	for (int i = 0; i < 9; i++) {
		little_scene *s = usual_scene();
		s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
		ob_world_body paddle = ob_world_box(&s->world, 0, ob_v3(1, 1, .1), ob_v3(0, 0, -.1));
		ob_world_kinematic(paddle);
		paddle.state->v.z = u[i / 3];
		ob_world_sphere(&s->world, 2, .1, ob_v3(.2, .1, 1.1)).state->v = ob_v3(0, 0, -2);
		ob_world_material(&s->world, 0, e[i % 3]);
		little_universe l;
		little_open(&l, s);
		little_run(&l, 90);
		CHECK_NEAR(little_state(&l, 1).v.z, 2 * e[i % 3] + (1 + e[i % 3]) * u[i / 3], 1e-9);
		done(&l, s);
	}
}

// A rotating paddle hits a ball at rest: (1 + e) times the velocity of the point of contact, along its normal.
static void test_turning_paddle(void)
{
	static const struct {
		double rate, radius, e;
	} each[] = { { 3, .5, .5 }, { 3, .5, 1 }, { 10, .2, .5 }, { 10, .2, 1 }, { 30, .5, 1 }, { 100, .9, 1 } };
	const double ball = .05, half = .03, from = -.8; // m, m, rad
	for (int i = 0; i < 6; i++) {
		little_scene *s = usual_scene();
		s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
		ob_world_body paddle = ob_world_box(&s->world, 0, ob_v3(1, half, .5), ob_v3(0, 0, 0));
		ob_world_kinematic(paddle);
		paddle.state->w.z = each[i].rate;
		paddle.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, from));
		ob_world_sphere(&s->world, 1, ball, ob_v3(each[i].radius, 0, .1));
		ob_world_material(&s->world, 0, each[i].e);
		const double angle = -asin((half + ball) / each[i].radius), when = (angle - from) / each[i].rate;
		const double v = (1 + each[i].e) * each[i].rate * each[i].radius * cos(angle);
		little_universe l;
		little_open(&l, s);
		little_run(&l, (uint64_t)ceil(60 * when) + 1);
		const ob_vec3 expected = ob_v3(-v * sin(angle), v * cos(angle), 0);
		CHECK_NEAR(ob_norm(ob_sub(little_state(&l, 1).v, expected)), 0, 1e-9 * v);
		done(&l, s);
	}
}

// An elastic ball goes on bouncing on a smooth plate, at any speed of the plate's rotation.
static void test_bounces_on_turntable(void)
{
	for (double rate = 1; rate <= 1000; rate *= 10) {
		little_scene *s = usual_scene();
		ob_world_body plate = ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(1, .1, 0), 0, ob_v3(0, 0, -.1));
		ob_world_kinematic(plate);
		plate.state->w.z = rate;
		ob_world_sphere(&s->world, 1, .1, ob_v3(.5, 0, .6));
		ob_world_material(&s->world, 0, 1);
		little_universe l;
		little_open(&l, s);
		const double energy = little_energy(&l);
		little_run(&l, 300);
		CHECK_NEAR(little_energy(&l) / energy, 1, 1e-9);
		done(&l, s);
	}
}

// A moving body wakes and pushes a sleeping one in its way, and not the one beside it.
static void test_wakes(void)
{
	little_scene *s = usual_scene();
	s->run.sleeping = true;
	ob_world_ground(&s->world);
	ob_world_body pusher = ob_world_box(&s->world, 0, ob_v3(.2, .2, .2), ob_v3(-4, 0, .25));
	ob_world_kinematic(pusher);
	pusher.state->v.x = 2;
	ob_world_box(&s->world, 10, ob_v3(.2, .2, .2), ob_v3(0, 0, .2));
	ob_world_box(&s->world, 10, ob_v3(.2, .2, .2), ob_v3(0, 2, .2));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 60);
	CHECK(little_asleep(&l, 2) && little_asleep(&l, 3));
	little_run(&l, 120);
	CHECK(!little_asleep(&l, 2) && little_asleep(&l, 3));
	CHECK_NEAR(little_state(&l, 2).pose.p.x, little_state(&l, 1).pose.p.x + .4, 1e-3);
	CHECK_NEAR(little_state(&l, 1).pose.p.x, 2, 1e-12);
	done(&l, s);
}

int main(void)
{
	test_shaking_table();
	test_smooth_table();
	test_convergence();
	test_belt();
	test_end_of_belt();
	test_turntable();
	test_ball_on_turntable();
	test_boost();
	test_lift();
	test_leaves_lift();
	test_rocks();
	test_ball_on_belt();
	test_pushed_row();
	test_paddle();
	test_turning_paddle();
	test_bounces_on_turntable();
	test_wakes();
	return check_end();
}
