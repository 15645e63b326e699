// Pages of the segment: reserved before they are touched; and the reaction to missing ones.
//
// A segment is sparse (layout.h), and its memory file system may be full. Touching a page that it cannot provide raises
// SIGBUS, in the middle of a step. So code that is about to use more of an area first reserves its pages, which can
// fail with an error:
//
//   at the start     header, gate, workers' cells; all that the scene's objects have
//   later            areas that grow with the number of neighbours and contacts, in chunks, before they are written;
//                    data of further objects, when they are added
//
// Each process remembers its reserved chunks for itself: reserving present pages again does no harm.
//
// Truncating the file takes away pages that were there. Programs that call ob_pages_guard, host and readers alike, then
// end with one line that reports it, instead of a signal.
//
// Thread-safety: any thread.
#ifndef OB_TABLE_PAGES_H
#define OB_TABLE_PAGES_H

#include "table/layout.h"

// Makes elements first .. first + count - 1 of an area writable. Returns false if the memory file system is full.
// Elements beyond the area's end are ignored.
bool ob_pages_take(ob_universe *u, ob_area area, uint64_t first, uint64_t count);
// Same for the areas that every universe uses from its creation on.
bool ob_pages_take_first(ob_universe *u);

// Tracks the universes mapped by this process, for the guard. ob_pages_track returns false if there are too many;
// further ones are not guarded.
bool ob_pages_track(const ob_universe *u);
void ob_pages_forget(const ob_universe *u);

#endif
