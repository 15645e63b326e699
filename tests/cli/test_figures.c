// Figures for people, and guesses at what they meant to type.
#include <math.h>
#include <string.h>

#include "base/spelling.h"
#include "check.h"
#include "cli/quantity.h"

static void check_text(double value, const char *unit, const char *expected)
{
	ob_quantity q;
	CHECK(strcmp(ob_quantity_text(&q, value, unit), expected) == 0);
	if (strcmp(q.text, expected) != 0)
		fprintf(stderr, "  %.17g %s reads '%s', expected '%s'\n", value, unit, q.text, expected);
}

static void test_quantities(void)
{
	check_text(1.2345e-6, "s", "1.23 us");
	check_text(12.345e-3, "m", "12.3 mm");
	check_text(123.45, "s", "123 s");
	check_text(1, "s", "1.00 s");
	check_text(999.4, "s", "999 s");
	check_text(999.7, "s", "1.00 ks");
	check_text(.9996, "s", "1.00 s");
	check_text(.99940, "s", "999 ms");
	check_text(9.9949, "s", "9.99 s");
	check_text(9.996, "s", "10.0 s");
	check_text(99.96, "s", "100 s");
	check_text(-2.5e-3, "J", "-2.50 mJ");
	check_text(1.5e9, "B", "1.50 GB");
	check_text(0, "m", "0 m");
	check_text(1e-15, "m", "0 m");
	check_text(NAN, "m", "-");
	check_text(1e22, "J", "1e+10 TJ");
}

static void test_distance(void)
{
	CHECK(ob_spelling_distance("", "") == 0);
	CHECK(ob_spelling_distance("", "abc") == 3);
	CHECK(ob_spelling_distance("kitten", "sitting") == 3);
	CHECK(ob_spelling_distance("abcd", "abdc") == 1); // a swap
	CHECK(ob_spelling_distance("workers", "worker") == 1);
}

static void test_suggestions(void)
{
	ob_spelling s = ob_spelling_start("durration");
	ob_spelling_offer(&s, "define");
	CHECK(!s.best);
	ob_spelling_offer(&s, "duration");
	ob_spelling_offer(&s, "step");
	CHECK(s.best && strcmp(s.best, "duration") == 0);
	s = ob_spelling_start("x");
	ob_spelling_offer(&s, "exchange");
	CHECK(!s.best);
	s = ob_spelling_start("integ");
	ob_spelling_offer(&s, "integrator");
	CHECK(s.best);
}

int main(void)
{
	test_quantities();
	test_distance();
	test_suggestions();
	return check_end();
}
