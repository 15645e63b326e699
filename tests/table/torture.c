#include "torture.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "workers.h"
#include "table/slot.h"

enum { WORDS = sizeof(ob_motion) / sizeof(uint64_t) };

typedef struct arena {
	ob_slot slot;
	_Alignas(64) uint32_t over;
	_Alignas(64) uint32_t ready; // readers that are ready
	_Alignas(64) torture_result sum;
} arena;

// Each word of a publication is a different function of its number.
static uint64_t word_of(uint64_t number, unsigned i)
{
	return number * UINT64_C(0x9e3779b97f4a7c15) + i;
}

static void publish(ob_slot *s, uint64_t number)
{
	union {
		ob_motion motion;
		uint64_t word[WORDS];
	} m;
	for (unsigned i = 0; i < WORDS; i++)
		m.word[i] = word_of(number, i);
	m.word[0] = number;
	ob_slot_publish(s, &m.motion);
}

static void count(uint64_t *sum, uint64_t n)
{
	__atomic_fetch_add(sum, n, __ATOMIC_RELAXED);
}

static int reader(void *shared, uint32_t number)
{
	(void)number;
	arena *a = shared;
	torture_result own = { 0 };
	uint64_t last = 0;
	__atomic_fetch_add(&a->ready, 1, __ATOMIC_RELEASE);
	while (!__atomic_load_n(&a->over, __ATOMIC_ACQUIRE)) {
		union {
			ob_motion motion;
			uint64_t word[WORDS];
		} m;
		if (!ob_slot_read(&a->slot, &m.motion)) {
			own.refused++;
			continue;
		}
		bool torn = false;
		for (unsigned i = 1; i < WORDS; i++)
			torn |= m.word[i] != word_of(m.word[0], i);
		own.read++;
		own.torn += torn;
		own.backward += m.word[0] < last;
		last = m.word[0];
	}
	count(&a->sum.read, own.read);
	count(&a->sum.torn, own.torn);
	count(&a->sum.backward, own.backward);
	count(&a->sum.refused, own.refused);
	return 0;
}

static bool gather(worker_group *readers, arena *a)
{
	publish(&a->slot, 1);
	if (!worker_group_start(readers))
		return false;
	while (__atomic_load_n(&a->ready, __ATOMIC_ACQUIRE) < readers->count)
		usleep(100);
	return true;
}

torture_result torture_run(bool processes, uint32_t readers, uint64_t publishes)
{
	arena *a = shared_memory(sizeof *a);
	worker_group g = { .processes = processes, .count = readers, .run = reader, .shared = a };
	if (!gather(&g, a))
		return (torture_result){ .failed = readers };
	double start = ob_clock_wall();
	for (uint64_t i = 2; i <= publishes; i++)
		publish(&a->slot, i);
	double seconds = ob_clock_wall() - start;
	__atomic_store_n(&a->over, 1, __ATOMIC_RELEASE);
	uint32_t failed = worker_group_join(&g);
	torture_result r = a->sum;
	r.failed = failed;
	r.published = publishes;
	r.seconds = seconds;
	return r;
}

// A successor continues from the number that the slot holds.
static pid_t start_writer(ob_slot *s)
{
	pid_t pid = fork();
	if (pid != 0)
		return pid;
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	ob_motion m;
	uint64_t number;
	ob_slot_read(s, &m);
	memcpy(&number, &m, sizeof number);
	for (;;)
		publish(s, ++number);
}

torture_result torture_run_killed(uint32_t readers, uint32_t kills)
{
	enum { PUBLISHES = 20 }; // minimum before a kill
	arena *a = shared_memory(sizeof *a);
	worker_group g = { .processes = true, .count = readers, .run = reader, .shared = a };
	torture_result r = { .failed = readers };
	if (!gather(&g, a))
		return r;
	double start = ob_clock_wall();
	uint32_t unreadable = 0;
	for (uint32_t i = 0; i < kills; i++) {
		uint64_t before = __atomic_load_n(&a->slot.version, __ATOMIC_ACQUIRE);
		pid_t pid = start_writer(&a->slot);
		while (__atomic_load_n(&a->slot.version, __ATOMIC_ACQUIRE) < before + PUBLISHES)
			usleep(100); // on a busy machine it has to wait for its turn
		usleep((useconds_t)(i * 7919 % 1000));
		kill(pid, SIGKILL);
		waitpid(pid, NULL, 0);
		ob_motion m;
		unreadable += !ob_slot_read(&a->slot, &m);
	}
	double seconds = ob_clock_wall() - start;
	__atomic_store_n(&a->over, 1, __ATOMIC_RELEASE);
	uint32_t failed = worker_group_join(&g);
	r = a->sum;
	r.failed = failed;
	r.refused += unreadable;
	r.published = __atomic_load_n(&a->slot.version, __ATOMIC_ACQUIRE);
	r.seconds = seconds;
	return r;
}
