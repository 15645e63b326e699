#include "solver/few_contacts.h"

#include <math.h>
#include <string.h>

#include "elementary/real.h"

#include "contact/friction.h" // for one number

enum { MOST_ROWS = OB_FEW_CONTACTS * OB_ROWS, NO_BODY = UINT32_MAX };

// Share of a row's own response. Rows of a face depend on each other; rounding errors grow by its inverse.
static const double compliance = 1e-7;

// Unknown of the linear system: the effect of its unit on both bodies, and on their velocities.
typedef struct unknown {
	uint32_t contact; // index in few.lane
	int row; // of the batch; OB_POINTS: friction, along or across the first tangent
	uint32_t a, b; // rows of bodies; NO_BODY for one that does not move
	bool brings; // its load brings friction
	double of_a[6], of_b[6]; // J^T
	double to_a[6], to_b[6]; // M^-1 J^T, with the friction that a load brings
	double left, extra; // m/s or rad/s: its velocity; addition to its response
	double tangents[2]; // shares of friction's two tangents
} unknown;

typedef struct few {
	uint32_t contacts, lane[OB_FEW_CONTACTS];
	double brought[OB_FEW_CONTACTS][OB_POINTS][OB_ROWS]; // friction and twist for a unit of each point's load
	uint32_t unknowns;
	unknown unknown[MOST_ROWS];
	double m[MOST_ROWS][MOST_ROWS + 1];
} few;

static void add_row(const ob_batch *b, uint32_t l, int row, double share, double *of_a, double *of_b)
{
	double a[6], c[6];
	ob_batch_row_of_lane(b, (int)l, row, a, c);
	for (int i = 0; i < 6; i++)
		of_a[i] += share * a[i], of_b[i] += share * c[i];
}

// Finds the change of velocity by an impulse. Returns false if the body does not move.
static bool accelerate(double inv_mass, const lanes *inertia, uint32_t l, const double *impulse, double *to)
{
	if (!(inv_mass > 0))
		return false;
	const double x = impulse[3], y = impulse[4], z = impulse[5];
	for (int c = 0; c < 3; c++)
		to[c] = inv_mass * impulse[c];
	to[3] = inertia[0][l] * x + inertia[1][l] * y + inertia[2][l] * z;
	to[4] = inertia[1][l] * x + inertia[3][l] * y + inertia[4][l] * z;
	to[5] = inertia[2][l] * x + inertia[4][l] * y + inertia[5][l] * z;
	return true;
}

static double dot6(const double *x, const double *y)
{
	double sum = 0;
	for (int c = 0; c < 6; c++)
		sum += x[c] * y[c];
	return sum;
}

// Adds an unknown: a row, or friction in a direction (tangents: shares of the two).
static unknown *add_unknown(const ob_island_work *w, few *f, uint32_t contact, int row, const double *tangents)
{
	const uint32_t l = f->lane[contact] % OB_LANES;
	const ob_batch *b = &w->batch[f->lane[contact] / OB_LANES];
	unknown *x = &f->unknown[f->unknowns++];
	double push_a[6], push_b[6];
	memset(x, 0, sizeof *x);
	x->contact = contact, x->row = row;
	if (row == OB_POINTS) {
		memcpy(x->tangents, tangents, sizeof x->tangents);
		add_row(b, l, 4, tangents[0], x->of_a, x->of_b);
		add_row(b, l, 5, tangents[1], x->of_a, x->of_b);
	} else {
		add_row(b, l, row, 1, x->of_a, x->of_b);
	}
	x->left = dot6(x->of_a, w->u[b->body_a[l]]) + dot6(x->of_b, w->u[b->body_b[l]]);
	if (row < OB_POINTS)
		x->left += b->bias[row][l];
	else if (b->turning >> l & 1)
		x->left += row == 6 ? b->turn[6][l] : tangents[0] * b->turn[4][l] + tangents[1] * b->turn[5][l];
	memcpy(push_a, x->of_a, sizeof push_a);
	memcpy(push_b, x->of_b, sizeof push_b);
	for (int i = OB_POINTS; row < OB_POINTS && i < OB_ROWS; i++)
		if (f->brought[contact][row][i] != 0)
			add_row(b, l, i, f->brought[contact][row][i], push_a, push_b), x->brings = true;
	x->a = accelerate(b->ima[l], b->ia, l, push_a, x->to_a) ? b->body_a[l] : NO_BODY;
	x->b = accelerate(b->imb[l], b->ib, l, push_b, x->to_b) ? b->body_b[l] : NO_BODY;
	return x;
}

// Finds the slip along the two tangents (m/s).
static void slip_of(const ob_island_work *w, const ob_batch *b, uint32_t l, double *slip)
{
	for (int k = 0; k < 2; k++) {
		double of_a[6] = { 0 }, of_b[6] = { 0 };
		add_row(b, l, 4 + k, 1, of_a, of_b);
		slip[k] = dot6(of_a, w->u[b->body_a[l]]) + dot6(of_b, w->u[b->body_b[l]]);
		slip[k] += b->turning >> l & 1 ? b->turn[4 + k][l] : 0;
	}
}

static void add_contact(const ob_island_work *w, few *f, uint32_t lane)
{
	const uint32_t l = lane % OB_LANES, contact = f->contacts++;
	const ob_batch *b = &w->batch[lane / OB_LANES];
	const double friction[2] = { b->impulse[4][l], b->impulse[5][l] }, x6 = b->impulse[6][l];
	const double sum = ob_batch_load(b, l);
	double slip[2], brought[OB_ROWS] = { 0 };
	disc_tangent tangent;
	f->lane[contact] = lane;
	if (!is_load(sum))
		return;
	const double bound = b->mu[l] * sum, twist = bound * b->radius[l];
	const bool follows = b->follows >> l & 1,
		   slides = follows || disc_slides(bound, friction[0] * friction[0] + friction[1] * friction[1]),
		   spins = follows || disc_slides(twist, x6 * x6);
	if (follows) {
		brought[OB_ROW_FRICTION] = b->follow[0][l], brought[OB_ROW_FRICTION + 1] = b->follow[1][l];
	} else if (slides && is_load(bound)) {
		slip_of(w, b, l, slip);
		tangent = disc_follow(friction, sum, slip);
		memcpy(brought + OB_ROW_FRICTION, tangent.brought, sizeof tangent.brought);
	}
	for (int i = 0; i < OB_POINTS; i++) {
		brought[OB_ROW_TWIST] = follows ? b->follow_twist[i][l] : spins ? x6 / sum : 0;
		memcpy(f->brought[contact][i], brought, sizeof brought);
	}
	for (int i = 0; i < OB_POINTS; i++)
		if (b->impulse[i][l] > 0 && ob_batch_has_point(b, (int)l, i))
			add_unknown(w, f, contact, i, NULL);
	if (!slides) {
		add_unknown(w, f, contact, OB_POINTS, (double[2]){ 1, 0 });
		add_unknown(w, f, contact, OB_POINTS, (double[2]){ 0, 1 });
	} else if (!follows && is_load(bound)) {
		add_unknown(w, f, contact, OB_POINTS, tangent.across)->extra = tangent.t;
	}
	if (!spins)
		add_unknown(w, f, contact, 6, NULL);
}

static double response(const unknown *i, const unknown *j)
{
	double sum = 0;
	if (i->a != NO_BODY)
		sum += i->a == j->a ? dot6(i->of_a, j->to_a) : i->a == j->b ? dot6(i->of_a, j->to_b) : 0;
	if (i->b != NO_BODY)
		sum += i->b == j->b ? dot6(i->of_b, j->to_b) : i->b == j->a ? dot6(i->of_b, j->to_a) : 0;
	return sum;
}

// Fills the matrix. It is symmetric except for loads that bring friction.
static void fill_matrix(few *f)
{
	for (uint32_t i = 0; i < f->unknowns; i++) {
		const unknown *x = &f->unknown[i];
		for (uint32_t j = 0; j <= i; j++) {
			const unknown *y = &f->unknown[j];
			f->m[i][j] = response(x, y);
			f->m[j][i] = x->brings || y->brings ? response(y, x) : f->m[i][j];
		}
		f->m[i][i] = f->m[i][i] * (1 + compliance) + x->extra;
		f->m[i][MOST_ROWS] = -x->left;
	}
}

// Solves by elimination without pivots; the last column becomes the solution.
static void solve(few *f)
{
	const uint32_t n = f->unknowns;
	for (uint32_t k = 0; k < n; k++) {
		const double inverse = 1 / f->m[k][k];
		for (uint32_t i = k + 1; i < n; i++) {
			const double share = f->m[i][k] * inverse;
			if (share == 0)
				continue;
			for (uint32_t j = k + 1; j < n; j++)
				f->m[i][j] -= share * f->m[k][j];
			f->m[i][MOST_ROWS] -= share * f->m[k][MOST_ROWS];
		}
	}
	for (uint32_t k = n; k-- > 0;) {
		for (uint32_t j = k + 1; j < n; j++)
			f->m[k][MOST_ROWS] -= f->m[k][j] * f->m[j][MOST_ROWS];
		f->m[k][MOST_ROWS] /= f->m[k][k];
	}
}

// Returns the share of the solution up to the place where the first point's impulse reaches zero.
static double share_of(const ob_island_work *w, const few *f)
{
	double share = 1;
	for (uint32_t k = 0; k < f->unknowns; k++) {
		const unknown *x = &f->unknown[k];
		const double change = f->m[k][MOST_ROWS];
		if (!isfinite(change))
			return 0;
		if (x->row >= OB_POINTS)
			continue;
		const uint32_t lane = f->lane[x->contact];
		const double before = w->batch[lane / OB_LANES].impulse[x->row][lane % OB_LANES];
		if (before + share * change < 0)
			share = -before / change;
	}
	return share;
}

static void apply(ob_island_work *w, const few *f, double share)
{
	for (uint32_t k = 0; k < f->unknowns; k++) {
		const unknown *x = &f->unknown[k];
		const uint32_t lane = f->lane[x->contact], l = lane % OB_LANES;
		ob_batch *b = &w->batch[lane / OB_LANES];
		const double change = share * f->m[k][MOST_ROWS];
		if (x->row == OB_POINTS) {
			b->impulse[4][l] += x->tangents[0] * change;
			b->impulse[5][l] += x->tangents[1] * change;
		} else {
			b->impulse[x->row][l] += change;
		}
		if (x->row < OB_POINTS) {
			b->impulse[x->row][l] = ob_max(0, b->impulse[x->row][l]);
			for (int i = OB_POINTS; i < OB_ROWS; i++)
				b->impulse[i][l] += f->brought[x->contact][x->row][i] * change;
		}
		for (int c = 0; c < 6 && x->a != NO_BODY; c++)
			w->u[x->a][c] += change * x->to_a[c];
		for (int c = 0; c < 6 && x->b != NO_BODY; c++)
			w->u[x->b][c] += change * x->to_b[c];
	}
}

void ob_few_contacts_step(ob_island_work *w)
{
	few f;
	f.contacts = f.unknowns = 0;
	for (uint32_t i = 0; i < w->batches; i++)
		for (unsigned left = w->batch[i].live & ~w->batch[i].isolated; left; left &= left - 1)
			add_contact(w, &f, i * OB_LANES + (uint32_t)__builtin_ctz(left));
	fill_matrix(&f);
	solve(&f);
	apply(w, &f, share_of(w, &f));
}
