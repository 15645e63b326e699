// Functions of each registered shape agree with each other: names, extents, support points, outlines, rays, mass
// properties.
#include "shape/shape.h"

#include <string.h>

#include "base/random.h"

#include "../check.h"

static const ob_vec3 SIZE = { .7, 1.1, 1.3 };

static ob_vec3 random_direction(uint64_t *seed)
{
	const ob_vec3 v = ob_splitmix_vector(seed, 1);
	return ob_scale(v, 1 / ob_norm(v));
}

static bool has_end(ob_shape s)
{
	return !ob_shape_is(s, OB_UNBOUNDED | OB_HULLED | OB_SURFACED);
}

static void test_names(void)
{
	CHECK(ob_shape_named("") == OB_SHAPE_NONE && ob_shape_named("cube") == OB_SHAPE_NONE);
	for (int s = OB_SHAPE_NONE; s < OB_SHAPE_KINDS; s++) {
		CHECK(ob_shape_named(ob_shape_name((ob_shape)s)) == (ob_shape)s);
		CHECK(s == OB_SHAPE_NONE || ob_shape_name((ob_shape)s)[0]);
	}
	for (unsigned s = OB_SHAPE_KINDS; s < 300; s++) {
		CHECK(!strcmp(ob_shape_name((ob_shape)s), "") && ob_shape_radius((ob_shape)s, SIZE) == 0);
		CHECK(s > 255 || s % 32 < OB_SHAPE_KINDS || !ob_shape_is((ob_shape)s, ~0u));
	}
	CHECK(!ob_shape_is(OB_SHAPE_NONE, ~0u));
}

// The support point is as far along n as the extent says, and no direction has a larger one.
static void test_extents(ob_shape s)
{
	const ob_shape_kind *kind = ob_shape_kind_of(s);
	uint64_t seed = 3;
	double least = INFINITY, farthest = 0;
	for (int i = 0; i < 20000; i++) {
		const ob_vec3 n = random_direction(&seed), at = kind->farthest(&SIZE, NULL, &n);
		const double extent = ob_shape_extent(s, SIZE, n);
		CHECK_NEAR(ob_dot(at, n), extent, 1e-14);
		const ob_vec3 any = random_direction(&seed), other = kind->farthest(&SIZE, NULL, &any);
		CHECK(ob_dot(other, n) <= extent + 1e-14);
		least = fmin(least, extent), farthest = fmax(farthest, ob_norm(at));
		ob_outline o;
		if (!ob_shape_outline(s, SIZE, &o))
			continue;
		const double sum = fabs(n.x) * o.half.x + fabs(n.y) * o.half.y + fabs(n.z) * o.half.z +
				   o.rim * hypot(n.x, n.y) + o.ball;
		CHECK_NEAR(sum, extent, 1e-14);
	}
	CHECK_NEAR(farthest, ob_shape_radius(s, SIZE), 1e-2);
	CHECK(farthest <= ob_shape_radius(s, SIZE) + 1e-14);
	CHECK(ob_shape_thickness(s, SIZE) <= 2 * least && ob_shape_thickness(s, SIZE) > 1.8 * least);
	const double longest =
		fmax(fmax(ob_shape_extent(s, SIZE, ob_v3(1, 0, 0)), ob_shape_extent(s, SIZE, ob_v3(0, 1, 0))),
		     ob_shape_extent(s, SIZE, ob_v3(0, 0, 1)));
	CHECK_NEAR(ob_shape_longest(s, SIZE), longest, 1e-15);
}

// Volume and moments by rays along z from both sides, over a grid: they enter where the shape begins and ends.
static void test_mass(ob_shape s)
{
	enum { GRID = 1000 };
	const ob_shape_kind *kind = ob_shape_kind_of(s);
	const double half = 1.01 * ob_shape_radius(s, SIZE), cell = 2 * half / GRID;
	double volume = 0;
	ob_vec3 second = { 0, 0, 0 }, n;
	for (int i = 0; i < GRID; i++)
		for (int j = 0; j < GRID; j++) {
			const double x = (i + .5) * cell - half, y = (j + .5) * cell - half;
			const double low = kind->enter(SIZE, ob_v3(x, y, -half), ob_v3(0, 0, 1), &n) - half;
			if (isinf(low))
				continue;
			CHECK(n.z < 0 && fabs(ob_norm(n) - 1) < 1e-12);
			const double high = half - kind->enter(SIZE, ob_v3(x, y, half), ob_v3(0, 0, -1), &n),
				     column = (high - low) * cell * cell;
			CHECK(column >= 0 && n.z > 0);
			volume += column;
			const double z2 = (high * high + high * low + low * low) / 3;
			second = ob_madd(second, column, ob_v3(x * x, y * y, z2));
		}
	const double mass = 3, share = mass / volume;
	const ob_vec3 i = ob_shape_inertia(s, SIZE, NULL, mass);
	CHECK_NEAR(ob_shape_volume(s, SIZE, NULL) / volume, 1, 5e-3);
	CHECK_NEAR(i.x / (share * (second.y + second.z)), 1, 5e-3);
	CHECK_NEAR(i.y / (share * (second.x + second.z)), 1, 5e-3);
	CHECK_NEAR(i.z / (share * (second.x + second.y)), 1, 5e-3);
	CHECK(isinf(kind->enter(SIZE, ob_v3(0, 0, 0), ob_v3(0, 0, 1), &n)));
}

// Numbers as people give them are, times their shares, components of the size; each component that counts is given.
static void test_keys(ob_shape s)
{
	const ob_shape_kind *kind = ob_shape_kind_of(s);
	unsigned given = 0;
	for (int k = 0; k < OB_SHAPE_KEYS && kind->key[k].name; k++) {
		const int c = kind->key[k].component;
		CHECK(kind->key[k].share > 0 && c <= 2);
		given |= c == OB_SHAPE_SIDES ? 7u : 1u << c;
	}
	const ob_vec3 more[] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	for (int c = 0; c < 3; c++) {
		const bool counts = ob_shape_volume(s, ob_add(SIZE, more[c]), NULL) != ob_shape_volume(s, SIZE, NULL);
		CHECK(counts == (given >> c & 1));
	}
}

int main(void)
{
	test_names();
	for (int s = OB_SHAPE_NONE + 1; s < OB_SHAPE_KINDS; s++) {
		if (!has_end((ob_shape)s))
			continue;
		test_extents((ob_shape)s);
		test_mass((ob_shape)s);
		test_keys((ob_shape)s);
	}
	return check_end();
}
