#include "host/control.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/log.h"
#include "control/packet.h"
#include "host/host_state.h"
#include "host/joining.h"
#include "host/pace.h"
#include "host/request_table.h"
#include "shape/shape.h"

enum { IDLE_MS = 50 };

struct ob_control {
	bool inside; // the program gives its commands itself, and takes the answers
	size_t given; // bytes of its next command, in packet; 0: none
	bool answered;
	int taken[2]; // pipe: sockets of programs, from the supervisor
	atomic_bool busy; // a program controls the run
	int fd; // its socket; -1: none
	uint64_t target; // step that the current command waits for
	bool stepping, running; // a command waits for steps; the run goes on by itself
	ob_control_turn turn; // by the caller, in the current command
	ob_contact_events *events; // NULL: the program has not subscribed
	uint64_t looked; // step at which contacts were looked at
	ob_pace pace; // then
	uint32_t origin; // of the objects that the last command has created; OB_ORIGIN_PROGRAM: of pulls
	ob_control_packet packet;
	ob_control_answer answer;
};

ob_control *ob_control_create(bool inside, ob_error *e)
{
	ob_control *c = calloc(1, sizeof *c);
	if (!c || pipe2(c->taken, O_CLOEXEC | O_NONBLOCK) != 0) {
		ob_fail(e, "no socket for control: %s", strerror(errno));
		free(c);
		return NULL;
	}
	c->inside = inside;
	c->fd = -1;
	c->origin = OB_ORIGIN_PROGRAM;
	ob_pace_begin(&c->pace, 1, false);
	return c;
}

void ob_control_destroy(ob_control *c)
{
	int fd;
	if (!c)
		return;
	while (read(c->taken[0], &fd, sizeof fd) == sizeof fd)
		close(fd);
	close(c->taken[0]);
	close(c->taken[1]);
	if (c->fd >= 0)
		close(c->fd);
	ob_contact_events_destroy(c->events);
	ob_pace_end(&c->pace);
	free(c);
}

bool ob_control_take(ob_control *c, int fd, ob_error *e)
{
	if (atomic_exchange(&c->busy, true))
		return ob_fail(e, "another program controls this run");
	return write(c->taken[1], &fd, sizeof fd) == sizeof fd || ob_fail(e, "%s", strerror(errno));
}

static void answer(ob_control *c, ob_host *h)
{
	const ob_universe *u = h->u;
	ob_control_answer *a = &c->answer;
	a->step = ob_step_count(u);
	a->time = (double)a->step * ob_universe_settings(u)->step_length;
	c->answered = true;
	if (c->inside)
		return;
	const ssize_t ignored = send(c->fd, a, sizeof *a, MSG_NOSIGNAL | MSG_DONTWAIT); // it is small, and the only one
	(void)ignored;
}

void ob_control_end(ob_control *c, const char *why)
{
	ob_fail(&c->answer.error, "%s", why);
	c->answered = true;
	if (c->fd >= 0 && (c->stepping || c->turn == OB_CONTROL_RESETS))
		send(c->fd, &c->answer, sizeof c->answer, MSG_NOSIGNAL | MSG_DONTWAIT);
	if (c->fd >= 0)
		close(c->fd); // a command that comes now finds that the run has ended
	c->fd = -1;
}

// ---- commands

// Carries out requests that were queued. The universe stands, and goes nowhere.
static void flush(ob_host *h)
{
	ob_host_go(h, ob_step_count(h->u));
}

static bool find_object(const ob_host *h, const ob_change *change, ob_request *r, ob_error *e)
{
	ob_passport p;
	if (!ob_universe_get_passport(h->u, change->id, &p))
		return ob_fail(e, "there is no object %u", change->id);
	if (change->generation && change->generation != p.generation)
		return ob_fail(e, "object %u has gone: another has its place", change->id);
	r->id = change->id;
	r->generation = p.generation;
	return true;
}

static void read_change(const ob_change *change, const ob_request_row *row, ob_request *r)
{
	enum { VALUES = sizeof change->value / sizeof *change->value };
	const double *v = change->value;
	const uint32_t joint = row->to == OB_TO_JOINT;
	ob_request_begin(r, row);
	r->origin = OB_ORIGIN_PROGRAM;
	r->joint = joint && v[0] >= 0 && v[0] < UINT32_MAX ? (uint32_t)v[0] : UINT32_MAX;
	ob_request_put_numbers(r, v + joint, VALUES - joint);
}

// All changes of the packet, or none: those of a command, and behind them `forces` changes of forces.
static bool change_objects(ob_control *c, ob_host *h, ob_control_command command, uint32_t forces, ob_error *e)
{
	const ob_request_row *const row = ob_request_row_of_control(command), *const force = ob_request_row_of_control(
										      OB_CONTROL_FORCE);
	const ob_control_packet *p = &c->packet;
	if (!row)
		return ob_fail(e, "this version of obsim has no command %u", command);
	bool fine = p->count <= OB_CONTROL_BATCH && forces <= OB_CONTROL_BATCH - p->count &&
		    p->bytes == (p->count + forces) * sizeof(ob_change);
	if (!fine)
		return ob_fail(e, "the list of changes has a wrong length");
	const uint32_t n = p->count + forces;
	if (!n)
		return true;
	ob_request *all = calloc(n, sizeof *all);
	if (!all)
		return ob_fail(e, "out of memory");
	for (uint32_t i = 0; i < n && fine; i++) {
		ob_change change;
		memcpy(&change, p->payload + i * sizeof change, sizeof change);
		read_change(&change, i < p->count ? row : force, &all[i]);
		fine = find_object(h, &change, &all[i], e) && ob_request_check(h, &all[i], e);
	}
	for (uint32_t i = 0; i < n && fine; i++)
		fine = ob_host_ask(h, &all[i], e);
	free(all);
	flush(h);
	return fine;
}

static void list_created(ob_control *c, const ob_host *h)
{
	ob_control_answer *a = &c->answer;
	const size_t n = ob_roster_copy(h->roster, NULL, 0);
	ob_roster_entry *all = malloc((n + 1) * sizeof *all);
	const size_t copied = all ? ob_roster_copy(h->roster, all, n) : 0;
	for (size_t i = 0; i < copied && i < n; i++)
		if (all[i].origin == c->origin && a->count < OB_CONTROL_IDS)
			a->id[a->count++] = all[i].id;
	free(all);
}

static bool ask_for(void *host, ob_request *r, ob_error *e)
{
	return ob_host_ask(host, r, e);
}

static bool create(ob_control *c, ob_host *h, ob_error *e)
{
	const ob_control_packet *p = &c->packet;
	const bool fine = ob_create_as_scene(h->u, (const char *)p->payload, p->bytes, ++c->origin, ask_for, h, e);
	flush(h);
	list_created(c, h);
	return fine;
}

static bool send_message(ob_control *c, ob_host *h, ob_error *e)
{
	const ob_control_packet *p = &c->packet;
	ob_change to;
	ob_request r = { .kind = OB_REQUEST_MESSAGE };
	if (p->bytes < sizeof to || (p->bytes > sizeof to && p->payload[p->bytes - 1] != 0))
		return ob_fail(e, "the message has a wrong length");
	memcpy(&to, p->payload, sizeof to);
	for (size_t at = sizeof to; at < p->bytes; at += strlen((const char *)p->payload + at) + 1)
		if (!ob_scene_put_value((const char *)p->payload + at, r.values, &r.bytes, sizeof r.values))
			return ob_fail(e, "message: at most %zu bytes can be sent", sizeof r.values);
	const bool fine = find_object(h, &to, &r, e) && ob_host_ask(h, &r, e);
	flush(h);
	return fine;
}

static bool give_path(const ob_control *c, ob_host *h, ob_error *e)
{
	const ob_control_packet *p = &c->packet;
	ob_change to;
	ob_request r = { .kind = OB_REQUEST_PATH };
	if (p->count > OB_REQUEST_POINTS || p->bytes != sizeof to + p->count * sizeof *r.path.point)
		return ob_fail(e, "the path has a wrong length");
	memcpy(&to, p->payload, sizeof to);
	memcpy(r.path.point, p->payload + sizeof to, p->count * sizeof *r.path.point);
	r.path.points = p->count;
	r.path.turns = to.value[0] != 0;
	r.path.loop = to.value[1] != 0;
	const bool fine = find_object(h, &to, &r, e) && ob_host_ask(h, &r, e);
	flush(h);
	return fine;
}

// Checks that the payload holds as many words as it says, each ended by 0.
static bool has_words(const ob_control_packet *p, ob_error *e)
{
	uint32_t words = 0;
	for (uint32_t i = 0; i < p->bytes; i++)
		words += p->payload[i] == 0;
	return (words == p->count && (p->bytes == 0 || p->payload[p->bytes - 1] == 0)) ||
	       ob_fail(e, "the words of the command are not whole");
}

// Leaves the command to the caller of ob_control_next.
static bool hand_on(ob_control *c, ob_control_turn turn, ob_error *e)
{
	if (!has_words(&c->packet, e))
		return false;
	if (turn == OB_CONTROL_SAVES && c->packet.count != 1)
		return ob_fail(e, "save: expected a path");
	c->turn = turn;
	return true;
}

static bool subscribe(ob_control *c, const ob_host *h, ob_error *e)
{
	ob_contact_events_destroy(c->events);
	c->events = c->packet.number ? ob_contact_events_create(h->u) : NULL;
	c->looked = ob_step_count(h->u);
	return c->events || !c->packet.number || ob_fail(e, "out of memory");
}

static bool take_events(ob_control *c, ob_error *e)
{
	enum { EACH = OB_CONTROL_IDS / 4 };
	ob_control_answer *a = &c->answer;
	if (!c->events)
		return ob_fail(e, "no contacts are noted: subscribe first");
	a->count = (uint32_t)ob_contact_events_take(c->events, a->event,
						    c->packet.number < EACH ? c->packet.number : EACH, &a->number);
	return true;
}

// After a wait: notes contacts of a step that has ended.
static void look_at_contacts(ob_control *c, const ob_host *h)
{
	const uint64_t now = ob_step_count(h->u);
	if (!c->events || now == c->looked)
		return;
	if (!ob_contact_events_look(c->events, h->u, now < c->looked))
		ob_log_warn("out of memory: contacts are no longer noted");
	c->looked = now;
}

static bool restore(ob_control *c, ob_host *h, uint64_t number, ob_error *e)
{
	ob_pace_restart(&c->pace);
	const bool fine = ob_host_restore_snapshot(h, number, e);
	if (fine && c->events)
		ob_contact_events_look(c->events, h->u, true);
	c->looked = ob_step_count(h->u);
	return fine;
}

static bool begin_steps(ob_control *c, const ob_host *h, uint64_t last, ob_error *e)
{
	const uint64_t now = ob_step_count(h->u), left = last - now;
	if (c->packet.number > left)
		return ob_fail(e, "step: expected at most %llu, as the run then ends, got %llu",
			       (unsigned long long)left, (unsigned long long)c->packet.number);
	c->target = now + c->packet.number;
	c->stepping = c->packet.number > 0;
	return true;
}

static bool begin_run(ob_control *c, ob_error *e)
{
	if (c->inside)
		return ob_fail(e, "go: inside a program a run goes on by its steps alone; take it outside");
	if (!(c->packet.value > 0))
		return ob_fail(e, "pace: expected a positive number, got %g", c->packet.value);
	ob_pace_set_rate(&c->pace, c->packet.value);
	c->running = true;
	return true;
}

// Carries out the command in c->packet. Errors change nothing, but for lists of objects to create.
static bool carry_out(ob_control *c, ob_host *h, uint64_t last, ob_error *e)
{
	ob_control_answer *a = &c->answer;
	const uint64_t number = c->packet.number;
	switch (c->packet.command) {
	case OB_CONTROL_HELLO:
		return true;
	case OB_CONTROL_STEP:
		c->running = false;
		return change_objects(c, h, OB_CONTROL_MOTOR, c->packet.forces, e) && begin_steps(c, h, last, e);
	case OB_CONTROL_RUN:
		return begin_run(c, e);
	case OB_CONTROL_PAUSE:
		c->running = false;
		return true;
	case OB_CONTROL_SNAPSHOT:
		return (a->number = ob_host_keep_snapshot(h, e)) != 0;
	case OB_CONTROL_RESTORE:
		return restore(c, h, number, e);
	case OB_CONTROL_FORGET:
		return ob_host_forget_snapshot(h, number, e);
	case OB_CONTROL_CREATE:
		return create(c, h, e);
	case OB_CONTROL_MESSAGE:
		return send_message(c, h, e);
	case OB_CONTROL_PATH:
		return give_path(c, h, e);
	case OB_CONTROL_RESET:
		return hand_on(c, OB_CONTROL_RESETS, e);
	case OB_CONTROL_SAVE:
		return hand_on(c, OB_CONTROL_SAVES, e);
	case OB_CONTROL_SUBSCRIBE:
		return subscribe(c, h, e);
	case OB_CONTROL_EVENTS:
		return take_events(c, e);
	default:
		return change_objects(c, h, c->packet.command, 0, e);
	}
}

// ---- the session

static bool is_whole(const ob_control_packet *p, ssize_t n)
{
	const size_t head = offsetof(ob_control_packet, payload);
	return n >= (ssize_t)head && memcmp(p->magic, OB_CONTROL_MAGIC, sizeof p->magic) == 0 &&
	       p->bytes == (size_t)n - head;
}

static void take_command(ob_control *c, ob_host *h, uint64_t last, ssize_t n)
{
	ob_error e;
	c->answer = (ob_control_answer){ .error = { "" } };
	if (!is_whole(&c->packet, n))
		ob_fail(&c->answer.error, "the command makes no sense to this version of obsim");
	else if (!carry_out(c, h, last, &e))
		c->answer.error = e;
	if (!c->stepping && c->turn == OB_CONTROL_GOES_ON)
		answer(c, h);
}

void ob_control_give(ob_control *c, const ob_control_packet *p, size_t bytes)
{
	memcpy(&c->packet, p, bytes);
	c->given = bytes;
	c->answered = false;
}

const ob_control_answer *ob_control_answered(const ob_control *c)
{
	return c->answered ? &c->answer : NULL;
}

static void take_given(ob_control *c, ob_host *h, uint64_t last)
{
	const ssize_t n = (ssize_t)c->given;
	c->given = 0;
	if (n > 0)
		take_command(c, h, last, n);
}

// Waits for the program, or for a first one. false: it has left.
static bool listen_for(ob_control *c, ob_host *h, uint64_t last, int patience_ms)
{
	struct pollfd p = { .fd = c->fd >= 0 ? c->fd : c->taken[0], .events = POLLIN };
	if (poll(&p, 1, patience_ms) != 1)
		return true;
	if (c->fd < 0) {
		if (read(c->taken[0], &c->fd, sizeof c->fd) != sizeof c->fd)
			c->fd = -1;
		else
			answer(c, h); // its hello was valid
		return true;
	}
	const ssize_t n = c->stepping ? -1 : recv(c->fd, &c->packet, sizeof c->packet, MSG_DONTWAIT);
	if (n > 0)
		take_command(c, h, last, n);
	return n > 0 || (!(p.revents & (POLLHUP | POLLERR)) && (n < 0 || c->stepping));
}

const char *ob_control_words(const ob_control *c, uint32_t *count, const uint64_t **seed)
{
	*count = c->packet.count;
	*seed = c->packet.value != 0 ? &c->packet.number : NULL;
	return (const char *)c->packet.payload;
}

void ob_control_reply(ob_control *c, ob_host *h, const ob_error *why)
{
	if (why)
		c->answer.error = *why;
	c->turn = OB_CONTROL_GOES_ON;
	answer(c, h);
}

// Begins with a new host: nothing of the old one holds any more.
static void begin_anew(ob_control *c, ob_host *h)
{
	ob_contact_events *old = c->events;
	c->stepping = c->running = false;
	c->events = old ? ob_contact_events_create(h->u) : NULL;
	c->looked = ob_step_count(h->u);
	ob_contact_events_destroy(old);
	ob_pace_restart(&c->pace);
	ob_control_reply(c, h, NULL);
}

ob_control_turn ob_control_next(ob_control *c, ob_host *h, uint64_t last, uint64_t *step)
{
	const double length = ob_universe_settings(h->u)->step_length;
	uint64_t now = ob_step_count(h->u);
	if (c->turn == OB_CONTROL_RESETS)
		begin_anew(c, h);
	c->turn = OB_CONTROL_GOES_ON;
	look_at_contacts(c, h);
	if (c->stepping && now >= c->target) {
		c->stepping = false;
		answer(c, h);
	}
	const bool stands = !c->stepping && (!c->running || now >= last);
	if (c->inside)
		take_given(c, h, last);
	else if (!listen_for(c, h, last, stands ? IDLE_MS : 0))
		return OB_CONTROL_LEFT;
	now = ob_step_count(h->u); // a snapshot may have been restored
	*step = now;
	if (c->turn != OB_CONTROL_GOES_ON)
		return c->turn;
	if (c->stepping) {
		*step = c->target;
	} else if (c->running && now < last) {
		const uint64_t due = ob_pace_wait(&c->pace, now, length, UINT64_MAX, .001);
		*step = due < last ? due : last;
	}
	if (c->events && *step > now)
		*step = now + 1;
	h->caller = (struct pollfd){ .fd = c->fd, .events = c->stepping ? 0 : POLLIN };
	return OB_CONTROL_GOES_ON;
}

// ---- contact events

typedef struct pair {
	uint32_t a, b;
} pair;

struct ob_contact_events {
	ob_contact_point *point; // [points_max]: scratch
	pair *before, *now; // ascending; [pairs_max]
	size_t points_max, count_before, count, pairs_max;
	ob_contact_event *event; // [events]
	size_t events, events_max;
	uint64_t lost;
};

static int by_ids(const void *pa, const void *pb)
{
	const pair *a = pa, *b = pb;
	if (a->a != b->a)
		return a->a < b->a ? -1 : 1;
	return (a->b > b->b) - (a->b < b->b);
}

static bool reserve_pairs(ob_contact_events *c, size_t count)
{
	size_t one = c->pairs_max, other = c->pairs_max;
	if (!OB_RESERVE(c->before, count, one) || !OB_RESERVE(c->now, count, other))
		return false;
	c->pairs_max = one;
	return true;
}

// Lists the pairs that touch.
static bool list_pairs(ob_contact_events *c, const ob_universe *u)
{
	size_t n = ob_universe_get_contacts(u, c->point, c->points_max);
	while (n > c->points_max) {
		if (!OB_RESERVE(c->point, n, c->points_max))
			return false;
		n = ob_universe_get_contacts(u, c->point, c->points_max);
	}
	if (!reserve_pairs(c, n + 1))
		return false;
	for (size_t i = 0; i < n; i++)
		c->now[i] = (pair){ c->point[i].a, c->point[i].b };
	qsort(c->now, n, sizeof *c->now, by_ids);
	c->count = 0;
	for (size_t i = 0; i < n; i++)
		if (i == 0 || by_ids(&c->now[i], &c->now[c->count - 1]) != 0)
			c->now[c->count++] = c->now[i];
	return true;
}

static void add(ob_contact_events *c, pair p, bool begins, uint64_t step)
{
	if (c->events < OB_CONTACT_EVENTS_MAX && OB_MAKE_ROOM(c->event, c->events, c->events_max))
		c->event[c->events++] = (ob_contact_event){ p.a, p.b, (uint32_t)step, begins };
	else
		c->lost++;
}

// Merges both lists.
static void compare(ob_contact_events *c, uint64_t step)
{
	for (size_t i = 0, k = 0; i < c->count_before || k < c->count;) {
		const int order = i == c->count_before ? 1 : k == c->count ? -1 : by_ids(&c->before[i], &c->now[k]);
		if (order < 0)
			add(c, c->before[i], false, step);
		else if (order > 0)
			add(c, c->now[k], true, step);
		i += order <= 0;
		k += order >= 0;
	}
}

bool ob_contact_events_look(ob_contact_events *c, const ob_universe *u, bool silent)
{
	ob_universe_info info;
	if (!list_pairs(c, u))
		return false;
	ob_universe_get_info(u, &info);
	if (!silent)
		compare(c, info.step);
	pair *reused = c->before;
	c->before = c->now;
	c->now = reused;
	c->count_before = c->count;
	return true;
}

ob_contact_events *ob_contact_events_create(const ob_universe *u)
{
	ob_contact_events *c = calloc(1, sizeof *c);
	if (c && ob_contact_events_look(c, u, true))
		return c;
	ob_contact_events_destroy(c);
	return NULL;
}

void ob_contact_events_destroy(ob_contact_events *c)
{
	if (!c)
		return;
	free(c->point);
	free(c->before);
	free(c->now);
	free(c->event);
	free(c);
}

size_t ob_contact_events_take(ob_contact_events *c, ob_contact_event *out, size_t max, uint64_t *lost)
{
	const size_t n = c->events < max ? c->events : max;
	if (n)
		memcpy(out, c->event, n * sizeof *out);
	c->events -= n;
	if (n)
		memmove(c->event, c->event + n, c->events * sizeof *out);
	*lost = c->lost;
	c->lost = 0;
	return n;
}
