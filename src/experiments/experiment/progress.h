// Progress of long operations, in one line of standard error: in place on a terminal, otherwise a line now and then.
// One format for all commands. One thread at a time.
#ifndef OB_EXPERIMENT_PROGRESS_H
#define OB_EXPERIMENT_PROGRESS_H

#include <stddef.h>

typedef struct ob_progress_view {
	double shown; // time of the last line, s; 0 = none yet
} ob_progress_view;

// Prints "[#####     ] 12 of 40, 3 min 2 s left: what". left_s NAN: not known yet. done and all in any unit
void ob_progress_print(char *to, size_t room, double done, double all, double left_s, const char *what);
// Shows it if it is due.
void ob_progress_show(ob_progress_view *v, double done, double all, double left_s, const char *what);
// Clears the line on the terminal.
void ob_progress_clear(ob_progress_view *v);

// Prints seconds in the two largest units, as people say them.
void ob_progress_print_time(char *text, size_t size, double s);

#endif
