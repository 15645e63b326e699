// Lines of a file of records, for appending to it. Internal to the module.
#ifndef OB_EXPERIMENT_RESULT_LINE_H
#define OB_EXPERIMENT_RESULT_LINE_H

#include "experiment/experiment.h"

void ob_result_head_write(FILE *f, const ob_experiment *x);
void ob_result_line_write(FILE *f, const ob_experiment *x, const ob_record *r);

#endif
