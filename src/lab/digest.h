// What a report asks of results: who took part, what holds at usual settings, who is cheaper at equal error. Pure but
// for ob_digest_make; any thread.
#ifndef OB_LAB_DIGEST_H
#define OB_LAB_DIGEST_H

#include "lab/result.h"

enum { OB_DIGEST_ENGINES = 24, OB_DIGEST_ROWS = 32 };

typedef struct ob_digest {
	const ob_results *results;
	size_t engines;
	const ob_engine_kind *engine[OB_DIGEST_ENGINES]; // in the order of the results
	const ob_engine_kind *own; // obsim itself; NULL: it did not take part
} ob_digest;

ob_digest ob_digest_make(const ob_results *r);

bool ob_digest_is_obsim(const ob_engine_kind *k); // or one of its variants, as opposed to other engines
size_t ob_digest_count_others(const ob_digest *d); // engines that took part and are not obsim
int ob_digest_style(const ob_digest *d, const ob_engine_kind *k); // of its curves, the same in every report

// At an engine's usual settings; NULL: was not run
const ob_result *ob_digest_usual(const ob_digest *d, const ob_case *c, const ob_engine_kind *k);
// The result that a case's targets are promised for; NULL: was not run
const ob_result *ob_digest_promised(const ob_digest *d, const ob_case *c);
bool ob_digest_ran(const ob_digest *d, const ob_case *c); // with any engine

bool ob_digest_has_target(const ob_case *c, uint32_t figure);
bool ob_digest_meets(const ob_result *r, uint32_t figure); // false, too, where the run failed
bool ob_digest_meets_all(const ob_result *r);
// Worst of figure over target, of those with a target: <= 1 where all are met. Infinite where it failed, or where all
// that is missed is a target of 0; NAN without targets.
double ob_digest_ratio(const ob_result *r);

// The other engine that has the smallest figure at its usual settings, failed runs left out; NULL: none
const ob_result *ob_digest_best_other(const ob_digest *d, const ob_case *c, uint32_t figure);

typedef struct ob_digest_rows {
	int measured, met; // rows of the table of hard cases
} ob_digest_rows;
ob_digest_rows ob_digest_count_rows(const ob_digest *d);

// Cost at equal error of one case: at its target, or where no engine gets there, at the least error of obsim's.
typedef struct ob_digest_equal {
	double error; // in the unit of figure 0; NAN: there is none
	bool is_target;
	double cost[OB_DIGEST_ENGINES]; // s of CPU per body and simulated second, by engine; NAN = never
	double own; // obsim's
	bool ahead; // obsim gets there, and none of the others at less cost
} ob_digest_equal;
ob_digest_equal ob_digest_compare(const ob_digest *d, const ob_case *c);
// The result with which an engine has its least error in a case; NULL: all failed
const ob_result *ob_digest_finest(const ob_digest *d, const ob_case *c, const ob_engine_kind *k);

#endif
