// Promised sizes: 1000 simulators one per process, 4000 one per thread, 10,000 objects on a pool of 2. Fewer under
// ThreadSanitizer, for which a fork takes .1 s, and a thread 4 MB.
#include "check.h"
#include "little_scene.h"
#include "workers.h"

#ifdef __SANITIZE_THREAD__
enum { MANY_PROCESSES = 100, MANY_THREADS = 500 };
#else
enum { MANY_PROCESSES = 1000, MANY_THREADS = 4000 };
#endif

static void test_many(ob_isolation isolation, uint32_t objects, uint32_t workers)
{
	ob_scene s = little_scene(objects - 1);
	ob_host_config c = little_config(&s, isolation, workers);
	ob_error e = { "" };
	ob_host_times t;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h != NULL);
	if (!h)
		fprintf(stderr, "%s\n", e.text);
	for (uint64_t step = 0; h && step <= 5; step++) {
		ob_host_go(h, step);
		bool there = ob_host_wait(h, &e) && steps_of(h) == step;
		CHECK(there);
		if (!there)
			fprintf(stderr, "step %d: %s\n", (int)step, e.text);
	}
	if (h) {
		ob_host_get_times(h, &t);
		printf("%u objects, %u workers as %s: start %.0f ms, median step %.2f ms, %.1f MiB\n", objects,
		       workers ? workers : objects, isolation == OB_ISOLATION_THREAD ? "threads" : "processes",
		       1e3 * t.startup_s, 1e3 * t.step_p50_s, (double)t.memory_bytes / (1 << 20));
	}
	double began = ob_clock_wall();
	ob_host_stop(h);
	printf("stopped in %.0f ms\n", 1e3 * (ob_clock_wall() - began));
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

int main(void)
{
	test_many(OB_ISOLATION_PROCESS, MANY_PROCESSES, 0);
	test_many(OB_ISOLATION_THREAD, MANY_THREADS, 0);
	test_many(OB_ISOLATION_THREAD, 10000, 2);
	test_many(OB_ISOLATION_PROCESS, 10000, 2);
	return check_end();
}
