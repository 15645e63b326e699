#include <arpa/inet.h>
#include <stdlib.h>
#include <string.h>

#include "serve/serve.h"

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
