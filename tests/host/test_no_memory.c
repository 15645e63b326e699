// A simulator runs out of memory: the run ends in order with a line that says so, with threads and with processes.
#include <string.h>
#include <sys/resource.h>

#include "base/allocate.h"
#include "check.h"
#include "little_scene.h"
#include "workers.h"

enum { BALLS = 200 };

static void test_run(ob_isolation isolation)
{
	ob_scene s = falling_heap(BALLS);
	ob_host_config c = little_config(&s, isolation, 2);
	ob_error e = { "" };
	struct rlimit before, none;
	ob_host *h = ob_host_start(&s, &c, &e);
	CHECK(h);
	ob_host_go(h, 2);
	CHECK(ob_host_wait(h, &e));
	for (uint32_t w = 0; w < 2; w++) {
		pid_t pid = pid_of_worker(ob_host_universe(h), w);
		CHECK(prlimit(pid, RLIMIT_DATA, NULL, &before) == 0);
		none = (struct rlimit){ 4096, before.rlim_max }; // 0 would mean unlimited
		CHECK(prlimit(pid, RLIMIT_DATA, &none, NULL) == 0);
	}
	ob_host_go(h, 150);
	CHECK(!ob_host_wait(h, &e) && strstr(e.text, "ran out of memory after step"));
	if (isolation == OB_ISOLATION_THREAD)
		setrlimit(RLIMIT_DATA, &before);
	puts(e.text);
	ob_host_stop(h);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
}

_Noreturn static void leave(void)
{
	_exit(9);
}

// Without a handler, and with one.
static void test_allocate(bool told, int code)
{
	int status;
	pid_t pid = fork();
	if (pid == 0) {
		if (told)
			ob_allocate_or_else(leave);
		else
			dup2(fileno(tmpfile()), STDERR_FILENO);
		char *p = ob_reallocate(ob_allocate(10), 20);
		p[19] = 1;
		p = ob_reallocate(p, (size_t)1 << 62);
		_exit(p != NULL);
	}
	CHECK(waitpid(pid, &status, 0) == pid && WIFEXITED(status) && WEXITSTATUS(status) == code);
}

int main(void)
{
	test_allocate(false, 1);
	test_allocate(true, 9);
	test_run(OB_ISOLATION_PROCESS);
	test_run(OB_ISOLATION_THREAD);
	return check_end();
}
