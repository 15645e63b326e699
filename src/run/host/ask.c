#include "host/ask.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/utf8.h"
#include "control/call.h"
#include "control/packet.h"
#include "host/control.h"
#include "host/host_state.h"

enum { WAITING = 16 };

static const char magic[8] = { 'O', 'B', 'S', 'I', 'M', 'A', 'S', '1' };

typedef struct packet {
	char magic[8];
	uint64_t size; // size of a request in this program
	ob_request request;
} packet;

// ---- the universe's side

// Adds a file descriptor to the events that the universe waits for: its socket, and callers that have not sent a
// request.
static bool watch(int events, int fd)
{
	return epoll_ctl(events, EPOLL_CTL_ADD, fd, &(struct epoll_event){ .events = EPOLLIN, .data.fd = fd }) == 0;
}

bool ob_asked_listen(ob_asked *a, const char *universe, ob_error *e)
{
	struct sockaddr_un address;
	const socklen_t n = ob_call_address(universe, &address);
	*a = (ob_asked){ .events = epoll_create1(EPOLL_CLOEXEC),
			 .socket = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0) };
	if (a->events >= 0 && a->socket >= 0 && bind(a->socket, (struct sockaddr *)&address, n) == 0 &&
	    listen(a->socket, WAITING) == 0 && watch(a->events, a->socket))
		return true;
	const int error = errno;
	ob_asked_close(a);
	return ob_fail(e, "obsim send cannot reach universe \"%s\": %s", universe,
		       error == EADDRINUSE
			       ? "another process has taken its address; end that one, or choose another --name"
			       : strerror(error));
}

void ob_asked_close(ob_asked *a)
{
	for (uint32_t i = 0; i < a->count; i++)
		close(a->caller[i]);
	if (a->socket >= 0)
		close(a->socket);
	if (a->events >= 0)
		close(a->events);
	*a = (ob_asked){ .events = -1, .socket = -1 };
}

static bool is_ours(int fd)
{
	struct ucred who;
	socklen_t n = sizeof who;
	return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &n) == 0 && (who.uid == geteuid() || who.uid == 0);
}

static void carry_out(ob_host *h, packet *p, ssize_t n, ob_error *e)
{
	ob_request *r = &p->request;
	e->text[0] = 0;
	if (n != sizeof *p || memcmp(p->magic, magic, sizeof magic) != 0 || p->size != sizeof *r) {
		ob_fail(e, "the request is not of this version of obsim");
		return;
	}
	r->origin = 0;
	if (r->kind == OB_REQUEST_ADD) {
		r->def.passport.name[OB_NAME_MAX - 1] = 0;
		ob_utf8_make_plain(r->def.passport.name);
		r->def.path = NULL, r->def.force = NULL; // only a scene has them
	}
	ob_host_ask(h, r, e);
}

static void end_call(int fd, const ob_error *e)
{
	const ssize_t ignored = send(fd, e, sizeof *e, MSG_NOSIGNAL | MSG_DONTWAIT);
	(void)ignored;
	close(fd);
}

static void drop(ob_asked *a, uint32_t i)
{
	memmove(&a->caller[i], &a->caller[i + 1], (--a->count - i) * sizeof a->caller[0]);
}

// Accepts a caller. If there are too many, closes the one that has been silent longest.
static void take_in(ob_asked *a)
{
	ob_error e;
	const int fd = accept4(a->socket, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd < 0)
		return;
	if (!is_ours(fd)) {
		ob_fail(&e, "this universe belongs to another user");
		end_call(fd, &e);
		return;
	}
	if (a->count == OB_ASKED_CALLERS) {
		ob_fail(&e, "no request was received");
		end_call(a->caller[0], &e);
		drop(a, 0);
	}
	if (watch(a->events, fd))
		a->caller[a->count++] = fd;
	else
		close(fd);
}

enum { VERSION = sizeof magic - 1 }; // place of the version in a magic

// True for a program of any version that wants to control the run.
static bool is_hello(const packet *p, ssize_t n)
{
	return n >= (ssize_t)sizeof p->magic && memcmp(p->magic, OB_CONTROL_MAGIC, VERSION) == 0;
}

// Gives a caller that wants to control the run to the thread that leads it.
static bool hand_over(ob_host *h, ob_asked *a, int fd, char version, ob_error *e)
{
	if (!h->control)
		return ob_fail(e, "this run is not to be controlled: start it with obsim control");
	if (version != OB_CONTROL_MAGIC[VERSION])
		return ob_fail(e, "this run has control protocol %c, and the program %c: use the same obsim for both",
			       OB_CONTROL_MAGIC[VERSION], version);
	epoll_ctl(a->events, EPOLL_CTL_DEL, fd, NULL);
	return ob_control_take(h->control, fd, e);
}

static void answer(ob_host *h, ob_asked *a, int fd)
{
	ob_error e = { "" };
	packet p;
	for (uint32_t i = 0; i < a->count; i++) {
		if (a->caller[i] != fd)
			continue;
		const ssize_t n = recv(fd, &p, sizeof p, MSG_DONTWAIT);
		drop(a, i);
		if (is_hello(&p, n) && hand_over(h, a, fd, p.magic[VERSION], &e))
			return;
		if (!is_hello(&p, n))
			carry_out(h, &p, n, &e);
		end_call(fd, &e);
		return;
	}
}

void ob_asked_answer(ob_host *h, ob_asked *a)
{
	struct epoll_event ready[OB_ASKED_CALLERS];
	const int n = epoll_wait(a->events, ready, OB_ASKED_CALLERS, 0);
	for (int i = 0; i < n; i++) // callers first: each ready one is answered before a new caller may take its place
		if (ready[i].data.fd != a->socket)
			answer(h, a, ready[i].data.fd);
	for (int i = 0; i < n; i++)
		if (ready[i].data.fd == a->socket)
			take_in(a);
}

// ---- the other side

static bool ask(int fd, const ob_universe *u, const ob_request *r, ob_error *e)
{
	packet p = { .size = sizeof *r };
	struct pollfd answered = { .fd = fd, .events = POLLIN };
	ob_error answer;
	memcpy(p.magic, magic, sizeof magic);
	memcpy(&p.request, r, sizeof *r);
	if (send(fd, &p, sizeof p, MSG_NOSIGNAL) != sizeof p || poll(&answered, 1, OB_CALL_PATIENCE_MS) != 1 ||
	    recv(fd, &answer, sizeof answer, 0) != sizeof answer)
		return ob_fail(e, "universe \"%s\" does not answer", ob_universe_name(u));
	answer.text[sizeof answer.text - 1] = 0;
	ob_utf8_make_plain(answer.text);
	return !*answer.text || ob_fail(e, "universe \"%s\": %s", ob_universe_name(u), answer.text);
}

bool ob_ask(const ob_universe *u, const ob_request *r, ob_error *e)
{
	const int fd = ob_call_host(u, e);
	if (fd < 0)
		return false;
	const bool fine = ask(fd, u, r, e);
	close(fd);
	return fine;
}
