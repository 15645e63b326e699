// A reader of a life's universe: a thread that maps it by its name, as a program does, and reads all of it while it runs.
#ifndef OB_TESTS_LIVES_READER_H
#define OB_TESTS_LIVES_READER_H

#include <ob/universe.h>

typedef struct reader reader;

// Begins to read. NULL: there is no such universe, or no memory.
reader *reader_start(const char *universe);
// Ends it; returns false and e if it read what makes no sense. NULL: true.
bool reader_stop(reader *r, ob_error *e);

#endif
