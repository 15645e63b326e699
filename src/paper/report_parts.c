#include "paper/report_parts.h"

#include <math.h>

#include "paper/table.h"
#include "paper/trial.h"
#include "paper/words.h"

static const char *const verdict_class[OB_PAPER_VERDICTS] = { "met", "partly", "missed", "open" };

void ob_paper_part_cards(ob_page *p, const void *with)
{
	static const char *const texts[OB_PAPER_VERDICTS] = { "hold", "hold only under a condition", "do not hold",
							      "cannot be told from these runs" };
	const ob_paper_matter *m = with;
	int count[OB_PAPER_VERDICTS] = { 0 };
	for (int i = 0; i < OB_PAPER_CLAIMS; i++)
		count[m->claim[i].verdict]++;
	for (int v = 0; v < OB_PAPER_VERDICTS; v++)
		if (v != OB_PAPER_OPEN || count[v])
			ob_page_markup(p, "<li><b>%d of %d</b><span>claims %s</span></li>\n", count[v], OB_PAPER_CLAIMS,
				       texts[v]);
}

void ob_paper_part_busy(ob_page *p, const void *with)
{
	static const double free_enough = .3;
	const ob_paper_matter *m = with;
	if (m->here->busy > free_enough)
		ob_page_markup(
			p,
			"<p class=\"warning\"><strong>The machine was busy with other work</strong> before these runs "
			"began (load average %.1f). The step, the frame rate and the pace suffer from that, CPU "
			"times much less.</p>\n",
			m->here->busy);
}

void ob_paper_part_claims(ob_page *p, const void *with)
{
	const ob_paper_matter *m = with;
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &m->claim[i];
		ob_page_markup(p, "<tr id=\"claim-%s\"><th scope=\"row\">", c->key);
		ob_page_text(p, c->says);
		ob_page_markup(p, "<small>%s</small></th><td><strong class=\"verdict %s\">%s</strong>", c->where,
			       verdict_class[c->verdict], ob_paper_verdict_text(c->verdict));
		if (*c->condition)
			ob_page_markup(p, " ");
		ob_page_text(p, c->condition);
		ob_page_markup(p, "</td><td>");
		ob_page_text(p, c->because);
		ob_page_markup(p, "</td><td>");
		ob_page_text(p, c->itself);
		ob_page_markup(p, "</td></tr>\n");
	}
}

// "1.2" and, small, "1.1 to 1.3"
static void write_middle(ob_page *p, double middle, double low, double high)
{
	ob_page_markup(p, "<td class=\"n\">");
	ob_page_number(p, middle);
	if (isfinite(low)) {
		ob_page_markup(p, "<small>");
		ob_page_number(p, low);
		ob_page_markup(p, " to ");
		ob_page_number(p, high);
		ob_page_markup(p, "</small>");
	}
	ob_page_markup(p, "</td>");
}

void ob_paper_part_medians(ob_page *p, const void *with)
{
	static const ob_paper_quantity shown[] = { OB_PAPER_STEP,  OB_PAPER_TOTAL, OB_PAPER_ONE, OB_PAPER_BUSIEST,
						   OB_PAPER_CPU,   OB_PAPER_PACE,  OB_PAPER_FPS, OB_PAPER_VIEWER,
						   OB_PAPER_TESTS, OB_PAPER_MEMORY };
	enum { SHOWN = sizeof shown / sizeof *shown };
	const ob_paper_matter *m = with;
	ob_page_markup(p, "<div class=\"scroll\"><table>\n<thead><tr><th></th>");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++)
		ob_page_markup(p, "<th scope=\"col\" class=\"n\">%s</th>", ob_paper_setups[s].title);
	ob_page_markup(p, "</tr></thead>\n<tbody>\n");
	for (int i = 0; i < SHOWN; i++) {
		const ob_paper_quantity_def *def = &ob_paper_quantities[shown[i]];
		ob_page_markup(p, "<tr><th scope=\"row\">%s<small>%s</small></th>", def->title,
			       def->unit[0] == '1' && !def->unit[1] ? "" : def->unit);
		for (int s = 0; s < OB_PAPER_SCENARIOS; s++) {
			ob_statistics of = ob_paper_summarise(m->here, s, shown[i]);
			write_middle(p, of.median * def->scale, of.median_low * def->scale,
				     of.median_high * def->scale);
		}
		ob_page_markup(p, "</tr>\n");
	}
	ob_page_markup(p, "</tbody></table></div>\n<dl>\n");
	for (int s = 0; s < OB_PAPER_SCENARIOS; s++)
		ob_page_markup(p, "<dt>%s</dt><dd>%s</dd>\n", ob_paper_setups[s].title, ob_paper_setups[s].what);
	ob_page_markup(p, "</dl>\n");
}

static void write_table(ob_page *p, const ob_paper_matter *m, const ob_paper_table *t)
{
	ob_page_markup(p, "<section id=\"%s\">\n<h3>%s</h3>\n<div class=\"scroll\"><table class=\"slim\">\n", t->id,
		       t->title);
	ob_page_markup(p, "<thead><tr><th scope=\"col\">experiment</th>");
	for (size_t i = 0; i < t->columns; i++)
		ob_page_markup(p, "<th scope=\"col\" class=\"n%s\">%s<small>%s</small></th>",
			       t->column[i].paper ? " theirs" : "", t->column[i].head,
			       ob_paper_quantities[t->column[i].quantity].unit);
	ob_page_markup(p, "</tr></thead>\n<tbody>\n");
	for (uint32_t row = 0; row < ob_paper_rows(m); row++) {
		ob_page_markup(p, "<tr><td>%u</td>", row + 1);
		for (size_t i = 0; i < t->columns; i++) {
			ob_page_markup(p, "<td class=\"n%s\">", t->column[i].paper ? " theirs" : "");
			ob_page_number(p, ob_paper_cell(m, t, i, row));
			ob_page_markup(p, "</td>");
		}
		ob_page_markup(p, "</tr>\n");
	}
	ob_page_markup(p, "<tr class=\"foot\"><th scope=\"row\">mean, 95&nbsp;%%</th>");
	for (size_t i = 0; i < t->columns; i++) {
		ob_statistics s = ob_paper_foot(m, t, i);
		write_middle(p, s.mean, s.mean_low, s.mean_high);
	}
	ob_page_markup(p, "</tr>\n</tbody></table></div>\n</section>\n");
}

static void write_tables(ob_page *p, const ob_paper_matter *m, bool printed)
{
	for (int i = 0; i < OB_PAPER_TABLES; i++)
		if (ob_paper_tables[i].column[0].paper == printed)
			write_table(p, m, &ob_paper_tables[i]);
}

void ob_paper_part_tables(ob_page *p, const void *with)
{
	write_tables(p, with, true);
}

// "With the load, OBS takes .. the CPU time that it takes without"
static void write_pair(ob_page *p, const ob_paper_matter *m, const char *what, ob_paper_scenario a, ob_paper_scenario b,
		       ob_paper_quantity q)
{
	ob_paper_ratio r = ob_paper_compare(m->here, a, b, q);
	ob_page_markup(p, "<li>%s: ", what);
	ob_page_text(p, ob_word_ratio(&r).text);
	ob_page_markup(p, ".</li>\n");
}

void ob_paper_part_never(ob_page *p, const void *with)
{
	ob_page_markup(p, "<ul>\n");
	write_pair(p, with, "CPU time of OBS with the load, against OBS without", OB_PAPER_OBS_LOAD, OB_PAPER_OBS,
		   OB_PAPER_TOTAL);
	write_pair(p, with, "CPU time of OBS with the load, against the common environment with it", OB_PAPER_OBS_LOAD,
		   OB_PAPER_COMMON_LOAD, OB_PAPER_TOTAL);
	write_pair(p, with, "CPU time of OBS with OBB, against OBS with AABB", OB_PAPER_OBS_OBB, OB_PAPER_OBS,
		   OB_PAPER_TOTAL);
	write_pair(p, with, "CPU time of OBS with OBB, against the common environment with OBB", OB_PAPER_OBS_OBB,
		   OB_PAPER_COMMON_OBB, OB_PAPER_TOTAL);
	write_pair(p, with, "the step of OBS with OBB, against that of the common environment with OBB",
		   OB_PAPER_OBS_OBB, OB_PAPER_COMMON_OBB, OB_PAPER_STEP);
	ob_page_markup(p, "</ul>\n");
	write_tables(p, with, false);
}

void ob_paper_part_itself(ob_page *p, const void *with)
{
	const ob_paper_matter *m = with;
	double busy[OB_PAPER_OBS + 1];
	for (int s = OB_PAPER_COMMON; s <= OB_PAPER_OBS; s++)
		busy[s] = ob_paper_summarise(&m->paper, s, OB_PAPER_STEP).mean *
			  ob_paper_summarise(&m->paper, s, OB_PAPER_FPS).mean;
	ob_page_markup(p, "Its runtime times its frame rate is ");
	ob_page_text(p, ob_word_number(busy[OB_PAPER_COMMON]).text);
	ob_page_markup(p, " in the common environment and ");
	ob_page_text(p, ob_word_number(busy[OB_PAPER_COMMON_LOAD]).text);
	ob_page_markup(p, " with the load: more than all of the time there is, so what its runtime measures cannot "
			  "have been done once in each frame.");
}

void ob_paper_part_setting(ob_page *p, const void *with)
{
	const ob_paper_matter *m = with;
	ob_page_markup(p, "<dt>Machine</dt><dd>");
	ob_page_text(p, m->here->machine);
	ob_page_markup(p, "</dd>\n<dt>obsim</dt><dd>commit <code>");
	ob_page_text(p, m->here->commit);
	ob_page_markup(p,
		       "</code></dd>\n<dt>Runs</dt><dd>%u experiments with %u boxes in each scenario, %zu runs in "
		       "all</dd>\n<dt>Step</dt><dd>%.3f&nbsp;s, %d substep; at most %d iterations or rounds</dd>\n",
		       m->here->experiments, m->here->objects, m->here->count, OB_PAPER_STEP_LENGTH, OB_PAPER_SUBSTEPS,
		       OB_PAPER_ROUNDS);
	if (*m->here->no_frames) {
		ob_page_markup(p, "<dt>No frames</dt><dd>");
		ob_page_text(p, m->here->no_frames);
		ob_page_markup(p, "</dd>\n");
	}
	for (size_t i = 0; i < m->here->count; i++) {
		const ob_paper_sample *s = &m->here->sample[i];
		if (!*s->failed)
			continue;
		ob_page_markup(p, "<dt>Failed</dt><dd>%s, %u objects, seed %llu: ", ob_paper_setups[s->scenario].title,
			       s->objects, (unsigned long long)s->seed);
		ob_page_text(p, s->failed);
		ob_page_markup(p, "</dd>\n");
	}
}
