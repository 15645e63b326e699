#include <math.h>

#include "paper/table.h"
#include "paper/words.h"

static void write_claims(const ob_paper_matter *m, FILE *f)
{
	fputs("| The paper says | Verdict | Measured | Its own tables |\n|---|---|---|---|\n", f);
	for (int i = 0; i < OB_PAPER_CLAIMS; i++) {
		const ob_paper_claim *c = &m->claim[i];
		fprintf(f, "| %s (%s) | **%s**%s%s | %s | %s |\n", c->says, c->where, ob_paper_verdict_text(c->verdict),
			*c->condition ? " " : "", c->condition, c->because, c->itself);
	}
}

static void write_number(FILE *f, double v)
{
	fprintf(f, " %s |", ob_word_number(v).text);
}

static void write_table(const ob_paper_matter *m, const ob_paper_table *t, FILE *f)
{
	fprintf(f, "\n## %s\n\n| Experiment |", t->title);
	for (size_t i = 0; i < t->columns; i++)
		fprintf(f, " %s (%s) |", t->column[i].head, ob_paper_quantities[t->column[i].quantity].unit);
	fputs("\n|---|", f);
	for (size_t i = 0; i < t->columns; i++)
		fputs("---:|", f);
	for (uint32_t row = 0; row < ob_paper_rows(m); row++) {
		fprintf(f, "\n| %u |", row + 1);
		for (size_t i = 0; i < t->columns; i++)
			write_number(f, ob_paper_cell(m, t, i, row));
	}
	fputs("\n| mean (95 %) |", f);
	for (size_t i = 0; i < t->columns; i++) {
		ob_statistics s = ob_paper_foot(m, t, i);
		fprintf(f, " %s (%s to %s) |", ob_word_number(s.mean).text, ob_word_number(s.mean_low).text,
			ob_word_number(s.mean_high).text);
	}
	fputc('\n', f);
}

void ob_paper_write_markdown(const ob_paper_matter *m, FILE *f)
{
	fprintf(f, "# The paper's claims, measured\n\n%s; obsim %s; %u experiments with %u boxes.\n\n",
		m->here->machine, m->here->commit, m->here->experiments, m->here->objects);
	write_claims(m, f);
	for (size_t i = 0; i < OB_PAPER_TABLES; i++)
		write_table(m, &ob_paper_tables[i], f);
}

// What has commas or quotes in it stands in quotes (RFC 4180).
static void write_text(const char *text, FILE *f)
{
	fputc('"', f);
	for (; *text; text++)
		fprintf(f, *text == '"' ? "\"\"" : "%c", *text);
	fputc('"', f);
}

void ob_paper_write_csv(const ob_paper_results *r, FILE *f)
{
	fputs("scenario,series,experiment,objects,seed", f);
	for (int q = 0; q < OB_PAPER_QUANTITIES; q++)
		fprintf(f, ",%s", ob_paper_quantities[q].key);
	fputs(",failed\n", f);
	for (size_t i = 0; i < r->count; i++) {
		const ob_paper_sample *s = &r->sample[i];
		fprintf(f, "%s,%s,%u,%u,%llu", ob_paper_setups[s->scenario].key, s->growth ? "growth" : "experiment",
			s->experiment + 1, s->objects, (unsigned long long)s->seed);
		for (int q = 0; q < OB_PAPER_QUANTITIES; q++) {
			double v = ob_paper_value(s, q);
			fprintf(f, isfinite(v) ? ",%.9g" : ",", v);
		}
		fputc(',', f);
		if (*s->failed)
			write_text(s->failed, f);
		fputc('\n', f);
	}
}
