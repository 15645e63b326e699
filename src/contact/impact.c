#include "contact/impact.h"

#include <string.h>

// One lane's rows as plain numbers.
typedef struct rows {
	double ja[7][6], jb[7][6]; // linear, angular; b's with the opposite sign
	double a[7][7];
	double rate[7]; // J v
	double gap[4], time[4]; // now; s until it closes, infinity if not within the substep
	double goal[4]; // m/s, normal velocity to reach, in terms of the substep's start
	double max_time;
} rows;

static void row_set(rows *r, int i, const lanes *lin, const lanes *ang_a, const lanes *ang_b, int l)
{
	for (int c = 0; c < 3; c++) {
		r->ja[i][c] = lin ? lin[c][l] : 0;
		r->jb[i][c] = -r->ja[i][c];
		r->ja[i][3 + c] = ang_a[c][l];
		r->jb[i][3 + c] = -ang_b[c][l];
	}
}

static double row_dot(const double *j, const double *x)
{
	return j[0] * x[0] + j[1] * x[1] + j[2] * x[2] + j[3] * x[3] + j[4] * x[4] + j[5] * x[5];
}

// M^-1 j, for a body of the lane
static void response(const double *j, double inv_mass, const lanes *inv_inertia, int l, double *o)
{
	double s[6];
	for (int c = 0; c < 6; c++)
		s[c] = inv_inertia[c][l];
	for (int c = 0; c < 3; c++)
		o[c] = inv_mass * j[c];
	o[3] = s[0] * j[3] + s[1] * j[4] + s[2] * j[5];
	o[4] = s[1] * j[3] + s[3] * j[4] + s[4] * j[5];
	o[5] = s[2] * j[3] + s[4] * j[4] + s[5] * j[5];
}

static bool rows_init(rows *r, const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	bool any = false;
	for (int i = 0; i < 4; i++)
		row_set(r, i, b->n, b->ja[i], b->jb[i], l);
	r->max_time = 0;
	for (int i = 0; i < 4; i++) {
		r->rate[i] = row_dot(r->ja[i], at->v[ia]) + row_dot(r->jb[i], at->v[ib]);
		r->gap[i] = b->gap[i][l] + row_dot(r->ja[i], at->d[ia]) + row_dot(r->jb[i], at->d[ib]);
		double a = (row_dot(r->ja[i], at->dv[ia]) + row_dot(r->jb[i], at->dv[ib])) / in->h;
		double t = b->inv_diag[i][l] > 0 ? ob_time_of_closing(r->gap[i], r->rate[i], a, in->h) : INFINITY;
		double approach = r->rate[i] + a * t;
		if (!(t <= in->h) || !(approach < -in->threshold)) {
			r->time[i] = INFINITY;
			continue;
		}
		any = true;
		r->time[i] = t;
		r->goal[i] = r->rate[i] - (1 + in->e) * approach;
		r->max_time = fmax(r->max_time, t);
	}
	return any;
}

bool ob_impact_pending(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at)
{
	rows r;
	return rows_init(&r, b, l, in, at);
}

static void rows_matrix(rows *r, const ob_batch *b, int l, const ob_impact *in)
{
	for (int i = 0; i < OB_ROWS; i++) {
		double xa[6], xb[6];
		response(r->ja[i], b->ima[l], b->ia, l, xa);
		response(r->jb[i], b->imb[l], b->ib, l, xb);
		for (int j = 0; j < OB_ROWS; j++)
			r->a[i][j] = in->split_a * row_dot(r->ja[j], xa) + in->split_b * row_dot(r->jb[j], xb);
	}
}

// Projected Gauss-Seidel on the points that hit, until nothing changes any more.
static void rows_solve(const rows *r, const ob_batch *b, int l, double *x)
{
	double rate[7];
	memcpy(rate, r->rate, sizeof rate);
	for (int s = 0; s < 200; s++) {
		double change = 0;
		for (int i = 0; i < OB_ROWS; i++) {
			if (i < 4 ? isinf(r->time[i]) : !(r->a[i][i] > 0))
				continue;
			double sum = x[0] + x[1] + x[2] + x[3], bound = b->mu[l] * sum, next;
			if (i < 4)
				next = fmax(0, x[i] - (rate[i] - r->goal[i]) / r->a[i][i]);
			else {
				double other = i == 4 ? x[5] : i == 5 ? x[4] : 0;
				bound = i == 6 ? bound * b->radius[l] : sqrt(fmax(0, bound * bound - other * other));
				next = fmax(-bound, fmin(bound, x[i] - rate[i] / r->a[i][i]));
			}
			double dx = next - x[i];
			x[i] = next;
			for (int j = 0; j < OB_ROWS; j++)
				rate[j] += r->a[j][i] * dx;
			change = fmax(change, fabs(dx) * r->a[i][i]);
		}
		if (change < 1e-15)
			break;
	}
}

bool ob_impact_solve(const ob_batch *b, int l, const ob_impact *in, const ob_impact_rows *at, ob_body_row *out_v,
		     ob_body_row *out_d)
{
	rows r;
	double x[7] = { 0 };
	if (!rows_init(&r, b, l, in, at))
		return false;
	row_set(&r, 4, b->t1, b->fa1, b->fb1, l);
	row_set(&r, 5, b->t2, b->fa2, b->fb2, l);
	row_set(&r, 6, NULL, b->n, b->n, l);
	const uint32_t ia = b->body_a[l], ib = b->body_b[l];
	for (int i = 4; i < OB_ROWS; i++)
		r.rate[i] = row_dot(r.ja[i], at->v[ia]) + row_dot(r.jb[i], at->v[ib]);
	rows_matrix(&r, b, l, in);
	rows_solve(&r, b, l, x);
	double ca[6], cb[6], change_a[6] = { 0 }, change_b[6] = { 0 }, shift_a[6] = { 0 }, shift_b[6] = { 0 };
	for (int i = 0; i < OB_ROWS; i++) {
		double t = i < 4 ? r.time[i] : r.max_time;
		if (x[i] == 0)
			continue;
		response(r.ja[i], b->ima[l], b->ia, l, ca);
		response(r.jb[i], b->imb[l], b->ib, l, cb);
		for (int c = 0; c < 6; c++) {
			change_a[c] += x[i] * ca[c];
			change_b[c] += x[i] * cb[c];
			shift_a[c] -= t * x[i] * ca[c];
			shift_b[c] -= t * x[i] * cb[c];
		}
	}
	for (int c = 0; c < 6; c++) {
		out_v[ia][c] += change_a[c];
		out_v[ib][c] += change_b[c];
		out_d[ia][c] += shift_a[c];
		out_d[ib][c] += shift_b[c];
	}
	return true;
}
