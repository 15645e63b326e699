// How a look at a universe reads as lines of text.
#ifndef OB_CLI_TOP_VIEW_H
#define OB_CLI_TOP_VIEW_H

#include <stdio.h>

#include "cli/top_sample.h"

typedef struct ob_top_view {
	int columns, lines; // of the screen; lines 0 = as many as it takes
	bool workers; // show the workers at length, else the objects
	bool by_speed; // fastest objects first, else by id
	uint32_t scroll; // first record shown
	int written; // lines, of this look
} ob_top_view;

// Sorts s's objects as the view wants them, brings scroll into range, and writes at most view->lines lines, each with
// a final newline, none wider than view->columns. Text from the universe is made harmless to a terminal.
void ob_top_view_write(ob_top_view *view, ob_top_sample *s, FILE *f);

#endif
