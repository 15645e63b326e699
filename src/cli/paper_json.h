// What obsim paper tells other programs.
#ifndef OB_CLI_PAPER_JSON_H
#define OB_CLI_PAPER_JSON_H

#include <stdio.h>

#include "paper/sample.h"

// Verdicts, ratios, fits and all runs
void ob_paper_write_json(const ob_paper_results *r, FILE *f);

#endif
