// A comparison as a table for people: medians, and the interval of what things cost.
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/compare.h"
#include "cli/quantity.h"

enum { LABEL_WIDTH = 24, COLUMN_WIDTH = 14, HASH_DIGITS = 12, COLUMNS_MAX = 6 };

static void print_value(ob_figure f, double x, char text[32])
{
	ob_quantity q;
	if (*ob_figure_table[f].unit || isnan(x))
		snprintf(text, 32, "%s", ob_quantity_text(&q, x, ob_figure_table[f].unit));
	else
		snprintf(text, 32, "%.3g", x);
}

// One line for the ways listed; nothing where none has it.
static void print_row(const ob_section *s, const int *way, int ways, ob_figure figure, FILE *f)
{
	bool known = false;
	for (int i = 0; i < ways; i++)
		known |= !isnan(ob_spread_of(&s->cell[way[i]], figure).median);
	if (!known)
		return;
	if (ob_figure_table[figure].group)
		fprintf(f, "%s\n", ob_figure_table[figure].group);
	fprintf(f, "  %-*s", LABEL_WIDTH - 2, ob_figure_table[figure].title);
	for (int i = 0; i < ways; i++) {
		char text[32];
		print_value(figure, ob_spread_of(&s->cell[way[i]], figure).median, text);
		fprintf(f, "%*s", COLUMN_WIDTH, text);
	}
	fputc('\n', f);
	if (figure != OB_FIGURE_COST)
		return;
	fprintf(f, "  %-*s", LABEL_WIDTH - 2, "  from .. to");
	for (int i = 0; i < ways; i++) {
		ob_spread x = ob_spread_of(&s->cell[way[i]], figure);
		char text[32];
		snprintf(text, sizeof text, "%.3g..%.3g us", 1e6 * x.low, 1e6 * x.high);
		fprintf(f, "%*s", COLUMN_WIDTH, text);
	}
	fputc('\n', f);
}

static void print_ways(const ob_comparison *c, const ob_section *s, const int *way, int ways, FILE *f)
{
	fprintf(f, "\n%*s", LABEL_WIDTH, "");
	for (int i = 0; i < ways; i++)
		fprintf(f, "%*s", COLUMN_WIDTH, ob_way_table[way[i]].title);
	fprintf(f, "\n  %-*s", LABEL_WIDTH - 2, "touching as");
	for (int i = 0; i < ways; i++)
		fprintf(f, "%*s", COLUMN_WIDTH, ob_way_table[way[i]].other_narrow ? c->other : c->narrow);
	fprintf(f, "\n  %-*s", LABEL_WIDTH - 2, "workers");
	for (int i = 0; i < ways; i++)
		fprintf(f, "%*" PRIu32, COLUMN_WIDTH, s->cell[way[i]].workers);
	fputc('\n', f);
	for (int k = 0; k < OB_FIGURE_KINDS; k++)
		print_row(s, way, ways, k, f);
	fprintf(f, "  %-*s", LABEL_WIDTH - 2, "state");
	for (int i = 0; i < ways; i++)
		fprintf(f, "%*.*s", COLUMN_WIDTH, HASH_DIGITS, s->cell[way[i]].sample[0].state_hash);
	fputc('\n', f);
}

static void print_section(const ob_comparison *c, const ob_section *s, FILE *f)
{
	int way[OB_WAYS], ways = 0;
	for (int w = 0; w < OB_WAYS; w++)
		if (ob_cell_is_done(s, w))
			way[ways++] = w;
	const ob_report *r = ways ? s->cell[way[0]].sample : NULL;
	if (r)
		fprintf(f,
			"%s%s%s: %" PRIu64 " objects, %" PRIu64 " steps of %g s, %g s simulated, %" PRIu32
			" runs of each; medians\n",
			c->scene, *s->define ? " " : "", s->define, r->objects, r->steps, r->step, r->simulated_s,
			c->repeats);
	for (int from = 0; from < ways; from += COLUMNS_MAX)
		print_ways(c, s, way + from, ways - from < COLUMNS_MAX ? ways - from : COLUMNS_MAX, f);
	for (int w = 0; w < OB_WAYS; w++) {
		if (s->cell[w].state != OB_WAY_DONE)
			fprintf(f, "%s: %s: %s\n", ob_way_table[w].title,
				s->cell[w].state == OB_WAY_FAILED ? "failed" : "skipped", s->cell[w].why);
	}
	ob_verdict v;
	ob_verdict_make(&v, c, s);
	fprintf(f, "\n%s\n",
		ob_section_agrees(s) ? "The object simulators end in the same bits."
				     : "The object simulators DIFFER in their last state.");
	fprintf(f, "Thread or process? %s\n", *v.headline ? v.headline : "Not measured.");
	const char *const said[] = { v.answer, v.architecture, v.narrow, v.sum };
	for (int i = 0; i < 4; i++)
		if (*said[i])
			fprintf(f, "%s\n", said[i]);
}

void ob_comparison_print(const ob_comparison *c, FILE *f)
{
	for (uint32_t i = 0; i < c->sections; i++) {
		print_section(c, &c->section[i], f);
		if (i + 1 < c->sections)
			fputc('\n', f);
	}
}
