// Report of made-up results: its conclusions, and its complete files.
//
// test_report       the conclusions
// test_report DIR   writes the report there, for check_report.py
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../check.h"
#include "lab/analysis.h"
#include "experiment/page.h"
#include "experiment/table.h"
#include "lab/report.h"

static const ob_engine_kind kinds[] = {
	{ .name = "obsim", .title = "obsim", .version = "", .usual = { .substeps = 8, .iterations = 16 } },
	{ .name = "obsim-jacobi",
	  .title = "obsim, Jacobi",
	  .version = "",
	  .usual = { .substeps = 8, .iterations = 16 } },
	{ .name = "obsim-ghost",
	  .title = "obsim, ghosts",
	  .version = "",
	  .usual = { .substeps = 8, .iterations = 16 } },
	{ .name = "obsim-lag",
	  .title = "obsim, late",
	  .version = "",
	  .usual = { .substeps = 8, .iterations = 16, .lag = 1 } },
	{ .name = "ode-quick",
	  .title = "ODE QuickStep",
	  .version = "0.16.2",
	  .usual = { .substeps = 1, .iterations = 20 } },
	{ .name = "ode-world", .title = "ODE dWorldStep", .version = "0.16.2", .usual = { .substeps = 1 } },
	{ .name = "bullet",
	  .title = "Bullet <3.24> & \"single\"",
	  .version = "3.24",
	  .usual = { .substeps = 1, .iterations = 10 } },
};
enum { OWN, JACOBI, GHOST, LATE, QUICK, WORLD, BULLET, KINDS, MOST = 4000 };

static ob_results made = { .machine = "Made-up processor, 2 cores, Linux 6.1", .commit = "0123456789ab" };
static ob_result results[MOST];

static ob_result *add(const ob_case *c, int kind, uint32_t substeps, double figure, double cost)
{
	ob_result *r = &results[made.count++];
	*r = (ob_result){ .of = c, .engine = &kinds[kind], .settings = kinds[kind].usual, .repeats = 1 };
	r->settings.step_length = ob_case_step;
	r->settings.substeps = substeps;
	r->outcome = (ob_case_result){ .cpu_s = cost * 10, .wall_s = cost * 10, .body_seconds = 10 };
	for (uint32_t i = 0; i < c->figures; i++)
		r->outcome.figure[i] =
			figure * (isfinite(c->figure[i].target) ? c->figure[i].target : 1) * (1 + .3 * i);
	return r;
}

// Value between 0 and 1, from two numbers.
static double shade(unsigned a, unsigned b)
{
	unsigned h = (a * 2654435761u) ^ (b * 2246822519u);
	h ^= h >> 15;
	h *= 2246822519u;
	return (h >> 8 & 0xffff) / 65536.;
}

// Adds a curve of one engine in one case: "error" times the target at its first setting, falling by an order.
static void add_curve(const ob_case *c, unsigned row, int kind, double error, double order, double cost)
{
	for (uint32_t n = 1, i = 0; n <= 32; n *= 2, i++) {
		double wobble = 1 + .25 * (shade(row * 7 + (unsigned)kind, i) - .5);
		ob_result *r = add(c, kind, n, error * pow(n, -order) * wobble, cost * pow(n, .85) * wobble);
		if (error * pow(n, -order) > 3e3)
			strcpy(r->outcome.failed, i % 2 ? "fell" : "passed through");
	}
}

static void make_up(void)
{
	made.count = 0;
	made.result = results;
	for (unsigned row = 0; ob_cases[row]; row++) {
		const ob_case *c = ob_cases[row];
		double hard = pow(10, 2 * shade(row, 1)), dear = 1e-6 * (1 + 9 * shade(row, 2));
		if (!strcmp(c->name, "lag")) {
			for (uint32_t lag = 0; lag < 6; lag++)
				add(c, LATE, 8, lag ? 1e13 * pow(4, lag) : .2, dear)->settings.lag = lag;
			continue;
		}
		add_curve(c, row, OWN, .3 * hard, 1.9, dear);
		for (int i = 0; i < 4; i++) {
			ob_result *r = add(c, OWN, 0, pow(10, 1 - i) * .7, dear * (1 + 3 * i));
			r->settings.tolerance = .005 * pow(10, -i);
		}
		add(c, OWN, 8, .5 * hard, dear * 2)->settings.iterations = 4;
		add_curve(c, row, JACOBI, 3 * hard, 1.1, dear * 2);
		add_curve(c, row, GHOST, 2e3 * hard, .2, dear);
		add_curve(c, row, QUICK, 1e3 * hard * shade(row, 3), 1, dear * 8);
		add_curve(c, row, WORLD, 1e3 * hard * shade(row, 4), 1.1, dear * 80);
		add_curve(c, row, BULLET, 1e3 * hard * shade(row, 5), .9, dear * 5);
	}
}

static const ob_case *named(const char *name)
{
	const ob_case *c = ob_case_find(name);
	CHECK(c != NULL);
	return c;
}

static void check_rows(void)
{
	made = (ob_results){ .result = results };
	const ob_case *stack = named("stack-10"), *taller = named("stack-20"), *spin = named("spin");
	add(stack, OWN, 8, .5, 1e-6);
	add(taller, OWN, 8, .5, 1e-6)->outcome.figure[0] = 1e3; // row 14, as the stack of 10
	add(spin, OWN, 8, .5, 1e-6);
	add(spin, OWN, 16, 9, 1e-6); // not at usual settings: ignored
	ob_lab_analysis d = ob_lab_analyse(&made);
	ob_lab_analysis_rows rows = ob_lab_analysis_count_rows(&d);
	CHECK(rows.measured == 2 && rows.met == 1);
	CHECK(ob_lab_analysis_meets_all(&results[0]) && !ob_lab_analysis_meets_all(&results[1]));
	CHECK_NEAR(ob_lab_analysis_ratio(&results[2]), .5 * 1.6, 1e-12); // its third figure
	CHECK_NEAR(ob_lab_analysis_ratio(&results[1]), 2000, 1e-9);
	const ob_case *wall = named("thin-wall"); // all targets are 0
	CHECK(ob_lab_analysis_ratio(add(wall, OWN, 8, 0, 1e-6)) == 0);
	results[--made.count].outcome.figure[1] = 3;
	CHECK(isinf(ob_lab_analysis_ratio(&results[made.count])) && !ob_lab_analysis_meets_all(&results[made.count]));
	strcpy(results[2].outcome.failed, "fell"); // met, but failed
	rows = ob_lab_analysis_count_rows(&d);
	CHECK(rows.measured == 2 && rows.met == 0);
	CHECK(isinf(ob_lab_analysis_ratio(&results[2])));
	results[2].outcome.failed[0] = 0;
	results[2].outcome.figure[1] = NAN;
	CHECK(!ob_lab_analysis_meets_all(&results[2]));
}

static void check_best_other(void)
{
	made = (ob_results){ .result = results };
	const ob_case *c = named("stack-10");
	add(c, OWN, 8, .5, 1e-6);
	add(c, JACOBI, 8, .01, 1e-6); // a variant of obsim is no other engine
	add(c, BULLET, 1, 7, 1e-6);
	add(c, QUICK, 1, 5, 1e-6);
	strcpy(add(c, WORLD, 1, 2, 1e-6)->outcome.failed, "fell");
	ob_lab_analysis d = ob_lab_analyse(&made);
	CHECK(d.engines == 5 && d.own == &kinds[OWN]);
	CHECK(ob_lab_analysis_best_other(&d, c, 0) == &results[3]);
	CHECK(ob_lab_analysis_style(&d, &kinds[OWN]) == 0 && ob_lab_analysis_style(&d, &kinds[BULLET]) == 7);
}

static void check_equal(void)
{
	made = (ob_results){ .result = results };
	const ob_case *c = named("stack-10");
	add(c, OWN, 8, .5, 1e-6);
	add(c, QUICK, 1, 100, 1e-6);
	add(c, QUICK, 32, .9, 7e-6);
	ob_lab_analysis d = ob_lab_analyse(&made);
	ob_lab_analysis_equal q = ob_lab_analysis_compare(&d, c);
	CHECK(q.is_target && q.ahead);
	CHECK_NEAR(q.error, c->figure[0].target, 0);
	CHECK_NEAR(q.own, 1e-6, 1e-18);
	CHECK(q.cost[1] > 1e-6 && q.cost[1] <= 7e-6);
	results[2].outcome.cpu_s = 5e-6; // now the other one reaches it at half the cost
	results[1].outcome.cpu_s = 1e-6;
	CHECK(!ob_lab_analysis_compare(&d, c).ahead);
	results[0].outcome.figure[0] = 3 * c->figure[0].target; // obsim misses the level of the other one
	q = ob_lab_analysis_compare(&d, c);
	CHECK(q.is_target && !q.ahead && isnan(q.own));
	results[2].outcome.figure[0] = 9 * c->figure[0].target; // no engine reaches it: at obsim's own
	q = ob_lab_analysis_compare(&d, c);
	CHECK(!q.is_target && q.ahead && isnan(q.cost[1]));
	CHECK_NEAR(q.error, 3 * c->figure[0].target, 0);
}

static const char *quantity(double v, const char *unit)
{
	static ob_word word;
	word = ob_word_quantity(v, unit);
	return word.text;
}

static void write_word(ob_page *p, const void *with)
{
	ob_page_text(p, with);
}

static void check_page(void)
{
	CHECK(!strcmp(quantity(.5, "mm"), "0.5 mm"));
	CHECK(!strcmp(quantity(0, "1"), "0"));
	CHECK(!strcmp(quantity(100, "1"), "100"));
	CHECK(!strcmp(quantity(12345, "1"), "12345"));
	CHECK(!strcmp(quantity(9.996, "1"), "10"));
	CHECK(!strcmp(quantity(.0123456, "1"), "0.0123"));
	CHECK(!strcmp(quantity(-35.94, "1"), "-35.9"));
	CHECK(!strcmp(quantity(3, "m^2/s^3"), "3 m\u00b2/s\u00b3"));
	CHECK(!strcmp(quantity(1e-6, "m^2/s^2"), "1e-6 m\u00b2/s\u00b2"));
	CHECK(!strcmp(quantity(.5, "1"), "0.5"));
	char text[100] = "";
	ob_page p = { .out = fmemopen(text, sizeof text, "w") };
	ob_page_fill(&p, "a {{word}} b{{none}}{{word}}", &(ob_page_slot){ "word", write_word }, 1, "<&>");
	fclose(p.out);
	CHECK(!strcmp(text, "a &lt;&amp;&gt; b&lt;&amp;&gt;"));
}

// Reports of nothing, and of one result, are written too; an unwritable place is an error.
static void check_little(void)
{
	char dir[] = "/tmp/obsim-report-XXXXXX", name[64];
	ob_error e = { "" };
	CHECK(mkdtemp(dir) != NULL);
	made = (ob_results){ .result = results };
	CHECK(ob_lab_report(&made, dir, &e));
	strcpy(add(named("stack-10"), QUICK, 1, 5, 1e-6)->outcome.failed, "fell");
	CHECK(ob_lab_report(&made, dir, &e));
	CHECK(!ob_lab_report(&made, "/dev/null/here", &e) && strstr(e.text, "/dev/null/here"));
	snprintf(name, sizeof name, "rm -r %s", dir);
	CHECK(system(name) == 0);
}

int main(int argc, char **argv)
{
	CHECK(ob_cases_open(NULL, 0, &(ob_error){ "" }));
	if (argc == 2) {
		ob_error e = { "" };
		make_up();
		if (ob_lab_report(&made, argv[1], &e))
			return 0;
		fprintf(stderr, "%s\n", e.text);
		return 1;
	}
	check_rows();
	check_best_other();
	check_equal();
	check_page();
	check_little();
	return check_end();
}
