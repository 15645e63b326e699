// Surfaces with prescribed motion, against closed forms: hits on a table that swings, and rollers that spin about their
// own axes.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

static void done(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.path);
	free(s);
}

static little_scene *usual_scene(void)
{
	little_scene *s = little_scene_new();
	s->run.iterations = 64;
	s->run.tolerance = 1e-3;
	return s;
}

// ---- a ball that bounces on a table

typedef struct table {
	double amplitude, frequency, phase; // m, rad/s, rad
} table;

static double height_of(const table *x, double t)
{
	return x->amplitude * sin(x->frequency * t + x->phase);
}

static double speed_of(const table *x, double t)
{
	return x->amplitude * x->frequency * cos(x->frequency * t + x->phase);
}

// Flight of the ball's lowest point from an instant on.
typedef struct flight {
	double since, z, v;
} flight;

static double above(const table *x, const flight *f, double t)
{
	const double s = t - f->since;
	return f->z + f->v * s - .5 * g * s * s - height_of(x, t);
}

// Goes on to the flight after the next hit.
static flight after_hit(const table *x, const flight *f, double e)
{
	const double scan = 1e-4;
	double low = f->since + scan;
	while (above(x, f, low + scan) > 0)
		low += scan;
	double high = low + scan;
	for (int i = 0; i < 60; i++) {
		const double middle = .5 * (low + high);
		*(above(x, f, middle) > 0 ? &low : &high) = middle;
	}
	const double u = speed_of(x, high), v = f->v - g * (high - f->since);
	return (flight){ high, height_of(x, high), -e * v + (1 + e) * u };
}

// Largest error (m) of a ball's height until the third hit.
static double bounce_error(const table *x, double e, double drop)
{
	little_scene *s = usual_scene();
	ob_world_swing(&s->world, ob_world_box(&s->world, 0, ob_v3(1, 1, .1), ob_v3(0, 0, -.1)),
		       ob_v3(0, 0, x->amplitude), x->frequency, x->phase);
	ob_world_sphere(&s->world, 1, .1, ob_v3(.2, .1, drop + .1));
	ob_world_material(&s->world, 0, e);
	flight f = { 0, drop, 0 }, next = after_hit(x, &f, e);
	little_universe l;
	little_open(&l, s);
	double worst = 0;
	for (int hits = 0, step = 1; hits < 3; step++) {
		const double t = step / 60.;
		little_run(&l, 1);
		for (; hits < 3 && t > next.since; hits++)
			f = next, next = after_hit(x, &f, e);
		if (hits < 3)
			worst = fmax(worst,
				     fabs(little_state(&l, 1).pose.p.z - .1 - height_of(x, t) - above(x, &f, t)));
	}
	done(&l, s);
	return worst;
}

static void test_hits_on_swinging_table(void)
{
	static const table each[] = { { .1, 8, .3 }, { .02, 40, 1 }, { .004, 90, 2 } };
	static const double e[] = { 1, .7 };
	for (int i = 0; i < 6; i++) {
		const double off = bounce_error(&each[i / 2], e[i % 2], .9);
		printf("two hits on a table, %g m at %g rad/s, restitution %g: off by %.1e m\n", each[i / 2].amplitude,
		       each[i / 2].frequency, e[i % 2], off);
		CHECK(off < 1e-9);
	}
}

// ---- a plank on two rollers that turn towards each other

typedef enum roller_kind { RUNNING, CYLINDERS, CAPSULES, BALLS } roller_kind;

static const double half_way = .5, thick = .1, radius = .1, spin = 20; // m, rad/s

static void add_roller(little_scene *s, roller_kind kind, ob_vec3 at, double sign)
{
	const ob_vec3 lying = ob_v3(-M_PI / 2, 0, 0); // the axis along y
	ob_world_body b;
	if (kind == BALLS)
		b = ob_world_sphere(&s->world, 0, radius, at);
	else if (kind == CAPSULES)
		b = ob_world_capsule(&s->world, 0, radius, .4, at);
	else
		b = ob_world_cylinder(&s->world, 0, radius, .4, at);
	if (kind != BALLS)
		b.state->pose.q = ob_quat_turn(ob_quat_identity(), lying);
	if (kind == RUNNING) {
		b.passport->surface_velocity = ob_v3(sign * spin * radius, 0, 0);
	} else {
		ob_world_kinematic(b);
		b.state->w = ob_v3(0, sign * spin, 0);
	}
}

static void add_rollers(little_scene *s, roller_kind kind)
{
	for (int k = 0; k < (kind == BALLS ? 4 : 2); k++)
		add_roller(s, kind,
			   ob_v3(k & 1 ? half_way : -half_way,
				 k & 2           ? .2
				 : kind == BALLS ? -.2
						 : 0,
				 -radius),
			   k & 1 ? -1 : 1);
}

// Largest error of the plank's place in ten seconds, as a share of its amplitude. It swings with the square of the
// frequency mu g / (d - mu t / 2), as the side to which it has gone presses more (Timoshenko and Young 1948, Advanced
// Dynamics, section 10).
static double roller_error(roller_kind kind, double turned)
{
	const double mu = .3, amplitude = .2;
	const double rate = sqrt(mu * g / (half_way - .5 * mu * thick));
	little_scene *s = usual_scene();
	add_rollers(s, kind);
	const uint32_t plank = s->world.objects;
	ob_world_box(&s->world, 3, ob_v3(1, .3, .5 * thick), ob_v3(amplitude, 0, .5 * thick));
	ob_world_material(&s->world, mu, 0);
	for (uint32_t i = 0; i < s->world.objects; i++) {
		ob_state *b = &s->state[i];
		const ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, turned));
		const ob_mat3 r = ob_quat_matrix(turn);
		b->pose = (ob_pose){ ob_rotate(&r, b->pose.p), ob_quat_mul(turn, b->pose.q) };
		b->w = ob_rotate(&r, b->w);
	}
	little_universe l;
	little_open(&l, s);
	double worst = 0;
	for (int step = 1; step <= 600; step++) {
		little_run(&l, 1);
		const double x = amplitude * cos(rate * step / 60);
		const ob_vec3 p = little_state(&l, plank).pose.p,
			      expected = ob_v3(x * cos(turned), x * sin(turned), .5 * thick);
		worst = fmax(worst, ob_norm(ob_sub(p, expected)));
	}
	done(&l, s);
	return worst / amplitude;
}

static void test_rollers(void)
{
	static const char *const name[] = { "running", "cylinders", "capsules" };
	for (roller_kind kind = RUNNING; kind <= CAPSULES; kind++)
		for (int turned = 0; turned < 2; turned++) {
			const double off = roller_error(kind, .7 * turned);
			printf("plank on rollers, %s, turned by %g: off by %.1e of its amplitude\n", name[kind],
			       .7 * turned, off);
			CHECK(off < 1e-4);
		}
}

// Place of a plank after half a second on four balls. running: static balls with a running surface instead.
static ob_state on_balls(bool running)
{
	little_scene *s = usual_scene();
	add_rollers(s, BALLS);
	for (int k = 0; running && k < 4; k++) {
		s->passport[k].flags = OB_OBJECT_PRESENT | OB_OBJECT_STATIC;
		s->passport[k].surface_velocity = ob_v3(k & 1 ? -spin * radius : spin * radius, 0, 0);
		s->state[k].w = ob_v3(0, 0, 0);
	}
	ob_world_box(&s->world, 3, ob_v3(1, .3, .5 * thick), ob_v3(.2, 0, .5 * thick));
	ob_world_material(&s->world, .3, 0);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 30);
	const ob_state b = little_state(&l, 4);
	done(&l, s);
	return b;
}

static void test_balls(void)
{
	const ob_state spinning = on_balls(false), running = on_balls(true);
	const double off = ob_norm(ob_sub(spinning.pose.p, running.pose.p));
	printf("plank on spinning balls, and on balls with running surfaces: %.1e m apart\n", off);
	CHECK(off < 1e-7);
}

// Cylinder or ball that lies on two rollers of the same sense: it comes to turn with them, in its place.
static void test_kiln(void)
{
	const double r = .3, rate = 5, apart = .25, height = sqrt((r + radius) * (r + radius) - apart * apart);
	for (int ball = 0; ball < 2; ball++) {
		little_scene *s = usual_scene();
		for (int k = 0; k < 2; k++) {
			add_roller(s, CYLINDERS, ob_v3(k ? apart : -apart, 0, 0), 1);
			s->state[k].w = ob_v3(0, rate, 0);
		}
		if (ball)
			ob_world_sphere(&s->world, 4, r, ob_v3(0, 0, height));
		else
			ob_world_cylinder(&s->world, 4, r, .3, ob_v3(0, 0, height)).state->pose.q =
				ob_quat_turn(ob_quat_identity(), ob_v3(-M_PI / 2, 0, 0));
		ob_world_material(&s->world, .2, 0);
		little_universe l;
		little_open(&l, s);
		double way = 0;
		for (int step = 0; step < 240; step++) {
			little_run(&l, 1);
			way = fmax(way, ob_norm(ob_sub(little_state(&l, 2).pose.p, ob_v3(0, 0, height))));
		}
		const double w = little_state(&l, 2).w.y;
		printf("%s on two rollers: turns at %.9g, %.1e m from its place at most\n", ball ? "ball" : "cylinder",
		       w, way);
		CHECK_NEAR(w, -rate * radius / r, 1e-6);
		CHECK(way < 1e-5);
		done(&l, s);
	}
}

// ---- bodies that tumble on a running ground: those on one that stands, seen by who goes by

enum { TUMBLING = 3 };

static void tumble(bool running, ob_state *end)
{
	const ob_vec3 belt = ob_v3(1.5, -.5, 0);
	little_scene *s = usual_scene();
	const ob_world_body b[TUMBLING] = { ob_world_cylinder(&s->world, 1, .1, .05, ob_v3(0, 0, .3)),
					    ob_world_cylinder(&s->world, 1, .05, .4, ob_v3(1, 0, .4)),
					    ob_world_capsule(&s->world, 1, .05, .3, ob_v3(3, 0, .4)) };
	for (int i = 0; i < TUMBLING; i++) {
		b[i].state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(.5 + .2 * i, .3, -.4));
		b[i].state->v = running ? ob_v3(.5, 1, 0) : ob_sub(ob_v3(.5, 1, 0), belt);
		b[i].state->w = ob_v3(-3, -8 + 2 * i, 1);
	}
	const ob_world_body ground = ob_world_ground(&s->world);
	if (running)
		ground.passport->surface_velocity = belt;
	ob_world_material(&s->world, .4, 0);
	little_universe l;
	little_open(&l, s);
	little_run(&l, 60);
	for (uint32_t i = 0; i < TUMBLING; i++) {
		end[i] = little_state(&l, i);
		if (!running)
			end[i].pose.p = ob_add(end[i].pose.p, belt), end[i].v = ob_add(end[i].v, belt);
	}
	done(&l, s);
}

static void test_running_ground(void)
{
	ob_state on_running[TUMBLING], on_standing[TUMBLING];
	tumble(true, on_running);
	tumble(false, on_standing);
	for (int i = 0; i < TUMBLING; i++) {
		const double apart = ob_norm(ob_sub(on_running[i].pose.p, on_standing[i].pose.p));
		printf("body %d tumbles on a running ground, and on one that stands: %.1e m apart\n", i, apart);
		CHECK(apart < 1e-4);
	}
}

int main(void)
{
	test_hits_on_swinging_table();
	test_rollers();
	test_balls();
	test_kiln();
	test_running_ground();
	return check_end();
}
