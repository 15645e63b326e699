// The batch functions of contact/batch.h, once per instruction set.
#ifndef OB_CONTACT_KERNEL_H
#define OB_CONTACT_KERNEL_H

#include "contact/batch.h"

static const double ob_no_contact = 1e3; // m: the gap of a point that is not there

typedef struct ob_kernel {
	void (*prepare)(ob_batch *b);
	void (*solve)(ob_batch *b, const ob_solver_iteration *iteration, ob_body_row *u, const ob_body_row *v,
		      const ob_body_row *d, ob_body_row *delta);
	bool (*project)(ob_batch *b, double slop, double beta, bool jacobi, ob_body_row *d, ob_body_row *delta);
	void (*limit_prediction)(ob_batch *b, const double *cap_impulse, double cap_velocity);
	void (*row_velocities)(const ob_batch *b, const ob_body_row *rows, lanes *r);
	void (*apply_impulses)(const ob_batch *b, const lanes *x, ob_body_row *rows);
} ob_kernel;

extern const ob_kernel ob_kernel_portable;
#ifdef OB_HAVE_AVX2
extern const ob_kernel ob_kernel_avx2;
#endif

// The fastest that this processor runs.
const ob_kernel *ob_kernel_best(void);

#endif
