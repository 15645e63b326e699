#include "solver/direct_solver.h"

#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "elementary/real.h"
#include "solver/budget.h"
#include "solver/joint_axis.h"
#include "solver/joint_rows.h"
#include "solver/relative_speed.h"

#include "contact/friction.h" // for one number

// Limits of a direct solve.
typedef struct limits {
	double compliance; // share of a row's own response
	uint32_t bodies; // of an island, at most
	uint32_t products; // of blocks in the factorisation, per body, at most
	uint32_t work; // per body, at most
	double least_share; // of a solution that is still tried
} limits;

static const limits of_trees = { 1e-6, UINT32_MAX, 64, 64, 1e-3 };
// Rows may depend on each other.
static const limits of_cycles = { 1e-8, 512, 64, 640, .3 };

// Thresholds above which a direct solve is worth its cost.
static const double residual_threshold = 1e-7; // m/s
static const double residual_after_correction = 1e-8; // m/s, if the last partial substep was solved directly
static const int max_solves = 4; // in a partial substep
static const double creep_speed = 1e-4; // m/s: slower bodies whose contacts hold should stand still
static const double neutral_speed = 1e-9; // m/s: a point that opens more slowly holds, even if it does not press
static const double standing_speed = .02; // m/s: faster bodies fall or slide
static const double rest_speed = 1e-3, min_rest_time = .25; // m/s, s: a body rests that has been slower for longer
static const double landing_speed = 1; // m/s: an island in which no contact is faster may be solved to the end
static const double unmoved_path = 2e-4; // m: or that has moved less since its start

static ob_batch *batch_of(const ob_island_work *w, const ob_direct_contact *c)
{
	return &w->batch[w->contact[c->contact].lane / OB_LANES];
}

static double length(double x, double y)
{
	return sqrt(x * x + y * y);
}

static int lane_of(const ob_island_work *w, const ob_direct_contact *c)
{
	return w->contact[c->contact].lane % OB_LANES;
}

// Finds the change n of four normal impulses that changes nothing else (null space of J^T): four points can share a
// load in many ways. On a plane its elements are the areas of the triangles between the other three points, with
// alternating signs. Returns false if the points lie on a line.
static bool normal_null_space(const ob_batch *b, int l, double *n)
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

// Lists the rows that hold: normals that press or are about to, friction and twist within their bounds. Returns their
// number.
static uint32_t holding_rows(const ob_batch *b, int l, const lanes *rate, double neutral, uint8_t *row)
{
	const double within = .999;
	uint32_t n = 0;
	double sum = 0;
	for (int j = 0; j < OB_POINTS; j++) {
		sum += b->impulse[j][l];
		if (b->inv_diag[j][l] > 0 && (rate[j][l] - neutral) * b->inv_diag[j][l] < b->impulse[j][l])
			row[n++] = (uint8_t)j;
	}
	double bound = within * b->mu[l] * sum;
	if (b->follows >> l & 1)
		return n;
	if (n && b->mu[l] > 0 && length(b->impulse[4][l], b->impulse[5][l]) <= bound)
		row[n++] = 4, row[n++] = 5;
	if (n && b->mu[l] > 0 && b->radius[l] > 0 && fabs(b->impulse[6][l]) <= bound * b->radius[l])
		row[n++] = 6;
	return n;
}

// Sets J and the velocities that the rows of a contact are to change by: the negative of "velocity".
static void fill_joint(const ob_island_work *w, ob_direct_contact *c, const lanes (*velocity)[OB_ROWS],
		       double compliance)
{
	const ob_batch *b = batch_of(w, c);
	const int l = lane_of(w, c);
	ob_joint *j = &c->joint;
	const bool child_is_a = w->contact[c->contact].a == c->child;
	double n[4], null_part = 0;
	for (uint32_t r = 0; r < j->rows; r++) {
		const int row = c->row[r];
		ob_batch_row_of_lane(b, l, row, child_is_a ? j->child[r] : j->parent[r],
				     child_is_a ? j->parent[r] : j->child[r]);
		j->y[r] = -velocity[b - w->batch][row][l];
		j->stiffness[r] = 1 / (compliance * b->diag[row][l]);
	}
	// Four points on a plane have no response along the null space: the velocity along it is removed.
	if (!has_four_normals(c) || !normal_null_space(b, l, n))
		return;
	for (int r = 0; r < 4; r++)
		null_part += n[r] * j->y[r];
	for (int r = 0; r < 4; r++)
		j->y[r] -= n[r] * null_part;
}

// Returns the next contact of the solve, with its bodies.
static ob_direct_contact *add_contact(ob_island_work *w, uint32_t contact)
{
	const uint32_t a = w->contact[contact].a, b = w->contact[contact].b;
	const bool a_fixed = w->body[a].inv_mass == 0;
	ob_direct_contact *c = &w->direct.contact[w->direct.contacts++];
	c->contact = contact;
	c->child = a_fixed ? b : a;
	c->parent = a_fixed ? a : b;
	return c;
}

// Adds the contacts with a row that holds.
static void add_contacts(ob_island_work *w, double compliance)
{
	ob_direct_solver *f = &w->direct;
	uint8_t row[OB_ROWS];
	f->contacts = 0;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const uint32_t lane = w->contact[i].lane;
		if (lane == OB_NO_LANE)
			continue;
		const uint32_t rows = holding_rows(&w->batch[lane / OB_LANES], lane % OB_LANES,
						   f->velocity[lane / OB_LANES], neutral_speed * w->unit.speed, row);
		if (!rows)
			continue;
		ob_direct_contact *c = add_contact(w, i);
		c->joint.rows = rows;
		c->anew = 0;
		memcpy(c->row, row, sizeof row);
		fill_joint(w, c, f->velocity, compliance);
	}
}

// ---- solving

static void find_row_velocities(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->batches; i++) {
		lanes *rate = w->direct.velocity[i];
		ob_batch_row_velocities(&w->batch[i], w->u, rate);
		for (int j = 0; j < OB_POINTS; j++)
			rate[j] += w->batch[i].bias[j];
		for (int j = OB_POINTS; w->batch[i].turning && j < OB_ROWS; j++)
			rate[j] += (lanes)(lanes_mask(w->batch[i].turning) & (lane_mask)w->batch[i].turn[j]);
	}
}

static uint32_t sparse_index(const ob_island_work *w, uint32_t row)
{
	return w->body[row].inv_mass > 0 ? row - 1 : OB_SPARSE_FIXED;
}

// Plans the elimination for the contacts. Returns false if it would cost too much.
static bool plan(ob_island_work *w, const limits *most)
{
	ob_direct_solver *f = &w->direct;
	ob_sparse_begin(&f->sparse, w->bodies);
	for (uint32_t k = 0; k < f->contacts; k++)
		ob_sparse_link(&f->sparse, f->contact[k].child - 1, sparse_index(w, f->contact[k].parent));
	for (uint32_t i = 0; i < w->joints.count; i++)
		ob_sparse_link(&f->sparse, w->joints.joint[i].child, w->joints.joint[i].parent);
	return ob_sparse_analyse(&f->sparse, most->products);
}

// Solves for the rows of the contacts. Joints hold: their rows do not move.
static void solve_rows(ob_island_work *w)
{
	ob_direct_solver *f = &w->direct;
	ob_sparse_clear(&f->sparse);
	ob_joints_set_inertias(w, &f->sparse);
	for (uint32_t k = 0; k < f->contacts; k++) {
		const ob_direct_contact *c = &f->contact[k];
		ob_sparse_add_joint(&f->sparse, &c->joint, c->child - 1, sparse_index(w, c->parent));
		ob_sparse_push(&f->sparse, &c->joint, c->child - 1, sparse_index(w, c->parent));
	}
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		ob_sparse_add_joint(&f->sparse, &j->rows, j->child, j->parent);
	}
	ob_sparse_factor(&f->sparse);
	ob_sparse_substitute(&f->sparse);
	for (uint32_t k = 0; k < f->contacts; k++) {
		ob_direct_contact *c = &f->contact[k];
		ob_sparse_joint_impulses(&f->sparse, &c->joint, c->child - 1, sparse_index(w, c->parent));
	}
}

// Distributes a load on four points so that none pulls, which is possible if the load lies between them. Moves x, the
// four impulses, along the null space to the middle of the admissible range.
static void distribute_load(const ob_batch *b, int l, double *x)
{
	double n[4], from = -INFINITY, to = INFINITY;
	if ((x[0] >= 0 && x[1] >= 0 && x[2] >= 0 && x[3] >= 0) || !normal_null_space(b, l, n))
		return;
	for (int j = 0; j < 4; j++) {
		if (n[j] > 0)
			from = ob_max(from, -x[j] / n[j]);
		if (n[j] < 0)
			to = ob_min(to, -x[j] / n[j]);
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
		sum += x[j] = ob_max(0, x[j]);
	const double bound = b->mu[l] * sum, share = disc_share(bound, x[4] * x[4] + x[5] * x[5]);
	x[4] *= share;
	x[5] *= share;
	x[6] = twist_within(-bound * b->radius[l], bound * b->radius[l], x[6]);
}

// Finds the impulses at which the solution aims: its own, and the present ones of all rows but those in "anew", bits.
static void set_aims(ob_island_work *w)
{
	ob_direct_solver *f = &w->direct;
	for (uint32_t k = 0; k < f->contacts; k++) {
		ob_direct_contact *c = &f->contact[k];
		const ob_batch *b = batch_of(w, c);
		const int l = lane_of(w, c);
		for (int i = 0; i < OB_ROWS; i++)
			c->aim[i] = c->anew >> i & 1 ? 0 : b->impulse[i][l];
		for (uint32_t r = 0; r < c->joint.rows; r++)
			c->aim[c->row[r]] += c->joint.x[r];
		if (has_four_normals(c))
			distribute_load(b, l, c->aim);
	}
}

// Projects the share alpha of the way to the aims on the cones: finds the changes of impulses, and of velocities in
// w->delta.
static void project_solution(ob_island_work *w, double alpha)
{
	ob_direct_solver *f = &w->direct;
	memset(f->impulse_change, 0, w->batches * sizeof *f->impulse_change);
	memset(w->delta, 0, w->rows * sizeof *w->delta);
	for (uint32_t k = 0; k < f->contacts; k++) {
		const ob_direct_contact *c = &f->contact[k];
		const ob_batch *b = batch_of(w, c);
		int l = lane_of(w, c);
		double x[OB_ROWS];
		for (int i = 0; i < OB_ROWS; i++)
			x[i] = b->impulse[i][l] + alpha * (c->aim[i] - b->impulse[i][l]);
		project_on_cone(b, l, x);
		for (int i = 0; i < OB_ROWS; i++)
			f->impulse_change[b - w->batch][i][l] = x[i] - b->impulse[i][l];
	}
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_apply_impulses(&w->batch[i], f->impulse_change[i], w->delta);
	ob_joints_follow(w, w->delta);
}

// Returns the share of the change, at most 1, that minimises the residual energy, slope t + curvature t^2 / 2.
static double line_search(const ob_island_work *w)
{
	const ob_direct_solver *f = &w->direct;
	double slope = 0, curvature = 0;
	for (uint32_t i = 0; i < w->batches; i++) {
		lanes r[OB_ROWS], s = lanes_of(0), c = lanes_of(0);
		ob_batch_row_velocities(&w->batch[i], w->delta, r);
		for (int k = 0; k < OB_ROWS; k++) {
			s += f->velocity[i][k] * f->impulse_change[i][k];
			c += r[k] * f->impulse_change[i][k];
		}
		for (int l = 0; l < OB_LANES; l++) {
			slope += s[l];
			curvature += c[l];
		}
	}
	return slope < 0 && curvature > 0 ? ob_min(1, -slope / curvature) : 0;
}

// Moves impulses and u towards the aims. Returns false, with nothing changed, if that does not reduce the residual.
static bool go_to_aims(ob_island_work *w, const limits *most)
{
	ob_direct_solver *f = &w->direct;
	const double backtrack = .3, min_step = .5; // the projection bends the direction: then a smaller share is tried
	double alpha = 1, t;
	for (project_solution(w, alpha); (t = line_search(w)) < min_step && alpha > most->least_share;
	     project_solution(w, alpha))
		alpha *= backtrack;
	f->gave_up = t < min_step;
	for (uint32_t i = 0; i < w->batches && !f->gave_up; i++)
		for (int k = 0; k < OB_ROWS; k++)
			w->batch[i].impulse[k] += t * f->impulse_change[i][k];
	for (uint32_t i = 1; i <= w->bodies && !f->gave_up; i++)
		for (int c = 0; c < 6; c++)
			w->u[i][c] += t * w->delta[i][c];
	if (!f->gave_up)
		ob_joints_add_share(w, t);
	memset(w->delta, 0, w->rows * sizeof *w->delta);
	return !f->gave_up;
}

// ---- from nothing

// Finds the velocities of all rows without the impulses that are found anew.
static void find_unloaded_velocities(ob_island_work *w)
{
	ob_direct_solver *f = &w->direct;
	memset(f->impulse_change, 0, w->batches * sizeof *f->impulse_change);
	memset(w->delta, 0, w->rows * sizeof *w->delta);
	for (uint32_t k = 0; k < f->contacts; k++) {
		const ob_direct_contact *c = &f->contact[k];
		const ob_batch *b = batch_of(w, c);
		const int l = lane_of(w, c);
		for (int i = 0; i < OB_ROWS; i++)
			f->impulse_change[b - w->batch][i][l] = c->anew >> i & 1 ? -b->impulse[i][l] : 0;
	}
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_apply_impulses(&w->batch[i], f->impulse_change[i], w->delta);
	ob_joints_follow(w, w->delta);
	for (uint32_t i = 0; i < w->batches; i++) {
		ob_batch_row_velocities(&w->batch[i], w->delta, f->unloaded[i]);
		for (int k = 0; k < OB_ROWS; k++)
			f->unloaded[i][k] += f->velocity[i][k];
	}
}

// Lists the rows of a contact: the normals in "push", bits, and the friction that is found anew.
static void list_rows(ob_direct_contact *c)
{
	uint32_t n = 0;
	for (int i = 0; i < OB_ROWS; i++)
		if (i < OB_POINTS ? c->push >> i & 1 : n && c->anew >> i & 1)
			c->row[n++] = (uint8_t)i;
	c->joint.rows = n;
}

// Returns the velocity of a row after the solve.
static double velocity_after(const ob_island_work *w, const ob_direct_contact *c, int row)
{
	const ob_direct_solver *f = &w->direct;
	const ob_batch *b = batch_of(w, c);
	const int l = lane_of(w, c);
	const bool child_is_a = w->contact[c->contact].a == c->child;
	const uint32_t parent = sparse_index(w, c->parent);
	double child_row[6], parent_row[6], v = f->unloaded[b - w->batch][row][l];
	ob_batch_row_of_lane(b, l, row, child_is_a ? child_row : parent_row, child_is_a ? parent_row : child_row);
	for (int i = 0; i < 6; i++)
		v += child_row[i] * f->sparse.change[c->child - 1][i];
	for (int i = 0; i < 6 && parent != OB_SPARSE_FIXED; i++)
		v += parent_row[i] * f->sparse.change[parent][i];
	return v;
}

// Drops normals that pull, and takes those that close. Returns true if there were any.
static bool change_normals(ob_island_work *w)
{
	ob_direct_solver *f = &w->direct;
	bool any = false;
	for (uint32_t k = 0; k < f->contacts; k++) {
		ob_direct_contact *c = &f->contact[k];
		const ob_batch *b = batch_of(w, c);
		const int l = lane_of(w, c);
		unsigned push = 0;
		for (int j = 0; j < OB_POINTS; j++) {
			const bool pushed = c->push >> j & 1;
			if (b->inv_diag[j][l] > 0 &&
			    (pushed ? c->aim[j] > 0 : velocity_after(w, c, j) < -neutral_speed * w->unit.speed))
				push |= 1u << j;
		}
		any |= push != c->push;
		c->push = push;
	}
	return any;
}

// Adds all contacts, to be solved anew: their normals, and friction that holds. Friction that slides keeps its impulse.
static void add_all(ob_island_work *w)
{
	ob_direct_solver *f = &w->direct;
	f->contacts = 0;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const uint32_t lane = w->contact[i].lane;
		if (lane == OB_NO_LANE)
			continue;
		const ob_batch *b = &w->batch[lane / OB_LANES];
		const uint32_t l = lane % OB_LANES;
		ob_direct_contact *c = add_contact(w, i);
		uint8_t row[OB_ROWS];
		const uint32_t rows =
			holding_rows(b, l, f->velocity[lane / OB_LANES], neutral_speed * w->unit.speed, row);
		c->push = 0;
		for (int j = 0; j < OB_POINTS; j++)
			c->push |= (unsigned)(b->inv_diag[j][l] > 0) << j;
		c->anew = c->push;
		for (uint32_t r = 0; r < rows; r++)
			c->anew |= 1u << row[r];
	}
}

// Finds aims that owe nothing to the present impulses: the shortest ones, of all points that press. Loads that a structure
// shares in many ways are left as uneven as iterations have made them by a step from there; points then pull.
static bool find_from_nothing(ob_solver *s, const limits *most)
{
	enum { ROUNDS = 12 };
	ob_island_work *w = &s->island;
	ob_direct_solver *f = &w->direct;
	add_all(w);
	find_unloaded_velocities(w);
	if (!plan(w, most))
		return false;
	for (int round = 0; round < ROUNDS; round++) {
		ob_budget_note(s, (uint64_t)most->work * w->bodies);
		for (uint32_t k = 0; k < f->contacts; k++) {
			list_rows(&f->contact[k]);
			fill_joint(w, &f->contact[k], f->unloaded, most->compliance);
		}
		solve_rows(w);
		set_aims(w);
		if (!change_normals(w))
			break;
	}
	return true;
}

bool ob_direct_solve(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_direct_solver *f = &w->direct;
	const limits *most = f->shape >= OB_DIRECT_CYCLIC ? &of_cycles : &of_trees;
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_prepare(&w->batch[i]);
	find_row_velocities(w);
	s->counters.direct_solves++;
	ob_budget_note(s, (uint64_t)most->work * w->bodies);
	if (w->bodies > most->bodies)
		return false;
	add_contacts(w, most->compliance);
	if (!plan(w, most))
		return false;
	solve_rows(w);
	set_aims(w);
	if (go_to_aims(w, most))
		return true;
	return f->shape >= OB_DIRECT_CYCLIC && find_from_nothing(s, most) && go_to_aims(w, most);
}

// ---- decision for a direct solve

void ob_direct_begin(ob_direct_solver *f)
{
	f->used_last = f->gave_up = false;
}

void ob_direct_begin_partial(ob_direct_solver *f)
{
	f->shape = OB_DIRECT_UNKNOWN;
	f->solves = 0;
}

void ob_direct_finish(ob_direct_solver *f)
{
	free(f->contact);
	free(f->velocity);
	free(f->impulse_change);
	free(f->unloaded);
	ob_sparse_finish(&f->sparse);
}

static void reserve(ob_direct_solver *f, const ob_island_work *w)
{
	if (w->contacts > f->contacts_max) {
		f->contacts_max = w->contacts + w->contacts / 2;
		free(f->contact);
		f->contact = ob_allocate(f->contacts_max * sizeof *f->contact);
	}
	if (w->batches > f->batches_max) {
		f->batches_max = w->batches + w->batches / 2;
		free(f->velocity);
		free(f->impulse_change);
		free(f->unloaded);
		f->unloaded = ob_allocate_aligned(32, f->batches_max * sizeof *f->unloaded);
		f->velocity = ob_allocate_aligned(32, f->batches_max * sizeof *f->velocity);
		f->impulse_change = ob_allocate_aligned(32, f->batches_max * sizeof *f->impulse_change);
	}
}

// Returns the largest relative speed (m/s) of touching bodies, at the velocities in rows. sum: sum over all contacts
// (m/s). Sliding along a plane without friction does not count.
static double fastest_contact(const ob_island_work *w, const ob_body_row *rows, double *sum)
{
	double most = 0;
	*sum = 0;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
		const double *va = rows[contact->a], *vb = rows[contact->b];
		ob_vec3 v = ob_v3(va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]);
		if (contact->lane == OB_NO_LANE)
			continue;
		double speed = contact->mu > 0 ? ob_norm(v) : ob_relative_speed(a->shape, &a->r, b->shape, &b->r, v);
		most = ob_max(most, speed);
		*sum += speed;
	}
	return most;
}

// True if contacts and joints close cycles: trees would load one contact with what several carry.
static bool closes_cycles(const ob_island_work *w)
{
	uint32_t touching = 0;
	for (uint32_t i = 0; i < w->contacts; i++)
		touching += w->contact[i].lane != OB_NO_LANE;
	for (uint32_t i = 0; i < w->joints.count; i++)
		touching += w->joints.joint[i].base > 0;
	return touching > w->bodies;
}

// True if a body has been slow for some time, or has not moved yet. A body that was hit is slow for a moment each time
// it turns back; its contacts are not in equilibrium then.
static bool rests(const ob_island_work *w, const ob_body *body)
{
	return body->speed <= rest_speed * w->unit.speed &&
	       (body->rest_time >= min_rest_time * w->unit.time || body->path <= unmoved_path * w->unit.length);
}

static bool has_come_to_rest(const ob_island_work *w)
{
	for (uint32_t i = 1; i <= w->bodies; i++)
		if (!rests(w, &w->body[i]))
			return false;
	return true;
}

// True if bodies creep that should stand still. The residual does not show it: in an island that sways as a whole it
// changes little from pair to pair. The sum over all pairs does: no body moves faster against the ground.
static bool creeps(const ob_island_work *w)
{
	double sum, fastest = fastest_contact(w, w->u, &sum);
	return sum > residual_threshold * w->unit.speed && fastest < creep_speed * w->unit.speed;
}

static bool is_worthwhile(const ob_solver *s, double residual)
{
	const ob_direct_solver *f = &s->island.direct;
	if (f->gave_up || f->shape == OB_DIRECT_UNFIT || s->settings->solver != OB_SOLVER_COLOURED)
		return false;
	// After a direct solve, the next partial substep is solved finely, too. The correction is part of the impulses
	// that the warm start repeats; left alone, it would oscillate for ever.
	const double enough =
		f->used_last && f->shape < OB_DIRECT_CYCLIC ? residual_after_correction : residual_threshold;
	return residual > enough * s->island.unit.speed || (!f->solves && creeps(&s->island));
}

// True if bodies are stacked so high that no iterations of a partial substep carry an impulse down from the top and back.
static bool is_high(ob_solver *s)
{
	ob_island_work *w = &s->island;
	bool higher = true;
	for (uint32_t row = 0; row < w->rows; row++)
		w->body[row].height = row - 1 < w->bodies ? UINT32_MAX : 0;
	for (uint32_t height = 0; higher; height++) {
		if (2 * height > s->settings->iterations)
			return true;
		higher = false;
		for (uint32_t i = 0; i < w->contacts; i++) {
			ob_body *a = &w->body[w->contact[i].a], *b = &w->body[w->contact[i].b];
			ob_body *upper = a->height == height ? b : b->height == height ? a : NULL;
			if (w->contact[i].lane == OB_NO_LANE || !upper || upper->height <= height)
				continue;
			upper->height = height + 1;
			higher = true;
		}
	}
	return false;
}

bool ob_direct_stands(const ob_island_work *w)
{
	double sum;
	for (uint32_t i = 0; i < w->joints.count; i++)
		if (w->joints.joint[i].axis && ob_axis_slides(&w->joints.joint[i]))
			return false;
	return fastest_contact(w, w->v, &sum) <= standing_speed * w->unit.speed;
}

static void find_shape(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_direct_solver *f = &w->direct;
	if (f->shape == OB_DIRECT_UNKNOWN) {
		double sum;
		const bool slow = ob_direct_stands(w), cyclic = closes_cycles(w);
		f->shape = slow && !cyclic               ? OB_DIRECT_TREES
			   : slow && has_come_to_rest(w) ? OB_DIRECT_CYCLIC
			   : cyclic && fastest_contact(w, w->v, &sum) < landing_speed * w->unit.speed && is_high(s)
				   ? OB_DIRECT_HIGH
				   : OB_DIRECT_UNFIT;
	}
	if (f->shape != OB_DIRECT_UNFIT)
		reserve(f, w);
}

bool ob_direct_wanted(ob_solver *s, double residual)
{
	ob_direct_solver *f = &s->island.direct;
	if (!is_worthwhile(s, residual))
		return false;
	find_shape(s);
	if (f->shape != OB_DIRECT_TREES || f->solves == max_solves)
		return false;
	f->solves++;
	return true;
}

bool ob_direct_settles(ob_solver *s, double residual)
{
	if (!is_worthwhile(s, residual))
		return false;
	find_shape(s);
	return s->island.direct.shape >= OB_DIRECT_CYCLIC;
}
