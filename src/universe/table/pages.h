// Pages of the segment: reserved before they are touched; and the reaction to missing ones.
//
// A segment is sparse (layout.h), and its memory file system may be full. Touching a page that it cannot provide raises
// SIGBUS, in the middle of a step. So code that is about to use more of an area first reserves its pages, which can
// fail with an error:
//
//   at the start     header, gate, workers' cells; all that the scene's objects have
//   later            areas that grow with the number of neighbours and contacts, before they are written;
//                    data of further objects, when they are added
//
// Each process remembers its reserved pages for itself: reserving present pages again does no harm.
//
// Truncating the file takes away pages that were there. Programs that call ob_pages_guard, host and readers alike, then
// end with one line that reports it, instead of a signal.
//
// Thread-safety: any thread, unless told otherwise.
#ifndef OB_TABLE_PAGES_H
#define OB_TABLE_PAGES_H

#include "table/layout.h"

// Makes elements first .. first + count - 1 of an area writable. Returns false if the memory file system is full.
// Elements beyond the area's end are ignored.
bool ob_pages_take(ob_universe *u, ob_area area, uint64_t first, uint64_t count);
// Same for the areas that every universe uses from its creation on.
bool ob_pages_take_first(ob_universe *u);

// Bytes of the segment; begin and end on page borders.
typedef struct ob_page_range {
	uint64_t begin, end;
} ob_page_range;

// A list, empty at first, of the pages in use by the step's own areas; without the scheduler's scratch, which holds nothing
// from one step to the next. NULL: no memory.
struct ob_used_pages *ob_pages_create_used(void);
void ob_pages_destroy_used(struct ob_used_pages *p); // NULL is allowed
// Brings the universe's list up to date. The host's thread alone, as the next.
void ob_pages_list_used(const ob_universe *u);
// Finds the range of number i, where the one before ended at "from", 0 for the first; false: there are no more.
bool ob_pages_next_used(const ob_universe *u, size_t i, uint64_t from, ob_page_range *found);

// Tracks the universes mapped by this process, for the guard. ob_pages_track returns false if there are too many;
// further ones are not guarded.
bool ob_pages_track(const ob_universe *u);
void ob_pages_forget(const ob_universe *u);

#endif
