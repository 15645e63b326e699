// Terrains: regions, searches beside a look at all triangles, directions that support, and what is refused.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "terrain/terrain.h"

enum { SIDE = 12 };

static ob_terrain *heights(double (*f)(double, double))
{
	const uint32_t cells[2] = { SIDE, SIDE };
	const double size[2] = { SIDE, SIDE };
	double z[(SIDE + 1) * (SIDE + 1)];
	ob_error e;
	for (int i = 0; i < (SIDE + 1) * (SIDE + 1); i++)
		z[i] = f(i % (SIDE + 1) - SIDE / 2, i / (SIDE + 1) - SIDE / 2);
	return ob_terrain_of_heights(z, cells, size, &e);
}

static double level(double x, double y)
{
	return 2;
}

static double tilted(double x, double y)
{
	return .3 * x - .7 * y + .1;
}

static double roof(double x, double y)
{
	return -fabs(x);
}

static double rough(double x, double y)
{
	return sin(3 * x + 5 * y) + .2 * sin(17 * x);
}

static double peak(double x, double y)
{
	return x == 0 && y == 0 ? 1 : 0;
}

static void regions(void)
{
	const struct {
		double (*f)(double, double);
		uint32_t regions;
	} each[] = { { level, 1 }, { tilted, 1 }, { roof, 2 }, { rough, 2 * SIDE * SIDE - 2 }, { peak, 7 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
		ob_terrain *t = heights(each[i].f);
		CHECK(t && t->vertices == (SIDE + 1) * (SIDE + 1) && t->triangles == 2 * SIDE * SIDE);
		printf("%u regions\n", t->regions);
		CHECK(t->regions == each[i].regions);
		for (uint32_t k = 0; k < t->triangles; k++) {
			const ob_terrain_triangle *x = &ob_terrain_triangles(t)[k];
			const ob_terrain_region *r = &ob_terrain_regions(t)[x->region];
			for (int c = 0; c < 3; c++)
				CHECK_NEAR(ob_dot(r->normal, ob_terrain_vertices(t)[x->corner[c]]), r->offset, 1e-12);
		}
		free(t);
	}
}

static void searches(void)
{
	ob_terrain *t = heights(rough);
	uint64_t seed = 3;
	for (int i = 0; i < 200; i++) {
		const ob_vec3 at = ob_splitmix_vector(&seed, 8), half = ob_splitmix_vector(&seed, 2);
		const double low[3] = { at.x - fabs(half.x), at.y - fabs(half.y), .2 * at.z - fabs(half.z) },
			     high[3] = { at.x + fabs(half.x), at.y + fabs(half.y), .2 * at.z + fabs(half.z) };
		bool found[2 * SIDE * SIDE] = { false };
		ob_terrain_search s;
		uint32_t triangle, n = 0, all = 0, region[2 * SIDE * SIDE];
		ob_terrain_begin(t, low, high, &s);
		while (ob_terrain_next(&s, &triangle)) {
			CHECK(!found[triangle]);
			found[triangle] = true;
			n++;
		}
		for (uint32_t k = 0; k < t->triangles; k++) {
			double least[3] = { INFINITY, INFINITY, INFINITY },
			       most[3] = { -INFINITY, -INFINITY, -INFINITY };
			for (int c = 0; c < 3; c++) {
				const ob_vec3 v = ob_terrain_vertices(t)[ob_terrain_triangles(t)[k].corner[c]];
				const double x[3] = { v.x, v.y, v.z };
				for (int j = 0; j < 3; j++)
					least[j] = fmin(least[j], x[j]), most[j] = fmax(most[j], x[j]);
			}
			bool in = true;
			for (int j = 0; j < 3; j++)
				in = in && least[j] <= high[j] && most[j] >= low[j];
			CHECK(found[k] == in);
			all += in;
		}
		const uint32_t regions = ob_terrain_find_regions(t, low, high, region, all);
		CHECK(n == all && regions <= all && 2 + regions >= all);
		for (uint32_t k = 1; k < regions; k++)
			CHECK(region[k] > region[k - 1]);
	}
	free(t);
}

// Triangle of the roof with the point, near its ridge x = 0.
static uint32_t triangle_at(const ob_terrain *t, ob_vec3 x)
{
	const ob_vec3 e = { .01, .01, .01 };
	const double low[3] = { x.x - e.x, x.y - e.y, x.z - e.z }, high[3] = { x.x + e.x, x.y + e.y, x.z + e.z };
	ob_terrain_search s;
	uint32_t i, found = UINT32_MAX;
	ob_terrain_begin(t, low, high, &s);
	while (ob_terrain_next(&s, &i))
		if (ob_terrain_is_over(t, i, x, 0, 0))
			found = i;
	return found;
}

static void support(void)
{
	ob_terrain *t = heights(roof);
	const double h = sqrt(.5);
	const ob_vec3 on_ridge = { 0, .3, 0 }, inner_edge = { -1, .3, -1 }, inside = { -1.3, .1, -1.3 };
	const uint32_t ridge = triangle_at(t, on_ridge), inner = triangle_at(t, inner_edge),
		       face = triangle_at(t, inside);
	CHECK(ob_terrain_supports(t, ridge, on_ridge, ob_v3(0, 0, 1), 0));
	CHECK(ob_terrain_supports(t, ridge, on_ridge, ob_v3(.6, 0, .8), 0));
	CHECK(ob_terrain_supports(t, ridge, on_ridge, ob_v3(-h, 0, h), 0));
	CHECK(!ob_terrain_supports(t, ridge, on_ridge, ob_v3(-.8, 0, .6), 0));
	CHECK(!ob_terrain_supports(t, ridge, on_ridge, ob_v3(0, .1, 1), 0));
	CHECK(ob_terrain_supports(t, inner, inner_edge, ob_v3(-h, 0, h), 0));
	CHECK(!ob_terrain_supports(t, inner, inner_edge, ob_v3(-.6, 0, .8), 0));
	CHECK(ob_terrain_supports(t, face, inside, ob_v3(-h, 0, h), 0));
	CHECK(!ob_terrain_supports(t, face, inside, ob_v3(0, 0, 1), 0));
	free(t);
	t = heights(peak);
	const ob_vec3 top = { 0, 0, 1 };
	const uint32_t at_top = triangle_at(t, top);
	CHECK(ob_terrain_supports(t, at_top, top, ob_v3(0, 0, 1), 0));
	CHECK(ob_terrain_supports(t, at_top, top, ob_v3(.3, .1, .9), 0));
	CHECK(!ob_terrain_supports(t, at_top, top, ob_v3(.9, 0, .3), 0));
	free(t);
}

// Distance at which a ray meets the terrain, by a look at all triangles.
static double first_of_all(const ob_terrain *t, ob_vec3 p, ob_vec3 d, double length)
{
	double first = INFINITY;
	for (uint32_t i = 0; i < t->triangles; i++) {
		const ob_terrain_triangle *x = &ob_terrain_triangles(t)[i];
		const ob_terrain_region *r = &ob_terrain_regions(t)[x->region];
		const double down = ob_dot(r->normal, d), at = (r->offset - ob_dot(r->normal, p)) / down;
		const ob_vec3 on = ob_madd(p, at, d);
		bool inside = down < 0 && at > 0 && at < length;
		for (int k = 0; k < 3 && inside; k++) {
			const ob_vec3 a = ob_terrain_vertices(t)[x->corner[k]],
				      way = ob_sub(ob_terrain_vertices(t)[x->corner[(k + 1) % 3]], a);
			inside = ob_dot(ob_cross(r->normal, way), ob_sub(on, a)) > -1e-9;
		}
		if (inside)
			first = fmin(first, at);
	}
	return first;
}

static void check_ray(const ob_terrain *t, ob_vec3 p, ob_vec3 d, double length, uint32_t *hits)
{
	ob_vec3 n = { 0 };
	uint32_t tests;
	const double got = ob_terrain_enter(t, p, d, length, &n, &tests), wanted = first_of_all(t, p, d, length);
	CHECK(isinf(wanted) ? isinf(got) : fabs(got - wanted) < 1e-7);
	CHECK(isinf(got) || (fabs(ob_norm(n) - 1) < 1e-12 && ob_dot(n, d) < 0));
	*hits += !isinf(got);
}

// Rays from anywhere, along axes, through vertices and along edges, from outside, inside and below.
static void rays(void)
{
	ob_terrain *t = heights(rough);
	uint64_t seed = 5;
	uint32_t hits = 0, tests;
	ob_vec3 n;
	for (int i = 0; i < 20000; i++) {
		const ob_vec3 p = ob_splitmix_vector(&seed, 9), way = ob_splitmix_vector(&seed, 1);
		const ob_vec3 d = i % 5 == 0   ? ob_v3(way.x > 0 ? 1 : -1, 0, 0)
				  : i % 5 == 1 ? ob_v3(0, way.x > 0 ? 1 : -1, 0)
				  : i % 5 == 2 ? ob_v3(0, 0, -1)
					       : ob_scale(way, 1 / ob_norm(way));
		check_ray(t, p, d, i % 3 ? 100 : 4, &hits);
	}
	printf("%u of 20000 rays meet the terrain\n", hits);
	CHECK(hits > 1000);
	for (int x = -SIDE / 2; x <= SIDE / 2; x++) // through all vertices, and edges between them
		for (int y = -SIDE / 2; y <= SIDE / 2; y++) {
			CHECK_NEAR(ob_terrain_enter(t, ob_v3(x, y, 10), ob_v3(0, 0, -1), 100, &n, &tests),
				   10 - rough(x, y), 1e-9);
			CHECK(isfinite(ob_terrain_enter(t, ob_v3(x, .5 * y, 10), ob_v3(0, 0, -1), 100, &n, &tests)));
		}
	CHECK(isinf(ob_terrain_enter(t, ob_v3(0, 0, 10), ob_v3(0, 0, 1), 100, &n, &tests)) && !tests);
	CHECK(isinf(ob_terrain_enter(t, ob_v3(0, 0, -10), ob_v3(0, 0, 1), 100, &n, &tests)));
	free(t);
}

static void refusals(void)
{
	const ob_vec3 vertex[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 2, 0, 0 }, { NAN, 0, 0 } };
	const uint32_t cells[2] = { 1, 1 }, good[][3] = { { 0, 1, 2 } }, thin[][3] = { { 0, 1, 2 }, { 0, 1, 3 } },
		       absent[][3] = { { 0, 1, 9 } };
	ob_error e;
	ob_terrain *t = ob_terrain_build(vertex, 4, good, 1, cells, false, &e);
	CHECK(t && t->regions == 1);
	free(t);
	CHECK(!ob_terrain_build(vertex, 5, good, 1, cells, false, &e) && strstr(e.text, "vertex 5: expected numbers"));
	CHECK(!ob_terrain_build(vertex, 4, thin, 2, cells, false, &e) &&
	      strstr(e.text, "triangle 2: expected an area"));
	CHECK(!ob_terrain_build(vertex, 4, absent, 1, cells, false, &e) && strstr(e.text, "triangle 1"));
	CHECK(!ob_terrain_build(vertex, 4, good, 0, cells, false, &e) && strstr(e.text, "expected 1 to"));
}

static void sets(void)
{
	ob_terrain_set *set = NULL;
	ob_terrain *one = heights(rough), *other = heights(level);
	ob_error e;
	CHECK(ob_terrain_set_add(&set, one, &e) && ob_terrain_set_add(&set, other, &e) && set->count == 2);
	CHECK(ob_terrain_set_makes_sense(set, set->bytes) && !ob_terrain_set_makes_sense(set, set->bytes - 64));
	CHECK(ob_terrain_at(set, 1)->regions == 1 && !ob_terrain_at(set, 2) && !ob_terrain_at(NULL, 0));
	ob_terrain *damaged = (ob_terrain *)((char *)set + set->offset[0]);
	((ob_terrain_triangle *)ob_terrain_triangles(damaged))[5].across[1] = UINT32_MAX;
	CHECK(!ob_terrain_set_makes_sense(set, set->bytes));
	free(set);
	free(one);
	free(other);
}

// The index has at most so many entries a triangle, whatever the triangles are: all equal, half of them large, or thin.
static void sizes(void)
{
	enum { EQUAL, MIXED, CROSSED, KINDS, N = 93000 };
	for (int kind = EQUAL; kind < KINDS; kind++) {
		ob_vec3 *vertex = malloc(3 * N * sizeof *vertex);
		uint32_t(*corner)[3] = malloc(N * sizeof *corner);
		const uint32_t side = 216, cells[2] = { side, side };
		uint64_t seed = 7;
		ob_error e;
		for (uint32_t i = 0; i < N; i++) {
			const ob_vec3 at = ob_splitmix_vector(&seed, 49);
			const bool large = kind == EQUAL || (kind == MIXED && i % 2);
			const double x = large                      ? 100
					 : kind == CROSSED && i % 2 ? 200
								    : .1,
				     y = large                           ? 100
					 : kind == CROSSED && i % 2 == 0 ? 200
									 : .1;
			vertex[3 * i] = large ? ob_v3(-50, -50, 0) : ob_v3(at.x - .5 * x, at.y - .5 * y, at.z);
			vertex[3 * i + 1] = ob_add(vertex[3 * i], ob_v3(x, 0, 0));
			vertex[3 * i + 2] = ob_add(vertex[3 * i], ob_v3(0, y, 0));
			for (uint32_t k = 0; k < 3; k++)
				corner[i][k] = 3 * i + k;
		}
		ob_terrain *t = ob_terrain_build(vertex, 3 * N, (const uint32_t(*)[3])corner, N, cells, false, &e);
		CHECK(t && t->triangles == N);
		if (t)
			printf("%u x %u columns, %u entries\n", t->columns[0], t->columns[1], t->entries);
		CHECK(t && t->entries >= N && t->entries <= OB_TERRAIN_ENTRIES_PER_TRIANGLE * N);
		free(t);
		free(vertex);
		free(corner);
	}
}

int main(void)
{
	regions();
	searches();
	support();
	rays();
	refusals();
	sets();
	sizes();
	return check_end();
}
