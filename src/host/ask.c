#include "host/ask.h"

#include <errno.h>
#include <poll.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/utf8.h"
#include "host/host_state.h"
#include "shape/shape.h"
#include "table/home.h"

enum { ANSWER_PATIENCE_MS = 10000, WAITING = 16 };

static const char magic[8] = { 'O', 'B', 'S', 'I', 'M', 'A', 'S', '1' };

typedef struct packet {
	char magic[8];
	uint64_t size; // size of a request in this program
	ob_request request;
} packet;

static socklen_t address_of(const char *universe, struct sockaddr_un *a)
{
	*a = (struct sockaddr_un){ .sun_family = AF_UNIX };
	const int n = snprintf(a->sun_path + 1, sizeof a->sun_path - 1, "obsim.%s", universe);
	return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)n);
}

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
	const socklen_t n = address_of(universe, &address);
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

static bool is_colour(const float *c)
{
	for (int i = 0; i < 4; i++)
		if (!(c[i] >= 0 && c[i] <= 1))
			return false;
	return true;
}

static bool check_new(const ob_host *h, ob_request *r, ob_error *e)
{
	const ob_shape shape = (ob_shape)r->def.passport.shape;
	ob_hull hull;
	if (!ob_shape_is_bounded(shape) || r->def.script || r->def.state_bytes)
		return ob_fail(e, "only objects with a size and without a script can be created by requests");
	if (!ob_population_find_look(h->population, &r->def, e))
		return false;
	if (!ob_shape_is(shape, OB_HULLED))
		return true;
	if (ob_universe_hulls(h->u) == 0)
		return ob_fail(e, "the one ODE world has no hulls");
	if (r->corners.count > OB_HULL_CORNERS_MAX)
		return ob_fail(e, "a hull has at most %d corners", OB_HULL_CORNERS_MAX);
	if (!ob_hull_build(r->corners.at, r->corners.count, &hull, e))
		return false;
	r->def.passport.size = ob_hull_size(&hull);
	return true;
}

// Checks the target of a move: the worker numbers that a pool has for its number of objects.
static bool check_move(const ob_universe *u, const ob_request *r, const ob_passport *p, ob_error *e)
{
	const uint32_t simulators = ob_universe_simulators(u), ids = ob_universe_ids(u),
		       workers = simulators < ids ? simulators : ids;
	if (ob_universe_settings(u)->monolith)
		return ob_fail(e, "in the one ODE world no object has a simulator");
	if (ob_universe_settings(u)->one_per_object)
		return ob_fail(e, "each object has a worker of its own, and cannot move");
	if (p->flags & (OB_OBJECT_STATIC | OB_OBJECT_KINEMATIC | OB_OBJECT_FROZEN))
		return ob_fail(e, "object %u (%.*s) does not move by forces, and has no simulator", r->id, OB_NAME_MAX,
			       p->name);
	return r->worker < workers ||
	       ob_fail(e, "there is no worker %u for objects: they are 0 to %u", r->worker, workers - 1);
}

static bool check(const ob_host *h, ob_request *r, ob_error *e)
{
	ob_passport p;
	if (r->kind > OB_REQUEST_MOVE)
		return ob_fail(e, "unknown request");
	if (r->kind != OB_REQUEST_MOVE && ob_universe_ranks(h->u) > 1)
		return ob_fail(e, "on several ranks, objects can only be moved");
	if (r->kind == OB_REQUEST_ADD)
		return check_new(h, r, e);
	if (!ob_universe_get_passport(h->u, r->id, &p) || p.generation != r->generation)
		return ob_fail(e, "the object has gone");
	if (r->kind == OB_REQUEST_COLOUR && !is_colour(r->colour))
		return ob_fail(e, "a colour has parts from 0 to 1");
	if (r->kind == OB_REQUEST_MESSAGE && (r->bytes > sizeof r->values || !ob_script_turn_of(h->u, r->id)))
		return ob_fail(e, "object %u (%.*s) has no script to send a message to", r->id, OB_NAME_MAX, p.name);
	return r->kind != OB_REQUEST_MOVE || check_move(h->u, r, &p, e);
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
	if (!check(h, r, e))
		return;
	if (r->kind != OB_REQUEST_MOVE)
		ob_host_request(h, r, e);
	else if (!ob_move_ask(h->u, r->id, r->worker))
		ob_fail(e, "an earlier move takes effect at the next step: send this one again");
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

static void answer(ob_host *h, ob_asked *a, int fd)
{
	ob_error e = { "" };
	packet p;
	for (uint32_t i = 0; i < a->count; i++) {
		if (a->caller[i] != fd)
			continue;
		carry_out(h, &p, recv(fd, &p, sizeof p, MSG_DONTWAIT), &e);
		end_call(fd, &e);
		drop(a, i);
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

// True if the universe's host itself listens there: any process may bind a free address.
static bool is_host(int fd, const ob_universe *u, ob_error *e)
{
	struct ucred who;
	socklen_t n = sizeof who;
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &who, &n) == 0 && (who.uid == geteuid() || geteuid() == 0) &&
	    (who.pid == info.host_pid || who.pid == 0)) // 0: in a PID namespace that is not visible here
		return true;
	return ob_fail(e,
		       "universe \"%s\" gets no request: process %d of user %u listens at its address, not its host %d",
		       ob_universe_name(u), (int)who.pid, (unsigned)who.uid, (int)info.host_pid);
}

static bool ask(int fd, const ob_universe *u, const ob_request *r, ob_error *e)
{
	const char *universe = ob_universe_name(u);
	struct sockaddr_un a;
	const socklen_t n = address_of(universe, &a);
	packet p = { .size = sizeof *r };
	struct pollfd answered = { .fd = fd, .events = POLLIN };
	ob_error answer;
	memcpy(p.magic, magic, sizeof magic);
	memcpy(&p.request, r, sizeof *r);
	if (connect(fd, (struct sockaddr *)&a, n) != 0)
		return ob_fail(e, "universe \"%s\" takes no requests: %s", universe, strerror(errno));
	if (!is_host(fd, u, e))
		return false;
	if (send(fd, &p, sizeof p, MSG_NOSIGNAL) != sizeof p || poll(&answered, 1, ANSWER_PATIENCE_MS) != 1 ||
	    recv(fd, &answer, sizeof answer, 0) != sizeof answer)
		return ob_fail(e, "universe \"%s\" does not answer", universe);
	answer.text[sizeof answer.text - 1] = 0;
	ob_utf8_make_plain(answer.text);
	return !*answer.text || ob_fail(e, "universe \"%s\": %s", universe, answer.text);
}

bool ob_ask(const ob_universe *u, const ob_request *r, ob_error *e)
{
	const struct timeval patience = { .tv_sec = ANSWER_PATIENCE_MS / 1000 }; // limit of connect and send
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return ob_fail(e, "no socket: %s", strerror(errno));
	setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
	const bool fine = ask(fd, u, r, e);
	close(fd);
	return fine;
}
