// Recommendations of a comparison of lockstep with free simulators from made-up runs: each must follow from the figures, and
// change with them. Slopes of made-up errors.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "compare/sync.h"

enum { SEEDS = 6 };
static const double size = .5, speed = 4;

// Penetration, m, of free simulators: so much without an injected lag, and as a power of the lag beyond.
typedef struct made {
	double base, order, cost; // cost: over lockstep's
	double gains_from; // s: injected lag from which energy is gained
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
	for (int w = 0; w < OB_SYNC_CONFIGURATIONS; w++)
		for (uint64_t seed = 0; seed < SEEDS; seed++) {
			const ob_sync_configuration *of = &ob_sync_table[w];
			const double lag = of->delay + 1e-4, worst = m.base * pow(lag / 1e-4, m.order),
				     noise = 1 + 1e-3 * (double)seed;
			if (of->coupling == OB_SYNC_LOCKSTEP)
				add(c, w, seed, 1e-3, 1e-3 * noise, NAN, 0);
			else
				add(c, w, seed, worst * (of->coupling == OB_SYNC_LEDGER ? 1 : 2), 1e-3 * m.cost * noise,
				    lag, of->delay >= m.gains_from ? .5 : 0);
		}
	return c;
}

static void expect(made m, const char *const *words)
{
	char text[2048];
	ob_sync_comparison *c = make(m);
	ob_sync_recommend(c, c->point, text, sizeof text);
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
	expect((made){ 5e-3, .5, 3, .03 }, (const char *[]){ "run in lockstep, unless", "ledger", "5 mm",
							     "3 times the CPU", "injected lag of 30 ms on", NULL });
	expect((made){ 5e-3, .5, .5, 1 }, (const char *[]){ "choose by need", "No lag that was tried", NULL });
	expect((made){ 5e-4, .1, .5, 1 }, (const char *[]){ "costs nothing here", NULL });
	expect((made){ 5e-4, .1, 2, 1 }, (const char *[]){ "as accurate", "pay the CPU", NULL });
	expect((made){ .2, .1, 2, 1 }, (const char *[]){ "Even without an injected lag", NULL });
	// 10 % of the size are 50 mm: with order 1 from 5 mm at .1 ms on, 1 ms is the first lag beyond
	expect((made){ 5e-3, 1, 3, 1 }, (const char *[]){ "latency of 0.1 ms", NULL });
	expect((made){ NAN, 1, 3, 1 }, (const char *[]){ "Too little was measured", NULL });
}

static void test_orders(void)
{
	for (double order = .5; order <= 2; order += .5) {
		ob_sync_comparison *c = make((made){ 1e-5, order, 3, 1 });
		const ob_line line = ob_sync_order(c, c->point, OB_SYNC_LEDGER);
		CHECK_NEAR(line.slope, order, 1e-9);
		CHECK(line.n == 5 && line.slope_low <= order + 1e-9 && line.slope_high >= order - 1e-9);
		const ob_statistics s = ob_sync_summarise(c, c->point, 0, OB_SYNC_CPU);
		CHECK(s.n == SEEDS && s.median_low >= 1e-3 && s.median_high > s.median);
		ob_sync_finish(c);
		free(c);
	}
}

int main(void)
{
	test_recommendations();
	test_orders();
	return check_end();
}
