#include "paper/table.h"

#include <math.h>

#define PAPER(head, quantity) \
	{ \
		head, true, quantity \
	}
#define HERE(head, quantity) \
	{ \
		head, false, quantity \
	}
#define RUNTIME_COLUMNS \
	HERE("step", OB_PAPER_STEP), HERE("all simulators", OB_PAPER_TOTAL), HERE("one simulator", OB_PAPER_ONE)

const ob_paper_table ob_paper_tables[OB_PAPER_TABLES] = {
	{ "table-1",
	  "Table 1. The common environment (scenario 1)",
	  OB_PAPER_COMMON,
	  6,
	  { PAPER("runtime, paper", OB_PAPER_STEP), HERE("runtime", OB_PAPER_STEP),
	    PAPER("frames, paper", OB_PAPER_FPS), HERE("frames", OB_PAPER_FPS), PAPER("CPU, paper", OB_PAPER_CPU),
	    HERE("CPU", OB_PAPER_CPU) } },
	{ "table-2",
	  "Table 2. The common environment with the added load",
	  OB_PAPER_COMMON_LOAD,
	  6,
	  { PAPER("runtime, paper", OB_PAPER_STEP), HERE("runtime", OB_PAPER_STEP),
	    PAPER("frames, paper", OB_PAPER_FPS), HERE("frames", OB_PAPER_FPS), PAPER("CPU, paper", OB_PAPER_CPU),
	    HERE("CPU", OB_PAPER_CPU) } },
	{ "table-3",
	  "Table 3. Runtime of OBS (scenario 2)",
	  OB_PAPER_OBS,
	  4,
	  { PAPER("runtime, paper", OB_PAPER_STEP), RUNTIME_COLUMNS } },
	{ "table-4",
	  "Table 4. Frame rates of OBS",
	  OB_PAPER_OBS,
	  2,
	  { PAPER("frames, paper", OB_PAPER_FPS), HERE("frames", OB_PAPER_FPS) } },
	{ "table-5",
	  "Table 5. CPU usage of OBS",
	  OB_PAPER_OBS,
	  3,
	  { PAPER("CPU, paper", OB_PAPER_CPU), HERE("CPU of all simulators", OB_PAPER_CPU),
	    HERE("CPU of viewer and host", OB_PAPER_VIEWER) } },
	{ "obs-load",
	  "OBS with the added load, which the paper never ran",
	  OB_PAPER_OBS_LOAD,
	  5,
	  { RUNTIME_COLUMNS, HERE("frames", OB_PAPER_FPS), HERE("CPU", OB_PAPER_CPU) } },
	{ "obs-obb",
	  "OBS with OBB, which the paper never ran",
	  OB_PAPER_OBS_OBB,
	  5,
	  { RUNTIME_COLUMNS, HERE("frames", OB_PAPER_FPS), HERE("CPU", OB_PAPER_CPU) } },
};

ob_paper_matter ob_paper_matter_make(const ob_paper_results *r)
{
	ob_paper_matter m = { .here = r, .paper = ob_paper_published() };
	ob_paper_judge(r, m.claim);
	return m;
}

void ob_paper_matter_finish(ob_paper_matter *m)
{
	ob_paper_results_finish(&m->paper);
}

const ob_paper_results *ob_paper_source(const ob_paper_matter *m, const ob_paper_column *c)
{
	return c->paper ? &m->paper : m->here;
}

uint32_t ob_paper_rows(const ob_paper_matter *m)
{
	return m->here->experiments > m->paper.experiments ? m->here->experiments : m->paper.experiments;
}

double ob_paper_cell(const ob_paper_matter *m, const ob_paper_table *t, size_t column, uint32_t row)
{
	const ob_paper_column *c = &t->column[column];
	const ob_paper_sample *s = ob_paper_find(ob_paper_source(m, c), t->scenario, row);
	return s ? ob_paper_value(s, c->quantity) * ob_paper_quantities[c->quantity].scale : NAN;
}

ob_statistics ob_paper_foot(const ob_paper_matter *m, const ob_paper_table *t, size_t column)
{
	const ob_paper_column *c = &t->column[column];
	ob_statistics s = ob_paper_summarise(ob_paper_source(m, c), t->scenario, c->quantity);
	double scale = ob_paper_quantities[c->quantity].scale;
	s.mean *= scale;
	s.mean_low *= scale;
	s.mean_high *= scale;
	return s;
}
