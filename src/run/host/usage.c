// Use of processors by the workers: their CPU time, switches and waiting.
#include <math.h>

#include "host/accounting.h"
#include "host/host_state.h"

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
