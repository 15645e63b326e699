// The elimination of bodies with joints in trees and cycles, against the equations that it solves, and its refusals.
#include "solver/sparse_solver.h"

#include <string.h>

#include "check.h"
#include "motion/random.h"

enum { BODIES = 12, JOINTS = 20, MANY = 70, LONG = 20000 };

typedef struct frame {
	double inertia[BODIES][6][6];
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
			j->child[r][i] = within(seed, -1, 1);
			j->parent[r][i] = within(seed, -1, 1);
		}
		j->y[r] = within(seed, -1, 1);
		j->stiffness[r] = pow(10, within(seed, 2, 5));
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
	ob_sparse_clear(t);
	for (uint32_t k = 0; k < BODIES; k++)
		ob_sparse_set_inertia(t, k, f->inertia[k]);
	for (int k = 0; k < JOINTS; k++) {
		ob_sparse_add_joint(t, &f->joint[k], f->child[k], f->parent[k]);
		ob_sparse_push(t, &f->joint[k], f->child[k], f->parent[k]);
	}
	ob_sparse_factor(t);
	ob_sparse_substitute(t);
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
				force[f.child[k]][i] += f.joint[k].child[r][i] * f.joint[k].x[r];
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

// A duplicate row: both carry the same load.
static void test_said_twice(ob_sparse_solver *t)
{
	double inertia[6][6] = {
		{ 2 }, { 0, 2 }, { 0, 0, 2 }, { 0, 0, 0, 1 }, { 0, 0, 0, 0, 1 }, { 0, 0, 0, 0, 0, 1 }
	};
	ob_joint j = { .rows = 2, .stiffness = { 1e7, 1e7 }, .y = { 3, 3 } };
	j.child[0][2] = j.child[1][2] = 1;
	ob_sparse_begin(t, 1);
	ob_sparse_link(t, 0, OB_SPARSE_FIXED);
	CHECK(ob_sparse_analyse(t, 0));
	ob_sparse_clear(t);
	ob_sparse_set_inertia(t, 0, inertia);
	ob_sparse_add_joint(t, &j, 0, OB_SPARSE_FIXED);
	ob_sparse_push(t, &j, 0, OB_SPARSE_FIXED);
	ob_sparse_factor(t);
	ob_sparse_substitute(t);
	ob_sparse_joint_impulses(t, &j, 0, OB_SPARSE_FIXED);
	CHECK_NEAR(t->change[0][2], 3, 1e-6);
	CHECK_NEAR(j.x[0], 3, 1e-6);
	CHECK(j.x[0] == j.x[1]);
}

// A tree of many bodies, a star among them, has one block and one product for each joint, and edges for its joints alone.
static void test_tree(ob_sparse_solver *t)
{
	ob_sparse_begin(t, LONG);
	for (uint32_t k = 1; k < LONG; k++)
		ob_sparse_link(t, k, k < LONG / 2 ? 0 : k / 2);
	CHECK(ob_sparse_analyse(t, 1));
	CHECK(t->first[LONG] == LONG - 1);
	CHECK(t->edges == 2 * (LONG - 1));
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
	test_tree(&t);
	test_said_twice(&t);
	ob_sparse_finish(&t);
	return check_end();
}
