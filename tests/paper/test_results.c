// Means, ratios and growth against figures computed by hand; the paper's own tables against its stated means.
#include "../check.h"
#include "made.h"

static void test_published(void)
{
	ob_paper_results p = ob_paper_published();
	CHECK(p.records.count == 45);
	// stated in the paper's text: .007 s, 234 fps, 50.28 %; .045 s, 153 fps, 52.33 %; .001 s, 239 fps, 20.94 %
	static const double said[3][3] = { { .007, 234, .5028 }, { .045, 153, .5233 }, { .001, 239, .2094 } };
	static const double digits[3] = { .0005, 1, .00006 };
	for (int s = 0; s < 3; s++) {
		CHECK_NEAR(ob_paper_summarise(&p, s, OB_PAPER_STEP).mean, said[s][0], digits[0]);
		CHECK_NEAR(ob_paper_summarise(&p, s, OB_PAPER_FPS).mean, said[s][1], digits[1]);
		CHECK_NEAR(ob_paper_summarise(&p, s, OB_PAPER_CPU).mean, said[s][2], digits[2]);
	}
	CHECK(ob_paper_summarise(&p, OB_PAPER_OBS_OBB, OB_PAPER_STEP).n == 0);
	ob_records_finish(&p.records);
}

static void test_ratio(void)
{
	ob_paper_results r = { .experiments = 3 };
	static const double of[2][3] = { { 2, 8, 4 }, { 1, 1, 1 } };
	for (int s = 0; s < 2; s++)
		for (uint32_t k = 0; k < 3; k++) {
			// pairs go by number, not by order
			ob_record x = made_record(s, false, r.objects, s ? 2 - k : k);
			x.metric[OB_PAPER_STEP] = of[s][k];
			ob_records_add(&r.records, &x);
		}
	ob_estimate q = ob_paper_compare(&r, 0, 1, OB_PAPER_STEP);
	CHECK(q.n == 3);
	CHECK_NEAR(q.value, 4, 1e-12); // (2 * 8 * 4)^(1/3)
	// logarithms ln 2, ln 8, ln 4: deviation ln 2; t(2) = 4.30265
	double half = 4.302653 * log(2) / sqrt(3);
	CHECK_NEAR(log(q.low), log(4) - half, 1e-5);
	CHECK_NEAR(log(q.high), log(4) + half, 1e-5);
	CHECK(isnan(ob_paper_compare(&r, 0, 1, OB_PAPER_FPS).value));
	ob_records_finish(&r.records);
}

static double square_root(double n)
{
	return .01 * sqrt(n);
}
static double line(double n)
{
	return .2 + .01 * n;
}
static double logarithm(double n)
{
	return .2 + .01 * log(n);
}

static void test_growth(void)
{
	ob_paper_results r = { .experiments = 0 };
	made_growth(&r, OB_PAPER_OBS, square_root);
	ob_paper_growth g = ob_paper_grow(&r, OB_PAPER_OBS, OB_PAPER_DEMAND);
	CHECK(g.power.n == MADE_SIZES * MADE_REPEATS);
	CHECK(g.power.slope_low < .5 && .5 < g.power.slope_high && g.power.slope_high - g.power.slope_low < .02);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_DEMAND, line);
	g = ob_paper_grow(&r, OB_PAPER_OBS, OB_PAPER_DEMAND);
	CHECK_NEAR(g.linear.slope, .01, .0005);
	CHECK(ob_paper_prefers(&g) == 1);
	made_set_growth(&r, OB_PAPER_OBS, OB_PAPER_DEMAND, logarithm);
	g = ob_paper_grow(&r, OB_PAPER_OBS, OB_PAPER_DEMAND);
	CHECK_NEAR(g.logarithmic.slope, .01, .002);
	CHECK(ob_paper_prefers(&g) == -1);
	g.linear.n = 4; // too few for a preference
	CHECK(ob_paper_prefers(&g) == 0);
	CHECK(ob_paper_grow(&r, OB_PAPER_COMMON, OB_PAPER_DEMAND).power.n == 0);
	ob_records_finish(&r.records);
}

int main(void)
{
	test_published();
	test_ratio();
	test_growth();
	return check_end();
}
