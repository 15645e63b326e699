// Sentences with figures. Each function appends to a text in an array, and truncates at its end.
#ifndef OB_PAPER_WORDS_H
#define OB_PAPER_WORDS_H

#include "paper/results.h"

#define OB_SAY(to, ...) ob_say(to, sizeof(to), __VA_ARGS__)
void ob_say(char *to, size_t room, const char *format, ...) __attribute__((format(printf, 3, 4)));

typedef struct ob_word {
	char text[80];
} ob_word;

// Three digits; a dash for unknown values.
ob_word ob_word_number(double v);
ob_word ob_word_value(double v, ob_paper_metric m); // in the metric's unit: "1.25 ms"
ob_word ob_word_ratio(const ob_paper_ratio *r); // "2.1 times (1.9 to 2.4)"
ob_word ob_word_exponent(const ob_line *l); // "n^0.98 (0.95 to 1.01)"
ob_word ob_word_odds(double logarithm); // "12 to 1", "more than a million to 1"

#endif
