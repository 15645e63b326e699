// Trials that misbehave in every way, each in its process; the experiment goes on after them, and is resumed.
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "experiment/experiment.h"
#include "experiment/process.h"

static const ob_metric metrics[] = {
	{ .key = "time_s", .title = "time", .unit = "ms", .scale = 1e3, .target = NAN },
	{ .key = "error_m", .title = "error", .unit = "mm", .scale = 1e3, .target = 1 },
};

// Does what the name of the case says.
static bool run(const ob_trial *t, ob_record *out, ob_error *e)
{
	volatile unsigned i = 0;
	out->metric[0] = 1 + t->repeat;
	out->metric[1] = .25;
	if (!strcmp(t->of, "fell"))
		snprintf(out->reason, sizeof out->reason, "fell");
	if (!strcmp(t->of, "talk"))
		printf("this is not to be seen\n");
	if (!strcmp(t->of, "abort")) {
		fprintf(stderr, "something else\nbody 3 is no body\n");
		abort();
	}
	if (!strcmp(t->of, "chatter")) // more than a pipe's capacity
		for (int n = 0; n < 5000; n++)
			fprintf(stderr, "line %d of many, each as boring as the one before\n", n);
	if (!strcmp(t->of, "kill"))
		kill(getpid(), SIGKILL);
	if (!strcmp(t->of, "exit") || !strcmp(t->of, "chatter"))
		exit(7);
	if (!strcmp(t->of, "interrupt"))
		kill(getppid(), SIGINT);
	while (!strcmp(t->of, "hang") || !strcmp(t->of, "interrupt"))
		pause();
	while (!strcmp(t->of, "busy"))
		i++;
	if (!strcmp(t->of, "orphan") && fork() == 0) // a child that nothing else would end
		for (;;)
			pause();
	return strcmp(t->of, "impossible") || ob_fail(e, "no such tolerance");
}

static bool is_finer(const ob_trial *t, const ob_record *than)
{
	return atoi(t->configuration) > atoi(than->configuration);
}

static ob_experiment make(double limit)
{
	return (ob_experiment){ .name = "test",
				.commit = "c0ffee",
				.metrics = 2,
				.metric = metrics,
				.run = run,
				.limit_s = limit,
				.is_finer = is_finer,
				.quiet = true };
}

static void add(ob_trials *s, const char *of, const char *configuration)
{
	ob_trial t = { .guess_s = 1 };
	snprintf(t.of, sizeof t.of, "%s", of);
	snprintf(t.configuration, sizeof t.configuration, "%s", configuration);
	CHECK(ob_trials_add(s, &t));
}

static ob_record once(const char *of, double limit)
{
	ob_experiment x = make(limit);
	ob_trials s = { 0 };
	ob_records r;
	ob_error e = { "" };
	add(&s, of, "1");
	CHECK(ob_experiment_open(&x, NULL, &r, &e));
	bool fine = ob_experiment_run(&x, &s, &r, NULL, &e);
	if (!fine)
		fprintf(stderr, "%s: %s\n", of, e.text);
	CHECK(fine && r.count == 1);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0); // no child is left
	ob_record one = r.count ? r.record[0] : (ob_record){ 0 };
	ob_records_finish(&r);
	ob_trials_finish(&s);
	return one;
}

static void expect(const char *of, double limit, ob_failure failure, const char *reason)
{
	ob_record r = once(of, limit);
	if (strcmp(r.reason, reason) != 0)
		fprintf(stderr, "%s: '%s' instead of '%s'\n", of, r.reason, reason);
	CHECK(r.failure == failure && strcmp(r.reason, reason) == 0 && r.took_s >= 0);
	CHECK(failure <= OB_FAILURE_OUTCOME ? r.metric[1] == .25 : isnan(r.metric[0]) && isnan(r.metric[1]));
}

static void test_outcomes(void)
{
	expect("fine", 20, OB_FAILURE_NONE, "");
	expect("talk", 0, OB_FAILURE_NONE, "");
	expect("orphan", 20, OB_FAILURE_NONE, "");
	expect("fell", 20, OB_FAILURE_OUTCOME, "fell");
	expect("impossible", 20, OB_FAILURE_ERROR, "no such tolerance");
	expect("abort", 20, OB_FAILURE_CRASH, "crashed, SIGABRT: body 3 is no body");
	expect("kill", 20, OB_FAILURE_CRASH, "crashed, SIGKILL");
	expect("exit", 20, OB_FAILURE_CRASH, "ended with status 7");
	expect("chatter", 20, OB_FAILURE_CRASH,
	       "ended with status 7: line 4999 of many, each as boring as the one before");
	expect("hang", .1, OB_FAILURE_TIME, "ran longer than 0.4 s");
	ob_record r = once("busy", .1); // on a machine with little time for it, the other limit ends it
	CHECK(r.failure == OB_FAILURE_TIME);
	CHECK(r.took_cpu_s >= .1 ? strstr(r.reason, "0.1 s of CPU") : strstr(r.reason, "0.4 s"));
}

// A schedule with repeats; the folder's results are not measured again.
static void test_resume(const char *folder)
{
	ob_experiment x = make(.05);
	ob_trials s = { 0 };
	ob_records r;
	ob_error e = { "" };
	add(&s, "fine", "1");
	add(&s, "hang", "1");
	add(&s, "hang", "2");
	add(&s, "fell", "1");
	CHECK(ob_trials_repeat(&s, 0, 3, OB_ORDER_SAME, false) && s.count == 12);
	CHECK(ob_experiment_open(&x, folder, &r, &e) && r.count == 0);
	CHECK(ob_experiment_run(&x, &s, &r, folder, &e));
	CHECK(r.count == 6); // failures are not repeated
	const ob_record *coarse = ob_records_find(&r, "hang", "1", 0, 0),
			*fine = ob_records_find(&r, "hang", "2", 0, 0);
	CHECK(coarse && fine && coarse->took_s == fine->took_s && fine->failure == OB_FAILURE_TIME); // untried
	const ob_record *third = ob_records_find(&r, "fine", "1", 2, 0);
	CHECK(third && third->metric[0] == 3);
	ob_records_finish(&r);

	CHECK(ob_experiment_open(&x, folder, &r, &e) && r.count == 6);
	CHECK(ob_experiment_run(&x, &s, &r, folder, &e) && r.count == 6); // nothing is left to do
	x.limit_s = .1; // more time for those that had too little
	CHECK(ob_experiment_run(&x, &s, &r, folder, &e) && r.count == 6);
	coarse = ob_records_find(&r, "hang", "1", 0, 0);
	CHECK(coarse && strstr(coarse->reason, "0.4 s"));
	ob_records_drop(&r, &s); // afresh
	CHECK(r.count == 0);
	ob_records_finish(&r);
	ob_trials_finish(&s);

	x.commit = "another"; // its results are set aside
	char aside[128];
	snprintf(aside, sizeof aside, "%s/results-1.csv", folder);
	CHECK(ob_experiment_open(&x, folder, &r, &e) && r.count == 0 && access(aside, R_OK) == 0);
	unlink(aside);
}

static void test_orders(void)
{
	ob_trials s = { 0 };
	add(&s, "a", "1");
	add(&s, "b", "1");
	add(&s, "c", "1");
	CHECK(ob_trials_repeat(&s, 0, 3, OB_ORDER_ROTATED, true));
	CHECK(s.count == 9 && s.trial[3].of[0] == 'b' && s.trial[5].of[0] == 'a' && s.trial[6].of[0] == 'c');
	CHECK(s.trial[4].repeat == 1 && s.trial[4].seed == 1 && s.trial[8].seed == 2);
	s.count = 3;
	CHECK(ob_trials_repeat(&s, 1, 2, OB_ORDER_TO_AND_FRO, false));
	CHECK(s.count == 5 && s.trial[3].of[0] == 'c' && s.trial[4].of[0] == 'b' && s.trial[4].seed == 0);
	ob_trials_finish(&s);
}

static void test_interrupted(const char *folder)
{
	ob_experiment x = make(60);
	ob_trials s = { 0 };
	ob_records r;
	ob_error e = { "" };
	add(&s, "fine", "1");
	add(&s, "interrupt", "1");
	CHECK(ob_experiment_open(&x, folder, &r, &e));
	CHECK(!ob_experiment_run(&x, &s, &r, folder, &e) && strstr(e.text, "interrupted: 1 of 2"));
	CHECK(r.count == 1); // completed ones are there
	ob_records_finish(&r);
	CHECK(ob_experiment_open(&x, folder, &r, &e) && r.count == 1);
	CHECK(!ob_experiment_run(&x, &s, &r, "/no/such/folder", &e) && strstr(e.text, "/no/such/folder"));
	ob_records_finish(&r);
	ob_trials_finish(&s);
	ob_processes_begin();
	CHECK(!ob_processes_interrupted()); // reported once
	ob_processes_end();
}

int main(void)
{
	char folder[] = "/tmp/obsim-test-XXXXXX", file[64];
	CHECK(mkdtemp(folder));
	snprintf(file, sizeof file, "%s/results.csv", folder);
	test_outcomes();
	test_orders();
	test_resume(folder);
	test_interrupted(folder);
	unlink(file);
	CHECK(rmdir(folder) == 0); // nothing else is left there
	return check_end();
}
