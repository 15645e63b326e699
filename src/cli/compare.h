// A comparison: the ways to run one scene, and what came of each.
#ifndef OB_CLI_COMPARE_H
#define OB_CLI_COMPARE_H

#include "cli/report.h"

typedef struct ob_variant {
	const char *key; // in JSON
	const char *title; // in the table
	const char *arch, *isolation;
	bool each; // one worker per object, else the pool
	uint32_t objects_max; // each: with more objects it is not tried
} ob_variant;

typedef enum ob_variant_state { OB_VARIANT_SKIPPED, OB_VARIANT_DONE, OB_VARIANT_FAILED } ob_variant_state;

typedef struct ob_variant_result {
	ob_variant_state state;
	char why[256]; // unless done
	ob_report report; // if done
} ob_variant_result;

enum { OB_VARIANTS = 5 };
extern const ob_variant ob_variant_table[OB_VARIANTS]; // the monolith first

typedef struct ob_comparison {
	const char *scene;
	ob_variant_result result[OB_VARIANTS];
	bool measured_differs; // object simulators that were looked at each step ended in other bits
} ob_comparison;

// true when all object simulators that ran ended in the same bits; hash: the first's, "" if none ran
bool ob_comparison_agrees(const ob_comparison *c, const char **hash);
void ob_comparison_print(const ob_comparison *c, FILE *f);
void ob_comparison_write_json(const ob_comparison *c, FILE *f);

#endif
