// What ODE keeps per process: its initialisation and its message handlers.
#include "ode/ode_body.h"

#include <ode/ode.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/log.h"

static pthread_once_t once = PTHREAD_ONCE_INIT;

// ODE repeats itself thousands of times a second ("LCP internal error, s <= 0"): the first one is news.
static void on_message(int number, const char *format, va_list args)
{
	static atomic_flag told = ATOMIC_FLAG_INIT;
	if (atomic_flag_test_and_set(&told))
		return;
	char text[256];
	vsnprintf(text, sizeof text, format, args);
	ob_log_warn("ODE: %s (%d); further messages of ODE are left out", text, number);
}

// ODE's contract: handlers of errors must not return.
static void on_error(int number, const char *format, va_list args)
{
	char text[256];
	vsnprintf(text, sizeof text, format, args);
	ob_log_warn("ODE failed: %s (%d)", text, number);
	abort();
}

static void init(void)
{
	dSetMessageHandler(on_message);
	dSetErrorHandler(on_error);
	dSetDebugHandler(on_error);
	if (!dInitODE2(dInitFlagManualThreadCleanup)) {
		ob_log_warn("ODE does not start: no memory");
		abort();
	}
}

// A child of fork inherits both the flag and what it stands for.
void ob_ode_init(void)
{
	pthread_once(&once, init);
}

void ob_ode_thread_init(void)
{
	ob_ode_init();
	dAllocateODEDataForThread(dAllocateMaskAll);
}

void ob_ode_thread_finish(void)
{
	dCleanupODEAllDataForThread();
}

#ifdef __SANITIZE_THREAD__
// ODE hands memory that a geometry no longer needs (it is destroyed, or has a body now) to the next one, of any thread,
// by a locked exchange. Debian's library is not built for ThreadSanitizer, which sees the hand-over but not the lock.
const char *__tsan_default_suppressions(void);
__attribute__((visibility("default"))) const char *__tsan_default_suppressions(void)
{
	return "race:dxGeom::~dxGeom\nrace:dGeomSetBody\n";
}
#endif
