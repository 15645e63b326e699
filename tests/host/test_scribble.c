// Random writes into the universe during a run neither crash nor hang the host: the run ends, normally or with a
// message. Its results may be wrong; test_contain.c tests that simulators cannot write where they should not.
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "check.h"
#include "little_scene.h"
#include "measure/measure.h"
#include "workers.h"

enum { STEPS = 200, BALLS = 60, RUNS_EACH = 2 };
static const char name[] = "test-scribble";

static uint64_t random_state;

static uint64_t draw(uint64_t below)
{
	random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (random_state >> 20) % below;
}

// Balls that fall onto each other, some of them temporary: the host changes the set of objects.
static ob_scene heap(void)
{
	ob_scene s = little_scene(BALLS);
	for (int i = 1; i <= BALLS; i++) {
		s.object[i].state.pose.p = ob_v3(.11 * (i % 3), .12 * (i / 3 % 3) + .01 * i, .3 + .22 * (i / 9));
		s.object[i].passport.restitution = .3;
		if (i > 40)
			s.object[i].dies = .05 * (i - 35);
	}
	return s;
}

// Runs, reads the universe now and then, and ends. Exit code 0 or 1: without an error, or with its message.
static int run(const ob_scene *s)
{
	ob_error e = { "" };
	ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, 2);
	ob_host_times times;
	ob_snapshot now = { 0 };
	c.name = name;
	c.patience = 1;
	ob_host *h = ob_host_start(s, &c, &e);
	bool fine = h;
	for (uint64_t step = 0; fine && step <= STEPS; step += 10) {
		ob_host_go(h, step);
		ob_penetration depth;
		fine = ob_host_wait(h, &e);
		if (fine && ob_snapshot_take(&now, ob_host_universe(h), OB_SNAPSHOT_CONTACTS, &e)) {
			ob_measure_penetration(&now, &depth);
			ob_measure_hash(&now);
		}
		pause_ms(1);
	}
	if (h)
		ob_host_get_times(h, &times);
	ob_host_stop(h);
	ob_snapshot_finish(&now);
	if (!fine && !*e.text)
		return 2;
	return fine ? 0 : 1;
}

// Maps the segment of the run for writing, as its simulators do. NULL: it is gone.
static uint64_t *map_segment(size_t *bytes, int *fd)
{
	struct stat s;
	char path[64];
	snprintf(path, sizeof path, "/obsim.%s", name);
	*fd = shm_open(path, O_RDWR | O_CLOEXEC, 0);
	if (*fd < 0 || fstat(*fd, &s) != 0 || s.st_size == 0)
		return NULL;
	*bytes = (size_t)s.st_size;
	void *base = mmap(NULL, *bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, *fd, 0);
	return base == MAP_FAILED ? NULL : base;
}

// Overwrites one word somewhere in the used pages. The first page, which is read before anything else, stays as it is.
static void scribble(uint64_t *word, size_t bytes, int fd)
{
	enum { PAGE = 4096, KINDS = 4 };
	off_t from = PAGE + (off_t)draw(bytes - PAGE);
	off_t data = lseek(fd, from, SEEK_DATA);
	data = data < 0 ? lseek(fd, PAGE, SEEK_DATA) : data;
	if (data < 0 || (size_t)data + PAGE > bytes)
		return;
	uint64_t *to = word + (size_t)data / 8 + draw(PAGE / 8);
	const uint64_t any = draw(UINT64_MAX) << 32 ^ draw(UINT64_MAX),
		       kinds[KINDS] = { any, draw(200), UINT64_MAX, *to ^ UINT64_C(1) << draw(64) };
	__atomic_store_n(to, kinds[draw(KINDS)], __ATOMIC_RELAXED);
}

static void test_words(int words, uint64_t seed)
{
	ob_scene s = heap();
	fflush(stdout);
	pid_t child = fork();
	if (child == 0)
		_exit(run(&s));
	size_t bytes = 0;
	int fd = -1, status = 0, done = 0;
	uint64_t *word = NULL;
	random_state = seed;
	while (!word && waitpid(child, &status, WNOHANG) == 0) {
		if (fd >= 0)
			close(fd);
		word = map_segment(&bytes, &fd);
		pause_ms(1);
	}
	pause_ms((int)draw(100));
	for (; word && done < words; done++) {
		scribble(word, bytes, fd);
		if (done % 50 == 0)
			pause_ms(1);
	}
	waitpid(child, &status, 0);
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) <= 1);
	printf("%d words, seed %llu: %s %d\n", words, (unsigned long long)seed, WIFEXITED(status) ? "exit" : "signal",
	       WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
	CHECK(nothing_left(name));
	if (word)
		munmap(word, bytes);
	if (fd >= 0)
		close(fd);
	free(s.object);
}

// The host relies on its own data: an object whose passport denies that it is kinematic still counts as kinematic.
static int run_with_false_passport(const ob_scene *s)
{
	ob_error e = { "" };
	ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, 2);
	ob_host *h = ob_host_start(s, &c, &e);
	if (!h)
		return 2;
	ob_host_go(h, 10);
	bool fine = ob_host_wait(h, &e);
	ob_passport *pass = (ob_passport *)ob_passport_of(ob_host_universe(h), BALLS);
	fine = fine && pass->flags & OB_OBJECT_KINEMATIC;
	pass->flags &= ~(uint32_t)OB_OBJECT_KINEMATIC;
	ob_host_go(h, 20);
	fine = ob_host_wait(h, &e) && fine;
	ob_host_stop(h);
	return fine ? 0 : 1;
}

static void test_false_passport(void)
{
	ob_scene s = little_scene(BALLS);
	int status = 0;
	s.object[BALLS].passport.flags = OB_OBJECT_KINEMATIC;
	s.object[BALLS].passport.mass = 0;
	fflush(stdout);
	pid_t child = fork();
	if (child == 0)
		_exit(run_with_false_passport(&s));
	waitpid(child, &status, 0);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) // builds that check invariants: the run ends in order
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 1);
#else
	CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
#endif
	free(s.object);
}

int main(int argc, char **argv)
{
	const uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
		       runs = argc > 2 ? strtoull(argv[2], NULL, 10) : RUNS_EACH;
	adopt_orphans();
	test_false_passport();
	for (uint64_t i = first; i < first + runs; i++) {
		test_words(1, 3 * i);
		test_words(10, 3 * i + 1);
		test_words(500, 3 * i + 2);
	}
	return check_end();
}
