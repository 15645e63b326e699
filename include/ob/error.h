// One way to say what went wrong: a function that can fail takes an ob_error and fills in one line for a
// person, with the place and the remedy. NULL is allowed where the caller does not want the text.
#ifndef OB_ERROR_H
#define OB_ERROR_H

#pragma GCC visibility push(default) // libobsim shows what its installed headers declare, nothing else

typedef struct ob_error {
	char text[1024];
} ob_error;

// printf into e->text, one line of UTF-8 in which nothing controls a terminal: names and paths in it may be anybody's.
// Returns 0, so that "return ob_fail(e, ...)" works for bool, and for pointers as NULL
int ob_fail(ob_error *e, const char *format, ...) __attribute__((format(printf, 2, 3)));

#pragma GCC visibility pop

#endif
