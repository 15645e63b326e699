// Ten thousand hostile packets: to the socket of requests and to a program's control of a run, random bytes and packets that
// were valid before some of their bytes were changed. The run goes on, its states stay finite, and it still answers.
//
// hostile [PACKETS [SEED]]: by hand, as many under a sanitizer, too
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "base/random.h"
#include "base/sanitizer.h"
#include "check.h"
#include "control/call.h"
#include "control/packet.h"
#include "host/ask.h"
#include "host/control.h"
#include "little_scene.h"
#include "workers.h"

enum { BALLS = 12, EACH_STEPS = 50, PACKETS = OB_SANITIZED ? 1000 : 10000 }; // sanitizers take ten times as long

static uint64_t state = 1;

static uint64_t draw(uint64_t below)
{
	return ob_splitmix(&state) % below;
}

// ---- the run

typedef struct led_run {
	ob_host *host;
	ob_control *control;
	pthread_t thread;
	bool failed;
	ob_error e;
} led_run;

static void *lead(void *argument)
{
	led_run *r = argument;
	const ob_error refused = { "not here" };
	ob_control_turn turn = OB_CONTROL_GOES_ON;
	for (uint64_t step = 0; turn != OB_CONTROL_LEFT;) {
		ob_host_go(r->host, step);
		r->failed = !ob_host_wait(r->host, &r->e);
		if (r->failed)
			break;
		turn = ob_control_next(r->control, r->host, 1 << 30, &step);
		if (turn == OB_CONTROL_SAVES || turn == OB_CONTROL_RESETS)
			ob_control_reply(r->control, r->host, &refused);
	}
	if (r->failed)
		ob_control_end(r->control, r->e.text);
	return NULL;
}

// ---- packets

static double number(void)
{
	static const double some[] = { 0, 1, -1, .5, NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300, 3, 1e7 };
	return some[draw(sizeof some / sizeof *some)];
}

// Changes some words, bytes or bits.
static void spoil(unsigned char *at, size_t bytes)
{
	static const uint32_t words[] = { 0, 1, 2, 255, 0x7fffffff, 0x80000000, 0xffffffff };
	for (uint64_t n = 1 + draw(4); n > 0; n--) {
		const double x = number();
		switch (draw(3)) {
		case 0:
			memcpy(at + 8 * draw(bytes / 8), &x, sizeof x);
			break;
		case 1:
			memcpy(at + 4 * draw(bytes / 4), &words[draw(7)], 4);
			break;
		default:
			at[draw(bytes)] ^= (unsigned char)(1 << draw(8));
		}
	}
}

// A request as another program sends it (host/ask.c).
typedef struct asking {
	char magic[8];
	uint64_t size;
	ob_request request;
} asking;

static void make_request(asking *p)
{
	*p = (asking){ .size = sizeof p->request };
	memcpy(p->magic, "OBSIMAS1", sizeof p->magic);
	ob_request *r = &p->request;
	r->kind = (uint32_t)draw(OB_REQUEST_KINDS + 1);
	r->id = (uint32_t)draw(BALLS + 3);
	r->generation = 1;
	r->def = ball("guest", 3 + (double)draw(50), 9, 5);
	r->frequency = r->friction = 1;
	r->state = (ob_state){ { { NAN, 0, 0 }, { NAN, 0, 0, 0 } }, { NAN, 0, 0 }, { 0, 0, 1 } };
	r->force = r->twist = ob_v3(0, 0, 1e-4);
	r->target = ob_v3(0, 0, 2);
	if (r->kind == OB_REQUEST_PATH)
		r->path = (ob_request_path){ .points = 1, .point = { { 1, { 0, 0, 2 }, { 1, 0, 0, 0 } } } };
	if (draw(4))
		spoil((unsigned char *)r, sizeof *r);
	if (draw(8) == 0)
		spoil((unsigned char *)p, sizeof *p);
}

// Sends a request and waits for the answer, or closes at once.
static void send_request(const char *name)
{
	asking p;
	ob_error answer;
	struct sockaddr_un a;
	const socklen_t n = ob_call_address(name, &a);
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
	make_request(&p);
	const size_t bytes = draw(8) ? sizeof p : draw(sizeof p) + 1;
	if (connect(fd, (struct sockaddr *)&a, n) == 0 && send(fd, &p, bytes, MSG_NOSIGNAL) == (ssize_t)bytes &&
	    draw(8))
		CHECK(recv(fd, &answer, sizeof answer, 0) == sizeof answer);
	close(fd);
}

static void make_command(ob_control_packet *p, size_t *bytes)
{
	const size_t head = offsetof(ob_control_packet, payload);
	const uint32_t count = (uint32_t)draw(6);
	memset(p, 0, head);
	memcpy(p->magic, OB_CONTROL_MAGIC, sizeof p->magic);
	p->command = (uint32_t)draw(OB_CONTROL_COMMANDS + 1);
	p->count = count;
	p->bytes = count * (uint32_t)sizeof(ob_change);
	p->number = draw(3);
	p->value = 1;
	for (uint32_t i = 0; i < 6; i++) {
		ob_change c = { .id = (uint32_t)draw(BALLS + 3) };
		for (int k = 0; k < 13; k++)
			c.value[k] = draw(2) ? number() : 1e-3 * (double)draw(100);
		memcpy(p->payload + i * sizeof c, &c, sizeof c);
	}
	if (p->command == OB_CONTROL_PATH)
		p->bytes = (uint32_t)(sizeof(ob_change) + count * sizeof(ob_path_point));
	if (p->command == OB_CONTROL_CREATE)
		p->bytes = (uint32_t)snprintf((char *)p->payload, 200, "sphere { radius = %g, at = { %d, 0, 9 } }",
					      number(), (int)draw(99));
	if (draw(3) == 0 && p->bytes >= 8)
		spoil(p->payload, p->bytes);
	if (draw(6) == 0)
		spoil((unsigned char *)p + sizeof p->magic, head - sizeof p->magic);
	*bytes = draw(8) ? head + (p->bytes <= OB_CONTROL_PAYLOAD ? p->bytes : OB_CONTROL_PAYLOAD) : draw(head) + 1;
	if (p->command == OB_CONTROL_STEP || p->command == OB_CONTROL_RUN) // long steps say nothing
		p->number = draw(3), p->value = number();
}

static bool send_command(int fd)
{
	static ob_control_packet p;
	static ob_control_answer a;
	size_t bytes;
	make_command(&p, &bytes);
	return send(fd, &p, bytes, MSG_NOSIGNAL) == (ssize_t)bytes && recv(fd, &a, sizeof a, 0) == sizeof a;
}

static bool step(int fd)
{
	static ob_control_packet p;
	static ob_control_answer a;
	memcpy(p.magic, OB_CONTROL_MAGIC, sizeof p.magic);
	p.command = OB_CONTROL_STEP;
	p.number = 1;
	return send(fd, &p, offsetof(ob_control_packet, payload), MSG_NOSIGNAL) > 0 &&
	       recv(fd, &a, sizeof a, 0) == sizeof a && !*a.error.text;
}

static void check_states(const ob_universe *u)
{
	ob_universe_info info;
	ob_motion m;
	ob_universe_get_info(u, &info);
	for (uint32_t id = 0; id < info.capacity; id++)
		CHECK(!ob_universe_get_motion(u, id, &m) || isfinite(ob_norm2(m.p) + ob_norm2(m.v) + ob_norm2(m.w)));
}

static void attack(ob_isolation isolation, long packets)
{
	ob_error e = { "" };
	ob_scene s = little_scene(BALLS);
	ob_host_config c = little_config(&s, isolation, 2);
	led_run r = { .control = ob_control_create(false, &e) };
	s.object[BALLS].passport.flags |= OB_OBJECT_KINEMATIC;
	s.object[BALLS].passport.mass = 0;
	c.control = r.control;
	c.spare = 100;
	r.host = ob_host_start(&s, &c, &e);
	CHECK(r.host && pthread_create(&r.thread, NULL, lead, &r) == 0);
	const ob_universe *u = ob_host_universe(r.host);
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	ob_controller *controller = ob_controller_open(u, &e);
	const int fd = ob_controller_fd(controller);
	for (long i = 0; i < packets; i += 2) {
		send_request(info.name);
		const bool answered = send_command(fd);
		if (!answered || (i % EACH_STEPS == 0 && !step(fd))) {
			fprintf(stderr, "after %ld packets: %s\n", i, r.failed ? r.e.text : "no answer");
			CHECK(!"the run goes on");
			break;
		}
	}
	check_states(u);
	ob_controller_close(controller);
	pthread_join(r.thread, NULL);
	ob_host_stop(r.host);
	ob_control_destroy(r.control);
	free(s.object);
}

int main(int argc, char **argv)
{
	const long packets = argc > 1 ? atol(argv[1]) : PACKETS;
	state = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
	attack(OB_ISOLATION_THREAD, packets / 2);
	attack(OB_ISOLATION_PROCESS, packets / 2);
	return check_end();
}
