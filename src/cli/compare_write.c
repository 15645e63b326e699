// A comparison for programs: JSON with every run's report, CSV with a line for each figure of each way.
#include <inttypes.h>
#include <math.h>

#include "cli/compare.h"
#include "cli/version.h"

static void write_figures(const ob_cell *cell, ob_json *j)
{
	ob_json_open(j, "figures");
	for (int k = 0; k < OB_FIGURE_KINDS; k++) {
		ob_spread x = ob_spread_of(cell, k);
		ob_json_open(j, ob_figure_table[k].key);
		ob_json_number(j, "median", x.median);
		ob_json_number(j, "low", x.low);
		ob_json_number(j, "high", x.high);
		ob_json_close(j);
	}
	ob_json_close(j);
}

static void write_way(const ob_comparison *c, const ob_section *s, int w, ob_json *j)
{
	const ob_cell *cell = &s->cell[w];
	ob_json_open(j, ob_way_table[w].key);
	ob_json_string(j, "narrow", ob_way_table[w].other_narrow ? c->other : c->narrow);
	ob_json_count(j, "workers", cell->workers);
	write_figures(cell, j);
	ob_json_open_list(j, "samples");
	for (uint32_t i = 0; i < cell->samples; i++) {
		ob_json_open(j, NULL);
		ob_report_write_members(&cell->sample[i], j);
		ob_json_close(j);
	}
	ob_json_close_list(j);
	ob_json_close(j);
}

static void write_section(const ob_comparison *c, const ob_section *s, ob_json *j)
{
	ob_verdict v;
	ob_verdict_make(&v, c, s);
	ob_json_open(j, NULL);
	ob_json_string(j, "define", s->define);
	ob_json_count(j, "objects", s->objects);
	ob_json_true(j, "hashes_agree", ob_section_agrees(s));
	ob_json_string(j, "headline", v.headline);
	ob_json_string(j, "answer", v.answer);
	ob_json_open(j, "runs");
	for (int w = 0; w < OB_WAYS; w++)
		if (ob_cell_is_done(s, w))
			write_way(c, s, w, j);
	ob_json_close(j);
	for (ob_way_state state = OB_WAY_SKIPPED; state <= OB_WAY_FAILED; state += OB_WAY_FAILED - OB_WAY_SKIPPED) {
		ob_json_open(j, state == OB_WAY_SKIPPED ? "skipped" : "failed");
		for (int w = 0; w < OB_WAYS; w++) {
			if (s->cell[w].state == state)
				ob_json_string(j, ob_way_table[w].key, s->cell[w].why);
		}
		ob_json_close(j);
	}
	ob_json_close(j);
}

void ob_comparison_write_json(const ob_comparison *c, FILE *f)
{
	ob_json j = { .f = f };
	ob_json_open(&j, NULL);
	ob_json_string(&j, "scene", c->scene);
	ob_json_string(&j, "options", c->options);
	ob_json_string(&j, "commit", ob_version_commit);
	ob_json_string(&j, "machine", c->machine);
	ob_json_count(&j, "repeats", c->repeats);
	ob_json_open_list(&j, "sections");
	for (uint32_t i = 0; i < c->sections; i++)
		write_section(c, &c->section[i], &j);
	ob_json_close_list(&j);
	ob_json_close(&j);
}

static void put_number(FILE *f, double x)
{
	fputc(',', f);
	if (isfinite(x))
		fprintf(f, "%.9g", x);
}

void ob_comparison_write_csv(const ob_comparison *c, FILE *f)
{
	fputs("define,objects,way,narrow,load,workers,figure,unit,runs,median,low,high\n", f);
	for (uint32_t i = 0; i < c->sections; i++) {
		const ob_section *s = &c->section[i];
		for (int w = 0; w < OB_WAYS; w++)
			for (int k = 0; ob_cell_is_done(s, w) && k < OB_FIGURE_KINDS; k++) {
				ob_spread x = ob_spread_of(&s->cell[w], k);
				fprintf(f, "\"%s\",%" PRIu32 ",%s,%s,%" PRIu64 ",%" PRIu32 ",%s,%s,%zu", s->define,
					s->objects, ob_way_table[w].key,
					ob_way_table[w].other_narrow ? c->other : c->narrow, c->load,
					s->cell[w].workers, ob_figure_table[k].key, ob_figure_table[k].unit, x.n);
				put_number(f, x.median);
				put_number(f, x.low);
				put_number(f, x.high);
				fputc('\n', f);
			}
	}
}
