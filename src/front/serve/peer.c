#include "serve/peer.h"

#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef union address {
	struct sockaddr any;
	struct sockaddr_in four;
	struct sockaddr_in6 six;
} address;

static ob_peer_end end_of_four(uint32_t word, unsigned port)
{
	return (ob_peer_end){ .word = { 0, 0, htonl(0xffff), word }, .port = port };
}

static ob_peer_end end_of(const address *a)
{
	if (a->any.sa_family != AF_INET6)
		return end_of_four(a->four.sin_addr.s_addr, ntohs(a->four.sin_port));
	ob_peer_end end = { .port = ntohs(a->six.sin6_port) };
	memcpy(end.word, &a->six.sin6_addr, sizeof end.word);
	return end;
}

// Reads an address as the tables have it: one word or four, of eight digits each.
static ob_peer_end read_end(const char *digits, unsigned port)
{
	ob_peer_end end = { .port = port };
	char word[9] = "";
	size_t n = 0;
	for (; n < 4 && strlen(digits) >= 8 * (n + 1); n++) {
		memcpy(word, digits + 8 * n, 8);
		end.word[n] = (uint32_t)strtoul(word, NULL, 16);
	}
	return n == 1 ? end_of_four(end.word[0], port) : end;
}

static bool is_same(const ob_peer_end *a, const ob_peer_end *b)
{
	return a->port == b->port && memcmp(a->word, b->word, sizeof a->word) == 0;
}

bool ob_peer_find_user(FILE *table, const ob_peer_end *own, const ob_peer_end *other, unsigned *user)
{
	char line[256], near[33], far[33];
	unsigned near_port, far_port;
	unsigned long inode;
	while (fgets(line, sizeof line, table)) {
		const int n = sscanf(line, " %*[^:]: %32[0-9A-F]:%x %32[0-9A-F]:%x %*s %*s %*s %*s %u %*s %lu", near,
				     &near_port, far, &far_port, user, &inode);
		if (n != 6 || inode == 0)
			continue;
		const ob_peer_end from = read_end(near, near_port), to = read_end(far, far_port);
		if (is_same(&from, own) && is_same(&to, other))
			return true;
	}
	return false;
}

bool ob_peer_is_ours(int fd)
{
	// either end of an IPv4 connection may be an IPv6 socket
	static const char *const table[] = { "/proc/net/tcp", "/proc/net/tcp6" };
	address near, far;
	socklen_t n = sizeof near, m = sizeof far;
	bool found = false;
	unsigned user = 0;
	if (getsockname(fd, &near.any, &n) != 0 || getpeername(fd, &far.any, &m) != 0)
		return false;
	const ob_peer_end own = end_of(&far), other = end_of(&near);
	for (size_t i = 0; i < sizeof table / sizeof *table && !found; i++) {
		FILE *f = fopen(table[i], "re");
		found = f && ob_peer_find_user(f, &own, &other, &user);
		if (f)
			fclose(f);
	}
	return found && (user == geteuid() || user == 0);
}
