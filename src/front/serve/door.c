#include "serve/door.h"

#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct ob_visit {
	ob_visit *next; // entered before it
	struct lws *wsi;
	unsigned char address[16]; // IPv6; IPv4 as ::ffff:a.b.c.d; of other networks the /64, which belongs to one host
	ob_door_state state;
	double since, active; // s: beginning of the state, and the client's last progress in it
};

static void find_address(struct lws *wsi, unsigned char address[16])
{
	struct sockaddr_storage a;
	socklen_t n = sizeof a;
	memset(address, 0, 16);
	if (getpeername(lws_get_socket_fd(wsi), (struct sockaddr *)&a, &n) != 0)
		return;
	if (a.ss_family == AF_INET) {
		address[10] = address[11] = 0xff;
		memcpy(address + 12, &((struct sockaddr_in *)&a)->sin_addr, 4);
	} else if (a.ss_family == AF_INET6) {
		const struct in6_addr *six = &((struct sockaddr_in6 *)&a)->sin6_addr;
		memcpy(address, six, IN6_IS_ADDR_V4MAPPED(six) || IN6_IS_ADDR_LOOPBACK(six) ? 16 : 8);
	}
}

static bool takes_place(const ob_visit *v)
{
	return v->state < OB_AT_VIEWER;
}

// Counts the places of an address; address: NULL: of all.
static uint32_t count(const ob_door *d, const unsigned char *address)
{
	uint32_t n = 0;
	for (const ob_visit *v = d->visits; v; v = v->next)
		n += takes_place(v) && (!address || memcmp(v->address, address, 16) == 0);
	return n;
}

static const unsigned char *fullest(const ob_door *d)
{
	const unsigned char *best = NULL;
	uint32_t most = 0;
	for (const ob_visit *v = d->visits; v; v = v->next) {
		const uint32_t n = takes_place(v) ? count(d, v->address) : 0;
		if (n > most) {
			most = n;
			best = v->address;
		}
	}
	return best;
}

static void end(ob_visit *v, double now)
{
	v->state = OB_AT_END;
	v->since = now;
	lws_set_timeout(v->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT, LWS_TO_KILL_ASYNC);
}

// Closes the connection of an address that has been in its state for longest.
static void push_out(ob_door *d, const unsigned char *address, double now)
{
	ob_visit *longest = NULL;
	for (ob_visit *v = d->visits; v; v = v->next) {
		if (takes_place(v) && memcmp(v->address, address, 16) == 0 && (!longest || v->since <= longest->since))
			longest = v;
	}
	if (longest)
		end(longest, now);
}

bool ob_door_enter(ob_door *d, struct lws *wsi, double now)
{
	ob_visit *v = calloc(1, sizeof *v);
	if (!v)
		return false;
	*v = (ob_visit){ .next = d->visits, .wsi = wsi, .state = OB_AT_REQUEST, .since = now, .active = now };
	find_address(wsi, v->address);
	d->visits = v;
	lws_set_opaque_user_data(wsi, v);
	if (count(d, v->address) > d->share)
		push_out(d, v->address, now);
	else if (count(d, NULL) > d->places)
		push_out(d, fullest(d), now);
	return true;
}

void ob_door_move(struct lws *wsi, ob_door_state state, double now)
{
	ob_visit *v = lws_get_opaque_user_data(wsi);
	if (!v || v->state == OB_AT_END)
		return;
	v->since = v->state == state ? v->since : now;
	v->active = now;
	v->state = state;
}

void ob_door_leave(ob_door *d, struct lws *wsi)
{
	for (ob_visit **at = &d->visits; *at; at = &(*at)->next) {
		if ((*at)->wsi == wsi) {
			ob_visit *gone = *at;
			*at = gone->next;
			free(gone);
			return;
		}
	}
}

void ob_door_look(ob_door *d, double now)
{
	static const double patience[] = { OB_DOOR_REQUEST, OB_DOOR_ANSWER, OB_DOOR_IDLE };
	for (ob_visit *v = d->visits; v; v = v->next) {
		if (takes_place(v) && now - v->active > patience[v->state])
			end(v, now);
	}
}

// ---- peer

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
