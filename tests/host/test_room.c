// The universe's memory runs out, or is truncated from outside, before a run and in the middle of one: one line that
// says so, exit code 1, nothing left.
//
// Only with a small /dev/shm of its own: PRIVATE_SHM=size=32m tests/private_shm.py PROGRAM.
#include <fcntl.h>
#include <pthread.h>
#include <string.h>
#include <sys/statvfs.h>

#include "check.h"
#include "little_scene.h"
#include "workers.h"

enum { SIZE_MIB = 32, SKIPPED = 77, BALLS = 150 };

// True if this /dev/shm is small and private, as requested.
static bool is_private(void)
{
	struct statvfs s;
	return statvfs("/dev/shm", &s) == 0 && s.f_blocks * s.f_frsize == (uint64_t)SIZE_MIB << 20;
}

static void fill_shared_memory(void)
{
	static char bytes[4096];
	int fd = open("/dev/shm/filler", O_CREAT | O_WRONLY, 0600);
	CHECK(fd >= 0);
	while (write(fd, bytes, sizeof bytes) > 0)
		;
	close(fd);
}

static void cut_short(void)
{
	CHECK(truncate("/dev/shm/obsim.test-room", 4096) == 0);
}

static void leave_alone(void) {}

// Runs a host in a process of its own, and harms it. Exit 0: without consequences.
_Noreturn static void run_host(ob_isolation isolation, uint32_t workers, void (*harm)(void), int said)
{
	ob_scene s = falling_heap(BALLS);
	ob_host_config c = little_config(&s, isolation, workers);
	ob_error e = { "" };
	dup2(said, STDERR_FILENO);
	c.name = "test-room";
	ob_pages_guard(NULL);
	ob_host *h = ob_host_start(&s, &c, &e);
	if (h)
		ob_host_go(h, 2);
	if (!h || !ob_host_wait(h, &e))
		_exit(2);
	harm();
	ob_host_go(h, 150);
	bool went = ob_host_wait(h, &e);
	if (!went)
		fprintf(stderr, "%s\n", e.text);
	ob_host_stop(h);
	_exit(!went);
}

// The run's output is one line with this in it, or empty.
static void check_harm(ob_isolation isolation, uint32_t workers, void (*harm)(void), const char *saying)
{
	char text[2000];
	int status;
	FILE *said = tmpfile();
	pid_t host = fork();
	if (host == 0)
		run_host(isolation, workers, harm, fileno(said));
	CHECK(waitpid(host, &status, 0) == host);
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == (saying ? 1 : 0));
	if (!WIFEXITED(status) || WEXITSTATUS(status) != (saying ? 1 : 0))
		fprintf(stderr, "isolation %d, workers %u, %s: status %d\n", isolation, workers, saying, status);
	rewind(said);
	text[fread(text, 1, sizeof text - 1, said)] = 0;
	CHECK(saying ? strstr(text, saying) != NULL && strchr(text, '\n') == text + strlen(text) - 1 : !*text);
	printf("%s", text);
	fclose(said);
	CHECK(nothing_left("test-room"));
	unlink("/dev/shm/filler");
}

enum { READERS = 8, TIMES = 20 };
static pthread_barrier_t together;

static void *read_missing_page(void *universe)
{
	const volatile ob_passport *p = ob_passport_of(universe, 1);
	pthread_barrier_wait(&together);
	return (void *)(uintptr_t)p->id;
}

// Threads that miss pages at the same time report it once.
static void test_many_miss(void)
{
	for (int i = 0; i < TIMES; i++) {
		char text[2000];
		int status;
		FILE *said = tmpfile();
		pid_t reader = fork();
		if (reader == 0) {
			pthread_t thread[READERS];
			ob_universe *u = make_universe("test-room", 2);
			dup2(fileno(said), STDERR_FILENO);
			ob_pages_guard(NULL);
			cut_short();
			pthread_barrier_init(&together, NULL, READERS);
			for (int k = 0; k < READERS; k++)
				pthread_create(&thread[k], NULL, read_missing_page, u);
			for (int k = 0; k < READERS; k++)
				pthread_join(thread[k], NULL);
			_exit(2);
		}
		CHECK(waitpid(reader, &status, 0) == reader && WIFEXITED(status) && WEXITSTATUS(status) == 1);
		rewind(said);
		text[fread(text, 1, sizeof text - 1, said)] = 0;
		CHECK(strstr(text, "cut it short") && strchr(text, '\n') == text + strlen(text) - 1);
		fclose(said);
		unlink("/dev/shm/obsim.test-room");
	}
}

// There is too little room to begin.
static void test_start(void)
{
	ob_scene s = falling_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, 2);
	ob_error e = { "" };
	fill_shared_memory();
	CHECK(!ob_host_start(&s, &c, &e) && strstr(e.text, "/dev/shm"));
	puts(e.text);
	unlink("/dev/shm/filler");
	free(s.object);
}

// Reserved memory is available, whichever thread uses it later.
static void test_reserved(void)
{
	ob_error e;
	ob_universe *u = make_universe("test-room", 2);
	CHECK(u && ob_universe_reserve(u, 4, &e) && ob_reserve_pairs(u, 0, 100) && ob_reserve_record(u, 99));
	fill_shared_memory();
	CHECK(ob_universe_reserve(u, 4, &e) && ob_reserve_pairs(u, 0, 100));
	memset(ob_universe_step_data(u)->pair, 1, 100 * sizeof(ob_pair_key));
	memset(ob_universe_step_data(u)->record + 99, 1, sizeof(ob_pair_record));
	CHECK(!ob_reserve_record(u, 5000) && ob_universe_lost(u));
	ob_universe_destroy(u, true);
	unlink("/dev/shm/filler");
}

int main(void)
{
	if (!is_private()) {
		puts("no /dev/shm of its own");
		return SKIPPED;
	}
	adopt_orphans();
	test_start();
	test_many_miss();
	test_reserved();
	for (int i = 0; i < 2; i++) {
		const ob_isolation isolation = i ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
		for (uint32_t workers = 0; workers < 3; workers += 2) {
			check_harm(isolation, workers, leave_alone, NULL);
			check_harm(isolation, workers, fill_shared_memory, "/dev/shm is full");
			check_harm(isolation, workers, cut_short, "is not all there: another program has cut it short");
		}
	}
	return check_end();
}
