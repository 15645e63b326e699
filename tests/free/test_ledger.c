// Momentum of a ledger: it stays to rounding, with the mail that is under way, for any lags, jitter, orders and kills. And a
// pair's hit is computed once, however late the other is.
#include "hand.h"

#include <math.h>

#include "../check.h"

#include "base/random.h"

static const ob_vec3 none = { 0, 0, 0 };

static ob_free_settings settings(double rate, double lag)
{
	return (ob_free_settings){
		.update_rate = rate, .max_lag = lag, .end = INFINITY, .seed = 1, .coupling = OB_COUPLING_LEDGER
	};
}

// Impulse, N s, that an account has deposited and its partner has not consumed.
static ob_vec3 under_way(const hand *h, uint32_t id, const ob_account *a)
{
	ob_motion m;
	ob_ledger theirs;
	ob_vec3 sum = ob_v3(a->sum[0], a->sum[1], a->sum[2]);
	ob_free_read_ledger(h->u, a->partner, &m, &theirs);
	for (uint32_t i = 0; i < theirs.head.accounts; i++) {
		const ob_account *c = &theirs.account[i];
		if (c->partner == id && c->epoch == a->epoch)
			sum = ob_sub(sum, ob_v3(c->sum[0], c->sum[1], c->sum[2]));
	}
	return sum;
}

// Momentum, N s, of all, with the mail under way. size: sum of magnitudes. Bodies may be at different times, as no force
// acts from outside.
static ob_vec3 momentum(const hand *h, double *size)
{
	ob_vec3 sum = none;
	*size = 0;
	for (uint32_t id = 0; id < h->objects; id++) {
		ob_motion m;
		ob_ledger l;
		ob_passport p;
		ob_universe_get_passport(h->u, id, &p);
		if (!ob_free_read_ledger(h->u, id, &m, &l))
			continue;
		sum = ob_madd(sum, p.mass, m.v);
		*size += p.mass * ob_norm(m.v);
		for (uint32_t i = 0; i < l.head.accounts; i++) {
			if (l.account[i].partner < id)
				continue;
			const ob_vec3 way = under_way(h, id, &l.account[i]);
			sum = ob_add(sum, way);
			*size += ob_norm(way);
		}
	}
	return sum;
}

// Random bodies that fly into each other and stay in touch for a while. mass_first: numbers are drawn in another order, so
// it is another world.
static hand *cloud(uint64_t *random, ob_free_settings f, bool mass_first)
{
	hand *h = hand_create(f, none);
	const uint32_t n = 3 + (uint32_t)(ob_splitmix(random) % 6);
	for (uint32_t i = 0; i < n; i++) {
		const ob_vec3 at = ob_v3(.45 * (i % 2), .45 * (i / 2 % 2), .45 * (i / 4));
		double mass = mass_first ? .5 + ob_splitmix_real(random) : 0;
		ob_vec3 place = mass_first ? ob_splitmix_vector(random, .02) : none;
		const ob_vec3 velocity = ob_splitmix_vector(random, 1);
		if (!mass_first) {
			place = ob_splitmix_vector(random, .02);
			mass = .5 + ob_splitmix_real(random);
		}
		hand_add(h, i % 3 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE, ob_v3(.2, .2, .2), mass, ob_add(at, place),
			 ob_add(ob_scale(at, -2), velocity), i % 4 ? 0 : .6);
	}
	return h;
}

static double worst;

static void check_momentum(const hand *h, ob_vec3 begin)
{
	double size;
	const double error = ob_norm(ob_sub(momentum(h, &size), begin)) / (size + 1e-3);
	worst = ob_max(worst, error);
	CHECK(error < 1e-12);
}

// Steps a random world, and compares its momentum at some boundaries. Returns the number of solved islands.
static uint64_t run_world(uint64_t seed, bool mass_first)
{
	uint64_t random = seed, solved = 0;
	ob_free_settings f =
		settings(200 + 800 * ob_splitmix_real(&random), seed % 4 ? .02 * ob_splitmix_real(&random) : INFINITY);
	f.jitter = .5 * ob_splitmix_real(&random);
	f.delay = seed % 5 ? 0 : .01 * ob_splitmix_real(&random);
	hand *h = cloud(&random, f, mass_first);
	double size;
	ob_vec3 begin = none;
	for (uint64_t step = 3; step <= 30; step += 3) {
		hand_until(h, step);
		if (step == 3)
			begin = momentum(h, &size);
		CHECK(hand_run(h, &random, .1));
		check_momentum(h, begin);
	}
	for (uint32_t id = 0; id < h->objects; id++)
		solved += h->sim[id].counts.solved;
	hand_destroy(h);
	return solved;
}

static void test_momentum(void)
{
	uint64_t solved = 0;
	for (uint64_t seed = 1; seed <= 30; seed++)
		solved += run_world(seed, false) + run_world(seed, true);
	CHECK(solved > 1000);
	run_world(120, false); // bodies that touch and part within a step
	run_world(413, false); // a hit that ends the load of one whose other side was just hit
	run_world(585, false);
	printf("worst error of momentum: %.2g\n", worst);
}

// An elastic hit of equal balls: they exchange their velocities, though the second is stepped long afterwards.
static void test_hit_once(void)
{
	hand *h = hand_create(settings(1000, INFINITY), none);
	const uint32_t a = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 0), ob_v3(1, 0, 0), 1),
		       b = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(1.05, 0, 0), none, 1);
	hand_until(h, 12);
	while (hand_step(h, a))
		;
	CHECK_NEAR(h->sim[a].motion.v.x, 0, 1e-9);
	CHECK_NEAR(h->sim[b].motion.v.x, 0, 1e-9);
	while (hand_step(h, b))
		;
	CHECK_NEAR(h->sim[b].motion.v.x, 1, 1e-9);
	CHECK_NEAR(h->sim[a].motion.v.x, 0, 1e-9);
	hand_until(h, 18);
	uint64_t random = 1;
	CHECK(hand_run(h, &random, 0));
	CHECK(h->sim[a].ledger.head.accounts == 0 &&
	      h->sim[b].ledger.head.accounts == 0); // settled, and dropped by both
	hand_destroy(h);
}

// A stack stands, its load mailed from box to box, while simulators begin anew at random.
static void test_stack(void)
{
	enum { BOXES = 5 };
	ob_free_settings f = settings(1000, .002);
	f.jitter = .3;
	hand *h = hand_create(f, ob_v3(0, 0, -9.81));
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	for (int i = 0; i < BOXES; i++)
		hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), 1000, ob_v3(0, 0, i + .5), none, 0);
	uint64_t random = 5;
	for (uint64_t step = 10; step <= 60; step += 10) {
		hand_until(h, step);
		CHECK(hand_run(h, &random, .001));
		for (uint32_t id = 1; id <= BOXES; id++)
			CHECK_NEAR(h->sim[id].motion.p.z, id - .5, 2e-3);
	}
	hand_destroy(h);
}

// Load, over the weight, that is to last after the first step of contact of a box with one that comes down on it at a speed (m/s).
static double first_load(double speed)
{
	static const double mass = 1000, gravity = 9.81;
	hand *h = hand_create(settings(1000, .002), ob_v3(0, 0, -gravity));
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t lower = hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), mass, ob_v3(0, 0, .5), none, 0),
		       upper = hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), mass, ob_v3(0, 0, 1.5), ob_v3(0, 0, -speed),
					0);
	hand_until(h, 1);
	CHECK(hand_step(h, lower) && h->sim[lower].ledger.head.accounts == 1);
	const ob_account *a = &h->sim[lower].ledger.account[0];
	CHECK(a->partner == upper && a->sum[2] >= 1e-3 * mass * (gravity + speed) * .99);
	const double load = a->rate[2] / (mass * gravity);
	hand_destroy(h);
	return load;
}

// The weight of the upper box lasts from the first step on, and a hit adds nothing to it.
static void test_first_load(void)
{
	CHECK_NEAR(first_load(0), 1, 1e-5);
	CHECK_NEAR(first_load(1), 1, 1e-5);
}

// A pyramid stays where it is set down: its boxes lie on two each, and all that bear a box share what they correct.
static void test_pyramid_stays(void)
{
	enum { ROWS = 4 };
	hand *h = hand_create(settings(1000, .002), ob_v3(0, 0, -9.81));
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	double x[HAND_OBJECTS] = { 0 }, aside = 0;
	for (int row = 0; row < ROWS; row++)
		for (int i = 0; i < ROWS - row; i++) {
			x[h->objects] = 1.05 * (i - .5 * (ROWS - row - 1));
			hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), 1000, ob_v3(x[h->objects], 0, row + .5), none, 0);
		}
	uint64_t random = 1;
	for (uint64_t step = 6; step <= 60; step += 6) {
		hand_until(h, step);
		CHECK(hand_run(h, &random, 0));
	}
	for (uint32_t id = 1; id < h->objects; id++)
		aside = ob_max(aside, fabs(h->sim[id].motion.p.x - x[id]));
	printf("farthest that a box of a pyramid got aside in a second: %.2g mm\n", 1e3 * aside);
	CHECK(aside < 1e-3);
	hand_destroy(h);
}

// A stack whose mail is late: loads go on no longer than they have lasted, or they would swing up until it explodes.
static void test_stack_of_late_mail(void)
{
	enum { BOXES = 10 };
	ob_free_settings f = settings(1000, .002);
	f.jitter = .3;
	f.delay = .005;
	hand *h = hand_create(f, ob_v3(0, 0, -9.81));
	hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	for (int i = 0; i < BOXES; i++)
		hand_add(h, OB_SHAPE_BOX, ob_v3(.5, .5, .5), 1000, ob_v3(0, 0, i + .5), none, 0);
	uint64_t random = 5;
	double work = 0;
	for (uint64_t step = 6; step <= 90; step += 6) {
		hand_until(h, step);
		CHECK(hand_run(h, &random, 0));
		for (uint32_t id = 1; id <= BOXES; id++) {
			CHECK_NEAR(h->sim[id].motion.p.z, id - .5, 1); // it sinks, as impulses are late
			CHECK(ob_norm(h->sim[id].motion.v) < 5);
		}
	}
	for (uint32_t id = 1; id <= BOXES; id++)
		work += h->sim[id].counts.worked - h->sim[id].counts.work_seen;
	CHECK(work < 0); // J: late mail takes more than it adds
	hand_destroy(h);
}

// A column that lands: its load goes up at one box a step, and what presses on a box goes on meanwhile. Steps get shorter
// while boxes overlap, so that they overlap by little, however late each steps.
static void test_column_lands(void)
{
	enum { BOXES = 8 };
	static const double edge = .5, gap = .02, speed = 4; // m, m, m/s
	double worst_overlap = 0;
	for (uint64_t random = 1; random <= 4; random++) {
		ob_free_settings f = settings(1000, .002);
		f.jitter = .3;
		hand *h = hand_create(f, ob_v3(0, 0, -9.81));
		hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
		for (int i = 0; i < BOXES; i++)
			hand_add(h, OB_SHAPE_BOX, ob_v3(edge / 2, edge / 2, edge / 2), 125,
				 ob_v3(0, 0, edge / 2 + gap + i * (edge + gap)), ob_v3(0, 0, -speed), 0);
		uint64_t order = random;
		for (uint64_t step = 1; step <= 20; step++) {
			hand_until(h, step);
			CHECK(hand_run(h, &order, 0));
			CHECK(ob_free_complete(h->u, step) == step);
			for (uint32_t id = 1; id <= BOXES; id++) {
				ob_motion m, below = { .p.z = -edge / 2 };
				CHECK(ob_universe_get_motion(h->u, id, &m) &&
				      (id == 1 || ob_universe_get_motion(h->u, id - 1, &below)));
				worst_overlap = ob_max(worst_overlap, below.p.z + edge - m.p.z);
			}
		}
		hand_destroy(h);
	}
	CHECK(worst_overlap < .015 * edge);
	printf("deepest overlap in a column that lands: %.2g mm\n", 1e3 * worst_overlap);
}

// Work of mail is the same on both sides if nothing else has changed the partner's motion.
static void test_work_of_mail(void)
{
	hand *h = hand_create(settings(1000, INFINITY), none);
	const uint32_t a = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(0, 0, 0), ob_v3(1, 0, 0), 0),
		       b = hand_add(h, OB_SHAPE_SPHERE, ob_v3(.5, 0, 0), 1, ob_v3(1.02, 0, 0), none, 0);
	hand_until(h, 6);
	uint64_t random = 1;
	CHECK(hand_run(h, &random, 0));
	const ob_free_counts *sent = &h->sim[a].counts, *received = &h->sim[b].counts;
	CHECK_NEAR(sent->work_seen, .125, 1e-6); // J: half of the momentum, at half of its speed
	CHECK_NEAR(received->worked, sent->work_seen, 1e-6);
	hand_destroy(h);
}

int main(void)
{
	test_momentum();
	test_hit_once();
	test_stack();
	test_first_load();
	test_pyramid_stays();
	test_stack_of_late_mail();
	test_column_lands();
	test_work_of_mail();
	return check_end();
}
