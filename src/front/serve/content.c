#include "serve/content.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

#include "content_table.h"

const ob_content *ob_content_find(const char *path)
{
	for (size_t i = 0; i < sizeof contents / sizeof *contents; i++) {
		if (strcmp(contents[i].path, path) == 0)
			return &contents[i];
	}
	return NULL;
}

// Reads a number of at most 15 digits; false: none is there.
static bool take_number(const char **s, uint64_t *out)
{
	int digits = 0;
	for (*out = 0; isdigit((unsigned char)**s) && digits < 15; (*s)++, digits++)
		*out = 10 * *out + (uint64_t)(**s - '0');
	return digits > 0 && !isdigit((unsigned char)**s);
}

ob_range_kind ob_content_range(const char *header, size_t size, size_t *first, size_t *end)
{
	const char *s = header;
	uint64_t from = 0, to = 0;
	*first = 0;
	*end = size;
	if (strncmp(s, "bytes=", 6) != 0)
		return OB_RANGE_ALL;
	s += 6;
	bool has_from = take_number(&s, &from);
	if (*s++ != '-')
		return OB_RANGE_ALL;
	bool has_to = take_number(&s, &to);
	if (*s || (!has_from && !has_to) || (has_from && has_to && to < from))
		return OB_RANGE_ALL;
	if (!has_from) { // a suffix range
		if (to == 0)
			return OB_RANGE_NONE;
		*first = to < size ? size - (size_t)to : 0;
		return OB_RANGE_PART;
	}
	if (from >= size)
		return OB_RANGE_NONE;
	*first = (size_t)from;
	*end = has_to && to < size ? (size_t)to + 1 : size;
	return OB_RANGE_PART;
}

bool ob_content_has_tag(const char *header, const char *tag)
{
	size_t n = strlen(tag);
	if (strcmp(header, "*") == 0)
		return true;
	for (const char *s = header; (s = strstr(s, tag)); s += n) {
		if (s[n] == 0 || s[n] == ',' || s[n] == ' ')
			return true;
	}
	return false;
}
