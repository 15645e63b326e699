// A block that stands tilted on one edge and falls back: its motion is that of a physical pendulum about the edge,
// theta'' = -(m g r / I) sin(alpha - theta), until the other edge hits. No energy is lost before that.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "reference/pivot.h"

typedef struct rocking_block {
	double half_width, half_height, r, alpha, start; // m, m, m, rad, rad
} rocking_block;

static const double g = 9.81;

// s, from rest at the start until the tilt is "tilt"; a substitution removes the singularity at zero speed.
static double time_to(const rocking_block *b, double tilt)
{
	const int n = 4000;
	double most = sqrt(b->start - tilt), sum = 0;
	for (int i = 0; i < n; i++) {
		double s = most * (i + .5) / n, fallen = 2 * sin(.5 * s * s) * sin(b->alpha - b->start + .5 * s * s);
		sum += 2 * s / sqrt(1.5 * g / b->r * fallen) * most / n;
	}
	return sum;
}

// Returns the share of the energy lost until just before the hit.
static double check_block(double slenderness, bool on_box, uint32_t substeps)
{
	rocking_block b = { .half_width = .1, .half_height = .1 * slenderness };
	b.r = hypot(b.half_width, b.half_height);
	b.alpha = atan2(b.half_width, b.half_height);
	b.start = .5 * b.alpha;
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	if (on_box)
		ob_world_box(&s->world, 0, ob_v3(1, 1, .5), ob_v3(0, 0, -.5));
	else
		ob_world_ground(&s->world);
	ob_world_body o = ob_world_box(&s->world, 10, ob_v3(b.half_width, .15, b.half_height), ob_v3(0, 0, 0));
	const double lean = b.alpha - b.start;
	o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, b.start, 0));
	o.state->pose.p = ob_v3(b.half_width - b.r * sin(lean), 0, b.r * cos(lean));
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	const double drop = 10 * g * b.r * (cos(lean) - cos(b.alpha)), quarter = time_to(&b, 0);
	double energy = little_energy(&l), lost = 0, late = 0;
	for (int step = 1;; step++) {
		little_run(&l, 1);
		ob_mat3 r = ob_quat_matrix(little_state(&l, 1).pose.q);
		double tilt = atan2(r.m[0][2], r.m[2][2]);
		if (tilt < .05 * b.start)
			break;
		lost = fmax(lost, fabs(little_energy(&l) - energy) / fabs(drop));
		late = step / 60. - time_to(&b, tilt);
	}
	printf("h/b %g, %u substeps: time off by %.4f %%, energy by %.1e of what it gains\n", slenderness, substeps,
	       100 * late / quarter, lost);
	CHECK(fabs(late) <= .0005 * quarter);
	CHECK(lost <= 3e-4);
	little_close(&l);
	free(s);
	return lost;
}

// Second order down to the shortest substeps: the neglected terms must not add up in so many more.
static void check_refined(double slenderness)
{
	double lost = check_block(slenderness, false, 8);
	for (uint32_t substeps = 32; substeps <= 128; substeps *= 4) {
		const double finer = check_block(slenderness, false, substeps);
		CHECK(finer <= .3 * lost);
		lost = finer;
	}
}

// A brick whose centre is a little beyond the edge that it lies on: it topples about that edge. An error of the
// edge of .1 mm would take a fifth of its lever, the distance of the centre from the edge.
static void check_toppling(double beyond, double tolerance, uint32_t substeps)
{
	const ob_vec3 half = ob_v3(.5, .25, .1);
	little_scene *s = little_scene_new();
	s->run.substeps = substeps;
	s->run.tolerance = tolerance;
	ob_world_box(&s->world, 0, ob_v3(2, 1, .5), ob_v3(-2, 0, -.5));
	const double moment = ob_world_box(&s->world, 10, half, ob_v3(beyond, 0, half.z)).passport->inertia.y / 10;
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	const double scale = 10 * g * half.z;
	double least = little_energy(&l), gained = 0;
	for (int step = 0; step < 84; step++) {
		little_run(&l, 1);
		gained = fmax(gained, (little_energy(&l) - least) / scale);
		least = fmin(least, little_energy(&l));
	}
	ob_mat3 r = ob_quat_matrix(little_state(&l, 1).pose.q);
	const double off = atan2(r.m[0][2], r.m[2][2]) / ob_reference_topple(beyond, half.z, moment, g, 84 / 60.) - 1;
	printf("brick %g mm over the edge, %u substeps, tolerance %g: tilt off by %.4f %%, energy grows by %.1e\n",
	       1e3 * beyond, substeps, tolerance, 100 * off, gained);
	CHECK(fabs(off) <= .002);
	CHECK(gained <= 1e-9);
	little_close(&l);
	free(s);
}

// Squared angular velocity of the block at the hit of an edge on the ground, if no energy is lost until then.
static double rate_of_hit(const ob_reference_rocker *r, const ob_state *s)
{
	return (ob_norm2(s->v) + r->moment * ob_norm2(s->w) + 2 * g * (s->pose.p.z - r->height)) /
	       (r->moment + r->half * r->half + r->height * r->height);
}

// It rocks from edge to edge: at each hit the moment of momentum about the new edge is kept (Housner 1963).
static void check_hits(ob_shape shape, double slenderness, bool on_box, double heading, double tolerance)
{
	const int most = shape == OB_SHAPE_BOX ? 3 : 1; // a cylinder rolls on then
	const double half = .1, height = half * slenderness, start = .5 * atan2(half, height);
	const double lean = atan2(half, height) - start, arm = hypot(half, height);
	little_scene *s = little_scene_new();
	if (on_box)
		ob_world_box(&s->world, 0, ob_v3(1, 1, .5), ob_v3(0, 0, -.5));
	else
		ob_world_ground(&s->world);
	const ob_vec3 size = shape == OB_SHAPE_BOX ? ob_v3(half, .15, height) : ob_v3(half, height, 0);
	ob_world_body o = ob_world_add(&s->world, shape, size, 10, ob_v3(0, 0, arm * cos(lean)));
	s->run.tolerance = tolerance;
	o.state->pose.q = ob_quat_mul(ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, heading)),
				      ob_quat_turn(ob_quat_identity(), ob_v3(0, start, 0)));
	ob_world_material(&s->world, 2, 0);
	const ob_reference_rocker r = { half, height, o.passport->inertia.y / 10, g };
	little_universe l;
	little_open(&l, s);
	double tilt = start, rate = 0, worst = 0;
	for (int step = 0, hits = 0; step < 240 && hits < most; step++) {
		little_run(&l, 1);
		ob_state now = little_state(&l, 1);
		ob_mat3 m = ob_quat_matrix(now.pose.q);
		double was = tilt, before = rate;
		tilt = atan2(m.m[0][2] * cos(heading) + m.m[1][2] * sin(heading), m.m[2][2]);
		rate = rate_of_hit(&r, &now);
		if ((tilt < 0) == (was < 0))
			continue;
		hits++;
		worst = fmax(worst, fabs(sqrt(rate / before) / ob_reference_rocker_ratio(&r) - 1));
		CHECK(hits < most || step < 239);
	}
	printf("h/b %g on %s, tolerance %g: ratio of rates at a hit off by %.4f %%\n", slenderness,
	       on_box ? "a box" : "a plane", tolerance, 100 * worst);
	CHECK(worst <= .002);
	little_close(&l);
	free(s);
}

// A prism of n corners rolls over its edges down a slope, which it does for ever: each hit takes from the rate of turn
// as Housner's does, and each edge gives back the same (McGeer 1990, "Passive dynamic walking", on the rimless wheel).
// The rate over each edge is that of the one before. When it hits within a substep is another for each.
static void check_wheel(int corners, double slope, double start, bool on_box)
{
	enum { SETTLED = 4 }; // frames after a hit
	const double radius = .2, length = .3, half_angle = M_PI / corners, pitch = 2 * radius * sin(half_angle);
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(g * sin(slope), 0, -g * cos(slope));
	if (on_box)
		ob_world_box(&s->world, 0, ob_v3(40, 1, .5), ob_v3(38, 0, -.5));
	else
		ob_world_ground(&s->world);
	ob_vec3 corner[24];
	for (int i = 0; i < 2 * corners; i++) {
		const double angle = half_angle * (i / 2 * 2 + 1);
		corner[i] = ob_v3(radius * sin(angle), (i % 2 - .5) * length, radius * cos(angle));
	}
	const ob_reference_rocker shape = { radius * sin(half_angle), radius * cos(half_angle), 0, g };
	ob_world_body o = ob_world_hull(&s->world, 1, corner, 2 * (uint32_t)corners, ob_v3(0, 0, shape.height));
	const ob_mat3 axes = ob_quat_matrix(o.state->pose.q);
	const double inertia[] = { o.passport->inertia.x, o.passport->inertia.y, o.passport->inertia.z };
	ob_reference_rocker r = shape;
	for (int c = 0; c < 3; c++)
		r.moment += axes.m[1][c] * axes.m[1][c] * inertia[c];
	const double kept = ob_reference_rocker_ratio(&r), about_edge = r.moment + radius * radius;
	const double given = 2 * g * pitch * sin(slope) / about_edge; // from edge to edge, (rad/s)^2
	const double steady = kept * kept * given / (1 - kept * kept), rate = start * sqrt(steady);
	o.state->w = ob_v3(0, rate, 0);
	o.state->v = ob_v3(rate * r.height, 0, rate * r.half);
	ob_world_material(&s->world, 1, 0);
	little_universe l;
	little_open(&l, s);
	double last = rate * rate, worst = 0;
	int hits = 0, since = 0;
	for (int step = 0, edge = 0; step < 900; step++) {
		little_run(&l, 1);
		const ob_state now = little_state(&l, 1);
		const double height = fmin(now.pose.p.z / radius, 1), angle = copysign(acos(height), -now.v.z);
		// from where it lay to here gravity has done this
		const double done = 2 * g * radius * (cos(slope - half_angle) - cos(slope + angle)) / about_edge;
		const double first = now.w.y * now.w.y - done; // the rate when it lay, squared
		const int over = (int)floor(now.pose.p.x / pitch);
		since = over == edge ? since + 1 : 0;
		edge = over;
		if (hits < edge && since == SETTLED) {
			hits++;
			worst = fmax(worst, fabs(sqrt(first / (kept * kept * (last + given))) - 1));
		}
		if (since >= SETTLED || edge == 0)
			last = first;
	}
	printf("wheel of %d corners on %s: %d hits, rate of turn after one off by %.4f %% at most\n", corners,
	       on_box ? "a box" : "a plane", hits, 100 * worst);
	CHECK(hits >= 25);
	CHECK(worst <= 5e-4);
	little_close(&l);
	free(s->world.hull);
	free(s);
}

// A disk rolls steadily on its rim, its centre at rest: the moment of what carries it turns its angular momentum,
// W^2 = g (a cos - h sin) / (sin (i cos - j h / a sin)); without slip its rate beyond W is -W (cos - h / a sin).
typedef struct rolling_disk {
	double radius, tilt, half_thick; // m, rad, m
	double heading; // rad
	bool on_box;
	double tolerance, step; // m, s
	uint32_t substeps; // 0: as the tolerance asks
	double height; // m: above the ground at the start
} rolling_disk;

// Returns the share of its energy that it loses in 60 steps. late: share by which its precession is.
static double lost_by_disk(const rolling_disk *d, double *late)
{
	const double a = d->radius, h = d->half_thick, i = a * a / 4 + h * h / 3, j = a * a / 2, c = cos(d->tilt),
		     sn = sin(d->tilt);
	const double turn = sqrt(g * (a * c - h * sn) / (sn * (i * c - j * h / a * sn)));
	const double spin = -turn * (c - h / a * sn), each = turn * d->step;
	const ob_vec3 axis = ob_v3(sn * cos(d->heading), sn * sin(d->heading), c);
	little_scene *s = little_scene_new();
	s->run.tolerance = d->tolerance;
	s->run.step_length = d->step;
	if (d->substeps)
		s->run.substeps = d->substeps;
	if (d->on_box)
		ob_world_box(&s->world, 0, ob_v3(1, 1, .5), ob_v3(0, 0, -.5));
	else
		ob_world_ground(&s->world);
	ob_world_body o =
		ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(a, h, 0), 10, ob_v3(0, 0, a * sn + h * c + d->height));
	o.state->pose.q =
		ob_quat_turn(ob_quat_identity(), ob_v3(-d->tilt * sin(d->heading), d->tilt * cos(d->heading), 0));
	o.state->w = ob_madd(ob_v3(0, 0, turn), spin, axis);
	ob_world_material(&s->world, .5, 0);
	little_universe l;
	little_open(&l, s);
	const double lying = 10 * g * h, energy = little_energy(&l) - lying;
	double azimuth = d->heading, off = 0;
	for (int step = 0; step < 60; step++) {
		little_run(&l, 1);
		ob_mat3 r = ob_quat_matrix(little_state(&l, 1).pose.q);
		double now = atan2(r.m[1][2], r.m[0][2]);
		off += remainder(now - azimuth - each, 2 * M_PI);
		azimuth = now;
	}
	const double lost = 1 - (little_energy(&l) - lying) / energy;
	*late = off / (60 * each);
	printf("disk of %g m at %g, %g thick, on %s: precession off by %.5f %%, energy by %.5f %%\n", a, d->tilt, 2 * h,
	       d->on_box ? "a box" : "a plane", 100 * *late, 100 * lost);
	little_close(&l);
	free(s);
	return lost;
}

static void check_disk(double tilt, double half_thick, double heading, bool on_box)
{
	double late;
	const double lost = lost_by_disk(
		&(rolling_disk){ .5, tilt, half_thick, heading, on_box, OB_DEFAULT_TOLERANCE, OB_DEFAULT_STEP, 0, 0 },
		&late);
	CHECK(fabs(late) <= 1e-4);
	CHECK(fabs(lost) <= 2e-4);
}

// A small one turns by up to 4.6 rad in a step.
static void check_small_disk(double radius, double tilt)
{
	double late;
	const double lost = lost_by_disk(
		&(rolling_disk){ radius, tilt, .05 * radius, 1, false, 1e-3 * radius, OB_DEFAULT_STEP, 0, 0 }, &late);
	CHECK(fabs(late) <= 1e-3);
	CHECK(fabs(lost) <= 1e-3);
}

// One that comes down on its rim while it spins nutates then, and loses as much as with finer substeps.
static void check_dropped_disk(double radius, double tilt)
{
	double lost[2], late;
	for (int i = 0; i < 2; i++)
		lost[i] = lost_by_disk(&(rolling_disk){ radius, tilt, .05 * radius, 1, false, 0, OB_DEFAULT_STEP,
							i ? 64 : 8, .02 * radius },
				       &late);
	CHECK_NEAR(lost[0], lost[1], .02);
}

// One ten times as large, at ten times the tolerance, does the same in steps that are longer by the root of ten.
static void check_sizes(double tilt)
{
	double lost[2], late[2];
	for (int i = 0; i < 2; i++) {
		const double size = i ? 1 : .1, step = OB_DEFAULT_STEP * sqrt(size);
		lost[i] = lost_by_disk(&(rolling_disk){ size, tilt, .05 * size, 1, false, 1e-3 * size, step, 0, 0 },
				       &late[i]);
	}
	CHECK_NEAR(lost[0], lost[1], 1e-8);
	CHECK_NEAR(late[0], late[1], 1e-8);
}

int main(void)
{
	static const double tilts[] = { .0524, .0873, .175, .35, .7 };
	for (int i = 0; i < 5; i++)
		for (int on_box = 0; on_box < 2; on_box++) {
			check_disk(tilts[i], .025, 1, on_box);
			check_disk(tilts[i], .1, -2, on_box);
		}
	for (int i = 0; i < 5; i++) {
		check_small_disk(.01, tilts[i]);
		check_small_disk(.05, tilts[i]);
		check_sizes(tilts[i]);
	}
	for (int i = 0; i < 4; i++) {
		check_dropped_disk(.2, tilts[i]);
		check_dropped_disk(.5, tilts[i]);
	}
	static const double slenderness[] = { 2, 4, 6, 10 };
	for (int i = 0; i < 4; i++)
		for (int on_box = 0; on_box < 2; on_box++)
			check_block(slenderness[i], on_box, 8);
	for (int i = 0; i < 4; i++)
		for (int on_box = 0; on_box < 2; on_box++)
			for (double tolerance = 1e-3; tolerance > 5e-6; tolerance /= 10) {
				check_hits(OB_SHAPE_BOX, slenderness[i], on_box, on_box ? .7 : 0, tolerance);
				check_hits(OB_SHAPE_CYLINDER, slenderness[i], on_box, on_box ? .7 : 0, tolerance);
			}
	for (int on_box = 0; on_box < 2; on_box++) {
		check_wheel(6, .15, 1, on_box);
		check_wheel(6, .15, 1.1, on_box);
		check_wheel(8, .12, 1, on_box);
		check_wheel(10, .1, 1, on_box);
	}
	for (int i = 0; i < 4; i++)
		check_refined(slenderness[i]);
	for (uint32_t substeps = 4; substeps <= 256; substeps *= 4) {
		check_toppling(5e-4, 0, substeps);
		check_toppling(2e-3, 0, substeps);
	}
	for (double tolerance = 1e-2; tolerance > 5e-6; tolerance /= 10)
		check_toppling(5e-4, tolerance, 8);
	return check_end();
}
