// Terminal for top: alternate screen, keys without Enter, size. Plain ANSI sequences (ECMA-48), which all current
// terminals support; a library for them would be one more package.
#ifndef OB_CLI_TERMINAL_H
#define OB_CLI_TERMINAL_H

#include <stdbool.h>
#include <stddef.h>

typedef enum ob_key {
	OB_KEY_NONE, // no key was pressed in time
	OB_KEY_RESIZE, // the screen has another size
	OB_KEY_QUIT, // q, Ctrl-C, a signal to end, or the terminal is closed
	OB_KEY_UP,
	OB_KEY_DOWN,
	OB_KEY_PAGE_UP,
	OB_KEY_PAGE_DOWN,
	OB_KEY_HOME,
	OB_KEY_END,
	OB_KEY_WORKERS, // w
	OB_KEY_SORT, // s
	OB_KEY_SENSORS, // n
} ob_key;

// Standard input and output must be a terminal. ob_terminal_leave restores it, and so do signals that end the process.
bool ob_terminal_enter(void);
void ob_terminal_leave(void);
void ob_terminal_size(int *columns, int *lines);
// Replaces the screen's contents by the text (lines end with \n) without flicker.
void ob_terminal_show(const char *text, size_t length);
ob_key ob_terminal_key(double timeout); // waits for at most that many seconds

#endif
