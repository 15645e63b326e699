#include "serve/door.h"

#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

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
