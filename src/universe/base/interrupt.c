#include "base/interrupt.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

static const int signals[] = { SIGINT, SIGTERM, SIGHUP };
enum { SIGNALS = sizeof signals / sizeof *signals };

static struct sigaction before[SIGNALS];
static int event_fd = -1;
static int watchers;
static atomic_bool came;

static void on_signal(int number)
{
	int saved = errno;
	came = true;
	uint64_t one = 1;
	ssize_t ignored = write(event_fd, &one, sizeof one);
	(void)ignored;
	(void)number;
	errno = saved;
}

int ob_interrupt_watch(void)
{
	if (watchers++ > 0)
		return event_fd;
	event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (event_fd < 0) {
		watchers = 0;
		return -1;
	}
	came = false;
	for (int i = 0; i < SIGNALS; i++) {
		struct sigaction action = { .sa_handler = on_signal, .sa_flags = SA_RESTART | SA_RESETHAND };
		sigaction(signals[i], NULL, &before[i]);
		if (before[i].sa_handler != SIG_IGN)
			sigaction(signals[i], &action, NULL);
	}
	return event_fd;
}

void ob_interrupt_release(void)
{
	if (watchers == 0 || --watchers > 0)
		return;
	for (int i = 0; i < SIGNALS; i++)
		sigaction(signals[i], &before[i], NULL);
	close(event_fd);
	event_fd = -1;
}

bool ob_interrupt_came(void)
{
	return came;
}

void ob_interrupt_leave_to_main(sigset_t *mask)
{
	static const int faults[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS };
	sigset_t all;
	sigfillset(&all);
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		sigdelset(&all, faults[i]);
	pthread_sigmask(SIG_SETMASK, &all, mask);
}
