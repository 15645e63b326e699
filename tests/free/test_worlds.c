// Random worlds of free simulators, some of which are stopped for a while, die, come and go: all come to the end. The momentum
// of those that no force acts on stays, with the mail that is under way. Without a lag no world gains energy.
#include "hand.h"
#include "free/ledger.h"

#include <math.h>
#include <stdlib.h>

#include "../check.h"

#include "base/random.h"

static const ob_vec3 none = { 0, 0, 0 };
static const double g = 9.81;
static double worst_momentum, worst_energy;

// Sums of a world at one boundary; each body is counted as if it had all mail that is under way to it.
typedef struct sums {
	ob_vec3 momentum; // N s
	double size; // N s: sum of magnitudes
	double energy; // J
} sums;

// Adds what a depositor has sent to a partner, and that has not consumed.
static void add_mail(const hand *h, uint32_t from, const ob_account *a, uint32_t to, const ob_ledger *theirs,
		     double mail[6])
{
	uint32_t generation;
	if (a->partner != to || from > to || ob_free_kind_of(h->u, to, &generation) != OB_FREE_SIMULATED ||
	    a->generation != generation)
		return;
	for (int i = 0; i < 6; i++)
		mail[i] += a->sum[i];
	for (uint32_t k = 0; k < theirs->head.accounts; k++)
		if (theirs->account[k].partner == from && theirs->account[k].epoch == a->epoch)
			for (int i = 0; i < 6; i++)
				mail[i] -= theirs->account[k].sum[i];
}

static double energy_of(const ob_passport *p, const ob_motion *m, ob_vec3 v, ob_vec3 w, double gravity)
{
	const ob_mat3 r = ob_quat_matrix(m->q);
	const ob_vec3 l = ob_rotate_back(&r, w);
	return .5 * p->mass * ob_norm2(v) +
	       .5 * (l.x * l.x * p->inertia.x + l.y * l.y * p->inertia.y + l.z * l.z * p->inertia.z) +
	       p->mass * gravity * m->p.z;
}

static sums sum_up(const hand *h, double gravity)
{
	sums s = { .size = 0 };
	for (uint32_t id = 0; id < h->objects; id++) {
		ob_motion m, other;
		ob_ledger own, theirs;
		ob_passport p;
		double mail[6] = { 0 };
		if (ob_free_kind_of(h->u, id, NULL) != OB_FREE_SIMULATED || !ob_universe_get_passport(h->u, id, &p) ||
		    !ob_free_read_ledger(h->u, id, &m, &own))
			continue;
		for (uint32_t from = 0; from < id; from++)
			if (ob_free_kind_of(h->u, from, NULL) == OB_FREE_SIMULATED &&
			    ob_free_read_ledger(h->u, from, &other, &theirs))
				for (uint32_t i = 0; i < theirs.head.accounts; i++)
					add_mail(h, from, &theirs.account[i], id, &own, mail);
		const ob_vec3 impulse = ob_v3(mail[0], mail[1], mail[2]), v = ob_madd(m.v, 1 / p.mass, impulse),
			      w = ob_add(m.w, ob_ledger_rate(&p, m.q, ob_v3(mail[3], mail[4], mail[5])));
		s.momentum = ob_madd(s.momentum, p.mass, v);
		s.size += p.mass * ob_norm(m.v) + ob_norm(impulse);
		s.energy += energy_of(&p, &m, v, w, gravity);
	}
	return s;
}

static void add_body(hand *h, uint64_t *random, ob_vec3 at, ob_vec3 velocity, double restitution)
{
	const double mass = .5 + ob_splitmix_real(random);
	hand_add(h, ob_splitmix(random) % 2 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE, ob_v3(.2, .2, .2), mass, at, velocity,
		 restitution);
}

// Changes that the host makes while all wait: one comes from outside, one goes.
static void come_and_go(hand *h, uint64_t *random, double radius)
{
	if (ob_splitmix(random) % 2) {
		const uint32_t id = (uint32_t)(ob_splitmix(random) % h->objects);
		if (ob_free_kind_of(h->u, id, NULL) == OB_FREE_SIMULATED)
			hand_remove(h, id);
	}
	if (ob_splitmix(random) % 2) {
		const double angle = 2 * M_PI * ob_splitmix_real(random);
		const ob_vec3 way = ob_v3(cos(angle), sin(angle), 0);
		add_body(h, random, ob_add(ob_scale(way, radius), ob_v3(0, 0, 1)), ob_scale(way, -3), 0);
	}
}

// Runs a world of a seed. lags: simulators step in random orders, are stopped and killed; else the earliest steps first.
static void run_world(uint64_t seed, bool lags)
{
	uint64_t random = seed;
	const double bounds[] = { INFINITY, .0005, .002, .02 };
	ob_free_settings f = { .update_rate = 200 + 800 * ob_splitmix_real(&random),
			       .max_lag = lags ? bounds[ob_splitmix(&random) % 4] : .002,
			       .end = INFINITY,
			       .seed = 1 + seed,
			       .coupling = OB_COUPLING_LEDGER };
	f.jitter = .5 * ob_splitmix_real(&random);
	f.delay = lags && seed % 5 == 0 ? .01 * ob_splitmix_real(&random) : 0;
	const double gravity = seed % 2 ? g : 0, kills = lags ? .02 : 0, stops = lags ? .01 : 0;
	hand *h = hand_create(f, ob_v3(0, 0, -gravity));
	if (gravity > 0)
		hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t n = 3 + (uint32_t)(ob_splitmix(&random) % 7);
	for (uint32_t i = 0; i < n; i++) {
		const ob_vec3 at = ob_v3(.45 * (i % 2), .45 * (i / 2 % 2), .45 * (i / 4));
		add_body(h, &random, ob_add(ob_add(at, ob_v3(0, 0, .4)), ob_splitmix_vector(&random, .02)),
			 ob_add(ob_scale(at, -2), ob_splitmix_vector(&random, 2)), i % 4 ? 0 : .6);
	}
	hand_until(h, 3);
	sums begin = sum_up(h, gravity);
	double allowed = begin.energy;
	for (uint64_t step = 3; step <= 24; step += 3) {
		CHECK(lags ? hand_run_with_stops(h, &random, kills, stops) : hand_run_in_order(h));
		CHECK(ob_free_complete(h->u, step) == step);
		const sums now = sum_up(h, gravity);
		const double error = ob_norm(ob_sub(now.momentum, begin.momentum)) / (now.size + begin.size + 1e-3),
			     gain = now.energy / allowed - 1;
		if (gravity == 0)
			worst_momentum = ob_max(worst_momentum, error);
		if (!lags)
			worst_energy = ob_max(worst_energy, gain);
		if ((gravity == 0 && error > 1e-12) || (!lags && gain > 1e-9))
			printf("seed %llu, step %llu: momentum off by %.3g, energy gained %.3g\n",
			       (unsigned long long)seed, (unsigned long long)step, error, gain);
		CHECK(gravity > 0 || error < 1e-12);
		CHECK(lags || gain < 1e-9);
		come_and_go(h, &random, 1.5 + .3 * (double)step);
		hand_until(h, step + 3);
		begin = sum_up(h, gravity);
		allowed += begin.energy - now.energy;
	}
	hand_destroy(h);
}

// Arguments: the number of worlds, or the first seed and the number of worlds.
int main(int argc, char **argv)
{
	const uint64_t worlds = argc > 1 ? strtoull(argv[argc - 1], NULL, 10) : 20,
		       first = argc > 2 ? strtoull(argv[1], NULL, 10) : 1;
	for (uint64_t seed = first; seed < first + worlds; seed++) {
		run_world(seed, true);
		run_world(seed, false);
	}
	printf("%llu worlds from seed %llu on: worst error of momentum %.2g, largest gain of energy %.2g\n",
	       (unsigned long long)worlds, (unsigned long long)first, worst_momentum, worst_energy);
	return check_end();
}
