#include "serve/film_page.h"

#include <assert.h>
#include <string.h>

#include "serve/content.h"

// Parts of index.html that are replaced
enum { MARK_RECORDING, MARK_ICON, MARK_STYLE, MARK_SCRIPT, MARKS };
static const char *const marks[MARKS] = {
	"<meta name=\"recording\" content=\"\">\n",
	"<link rel=\"icon\" href=\"icon.svg\" type=\"image/svg+xml\">\n",
	"<link rel=\"stylesheet\" href=\"style.css\">\n",
	"<script type=\"module\" src=\"main.js\"></script>\n",
};

static void put_text(ob_message *to, const char *text)
{
	ob_message_put(to, text, strlen(text));
}

static void put_content(ob_message *to, const char *before, const char *path, const char *after)
{
	const ob_content *c = ob_content_find(path);
	assert(c);
	put_text(to, before);
	ob_message_put(to, c->bytes, c->size);
	put_text(to, after);
}

// Offset of the mark in the page, which must have it.
static size_t find(const ob_content *page, const char *mark)
{
	const unsigned char *at = memmem(page->bytes, page->size, mark, strlen(mark));
	assert(at);
	return (size_t)(at - page->bytes);
}

// Appends base64 (RFC 4648, 4).
static void put_base64(ob_message *to, const unsigned char *bytes, size_t size)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t i = 0; i < size; i += 3) {
		size_t n = size - i < 3 ? size - i : 3;
		unsigned three = (unsigned)bytes[i] << 16 | (n > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
				 (n > 2 ? bytes[i + 2] : 0);
		char four[4];
		for (unsigned k = 0; k < 4; k++)
			four[k] = k <= n ? digits[three >> (18 - 6 * k) & 63] : '=';
		ob_message_put(to, four, sizeof four);
	}
}

static ob_message *whole_or_none(ob_message *m)
{
	if (m && !m->failed)
		return m;
	ob_message_release(m);
	return NULL;
}

ob_message *ob_film_page_served(void)
{
	const ob_content *page = ob_content_find("/index.html");
	size_t at = find(page, marks[MARK_RECORDING]), end = at + strlen(marks[MARK_RECORDING]);
	ob_message *m = ob_message_new(true);
	if (!m)
		return NULL;
	ob_message_put(m, page->bytes, at);
	put_text(m, "<meta name=\"recording\" content=\"recording\">\n");
	ob_message_put(m, page->bytes + end, page->size - end);
	return whole_or_none(m);
}

// Adds the film as an element that film.js finds by its id.
static void put_recording(ob_message *m, const ob_message *film)
{
	put_text(m, "<meta name=\"recording\" content=\"#recording\">\n");
	put_text(m, "<script type=\"text/plain\" id=\"recording\">");
	if (film)
		put_base64(m, film->bytes, film->size);
	put_text(m, "</script>\n");
}

ob_message *ob_film_page_whole(const ob_message *film)
{
	const ob_content *page = ob_content_find("/index.html");
	ob_message *m = ob_message_new(true);
	size_t from = 0;
	if (!m)
		return NULL;
	for (int i = 0; i < MARKS; i++) { // in the order of the page
		size_t at = find(page, marks[i]);
		assert(at >= from);
		ob_message_put(m, page->bytes + from, at - from);
		from = at + strlen(marks[i]);
		if (i == MARK_RECORDING)
			put_recording(m, film);
		else if (i == MARK_STYLE)
			put_content(m, "<style>\n", "/style.css", "</style>\n");
		else if (i == MARK_SCRIPT)
			put_content(m, "<script type=\"module\">\n", "/main.js", "</script>\n");
	}
	ob_message_put(m, page->bytes + from, page->size - from);
	return whole_or_none(m);
}
