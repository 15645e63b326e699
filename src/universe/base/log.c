#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <ob/error.h>

#include "base/utf8.h"

static int notes = 1;

// One write a line, so that lines of several processes do not mix.
static void put(const char *kind, const char *format, va_list args)
{
	char line[1200];
	int n = snprintf(line, sizeof line, "obsim: %s", kind);
	vsnprintf(line + n, sizeof line - (size_t)n - 1, format, args);
	ob_utf8_make_plain(line);
	n = (int)strlen(line);
	line[n++] = '\n';
	ssize_t ignored = write(STDERR_FILENO, line, n);
	(void)ignored;
}

void ob_log_error(const char *format, ...)
{
	va_list args;
	va_start(args, format);
	put("", format, args);
	va_end(args);
}

void ob_log_warn(const char *format, ...)
{
	va_list args;
	va_start(args, format);
	put("warning: ", format, args);
	va_end(args);
}

void ob_log_note(const char *format, ...)
{
	if (!notes)
		return;
	va_list args;
	va_start(args, format);
	put("", format, args);
	va_end(args);
}

void ob_log_set_notes(int on)
{
	notes = on;
}

// ---- error

int ob_fail(ob_error *e, const char *format, ...)
{
	if (e) {
		va_list args;
		va_start(args, format);
		vsnprintf(e->text, sizeof e->text, format, args);
		va_end(args);
		ob_utf8_make_plain(e->text);
	}
	return 0;
}
