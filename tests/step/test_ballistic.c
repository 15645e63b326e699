// Flights that no step solves until they end: as accurate as if every object were solved in every step, and for balls
// the same to the last bit.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"
#include "step/pairs.h"

enum { STEPS = 90 };

// A few bodies thrown over a floor and beside a wall, near each other or not.
static little_scene *thrown(uint64_t *seed, bool balls, double room)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_body wall = ob_world_ground(&s->world);
	wall.state->pose.p.x = -room - 1;
	wall.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, acos(0), 0));
	int bodies = 2 + (int)within(seed, 0, 4);
	double e = uniform(seed) < .3 ? 1 : within(seed, 0, 1);
	for (int i = 0; i < bodies; i++) {
		double a = within(seed, .1, .4), b = within(seed, .1, .4), c = within(seed, .1, .4);
		double x = within(seed, -room, room), y = within(seed, -room, room);
		ob_vec3 p = ob_v3(x, y, 1.5 + 1.2 * i);
		bool ball = balls || uniform(seed) < .3;
		ob_world_body o = ball ? ob_world_sphere(&s->world, 1 + a, a, p)
				       : ob_world_box(&s->world, 1 + a, ob_v3(a, b, c), p);
		o.passport->restitution = e;
		o.state->v = random_vector(seed, 4);
		o.state->w = random_vector(seed, 4);
		o.state->pose.q = random_attitude(seed);
	}
	return s;
}

// Makes all flying bodies due in the next step, from which they compute their impacts.
static void call_all(ob_universe *u)
{
	ob_step_data *ex = ob_universe_step_data(u);
	for (uint32_t id = 0; id < ob_universe_ids(u); id++) {
		if (ex->schedule[id].state != OB_SCHEDULE_AWAKE)
			continue;
		ob_motion m = *ob_newest_motion(u, id);
		m.valid_until = m.t0;
		ob_publish_motion(u, id, &m);
		ex->schedule[id].due = (uint32_t)ob_step_count(u);
	}
	ob_pairs_link(u); // calendars follow the schedule
}

typedef struct outcome {
	double deepest, growth; // m; relative
	uint64_t hash, advances, solved; // solved: bodies in steps of the contact solver
	double energy; // J, at the end
} outcome;

static outcome play(const little_scene *s, bool call)
{
	little_universe l;
	outcome out = { 0 };
	ob_counters c;
	little_open(&l, s);
	double start = little_energy(&l), lowest = start;
	for (int k = 0; k < STEPS; k++) {
		if (call)
			call_all(l.u);
		little_run(&l, 1);
		double energy = little_energy(&l);
		lowest = fmin(lowest, energy);
		out.growth = fmax(out.growth, (energy - lowest) / start);
		out.deepest = fmax(out.deepest, little_penetration(&l).max_m);
	}
	ob_universe_count(l.u, &c);
	out.advances = c.ballistic_advances;
	out.solved = c.body_steps;
	out.energy = little_energy(&l);
	out.hash = ob_measure_hash(&l.now);
	little_close(&l);
	return out;
}

// A ball's landing is closed form, from the start of its flight: the time of computation does not matter. After the
// contact solver it matters to rounding: the solver gets the pairs found by fat AABBs.
static void test_balls(void)
{
	uint64_t seed = 21, visits = 0, called = 0;
	for (int k = 0; k < 60; k++) {
		little_scene *s = thrown(&seed, true, 1);
		for (uint32_t i = 2; i < s->world.objects; i++) // far from each other
			s->world.state[i].pose.p.y = 30 * i;
		outcome by_itself = play(s, false), each_step = play(s, true);
		CHECK(by_itself.hash == each_step.hash || by_itself.solved > 0);
		CHECK_NEAR(by_itself.energy / each_step.energy, 1, 1e-12);
		visits += by_itself.advances;
		called += each_step.advances;
		free(s);
	}
	CHECK(visits * 8 < called);
}

// Nothing is missed: a missed event would leave a deep penetration.
static void test_nothing_missed(void)
{
	uint64_t seed = 22, visits = 0, called = 0;
	double by_itself = 0, each_step = 0;
	for (int k = 0; k < 400; k++) {
		little_scene *s = thrown(&seed, k % 4 == 0, within(&seed, .5, 3));
		s->run.tolerance = 1e-3;
		outcome a = play(s, false), b = play(s, true);
		CHECK(a.growth < 1e-5);
		CHECK(a.deepest < 5e-3);
		by_itself = fmax(by_itself, a.deepest), each_step = fmax(each_step, b.deepest);
		visits += a.advances;
		called += b.advances;
		free(s);
	}
	printf("deepest %.2f mm, visited in each step %.2f mm\n", 1e3 * by_itself, 1e3 * each_step);
	CHECK(visits * 2 < called);
	CHECK(by_itself < 2 * each_step + 1e-3);
}

// A new plane under a flying body is hit all the same.
static void test_new_plane(void)
{
	little_scene *s = little_scene_new();
	s->capacity = 2;
	ob_world_sphere(&s->world, 1, .5, ob_v3(0, 0, 10));
	little_universe l;
	little_open(&l, s);
	little_run(&l, 5);
	ob_world_ground(&s->world).state->pose.p.z = 8;
	little_put(&l, 1);
	little_run(&l, 120);
	CHECK_NEAR(little_state(&l, 0).pose.p.z, 8.5, 1e-3);
	little_close(&l);
	free(s);
}

// A body that hops too low to leave the contact solver flies on by itself, and comes to rest as usual.
static void test_low_hops(void)
{
	uint64_t seed = 23, taken_off = 0;
	for (int k = 0; k < 40; k++) {
		little_scene *s = little_scene_new();
		s->run.tolerance = 1e-3;
		s->run.sleeping = true;
		ob_world_ground(&s->world).passport->restitution = .8;
		ob_world_body o = ob_world_box(&s->world, 1, ob_v3(within(&seed, .1, .4), .2, .3), ob_v3(0, 0, .7));
		o.state->pose.q = random_attitude(&seed);
		o.state->v = random_vector(&seed, 1);
		little_universe l;
		little_open(&l, s);
		const ob_step_data *ex = ob_universe_step_data(l.u);
		double energy = little_energy(&l), growth = 0;
		for (int step = 0; step < 600 && ex->schedule[1].state == OB_SCHEDULE_AWAKE; step++) {
			bool held = ex->count->pairs && ex->pair[0].active;
			ob_counters before, after;
			ob_universe_count(l.u, &before);
			little_run(&l, 1);
			ob_universe_count(l.u, &after);
			taken_off += held && after.ballistic_advances > before.ballistic_advances;
			double now = little_energy(&l);
			growth = fmax(growth, now / energy - 1);
			energy = fmin(energy, now);
			CHECK(little_penetration(&l).max_m < 1.1e-3);
		}
		CHECK(growth < 1e-5);
		CHECK(ex->schedule[1].state == OB_SCHEDULE_ASLEEP);
		little_close(&l);
		free(s);
	}
	CHECK(taken_off > 5);
}

int main(void)
{
	test_balls();
	test_low_hops();
	test_nothing_missed();
	test_new_plane();
	return check_end();
}
