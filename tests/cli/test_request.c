// From words to a request: ranges, contradictions, places that are not there; and what the scene adds.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/cpu.h"
#include "check.h"
#include "cli/request.h"

static bool read_line(const char *line, ob_run_request *r, ob_error *e)
{
	static char copy[256];
	char *words[16];
	int n = 0;
	ob_arguments a;
	strcpy(copy, line);
	for (char *w = strtok(copy, " "); w && n < 16; w = strtok(NULL, " "))
		words[n++] = w;
	e->text[0] = 0;
	bool fine = ob_options_parse(&a, OB_COMMAND_RUN, n, words, e) && ob_request_read(r, &a, e);
	ob_options_finish(&a);
	return fine;
}

static void check_refused(const char *line, const char *part)
{
	ob_run_request r;
	ob_error e;
	bool taken = read_line(line, &r, &e);
	CHECK(!taken);
	CHECK(strstr(e.text, part));
	if (taken || !strstr(e.text, part))
		fprintf(stderr, "  '%s' gave '%s', expected '%s' in it\n", line, e.text, part);
}

static void test_refused(void)
{
	check_refused("", "no scene given");
	check_refused("s --duration 1x", "expected a number");
	check_refused("s --duration nan", "expected a number");
	check_refused("s --duration inf", "expected a number");
	check_refused("s --duration 0x10", "expected a number");
	check_refused("s --duration 0", "more than 0");
	check_refused("s --duration -1", "more than 0");
	check_refused("s --step 1/0", "more than 1e-09");
	check_refused("s --step 1/", "expected a number");
	check_refused("s --step 1/60s", "expected a number");
	check_refused("s --set substeps=0", "expected 1 to 1000");
	check_refused("s --set substeps=2.5", "whole number");
	check_refused("s --seed -1", "whole number");
	check_refused("s --seed 18446744073709551616", "expected 0 to");
	check_refused("s --workers many", "a number, or objects");
	check_refused("s --workers 0", "expected 1 to");
	check_refused("s --arch monolith --workers 2", "one worker");
	check_refused("s --arch monolith --workers objects", "one worker");
	check_refused("s --tolerance mm", "a length, as .5mm or .0005 (m), or a share");
	check_refused("s --tolerance 1mmm", "a length, as .5mm or .0005 (m), or a share");
	check_refused("s --tolerance nanm", "a length, as .5mm or .0005 (m), or a share");
	check_refused("s --tolerance 0x1p-9", "a length, as .5mm or .0005 (m), or a share");
	check_refused("s --tolerance -1mm", "a length, as .5mm or .0005 (m), or a share");
	check_refused("s --tolerance 0", "expected 1e-06m to 1m");
	check_refused("s --tolerance 0mm", "expected 1e-06m to 1m");
	check_refused("s --tolerance 2m", "expected 1e-06m to 1m");
	check_refused("s --tolerance 1mm --set substeps=4", "expected one of them");
	check_refused("s --set lag=257", "expected 0 to 256");
	check_refused("s --set lag", "--set lag needs a value: --set lag=K");
	check_refused("s --set leg=1", "--set leg=1: did you mean lag?");
	check_refused("s --set zzzz=1", "--set help lists them");
	check_refused("s --set tolerance=1mm", "it has an option of its own: --tolerance");
	check_refused("s --set update_rate=0", "--set update_rate=0: expected more than 0, at most 100000");
	check_refused("s --set jitter=1", "--set jitter=1: expected more than 0, at most 0.9");
	check_refused("s --set record_schedule=a.mp4", "is the end of the name of a video");
	check_refused("s --set record_schedule=same --json same", "--json and --set record_schedule both write same");
	check_refused("s --still 1", "--still needs --out");
	check_refused("s --out - --still 1,1", "--still 1,1: expected growing times");
	check_refused("s --out - --still 1 --fps 2", "--still gives single frames: leave --fps away");
	check_refused("s --fps 30", "--fps needs --out");
	check_refused("s --overlay aabb", "--overlay needs");
	check_refused("s --out - --size 1280", "WIDTHxHEIGHT");
	check_refused("s --out - --size 1280x720x3", "WIDTHxHEIGHT");
	check_refused("s --out - --size 8x8", "pixels each way");
	check_refused("s --out v.mp4 --size 641x480", "even width");
	check_refused("s --out - --overlay aabb,contact", "expected aabb, contacts");
	check_refused("s --out - --json -", "both write standard output");
	check_refused("s --record same --json same", "both write same");
	check_refused("s --record -", "name a file");
	check_refused("s --json /no/such/place/x.json", "no directory /no/such/place");
	check_refused("s --json /tmp", "this is a directory");
	check_refused("s --out /dev/null/frames", "this is a file");
	check_refused("s --series x.csv --set measure=end", "--set measure=step");
	check_refused("s --harden --isolation thread", "threads share all their memory");
	check_refused("s --isolation process --harden --arch monolith", "a monolith is one simulator");
	check_refused("s --isolation process --harden=page", "--harden=page: expected some of outbox|checksum|pages");
	check_refused("s --isolation process --harden=,", "--harden=: expected some of");
	check_refused("s --name a/b", "letters, digits");
	check_refused("s --name .hidden", "letters, digits");
	check_refused("s --name aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "at most 47");
}

static void test_taken(void)
{
	ob_run_request r;
	ob_error e;
	CHECK(read_line("s", &r, &e));
	CHECK(r.workers == (uint32_t)ob_cpu_count() && r.asked.measure == OB_MEASURE_STEPS && !r.frames.wanted &&
	      !ob_setting_is_set(&r.asked, OB_SETTING_ARCHITECTURE));
	CHECK(read_line("s --step 1/60 --duration .5 --workers objects --isolation process", &r, &e));
	CHECK(r.asked.run.step_length == 1. / 60 && r.duration == .5 && r.workers == 0 &&
	      r.isolation == OB_ISOLATION_PROCESS);
	CHECK(read_line("s --arch monolith --workers 1 --set iterations=0", &r, &e));
	CHECK(r.asked.run.monolith == 1 && r.workers == 1 && r.asked.run.iterations == 0);
	CHECK(read_line("s --out - --size 64x48 --overlay contacts,aabb --fps 1/3 --set measure=end", &r, &e));
	CHECK(r.frames.wanted && r.frames.width == 64 && r.frames.height == 48 && r.frames.aabb && r.frames.contacts);
	CHECK(r.frames.fps == 1. / 3 && r.asked.measure == OB_MEASURE_ENDS);
	CHECK(read_line("s --tolerance .5mm --set iterations=20 --explain", &r, &e));
	CHECK_NEAR(r.asked.run.tolerance, .5e-3, 1e-18);
	CHECK(r.explain && r.asked.run.iterations == 20 && !ob_setting_is_set(&r.asked, OB_SETTING_SUBSTEPS));
	CHECK(read_line("s --tolerance 1e-3m", &r, &e) && r.asked.run.tolerance == 1e-3 && !r.explain);
	CHECK(read_line("s --tolerance .001", &r, &e) && r.asked.run.tolerance == 1e-3);
	CHECK(read_line("s --tolerance 20um", &r, &e));
	CHECK_NEAR(r.asked.run.tolerance, 20e-6, 1e-18);
	CHECK(!r.harden && read_line("s --harden", &r, &e) && r.harden == OB_HARDEN_ALL);
	CHECK(r.isolation == OB_ISOLATION_PROCESS);
	CHECK(read_line("s --harden=limits,calls --isolation process", &r, &e));
	CHECK(r.harden == (1 << OB_HARDEN_LIMITS | 1 << OB_HARDEN_CALLS));
	CHECK(read_line("s --harden=pages --isolation process", &r, &e)); // pages need the outbox
	CHECK(r.harden == (1 << OB_HARDEN_OUTBOX | 1 << OB_HARDEN_PAGES));
	CHECK(read_line("s --set max_lag=none --set jitter=0 --set delay=1/8", &r, &e) && isinf(r.asked.free.max_lag));
	CHECK(r.asked.free.jitter == 0 && r.asked.free.delay == .125);
	CHECK(ob_setting_is_set(&r.asked, OB_SETTING_JITTER) && !ob_setting_is_set(&r.asked, OB_SETTING_COUPLING));
	CHECK(read_line("s --seed 18446744073709551615", &r, &e));
	CHECK(r.scene_options.has_seed && r.scene_options.seed == UINT64_MAX);
}

// Words of earlier versions
static void test_former_names(void)
{
	ob_run_request r;
	ob_error e;
	CHECK(read_line("s --set passes=5 --set exchange=jacobi --set measure=parts", &r, &e));
	CHECK(r.asked.run.iterations == 5 && r.asked.run.solver == OB_SOLVER_JACOBI &&
	      r.asked.measure == OB_MEASURE_PROFILE);
	check_refused("s --set passes=5 --set iterations=5", "--set iterations is given twice");
	check_refused("s --set exchange=jakobi", "--set solver=jakobi: did you mean jacobi?");
	check_refused("s --exchange jacobi", "--exchange is now --set solver=coloured|jacobi|ghost|lagged");
	check_refused("s --lag 3", "--lag is now --set lag=K");
	check_refused("s --max-lag=none", "--max-lag is now --set max_lag=S|none");
	check_refused("s --parts", "unknown option --parts");
}

static void test_settle(void)
{
	ob_camera_def cameras[] = { { .name = "main" }, { .name = "above" } };
	ob_scene s = { .run = ob_run_settings_default(), .duration = 10, .cameras = 2, .camera = cameras };
	ob_run_request r;
	ob_error e;
	CHECK(read_line("s", &r, &e) && ob_request_resolve(&r, &s, &e));
	CHECK(r.run.substeps == 8 && r.run.tolerance == 1e-3 && r.run.timed == 0 && r.duration == 10);
	CHECK(read_line("s --set solver=jacobi --set integrator=ode --set sleeping=off --set substeps=2 --duration 3",
			&r, &e));
	CHECK(ob_request_resolve(&r, &s, &e) && r.duration == 3);
	CHECK(r.run.solver == OB_SOLVER_JACOBI && r.run.integrator == OB_INTEGRATOR_ODE && r.run.sleeping == 0);
	CHECK(r.run.substeps == 2 && r.run.tolerance == 0);
	CHECK(read_line("s --explain", &r, &e) && ob_request_resolve(&r, &s, &e) && r.run.timed == 1);
	CHECK(read_line("s --set measure=profile", &r, &e) && ob_request_resolve(&r, &s, &e) && r.run.timed == 1);
	CHECK(read_line("s --arch monolith --explain", &r, &e) && !ob_request_resolve(&r, &s, &e));
	CHECK(strstr(e.text, "--explain means nothing"));
	CHECK(read_line("s --out - --camera abov", &r, &e) && !ob_request_resolve(&r, &s, &e));
	CHECK(strstr(e.text, "did you mean above?"));
	CHECK(read_line("s --out - --camera above", &r, &e) && ob_request_resolve(&r, &s, &e));
	CHECK(read_line("s --duration 1e9 --step 2e-9", &r, &e) && !ob_request_resolve(&r, &s, &e));
	CHECK(strstr(e.text, "too many steps"));
}

static void test_steps(void)
{
	CHECK(ob_request_steps(10, 1. / 60) == 600);
	CHECK(ob_request_steps(.3, .1) == 3); // .3 / .1 is a little less than 3
	CHECK(ob_request_steps(.7, .1) == 7); // .7 / .1 a little less than 7; 1.1 / .1 a little more than 11
	CHECK(ob_request_steps(1.1, .1) == 11);
	CHECK(ob_request_steps(.25, .1) == 3);
	CHECK(ob_request_steps(1e-6, .1) == 1);
	for (uint64_t n = 1; n < 200000; n = n * 3 / 2 + 1) {
		CHECK(ob_request_steps((double)n / 60, 1. / 60) == n);
		CHECK(ob_request_steps((double)n * .001, .001) == n);
	}
}

int main(void)
{
	test_refused();
	test_taken();
	test_former_names();
	test_settle();
	test_steps();
	return check_end();
}
