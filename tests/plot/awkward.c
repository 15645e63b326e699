#include "awkward.h"

#include <float.h>
#include <math.h>

static const char very_long[] =
	"A title that goes on and on, as titles do when every setting of a run has to be in them: step, substeps, "
	"rounds, "
	"coupling, workers, isolation, commit, machine; and then some more words, for good measure, until nobody would "
	"expect it to fit on any diagram whatsoever, which it does not, and so it ends where three lines of it have "
	"ended, "
	"Donaudampfschifffahrtselektrizitaetenhauptbetriebswerkbauunterbeamtengesellschaft, amen, amen, amen, amen, "
	"amen.";
static const char strange[] =
	"a < b & \"c\" > 'd' \t \x01 \xff\xfe \xc3 \xe2\x82 \xed\xa0\x80 \u00b5 \u2264 \U0001f600";

static unsigned state;
static double uniform(void) // 0 .. 1, the same in every run
{
	state = state * 1664525u + 1013904223u;
	return (state >> 8) / 16777216.;
}

// Makes "count" curves of "points" points over many decades; every fifth point failed.
static void fill(awkward *a, size_t count, size_t points)
{
	static const char *labels[] = { "1", "2", "4", "8", "16 substeps", "240 Hz" };
	static const char longish[] = "the fourth, with a title that is longer than the legend is wide";
	static const char *titles[] = { "obsim", "ODE QuickStep", "Bullet 3.24, single precision", longish, "", "<&>" };
	for (size_t i = 0; i < count; i++) {
		for (size_t j = 0; j < points; j++) {
			ob_plot_point *p = &a->point[i][j];
			*p = (ob_plot_point){ .x = pow(10, 3 * uniform()),
					      .y = pow(10, 8 * uniform() - 4),
					      .label = labels[j % 6] };
			p->failed = j % 5 == 4;
			if (p->failed && j % 2)
				p->y = NAN;
			if (j % 3 == 0) {
				p->low = p->y * .5;
				p->high = p->y * 2;
			}
		}
		a->series[i] = (ob_plot_series){ .title = titles[i % 6],
						 .count = points,
						 .point = a->point[i],
						 .style = (int)i,
						 .line = i % 3 != 2,
						 .hollow = i % 4 == 3 };
	}
	a->mark[0] = (ob_plot_mark){ .at = .5, .label = "target 0.5 mm", .tinted = true };
	a->mark[1] = (ob_plot_mark){ .at = 30, .label = "a vertical one", .vertical = true };
	a->plot = (ob_plot){ .title = "Cost against error",
			     .subtitle = "H = 1/60 s, commit 1234567",
			     .x = { .label = "CPU per body and simulated second (\u00b5s)", .scale = OB_SCALE_LOG },
			     .y = { .label = "worst penetration (mm)", .scale = OB_SCALE_LOG },
			     .series = a->series,
			     .series_count = count,
			     .mark = a->mark,
			     .marks = 2 };
}

static void scatter(awkward *a, const double *values, size_t count)
{
	fill(a, 1, count * count);
	for (size_t i = 0; i < count * count; i++)
		a->point[0][i] = (ob_plot_point){ .x = values[i % count],
						  .y = values[i / count],
						  .failed = i % 7 == 0,
						  .low = count < 4 || i % 3 ? 0 : -DBL_MAX,
						  .high = count < 4 || i % 3 ? 0 : DBL_MAX,
						  .label = "x" };
}

static void make_categories(awkward *a, size_t count)
{
	fill(a, 2, count < AWKWARD_POINTS ? count : AWKWARD_POINTS);
	for (size_t i = 0; i < 2; i++)
		for (size_t j = 0; j < a->series[i].count; j++)
			a->point[i][j].y = (double)j + .1 * (double)i;
	for (size_t i = 0; i < count; i++)
		a->category[i] = i % 7 == 3 ? very_long : i % 7 == 4 ? NULL : "stack of 10";
	a->mark[0] = (ob_plot_mark){ .at = 0, .label = "target", .vertical = true, .tinted = true };
	a->plot.y = (ob_plot_axis){ .scale = OB_SCALE_CATEGORY, .categories = count, .category = a->category };
}

static const double wild[] = { 0, -1, 1e-300, 1e300, DBL_MAX, INFINITY };

static void make_numbers(awkward *a, int i, ob_plot_scale scale)
{
	if (i == 0)
		scatter(a, wild, 6);
	else if (i == 1)
		scatter(a, (const double[]){ NAN, -INFINITY, INFINITY }, 3);
	else if (i == 2)
		scatter(a, (const double[]){ 7.3 }, 1); // one point
	else if (i == 3)
		scatter(a, (const double[]){ 1, 1 + 1e-12 }, 2); // hardly a range
	else
		scatter(a, (const double[]){ 5e-324, 2e-310 }, 2); // denormal
	a->plot.x.scale = a->plot.y.scale = scale;
	a->mark[0].at = i == 0 ? -DBL_MAX : i == 1 ? NAN : a->mark[0].at;
}

static void make_texts(awkward *a, int i)
{
	const char *text = i % 2 ? strange : very_long;
	fill(a, 5, 6);
	a->plot.title = a->plot.subtitle = a->plot.x.label = a->plot.y.label = a->mark[0].label = text;
	for (size_t j = 0; j < 5; j++) {
		a->series[j].title = text;
		a->point[j][2].label = text;
	}
	a->plot.width = (const double[]){ 0, 0, 300, 300, 2000, 1 }[i];
	a->plot.height = (const double[]){ 0, 0, 200, 200, 300, 1 }[i];
}

bool awkward_make(awkward *a, int i)
{
	static const char *names[] = { "plain", "twelve", "crowded",   "none",    "no-points",
				       "fixed", "rows",   "many-rows", "no-rows", "narrow" };
	enum { NAMED = sizeof names / sizeof *names, NUMBERS = 15, TEXTS = 6 };
	state = (unsigned)i;
	*a = (awkward){ 0 };
	a->name = i < NAMED ? names[i] : i < NAMED + NUMBERS ? "numbers" : "texts";
	if (i >= NAMED + NUMBERS) {
		make_texts(a, (i - NAMED - NUMBERS) % TEXTS);
		return i < NAMED + NUMBERS + TEXTS;
	}
	if (i >= NAMED) {
		make_numbers(a, (i - NAMED) % 5, (ob_plot_scale)((i - NAMED) / 5));
		return true;
	}
	static const size_t series[NAMED] = { 3, 12, 12, 0, 3, 4, 0, 0, 0, 8 },
			    points[NAMED] = { 6, 6, 40, 0, 0, 12, 0, 0, 0, 6 };
	fill(a, series[i], points[i]);
	if (i == 5) {
		a->plot.x = (ob_plot_axis){ "narrower than the data", OB_SCALE_LOG, .from = 8, .to = 90 };
		a->plot.y = (ob_plot_axis){ "narrower than the data", OB_SCALE_LOG, .from = .01, .to = 10 };
	} else if (i >= 6 && i <= 8) {
		make_categories(a, (const size_t[]){ 20, 60, 0 }[i - 6]);
	} else if (i == 9) {
		a->plot.width = 320;
	}
	return true;
}
