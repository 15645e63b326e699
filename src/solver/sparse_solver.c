#include "solver/sparse_solver.h"

#include "base/allocate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BITS = 64 };

void ob_sparse_begin(ob_sparse_solver *t, uint32_t bodies)
{
	if (bodies > t->bodies_max) {
		ob_sparse_finish(t);
		t->bodies_max = bodies + bodies / 2;
		size_t n = t->bodies_max, words = (n + BITS - 1) / BITS;
		t->adjacent = ob_allocate(n * words * sizeof *t->adjacent);
		t->order = ob_allocate(n * sizeof *t->order);
		t->place = ob_allocate(n * sizeof *t->place);
		t->first = ob_allocate((n + 1) * sizeof *t->first);
		t->at = ob_allocate(n * n * sizeof *t->at);
		t->own = ob_allocate(n * sizeof *t->own);
		t->inverse = ob_allocate(n * sizeof *t->inverse);
		t->change = ob_allocate(n * sizeof *t->change);
	}
	t->bodies = bodies;
	t->words = (bodies + BITS - 1) / BITS;
	memset(t->adjacent, 0, (size_t)bodies * t->words * sizeof *t->adjacent);
}

static uint64_t *adjacent_to(const ob_sparse_solver *t, uint32_t body)
{
	return t->adjacent + (size_t)body * t->words;
}

void ob_sparse_link(ob_sparse_solver *t, uint32_t child, uint32_t parent)
{
	if (parent == OB_SPARSE_FIXED)
		return;
	adjacent_to(t, child)[parent / BITS] |= UINT64_C(1) << parent % BITS;
	adjacent_to(t, parent)[child / BITS] |= UINT64_C(1) << child % BITS;
}

static uint32_t degree(const ob_sparse_solver *t, uint32_t body)
{
	uint32_t n = 0;
	for (uint32_t k = 0; k < t->words; k++)
		n += (uint32_t)__builtin_popcountll(adjacent_to(t, body)[k]);
	return n;
}

// Links the body's neighbours with each other, and removes it.
static void remove_from_graph(ob_sparse_solver *t, uint32_t body, const uint32_t *neighbour, uint32_t n)
{
	const uint64_t *gone = adjacent_to(t, body);
	for (uint32_t i = 0; i < n; i++) {
		uint64_t *row = adjacent_to(t, neighbour[i]);
		for (uint32_t k = 0; k < t->words; k++)
			row[k] |= gone[k];
		row[neighbour[i] / BITS] &= ~(UINT64_C(1) << neighbour[i] % BITS);
		row[body / BITS] &= ~(UINT64_C(1) << body % BITS);
	}
}

static uint32_t *list_neighbours(ob_sparse_solver *t, uint32_t body, uint32_t from, uint32_t n)
{
	if (from + n >= t->below_max) {
		t->below_max = (from + n + 1) * 2;
		t->below = ob_reallocate(t->below, t->below_max * sizeof *t->below);
		free(t->block);
		t->block = ob_allocate(t->below_max * sizeof *t->block);
	}
	uint32_t *list = t->below + from;
	for (uint32_t k = 0; k < t->words; k++)
		for (uint64_t left = adjacent_to(t, body)[k]; left; left &= left - 1)
			*list++ = k * BITS + (uint32_t)__builtin_ctzll(left);
	return t->below + from;
}

bool ob_sparse_analyse(ob_sparse_solver *t, uint32_t most)
{
	uint64_t cost = 0;
	uint32_t blocks = 0, *left = t->order; // remaining bodies, behind the eliminated ones
	for (uint32_t i = 0; i < t->bodies; i++)
		left[i] = i;
	for (uint32_t k = 0; k < t->bodies; k++) {
		uint32_t best = k, least = UINT32_MAX;
		for (uint32_t i = k; i < t->bodies && least > 1; i++) {
			uint32_t n = degree(t, left[i]);
			if (n < least)
				best = i, least = n;
		}
		uint32_t body = left[best];
		left[best] = left[k];
		left[k] = body;
		t->place[body] = k;
		t->first[k] = blocks;
		const uint32_t *neighbour = list_neighbours(t, body, blocks, least);
		remove_from_graph(t, body, neighbour, least);
		for (uint32_t i = 0; i < least; i++) {
			t->at[(size_t)body * t->bodies + neighbour[i]] = blocks + i;
			t->at[(size_t)neighbour[i] * t->bodies + body] = blocks + i;
		}
		blocks += least;
		cost += (uint64_t)least * (least + 1) / 2;
		if (cost > (uint64_t)most * t->bodies)
			return false;
	}
	t->first[t->bodies] = blocks;
	memset(t->block, 0, blocks * sizeof *t->block);
	memset(t->change, 0, t->bodies * sizeof *t->change);
	return true;
}

// ---- assembly

void ob_sparse_add_inertia(ob_sparse_solver *t, uint32_t body, double m[6][8])
{
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++)
			t->own[body][i][k] = m[i][k];
}

void ob_sparse_add_joint(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		const double stiffness = 1 / j->compliance[r], push = stiffness * j->parent[r][6], *p = j->parent[r];
		for (int i = 0; i < 6; i++) {
			const double s = stiffness * j->child[i][r];
			for (int k = 0; k < 6; k++)
				t->own[child][i][k] += s * j->child[k][r];
			t->change[child][i] += push * j->child[i][r];
		}
		if (parent == OB_SPARSE_FIXED)
			continue;
		const bool child_first = t->place[child] < t->place[parent];
		double(*both)[6] = t->block[t->at[(size_t)child * t->bodies + parent]];
		for (int i = 0; i < 6; i++) {
			const double s = stiffness * p[i];
			for (int k = 0; k < 6; k++) {
				t->own[parent][i][k] += s * p[k];
				both[child_first ? i : k][child_first ? k : i] += s * j->child[k][r];
			}
			t->change[parent][i] += push * p[i];
		}
	}
}

// ---- solve

// Replaces the lower triangle by its Cholesky factor. A direction with nothing left but rounding does not move.
static void cholesky(double (*m)[6], double *inverse)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j <= i; j++) {
			double sum = m[i][j];
			for (int k = 0; k < j; k++)
				sum -= m[i][k] * m[j][k];
			if (i > j) {
				m[i][j] = sum * inverse[j];
				continue;
			}
			inverse[i] = sum > 0 ? 1 / sqrt(sum) : 0;
			m[i][i] = sum * inverse[i];
		}
}

// x <- L^-1 x
static void lower_solve(double (*root)[6], const double *inverse, double *x)
{
	for (int i = 0; i < 6; i++) {
		for (int k = 0; k < i; k++)
			x[i] -= root[i][k] * x[k];
		x[i] *= inverse[i];
	}
}

// x <- L^-T x
static void upper_solve(double (*root)[6], const double *inverse, double *x)
{
	for (int i = 5; i >= 0; i--) {
		for (int k = i + 1; k < 6; k++)
			x[i] -= root[k][i] * x[k];
		x[i] *= inverse[i];
	}
}

// m <- m - a b^T, with b^T given
static void subtract(double (*m)[6], double (*a)[6], double (*bt)[6])
{
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++)
			for (int c = 0; c < 6; c++)
				m[i][c] -= a[i][k] * bt[k][c];
}

static void eliminate_body(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k], from = t->first[k], to = t->first[k + 1];
	cholesky(t->own[body], t->inverse[body]);
	lower_solve(t->own[body], t->inverse[body], t->change[body]);
	for (uint32_t i = from; i < to; i++)
		for (int r = 0; r < 6; r++)
			lower_solve(t->own[body], t->inverse[body], t->block[i][r]);
	for (uint32_t i = from; i < to; i++) {
		const uint32_t sooner = t->below[i];
		ob_sparse_block turned;
		for (int r = 0; r < 6; r++)
			for (int c = 0; c < 6; c++)
				turned[c][r] = t->block[i][r][c];
		subtract(t->own[sooner], t->block[i], turned);
		for (int r = 0; r < 6; r++)
			for (int c = 0; c < 6; c++)
				t->change[sooner][r] -= t->block[i][r][c] * t->change[body][c];
		for (uint32_t j = from; j < to; j++) {
			const uint32_t later = t->below[j];
			if (t->place[later] > t->place[sooner])
				subtract(t->block[t->at[(size_t)sooner * t->bodies + later]], t->block[j], turned);
		}
	}
}

static void back_substitute(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k];
	for (uint32_t i = t->first[k]; i < t->first[k + 1]; i++)
		for (int r = 0; r < 6; r++)
			for (int c = 0; c < 6; c++)
				t->change[body][c] -= t->block[i][r][c] * t->change[t->below[i]][r];
	upper_solve(t->own[body], t->inverse[body], t->change[body]);
}

void ob_sparse_solve(ob_sparse_solver *t)
{
	for (uint32_t k = 0; k < t->bodies; k++)
		eliminate_body(t, k);
	for (uint32_t k = t->bodies; k-- > 0;)
		back_substitute(t, k);
}

void ob_sparse_joint_impulses(const ob_sparse_solver *t, ob_joint *j, uint32_t child, uint32_t parent)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		double left = j->parent[r][6];
		for (int i = 0; i < 6; i++)
			left -= j->child[i][r] * t->change[child][i];
		for (int i = 0; i < 6 && parent != OB_SPARSE_FIXED; i++)
			left -= j->parent[r][i] * t->change[parent][i];
		j->x[r] = left / j->compliance[r];
	}
}

void ob_sparse_finish(ob_sparse_solver *t)
{
	free(t->adjacent);
	free(t->order);
	free(t->place);
	free(t->first);
	free(t->below);
	free(t->at);
	free(t->block);
	free(t->own);
	free(t->inverse);
	free(t->change);
	*t = (ob_sparse_solver){ 0 };
}
