// The elimination for closed cycles of joints, against the equations that it solves, and its refusals.
#include "solver/sparse_solver.h"

#include <string.h>

#include "check.h"
#include "motion/random.h"

enum { BODIES = 12, JOINTS = 20, MANY = 70 };

typedef struct frame {
	double inertia[BODIES][6][8];
	uint32_t child[JOINTS], parent[JOINTS];
	ob_joint joint[JOINTS];
} frame;

static uint32_t pick(uint64_t *seed, uint32_t n)
{
	return (uint32_t)(n * .9999 * uniform(seed));
}

static void random_joint(ob_joint *j, uint64_t *seed)
{
	memset(j, 0, sizeof *j);
	j->rows = 1 + pick(seed, 7);
	for (uint32_t r = 0; r < j->rows; r++) {
		for (int i = 0; i < 6; i++) {
			j->child[i][r] = within(seed, -1, 1);
			j->parent[r][i] = within(seed, -1, 1);
		}
		j->parent[r][6] = within(seed, -1, 1);
		j->compliance[r] = pow(10, within(seed, -5, -2));
	}
}

// More joints than bodies, some of them to fixed bodies.
static void random_frame(frame *f, uint64_t *seed)
{
	memset(f, 0, sizeof *f);
	for (int k = 0; k < BODIES; k++) {
		double mass = pow(10, within(seed, -1, 1));
		for (int i = 0; i < 6; i++)
			f->inertia[k][i][i] = mass * within(seed, .5, 2);
		f->inertia[k][3][4] = f->inertia[k][4][3] = .3 * mass * within(seed, -1, 1);
	}
	for (int k = 0; k < JOINTS; k++) {
		f->child[k] = pick(seed, BODIES);
		do
			f->parent[k] = pick(seed, BODIES);
		while (f->parent[k] == f->child[k]);
		if (k % 5 == 0)
			f->parent[k] = OB_SPARSE_FIXED;
		random_joint(&f->joint[k], seed);
	}
}

static bool solve(frame *f, ob_sparse_solver *t, uint32_t most)
{
	ob_sparse_begin(t, BODIES);
	for (int k = 0; k < JOINTS; k++)
		ob_sparse_link(t, f->child[k], f->parent[k]);
	if (!ob_sparse_analyse(t, most))
		return false;
	for (uint32_t k = 0; k < BODIES; k++)
		ob_sparse_add_inertia(t, k, f->inertia[k]);
	for (int k = 0; k < JOINTS; k++)
		ob_sparse_add_joint(t, &f->joint[k], f->child[k], f->parent[k]);
	ob_sparse_solve(t);
	for (int k = 0; k < JOINTS; k++)
		ob_sparse_joint_impulses(t, &f->joint[k], f->child[k], f->parent[k]);
	return true;
}

// M dv = sum of J^T x for each body. J dv + e x = y holds for each row by construction of x.
static void check_frame(uint64_t *seed, ob_sparse_solver *t)
{
	frame f;
	double force[BODIES][6] = { 0 }, scale = 0;
	random_frame(&f, seed);
	CHECK(solve(&f, t, UINT32_MAX / BODIES));
	for (int k = 0; k < JOINTS; k++)
		for (uint32_t r = 0; r < f.joint[k].rows; r++)
			for (int i = 0; i < 6; i++) {
				force[f.child[k]][i] += f.joint[k].child[i][r] * f.joint[k].x[r];
				if (f.parent[k] != OB_SPARSE_FIXED)
					force[f.parent[k]][i] += f.joint[k].parent[r][i] * f.joint[k].x[r];
				scale = fmax(scale, fabs(f.joint[k].x[r]));
			}
	CHECK(scale > 0);
	for (int k = 0; k < BODIES; k++)
		for (int i = 0; i < 6; i++) {
			double momentum = 0;
			for (int j = 0; j < 6; j++)
				momentum += f.inertia[k][i][j] * t->change[k][j];
			CHECK_NEAR(momentum / scale, force[k][i] / scale, 1e-8);
		}
}

// A chain costs one product a body, in any order of its links; a clique costs too much.
static void test_cost(ob_sparse_solver *t)
{
	ob_sparse_begin(t, MANY);
	for (uint32_t k = 0; k + 1 < MANY; k++)
		ob_sparse_link(t, k * 29 % MANY, (k + 1) * 29 % MANY);
	CHECK(ob_sparse_analyse(t, 1));
	CHECK(t->first[MANY] == MANY - 1);
	ob_sparse_begin(t, MANY);
	for (uint32_t k = 0; k < MANY; k++)
		for (uint32_t i = 0; i < k; i++)
			ob_sparse_link(t, k, i);
	CHECK(!ob_sparse_analyse(t, MANY));
}

int main(void)
{
	uint64_t seed = 1;
	ob_sparse_solver t = { 0 };
	for (int i = 0; i < 1000; i++)
		check_frame(&seed, &t);
	test_cost(&t);
	ob_sparse_finish(&t);
	return check_end();
}
