#include "contact/batch.h"

#include <stddef.h>
#include <string.h>

static void set3(lanes *x, int l, ob_vec3 v)
{
	x[0][l] = v.x;
	x[1][l] = v.y;
	x[2][l] = v.z;
}

void ob_tangents(ob_vec3 n, ob_vec3 *t1, ob_vec3 *t2)
{
	if (fabs(n.z) > .7) {
		double k = 1 / sqrt(n.y * n.y + n.z * n.z);
		*t1 = ob_v3(0, -n.z * k, n.y * k);
	} else {
		double k = 1 / sqrt(n.x * n.x + n.y * n.y);
		*t1 = ob_v3(-n.y * k, n.x * k, 0);
	}
	*t2 = ob_cross(n, *t1);
}

void ob_batch_init(ob_batch *b, ob_batch_kind kind)
{
	memset(b, 0, offsetof(ob_batch, coupling)); // which is made before it is used
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
	ob_batch_set(b, l, &empty);
	b->live &= ~(1u << l);
	for (int i = 0; i < OB_ROWS; i++)
		b->impulse[i][l] = b->impulse_start[i][l] = 0;
}

void ob_batch_set(ob_batch *b, int l, const ob_batch_lane *in)
{
	ob_vec3 n = in->normal, t1, t2, ca = { 0, 0, 0 }, cb = { 0, 0, 0 };
	ob_tangents(n, &t1, &t2);
	double radius = 0;
	for (int j = 0; j < in->points; j++) {
		ca = ob_madd(ca, 1. / in->points, in->arm_a[j]);
		cb = ob_madd(cb, 1. / in->points, in->arm_b[j]);
	}
	for (int j = 0; j < OB_POINTS; j++) {
		bool used = j < in->points;
		set3(b->ja[j], l, used ? ob_cross(in->arm_a[j], n) : ob_v3(0, 0, 0));
		set3(b->jb[j], l, used ? ob_cross(in->arm_b[j], n) : ob_v3(0, 0, 0));
		b->gap[j][l] = used ? in->gap[j] : ob_no_contact;
		if (used)
			radius += ob_norm(ob_sub(in->arm_a[j], ca)) / in->points;
	}
	set3(b->n, l, n);
	set3(b->t1, l, t1);
	set3(b->t2, l, t2);
	set3(b->fa1, l, ob_cross(ca, t1));
	set3(b->fa2, l, ob_cross(ca, t2));
	set3(b->fb1, l, ob_cross(cb, t1));
	set3(b->fb2, l, ob_cross(cb, t2));
	for (int c = 0; c < 6; c++) {
		b->ia[c][l] = in->inv_inertia_a[c];
		b->ib[c][l] = in->inv_inertia_b[c];
	}
	b->ima[l] = in->inv_mass_a;
	b->imb[l] = in->inv_mass_b;
	b->mu[l] = in->mu;
	b->radius[l] = radius;
	b->body_a[l] = in->body_a;
	b->body_b[l] = in->body_b;
	b->live |= 1u << l;
	b->elastic = in->e > 0 ? b->elastic | 1u << l : b->elastic & ~(1u << l);
	b->dirty = 1;
}

// ---- the arithmetic, by the kernel for this processor

const ob_kernel *ob_kernel_best(void)
{
#ifdef OB_HAVE_AVX2
	if (__builtin_cpu_supports("avx2"))
		return &ob_kernel_avx2;
#endif
	return &ob_kernel_portable;
}

void ob_batch_prepare(ob_batch *b)
{
	ob_kernel_best()->prepare(b);
}

void ob_batch_solve(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		    const ob_body_row *d, ob_body_row *delta)
{
	ob_kernel_best()->solve(b, iteration, u, v, d, delta);
}

bool ob_batch_project(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta)
{
	return ob_kernel_best()->project(b, slop, beta, jacobi, d, delta);
}

void ob_batch_limit_prediction(ob_batch *b, const double *cap_impulse, double cap_velocity)
{
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
