// Contacts of two shapes are invariant: rotated, mirrored, moved, boosted, or with the two swapped, a manifold has the
// same points. Random boxes, and boxes flat on each other, where axes tie.
#include "check.h"
#include "placed.h"

static const double tiny = 1e-10; // m

typedef struct view {
	rigid moved;
	ob_vec3 boost;
	bool mirrored, swapped;
} view;

static ob_vec3 seen_vector(const view *w, ob_vec3 v)
{
	if (w->mirrored)
		v.x = -v.x;
	return rigid_turn(&w->moved, v);
}

static ob_placed seen(const view *w, const ob_placed *s)
{
	ob_placed out = *s;
	ob_vec3 p = s->p, axial = w->mirrored ? ob_v3(-s->w.x, s->w.y, s->w.z) : s->w;
	if (w->mirrored)
		p.x = -p.x;
	out.p = rigid_point(&w->moved, p);
	for (int c = 0; c < 3; c++) { // a box's axis may be negated: the frame stays right-handed
		ob_vec3 axis = seen_vector(w, ob_column(&s->r, c));
		if (w->mirrored && c == 0)
			axis = ob_scale(axis, -1);
		out.r.m[0][c] = axis.x, out.r.m[1][c] = axis.y, out.r.m[2][c] = axis.z;
	}
	out.v = ob_add(seen_vector(w, s->v), w->boost);
	if (w->mirrored)
		axial = ob_v3(s->w.x, -s->w.y, -s->w.z);
	out.w = rigid_turn(&w->moved, axial);
	return out;
}

// Largest distance of a point of m, in the view, from the nearest of n (m).
static double points_apart(const view *w, const ob_manifold *m, const ob_manifold *n)
{
	double most = 0;
	for (int i = 0; i < m->points; i++) {
		ob_vec3 at = m->at[i];
		if (w->mirrored)
			at.x = -at.x;
		at = rigid_point(&w->moved, at);
		double least = INFINITY;
		for (int j = 0; j < n->points; j++)
			least = fmin(least, ob_norm(ob_sub(at, n->at[j])) + fabs(m->gap[i] - n->gap[j]));
		most = fmax(most, least);
	}
	return most;
}

// True if both views give the same result.
static bool same(const ob_placed *a, const ob_placed *b, double margin, const view *w)
{
	ob_manifold m = { .valid_path = INFINITY }, n = m;
	ob_placed x = seen(w, a), y = seen(w, b);
	ob_manifold_find(a, b, margin, &m);
	ob_manifold_find(w->swapped ? &y : &x, w->swapped ? &x : &y, margin, &n);
	if (m.points != n.points || fabs(m.separation - n.separation) > tiny)
		return false;
	ob_vec3 normal = ob_scale(seen_vector(w, m.normal), w->swapped ? -1 : 1);
	return m.points == 0 || (ob_norm(ob_sub(normal, n.normal)) <= tiny && points_apart(w, &m, &n) <= tiny);
}

static view random_view(uint64_t *seed, int k)
{
	view w = { .moved.q = ob_quat_identity() };
	if (k & 1)
		w.moved = random_rigid(seed);
	w.mirrored = k & 2;
	w.swapped = k & 4;
	if (k & 8)
		w.boost = random_vector(seed, 100);
	return w;
}

static ob_placed moving(uint64_t *seed, ob_placed s)
{
	s.v = random_vector(seed, 1);
	s.w = random_vector(seed, 1);
	s.rest_depth = 2e-4, s.far_future = 10;
	return s;
}

static void test_random(ob_shape sa, ob_shape sb)
{
	uint64_t seed = 1;
	int touching = 0, failed = 0;
	for (int i = 0; i < 16000; i++) {
		ob_placed a = moving(&seed, random_placed(&seed, sa, .7)),
			  b = moving(&seed, random_placed(&seed, sb, .7));
		double margin = within(&seed, 0, .1);
		view w = random_view(&seed, i % 16);
		ob_manifold m;
		ob_manifold_find(&a, &b, margin, &m);
		touching += m.points > 0;
		failed += !same(&a, &b, margin, &w);
	}
	printf("random: %d touch, %d are seen otherwise\n", touching, failed);
	CHECK(touching > 3000 && failed == 0);
}

// Boxes on each other, in all proportions, rotated about the vertical by any angle, by a quarter, or not; a hair apart
// or overlapping; at rest or not.
static void test_flat(double tilt, bool rests)
{
	uint64_t seed = 2;
	int failed[16] = { 0 }, all = 0;
	for (int i = 0; i < 16000; i++) {
		ob_vec3 sa = random_size(&seed), sb = i % 3 ? random_size(&seed) : sa;
		double turn = i % 5 == 0 ? 0 : i % 5 == 1 ? M_PI / 4 : i % 5 == 2 ? M_PI / 2 : within(&seed, -3, 3);
		ob_vec3 th = random_vector(&seed, tilt), off = random_vector(&seed, .2);
		ob_placed b = place(OB_SHAPE_BOX, sb, ob_v3(0, 0, 0), ob_quat_identity());
		ob_placed a = place(OB_SHAPE_BOX, sa, ob_v3(off.x, off.y, sa.z + sb.z + within(&seed, -1e-4, 1e-4)),
				    ob_quat_turn(ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, turn)), th));
		if (i % 7 == 0)
			a.p.x = a.p.y = 0;
		if (!rests)
			a = moving(&seed, a), b = moving(&seed, b);
		a.rest_depth = b.rest_depth = 2e-4, a.far_future = b.far_future = 10;
		view w = random_view(&seed, i % 16);
		failed[i % 16] += !same(&a, &b, 3e-3, &w);
	}
	for (int k = 0; k < 16; k++)
		all += failed[k];
	printf("flat, tilt %g, %s: %d are seen otherwise:", tilt, rests ? "at rest" : "moving", all);
	for (int k = 0; k < 16; k++)
		printf(" %d", failed[k]);
	printf("\n");
	CHECK(all == 0);
}

// A box and its mirror image meet head-on: an edge parallel to the other's, or a corner, in front. No axis of a face
// or of edges decides, so the normal is the way on which they meet.
static void test_head_on(bool corner)
{
	uint64_t seed = 3;
	int wrong = 0, failed = 0;
	for (int i = 0; i < 4000; i++) {
		const ob_vec3 half = random_size(&seed), front = { half.x, half.y, corner ? half.z : 0 };
		const double lean = within(&seed, -.6, .6), apart = i % 2 ? within(&seed, 0, 1e-4) : 1e-12;
		ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, 0, corner ? 0 : lean - M_PI / 4));
		if (corner) // the diagonal of a cube forward, then a little beside
			q = ob_quat_mul(ob_quat_turn(ob_quat_identity(), random_vector(&seed, .1)),
					ob_quat_turn(ob_quat_identity(),
						     ob_scale(ob_v3(0, M_SQRT1_2, -M_SQRT1_2), acos(1 / sqrt(3)))));
		const ob_mat3 r = ob_quat_matrix(q);
		ob_placed a = place(OB_SHAPE_BOX, half, ob_sub(ob_v3(-apart / 2, 0, 0), ob_rotate(&r, front)), q);
		a.v.x = within(&seed, .1, 10), a.rest_depth = i % 3 ? 2e-4 : 1e-6, a.far_future = 10;
		const view mirror = { .moved.q = ob_quat_identity(), .mirrored = true };
		const ob_placed b = seen(&mirror, &a);
		view w = random_view(&seed, i % 16);
		ob_manifold m = { .valid_path = INFINITY };
		ob_manifold_find(&a, &b, 3e-3, &m);
		wrong += m.points != (corner ? 1 : 2) || ob_norm(ob_sub(m.normal, ob_v3(-1, 0, 0))) > 1e-7;
		failed += !same(&a, &b, 3e-3, &w);
	}
	printf("head-on, %s: %d have another normal, %d are seen otherwise\n", corner ? "corners" : "edges", wrong,
	       failed);
	CHECK(wrong == 0 && failed == 0);
}

int main(void)
{
	test_head_on(false);
	test_head_on(true);
	test_random(OB_SHAPE_BOX, OB_SHAPE_BOX);
	test_random(OB_SHAPE_SPHERE, OB_SHAPE_BOX);
	for (int rests = 0; rests < 2; rests++) {
		test_flat(0, rests);
		test_flat(1e-6, rests);
		test_flat(1e-3, rests);
	}
	return check_end();
}
