// A contact that is solved at once by itself comes to the same impulses as in a batch with three empty lanes, on every
// processor to the same bits.
#include "contact/batch.h"

#include "check.h"
#include "scene.h"

// One lane with a body that moves, and one that does not; the others are empty. In the middle of a substep, such as
// contacts are that go on: some turn, some are hit.
static int random_lone(scene *s, uint64_t *seed)
{
	const int l = (int)(OB_LANES * uniform(seed));
	random_scene(s, seed, within(seed, 0, .3));
	const double slow = uniform(seed) < .5 ? 1e-3 : 1;
	pair *p = &s->p[l];
	p->b.inv_mass = 0;
	memset(&p->b.inv_inertia, 0, sizeof p->b.inv_inertia);
	memset(s->v[row_a(l) + 1], 0, sizeof s->v[0]);
	for (int c = 0; c < 6; c++)
		s->v[row_a(l)][c] *= slow;
	p->e = uniform(seed) < .5 ? 0 : p->e;
	for (int j = 0; j < p->points; j++)
		p->gap[j] *= slow;
	put(s, l);
	for (int i = 0; i < OB_LANES; i++)
		if (i != l)
			ob_batch_clear(&s->batch, i);
	ob_batch_prepare(&s->batch);
	s->batch.isolated = s->batch.live;
	s->batch.hit = uniform(seed) < .3 ? s->batch.live : 0;
	s->batch.turning = uniform(seed) < .3 ? s->batch.live : 0;
	for (int i = 0; i < OB_ROWS; i++)
		lanes_put(&s->batch.turn[i], l, within(seed, -.01, .01));
	memcpy(s->u, s->v, sizeof s->u);
	for (int c = 0; c < 3; c++)
		s->dv[row_a(l)][c] = slow * within(seed, -.02, .02), s->u[row_a(l)][c] += s->dv[row_a(l)][c];
	return l;
}

// No gap closes farther than it may, no point that leaves it pushes, and what holds does not slip.
static void check_law(const scene *s, int l)
{
	const ob_batch *b = &s->batch;
	const bool turning = b->turning, slides = b->slides;
	lanes rate[OB_ROWS];
	double sum = 0;
	ob_batch_row_velocities(b, s->u, rate);
	for (int j = 0; j < s->p[l].points; j++) {
		const double x = b->impulse[j][l], left = rate[j][l] + b->bias[j][l];
		CHECK(x >= 0);
		CHECK(left >= -1e-9);
		CHECK(x == 0 || left <= 1e-9);
		sum += x;
	}
	const double bound = s->p[l].mu * sum;
	CHECK(hypot(b->impulse[4][l], b->impulse[5][l]) <= bound * (1 + 1e-9) + 1e-15);
	const double arm = hypot(b->patch_e1[0][l], b->patch_e1[1][l]) + hypot(b->patch_e2[0][l], b->patch_e2[1][l]);
	CHECK(fabs(b->impulse[6][l]) <= 2 * bound * arm);
	for (int i = OB_POINTS; i < OB_ROWS && !slides; i++)
		CHECK_NEAR((rate[i][l] + (turning ? b->turn[i][l] : 0)) * (i < 6 ? 1 : b->radius[l]), 0, 1e-9);
}

static bool carries(const ob_batch *b, int l)
{
	double sum = 0;
	for (int j = 0; j < OB_POINTS; j++)
		sum += b->impulse[j][l];
	return sum > 0;
}

static double apart(const scene *a, const scene *b, int l)
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, fabs(b->u[row_a(l)][c] - a->u[row_a(l)][c]));
	return most;
}

int main(void)
{
	enum { SCENES = 20000 };
	uint64_t seed = 1;
	int slid = 0, held = 0, unsolved = 0, elsewhere = 0, near = 0;
	for (int i = 0; i < SCENES; i++) {
		scene a, b, c;
		const int l = random_lone(&a, &seed);
		memcpy(&b, &a, sizeof b); // padding too
		memcpy(&c, &a, sizeof c);
		const ob_solver_iteration iteration = iteration_on(&a, true);
		ob_kernel_portable.solve(&a.batch, &iteration, a.u, a.v, a.d, a.delta);
		ob_batch_solve(&b.batch, &iteration, b.u, b.v, b.d, b.delta);
		ob_kernel_portable.solve_lone(&c.batch, l, &iteration, c.u, c.v, c.d);
		CHECK(memcmp(&b.batch, &c.batch, sizeof b.batch) == 0);
		CHECK(memcmp(b.u, c.u, sizeof b.u) == 0);
		if (b.batch.solved)
			check_law(&b, l);
		else
			unsolved++;
		const bool loaded = carries(&b.batch, l);
		slid += loaded && b.batch.slides;
		held += loaded && !b.batch.slides;
		if (!a.batch.solved || !b.batch.solved)
			continue;
		elsewhere += apart(&a, &b, l) > .01; // a lever that jams has several solutions
		near += apart(&a, &b, l) < 1e-6;
	}
	CHECK(slid > SCENES / 4);
	CHECK(held > SCENES / 100);
	CHECK(unsolved < SCENES / 50);
	CHECK(elsewhere < SCENES / 1000);
	CHECK(near > SCENES * 9 / 10);
	return check_end();
}
