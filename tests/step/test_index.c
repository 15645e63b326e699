// The hash grid against a check of all pairs: sizes over six decades and beyond the largest cells, objects that move, grow,
// are removed and added, planes.
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "step/broadphase.h"

#include "motion/random.h"

enum { BODIES = 400, PLANES = 3, ALL = BODIES + PLANES };

static bool there[ALL]; // in the index

static void random_bounds(uint64_t *seed, float *b)
{
	const bool vast = uniform(seed) < .02; // around all the others, its middle far away
	double scale = pow(10, vast ? within(seed, 8, 15) : within(seed, -3, 3));
	double spread = vast ? .4 * scale : uniform(seed) < .5 ? 2 : 2000;
	ob_vec3 p = random_vector(seed, spread);
	double at[3] = { p.x, p.y, p.z };
	for (int c = 0; c < 3; c++) {
		double half = vast && scale > 1e14 ? INFINITY : scale * within(seed, vast ? .5 : .05, 1);
		b[c] = fmaxf((float)(at[c] - half), -FLT_MAX);
		b[3 + c] = fminf((float)(at[c] + half), FLT_MAX);
	}
}

static bool is_plane(uint32_t id)
{
	return id >= BODIES;
}

// True if a corner of the box lies on or below the plane.
static bool reaches_below(const ob_state *plane, const float *b)
{
	ob_mat3 r = ob_quat_matrix(ob_quat_normalize(plane->pose.q));
	for (int k = 0; k < 8; k++) {
		ob_vec3 corner = ob_v3(b[k & 1 ? 3 : 0], b[k & 2 ? 4 : 1], b[k & 4 ? 5 : 2]);
		if (ob_dot(ob_column(&r, 2), ob_sub(corner, plane->pose.p)) <= 0)
			return true;
	}
	return false;
}

static bool neighbours(const ob_universe *u, const little_scene *s, uint32_t i, uint32_t j)
{
	const ob_step_data *ex = ob_universe_step_data(u);
	const float *a = ex->bounds[i], *b = ex->bounds[j];
	if (i == j || !there[i] || !there[j] || (is_plane(i) && is_plane(j)))
		return false;
	if (is_plane(i))
		return reaches_below(&s->world.state[i], b);
	if (is_plane(j))
		return reaches_below(&s->world.state[j], a);
	for (int c = 0; c < 3; c++)
		if (a[c] > b[3 + c] || b[c] > a[3 + c])
			return false;
	return true;
}

static uint64_t tests; // box tests so far

static void check_queries(const ob_universe *u, const little_scene *s, uint32_t *found)
{
	for (uint32_t i = 0; i < ALL; i++) {
		uint32_t out[ALL], count = 0, n = ob_index_query(u, i, out, ALL, &tests);
		bool seen[ALL] = { false };
		if (!there[i])
			continue;
		for (uint32_t k = 0; k < n && k < ALL; k++) {
			CHECK(!seen[out[k]]);
			seen[out[k]] = true;
		}
		for (uint32_t j = 0; j < ALL; j++) {
			CHECK(seen[j] == neighbours(u, s, i, j));
			count += seen[j];
		}
		CHECK(n == count);
		uint32_t few[2] = { ALL, ALL };
		CHECK(ob_index_query(u, i, few, 1, &tests) == n); // returns the full number
		CHECK(few[1] == ALL); // and writes no more than requested
		*found += n;
	}
}

static little_scene *scene(uint64_t *seed)
{
	little_scene *s = little_scene_new();
	for (int i = 0; i < BODIES; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, 0));
	for (int i = 0; i < PLANES; i++) {
		ob_world_body o = ob_world_ground(&s->world);
		o.state->pose.p = random_vector(seed, 1);
		o.state->pose.q = i ? random_attitude(seed) : ob_quat_identity();
	}
	return s;
}

static void test_against_all(uint64_t seed)
{
	little_scene *s = scene(&seed);
	ob_universe *u = little_populate(s, 1);
	ob_step_data *ex = ob_universe_step_data(u);
	uint32_t found = 0;
	memset(there, 0, sizeof there);
	for (int round = 0; round < 12; round++) {
		for (uint32_t i = 0; i < ALL; i++) {
			if (round > 0 && uniform(&seed) < .5)
				continue;
			if (there[i] && uniform(&seed) < .2) {
				ob_index_remove(u, i);
				there[i] = false;
				continue;
			}
			if (!is_plane(i))
				random_bounds(&seed, ex->bounds[i]);
			ob_index_put(u, i);
			there[i] = true;
		}
		check_queries(u, s, &found);
	}
	CHECK(found > 10000);
	ob_universe_destroy(u, true);
	free(s);
}

// Bounds that only touch, of no size, far away, or as large as the largest cells.
static void test_extremes(void)
{
	static const float box[][6] = {
		{ 0, 0, 0, 1, 1, 1 },        { 1, 1, 1, 2, 2, 2 },          { .5f, .5f, .5f, .5f, .5f, .5f },
		{ 2, 2, 2.001f, 3, 3, 3 },   { 3e9f, 0, 0, 3.1e9f, 1, 1 },  { 3.05e9f, 0, 0, 3.2e9f, 1, 1 },
		{ -5e8f, 0, 0, 5e8f, 1, 1 }, { -64, -64, -64, 64, 64, 64 },
	};
	enum { BOXES = sizeof box / sizeof box[0] };
	little_scene *s = little_scene_new();
	for (int i = 0; i < BOXES; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, 0));
	ob_universe *u = little_populate(s, 1);
	memset(there, 0, sizeof there);
	for (uint32_t i = 0; i < BOXES; i++) {
		memcpy(ob_universe_step_data(u)->bounds[i], box[i], sizeof box[i]);
		ob_index_put(u, i);
		there[i] = true;
	}
	for (uint32_t i = 0; i < BOXES; i++) {
		uint32_t out[BOXES], n = ob_index_query(u, i, out, BOXES, &tests), expected = 0;
		for (uint32_t j = 0; j < BOXES; j++)
			expected += neighbours(u, s, i, j);
		CHECK(n == expected);
	}
	ob_universe_destroy(u, true);
	free(s);
}

// Boxes of all lengths along an axis, among many small ones in a row.
static void test_rows(int axis)
{
	enum { BOXES = 300, STEP = 3 };
	little_scene *s = little_scene_new();
	for (int i = 0; i < BOXES; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, 0));
	ob_universe *u = little_populate(s, 1);
	memset(there, 0, sizeof there);
	for (uint32_t i = 0; i < BOXES; i++) {
		float *b = ob_universe_step_data(u)->bounds[i];
		const float length = i % STEP ? .9f : (float)i;
		for (int c = 0; c < 3; c++)
			b[c] = c == axis ? (float)i - 150 : .05f, b[3 + c] = b[c] + (c == axis ? length : .9f);
		ob_index_put(u, i);
		there[i] = true;
	}
	for (uint32_t i = 0; i < BOXES; i++) {
		uint32_t out[BOXES], n = ob_index_query(u, i, out, BOXES, &tests), expected = 0;
		for (uint32_t j = 0; j < BOXES; j++)
			expected += neighbours(u, s, i, j);
		CHECK(n == expected);
	}
	ob_universe_destroy(u, true);
	free(s);
}

int main(void)
{
	for (uint64_t seed = 1; seed <= 3; seed++)
		test_against_all(seed);
	test_extremes();
	for (int axis = 0; axis < 3; axis++)
		test_rows(axis);
	return check_end();
}
