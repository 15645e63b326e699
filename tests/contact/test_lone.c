// A contact that is solved by itself has the same impulses as in a batch with three empty lanes, with the same bits on
// every processor.
#include "contact/kernel.h"

#include "check.h"
#include "scene.h"

// The four corners of a face, the last two of which are slightly farther away, or much: an edge or little more carries
// the load.
static void set_face(pair *p, uint64_t *seed)
{
	ob_vec3 t1, t2, middle = ob_madd(p->arm_a[0], within(seed, -.1, .1), p->normal);
	const double length = within(seed, .05, .5), width = within(seed, .05, .5),
		     lift = pow(10, within(seed, -7, -1)), angle = within(seed, 0, 7);
	ob_tangents(p->normal, &t1, &t2);
	const ob_vec3 along = ob_add(ob_scale(t1, cos(angle)), ob_scale(t2, sin(angle))),
		      across = ob_cross(p->normal, along);
	for (int j = 0; j < OB_POINTS; j++) {
		const ob_vec3 at = ob_madd(ob_scale(along, j & 1 ? length : -length), j & 2 ? width : -width, across);
		p->arm_a[j] = ob_add(middle, at);
		p->arm_b[j] = ob_sub(ob_add(p->a.p, p->arm_a[j]), p->b.p);
		p->gap[j] = j & 2 ? lift : within(seed, -1e-6, 1e-6);
	}
	p->points = OB_POINTS;
}

// One lane with a moving and a fixed body; the others are empty. In the middle of a substep, like persisting contacts:
// some rotate, some have impacts.
static int random_lone(scene *s, uint64_t *seed)
{
	const int l = (int)(OB_LANES * uniform(seed));
	random_scene(s, seed, within(seed, 0, .3));
	const double slow = uniform(seed) < .5 ? 1e-3 : 1;
	pair *p = &s->p[l];
	p->b.inv_mass = 0;
	memset(&p->b.inv_inertia, 0, sizeof p->b.inv_inertia);
	memset(s->v[row_a(l) + 1], 0, sizeof s->v[0]);
	for (int c = 0; c < 6; c++)
		s->v[row_a(l)][c] *= slow;
	p->e = uniform(seed) < .5 ? 0 : p->e;
	if (uniform(seed) < .3)
		set_face(p, seed);
	for (int j = 0; j < p->points; j++)
		p->gap[j] *= slow;
	put(s, l);
	for (int i = 0; i < OB_LANES; i++)
		if (i != l)
			ob_batch_clear(&s->batch, i);
	ob_batch_prepare(&s->batch);
	s->batch.isolated = s->batch.live;
	s->batch.hit = uniform(seed) < .3 ? s->batch.live : 0;
	s->batch.turning = uniform(seed) < .3 ? s->batch.live : 0;
	for (int i = 0; i < OB_ROWS; i++)
		lanes_put(&s->batch.turn[i], l, within(seed, -.01, .01));
	memcpy(s->u, s->v, sizeof s->u);
	for (int c = 0; c < 3; c++)
		s->dv[row_a(l)][c] = slow * within(seed, -.02, .02), s->u[row_a(l)][c] += s->dv[row_a(l)][c];
	return l;
}

// No gap closes farther than allowed, no point that separates has an impulse, and no sticking point slips.
static void check_law(const scene *s, int l)
{
	const ob_batch *b = &s->batch;
	const bool turning = b->turning, slides = b->slides;
	lanes rate[OB_ROWS];
	double sum = 0;
	ob_batch_row_velocities(b, s->u, rate);
	for (int j = 0; j < s->p[l].points; j++) {
		const double x = b->impulse[j][l], left = rate[j][l] + b->bias[j][l];
		CHECK(x >= 0);
		CHECK(left >= -1e-9);
		CHECK(x == 0 || left <= 1e-9);
		sum += x;
	}
	const double bound = s->p[l].mu * sum;
	CHECK(hypot(b->impulse[4][l], b->impulse[5][l]) <= bound * (1 + 1e-9) + 1e-15);
	const double arm = hypot(b->patch_e1[0][l], b->patch_e1[1][l]) + hypot(b->patch_e2[0][l], b->patch_e2[1][l]);
	CHECK(fabs(b->impulse[6][l]) <= 2 * bound * arm);
	for (int i = OB_POINTS; i < OB_ROWS && !slides; i++)
		CHECK_NEAR((rate[i][l] + (turning ? b->turn[i][l] : 0)) * (i < 6 ? 1 : b->radius[l]), 0, 1e-9);
}

static bool carries(const ob_batch *b, int l)
{
	double sum = 0;
	for (int j = 0; j < OB_POINTS; j++)
		sum += b->impulse[j][l];
	return sum > 0;
}

static double apart(const scene *a, const scene *b, int l)
{
	double most = 0;
	for (int c = 0; c < 3; c++)
		most = fmax(most, fabs(b->u[row_a(l)][c] - a->u[row_a(l)][c]));
	return most;
}

// A box that rattles on an edge, nearly at rest, from a run of a million boxes. Its ellipsoid exceeds the limit of the
// force, so that the sliding force does not follow the load as the ellipsoid alone would have it.
static void test_force_at_its_limit(void)
{
	static const double inverse[6] = { .040403251748610529, -.0099510494517476584,   3.7450526271528756e-07,
					   .059997943849608472, -4.9727424251665827e-07, .040360129283318384 };
	static const double arm[OB_POINTS][2] = { { -.069155428006979491, -.50636311227253827 },
						  { -.40935018371465048, .30596921627284246 },
						  { .40934364414442825, -.30597360514275351 },
						  { .069148888436757261, .50635872340262722 } };
	static const double bias[OB_POINTS] = { .011579746907442507, .015095880564672821, .0023206997514202215,
						.0026902505503597122 };
	static const double load[OB_POINTS] = { 5.8832085935531122, 0, .31114343041718151, 0 };
	static const ob_vec3 force = { -.58905568266977326, 3.0477553358114684, 0 };
	static const double before[6] = { -.0013413487793549025, -.025207476025070785, .0044274026536828565,
					  .12397240888733152,    -.054239756445136116, .024775036797584912 };
	static const double after[6] = { -.0034111718110554296, -.014498277600127967,  .0057556081088360831,
					 .033508857190590317,   -.0053170923982743673, .0044743004770791892 };
	scene s = { 0 };
	pair *p = &s.p[0];
	*p = (pair){ .b = fixed_body(), .normal = { 0, 0, 1 }, .mu = .5, .points = OB_POINTS };
	p->a = (body){ .mass = 1 / .0035137985976461204, .inv_mass = .0035137985976461204 };
	memcpy(p->a.inv_inertia, inverse, sizeof inverse);
	for (int j = 0; j < OB_POINTS; j++)
		p->arm_a[j] = p->arm_b[j] = ob_v3(arm[j][0], arm[j][1], -.3114597);
	ob_batch_init(&s.batch, OB_KIND_FULL);
	put(&s, 0);
	ob_batch_prepare(&s.batch);
	s.batch.isolated = s.batch.hit = s.batch.live;
	for (int j = 0; j < OB_POINTS; j++) {
		lanes_put(&s.batch.impulse[j], 0, load[j]);
		lanes_put(&s.batch.bias[j], 0, bias[j]);
	}
	for (int c = 0; c < 3; c++) {
		s.batch.impulse[4][0] += s.batch.t1[c][0] * (&force.x)[c];
		s.batch.impulse[5][0] += s.batch.t2[c][0] * (&force.x)[c];
	}
	s.batch.impulse[6][0] = -.50295319326250798;
	memcpy(s.v[row_a(0)], before, sizeof before);
	memcpy(s.u[row_a(0)], after, sizeof after);
	ob_solver_iteration iteration = iteration_on(&s, false);
	iteration.converged = 1e-12;
	ob_kernel_portable.solve_lone(&s.batch, 0, &iteration, s.u, s.v, s.d);
	CHECK(s.batch.solved);
	check_law(&s, 0);
}

// As test_batch.c's: speeds whose squares are no numbers.
static void test_small_numbers(void)
{
	enum { SCENES = 2000 };
	uint64_t seed = 2;
	for (int i = 0; i < SCENES; i++) {
		scene s;
		const int l = random_lone(&s, &seed);
		const double share = pow(10, within(&seed, -324, -100));
		for (int c = 0; c < 6; c++) {
			s.v[row_a(l)][c] *= share, s.u[row_a(l)][c] *= share, s.dv[row_a(l)][c] *= share;
		}
		memset(s.p[l].gap, 0, sizeof s.p[l].gap);
		put(&s, l);
		ob_batch_prepare(&s.batch);
		const ob_solver_iteration iteration = iteration_on(&s, true);
		ob_kernel_portable.solve_lone(&s.batch, l, &iteration, s.u, s.v, s.d);
		for (int k = 0; k < OB_ROWS; k++)
			CHECK(fabs(s.batch.impulse[k][l]) <= 1e3);
		for (int c = 0; c < 6; c++)
			CHECK(fabs(s.u[row_a(l)][c]) <= 1e3);
	}
}

int main(void)
{
	test_small_numbers();
	test_force_at_its_limit();
	enum { SCENES = 20000 };
	uint64_t seed = 1;
	int slid = 0, held = 0, unsolved = 0, elsewhere = 0, near = 0;
	for (int i = 0; i < SCENES; i++) {
		scene a, b, c;
		const int l = random_lone(&a, &seed);
		memcpy(&b, &a, sizeof b); // padding included
		memcpy(&c, &a, sizeof c);
		const ob_solver_iteration iteration = iteration_on(&a, true);
		ob_kernel_portable.solve(&a.batch, &iteration, a.u, a.v, a.d, a.delta);
		ob_batch_solve(&b.batch, &iteration, b.u, b.v, b.d, b.delta);
		ob_kernel_portable.solve_lone(&c.batch, l, &iteration, c.u, c.v, c.d);
		CHECK(memcmp(&b.batch, &c.batch, sizeof b.batch) == 0);
		CHECK(memcmp(b.u, c.u, sizeof b.u) == 0);
		if (b.batch.solved)
			check_law(&b, l);
		else
			unsolved++;
		const bool loaded = carries(&b.batch, l);
		slid += loaded && b.batch.slides;
		held += loaded && !b.batch.slides;
		if (!a.batch.solved || !b.batch.solved)
			continue;
		elsewhere += apart(&a, &b, l) > .01; // a lever that jams has several solutions
		near += apart(&a, &b, l) < 1e-6;
	}
	CHECK(slid > SCENES / 4);
	CHECK(held > SCENES / 100);
	CHECK(unsolved < SCENES / 50);
	CHECK(elsewhere < SCENES / 1000);
	CHECK(near > SCENES * 9 / 10);
	return check_end();
}
