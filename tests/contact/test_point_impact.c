// One point against what is fixed: what the solver of any pair's impacts makes of it, Newton's law, energy never more.
#include "contact/impact.h"

#include "check.h"
#include "contact/impact.h"
#include "pair.h"

typedef struct blow {
	ob_point_impact r;
	ob_vec3 arm, normal;
	ob_state before, after;
} blow;

static blow random_blow(uint64_t *seed, int k)
{
	blow b = { .normal = random_direction(seed), .arm = random_vector(seed, .5) };
	b.r.inv_mass = 1 / within(seed, .5, 2);
	b.r.inertia = ob_scale(random_inertia(seed), within(seed, .05, .5));
	b.r.friction = k % 4 ? within(seed, 0, 1) : 0;
	b.r.restitution = k % 5 ? within(seed, 0, 1) : 1;
	b.before = (ob_state){ { { 0, 0, 0 }, random_attitude(seed) }, random_vector(seed, 2), random_vector(seed, 2) };
	return b;
}

static ob_vec3 speed_of_point(const blow *b, const ob_state *s)
{
	return ob_add(s->v, ob_cross(s->w, b->arm));
}

static double energy_of(const blow *b, const ob_state *s)
{
	ob_mat3 r = ob_quat_matrix(s->pose.q);
	ob_vec3 w = ob_rotate_back(&r, s->w), j = b->r.inertia;
	return .5 * ob_norm2(s->v) / b->r.inv_mass + .5 * (j.x * w.x * w.x + j.y * w.y * w.y + j.z * w.z * w.z);
}

// The same by the solver of pairs, whose substep is so short that only the impact counts.
static ob_state by_pairs(const blow *b)
{
	pair p = { .normal = b->normal, .points = 1, .mu = b->r.friction, .e = b->r.restitution, .b = fixed_body() };
	ob_mat3 r = ob_quat_matrix(b->before.pose.q);
	double inverse[3] = { 1 / b->r.inertia.x, 1 / b->r.inertia.y, 1 / b->r.inertia.z };
	p.a.inv_mass = b->r.inv_mass;
	for (int i = 0, c = 0; i < 3; i++)
		for (int j = i; j < 3; j++, c++)
			for (int k = 0; k < 3; k++)
				p.a.inv_inertia[c] += r.m[i][k] * inverse[k] * r.m[j][k];
	p.arm_a[0] = b->arm;
	ob_batch batch;
	ob_batch_init(&batch, OB_KIND_FULL);
	put_pair(&batch, 0, &p, 1, 0);
	ob_batch_prepare(&batch);
	const ob_state *s = &b->before;
	ob_body_row v[2] = { { 0 }, { s->v.x, s->v.y, s->v.z, s->w.x, s->w.y, s->w.z } }, none[2] = { 0 }, d[2] = { 0 };
	ob_impact in = { 1e-9, 1e-9, p.e, 1e-9, 1, 1 };
	CHECK(ob_impact_solve(&batch, 0, &in, &(ob_impact_rows){ v, none, d }, v, d) >= 0);
	return (ob_state){ s->pose, linear(v[1]), angular(v[1]) };
}

static int unsettled;

static void check_blow(uint64_t *seed, int k)
{
	blow b = random_blow(seed, k);
	double in = ob_dot(b.normal, speed_of_point(&b, &b.before));
	if (in > -1e-3)
		return;
	b.after = b.before;
	ob_point_impact_solve(&b.r, b.arm, b.normal, &b.after);
	ob_state pairs = by_pairs(&b);
	double scale = ob_norm(b.before.v) + ob_norm(b.before.w), energy = energy_of(&b, &b.before);
	double off = (ob_norm(ob_sub(b.after.v, pairs.v)) + ob_norm(ob_sub(b.after.w, pairs.w))) / scale;
	unsettled += off > 1e-7; // where friction and a long lever jam
	CHECK(energy_of(&b, &b.after) <= energy * (1 + 1e-14));
	if (b.r.friction > 0)
		return;
	CHECK_NEAR(ob_dot(b.normal, speed_of_point(&b, &b.after)), -b.r.restitution * in, 1e-13);
	if (b.r.restitution == 1)
		CHECK_NEAR(energy_of(&b, &b.after) / energy, 1, 1e-14);
}

int main(void)
{
	uint64_t seed = 3;
	for (int k = 0; k < 20000; k++)
		check_blow(&seed, k);
	CHECK(unsettled < 50);
	return check_end();
}
