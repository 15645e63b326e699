#include "host/stall.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "host/host_state.h"
#include "table/step_data.h"

enum { SHOWN = 4 };
static const uint64_t busy_ns = 10000000; // CPU within the tenth of a second: it computes

// The kernel's letter for what a task does (proc(5), stat); 0 when it is gone.
static char state_of(const ob_worker_info *w)
{
	char path[64], line[256], *end = NULL;
	snprintf(path, sizeof path, "/proc/%d/task/%d/stat", (int)w->pid, (int)w->tid);
	FILE *f = fopen(path, "re");
	if (!f)
		return 0;
	if (fgets(line, sizeof line, f))
		end = strrchr(line, ')'); // of its name, which may hold anything
	fclose(f);
	return end && end[1] == ' ' ? end[2] : 0;
}

static const char *doing(const ob_worker_info *w, uint64_t cpu_ns)
{
	char state = state_of(w);
	if (!state)
		return "gone";
	if (state == 'T')
		return "stopped by a signal";
	if (state == 't')
		return "held by a debugger";
	return state == 'R' || cpu_ns > busy_ns ? "computing" : "asleep";
}

void ob_stall_describe(const ob_host *h, char *text, size_t size)
{
	uint32_t who[SHOWN], shown = 0, more = 0;
	uint64_t before[SHOWN];
	ob_worker_info info[SHOWN];
	size_t n = 0;
	uint32_t arranger = ob_universe_step_data(h->u)->count->scheduler;
	bool awaited = false; // else all have arrived, and the last of them has not opened the gate again
	for (uint32_t w = 0; w < h->workers; w++)
		awaited = awaited || ob_gate_waits_for(h->u, w);
	for (uint32_t w = 0; w < h->workers; w++) {
		if (awaited ? !ob_gate_waits_for(h->u, w) : w != arranger)
			continue;
		if (shown < SHOWN && ob_universe_get_worker(h->u, w, &info[shown])) {
			before[shown] = h->spawn->cpu(&info[shown]);
			who[shown++] = w;
		} else {
			more++;
		}
	}
	nanosleep(&(struct timespec){ .tv_nsec = 100000000 }, NULL);
	for (uint32_t i = 0; i < shown && n < size; i++)
		n += (size_t)snprintf(text + n, size - n, "%ssimulator %u (task %d, %s)", i ? ", " : "", who[i],
				      (int)info[i].tid, doing(&info[i], h->spawn->cpu(&info[i]) - before[i]));
	if (more && n < size)
		snprintf(text + n, size - n, " and %u more", more);
}
