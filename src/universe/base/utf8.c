#include "base/utf8.h"

#include <string.h>

size_t ob_utf8_length(const char *s)
{
	const unsigned char *u = (const unsigned char *)s;
	size_t n = u[0] < 0x80 ? 1 : u[0] < 0xc2 ? 0 : u[0] < 0xe0 ? 2 : u[0] < 0xf0 ? 3 : u[0] < 0xf5 ? 4 : 0;
	for (size_t i = 1; i < n; i++)
		if ((u[i] & 0xc0) != 0x80)
			return 0;
	if ((u[0] == 0xe0 && u[1] < 0xa0) || (u[0] == 0xed && u[1] > 0x9f) || (u[0] == 0xf0 && u[1] < 0x90) ||
	    (u[0] == 0xf4 && u[1] > 0x8f))
		return 0;
	return n;
}

uint32_t ob_utf8_decode(const char *s, size_t *bytes)
{
	static const unsigned char payload[] = { 0, 0x7f, 0x1f, 0x0f, 0x07 }; // bits of the first byte, by length
	size_t n = ob_utf8_length(s);
	*bytes = n ? n : 1;
	if (!n)
		return OB_UTF8_REPLACEMENT;
	uint32_t code = (unsigned char)s[0] & payload[n];
	for (size_t i = 1; i < n; i++)
		code = code << 6 | ((unsigned char)s[i] & 0x3f);
	return code;
}

size_t ob_utf8_count(const char *s)
{
	size_t count = 0;
	for (size_t bytes; *s; s += bytes, count++)
		ob_utf8_decode(s, &bytes);
	return count;
}

bool ob_utf8_is_plain(uint32_t code)
{
	static const struct {
		uint32_t first, last;
	} active[] = { { 0, 0x1f },        { 0x7f, 0x9f },     { 0x61c, 0x61c },
		       { 0x200e, 0x200f }, { 0x2028, 0x202e }, { 0x2066, 0x2069 } };
	for (size_t i = 0; i < sizeof active / sizeof *active; i++)
		if (code >= active[i].first && code <= active[i].last)
			return false;
	return true;
}

void ob_utf8_make_plain(char *text)
{
	while (*text >= ' ' && *text < 0x7f) // fast path: most texts are plain ASCII
		text++;
	char *to = text;
	for (const char *from = text; *from;) {
		size_t n = ob_utf8_length(from), bytes;
		if (n > 0 && ob_utf8_is_plain(ob_utf8_decode(from, &bytes))) {
			memmove(to, from, n);
			to += n;
		} else {
			*to++ = (unsigned char)*from < ' ' || *from == 0x7f ? ' ' : '?';
		}
		from += n ? n : 1;
	}
	*to = 0;
}
