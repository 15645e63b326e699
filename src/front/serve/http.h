// The content server's half of a connection: requests for pages, scripts and shaders, answered from content.h. The
// server's thread only.
#ifndef OB_SERVE_HTTP_H
#define OB_SERVE_HTTP_H

#include <libwebsockets.h>

#include "serve/content.h"

// Rest of an answer
typedef struct ob_http_answer {
	const ob_content *content; // NULL: nothing
	size_t at, end;
} ob_http_answer;

// True if the Host header names this server, and Origin, if there is one, a page of it. address: the server's;
// any_name: the token decides, the name does not; any_origin: pages of others may ask.
bool ob_http_is_ours(struct lws *wsi, const char *address, int port, bool any_name, bool any_origin);
// True if a page asks, and not a program.
bool ob_http_is_page(struct lws *wsi);
// Both return the value of the library's callback: other than 0 ends the connection. own: contents that take precedence
// over content.h; ends with one without a path.
int ob_http_answer_request(struct lws *wsi, ob_http_answer *a, const char *path, const ob_content *own);
// A content made for this request, some 100 kB at most. The value is that of the callback, too.
int ob_http_answer_whole(struct lws *wsi, const char *type, const void *bytes, size_t size);
int ob_http_go_on(struct lws *wsi, ob_http_answer *a);

#endif
