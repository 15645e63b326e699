// Text on a picture: a caption, and who simulates what. By cairo, in a part of the program: obsim-cairo.so (base/part.h).
#ifndef OB_RENDER_CAPTION_H
#define OB_RENDER_CAPTION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/part.h"

// True if cairo is there; false and e with the package that is missing.
bool ob_caption_check(ob_error *e);

// Writes title and time on a dark ground at the lower left of a picture (rgba: width * height * 4 bytes, top row
// first). The size is legible at the picture's height. The same text gives the same pixels on one machine. Any thread.
bool ob_caption(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e);

typedef struct ob_strip_row {
	float colour[3]; // linear RGB
	char text[48]; // "worker 2, pid 4711"
	char tail[32]; // behind the bar
	double share; // of the bar that is filled; NaN: the bar is left out
} ob_strip_row;

// Place on a scale, from left to right.
typedef struct ob_strip_place {
	float colour[3]; // linear RGB
	uint32_t count; // a place with more is higher
} ob_strip_place;

typedef struct ob_strip {
	uint32_t rows, places; // places 0: no ribbon
	const ob_strip_row *row; // [rows]
	const ob_strip_place *place; // [places]
	char more[64], title[64]; // below the rows, "": nothing; above the ribbon
	const char *tick[5]; // below the ribbon, evenly from its left to its right end
} ob_strip;

// Paints the rows, and a ribbon below them, on a dark ground at the upper left. Likewise.
bool ob_caption_strip(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e);

typedef struct ob_caption_part {
	ob_part_head head;
	bool (*caption)(uint8_t *rgba, int width, int height, const char *title, const char *time, ob_error *e);
	bool (*strip)(uint8_t *rgba, int width, int height, const ob_strip *s, ob_error *e);
} ob_caption_part;

#endif
