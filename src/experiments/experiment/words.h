// Texts of figures: numbers that people can read, with units; sentences made of them. Pure functions; any thread.
#ifndef OB_EXPERIMENT_WORDS_H
#define OB_EXPERIMENT_WORDS_H

#include "experiment/experiment.h"

typedef struct ob_word {
	char text[80];
} ob_word;

// A number of three digits with its unit: "0.5 mm²" from "mm^2"; unit "1" = a bare number; a dash for NaN.
ob_word ob_word_quantity(double v, const char *unit);
ob_word ob_word_number(double v); // the same, bare
ob_word ob_word_metric(double v, const ob_metric *m); // in its unit for people
ob_word ob_word_unit(const char *unit); // alone, with superscript digits

// Appends to the text in an array, which is cut at its end.
#define OB_SAY(to, ...) ob_say(to, sizeof(to), __VA_ARGS__)
void ob_say(char *to, size_t room, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Prints lines of at most this width behind "before", unless a word is longer.
void ob_word_wrap(FILE *f, const char *before, const char *text, size_t width);

#endif
