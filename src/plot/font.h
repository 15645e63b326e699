// Font metrics: extents of texts from a table, so that a diagram has the same layout on every machine, with any fonts.
// The table holds the widest of the fonts that may show a text, so that texts need not be squeezed (Helvetica, Arial
// and Liberation Sans are alike; DejaVu Sans and Verdana are wider). Pure; any thread.
#ifndef OB_PLOT_FONT_H
#define OB_PLOT_FONT_H

#include <stdbool.h>
#include <stddef.h>

#define OB_FONT_FAMILY "Liberation Sans, Arial, Helvetica, DejaVu Sans, sans-serif"

// Relative to the font size: from the base line to the top of a capital or an ascender, and to the bottom of a
// descender.
#define OB_FONT_ASCENT .74
#define OB_FONT_DESCENT .21

// Width (px) at a font size in px: an upper bound over the fonts. A byte that is not UTF-8 counts as a letter.
double ob_font_width(const char *text, double size, bool bold);

// Copies text into to[room] as valid UTF-8 without control characters; cuts at a whole letter if it does not fit.
void ob_font_clean_text(const char *text, char *to, size_t room);

// Copies as many whole words of *text as fit into width px, at least one letter, and moves *text behind them. With
// "last", takes the rest, and cuts it with an ellipsis if it is too wide. Returns false if nothing was left.
bool ob_font_fit_line(const char **text, double width, double size, bool bold, bool last, char *line, size_t room);

#endif
