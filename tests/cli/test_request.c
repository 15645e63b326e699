// From words to a request: ranges, contradictions, places that are not there; and what the scene adds.
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
	check_refused("s --step 1/0", "more than 0");
	check_refused("s --step 1/", "expected a number");
	check_refused("s --step 1/60s", "expected a number");
	check_refused("s --substeps 0", "expected 1 to 1000");
	check_refused("s --substeps 2.5", "whole number");
	check_refused("s --seed -1", "whole number");
	check_refused("s --seed 18446744073709551616", "expected 0 to");
	check_refused("s --workers many", "a number, or objects");
	check_refused("s --workers 0", "expected 1 to");
	check_refused("s --arch monolith --workers 2", "one worker");
	check_refused("s --arch monolith --workers objects", "one worker");
	check_refused("s --arch monolith --exchange jacobi", "means nothing");
	check_refused("s --arch monolith --tolerance 1mm", "means nothing");
	check_refused("s --arch monolith --explain", "means nothing");
	check_refused("s --tolerance 1", "a length with its unit");
	check_refused("s --tolerance mm", "a length with its unit");
	check_refused("s --tolerance 1mmm", "a length with its unit");
	check_refused("s --tolerance nanm", "a length with its unit");
	check_refused("s --tolerance 0mm", "expected 1e-06m to 1m");
	check_refused("s --tolerance 2m", "expected 1e-06m to 1m");
	check_refused("s --tolerance 1mm --substeps 4", "expected one of them");
	check_refused("s --lag 257", "expected 0 to 256");
	check_refused("s --iterations 5", "--arch monolith");
	check_refused("s --fps 30", "--fps needs --frames, --video or --raw");
	check_refused("s --overlay aabb", "--overlay needs");
	check_refused("s --raw - --size 1280", "WIDTHxHEIGHT");
	check_refused("s --raw - --size 1280x720x3", "WIDTHxHEIGHT");
	check_refused("s --raw - --size 8x8", "pixels each way");
	check_refused("s --video v.mp4 --size 641x480", "even width");
	check_refused("s --raw - --overlay aabb,contact", "expected aabb, contacts");
	check_refused("s --raw - --json -", "both write standard output");
	check_refused("s --record same --json same", "both write same");
	check_refused("s --record -", "name a file");
	check_refused("s --json /no/such/place/x.json", "no directory /no/such/place");
	check_refused("s --json /tmp", "this is a directory");
	check_refused("s --frames /dev/null", "this is a file");
	check_refused("s --series x.csv --measure end", "--measure step");
	check_refused("s --name a/b", "letters, digits");
	check_refused("s --name .hidden", "letters, digits");
	check_refused("s --name aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "at most 47");
}

static void test_taken(void)
{
	ob_run_request r;
	ob_error e;
	CHECK(read_line("s", &r, &e));
	CHECK(r.workers == (uint32_t)ob_cpu_count() && r.measure == OB_MEASURE_STEPS && !r.frames.wanted &&
	      !r.monolith);
	CHECK(read_line("s --step 1/60 --duration .5 --workers objects --isolation process", &r, &e));
	CHECK(r.step == 1. / 60 && r.duration == .5 && r.workers == 0 && r.isolation == OB_ISOLATION_PROCESS);
	CHECK(read_line("s --arch monolith --workers 1 --iterations 0", &r, &e));
	CHECK(r.monolith && r.workers == 1 && r.iterations == 0);
	CHECK(read_line("s --raw - --size 64x48 --overlay contacts,aabb --fps 1/3 --measure end", &r, &e));
	CHECK(r.frames.wanted && r.frames.width == 64 && r.frames.height == 48 && r.frames.aabb && r.frames.contacts);
	CHECK(r.frames.fps == 1. / 3 && r.measure == OB_MEASURE_ENDS);
	CHECK(read_line("s --tolerance .5mm --passes 20 --explain", &r, &e));
	CHECK_NEAR(r.tolerance, .5e-3, 1e-18);
	CHECK(r.explain && r.passes == 20 && r.substeps == 0);
	CHECK(read_line("s --tolerance 1e-3m", &r, &e) && r.tolerance == 1e-3 && !r.explain);
	CHECK(read_line("s --tolerance 20um", &r, &e));
	CHECK_NEAR(r.tolerance, 20e-6, 1e-18);
	CHECK(read_line("s --seed 18446744073709551615", &r, &e));
	CHECK(r.scene_options.has_seed && r.scene_options.seed == UINT64_MAX);
}

static void test_settle(void)
{
	ob_camera_def cameras[] = { { .name = "main" }, { .name = "above" } };
	ob_scene s = {
		.step = 1. / 60,
		.duration = 10,
		.substeps = 4,
		.passes = 16,
		.exchange = "jacobi",
		.integrator = "ode",
		.cameras = 2,
		.camera = cameras,
	};
	ob_run_request r;
	ob_run_settings run;
	ob_error e;
	CHECK(read_line("s", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.step_length == 1. / 60 && run.substeps == 4 && run.passes == 16 && run.sleeping == 0);
	CHECK(run.exchange == OB_SOLVER_JACOBI && run.integrator == OB_INTEGRATOR_ODE && r.duration == 10);
	CHECK(read_line("s --exchange coloured --integrator exact --sleeping on --substeps 2 --passes 3", &r, &e));
	CHECK(ob_request_settle(&r, &s, &run, &e));
	CHECK(run.exchange == OB_SOLVER_COLOURED && run.integrator == OB_INTEGRATOR_EXACT && run.sleeping == 1);
	CHECK(run.substeps == 2 && run.passes == 3);
	CHECK(read_line("s --arch monolith", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.substeps == 1 && run.monolith == 1 && run.iterations == 20);
	CHECK(read_line("s --arch monolith --substeps 3", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.substeps == 3);
	CHECK(read_line("s --raw - --camera abov", &r, &e) && !ob_request_settle(&r, &s, &run, &e));
	CHECK(strstr(e.text, "did you mean above?"));
	CHECK(read_line("s --raw - --camera above", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(read_line("s --duration 1e9 --step 1e-9", &r, &e) && !ob_request_settle(&r, &s, &run, &e));
	CHECK(strstr(e.text, "too many steps"));
}

// Numbers on the command line stand above the scene's tolerance, and a tolerance there above the scene's numbers.
static void test_settle_exactness(void)
{
	ob_scene s = { .gravity = { 0, 0, -9.81 },
		       .step = 1. / 60,
		       .duration = 10,
		       .substeps = 4,
		       .passes = 16,
		       .lag = 1,
		       .exchange = "coloured",
		       .integrator = "exact" };
	ob_run_request r;
	ob_run_settings run;
	ob_error e;
	CHECK(read_line("s --tolerance .5mm", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == .5e-3 && run.substeps == 1 && r.substeps == 0 && run.passes == 64);
	CHECK(read_line("s --tolerance .5mm --passes 5", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.passes == 5);
	CHECK(read_line("s --tolerance .5mm --integrator ode", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.substeps == 4); // g H^2 / 2 = 1.36 mm
	CHECK(read_line("s", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 0 && run.substeps == 4 && run.passes == 16 && run.lag == 0 && run.timed == 0);
	s.tolerance = 2e-3;
	s.passes = 64;
	CHECK(read_line("s", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 2e-3 && run.substeps == 4 && run.passes == 64);
	CHECK(read_line("s --exchange ghost", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 0 && run.substeps == 4);
	s.substeps = 1;
	CHECK(read_line("s --explain", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 2e-3 && run.substeps == 1 && run.passes == 64 && run.timed == 1);
	CHECK(read_line("s --tolerance 1mm", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 1e-3);
	CHECK(read_line("s --substeps 3", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 0 && run.substeps == 3);
	CHECK(read_line("s --arch monolith", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.tolerance == 0 && run.substeps == 1);
	CHECK(read_line("s --lag 2", &r, &e) && !ob_request_settle(&r, &s, &run, &e));
	CHECK(strstr(e.text, "--exchange lagged"));
	CHECK(read_line("s --exchange lagged --lag 0", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.exchange == OB_SOLVER_LAGGED && run.lag == 0);
	CHECK(read_line("s --exchange lagged", &r, &e) && ob_request_settle(&r, &s, &run, &e) && run.lag == 1);
	CHECK(read_line("s --exchange ghost", &r, &e) && ob_request_settle(&r, &s, &run, &e));
	CHECK(run.exchange == OB_SOLVER_GHOST);
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
	test_settle();
	test_settle_exactness();
	test_steps();
	return check_end();
}
