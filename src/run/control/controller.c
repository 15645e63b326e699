#include <ob/control.h>

#include <assert.h>
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/utf8.h"
#include "control/call.h"
#include "control/inside.h"

struct ob_controller {
	int fd; // -1: the run is inside
	const ob_inside_part *part; // NULL: outside
	ob_inside_run *inside;
	ob_control_packet packet; // the current command
	const ob_control_answer *answer; // the last one
	ob_control_answer received; // storage of an answer from outside
};

// Begins a command; call sends it.
static ob_control_packet *command(ob_controller *c, ob_control_command which)
{
	ob_control_packet *p = &c->packet;
	memset(p, 0, offsetof(ob_control_packet, payload));
	memcpy(p->magic, OB_CONTROL_MAGIC, sizeof p->magic);
	p->command = which;
	return p;
}

// Gives the command and waits for its answer: a step takes as long as it takes.
static bool call(ob_controller *c, ob_error *e)
{
	const size_t bytes = offsetof(ob_control_packet, payload) + c->packet.bytes;
	ob_control_answer *a = &c->received;
	if (c->inside) {
		c->answer = c->part->call(c->inside, &c->packet, bytes);
		return !*c->answer->error.text || ob_fail(e, "%s", c->answer->error.text);
	}
	ssize_t n = send(c->fd, &c->packet, bytes, MSG_NOSIGNAL);
	if (n != (ssize_t)bytes)
		return ob_fail(e, "the run has ended");
	do
		n = recv(c->fd, a, sizeof *a, 0);
	while (n < 0 && errno == EINTR);
	if (n < (ssize_t)sizeof a->error)
		return ob_fail(e, "the run has ended");
	a->error.text[sizeof a->error.text - 1] = 0;
	ob_utf8_make_plain(a->error.text);
	if (n == (ssize_t)sizeof *a && !*a->error.text)
		return true;
	return ob_fail(e, "%s", *a->error.text ? a->error.text : "the run is of another version of obsim");
}

static ob_controller *create(ob_error *e)
{
	ob_controller *c = calloc(1, sizeof *c);
	if (!c) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	c->fd = -1;
	c->answer = &c->received;
	return c;
}

ob_controller *ob_controller_open(const ob_universe *u, ob_error *e)
{
	ob_controller *c = create(e);
	if (c && (c->fd = ob_call_host(u, e)) >= 0) {
		command(c, OB_CONTROL_HELLO);
		if (call(c, e))
			return c;
	}
	ob_controller_close(c);
	return NULL;
}

ob_controller *ob_controller_open_inside(const char *const *words, size_t n, char name[OB_NAME_MAX], ob_error *e)
{
	ob_controller *c = create(e);
	if (!c)
		return NULL;
	c->part = ob_part_load("inside", sizeof *c->part, OB_PART_OWN, "obsim", e);
	c->inside = c->part ? c->part->open(words, n, name, e) : NULL;
	command(c, OB_CONTROL_HELLO);
	if (c->inside && call(c, e))
		return c;
	ob_controller_close(c);
	return NULL;
}

void ob_controller_close(ob_controller *c)
{
	if (c && c->fd >= 0)
		close(c->fd);
	if (c && c->inside)
		c->part->close(c->inside);
	free(c);
}

int ob_controller_fd(const ob_controller *c)
{
	return c->fd;
}

uint64_t ob_controller_steps(const ob_controller *c)
{
	return c->answer->step;
}

double ob_controller_time(const ob_controller *c)
{
	return c->answer->time;
}

static bool call_number(ob_controller *c, ob_control_command which, uint64_t number, ob_error *e)
{
	command(c, which)->number = number;
	return call(c, e);
}

bool ob_controller_step(ob_controller *c, uint64_t steps, ob_error *e)
{
	return call_number(c, OB_CONTROL_STEP, steps, e);
}

bool ob_controller_step_with(ob_controller *c, uint64_t steps, const ob_change *motor, size_t motors,
			     const ob_change *force, size_t forces, ob_error *e)
{
	if (motors > OB_CONTROL_BATCH || forces > OB_CONTROL_BATCH - motors)
		return ob_controller_set_motors(c, motor, motors, e) && ob_controller_set_forces(c, force, forces, e) &&
		       ob_controller_step(c, steps, e);
	ob_control_packet *p = command(c, OB_CONTROL_STEP);
	p->number = steps;
	p->count = (uint32_t)motors;
	p->forces = (uint32_t)forces;
	p->bytes = (uint32_t)((motors + forces) * sizeof *motor);
	if (motors)
		memcpy(p->payload, motor, motors * sizeof *motor);
	if (forces)
		memcpy(p->payload + motors * sizeof *motor, force, forces * sizeof *force);
	return call(c, e);
}

bool ob_controller_run(ob_controller *c, double pace, ob_error *e)
{
	command(c, OB_CONTROL_RUN)->value = pace;
	return call(c, e);
}

bool ob_controller_pause(ob_controller *c, ob_error *e)
{
	return call_number(c, OB_CONTROL_PAUSE, 0, e);
}

bool ob_controller_snapshot(ob_controller *c, uint64_t *snapshot, ob_error *e)
{
	const bool fine = call_number(c, OB_CONTROL_SNAPSHOT, 0, e);
	*snapshot = fine ? c->answer->number : 0;
	return fine;
}

bool ob_controller_restore(ob_controller *c, uint64_t snapshot, ob_error *e)
{
	return call_number(c, OB_CONTROL_RESTORE, snapshot, e);
}

bool ob_controller_forget(ob_controller *c, uint64_t snapshot, ob_error *e)
{
	return call_number(c, OB_CONTROL_FORGET, snapshot, e);
}

// Sends changes, in as many packets as they take.
static bool change_all(ob_controller *c, ob_control_command which, const ob_change *change, size_t n, ob_error *e)
{
	static_assert(OB_CONTROL_BATCH * sizeof *change <= OB_CONTROL_PAYLOAD, "a batch fits");
	bool fine = true;
	for (size_t at = 0, some; at < n && fine; at += some) {
		some = n - at < OB_CONTROL_BATCH ? n - at : OB_CONTROL_BATCH;
		ob_control_packet *p = command(c, which);
		p->count = (uint32_t)some;
		p->bytes = (uint32_t)(some * sizeof *change);
		memcpy(p->payload, change + at, p->bytes);
		fine = call(c, e);
	}
	return fine;
}

#define CHANGE(name, command) \
	bool ob_controller_##name(ob_controller *c, const ob_change *change, size_t n, ob_error *e) \
	{ \
		return change_all(c, OB_CONTROL_##command, change, n, e); \
	}
CHANGE(set_forces, FORCE)
CHANGE(kick, KICK)
CHANGE(set_states, STATE)
CHANGE(set_colours, COLOUR)
CHANGE(remove, REMOVE)
CHANGE(set_torques, TORQUE)
CHANGE(push, PUSH)
CHANGE(drag, DRAG)
CHANGE(release, RELEASE)
CHANGE(set_frictions, FRICTION)
CHANGE(set_surface_velocities, SURFACE)
CHANGE(set_motors, MOTOR)
CHANGE(unjoin, UNJOIN)
CHANGE(kill, KILL)

bool ob_controller_create(ob_controller *c, const char *text, uint32_t *ids, size_t max, size_t *n, ob_error *e)
{
	const size_t bytes = strlen(text);
	ob_control_packet *p = command(c, OB_CONTROL_CREATE);
	if (bytes > sizeof p->payload)
		return ob_fail(e, "create: expected a text of at most %zu bytes, got %zu", sizeof p->payload, bytes);
	p->bytes = (uint32_t)bytes;
	memcpy(p->payload, text, bytes);
	if (!call(c, e))
		return false;
	const size_t count = c->answer->count < OB_CONTROL_IDS ? c->answer->count : OB_CONTROL_IDS;
	memcpy(ids, c->answer->id, (count < max ? count : max) * sizeof *ids);
	*n = count;
	return true;
}

// Adds words to the payload, each with the 0 that ends it.
static bool add_words(ob_control_packet *p, const char *const *word, size_t n, const char *what, ob_error *e)
{
	p->count = (uint32_t)n;
	for (size_t i = 0; i < n; i++) {
		const size_t size = strlen(word[i]) + 1;
		if (size > sizeof p->payload - p->bytes)
			return ob_fail(e, "%s: expected at most %zu bytes in all", what, sizeof p->payload);
		memcpy(p->payload + p->bytes, word[i], size);
		p->bytes += (uint32_t)size;
	}
	return true;
}

bool ob_controller_message(ob_controller *c, uint32_t id, const char *const *words, size_t n, ob_error *e)
{
	const ob_change to = { .id = id };
	ob_control_packet *p = command(c, OB_CONTROL_MESSAGE);
	memcpy(p->payload, &to, sizeof to);
	p->bytes = sizeof to;
	return add_words(p, words, n, "message", e) && call(c, e);
}

bool ob_controller_set_path(ob_controller *c, uint32_t id, const ob_path_point *point, size_t n, bool turns, bool loop,
			    ob_error *e)
{
	const ob_change to = { .id = id, .value = { turns, loop } };
	ob_control_packet *p = command(c, OB_CONTROL_PATH);
	if (n > OB_CONTROL_POINTS)
		return ob_fail(e, "path: expected at most %d points, got %zu", OB_CONTROL_POINTS, n);
	p->count = (uint32_t)n;
	p->bytes = (uint32_t)(sizeof to + n * sizeof *point);
	memcpy(p->payload, &to, sizeof to);
	if (n)
		memcpy(p->payload + sizeof to, point, n * sizeof *point);
	return call(c, e);
}

bool ob_controller_reset(ob_controller *c, const uint64_t *seed, const char *const *parameters, size_t n, ob_error *e)
{
	ob_control_packet *p = command(c, OB_CONTROL_RESET);
	p->value = seed != NULL;
	p->number = seed ? *seed : 0;
	return add_words(p, parameters, n, "parameters", e) && call(c, e);
}

bool ob_controller_save(ob_controller *c, const char *path, ob_error *e)
{
	return add_words(command(c, OB_CONTROL_SAVE), &path, 1, "path", e) && call(c, e);
}

bool ob_controller_subscribe_contacts(ob_controller *c, bool on, ob_error *e)
{
	return call_number(c, OB_CONTROL_SUBSCRIBE, on, e);
}

bool ob_controller_take_contacts(ob_controller *c, ob_contact_event *out, size_t max, size_t *n, uint64_t *lost,
				 ob_error *e)
{
	enum { EACH = OB_CONTROL_IDS / 4 };
	*n = 0;
	*lost = 0;
	for (size_t some = EACH; some == EACH && *n < max; *n += some) {
		const size_t most = max - *n < EACH ? max - *n : EACH;
		if (!call_number(c, OB_CONTROL_EVENTS, most, e))
			return false;
		some = c->answer->count < most ? c->answer->count : most;
		memcpy(out + *n, c->answer->event, some * sizeof *out);
		*lost += c->answer->number;
	}
	return true;
}
