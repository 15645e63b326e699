// The paper's figures with ours in them.
#ifndef OB_PAPER_CHART_H
#define OB_PAPER_CHART_H

#include "paper/table.h"
#include "plot/plot.h"

enum { OB_PAPER_CHARTS = 6 };

typedef struct ob_paper_chart ob_paper_chart;

// What a chart is called: in files, and above the figure
const char *ob_paper_chart_name(int chart);
const char *ob_paper_chart_caption(int chart);
// NULL: nothing to show, or no memory. One thread at a time per chart.
ob_paper_chart *ob_paper_chart_make(const ob_paper_matter *m, int chart);
const ob_plot *ob_paper_chart_plot(const ob_paper_chart *c);
void ob_paper_chart_free(ob_paper_chart *c);

#endif
