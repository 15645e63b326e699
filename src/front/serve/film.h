// A recording for a page that plays it by itself (src/front/serve/page/film.js): the messages to a viewer of the run, one
// after the other, in one piece.
//
//   gzip of:   u32 bytes, a message;  u32 bytes, a message;  ..       little-endian
//              {"welcome": ..}, {"film": ..}, the meshes, then the others of feed.h, in the order of their times
//
// {"film": begin, end, interval (s), created, version, commit, objects: [[id, generation, mass, friction, restitution]
// ..], events: [[time, added (1) or removed (-1), id, name] ..]}
//
// At times, after enough changes, there is an additional whole state, from which a page begins to show another time. So
// it need not begin at the start, and a long recording is a fifth larger.
//
// One thread at a time.
#ifndef OB_SERVE_FILM_H
#define OB_SERVE_FILM_H

#include "record/recording.h"
#include "serve/message.h"

// CPU time (s) in which a page is made, unless more is allowed: a record from outside may have millions of states.
#define OB_FILM_SECONDS 10.

// Makes the film of a recording that has just been opened, in some seconds of this process's CPU time; path is for
// errors. NULL and e: unreadable, too long for that time or for a browser, or out of memory.
ob_message *ob_film_make(ob_recording *r, const char *path, double seconds, ob_error *e);

// ---- film page

// The viewer's page for a film (film.h). Pure; any thread.

// The page of a server, which serves scripts, style and shaders, too, and the film as "recording".
ob_message *ob_film_page_served(void);
// The page with all of these in it, without a server. film: NULL: a page into which a viewer puts its own record.
// NULL: out of memory.
ob_message *ob_film_page_whole(const ob_message *film);

#endif
