// The parts of the report's page, each written where its slot stands in a template. "with" is the ob_digest; for a
// case's own parts, an ob_report_case.
#ifndef OB_LAB_REPORT_PARTS_H
#define OB_LAB_REPORT_PARTS_H

#include "lab/digest.h"
#include "experiment/page.h"

typedef struct ob_report_case {
	const ob_digest *digest;
	const ob_case *of;
} ob_report_case;

void ob_report_cards(ob_page *p, const void *with);
void ob_report_verdict(ob_page *p, const void *with);
void ob_report_equal(ob_page *p, const void *with); // cost at equal error
void ob_report_rows(ob_page *p, const void *with); // every figure that has a target

void ob_report_title(ob_page *p, const void *with);
void ob_report_badge(ob_page *p, const void *with);
void ob_report_reference(ob_page *p, const void *with);
void ob_report_figures(ob_page *p, const void *with); // all engines at usual settings
void ob_report_runs(ob_page *p, const void *with); // all settings

#endif
