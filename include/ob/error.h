// Error texts: a function that can fail takes an ob_error and fills in one line for a person, with the place and the
// remedy. Callers that do not want the text pass NULL.
#ifndef OB_ERROR_H
#define OB_ERROR_H

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

typedef struct ob_error {
	char text[1024];
} ob_error;

// Prints into e->text: one line of UTF-8 without characters that control a terminal, as names and paths in it may come
// from anywhere. Returns 0, so that "return ob_fail(e, ...)" works for bool, and for pointers as NULL.
int ob_fail(ob_error *e, const char *format, ...) __attribute__((format(printf, 2, 3)));

#pragma GCC visibility pop

#endif
