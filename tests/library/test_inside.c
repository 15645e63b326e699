// Four universes within a program, as its callers have them: led in threads of their own, then as a batch that threads share. All end
// in the bits of one that is led alone. Under the thread sanitizer and valgrind this also says that they share nothing.
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <ob/control.h>
#include <ob/joint.h>
#include <ob/sensor.h>

#include "check.h"

enum { RUNS = 4, STEPS = 30, OBJECTS = 9 };

typedef struct run {
	ob_controller *controller;
	ob_universe *universe;
	double position[OBJECTS][3], velocity[OBJECTS][3];
	double sample[6];
	bool fine;
} run;

static const char *scene;

static bool begin(run *r)
{
	char name[OB_NAME_MAX];
	ob_error e;
	r->controller = ob_controller_open_inside(&scene, 1, name, &e);
	r->universe = r->controller ? ob_universe_attach(name, &e) : NULL;
	if (!r->universe)
		fprintf(stderr, "%s\n", e.text);
	return r->universe;
}

static void end(run *r)
{
	if (r->universe)
		ob_universe_detach(r->universe);
	ob_controller_close(r->controller);
}

static void check_same(const run *r, const run *alone)
{
	CHECK(memcmp(r->position, alone->position, sizeof r->position) == 0);
	CHECK(memcmp(r->velocity, alone->velocity, sizeof r->velocity) == 0);
	CHECK(memcmp(r->sample, alone->sample, sizeof r->sample) == 0);
}

static ob_change target_of(int step)
{
	return (ob_change){ .id = 2, .value = { 0, step % 20 < 10 ? 2 : -2 } };
}

static bool read_run(run *r)
{
	uint64_t number;
	double time;
	const ob_state_arrays to = { .position = *r->position, .velocity = *r->velocity };
	return ob_universe_get_states(r->universe, &to, OBJECTS) == OBJECTS &&
	       ob_universe_get_samples(r->universe, 0, 0, &number, &time, r->sample, 1) == 1;
}

// Steps with new targets, is kicked, goes back, and does it again.
static void *lead(void *argument)
{
	run *r = argument;
	ob_controller *c;
	ob_error e;
	uint64_t start;
	r->fine = begin(r);
	if (!r->fine)
		return NULL;
	c = r->controller;
	const ob_change kick = { .id = 3, .value = { 1, 0, 2 } };
	r->fine = ob_controller_snapshot(c, &start, &e);
	for (int round = 0; r->fine && round < 2; round++) {
		for (int i = 0; r->fine && i < STEPS; i++) {
			const ob_change target = target_of(i);
			r->fine = ob_controller_step_with(c, 1, &target, 1, NULL, 0, &e);
		}
		if (round == 0)
			r->fine = r->fine && ob_controller_kick(c, &kick, 1, &e) && ob_controller_step(c, 5, &e) &&
				  ob_controller_restore(c, start, &e);
	}
	r->fine = r->fine && read_run(r);
	if (!r->fine)
		fprintf(stderr, "%s\n", e.text);
	return NULL;
}

static void test_threads(run *alone)
{
	static run r[RUNS];
	pthread_t thread[RUNS];
	lead(alone);
	CHECK(alone->fine);
	for (int i = 0; i < RUNS; i++)
		CHECK(pthread_create(&thread[i], NULL, lead, &r[i]) == 0);
	for (int i = 0; i < RUNS; i++)
		pthread_join(thread[i], NULL);
	for (int i = 0; i < RUNS; i++) {
		CHECK(r[i].fine);
		check_same(&r[i], alone);
		end(&r[i]);
	}
}

static void test_batch(const run *alone)
{
	static run r[RUNS];
	ob_run_step step[RUNS];
	ob_change target;
	static const uint32_t joint = 0;
	double value[RUNS][2];
	ob_error e;
	memset(step, 0, sizeof step);
	for (int i = 0; i < RUNS; i++) {
		CHECK(begin(&r[i]));
		step[i] = (ob_run_step){ .controller = r[i].controller,
					 .universe = r[i].universe,
					 .motor = &target,
					 .motors = 1,
					 .joint = &joint,
					 .joints = 1,
					 .values = value[i] };
	}
	for (int i = 0; i < STEPS; i++) {
		target = target_of(i);
		if (!ob_controller_step_all(step, RUNS, 1, 3, &e))
			fprintf(stderr, "%s\n", e.text);
	}
	for (int i = 0; i < RUNS; i++) {
		CHECK(!step[i].failed && value[i][0] == value[0][0] && value[i][1] == value[0][1]);
		CHECK(read_run(&r[i]));
		check_same(&r[i], alone);
		end(&r[i]);
	}
}

int main(int count, char **word)
{
	static run alone;
	if (count != 2)
		return 2;
	scene = word[1];
	test_threads(&alone);
	test_batch(&alone);
	end(&alone);
	return check_end();
}
