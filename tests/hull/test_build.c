// Hulls of points: regular solids against their closed forms; the same hull from the same points in any form;
// consistent hulls of many kinds; points without a hull.
#include "hull/hull.h"

#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "hull/solids.h"

static double random_real(uint64_t *seed, double low, double high)
{
	return ob_splitmix_within(seed, low, high);
}

static ob_quat random_attitude(uint64_t *seed)
{
	return ob_quat_normalize((ob_quat){ random_real(seed, -1, 1), random_real(seed, -1, 1),
					    random_real(seed, -1, 1), random_real(seed, -1, 1) });
}

// ---- regular solids

static void check_solid(const solid *s, double edge, ob_vec3 at, ob_quat q)
{
	const ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 point[20];
	ob_hull h;
	ob_error e;
	for (int i = 0; i < s->corners; i++)
		point[i] = ob_add(at, ob_rotate(&r, ob_scale(s->corner[i], edge)));
	const bool built = ob_hull_build(point, (size_t)s->corners, &h, &e);
	CHECK(built);
	if (!built)
		return;
	CHECK((int)h.corners == s->corners && (int)h.faces == s->faces && (int)h.edges == s->edges);
	const double e2 = edge * edge, e3 = e2 * edge;
	CHECK_NEAR(h.volume / e3, s->volume, 1e-12 * s->volume);
	CHECK_NEAR(h.inertia.x / e2, s->inertia, 1e-12 * s->inertia);
	CHECK_NEAR(h.inertia.y / e2, s->inertia, 1e-12 * s->inertia);
	CHECK_NEAR(h.inertia.z / e2, s->inertia, 1e-12 * s->inertia);
	CHECK(h.inertia.x == h.inertia.y && h.inertia.y == h.inertia.z);
	CHECK_NEAR(h.inner / edge, s->inner, 1e-12 * s->inner);
	CHECK_NEAR(h.radius / edge, s->radius, 1e-12 * s->radius);
	CHECK_NEAR(ob_norm(ob_sub(h.centre, at)), 0, 1e-14 * (ob_norm(at) + edge));
}

static void check_solids(void)
{
	solid s[5];
	uint64_t seed = 7;
	solids_make(s);
	for (int i = 0; i < 5; i++) {
		check_solid(&s[i], 1, ob_v3(0, 0, 0), ob_quat_identity());
		check_solid(&s[i], 1, ob_v3(.25, -.5, 3), random_attitude(&seed));
		check_solid(&s[i], 1e-3, ob_v3(0, 0, 0), random_attitude(&seed));
		check_solid(&s[i], 1e3, ob_v3(0, 0, 0), random_attitude(&seed));
	}
}

// ---- any hull

// Checks that a hull is consistent, and contains all of these points.
static void check_whole(const ob_hull *h, const ob_vec3 *point, size_t n)
{
	const double near = 1e-11 * h->radius;
	const ob_mat3 r = ob_quat_matrix(h->frame);
	double outside = -INFINITY, bent = 0, lopsided = 0;
	CHECK(ob_hull_makes_sense(h));
	for (size_t i = 0; i < n; i++) {
		const ob_vec3 x = ob_rotate_back(&r, ob_sub(point[i], h->centre));
		for (uint32_t f = 0; f < h->faces; f++)
			outside = fmax(outside, ob_dot(h->normal[f], x) - h->offset[f]);
	}
	for (uint32_t f = 0; f < h->faces; f++)
		for (uint32_t k = h->first[f]; k < h->first[f + 1]; k++)
			bent = fmax(bent, fabs(ob_dot(h->normal[f], h->corner[h->loop[k]]) - h->offset[f]));
	for (uint32_t k = 0; k < h->edges; k++) {
		const ob_hull_edge *e = &h->edge[k];
		const ob_vec3 d = ob_sub(h->corner[e->to], h->corner[e->from]);
		lopsided = fmax(lopsided, fabs(ob_dot(d, h->normal[e->left])) + fabs(ob_dot(d, h->normal[e->right])));
		CHECK(ob_dot(d, ob_cross(h->normal[e->left], h->normal[e->right])) > 0);
	}
	CHECK(outside <= near);
	CHECK(bent <= near);
	CHECK(lopsided <= near);
	const ob_vec3 i = h->inertia;
	CHECK(i.x <= (i.y + i.z) * (1 + 1e-9) && i.y <= (i.z + i.x) * (1 + 1e-9) && i.z <= (i.x + i.y) * (1 + 1e-9));
	CHECK(h->inner <= h->radius && h->thickness >= 2 * h->inner * (1 - 1e-9) && h->thickness <= 2 * h->radius);
}

// Cuboids keep their bits: centre, axes and corners are those of the box.
static void check_box(void)
{
	const ob_vec3 half = ob_v3(.5, .15, .37);
	ob_vec3 point[8];
	ob_hull h;
	ob_error e;
	for (int k = 0; k < 8; k++)
		point[k] = ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
	CHECK(ob_hull_build(point, 8, &h, &e));
	CHECK(h.faces == 6 && h.edges == 12);
	CHECK(ob_norm2(h.centre) == 0 && h.frame.w == 1);
	for (uint32_t k = 0; k < 8; k++)
		CHECK(fabs(h.corner[k].x) == half.x && fabs(h.corner[k].y) == half.y && fabs(h.corner[k].z) == half.z);
	CHECK_NEAR(h.inertia.x, (half.y * half.y + half.z * half.z) / 3, 1e-15);
	CHECK_NEAR(h.inertia.y, (half.x * half.x + half.z * half.z) / 3, 1e-15);
	CHECK_NEAR(h.inertia.z, (half.x * half.x + half.y * half.y) / 3, 1e-15);
	CHECK_NEAR(h.thickness, 2 * half.y, 1e-15);
}

enum { MOST = 400 };

// Points of many kinds: in a ball, on one, prisms, cuboids of a lattice, slivers.
static size_t draw(uint64_t *seed, int kind, ob_vec3 *p)
{
	size_t n = 0;
	if (kind == 0 || kind == 1) {
		for (n = 0; n < (kind ? 40u : 14u); n++) {
			p[n] = ob_splitmix_vector(seed, 1);
			if (kind)
				p[n] = ob_scale(p[n], 1 / ob_norm(p[n]));
		}
	} else if (kind == 2) {
		const int sides = 3 + (int)(random_real(seed, 0, 1) * 28);
		for (int i = 0; i < 2 * sides; i++)
			p[n++] = ob_v3(cos(2 * M_PI * (i % sides) / sides), sin(2 * M_PI * (i % sides) / sides),
				       i < sides ? -.4 : .4);
	} else if (kind == 3) {
		for (int x = 0; x < 5; x++)
			for (int y = 0; y < 4; y++)
				for (int z = 0; z < 6; z++)
					p[n++] = ob_v3(.1 * x, .3 * y, .7 * z);
	} else {
		for (n = 0; n < 10; n++) {
			p[n] = ob_splitmix_vector(seed, 1);
			p[n].z *= .003;
		}
	}
	const ob_mat3 r = ob_quat_matrix(random_attitude(seed));
	const ob_vec3 at = ob_splitmix_vector(seed, 2);
	for (size_t i = 0; i < n; i++)
		p[i] = ob_add(at, ob_rotate(&r, p[i]));
	return n;
}

static void shuffle(uint64_t *seed, ob_vec3 *p, size_t n)
{
	for (size_t i = n; i > 1; i--) {
		const size_t j = (size_t)(random_real(seed, 0, .999999) * (double)i);
		const ob_vec3 x = p[j];
		p[j] = p[i - 1], p[i - 1] = x;
	}
}

// In another order, some twice, with points inside: the same bits.
static void check_same(uint64_t *seed, const ob_hull *h, const ob_vec3 *point, size_t n)
{
	static ob_vec3 more[MOST];
	ob_hull again;
	ob_error e;
	memcpy(more, point, n * sizeof *more);
	for (int i = 0; i < 20; i++) {
		const size_t a = (size_t)(random_real(seed, 0, .999999) * (double)n);
		more[n + (size_t)i] =
			i % 2 ? point[a]
			      : ob_add(h->centre, ob_scale(ob_sub(point[a], h->centre), random_real(seed, 0, .7)));
	}
	shuffle(seed, more, n + 20);
	CHECK(ob_hull_build(more, n + 20, &again, &e));
	CHECK(!memcmp(h, &again, sizeof again));
}

// From another frame: the same numbers, to rounding.
static void check_elsewhere(uint64_t *seed, const ob_hull *h, const ob_vec3 *point, size_t n)
{
	ob_vec3 moved[MOST];
	ob_hull there;
	ob_error e;
	const ob_mat3 r = ob_quat_matrix(random_attitude(seed));
	const ob_vec3 by = ob_splitmix_vector(seed, 5);
	for (size_t i = 0; i < n; i++)
		moved[i] = ob_add(by, ob_rotate(&r, point[i]));
	CHECK(ob_hull_build(moved, n, &there, &e));
	CHECK(there.corners == h->corners && there.faces == h->faces);
	CHECK_NEAR(there.volume, h->volume, 1e-11 * h->volume);
	CHECK_NEAR(there.inertia.x + there.inertia.y + there.inertia.z, h->inertia.x + h->inertia.y + h->inertia.z,
		   1e-11 * h->radius * h->radius);
	CHECK_NEAR(ob_norm(ob_sub(there.centre, ob_add(by, ob_rotate(&r, h->centre)))), 0, 1e-12 * h->radius);
	CHECK_NEAR(there.thickness, h->thickness, 1e-10 * h->radius);
}

// The corners as given: some of the caller's points, which give the same hull.
static void check_corners(const ob_hull *h, const ob_vec3 *point, size_t n)
{
	ob_hull_corners c;
	ob_hull again;
	ob_error e;
	ob_hull_find_corners(h, point, n, &c);
	CHECK(c.count == h->corners);
	for (uint32_t k = 0; k < c.count; k++) {
		bool given = false;
		for (size_t i = 0; i < n; i++)
			given |= memcmp(&point[i], &c.at[k], sizeof *point) == 0;
		CHECK(given);
	}
	CHECK(ob_hull_build(c.at, c.count, &again, &e) && memcmp(&again, h, sizeof again) == 0);
}

static void check_many(void)
{
	uint64_t seed = 1;
	ob_vec3 point[MOST];
	for (int run = 0; run < 200; run++) {
		ob_hull h;
		ob_error e = { "" };
		const size_t n = draw(&seed, run % 5, point);
		const bool built = ob_hull_build(point, n, &h, &e);
		CHECK(built);
		if (!built) {
			fprintf(stderr, "run %d: %s\n", run, e.text);
			continue;
		}
		check_whole(&h, point, n);
		check_same(&seed, &h, point, n);
		check_elsewhere(&seed, &h, point, n);
		check_corners(&h, point, n);
	}
}

// ---- points without a hull

static void check_none(void)
{
	ob_hull h;
	ob_error e;
	ob_vec3 flat[9], ball[300];
	uint64_t seed = 3;
	for (int i = 0; i < 9; i++)
		flat[i] = ob_v3(i % 3, i / 3, .5 * (i % 3) + 2);
	CHECK(!ob_hull_build(flat, 9, &h, &e) && strstr(e.text, "plane"));
	flat[4].z += 1e-9;
	CHECK(!ob_hull_build(flat, 9, &h, &e) && strstr(e.text, "plane"));
	CHECK(!ob_hull_build(flat, 3, &h, &e) && strstr(e.text, "four"));
	for (int i = 0; i < 9; i++)
		flat[i] = ob_v3(1, 2, 3);
	CHECK(!ob_hull_build(flat, 9, &h, &e) && strstr(e.text, "four"));
	for (int i = 0; i < 9; i++)
		flat[i] = ob_v3(i, 2 * i, 3 * i);
	CHECK(!ob_hull_build(flat, 9, &h, &e));
	flat[3].x = NAN;
	CHECK(!ob_hull_build(flat, 9, &h, &e) && strstr(e.text, "finite"));
	for (int i = 0; i < 300; i++) {
		ball[i] = ob_splitmix_vector(&seed, 1);
		ball[i] = ob_scale(ball[i], 1 / ob_norm(ball[i]));
	}
	CHECK(!ob_hull_build(ball, 300, &h, &e) && strstr(e.text, "64"));
	CHECK(ob_hull_build(ball, 64, &h, &e) && h.corners == 64 && h.faces == OB_HULL_FACES_MAX);
	check_whole(&h, ball, 64);
}

// ---- compounds

// A compound of one round part is that part: the ball in it is no larger than the ball about it, wherever its points' origin is.
static void check_one_round(void)
{
	uint64_t seed = 5;
	for (int run = 0; run < 300; run++) {
		ob_hull h[2];
		ob_error e = { "" };
		uint32_t failed;
		const double angle = ob_splitmix_within(&seed, 0, 3);
		const ob_hull_part part = { .round = OB_SHAPE_SPHERE,
					    .size = { .x = ob_splitmix_within(&seed, .01, 1) },
					    .pose = { ob_splitmix_vector(&seed, 1),
						      { cos(angle), .6 * sin(angle), 0, .8 * sin(angle) } },
					    .density = 1 };
		CHECK(ob_hull_build_compound(&part, 1, ob_v3(NAN, 0, 0), h, &failed, &e));
		CHECK(h->inner <= h->radius);
		CHECK_NEAR(h->inner, part.size.x, 1e-14);
		CHECK_NEAR(h->radius, part.size.x, 1e-14);
	}
}

int main(void)
{
	check_solids();
	check_box();
	check_many();
	check_none();
	check_one_round();
	return check_end();
}
