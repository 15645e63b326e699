#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "free/free.h"
#include "host/ask.h"
#include "host/host_state.h"
#include "host/restart.h"

enum { REFRESH_MS = 500 };

// "simulator 3 (object "crate", process 4242)"
static void describe_worker(const ob_host *h, const ob_worker_end *end, char *text, size_t size)
{
	ob_passport p;
	int n = snprintf(text, size, "simulator %u (", end->worker);
	if (ob_universe_settings(h->u)->one_per_object && ob_universe_get_passport(h->u, end->worker, &p))
		n += snprintf(text + n, size - (size_t)n, "object \"%.*s\", ", OB_NAME_MAX, p.name);
	snprintf(text + n, size - (size_t)n, "process %d)", end->pid);
}

// Requests a restart after the unexpected end of a process.
static void request_restart(ob_host *h, const ob_worker_end *end, const char *worker)
{
	const unsigned long long step = ob_step_count(h->u);
	ob_death d = { .cause = end->signal ? OB_DEATH_SIGNAL : OB_DEATH_EXIT,
		       .worker = end->worker,
		       .pid = end->pid,
		       .signal = end->signal,
		       .code = end->code,
		       .step = step + 1 };
	ob_death_find_object(&d, h->u);
	memcpy(d.words, end->words, sizeof d.words);
	if (end->signal)
		snprintf(d.text, sizeof d.text, "%s was killed by SIG%s (%s) after step %llu", worker,
			 sigabbrev_np(end->signal), strsignal(end->signal), step);
	else
		snprintf(d.text, sizeof d.text, "%s left with exit code %d after step %llu, before the run was over",
			 worker, end->code, step);
	if (ob_free_settings_of(h->u))
		ob_restart_worker(h, &d);
	else
		ob_restart_request(h, &d);
}

// True if workers were ordered to leave.
static bool is_halted(ob_host *h)
{
	pthread_mutex_lock(&h->interval.lock);
	const bool halted = h->interval.halted;
	pthread_mutex_unlock(&h->interval.lock);
	return halted;
}

static void on_end(ob_host *h, const ob_worker_end *end)
{
	char worker[160];
	unsigned long long step = ob_step_count(h->u);
	if (h->restart.requested)
		ob_restart_add_words(h, end);
	if (h->ending || h->failed || h->restart.requested || is_halted(h))
		return;
	describe_worker(h, end, worker, sizeof worker);
	if (ob_universe_traced(h->u) && !end->error)
		ob_trace_span(h->u, ob_trace_supervisor(h->u), OB_TRACE_KILLED, ob_clock_ns(), end->worker,
			      (uint32_t)end->signal);
	if (end->error)
		ob_host_set_failure(h,
				    "simulator %u of %u does not start: %s; use fewer workers, or raise the limit on "
				    "processes (ulimit -u, or pids.max of the container)",
				    end->worker + 1, h->workers, strerror(end->error));
	else if (end->signal == SIGBUS && ob_universe_lost(h->u))
		ob_host_set_failure(h, "%s ended after step %llu: the memory of universe \"%s\" is not all there: %s",
				    worker, step, ob_universe_name(h->u), ob_universe_lost(h->u));
	else if (end->code == OB_WORKER_NO_MEMORY)
		ob_host_set_failure(
			h,
			"%s ran out of memory after step %llu: take fewer objects or workers, or raise the limits "
			"(ulimit -v, or memory.max of the container)",
			worker, step);
	else
		request_restart(h, end, worker);
}

static void on_fork_server_end(ob_host *h)
{
	if (!h->ending && !h->failed)
		ob_host_set_failure(h, "the fork server (process %d) has ended, so this run is no longer supervised",
				    (int)ob_fork_server_pid(h->fork_server));
}

// Returns false when the supervisor is to end.
static bool handle_events(ob_host *h, struct pollfd fds[5])
{
	ob_worker_end end;
	if (fds[0].revents)
		return false;
	if (fds[1].revents)
		while (h->spawn->next_end(h->group, &end)) {
			on_end(h, &end);
			h->running_workers--; // last: once all have ended, the host may restart them
		}
	if (fds[2].revents) { // POLLHUP would be reported again and again
		on_fork_server_end(h);
		fds[1].fd = fds[1].fd == fds[2].fd ? -1 : fds[1].fd;
		fds[2].fd = -1;
	}
	if (fds[3].revents) {
		h->interrupted = true;
		fds[3].fd = -1;
		ob_host_pause_early(h);
	}
	if (fds[4].revents)
		ob_asked_answer(h, &h->asked);
	return true;
}

static void *supervise(void *argument)
{
	ob_host *h = argument;
	struct pollfd fds[5] = {
		{ .fd = h->wake_fd, .events = POLLIN },      { .fd = h->spawn->fd(h->group), .events = POLLIN },
		{ .fd = ob_fork_server_fd(h->fork_server) }, // only POLLHUP
		{ .fd = h->interrupt_fd, .events = POLLIN }, { .fd = h->asked.events, .events = POLLIN },
	};
	double refreshed = 0;
	pthread_setname_np(pthread_self(), "supervisor");
	for (;;) {
		if (poll(fds, 5, REFRESH_MS) < 0)
			continue;
		if (h->dismissed || !handle_events(h, fds))
			return NULL;
		double now = ob_clock_wall();
		if (now - refreshed >= 1e-3 * REFRESH_MS) {
			refreshed = now;
			ob_host_read_cpu(h);
		}
	}
}

bool ob_supervisor_start(ob_host *h, ob_error *e)
{
	sigset_t before;
	h->wake_fd = eventfd(0, EFD_CLOEXEC);
	if (h->wake_fd < 0)
		return ob_fail(e, "cannot make an event for the supervisor: %s", strerror(errno));
	ob_error why;
	if (ob_universe_rank(h->u) == 0 && !ob_asked_listen(&h->asked, ob_universe_name(h->u), &why))
		ob_log_warn("%s", why.text);
	ob_interrupt_leave_to_main(&before);
	int error = pthread_create(&h->supervisor, NULL, supervise, h);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	h->supervised = error == 0;
	return h->supervised ||
	       ob_fail(e, "cannot start the supervisor thread: %s; raise the limit on processes (ulimit -u)",
		       strerror(error));
}

void ob_supervisor_stop(ob_host *h)
{
	uint64_t one = 1;
	h->dismissed = true; // seen soon enough even without a wake-up
	if (h->supervised) {
		ssize_t ignored = write(h->wake_fd, &one, sizeof one);
		(void)ignored;
		pthread_join(h->supervisor, NULL);
		h->supervised = false;
	}
	if (h->wake_fd >= 0)
		close(h->wake_fd);
	h->wake_fd = -1;
	ob_asked_close(&h->asked);
}
