// obsim control: one scene that a program leads step by step (include/ob/control.h).
#include <math.h>
#include <signal.h>
#include <stdio.h>

#include "base/interrupt.h"
#include "cli/command.h"
#include "cli/observe.h"
#include "cli/quantity.h"
#include "cli/request.h"
#include "host/control.h"
#include "host/host.h"
#include "table/table.h"

// Leads the run until the program leaves. false and e: it has failed, or was interrupted.
static bool lead(ob_host *h, ob_control *c, uint64_t last, ob_error *e)
{
	uint64_t step = 0;
	ob_warn_of_overlap(h);
	for (;;) {
		ob_host_go(h, step);
		if (!ob_host_wait(h, e)) {
			ob_control_end(c, e->text);
			return false;
		}
		if (!ob_control_next(c, h, last, &step))
			return true;
	}
}

int ob_command_control(const ob_arguments *a)
{
	ob_run_request q;
	ob_error e;
	uint64_t room = 1000; // for objects that the program adds
	if (!ob_request_read(&q, a, &e) || !ob_number_count("room", a->value[OB_OPTION_ROOM], 0, 1000000, &room, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	ob_scene *scene = ob_scene_load(q.scene, &q.scene_options, &e);
	ob_control *c = scene && ob_request_resolve(&q, scene, &e) ? ob_control_create(&e) : NULL;
	if (!c) {
		ob_scene_free(scene);
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	}
	ob_host_config config = ob_request_host(&q);
	config.control = c;
	config.spare = (uint32_t)room;
	// a motion carries its step as 32 bits
	const uint64_t last =
		a->value[OB_OPTION_DURATION] ? ob_request_steps(q.duration, q.run.step_length) : UINT32_MAX - 2;
	signal(SIGPIPE, SIG_IGN);
	ob_interrupt_watch(); // before there is anything to clean up after Ctrl-C
	ob_host *h = ob_host_start(scene, &config, &e);
	int code = OB_EXIT_FAILED;
	if (h) {
		printf("%s waits as universe \"%s\" for a program to control it.\n", scene->title,
		       ob_universe_name(ob_host_universe(h)));
		fflush(stdout);
		code = lead(h, c, last, &e) ? OB_EXIT_OK : ob_host_broke_invariant(h) ? OB_EXIT_BROKEN : OB_EXIT_FAILED;
	}
	if (code != OB_EXIT_OK)
		ob_command_fail(code, e.text);
	ob_host_stop(h);
	ob_control_destroy(c);
	ob_interrupt_release();
	ob_scene_free(scene);
	return code;
}
