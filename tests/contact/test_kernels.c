// The kernels for each instruction set give the same bits.
#include "contact/kernel.h"

#include "check.h"
#include "placed.h"
#include "scene.h"

enum { SKIPPED = 77 }; // meson's exit code for it

static void run(const ob_kernel *k, scene *s, bool jacobi)
{
	static const double cap[OB_LANES] = { .01, .02, .03, .04 };
	k->prepare(&s->batch);
	for (int round = 0; round < 4; round++) {
		ob_solver_iteration iteration = iteration_on(s, round == 0);
		iteration.jacobi = jacobi;
		k->solve(&s->batch, &iteration, s->u, s->v, s->d, s->delta);
	}
	k->project(&s->batch, 1e-4, .3, jacobi, s->d, s->delta);
	k->limit_prediction(&s->batch, cap, .05);
	lanes rate[OB_ROWS];
	k->row_velocities(&s->batch, s->u, rate);
	k->apply_impulses(&s->batch, rate, s->delta);
}

static void compare(const ob_kernel *x, const ob_kernel *y)
{
	uint64_t seed = 1;
	for (int i = 0; i < 3000; i++) {
		scene a, b;
		random_scene_of(&a, &seed, within(&seed, -1, 3), (ob_batch_kind)(i % OB_KINDS));
		if (i % 5 == 0)
			ob_batch_clear(&a.batch, (int)(OB_LANES * uniform(&seed)));
		a.batch.elastic = (unsigned)(16 * uniform(&seed));
		a.batch.isolated = (unsigned)(16 * uniform(&seed));
		memcpy(&b, &a, sizeof b); // padding included
		run(x, &a, i / OB_KINDS % 2);
		run(y, &b, i / OB_KINDS % 2);
		CHECK(memcmp(&a.batch, &b.batch, sizeof a.batch) == 0);
		CHECK(memcmp(a.u, b.u, sizeof a.u) == 0);
		CHECK(memcmp(a.d, b.d, sizeof a.d) == 0);
		CHECK(memcmp(a.delta, b.delta, sizeof a.delta) == 0);
	}
}

static void fill(const ob_kernel *k, const pair *p, ob_batch *b, ob_vec3 arm[4])
{
	ob_batch_lane in = { .normal = p->normal,
			     .points = p->points,
			     .arm_a = p->arm_a,
			     .arm_b = p->arm_b,
			     .gap = p->gap,
			     .inv_inertia_a = p->a.inv_inertia,
			     .inv_inertia_b = p->b.inv_inertia };
	k->friction_arms(p->arm_a, p->arm_b, p->gap, p->points, p->normal, &arm[0], &arm[1]);
	for (int l = 0; l < OB_LANES; l++)
		k->set(b, l, &in, &arm[2], &arm[3]);
}

static void compare_lanes(const ob_kernel *x, const ob_kernel *y)
{
	uint64_t seed = 3;
	for (int i = 0; i < 10000; i++) {
		ob_batch a, b;
		pair p = random_pair(&seed, 1);
		memset(&a, 0, sizeof a);
		memset(&b, 0, sizeof b);
		for (int j = 0; j < p.points; j++)
			p.gap[j] = within(&seed, -1e-3, 1e-3);
		ob_vec3 of_a[4], of_b[4];
		fill(x, &p, &a, of_a);
		fill(y, &p, &b, of_b);
		CHECK(memcmp(&a, &b, sizeof a) == 0);
		CHECK(memcmp(of_a, of_b, sizeof of_a) == 0);
		CHECK(memcmp(&of_a[0], &of_a[2], 2 * sizeof of_a[0]) == 0); // found alone, and with the lane
	}
}

// Boxes with separations about the width of their margin; some of them aligned, so that axes are parallel and gaps
// equal.
static void compare_boxes(const ob_kernel *x, const ob_kernel *y)
{
	uint64_t seed = 2;
	int touching = 0;
	for (int i = 0; i < 20000; i++) {
		ob_placed a = random_placed(&seed, OB_SHAPE_BOX, 1), b = random_placed(&seed, OB_SHAPE_BOX, 1);
		ob_manifold m, n;
		memset(&m, 0, sizeof m);
		if (i % 4 == 0)
			b.r = a.r;
		if (i % 8 == 0)
			b.size = a.size;
		a.v = random_vector(&seed, 1), a.w = random_vector(&seed, 5);
		a.rest_depth = b.rest_depth = 1e-3;
		n = m;
		const double margin = within(&seed, 0, .5);
		x->boxes(&a, &b, margin, &m);
		y->boxes(&a, &b, margin, &n);
		CHECK(memcmp(&m, &n, sizeof m) == 0);
		touching += m.points > 0;
	}
	CHECK(touching > 5000);
}

static void compare_all(const ob_kernel *x, const ob_kernel *y)
{
	compare(x, y);
	compare_lanes(x, y);
	compare_boxes(x, y);
}

int main(void)
{
	if (ob_kernel_best() == &ob_kernel_portable)
		return SKIPPED;
	compare_all(ob_kernel_best(), &ob_kernel_portable);
#ifdef OB_HAVE_AVX2
	compare_all(&ob_kernel_avx2, &ob_kernel_portable); // it may be the second best
#endif
	return check_end();
}
