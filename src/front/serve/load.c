// Loader of the server: loads the part that calls libwebsockets.
#include <arpa/inet.h>
#include <stdlib.h>
#include <string.h>

#include "serve/part.h"
#include "serve/serve.h"

#define PACKAGE "libwebsockets17"

bool ob_serve_check(ob_error *e)
{
	return ob_part_check("serve", PACKAGE, e);
}

ob_server *ob_server_start(const ob_server_config *c, ob_host *const *h, uint32_t hosts, ob_pace *pace, ob_error *e)
{
	const ob_serve_part *part = ob_part_load("serve", sizeof *part, OB_PART_PROGRAM, PACKAGE, e);
	ob_server *s = part ? part->start(c, h, hosts, pace, e) : NULL;
	if (s)
		((ob_server_base *)s)->part = part;
	return s;
}

const char *ob_server_url(const ob_server *s, ob_role role)
{
	return ((const ob_server_base *)s)->part->url(s, role);
}

void ob_server_tell(ob_server *s, ob_message *m)
{
	((ob_server_base *)s)->part->tell(s, m);
}

void ob_server_hold(ob_server *s)
{
	((ob_server_base *)s)->part->hold(s);
}

bool ob_server_go_on(ob_server *s, const ob_scene *scene, ob_host *const *h, ob_error *e)
{
	return ((ob_server_base *)s)->part->go_on(s, scene, h, e);
}

void ob_server_stop(ob_server *s)
{
	if (s)
		((ob_server_base *)s)->part->stop(s);
}

// ---- listen

bool ob_listen_read(ob_listen *l, const char *text, ob_error *e)
{
	const char *colon = strrchr(text, ':');
	char *end = NULL;
	struct in6_addr at;
	size_t n = colon ? (size_t)(colon - text) : 0;
	long port = colon && colon[1] >= '0' && colon[1] <= '9' ? strtol(colon + 1, &end, 10) : -1;
	*l = (ob_listen){ .six = n > 2 && text[0] == '[' && text[n - 1] == ']', .port = (int)port };
	n -= l->six ? 2 : 0;
	if (port < 0 || port > 65535 || *end || n >= sizeof l->address)
		return ob_fail(e, "--listen %s: expected ADDRESS:PORT, as 127.0.0.1:8080", text);
	memcpy(l->address, text + l->six, n);
	if (strcmp(l->address, "localhost") == 0)
		strcpy(l->address, "127.0.0.1");
	if (inet_pton(l->six ? AF_INET6 : AF_INET, l->address, &at) != 1)
		return ob_fail(e, "--listen %s: expected an address in numbers, as 127.0.0.1:8080 or [::1]:8080", text);
	l->loopback = !l->six                     ? at.s6_addr[0] == 127
		      : IN6_IS_ADDR_V4MAPPED(&at) ? at.s6_addr[12] == 127
						  : IN6_IS_ADDR_LOOPBACK(&at);
	return true;
}
