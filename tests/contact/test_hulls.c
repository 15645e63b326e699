// Hulls against every shape: no direction has a larger separation, even in a slow search; points lie between the two
// surfaces; a cuboid hull has the contacts of the box; swapped and rotated pairs have swapped and rotated contacts.
#include "check.h"
#include "hull/hull.h"

#include "convex.h"

enum { HULLS = 12 };
static ob_hull hull[HULLS];

// Makes hulls of few corners and of many, flat and long.
static void make_hulls(uint64_t *seed)
{
	for (int i = 0; i < HULLS; i++) {
		ob_vec3 point[40];
		const int n = i < 2 ? 4 : i < 8 ? 6 + 2 * i : 40;
		const ob_vec3 stretch = random_size(seed);
		for (int k = 0; k < n; k++) {
			const ob_vec3 d = random_direction(seed);
			point[k] = ob_v3(d.x * stretch.x, d.y * stretch.y, d.z * stretch.z);
		}
		ob_error e;
		CHECK(ob_hull_build(point, (size_t)n, &hull[i], &e));
	}
}

static ob_placed place_hull(const ob_hull *h, ob_vec3 p, ob_quat q)
{
	return (ob_placed){ .shape = OB_SHAPE_HULL,
			    .size = ob_hull_size(h),
			    .p = p,
			    .r = ob_quat_matrix(q),
			    .hull = h,
			    .rest_depth = 2e-4,
			    .far_future = 10 };
}

static ob_placed random_shape(uint64_t *seed, ob_shape shape)
{
	ob_placed x = random_placed(seed, shape, 0);
	if (shape == OB_SHAPE_HULL)
		x = place_hull(&hull[(int)(HULLS * uniform(seed)) % HULLS], x.p, random_attitude(seed));
	x.rest_depth = 2e-4, x.far_future = 10;
	return x;
}

// Moves b along a random direction until the two are "gap" apart along the best direction tried.
static void bring_near(uint64_t *seed, const ob_placed *a, ob_placed *b, double gap)
{
	const ob_vec3 d = random_direction(seed);
	double low = 0, high = 5;
	for (int i = 0; i < 30; i++) {
		const double middle = .5 * (low + high);
		uint64_t same = 1;
		b->p = ob_madd(a->p, middle, d);
		if (farthest_apart(&same, a, b, 60) > gap)
			high = middle;
		else
			low = middle;
	}
}

// Normals of faces and directions of edges, world frame.
static int normals_of(const ob_placed *x, ob_vec3 *n)
{
	int count = x->shape == OB_SHAPE_BOX ? 3 : (int)x->hull->faces;
	for (int i = 0; i < count; i++)
		n[i] = x->shape == OB_SHAPE_BOX ? ob_column(&x->r, i) : ob_rotate(&x->r, x->hull->normal[i]);
	return count;
}

static int edges_of(const ob_placed *x, ob_vec3 *e)
{
	if (x->shape == OB_SHAPE_BOX)
		return normals_of(x, e);
	for (uint32_t i = 0; i < x->hull->edges; i++)
		e[i] = ob_rotate(&x->r,
				 ob_sub(x->hull->corner[x->hull->edge[i].to], x->hull->corner[x->hull->edge[i].from]));
	return (int)x->hull->edges;
}

static double both_ways(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	return fmax(apart_along(a, b, n), apart_along(a, b, ob_scale(n, -1)));
}

// Largest separation along all axes that two polyhedra can have (Gottschalk et al. 1996).
static double every_axis(const ob_placed *a, const ob_placed *b)
{
	static ob_vec3 n[OB_HULL_FACES_MAX], ea[OB_HULL_EDGES_MAX], eb[OB_HULL_EDGES_MAX];
	double best = -INFINITY;
	for (int side = 0; side < 2; side++)
		for (int i = normals_of(side ? b : a, n) - 1; i >= 0; i--)
			best = fmax(best, both_ways(a, b, n[i]));
	const int na = edges_of(a, ea), nb = edges_of(b, eb);
	for (int i = 0; i < na; i++)
		for (int j = 0; j < nb; j++) {
			const ob_vec3 c = ob_cross(ea[i], eb[j]);
			const double l2 = ob_norm2(c);
			if (l2 > 1e-4 * ob_norm2(ea[i]) * ob_norm2(eb[j]))
				best = fmax(best, both_ways(a, b, ob_scale(c, 1 / sqrt(l2))));
		}
	return best;
}

static double worst_above, worst_below;

// Every point is midway between the two surfaces along the normal, at half its gap from each.
static void check_points(const ob_placed *a, const ob_placed *b, const ob_manifold *m)
{
	CHECK_NEAR(ob_norm(m->normal), 1, 1e-12);
	CHECK(m->points >= 0 && m->points <= 4);
	for (int k = 0; k < m->points; k++) {
		const ob_vec3 n = m->normal, from_a = ob_sub(m->at[k], a->p), from_b = ob_sub(m->at[k], b->p);
		const double slack = 1e-7 + fmax(0, -m->gap[k]);
		CHECK(-ob_dot(n, from_a) - .5 * m->gap[k] <= reach(a, ob_scale(n, -1)) + slack);
		CHECK(ob_dot(n, from_b) - .5 * m->gap[k] <= reach(b, n) + slack);
	}
}

static void check_pair(uint64_t *seed, ob_shape shape, double gap)
{
	ob_placed a = random_shape(seed, OB_SHAPE_HULL), b = random_shape(seed, shape);
	bring_near(seed, &a, &b, gap);
	ob_manifold m = { .valid_path = INFINITY }, swapped = { .valid_path = INFINITY };
	CHECK(ob_manifold_find(&a, &b, .02, &m));
	CHECK(ob_manifold_find(&b, &a, .02, &swapped));
	const bool edged = shape == OB_SHAPE_BOX || shape == OB_SHAPE_HULL;
	double best = edged ? every_axis(&a, &b) : farthest_apart(seed, &a, &b, 100);
	if (m.points && !edged) // the best direction may be a ridge, which a search does not always climb to its end
		best = fmax(best, apart_along(&a, &b, m.normal));
	if (best < .02) { // farther pairs have no exact separation
		CHECK(m.separation <= best + 1e-9);
		CHECK(m.separation >= best - 1e-9);
		worst_above = fmax(worst_above, m.separation - best);
		worst_below = fmax(worst_below, best - m.separation);
	}
	CHECK(m.separation > .02 || m.separation < -.05 || m.points > 0 || m.valid_path < INFINITY);
	if (m.separation <= .02)
		check_points(&a, &b, &m);
	CHECK_NEAR(m.separation, swapped.separation, 1e-12);
	CHECK(m.points == swapped.points);
	if (m.points && swapped.points)
		CHECK_NEAR(ob_norm(ob_add(m.normal, swapped.normal)), 0, 1e-9);
}

static void check_pairs(void)
{
	static const ob_shape with[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER,
					 OB_SHAPE_HULL };
	uint64_t seed = 3;
	for (size_t k = 0; k < sizeof with / sizeof *with; k++) {
		worst_above = worst_below = 0;
		for (int i = 0; i < 60; i++)
			check_pair(&seed, with[k], i % 3 == 0 ? .004 : i % 3 == 1 ? -.001 : -.02);
		printf("shape %d: above %.2g, below %.2g\n", with[k], worst_above, worst_below);
	}
}

// Planes: the lowest corner, and points on it.
static void check_planes(void)
{
	uint64_t seed = 11;
	for (int i = 0; i < 100; i++) {
		ob_placed a = random_shape(&seed, OB_SHAPE_HULL),
			  b = place(OB_SHAPE_PLANE, ob_v3(0, 0, 0), random_vector(&seed, 1), random_attitude(&seed));
		const ob_vec3 n = ob_column(&b.r, 2);
		a.p = ob_madd(b.p, reach(&a, ob_scale(n, -1)) + within(&seed, -.01, .01), n);
		ob_manifold m = { .valid_path = INFINITY };
		CHECK(ob_manifold_find(&a, &b, .02, &m));
		CHECK_NEAR(m.separation, ob_dot(n, ob_sub(a.p, b.p)) - reach(&a, ob_scale(n, -1)), 1e-12);
		CHECK(m.points >= 1);
		double least = INFINITY;
		for (int k = 0; k < m.points; k++) {
			least = fmin(least, m.gap[k]);
			CHECK_NEAR(ob_dot(n, ob_sub(m.at[k], b.p)), .5 * m.gap[k], 1e-12);
		}
		CHECK_NEAR(least, m.separation, 1e-12);
	}
}

// ---- a cuboid

static ob_hull cuboid_hull(ob_vec3 half)
{
	ob_vec3 corner[8];
	ob_hull h;
	ob_error e;
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
	CHECK(ob_hull_build(corner, 8, &h, &e));
	return h;
}

static bool same_points(const ob_manifold *a, const ob_manifold *b)
{
	bool same = a->points == b->points;
	for (int i = 0; same && i < a->points; i++) {
		bool found = false;
		for (int j = 0; j < b->points; j++)
			found |= ob_norm(ob_sub(a->at[i], b->at[j])) < 1e-9 && fabs(a->gap[i] - b->gap[j]) < 1e-9;
		same = found;
	}
	return same;
}

// Cuboids as boxes against every shape, and as hulls: the same separation, and, with a few exceptions near ties, the
// same points.
static void check_cuboids(void)
{
	static const ob_shape with[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	uint64_t seed = 5;
	for (size_t k = 0; k < sizeof with / sizeof *with; k++) {
		int differ = 0;
		for (int i = 0; i < 100; i++) {
			ob_placed box = random_shape(&seed, OB_SHAPE_BOX), b = random_shape(&seed, with[k]);
			const ob_hull h = cuboid_hull(box.size);
			bring_near(&seed, &box, &b, i % 2 ? .002 : -.0001);
			box.v = random_vector(&seed, 1), box.w = random_vector(&seed, 1), b.v = random_vector(&seed, 1);
			ob_placed as_hull = box;
			as_hull.shape = OB_SHAPE_HULL, as_hull.size = ob_hull_size(&h), as_hull.hull = &h;
			ob_manifold m = { .valid_path = INFINITY }, n = { .valid_path = INFINITY };
			CHECK(ob_manifold_find(&box, &b, .01, &m));
			CHECK(ob_manifold_find(&as_hull, &b, .01, &n));
			CHECK_NEAR(m.separation, n.separation, 1e-6);
			differ += !same_points(&m, &n);
		}
		printf("cuboid with shape %d: %d of 100 differ\n", with[k], differ);
		CHECK(differ <= (with[k] == OB_SHAPE_CYLINDER ? 10 : with[k] == OB_SHAPE_CAPSULE ? 5 : 0));
	}
}

// ---- the same pair elsewhere

static void check_turned(void)
{
	static const ob_shape with[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_HULL };
	uint64_t seed = 9;
	for (int i = 0; i < 200; i++) {
		ob_placed a = random_shape(&seed, OB_SHAPE_HULL), b = random_shape(&seed, with[i % 4]);
		bring_near(&seed, &a, &b, i % 3 ? .002 : -.001);
		const rigid g = random_rigid(&seed);
		const ob_mat3 turn = ob_quat_matrix(g.q);
		ob_placed there[2] = { a, b };
		for (int k = 0; k < 2; k++) {
			there[k].p = rigid_point(&g, there[k].p);
			for (int c = 0; c < 3; c++) {
				const ob_vec3 axis = ob_rotate(&turn, ob_column(&there[k].r, c));
				there[k].r.m[0][c] = axis.x, there[k].r.m[1][c] = axis.y, there[k].r.m[2][c] = axis.z;
			}
		}
		ob_manifold m = { .valid_path = INFINITY }, n = { .valid_path = INFINITY };
		CHECK(ob_manifold_find(&a, &b, .01, &m));
		CHECK(ob_manifold_find(&there[0], &there[1], .01, &n));
		CHECK_NEAR(m.separation, n.separation, 1e-10);
		for (int k = 0; k < m.points; k++)
			m.at[k] = rigid_point(&g, m.at[k]);
		CHECK(same_points(&m, &n));
	}
}

int main(void)
{
	uint64_t seed = 1;
	make_hulls(&seed);
	check_pairs();
	check_planes();
	check_cuboids();
	check_turned();
	return check_end();
}
