// Paths of kinematic objects: ellipses against sines, splines through their points, and bounding boxes.
#include "motion/path.h"

#include <stdlib.h>

#include "check.h"
#include "motion/flight.h"
#include "random.h"

static ob_motion swinging(const ob_state *s, const ob_path *path, double t0)
{
	return (ob_motion){ .t0 = t0,
			    .p = s->pose.p,
			    .q = ob_quat_identity(),
			    .v = s->v,
			    .w = s->w,
			    .a = path->a,
			    .frequency = path->frequency,
			    .flags = OB_MOTION_SWINGS };
}

static void test_sine(void)
{
	uint64_t seed = 3;
	for (int k = 0; k < 200; k++) {
		const ob_vec3 at = random_vector(&seed, 5), amplitude = random_vector(&seed, 1);
		const double f = within(&seed, .1, 30), phase = within(&seed, -4, 4), t0 = within(&seed, 0, 10),
			     t = t0 + within(&seed, -1, 100);
		ob_state s = { .pose = { at, ob_quat_identity() } };
		const ob_path path = ob_path_sine(&s, amplitude, f, phase);
		const ob_motion m = swinging(&s, &path, t0);
		const ob_state now = ob_motion_at(&m, ob_v3(0, 0, 0), t);
		const double angle = f * (t - t0) + phase;
		CHECK_NEAR(ob_norm(ob_sub(now.pose.p, ob_madd(at, sin(angle), amplitude))), 0, 1e-11);
		CHECK_NEAR(ob_norm(ob_sub(now.v, ob_scale(amplitude, f * cos(angle)))), 0, 1e-10 * f);
		CHECK_NEAR(ob_norm(ob_sub(ob_acceleration_at(&m, t), ob_scale(amplitude, -f * f * sin(angle)))), 0,
			   1e-10 * f * f);
		double box[6];
		ob_motion_swept_bounds(&m, OB_SHAPE_SPHERE, ob_v3(.1, 0, 0), INFINITY, box);
		CHECK(box[0] <= now.pose.p.x - .1 && now.pose.p.x + .1 <= box[3]);
		CHECK(box[2] <= now.pose.p.z - .1 && now.pose.p.z + .1 <= box[5]);
		CHECK_NEAR(box[3] - box[0], .2 + 2 * fabs(amplitude.x), 1e-12);
	}
}

static void test_circle(void)
{
	const ob_vec3 centre = ob_v3(1, 2, 3), axis = ob_v3(0, .6, .8);
	ob_state s = { .pose = { { 2.5, 1, 4 }, ob_quat_identity() } };
	const ob_path path = ob_path_circle(&s, centre, axis, 2);
	const ob_motion m = swinging(&s, &path, 0);
	for (int i = 0; i < 50; i++) {
		const ob_quat turn = ob_quat_turn(ob_quat_identity(), ob_scale(axis, 2 * .3 * i));
		const ob_mat3 r = ob_quat_matrix(turn);
		const ob_vec3 exact = ob_add(centre, ob_rotate(&r, ob_sub(s.pose.p, centre)));
		CHECK_NEAR(ob_norm(ob_sub(ob_motion_at(&m, ob_v3(0, 0, 0), .3 * i).pose.p, exact)), 0, 1e-13);
	}
}

// Pieces lead through the points, without a jump of place or velocity, and not beyond them.
static void check_spline(const ob_path *path, double h, uint64_t steps)
{
	ob_path_piece last = ob_path_piece_at(path, h, 0);
	CHECK(last.from == 0);
	for (uint64_t step = 1; step < steps; step++) {
		const ob_path_piece p = ob_path_piece_at(path, h, step);
		CHECK(p.from <= step && step < p.until);
		if (p.from == last.from)
			continue;
		const double s = (double)(p.from - last.from) * h;
		CHECK(p.from == last.until);
		CHECK_NEAR(ob_norm(ob_sub(p.p, ob_madd(ob_madd(last.p, s, last.v), .5 * s * s, last.a))), 0, 1e-12);
		CHECK_NEAR(ob_norm(ob_sub(p.v, ob_madd(last.v, s, last.a))), 0, 1e-11);
		last = p;
	}
}

static void test_spline(void)
{
	ob_path_point lift[] = { { .t = 0, .p = { 0, 0, 0 } },
				 { .t = 1, .p = { 0, 0, 0 } },
				 { .t = 3, .p = { 0, 0, 4 } },
				 { .t = 4, .p = { 0, 0, 4 } } };
	const ob_path path = { .points = 4, .point = lift };
	const double h = 1. / 60;
	check_spline(&path, h, 400);
	const ob_path_piece up = ob_path_piece_at(&path, h, 90), down = ob_path_piece_at(&path, h, 130);
	CHECK_NEAR(up.a.z, 4, 1e-12); // two metres in the first second
	CHECK_NEAR(down.a.z, -4, 1e-12);
	CHECK_NEAR(down.p.z, 2, 1e-12);
	CHECK(ob_path_piece_at(&path, h, 300).until == UINT64_MAX);
	CHECK(ob_path_piece_at(&path, h, 300).p.z == 4);
	ob_path_point round[] = { { .t = 0, .p = { 0, 0, 0 } },
				  { .t = .7, .p = { 1, 0, 0 } },
				  { .t = 1.1, .p = { 2, 1, 0 } },
				  { .t = 1.6, .p = { 0, 2, .5 } },
				  { .t = 2.5, .p = { 0, 0, 0 } } };
	const ob_path loop = { .points = 5, .loop = true, .point = round };
	check_spline(&loop, h, 1000);
	check_spline(&loop, .013, 1000);
	CHECK_NEAR(ob_norm(ob_path_piece_at(&loop, h, 150).p), 0, 1e-12);
	CHECK(ob_norm(ob_path_piece_at(&loop, h, 150).v) == ob_norm(ob_path_piece_at(&loop, h, 0).v));
	uint32_t which = 0;
	CHECK(ob_path_fits(&loop, h, &which));
	CHECK(!ob_path_fits(&loop, .25, &which) && which == 2);
	ob_path *copy = ob_path_copy(&loop);
	CHECK(copy && copy->points == 5 && copy->loop && copy->point[3].p.y == 2);
	free(copy);
}

// Degrees about z, from the attitude a to b.
static double degrees_between(ob_quat a, ob_quat b)
{
	ob_vec3 turn;
	CHECK(ob_path_turn(a, b, &turn));
	CHECK_NEAR(ob_norm(ob_sub(turn, ob_v3(0, 0, turn.z))), 0, 1e-12);
	return turn.z * 180 / M_PI;
}

static ob_quat about_z(double degrees)
{
	return (ob_quat){ cos(degrees * M_PI / 360), 0, 0, sin(degrees * M_PI / 360) };
}

// Attitudes are those of the points, and between them in proportion to the time; the shortest way, and an error if
// there is none.
static void test_turns(void)
{
	ob_path_point door[] = { { 0, { 0, 0, 0 }, about_z(0) },
				 { 1, { 0, 0, 0 }, about_z(90) },
				 { 1.5, { 0, 0, 0 }, about_z(90) },
				 { 3, { 0, 0, 0 }, about_z(-60) },
				 { 4, { 0, 0, 0 }, about_z(360) } }; // equal to that of 0, with the other sign
	const double h = 1. / 60;
	const struct {
		double t, degrees, rate;
	} expected[] = { { 0, 0, 90 },       { .5, 45, 90 }, { 1, 90, 0 },    { 1.5, 90, -100 },
			 { 2.25, 15, -100 }, { 3, -60, 60 }, { 3.5, -30, 60 } };
	for (int loop = 0; loop < 2; loop++) {
		const ob_path path = { .points = 5, .loop = loop, .turns = true, .point = door };
		for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
			const uint64_t step = (uint64_t)lround(expected[i].t / h) + (loop ? 2400 : 0);
			const ob_path_piece p = ob_path_piece_at(&path, h, step);
			const ob_quat q = ob_quat_turn(p.q, ob_scale(p.w, (double)(step - p.from) * h));
			CHECK_NEAR(degrees_between(about_z(expected[i].degrees), q), 0, 1e-10);
			CHECK_NEAR(p.w.z * 180 / M_PI, expected[i].rate, 1e-9);
		}
		const ob_path_piece end = ob_path_piece_at(&path, h, 5000);
		CHECK(loop || (ob_norm(end.w) == 0 && end.until == UINT64_MAX));
		CHECK(loop || fabs(degrees_between(end.q, about_z(0))) < 1e-10);
	}
	ob_vec3 turn;
	CHECK(!ob_path_turn(about_z(10), about_z(190), &turn));
	CHECK(ob_path_turn(about_z(10), about_z(10), &turn) && ob_norm(turn) == 0);
}

int main(void)
{
	test_sine();
	test_circle();
	test_spline();
	test_turns();
	return check_end();
}
