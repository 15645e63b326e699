// Words of the paper's figures.
#ifndef OB_PAPER_WORDS_H
#define OB_PAPER_WORDS_H

#include "experiment/words.h"
#include "paper/results.h"

ob_word ob_word_value(double v, ob_paper_metric m); // in the metric's unit: "1.25 ms"
ob_word ob_word_ratio(const ob_estimate *r); // "2.1 times (1.9 to 2.4)"
ob_word ob_word_exponent(const ob_line *l); // "n^0.98 (0.95 to 1.01)"
ob_word ob_word_odds(double logarithm); // "12 to 1", "more than a million to 1"

#endif
