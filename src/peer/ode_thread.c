#include "ode/ode_body.h"
#include "peer/engines.h"

static _Thread_local unsigned peers;

void ob_peer_ode_enter(void)
{
	if (peers++ == 0)
		ob_ode_thread_init();
}

void ob_peer_ode_leave(void)
{
	if (--peers == 0)
		ob_ode_thread_finish();
}
