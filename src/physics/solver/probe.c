#include "solver/probe.h"

#include <stdlib.h>
#include <string.h>

#include "shape/shape.h"
#include "solver/budget.h"
#include "solver/island_solver.h"

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

void ob_probe_solve(ob_probe *p, ob_solver *s, uint32_t substeps, uint32_t beside)
{
	(void)solve(p, s->in, substeps, (double)beside / substeps, UINT64_MAX, s);
}

const ob_island_work *ob_probe_island(const ob_probe *p)
{
	return &p->solver.island;
}

double ob_probe_distance(const ob_probe *p, const ob_island_work *w, uint32_t row, double *speed)
{
	const ob_island_work *other = &p->solver.island;
	const ob_body *a = &w->body[row], *b = &other->body[row];
	double linear = 0, angular = 0;
	*speed = 0;
	if (a->moved_freely && b->moved_freely)
		return 0;
	for (int k = 0; k < 3; k++) {
		const double v = w->v[row][k] - other->v[row][k], turn = w->v[row][3 + k] - other->v[row][3 + k];
		linear += v * v;
		angular += turn * turn;
	}
	*speed = sqrt(linear) + a->radius * sqrt(angular);
	return ob_norm(ob_sub(a->p, b->p)) + turned_by(a, a->q, b->q);
}
