#include "contact/kernel.h"

#include <stddef.h>
#include <string.h>

void ob_batch_init(ob_batch *b, ob_batch_kind kind)
{
	memset(b, 0, offsetof(ob_batch, coupling)); // coupling is computed before its use
	b->kind = kind;
	for (int i = 0; i < 4; i++)
		b->gap[i] = lanes_of(ob_no_contact);
	b->ka = b->kb = lanes_of(1);
}

void ob_batch_clear(ob_batch *b, int l)
{
	static const ob_vec3 zero;
	static const double none[6];
	ob_batch_lane empty = {
		.normal = { 0, 0, 1 }, .inv_inertia_a = none, .inv_inertia_b = none, .arm_a = &zero, .arm_b = &zero
	};
	ob_vec3 friction_a, friction_b;
	ob_batch_set(b, l, &empty, &friction_a, &friction_b);
	b->live &= ~(1u << l);
	for (int i = 0; i < OB_ROWS; i++) {
		lanes_put(&b->impulse[i], l, 0);
		lanes_put(&b->impulse_start[i], l, 0);
	}
}

void ob_batch_row_of_lane(const ob_batch *b, int l, int row, double *of_a, double *of_b)
{
	const ob_row r = ob_batch_row(b, row);
	for (int c = 0; c < 3; c++) {
		const double along = r.along ? r.along[c][l] : 0;
		of_a[c] = along, of_a[3 + c] = r.about_a[c][l];
		of_b[c] = -along, of_b[3 + c] = -r.about_b[c][l];
	}
}

// ---- the arithmetic, by the kernel for this processor

void ob_friction_arms(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n, ob_vec3 *a,
		      ob_vec3 *b)
{
	ob_kernel_best()->friction_arms(arm_a, arm_b, gap, points, n, a, b);
}

void ob_batch_set(ob_batch *b, int l, const ob_batch_lane *in, ob_vec3 *friction_a, ob_vec3 *friction_b)
{
	ob_kernel_best()->set(b, l, in, friction_a, friction_b);
}

void ob_batch_prepare(ob_batch *b)
{
	if (b->dirty)
		ob_kernel_best()->prepare(b);
}

void ob_batch_find_follows(ob_batch *b, const ob_body_row *v, const ob_body_row *u)
{
	ob_kernel_best()->find_follows(b, v, u);
}

static unsigned lone_lanes(const ob_batch *b, const ob_solver_iteration *iteration)
{
	unsigned found = 0;
	if (b->kind != OB_KIND_FULL || iteration->jacobi || iteration->ghosts)
		return 0;
	for (unsigned left = b->live & b->isolated; left; left &= left - 1) {
		const int l = __builtin_ctz(left);
		found |= (unsigned)((b->ima[l] > 0) != (b->imb[l] > 0) && !(b->disc[l] > 0)) << l;
	}
	return found;
}

void ob_batch_solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		    const ob_body_row *d, ob_body_row *delta)
{
	const ob_kernel *kernel = ob_kernel_best();
	const unsigned live = b->live, isolated = b->isolated, lone = lone_lanes(b, iteration);
	const unsigned impact = iteration->first ? 0 : b->impact & lone;
	b->live &= ~lone, b->isolated &= ~lone;
	b->changed = b->residual = 0;
	b->impact &= iteration->first ? 0 : ~0u;
	b->solved = b->active = b->slides = b->sweeps = 0;
	if (b->live) {
		ob_batch_prepare(b);
		kernel->solve(b, iteration, u, v, d, delta);
	}
	b->live = live, b->isolated = isolated;
	b->impact |= impact;
	for (unsigned left = lone; left; left &= left - 1)
		kernel->solve_lone(b, __builtin_ctz(left), iteration, u, v, d);
}

bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta)
{
	return ob_kernel_best()->project(b, slop, beta, jacobi, d, delta);
}

void ob_batch_limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity)
{
	if (b->impact)
		ob_batch_prepare(b);
	ob_kernel_best()->limit_prediction(b, cap_impulse, cap_velocity);
}

void ob_batch_row_velocities(const ob_batch *b, const ob_body_row *rows, lanes *r)
{
	ob_kernel_best()->row_velocities(b, rows, r);
}

void ob_batch_apply_impulses(const ob_batch *b, const lanes *x, ob_body_row *rows)
{
	ob_kernel_best()->apply_impulses(b, x, rows);
}
