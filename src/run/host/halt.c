// Failure, halt and early pause of a run, by any thread.
#include <stdarg.h>
#include <stdio.h>

#include "host/host_state.h"

void ob_host_set_failure(ob_host *h, const char *format, ...)
{
	va_list args;
	pthread_mutex_lock(&h->failure_lock);
	if (!h->failed) {
		va_start(args, format);
		vsnprintf(h->failure.text, sizeof h->failure.text, format, args);
		va_end(args);
		h->failed = true;
	}
	pthread_mutex_unlock(&h->failure_lock);
	ob_host_halt(h);
}

void ob_host_halt(ob_host *h)
{
	pthread_mutex_lock(&h->interval.lock);
	h->interval.halted = true;
	ob_gate_set_pause_step(h->u, 0); // where all objects sleep, thousands of steps pass without a phase at the gate
	pthread_mutex_unlock(&h->interval.lock);
	ob_gate_stop(h->u);
}

void ob_host_pause_early(ob_host *h)
{
	ob_interval *interval = &h->interval;
	h->free_hold = true;
	pthread_mutex_lock(&interval->lock);
	uint64_t next = ob_step_count(h->u) + 1;
	if (interval->running && next < interval->end) {
		interval->end = next;
		ob_gate_set_pause_step(h->u, next);
	}
	pthread_mutex_unlock(&interval->lock);
}
