#include "serve/http.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "serve/door.h"

enum { CHUNK = 32768, HEADERS = 2048 };

// ---- origin

// True if host[:port] is the address, localhost, or another name of the loopback, and the port is the server's.
static bool is_own_name(const char *host, const char *address, int port)
{
	const char *const names[] = { "localhost", "127.0.0.1", "[::1]", address };
	char own[128];
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		bool bare = strchr(names[i], ':') && names[i][0] != '[';
		snprintf(own, sizeof own, bare ? "[%s]:%d" : "%s:%d", names[i], port);
		if (strcmp(host, own) == 0)
			return true;
		*strrchr(own, ':') = 0;
		if (port == 80 && strcmp(host, own) == 0)
			return true;
	}
	return false;
}

bool ob_http_is_page(struct lws *wsi)
{
	return lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) > 0;
}

bool ob_http_is_ours(struct lws *wsi, const char *address, int port, bool any_name, bool any_origin)
{
	char host[128], origin[160], expected[160];
	if (lws_hdr_copy(wsi, host, sizeof host, WSI_TOKEN_HOST) <= 0)
		return false;
	if (!any_name && !is_own_name(host, address, port))
		return false;
	if (any_origin || !ob_http_is_page(wsi))
		return true; // not a page but a program
	snprintf(expected, sizeof expected, "http://%s", host);
	return lws_hdr_copy(wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN) > 0 && strcmp(origin, expected) == 0;
}

// ---- answers

typedef struct head {
	struct lws *wsi;
	unsigned char buffer[LWS_PRE + HEADERS];
	unsigned char *at;
	bool failed;
} head;

static void add(head *h, const char *name, const char *value)
{
	h->failed |= lws_add_http_header_by_name(h->wsi, (const unsigned char *)name, (const unsigned char *)value,
						 (int)strlen(value), &h->at, h->buffer + sizeof h->buffer) != 0;
}

static void begin_head(head *h, struct lws *wsi, unsigned status, const char *type, size_t size)
{
	h->wsi = wsi;
	h->at = h->buffer + LWS_PRE;
	h->failed = lws_add_http_common_headers(wsi, status, type, size, &h->at, h->buffer + sizeof h->buffer) != 0;
	add(h, "x-content-type-options:", "nosniff");
	add(h, "referrer-policy:", "no-referrer");
	add(h, "content-security-policy:",
	    "default-src 'self'; connect-src 'self' ws:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
}

static bool write_head(head *h)
{
	return !h->failed &&
	       lws_finalize_write_http_header(h->wsi, h->buffer + LWS_PRE, &h->at, h->buffer + sizeof h->buffer) == 0;
}

static int end_transaction(struct lws *wsi)
{
	ob_door_move(wsi, OB_AT_IDLE, ob_clock_wall());
	return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static bool write_whole(struct lws *wsi, unsigned status, const char *type, const void *bytes, size_t n)
{
	head h;
	unsigned char *body = malloc(LWS_PRE + n);
	if (!body)
		return false;
	begin_head(&h, wsi, status, type, n);
	add(&h, "cache-control:", "no-store");
	if (status == HTTP_STATUS_METHOD_NOT_ALLOWED)
		add(&h, "allow:", "GET, HEAD");
	memcpy(body + LWS_PRE, bytes, n);
	const bool written = write_head(&h) && lws_write(wsi, body + LWS_PRE, n, LWS_WRITE_HTTP_FINAL) >= 0;
	free(body);
	return written;
}

static bool write_text(struct lws *wsi, unsigned status, const char *text, size_t n)
{
	return write_whole(wsi, status, "text/plain; charset=utf-8", text, n);
}

static int refuse(struct lws *wsi, unsigned status, const char *text)
{
	return write_text(wsi, status, text, strlen(text)) ? end_transaction(wsi) : -1;
}

// Refuses a request that may have a body, which is not read: the connection ends.
static int refuse_body(struct lws *wsi, unsigned status, const char *text)
{
	write_text(wsi, status, text, strlen(text));
	return -1;
}

static bool has_body(struct lws *wsi)
{
	char length[24];
	const int n = lws_hdr_copy(wsi, length, sizeof length, WSI_TOKEN_HTTP_CONTENT_LENGTH);
	return n < 0 || (n > 0 && strspn(length, "0") < (size_t)n) ||
	       lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0;
}

int ob_http_answer_whole(struct lws *wsi, const char *type, const void *bytes, size_t size)
{
	char *uri;
	int length;
	if (lws_http_get_uri_and_method(wsi, &uri, &length) != LWSHUMETH_GET)
		return refuse_body(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, "only GET is answered here\n");
	if (has_body(wsi))
		return refuse_body(wsi, HTTP_STATUS_REQ_ENTITY_TOO_LARGE, "requests have no body here\n");
	return write_whole(wsi, HTTP_STATUS_OK, type, bytes, size) ? end_transaction(wsi) : -1;
}

// By default browsers keep a content, but revalidate its tag each time.
static void add_caching(head *h, const ob_content *c)
{
	add(h, "etag:", c->tag);
	add(h, "cache-control:", c->lasting ? "private, max-age=31536000, immutable" : "no-cache");
}

static const ob_content *find(const char *path, const ob_content *own)
{
	for (const ob_content *c = own; c->path; c++) {
		if (strcmp(c->path, path) == 0)
			return c;
	}
	return path[0] == '/' ? ob_content_find(path) : NULL;
}

int ob_http_answer_request(struct lws *wsi, ob_http_answer *a, const char *path, const ob_content *own)
{
	head h;
	char header[256], part[96], *uri;
	int length, method = lws_http_get_uri_and_method(wsi, &uri, &length);
	const ob_content *c = find(strcmp(path, "/") == 0 ? "/index.html" : path, own);
	*a = (ob_http_answer){ .content = NULL };
	if (method != LWSHUMETH_GET && method != LWSHUMETH_HEAD)
		return refuse_body(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, "only GET and HEAD are answered here\n");
	if (has_body(wsi))
		return refuse_body(wsi, HTTP_STATUS_REQ_ENTITY_TOO_LARGE, "requests have no body here\n");
	if (!c)
		return refuse(wsi, HTTP_STATUS_NOT_FOUND, "there is nothing of this name here\n");
	if (lws_hdr_copy(wsi, header, sizeof header, WSI_TOKEN_HTTP_IF_NONE_MATCH) > 0 &&
	    ob_content_has_tag(header, c->tag)) {
		begin_head(&h, wsi, HTTP_STATUS_NOT_MODIFIED, c->type, LWS_ILLEGAL_HTTP_CONTENT_LEN);
		add_caching(&h, c);
		return write_head(&h) ? end_transaction(wsi) : -1;
	}
	ob_range_kind range = OB_RANGE_ALL;
	size_t first = 0, end = c->size;
	if (lws_hdr_copy(wsi, header, sizeof header, WSI_TOKEN_HTTP_RANGE) > 0)
		range = ob_content_range(header, c->size, &first, &end);
	if (range == OB_RANGE_NONE)
		return refuse(wsi, HTTP_STATUS_REQ_RANGE_NOT_SATISFIABLE, "there are not so many bytes\n");
	begin_head(&h, wsi, range == OB_RANGE_PART ? HTTP_STATUS_PARTIAL_CONTENT : HTTP_STATUS_OK, c->type,
		   end - first);
	add_caching(&h, c);
	add(&h, "accept-ranges:", "bytes");
	if (range == OB_RANGE_PART) {
		snprintf(part, sizeof part, "bytes %zu-%zu/%zu", first, end - 1, c->size);
		add(&h, "content-range:", part);
	}
	if (!write_head(&h))
		return -1;
	if (method == LWSHUMETH_HEAD)
		return end_transaction(wsi);
	*a = (ob_http_answer){ c, first, end };
	lws_callback_on_writable(wsi);
	return 0;
}

int ob_http_go_on(struct lws *wsi, ob_http_answer *a)
{
	unsigned char buffer[LWS_PRE + CHUNK];
	if (!a->content)
		return 0;
	size_t n = a->end - a->at < CHUNK ? a->end - a->at : CHUNK;
	bool ends = a->at + n == a->end;
	memcpy(buffer + LWS_PRE, a->content->bytes + a->at, n);
	if (lws_write(wsi, buffer + LWS_PRE, n, ends ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < (int)n)
		return -1;
	a->at += n;
	ob_door_move(wsi, OB_AT_ANSWER, ob_clock_wall());
	if (!ends) {
		lws_callback_on_writable(wsi);
		return 0;
	}
	a->content = NULL;
	return end_transaction(wsi);
}
