#include "host/accounting.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "host/host_state.h"

size_t ob_memory_of_process(pid_t pid)
{
	char path[64], line[128];
	size_t kib, sum = 0;
	snprintf(path, sizeof path, "/proc/%d/smaps_rollup", (int)pid);
	FILE *f = fopen(path, "re");
	if (!f)
		return 0;
	while (fgets(line, sizeof line, f)) {
		if (sscanf(line, "Pss_Anon: %zu kB", &kib) == 1 || sscanf(line, "Pss_File: %zu kB", &kib) == 1)
			sum += kib << 10;
	}
	fclose(f);
	return sum;
}

size_t ob_memory_of_universe(const char *name)
{
	char path[128];
	struct stat s;
	snprintf(path, sizeof path, "/dev/shm/obsim.%s", name);
	return stat(path, &s) == 0 ? (size_t)s.st_blocks * 512 : 0;
}

static FILE *open_thread_file(pid_t pid, pid_t tid, const char *name)
{
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/task/%d/%s", (int)pid, (int)tid, name);
	return fopen(path, "re");
}

uint64_t ob_switches_of_thread(pid_t pid, pid_t tid)
{
	char line[256];
	uint64_t n, sum = 0;
	FILE *f = open_thread_file(pid, tid, "status");
	if (!f)
		return 0;
	while (fgets(line, sizeof line, f)) {
		if (sscanf(line, "voluntary_ctxt_switches: %" SCNu64, &n) == 1 ||
		    sscanf(line, "nonvoluntary_ctxt_switches: %" SCNu64, &n) == 1)
			sum += n;
	}
	fclose(f);
	return sum;
}

const char *ob_state_word(char state)
{
	switch (state) {
	case 0:
	case 'X':
	case 'Z':
		return "gone";
	case 'T':
		return "stopped by a signal";
	case 't':
		return "held by a debugger";
	case 'R':
		return "computing";
	default:
		return "asleep";
	}
}

char ob_state_of_thread(pid_t pid, pid_t tid)
{
	char line[256], *end = NULL;
	FILE *f = open_thread_file(pid, tid, "stat");
	if (!f)
		return 0;
	if (fgets(line, sizeof line, f))
		end = strrchr(line, ')'); // the thread's name stands in brackets and may hold anything
	fclose(f);
	return end && end[1] == ' ' ? end[2] : 0;
}

// ---- usage

// Use of processors by the workers: their CPU time, switches and waiting.

uint64_t ob_host_read_cpu(ob_host *h)
{
	uint64_t sum = h->restart.cpu;
	for (uint32_t w = 0; w < h->workers; w++) {
		ob_worker_info info;
		if (!ob_universe_get_worker(h->u, w, &info) || info.pid == 0)
			continue;
		uint64_t ns = h->spawn->cpu(&info);
		if (ns > info.cpu_ns)
			ob_worker_set_cpu(h->u, w, ns);
		sum += ns > info.cpu_ns ? ns : info.cpu_ns;
	}
	return sum;
}

uint64_t ob_host_count_switches(const ob_host *h)
{
	uint64_t sum = 0;
	ob_worker_info info;
	for (uint32_t w = 0; w < h->workers; w++)
		if (ob_universe_get_worker(h->u, w, &info) && info.pid != 0)
			sum += ob_switches_of_thread(info.pid, info.tid);
	return sum;
}

// A worker that waits now has waited since its last phase (since_ns).
double ob_host_gate_time(const ob_host *h, double now)
{
	double sum = 0;
	for (uint32_t w = 0; w < h->workers; w++) {
		ob_counters c;
		ob_counters_copy(&c, ob_worker_counters(h->u, w));
		sum += 1e-9 * (double)c.gate_ns;
		if (c.since_ns)
			sum += fmax(0, now - 1e-9 * (double)c.since_ns);
	}
	return sum;
}
