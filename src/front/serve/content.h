// Contents of the content server: the pages, their style, and a script for each, with the shaders of shaders/, which the
// renderer uses, too. They are built into the program. Pure; any thread.
#ifndef OB_SERVE_CONTENT_H
#define OB_SERVE_CONTENT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ob_content {
	const char *path; // as in "/style.css"
	const char *type; // media type
	const char *tag; // entity tag with its quotes: hash of the bytes
	const unsigned char *bytes;
	size_t size;
	bool lasting; // its path contains its hash, so a browser need not revalidate it
} ob_content;

// NULL: not found. Paths of requests begin with '/'.
const ob_content *ob_content_find(const char *path);

typedef enum ob_range_kind { OB_RANGE_ALL, OB_RANGE_PART, OB_RANGE_NONE } ob_range_kind;

// Range of size bytes that a Range header requests (RFC 9110, 14.2): one range of bytes; for any other header, all.
// Part: from the byte "first" up to, but without, "end". None: it lies outside.
ob_range_kind ob_content_range(const char *header, size_t size, size_t *first, size_t *end);
// True if a list of entity tags (If-None-Match) has this one.
bool ob_content_has_tag(const char *header, const char *tag);

#endif
