// How wide text is, in the letter shapes of Helvetica and of those made to its measure (Arial, Liberation Sans): from
// a table, so that a diagram is laid out alike on every machine, whatever fonts it has. Pure; any thread.
#ifndef OB_PLOT_LETTERS_H
#define OB_PLOT_LETTERS_H

#include <stdbool.h>
#include <stddef.h>

#define OB_LETTERS_FAMILY "Liberation Sans, Arial, Helvetica, sans-serif"

// Of the font size: from the base line to the top of a capital or an ascender, and to the bottom of a descender
#define OB_LETTERS_ASCENT .74
#define OB_LETTERS_DESCENT .21

// px, at a font size in px. What is not UTF-8 counts as one letter a byte.
double ob_letters_width(const char *text, double size, bool bold);

// Copies text into to[room] as valid UTF-8 without control characters; cut at a whole letter where it does not fit.
void ob_letters_clean(const char *text, char *to, size_t room);

// Copies as many whole words of *text as fit into width px, at least one letter, and moves *text behind them. With
// "last" all that is left is taken, cut with an ellipsis where it is too wide. false: nothing was left.
bool ob_letters_line(const char **text, double width, double size, bool bold, bool last, char *line, size_t room);

#endif
