// The paper's claims, and verdicts from the measurements. The verdict and every figure in its text follow from the data
// by the rules in claims.c. Pure functions.
#ifndef OB_PAPER_CLAIMS_H
#define OB_PAPER_CLAIMS_H

#include "experiment/table.h"
#include "paper/results.h"

typedef enum ob_paper_verdict {
	OB_PAPER_HOLDS,
	OB_PAPER_ONLY_IF,
	OB_PAPER_FAILS,
	OB_PAPER_OPEN, // the measurements are inconclusive
	OB_PAPER_VERDICTS
} ob_paper_verdict;

enum { OB_PAPER_CLAIMS = 8 };

typedef struct ob_paper_claim {
	const char *key, *says, *where; // the paper's statement, and its place
	ob_paper_verdict verdict;
	char condition[320]; // ONLY_IF: text after "only if"
	char because[1000]; // measured evidence
	char itself[400]; // evidence from the paper's own tables
} ob_paper_claim;

// "holds", "holds only if", ..
const char *ob_paper_verdict_text(ob_paper_verdict v);
void ob_paper_judge(const ob_paper_results *r, ob_paper_claim claim[OB_PAPER_CLAIMS]);

// Words of the figures.
ob_word ob_word_value(double v, ob_paper_metric m); // in the metric's unit: "1.25 ms"
ob_word ob_word_ratio(const ob_estimate *r); // "2.1 times (1.9 to 2.4)"
ob_word ob_word_exponent(const ob_line *l); // "n^0.98 (0.95 to 1.01)"
ob_word ob_word_odds(double logarithm); // "12 to 1", "more than a million to 1"

#endif
