#include "solver/conjugate.h"

#include "base/allocate.h"

#include <stdlib.h>
#include <string.h>

void ob_conjugate_begin(ob_island_work *w)
{
	ob_conjugate *c = &w->conjugate;
	if (w->batches > c->batches_max) {
		c->batches_max = w->batches + w->batches / 2;
		free(c->direction);
		free(c->change);
		c->direction = ob_allocate_aligned(32, c->batches_max * sizeof *c->direction);
		c->change = ob_allocate_aligned(32, c->batches_max * sizeof *c->change);
	}
	if (w->batches)
		memset(c->direction, 0, w->batches * sizeof *c->direction);
	for (uint32_t i = 0; i < w->batches; i++)
		ob_batch_prepare(&w->batch[i]);
	c->last = 0;
}

void ob_conjugate_note(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->batches; i++)
		memcpy(w->conjugate.change[i], w->batch[i].impulse, sizeof *w->conjugate.change);
}

// Returns the square (J) of the iteration's change of impulses; leaves the change in place of the impulses noted
// before.
static double find_change(ob_island_work *w)
{
	lanes sum = lanes_of(0);
	for (uint32_t i = 0; i < w->batches; i++) {
		const ob_batch *b = &w->batch[i];
		lanes *change = w->conjugate.change[i];
		const lane_mask live = lanes_mask(b->live);
		for (int k = 0; k < OB_ROWS; k++) {
			change[k] = (lanes)(live & (lane_mask)(b->impulse[k] - change[k]));
			sum += change[k] * change[k] * b->diag[k];
		}
	}
	return sum[0] + sum[1] + sum[2] + sum[3];
}

void ob_conjugate_go_on(ob_island_work *w)
{
	ob_conjugate *c = &w->conjugate;
	const double now = find_change(w), beta = c->last > 0 ? now / c->last : 0;
	c->last = now;
	for (uint32_t i = 0; i < w->batches; i++) {
		ob_batch *b = &w->batch[i];
		lanes *p = c->direction[i];
		if (beta > 1) {
			memset(p, 0, sizeof *c->direction);
			continue;
		}
		for (int k = 0; k < OB_ROWS; k++) {
			p[k] *= beta;
			b->impulse[k] += p[k];
		}
		ob_batch_apply_impulses(b, p, w->u);
		for (int k = 0; k < OB_ROWS; k++)
			p[k] += c->change[i][k];
	}
}

void ob_conjugate_finish(ob_conjugate *c)
{
	free(c->direction);
	free(c->change);
}
