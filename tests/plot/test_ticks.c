#include <string.h>

#include "../check.h"
#include "plot/frame.h"

// All labels of an axis, in order, with ^ before an exponent.
static const char *labels(const ob_ticks *t)
{
	static char all[1000];
	size_t used = 0;
	all[0] = 0;
	for (size_t i = 0; i < t->count; i++)
		if (t->tick[i].major)
			used += (size_t)snprintf(all + used, sizeof all - used, "%s%s%s%s", used ? " " : "",
						 t->tick[i].text, *t->tick[i].super ? "^" : "", t->tick[i].super);
	return all;
}

static void check(ob_plot_scale scale, double from, double to, int wanted, bool fixed, const char *expected)
{
	ob_ticks t;
	ob_ticks_choose(&t, scale, from, to, wanted, fixed);
	CHECK(!strcmp(labels(&t), expected));
	if (strcmp(labels(&t), expected))
		fprintf(stderr, "\t%g .. %g: %s\n", from, to, labels(&t));
}

static void check_labels(void)
{
	check(OB_SCALE_LINEAR, 0, 10, 5, false, "0 2 4 6 8 10");
	check(OB_SCALE_LINEAR, 0, 6.3, 5, false, "0 2 4 6 8");
	check(OB_SCALE_LINEAR, -.31, .5, 4, false, "\u22120.5 0 0.5");
	check(OB_SCALE_LINEAR, 0, 4e-6, 4, false,
	      "0 1\u00d710^\u22126 2\u00d710^\u22126 3\u00d710^\u22126 4\u00d710^\u22126");
	check(OB_SCALE_LINEAR, 3e6, 3e6, 3, true, "2\u00d710^6 3\u00d710^6 4\u00d710^6");
	check(OB_SCALE_LOG, .004, 700, 8, false, "0.01 0.1 1 10 100 1000");
	check(OB_SCALE_LOG, 2, 40, 8, false, "2 5 10 20");
	check(OB_SCALE_LOG, 1e-17, 1e3, 8, false, "10^\u221215 10^\u221212 10^\u22129 10^\u22126 10^\u22123 10^0 10^3");
	check(OB_SCALE_LOG, 1e-300, 1e300, 8, false,
	      "10^\u2212300 10^\u2212200 10^\u2212100 10^0 10^100 10^200 10^300");
	check(OB_SCALE_LOG, 1, 1, 8, false, "0.5 1 2");
	check(OB_SCALE_LOG, 1, 1.5, 5, true, "1.0 1.1 1.2 1.3 1.4 1.5");
	check(OB_SCALE_LOG2, 1, 32, 8, false, "1 2 4 8 16 32");
	check(OB_SCALE_LOG2, .25, 1, 8, false, "0.25 0.5 1");
}

// Any range: at least two labels, all on the axis, in order, at their values.
static void check_ranges(void)
{
	int few = 0, astray = 0, disordered = 0;
	for (int scale = OB_SCALE_LINEAR; scale <= OB_SCALE_LOG2; scale++) {
		for (int i = 0; i < 4000; i++) {
			double from = pow(10, (i * 7919 % 600) - 300), to = from * pow(10, pow(10, i % 9 - 6));
			ob_ticks t;
			ob_ticks_choose(&t, (ob_plot_scale)scale, from, fmin(to, 1e300), 2 + i % 9, false);
			int majors = 0;
			for (size_t j = 0; j < t.count; j++) {
				majors += t.tick[j].major;
				astray += !(t.tick[j].at >= 0 && t.tick[j].at <= 1);
				disordered += j && t.tick[j].at <= t.tick[j - 1].at;
			}
			few += majors < 2;
			if (majors < 2)
				fprintf(stderr, "scale %d: %g .. %g: %s\n", scale, from, to, labels(&t));
			double along = ob_ticks_along(&t, from);
			astray += !(along >= -1e-9 && along <= 1 + 1e-9);
		}
	}
	CHECK(few == 0);
	CHECK(astray == 0);
	CHECK(disordered == 0);
}

int main(void)
{
	check_labels();
	check_ranges();
	return check_end();
}
