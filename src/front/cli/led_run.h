// A run that a program leads, with its scene: begun, begun anew, saved; the program is a process of its own (obsim control)
// or the caller (inside.c).
#ifndef OB_CLI_LED_RUN_H
#define OB_CLI_LED_RUN_H

#include <limits.h>

#include "cli/request.h"
#include "host/control.h"
#include "record/record.h"

typedef struct ob_led_run {
	const ob_arguments *a;
	ob_run_request q;
	char path[PATH_MAX]; // of the scene
	ob_scene *scene;
	uint64_t room; // for objects that the program adds
	const char *
		*defines; // [q.scene_options.define_count], with words of their own behind those of the command line
	uint32_t own; // words of their own
	ob_saved_run saved; // start of a resumed run; else zeroed
	ob_checkpoint_file saved_file; // storage of saved
	ob_control *control;
	ob_host *host;
	uint64_t step; // to which it goes
	ob_recorder *recorder; // NULL: it is not recorded
	ob_snapshot now;
	uint64_t recorded; // step of the last recorded state; UINT64_MAX: none yet
} ob_led_run;

// Reads options and scene, which the arguments keep. false and e: they are wrong. To be finished in any case.
bool ob_led_run_load(ob_led_run *r, const ob_arguments *a, bool inside, ob_error *e);
// Starts the host, which then stands at the first step. false and e: it cannot.
bool ob_led_run_start(ob_led_run *r, ob_error *e);
// Goes on until the program leaves; inside, until its command is answered. false and e: it has failed, or was interrupted.
bool ob_led_run_go_on(ob_led_run *r, ob_error *e);
void ob_led_run_finish(ob_led_run *r);

// ---- save

// Saves a run that a program or visitors lead as a checkpoint file, from which obsim run --resume goes on.

// Between a wait and the next go; the request is resolved, the scene its own. false and e: nothing is written.
bool ob_save_led_run(const ob_run_request *r, const ob_scene *s, ob_host *h, const char *path, ob_error *e);

#endif
