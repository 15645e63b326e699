// A line of text on a picture.
#ifndef OB_PLOT_CAPTION_H
#define OB_PLOT_CAPTION_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/error.h>

// Writes title and time on a dark ground at the lower left of a picture (rgba: width * height * 4 bytes, top row
// first). The size is legible at the picture's height. The same text gives the same pixels on one machine. Any thread.
bool ob_plot_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e);

#endif
