// The content server's content: what a viewer is made of (page, style, scripts, and the shaders of shaders/, the same
// that the renderer draws with), built into the program. Pure; any thread.
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
	bool lasting; // its path says its bytes, so it need not be asked for again
} ob_content;

// NULL: nothing is there. Paths of requests begin with '/'; all scripts in one, for a page that needs nobody, are
// "all.js".
const ob_content *ob_content_find(const char *path);
const ob_content *ob_content_at(size_t i); // the ones that there are; NULL: no more

typedef enum ob_range_kind { OB_RANGE_ALL, OB_RANGE_PART, OB_RANGE_NONE } ob_range_kind;

// What of size bytes a Range header asks for (RFC 9110, 14.2): one range of bytes; of anything else, all. Part: from
// the byte "first" up to, but without, "end". None: it lies outside.
ob_range_kind ob_content_range(const char *header, size_t size, size_t *first, size_t *end);
// Whether a list of entity tags (If-None-Match) has this one.
bool ob_content_has_tag(const char *header, const char *tag);

#endif
