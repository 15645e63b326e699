#include "ode/ode_body.h"
#include "engine/engines.h"

static _Thread_local unsigned users;

void ob_engine_ode_enter(void)
{
	if (users++ == 0)
		ob_ode_thread_init();
}

void ob_engine_ode_leave(void)
{
	if (--users == 0)
		ob_ode_thread_finish();
}
