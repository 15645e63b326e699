// The segment's pages: taken before they are touched, and what happens where one is missing.
//
// A segment is sparse (layout.h), and its memory file system may be full. To touch a page that it cannot give is
// SIGBUS, in the middle of a step. So whoever is about to use more of an area asks for its pages first, which can fail
// in order:
//
//   at the start     header, gate, workers' cells; all that the scene's objects have
//   later            what grows with their number of neighbours and contacts, in chunks, by whoever is about to write
//   there;
//                    what further objects have, when they are added
//
// Which chunks it has asked for, each process remembers for itself: to ask again for pages that are there does no harm.
//
// A file that somebody cuts short takes pages away that were there. Programs that call ob_pages_guard end then with one
// line that says so, host and readers alike, instead of a signal.
//
// Thread-safety: any thread.
#ifndef OB_TABLE_PAGES_H
#define OB_TABLE_PAGES_H

#include "table/layout.h"

// Makes sure that elements first .. first + count - 1 of an area can be written. false: the memory file system is full.
// Elements beyond the area's end are left to the caller.
bool ob_pages_take(ob_universe *u, ob_area area, uint64_t first, uint64_t count);
// That of the areas that every universe uses from its creation on.
bool ob_pages_take_first(ob_universe *u);

// For the guard: the universes that this process has mapped. ob_pages_track returns false where there are too many to
// track; those are not guarded.
bool ob_pages_track(const ob_universe *u);
void ob_pages_forget(const ob_universe *u);

#endif
