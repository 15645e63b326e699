#include "sim/forest.h"

#include <string.h>

#include "sim/state.h"

enum { FREE = UINT32_MAX, UNSEEN = FREE - 1 }; // in up[]: a root; not reached yet

static const double compliance = 1e-6; // of a row's own response
static const double compliance_in_cycles = 1e-5; // .. where several rows may say the same in different words
static const uint32_t most_products = 64; // of blocks, for each body

static ob_batch *batch_of(const ob_island_work *w, const ob_direct_contact *c)
{
	return &w->batch[w->touch[c->touch].lane / OB_LANES];
}

static int lane_of(const ob_island_work *w, const ob_direct_contact *c)
{
	return w->touch[c->touch].lane % OB_LANES;
}

// Four normals carry a load in many ways: n is the change of their impulses that changes nothing else. On a plane its
// elements are the areas of the triangles between the other three points, in turn added and taken away.
static bool idle_split(const ob_batch *b, int l, double *n)
{
	double at[4][2], length2 = 0;
	for (int j = 0; j < 4; j++) {
		const lanes *arm = b->ja[j];
		at[j][0] = arm[0][l] * b->t1[0][l] + arm[1][l] * b->t1[1][l] + arm[2][l] * b->t1[2][l];
		at[j][1] = arm[0][l] * b->t2[0][l] + arm[1][l] * b->t2[1][l] + arm[2][l] * b->t2[2][l];
	}
	for (int j = 0; j < 4; j++) {
		const double *p = at[(j + 1) % 4], *q = at[(j + 2) % 4], *r = at[(j + 3) % 4];
		double area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
		n[j] = j % 2 ? -area : area;
		length2 += n[j] * n[j];
	}
	for (int j = 0; j < 4; j++)
		n[j] /= sqrt(length2);
	return length2 > 0;
}

static bool has_four_normals(const ob_direct_contact *c)
{
	return c->joint.rows >= 4 && c->row[3] == 3;
}

// ---- assembling

// Rows that hold: normals that press or are about to, friction and twist within their bounds. Returns how many.
static uint32_t holding_rows(const ob_batch *b, int l, const lanes *rate, uint8_t *row)
{
	const double within = .999;
	uint32_t n = 0;
	double sum = 0;
	for (int j = 0; j < OB_POINTS; j++) {
		sum += b->impulse[j][l];
		if (b->inv_diag[j][l] > 0 && rate[j][l] * b->inv_diag[j][l] < b->impulse[j][l])
			row[n++] = (uint8_t)j;
	}
	double bound = within * b->mu[l] * sum;
	if (hypot(b->impulse[4][l], b->impulse[5][l]) < bound)
		row[n++] = 4, row[n++] = 5;
	if (fabs(b->impulse[6][l]) < bound * b->radius[l])
		row[n++] = 6;
	return n;
}

// One row for both bodies; a's and b's sides of a batch differ in sign.
static void fill_row(const ob_batch *b, int l, int row, bool child_is_a, uint32_t r, ob_joint *j)
{
	static const lanes none[3];
	const lanes *along = row < 4 ? b->n : row == 4 ? b->t1 : row == 5 ? b->t2 : none;
	const lanes *about_a = row < 4 ? b->ja[row] : row == 4 ? b->fa1 : row == 5 ? b->fa2 : b->n;
	const lanes *about_b = row < 4 ? b->jb[row] : row == 4 ? b->fb1 : row == 5 ? b->fb2 : b->n;
	for (int c = 0; c < 3; c++) {
		double n = child_is_a ? along[c][l] : -along[c][l];
		j->child[c][r] = n;
		j->parent[r][c] = -n;
		j->child[3 + c][r] = child_is_a ? about_a[c][l] : -about_b[c][l];
		j->parent[r][3 + c] = child_is_a ? -about_b[c][l] : about_a[c][l];
	}
}

static void fill_joint(const ob_island_work *w, ob_direct_contact *c)
{
	const ob_batch *b = batch_of(w, c);
	int l = lane_of(w, c);
	ob_joint *j = &c->joint;
	double n[4], idle = 0, softness = w->forest.fit == OB_DIRECT_CYCLIC ? compliance_in_cycles : compliance;
	memset(j->child, 0, sizeof j->child);
	memset(j->parent, 0, sizeof j->parent);
	for (uint32_t r = 0; r < j->rows; r++) {
		int row = c->row[r];
		fill_row(b, l, row, w->touch[c->touch].a == c->child, r, j);
		j->parent[r][6] = -w->forest.rate[b - w->batch][row][l];
		j->compliance[r] = softness * b->diag[row][l];
	}
	// What four points on a plane cannot do together is not asked of them.
	if (!has_four_normals(c) || !idle_split(b, l, n))
		return;
	for (int r = 0; r < 4; r++)
		idle += n[r] * j->parent[r][6];
	for (int r = 0; r < 4; r++)
		j->parent[r][6] -= n[r] * idle;
}

static void fill_link(const ob_body *m, ob_link *k)
{
	memset(k->m, 0, sizeof k->m);
	for (int i = 0; i < 3; i++) {
		const double *r = m->r.m[i];
		k->m[i][i] = m->mass;
		for (int j = 0; j < 3; j++) {
			const double *q = m->r.m[j];
			k->m[3 + i][3 + j] =
				r[0] * q[0] * m->inertia.x + r[1] * q[1] * m->inertia.y + r[2] * q[2] * m->inertia.z;
		}
	}
}

// The contact of touch i takes part, if any of its rows holds.
static ob_direct_contact *join(ob_island_work *w, uint32_t i, uint32_t child)
{
	ob_direct_solver *f = &w->forest;
	const ob_contact *t = &w->touch[i];
	ob_direct_contact *c = &f->contact[f->contacts];
	if (t->lane == OB_NO_LANE)
		return NULL;
	uint32_t batch = t->lane / OB_LANES;
	c->joint.rows = holding_rows(&w->batch[batch], t->lane % OB_LANES, f->rate[batch], c->row);
	if (!c->joint.rows)
		return NULL;
	c->touch = i;
	c->child = child;
	c->parent = t->a == child ? t->b : t->a;
	fill_joint(w, c);
	f->contacts++;
	return c;
}

static uint32_t take_roots(ob_island_work *w)
{
	ob_direct_solver *f = &w->forest;
	uint32_t n = 0;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		bool a_fixed = w->member[t->a].inv_mass == 0, b_fixed = w->member[t->b].inv_mass == 0;
		uint32_t at = a_fixed ? t->b : t->a;
		if ((!a_fixed && !b_fixed) || f->up[at] != UNSEEN)
			continue;
		const ob_direct_contact *c = join(w, i, at);
		if (!c)
			continue;
		ob_link_anchor(&f->link[at], &c->joint);
		f->up[at] = FREE;
		f->order[n++] = at;
	}
	return n;
}

static uint32_t take_neighbours(ob_island_work *w, uint32_t at, uint32_t n)
{
	ob_direct_solver *f = &w->forest;
	const ob_body *m = &w->member[at];
	for (uint32_t k = 0; k < m->adjacent; k++) {
		uint32_t i = w->adjacency[m->first_adjacent + k];
		uint32_t other = w->touch[i].a == at ? w->touch[i].b : w->touch[i].a;
		if (w->member[other].inv_mass == 0 || f->up[other] != UNSEEN || !join(w, i, other))
			continue;
		f->up[other] = f->contacts - 1;
		f->order[n++] = other;
	}
	return n;
}

// Every member stands in the order once, those that nothing holds as trees of their own.
static void grow(ob_island_work *w)
{
	ob_direct_solver *f = &w->forest;
	f->contacts = 0;
	for (uint32_t i = 1; i <= w->members; i++) {
		f->up[i] = UNSEEN;
		fill_link(&w->member[i], &f->link[i]);
	}
	uint32_t n = take_roots(w), root = 1;
	for (uint32_t done = 0; done < w->members; done++) {
		for (; done == n; root++)
			if (f->up[root] == UNSEEN) {
				f->up[root] = FREE;
				f->order[n++] = root;
			}
		n = take_neighbours(w, f->order[done], n);
	}
}

// All contacts of which some row holds.
static void gather(ob_island_work *w)
{
	w->forest.contacts = 0;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		join(w, i, w->member[t->a].inv_mass == 0 ? t->b : t->a);
	}
}

// ---- solving

static void find_rates(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->batches; i++) {
		lanes *rate = w->forest.rate[i];
		ob_batch_row_velocities(&w->batch[i], w->u, rate);
		for (int j = 0; j < OB_POINTS; j++)
			rate[j] += w->batch[i].bias[j];
	}
}

static void solve_trees(ob_island_work *w)
{
	ob_direct_solver *f = &w->forest;
	for (uint32_t k = w->members; k-- > 0;) {
		uint32_t i = f->order[k];
		ob_direct_contact *c = f->up[i] == FREE ? NULL : &f->contact[f->up[i]];
		ob_link_eliminate(&f->link[i], c ? &c->joint : NULL, c ? &f->link[c->parent] : NULL);
	}
	for (uint32_t k = 0; k < w->members; k++) {
		uint32_t i = f->order[k];
		ob_direct_contact *c = f->up[i] == FREE ? NULL : &f->contact[f->up[i]];
		ob_link_substitute(&f->link[i], c ? &c->joint : NULL, c ? &f->link[c->parent] : NULL);
	}
	for (uint32_t k = 0; k < f->contacts; k++)
		if (w->member[f->contact[k].parent].inv_mass == 0)
			ob_link_anchor_impulses(&f->link[f->contact[k].child], &f->contact[k].joint);
}

static uint32_t number_of(const ob_island_work *w, uint32_t row)
{
	return w->member[row].inv_mass > 0 ? row - 1 : OB_SPARSE_FIXED;
}

// false: it would cost too much.
static bool solve_truss(ob_island_work *w)
{
	ob_direct_solver *f = &w->forest;
	ob_sparse_begin(&f->truss, w->members);
	for (uint32_t k = 0; k < f->contacts; k++)
		ob_sparse_link(&f->truss, f->contact[k].child - 1, number_of(w, f->contact[k].parent));
	if (!ob_sparse_analyse(&f->truss, most_products))
		return false;
	for (uint32_t i = 1; i <= w->members; i++) {
		fill_link(&w->member[i], &f->link[i]);
		ob_sparse_add_inertia(&f->truss, i - 1, f->link[i].m);
	}
	for (uint32_t k = 0; k < f->contacts; k++) {
		const ob_direct_contact *c = &f->contact[k];
		ob_sparse_add_joint(&f->truss, &c->joint, c->child - 1, number_of(w, c->parent));
	}
	ob_sparse_solve(&f->truss);
	for (uint32_t k = 0; k < f->contacts; k++) {
		ob_direct_contact *c = &f->contact[k];
		ob_sparse_joint_impulses(&f->truss, &c->joint, c->child - 1, number_of(w, c->parent));
	}
	return true;
}

// A load on four points may be split so that none pulls, as long as it stands between them: x, the four impulses, goes
// along n to the middle of what is allowed.
static void share_out(const ob_batch *b, int l, double *x)
{
	double n[4], from = -INFINITY, to = INFINITY;
	if ((x[0] >= 0 && x[1] >= 0 && x[2] >= 0 && x[3] >= 0) || !idle_split(b, l, n))
		return;
	for (int j = 0; j < 4; j++) {
		if (n[j] > 0)
			from = fmax(from, -x[j] / n[j]);
		if (n[j] < 0)
			to = fmin(to, -x[j] / n[j]);
	}
	if (isinf(from) || isinf(to))
		return;
	for (int j = 0; j < 4; j++)
		x[j] += n[j] * .5 * (from + to);
}

static void project_on_cone(const ob_batch *b, int l, double *x)
{
	double sum = 0;
	for (int j = 0; j < OB_POINTS; j++)
		sum += x[j] = fmax(0, x[j]);
	double bound = b->mu[l] * sum, friction = hypot(x[4], x[5]);
	if (friction > bound) {
		x[4] *= bound / friction;
		x[5] *= bound / friction;
	}
	x[6] = fmax(-bound * b->radius[l], fmin(bound * b->radius[l], x[6]));
}

// The share alpha of the solution, projected: changes of the impulses, and of the velocities in w->delta.
static void aim(ob_island_work *w, double alpha)
{
	ob_direct_solver *f = &w->forest;
	memset(f->change, 0, w->batches * sizeof *f->change);
	memset(w->delta, 0, w->rows * sizeof *w->delta);
	for (uint32_t k = 0; k < f->contacts; k++) {
		const ob_direct_contact *c = &f->contact[k];
		const ob_batch *b = batch_of(w, c);
		int l = lane_of(w, c);
		double x[OB_ROWS];
		for (int i = 0; i < OB_ROWS; i++)
			x[i] = b->impulse[i][l];
		for (uint32_t r = 0; r < c->joint.rows; r++)
			x[c->row[r]] += c->joint.x[r];
		if (has_four_normals(c))
			share_out(b, l, x);
		for (int i = 0; i < OB_ROWS; i++)
			x[i] = b->impulse[i][l] + alpha * (x[i] - b->impulse[i][l]);
		project_on_cone(b, l, x);
		for (int i = 0; i < OB_ROWS; i++)
			f->change[b - w->batch][i][l] = x[i] - b->impulse[i][l];
	}
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_apply_impulses(&w->batch[i], f->change[i], w->delta);
}

// How far along the change the residual energy falls, 1 at most: it is slope t + curvature t^2 / 2.
static double way_down(const ob_island_work *w)
{
	const ob_direct_solver *f = &w->forest;
	double slope = 0, curvature = 0;
	for (uint32_t i = 0; i < w->batches; i++) {
		lanes r[OB_ROWS], s = lanes_of(0), c = lanes_of(0);
		ob_batch_row_velocities(&w->batch[i], w->delta, r);
		for (int k = 0; k < OB_ROWS; k++) {
			s += f->rate[i][k] * f->change[i][k];
			c += r[k] * f->change[i][k];
		}
		for (int l = 0; l < OB_LANES; l++) {
			slope += s[l];
			curvature += c[l];
		}
	}
	return slope < 0 && curvature > 0 ? fmin(1, -slope / curvature) : 0;
}

static bool find_solution(ob_island_work *w)
{
	if (w->forest.fit == OB_DIRECT_CYCLIC) {
		gather(w);
		return solve_truss(w);
	}
	grow(w);
	solve_trees(w);
	return true;
}

void ob_direct_solve(ob_sim *s)
{
	ob_island_work *w = &s->island;
	ob_direct_solver *f = &w->forest;
	const double shorter = .3, straight = .5; // straight enough: projection bends the way
	const double shortest = f->fit == OB_DIRECT_CYCLIC ? shorter : 1e-3;
	double alpha = 1, t;
	find_rates(w);
	if (!find_solution(w)) {
		f->hopeless = true;
		return;
	}
	for (aim(w, alpha); (t = way_down(w)) < straight && alpha > shortest; aim(w, alpha))
		alpha *= shorter;
	f->hopeless = t < straight;
	if (f->hopeless)
		t = 0;
	for (uint32_t i = 0; i < w->batches; i++)
		for (int k = 0; k < OB_ROWS; k++)
			w->batch[i].impulse[k] += t * f->change[i][k];
	for (uint32_t i = 1; i <= w->members; i++)
		for (int c = 0; c < 6; c++)
			w->u[i][c] += t * w->delta[i][c];
	memset(w->delta, 0, w->rows * sizeof *w->delta);
}
