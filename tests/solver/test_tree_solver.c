// The elimination along a tree against the same equations solved all at once.
#include "solver/tree_solver.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "motion/random.h"

enum { BODIES = 7, ROWS_MAX = BODIES * OB_JOINT_ROWS };

// Body k is linked to up[k]; -1: to none. A fixed body holds body 0 and body 2.
typedef struct tree {
	int up[BODIES];
	double inertia[BODIES][6][6];
	ob_joint joint[BODIES], anchor[2];
} tree;

static const int anchored[2] = { 0, 2 };

static void random_joint(ob_joint *j, uint64_t *seed)
{
	memset(j, 0, sizeof *j);
	j->rows = 1 + (uint32_t)(6.999 * uniform(seed));
	for (uint32_t r = 0; r < j->rows; r++) {
		for (int i = 0; i < 6; i++) {
			j->child[i][r] = within(seed, -1, 1);
			j->parent[r][i] = within(seed, -1, 1);
		}
		j->parent[r][6] = within(seed, -1, 1);
		j->compliance[r] = pow(10, within(seed, -6, -2));
	}
}

static void random_tree(tree *t, uint64_t *seed)
{
	for (int k = 0; k < BODIES; k++) {
		double mass = pow(10, within(seed, -2, 2));
		t->up[k] = k == 0 || k == 4 ? -1 : (int)(k * .999 * uniform(seed)); // two trees
		memset(t->inertia[k], 0, sizeof t->inertia[k]);
		for (int i = 0; i < 6; i++)
			t->inertia[k][i][i] = mass * within(seed, .5, 2);
		t->inertia[k][3][4] = t->inertia[k][4][3] = .3 * mass * within(seed, -1, 1);
		random_joint(&t->joint[k], seed);
	}
	for (int k = 0; k < 2; k++)
		random_joint(&t->anchor[k], seed);
}

static void solve(const tree *t, tree *solved, ob_link *link)
{
	*solved = *t;
	for (int k = 0; k < BODIES; k++) {
		memset(&link[k], 0, sizeof link[k]);
		for (int i = 0; i < 6; i++)
			memcpy(link[k].m[i], t->inertia[k][i], sizeof t->inertia[k][i]);
	}
	for (int k = 0; k < 2; k++)
		ob_link_anchor(&link[anchored[k]], &solved->anchor[k]);
	for (int k = BODIES - 1; k >= 0; k--)
		ob_link_eliminate(&link[k], t->up[k] < 0 ? NULL : &solved->joint[k],
				  t->up[k] < 0 ? NULL : &link[t->up[k]]);
	for (int k = 0; k < BODIES; k++)
		ob_link_substitute(&link[k], t->up[k] < 0 ? NULL : &solved->joint[k],
				   t->up[k] < 0 ? NULL : &link[t->up[k]]);
	for (int k = 0; k < 2; k++)
		ob_link_anchor_impulses(&link[anchored[k]], &solved->anchor[k]);
}

// M dv = sum of J^T x for each body, and J dv + e x = y for each row.
static void check_joint(const ob_joint *given, const ob_joint *solved, const ob_link *child, const ob_link *parent,
			double (*force_child)[6], double (*force_parent)[6])
{
	for (uint32_t r = 0; r < given->rows; r++) {
		double rate = given->compliance[r] * solved->x[r];
		for (int i = 0; i < 6; i++) {
			rate += given->child[i][r] * child->change[i];
			(*force_child)[i] += given->child[i][r] * solved->x[r];
			if (!parent)
				continue;
			rate += given->parent[r][i] * parent->change[i];
			(*force_parent)[i] += given->parent[r][i] * solved->x[r];
		}
		CHECK_NEAR(rate, given->parent[r][6], 1e-8);
	}
}

static void check_tree(uint64_t *seed)
{
	tree t, solved;
	ob_link link[BODIES];
	double force[BODIES][6] = { 0 }, scale = 0;
	random_tree(&t, seed);
	solve(&t, &solved, link);
	for (int k = 0; k < BODIES; k++)
		if (t.up[k] >= 0)
			check_joint(&t.joint[k], &solved.joint[k], &link[k], &link[t.up[k]], &force[k],
				    &force[t.up[k]]);
	for (int k = 0; k < 2; k++)
		check_joint(&t.anchor[k], &solved.anchor[k], &link[anchored[k]], NULL, &force[anchored[k]], NULL);
	for (int k = 0; k < BODIES; k++)
		for (int i = 0; i < 6; i++)
			scale = fmax(scale, fabs(force[k][i]));
	CHECK(scale > 0);
	for (int k = 0; k < BODIES; k++)
		for (int i = 0; i < 6; i++) {
			double momentum = 0;
			for (int j = 0; j < 6; j++)
				momentum += t.inertia[k][i][j] * link[k].change[j];
			CHECK_NEAR(momentum / scale, force[k][i] / scale, 1e-8);
		}
}

// A duplicate row: both carry the same load.
static void test_said_twice(void)
{
	ob_link link = {
		.m = { { 2 }, { 0, 2 }, { 0, 0, 2 }, { 0, 0, 0, 1 }, { 0, 0, 0, 0, 1 }, { 0, 0, 0, 0, 0, 1 } }
	};
	ob_joint j = { .rows = 2, .compliance = { 1e-7, 1e-7 } };
	j.child[2][0] = j.child[2][1] = 1;
	j.parent[0][6] = j.parent[1][6] = 3;
	ob_link_anchor(&link, &j);
	ob_link_eliminate(&link, NULL, NULL);
	ob_link_substitute(&link, NULL, NULL);
	ob_link_anchor_impulses(&link, &j);
	CHECK_NEAR(link.change[2], 3, 1e-6);
	CHECK_NEAR(j.x[0], 3, 1e-6);
	CHECK(j.x[0] == j.x[1]);
}

int main(void)
{
	uint64_t seed = 1;
	for (int i = 0; i < 1000; i++)
		check_tree(&seed);
	test_said_twice();
	return check_end();
}
