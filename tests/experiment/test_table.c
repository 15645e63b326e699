// One description of a table, in all its forms.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "printed.h"
#include "experiment/table.h"

static ob_table *plain(void)
{
	ob_table *t = ob_table_new("lrl");
	ob_table_row(t, "a", "number", "", "longer", "1 \u00b5s", "x", "", "", "end", NULL);
	return t;
}

static void test_forms(void)
{
	FILE *f = begin();
	ob_table_print(plain(), f, 0);
	expect(f, "a       number\n"
		  "longer    1 \u00b5s  x\n"
		  "                end\n");
	f = begin();
	ob_table_markdown(plain(), f);
	expect(f, "| a      | number |     |\n"
		  "| ------ | -----: | --- |\n"
		  "| longer |   1 \u00b5s | x   |\n"
		  "|        |        | end |\n");
	ob_table *t = plain();
	ob_table_add(t, "half a row");
	f = begin();
	ob_table_print(t, f, 0);
	fclose(f);
	CHECK(strstr(text, "half a row\n"));
	free(text);
}

// A heading spans all columns, and widens none.
static ob_table *headed(void)
{
	ob_table *t = ob_table_new("lr");
	ob_table_row(t, "a", "b", NULL);
	ob_table_heading(t, "where it goes");
	ob_table_row(t, "x", "1", NULL);
	return t;
}

static void test_heading(void)
{
	FILE *f = begin();
	ob_table_print(headed(), f, 0);
	expect(f, "a  b\nwhere it goes\nx  1\n");
	f = begin();
	ob_page page = { f };
	ob_table_html(headed(), &page);
	fclose(f);
	CHECK(strstr(text, "<tr><th colspan=\"2\" scope=\"rowgroup\">where it goes</th></tr>\n<tr><td>x</td>"));
	free(text);
}

// Columns that do not fit follow below, behind the first column again.
static void test_panels(void)
{
	ob_table *t = ob_table_new("lrrr");
	static const char *const cells[] = { "", "one", "two", "three", "cost", "1", "22", "333" };
	for (size_t i = 0; i < sizeof cells / sizeof *cells; i++)
		ob_table_add(t, "%s", cells[i]);
	FILE *f = begin();
	ob_table_print(t, f, 15);
	expect(f, "      one  two\n"
		  "cost    1   22\n"
		  "\n"
		  "      three\n"
		  "cost    333\n");
}

static ob_table *measured(void)
{
	static const ob_metric m = { .key = "time_s", .unit = "ms", .scale = 1e3 };
	ob_table *t = ob_table_new("lr");
	ob_table_add(t, "case");
	ob_table_add(t, "time");
	ob_table_add(t, "a < b");
	ob_table_link(t, "pile");
	ob_table_add_median(t, &m, &(ob_statistics){ .median = .0025, .median_low = .002, .median_high = .003 });
	ob_table_class(t, "met");
	ob_table_add(t, "once");
	ob_table_add_median(t, &m, &(ob_statistics){ .median = 1, .median_low = NAN, .median_high = NAN });
	return t;
}

static void test_small_and_html(void)
{
	FILE *f = begin();
	ob_table_print(measured(), f, 0);
	expect(f, "case              time\n"
		  "a < b  2.5 ms (2 to 3)\n"
		  "once           1000 ms\n");
	f = begin();
	ob_page page = { .out = f };
	ob_table_html(measured(), &page);
	expect(f,
	       "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">case</th><th scope=\"col\" class=\"n\">time"
	       "</th></tr></thead>\n<tbody>\n"
	       "<tr><td><a href=\"#pile\">a &lt; b</a></td><td class=\"n met\">2.5 ms<small>2 to 3</small></td></tr>\n"
	       "<tr><td>once</td><td class=\"n\">1000 ms</td></tr>\n</tbody></table></div>\n");
}

int main(void)
{
	test_forms();
	test_heading();
	test_panels();
	test_small_and_html();
	return check_end();
}
