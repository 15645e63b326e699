#include "serve/peer.h"

#include <netinet/in.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef union address {
	struct sockaddr any;
	struct sockaddr_in four;
	struct sockaddr_in6 six;
} address;

// Writes an address as /proc/net/tcp has it: words of the address in the machine's byte order, and the port.
static void print(char out[48], const address *a)
{
	uint32_t word[4] = { a->four.sin_addr.s_addr };
	const bool six = a->any.sa_family == AF_INET6;
	if (six)
		memcpy(word, &a->six.sin6_addr, sizeof word);
	int n = 0;
	for (int i = 0; i < (six ? 4 : 1); i++)
		n += snprintf(out + n, 48 - (size_t)n, "%08X", word[i]);
	snprintf(out + n, 48 - (size_t)n, ":%04X", ntohs(six ? a->six.sin6_port : a->four.sin_port));
}

// User of the socket that is bound to `own` and connected to `other`. false: there is none.
static bool find_user(const char *table, const char *own, const char *other, unsigned *user)
{
	FILE *f = fopen(table, "re");
	char line[256], from[48], to[48];
	bool found = false;
	while (f && !found && fgets(line, sizeof line, f))
		found = sscanf(line, " %*[^:]: %47s %47s %*s %*s %*s %*s %u", from, to, user) == 3 &&
			strcmp(from, own) == 0 && strcmp(to, other) == 0;
	if (f)
		fclose(f);
	return found;
}

bool ob_peer_is_ours(int fd)
{
	address near, far;
	socklen_t n = sizeof near, m = sizeof far;
	char own[48], other[48];
	unsigned user;
	if (getsockname(fd, &near.any, &n) != 0 || getpeername(fd, &far.any, &m) != 0)
		return false;
	print(own, &far);
	print(other, &near);
	return find_user(near.any.sa_family == AF_INET6 ? "/proc/net/tcp6" : "/proc/net/tcp", own, other, &user) &&
	       (user == geteuid() || user == 0);
}
