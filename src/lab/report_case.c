// One case's part of the report.
#include <math.h>
#include <string.h>

#include "lab/chart.h"
#include "lab/report_parts.h"

void ob_report_title(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	ob_page_text(p, c->of->title);
}

void ob_report_badge(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	const ob_result *r = ob_digest_promised(c->digest, c->of);
	if (r)
		ob_page_markup(p, "<span class=\"badge %s</span>",
			       ob_digest_meets_all(r) ? "met\">met" : "missed\">missed");
}

void ob_report_reference(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	for (uint32_t i = 0; i < c->of->figures; i++) {
		const ob_figure_def *def = &c->of->figure[i];
		ob_page_markup(p, i ? "<br>" : "");
		ob_page_text(p, def->name);
		ob_page_markup(p, ": ");
		ob_page_text(p, def->reference);
	}
}

static void write_heads(ob_page *p, const ob_case *c, const char *first, const char *second)
{
	ob_page_markup(
		p,
		"<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">%s</th><th scope=\"col\" class=\"n\">%s"
		"</th>",
		first, second);
	for (uint32_t i = 0; i < c->figures; i++) {
		const ob_figure_def *def = &c->figure[i];
		ob_page_markup(p, "<th scope=\"col\" class=\"n\">");
		ob_page_text(p, def->name);
		if (ob_digest_has_target(c, i)) {
			ob_page_markup(p, "<small>target ");
			ob_page_quantity(p, def->target, def->unit);
			ob_page_markup(p, "</small>");
		}
		ob_page_markup(p, "</th>");
	}
	ob_page_markup(
		p,
		"<th scope=\"col\" class=\"n\">CPU<small>\u00b5s per body and s</small></th></tr></thead>\n<tbody>\n");
}

static void write_figures(ob_page *p, const ob_result *r)
{
	for (uint32_t i = 0; i < r->of->figures; i++) {
		const char *verdict = !ob_digest_has_target(r->of, i) || r->outcome.failed[0] ? ""
				      : ob_digest_meets(r, i)                                 ? " met"
											      : " missed";
		ob_page_markup(p, "<td class=\"n%s\">", verdict);
		ob_page_quantity(p, r->outcome.figure[i], r->of->figure[i].unit);
		ob_page_markup(p, "</td>");
	}
	ob_page_markup(p, "<td class=\"n\">");
	ob_page_number(p, ob_result_cost(r) * 1e6);
	ob_page_markup(p, "</td></tr>\n");
}

static void write_failure(ob_page *p, const ob_result *r)
{
	if (!r->outcome.failed[0])
		return;
	ob_page_markup(p, "<small class=\"missed\">failed: ");
	ob_page_text(p, r->outcome.failed);
	ob_page_markup(p, "</small>");
}

void ob_report_figures(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	const ob_digest *d = c->digest;
	const ob_result *promised = ob_digest_promised(d, c->of);
	write_heads(p, c->of, "engine, at its usual settings", "steps a frame");
	for (size_t i = 0; i < d->engines; i++) {
		bool is_promised = promised && promised->engine == d->engine[i];
		const ob_result *r = is_promised ? promised : ob_digest_usual(d, c->of, d->engine[i]);
		if (!r)
			continue;
		ob_page_markup(p, "<tr><th scope=\"row\">");
		ob_page_text(p, r->engine->title);
		write_failure(p, r);
		ob_page_markup(p, "</th><td class=\"n\">%u</td>", r->settings.substeps);
		write_figures(p, r);
	}
	ob_page_markup(p, "</tbody></table></div>\n");
}

void ob_report_runs(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	write_heads(p, c->of, "engine", "setting");
	for (size_t i = 0; i < c->digest->results->count; i++) {
		const ob_result *r = &c->digest->results->result[i];
		char setting[32];
		if (r->of != c->of)
			continue;
		ob_chart_setting(r, setting, sizeof setting);
		ob_page_markup(p, "<tr><th scope=\"row\">");
		ob_page_text(p, r->engine->title);
		write_failure(p, r);
		ob_page_markup(p, "</th><td class=\"n\">");
		ob_page_text(p, setting);
		ob_page_markup(p, "<small>%u iterations", r->settings.iterations);
		if (r->settings.lag)
			ob_page_markup(p, ", lag %u", r->settings.lag);
		ob_page_markup(p, "</small></td>");
		write_figures(p, r);
	}
	ob_page_markup(p, "</tbody></table></div>\n");
}
