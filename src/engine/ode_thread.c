#include "ode/ode_body.h"
#include "engine/engines.h"

static _Thread_local unsigned peers;

void ob_engine_ode_enter(void)
{
	if (peers++ == 0)
		ob_ode_thread_init();
}

void ob_engine_ode_leave(void)
{
	if (--peers == 0)
		ob_ode_thread_finish();
}
