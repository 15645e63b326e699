// Engines that do what no engine should, each in its attempt; and the lab that goes on after them.
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "check.h"
#include "lab/attempt.h"
#include "world/world.h"
#include "lab/lab.h"

static void build(ob_world *w, uint32_t run)
{
	ob_world_sphere(w, 1, .5, ob_v3(0, 0, 1));
}

static void judge(ob_trial *t)
{
	t->figure[0] = .25;
	t->figure[1] = t->time;
}

static const ob_case plain = { .name = "plain",
			       .title = "Plain",
			       .duration = .5,
			       .step = 1. / 60,
			       .runs = 2,
			       .figures = 2,
			       .figure = { { "error", "mm", .5, "nothing" }, { "time", "s", NAN, "nothing" } },
			       .build = build,
			       .judge = judge };

static ob_engine *create(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	static int anything;
	return (ob_engine *)&anything;
}

static void get(const ob_engine *p, ob_state *state)
{
	state[0] = (ob_state){ .pose.q = { 1, 0, 0, 0 } };
}

static void destroy(ob_engine *p) {}

static bool step_well(ob_engine *p, ob_error *e)
{
	printf("this is not to be seen\n");
	return true;
}

static bool step_abort(ob_engine *p, ob_error *e)
{
	fprintf(stderr, "something else\nbody 3 is no body\n");
	abort();
}

static bool step_killed(ob_engine *p, ob_error *e)
{
	return kill(getpid(), SIGKILL) == 0;
}

static bool step_forever(ob_engine *p, ob_error *e)
{
	while (pause() < 0)
		;
	return true;
}

static bool step_busy(ob_engine *p, ob_error *e)
{
	volatile unsigned i = 0;
	while (i < 2)
		i ^= 1;
	return true;
}

static bool step_exit(ob_engine *p, ob_error *e)
{
	close(STDERR_FILENO);
	exit(7);
}

// More than a pipe holds
static bool step_talk(ob_engine *p, ob_error *e)
{
	for (int i = 0; i < 5000; i++)
		fprintf(stderr, "line %d of many, each as boring as the one before\n", i);
	exit(1);
}

static bool step_interrupt(ob_engine *p, ob_error *e)
{
	kill(getppid(), SIGINT);
	return step_forever(p, e);
}

static ob_engine *create_none(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	ob_fail(e, "no such tolerance");
	return NULL;
}

#define ENGINE(engine, create_function, step_function) \
	static const ob_engine_kind engine = { .name = #engine, \
					     .title = #engine, \
					     .version = "", \
					     .usual = { .substeps = 1 }, \
					     .create = create_function, \
					     .step = step_function, \
					     .get = get, \
					     .destroy = destroy }
ENGINE(well, create, step_well);
ENGINE(aborting, create, step_abort);
ENGINE(killed, create, step_killed);
ENGINE(hanging, create, step_forever);
ENGINE(busy, create, step_busy);
ENGINE(exiting, create, step_exit);
ENGINE(talking, create, step_talk);
ENGINE(interrupting, create, step_interrupt);
ENGINE(impossible, create_none, step_well);

static int ticks;

static void count_tick(void *with)
{
	ticks += *(int *)with;
}

static ob_outcome run(const ob_engine_kind *k, double limit)
{
	int one = 1;
	ob_attempt a = { &plain, k, { .step_length = 1. / 60, .substeps = 1 }, limit, count_tick, &one };
	ob_outcome out;
	ob_error e = { "" };
	ticks = 0;
	bool fine = ob_attempt_run(&a, &out, &e);
	if (!fine)
		fprintf(stderr, "%s: %s\n", k->name, e.text);
	CHECK(fine);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0); // nobody is left
	return out;
}

static void expect(const ob_engine_kind *k, double limit, const char *reason)
{
	ob_outcome out = run(k, limit);
	if (strcmp(out.failed, reason) != 0)
		fprintf(stderr, "%s: '%s' instead of '%s'\n", k->name, out.failed, reason);
	CHECK(strcmp(out.failed, reason) == 0);
	CHECK(isinf(out.figure[0]) && isinf(out.figure[1]) && isnan(out.body_seconds) && out.wall_s >= 0);
}

static void test_outcomes(void)
{
	ob_outcome out = run(&well, 20);
	CHECK(!*out.failed && out.figure[0] == .25 && out.body_seconds == 1 && out.cpu_s >= 0);
	CHECK_NEAR(out.figure[1], .5, 1e-12);
	expect(&aborting, 20, "crashed, SIGABRT: body 3 is no body");
	expect(&killed, 20, "crashed, SIGKILL");
	expect(&exiting, 20, "ended with status 7");
	expect(&talking, 20, "ended with status 1: line 4999 of many, each as boring as the one before");
	expect(&impossible, 20, "no such tolerance");
	CHECK(!ob_attempt_had_less(&out, 1e9));
	double begun = ob_clock_wall();
	expect(&hanging, .1, "ran longer than 0.4 s");
	CHECK(ob_clock_wall() - begun < 10 && ticks >= 1);
	out = run(&hanging, .01);
	CHECK(out.wall_s >= .04 && !ob_attempt_had_less(&out, .01) && ob_attempt_had_less(&out, 60));
	out = run(&busy, .1); // on a machine that has little time for it, the other limit ends it
	CHECK(out.cpu_s >= .1 ? strstr(out.failed, "0.1 s of CPU") : strstr(out.failed, "0.4 s"));
	CHECK(!ob_attempt_had_less(&out, .1) && ob_attempt_had_less(&out, 60));
}

static void test_interrupted(void)
{
	ob_attempt a = { &plain, &interrupting, { .step_length = 1. / 60, .substeps = 1 }, 60, NULL, NULL };
	ob_outcome out;
	ob_error e = { "" };
	ob_attempts_begin();
	CHECK(!ob_attempts_interrupted());
	CHECK(!ob_attempt_run(&a, &out, &e) && strstr(e.text, "interrupted"));
	CHECK(ob_attempts_interrupted());
	a.engine = &hanging; // the next one does not begin to wait
	CHECK(!ob_attempt_run(&a, &out, &e));
	ob_attempts_end();
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	ob_attempts_begin();
	CHECK(!ob_attempts_interrupted()); // told once
	kill(getpid(), SIGTERM); // waits for the next attempt
	CHECK(!ob_attempts_interrupted());
	CHECK(!ob_attempt_run(&a, &out, &e));
	ob_attempts_end();
}

static size_t done, all;

static void see(const ob_lab_progress *p, void *with)
{
	CHECK(p->done < p->all && p->of == with);
	done = p->done;
	all = p->all;
}

static ob_lab_plan make_plan(const ob_engine_kind *a, const ob_engine_kind *b, const char *file)
{
	ob_lab_plan p = { .repeats = 1, .limit = .05, .file = file, .tick = see, .with = (void *)&plain };
	p.cases = (ob_case_list){ 1, { &plain } };
	p.engines = (ob_engine_list){ 2, { a, b } };
	ob_error e;
	CHECK(ob_sweep_parse(&p.sweep, "substeps=1,2", &e));
	return p;
}

static void test_lab(const char *file)
{
	ob_results r = { .commit = "c0ffee" };
	ob_error e = { "" };
	ob_lab_plan p = make_plan(&well, &hanging, file);
	CHECK(ob_lab_run(&p, &r, &e));
	CHECK(r.count == 4 && done == 2 && all == 4 && access(file, R_OK) == 0); // no tick while the last is not tried
	const ob_run_settings one = { .step_length = plain.step, .substeps = 1 }, two = { .step_length = plain.step, .substeps = 2 };
	const ob_result *coarse = ob_results_find(&r, &plain, &hanging, &one);
	const ob_result *fine = ob_results_find(&r, &plain, &hanging, &two);
	CHECK(coarse && fine && coarse->wall_s[0] == fine->wall_s[0]);
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].repeats == 1 && !strcmp(r.result[i].commit, "c0ffee") &&
		      !*r.result[i].outcome.failed == (r.result[i].engine == &well));
	done = all = 9;
	CHECK(ob_lab_run(&p, &r, &e) && r.count == 4 && all == 9); // there is nothing left to do
	p.repeats = 3;
	CHECK(ob_lab_run(&p, &r, &e) && r.count == 4 && all == 4); // two more of those that came to their end
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].repeats == (r.result[i].engine == &well ? 3 : 1));
	p.limit = .1;
	CHECK(ob_lab_run(&p, &r, &e) && all == 2); // more time for those that had too little
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].engine == &well || strstr(r.result[i].outcome.failed, "0.4 s"));
	ob_results_finish(&r);
}

static void judge_fallen(ob_trial *t)
{
	judge(t);
	t->failed = "fell";
}

// What failed is shown as such, whatever its time: that is not taken again.
static void test_lab_failed_once(const char *file)
{
	ob_results r = { 0 };
	ob_error e = { "" };
	ob_case fallen = plain;
	fallen.judge = judge_fallen;
	ob_lab_plan p = make_plan(&well, &well, file);
	p.cases.of[0] = p.with = &fallen;
	p.engines.count = 1;
	p.repeats = 3;
	CHECK(ob_lab_run(&p, &r, &e) && r.count == 2);
	for (size_t i = 0; i < r.count; i++)
		CHECK(r.result[i].repeats == 1 && strstr(r.result[i].outcome.failed, "fell"));
	ob_results_finish(&r);
}

static void test_lab_interrupted(const char *file)
{
	ob_results r = { 0 };
	ob_error e = { "" };
	ob_lab_plan p = make_plan(&well, &interrupting, file);
	p.limit = 60;
	CHECK(!ob_lab_run(&p, &r, &e) && strstr(e.text, "interrupted"));
	CHECK(r.count == 2 && r.result[0].engine == &well); // what was done is there
	ob_results_finish(&r);
	p.engines.count = 1;
	p.file = "/no/such/folder/results.csv";
	CHECK(!ob_lab_run(&p, &r, &e) && strstr(e.text, "/no/such/folder"));
	ob_results_finish(&r);
}

int main(void)
{
	char file[] = "/tmp/obsim-test-XXXXXX";
	int made = mkstemp(file);
	CHECK(made >= 0);
	test_outcomes();
	test_interrupted();
	test_lab(file);
	test_lab_failed_once(file);
	test_lab_interrupted(file);
	close(made);
	unlink(file);
	return check_end();
}
