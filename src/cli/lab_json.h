// The lab's results for other programs.
#ifndef OB_CLI_LAB_JSON_H
#define OB_CLI_LAB_JSON_H

#include <stdio.h>

#include "lab/result.h"

void ob_lab_write_json(const ob_results *r, FILE *f);

#endif
