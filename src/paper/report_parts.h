// The parts of the page, each written where its slot stands in report/paper.html. "with" is the ob_paper_matter.
#ifndef OB_PAPER_REPORT_PARTS_H
#define OB_PAPER_REPORT_PARTS_H

#include "experiment/page.h"

void ob_paper_part_cards(ob_page *p, const void *with);
void ob_paper_part_busy(ob_page *p, const void *with); // a warning, where the machine was not free
void ob_paper_part_claims(ob_page *p, const void *with);
void ob_paper_part_medians(ob_page *p, const void *with); // of all scenarios
void ob_paper_part_tables(ob_page *p, const void *with); // the paper's
void ob_paper_part_never(ob_page *p, const void *with); // what it never ran
void ob_paper_part_itself(ob_page *p, const void *with); // what its figures say of themselves
void ob_paper_part_setting(ob_page *p, const void *with);

#endif
