#include "lab/grid.h"
#include "experiment/page.h"
#include "lab/tables.h"

typedef struct quantity {
	char text[48];
} quantity;

static const char *print(quantity *q, double v, const char *unit)
{
	ob_page_print_quantity(q->text, sizeof q->text, v, unit);
	return q->text;
}

static bool others_ran(const ob_digest *d, const ob_case *c)
{
	for (size_t i = 0; i < d->engines; i++)
		if (!ob_digest_is_obsim(d->engine[i]) && ob_digest_usual(d, c, d->engine[i]))
			return true;
	return false;
}

static void add_figure(ob_grid *g, const ob_digest *d, const ob_result *r, uint32_t figure, bool first)
{
	const ob_case *c = r->of;
	const ob_figure_def *def = &c->figure[figure];
	const ob_result *other = ob_digest_best_other(d, c, figure);
	quantity q;
	if (first)
		ob_grid_add(g, "%d", c->row);
	else
		ob_grid_add(g, "%s", "");
	ob_grid_add(g, "%s", first ? c->title : "");
	ob_grid_add(g, "%s", def->name);
	if (*r->outcome.failed && !isfinite(r->outcome.figure[figure]))
		ob_grid_add(g, "%s", "failed");
	else
		ob_grid_add(g, "%s", print(&q, r->outcome.figure[figure], def->unit));
	ob_grid_add(g, "\u2264 %s", print(&q, def->target, def->unit));
	if (ob_digest_meets(r, figure))
		ob_grid_add(g, "met");
	else
		ob_grid_add(g, "MISSED%s%s", *r->outcome.failed ? ": " : "", r->outcome.failed);
	if (other)
		ob_grid_add(g, "%s (%s)", print(&q, other->outcome.figure[figure], def->unit), other->engine->title);
	else
		ob_grid_add(g, "%s", others_ran(d, c) ? "all failed" : "\u2013");
}

void ob_lab_print_rows(FILE *f, const ob_digest *d, bool markdown)
{
	static const char *const heads[] = { "Row", "Case", "Figure", "obsim", "Target", "", "Best other engine" };
	ob_grid *g = ob_grid_new("rllrlll");
	for (size_t i = 0; g && i < sizeof heads / sizeof *heads; i++)
		ob_grid_add(g, "%s", heads[i]);
	for (const ob_case *const *c = ob_cases; g && *c; c++) {
		const ob_result *r = ob_digest_promised(d, *c);
		bool first = true;
		for (uint32_t i = 0; r && i < (*c)->figures; i++) {
			if (!ob_digest_has_target(*c, i))
				continue;
			add_figure(g, d, r, i, first);
			first = false;
		}
	}
	if (g)
		ob_grid_print(g, f, markdown);
	ob_grid_free(g);
}

size_t ob_lab_count_missed(const ob_digest *d)
{
	size_t missed = 0;
	for (const ob_case *const *c = ob_cases; *c; c++) {
		const ob_result *r = ob_digest_promised(d, *c);
		for (uint32_t i = 0; r && i < (*c)->figures; i++)
			missed += ob_digest_has_target(*c, i) && !ob_digest_meets(r, i);
	}
	return missed;
}
