// Freezes all that a step cannot take at once, wherever it is: the step is tried again once. Objects that are asked for meanwhile
// come when that step is complete, or each attempt would find more of them.
#include <pthread.h>

#include "check.h"
#include "little_scene.h"

enum { HEAPS = 4, BALLS = 12 };

// Heaps of balls, far apart.
static ob_scene heaps(void)
{
	ob_scene s = little_scene(HEAPS * BALLS);
	for (uint32_t i = 0; i < HEAPS * BALLS; i++) {
		const uint32_t k = i % BALLS;
		s.object[i + 1].state.pose.p =
			ob_v3(50. * (i / BALLS) + .11 * (k % 2), .12 * (k / 2 % 2), .1 + .18 * (k / 4));
	}
	return s;
}

// substeps: 1000: each heap is more than a step may take; 200: all together are.
static void test_all_at_once(ob_isolation isolation, unsigned harden, uint32_t substeps)
{
	ob_scene s = heaps();
	ob_host_config c = little_config(&s, isolation, 2);
	ob_error e = { "" };
	ob_host_times times;
	c.on_death = OB_ON_DEATH_KEEP;
	c.harden = harden;
	c.budget = 1;
	c.run.substeps = substeps;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h);
	ob_host_go(h, 3);
	CHECK(ob_host_wait(h, &e) && steps_of(h) == 3);
	ob_host_get_times(h, &times);
	CHECK(times.deaths == 1 && times.frozen == HEAPS * BALLS);
	ob_host_stop(h);
	free(s.object);
}

typedef struct newcomer {
	ob_host *h;
	ob_object_def def;
} newcomer;

// Asks for an object as soon as the first step has failed.
static void *come(void *argument)
{
	newcomer *n = argument;
	ob_death deaths[OB_DEATHS_KEPT];
	ob_error e;
	while (ob_host_get_deaths(n->h, deaths) == 0)
		;
	CHECK(ob_host_request(n->h, &(ob_request){ .kind = OB_REQUEST_ADD, .def = n->def }, &e));
	return NULL;
}

static void test_newcomers_wait(ob_isolation isolation)
{
	ob_scene s = little_scene(1);
	ob_host_config c = little_config(&s, isolation, 2);
	ob_error e = { "" };
	ob_motion m = { 0 };
	pthread_t thread;
	c.run.gravity = ob_v3(0, 0, 1e20); // m/s^2: whatever moves diverges
	c.on_death = OB_ON_DEATH_KEEP;
	c.spare = 1;
	newcomer n = { ob_host_start(&s, &c, &e), ball("late", 9, 9, 9) };
	CHECK(n.h);
	ob_host_go(n.h, 0);
	CHECK(ob_host_wait(n.h, &e));
	pthread_create(&thread, NULL, come, &n);
	ob_host_go(n.h, 1);
	CHECK(ob_host_wait(n.h, &e));
	pthread_join(thread, NULL);
	ob_host_go(n.h, 1); // a pause in which it comes, unless it has come
	CHECK(ob_host_wait(n.h, &e) && steps_of(n.h) == 1);
	CHECK(ob_universe_get_motion(ob_host_universe(n.h), s.objects, &m) && m.t0 == c.run.step_length && m.p.z == 9);
	ob_host_stop(n.h);
	free(s.object);
}

int main(void)
{
	for (uint32_t substeps = 200; substeps <= 1000; substeps += 800) {
		test_all_at_once(OB_ISOLATION_THREAD, 0, substeps);
		test_all_at_once(OB_ISOLATION_PROCESS, 0, substeps);
		test_all_at_once(OB_ISOLATION_PROCESS, OB_HARDEN_ALL, substeps);
	}
	test_newcomers_wait(OB_ISOLATION_THREAD);
	test_newcomers_wait(OB_ISOLATION_PROCESS);
	return check_end();
}
