// Hardened simulators: the bits are the same. Random writes to all memory of the universe that one of them can write
// are detected or without effect, and never reach the result; the culprit is named. Each measure alone is in force, and
// changes no bits.
//
// Words are written from outside, at any instant (process_vm_writev obeys the protection of the pages, as the
// simulator's own stores do). Arguments: first seed, seeds, "all" to include the simulators' own memory, where a store
// may make a simulator miscalculate.
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/uio.h>

#include "base/sanitizer.h"
#include "check.h"
#include "little_scene.h"
#include "measure/measure.h"
#include "workers.h"

enum { STEPS = OB_SANITIZED ? 100 : 200, BALLS = OB_SANITIZED ? 30 : 60, SEEDS = OB_SANITIZED ? 1 : 2 };

typedef struct scribbler {
	ob_host *h;
	uint64_t random;
	int words;
	bool own_memory; // include the simulators' own memory
	atomic_bool over;
	atomic_uint written;
} scribbler;

static uint64_t draw(scribbler *s, uint64_t below)
{
	s->random = s->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (s->random >> 20) % below;
}

// Chooses a word among those that the process can write. Returns 0 if there is none any more, or if the process does not
// simulate yet: it is announced (ob_worker_announce) just before the universe becomes read-only for it.
static uint64_t choose_word(scribbler *s, pid_t pid)
{
	char path[64], line[400], rights[5];
	uint64_t begin, end, inode, first[256], size[256], n = 0;
	unsigned major, minor;
	bool confined = false;
	snprintf(path, sizeof path, "/proc/%d/maps", (int)pid);
	FILE *f = fopen(path, "r");
	while (f && n < 256 && fgets(line, sizeof line, f)) {
		if (sscanf(line, "%" SCNx64 "-%" SCNx64 " %4s %*x %x:%x %" SCNu64, &begin, &end, rights, &major, &minor,
			   &inode) != 6)
			continue;
		const bool shared = rights[3] == 's';
		confined |= shared && rights[1] != 'w';
		if (rights[1] != 'w' || !(shared || s->own_memory))
			continue;
		first[n] = begin, size[n++] = end - begin;
	}
	if (f)
		fclose(f);
	if (!n || !confined)
		return 0;
	const uint64_t i = draw(s, n);
	return first[i] + 8 * draw(s, (draw(s, 2) ? size[i] : size[i] < 65536 ? size[i] : 65536) / 8);
}

static void scribble(scribbler *s, pid_t pid)
{
	const uint64_t any = draw(s, UINT64_MAX) << 32 ^ draw(s, UINT64_MAX),
		       kinds[4] = { any, draw(s, 200), 0, UINT64_MAX };
	uint64_t word = kinds[draw(s, 4)], at = choose_word(s, pid);
	struct iovec from = { &word, sizeof word }, to = { (void *)(uintptr_t)at, sizeof word };
	if (at && process_vm_writev(pid, &from, 1, &to, 1, 0) == sizeof word)
		s->written++;
}

static void *scribble_along(void *argument)
{
	scribbler *s = argument;
	ob_worker_info info;
	pause_us((int)draw(s, 60000));
	for (int i = 0; i < s->words && !s->over; i++) {
		const uint32_t w = (uint32_t)draw(s, ob_universe_simulators(ob_host_universe(s->h)));
		if (ob_universe_get_worker(ob_host_universe(s->h), w, &info) && info.pid)
			scribble(s, info.pid);
		if (i % 20 == 19)
			pause_us(500);
	}
	return NULL;
}

// Returns the hash at the end; 0: the run has failed.
static uint64_t run(const ob_scene *scene, ob_host_config *c, scribbler *s, uint32_t *deaths)
{
	ob_error e = { "" };
	ob_snapshot now = { 0 };
	ob_host_times times;
	pthread_t thread;
	uint64_t hash = 0;
	ob_host *h = ob_host_start(scene, c, &e);
	bool fine = h;
	if (h && s) {
		s->h = h;
		pthread_create(&thread, NULL, scribble_along, s);
	}
	for (uint64_t step = 10; fine && step <= STEPS; step += 10) {
		ob_host_go(h, step);
		fine = ob_host_wait(h, &e) && steps_of(h) == step;
		if (s)
			pause_us(1000);
	}
	if (h && s) {
		s->over = true;
		pthread_join(thread, NULL);
	}
	if (fine && ob_snapshot_take(&now, ob_host_universe(h), 0, &e))
		hash = ob_measure_hash(&now);
	if (!hash)
		printf("%s\n", e.text);
	if (h)
		ob_host_get_times(h, &times);
	*deaths = h ? times.deaths : 0;
	ob_host_stop(h);
	ob_snapshot_finish(&now);
	return hash;
}

static void test_same_bits(const ob_scene *s, uint64_t expected)
{
	static const uint32_t workers[] = { 1, 2, 3, 0 };
	uint32_t deaths;
	for (size_t i = 0; i < sizeof workers / sizeof *workers; i++) {
		ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, workers[i]);
		c.harden = OB_HARDEN_ALL;
		CHECK(run(s, &c, NULL, &deaths) == expected && deaths == 0);
	}
}

// ---- each measure

// Returns the number in /proc/PID/FILE after a word at the start of a line; -1: there is none.
static int64_t number_of(pid_t pid, const char *file, const char *word, int base)
{
	char path[64], line[400];
	int64_t found = -1;
	snprintf(path, sizeof path, "/proc/%d/%s", (int)pid, file);
	FILE *f = fopen(path, "r");
	while (f && found < 0 && fgets(line, sizeof line, f))
		if (!strncmp(line, word, strlen(word)))
			found = strtoll(line + strlen(word), NULL, base);
	if (f)
		fclose(f);
	return found;
}

// Counts the bytes that the process shares with others (the universe), and those of them that it can write.
static void count_shared(pid_t pid, uint64_t *all, uint64_t *writable)
{
	char path[64], line[400], rights[5];
	uint64_t begin, end;
	snprintf(path, sizeof path, "/proc/%d/maps", (int)pid);
	FILE *f = fopen(path, "r");
	*all = *writable = 0;
	while (f && fgets(line, sizeof line, f))
		if (sscanf(line, "%" SCNx64 "-%" SCNx64 " %4s", &begin, &end, rights) == 3 && rights[3] == 's') {
			*all += end - begin;
			*writable += rights[1] == 'w' ? end - begin : 0;
		}
	if (f)
		fclose(f);
}

static void check_in_force(const ob_universe *u, uint32_t measures)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
	const bool filtered = false; // sanitizers make system calls of their own, which confine.c allows
#else
	const bool filtered = true;
#endif
	enum { NOBODY = 65534, FILES = 3 };
	const bool privileges = measures & 1 << OB_HARDEN_PRIVILEGES,
		   calls = filtered && measures & 1 << OB_HARDEN_CALLS;
	ob_worker_info info;
	uint64_t all, writable;
	CHECK(ob_universe_workers(u) - ob_universe_simulators(u) == (measures >> OB_HARDEN_OUTBOX & 1));
	for (uint32_t w = 0; w < ob_universe_workers(u); w++) {
		CHECK(ob_universe_get_worker(u, w, &info));
		count_shared(info.pid, &all, &writable);
		CHECK(all > 0 && writable > 0);
		CHECK((writable < all) == (measures & 1 << OB_HARDEN_PAGES && w < ob_universe_simulators(u)));
		CHECK(number_of(info.pid, "status", "Uid:", 10) == (privileges && getuid() == 0 ? NOBODY : getuid()));
		CHECK(number_of(info.pid, "status", "CapEff:", 16) ==
		      (privileges ? 0 : number_of(getpid(), "status", "CapEff:", 16)));
		CHECK(number_of(info.pid, "status", "NoNewPrivs:", 10) ==
		      (privileges || calls || number_of(getpid(), "status", "NoNewPrivs:", 10) == 1));
		CHECK((number_of(info.pid, "limits", "Max open files", 10) == FILES) ==
		      !!(measures & 1 << OB_HARDEN_LIMITS));
		CHECK(number_of(info.pid, "status", "Seccomp_filters:", 10) ==
		      number_of(getpid(), "status", "Seccomp_filters:", 10) + calls);
	}
}

static void test_each_measure(const ob_scene *s, uint64_t expected)
{
	static const char *const lists[] = { "outbox", "checksum", "pages", "privileges", "limits", "calls", "", NULL };
	ob_error e;
	uint32_t deaths;
	for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
		ob_host_config c = little_config(s, OB_ISOLATION_PROCESS, 2);
		CHECK(ob_harden_read(&c.harden, lists[i], &e));
		ob_host *h = ob_host_start(s, &c, &e);
		CHECK(h);
		if (!h)
			continue;
		ob_host_go(h, 10);
		CHECK(ob_host_wait(h, &e));
		check_in_force(ob_host_universe(h), c.harden);
		ob_host_stop(h);
		CHECK(run(s, &c, NULL, &deaths) == expected && deaths == 0);
	}
}

int main(int argc, char **argv)
{
	const uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
		       seeds = argc > 2 ? strtoull(argv[2], NULL, 10) : SEEDS;
	static const int words[] = { 1, 10, 500 };
	uint32_t deaths, sum = 0, failed = 0, wrong = 0, runs = 0;
	uint64_t written = 0;
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, 1);
	const uint64_t expected = run(&s, &c, NULL, &deaths);
	test_same_bits(&s, expected);
	test_each_measure(&s, expected);
	for (uint64_t seed = first; seed < first + seeds; seed++)
		for (int i = 0; i < 3; i++, runs++) {
			scribbler by = { .random = 3 * seed + (uint64_t)i, .words = words[i], .own_memory = argc > 3 };
			c = little_config(&s, OB_ISOLATION_PROCESS, seed % 4 == 3 ? 0 : 2);
			c.harden = OB_HARDEN_ALL;
			c.patience = 1;
			const uint64_t hash = run(&s, &c, &by, &deaths);
			failed += !hash;
			wrong += hash && hash != expected;
			if (hash && hash != expected)
				printf("seed %" PRIu64 ", %d words: wrong\n", seed, words[i]);
			sum += deaths;
			written += by.written;
		}
	printf("%u runs, %" PRIu64 " words written: %u wrong, %u failed, %u restarts\n", runs, written, wrong, failed,
	       sum);
	CHECK(wrong == 0 && written > 0);
	CHECK(waitpid(-1, NULL, WNOHANG) < 0);
	free(s.object);
	return check_end();
}
