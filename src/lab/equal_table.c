#include <string.h>

#include "lab/grid.h"
#include "experiment/page.h"
#include "lab/tables.h"

static bool is_shown(const ob_digest *d, const ob_case *c)
{
	return c->compared && ob_digest_ran(d, c);
}

// Whoever took part in a case that is compared; obsim itself comes first.
static size_t gather(const ob_digest *d, size_t place[OB_DIGEST_ENGINES])
{
	size_t count = 0;
	for (int own = 1; own >= 0; own--) {
		for (size_t i = 0; i < d->engines; i++) {
			bool part = false;
			for (size_t j = 0; j < d->results->count; j++)
				part |= d->results->result[j].engine == d->engine[i] &&
					d->results->result[j].of->compared;
			if (part && (d->engine[i] == d->own) == own)
				place[count++] = i;
		}
	}
	return count;
}

static void add_cost(ob_grid *g, const ob_digest *d, const ob_digest_equal *q, size_t engine)
{
	char text[48];
	ob_page_print_quantity(text, sizeof text, q->cost[engine] * 1e6, "1");
	if (isnan(q->cost[engine]))
		ob_grid_add(g, "never");
	else if (d->engine[engine] == d->own || isnan(q->own))
		ob_grid_add(g, "%s", text);
	else
		ob_grid_add(g, "%s (%.2g\u00d7)", text, q->cost[engine] / q->own);
}

// How often obsim is ahead of all other engines, and how far behind at worst
static void print_sum(FILE *f, const ob_digest *d)
{
	int cases = 0, ahead = 0, never = 0;
	double worst = 0;
	if (!ob_digest_count_others(d)) // ahead of nobody
		return;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!is_shown(d, *c) || !d->own)
			continue;
		ob_digest_equal q = ob_digest_compare(d, *c);
		cases++;
		ahead += q.ahead;
		never += isnan(q.own);
		for (size_t i = 0; i < d->engines && !q.ahead; i++)
			if (!ob_digest_is_obsim(d->engine[i]) && q.cost[i] > 0)
				worst = fmax(worst, q.own / q.cost[i]);
	}
	if (cases)
		fprintf(f, "\nobsim is ahead in %d of %d", ahead, cases);
	if (cases && worst > 0)
		fprintf(f, "; at worst it takes %.2g times as long", worst);
	if (cases)
		fprintf(f, "%s.\n", never ? "; there are errors that it does not reach" : "");
}

void ob_lab_print_equal(FILE *f, const ob_digest *d, bool markdown)
{
	size_t place[OB_DIGEST_ENGINES], engines = gather(d, place);
	char align[OB_DIGEST_ENGINES + 3] = "lr", text[48];
	memset(align + 2, 'r', engines);
	align[2 + engines] = 0;
	ob_grid *g = engines ? ob_grid_new(align) : NULL;
	if (!g)
		return;
	ob_grid_add(g, "Case");
	ob_grid_add(g, "at an error of");
	for (size_t i = 0; i < engines; i++)
		ob_grid_add(g, "%s", markdown ? d->engine[place[i]]->title : d->engine[place[i]]->name);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!is_shown(d, *c))
			continue;
		ob_digest_equal q = ob_digest_compare(d, *c);
		ob_grid_add(g, "%s", (*c)->title);
		ob_page_print_quantity(text, sizeof text, q.error, (*c)->figure[0].unit);
		ob_grid_add(g, "%s%s", isnan(q.error) ? "nobody's" : text, q.is_target ? "" : " *");
		for (size_t i = 0; i < engines; i++)
			add_cost(g, d, &q, place[i]);
	}
	fputs("Microseconds of CPU per body and simulated second; in brackets: over obsim's. The error is the\n"
	      "target or, where nobody reaches that (*), obsim's smallest.\n\n",
	      f);
	ob_grid_print(g, f, markdown);
	ob_grid_free(g);
	print_sum(f, d);
}

void ob_lab_write_equal(FILE *f, const ob_digest *d)
{
	size_t place[OB_DIGEST_ENGINES], engines = gather(d, place);
	fputs("case,error,unit,error_is_target,engine,cpu_s_per_body_and_simulated_s,over_obsim\r\n", f);
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!is_shown(d, *c))
			continue;
		ob_digest_equal q = ob_digest_compare(d, *c);
		for (size_t i = 0; i < engines; i++) {
			double cost = q.cost[place[i]];
			fprintf(f, "%s,%.17g,%s,%d,%s,", (*c)->name, q.error, (*c)->figure[0].unit, q.is_target,
				d->engine[place[i]]->name);
			if (!isnan(cost))
				fprintf(f, "%.17g", cost);
			putc(',', f);
			if (!isnan(cost / q.own))
				fprintf(f, "%.17g", cost / q.own);
			fputs("\r\n", f);
		}
	}
}
