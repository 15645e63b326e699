#include "lab/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "lab/chart.h"
#include "lab/report_parts.h"
#include "report_texts.h"

enum { PATH = 4096 };
#define PNG_ZOOM 2

static void write_svg(ob_page *p, ob_chart *chart)
{
	char *svg = chart ? ob_plot_svg_text(&chart->plot, NULL) : NULL;
	if (svg)
		fputs(svg, p->out);
	free(svg);
	ob_chart_free(chart);
}

static void write_style(ob_page *p, const void *with)
{
	ob_page_style(p);
}

static void write_promises(ob_page *p, const void *with)
{
	write_svg(p, ob_chart_promises(with));
}

static const char *const convergence_cases[] = { "stack-10", "pile", "sliding" };
enum { CONVERGENCE_CASES = sizeof convergence_cases / sizeof *convergence_cases };

static ob_chart *convergence_chart(const ob_digest *d, size_t i)
{
	const ob_case *c = ob_case_find(convergence_cases[i]);
	return c ? ob_chart_convergence(d, c) : NULL;
}

// A section that stands only if it has a chart
static bool begin_section(ob_page *p, const ob_chart *chart, const char *id, const char *title, const char *text)
{
	if (chart)
		ob_page_markup(p, "<h2 id=\"%s\">%s</h2>\n<p>%s</p>\n", id, title, text);
	return chart != NULL;
}

static void write_convergence(ob_page *p, const void *with)
{
	bool begun = false;
	for (size_t i = 0; i < CONVERGENCE_CASES; i++) {
		ob_chart *chart = convergence_chart(with, i);
		begun = begun || begin_section(p, chart, "order", "Order of convergence",
					       "What doubling the substeps buys. An error of first order halves, one "
					       "of second order falls to a quarter; "
					       "the observed order stands beside each name.");
		if (chart)
			ob_page_markup(p, "<figure>\n");
		write_svg(p, chart);
		if (chart)
			ob_page_markup(p, "</figure>\n");
	}
}

static void write_ghost(ob_page *p, const void *with)
{
	ob_chart *chart = ob_chart_ghost(with);
	if (!begin_section(p, chart, "ghost", "Why neighbours must not be ghosts",
			   "The first thing that comes to mind when every body is a simulator of its own: treat each "
			   "neighbour as a body "
			   "that nothing can move. Then both sides answer a hit with the whole of it, momentum is not "
			   "kept, and energy "
			   "comes from nowhere. (Where bodies touch nothing but the ground it makes no difference.) "
			   "obsim can do so (<code>coupling=ghost</code>) only to show it."))
		return;
	ob_page_markup(p, "<figure>\n");
	write_svg(p, chart);
	ob_page_markup(p, "</figure>\n");
}

static void write_lag(ob_page *p, const void *with)
{
	ob_chart *chart = ob_chart_lag(with);
	if (!begin_section(p, chart, "late", "Why partners must not be read late",
			   "Two bodies hit each other, each in its own simulator, and each works with a state of the "
			   "other that is some "
			   "exchanges old. Momentum is exact only where both sides see the same."))
		return;
	ob_page_markup(p, "<figure>\n");
	write_svg(p, chart);
	ob_page_markup(p, "</figure>\n");
}

static void write_index(ob_page *p, const void *with)
{
	for (const ob_case *const *c = ob_cases; *c; c++) {
		if (!ob_digest_ran(with, *c))
			continue;
		ob_page_markup(p, "<li><a href=\"#%s\">", (*c)->name);
		ob_page_text(p, (*c)->title);
		ob_page_markup(p, "</a></li>\n");
	}
}

static void write_id(ob_page *p, const void *with)
{
	ob_page_text(p, ((const ob_report_case *)with)->of->name);
}

static void write_setup(ob_page *p, const void *with)
{
	ob_page_text(p, ((const ob_report_case *)with)->of->setup);
}

static void write_peers(ob_page *p, const void *with)
{
	ob_page_text(p, ((const ob_report_case *)with)->of->peers);
}

// A case's own: over cost, but where it is about reading late
static ob_chart *case_chart(const ob_digest *d, const ob_case *c)
{
	return c == ob_case_find("lag") ? ob_chart_lag(d) : ob_chart_cost(d, c);
}

static void write_plot(ob_page *p, const void *with)
{
	const ob_report_case *c = with;
	write_svg(p, case_chart(c->digest, c->of));
}

static void write_cases(ob_page *p, const void *with)
{
	static const ob_page_slot slots[] = { { "id", write_id },
					      { "title", ob_report_title },
					      { "badge", ob_report_badge },
					      { "setup", write_setup },
					      { "reference", ob_report_reference },
					      { "peers", write_peers },
					      { "figures", ob_report_figures },
					      { "plot", write_plot },
					      { "runs", ob_report_runs } };
	for (const ob_case *const *c = ob_cases; *c; c++)
		if (ob_digest_ran(with, *c))
			ob_page_fill(p, text_case_html, slots, sizeof slots / sizeof *slots,
				     &(ob_report_case){ .digest = with, .of = *c });
}

static void write_setting(ob_page *p, const void *with)
{
	const ob_digest *d = with;
	ob_page_markup(p, "<dt>Machine</dt><dd>");
	ob_page_text(p, d->results->machine);
	ob_page_markup(p, "</dd>\n<dt>obsim</dt><dd>commit <code>");
	ob_page_text(p, d->results->commit);
	ob_page_markup(p, "</code></dd>\n");
	for (size_t i = 0; i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		ob_page_markup(p, "<dt>");
		ob_page_text(p, k->title);
		ob_page_markup(p, "</dt><dd><code>");
		ob_page_text(p, k->name);
		ob_page_markup(p, "</code>%s", *k->version ? " " : "");
		ob_page_text(p, k->version);
		ob_page_markup(p, "; usual: %u step%s a frame", k->usual.substeps, k->usual.substeps == 1 ? "" : "s");
		if (k->usual.iterations)
			ob_page_markup(p, ", %u %s", k->usual.iterations,
				       ob_digest_is_obsim(k) ? "rounds of exchange at most" : "solver iterations");
		ob_page_markup(p, "</dd>\n");
	}
}

static bool make_folder(const char *path, ob_error *e)
{
	return !mkdir(path, 0777) || errno == EEXIST || ob_fail(e, "cannot make the folder %s: %m", path);
}

// Takes the chart; none is no error.
static bool write_chart(ob_chart *chart, const char *dir, const char *name, ob_error *e)
{
	char path[PATH];
	bool ok = true;
	if (chart) {
		snprintf(path, sizeof path, "%s/plots/%s.svg", dir, name);
		ok = ob_plot_svg(&chart->plot, path, e);
		snprintf(path, sizeof path, "%s/plots/%s.png", dir, name);
		ok = ok && ob_plot_png(&chart->plot, path, PNG_ZOOM, e);
	}
	ob_chart_free(chart);
	return ok;
}

static bool write_charts(const ob_digest *d, const char *dir, ob_error *e)
{
	char name[80];
	for (const ob_case *const *c = ob_cases; *c; c++)
		if (!write_chart(case_chart(d, *c), dir, (*c)->name, e))
			return false;
	for (size_t i = 0; i < CONVERGENCE_CASES; i++) {
		snprintf(name, sizeof name, "order-%s", convergence_cases[i]);
		if (!write_chart(convergence_chart(d, i), dir, name, e))
			return false;
	}
	return write_chart(ob_chart_promises(d), dir, "all-cases", e) &&
	       write_chart(ob_chart_ghost(d), dir, "all-ghost", e);
}

bool ob_lab_report(const ob_results *r, const char *dir, ob_error *e)
{
	static const ob_page_slot slots[] = { { "style", write_style },
					      { "cards", ob_report_cards },
					      { "verdict", ob_report_verdict },
					      { "promises", write_promises },
					      { "equal", ob_report_equal },
					      { "rows", ob_report_rows },
					      { "convergence", write_convergence },
					      { "ghost", write_ghost },
					      { "lag", write_lag },
					      { "index", write_index },
					      { "cases", write_cases },
					      { "setting", write_setting } };
	char path[PATH];
	ob_digest d = ob_digest_make(r);
	if (snprintf(path, sizeof path, "%s/plots", dir) >= PATH - 100)
		return ob_fail(e, "the name of the folder is too long: %s", dir);
	if (!make_folder(dir, e) || !make_folder(path, e) || !write_charts(&d, dir, e))
		return false;
	snprintf(path, sizeof path, "%s/report.html", dir);
	ob_page page = { .out = fopen(path, "w") };
	if (!page.out)
		return ob_fail(e, "cannot write %s: %m", path);
	ob_page_fill(&page, text_page_html, slots, sizeof slots / sizeof *slots, &d);
	bool written = !ferror(page.out);
	written = !fclose(page.out) && written;
	return written || ob_fail(e, "cannot write %s: %m", path);
}
