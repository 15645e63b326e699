// Memory of an object in total: simulators, universe and host, with and without ODE worlds of their own, and, with
// processes, the checkpoint for restarts. The memory of a run of ten objects is subtracted, as the share of every run.
// Each run is in a process of its own, which finds no memory left by another.
#include "../check.h"

#include <sys/wait.h>
#include <unistd.h>

#include "little_scene.h"

enum { FEW = 10, MANY = 20000, STEPS = 30 };

static size_t run(uint32_t objects, ob_isolation isolation, uint32_t workers, uint32_t integrator)
{
	ob_error e;
	ob_scene s = little_scene(objects);
	ob_host_config c = little_config(&s, isolation, workers);
	c.run.integrator = integrator;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h);
	if (h) {
		ob_host_go(h, STEPS);
		CHECK(ob_host_wait(h, &e));
	}
	ob_host_times t = { 0 };
	if (h)
		ob_host_get_times(h, &t);
	ob_host_stop(h);
	free(s.object);
	return t.memory_bytes;
}

static size_t run_alone(uint32_t objects, ob_isolation isolation, uint32_t workers, uint32_t integrator)
{
	size_t bytes = 0;
	int ends[2], status = 1;
	CHECK(pipe(ends) == 0);
	const pid_t child = fork();
	if (child == 0) {
		bytes = run(objects, isolation, workers, integrator);
		_exit(write(ends[1], &bytes, sizeof bytes) != sizeof bytes);
	}
	close(ends[1]);
	CHECK(child > 0 && read(ends[0], &bytes, sizeof bytes) == sizeof bytes);
	CHECK(waitpid(child, &status, 0) == child && status == 0);
	close(ends[0]);
	return bytes;
}

static void check(const char *what, ob_isolation isolation, uint32_t workers, uint32_t integrator, double most)
{
	size_t few = run_alone(FEW, isolation, workers, integrator),
	       many = run_alone(MANY, isolation, workers, integrator);
	double each = (double)(many - few) / (MANY - FEW);
	printf("%s, %u workers: %.0f bytes each, %zu besides\n", what, workers, each, few);
	fflush(stdout);
	CHECK(many > few && each < most);
}

int main(void)
{
	check("threads", OB_ISOLATION_THREAD, 1, OB_INTEGRATOR_EXACT, 1500);
	check("threads", OB_ISOLATION_THREAD, 2, OB_INTEGRATOR_EXACT, 1500);
	check("processes", OB_ISOLATION_PROCESS, 2, OB_INTEGRATOR_EXACT, 1950);
	check("threads, ODE worlds", OB_ISOLATION_THREAD, 1, OB_INTEGRATOR_ODE, 4000);
	check("processes, ODE worlds", OB_ISOLATION_PROCESS, 2, OB_INTEGRATOR_ODE, 4000);
	return check_end();
}
