// Recommendations and answers of a comparison of lockstep with free simulators from made-up runs: each must follow from the
// figures and their intervals, and change with them. Slopes of made-up errors.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "base/random.h"
#include "compare/sync.h"

enum { SEEDS = 6 };
static const double size = .5, speed = 4;

// Penetration, m, of free simulators: so much without an injected lag, and as a power of the lag beyond.
typedef struct made {
	double base, order, cost; // cost: over lockstep's
	double gains_from; // s: injected lag from which energy is gained
	double scatter; // share by which seeds differ
	double order_late; // from 10 ms on, less `order`
	double group, group_cost; // m; over lockstep's: groups in every form; 0 m: as lockstep
} made;

static void add(ob_sync_comparison *c, int w, uint64_t seed, double worst, double cpu, double latency, double gain)
{
	ob_record r = { .seed = seed };
	for (int i = 0; i < OB_METRICS; i++)
		r.metric[i] = NAN;
	snprintf(r.of, sizeof r.of, "%s", c->point->key);
	snprintf(r.configuration, sizeof r.configuration, "%s", ob_sync_table[w].key);
	r.metric[OB_SYNC_CPU] = cpu;
	r.metric[OB_SYNC_WORST] = worst;
	r.metric[OB_SYNC_SIZES] = worst / size;
	r.metric[OB_SYNC_LATENCY] = latency;
	r.metric[OB_SYNC_LAG] = latency * speed / size;
	r.metric[OB_SYNC_ENERGY] = gain;
	CHECK(ob_records_add(&c->records, &r));
}

static ob_sync_comparison *make(made m)
{
	ob_sync_comparison *c = calloc(1, sizeof *c);
	*c = (ob_sync_comparison){ .scene = "heap.lua", .seeds = SEEDS, .points = 1, .duration = 2, .rate = 1000 };
	c->point[0] = (ob_sync_point){ .key = "heap", .objects = 100, .size = size, .mass = 1, .speed = speed };
	uint64_t random = 1;
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
		for (uint64_t seed = 0; seed < SEEDS; seed++) {
			const ob_sync_configuration *of = &ob_sync_table[w];
			const bool gains = of->delay >= m.gains_from;
			const double lag = of->delay + 1e-4, noise = 1 + 1e-3 * (double)seed,
				     scatter = exp(ob_splitmix_within(&random, -m.scatter, m.scatter)),
				     late = pow(fmax(1, lag / .0101), m.order_late),
				     worst = m.base * pow(lag / 1e-4, m.order) * late * scatter;
			if (of->coupling == OB_SYNC_LOCKSTEP)
				add(c, w, seed, 1e-3, 1e-3 * noise, NAN, 0);
			else if (of->coupling == OB_SYNC_GROUP)
				add(c, w, seed, m.group != 0 ? m.group * scatter : 1e-3, 1e-3 * m.group_cost * noise,
				    NAN, 0);
			else
				add(c, w, seed, worst, 1e-3 * m.cost * noise, lag, gains ? .5 * noise : 0);
		}
	return c;
}

// hypothesis: -1 for the recommendation.
static void expect(int hypothesis, made m, const char *const *words)
{
	ob_sync_comparison *c = make(m);
	const ob_sync_text t = hypothesis < 0 ? ob_sync_recommend(c, c->point) : ob_sync_judge(c, hypothesis);
	const char *text = t.words;
	for (; *words; words++) {
		if (!strstr(text, *words)) {
			printf("\"%s\" is not in \"%s\"\n", *words, text);
			CHECK(false);
		}
	}
	ob_sync_finish(c);
	free(c);
}

static void test_recommendations(void)
{
	// groups as deep as lockstep, and own responses that are not
	expect(-1, (made){ .base = 5e-3, .order = .5, .cost = 3, .gains_from = .03, .group_cost = 1.5 },
	       (const char *[]){ "pay the CPU", "(group, 2 threads)", "by 1 (1 to 1) mm",
				 "1.5 (1.5 to 1.5) times the CPU", "injected lag of 30 ms on", NULL });
	expect(-1, (made){ .base = 5e-4, .order = .5, .cost = 3, .gains_from = 1, .group_cost = 1.5 },
	       (const char *[]){ "(own, 2 threads)", "No injected lag made", NULL });
	expect(-1, (made){ .base = 5e-3, .order = .1, .cost = 3, .gains_from = 1, .group = 2e-3, .group_cost = 3 },
	       (const char *[]){ "run in lockstep, unless", "by 2 (2 to 2) mm", NULL });
	expect(-1, (made){ .base = 5e-3, .order = .1, .cost = 3, .gains_from = 1, .group = 2e-3, .group_cost = .5 },
	       (const char *[]){ "choose by need", NULL });
	expect(-1, (made){ .base = 5e-3, .order = .1, .cost = 3, .gains_from = 1, .group_cost = .5 },
	       (const char *[]){ "costs nothing here", NULL });
	expect(-1, (made){ .base = .2, .order = .1, .cost = 2, .gains_from = 1, .group_cost = 1 },
	       (const char *[]){ "Even without an injected lag", NULL });
	// 10 % of the size are 50 mm: with order 1 from 5 mm at .1 ms on, 1 ms is the first lag beyond
	expect(-1, (made){ .base = 5e-3, .order = 1, .cost = 3, .gains_from = 1, .group_cost = 1 },
	       (const char *[]){ "latency of 0.1 ms", NULL });
	expect(-1, (made){ .base = NAN, .order = 1, .cost = 3, .gains_from = 1, .group = NAN },
	       (const char *[]){ "Too little was measured", NULL });
	// seeds that differ by a factor of five around lockstep's error decide nothing
	expect(-1,
	       (made){ .base = 1,
		       .order = .1,
		       .cost = 3,
		       .gains_from = 1,
		       .group = 1.1e-3,
		       .group_cost = 3,
		       .scatter = .8 },
	       (const char *[]){ "not shown to be less accurate", NULL });
}

static void test_hypotheses(void)
{
	expect(0, (made){ .base = 1e-5, .order = 1, .cost = 3, .gains_from = 1, .scatter = .01 },
	       (const char *[]){ "Not contradicted.", "Powers", "describes it", NULL });
	expect(0, (made){ .base = 1e-5, .order = 1, .cost = 3, .gains_from = 1, .scatter = .01, .order_late = -.5 },
	       (const char *[]){ "Contradicted.", "no fixed power", NULL });
	expect(0, (made){ .base = 1e-3, .order = 0, .cost = 3, .gains_from = 1, .scatter = .5 },
	       (const char *[]){ "Undecided.", "no power is excluded", NULL });
	expect(1, (made){ .base = 5e-3, .order = 1, .cost = 3, .group_cost = 1 },
	       (const char *[]){ "Not contradicted.", "1 (1 to 1) (group, process each)", "5 (5 to 5) (own, 2 threads)",
				 NULL });
	expect(1, (made){ .base = 5e-3, .order = 1, .cost = 3, .group = 1.3e-3, .group_cost = 1 },
	       (const char *[]){ "Contradicted.", NULL });
	expect(1, (made){ .base = 1.1e-3, .order = 1, .cost = 3, .group_cost = 1 },
	       (const char *[]){ "Contradicted.", NULL });
	expect(1, (made){ .base = 5e-3, .order = 1, .cost = 3, .group = .9e-3, .group_cost = 1, .scatter = .8 },
	       (const char *[]){ "Undecided.", NULL });
	expect(2, (made){ .base = 5e-3, .order = 1, .cost = 3, .group_cost = 1.9 },
	       (const char *[]){ "Not contradicted.", "1.9 (1.9 to 1.9) (group, thread each)", NULL });
	expect(2, (made){ .base = 5e-3, .order = 1, .cost = 3, .group_cost = 2.1 },
	       (const char *[]){ "Contradicted.", NULL });
}

static void test_orders(void)
{
	for (double order = .5; order <= 2; order += .5) {
		ob_sync_comparison *c = make((made){ .base = 1e-5, .order = order, .cost = 3, .gains_from = 1 });
		const ob_line line = ob_sync_order(c, c->point, OB_SYNC_OWN);
		CHECK_NEAR(line.slope, order, 1e-9);
		CHECK(line.n == 5 && line.slope_low <= order + 1e-9 && line.slope_high >= order - 1e-9);
		const ob_estimate s = ob_sync_estimate(c, c->point, 0, OB_SYNC_CPU);
		CHECK(s.n == SEEDS && s.low >= 1e-3 && s.high > s.value && s.value > s.low);
		ob_sync_finish(c);
		free(c);
	}
}

int main(void)
{
	test_recommendations();
	test_hypotheses();
	test_orders();
	return check_end();
}
