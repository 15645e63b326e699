// A recording as what a page plays by itself (src/serve/page/film.js): the messages that a viewer of the run would have
// been told, one after the other, in one piece.
//
//   gzip of:   u32 bytes, a message;  u32 bytes, a message;  ..       little-endian
//              {"welcome": ..}, {"film": ..}, the meshes, then the others of feed.h, in the order of their times
//
// {"film": begin, end, interval (s), created, version, commit, objects: [[id, generation, mass, friction, restitution]
// ..], events: [[time, came (1) or went (-1), id, name] ..]}
//
// Now and then, where enough has been told since, all is told anew beside: from there a page begins that is to show
// another time. So it need not begin at the start, and a long recording costs a fifth more.
//
// One thread's.
#ifndef OB_SERVE_FILM_H
#define OB_SERVE_FILM_H

#include "record/recording.h"
#include "serve/message.h"

// Of a recording that has just been opened; path is for errors. NULL and e: it cannot be read, or out of memory.
ob_message *ob_film_make(ob_recording *r, const char *path, ob_error *e);

#endif
