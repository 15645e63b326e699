// Hardened simulators: the bits are the same; what is scribbled over all that one of them can write of the universe is
// noticed or of no effect, and never gets into the result; the culprit is named.
//
// Words are written from outside, at any instant (process_vm_writev goes by the protection of the pages, as the
// simulator's own stores do).
// Arguments: first seed, seeds, "all" for the simulators' own memory, too, where a store may make a simulator
// miscalculate.
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/uio.h>

#include "check.h"
#include "little_scene.h"
#include "measure/measure.h"
#include "workers.h"

enum { STEPS = 200, BALLS = 60 };

typedef struct scribbler {
	ob_host *h;
	uint64_t random;
	int words;
	bool own_memory; // too
	atomic_bool over;
	atomic_uint written;
} scribbler;

static uint64_t draw(scribbler *s, uint64_t below)
{
	s->random = s->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (s->random >> 20) % below;
}

// A word among those that the process can write; 0: there is none any more.
static uint64_t choose_word(scribbler *s, pid_t pid)
{
	char path[64], line[400], rights[5];
	uint64_t begin, end, inode, first[256], size[256], n = 0;
	unsigned major, minor;
	snprintf(path, sizeof path, "/proc/%d/maps", (int)pid);
	FILE *f = fopen(path, "r");
	while (f && n < 256 && fgets(line, sizeof line, f)) {
		if (sscanf(line, "%" SCNx64 "-%" SCNx64 " %4s %*x %x:%x %" SCNu64, &begin, &end, rights, &major, &minor,
			   &inode) != 6)
			continue;
		const bool shared = rights[3] == 's';
		if (rights[1] != 'w' || !(shared || s->own_memory))
			continue;
		first[n] = begin, size[n++] = end - begin;
	}
	if (f)
		fclose(f);
	if (!n)
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

// 0: the run has failed.
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
	if (fine && ob_snapshot_take(&now, ob_host_universe(h), false, &e))
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
		c.harden = true;
		CHECK(run(s, &c, NULL, &deaths) == expected && deaths == 0);
	}
}

int main(int argc, char **argv)
{
	const uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
		       seeds = argc > 2 ? strtoull(argv[2], NULL, 10) : 2;
	static const int words[] = { 1, 10, 500 };
	uint32_t deaths, sum = 0, failed = 0, wrong = 0, runs = 0;
	uint64_t written = 0;
	ob_scene s = busy_heap(BALLS);
	ob_host_config c = little_config(&s, OB_ISOLATION_THREAD, 1);
	const uint64_t expected = run(&s, &c, NULL, &deaths);
	test_same_bits(&s, expected);
	for (uint64_t seed = first; seed < first + seeds; seed++)
		for (int i = 0; i < 3; i++, runs++) {
			scribbler by = { .random = 3 * seed + (uint64_t)i, .words = words[i], .own_memory = argc > 3 };
			c = little_config(&s, OB_ISOLATION_PROCESS, seed % 4 == 3 ? 0 : 2);
			c.harden = true;
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
