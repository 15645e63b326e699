#include "solver/sparse_solver.h"

#include "base/allocate.h"
#include "solver/six.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NONE = UINT32_MAX };

void ob_sparse_begin(ob_sparse_solver *t, uint32_t bodies)
{
	if (bodies > t->bodies_max) {
		ob_sparse_finish(t);
		t->bodies_max = bodies + bodies / 2;
		size_t n = t->bodies_max;
		t->node = ob_allocate(n * sizeof *t->node);
		t->least = ob_allocate(n * sizeof *t->least);
		t->order = ob_allocate(n * sizeof *t->order);
		t->first = ob_allocate((n + 1) * sizeof *t->first);
		t->own = ob_allocate(n * sizeof *t->own);
		t->inverse = ob_allocate(n * sizeof *t->inverse);
		t->change = ob_allocate(n * sizeof *t->change);
	}
	t->bodies = bodies;
	t->edges = 0;
	for (uint32_t i = 0; i < bodies; i++)
		t->node[i] = (ob_sparse_node){ .edges = NONE, .place = NONE, .mark = NONE };
}

// ---- the graph

static void add_edge(ob_sparse_solver *t, uint32_t from, uint32_t to)
{
	if (t->edges == t->edges_max) {
		t->edges_max = 2 * t->edges_max + 64;
		t->edge = ob_reallocate(t->edge, t->edges_max * sizeof *t->edge);
	}
	t->edge[t->edges] = (ob_sparse_edge){ to, t->node[from].edges };
	t->node[from].edges = t->edges++;
	t->node[from].degree++;
}

void ob_sparse_link(ob_sparse_solver *t, uint32_t child, uint32_t parent)
{
	t->node[child].linked = true;
	if (parent == OB_SPARSE_FIXED)
		return;
	t->node[parent].linked = true;
	const bool fewer = t->node[child].degree < t->node[parent].degree;
	const uint32_t from = fewer ? child : parent, to = fewer ? parent : child;
	for (uint32_t e = t->node[from].edges; e != NONE; e = t->edge[e].next)
		if (t->edge[e].to == to)
			return;
	add_edge(t, child, parent);
	add_edge(t, parent, child);
}

// ---- the order of elimination

static void enter_degree(ob_sparse_solver *t, uint32_t body)
{
	ob_sparse_node *node = &t->node[body];
	uint32_t *least = &t->least[node->degree];
	node->previous = NONE, node->next = *least;
	if (*least != NONE)
		t->node[*least].previous = body;
	*least = body;
}

static void leave_degree(ob_sparse_solver *t, uint32_t body)
{
	const ob_sparse_node *node = &t->node[body];
	if (node->previous == NONE)
		t->least[node->degree] = node->next;
	else
		t->node[node->previous].next = node->next;
	if (node->next != NONE)
		t->node[node->next].previous = node->previous;
}

// Lists the neighbours that are not eliminated yet, from this place in "below".
static const uint32_t *list_neighbours(ob_sparse_solver *t, uint32_t body, uint32_t from)
{
	if (from + t->node[body].degree >= t->below_max) {
		t->below_max = (from + t->node[body].degree + 1) * 2;
		t->below = ob_reallocate(t->below, t->below_max * sizeof *t->below);
	}
	uint32_t *list = t->below + from;
	for (uint32_t e = t->node[body].edges; e != NONE; e = t->edge[e].next)
		if (t->node[t->edge[e].to].place == NONE)
			*list++ = t->edge[e].to;
	return t->below + from;
}

// Links a neighbour of an eliminated body with the others.
static void link_neighbour(ob_sparse_solver *t, uint32_t body, const uint32_t *neighbour, uint32_t n)
{
	ob_sparse_node *node = &t->node[body];
	uint32_t *last = &node->edges;
	node->mark = body;
	for (uint32_t e = node->edges; e != NONE; e = t->edge[e].next) {
		if (t->node[t->edge[e].to].place != NONE)
			continue; // eliminated: leaves the chain
		t->node[t->edge[e].to].mark = body;
		*last = e;
		last = &t->edge[e].next;
	}
	*last = NONE;
	for (uint32_t i = 0; i < n; i++)
		if (t->node[neighbour[i]].mark != body)
			add_edge(t, body, neighbour[i]);
}

// Links the body's neighbours with each other, and removes it. Returns the least degree that may have come about.
static uint32_t remove_from_graph(ob_sparse_solver *t, const uint32_t *neighbour, uint32_t n)
{
	uint32_t least = n;
	for (uint32_t i = 0; i < n; i++) {
		leave_degree(t, neighbour[i]);
		t->node[neighbour[i]].degree--;
		if (n > 1)
			link_neighbour(t, neighbour[i], neighbour, n);
		enter_degree(t, neighbour[i]);
		const uint32_t degree = t->node[neighbour[i]].degree;
		least = degree < least ? degree : least;
	}
	return least;
}

static void reserve_blocks(ob_sparse_solver *t, uint32_t blocks)
{
	if (blocks > t->blocks_max) {
		t->blocks_max = 2 * blocks;
		free(t->block);
		t->block = ob_allocate(t->blocks_max * sizeof *t->block);
	}
}

bool ob_sparse_analyse(ob_sparse_solver *t, uint32_t most)
{
	uint64_t cost = 0;
	uint32_t blocks = 0, degree = 0;
	for (uint32_t i = 0; i < t->bodies; i++)
		t->least[i] = NONE;
	for (uint32_t i = t->bodies; i-- > 0;)
		if (t->node[i].linked)
			enter_degree(t, i);
	t->unlinked = 0;
	for (uint32_t i = t->bodies; i-- > 0;)
		if (!t->node[i].linked) {
			enter_degree(t, i);
			t->unlinked++;
		}
	for (uint32_t k = 0; k < t->bodies; k++) {
		while (t->least[degree] == NONE)
			degree++;
		const uint32_t body = t->least[degree], n = degree;
		leave_degree(t, body);
		t->node[body].place = k;
		t->order[k] = body;
		t->first[k] = blocks;
		degree = remove_from_graph(t, list_neighbours(t, body, blocks), n);
		blocks += n;
		cost += (uint64_t)n * (n + 1) / 2;
		if (cost > (uint64_t)most * t->bodies)
			return false;
	}
	t->first[t->bodies] = blocks;
	reserve_blocks(t, blocks);
	return true;
}

// ---- assembly

void ob_sparse_set_inertia(ob_sparse_solver *t, uint32_t body, double (*m)[6])
{
	memcpy(t->own[body], m, sizeof t->own[body]);
}

// Returns the block of two bodies, of which the first is eliminated sooner.
static uint32_t block_of(const ob_sparse_solver *t, uint32_t sooner, uint32_t later)
{
	uint32_t i = t->first[t->node[sooner].place];
	while (t->below[i] != later)
		i++;
	return i;
}

void ob_sparse_clear(ob_sparse_solver *t)
{
	const uint32_t blocks = t->first[t->bodies];
	if (blocks)
		memset(t->block, 0, blocks * sizeof *t->block);
	ob_sparse_begin_side(t);
}

void ob_sparse_begin_side(ob_sparse_solver *t)
{
	memset(t->change, 0, t->bodies * sizeof *t->change);
}

void ob_sparse_push(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		const double push = j->stiffness[r] * j->y[r];
		ob_six_add(t->change[child], push, j->child[r]);
		if (parent != OB_SPARSE_FIXED)
			ob_six_add(t->change[parent], push, j->parent[r]);
	}
}

// Adds s x y^T, or its lower triangle: the upper one is undefined then.
static void add_product(double (*m)[6], double s, const double *x, const double *y, bool lower)
{
	for (int i = 0; i < 6; i++)
		ob_six_add_pairs(m[i], s * x[i], y, lower ? 1 + i / 2 : 3);
}

void ob_sparse_add_joint(ob_sparse_solver *t, const ob_joint *j, uint32_t child, uint32_t parent)
{
	const bool fixed = parent == OB_SPARSE_FIXED,
		   child_first = fixed || t->node[child].place < t->node[parent].place;
	double(*both)[6] =
		fixed ? NULL : t->block[child_first ? block_of(t, child, parent) : block_of(t, parent, child)];
	for (uint32_t r = 0; r < j->rows; r++) {
		const double *x = child_first ? j->child[r] : j->parent[r],
			     *y = child_first ? j->parent[r] : j->child[r];
		add_product(t->own[child], j->stiffness[r], j->child[r], j->child[r], true);
		if (fixed)
			continue;
		add_product(t->own[parent], j->stiffness[r], j->parent[r], j->parent[r], true);
		add_product(both, j->stiffness[r], x, y, false);
	}
}

// ---- solve

// Replaces the lower triangle by its Cholesky factor, and the upper one by its transpose. A direction with nothing left but rounding
// does not move.
static void cholesky(double (*m)[6], double *inverse)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j <= i; j++) {
			double sum = m[i][j];
			for (int k = 0; k < j; k++)
				sum -= m[i][k] * m[j][k];
			if (i > j) {
				m[i][j] = m[j][i] = sum * inverse[j];
				continue;
			}
			inverse[i] = sum > 0 ? 1 / sqrt(sum) : 0;
			m[i][i] = sum * inverse[i];
		}
}

// x <- L^-1 x
static void lower_solve(double (*root)[6], const double *inverse, double *x)
{
	for (int k = 0; k < 6; k++) {
		x[k] *= inverse[k];
		for (int i = k + 1; i < 6; i++)
			x[i] -= root[k][i] * x[k];
	}
}

// x <- L^-T x
static void upper_solve(double (*root)[6], const double *inverse, double *x)
{
	for (int k = 5; k >= 0; k--) {
		x[k] *= inverse[k];
		for (int i = 0; i < k; i++)
			x[i] -= root[k][i] * x[k];
	}
}

// block <- L^-1 block
static void lower_solve_block(double (*root)[6], const double *inverse, double (*block)[6])
{
	for (int k = 0; k < 6; k++) {
		ob_six_scale(block[k], inverse[k]);
		for (int i = k + 1; i < 6; i++)
			ob_six_add(block[i], -root[i][k], block[k]);
	}
}

// m <- m - a^T b, as above
static void subtract(double (*m)[6], double (*a)[6], double (*b)[6], bool lower)
{
	for (int k = 0; k < 6; k++)
		add_product(m, -1, a[k], b[k], lower);
}

static void eliminate_body(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k], from = t->first[k], to = t->first[k + 1];
	cholesky(t->own[body], t->inverse[body]);
	for (uint32_t i = from; i < to; i++)
		lower_solve_block(t->own[body], t->inverse[body], t->block[i]);
	for (uint32_t i = from; i < to; i++) {
		const uint32_t sooner = t->below[i], place = t->node[sooner].place;
		subtract(t->own[sooner], t->block[i], t->block[i], true);
		for (uint32_t j = t->first[place]; to - from > 1 && j < t->first[place + 1]; j++)
			t->node[t->below[j]].mark = j;
		for (uint32_t j = from; j < to; j++) {
			const uint32_t later = t->below[j];
			if (t->node[later].place > place)
				subtract(t->block[t->node[later].mark], t->block[i], t->block[j], false);
		}
	}
}

static void back_substitute(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k];
	for (uint32_t i = t->first[k]; i < t->first[k + 1]; i++)
		for (int c = 0; c < 6; c++)
			t->change[body][c] -= ob_six_dot(t->block[i][c], t->change[t->below[i]]);
	upper_solve(t->own[body], t->inverse[body], t->change[body]);
}

void ob_sparse_factor(ob_sparse_solver *t)
{
	for (uint32_t k = t->unlinked; k < t->bodies; k++)
		eliminate_body(t, k);
}

static void forward_substitute(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k];
	lower_solve(t->own[body], t->inverse[body], t->change[body]);
	for (uint32_t i = t->first[k]; i < t->first[k + 1]; i++)
		for (int c = 0; c < 6; c++)
			ob_six_add(t->change[t->below[i]], -t->change[body][c], t->block[i][c]);
}

void ob_sparse_substitute(ob_sparse_solver *t)
{
	for (uint32_t k = t->unlinked; k < t->bodies; k++)
		forward_substitute(t, k);
	for (uint32_t k = t->bodies; k-- > t->unlinked;)
		back_substitute(t, k);
}

void ob_sparse_joint_impulses(const ob_sparse_solver *t, ob_joint *j, uint32_t child, uint32_t parent)
{
	for (uint32_t r = 0; r < j->rows; r++) {
		double left = j->y[r] - ob_six_dot(j->child[r], t->change[child]);
		if (parent != OB_SPARSE_FIXED)
			left -= ob_six_dot(j->parent[r], t->change[parent]);
		j->x[r] = j->stiffness[r] * left;
	}
}

// ---- the inverse

// Block of the inverse of two bodies that share a factor's block, rows of the first; turned if it is stored for the other.
static ob_sparse_block *inverse_of(const ob_sparse_solver *t, uint32_t row, uint32_t column, bool *turned)
{
	*turned = t->node[row].place < t->node[column].place;
	return row == column ? &t->response[row]
			     : &t->between[*turned ? block_of(t, row, column) : block_of(t, column, row)];
}

// sum <- sum - z w, or z^T w
static void subtract_product(double (*sum)[6], double (*z)[6], bool turned, double (*w)[6])
{
	for (int r = 0; r < 6; r++)
		for (int k = 0; k < 6; k++)
			for (int c = 0; c < 6; c++)
				sum[r][c] -= (turned ? z[k][r] : z[r][k]) * w[k][c];
}

// With W = L_ib L_bb^-1 the inverse Z is Z_ib = - sum of Z_ij W_j, and Z_bb = (L_bb L_bb^T)^-1 - sum of Z_bi W_i.
static void invert_body(ob_sparse_solver *t, uint32_t k)
{
	const uint32_t body = t->order[k], from = t->first[k], to = t->first[k + 1];
	for (int c = 0; c < 6; c++) { // columns of the symmetric inverse of the body's own block
		double *column = t->response[body][c];
		memset(column, 0, sizeof t->response[body][c]);
		column[c] = 1;
		lower_solve(t->own[body], t->inverse[body], column);
		upper_solve(t->own[body], t->inverse[body], column);
	}
	for (uint32_t i = from; i < to; i++)
		for (int r = 0; r < 6; r++) { // rows of W: solved from the right
			for (int c = 0; c < 6; c++)
				t->shares[i][r][c] = t->block[i][c][r];
			upper_solve(t->own[body], t->inverse[body], t->shares[i][r]);
		}
	for (uint32_t i = from; i < to; i++) {
		memset(t->between[i], 0, sizeof t->between[i]);
		for (uint32_t j = from; j < to; j++) {
			bool turned;
			ob_sparse_block *z = inverse_of(t, t->below[i], t->below[j], &turned);
			subtract_product(t->between[i], *z, turned, t->shares[j]);
		}
	}
	for (uint32_t i = from; i < to; i++)
		subtract_product(t->response[body], t->between[i], true, t->shares[i]);
}

void ob_sparse_invert(ob_sparse_solver *t)
{
	const uint32_t blocks = t->first[t->bodies];
	if (t->bodies > t->response_max) {
		t->response_max = t->bodies_max;
		t->response = ob_reallocate(t->response, t->response_max * sizeof *t->response);
	}
	if (blocks > t->between_max) {
		t->between_max = 2 * blocks;
		t->between = ob_reallocate(t->between, t->between_max * sizeof *t->between);
		t->shares = ob_reallocate(t->shares, t->between_max * sizeof *t->shares);
	}
	for (uint32_t k = t->bodies; k-- > t->unlinked;)
		invert_body(t, k);
}

static double product(const double *x, double (*z)[6], bool turned, const double *y)
{
	double sum = 0;
	for (int r = 0; r < 6; r++)
		for (int c = 0; c < 6; c++)
			sum += x[r] * (turned ? z[c][r] : z[r][c]) * y[c];
	return sum;
}

double ob_sparse_response(const ob_sparse_solver *t, const double *of_child, const double *of_parent, uint32_t child,
			  uint32_t parent)
{
	double sum = product(of_child, t->response[child], false, of_child);
	if (parent == OB_SPARSE_FIXED)
		return sum;
	bool turned;
	ob_sparse_block *z = inverse_of(t, child, parent, &turned);
	return sum + product(of_parent, t->response[parent], false, of_parent) +
	       2 * product(of_child, *z, turned, of_parent);
}

void ob_sparse_finish(ob_sparse_solver *t)
{
	free(t->response);
	free(t->between);
	free(t->shares);
	free(t->node);
	free(t->least);
	free(t->edge);
	free(t->order);
	free(t->first);
	free(t->below);
	free(t->block);
	free(t->own);
	free(t->inverse);
	free(t->change);
	*t = (ob_sparse_solver){ 0 };
}
