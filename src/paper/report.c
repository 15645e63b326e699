#include "paper/report.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "paper/chart.h"
#include "paper/report_parts.h"
#include "paper_texts.h"

enum { PATH = 4096 };
#define PNG_ZOOM 2

static void write_style(ob_page *p, const void *with)
{
	ob_page_style(p);
	fputs(text_paper_css, p->out);
}

static void write_chart(ob_page *p, const void *with, int chart)
{
	ob_paper_chart *c = ob_paper_chart_make(with, chart);
	char *svg = c ? ob_plot_svg_text(ob_paper_chart_plot(c), NULL) : NULL;
	if (svg)
		ob_page_markup(p, "<figure id=\"%s\">\n%s</figure>\n", ob_paper_chart_name(chart), svg);
	free(svg);
	ob_paper_chart_free(c);
}

static void write_figures(ob_page *p, const void *with)
{
	for (int i = 0; i < OB_PAPER_CHARTS; i++)
		write_chart(p, with, i);
}

static bool write_plots(const ob_paper_matter *m, const char *dir, ob_error *e)
{
	bool fine = true;
	for (int i = 0; fine && i < OB_PAPER_CHARTS; i++) {
		char path[PATH];
		ob_paper_chart *c = ob_paper_chart_make(m, i);
		if (!c)
			continue;
		snprintf(path, sizeof path, "%s/plots/%s.svg", dir, ob_paper_chart_name(i));
		fine = ob_plot_svg(ob_paper_chart_plot(c), path, e);
		snprintf(path, sizeof path, "%s/plots/%s.png", dir, ob_paper_chart_name(i));
		fine = fine && ob_plot_png(ob_paper_chart_plot(c), path, PNG_ZOOM, e);
		ob_paper_chart_free(c);
	}
	return fine;
}

static void write_page(const ob_paper_matter *m, FILE *f)
{
	static const ob_page_slot slots[] = {
		{ "style", write_style },
		{ "cards", ob_paper_part_cards },
		{ "busy", ob_paper_part_busy },
		{ "claims", ob_paper_part_claims },
		{ "medians", ob_paper_part_medians },
		{ "figures", write_figures },
		{ "tables", ob_paper_part_tables },
		{ "never", ob_paper_part_never },
		{ "itself", ob_paper_part_itself },
		{ "setting", ob_paper_part_setting },
	};
	ob_page page = { .out = f };
	ob_page_fill(&page, text_paper_html, slots, sizeof slots / sizeof *slots, m);
}

static void write_figures_of_all(const ob_paper_matter *m, FILE *f)
{
	ob_paper_write_csv(m->here, f);
}

static bool write_file(const ob_paper_matter *m, const char *dir, const char *name,
		       void (*write)(const ob_paper_matter *, FILE *), ob_error *e)
{
	char path[PATH];
	snprintf(path, sizeof path, "%s/%s", dir, name);
	FILE *f = fopen(path, "we");
	if (f)
		write(m, f);
	bool fine = f && !ferror(f);
	fine = (!f || fclose(f) == 0) && fine;
	return fine || ob_fail(e, "cannot write %s: %m", path);
}

bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e)
{
	char path[PATH];
	if (snprintf(path, sizeof path, "%s/plots", dir) >= PATH - 100)
		return ob_fail(e, "the name of the folder is too long: %s", dir);
	if (mkdir(path, 0777) != 0 && errno != EEXIST)
		return ob_fail(e, "cannot make the folder %s: %m", path);
	ob_paper_matter m = ob_paper_matter_make(r);
	bool fine = write_file(&m, dir, "results.csv", write_figures_of_all, e) &&
		    write_file(&m, dir, "tables.md", ob_paper_write_markdown, e) &&
		    write_file(&m, dir, "report.html", write_page, e) && write_plots(&m, dir, e);
	ob_paper_matter_finish(&m);
	return fine;
}
