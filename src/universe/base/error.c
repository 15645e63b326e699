#include <ob/error.h>

#include <stdarg.h>
#include <stdio.h>

#include "base/utf8.h"

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
