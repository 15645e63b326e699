// Runs, start to end, in both isolations: the requested steps are completed, births, deaths and requests take effect at
// their step, times are plausible, and nothing is left.
#include <pthread.h>
#include <string.h>

#include "check.h"
#include "little_scene.h"
#include "workers.h"

static ob_host *start(const ob_scene *s, const ob_host_config *c)
{
	ob_error e = { "" };
	ob_host *h = ob_host_start(s, c, &e);
	if (!h)
		fprintf(stderr, "start: %s\n", e.text);
	return h;
}

static bool reach(ob_host *h, uint64_t step)
{
	ob_error e = { "" };
	ob_host_go(h, step);
	if (ob_host_wait(h, &e) && steps_of(h) == step)
		return true;
	fprintf(stderr, "step %llu instead of %llu: %s\n", (unsigned long long)steps_of(h), (unsigned long long)step,
		e.text);
	return false;
}

static void test_plain(ob_isolation isolation, uint32_t workers)
{
	ob_scene s = little_scene(5);
	ob_host_config c = little_config(&s, isolation, workers);
	ob_motion m;
	ob_universe_info info;
	char name[OB_NAME_MAX];
	double began = ob_clock_wall();
	ob_host *h = start(&s, &c);
	CHECK(h != NULL);
	if (!h)
		return;
	const ob_universe *u = ob_host_universe(h);
	CHECK(reach(h, 0));
	CHECK(ob_universe_get_motion(u, 1, &m) && m.p.z == 1 && m.v.z == 0);
	CHECK(reach(h, 1) && reach(h, 2) && reach(h, 30));
	CHECK(reach(h, 30)); // it is there already
	ob_host_go(h, 12); // an earlier step
	CHECK(ob_host_wait(h, NULL) && steps_of(h) == 30);
	CHECK(ob_universe_get_motion(u, 5, &m));
	CHECK_NEAR(ob_motion_at(&m, ob_v3(1, 1, 1), .3).pose.p.z, 1 - .5 * 9.81 * .09, 1e-9);
	ob_universe_get_info(u, &info);
	CHECK(info.objects == 6 && info.state == OB_UNIVERSE_RUNNING);
	CHECK(!strcmp(info.isolation, isolation == OB_ISOLATION_THREAD ? "thread" : "process"));
	CHECK(info.workers == (workers ? workers : 6) && !ob_host_interrupted(h));
	ob_host_times t;
	CHECK(reach(h, 3000));
	do // the clock of a process that runs on another core moves by ticks
		ob_host_get_times(h, &t);
	while (t.cpu_s == 0 && ob_clock_wall() - began < 60);
	double elapsed = ob_clock_wall() - began;
	CHECK(t.startup_s > 0 && t.startup_s < elapsed);
	CHECK(t.wall_s > 0 && t.wall_s < elapsed);
	CHECK(t.cpu_s > 0 && t.cpu_s < elapsed * info.workers);
	CHECK(t.step_p50_s > 0 && t.step_p50_s <= t.step_p99_s && t.step_p99_s < t.wall_s * 1.02);
	CHECK(t.memory_bytes > 100 << 10 && t.memory_bytes < (size_t)1 << 30);
	strcpy(name, info.name);
	ob_host_stop(h);
	CHECK(!segment_exists(name));
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

static bool is_there(const ob_host *h, uint32_t id)
{
	ob_passport p;
	ob_roster_entry entry;
	bool passport = ob_universe_get_passport(ob_host_universe(h), id, &p);
	CHECK(ob_roster_find(ob_host_roster(h), id, &entry) == passport);
	return passport;
}

// ball 2 lives from .05 to .1 s, ball 3 from .07 on, ball 4 never
static void test_timetable(ob_isolation isolation, uint32_t workers)
{
	ob_scene s = little_scene(4);
	ob_host_config c = little_config(&s, isolation, workers);
	ob_motion m;
	s.object[2].born = .05;
	s.object[2].dies = .1;
	s.object[3].born = .07;
	s.object[3].state.pose.p.z = 2;
	s.object[4].born = s.object[4].dies = .03;
	ob_host *h = start(&s, &c);
	CHECK(reach(h, 4) && !is_there(h, 2));
	CHECK(reach(h, 5) && is_there(h, 2) && !is_there(h, 3));
	CHECK(reach(h, 9) && is_there(h, 2) && is_there(h, 3));
	CHECK(reach(h, 20) && !is_there(h, 2) && is_there(h, 3) && !is_there(h, 4) && is_there(h, 1));
	CHECK(ob_universe_get_motion(ob_host_universe(h), 3, &m)); // it began to fall at .07 s
	CHECK_NEAR(ob_motion_at(&m, ob_v3(1, 1, 1), .2).pose.p.z, 2 - .5 * 9.81 * .13 * .13, 1e-9);
	ob_host_stop(h);
	free(s.object);
}

typedef struct asker {
	ob_host *h;
	ob_object_def def;
} asker;

static void *ask(void *argument)
{
	asker *a = argument;
	pause_ms(30);
	bool ok = ob_host_request(a->h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = a->def }, NULL) &&
		  ob_host_request_remove(a->h, 1, 1);
	for (int i = 0; i < 500; i++) { // removes no object, but makes the run pause at its next step
		ok = ok && ob_host_request_remove(a->h, 12345, 1);
		pause_us(i);
	}
	return ok ? a : NULL;
}

// Requests from another thread, in the middle of a long run
static void test_requests(ob_isolation isolation, uint32_t workers)
{
	ob_scene s = little_scene(2);
	ob_host_config c = little_config(&s, isolation, workers);
	ob_roster_entry entry;
	pthread_t thread;
	void *ok;
	c.spare = 1;
	ob_host *h = start(&s, &c);
	asker a = { h, ball("newcomer", 20, 20, 3) };
	ob_object_def nonsense = ball("nonsense", NAN, 0, 0);
	CHECK(!ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = nonsense }, NULL));
	CHECK(reach(h, 0));
	pthread_create(&thread, NULL, ask, &a);
	CHECK(reach(h, workers ? 40000 : 4000));
	pthread_join(thread, &ok);
	CHECK(ok != NULL);
	CHECK(reach(h, steps_of(h) + 1)); // if they came too late for the long run
	CHECK(ob_roster_find(ob_host_roster(h), 3, &entry) && !strcmp(entry.name, "newcomer") && entry.generation == 1);
	CHECK(entry.own_worker == !workers);
	CHECK(!is_there(h, 1) && is_there(h, 2));
	a.def = ball("second", 30, 0, 3); // gets the slot of ball 1
	CHECK(ob_host_request(h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = a.def }, NULL) &&
	      reach(h, steps_of(h) + 1));
	CHECK(ob_roster_find(ob_host_roster(h), 1, &entry) && !strcmp(entry.name, "second") && entry.generation == 2);
	CHECK(ob_roster_copy(ob_host_roster(h), &entry, 1) == 4 && !strcmp(entry.name, "ground"));
	ob_host_stop(h);
	free(s.object);
}

static void test_refusals(void)
{
	ob_scene s = little_scene(1);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, 1);
	ob_error e = { "" };
	c.run.step_length = 0;
	CHECK(!ob_host_start(&s, &c, &e) && strstr(e.text, "step"));
	c = little_config(&s, OB_ISOLATION_PROCESS, 2000000);
	CHECK(!ob_host_start(&s, &c, &e) && strstr(e.text, "workers"));
	c = little_config(&s, OB_ISOLATION_THREAD, 1);
	s.object[1].passport.mass = -1;
	CHECK(!ob_host_start(&s, &c, &e) && strstr(e.text, "\"ball 1\": mass"));
	s.object[1].passport.mass = 1;
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "taken-%d", (int)getpid());
	c.name = name;
	ob_host *h = ob_host_start(&s, &c, &e), *other = ob_host_start(&s, &c, &e);
	CHECK(h && !other && strstr(e.text, name));
	ob_host_stop(h);
	ob_host_stop(NULL);
	free(s.object);
}

int main(void)
{
	for (int i = 0; i < 2; i++) {
		ob_isolation isolation = i ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
		for (uint32_t workers = 0; workers < 4; workers++)
			test_plain(isolation, workers);
		test_timetable(isolation, 2);
		test_timetable(isolation, 0);
		test_requests(isolation, 2);
		test_requests(isolation, 0);
	}
	test_refusals();
	return check_end();
}
