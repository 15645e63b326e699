// Control by a program: the same changes at the same steps end in the same bits, however often the run was put back to
// snapshots in between, with any isolation and workers, and with simulators that are killed. What makes no sense is
// refused, and harms nothing.
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "check.h"
#include "control/call.h"
#include "control/packet.h"
#include "host/control.h"
#include "little_scene.h"
#include "measure/measure.h"
#include "workers.h"

enum { BALLS = 20, STEPS = 160, LAST = 1 << 22, NEVER = 1 << 30 };

// ---- a run that is led by a program in another thread

typedef struct led_run {
	ob_host *host;
	ob_control *control;
	pthread_t thread;
	uint64_t last; // 0: LAST
	bool failed;
} led_run;

static void *lead(void *argument)
{
	led_run *r = argument;
	ob_error e;
	uint64_t step = 0;
	do {
		ob_host_go(r->host, step);
		r->failed = !ob_host_wait(r->host, &e);
	} while (!r->failed &&
		 ob_control_next(r->control, r->host, r->last ? r->last : LAST, &step) == OB_CONTROL_GOES_ON);
	if (r->failed)
		ob_control_end(r->control, e.text);
	return NULL;
}

static bool begin(led_run *r, const ob_scene *s, ob_isolation isolation, uint32_t workers)
{
	ob_error e;
	ob_host_config c = little_config(s, isolation, workers);
	r->control = ob_control_create(false, &e);
	c.control = r->control;
	c.spare = 100;
	r->host = ob_host_start(s, &c, &e);
	CHECK(r->host);
	return r->host && pthread_create(&r->thread, NULL, lead, r) == 0;
}

static void end(led_run *r)
{
	pthread_join(r->thread, NULL);
	CHECK(!r->failed);
	ob_host_stop(r->host);
	ob_control_destroy(r->control);
}

static uint64_t hash_of(const ob_universe *u)
{
	ob_snapshot s = { 0 };
	CHECK(ob_snapshot_take(&s, u, 0, NULL));
	const uint64_t hash = ob_measure_hash(&s);
	ob_snapshot_finish(&s);
	return hash;
}

// A command is answered soon while the run goes on as fast as it can, also after it went on slowly for a while.
static void hurry(void)
{
	enum { SLOWLY = 25, SOON = 1 << 19 }; // SOON: seconds of steps on any machine
	ob_error e = { "" };
	ob_scene s = little_scene(1);
	led_run r = { 0 };
	CHECK(begin(&r, &s, OB_ISOLATION_THREAD, 1));
	ob_controller *c = ob_controller_open(ob_host_universe(r.host), &e);
	CHECK(c && ob_controller_run(c, 1, &e));
	while (steps_of(r.host) < SLOWLY)
		pause_ms(1);
	CHECK(ob_controller_run(c, INFINITY, &e) && ob_controller_pause(c, &e));
	CHECK(ob_controller_steps(c) < SOON);
	ob_controller_close(c);
	end(&r);
	free(s.object);
}

// Likewise where nothing happens: no simulator has work, and millions of steps pass in a second.
static void hurry_idly(ob_isolation isolation)
{
	ob_error e = { "" };
	ob_scene s = little_scene(0);
	led_run r = { .last = NEVER };
	CHECK(begin(&r, &s, isolation, 1));
	ob_controller *c = ob_controller_open(ob_host_universe(r.host), &e);
	CHECK(c && ob_controller_step(c, 10, &e) && ob_controller_run(c, INFINITY, &e) && ob_controller_pause(c, &e));
	CHECK(ob_controller_steps(c) < NEVER && ob_controller_step(c, 1, &e));
	ob_controller_close(c);
	end(&r);
	free(s.object);
}

// ---- the same life, with and without detours

static uint64_t draw(uint64_t *seed)
{
	*seed = *seed * 6364136223846793005u + 1442695040888963407u;
	return *seed >> 33;
}

// Changes of the step that is complete.
static void change(ob_controller *c, uint64_t step, uint32_t *created)
{
	ob_error e = { "" };
	size_t n = 0;
	const ob_change force = { 3, 0, { 5, 0, 30 } }, kick = { 4, 0, { 0, 2, 3, .01, 0, .02 } },
			state = { 5, 0, { .3, .2, 2, 1, 0, 0, 0, 1, 0, 0, 0, 0, 3 } }, gone = { 6, 0, { 0 } },
			torque = { 7, 0, { 0, .02, .01 } }, push = { 8, 0, { 3, 0, 9, 0, .05, 0 } },
			drag = { 9, 0, { .1, .2, .8, 0, 0, .1 } }, ice = { 0, 0, { .01 } },
			faster = { 10, 0, { NAN, 0, 0, NAN, 0, 0, 0, 0, 1, 2, NAN } };
	bool fine = true;
	if (step == 20)
		fine = ob_controller_set_torques(c, &torque, 1, &e) && ob_controller_push(c, &push, 1, &e);
	else if (step == 30)
		fine = ob_controller_drag(c, &drag, 1, &e);
	else if (step == 50)
		fine = ob_controller_release(c, &push, 1, &e);
	else if (step == 70)
		fine = ob_controller_set_frictions(c, &ice, 1, &e);
	else if (step == 100)
		fine = ob_controller_set_states(c, &faster, 1, &e) && ob_controller_release(c, &drag, 1, &e);
	else if (step == 40)
		fine = ob_controller_set_forces(c, &force, 1, &e);
	else if (step == 60)
		fine = ob_controller_kick(c, &kick, 1, &e);
	else if (step == 80)
		fine = ob_controller_set_states(c, &state, 1, &e);
	else if (step == 90)
		fine = ob_controller_create(c,
					    "box { size = { .2, .2, .2 }, at = { .1, .1, 3 } } sphere { radius = .1 }",
					    created, 2, &n, &e) &&
		       n == 2;
	else if (step == 110)
		fine = ob_controller_remove(c, &gone, 1, &e);
	if (!fine)
		fprintf(stderr, "step %llu: %s\n", (unsigned long long)step, e.text);
	CHECK(fine);
}

// Goes somewhere else, and comes back.
static void make_detour(ob_controller *c, const ob_universe *u, uint64_t *seed)
{
	ob_error e = { "" };
	uint64_t snapshot, before = hash_of(u);
	uint32_t id[2];
	size_t n;
	const ob_change kick = { 1 + (uint32_t)(draw(seed) % 5), 0, { 1, 1, 4, 0, .1, 0 } };
	CHECK(ob_controller_snapshot(c, &snapshot, &e));
	CHECK(ob_controller_create(c, "sphere { radius = .15, at = { 0, 0, 4 } }", id, 2, &n, &e));
	CHECK(ob_controller_kick(c, &kick, 1, &e));
	CHECK(ob_controller_step(c, draw(seed) % 40, &e));
	CHECK(ob_controller_restore(c, snapshot, &e));
	CHECK(hash_of(u) == before);
	if (draw(seed) % 2)
		CHECK(ob_controller_forget(c, snapshot, &e));
}

// Kills the worker of the first object that has one.
static void kill_a_worker(const ob_universe *u, ob_controller *c)
{
	ob_error e = { "" };
	uint32_t worker;
	ob_change of = { .id = 1 };
	while (of.id < BALLS && !ob_universe_get_home(u, of.id, &worker))
		of.id++;
	ob_universe_info before, now;
	ob_universe_get_info(u, &before);
	CHECK(of.id == BALLS || ob_controller_kill(c, &of, 1, &e));
	for (int i = 0; i < 100 * WAIT_S && of.id < BALLS; i++) {
		ob_universe_get_info(u, &now);
		if (now.deaths > before.deaths)
			return;
		pause_ms(10);
	}
}

// A command that comes while a run makes up for a death waits until it is where it was: no clock goes back.
static void pause_after_kill(void)
{
	enum { ROUNDS = 8 };
	ob_error e = { "" };
	ob_scene s = busy_heap(BALLS);
	led_run r = { 0 };
	CHECK(begin(&r, &s, OB_ISOLATION_PROCESS, 2));
	const ob_universe *u = ob_host_universe(r.host);
	ob_controller *c = ob_controller_open(u, &e);
	CHECK(c);
	for (int i = 0; c && i < ROUNDS; i++) {
		CHECK(ob_controller_step(c, 10, &e));
		const uint64_t before = ob_controller_steps(c);
		kill_a_worker(u, c);
		CHECK(ob_controller_run(c, INFINITY, &e) && ob_controller_pause(c, &e));
		CHECK(ob_controller_steps(c) >= before);
	}
	ob_controller_close(c);
	end(&r);
	free(s.object);
}

// seed: of the detours; 0: none
static uint64_t live(ob_isolation isolation, uint32_t workers, uint64_t seed, bool kills)
{
	ob_error e = { "" };
	ob_scene s = busy_heap(BALLS);
	led_run r = { 0 };
	uint64_t hash = 0;
	uint32_t created[2] = { 0 };
	if (!begin(&r, &s, isolation, workers))
		return 0;
	const ob_universe *u = ob_host_universe(r.host);
	ob_controller *c = ob_controller_open(u, &e);
	CHECK(c);
	for (uint64_t step = 0; c && step < STEPS; step += 10) {
		CHECK(ob_controller_steps(c) == step);
		if (seed && draw(&seed) % 4 == 0)
			make_detour(c, u, &seed);
		change(c, step, created);
		if (kills && step % 50 == 0)
			kill_a_worker(u, c);
		CHECK(ob_controller_step(c, 10, &e));
	}
	hash = hash_of(u);
	ob_controller_close(c);
	end(&r);
	free(s.object);
	return hash;
}

static void test_lives(void)
{
	const uint64_t straight = live(OB_ISOLATION_THREAD, 2, 0, false);
	CHECK(straight != 0);
	for (uint64_t seed = 1; seed <= 4; seed++) {
		CHECK(live(OB_ISOLATION_THREAD, 1 + (uint32_t)seed % 3, seed, false) == straight);
		CHECK(live(OB_ISOLATION_PROCESS, 1 + (uint32_t)seed % 3, seed, seed % 2) == straight);
	}
	CHECK(live(OB_ISOLATION_PROCESS, 0, 5, false) == straight); // one for each object
}

// ---- arrays, clock and errors

static void test_states(const ob_universe *u, ob_controller *c)
{
	double p[3 * (BALLS + 1)], q[4 * (BALLS + 1)], v[3 * (BALLS + 1)];
	uint32_t id[BALLS + 1];
	ob_motion m;
	CHECK(ob_universe_get_states(u, &(ob_state_arrays){ id, NULL, p, q, v, NULL }, BALLS + 1) == BALLS + 1);
	CHECK(ob_universe_get_states(u, &(ob_state_arrays){ 0 }, 0) == BALLS + 1);
	for (uint32_t i = 0; i <= BALLS; i++) {
		CHECK(id[i] == i && ob_universe_get_motion(u, i, &m));
		const ob_state s = ob_motion_at(&m, ob_v3(0, 0, 0), ob_controller_time(c));
		CHECK(p[3 * i + 2] == s.pose.p.z && v[3 * i + 2] == s.v.z && q[4 * i] <= 1);
	}
}

typedef struct waiter {
	const ob_universe *u;
	uint64_t step;
	bool came;
} waiter;

static void *wait_for_step(void *argument)
{
	waiter *w = argument;
	w->came = ob_universe_wait(w->u, w->step, WAIT_S);
	return NULL;
}

static void test_wait(const char *name, ob_controller *c)
{
	ob_error e;
	ob_universe *u = ob_universe_attach(name, &e); // a reader's handle sees whether the universe has a host
	CHECK(u);
	const uint64_t now = ob_controller_steps(c);
	waiter w = { u, now + 5, false };
	pthread_t thread;
	CHECK(ob_universe_wait(u, now, 0) && !ob_universe_wait(u, now + 1, .01));
	CHECK(pthread_create(&thread, NULL, wait_for_step, &w) == 0);
	for (int i = 0; i < 5; i++)
		CHECK(ob_controller_step(c, 1, &e));
	pthread_join(thread, NULL);
	CHECK(w.came);
	ob_universe_detach(u);
}

static void refuse(bool fine, const ob_error *e, const char *text)
{
	if (fine || !strstr(e->text, text))
		fprintf(stderr, "expected \"%s\", got \"%s\"\n", text, fine ? "success" : e->text);
	CHECK(!fine && strstr(e->text, text));
}

static void test_refused(const ob_universe *u, ob_controller *c)
{
	ob_error e = { "" };
	uint32_t id[2];
	size_t n;
	const ob_change none = { 77, 0, { 0 } }, old = { 1, 9, { 0 } }, ground = { 0, 0, { 1 } },
			huge = { 1, 0, { 1e30 } }, turned = { 1, 0, { 0, 0, 1 } };
	const uint64_t before = hash_of(u);
	CHECK(!ob_controller_open(u, &e) && strstr(e.text, "another program controls this run"));
	refuse(ob_controller_restore(c, 3, &e), &e, "there is no snapshot 3");
	refuse(ob_controller_run(c, 0, &e), &e, "expected a positive number");
	refuse(ob_controller_step(c, 1u << 30, &e), &e, "expected at most");
	refuse(ob_controller_kick(c, &none, 1, &e), &e, "there is no object 77");
	refuse(ob_controller_kick(c, &old, 1, &e), &e, "object 1 has gone");
	refuse(ob_controller_kick(c, &ground, 1, &e), &e, "does not move by forces");
	refuse(ob_controller_set_forces(c, &huge, 1, &e), &e, "force: expected");
	refuse(ob_controller_set_states(c, &turned, 1, &e), &e, "unit quaternion");
	refuse(ob_controller_create(c, "boks {}", id, 2, &n, &e), &e, "unknown name");
	const ob_change away = { 1, 0, { 0, 0, 1, 9, 0, 0 } }, nowhere = { 1, 0, { NAN } },
			wild = { 1, 0, { 0, 0, 1, 0, 0, 0, 1e9 } }, rough = { 1, 0, { -1 } };
	refuse(ob_controller_push(c, &away, 1, &e), &e, "point: expected one of the object");
	refuse(ob_controller_drag(c, &nowhere, 1, &e), &e, "target: expected");
	refuse(ob_controller_drag(c, &wild, 1, &e), &e, "frequency: expected");
	refuse(ob_controller_drag(c, &ground, 1, &e), &e, "does not move by forces");
	refuse(ob_controller_set_torques(c, &huge, 1, &e), &e, "twist: expected");
	refuse(ob_controller_set_frictions(c, &rough, 1, &e), &e, "friction: expected");
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	if (strcmp(info.isolation, "thread") == 0)
		refuse(ob_controller_kill(c, &wild, 1, &e), &e, "simulators are threads");
	else
		refuse(ob_controller_kill(c, &ground, 1, &e), &e, "has no simulator");
	refuse(ob_controller_message(c, 1, (const char *const[]){ "hop" }, 1, &e), &e, "no script");
	const ob_change mixed[] = { { 1, 0, { 0, 0, 5 } }, none };
	refuse(ob_controller_kick(c, mixed, 2, &e), &e, "there is no object 77"); // and neither is kicked
	CHECK(hash_of(u) == before && ob_controller_step(c, 0, &e) && hash_of(u) == before);
}

static ob_state state_of(const ob_universe *u, uint32_t id, const ob_controller *c)
{
	ob_motion m;
	CHECK(ob_universe_get_motion(u, id, &m));
	return ob_motion_at(&m, ob_v3(0, 0, 0), ob_controller_time(c));
}

// Closed forms: a torque on a ball in free flight, a push that holds it against gravity, and the sag of a drag, g / w^2.
static void test_pulls(const ob_universe *u, ob_controller *c)
{
	ob_error e = { "" };
	ob_passport p;
	CHECK(ob_universe_get_passport(u, 12, &p));
	const double w = 2 * M_PI * 2, inertia = p.inertia.x;
	const ob_change free = { 12, 0, { 30, 30, 20, 1 } }, torque = { 12, 0, { 0, inertia, 0 } },
			hold = { 12, 0, { 0, 0, 9.81 * p.mass } }, drag = { 12, 0, { 31, 30, 20, 0, 0, 0, 2 } };
	CHECK(ob_controller_set_states(c, &free, 1, &e) && ob_controller_set_torques(c, &torque, 1, &e) &&
	      ob_controller_push(c, &hold, 1, &e) && ob_controller_step(c, 50, &e));
	ob_state s = state_of(u, 12, c);
	CHECK_NEAR(s.w.y, .5, 1e-12);
	CHECK_NEAR(s.v.z, 0, 1e-12);
	CHECK_NEAR(s.pose.p.z, 20, 1e-9);
	CHECK(ob_controller_release(c, &free, 1, &e) && ob_controller_step(c, 10, &e));
	CHECK_NEAR(state_of(u, 12, c).v.z, -.981, 1e-9);
	CHECK(ob_controller_drag(c, &drag, 1, &e) && ob_controller_step(c, 400, &e));
	s = state_of(u, 12, c);
	CHECK_NEAR(s.pose.p.x, 31, 1e-6);
	CHECK_NEAR(s.pose.p.z, 20 - 9.81 / (w * w), .1 * 9.81 / (w * w));
	CHECK(ob_controller_release(c, &drag, 1, &e));
}

// Packets of random bytes, many of them valid at the beginning.
static void test_nonsense(const ob_universe *u)
{
	static ob_control_packet p;
	static ob_control_answer a;
	ob_error e;
	uint64_t seed = 7;
	const int fd = ob_call_host(u, &e);
	CHECK(fd >= 0);
	memcpy(p.magic, OB_CONTROL_MAGIC, sizeof p.magic);
	p.command = OB_CONTROL_HELLO;
	CHECK(send(fd, &p, offsetof(ob_control_packet, payload), 0) > 0 && recv(fd, &a, sizeof a, 0) == sizeof a);
	for (int i = 0; i < 2000; i++) {
		const size_t head = offsetof(ob_control_packet, payload);
		const size_t bytes = draw(&seed) % 3 ? draw(&seed) % 400 : draw(&seed) % OB_CONTROL_PAYLOAD;
		for (size_t k = 0; k < bytes; k++)
			p.payload[k] = (unsigned char)draw(&seed);
		memcpy(p.magic, OB_CONTROL_MAGIC, sizeof p.magic);
		p.command = draw(&seed) % 5
				    ? OB_CONTROL_FORCE + (uint32_t)draw(&seed) % (OB_CONTROL_KILL - OB_CONTROL_FORCE)
				    : (uint32_t)draw(&seed);
		p.command = p.command == OB_CONTROL_STEP || p.command == OB_CONTROL_RUN ? OB_CONTROL_PAUSE : p.command;
		p.count = draw(&seed) % 2 ? (uint32_t)(bytes / sizeof(ob_change)) : (uint32_t)draw(&seed);
		p.bytes = draw(&seed) % 4 ? (uint32_t)bytes : (uint32_t)draw(&seed);
		p.number = draw(&seed);
		const size_t sent = draw(&seed) % 8 ? head + bytes : draw(&seed) % (head + bytes) + 1;
		if (send(fd, &p, sent, MSG_NOSIGNAL) != (ssize_t)sent || recv(fd, &a, sizeof a, 0) != sizeof a) {
			CHECK(!"the host has left");
			break;
		}
	}
	close(fd);
}

static void test_session(ob_isolation isolation)
{
	ob_error e = { "" };
	ob_scene s = busy_heap(BALLS);
	led_run r = { 0 };
	if (!begin(&r, &s, isolation, 2))
		return;
	const ob_universe *u = ob_host_universe(r.host);
	ob_controller *c = ob_controller_open(u, &e);
	CHECK(c && ob_controller_step(c, 30, &e));
	if (c) {
		test_states(u, c);
		test_wait(ob_universe_name(u), c);
		test_refused(u, c);
		test_pulls(u, c);
		CHECK(ob_controller_run(c, INFINITY, &e));
		for (int i = 0; i < 10 * WAIT_S && ob_controller_pause(c, &e) && ob_controller_steps(c) < 600; i++) {
			CHECK(ob_controller_run(c, INFINITY, &e));
			pause_ms(100);
		}
		CHECK(ob_controller_steps(c) >= 600);
	}
	ob_controller_close(c);
	end(&r);
	if (begin(&r, &s, isolation, 2)) {
		test_nonsense(ob_host_universe(r.host));
		end(&r);
	}
	free(s.object);
}

int main(void)
{
	test_session(OB_ISOLATION_THREAD);
	test_session(OB_ISOLATION_PROCESS);
	hurry();
	hurry_idly(OB_ISOLATION_THREAD);
	hurry_idly(OB_ISOLATION_PROCESS);
	pause_after_kill();
	test_lives();
	return check_end();
}
