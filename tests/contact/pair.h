// Two random bodies in contact, as the contact kernel sees them.
#ifndef OB_TESTS_CONTACT_PAIR_H
#define OB_TESTS_CONTACT_PAIR_H

#include <string.h>

#include "contact/batch.h"

#include "placed.h"

typedef struct body {
	double mass; // kg; infinite: fixed
	ob_vec3 p; // m
	ob_mat3 inertia; // kg m^2, world
	double inv_mass, inv_inertia[6];
} body;

typedef struct pair {
	body a, b;
	ob_vec3 normal, arm_a[OB_POINTS], arm_b[OB_POINTS];
	double gap[OB_POINTS], disc_radius, mu, e;
	int points;
} pair;

static inline body fixed_body(void)
{
	return (body){ .mass = INFINITY };
}

// A box of this mass with random half extents about .1 to 1 m, turned at random.
static inline body random_body(uint64_t *seed, double mass)
{
	ob_vec3 moment = ob_scale(random_inertia(seed), mass / 3);
	ob_mat3 r = ob_quat_matrix(random_attitude(seed));
	double principal[3] = { moment.x, moment.y, moment.z };
	body out = { .mass = mass, .p = random_vector(seed, 1), .inv_mass = 1 / mass };
	for (int i = 0, c = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			double inverse = 0;
			for (int k = 0; k < 3; k++) {
				out.inertia.m[i][j] += r.m[i][k] * principal[k] * r.m[j][k];
				inverse += r.m[i][k] / principal[k] * r.m[j][k];
			}
			if (j >= i)
				out.inv_inertia[c++] = inverse;
		}
	return out;
}

// Points in a plane across a random normal. mass_ratio: b's; infinity makes it fixed.
static inline pair random_pair(uint64_t *seed, double mass_ratio)
{
	pair p = { .normal = random_direction(seed) };
	ob_vec3 t1, t2;
	p.points = 1 + (int)(4 * uniform(seed));
	p.a = random_body(seed, within(seed, .5, 2));
	p.b = isinf(mass_ratio) ? fixed_body() : random_body(seed, mass_ratio * p.a.mass);
	p.mu = within(seed, 0, 1);
	ob_tangents(p.normal, &t1, &t2);
	ob_vec3 centre = random_vector(seed, .5);
	for (int j = 0; j < p.points; j++) {
		double along = within(seed, -.5, .5), across = within(seed, -.5, .5);
		ob_vec3 x = ob_madd(ob_madd(centre, along, t1), across, t2);
		p.arm_a[j] = ob_sub(x, p.a.p);
		p.arm_b[j] = ob_sub(x, p.b.p);
	}
	return p;
}

static inline void put_pair(ob_batch *batch, int lane, const pair *p, uint32_t row_a, uint32_t row_b)
{
	ob_batch_lane in = { .body_a = row_a,
			     .body_b = row_b,
			     .normal = p->normal,
			     .points = p->points,
			     .arm_a = p->arm_a,
			     .arm_b = p->arm_b,
			     .gap = p->gap,
			     .disc_radius = p->disc_radius,
			     .mu = p->mu,
			     .e = p->e,
			     .inv_mass_a = p->a.inv_mass,
			     .inv_mass_b = p->b.inv_mass,
			     .inv_inertia_a = p->a.inv_inertia,
			     .inv_inertia_b = p->b.inv_inertia };
	ob_vec3 friction_a, friction_b;
	ob_batch_set(batch, lane, &in, &friction_a, &friction_b);
}

static inline void random_row(uint64_t *seed, const body *b, ob_body_row row)
{
	memset(row, 0, sizeof(ob_body_row));
	for (int c = 0; c < 6 && b->inv_mass > 0; c++)
		row[c] = within(seed, -1, 1);
}

static inline ob_vec3 linear(const double *row)
{
	return ob_v3(row[0], row[1], row[2]);
}

static inline ob_vec3 angular(const double *row)
{
	return ob_v3(row[3], row[4], row[5]);
}

// kg m/s; 0 for a fixed body
static inline ob_vec3 momentum(const body *b, const double *row)
{
	return b->inv_mass > 0 ? ob_scale(linear(row), b->mass) : ob_v3(0, 0, 0);
}

// kg m^2/s, about the origin
static inline ob_vec3 angular_momentum(const body *b, const double *row)
{
	return ob_add(ob_cross(b->p, momentum(b, row)), ob_rotate(&b->inertia, angular(row)));
}

static inline double energy(const body *b, const double *row)
{
	ob_vec3 w = angular(row);
	return .5 * ob_dot(momentum(b, row), linear(row)) + .5 * ob_dot(w, ob_rotate(&b->inertia, w));
}

// m/s at which point j of the pair opens
static inline double opening(const pair *p, int j, const double *a, const double *b)
{
	ob_vec3 va = ob_add(linear(a), ob_cross(angular(a), p->arm_a[j]));
	ob_vec3 vb = ob_add(linear(b), ob_cross(angular(b), p->arm_b[j]));
	return ob_dot(p->normal, ob_sub(va, vb));
}

#endif
