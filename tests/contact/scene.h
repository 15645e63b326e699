// Four random pairs side by side in a batch, and the rows of their bodies.
#ifndef OB_TESTS_CONTACT_SCENE_H
#define OB_TESTS_CONTACT_SCENE_H

#include "pair.h"

static const double substep = 1. / 480; // s

typedef struct scene {
	pair p[OB_LANES];
	ob_batch batch;
	ob_body_row u[2 * OB_LANES + 1], v[2 * OB_LANES + 1], d[2 * OB_LANES + 1], delta[2 * OB_LANES + 1];
	ob_body_row dv[2 * OB_LANES + 1];
} scene;

static inline uint32_t row_a(int lane)
{
	return 1 + 2 * (uint32_t)lane;
}
static inline uint32_t row_b(const scene *s, int lane)
{
	return s->p[lane].b.inv_mass > 0 ? 2 + 2 * (uint32_t)lane : 0;
}

static inline void put(scene *s, int lane)
{
	put_pair(&s->batch, lane, &s->p[lane], row_a(lane), row_b(s, lane));
}

// Four pairs in contact, overlap or near contact, at random velocities, pressed together by "push" m/s.
static inline void random_scene_of(scene *s, uint64_t *seed, double push, ob_batch_kind kind)
{
	memset(s, 0, sizeof *s);
	ob_batch_init(&s->batch, kind);
	for (int l = 0; l < OB_LANES; l++) {
		pair *p = &s->p[l];
		*p = random_pair(seed, uniform(seed) < .3 ? INFINITY : pow(10, within(seed, -2, 2)));
		p->points = kind & OB_KIND_POINT ? 1 : p->points;
		p->mu = kind & OB_KIND_FRICTIONLESS ? 0 : p->mu;
		for (int j = 0; j < p->points; j++)
			p->gap[j] = within(seed, -1e-3, 1e-3);
		put(s, l);
		random_row(seed, &p->a, s->v[row_a(l)]);
		random_row(seed, &p->b, s->v[row_a(l) + 1]);
		double n[3] = { p->normal.x, p->normal.y, p->normal.z };
		for (int c = 0; c < 3; c++)
			s->v[row_a(l)][c] -= push * n[c];
	}
	memcpy(s->u, s->v, sizeof s->u);
	ob_batch_prepare(&s->batch);
}

static inline void random_scene(scene *s, uint64_t *seed, double push)
{
	random_scene_of(s, seed, push, OB_KIND_FULL);
}

// An iteration with the contact solver's parameters.
static inline ob_solver_iteration iteration_on(const scene *s, bool first)
{
	return (ob_solver_iteration){ .h = substep,
				      .block_sweeps = 4,
				      .converged = 1e-12,
				      .wake_threshold = 2e-3,
				      .impact_threshold = .1,
				      .first = first,
				      .resting_gap = 1e-7,
				      .dv = s->dv };
}

#endif
