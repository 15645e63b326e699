#include "solver/probe.h"

#include <stdlib.h>
#include <string.h>

#include "motion/deviation.h"
#include "shape/shape.h"
#include "solver/budget.h"
#include "solver/island_solver.h"
#include "solver/joint_rows.h"

struct ob_probe {
	ob_run_settings settings; // of the run, with other substeps
	ob_solver solver;
	uint64_t work, most; // in the running island
	ob_solver *payer; // whose budget it takes, too; NULL: none
};

static bool spend(void *probe, uint64_t work)
{
	ob_probe *p = probe;
	p->work += work;
	if (p->payer)
		ob_budget_note(p->payer, work);
	return p->work > p->most || (p->payer && ob_budget_spent(p->payer));
}

static void attempt_nothing(void *probe) {}
static void touch_nothing(void *probe, uint32_t a, uint32_t b, double impulse, ob_vec3 point) {}
static void fail_nothing(void *probe, uint32_t object) {}

ob_probe *ob_probe_create(const ob_run_settings *run, uint32_t substeps)
{
	enum { ODE_BODIES = 256 };
	ob_probe *p = calloc(1, sizeof *p);
	const ob_island_calls calls = {
		.with = p, .spend = spend, .attempt = attempt_nothing, .touch = touch_nothing, .fail = fail_nothing
	};
	if (!p)
		return NULL;
	p->settings = *run;
	p->settings.substeps = substeps;
	if (ob_solver_create(&p->solver, &p->settings, &calls, ODE_BODIES))
		return p;
	ob_probe_destroy(p);
	return NULL;
}

void ob_probe_destroy(ob_probe *p)
{
	if (!p)
		return;
	ob_solver_finish(&p->solver);
	free(p);
}

static bool solve(ob_probe *p, const ob_island_input *in, uint32_t substeps, double stretch, uint64_t most,
		  ob_solver *payer)
{
	p->work = 0;
	p->payer = payer;
	p->most = most;
	memset(&p->solver.budget, 0, sizeof p->solver.budget);
	p->solver.counters.pair_solves = 0;
	ob_island_probe(&p->solver, in, substeps, stretch);
	return !p->solver.budget.spent;
}

bool ob_probe_try(ob_probe *p, const ob_island_input *in, uint32_t substeps, uint64_t most)
{
	return solve(p, in, substeps, 1, most, NULL);
}

// Largest distance by which a turn from a to b moves the surface of a body: one that is the same however it is turned about
// an axis moves with its axis.
static double turned_by(const ob_body *body, ob_quat a, ob_quat b)
{
	const double c[2][4] = { { a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z },
				 { a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z } };
	double square[2] = { 0, 0 };
	if (ob_shape_is(body->shape, OB_ISOTROPIC))
		return 0;
	if (ob_shape_is(body->shape, OB_AXIAL)) {
		const ob_mat3 of_a = ob_quat_matrix(a), of_b = ob_quat_matrix(b);
		return body->radius * ob_norm(ob_sub(ob_column(&of_a, 2), ob_column(&of_b, 2)));
	}
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < 4; i++)
			square[k] += c[k][i] * c[k][i];
	return 2 * body->radius * sqrt(ob_min(square[0], square[1]));
}

// Takes from velocities what the rows of a batch that hold do not let last: loaded points, and friction that sticks.
static void hold(ob_batch *b, ob_body_row *rows)
{
	const lane_mask live = lanes_mask(b->live);
	lanes rate[OB_ROWS], impulse[OB_ROWS];
	ob_batch_prepare(b);
	ob_batch_row_velocities(b, rows, rate);
	const lane_mask loaded = b->impulse[0] + b->impulse[1] + b->impulse[2] + b->impulse[3] > lanes_of(0),
			sticks = live & ~lanes_mask(b->slides) & loaded;
	for (int i = 0; i < OB_ROWS; i++) {
		const lane_mask holds = i < OB_POINTS ? live & (b->impulse[i] > lanes_of(0)) : sticks;
		impulse[i] = lanes_where(holds, -rate[i] * b->inv_diag[i]);
		for (int j = i + 1; j < OB_ROWS; j++)
			rate[j] += b->coupling[i][j] * b->diag[j] * impulse[i];
	}
	ob_batch_apply_impulses(b, impulse, rows);
}

void ob_probe_compare(ob_probe *p, ob_island_work *w)
{
	enum { SWEEPS = 16 };
	const ob_island_work *other = &p->solver.island;
	memset(other->u, 0,
	       w->rows * sizeof *other->u); // free as scratch memory here: it has room for all that the input may need
	for (uint32_t row = 1; row <= w->bodies; row++)
		for (int k = 0; k < 6; k++)
			other->u[row][k] = w->v[row][k] - other->v[row][k];
	if (w->bodies <= OB_WATCHED_BODIES || ob_flies_with_joints(p->solver.in))
		return;
	for (int sweep = 0; sweep < SWEEPS; sweep++) {
		for (uint32_t i = 0; i < w->batches; i++)
			if (w->batch[i].live)
				hold(&w->batch[i], other->u);
		if (w->joints.count)
			ob_joints_follow(w, other->u);
	}
}

void ob_probe_solve(ob_probe *p, ob_solver *s, uint32_t substeps, uint32_t beside)
{
	(void)solve(p, s->in, substeps, (double)beside / substeps, UINT64_MAX, s);
	ob_probe_compare(p, &s->island);
}

ob_island_work *ob_probe_island(ob_probe *p)
{
	return &p->solver.island;
}

double ob_probe_distance(const ob_probe *p, const ob_island_work *w, uint32_t row, double *speed)
{
	const ob_island_work *other = &p->solver.island;
	const ob_body *a = &w->body[row], *b = &other->body[row];
	if (a->moved_freely && b->moved_freely)
		return *speed = 0;
	*speed = ob_surface_speed(ob_row_linear(other->u[row]), ob_row_angular(other->u[row]), a->radius);
	return ob_norm(ob_sub(a->p, b->p)) + turned_by(a, a->q, b->q);
}
