#include "solver/tree_solver.h"

#include <math.h>

// Factors the lower triangle of a symmetric matrix, row i of width "stride" (Cholesky). A direction with nothing left
// but rounding does not move.
static void cholesky(int n, int stride, const double *m, int root_stride, double *root, double *inverse)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j <= i; j++) {
			double sum = m[i * stride + j];
			for (int k = 0; k < j; k++)
				sum -= root[i * root_stride + k] * root[j * root_stride + k];
			if (i > j) {
				root[i * root_stride + j] = sum * inverse[j];
				continue;
			}
			root[i * root_stride + i] = sum > 0 ? sqrt(sum) : 0;
			inverse[i] = sum > 0 ? 1 / root[i * root_stride + i] : 0;
		}
}

// Rows of eight: x[i] <- (L^-1 x)[i]
static void lower_solve(int n, int root_stride, const double *root, const double *inverse, double (*x)[8])
{
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < i; k++)
			for (int c = 0; c < 8; c++)
				x[i][c] -= root[i * root_stride + k] * x[k][c];
		for (int c = 0; c < 8; c++)
			x[i][c] *= inverse[i];
	}
}

// x <- L^-T x
static void upper_solve(int n, int root_stride, const double *root, const double *inverse, double *x)
{
	for (int i = n - 1; i >= 0; i--) {
		for (int k = i + 1; k < n; k++)
			x[i] -= root[k * root_stride + i] * x[k];
		x[i] *= inverse[i];
	}
}

void ob_link_anchor(ob_link *child, const ob_joint *j)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		double stiffness = 1 / j->compliance[r];
		for (int i = 0; i < 6; i++) {
			double s = stiffness * j->child[i][r];
			for (int k = 0; k < 6; k++)
				child->m[i][k] += s * j->child[k][r];
			child->m[i][6] += s * j->parent[r][6];
		}
	}
}

void ob_link_eliminate(ob_link *child, ob_joint *j, ob_link *parent)
{
	cholesky(6, 8, child->m[0], 6, child->root[0], child->inverse);
	double push[6][8] = { 0 }, (*rows)[8] = j ? j->child : push;
	for (int i = 0; i < 6; i++)
		rows[i][7] = child->m[i][6];
	lower_solve(6, 6, child->root[0], child->inverse, rows);
	for (int i = 0; i < 6; i++)
		child->m[i][6] = rows[i][7];
	if (!j)
		return;
	double s[8][8] = { 0 };
	for (int i = 0; i < 6; i++)
		for (int r = 0; r < 8; r++)
			for (int c = 0; c < 8; c++)
				s[r][c] += j->child[i][r] * j->child[i][c];
	for (uint32_t r = 0; r < j->rows; r++) {
		s[r][r] += j->compliance[r];
		j->parent[r][6] -= s[r][7];
	}
	cholesky((int)j->rows, 8, s[0], 8, j->root[0], j->inverse);
	lower_solve((int)j->rows, 8, j->root[0], j->inverse, j->parent);
	for (uint32_t r = 0; r < j->rows; r++)
		for (int i = 0; i < 6; i++)
			for (int c = 0; c < 8; c++)
				parent->m[i][c] += j->parent[r][i] * j->parent[r][c];
}

void ob_link_substitute(ob_link *child, ob_joint *j, const ob_link *parent)
{
	for (int i = 0; i < 6; i++)
		child->change[i] = child->m[i][6];
	if (j) {
		for (uint32_t r = 0; r < j->rows; r++) {
			j->x[r] = j->parent[r][6];
			for (int i = 0; i < 6; i++)
				j->x[r] -= j->parent[r][i] * parent->change[i];
		}
		upper_solve((int)j->rows, 8, j->root[0], j->inverse, j->x);
		for (int i = 0; i < 6; i++)
			for (uint32_t r = 0; r < j->rows; r++)
				child->change[i] += j->child[i][r] * j->x[r];
	}
	upper_solve(6, 6, child->root[0], child->inverse, child->change);
}

void ob_link_anchor_impulses(const ob_link *child, ob_joint *j)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		double left = j->parent[r][6];
		for (int i = 0; i < 6; i++)
			left -= j->child[i][r] * child->change[i];
		j->x[r] = left / j->compliance[r];
	}
}
