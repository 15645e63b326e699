// Arithmetic that is compiled once per instruction set (kernel.c, lone.c), for batch.h and manifold.h. Tests compare its
// bits, which are the same for all.
#ifndef OB_CONTACT_KERNEL_H
#define OB_CONTACT_KERNEL_H

#include "contact/batch.h"

typedef struct ob_kernel {
	void (*set)(ob_batch *b, int l, const ob_batch_lane *in, ob_vec3 *friction_a, ob_vec3 *friction_b);
	void (*friction_arms)(const ob_vec3 *arm_a, const ob_vec3 *arm_b, const double *gap, int points, ob_vec3 n,
			      ob_vec3 *a, ob_vec3 *b);
	void (*prepare)(ob_batch *b);
	void (*find_follows)(ob_batch *b, const ob_body_row *v, const ob_body_row *u);
	void (*solve)(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		      const ob_body_row *d, ob_body_row *delta);
	// Adds lane l to the batch's results of the iteration: impact, slides, solved, active, sweeps, changed,
	// residual.
	void (*solve_lone)(ob_batch *b, int l, const ob_solver_iteration *iteration, ob_body_row *u,
			   const ob_body_row *v, const ob_body_row *d);
	bool (*project)(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta);
	void (*limit_prediction)(ob_batch *b, const double *cap_impulse, double cap_velocity);
	void (*row_velocities)(const ob_batch *b, const ob_body_row *rows, lanes *r);
	void (*apply_impulses)(const ob_batch *b, const lanes *x, ob_body_row *rows);
	void (*boxes)(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
} ob_kernel;

extern const ob_kernel ob_kernel_portable;
#ifdef OB_HAVE_AVX2
extern const ob_kernel ob_kernel_avx2;
#endif
#ifdef OB_HAVE_AVX512
extern const ob_kernel ob_kernel_avx512;
#endif

// Returns the fastest kernel that this processor runs.
const ob_kernel *ob_kernel_best(void);

#endif
