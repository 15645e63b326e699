#include "serve/message.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/utf8.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are sent as they lie in memory");

ob_message *ob_message_new(bool text)
{
	ob_message *m = calloc(1, sizeof *m);
	if (m)
		*m = (ob_message){ .holders = 1, .text = text };
	return m;
}

void ob_message_hold(ob_message *m)
{
	m->holders++;
}

void ob_message_release(ob_message *m)
{
	if (!m || --m->holders > 0)
		return;
	free(m->bytes);
	free(m);
}

static bool reserve(ob_message *m, size_t more)
{
	const bool fine = OB_RESERVE(m->bytes, m->size + more, m->room);
	m->failed |= !fine;
	return fine;
}

void ob_message_put(ob_message *m, const void *bytes, size_t size)
{
	if (size == 0 || !reserve(m, size))
		return;
	memcpy(m->bytes + m->size, bytes, size);
	m->size += size;
}

void ob_message_put_u8(ob_message *m, unsigned value)
{
	ob_message_put(m, &(uint8_t){ (uint8_t)value }, 1);
}

void ob_message_put_u32(ob_message *m, uint32_t value)
{
	ob_message_put(m, &value, sizeof value);
}

void ob_message_put_f32(ob_message *m, double value)
{
	ob_message_put(m, &(float){ (float)value }, sizeof(float));
}

void ob_message_put_f64(ob_message *m, double value)
{
	ob_message_put(m, &value, sizeof value);
}

void ob_message_set_u32(ob_message *m, size_t at, uint32_t value)
{
	if (!m->failed)
		memcpy(m->bytes + at, &value, sizeof value);
}

void ob_message_print(ob_message *m, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	int n = vsnprintf(NULL, 0, format, args);
	va_end(args);
	if (n < 0 || !reserve(m, (size_t)n + 1))
		return;
	va_start(args, format);
	vsnprintf((char *)m->bytes + m->size, (size_t)n + 1, format, args);
	va_end(args);
	m->size += (size_t)n;
}

void ob_message_put_json(ob_message *m, const char *string)
{
	ob_message_put_u8(m, '"');
	for (const char *s = string; *s;) {
		size_t n = ob_utf8_length(s);
		if (n == 0 || (unsigned char)*s < 0x20 || *s == '"' || *s == '\\' || *s == 0x7f)
			ob_message_print(m, "\\u%04x", (unsigned char)*s);
		else
			ob_message_put(m, s, n);
		s += n ? n : 1;
	}
	ob_message_put_u8(m, '"');
}
