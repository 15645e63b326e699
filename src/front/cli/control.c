// obsim control: one scene that a program leads step by step (include/ob/control.h).
#include <signal.h>
#include <stdio.h>

#include "base/interrupt.h"
#include "cli/command.h"
#include "cli/led_run.h"

static int carry_out(ob_led_run *r)
{
	ob_error e;
	bool fine = ob_led_run_start(r, &e);
	if (fine) {
		printf("%s waits as universe \"%s\" for a program to control it.\n", r->scene->title,
		       ob_universe_name(ob_host_universe(r->host)));
		fflush(stdout);
		fine = ob_led_run_go_on(r, &e);
	}
	if (fine)
		return OB_EXIT_OK;
	ob_control_end(r->control, e.text);
	return ob_command_fail(r->host && ob_host_broke_invariant(r->host) ? OB_EXIT_BROKEN : OB_EXIT_FAILED, e.text);
}

int ob_command_control(const ob_arguments *a)
{
	ob_led_run r;
	ob_error e;
	if (!ob_led_run_load(&r, a, false, &e)) {
		ob_led_run_finish(&r);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	const int code = carry_out(&r);
	ob_led_run_finish(&r);
	ob_interrupt_release();
	return code;
}
