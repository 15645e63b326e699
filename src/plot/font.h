// Font metrics: how much room a text needs, from a table, so that a diagram is laid out alike on every machine, whatever
// fonts it has. The table holds the widest of the fonts that a text may be shown in (Helvetica, Arial and Liberation
// Sans are alike; DejaVu Sans and Verdana are wider), so that texts need not be squeezed. Pure; any thread.
#ifndef OB_PLOT_FONT_H
#define OB_PLOT_FONT_H

#include <stdbool.h>
#include <stddef.h>

#define OB_FONT_FAMILY "Liberation Sans, Arial, Helvetica, DejaVu Sans, sans-serif"

// Of the font size: from the base line to the top of a capital or an ascender, and to the bottom of a descender
#define OB_FONT_ASCENT .74
#define OB_FONT_DESCENT .21

// px, at a font size in px; a text is at most so wide in any of the fonts. A byte that is not UTF-8 counts as a letter.
double ob_font_width(const char *text, double size, bool bold);

// Copies text into to[room] as valid UTF-8 without control characters; cut at a whole letter where it does not fit.
void ob_font_clean_text(const char *text, char *to, size_t room);

// Copies as many whole words of *text as fit into width px, at least one letter, and moves *text behind them. With
// "last" all that is left is taken, cut with an ellipsis where it is too wide. false: nothing was left.
bool ob_font_fit_line(const char **text, double width, double size, bool bold, bool last, char *line, size_t room);

#endif
