// The contact kernel: impulses on both sides are equal, lanes are independent, impulses stay within their bounds.
#include "contact/batch.h"

#include "check.h"
#include "scene.h"

static void solve(scene *s, int iterations)
{
	for (int k = 0; k < iterations; k++) {
		ob_solver_iteration iteration = iteration_on(s, k == 0);
		ob_batch_solve(&s->batch, &iteration, s->u, s->v, s->d, s->delta);
	}
}

static void check_conserved(const pair *p, const ob_body_row *before, const ob_body_row *after, double tolerance)
{
	ob_vec3 m = ob_sub(momentum(&p->a, after[0]), momentum(&p->a, before[0]));
	ob_vec3 l = ob_sub(angular_momentum(&p->a, after[0]), angular_momentum(&p->a, before[0]));
	double scale =
		ob_norm(momentum(&p->a, before[0])) + ob_norm(momentum(&p->b, before[1])) + ob_norm(m) + ob_norm(l);
	m = ob_add(m, ob_sub(momentum(&p->b, after[1]), momentum(&p->b, before[1])));
	l = ob_add(l, ob_sub(angular_momentum(&p->b, after[1]), angular_momentum(&p->b, before[1])));
	CHECK_NEAR(ob_norm(m) / scale, 0, tolerance);
	CHECK_NEAR(ob_norm(l) / scale, 0, 20 * tolerance);
}

static void check_cone(const scene *s, int l)
{
	const lanes *x = s->batch.impulse;
	double sum = 0, friction = hypot(x[4][l], x[5][l]), most = s->p[l].mu;
	for (int i = 0; i < OB_POINTS; i++) {
		CHECK(x[i][l] >= 0);
		CHECK(i < s->p[l].points || x[i][l] == 0);
		sum += x[i][l];
	}
	CHECK(friction <= most * sum * (1 + 1e-12));
	CHECK(fabs(x[6][l]) <= most * sum * s->batch.radius[l] * (1 + 1e-12));
}

static void test_both_sides(void)
{
	uint64_t seed = 1;
	int pressed = 0;
	for (int i = 0; i < 2000; i++) {
		scene s;
		random_scene(&s, &seed, 1);
		solve(&s, 5);
		for (int l = 0; l < OB_LANES; l++) {
			check_cone(&s, l);
			pressed += s.batch.impulse[0][l] > 0;
			if (s.p[l].b.inv_mass > 0)
				check_conserved(&s.p[l], s.v + row_a(l), s.u + row_a(l), 4e-15);
			else
				CHECK(s.u[row_a(l) + 1][0] == 0);
		}
		for (int c = 0; c < 6; c++)
			CHECK(s.u[0][c] == 0); // fixed bodies
	}
	CHECK(pressed > 2000);
}

// After enough iterations no point closes by more than its gap, and those that carry are at it.
static void test_solution(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 300; i++) {
		scene s;
		random_scene(&s, &seed, 1);
		for (int l = 0; l < OB_LANES; l++)
			s.p[l].mu = 0, put(&s, l);
		ob_batch_prepare(&s.batch);
		s.batch.isolated = 0xf;
		solve(&s, 300);
		for (int l = 0; l < OB_LANES; l++)
			for (int j = 0; j < s.p[l].points; j++) {
				double to = fmax(s.p[l].gap[j], 0) / substep;
				double rate = opening(&s.p[l], j, s.u[row_a(l)], s.u[row_a(l) + 1]);
				CHECK(rate + to >= -1e-5);
				CHECK(s.batch.impulse[j][l] * s.batch.diag[j][l] < 1e-5 || rate + to <= 1e-5);
			}
	}
}

// One point pressed on the ground sideways: it sticks below the cone's limit, and slides along its own direction at it.
static void test_friction(void)
{
	uint64_t seed = 3;
	for (int i = 0; i < 500; i++) {
		double mu = within(&seed, .1, 1), angle = within(&seed, -3, 3), k = .4;
		scene s;
		memset(&s, 0, sizeof s);
		ob_batch_init(&s.batch, OB_KIND_FULL);
		pair *p = &s.p[0];
		*p = (pair){ .normal = { 0, 0, 1 }, .points = 1, .mu = mu, .b = fixed_body() };
		p->a = (body){ .mass = 1, .inv_mass = 1 };
		bool ball = i % 2;
		for (int c = 0; c < 6 && ball; c++)
			p->a.inv_inertia[c] = c == 0 || c == 3 || c == 5 ? 1 / k : 0;
		p->arm_a[0] = ob_v3(0, 0, -1);
		put(&s, 0);
		ob_batch_prepare(&s.batch);
		s.batch.isolated = 1;
		double sliding = within(&seed, 0, 3), press = 1,
		       stick = ball ? 1 + 1 / k : 1; // inverse mass at the point
		memcpy(s.v[1], (double[3]){ sliding * cos(angle), sliding * sin(angle), -press }, 3 * sizeof(double));
		memcpy(s.u, s.v, sizeof s.u);
		solve(&s, 20);
		double f = fmin(mu * press, sliding / stick);
		CHECK_NEAR(s.batch.impulse[0][0], press, 1e-12);
		CHECK_NEAR(hypot(s.batch.impulse[4][0], s.batch.impulse[5][0]), f, 1e-9);
		CHECK_NEAR(s.u[1][0], (sliding - f) * cos(angle), 1e-9);
		CHECK_NEAR(s.u[1][1], (sliding - f) * sin(angle), 1e-9);
		CHECK_NEAR(s.u[1][2], 0, 1e-12);
	}
}

static bool same_rows(const ob_body_row *x, const ob_body_row *y)
{
	return memcmp(x, y, 2 * sizeof *x) == 0;
}

// The same contact alone and beside three others, in each lane: the same bits. alone: bodies without other contacts are
// solved to convergence, which takes as many sweeps as that contact needs.
static void check_lanes(uint64_t *seed, unsigned alone, ob_batch_kind kind)
{
	scene s;
	random_scene_of(&s, seed, within(seed, 0, 2), kind);
	scene together = s;
	together.batch.isolated = alone;
	solve(&together, 3);
	ob_batch_project(&together.batch, 1e-4, .3, false, together.d, together.delta);
	for (int l = 0; l < OB_LANES; l++)
		for (int at = 0; at < OB_LANES; at++) {
			scene single = s;
			ob_batch_init(&single.batch, kind);
			put_pair(&single.batch, at, &s.p[l], row_a(l), row_b(&s, l));
			ob_batch_prepare(&single.batch);
			single.batch.isolated = alone >> l & 1 ? 1u << at : 0;
			solve(&single, 3);
			ob_batch_project(&single.batch, 1e-4, .3, false, single.d, single.delta);
			CHECK(same_rows(single.u + row_a(l), together.u + row_a(l)));
			CHECK(same_rows(single.d + row_a(l), together.d + row_a(l)));
			for (int i = 0; i < OB_ROWS; i++)
				CHECK(single.batch.impulse[i][at] == together.batch.impulse[i][l]);
			CHECK((single.batch.active >> at & 1) == (together.batch.active >> l & 1));
			CHECK((single.batch.impact >> at & 1) == (together.batch.impact >> l & 1));
		}
}

static void test_lanes(void)
{
	uint64_t seed = 4;
	for (int i = 0; i < 1200; i++)
		check_lanes(&seed, i % 2 ? (unsigned)(16 * uniform(&seed)) : 0, (ob_batch_kind)(i / 2 % OB_KINDS));
}

// Specialised kernels give the same results as the general one.
static void test_kinds(void)
{
	uint64_t seed = 10;
	for (int i = 0; i < 800; i++) {
		scene s;
		random_scene_of(&s, &seed, within(&seed, -.5, 2), (ob_batch_kind)(i % OB_KINDS));
		scene full = s;
		ob_batch_init(&full.batch, OB_KIND_FULL);
		for (int l = 0; l < OB_LANES; l++)
			put(&full, l);
		ob_batch_prepare(&full.batch);
		s.batch.isolated = full.batch.isolated = (unsigned)(16 * uniform(&seed));
		solve(&s, 4);
		solve(&full, 4);
		ob_batch_project(&s.batch, 1e-4, .3, false, s.d, s.delta);
		ob_batch_project(&full.batch, 1e-4, .3, false, full.d, full.delta);
		for (int k = 0; k < 2 * OB_LANES + 1; k++)
			for (int c = 0; c < 6; c++) {
				CHECK_NEAR(s.u[k][c], full.u[k][c], 1e-9 * (1 + fabs(full.u[k][c])));
				CHECK_NEAR(s.d[k][c], full.d[k][c], 1e-15);
			}
		CHECK(s.batch.active == full.batch.active && s.batch.impact == full.batch.impact);
	}
}

// The rates of the rows are the changes of velocity by unit impulses, A.
static void test_rates(void)
{
	uint64_t seed = 11;
	for (int i = 0; i < 500; i++) {
		scene s;
		lanes x[OB_ROWS], rate[OB_ROWS];
		random_scene(&s, &seed, 0);
		memset(s.u, 0, sizeof s.u);
		for (int k = 0; k < OB_ROWS; k++)
			for (int l = 0; l < OB_LANES; l++)
				x[k][l] = within(&seed, -1, 1);
		ob_batch_apply_impulses(&s.batch, x, s.u);
		ob_batch_row_velocities(&s.batch, s.u, rate);
		for (int k = 0; k < OB_ROWS; k++)
			for (int l = 0; l < OB_LANES; l++) {
				double expected = 0, scale = 1;
				for (int j = 0; j < OB_ROWS; j++) {
					double a = s.batch.coupling[j][k][l] * s.batch.diag[k][l];
					expected += a * x[j][l];
					scale += fabs(a);
				}
				if (s.p[l].b.inv_mass > 0 && (k > 3 || k < s.p[l].points))
					CHECK_NEAR(rate[k][l] / scale, expected / scale, 1e-12);
			}
	}
}

// One body, row 1, between four others, rows 2 to 5, for Jacobi iterations.
typedef struct star {
	scene s;
	body middle;
} star;

static void random_star(star *t, uint64_t *seed, double push)
{
	memset(t, 0, sizeof *t);
	scene *s = &t->s;
	ob_batch_init(&s->batch, OB_KIND_FULL);
	t->middle = random_body(seed, 3);
	for (int l = 0; l < OB_LANES; l++) {
		pair *p = &s->p[l];
		*p = random_pair(seed, 1);
		p->b = t->middle;
		for (int j = 0; j < p->points; j++) // the same point, relative to both centres
			p->arm_b[j] = ob_sub(ob_add(p->a.p, p->arm_a[j]), t->middle.p);
		put_pair(&s->batch, l, p, 2 + (uint32_t)l, 1);
		random_row(seed, &p->a, s->v[2 + l]);
		double n[3] = { p->normal.x, p->normal.y, p->normal.z };
		for (int c = 0; c < 3; c++)
			s->v[2 + l][c] -= push * n[c];
	}
	random_row(seed, &t->middle, s->v[1]);
	memcpy(s->u, s->v, sizeof s->u);
	s->batch.kb = lanes_of(OB_LANES);
	ob_batch_prepare(&s->batch);
}

static double star_energy(const star *t, const ob_body_row *rows)
{
	double sum = energy(&t->middle, rows[1]);
	for (int l = 0; l < OB_LANES; l++)
		sum += energy(&t->s.p[l].a, rows[2 + l]);
	return sum;
}

// Checks the total momentum of the rows against the sum of single contacts.
static void check_star(const star *t, const ob_body_row *rows, const ob_body_row *before)
{
	ob_vec3 m = { 0, 0, 0 }, l = { 0, 0, 0 };
	double scale = 1e-9;
	for (int k = 0; k <= OB_LANES; k++) {
		const body *b = k ? &t->s.p[k - 1].a : &t->middle;
		ob_vec3 mk = ob_sub(momentum(b, rows[1 + k]), momentum(b, before[1 + k]));
		ob_vec3 lk = ob_sub(angular_momentum(b, rows[1 + k]), angular_momentum(b, before[1 + k]));
		m = ob_add(m, mk);
		l = ob_add(l, lk);
		scale += ob_norm(mk) + ob_norm(lk) + ob_norm(momentum(b, before[1 + k]));
	}
	CHECK_NEAR(ob_norm(m) / scale, 0, 4e-15);
	CHECK_NEAR(ob_norm(l) / scale, 0, 1e-13);
}

// All changes start from the same published state and are published together: the split masses add up to the body's.
static void test_jacobi(void)
{
	uint64_t seed = 5;
	for (int i = 0; i < 500; i++) {
		star t;
		random_star(&t, &seed, i % 2 ? 2 : 0);
		scene *s = &t.s;
		ob_solver_iteration iteration = iteration_on(s, true);
		iteration.jacobi = true;
		ob_batch_solve(&s->batch, &iteration, s->u, s->v, s->d, s->delta);
		CHECK(memcmp(s->u, s->v, sizeof s->u) == 0);
		for (int k = 1; k <= 1 + OB_LANES; k++)
			for (int c = 0; c < 6; c++)
				s->u[k][c] += s->delta[k][c];
		check_star(&t, s->u, s->v);
		CHECK(star_energy(&t, s->u) <= star_energy(&t, s->v) * (1 + 1e-12));
		for (int l = 0; l < OB_LANES; l++)
			check_cone(s, l);
	}
}

// Overlaps are reduced in the displacements by the requested share; velocities and impulses do not change.
static void test_project(void)
{
	uint64_t seed = 6;
	const double slop = 1e-4, share = .3;
	for (int i = 0; i < 500; i++) {
		scene s;
		random_scene(&s, &seed, 0);
		for (int l = 0; l < OB_LANES; l++)
			s.p[l].points = 1, s.p[l].gap[0] = within(&seed, -1e-2, 1e-3), put(&s, l);
		ob_batch_prepare(&s.batch);
		ob_body_row none[2 * OB_LANES + 1] = { 0 };
		ob_batch before = s.batch;
		ob_batch_project(&s.batch, slop, share, false, s.d, s.delta);
		CHECK(memcmp(&before, &s.batch, sizeof before) == 0);
		for (int l = 0; l < OB_LANES; l++) {
			const pair *p = &s.p[l];
			double deep = fmin(0, p->gap[0] + slop),
			       moved = opening(p, 0, s.d[row_a(l)], s.d[row_a(l) + 1]);
			CHECK_NEAR(moved, -share * deep, 1e-15);
			if (p->b.inv_mass > 0 && deep < 0)
				check_conserved(p, none, s.d + row_a(l), 4e-15);
		}
		ob_batch_project(&s.batch, slop, share, true, none, s.delta);
		CHECK(memcmp(s.d + 1, s.delta + 1, sizeof s.d - sizeof s.d[0]) == 0); // Jacobi: the same, stored apart
	}
}

// Impulses of an impact are taken back to within the cap; contacts without one keep theirs.
static void test_cap(void)
{
	uint64_t seed = 7;
	int capped = 0;
	for (int i = 0; i < 500; i++) {
		scene s;
		random_scene(&s, &seed, i % 2 ? 3 : -.5);
		solve(&s, 2);
		ob_batch solved = s.batch;
		const double cap[OB_LANES] = { .01, .02, .03, .04 };
		ob_batch_limit_prediction(&s.batch, cap, .05);
		CHECK(s.batch.impact == 0);
		for (int l = 0; l < OB_LANES; l++) {
			bool impact = solved.impact >> l & 1;
			capped += impact;
			for (int k = 0; k < OB_ROWS; k++) {
				const double arm = k == 6 ? s.batch.radius[l] : 1; // twist: N m s, and m/s at the arm
				const double most = fmax(cap[l] * arm, .05 / (s.batch.diag[k][l] * arm));
				CHECK(impact || s.batch.impulse[k][l] == solved.impulse[k][l]);
				CHECK(!impact || fabs(s.batch.impulse[k][l]) <= most * (1 + 1e-12));
			}
		}
	}
	CHECK(capped > 500);
}

// Applying the negated impulses restores the velocities of before.
static void test_push(void)
{
	uint64_t seed = 8;
	for (int i = 0; i < 500; i++) {
		scene s;
		random_scene(&s, &seed, 2);
		solve(&s, 3);
		ob_body_row u[2 * OB_LANES + 1];
		memcpy(u, s.u, sizeof u);
		lanes back[OB_ROWS];
		for (int k = 0; k < OB_ROWS; k++)
			back[k] = -s.batch.impulse[k];
		ob_batch_apply_impulses(&s.batch, back, s.u);
		for (int k = 0; k < 2 * OB_LANES + 1; k++)
			for (int c = 0; c < 6; c++)
				CHECK_NEAR(s.u[k][c], s.v[k][c], 1e-12 * (1 + fabs(u[k][c])));
	}
}

static void test_tangents(void)
{
	uint64_t seed = 9;
	for (int i = 0; i < 1000; i++) {
		ob_vec3 n = i < 6 ? ob_v3(i / 2 == 0, i / 2 == 1, i / 2 == 2) : random_direction(&seed), t1, t2;
		n = i % 2 ? n : ob_scale(n, -1);
		ob_tangents(n, &t1, &t2);
		CHECK_NEAR(ob_norm(t1), 1, 1e-14);
		CHECK_NEAR(ob_norm(t2), 1, 1e-14);
		CHECK_NEAR(ob_dot(t1, n), 0, 1e-14);
		CHECK_NEAR(ob_norm(ob_sub(ob_cross(n, t1), t2)), 0, 1e-14);
	}
}

// Speeds down to the smallest numbers: their squares are none, and impulses stay numbers within their bounds.
static void test_small_numbers(void)
{
	enum { SCENES = 1000 };
	uint64_t seed = 12;
	for (int i = 0; i < SCENES; i++) {
		scene s;
		random_scene_of(&s, &seed, within(&seed, 0, 2), (ob_batch_kind)(i % OB_KINDS));
		const double share = pow(10, within(&seed, -324, -100));
		for (int k = 0; k < 2 * OB_LANES + 1; k++)
			for (int c = 0; c < 6; c++)
				s.u[k][c] = s.v[k][c] *= share;
		for (int l = 0; l < OB_LANES; l++) {
			memset(s.p[l].gap, 0, sizeof s.p[l].gap);
			put(&s, l);
		}
		ob_batch_prepare(&s.batch);
		s.batch.isolated = s.batch.hit = (unsigned)(16 * uniform(&seed));
		solve(&s, 4);
		ob_batch_project(&s.batch, 1e-4, .3, false, s.d, s.delta);
		for (int l = 0; l < OB_LANES; l++)
			for (int k = 0; k < OB_ROWS; k++)
				CHECK(fabs(s.batch.impulse[k][l]) <= 1e3);
		for (int k = 0; k < 2 * OB_LANES + 1; k++)
			for (int c = 0; c < 6; c++)
				CHECK(fabs(s.u[k][c]) <= 1e3 && fabs(s.d[k][c]) <= 1e3);
	}
}

int main(void)
{
	test_small_numbers();
	test_both_sides();
	test_solution();
	test_friction();
	test_lanes();
	test_kinds();
	test_rates();
	test_jacobi();
	test_project();
	test_cap();
	test_push();
	test_tangents();
	return check_end();
}
