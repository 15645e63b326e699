#include "ranks/courier.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

struct ob_courier {
	pid_t pid;
	int socket;
	size_t size; // of a packet
};

// Packet in the socket: a message, or the courier's own control word.
typedef struct packet {
	uint32_t rank; // destination or source; or a control word
	char bytes[OB_COURIER_BYTES];
} packet;

enum { ERROR = UINT32_MAX, END = UINT32_MAX - 1 }; // to its process, with a text; from its process

// The core belongs to a trial, and messages are rare. Naps between polls of the wire grow with the time since the last
// message, so the added delay is a small share of that time.
enum { NAP_SHARE = 8, NAP_MAX_MS = 16 };

static _Noreturn void give_up(int socket, size_t size, const char *text)
{
	packet p = { .rank = ERROR };
	snprintf(p.bytes, size - offsetof(packet, bytes), "%s", text);
	send(socket, &p, size, MSG_NOSIGNAL);
	_exit(1);
}

static _Noreturn void carry(const ob_ranks *ranks, int socket, size_t size)
{
	const size_t bytes = size - offsetof(packet, bytes);
	packet p;
	ob_error e;
	ob_wire *w = ob_wire_open(ranks, &e);
	if (!w)
		give_up(socket, size, e.text);
	for (int quiet_ms = 0;;) {
		const ssize_t n = recv(socket, &p, sizeof p, MSG_DONTWAIT);
		if (n > 0 && p.rank == END)
			break;
		if (n > 0)
			ob_wire_send(w, p.rank, p.bytes, bytes);
		else if (n == 0 || (errno != EAGAIN && errno != EINTR))
			_exit(1); // its process has ended
		size_t size_came;
		const void *came = ob_wire_receive(w, &p.rank, &size_came);
		if (came && size_came != bytes)
			give_up(socket, size, "ranks of different programs: install the same obsim on all machines");
		if (came)
			memcpy(p.bytes, came, bytes);
		if (came && send(socket, &p, size, MSG_NOSIGNAL) < 0)
			_exit(1);
		if (came || n > 0) {
			quiet_ms = 0;
			continue;
		}
		const int share = 1 + quiet_ms / NAP_SHARE, nap_ms = share < NAP_MAX_MS ? share : NAP_MAX_MS;
		poll(&(struct pollfd){ .fd = socket, .events = POLLIN }, 1, nap_ms);
		quiet_ms += quiet_ms < NAP_SHARE * NAP_MAX_MS ? nap_ms : 0;
	}
	ob_wire_close(w);
	_exit(0);
}

static void begin(pid_t parent)
{
	signal(SIGINT, SIG_IGN);
	signal(SIGTERM, SIG_IGN);
	signal(SIGHUP, SIG_IGN);
	prctl(PR_SET_NAME, "obsim-courier");
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (getppid() != parent) // the parent died before the line above
		_exit(1);
}

ob_courier *ob_courier_start(const ob_ranks *ranks, size_t n, ob_error *e)
{
	int ends[2];
	ob_courier *c = malloc(sizeof *c);
	if (!c || n > OB_COURIER_BYTES || socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
		ob_fail(e, "no socket for %zu bytes: %s", n, strerror(errno));
		free(c);
		return NULL;
	}
	const pid_t parent = getpid();
	const size_t size = offsetof(packet, bytes) + n;
	*c = (ob_courier){ fork(), ends[0], size };
	if (c->pid == 0) {
		begin(parent);
		close(ends[0]);
		carry(ranks, ends[1], size);
	}
	close(ends[1]);
	if (c->pid > 0)
		return c;
	ob_fail(e, "cannot start a process: %s", strerror(errno));
	close(ends[0]);
	free(c);
	return NULL;
}

int ob_courier_socket(const ob_courier *c)
{
	return c->socket;
}

bool ob_courier_send(ob_courier *c, uint32_t to, const void *message, ob_error *e)
{
	packet p = { .rank = to };
	memcpy(p.bytes, message, c->size - offsetof(packet, bytes));
	return send(c->socket, &p, c->size, MSG_NOSIGNAL) >= 0 ||
	       ob_fail(e, "the other ranks cannot be reached: %s", strerror(errno));
}

ob_courier_news ob_courier_receive(ob_courier *c, void *message, uint32_t *from, ob_error *e)
{
	packet p;
	const ssize_t n = recv(c->socket, &p, c->size, MSG_DONTWAIT);
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return OB_COURIER_NOTHING;
	if (n != (ssize_t)c->size)
		ob_fail(e, "the other ranks cannot be reached: MPI has ended");
	else if (p.rank == ERROR)
		ob_fail(e, "%s", p.bytes);
	if (n != (ssize_t)c->size || p.rank == ERROR)
		return OB_COURIER_GONE;
	memcpy(message, p.bytes, c->size - offsetof(packet, bytes));
	*from = p.rank;
	return OB_COURIER_MESSAGE;
}

static int reap(ob_courier *c)
{
	int status = 0;
	close(c->socket);
	while (waitpid(c->pid, &status, 0) < 0 && errno == EINTR)
		;
	free(c);
	return status;
}

bool ob_courier_end(ob_courier *c, ob_error *e)
{
	const packet p = { .rank = END };
	send(c->socket, &p, c->size, MSG_NOSIGNAL);
	return reap(c) == 0 || ob_fail(e, "the other ranks cannot be reached: MPI has ended");
}

void ob_courier_abandon(ob_courier *c)
{
	if (!c)
		return;
	kill(c->pid, SIGKILL);
	reap(c);
}
